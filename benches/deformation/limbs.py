"""Tests of deformation made of any shapes: a limb turns, and the rest stays.

`python limbs.py OUT SHAPE:LIMB:ANGLE …` writes NAME.off, NAME.sel and NAME.def for each shape, as the survey `botsch2008` has
them: a state of each vertex (0 stays, 1 is free, 2 is moved) and a matrix. LIMB counts the tips of the shape, farthest from
its middle first, each as far as possible from those before. Vertices within 12 % of the largest distance along edges from
the tip move, those beyond 60 % stay, and the tip turns by ANGLE degrees about an axis across the limb, at a third of the
way. Then `arap.py OUT OUT` and the example `survey` of adwave-deform bend them. Needs `pip install adwave numpy scipy`.
"""

from __future__ import annotations

import sys
from pathlib import Path

import adwave as aw
import numpy as np
from arap import write_off
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

MOVED_WITHIN = 0.12
FREE_WITHIN = 0.6
#: Between which distances from the tip the axis lies.
PIVOT = (0.264, 0.408)
#: A direction that no limb of a test is along.
ACROSS = (0.31, 0.77, 0.55)


def turn(axis: np.ndarray, angle: float, center: np.ndarray) -> np.ndarray:
    """Matrix of a rotation about an axis through a point."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix = np.eye(4)
    matrix[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    matrix[:3, 3] = center - matrix[:3, :3] @ center
    return matrix


def limb(points: np.ndarray, faces: np.ndarray, number: int, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """State of each vertex and matrix of the moved ones."""
    edges = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    graph = coo_matrix((lengths + 1e-12, (edges[:, 0], edges[:, 1])), shape=(len(points), len(points))).tocsr()
    used = np.unique(faces)
    middle = used[np.argmin(np.linalg.norm(points[used] - points[used].mean(axis=0), axis=1))]
    distance = dijkstra(graph, directed=False, indices=middle)
    distance = np.where(np.isfinite(distance), distance, -1.0)
    size = distance.max()
    for _ in range(number + 1):
        tip = int(np.argmax(distance))
        from_tip = dijkstra(graph, directed=False, indices=tip)
        distance = np.minimum(distance, from_tip)
    state = np.where(from_tip < MOVED_WITHIN * size, 2, np.where(from_tip <= FREE_WITHIN * size, 1, 0))
    pivot = points[(from_tip > PIVOT[0] * size) & (from_tip < PIVOT[1] * size)].mean(axis=0)
    along = points[state == 2].mean(axis=0) - pivot  # noqa: PLR2004
    return state, turn(np.cross(along, ACROSS), np.radians(angle), pivot)


if __name__ == "__main__":
    out = Path(sys.argv[1])
    for text in sys.argv[2:]:
        path, number, angle = text.rsplit(":", 2)
        shape = aw.read(path)
        points, faces = np.asarray(shape.points, dtype=float), np.asarray(shape.faces, dtype=np.int64)
        state, matrix = limb(points, faces, int(number), float(angle))
        name = f"{Path(path).stem}-{number}"
        write_off(out / f"{name}.off", points, faces)
        np.savetxt(out / f"{name}.sel", state, fmt="%d")
        np.savetxt(out / f"{name}.def", matrix, fmt="%.17g")
