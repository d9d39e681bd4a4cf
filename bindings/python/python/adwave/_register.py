"""Two shapes compared, and one with fewer vertices."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from adwave import _native
from adwave._decomposer import Length, prepared
from adwave._progress import ProgressLike, reporting
from adwave._shape import Shape, as_shape

_PAIR = np.dtype(
    [
        ("first", np.int64),
        ("second", np.int64),
        ("sigma", np.float64),
        ("distance", np.float64),
        ("confidence", np.float64),
    ]
)


class Simplified(NamedTuple):
    """A shape with fewer vertices, and how far it is from what it was."""

    shape: Shape
    """With the fields, texture coordinates and materials of the vertices and faces that are left."""
    kept: NDArray[np.uint32]
    """Which vertices of the original it has."""
    greatest: float
    """The greatest distance between both surfaces, measured, model units."""
    rms: float
    """The root mean square of it by area."""


def simplify(
    shape: object,
    faces: object = None,
    *,
    error: Length | None = None,
    vertices: int | None = None,
    ratio: float | None = None,
    keep_border: bool = False,
    progress: ProgressLike = None,
) -> Simplified:
    """Drop vertices, and measure how far the result is from the shape.

    Edges of meshes are collapsed in the order of the quadric error; clouds are thinned to Poisson disks.

    Parameters
    ----------
    shape, faces
        Anything that is a mesh or a cloud; see `Shape`.
    error : float or str, optional
        As few vertices as a distance of at most this allows, in model units or in ``"0.1%"`` of the diagonal; of a cloud, the
        distance within which every dropped point has one that is kept.
    vertices : int, optional
        So many vertices.
    ratio : float, optional
        This share of the vertices.
    keep_border : bool
        Leave the borders of an open mesh as they are.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total).

    Returns
    -------
    Simplified

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.simplify(aw.sample("creature", vertices=3000), error="0.5%")
    >>> found.shape.n_vertices < 3000 and found.greatest < 0.02
    True
    """
    asked = [name for name, value in (("error", error), ("vertices", vertices), ("ratio", ratio)) if value is not None]
    if len(asked) != 1:
        raise ValueError(f"give one of error, vertices and ratio, not {' and '.join(asked) or 'none'}")
    own = as_shape(shape, faces)
    with reporting(progress, "simplifying") as report:
        data, kept, greatest, rms = _native.simplified(own._data, error, vertices, ratio, keep_border, report)
    if kept is None:
        kept = np.arange(own.n_vertices, dtype=np.uint32)
    return Simplified(Shape._of(data), kept, greatest, rms)


class Matched(NamedTuple):
    """Which features of two shapes are the same, and the motion between them."""

    pairs: NDArray[Any]
    """first, second: the vertices; sigma: the size; distance after the motion, in sigma; confidence in [0, 1]."""
    motion: NDArray[np.float64] | None
    """4 × 4, from the first shape to the second; None where no motion explains the features better than chance."""
    median: float | None
    """Median distance of the surfaces after the motion, model units."""
    overlap: float | None
    """Share of the first that has a closest point on the second."""
    n_features: tuple[int, int]
    """How many features were found on both."""


def match(
    first: object,
    second: object,
    *,
    theta: float = 1.0,
    within: float = 2.0,
    scaled: bool = False,
    progress: ProgressLike = None,
    **operator: Any,
) -> Matched:
    """Find the motion between two scans of one thing, and which of their features are the same.

    Parameters
    ----------
    first, second
        Anything that is a mesh or a cloud (pairs of points and faces as tuples; see `Shape`), or `Decomposer` objects.
    theta : float
        How many times the mean response of its level a feature has.
    within : float
        Pairs are at most so many sigma apart.
    scaled : bool
        Whether one may be larger than the other, as where units differ.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total).
    **operator
        The options of `Decomposer`; heat on the surface by default.

    Returns
    -------
    Matched

    Examples
    --------
    >>> import adwave as aw
    >>> scan = aw.sample("creature", vertices=8000, noise=0.1)
    >>> turned = scan.with_points(scan.points[:, [1, 2, 0]])
    >>> found = aw.match(scan, turned)
    >>> found.motion[:3, :3].round(2) + 0
    array([[0., 1., 0.],
           [0., 0., 1.],
           [1., 0., 0.]])
    """
    one = prepared(first, None, dict(operator), by_width=True)
    two = prepared(second, None, dict(operator), by_width=True)
    with reporting(progress, "matching") as report:
        found = _native.matched(one._data, two._data, theta, within, scaled, report)
    pairs = np.empty(len(found["first"]), dtype=_PAIR)
    for name in _PAIR.names or ():
        pairs[name] = found[name]
    return Matched(pairs, found["motion"], found["median"], found["overlap"], found["n_features"])


class Distances(NamedTuple):
    """How far each vertex of a shape is from another shape."""

    values: NDArray[np.float64]
    """Model units; > 0 where the other lies outside; NaN beyond its border and beyond the limit."""
    is_signed: bool
    """Whether there is a sign: the shape has an outside."""
    motion: NDArray[np.float64]
    """4 × 4: how the second was moved before."""


def distances(
    first: object,
    second: object,
    *,
    align: bool = False,
    limit: Length | None = None,
    progress: ProgressLike = None,
) -> Distances:
    """The signed distance of each vertex of one shape to the closest point of another.

    Their bands, ``decompose(first, signal=distances(first, second).values)``, say at which scale two versions differ.

    Parameters
    ----------
    first, second
        Anything that is a mesh or a cloud (pairs of points and faces as tuples; see `Shape`), or `Decomposer` objects.
    align : bool
        Fit the second to the first before, by a rigid motion.
    limit : float or str, optional
        What is farther has no value; in model units or in ``"1%"`` of the diagonal.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total).

    Examples
    --------
    >>> import adwave as aw
    >>> sphere = aw.sample("sphere", vertices=2000)
    >>> found = aw.distances(sphere, sphere.with_points(1.1 * sphere.points))
    >>> found.is_signed, round(float(found.values.mean()), 2)
    (True, 0.1)
    """
    one, two = prepared(first, None, {}, by_width=True), prepared(second, None, {}, by_width=True)
    with reporting(progress, "measuring") as report:
        values, is_signed, motion = _native.distances(one._data, two._data, align, limit, report)
    return Distances(values, is_signed, motion)
