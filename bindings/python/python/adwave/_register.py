"""Two shapes compared, and a shape simplified."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._argument_order import ask_about_faces
from adwave._caller import public
from adwave._decomposer import Decomposer, prepare_decomposer
from adwave._layout import vertex_weights
from adwave._measures import Features
from adwave._options import Length, OperatorLike, as_operator
from adwave._part import Part, read_part
from adwave._progress import ProgressLike, report_progress
from adwave._shape import Shape

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from adwave._part import PartOptions

_PAIR = np.dtype(
    [
        ("first", np.int64),
        ("second", np.int64),
        ("sigma", np.float64),
        ("distance", np.float64),
        ("confidence", np.float64),
    ]
)


_SIMPLIFY = ("error", "vertices", "ratio", "weights", "keep_border", "progress")


class SimplifyResult(NamedTuple):
    """A shape with fewer vertices, and its distance from the original.

    Attributes
    ----------
    shape : object like the shape
        A `Shape` for a `Shape` or a path, a trimesh for a trimesh, and so on, with the fields, texture coordinates and materials of the remaining vertices and faces.
    vertices : (m,) array of int
        Index in the original of each remaining vertex.
    greatest : float
        Upper bound of the distance between both surfaces, measured on the result, in model units: no point of either is
        farther from the other.
    rms : float
        Root mean square of the distance by area, in model units.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.simplify(aw.sample("sphere", vertices=1000), ratio=0.5)
    >>> found.shape.n_vertices == len(found.vertices)
    True
    """

    shape: Any
    vertices: NDArray[np.uint32]
    greatest: float
    rms: float


@dataclass(frozen=True)
class SimplifyOptions:
    """Target of a simplification, as the extension takes it."""

    error: Union[Length, None]
    vertices: Union[int, None]
    ratio: Union[float, None]
    keep_border: bool
    weights: Union[NDArray[np.float64], None]


@public()
def simplify(
    shape: object,
    *,
    error: Length | None = None,
    vertices: int | None = None,
    ratio: float | None = None,
    weights: ArrayLike | None = None,
    keep_border: bool = False,
    progress: ProgressLike = None,
    **options: Unpack[PartOptions],
) -> SimplifyResult:
    """Remove vertices, and measure the distance of the result from the shape.

    Edges of meshes are collapsed in the order of the quadric error, without a change of the topology: parts, holes and
    handles stay. Clouds are thinned to Poisson disks. Exactly one of `error`, `vertices` and `ratio` is given.

    Parameters
    ----------
    shape : shape_like
        Anything that is a mesh or a cloud; see `Shape`.
    error : float or str, optional
        Largest distance, in model units or as a share of the diagonal such as ``"0.1%"``; the result has as few vertices
        as are found within it, proven for all points of both surfaces. For a cloud, every removed point has a remaining
        one within this distance.
    vertices : int, optional
        Number of vertices of the result; more if the topology needs them.
    ratio : float, optional
        Share of the vertices that remain.
    weights : (n,) array_like or str, optional
        Importance of each vertex of a mesh, or the name of a signal or field; the sign does not count. It multiplies the
        squared distance by which collapses are ordered, so that more vertices remain where it is large.
    keep_border : bool
        Leave the borders of an open mesh unchanged.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
    **options
        ``faces=``, and ``mask=`` or ``only=``: the other vertices are left out.

    Returns
    -------
    SimplifyResult

    Raises
    ------
    ValueError
        If the shape is a graph, not exactly one target is given, or a weight is missing or not finite.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.simplify(aw.sample("creature", vertices=3000), error="0.5%")
    >>> found.shape.n_vertices < 3000 and found.greatest < 0.02
    True
    >>> shape = aw.sample("creature", vertices=3000)
    >>> salient = aw.simplify(shape, ratio=0.2, weights=aw.saliency(shape))
    >>> salient.shape.n_vertices
    606
    """
    if ratio is not None and not 0 < ratio <= 1:
        raise ValueError(f"ratio is the share of the vertices that remain, above 0 and at most 1, got {ratio}")
    # An option of another library is named before the one that it stands for is missed.
    part = read_part("simplify", shape, options, _SIMPLIFY)
    given = [name for name, value in (("error", error), ("vertices", vertices), ("ratio", ratio)) if value is not None]
    if len(given) != 1:
        raise ValueError(f"give one of error, vertices and ratio, got {' and '.join(given) or 'none'}")
    own = part.shape
    importance = None if weights is None else _importance(part, weights)
    with report_progress(progress, "simplifying") as report:
        settings = SimplifyOptions(error, vertices, ratio, keep_border, importance)
        data, remaining, greatest, rms = _native.simplify(own._data, settings, report)
    if remaining is None:
        remaining = np.arange(own.n_vertices, dtype=np.uint32)
    if part.selection is not None:
        remaining = part.selection.rows[remaining].astype(np.uint32)
    return SimplifyResult(_in_kind(part, Shape._from_data(data)), remaining, greatest, rms)


def _importance(part: Part, weights: ArrayLike) -> NDArray[np.float64]:
    """One weight for each vertex that takes part, from an array or the name of a signal."""
    if part.shape.kind != "mesh":
        raise ValueError(f"weights are for meshes, got a {part.shape.kind}; leave them out")
    whole = part.whole_shape
    values = whole.signal(weights) if isinstance(weights, str) else weights
    of_all = vertex_weights(values, whole.n_vertices, "weights")
    return of_all if part.selection is None else of_all[part.selection.rows]


def _in_kind(part: Part, simpler: Shape) -> Any:
    """A simpler shape as an object of the caller's kind."""
    if part.is_own:
        return simpler
    faces = None
    if simpler.kind == "mesh":
        faces = np.array(simpler.faces, dtype=np.int64)
    fields = dict(simpler.fields) if _adapt.holds_fields(part.given) else {}
    return _adapt.with_results(part.given, points=np.array(simpler.points), fields=fields, faces=faces)


class MatchResult(NamedTuple):
    """Corresponding features of two shapes, and the motion between the shapes.

    Attributes
    ----------
    pairs : structured array
        first, second: the vertices; sigma: the size (rms width, model units); distance after the motion, in sigma;
        confidence in [0, 1].
    motion : (4, 4) array or None
        From the first shape to the second; None if no motion fits better than chance.
    median : float or None
        Median distance of the surfaces after the motion, in model units.
    overlap : float or None
        Share of the first shape that has a closest point on the second.
    n_features : (int, int)
        Number of features of both shapes.
    equal_motions : list of (4, 4) arrays
        Other motions that fit equally well, such as those between repeated windows. Confidences are shared among them.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("creature", vertices=5000)
    >>> aw.match(shape, shape).motion.round(3) + 0
    array([[1., 0., 0., 0.],
           [0., 1., 0., 0.],
           [0., 0., 1., 0.],
           [0., 0., 0., 1.]])
    """

    pairs: NDArray[Any]
    motion: NDArray[np.float64] | None
    median: float | None
    overlap: float | None
    n_features: tuple[int, int]
    equal_motions: list[NDArray[np.float64]]


@dataclass(frozen=True)
class MatchOptions:
    """Options of matching, as the extension takes them."""

    theta: float | None
    within: float
    scaled: bool


@public()
def match(
    first: object,
    second: object,
    *,
    theta: float | None = None,
    within: float = 1.0,
    scaled: bool = False,
    operator: OperatorLike = None,
    progress: ProgressLike = None,
) -> MatchResult:
    """Find the motion between two scans of the same object, and their corresponding features.

    Parameters
    ----------
    first, second : shape_like
        Anything that is a mesh or a cloud (see `Shape`), or `Decomposer` objects; or `Features` of both with descriptors,
        whose pairs of nearest descriptors are used, without the surfaces.
    theta : float, optional
        Smallest response of a feature, in multiples of the mean response of its level. By default features are those that
        stand out from what triangles, sampling and noise can cause (see `features`); 1 for a surface without an outside.
    within : float
        Largest distance of a pair, in rms widths of its level.
    scaled : bool
        Whether one shape may be larger than the other, for example in other units.
    operator : str or Operator, optional
        As in `decompose`; heat on the surface by default.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Returns
    -------
    MatchResult

    Raises
    ------
    ValueError
        If a shape is a graph, or an option is invalid.

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
    if isinstance(first, Features) and isinstance(second, Features):
        return _match_features(first, second, within, scaled)
    ask_about_faces("match", first, second)
    one, two = _surface_decomposer(first, operator), _surface_decomposer(second, operator)
    with report_progress(progress, "matching") as report:
        found = _native.match_shapes(one._data, two._data, MatchOptions(theta, within, scaled), report)
    pairs = np.empty(len(found["first"]), dtype=_PAIR)
    for name in _PAIR.names or ():
        pairs[name] = found[name]
    return MatchResult(
        pairs, found["motion"], found["median"], found["overlap"], found["n_features"], found["equal_motions"]
    )


#: Largest quotient of the distances of the nearest and the second nearest descriptor (`lowe2004`).
_RATIO = 0.9
#: Number of motions that are tried, each through three pairs.
_TRIALS = 2000
#: Fewest pairs that agree with a motion which is not one of chance.
_AGREEING = 6


def _match_features(first: Features, second: Features, within: float, scaled: bool) -> MatchResult:
    """Motion between features by their descriptors: nearest ones that agree with a motion through three of them."""
    if first.descriptors is None or second.descriptors is None:
        raise ValueError(
            "first, second: features need descriptors; find them with "
            "aw.features(shape, options=aw.FeatureOptions(descriptors=True))"
        )
    ours, theirs = _descriptor_pairs(first, second)
    from_points, to_points = np.asarray(first["position"])[ours], np.asarray(second["position"])[theirs]
    sigma = np.asarray(first["sigma"])[ours]
    best: NDArray[np.bool_] = np.zeros(len(ours), dtype=bool)
    rng = np.random.default_rng(0)
    for _ in range(_TRIALS if len(ours) >= _AGREEING else 0):
        chosen = rng.choice(len(ours), 3, replace=False)
        motion = _fit_motion(from_points[chosen], to_points[chosen], scaled)
        agrees = _residuals(motion, from_points, to_points) < within * sigma
        best = agrees if agrees.sum() > best.sum() else best
    if best.sum() < _AGREEING:
        return MatchResult(np.empty(0, dtype=_PAIR), None, None, None, (len(first), len(second)), [])
    motion = np.eye(4)
    for _ in range(5):
        motion = _fit_motion(from_points[best], to_points[best], scaled)
        best = _residuals(motion, from_points, to_points) < within * sigma
    pairs = np.empty(int(best.sum()), dtype=_PAIR)
    pairs["first"], pairs["second"] = (
        np.asarray(first["vertex"])[ours[best]],
        np.asarray(second["vertex"])[theirs[best]],
    )
    distance = _residuals(motion, from_points, to_points)[best] / sigma[best]
    pairs["sigma"], pairs["distance"], pairs["confidence"] = sigma[best], distance, best.mean()
    return MatchResult(pairs, motion, None, None, (len(first), len(second)), [])


def _descriptor_pairs(first: Features, second: Features) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Indices of features of the same sign whose descriptors are mutually nearest, and clearly so."""
    one, two = np.asarray(first.descriptors), np.asarray(second.descriptors)
    distance = ((one[:, None] - two[None]) ** 2).sum(axis=2)
    distance[np.asarray(first["sign"])[:, None] != np.asarray(second["sign"])[None]] = np.inf
    if min(distance.shape, default=0) < 2:
        return np.empty(0, np.intp), np.empty(0, np.intp)
    nearest = distance.argmin(axis=1)
    two_least = np.partition(distance, 1, axis=1)[:, :2]
    is_clear = two_least[:, 0] < _RATIO**2 * two_least[:, 1]
    is_mutual = distance.argmin(axis=0)[nearest] == np.arange(len(one))
    ours = np.flatnonzero(is_clear & is_mutual & np.isfinite(two_least[:, 0]))
    return ours, nearest[ours]


def _fit_motion(points: NDArray[np.float64], targets: NDArray[np.float64], scaled: bool) -> NDArray[np.float64]:
    """The rigid motion (and scale) with the least squared distance, (4, 4) (`umeyama1991`)."""
    middle, target = points.mean(axis=0), targets.mean(axis=0)
    u, s, v = np.linalg.svd((targets - target).T @ (points - middle))
    handed = np.array([1.0, 1.0, np.sign(np.linalg.det(u @ v)) or 1.0])
    scale = (s * handed).sum() / (((points - middle) ** 2).sum() or 1.0) if scaled else 1.0
    motion = np.eye(4)
    motion[:3, :3] = scale * (u * handed) @ v
    motion[:3, 3] = target - motion[:3, :3] @ middle
    return motion


def _residuals(
    motion: NDArray[np.float64], points: NDArray[np.float64], targets: NDArray[np.float64]
) -> NDArray[np.float64]:
    return np.linalg.norm(points @ motion[:3, :3].T + motion[:3, 3] - targets, axis=1)


def _surface_decomposer(shape: object, operator: OperatorLike = None) -> Decomposer:
    """A decomposer by heat on the surface, unless another kind or an option of the walk is given."""
    if isinstance(shape, Decomposer):
        return prepare_decomposer(shape, operator)
    options = as_operator(operator)
    return prepare_decomposer(shape, options.with_default_kind("walk" if options.needs_walk() else "surface"))


class Distances(NamedTuple):
    """Distance of each vertex of a shape from another shape.

    Attributes
    ----------
    values : (n,) array
        Model units; > 0 where the other shape lies outside, for a cloud inside of another shape that is closed; NaN beyond the
        border of the other shape and beyond the limit.
    is_signed : bool
        Whether there is a sign: one of the shapes has an outside. Points scattered in a volume have none.
    motion : (4, 4) array
        Motion of the second shape before the measurement.

    Examples
    --------
    >>> import adwave as aw
    >>> sphere = aw.sample("sphere", vertices=500)
    >>> aw.distances(sphere, sphere).motion.shape
    (4, 4)
    """

    values: NDArray[np.float64]
    is_signed: bool
    motion: NDArray[np.float64]


@public()
def distances(
    first: object,
    second: object,
    *,
    align: bool = False,
    limit: Length | None = None,
    progress: ProgressLike = None,
) -> Distances:
    """Signed distance of each vertex of one shape to the closest point of another.

    Their bands, ``decompose(first, distances(first, second).values)``, show at which scale two versions differ.

    Parameters
    ----------
    first, second : shape_like
        Anything that is a mesh or a cloud (see `Shape`), or `Decomposer` objects.
    align : bool
        Fit the second to the first before, by a rigid motion.
    limit : float or str, optional
        Largest distance, in model units or as a share of the diagonal such as ``"1%"``; farther vertices are NaN.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Returns
    -------
    Distances

    Raises
    ------
    ValueError
        If a shape is a graph, or `limit` is invalid.

    Examples
    --------
    >>> import adwave as aw
    >>> sphere = aw.sample("sphere", vertices=2000)
    >>> found = aw.distances(sphere, sphere.with_points(1.1 * sphere.points))
    >>> found.is_signed, round(float(found.values.mean()), 2)
    (True, 0.1)
    """
    ask_about_faces("distances", first, second)
    one, two = _surface_decomposer(first), _surface_decomposer(second)
    with report_progress(progress, "measuring") as report:
        values, is_signed, motion = _native.distances(one._data, two._data, align, limit, report)
    return Distances(values, is_signed, motion)
