"""Runs denoisers on pairs of noisy and clean meshes and writes docs/DENOISING.md.

`cargo xtask bench-peers --only denoise` runs it in an environment of its own. `--pairs WORD` takes only the pairs whose name
contains the word, prints the result, and writes no document.
"""

import argparse
import json
import sys
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent.parent))  # modules shared by all comparisons

import pictures  # noqa: E402
import report  # noqa: E402
import timing  # noqa: E402
from measure import Clean, read, write_obj  # noqa: E402
from programs import Failure, Programs, command  # noqa: E402

# Built-in shapes that get noise, with their number of vertices; kinds of noise with σ in mean edges; stronger noise for one.
SHAPES = {"bracket": 10000, "creature": 20000}
NOISES = (("normal", 0.3), ("isotropic", 0.3), ("impulsive", 0.6), ("scanner", 0.3))
STRONG = {"bracket": (("normal", 0.6), ("isotropic", 0.6))}
SEED = 1
# Pairs whose clean mesh is denoised too, next to the built-in shapes: it should stay as it is.
CLEAN_PAIRS = ("Fandisk0.3", "Bunny0.2")
LEARNED = "gcn.obj"


@dataclass
class Pair:
    """A noisy mesh, the clean one, and the published result of a learned method if there is one."""

    name: str
    noisy: Path
    clean: Path
    learned: Path | None = None


class Bench:
    """The programs, the work folder, and notes on what was left out."""

    def __init__(self, args):
        self.args, self.notes = args, []
        args.work.mkdir(parents=True, exist_ok=True)
        self.programs = Programs(args.adwave, args.steps, args.work)
        if not self.programs.has_denoise:
            self.add_note("this build has no `adwave denoise`; the preset `suppress` with four levels is used instead")

    def add_note(self, text):
        print(f"  {text}", flush=True)
        self.notes.append(text)

    def published_pairs(self):
        """Pairs of a folder: `noisy.obj` and `clean.obj` next to each other."""
        files = sorted(self.args.models.rglob("noisy.obj")) if self.args.models.is_dir() else []
        for noisy in files:
            clean, learned = noisy.with_name("clean.obj"), noisy.with_name(LEARNED)
            if clean.is_file():
                yield Pair(noisy.parent.name, noisy, clean, learned if learned.is_file() else None)
        if not files:
            self.add_note(f"no pairs below {self.args.models}: built-in shapes only")

    def synthetic_pairs(self):
        """Built-in shapes with noise of each kind."""
        for shape, n_vertices in SHAPES.items():
            clean = self.args.work / f"{shape}.obj"
            command([self.args.adwave, "sample", shape, "--vertices", n_vertices, "--quiet", "-o", clean])
            for kind, sigma in NOISES + STRONG.get(shape, ()):
                noisy = self.args.work / f"{shape}-{kind}-{sigma:g}.obj"
                command([self.args.steps, "noise", kind, sigma, SEED, clean, noisy])
                yield Pair(noisy.stem, noisy, clean)

    def measure_pair(self, pair):
        """Measures, seconds and memory of all programs on a pair, by name, with the best settings of tuned ones."""
        clean = Clean(read(pair.clean))
        found = {"noisy": clean.measures(read(pair.noisy))}
        if pair.learned:
            found["learned"] = clean.measures(read(pair.learned))
        for name, program in self.programs.defaults().items():
            self.run_program(found, pair, clean, name, program)
        for name, settings in self.programs.tuned().items():
            best = None
            for words, program in settings:
                try:
                    ran = program(pair.noisy, self.result_path(pair, "trial"))
                    angle = clean.measures(ran.mesh, distances=False)["angle"]
                except (Failure, ValueError) as error:
                    self.add_note(f"{name} ({words}) on {pair.name}: {error}")
                    continue
                if best is None or angle < best[0]:
                    best = (angle, words, program)
            if best:
                self.run_program(found, pair, clean, name, best[2], settings=best[1])
        return found

    def run_program(self, found, pair, clean, name, program, **more):
        """Adds the measures of one program on a pair to `found`, or the reason why it failed."""
        out = self.result_path(pair, name)
        try:
            ran = program(pair.noisy, out)
            found[name] = {**clean.measures(ran.mesh), "seconds": ran.seconds, "peak": ran.peak, **more}
        except (Failure, ValueError) as error:
            found[name] = {"failed": str(error)}
            self.add_note(f"{name} on {pair.name}: {error}")

    def result_path(self, pair, name):
        """File for the result of a program on a pair; its folder is created."""
        folder = self.args.work / pair.name
        folder.mkdir(exist_ok=True)
        return folder / (name.replace(", ", "-").replace(" ", "-").lower() + ".obj")

    def measure_clean_meshes(self, pairs):
        """Motion of clean meshes by programs without tuning, in mean edges."""
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
                except (Failure, ValueError) as error:
                    self.add_note(f"{program} on {name}: {error}")
        return moved


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--adwave", type=Path, required=True, help="the command")
    parser.add_argument("--steps", type=Path, required=True, help="the program denoise_case")
    parser.add_argument("--models", type=Path, required=True, help="folder that contains pairs, at any depth")
    parser.add_argument("--work", type=Path, required=True, help="folder in which meshes and pictures are kept")
    parser.add_argument("--docs", type=Path, required=True, help="folder with DENOISING.md")
    parser.add_argument("--pairs", help="only pairs whose name contains this word; prints the result")
    args = parser.parse_args()
    bench, start = Bench(args), time.monotonic()
    published = [*bench.published_pairs()]
    pairs = [*published, *bench.synthetic_pairs()]
    if args.pairs:
        pairs = [pair for pair in pairs if args.pairs in pair.name]
    results = {"given": [pair.name for pair in published], "pairs": {}, "clean": {}, "times": {}}
    for pair in pairs:
        print(pair.name, flush=True)
        results["pairs"][pair.name] = programs = bench.measure_pair(pair)
        print("  " + ", ".join(f"{name} {m['angle']:.2f}°" for name, m in programs.items() if "angle" in m), flush=True)
        (args.work / "measured.json").write_text(json.dumps(results, indent=1))
    if not args.pairs:
        results["clean"] = bench.measure_clean_meshes(pairs)
        results["times"] = timing.measure(bench)
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
