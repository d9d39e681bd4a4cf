"""Data that `adwave.blender` reads from Blender's meshes, computes and writes back, without the user interface.

A split mesh keeps its original points in the attribute `ORIGINAL`, so that they are saved, copied and undone with it. The
bands computed from them (`Split`) are kept outside of Blender, and computed again if they are missing.
"""

from __future__ import annotations

import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

import adwave
from adwave import _adapt, _native
from adwave._options import Constraints
from adwave._progress import Report

#: Blender does not list names that begin with a dot.
ORIGINAL = ".adwave_original"
#: Linear colors at the ends and in the middle of the scale: concave, flat, convex.
COLORS = ((0.05, 0.13, 0.6), (0.8, 0.8, 0.8), (0.6, 0.03, 0.02))

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]


def raw(mesh: Any, name: str, key: str, width: int, kind: type) -> NDArray[Any]:
    """Numbers of an attribute in one copy; an empty array if the mesh has no such attribute."""
    attribute = mesh.attributes.get(name)
    values = np.zeros((len(attribute.data) if attribute else 0) * width, kind)
    if attribute:
        attribute.data.foreach_get(key, values)
    return values


def points_of(mesh: Any, name: str = "position") -> Singles:
    """Points as Blender stores them: 3·n numbers of single precision."""
    return raw(mesh, name, "vector", 3, np.float32)


def put_points(mesh: Any, points: Singles) -> None:
    """Move the points; nothing else of the mesh changes."""
    mesh.attributes["position"].data.foreach_set("vector", points)
    mesh.update()


def checksum(*arrays: NDArray[Any]) -> str:
    """Short text that changes if an array changes."""
    total = 0
    for array in arrays:
        total = zlib.crc32(array.data, total)
    return f"{total:08x}"


def connections(mesh: Any) -> str:
    """Short text that changes if the faces (or, without faces, the edges) of the mesh change."""
    links = raw(mesh, ".corner_vert", "value", 1, np.int32)
    if not len(links):
        links = raw(mesh, ".edge_verts", "value", 2, np.int32)
    return f"{len(mesh.vertices)} {len(mesh.polygons)} {checksum(links)}"


def shape_of(mesh: Any, points: Singles) -> adwave.Shape:
    """Shape of a mesh: a mesh if it has faces, a graph if it has edges only, otherwise a cloud."""
    if not len(points):
        raise ValueError("the mesh has no vertices")
    places = _adapt.points_array(points.reshape(-1, 3))
    if len(mesh.polygons):
        corners = raw(mesh, ".corner_vert", "value", 1, np.int32).astype(np.uint32)
        offsets = np.full(len(mesh.polygons) + 1, len(corners), np.uint32)
        starts = np.empty(len(mesh.polygons), np.int32)
        mesh.polygons.foreach_get("loop_start", starts)
        offsets[:-1] = starts
        return adwave.Shape._from_data(_native.ShapeData.from_arrays(places, corners, offsets))
    if len(mesh.edges):
        return adwave.graph(len(places), raw(mesh, ".edge_verts", "value", 2, np.int32).reshape(-1, 2))
    return adwave.Shape(places)


def group_weights(mesh: Any, index: int) -> Floats:
    """Weights of a vertex group, (n,); 0 outside of it."""
    weights = np.zeros(len(mesh.vertices))
    for vertex in mesh.vertices:
        for member in vertex.groups:
            if member.group == index:
                weights[vertex.index] = member.weight
    return weights


def selected(mesh: Any) -> Floats:
    """Weights that are 1 at selected vertices, (n,)."""
    flags = raw(mesh, ".select_vert", "value", 1, bool)
    # Without a selection there is no such attribute.
    return flags.astype(float) if len(flags) else np.zeros(len(mesh.vertices))


class Split:
    """The bands of a mesh, and its new points for given gains in milliseconds."""

    def __init__(self, mesh: Any, original: Singles, levels: int, report: Report | None = None) -> None:
        shape = shape_of(mesh, original)
        self.made_of = (checksum(original), connections(mesh), levels)
        self._before: Floats = original.reshape(-1, 3).astype(float)
        self._negative = np.flatnonzero((original == 0) & np.signbit(original))
        self._decomposer = adwave.Decomposer(shape, progress=report)
        signal = self._before if shape.kind == "graph" else None
        self.bands = self._decomposer.decompose(signal, levels=levels or None, progress=report)
        self._open = shape.kind == "cloud" or (shape.kind == "mesh" and not adwave.info(self._decomposer)["closed"])
        self._graph = shape.kind == "graph"
        self._edited = np.empty_like(self._before)
        self._turns: dict[tuple[str, str], Floats] = {}
        #: Name and weights of a vertex group, until it is painted again.
        self.group: tuple[str, Floats] | None = None

    def points(self, gains: list[float], where: Floats | None, along: str, border: str, keep_volume: bool) -> Singles:
        """New points for gains, 3·n numbers; bit-identical to the old ones where no gain applies."""
        edited = self.bands.apply(gains, where, out=self._edited)
        straight = along == "auto" and (border == "free" or not self._open)
        if keep_volume and not self._graph:
            edited = self._constrain(edited, along, border, "keep")
        elif not straight and not self._graph:
            np.subtract(edited, self._before, out=edited)
            edited = np.einsum("nij,nj->ni", self._turn(along, border), edited)
            np.add(self._before, edited, out=edited)
        points = edited.astype(np.float32).ravel()
        # A zero added to -0.0 is 0.0.
        points[self._negative[points[self._negative] == 0]] = -0.0
        return points

    def with_base(self, base: Singles) -> Singles:
        """Points with the detail of the original on another base, 3·n numbers."""
        if self._graph:
            raise ValueError("the mesh has edges alone; putting detail back needs faces")
        return self.bands.with_base(base.reshape(-1, 3).astype(float)).astype(np.float32).ravel()

    def _constrain(self, edited: Floats, along: str, border: str, volume: str) -> Floats:
        constraints = Constraints(along=None if along == "auto" else along, border=border, volume=volume)  # type: ignore[arg-type]
        return self._decomposer._data.constrain_positions(edited, constraints)

    def _turn(self, along: str, border: str) -> Floats:
        """Matrix of each vertex that maps the displacement by the bands to the one that directions and borders allow.

        The map is linear, since the normals are those of the original points: three displacements determine it.
        """
        if (along, border) not in self._turns:
            size = self._decomposer.diagonal or 1.0
            columns = [
                (self._constrain(self._before + size * axis, along, border, "free") - self._before)
                for axis in np.eye(3)
            ]
            self._turns = {(along, border): np.stack(columns, axis=2) / size}
        return self._turns[along, border]


def colors_of(values: Floats) -> Singles:
    """Linear colors of signed values, 4·n numbers; the strongest hundredth is at the ends of the scale."""
    size = float(np.percentile(np.abs(values), 99)) or 1.0
    t = np.clip(np.nan_to_num(values) / size, -1, 1)[:, None]
    low, middle, high = (np.array(color) for color in COLORS)
    rgb = middle + np.where(t < 0, -t * (low - middle), t * (high - middle))
    return np.column_stack([rgb, np.ones(len(rgb))]).astype(np.float32).ravel()


def put_field(mesh: Any, name: str, kind: str, key: str, values: NDArray[Any]) -> None:
    """Write values at the vertices as an attribute, replacing those of that name."""
    attribute = mesh.attributes.get(name)
    if attribute and (attribute.data_type, attribute.domain) != (kind, "POINT"):
        raise ValueError(f"the attribute {name!r} exists and is of another kind; choose another name")
    if not attribute:
        attribute = mesh.attributes.new(name, kind, "POINT")
    attribute.data.foreach_set(key, values)
