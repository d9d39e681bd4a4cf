"""`union`: several domains as one, such as two hemispheres and the voxels between them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._adapt import depth
from adwave._decomposer import Decomposer, as_domain, prepare_decomposer
from adwave._options import Operator
from adwave._shape import Shape


class UnionDecomposer(Decomposer):
    """A `Decomposer` of several domains, whose rows follow each other."""

    __slots__ = ("_counts", "_given")

    #: The parts as they were given, from which a copy in another process is made.
    _given: tuple[object, ...]
    _counts: tuple[int, ...]

    def __init__(self, parts: Iterable[object]) -> None:
        if isinstance(parts, (str, bytes)) or not isinstance(parts, Iterable):
            raise TypeError("parts: give a list of surfaces, curves and grids, as in aw.union([left, right])")
        self._given = tuple(parts)
        prepared = [_with_heat(part, k) for k, part in enumerate(self._given)]
        if not prepared:
            raise ValueError("parts: a union has one part or more, got none")
        self._counts = tuple(part.n_vertices for part in prepared)
        none = np.empty(0, dtype=np.uint32)
        shape = _native.ShapeData.from_graph(sum(self._counts), none, none, None, True)
        self.shape = Shape._from_data(shape)
        self._options = Operator("surface")
        self._data = _native.Prepared.union(shape, prepared)
        self._mask = self._given_walk = self._by_width = self._last_masked = None

    @property
    def parts(self) -> tuple[slice, ...]:
        """Rows of each part."""
        ends = np.cumsum(self._counts).tolist()
        return tuple(slice(first, end) for first, end in zip([0, *ends], ends))  # noqa: B905

    def with_mask(self, mask: ArrayLike) -> UnionDecomposer:
        """Union without some rows: the diffusion goes around them, and their bands are NaN; see `Decomposer.with_mask`."""
        other = super().with_mask(mask)
        other._given, other._counts = self._given, self._counts
        return other

    def __repr__(self) -> str:
        return f"<adwave.Decomposer: heat on {len(self._counts)} parts, {self.n_vertices} rows>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (self._given, self._mask)


def _restore(parts: tuple[object, ...], mask: NDArray[np.bool_] | None) -> UnionDecomposer:
    whole = UnionDecomposer(parts)
    return whole if mask is None else whole.with_mask(mask)


def _with_heat(part: object, k: int) -> _native.Prepared:
    """A part with heat: all of it, or the vertices that stand beside it, with labels or without."""
    # Faces have two axes, and vertices that take part one: (points, faces) is a mesh.
    has_rows = isinstance(part, tuple) and len(part) in (2, 3) and depth(part[1]) != 2
    rows = part[1:] if has_rows and isinstance(part, tuple) else ()
    domain = as_domain(part[0] if rows and isinstance(part, tuple) else part)
    prepared = domain if isinstance(domain, Decomposer) else prepare_decomposer(domain, "surface")
    if prepared.chooses_operator:
        prepared = prepare_decomposer(prepared.shape, "surface")
    if prepared.operator != "surface":
        raise ValueError(
            f"parts: each part has heat as its operator, and part {k} has {prepared.operator}; "
            "prepare it by aw.Decomposer(shape, operator='surface')"
        )
    if not rows:
        return prepared._data
    vertices = _indices(rows[0], k)
    labels = _indices(rows[1], k) if len(rows) > 1 else np.zeros(len(vertices), dtype=np.uint32)
    return prepared._data.part(vertices, labels)


def _indices(values: Any, k: int) -> NDArray[np.uint32]:
    array = np.asarray(values)
    if array.ndim != 1 or not np.issubdtype(array.dtype, np.integer) or (array.size and array.min() < 0):
        raise ValueError(f"parts: vertices and labels of part {k} must be lists of whole numbers ≥ 0")
    return np.ascontiguousarray(array, dtype=np.uint32)


def union(parts: Iterable[object]) -> UnionDecomposer:
    """Join surfaces, curves and grids into one domain: the rows of a signal are those of the first part, then the second, …

    Nothing flows from one part to another, and a width in model units is the same width on each. Everything that takes a
    `Decomposer` takes the result. The values of a CIFTI with both hemispheres are smoothed so at once.

    Parameters
    ----------
    parts : sequence of shape_like, Grid or Decomposer
        Surfaces get heat on the surface; a `Decomposer` must have it. A tuple ``(part, vertices)`` takes some vertices in
        this order, as the rows of a CIFTI do; nothing flows between those of different labels in ``(part, vertices,
        labels)``. A place of a grid is its index in the flat array.

    Returns
    -------
    Decomposer
        With `parts`, the rows of each part as slices.

    Raises
    ------
    ValueError
        If there is no part, or one has another operator than heat.

    Notes
    -----
    O(places + neighbors). Each part takes steps by its own operator, so the result is that of each part by itself to the
    accuracy of the bands.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> left, right = aw.sample("sphere", vertices=500), aw.sample("knot", vertices=800)
    >>> both = aw.union([left, right])
    >>> values = np.random.default_rng(0).normal(size=both.n_vertices)
    >>> smooth = both.smooth(values, fwhm=0.2)
    >>> bool(np.allclose(smooth[both.parts[0]], left.smooth(values[both.parts[0]], fwhm=0.2), atol=1e-8))
    True
    >>> aw.union([(left.points, left.faces), right]).n_vertices == both.n_vertices
    True
    >>> upper = np.flatnonzero(left.points[:, 2] > 0)
    >>> aw.union([(left, upper), aw.grid(np.zeros((5, 6, 7)))]).parts
    (slice(0, 250, None), slice(250, 460, None))
    """
    return UnionDecomposer(parts)
