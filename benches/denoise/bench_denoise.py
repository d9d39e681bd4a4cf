"""Denoisers beside each other on pairs of noisy and clean meshes; writes docs/DENOISING.md.

`cargo xtask bench-peers --only denoise` runs it in an environment of its own. `--pairs WORD` takes only the pairs whose name
has the word in it, prints, and writes no document.
"""

import argparse
import json
import sys
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent.parent))  # what all comparisons share

import pictures  # noqa: E402
import report  # noqa: E402
import timing  # noqa: E402
from measure import Clean, read, write_obj  # noqa: E402
from programs import Failure, Programs, command  # noqa: E402

# Built-in shapes that noise is put on, with their vertices, and the noise: kind and σ in mean edges, on the first also strong.
SHAPES = {"bracket": 10000, "creature": 20000}
NOISES = (("normal", 0.3), ("isotropic", 0.3), ("impulsive", 0.6), ("scanner", 0.3))
STRONG = {"bracket": (("normal", 0.6), ("isotropic", 0.6))}
SEED = 1
# Clean meshes that ought to stay as they are: built-in ones, and those of these pairs.
CLEAN_PAIRS = ("Fandisk0.3", "Bunny0.2")
LEARNED = "gcn.obj"


@dataclass
class Pair:
    name: str
    noisy: Path
    clean: Path
    learned: Path | None = None


class Bench:
    def __init__(self, args):
        self.args, self.notes = args, []
        args.work.mkdir(parents=True, exist_ok=True)
        self.programs = Programs(args.adwave, args.steps, args.work)
        if not self.programs.has_denoise:
            self.note("this build has no `adwave denoise`; four levels of the preset `suppress` take its place")

    def note(self, what):
        print(f"  {what}", flush=True)
        self.notes.append(what)

    def given(self):
        """The pairs of a folder: `noisy.obj` and `clean.obj` side by side."""
        files = sorted(self.args.models.rglob("noisy.obj")) if self.args.models.is_dir() else []
        for noisy in files:
            clean, learned = noisy.with_name("clean.obj"), noisy.with_name(LEARNED)
            if clean.is_file():
                yield Pair(noisy.parent.name, noisy, clean, learned if learned.is_file() else None)
        if not files:
            self.note(f"no pairs below {self.args.models}: built-in shapes only")

    def made(self):
        """Built-in shapes with noise of each kind."""
        for shape, n_vertices in SHAPES.items():
            clean = self.args.work / f"{shape}.obj"
            command([self.args.adwave, "sample", shape, "--vertices", n_vertices, "--quiet", "-o", clean])
            for kind, sigma in NOISES + STRONG.get(shape, ()):
                noisy = self.args.work / f"{shape}-{kind}-{sigma:g}.obj"
                command([self.args.steps, "noise", kind, sigma, SEED, clean, noisy])
                yield Pair(noisy.stem, noisy, clean)

    def of_pair(self, pair):
        """All programs on a pair: measures, seconds and memory by name; the settings that were best."""
        clean = Clean(read(pair.clean))
        found = {"noisy": clean.measures(read(pair.noisy))}
        if pair.learned:
            found["learned"] = clean.measures(read(pair.learned))
        for name, program in self.programs.defaults().items():
            self.take(found, pair, clean, name, program)
        for name, settings in self.programs.tuned().items():
            best = None
            for words, program in settings:
                try:
                    ran = program(pair.noisy, self.out(pair, "trial"))
                    angle = clean.measures(ran.mesh, distances=False)["angle"]
                except (Failure, ValueError) as why:
                    self.note(f"{name} ({words}) on {pair.name}: {why}")
                    continue
                if best is None or angle < best[0]:
                    best = (angle, words, program)
            if best:
                self.take(found, pair, clean, name, best[2], settings=best[1])
        return found

    def take(self, found, pair, clean, name, program, **more):
        out = self.out(pair, name)
        try:
            ran = program(pair.noisy, out)
            found[name] = {**clean.measures(ran.mesh), "seconds": ran.seconds, "peak": ran.peak, **more}
        except (Failure, ValueError) as why:
            found[name] = {"failed": str(why)}
            self.note(f"{name} on {pair.name}: {why}")

    def out(self, pair, name):
        folder = self.args.work / pair.name
        folder.mkdir(exist_ok=True)
        return folder / (name.replace(", ", "-").replace(" ", "-").lower() + ".obj")

    def untouched(self, pairs):
        """How far clean meshes are moved by programs without knobs, mean edges."""
        meshes = {pair.name.rstrip(".0123456789") + ", clean": pair.clean for pair in pairs if pair.name in CLEAN_PAIRS}
        meshes |= {shape: self.args.work / f"{shape}.obj" for shape in SHAPES}
        moved = {}
        for name, path in meshes.items():
            mesh = read(path)
            source = self.args.work / "clean.obj"
            write_obj(source, mesh)
            clean, moved[name] = Clean(mesh), {}
            for program, run in self.programs.defaults().items():
                try:
                    ran = run(source, self.args.work / "moved.obj")
                    moved[name][program] = clean.measures(ran.mesh, distances=False)
                except (Failure, ValueError) as why:
                    self.note(f"{program} on {name}: {why}")
        return moved


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--adwave", type=Path, required=True, help="the command")
    parser.add_argument("--steps", type=Path, required=True, help="the program denoise_case")
    parser.add_argument("--models", type=Path, required=True, help="folder with pairs somewhere in it")
    parser.add_argument("--work", type=Path, required=True, help="folder for meshes and pictures, which are kept")
    parser.add_argument("--docs", type=Path, required=True, help="folder with DENOISING.md")
    parser.add_argument("--pairs", help="only pairs whose name has this in it, printed")
    args = parser.parse_args()
    bench, start = Bench(args), time.monotonic()
    given = [*bench.given()]
    pairs = [*given, *bench.made()]
    if args.pairs:
        pairs = [pair for pair in pairs if args.pairs in pair.name]
    results = {"given": [pair.name for pair in given], "pairs": {}, "clean": {}, "times": {}}
    for pair in pairs:
        print(pair.name, flush=True)
        results["pairs"][pair.name] = of = bench.of_pair(pair)
        print("  " + ", ".join(f"{name} {m['angle']:.2f}°" for name, m in of.items() if "angle" in m), flush=True)
        (args.work / "measured.json").write_text(json.dumps(results, indent=1))
    if not args.pairs:
        results["clean"] = bench.untouched(pairs)
        results["times"] = timing.measured(bench)
    pictures.draw(bench, pairs, results["pairs"])
    results["notes"], results["seconds"] = bench.notes, time.monotonic() - start
    (args.work / "measured.json").write_text(json.dumps(results, indent=1))
    if args.pairs:
        print(report.measured(results))
        return
    report.write(results, args.docs)
    print(f"wrote {args.docs / 'DENOISING.md'}; figures, meshes and pictures are in {args.work}")


if __name__ == "__main__":
    main()
