"""Part `gaze`: agreement of saliency maps with fixations, by vertex and by area, on the meshes given and on even ones."""

import numpy as np

from adwave import Failure
from closest import Surface
from page import table

FIELD = "gaze"
# A vertex was looked at when its fixation is above this, as in `adwave evaluate`.
THRESHOLD = 0.0
TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "int": "<i4", "uint": "<u4"}
DENSITY = "density of vertices"
PLACES = {"as given": "mesh as given", "isotropic": "isotropic remeshing"}
WEIGHTS = ("by vertex", "by area")


def auc(values, positive, weights):
    """The share of weighted pairs, looked at and not, that the map puts the right way round; equal values count half."""
    order = np.argsort(values, kind="stable")
    _, group = np.unique(values[order], return_inverse=True)
    yes = np.bincount(group, (weights * positive)[order])
    no = np.bincount(group, (weights * ~positive)[order])
    below = np.concatenate([[0], np.cumsum(no)[:-1]])
    return float((yes * (below + no / 2)).sum() / (yes.sum() * no.sum()))


def correlation(a, b, weights):
    centered = [v - np.average(v, weights=weights) for v in (a, b)]
    moment = lambda u, v: np.average(u * v, weights=weights)
    return float(moment(*centered) / np.sqrt(moment(centered[0], centered[0]) * moment(centered[1], centered[1])))


def scores(values, fixations, areas):
    """AUC and correlation by vertex, then by area, where both are known."""
    known = np.isfinite(values) & np.isfinite(fixations)
    values, fixations = values[known], fixations[known]
    return [f(values, g, w) for w in (np.ones(known.sum()), areas[known])
            for f, g in ((auc, fixations > THRESHOLD), (correlation, fixations))]


def fixations_of(file):
    """The field of the vertices of a binary PLY file, or None where it has none."""
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
    fields = {file: fixations_of(file) for file in sorted(bench.args.fixations.rglob("*.ply"))}
    fields = {file: fixations for file, fixations in fields.items() if fixations is not None}
    if not fields:
        bench.note(f"no PLY file with a field {FIELD} below the folder of fixations: no agreement with them")
    found = {}
    for file, fixations in fields.items():
        print(f"  {file.stem}", flush=True)
        given = bench.meshings.original(f"gaze-{file.stem}", file)
        if len(fixations) != len(given.points):
            bench.note(f"{file.name} is left out: it has vertices that no triangle uses")
            continue
        even = bench.meshings.isotropic(given)
        lengths = bench.adwave.default_lengths(given)
        of = found[file.stem] = {}
        carried = Surface(given).closest(even.points).nearest(fixations)
        for place, mesh, seconds in (("as given", given, fixations), ("isotropic", even, carried)):
            for operator in bench.adwave.operators:
                try:
                    values = bench.adwave.saliency(mesh, lengths, operator)
                    of[f"{place}/{operator}"] = scores(values, seconds, mesh.vertex_areas)
                except Failure as failure:
                    bench.note(str(failure))
            of[f"{place}/{DENSITY}"] = scores(-mesh.spacing(), seconds, mesh.vertex_areas)
    return found


def text(found):
    if not found:
        return "Not measured: no meshes with fixations."
    keys = [key for key in next(iter(found.values())) if all(key in of for of in found.values())]
    head = [f"{score} {weight}" for weight in WEIGHTS for score in ("AUC", "correlation")]
    label = lambda key: [PLACES[key.partition("/")[0]], key.partition("/")[2]]
    signed = lambda x: f"{x:.3f}".replace("-", "−")
    means = [[*label(key), *(signed(x) for x in np.mean([of[key] for of in found.values()], axis=0))] for key in keys]
    each = [[name, *(" / ".join(signed(of[key][k]) for k in (0, 2)) for key in keys)] for name, of in found.items()]
    return "\n\n".join([
        f"{len(found)} meshes of an eye-tracking study (Fandos 2022). Means over the meshes:",
        table(["on", "map", *head], means),
        "AUC by vertex / by area, mesh by mesh:",
        table(["mesh", *(", ".join(label(key)) for key in keys)], each)])
