"""Part `pictures`: a band on three meshings of a shape by both operators, on one page and one sheet."""

import numpy as np
from PIL import Image

from adwave import SURFACE, WALK, Failure
from closest import Surface
from mesh import write
from picture_page import Block, Panel, Row, page, sheet
from remeshing import norms, octave_levels
from page import paragraph, table
from tables import figure

# σ of the band in mean edges of the first meshing.
EDGES = 4
# The last color is this quantile of |W|, by area, on the first meshing by the last operator.
QUANTILE = 0.98
PIXELS = 760
# Lines between triangles: their width in parts of the diagonal, and its largest share of the radius of the inscribed circle.
LINE, LINE_SHARE = 1 / 900, 0.3
COLORS = "viridis"
# View of a shape by name, and the visible part of the picture: left, top, right, bottom, from 0 to 1.
VIEWS = {"armadillo": ("front", (0.28, 0.02, 0.72, 0.46))}
VIEW = ("three-quarter", (0.0, 0.0, 1.0, 1.0))
WAYS = {"as given": None, "isotropic remeshing": "isotropic", "half the triangles": "decimated"}
HEADS = {WALK: "by the walk", SURFACE: "by the surface's heat"}

TITLE = "The mesh and the surface"
INTRODUCTION = (
    "Each row shows one surface with three sets of triangles. A quantity of the surface should look the same three times.",
    "Colors show the length of the detail W between two widths of smoothing. The walk smooths along the edges of the mesh, "
    "so its details follow the triangles; heat on the surface does not depend on them.",
)
EXPLANATION = ("Details between σ/√2 and σ of {edges} mean edges, with one range of colors for all pictures of the shape. Differences are "
               "shown on the mesh {first}, at the same places, with ‖difference‖/‖W‖ (root of area times square) below.")

# The shape of the picture in the document.
BUILT_IN, BUILT_IN_VERTICES = "knot", 20000


class Pictures:
    """Draws meshings of a shape by `adwave render`, all from the same side."""

    def __init__(self, bench, mesh):
        self.adwave, self.line = bench.adwave, LINE * mesh.diagonal
        self.view, part = VIEWS.get(mesh.name, VIEW)
        self.pixels = round(PIXELS / (part[2] - part[0]))
        self.part = [round(at * self.pixels) for at in part]

    def draw(self, path, values, largest, colors):
        """The picture of values at the vertices of a file's mesh."""
        out = self.adwave.work / "panel.png"
        self.adwave.run("render", path, "-o", out, "--color", self.adwave.field(values), f"--range=0,{float(largest)!r}",
                        "--colormap", colors, "--no-bar", "--transparent", "--view", self.view, "--size", f"{self.pixels}x{self.pixels}")
        with Image.open(out) as picture:
            return picture.convert("RGBA").crop(self.part)

    def band(self, mesh, values, largest):
        """The picture of a band's lengths."""
        return self.draw(mesh.path, values, largest, COLORS)

    def triangles(self, mesh):
        """The picture of the mesh with a line along each edge."""
        points, triangles, brightness = outline_triangles(mesh.points, mesh.triangles, self.line)
        path = self.adwave.work / "outlined.ply"
        write(path, points, triangles, "triangles and their borders")
        return self.draw(path, brightness, 1.0, "gray")


def outline_triangles(points, triangles, width):
    """Points, triangles and brightness of a mesh that shows each triangle bright inside a dark border."""
    corners = points[triangles]
    sides = np.linalg.norm(corners[:, [1, 2, 0]] - corners[:, [2, 0, 1]], axis=2)
    perimeter = np.maximum(sides.sum(axis=1), 1e-300)
    heart = np.einsum("tk,tkd->td", sides, corners) / perimeter[:, None]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    inside = np.maximum(2 * area / perimeter, 1e-300)
    share = np.minimum(width / inside, LINE_SHARE)
    inner = corners + share[:, None, None] * (heart[:, None] - corners)
    n = len(triangles)
    # The corners, the inner corners of the border, and the corners of the bright triangle at the same positions.
    all_points = np.concatenate([corners.reshape(-1, 3), inner.reshape(-1, 3), inner.reshape(-1, 3)])
    outer = np.arange(3 * n).reshape(n, 3)
    a, b = outer, np.roll(outer, -1, axis=1)
    border = [np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, b, b + 3 * n), (a, b + 3 * n, a + 3 * n))]
    return all_points, np.concatenate([*border, outer + 6 * n]), np.repeat([0.25, 0.25, 1.0], 3 * n)


def quantile_by_area(values, areas, share):
    """The value below which a share of the area lies."""
    order = np.argsort(values)
    return values[order][np.searchsorted(np.cumsum(areas[order]), share * areas.sum())]


def compare_meshings(bench, mesh):
    """The numbers of a shape's bands on its meshings, and the block of their pictures."""
    meshes = {way: mesh if make is None else getattr(bench.meshings, make)(mesh) for way, make in WAYS.items()}
    first, *others = meshes
    places = {way: Surface(meshes[way]).closest(mesh.points) for way in others}
    sigma = EDGES * mesh.mean_edge
    levels, counted = octave_levels([sigma])
    bands = {operator: {way: bench.adwave.transform(m, levels, operator).wavelet[counted][0] / sigma for way, m in meshes.items()}
             for operator in bench.adwave.operators}
    length = lambda w: np.linalg.norm(w, axis=1)
    largest = quantile_by_area(length(list(bands.values())[-1][first]), mesh.vertex_areas, QUANTILE)
    pictures, figures = Pictures(bench, mesh), {}
    rows = [Row("The triangles", [Panel(pictures.triangles(m), f"{way}, {len(m.points):,} vertices") for way, m in meshes.items()])]
    for operator, by_way in bands.items():
        size = norms(by_way[first][None], mesh.vertex_areas)
        apart = {way: by_way[first] - places[way].interpolated(by_way[way]) for way in others}
        figures[operator] = {way: float((norms(d[None], mesh.vertex_areas) / size)[0]) for way, d in apart.items()}
        differ = lambda way: f"{way}: differs by {figure(figures[operator][way])}"
        rows += [
            Row(f"Details {HEADS[operator]}", [Panel(pictures.band(m, length(by_way[way]), largest), way) for way, m in meshes.items()]),
            Row(f"Difference from the first, {HEADS[operator]}", [Panel(None, ""), *(Panel(pictures.band(mesh, length(d), largest), differ(way))
                                                               for way, d in apart.items())])]
    numbers = {"shape": mesh.name, "vertices": {way: len(m.points) for way, m in meshes.items()}, "figures": figures}
    return numbers, Block(mesh.name, EXPLANATION.format(edges=EDGES, first=first), rows, float(largest))


def illustration(bench):
    """Writes the picture of the document: triangles and details of a built-in shape."""
    mesh = bench.meshings.many_sizes(bench.meshings.original(BUILT_IN, bench.adwave.sample(BUILT_IN, BUILT_IN_VERTICES)))
    _, block = compare_meshings(bench, mesh)
    block.rows = [row for row in block.rows if row.panels[0].picture is not None]
    folder = bench.args.docs / "meshings"
    folder.mkdir(exist_ok=True)
    sheet([block]).save(folder / f"{BUILT_IN}.jpg", quality=85)


def measure(bench):
    """Pictures of the band at σ of 4 mean edges on three meshings of the mesh of many sizes and of the first shape."""
    found, blocks = [], []
    if bench.args.only is None:
        illustration(bench)
    for mesh in (bench.many_sizes, bench.shapes[0]):
        print(f"  {mesh.name}", flush=True)
        try:
            numbers, block = compare_meshings(bench, mesh)
        except Failure as failure:
            bench.add_note(f"pictures: {failure}")
            continue
        found.append(numbers)
        blocks.append(block)
    if blocks:
        (bench.args.work / "pictures.html").write_text(page(TITLE, INTRODUCTION, blocks))
        sheet(blocks).save(bench.args.work / "pictures.png")
        print(f"  wrote pictures.html and pictures.png to {bench.args.work}")
    return found


def text(found):
    """The section of the page."""
    rows = [[entry["shape"], operator, *(figure(figures[way]) for way in list(WAYS)[1:])]
            for entry in found for operator, figures in entry["figures"].items()]
    return (paragraph(f"Differences of the band at σ = {EDGES} mean edges; after a run the pictures are in `target/meshings/pictures.html`.")
            + "\n\n" + table(["shape", "operator", *list(WAYS)[1:]], rows))
