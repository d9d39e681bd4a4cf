"""The tables of docs/DENOISING.md, between its markers."""

from statistics import median

import page

OURS = "adwave"
PACKAGES = ("numpy", "scipy", "pymeshlab", "meshlib")
TUNED = ("bilateral, tuned", "guided, tuned", "windowed sinc, tuned")
COLUMNS = ("noisy", OURS, "bilateral", "guided", "MeshLib", "MeshLab two-step", "MeshLab Taubin", "windowed sinc", *TUNED, "learned")


def table(head, rows):
    return page.table(head, rows, numbers=True)


def shown(measures, key, form):
    value = (measures or {}).get(key)
    return "–" if value is None else form(value)


def angle(value):
    return f"{value:.2f}"


def summary(pairs, given):
    """Mean angles, all programs on all pairs, and their means over the published pairs and over ours."""
    columns = [c for c in COLUMNS if any(c in of for of in pairs.values())]
    rows = []
    for name, of in pairs.items():
        known = [of[c]["angle"] for c in columns if c not in ("noisy", "learned") and "angle" in of.get(c, {})]
        mark = lambda c: (lambda v: f"**{angle(v)}**" if c not in ("noisy", "learned") and v == min(known) else angle(v))
        rows.append([name, *(shown(of.get(c), "angle", mark(c)) for c in columns)])
    for kind, names in (("published", given), ("with our noise", [name for name in pairs if name not in given])):
        part = [pairs[name] for name in names if name in pairs]
        mean = lambda c: angle(sum(of[c]["angle"] for of in part) / len(part)) if all("angle" in of.get(c, {}) for of in part) else "–"
        rows += [[f"mean, {kind}", *map(mean, columns)]] if part else []
    return table(["pair", *columns], rows)


def verdict(pairs, given):
    """Ours beside the best tuned rival, pair by pair, and beside the learned method."""
    lines = []
    for kind, names in (("published", given), ("with our noise", [name for name in pairs if name not in given])):
        against = {}
        for name in names:
            of = pairs.get(name, {})
            rivals = {c: of[c]["angle"] for c in TUNED if "angle" in of.get(c, {})}
            if rivals and "angle" in of.get(OURS, {}):
                best = min(rivals, key=rivals.get)
                against[name] = (of[OURS]["angle"] / rivals[best], best)
        if against:
            worst = max(against, key=lambda name: against[name][0])
            wins = sum(ratio <= 1 for ratio, _ in against.values())
            lines.append(f"* Pairs {kind}: without knobs adwave is at least as good as the best rival that was tuned on the clean mesh on "
                         f"{wins} of {len(against)}; at worst its angle is {against[worst][0]:.2f} times as large ({worst}, {against[worst][1]}).")
    for name, of in pairs.items():
        if "learned" in of and "angle" in of.get(OURS, {}):
            ratio = of[OURS]["angle"] / of["learned"]["angle"]
            lines.append(f"* {name}: {ratio:.2f} times the angle of the learned method (trained on such noise).")
    return "\n".join(lines)


def of_pair(name, of):
    rows = []
    for program in COLUMNS:
        m = of.get(program)
        if m is None:
            continue
        if "failed" in m:
            rows.append([program, m["failed"], *["–"] * 7])
            continue
        label = f"{program} ({m['settings']})" if "settings" in m else program
        rows.append([label, angle(m["angle"]), *(shown(m, k, lambda v: f"{v:.3f}") for k in ("to_clean", "from_clean", "moved")),
                     m["flipped"], shown(m, "volume", lambda v: f"{100 * v:+.2f}"), shown(m, "seconds", lambda v: f"{v:.2f}"),
                     shown(m, "peak", lambda v: f"{v / 1e6:.0f}")])
    return f"### {name}\n\n" + table(["", "angle, °", "to clean", "from clean", "moved", "flipped", "volume, %", "s", "MB"], rows)


def untouched(clean):
    programs = [c for c in COLUMNS if any(c in of for of in clean.values())]
    cell = lambda m: "–" if m is None else f"{m['moved']:.3f} ({m['angle']:.1f}°)"
    return table(["clean mesh", *programs], [[name, *(cell(of.get(p)) for p in programs)] for name, of in clean.items()])


def times(found):
    """Median and fastest turn, and how many times as long as ours the same turn took."""
    parts = []
    for n_vertices, of in found.items():
        ours, rows = of.get(f"{OURS}, PLY", {}).get("seconds", []), []
        for name, line in of.items():
            seconds = line["seconds"]
            ratio = median(a / b for a, b in zip(seconds, ours)) if ours else float("nan")
            rows.append([name, len(seconds), f"{median(seconds):.2f}", f"{min(seconds):.2f}", f"{ratio:.2f}", f"{line['peak'] / 1e6:.0f}"])
        parts.append(table([f"{int(n_vertices):,} vertices", "turns", "median, s", "fastest, s", "times ours", "MB"], rows))
    return "\n\n".join(parts)


def measured(results):
    parts = [f"{page.machine(*PACKAGES)} The whole run took {results['seconds'] / 60:.0f} minutes.",
             "## Mean angle of the normals, degrees\n\n" + summary(results["pairs"], results["given"]), verdict(results["pairs"], results["given"])]
    if results["clean"]:
        parts.append("## Clean meshes\n\nRoot mean square way of the vertices in mean edges, and the mean turn of the normals, by programs "
                     "without knobs: what is no noise should stay.\n\n" + untouched(results["clean"]))
    if results["times"]:
        parts.append("## Time and memory\n\nThe creature with noise along the normals (0.3 mean edges). The programs take turns; *times ours* is the "
                     "median over the turns of the ratio of the same turn. Ours: the whole command, from a file to a file; "
                     "the others: the call alone, reading and writing left out.\n\n" + times(results["times"]))
    parts.append("## Pair by pair\n\nDistances in mean edges of the clean mesh; *moved* is the root mean square distance of "
                 "corresponding vertices. Tuned: the best settings in brackets (width of the range weight and rounds, or the pass band).")
    parts += [of_pair(name, of) for name, of in results["pairs"].items()]
    if results["notes"]:
        parts.append("## What was left out\n\n" + "\n".join(f"* {note}" for note in dict.fromkeys(results["notes"])))
    return "\n\n".join(part for part in parts if part)


def write(results, docs):
    page.write(docs / "DENOISING.md", measured(results))
