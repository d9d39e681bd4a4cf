"""The tables of docs/PERFORMANCE.md, between its markers, and the plot of the cost."""

import math
import statistics

import page
import plot
from page import table

# Bytes beyond input and output that a vertex, and each of its channels, may take.
VERTEX_BYTES, CHANNEL_BYTES = 200, 60
# What counts as the same matrices: ten times the drop tolerance, and a fiftieth of the entries.
MOST_DIFFERENCE, MOST_NUMBER = 1e-5, 0.02


def seconds(t):
    for unit, factor in (("s", 1), ("ms", 1e3), ("µs", 1e6)):
        if t * factor >= 0.9995:
            return f"{t * factor:.3g} {unit}"
    return f"{t * 1e9:.3g} ns"


def times(s):
    return f"{seconds(s['min'])} / {seconds(s['median'])}"


def megabytes(b):
    return "–" if b is None else f"{b / 1e6:.0f} MB"


def verdict(reached, wanted):
    if reached >= wanted:
        return "yes"
    return f"**no**: {reached / wanted:.0%} of it"


def ratio_row(work, peer, line, wanted, agreement):
    """One line: times of both, the ratio of the medians and, in brackets, of the minima."""
    if "failed" in line:
        return [work, peer, "–", f"failed: {line['failed']}", "–", f"≥ {wanted}" if wanted else "–", "–", "–"]
    ours, theirs = line["ours"], line["peer"]
    medians, minima = theirs["median"] / ours["median"], theirs["min"] / ours["min"]
    want, reached = ("–", "–") if wanted is None else (f"≥ {wanted}", verdict(medians, wanted))
    return [work, peer, times(ours), times(theirs), f"**{medians:.3g}** ({minima:.3g})", want, reached, agreement]


def agrees(line):
    return line["max_difference"] <= MOST_DIFFERENCE and abs(line["nnz_difference"]) <= MOST_NUMBER


def exponent(value):
    return "0" if value == 0 else f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")


def ratio_table(r):
    rows = []
    labels = {"SciPy": "SciPy `@`", "MKL": "MKL by `sparse_dot_mkl`", "GraphBLAS": "SuiteSparse:GraphBLAS"}
    wanted = {"SciPy": 15, "MKL": 10, "GraphBLAS": 10}
    basis = r["basis"]
    for line in basis["lines"]:
        if "failed" in line:
            agreement = "–"
        else:
            agreement = ("" if agrees(line) else "**they disagree**: ") + (
                         f"entries differ by {exponent(line['max_difference'])} at most, "
                         f"their number by {abs(line['nnz_difference']):.2%} at most")
        kind, double = line["kind"], line["precision"] == "f64"
        rows.append(ratio_row(f"Φ₁ … Φ₆ stored, {basis['n']:,} vertices",
                              labels[kind] + ", threshold, renormalize" + ("" if double else ", single precision"),
                              line, wanted[kind] if double else None, agreement))
    bands = r["bands"]
    work = f"all bands of xyz, J = 8, {bands['n']:,} vertices"
    scipy = bands["SciPy"]
    errors = "–" if "failed" in scipy else f"our W_f(j) err by {exponent(max(scipy['errors']))} at most"
    rows.append(ratio_row(work, "SciPy, 128 products", scipy, 10, errors))
    for backend, label in (("Sequential", "one thread, its default"), ("STDThread", "threads"), ("TBB", "TBB")):
        line = bands[f"VTK {backend}"]
        rows.append(ratio_row("same", f"VTK windowed sinc, 40 iterations ({label})", line, 5, "other weights: not comparable"))
    gsp = bands["PyGSP"]
    theirs = "–" if "failed" in gsp else f"its bands err by {exponent(max(gsp['peer_errors']))} at most"
    rows.append(ratio_row("same", "PyGSP, Chebyshev of order 39, 8 bands", gsp, 40, theirs))
    bound, steps = r["bound"], 2**15
    powers = {k: bound["product"][k] * steps for k in ("min", "median")}
    by_round = [a["product"]["median"] * steps / a["deep"]["median"] for a in bound["rounds"]]
    deep_error = max(max(bound["deep_errors_finer"]), max(bound["deep_errors_powers"]))
    rows.append(ratio_row("same, J = 16", f"our own powers: {steps:,} × one product", {"ours": bound["deep"], "peer": powers},
                          40, f"by round {min(by_round):.3g} … {max(by_round):.3g}; W_f(j) err by {exponent(deep_error)} at most"))
    harmonics = r["harmonics"]
    line = harmonics["line"]
    residual = "–" if "failed" in line else f"another basis; residual of the eigenpairs {exponent(line['peer']['residual'])}"
    rows.append(ratio_row(f"filter of 8 bands, {harmonics['n']:,} vertices", "SciPy `eigsh`, 300 eigenpairs by shift-invert, and filter",
                          line, 500, residual))
    return table(["work", "peer", "adwave, min / median", "peer, min / median", "ratio", "wanted", "reached", "agreement"], rows)


def bound_table(r):
    bound, wavelet = r["bound"], r["wavelet"]
    rounds = bound["rounds"]
    product_bytes, unfused_bytes = rounds[0]["product"]["bytes"], rounds[0]["bands"]["unfused_bytes"]
    product = [product_bytes / a["bandwidth"] / a["product"]["median"] for a in rounds]
    bands = [unfused_bytes / a["bandwidth"] / a["bands"]["median"] for a in rounds]
    both = lambda name: f"{seconds(min(a[name]['min'] for a in rounds))} / {seconds(statistics.median(a[name]['median'] for a in rounds))}"
    reached = lambda parts: f"**{statistics.median(parts):.2f}** ({min(parts):.2f} … {max(parts):.2f})"
    rows = [
        [f"one product, xyz, {bound['n']:,} vertices", both("product"), f"{product_bytes / 1e6:.0f} MB",
         reached(product) + " of the bound", "≥ 0.85", verdict(statistics.median(product), 0.85)],
        ["the whole transform, J = 8, with its sums", both("bands"), f"{unfused_bytes / 1e9:.2f} GB unfused",
         reached(bands) + " times past the bound", "≥ 1.5", verdict(statistics.median(bands), 1.5)],
        [f"one ψ of level 8, {wavelet['n']:,} vertices, 50 vertices", f"{times(wavelet['times'])}, worst {seconds(wavelet['times']['max'])}", "–",
         f"relative difference from 128 products {exponent(wavelet['difference'])}", "≤ 2 ms",
         verdict(2e-3, wavelet["times"]["median"]) + ("" if wavelet["times"]["max"] <= 2e-3 else " (not the worst)")],
    ]
    speeds = [a["bandwidth"] / 1e9 for a in rounds]
    return (f"Bandwidth of `a = b + s·c` on all cores: {min(speeds):.1f} … {max(speeds):.1f} GB/s in {len(rounds)} rounds. Each round is compared "
            "with its own bandwidth; the median of the rounds counts, the range is in brackets.\n\n"
            + table(["work", "adwave, min / median", "bytes", "result", "wanted", "reached"], rows))


def memory_table(r):
    rows = []
    for line in r["memory"]:
        n, c = line["n"], line["channels"]
        limit = VERTEX_BYTES + CHANNEL_BYTES * c
        highest = max(line["counted"], line["seen"] or 0) / n
        rows.append([c, f"{line['counted'] / n:.0f}", "–" if line["seen"] is None else f"{line['seen'] / n:.0f}", f"≤ {limit}",
                     verdict(limit, highest)])
    return table(["channels", "counted by the library, bytes a vertex", "seen by the system", "wanted", "reached"], rows)


def peak_table(r):
    """What each program used at most during its first call beyond what it had, result included."""
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
    """What somebody waits for who has nothing prepared."""
    bands, harmonics, basis = r["bands"], r["harmonics"], r["basis"]
    rows = [
        [f"all bands of xyz, J = 8, {bands['n']:,} vertices", seconds(bands["operator_seconds"]), times(bands["one_call"])],
        [f"filter of 8 bands, {bands['n']:,} vertices", seconds(bands["operator_seconds"]), times(bands["filter"])],
        [f"all bands of xyz, J = 8, {harmonics['n']:,} vertices", seconds(harmonics["operator_seconds"]), times(harmonics["decompose"])],
        [f"filter of 8 bands, {harmonics['n']:,} vertices", seconds(harmonics["operator_seconds"]), times(harmonics["filter"])],
        [f"Φ₁ … Φ₆, {basis['n']:,} vertices, first call", seconds(harmonics["operator_seconds"]), seconds(basis["first_seconds"])],
    ]
    return table(["work", "Φ₁ from the mesh", "one call, min / median"], rows)


def cost_tables(r):
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
    return (f"All eight bands of xyz on a torus; the time grows as n to the power {slope:.2f} from the first line to the last.\n\n"
            + table(["vertices", "min / median", "a vertex", "Φ₁ from the mesh"], by_n)
            + f"\n\nAll bands of xyz on {cost['n']:,} vertices; from J = 14 to J = 20 a level more costs {mean:.2f} times as much "
            + "(√2 = 1.41 for the products alone). Powers are one product times the steps.\n\n"
            + table(["J", "steps", "products", "min / median", "over J − 1", "powers"], rows))


def machine_text(r):
    m, bound = r["machine"], r["bound"]
    caches = ", ".join(f"{k} {v}" for k, v in m["caches"].items())
    packages = ", ".join(f"{k} {v}" for k, v in m["packages"].items())
    return (f"{m['cpu']}, {m['cores']} cores{' of a virtual machine' if m['virtual'] else ''}, vectors "
            f"{', '.join(m['vectors'])}, caches {caches}, {m['memory'] / 2**30:.0f} GiB of memory at {max(a['bandwidth'] for a in bound['rounds']) / 1e9:.0f} GB/s; "
            f"{m['system']}, rustc {m['rustc']}, Python {m['python']}, {packages}. Shape: {r['shape']}.\n\n"
            "Share of the processors that other programs took during each part: "
            + ", ".join(f"{name} {a['foreign']:.1%}" + (f" (best of {a['attempts']} attempts)" if a["attempts"] > 1 else "")
                        for name, a in r["alone"].items()) + ".")


def agreement_text(r):
    basis, bands = r["basis"], r["bands"]
    entries = ", ".join(f"{n / 1e6:.2f}" for n in basis["nnz"])
    lines = [f"* Φ₁ as NumPy builds it for the peers and ours differ by {exponent(max(basis['operator_difference'], bands['operator_difference']))} at most.",
             f"* Φ₁ … Φ₆ have {entries} million entries, {basis['bytes'] / 1e6:.0f} MB."]
    if "errors" in bands["SciPy"]:
        lines.append("* Relative error of W_f(1) … W_f(8) against SciPy's products: " + ", ".join(map(exponent, bands["SciPy"]["errors"])) + ".")
    if "peer_errors" in bands["PyGSP"]:
        lines.append("* The same of PyGSP's bands: " + ", ".join(map(exponent, bands["PyGSP"]["peer_errors"])) + ".")
    bound = r["bound"]
    lines.append(f"* J = 16: at most {exponent(max(bound['deep_errors_finer']))} against the same engine asked for 1e-12 on {bound['n']:,} vertices, "
                 f"at most {exponent(max(bound['deep_errors_powers']))} against 32,768 products on {basis['n']:,}.")
    return "\n".join(lines)


def missed(tables):
    """Every row of the tables that did not reach its goal."""
    rows = [line.strip("| ").split(" | ") for text in tables for line in text.splitlines() if "**no**" in line or "failed: " in line]
    if not rows:
        return "Nothing."
    return "\n".join(f"* {row[0]}, {row[1]}: {next(c for c in row if '**no**' in c or 'failed' in c).replace('**', '')}" for row in rows)


def measured(r):
    ratios, bound, memory = ratio_table(r), bound_table(r), memory_table(r)
    parts = [
        ("Machine", machine_text(r)),
        ("Against others", ratios),
        ("Against the memory's speed, and single wavelets", bound),
        ("Memory beyond input and output", memory),
        ("Goals not reached, programs that failed", missed([ratios, bound, memory])),
        ("Do the answers agree?", agreement_text(r)),
        ("With nothing prepared", waiting_table(r)),
        ("Highest use of memory during the first call, result included", peak_table(r)),
        ("Cost against the number of vertices and of levels", "![cost](performance-cost.svg)\n\n" + cost_tables(r)),
    ]
    return page.sections(parts)


def write(results, docs):
    plot.draw(results["cost"], docs / "performance-cost.svg")
    page.write(docs / "PERFORMANCE.md", measured(results))
