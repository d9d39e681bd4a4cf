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

Family = Literal["butterfly", "linear", "loop", "haar", "irregular"]
_HIERARCHY = ("kind", "areas", "progress")


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
        that was cut, or a vertex that stays, twice. Empty for levels of any mesh.
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
    parents: tuple[NDArray[np.uint32], ...]
    parts: list[tuple[int, int]]

    def __init__(self, shape: Shape, kind: str, areas: Union[NDArray[np.float64], None], report: object) -> None:
        self._shape = shape
        self._areas = areas
        self._wavelets: dict[str, _native.WaveletData] = {}
        self._data: Union[_native.HierarchyData, None] = None
        if kind == "irregular":
            own = self._family("irregular")
            self.sizes, self.parents, self.parts = tuple(own.sizes()), (), []
        else:
            self._data = _native.HierarchyData(shape._data, report)  # type: ignore[arg-type]
            self.sizes = tuple(self._data.sizes())
            self.parents = tuple(self._data.parents(level) for level in range(len(self.sizes) - 1))
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

    def shape(self, level: int) -> Shape:
        """The mesh of a level, by the vertices of the mesh.

        Raises
        ------
        ValueError
            If the level does not exist, or the levels are those of any mesh, which have no faces.
        """
        if self._check(level) == 0:
            return self._shape
        if self._data is None:
            raise ValueError("levels of any mesh have no faces; aw.simplify makes coarser meshes of any mesh")
        return Shape(self._shape.points[self.vertices(level)], self._data.faces(level))

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
        family : {'butterfly', 'linear', 'loop'}, optional
            Family of the wavelets that are left out; butterfly by default.
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
        family : {'butterfly', 'linear', 'loop'}, optional
            Family of the subdivision; butterfly by default.

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
            parents = self.parents[k].astype(np.int64)
            n = len(parents)
            halves = (np.full(2 * n, 0.5), parents.ravel(), np.arange(0, 2 * n + 1, 2))
            step: Any = csr_array(halves, shape=(n, self.sizes[k + 1]))
            step.sum_duplicates()
            shares = shares @ step
        return shares

    def _vertex_areas(self) -> NDArray[np.float64]:
        """Third of the area of the triangles at each vertex of the mesh; equal shares on a mesh without area."""
        assert self._data is not None
        points = np.asarray(self._shape.points if self._areas is None else self._areas)[self.vertices(0)]
        faces = np.asarray(self._data.faces(0), dtype=np.int64)
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
        family : {'butterfly', 'linear', 'loop', 'haar'}, optional
            Family of the wavelets; butterfly by default, and irregular on levels of any mesh.
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
        own = "irregular" if self._data is None else "butterfly"
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
    progress: ProgressLike = None,
    **options: Unpack[PartOptions],
) -> Hierarchy:
    """Levels of a mesh that was made by cutting triangles into four, in any order of vertices and faces.

    Parameters
    ----------
    shape : shape_like
        A mesh of triangles; see `Shape`. Vertices at equal positions count as one.
    kind : {'subdivision', 'irregular'}
        ``'irregular'`` makes levels for any mesh of triangles, by removing vertices.
    areas : shape_like or (n, 3) array_like, optional
        Surface with the same vertices whose areas weigh the fields, such as the white surface if the shape is a sphere; by
        default the shape.
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
    with report_progress(progress, "finding levels") as report:
        return Hierarchy(own, kind, _surface(areas, own.n_vertices), report)


@public()
def subdivide(shape: object, levels: int = 1) -> Shape:
    """A mesh of triangles, each cut into four at the midpoints of its edges.

    The vertices of the mesh come first; `hierarchy` finds them again.

    Parameters
    ----------
    shape : shape_like
        A mesh of triangles; see `Shape`.
    levels : int
        Number of times.

    Raises
    ------
    ValueError
        If the shape is no mesh, or the number is negative.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.subdivide(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])).n_vertices
    6
    """
    if levels < 0:
        raise ValueError(f"levels must be at least 0, got {levels}")
    own = read_part("subdivide", shape, {}, ()).shape
    if own.kind != "mesh":
        raise ValueError(f"subdivision needs a mesh of triangles, got a {own.kind}")
    points, faces = np.array(own.points), np.array(own.faces, dtype=np.int64)
    for _ in range(levels):
        sides = np.stack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]], axis=1)
        edges, index = np.unique(np.sort(sides.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
        middle = len(points) + index.reshape(-1, 3)
        points = np.concatenate([points, 0.5 * (points[edges[:, 0]] + points[edges[:, 1]])])
        corners = [np.stack([faces[:, k], middle[:, k], middle[:, (k + 2) % 3]], axis=1) for k in range(3)]
        faces = np.concatenate([*corners, middle])
    return Shape(points, faces)


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
