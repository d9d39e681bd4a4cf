"""The measured part of docs/PERFORMANCE.md, and the plot of the cost."""

import math
import statistics

import page
import plot
from page import bullets, paragraph, table

# Bytes beyond input and output that are allowed per vertex, and per vertex and channel.
VERTEX_BYTES, CHANNEL_BYTES = 200, 60
# Matrices agree within ten times the drop tolerance, and within a fiftieth of the number of entries.
MAX_DIFFERENCE, MAX_COUNT_DIFFERENCE = 1e-5, 0.02


def seconds(t):
    """A time with three significant digits, in s, ms, µs or ns."""
    for unit, factor in (("s", 1), ("ms", 1e3), ("µs", 1e6)):
        if t * factor >= 0.9995:
            return f"{t * factor:.3g} {unit}"
    return f"{t * 1e9:.3g} ns"


def times(s):
    """The least and the median of a time."""
    return f"{seconds(s['min'])} / {seconds(s['median'])}"


def megabytes(b):
    """A number of bytes in MB, or a dash for None."""
    return "–" if b is None else f"{b / 1e6:.0f} MB"


def verdict(reached, goal):
    """A value that shall be at least a goal, in words."""
    if reached >= goal:
        return "yes"
    return f"**no**: {reached / goal:.0%} of it"


def ratio_row(work, peer, line, goal, agreement):
    """A comparison: work, peer, times of both, ratio of the medians (and of the minima), goal, verdict, agreement."""
    if "failed" in line:
        return [work, peer, "–", f"failed: {line['failed']}", "–", f"≥ {goal}" if goal else "–", "–", "–"]
    ours, theirs = line["ours"], line["peer"]
    medians, minima = theirs["median"] / ours["median"], theirs["min"] / ours["min"]
    bar, reached = ("–", "–") if goal is None else (f"≥ {goal}", verdict(medians, goal))
    return [work, peer, times(ours), times(theirs), f"**{medians:.3g}** ({minima:.3g})", bar, reached, agreement]


def agrees(line):
    """True if the matrices of both programs agree."""
    return line["max_difference"] <= MAX_DIFFERENCE and abs(line["nnz_difference"]) <= MAX_COUNT_DIFFERENCE


def exponent(value):
    """A number with one significant digit."""
    return "0" if value == 0 else f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")


def ratio_rows(r):
    """All comparisons with other programs, as rows of `ratio_row`."""
    rows = []
    labels = {"SciPy": "SciPy `@`", "MKL": "MKL, `sparse_dot_mkl`", "GraphBLAS": "SuiteSparse:GraphBLAS"}
    goals = {"SciPy": 15, "MKL": 10, "GraphBLAS": 10}
    basis = r["basis"]
    for line in basis["lines"]:
        if "failed" in line:
            agreement = "–"
        else:
            agreement = ("" if agrees(line) else "**the matrices disagree**: ") + (
                         f"entries differ by at most {exponent(line['max_difference'])}, "
                         f"their number by at most {abs(line['nnz_difference']):.2%}")
        kind, double = line["kind"], line["precision"] == "f64"
        rows.append(ratio_row(f"Φ₁ … Φ₆ stored, {basis['n']:,} vertices",
                              labels[kind] + ("" if double else ", single precision"),
                              line, goals[kind] if double else None, agreement))
    bands = r["bands"]
    work = f"all bands of xyz, J = 8, {bands['n']:,} vertices"
    scipy = bands["SciPy"]
    errors = "–" if "failed" in scipy else f"relative error of our W_f(j) at most {exponent(max(scipy['errors']))}"
    rows.append(ratio_row(work, "SciPy, 128 products", scipy, 10, errors))
    for backend, label in (("Sequential", "one thread"), ("STDThread", "threads"), ("TBB", "TBB")):
        line = bands[f"VTK {backend}"]
        rows.append(ratio_row(work, f"VTK windowed sinc, {label}", line, 5, "other weights, not comparable"))
    gsp = bands["PyGSP"]
    theirs = "–" if "failed" in gsp else f"relative error of its bands at most {exponent(max(gsp['peer_errors']))}"
    rows.append(ratio_row(work, "PyGSP, Chebyshev of order 39", gsp, 40, theirs))
    bound, steps = r["bound"], 2**15
    powers = {k: bound["product"][k] * steps for k in ("min", "median")}
    by_round = [a["product"]["median"] * steps / a["deep"]["median"] for a in bound["rounds"]]
    deep_error = max(max(bound["deep_errors_finer"]), max(bound["deep_errors_powers"]))
    rows.append(ratio_row(f"all bands of xyz, J = 16, {bands['n']:,} vertices", f"our own powers: {steps:,} × one product",
                          {"ours": bound["deep"], "peer": powers}, 40,
                          f"ratio by round {min(by_round):.3g} … {max(by_round):.3g}; relative error of W_f(j) at most "
                          f"{exponent(deep_error)}"))
    harmonics = r["harmonics"]
    line = harmonics["line"]
    residual = "–" if "failed" in line else f"another basis; residual of its eigenpairs {exponent(line['peer']['residual'])}"
    rows.append(ratio_row(f"filter of 8 bands, {harmonics['n']:,} vertices", "SciPy `eigsh`, 300 eigenpairs, and filter",
                          line, 500, residual))
    return rows


def ratio_sections(rows):
    """A table for each work, and the agreement of the results below it."""
    parts = []
    for work in dict.fromkeys(row[0] for row in rows):
        part = [row[1:] for row in rows if row[0] == work]
        notes = {}
        for peer, *_, agreement in part:
            if agreement != "–":
                notes.setdefault(agreement, []).append(peer)
        everybody = [row[0] for row in part if row[-1] != "–"]
        heads = ["peer", "adwave", "peer's time", "ratio", "goal", "reached"]
        names = lambda peers: "" if peers == everybody else f" ({'; '.join(peers)})"
        agreements = bullets(f"{agreement[0].upper()}{agreement[1:]}{names(peers)}." for agreement, peers in notes.items())
        parts += [f"### {work[0].upper()}{work[1:]}", table(heads, [row[:-1] for row in part]), agreements]
    return "\n\n".join(part for part in parts if part)


def bound_rows(r):
    """One product and the whole transform relative to the memory's bandwidth, as rows of the page."""
    bound = r["bound"]
    rounds = bound["rounds"]
    product_bytes, unfused_bytes = rounds[0]["product"]["bytes"], rounds[0]["bands"]["unfused_bytes"]
    product = [product_bytes / a["bandwidth"] / a["product"]["median"] for a in rounds]
    bands = [unfused_bytes / a["bandwidth"] / a["bands"]["median"] for a in rounds]
    both = lambda name: (f"{seconds(min(a[name]['min'] for a in rounds))} / "
                         f"{seconds(statistics.median(a[name]['median'] for a in rounds))}")
    reached = lambda parts: f"**{statistics.median(parts):.2f}** ({min(parts):.2f} … {max(parts):.2f})"
    return [
        [f"one product, {bound['n']:,} vertices", both("product"), f"{product_bytes / 1e6:.0f} MB",
         reached(product), "≥ 0.85", verdict(statistics.median(product), 0.85)],
        ["the whole transform, J = 8", both("bands"), f"{unfused_bytes / 1e9:.2f} GB unfused",
         reached(bands), "≥ 1.5", verdict(statistics.median(bands), 1.5)],
    ]


def bound_section(bandwidth, rows):
    """The section on the memory's bandwidth."""
    return "\n\n".join([
        paragraph(f"Bandwidth of `a = b + s·c` on all cores: {bandwidth}. Each round is compared with its own bandwidth; the median of the "
                  "rounds counts, and the range is in parentheses."),
        table(["work", "adwave", "bytes", "bound / time", "goal", "reached"], rows)])


def bandwidth_text(r):
    """The range of the measured bandwidth."""
    rounds = r["bound"]["rounds"]
    speeds = [a["bandwidth"] / 1e9 for a in rounds]
    return f"{min(speeds):.1f} … {max(speeds):.1f} GB/s in {len(rounds)} rounds"


def wavelet_rows(r):
    """The times of single wavelets, as rows of the page."""
    wavelet = r["wavelet"]
    limit = 2e-3
    reached = verdict(limit, wavelet["times"]["median"]) + ("" if wavelet["times"]["max"] <= limit else " (not the worst)")
    return [[f"one ψ of level 8, {wavelet['n']:,} vertices", times(wavelet["times"]), seconds(wavelet["times"]["max"]),
             exponent(wavelet["difference"]), "≤ 2 ms", reached]]


def wavelet_section(rows):
    """The section on single wavelets."""
    return "\n\n".join([
        paragraph("Least and median over 50 vertices, and the worst of them. The difference is relative to 128 products."),
        table(["work", "adwave", "worst", "difference", "goal", "reached"], rows)])


def memory_rows(r):
    """Memory of the transform for each number of channels, as rows of the page."""
    rows = []
    for line in r["memory"]:
        n, c = line["n"], line["channels"]
        limit = VERTEX_BYTES + CHANNEL_BYTES * c
        highest = max(line["counted"], line["seen"] or 0) / n
        rows.append([c, f"{line['counted'] / n:.0f}", "–" if line["seen"] is None else f"{line['seen'] / n:.0f}", f"≤ {limit}",
                     verdict(limit, highest)])
    return rows


def memory_section(rows):
    """The section on the memory of the transform."""
    return "Bytes per vertex:\n\n" + table(["channels", "counted by the library", "seen by the system", "goal", "reached"], rows)


def peak_table(r):
    """Peak memory of each program during its first call, beyond its memory before, result included."""
    rows = []
    basis = r["basis"]
    for line in basis["lines"]:
        if "peer" in line:
            rows.append([f"Φ₁ … Φ₆ stored, {line['precision']}", line["kind"], megabytes(basis["peak"]), megabytes(line["peer"]["peak"])])
    bands = r["bands"]
    for name in ("SciPy", "VTK STDThread", "PyGSP"):
        if "peer" in bands[name]:
            rows.append(["all bands of xyz, J = 8", name, megabytes(bands["first"]["peak"]), megabytes(bands[name]["peer"]["peak"])])
    if "peer" in r["harmonics"]["line"]:
        rows.append(["filter", "SciPy `eigsh`", megabytes(r["harmonics"]["filter"]["peak"]), megabytes(r["harmonics"]["line"]["peer"]["peak"])])
    return table(["work", "peer", "adwave", "peer's"], rows)


def waiting_table(r):
    """Times of one call with nothing prepared."""
    bands, harmonics, basis = r["bands"], r["harmonics"], r["basis"]
    rows = [
        [f"all bands of xyz, J = 8, {bands['n']:,} vertices", seconds(bands["operator_seconds"]), times(bands["one_call"])],
        [f"filter of 8 bands, {bands['n']:,} vertices", seconds(bands["operator_seconds"]), times(bands["filter"])],
        [f"all bands of xyz, J = 8, {harmonics['n']:,} vertices", seconds(harmonics["operator_seconds"]), times(harmonics["decompose"])],
        [f"filter of 8 bands, {harmonics['n']:,} vertices", seconds(harmonics["operator_seconds"]), times(harmonics["filter"])],
        [f"Φ₁ … Φ₆, {basis['n']:,} vertices, first call", seconds(harmonics["operator_seconds"]), seconds(basis["first_seconds"])],
    ]
    return table(["work", "Φ₁ from the mesh", "one call"], rows)


def cost_section(r):
    """The section on the growth of the cost with the shape and with the levels."""
    cost = r["cost"]
    by_n = [[f"{line['n']:,}", times(line), f"{1e9 * line['median'] / line['n']:.0f} ns", seconds(line["operator_seconds"])]
            for line in cost["against_n"]]
    rows, before = [], None
    for line in cost["against_levels"]:
        growth = "–" if before is None else f"{line['median'] / before:.2f}"
        powers = cost["product"]["median"] * 2 ** (line["levels"] - 1)
        rows.append([line["levels"], f"{2 ** (line['levels'] - 1):,}", line["products"], times(line), growth, seconds(powers)])
        before = line["median"]
    deep = [line for line in cost["against_levels"] if line["levels"] in (14, 20)]
    mean = (deep[1]["median"] / deep[0]["median"]) ** (1 / 6)
    first, last = cost["against_n"][0], cost["against_n"][-1]
    slope = math.log(last["median"] / first["median"]) / math.log(last["n"] / first["n"])
    return "\n\n".join([
        "![Time against the number of vertices, and against the number of levels](performance-cost.svg)",
        paragraph(f"All eight bands of xyz on a torus; the time grows as n to the power {slope:.2f} from the first row to the last."),
        table(["vertices", "least / median", "per vertex", "Φ₁ from the mesh"], by_n),
        paragraph(f"All bands of xyz on {cost['n']:,} vertices; from J = 14 to J = 20, each further level multiplies the time by {mean:.2f} "
                  "(√2 = 1.41 for the products alone). Powers are one product times the number of steps."),
        table(["J", "steps", "products", "least / median", "over J − 1", "powers"], rows)])


def machine_section(r):
    """The machine, and the share of its processors that other programs took."""
    m, bound = r["machine"], r["bound"]
    caches = ", ".join(f"{k} {v}" for k, v in m["caches"].items())
    packages = ", ".join(f"{k} {v}" for k, v in m["packages"].items())
    bandwidth = max(a["bandwidth"] for a in bound["rounds"])
    foreign = ", ".join(f"{name} {a['foreign']:.1%}" + (f" (best of {a['attempts']} attempts)" if a["attempts"] > 1 else "")
                        for name, a in r["alone"].items())
    return "\n\n".join([
        paragraph(f"{m['cpu']}, {m['cores']} cores{' of a virtual machine' if m['virtual'] else ''}, vectors {', '.join(m['vectors'])}, "
                  f"caches {caches}, {m['memory'] / 2**30:.0f} GiB of memory at {bandwidth / 1e9:.0f} GB/s; {m['system']}, rustc {m['rustc']}, "
                  f"Python {m['python']}, {packages}. Shape: {r['shape']}."),
        paragraph(f"Share of the processors that other programs took during each part: {foreign}.")])


def agreement_section(r):
    """Differences between the answers of the programs."""
    basis, bands = r["basis"], r["bands"]
    entries = ", ".join(f"{n / 1e6:.2f}" for n in basis["nnz"])
    difference = exponent(max(basis["operator_difference"], bands["operator_difference"]))
    lines = [f"Φ₁ as NumPy builds it for the peers differs from ours by at most {difference}.",
             f"Φ₁ … Φ₆ have {entries} million entries, {basis['bytes'] / 1e6:.0f} MB."]
    if "errors" in bands["SciPy"]:
        lines.append("Relative errors of W_f(1) … W_f(8) against SciPy's products: " + ", ".join(map(exponent, bands["SciPy"]["errors"])) + ".")
    if "peer_errors" in bands["PyGSP"]:
        lines.append("The same for PyGSP's bands: " + ", ".join(map(exponent, bands["PyGSP"]["peer_errors"])) + ".")
    bound = r["bound"]
    lines.append(f"J = 16: at most {exponent(max(bound['deep_errors_finer']))} against the same engine at accuracy 1e-12 on {bound['n']:,} "
                 f"vertices, at most {exponent(max(bound['deep_errors_powers']))} against 32,768 products on {basis['n']:,}.")
    return bullets(lines)


def missed_section(rows):
    """A list of the rows that did not reach their goal or failed."""
    lines = []
    for row in rows:
        problem = next((str(cell) for cell in row if "**no**" in str(cell) or "failed: " in str(cell)), None)
        if problem:
            lines.append(f"{row[0]}, {row[1]}: {problem.replace('**', '')}")
    return bullets(lines) or "All goals were reached."


def render(r):
    """The measured part of the page."""
    ratios, bounds, wavelets, memory = ratio_rows(r), bound_rows(r), wavelet_rows(r), memory_rows(r)
    return page.sections([
        ("Machine", machine_section(r)),
        ("Comparison with other programs", "Times are least / median.\n\n" + ratio_sections(ratios)),
        ("Comparison with the memory's bandwidth", bound_section(bandwidth_text(r), bounds)),
        ("Single wavelets", wavelet_section(wavelets)),
        ("Memory beyond input and output", memory_section(memory)),
        ("Goals that were missed", missed_section([*ratios, *bounds, *wavelets, *memory])),
        ("Agreement of the results", agreement_section(r)),
        ("One call with nothing prepared", waiting_table(r)),
        ("Peak memory during the first call, result included", peak_table(r)),
        ("Cost against the number of vertices and of levels", cost_section(r)),
    ])


def write(results, docs):
    """Writes the plot and the measured part of PERFORMANCE.md in the folder `docs`."""
    plot.draw(results["cost"], docs / "performance-cost.svg")
    page.write(docs / "PERFORMANCE.md", render(results))
