"""The measured part of docs/DENOISING.md: tables of angles, clean meshes, times, and every pair in full."""

from statistics import median

import page

OURS = "adwave"
PACKAGES = ("numpy", "scipy", "pymeshlab", "meshlib")
UNTUNED = (OURS, "bilateral", "guided", "MeshLib", "MeshLab two-step", "MeshLab Taubin", "windowed sinc")
TUNED = ("bilateral, tuned", "guided, tuned", "windowed sinc, tuned")
PROGRAMS = ("noisy", *UNTUNED, *TUNED, "learned")
# Rows that are no program that competes: the input, and a method trained on such noise.
NOT_COMPETING = ("noisy", "learned")
# Shorter names for the heads of wide tables.
HEADS = {"MeshLab two-step": "two-step", "MeshLab Taubin": "Taubin", "windowed sinc": "sinc",
         "windowed sinc, tuned": "sinc, tuned"}


def format_measure(measures, key, form):
    """One measure of a program, or a dash if it was not measured."""
    value = (measures or {}).get(key)
    return "–" if value is None else form(value)


def format_angle(value):
    return f"{value:.2f}"


def groups_of_pairs(pairs, published):
    """Names of the published pairs and of those with synthetic noise, with the title of each group."""
    return (("published", [name for name in published if name in pairs]),
            ("synthetic", [name for name in pairs if name not in published]))


def angle_table(pairs, published, columns):
    """Mean angles of some programs on all pairs, and their means over both groups; the best program of a pair is bold."""
    columns = [c for c in columns if any(c in programs for programs in pairs.values())]
    rows = []
    for name, programs in pairs.items():
        best = min(m["angle"] for c, m in programs.items() if c not in NOT_COMPETING and "angle" in m)

        def cell(column):
            is_best = column not in NOT_COMPETING and programs.get(column, {}).get("angle") == best
            return format_measure(programs.get(column), "angle",
                                  lambda v: f"**{format_angle(v)}**" if is_best else format_angle(v))

        rows.append([name, *map(cell, columns)])
    for kind, names in groups_of_pairs(pairs, published):
        part = [pairs[name] for name in names]

        def mean(column):
            angles = [programs.get(column, {}).get("angle") for programs in part]
            return "–" if None in angles else format_angle(sum(angles) / len(angles))

        rows += [[f"mean, {kind}", *map(mean, columns)]] if part else []
    return page.table(["pair", *(HEADS.get(c, c) for c in columns)], rows, numbers=True)


def verdicts(pairs, published):
    """Sentences that compare ours with the best tuned program, group by group, and with the learned method."""
    lines = []
    for kind, names in groups_of_pairs(pairs, published):
        ratios = {}
        for name in names:
            programs = pairs[name]
            rivals = {c: programs[c]["angle"] for c in TUNED if "angle" in programs.get(c, {})}
            if rivals and "angle" in programs.get(OURS, {}):
                best = min(rivals, key=rivals.get)
                ratios[name] = (programs[OURS]["angle"] / rivals[best], best)
        if ratios:
            worst = max(ratios, key=lambda name: ratios[name][0])
            wins = sum(ratio <= 1 for ratio, _ in ratios.values())
            lines.append(f"{kind.capitalize()} pairs: without tuning, adwave is at least as good as the best program that was "
                         f"tuned on the clean mesh on {wins} of {len(ratios)}; at worst its angle is {ratios[worst][0]:.2f} "
                         f"times as large ({worst}, {ratios[worst][1]}).")
    for name, programs in pairs.items():
        if "learned" in programs and "angle" in programs.get(OURS, {}):
            ratio = programs[OURS]["angle"] / programs["learned"]["angle"]
            lines.append(f"{name}: {ratio:.2f} times the angle of the learned method (trained on such noise).")
    return page.bullets(lines)


def pair_section(name, programs):
    """All measures of all programs on one pair."""
    rows = []
    for program in PROGRAMS:
        m = programs.get(program)
        if m is None:
            continue
        if "failed" in m:
            rows.append([program, m["failed"], *["–"] * 7])
            continue
        label = f"{program} ({m['settings']})" if "settings" in m else program
        lengths = (format_measure(m, k, lambda v: f"{v:.3f}") for k in ("to_clean", "from_clean", "moved"))
        rows.append([label, format_angle(m["angle"]), *lengths, m["flipped"],
                     format_measure(m, "volume", lambda v: f"{100 * v:+.2f}"),
                     format_measure(m, "seconds", lambda v: f"{v:.2f}"),
                     format_measure(m, "peak", lambda v: f"{v / 1e6:.0f}")])
    head = ["", "angle, °", "to clean", "from clean", "moved", "flipped", "volume, %", "s", "MB"]
    return f"### {name}\n\n" + page.table(head, rows, numbers=True)


def clean_table(clean):
    """Motion of the vertices and turn of the normals on clean meshes, for programs without tuning."""
    programs = [c for c in PROGRAMS if any(c in measured for measured in clean.values())]
    cell = lambda m: "–" if m is None else f"{m['moved']:.3f}, {m['angle']:.1f}°"
    rows = [[name.removesuffix(", clean"), *(cell(measured.get(p)) for p in programs)] for name, measured in clean.items()]
    return page.table(["mesh", *(HEADS.get(p, p) for p in programs)], rows, numbers=True)


def timing_tables(timings):
    """For each number of vertices: the median and fastest turn of each program, and its time relative to ours."""
    parts = []
    for n_vertices, programs in timings.items():
        ours, rows = programs.get(f"{OURS}, PLY", {}).get("seconds", []), []
        for name, line in programs.items():
            seconds = line["seconds"]
            ratio = median(a / b for a, b in zip(seconds, ours)) if ours else float("nan")
            rows.append([name, len(seconds), f"{median(seconds):.2f}", f"{min(seconds):.2f}", f"{ratio:.2f}",
                         f"{line['peak'] / 1e6:.0f}"])
        head = [f"{int(n_vertices):,} vertices", "turns", "median, s", "fastest, s", "times ours", "MB"]
        parts.append(page.table(head, rows, numbers=True))
    return "\n\n".join(parts)


def render(results, machine, timings):
    """The measured part of the page from results, a sentence on the machine, and the tables of times."""
    pairs, published = results["pairs"], results["given"]
    parts = [page.paragraph(machine),
             "## Mean angle of the normals, degrees", verdicts(pairs, published),
             page.paragraph("Programs without tuning. Bold: the smallest angle on the pair, tuned programs included."),
             angle_table(pairs, published, ("noisy", *UNTUNED)),
             "Programs tuned on the clean mesh, and a learned method:",
             angle_table(pairs, published, (OURS, *TUNED, "learned"))]
    if results["clean"]:
        parts += ["## Clean meshes",
                  page.paragraph("Root mean square motion of the vertices in mean edges, and mean turn of the normals, by programs "
                                 "without tuning. A clean mesh should stay as it is."), clean_table(results["clean"])]
    if timings:
        parts += ["## Time and memory",
                  page.paragraph("The creature with noise along the normals (0.3 mean edges). The programs take turns; *times ours* "
                                 "is the median over the turns of the ratio within a turn. Ours is the whole command, from file "
                                 "to file; the others are the call alone, without reading and writing."), timings]
    parts += ["## Pair by pair",
              page.paragraph("Distances are in mean edges of the clean mesh; *moved* is the root mean square distance of "
                             "corresponding vertices. For tuned programs the best settings are in parentheses: width of the range "
                             "weight and rounds, or the pass band.")]
    parts += [pair_section(name, programs) for name, programs in pairs.items()]
    if results["notes"]:
        parts.append("## What was left out\n\n" + page.bullets(dict.fromkeys(results["notes"])))
    return "\n\n".join(part for part in parts if part)


def measured(results):
    """The measured part of the page from the results of a run."""
    machine = f"{page.machine(*PACKAGES)} The whole run took {results['seconds'] / 60:.0f} minutes."
    return render(results, machine, timing_tables(results["times"]))


def write(results, docs):
    """Writes the measured part of DENOISING.md in the folder `docs`."""
    page.write(docs / "DENOISING.md", measured(results))
