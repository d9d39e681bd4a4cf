"""What `adwave.blender` reads from Blender's meshes, computes from it and writes back; nothing of windows and panels.

A mesh that is split keeps its original points in the attribute `ORIGINAL`, so that they are saved, copied and undone with it. What is
computed from them (`Split`) is kept beside Blender and made again where it is missing.
"""

from __future__ import annotations

import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

import adwave
from adwave import _adapt, _native
from adwave._progress import Report

#: Names that begin with a dot are not listed by Blender.
ORIGINAL = ".adwave_original"
#: Ends of the scale of colors, of linear light: hollow, level, standing out.
COLORS = ((0.05, 0.13, 0.6), (0.8, 0.8, 0.8), (0.6, 0.03, 0.02))

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]


def raw(mesh: Any, name: str, key: str, width: int, kind: type) -> NDArray[Any]:
    """An attribute's numbers in one copy, without a detour by Python objects; none where it is not there."""
    attribute = mesh.attributes.get(name)
    values = np.zeros((len(attribute.data) if attribute else 0) * width, kind)
    if attribute:
        attribute.data.foreach_get(key, values)
    return values


def points_of(mesh: Any, name: str = "position") -> Singles:
    """The points as Blender has them: 3·n numbers of single precision."""
    return raw(mesh, name, "vector", 3, np.float32)


def put_points(mesh: Any, points: Singles) -> None:
    """Move the points; nothing else of the mesh changes."""
    mesh.attributes["position"].data.foreach_set("vector", points)
    mesh.update()


def checksum(*arrays: NDArray[Any]) -> str:
    """A short text that tells whether arrays are still the same."""
    total = 0
    for array in arrays:
        total = zlib.crc32(array.data, total)
    return f"{total:08x}"


def connections(mesh: Any) -> str:
    """A short text that tells whether the mesh has the faces (or, without any, the edges) that it had."""
    links = raw(mesh, ".corner_vert", "value", 1, np.int32)
    if not len(links):
        links = raw(mesh, ".edge_verts", "value", 2, np.int32)
    return f"{len(mesh.vertices)} {len(mesh.polygons)} {checksum(links)}"


def shape_of(mesh: Any, points: Singles) -> adwave.Shape:
    """Faces of any number of corners as a mesh, edges alone as a graph, and points alone as a cloud."""
    if not len(points):
        raise ValueError("the mesh has no vertices")
    places = _adapt.points_array(points.reshape(-1, 3))
    if len(mesh.polygons):
        corners = raw(mesh, ".corner_vert", "value", 1, np.int32).astype(np.uint32)
        offsets = np.full(len(mesh.polygons) + 1, len(corners), np.uint32)
        starts = np.empty(len(mesh.polygons), np.int32)
        mesh.polygons.foreach_get("loop_start", starts)
        offsets[:-1] = starts
        return adwave.Shape._of(_native.ShapeData.from_arrays(places, corners, offsets))
    if len(mesh.edges):
        return adwave.graph(len(places), raw(mesh, ".edge_verts", "value", 2, np.int32).reshape(-1, 2))
    return adwave.Shape(places)


def group_weights(mesh: Any, index: int) -> Floats:
    """The weights of a vertex group: Blender gives them one by one."""
    weights = np.zeros(len(mesh.vertices))
    for vertex in mesh.vertices:
        for member in vertex.groups:
            if member.group == index:
                weights[vertex.index] = member.weight
    return weights


def selected(mesh: Any) -> Floats:
    """1 at vertices that are selected."""
    flags = raw(mesh, ".select_vert", "value", 1, bool)
    # Where nothing is selected there is no such attribute.
    return flags.astype(float) if len(flags) else np.zeros(len(mesh.vertices))


class Split:
    """The bands of a mesh, and what makes new points of gains in milliseconds."""

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
        #: Weights of the vertex group of that name, as long as nobody paints.
        self.group: tuple[str, Floats] | None = None

    def points(self, gains: list[float], where: Floats | None, along: str, border: str, keep_volume: bool) -> Singles:
        """New points for gains, 3·n numbers; where no gain applies the bits of the old ones."""
        edited = self.bands.apply(gains, where, out=self._edited)
        straight = along == "auto" and (border == "free" or not self._open)
        if keep_volume and not self._graph:
            edited = self._settled(edited, along, border, "keep")
        elif not straight and not self._graph:
            np.subtract(edited, self._before, out=edited)
            edited = np.einsum("nij,nj->ni", self._turn(along, border), edited)
            np.add(self._before, edited, out=edited)
        points = edited.astype(np.float32).ravel()
        # A zero added to -0.0 is 0.0.
        points[self._negative[points[self._negative] == 0]] = -0.0
        return points

    def _settled(self, edited: Floats, along: str, border: str, volume: str) -> Floats:
        return self._decomposer._data.settled(edited, None if along == "auto" else along, border, volume)

    def _turn(self, along: str, border: str) -> Floats:
        """The matrix of each vertex that takes the bands' displacement to the one that directions and borders allow.

        That is linear, and the normals are those of the original points: three displacements tell it once for all sliders.
        """
        if (along, border) not in self._turns:
            size = self._decomposer.diagonal or 1.0
            columns = [
                (self._settled(self._before + size * axis, along, border, "free") - self._before) for axis in np.eye(3)
            ]
            self._turns = {(along, border): np.stack(columns, axis=2) / size}
        return self._turns[along, border]


def colors_of(values: Floats) -> Singles:
    """Linear colors for values with a sign, 4·n numbers; the strongest hundredth is at the ends of the scale."""
    size = float(np.percentile(np.abs(values), 99)) or 1.0
    t = np.clip(np.nan_to_num(values) / size, -1, 1)[:, None]
    low, middle, high = (np.array(color) for color in COLORS)
    rgb = middle + np.where(t < 0, -t * (low - middle), t * (high - middle))
    return np.column_stack([rgb, np.ones(len(rgb))]).astype(np.float32).ravel()


def put_field(mesh: Any, name: str, kind: str, key: str, values: NDArray[Any]) -> None:
    """Values at the vertices as an attribute, in place of those that it had."""
    attribute = mesh.attributes.get(name)
    if attribute and (attribute.data_type, attribute.domain) != (kind, "POINT"):
        raise ValueError(f"the attribute {name!r} is there and is of another kind; choose another name")
    if not attribute:
        attribute = mesh.attributes.new(name, kind, "POINT")
    attribute.data.foreach_set(key, values)
