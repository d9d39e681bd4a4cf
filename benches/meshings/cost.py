"""Part `cost`: time and memory of both operators at the same lengths, in turns."""

import statistics

from adwave import SURFACE, WALK, Failure
from tables import seconds, table

LEVELS, ROUNDS = 8, 5
# As in docs/PERFORMANCE.md.
ACCURACY = 1e-5
# The shape that is cut into four twice.
LARGE_OF = "bunny"


def measure(bench):
    """The transform of a large even mesh and of the mesh of many sizes, J = 8, σ of the walk's 1 … 128 steps."""
    named = [mesh for mesh in bench.shapes if mesh.name == LARGE_OF]
    large = bench.meshings.subdivided(bench.meshings.subdivided((named or bench.shapes)[0]))
    found = {}
    for mesh in (large, bench.many_sizes):
        step = bench.adwave.run("info", mesh.path, *bench.adwave.chosen(WALK))["sigma"][1]
        lengths = [step * 2 ** (k / 2) for k in range(LEVELS)]
        runs = {operator: [] for operator in bench.adwave.operators}
        print(f"  {mesh.name}", flush=True)
        try:
            for _ in range(ROUNDS):
                for operator, of in runs.items():
                    done = bench.adwave.transform(mesh, lengths, operator, accuracy=ACCURACY)
                    of.append({"bands": done.info["seconds"]["bands"], "diffusion": done.info["seconds"]["diffusion"],
                               "products": done.info.get("products"), "peak": done.peak})
        except Failure as failure:
            bench.note(str(failure))
        found[mesh.name] = {"vertices": len(mesh.points), "runs": {o: r for o, r in runs.items() if len(r) == ROUNDS}}
    return found


def text(found):
    rows = []
    for name, of in found.items():
        medians = {o: statistics.median(r["bands"] for r in runs) for o, runs in of["runs"].items()}
        for operator, runs in of["runs"].items():
            both = lambda key: f"{seconds(min(r[key] for r in runs))} / {seconds(statistics.median(r[key] for r in runs))}"
            ratio = f"{medians[SURFACE] / medians[WALK]:.3g}" if operator == SURFACE and WALK in medians else "–"
            products = runs[0]["products"]
            rows.append([name, f"{of['vertices']:,}", operator, both("bands"), ratio, both("diffusion"),
                         "–" if products is None else products, f"{max(r['peak'] or 0 for r in runs) / 1e6:.0f} MB"])
    return (f"All bands of xyz, J = {LEVELS}, σ those of 1, 2, 4 … {2 ** (LEVELS - 1)} steps of the walk, accuracy {ACCURACY:g}; least / median of "
            f"{ROUNDS} whole commands in turns, by their own clock. Memory is that of the whole command, result and file included.\n\n"
            + table(["mesh", "vertices", "operator", "bands", "times the walk", "operator from the mesh", "products", "memory"], rows))
