"""Part `cost`: time and memory of both operators at the same lengths, in turns."""

import statistics

from adwave import SURFACE, WALK, Failure
from page import bullets, paragraph, table
from tables import figure, seconds

LEVELS, ROUNDS = 8, 5
# The default, and the accuracy of docs/PERFORMANCE.md.
ACCURACIES = (1e-10, 1e-5)
# The shape whose triangles are cut into four twice.
LARGE_SOURCE = "bunny"
# Ratios above this are named in the text.
LARGE_RATIO = 2.0


def measure(bench):
    """Bands of each shape, of a large mesh and of the mesh of many sizes: J = 8, σ of 1 … 128 steps of the walk."""
    named = [mesh for mesh in bench.shapes if mesh.name == LARGE_SOURCE]
    large = bench.meshings.subdivided(bench.meshings.subdivided((named or bench.shapes)[0]))
    found = {}
    for mesh in (*bench.shapes, bench.many_sizes, large):
        step = bench.adwave.run("info", mesh.path, *bench.adwave.operator_option(WALK))["sigma"][1]
        lengths = [step * 2 ** (k / 2) for k in range(LEVELS)]
        print(f"  {mesh.name}", flush=True)
        entry = found[mesh.name] = {"vertices": len(mesh.points), "operators": {o: {} for o in bench.adwave.operators}}
        for accuracy in ACCURACIES:
            runs = {operator: [] for operator in bench.adwave.operators}
            try:
                for _ in range(ROUNDS):
                    for operator, finished in runs.items():
                        finished.append(run_once(bench, mesh, lengths, operator, accuracy))
            except Failure as failure:
                bench.add_note(str(failure))
            for operator, finished in runs.items():
                if len(finished) == ROUNDS:
                    entry["operators"][operator][str(accuracy)] = finished
    return found


def run_once(bench, mesh, lengths, operator, accuracy):
    """Seconds of the bands and of the operator, number of products and peak memory in bytes of one command."""
    result = bench.adwave.transform(mesh, lengths, operator, accuracy=accuracy)
    clock = result.info["seconds"]
    return {"bands": clock["bands"], "diffusion": clock["diffusion"], "products": result.info.get("products"),
            "peak": result.peak}


def least(runs, key):
    return min(run[key] for run in runs)


def least_and_median(runs, key):
    """The least and the median of a time, as the page prints them."""
    return f"{seconds(least(runs, key))} / {seconds(statistics.median(run[key] for run in runs))}"


def ratios(entry):
    """Times of `surface` relative to the walk: bands at each accuracy, then preparation; None if not measured."""
    walk, surface = (entry["operators"].get(operator, {}) for operator in (WALK, SURFACE))
    pairs = [(walk[a], surface[a]) if a in walk and a in surface else None for a in map(str, ACCURACIES)]
    times = lambda pair, key: None if pair is None else least(pair[1], key) / least(pair[0], key)
    return [*(times(pair, "bands") for pair in pairs), times(pairs[-1], "diffusion")]


def text(found):
    """The section of the page."""
    bands_rows, operator_rows = [], []
    for name, entry in found.items():
        for operator, by_accuracy in entry["operators"].items():
            if len(by_accuracy) < len(ACCURACIES):
                continue
            runs = [by_accuracy[str(a)] for a in ACCURACIES]
            *times, prepared = map(figure, ratios(entry) if operator == SURFACE else [None] * (len(ACCURACIES) + 1))
            cells = [cell for r, ratio in zip(runs, times)
                     for cell in (least_and_median(r, "bands"), ratio, r[0]["products"] or "–")]
            peak = max(run["peak"] or 0 for run in runs[-1])
            bands_rows.append([name, f"{entry['vertices']:,}", operator, *cells])
            operator_rows.append([name, operator, least_and_median(runs[-1], "diffusion"), prepared, f"{peak / 1e6:.0f} MB"])
    heads = [head for a in ACCURACIES for head in (f"{a:g}", "× walk", "products")]
    lines = []
    for k, a in enumerate(ACCURACIES):
        slow = [(ratios(entry)[k], name) for name, entry in found.items() if (ratios(entry)[k] or 0) > LARGE_RATIO]
        names = ", ".join(f"{name} ({figure(ratio)})" for ratio, name in sorted(slow, reverse=True))
        lines.append(f"Accuracy {a:g}: bands by `surface` take more than {LARGE_RATIO:g} times as long as by the walk on "
                     f"{names or 'no shape'}.")
    has_surface = any(SURFACE in entry["operators"] for entry in found.values())
    return "\n\n".join([
        paragraph(f"All bands of xyz, J = {LEVELS}, with σ of 1, 2, 4 … {2 ** (LEVELS - 1)} steps of the walk. Times are least / median of "
                  f"{ROUNDS} whole commands in turns, by their own clock; ratios are those of the least times."),
        *([bullets(lines)] if has_surface else []),
        "Bands, by accuracy:",
        table(["mesh", "vertices", "operator", *heads], bands_rows),
        paragraph("Preparing the operator from a mesh in memory, and the peak memory of the whole command with result and file:"),
        table(["mesh", "operator", "prepared in", "× walk", "memory"], operator_rows)])
