"""Levels of meshes that were made by subdivision, and wavelets on them and on any mesh."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._caller import public
from adwave._layout import Layout, signal_values
from adwave._part import read_part
from adwave._progress import ProgressLike, report_progress
from adwave._shape import Shape

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from adwave._part import PartOptions

Family = Literal["butterfly", "linear", "loop", "catmull-clark", "haar", "irregular"]
_HIERARCHY = ("kind", "areas", "creases", "corners", "progress")


@dataclass(frozen=True)
class Coefficients:
    """Coefficients of a field: as many as it has values.

    Attributes
    ----------
    array : array
        Coefficients in the axes of the field.
    levels : (n,) array of int
        Level of each row: 1 for the finest details, one more than the number of levels for values of the coarsest level.
    norms : (n,) array
        Norm by area of the function of each row; the areas are shares of the whole.

    Examples
    --------
    >>> import adwave as aw
    >>> mesh = aw.Shape([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> h = aw.hierarchy(aw.subdivide(mesh, 4))
    >>> c = h.analyze(h.shape(0).points[:, 2])
    >>> bool(abs(c.synthesize() - h.shape(0).points[:, 2]).max() < 1e-13)
    True
    """

    array: NDArray[np.float64]
    levels: NDArray[np.uint32]
    norms: NDArray[np.float64]
    _data: _native.WaveletData = field(repr=False)
    _layout: Layout = field(repr=False)

    def __array__(self, dtype: object = None, copy: Union[bool, None] = None) -> NDArray[np.float64]:
        """The coefficients."""
        array = np.asarray(self.array, dtype=dtype)  # type: ignore[arg-type]
        return array.copy() if copy else array

    def keep(self, share: float) -> Coefficients:
        """The coefficients with all but a share of the rows set to 0: those stay that contribute most to the field.

        Parameters
        ----------
        share : float
            Share of the rows, in 0 to 1.

        Raises
        ------
        ValueError
            If the share is not in 0 to 1.
        """
        kept = self._data.keep(_rows(self._layout.flatten(self.array)), float(share))
        return replace(self, array=self._layout.arrange(kept))

    def replace(self, array: ArrayLike) -> Coefficients:
        """Other coefficients of the same wavelets, in the same axes.

        Raises
        ------
        ValueError
            If the array has other axes.
        """
        values = np.asarray(array, dtype=np.float64)
        if values.shape != self.array.shape:
            raise ValueError(f"array must have the shape {self.array.shape}, got {values.shape}")
        return replace(self, array=values)

    def synthesize(self) -> NDArray[np.float64]:
        """The field of the coefficients, in its own axes."""
        return self._layout.arrange(self._data.synthesize(_rows(self._layout.flatten(self.array))))


class Hierarchy:
    """Levels of a mesh; made by `hierarchy`.

    Level 0 is the mesh itself. The vertices of level k + 1 are the first ones of level k for all k ≥ 1.

    Attributes
    ----------
    levels : int
        Number of coarser levels.
    sizes : tuple of int
        Number of vertices of each level, of the mesh first.
    parents : tuple of (n_k, 2) arrays of int
        For each level but the coarsest, the parents of each vertex as vertices of the next level: the ends of the edge
        that was cut, or a vertex that stays, twice. For quadrilaterals (n_k, m): the corners of a face for the vertex in its
        middle, the ends of an edge, or a vertex that stays; the rest of a row is -1. Empty for levels of any mesh.
    parts : list of (int, int)
        Number of levels and of vertices of each connected part; empty for levels of any mesh.

    Examples
    --------
    >>> import adwave as aw
    >>> mesh = aw.Shape([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> h = aw.hierarchy(aw.subdivide(mesh, 3))
    >>> h.levels, h.sizes, h.parents[0].shape
    (3, (130, 34, 10, 4), (130, 2))
    """

    levels: int
    sizes: tuple[int, ...]
    parents: tuple[NDArray[Any], ...]
    parts: list[tuple[int, int]]

    def __init__(
        self, shape: Shape, kind: str, areas: Union[NDArray[np.float64], None], sharp: _Sharp, report: object
    ) -> None:
        self._shape = shape
        self._areas = areas
        self._wavelets: dict[str, _native.WaveletData] = {}
        self._data: Union[_native.HierarchyData, None] = None
        if kind == "irregular":
            own = self._family("irregular")
            self.sizes, self.parents, self.parts = tuple(own.sizes()), (), []
        else:
            self._data = _native.HierarchyData(shape._data, sharp.pairs, sharp.angle, sharp.corners, report)  # type: ignore[arg-type]
            self.sizes = tuple(self._data.sizes())
            rows = (self._data.parents(level) for level in range(len(self.sizes) - 1))
            self.parents = tuple(_padded(*row) if self._data.is_of_quads() else _pairs(*row) for row in rows)
            self.parts = [(n_levels, n_vertices) for n_levels, n_vertices in self._data.parts()]
        self.levels = len(self.sizes) - 1

    def __repr__(self) -> str:
        return f"Hierarchy({self.levels} levels, {self.sizes[0]} to {self.sizes[-1]} vertices)"

    def vertices(self, level: int) -> NDArray[np.uint32]:
        """Vertex of the mesh at each vertex of a level, (n_level,).

        Raises
        ------
        ValueError
            If the level does not exist.
        """
        return (self._data or self._family("irregular")).vertices(self._check(level))

    def shape(self, level: int, *, family: Union[Family, None] = None) -> Shape:
        """The mesh of a level, with faces of any number of corners.

        Parameters
        ----------
        level : int
            The level.
        family : {'butterfly', 'linear', 'loop', 'catmull-clark'}, optional
            Family whose wavelets are left out, which moves the vertices to where this subdivision would begin; by default
            the vertices stay where they are in the mesh.

        Raises
        ------
        ValueError
            If the level does not exist, or the levels are those of any mesh, which have no faces.
        """
        if self._check(level) == 0:
            return self._shape
        if self._data is None:
            raise ValueError("levels of any mesh have no faces; aw.simplify makes coarser meshes of any mesh")
        points = np.array(self._shape.points)
        points = points[self.vertices(level)] if family is None else self.down(points, level, family=family)
        offsets, corners = self._data.faces(level)
        sizes = np.diff(offsets.astype(np.int64))
        if (sizes == 3).all():
            return Shape(points, corners.reshape(-1, 3))
        return Shape(points, np.split(corners.astype(np.int64), offsets[1:-1].astype(np.int64)))

    def with_level(self, points: ArrayLike, level: int, *, family: Union[Family, None] = None) -> NDArray[np.float64]:
        """Positions of the mesh after an edit of a level; the detail of all finer levels turns with its surroundings.

        Unchanged positions give those of the mesh, and a level moved as a whole gives the mesh moved.

        Parameters
        ----------
        points : (n_level, 3) array_like
            Edited positions of ``shape(level, family=...)``, in its order.
        level : int
            The level, at least 1.
        family : {'butterfly', 'linear', 'loop', 'catmull-clark'}, optional
            Family of the subdivision; catmull-clark by default on quadrilaterals, and else butterfly.

        Raises
        ------
        ValueError
            If the level does not exist, or has another number of vertices.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> mesh = aw.Shape([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
        >>> h = aw.hierarchy(aw.subdivide(mesh, 3))
        >>> coarse = np.array(h.shape(2, family="loop").points)
        >>> bool(np.abs(h.with_level(coarse + 1, 2, family="loop") - h.shape(0).points - 1).max() < 1e-12)
        True
        """
        if self._data is None:
            raise ValueError("levels of any mesh have no faces; bands.with_base edits the base of any mesh")
        edited = np.ascontiguousarray(points, dtype=np.float64)
        if edited.ndim != 2 or edited.shape[1] != 3:
            raise ValueError(f"points must be an array of shape (n, 3), got {edited.shape}")
        return self._data.with_level(self._shape._data, self._family(family), self._check(level), edited)

    def down(
        self,
        field: ArrayLike,
        level: int = 1,
        *,
        family: Union[Family, None] = None,
        by: Union[Literal["wavelets", "cells", "labels"], None] = None,
    ) -> NDArray[Any]:
        """A field of the mesh on a coarser level: with the same mean by area, or labels.

        Wavelets are the default for numbers because `up` and the details lead back to the field exactly; their values may leave
        the range of the field, beside jumps most. Means over cells stay in it. Integers are labels, which have no mean:
        each vertex gets the one with the largest share of the area of its cell. Give ``field.astype(float)`` to average them.

        Parameters
        ----------
        field : (n,) or (n, channels) array_like
            One value, or several, for each vertex of the mesh.
        level : int
            The level.
        family : {'butterfly', 'linear', 'loop', 'catmull-clark'}, optional
            Family of the wavelets that are left out; catmull-clark by default on quadrilaterals, and else butterfly.
        by : {'wavelets', 'cells', 'labels'}, optional
            ``'cells'`` averages over the cells of the vertices of the level: a vertex of the mesh belongs to its parents in equal
            shares. By default ``'labels'`` for integers, and else ``'wavelets'``.

        Raises
        ------
        ValueError
            If the level does not exist, a value is missing, or labels or cells are asked for of levels of any mesh.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> mesh = aw.Shape([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
        >>> h = aw.hierarchy(aw.subdivide(mesh, 3))
        >>> labels = np.where(h.shape(0).points[:, 2] > 0, 1002, 35)
        >>> [int(label) for label in np.unique(h.down(labels, 2))]
        [35, 1002]
        """
        by = by or _usual_way(field)
        if by == "wavelets":
            values, layout = signal_values(field, self.sizes[0], "field")
            coarse = self._family(family).resample(_rows(values), self._check(level), "down")
            return layout.with_vertices(self.sizes[level]).arrange(coarse)
        if family is not None:
            raise ValueError(f"family applies to by='wavelets', and by is {by!r}; leave one out")
        shares = self._shares(level, by).T.multiply(self._vertex_areas()).tocsr()
        if by == "labels":
            return _most_frequent(shares, np.asarray(field), self.sizes[0])
        if by != "cells":
            raise ValueError(f"by must be 'wavelets', 'cells' or 'labels', got {by!r}")
        values, layout = signal_values(field, self.sizes[0], "field")
        rows = _rows(values)
        rows = rows.reshape(len(rows), -1)
        means = (shares @ rows) / np.asarray(shares.sum(axis=1)).reshape(-1, 1)
        # Rounding must not leave the range.
        means = np.clip(means, rows.min(axis=0), rows.max(axis=0))
        return layout.with_vertices(self.sizes[level]).arrange(means)

    def up(self, field: ArrayLike, level: int = 1, *, family: Union[Family, None] = None) -> NDArray[Any]:
        """A field of a coarser level on the mesh, by subdivision without details.

        Integers are labels: each vertex of the mesh gets the one with the largest share among the vertices of the level from which
        it was made, and of equal shares the smallest.

        Parameters
        ----------
        field : (n_level,) or (n_level, channels) array_like
            One value, or several, for each vertex of the level.
        level : int
            The level.
        family : {'butterfly', 'linear', 'loop', 'catmull-clark'}, optional
            Family of the subdivision; catmull-clark by default on quadrilaterals, and else butterfly.

        Raises
        ------
        ValueError
            If the level does not exist, a value is missing, or labels are given on levels of any mesh.
        """
        if _usual_way(field) == "labels":
            if family is not None:
                raise ValueError(
                    "family applies to numbers, and integers are labels; leave it out, or give field.astype(float)"
                )
            return _most_frequent(self._shares(level, "labels"), np.asarray(field), self.sizes[level])
        values, layout = signal_values(field, self.sizes[self._check(level)], "field")
        fine = self._family(family).resample(_rows(values), level, "up")
        return layout.with_vertices(self.sizes[0]).arrange(fine)

    def _shares(self, level: int, by: str) -> Any:
        """Share of each vertex of a level in each vertex of the mesh, as a sparse matrix of rows that sum to 1."""
        from scipy.sparse import csr_array

        self._check(level)
        if self._data is None:
            raise ValueError(
                f"levels of any mesh have no cells, which by={by!r} needs; field[h.vertices(level)] takes the values of the vertices "
                "that stay, and field.astype(float) is averaged by wavelets"
            )
        shares: Any = csr_array((np.ones(self.sizes[0]), np.arange(self.sizes[0]), np.arange(self.sizes[0] + 1)))
        for k in range(level):
            starts, parents = (array.astype(np.int64) for array in self._data.parents(k))
            n, counts = len(starts) - 1, np.diff(starts)
            step: Any = csr_array((np.repeat(1.0 / counts, counts), parents, starts), shape=(n, self.sizes[k + 1]))
            shares = shares @ step
        return shares

    def _vertex_areas(self) -> NDArray[np.float64]:
        """Third of the area of the triangles at each vertex of the mesh; equal shares on a mesh without area."""
        assert self._data is not None
        points = np.asarray(self._shape.points if self._areas is None else self._areas)[self.vertices(0)]
        faces = np.asarray(self._data.triangles(), dtype=np.int64)
        a, b, c = (points[faces[:, k]] for k in range(3))
        thirds = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6.0
        areas = np.bincount(faces.ravel(), np.repeat(thirds, 3), self.sizes[0])
        return np.where(areas > 0, areas, np.finfo(np.float64).tiny ** 0.5 if areas.any() else 1.0)

    def analyze(
        self, field: ArrayLike, *, family: Union[Family, None] = None, progress: ProgressLike = None
    ) -> Coefficients:
        """Coefficients of a field, as many as it has values.

        Parameters
        ----------
        field : (n,) or (n, channels) array_like
            One value, or several, for each vertex; for haar, for each face.
        family : {'butterfly', 'linear', 'loop', 'catmull-clark', 'haar'}, optional
            Family of the wavelets; catmull-clark by default on quadrilaterals, irregular on levels of any mesh, and else
            butterfly.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

        Raises
        ------
        ValueError
            If the family does not fit the levels, or a value is missing.
        """
        data = self._family(family)
        n_rows = data.sizes()[0]
        values, layout = signal_values(field, n_rows, "field")
        with report_progress(progress, "transforming") as report:
            found, levels, norms = data.analyze(_rows(values), report)
        return Coefficients(layout.arrange(found), levels, norms, data, layout)

    def _family(self, family: Union[str, None]) -> _native.WaveletData:
        """Prepared wavelets of a family."""
        of_quads = self._data is not None and self._data.is_of_quads()
        own = "irregular" if self._data is None else "catmull-clark" if of_quads else "butterfly"
        name = own if family is None else family
        if (name == "irregular") != (self._data is None):
            levels = "any mesh (kind='irregular')" if self._data is None else "subdivision"
            raise ValueError(f"family {name!r} does not fit levels of {levels}")
        found = self._wavelets.get(name)
        if found is None:
            found = _native.WaveletData(self._shape._data, name, self._data, self._areas)
            self._wavelets[name] = found
        return found

    def _check(self, level: int) -> int:
        if not 0 <= level <= self.levels:
            raise ValueError(f"level must be in 0..={self.levels}, got {level}")
        return level


@public()
def hierarchy(
    shape: object,
    *,
    kind: Literal["subdivision", "irregular"] = "subdivision",
    areas: object = None,
    creases: Union[ArrayLike, float, None] = None,
    corners: Literal["smooth", "sharp"] = "smooth",
    progress: ProgressLike = None,
    **options: Unpack[PartOptions],
) -> Hierarchy:
    """Levels of a mesh that was made by cutting triangles into four, or polygons into quadrilaterals (Catmull–Clark).

    Vertices and faces may have any order. Where the faces alone allow several coarse meshes, the positions choose.

    Parameters
    ----------
    shape : shape_like
        A mesh; see `Shape`. Vertices at equal positions count as one. If all faces are triangles, the levels are those of
        triangles, and else of quadrilaterals; the coarsest mesh of these may have faces of any number of corners.
    kind : {'subdivision', 'irregular'}
        ``'irregular'`` makes levels for any mesh, by removing vertices.
    areas : shape_like or (n, 3) array_like, optional
        Surface with the same vertices whose areas weigh the fields, such as the white surface if the shape is a sphere; by
        default the shape.
    creases : (m, 2) array_like of int, or float, optional
        Sharp edges of a mesh of quadrilaterals by their ends, or the angle in degrees between faces above which an edge is
        sharp. A coarse edge is sharp if both of its halves are.
    corners : {'smooth', 'sharp'}
        Whether border vertices of one face stay in place in Catmull–Clark subdivision.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
    **options
        ``faces=``, and ``mask=`` or ``only=``: the other vertices are left out.

    Returns
    -------
    Hierarchy

    Raises
    ------
    ValueError
        If the mesh has no levels of subdivision, with the reason.

    References
    ----------
    Lounsbery, DeRose & Warren, "Multiresolution analysis for surfaces of arbitrary topological type", 1997.

    Examples
    --------
    >>> import adwave as aw
    >>> creature = aw.sample("creature", vertices=2000)
    >>> h = aw.hierarchy(creature, kind="irregular")
    >>> half = h.analyze(creature.points).keep(0.5).synthesize()
    >>> bool(abs(half - creature.points).max() < 0.05)
    True
    """
    if kind not in ("subdivision", "irregular"):
        raise ValueError(f"kind must be 'subdivision' or 'irregular', got {kind!r}")
    part = read_part("hierarchy", shape, options, _HIERARCHY)
    own = part.shape
    sharp = _sharp(creases, corners)
    is_sharp = creases is not None or corners != "smooth"
    if is_sharp and (kind == "irregular" or own.kind != "mesh" or own._data.triangles is not None):
        raise ValueError(
            "creases and corners apply to quadrilaterals, and these levels are of triangles; leave them out"
        )
    with report_progress(progress, "finding levels") as report:
        return Hierarchy(own, kind, _surface(areas, own.n_vertices), sharp, report)


@public()
def subdivide(shape: object, levels: int = 1, *, family: Family = "linear") -> Shape:
    """A mesh of triangles, each cut into four at the midpoints of its edges; of other polygons, each into quadrilaterals.

    The vertices of the mesh come first; `hierarchy` finds them again.

    Parameters
    ----------
    shape : shape_like
        A mesh; see `Shape`.
    levels : int
        Number of times.
    family : {'linear', 'butterfly', 'loop', 'catmull-clark'}
        Rule for the positions. Butterfly and loop are for triangles; catmull-clark cuts triangles into quadrilaterals too.

    Raises
    ------
    ValueError
        If the shape is no mesh, the number is negative, or the family does not fit the faces.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.subdivide(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])).n_vertices
    6
    >>> tetrahedron = ([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    >>> fine = aw.subdivide(tetrahedron, 3, family="catmull-clark")
    >>> aw.hierarchy(fine).sizes
    (194, 50, 14, 4)
    """
    if levels < 0:
        raise ValueError(f"levels must be at least 0, got {levels}")
    own = read_part("subdivide", shape, {}, ()).shape
    if own.kind != "mesh":
        raise ValueError(f"subdivision needs a mesh, got a {own.kind}")
    of_quads = family == "catmull-clark" or own._data.triangles is None
    fine = _cut_polygons(own, levels) if of_quads else _cut_triangles(own, levels)
    if family == "linear" or levels == 0:
        return fine
    h = hierarchy(fine)
    moved = h.up(np.array(own.points)[h.vertices(levels)], levels, family=family)
    offsets, corners = fine.polygons()
    faces = corners.reshape(-1, int(offsets[1]))
    return Shape(moved, faces)


def _cut_polygons(own: Shape, levels: int) -> Shape:
    """Polygons of n corners, each cut into n quadrilaterals."""
    points = np.array(own.points)
    offsets, corners = (array.astype(np.int64) for array in own.polygons())
    for _ in range(levels):
        sizes = np.diff(offsets)
        face = np.repeat(np.arange(len(sizes)), sizes)
        after = np.arange(1, len(corners) + 1)
        after[offsets[1:] - 1] = offsets[:-1]
        edges, index = np.unique(np.sort(np.stack([corners, corners[after]], 1), axis=1), axis=0, return_inverse=True)
        middle = len(points) + index.ravel()
        before = np.empty_like(middle)
        before[after] = middle
        centers = np.stack([np.bincount(face, points[corners, k]) for k in range(3)], 1) / sizes[:, None]
        quads = np.stack([corners, middle, len(points) + len(edges) + face, before], axis=1)
        points = np.concatenate([points, 0.5 * (points[edges[:, 0]] + points[edges[:, 1]]), centers])
        offsets, corners = np.arange(0, 4 * len(quads) + 1, 4), quads.ravel()
    return own if levels == 0 else Shape(points, corners.reshape(-1, 4))


def _cut_triangles(own: Shape, levels: int) -> Shape:
    """Triangles, each cut into four."""
    points, faces = np.array(own.points), np.array(own.faces, dtype=np.int64)
    for _ in range(levels):
        sides = np.stack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]], axis=1)
        edges, index = np.unique(np.sort(sides.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
        middle = len(points) + index.reshape(-1, 3)
        points = np.concatenate([points, 0.5 * (points[edges[:, 0]] + points[edges[:, 1]])])
        corners = [np.stack([faces[:, k], middle[:, k], middle[:, (k + 2) % 3]], axis=1) for k in range(3)]
        faces = np.concatenate([*corners, middle])
    return Shape(points, faces)


@dataclass(frozen=True)
class _Sharp:
    """Sharp edges of quadrilaterals by their ends or an angle in degrees, and the rule of border corners."""

    pairs: Union[NDArray[np.uint32], None] = None
    angle: Union[float, None] = None
    corners: str = "smooth"


def _sharp(creases: Union[ArrayLike, float, None], corners: str) -> _Sharp:
    if corners not in ("smooth", "sharp"):
        raise ValueError(f"corners must be 'smooth' or 'sharp', got {corners!r}")
    if creases is None:
        return _Sharp(corners=corners)
    array = np.asarray(creases)
    if array.ndim == 0:
        angle = float(array)
        if not 0 <= angle <= 180:
            raise ValueError(f"creases must be an angle in 0 to 180 degrees, or pairs of vertices, got {angle}")
        return _Sharp(angle=angle, corners=corners)
    if array.ndim != 2 or array.shape[1] != 2 or array.dtype.kind not in "iu":
        raise ValueError(f"creases must be integers of shape (m, 2), got {array.dtype} of shape {array.shape}")
    if (array < 0).any() or (array >= 2**32).any():
        raise ValueError("creases must name vertices, counted from 0; a number is out of range")
    return _Sharp(pairs=np.ascontiguousarray(array, dtype=np.uint32), corners=corners)


def _pairs(starts: NDArray[np.uint32], parents: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """The first and the last parent of each vertex."""
    return np.stack([parents[starts[:-1]], parents[starts[1:] - 1]], axis=1)


def _padded(starts: NDArray[np.uint32], parents: NDArray[np.uint32]) -> NDArray[np.int64]:
    """Parents of each vertex as rows filled up with -1."""
    counts = np.diff(starts.astype(np.int64))
    rows = np.full((len(counts), int(counts.max(initial=1))), -1, dtype=np.int64)
    rows[np.arange(rows.shape[1]) < counts[:, None]] = parents
    return rows


def _usual_way(field: ArrayLike) -> Literal["wavelets", "labels"]:
    """Labels for integers and truth values, else wavelets."""
    return "labels" if np.asarray(field).dtype.kind in "iub" else "wavelets"


def _most_frequent(shares: Any, field: NDArray[Any], n_rows: int) -> NDArray[Any]:
    """The label with the largest sum of shares for each row, the smallest of several."""
    if field.ndim not in (1, 2) or len(field) != n_rows:
        raise ValueError(
            f"field must have one label, or several, for each of {n_rows} vertices, got shape {field.shape}"
        )
    columns = field.reshape(len(field), -1)
    found = np.empty((shares.shape[0], columns.shape[1]), dtype=field.dtype)
    for k, column in enumerate(columns.T):
        best = np.full(shares.shape[0], -1.0)
        for label in np.unique(column):
            share = shares @ (column == label).astype(np.float64)
            # Sums of equal shares differ by rounding, which must not choose.
            is_more = share > best * (1 + 1e-12)
            best[is_more], found[is_more, k] = share[is_more], label
    return found.reshape(shares.shape[0], *field.shape[1:])


def _rows(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.ascontiguousarray(values, dtype=np.float64)


def _surface(areas: object, n_vertices: int) -> Union[NDArray[np.float64], None]:
    """Positions of the surface whose areas weigh."""
    if areas is None:
        return None
    points = np.asarray(areas if isinstance(areas, np.ndarray) else read_part("hierarchy", areas, {}, ()).shape.points)
    if points.shape != (n_vertices, 3):
        raise ValueError(f"areas must be a surface of {n_vertices} vertices, got shape {points.shape}")
    return _rows(points)
