"""Triangle meshes with their measures, and PLY files that record their source."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

MADE_FROM = "comment made from "


def triangle_areas(points, triangles):
    """The area of each triangle."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def edges_and_sides(triangles):
    """The edges (e × 2, smaller vertex first), and the edge numbers ab, bc, ca of each triangle (m × 3)."""
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    edges, number = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    return edges, number.reshape(-1, 3)


@dataclass(frozen=True)
class Mesh:
    """A mesh and its file."""

    name: str
    path: Path
    points: np.ndarray
    triangles: np.ndarray

    @cached_property
    def triangle_areas(self):
        return triangle_areas(self.points, self.triangles)

    @cached_property
    def vertex_areas(self):
        """A third of the area of the triangles at each vertex."""
        return np.bincount(self.triangles.ravel(), np.repeat(self.triangle_areas / 3, 3), len(self.points))

    @cached_property
    def edges(self):
        return edges_and_sides(self.triangles)[0]

    @cached_property
    def edge_lengths(self):
        return np.linalg.norm(self.points[self.edges[:, 0]] - self.points[self.edges[:, 1]], axis=1)

    @property
    def mean_edge(self):
        return float(self.edge_lengths.mean())

    @property
    def diagonal(self):
        return float(np.linalg.norm(np.ptp(self.points, axis=0)))

    def spacing(self):
        """The mean length of the edges at each vertex."""
        ends, lengths = self.edges.ravel(), np.repeat(self.edge_lengths, 2)
        return np.bincount(ends, lengths, len(self.points)) / np.bincount(ends, minlength=len(self.points))


def drop_unused_vertices(points, triangles):
    """Points and triangles without the vertices that no triangle uses."""
    kept, number = np.unique(triangles, return_inverse=True)
    return points[kept], number.reshape(triangles.shape)


def write(path, points, triangles, made_from):
    """Writes a binary PLY with a comment on its source."""
    faces = np.empty(len(triangles), [("n", "u1"), ("corners", "<i4", 3)])
    faces["n"], faces["corners"] = 3, triangles
    header = ["ply", "format binary_little_endian 1.0", MADE_FROM + made_from, f"element vertex {len(points)}",
              *(f"property double {c}" for c in "xyz"), f"element face {len(triangles)}",
              "property list uchar int vertex_indices", "end_header", ""]
    part = path.with_suffix(".part")
    part.write_bytes("\n".join(header).encode() + points.astype("<f8").tobytes() + faces.tobytes())
    part.replace(path)


def read(path, made_from):
    """Points and triangles of a file of `write`, or None if it is missing or has another source."""
    if not path.is_file():
        return None
    header, end, body = path.read_bytes().partition(b"end_header\n")
    lines = header.decode().splitlines()
    if MADE_FROM + made_from not in lines:
        return None
    n_points, n_faces = (int(line.split()[-1]) for line in lines if line.startswith("element"))
    points = np.frombuffer(body, "<f8", 3 * n_points).reshape(-1, 3)
    faces = np.frombuffer(body, [("n", "u1"), ("corners", "<i4", 3)], n_faces, 24 * n_points)
    return points, faces["corners"].astype(np.int64)
