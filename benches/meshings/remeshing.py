"""Part `remeshing`: bands of two meshings of one surface, compared at the same places."""

import numpy as np

from adwave import Failure
from closest import Surface
from page import paragraph, table
from tables import figure

# σ in % of the diagonal: W is the band between this length and the one before, the first between 0 and this one.
PERCENT = (0.8, 1.1, 1.6, 2.2, 3.2, 4.5, 6.3)
# σ in mean edges of the first mesh: W is the band between σ/√2 and σ.
EDGES = (2, 4, 8, 12)
# Surfaces that differ by less than this, in mean edges, differ by rounding only.
ROUNDING = 1e-6
WAYS = ("isotropic", "subdivided", "decimated")


def octave_levels(lengths):
    """Levels σ/√2 and σ for each σ, and the indices of the bands between the two."""
    levels = [length / factor for length in lengths for factor in (2**0.5, 1)]
    return levels, [2 * k + 1 for k in range(len(lengths))]


def schedules(mesh):
    """Two schedules, by diagonal and by mean edge: widths in model units and the indices of the bands that count."""
    yield [p / 100 * mesh.diagonal for p in PERCENT], list(range(len(PERCENT)))
    yield octave_levels([e * mesh.mean_edge for e in EDGES])


def norms(values, areas):
    """The root of the sum of area times square, for each band."""
    return np.sqrt(np.einsum("n,jnd->j", areas, values**2))


def difference(bench, a, b, scale):
    """‖W_A − W_B∘closest‖/‖W_A‖ for each operator, over the vertices of A, weighted by area; and the distance of the surfaces.

    Widths are those of the mesh `scale`. The floor is the same ratio for the motion of the surface:
    ‖W_A[x − closest(x)]‖/‖W_A[x]‖.
    """
    places = Surface(b).closest(a.points)
    apart = a.points - places.interpolated(b.points)
    found = {"vertices": [len(a.points), len(b.points)], "edge": b.mean_edge / a.mean_edge,
             "apart": float(np.sqrt(np.average(places.distances**2, weights=a.vertex_areas)) / a.mean_edge),
             "operators": {}}
    for operator in bench.adwave.operators:
        figures, floors = [], []
        for lengths, counted in schedules(scale):
            try:
                here, there, floor = (
                    bench.adwave.transform(mesh, lengths, operator, field=field).wavelet[counted]
                    for mesh, field in ((a, None), (b, None), (a, apart)))
            except Failure as failure:
                bench.add_note(str(failure))
                figures += [None] * len(counted)
                floors += [None] * len(counted)
                continue
            size = norms(here, a.vertex_areas)
            other = np.stack([places.interpolated(w) for w in there])
            figures += (norms(here - other, a.vertex_areas) / size).tolist()
            floors += (norms(floor, a.vertex_areas) / size).tolist()
        found["operators"][operator] = {"figures": figures, "floors": floors}
    return found


def measure(bench):
    """Isotropic, subdivided and decimated meshings of each shape, and a mesh of many sizes with its isotropic remeshing."""
    found = {way: {} for way in WAYS}
    for mesh in bench.shapes:
        for way in WAYS:
            print(f"  {mesh.name}, {way}", flush=True)
            found[way][mesh.name] = difference(bench, mesh, getattr(bench.meshings, way)(mesh), mesh)
    many = bench.many_sizes
    regular = bench.meshings.isotropic(many)
    areas = many.triangle_areas
    found["many"] = {"shape": many.name, "ratio": float(areas.max() / areas.min()),
                     "most": float(np.quantile(areas, 0.999) / np.quantile(areas, 0.001)),
                     "from it": difference(bench, many, regular, many),
                     "from the isotropic one": difference(bench, regular, many, many)}
    return found


HEAD = ["operator", *(f"{p} %" for p in PERCENT), *(f"{e} edges" for e in EDGES)]


def comparison_rows(name, pair):
    """A row for each operator, and the floor by the last of them if the surfaces differ."""
    rows = [[name, operator, *map(figure, found["figures"])] for operator, found in pair["operators"].items()]
    last = list(pair["operators"].values())[-1]
    return rows if pair["apart"] < ROUNDING else rows + [[name, "*floor*", *map(figure, last["floors"])]]


def mean_rows(way, pairs):
    """The means over the shapes, for each operator."""
    operators = next(iter(pairs.values()))["operators"]
    columns = {o: zip(*(p["operators"][o]["figures"] for p in pairs.values())) for o in operators}
    mean = lambda values: None if None in values else sum(values) / len(values)
    return [[way, operator, *(figure(mean(c)) for c in column)] for operator, column in columns.items()]


def text(found):
    """The section of the page."""
    titles = {
        "isotropic": "Isotropic remeshing, the same mean edge",
        "subdivided": "Every triangle cut into four",
        "decimated": "Decimated to half the triangles",
    }
    many = found["many"]
    many_rows = [row for side in ("from it", "from the isotropic one") for row in comparison_rows(side, many[side])]
    means = [row for way in titles for row in mean_rows(way, found[way])]
    parts = ["Means over the shapes:", table(["meshing", *HEAD], means)]
    for way, title in titles.items():
        rows = [row for name, pair in found[way].items() for row in comparison_rows(name, pair)]
        sizes = ", ".join(f"{name} {p['vertices'][0]:,} → {p['vertices'][1]:,} ({p['apart']:.3f})" for name, p in found[way].items())
        parts += [f"### {title}",
                  paragraph("Vertices, with the distance between the surfaces in parentheses (root mean square, in mean edges): "
                            f"{sizes}."),
                  table(["shape", *HEAD], rows)]
    here = many["from it"]
    parts += ["### Triangles of many sizes",
              paragraph(f"{many['shape']}: {here['vertices'][0]:,} vertices; the largest triangle has {many['ratio']:,.0f} times the area of "
                        f"the smallest (the 99.9th percentile {many['most']:,.0f} times the 0.1th). It is compared with its isotropic "
                        f"remeshing of {here['vertices'][1]:,} vertices ({here['apart']:.3f} mean edges apart). The difference is relative "
                        "to the bands of the mesh from which it is measured."),
              table(["measured", *HEAD], many_rows)]
    return "\n\n".join(parts)
