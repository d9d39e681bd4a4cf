"""Measures the dependence of bands on the mesh instead of the surface, operator by operator, and writes docs/MESHINGS.md.

`cargo xtask bench-meshings` runs it in an environment of its own. `--only PART` prints one part and writes no document.
"""

import argparse
import json
import shutil
import sys
import time
from functools import cached_property
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent.parent))  # modules shared by all comparisons

import cloud  # noqa: E402
import cost  # noqa: E402
import features  # noqa: E402
import gaze  # noqa: E402
import pictures  # noqa: E402
import remeshing  # noqa: E402
import report  # noqa: E402
import scipy_peer  # noqa: E402
from adwave import Adwave  # noqa: E402
from meshings import Meshings  # noqa: E402

MODELS = {"armadillo": "armadillo.obj", "kitten": "kitten.obj", "horse": "horse.ply", "dinosaur": "dinosaur.obj",
          "skull": "skull.off", "face": "face.obj", "bunny": "stanford-bunny.obj", "fandisk": "fandisk.obj"}
# Built-in shapes that replace the models if none is found.
SAMPLES = {"creature": 30000, "knot": 20000, "torus": 20000, "sphere": 10000}
# Sources of the mesh with triangles of many sizes: one of the models, one of the samples.
MANY_SIZES_SOURCES = ("kitten", "knot")

PARTS = {"remeshing": remeshing, "cloud": cloud, "features": features, "scipy": scipy_peer, "cost": cost, "gaze": gaze,
         "pictures": pictures}


class Bench:
    """The command, the shapes, their other meshings, and notes on failures."""

    def __init__(self, args):
        self.args, self.notes = args, []
        self.adwave = Adwave(args.adwave, args.work / "scratch")
        self.meshings = Meshings(args.work)

    def add_note(self, text):
        """Prints and keeps a note, once."""
        if text not in self.notes:
            print(f"  {text}")
            self.notes.append(text)

    @cached_property
    def shapes(self):
        """The models that were found, or the built-in shapes."""
        found = []
        for name, file in MODELS.items():
            paths = sorted(self.args.models.rglob(file)) if self.args.models.is_dir() else []
            if paths:
                found.append(self.meshings.original(name, paths[0]))
            else:
                self.add_note(f"{name} is left out: the folder of models contains no {file}")
        if found:
            return found
        self.add_note("built-in shapes replace the models")
        return [self.meshings.original(name, self.adwave.sample(name, n)) for name, n in SAMPLES.items()]

    @cached_property
    def many_sizes(self):
        """The mesh with triangles of many sizes."""
        named = [mesh for mesh in self.shapes if mesh.name in MANY_SIZES_SOURCES]
        return self.meshings.many_sizes((named or self.shapes)[0])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--adwave", type=Path, required=True, help="the command")
    parser.add_argument("--models", type=Path, required=True, help="folder that contains the models, at any depth")
    parser.add_argument("--fixations", type=Path, required=True, help="folder that contains meshes with a field `gaze`, at any depth")
    parser.add_argument("--work", type=Path, required=True, help="folder in which meshings are kept")
    parser.add_argument("--docs", type=Path, required=True, help="folder with MESHINGS.md")
    parser.add_argument("--matrices", type=Path, help="program that writes masses and stiffness of the operator `surface`")
    parser.add_argument("--only", choices=PARTS, help="measure one part and print it")
    args = parser.parse_args()
    bench = Bench(args)
    results = {"seconds": {}}
    for name, part in PARTS.items():
        if args.only in (None, name):
            print(f"{name}: {part.measure.__doc__}", flush=True)
            start = time.monotonic()
            results[name] = part.measure(bench)
            results["seconds"][name] = time.monotonic() - start
            print(f"  {results['seconds'][name]:.0f} s", flush=True)
    results["notes"], results["machine"] = bench.notes, report.machine()
    shutil.rmtree(bench.adwave.work)
    if args.only:
        print(PARTS[args.only].text(results[args.only]))
        return
    (args.work / "measured.json").write_text(json.dumps(results, indent=1))
    report.write(results, PARTS, args.docs)
    print(f"wrote {args.docs / 'MESHINGS.md'}; all figures are in {args.work / 'measured.json'}")


if __name__ == "__main__":
    main()
