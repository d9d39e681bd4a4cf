"""Part `cost`: time and memory of both operators at the same lengths, in turns."""

import statistics

from adwave import SURFACE, WALK, Failure
from page import table
from tables import figure, seconds

LEVELS, ROUNDS = 8, 5
# The default, and that of docs/PERFORMANCE.md.
ACCURACIES = (1e-10, 1e-5)
# The shape that is cut into four twice.
LARGE_OF = "bunny"
# Ratios above this are named in the text.
MUCH = 2.0


def measure(bench):
    """The transform of each shape, of a large even mesh and of the mesh of many sizes, J = 8, σ of the walk's 1 … 128 steps."""
    named = [mesh for mesh in bench.shapes if mesh.name == LARGE_OF]
    large = bench.meshings.subdivided(bench.meshings.subdivided((named or bench.shapes)[0]))
    found = {}
    for mesh in (*bench.shapes, bench.many_sizes, large):
        step = bench.adwave.run("info", mesh.path, *bench.adwave.chosen(WALK))["sigma"][1]
        lengths = [step * 2 ** (k / 2) for k in range(LEVELS)]
        print(f"  {mesh.name}", flush=True)
        of = found[mesh.name] = {"vertices": len(mesh.points), "operators": {o: {} for o in bench.adwave.operators}}
        for accuracy in ACCURACIES:
            runs = {operator: [] for operator in bench.adwave.operators}
            try:
                for _ in range(ROUNDS):
                    for operator, done in runs.items():
                        done.append(one(bench, mesh, lengths, operator, accuracy))
            except Failure as failure:
                bench.note(str(failure))
            for operator, done in runs.items():
                if len(done) == ROUNDS:
                    of["operators"][operator][str(accuracy)] = done
    return found


def one(bench, mesh, lengths, operator, accuracy):
    done = bench.adwave.transform(mesh, lengths, operator, accuracy=accuracy)
    clock = done.info["seconds"]
    return {"bands": clock["bands"], "diffusion": clock["diffusion"], "products": done.info.get("products"), "peak": done.peak}


def least(runs, key):
    return min(run[key] for run in runs)


def both(runs, key):
    return f"{seconds(least(runs, key))} / {seconds(statistics.median(run[key] for run in runs))}"


def ratios(of):
    """How many times the walk the surface takes: its bands at each accuracy, then its preparation; None where not measured."""
    walk, surface = (of["operators"].get(operator, {}) for operator in (WALK, SURFACE))
    pairs = [(walk[a], surface[a]) if a in walk and a in surface else None for a in map(str, ACCURACIES)]
    times = lambda pair, key: None if pair is None else least(pair[1], key) / least(pair[0], key)
    return [*(times(pair, "bands") for pair in pairs), times(pairs[-1], "diffusion")]


def text(found):
    rows = []
    for name, of in found.items():
        for operator, by_accuracy in of["operators"].items():
            if len(by_accuracy) < len(ACCURACIES):
                continue
            at = [by_accuracy[str(a)] for a in ACCURACIES]
            *times, prepared = map(figure, ratios(of) if operator == SURFACE else [None] * (len(ACCURACIES) + 1))
            bands = [cell for runs, ratio in zip(at, times) for cell in (both(runs, "bands"), ratio, runs[0]["products"] or "–")]
            peak = max(run["peak"] or 0 for run in at[-1])
            rows.append([name, f"{of['vertices']:,}", operator, *bands, both(at[-1], "diffusion"), prepared, f"{peak / 1e6:.0f} MB"])
    heads = [head for a in ACCURACIES for head in (f"bands, {a:g}", "× walk", "products")]
    lines = []
    for k, a in enumerate(ACCURACIES):
        much = [(ratios(of)[k], name) for name, of in found.items() if (ratios(of)[k] or 0) > MUCH]
        said = ", ".join(f"{name} ({figure(ratio)})" for ratio, name in sorted(much, reverse=True))
        lines.append(f"* Accuracy {a:g}, bands of `surface` take more than {MUCH:g} times as long as the walk's on: {said or 'none of them'}.")
    return "\n\n".join([
        f"All bands of xyz, J = {LEVELS}, σ those of 1, 2, 4 … {2 ** (LEVELS - 1)} steps of the walk; least / median of {ROUNDS} whole commands in "
        "turns, by their own clock; ratios are those of the least. *Operator* is what it takes to prepare the operator from a mesh that is "
        "read. Memory is that of the whole command, result and file included.",
        *(["\n".join(lines)] if any(SURFACE in of["operators"] for of in found.values()) else []),
        table(["mesh", "vertices", "by", *heads, "operator", "× walk", "memory"], rows)])
