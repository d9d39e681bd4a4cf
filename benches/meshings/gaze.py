"""Part `gaze`: agreement of saliency maps with fixations, by vertex and by area, on given meshes and remeshings."""

import numpy as np

from adwave import Failure
from closest import Surface
from page import paragraph, table

FIELD = "gaze"
# A vertex counts as looked at if its fixation is above this, as in `adwave evaluate`.
THRESHOLD = 0.0
TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "int": "<i4", "uint": "<u4"}
DENSITY = "density"
PLACES = {"as given": "given", "isotropic": "remeshed"}
WEIGHTS = ("by vertex", "by area")


def auc(values, positive, weights):
    """Area under the ROC curve: the weighted share of pairs (looked at, not) in the right order; ties count half."""
    order = np.argsort(values, kind="stable")
    _, group = np.unique(values[order], return_inverse=True)
    yes = np.bincount(group, (weights * positive)[order])
    no = np.bincount(group, (weights * ~positive)[order])
    below = np.concatenate([[0], np.cumsum(no)[:-1]])
    return float((yes * (below + no / 2)).sum() / (yes.sum() * no.sum()))


def correlation(a, b, weights):
    """The weighted linear correlation."""
    centered = [v - np.average(v, weights=weights) for v in (a, b)]
    moment = lambda u, v: np.average(u * v, weights=weights)
    return float(moment(*centered) / np.sqrt(moment(centered[0], centered[0]) * moment(centered[1], centered[1])))


def scores(values, fixations, areas):
    """AUC and correlation by vertex, then by area, over vertices at which both values are known."""
    known = np.isfinite(values) & np.isfinite(fixations)
    values, fixations = values[known], fixations[known]
    return [f(values, g, w) for w in (np.ones(known.sum()), areas[known])
            for f, g in ((auc, fixations > THRESHOLD), (correlation, fixations))]


def read_fixations(file):
    """The field of fixations of a binary PLY file, one value per vertex, or None if it has none."""
    header, end, body = file.read_bytes().partition(b"end_header\n")
    lines = [line.split() for line in header.decode(errors="replace").splitlines()]
    elements = [k for k, words in enumerate(lines) if words[:1] == ["element"]]
    if not elements or ["format", "binary_little_endian", "1.0"] not in lines:
        return None
    vertex = lines[elements[0]:(elements + [len(lines)])[1]]
    row = [(words[2], TYPES.get(words[1])) for words in vertex[1:] if words[0] == "property"]
    if (FIELD not in dict(row)) or vertex[0][1] != "vertex":
        return None
    return np.frombuffer(body, row, int(vertex[0][2]))[FIELD].astype(float)


def measure(bench):
    """Maps of both operators and the density of vertices; fixations are carried over by the closest point."""
    fields = {file: read_fixations(file) for file in sorted(bench.args.fixations.rglob("*.ply"))}
    fields = {file: fixations for file, fixations in fields.items() if fixations is not None}
    if not fields:
        bench.add_note(f"the folder of fixations contains no PLY file with a field {FIELD}")
    found = {}
    for file, fixations in fields.items():
        print(f"  {file.stem}", flush=True)
        given = bench.meshings.original(f"gaze-{file.stem}", file)
        if len(fixations) != len(given.points):
            bench.add_note(f"{file.name} is left out: no triangle uses some of its vertices")
            continue
        even = bench.meshings.isotropic(given)
        lengths = bench.adwave.default_lengths(given)
        entry = found[file.stem] = {}
        carried = Surface(given).closest(even.points).nearest(fixations)
        for place, mesh, seconds in (("as given", given, fixations), ("isotropic", even, carried)):
            for operator in bench.adwave.operators:
                try:
                    values = bench.adwave.saliency(mesh, lengths, operator)
                    entry[f"{place}/{operator}"] = scores(values, seconds, mesh.vertex_areas)
                except Failure as failure:
                    bench.add_note(str(failure))
            entry[f"{place}/{DENSITY}"] = scores(-mesh.spacing(), seconds, mesh.vertex_areas)
    return found


def text(found):
    """The section of the page."""
    if not found:
        return "Not measured: no meshes with fixations."
    keys = [key for key in next(iter(found.values())) if all(key in entry for entry in found.values())]
    head = [f"{score} {weight}" for weight in WEIGHTS for score in ("AUC", "correlation")]
    label = lambda key: [PLACES[key.partition("/")[0]], key.partition("/")[2]]
    signed = lambda x: f"{x:.3f}".replace("-", "−")
    means = [[*label(key), *(signed(x) for x in np.mean([entry[key] for entry in found.values()], axis=0))] for key in keys]
    each = [[name, *(" / ".join(signed(entry[key][k]) for k in (0, 2)) for key in keys)] for name, entry in found.items()]
    return "\n\n".join([
        paragraph(f"{len(found)} meshes of an eye-tracking study (Fandos 2022), as given and remeshed isotropically. The control is the "
                  "density of vertices. Means over the meshes:"),
        table(["mesh", "map", *head], means),
        "AUC by vertex / by area, mesh by mesh:",
        table(["mesh", *(", ".join(label(key)) for key in keys)], each)])
