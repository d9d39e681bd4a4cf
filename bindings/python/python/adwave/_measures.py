"""Where a shape stands out: saliency maps and features, and how well a map agrees with where people look."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._decomposer import Length, SignalLike, prepared
from adwave._progress import ProgressLike, reporting

if TYPE_CHECKING:
    import pandas as pd

_FEATURE = np.dtype(
    [
        ("vertex", np.int64),
        ("position", np.float64, 3),
        ("level", np.int32),
        ("sigma", np.float64),
        ("response", np.float64),
        ("strength", np.float64),
        ("sign", np.int8),
        ("channel", np.int32),
    ]
)


class Saliency(np.ndarray):
    """A map of where a signal stands out: an array of n numbers that knows more.

    With a sign where one side is outside: + convex, − concave; of a scalar + above its surroundings. NaN where masked.

    Attributes
    ----------
    levels : structured array
        level, sigma, mean and max of the wavelets, alpha: the weight of the level.
    sides : str
        Which sides the signs stand for, or why there are none.
    per_level : list of (n,) arrays
        What each level adds, where that was asked for.
    """

    levels: NDArray[Any]
    sides: str
    per_level: list[NDArray[np.float64]]

    def __array_finalize__(self, other: Any) -> None:
        self.levels, self.sides, self.per_level = np.empty(0), "", []

    @property
    def map(self) -> NDArray[np.float64]:
        """The numbers alone."""
        return np.asarray(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return _saliency_again, (np.asarray(self), self.levels, self.sides, self.per_level)


def _saliency_again(
    array: NDArray[np.float64], levels: NDArray[Any], sides: str, per_level: list[NDArray[np.float64]]
) -> Saliency:
    found = array.view(Saliency)
    found.levels, found.sides, found.per_level = levels, sides, per_level
    return found


def saliency(
    shape: object,
    faces: object = None,
    *,
    signal: SignalLike = None,
    weighting: Literal["signed", "paper", "printed", "normalized", "ranks", "none"] = "signed",
    unsigned: bool = False,
    skip: int | None = None,
    border: float | None = None,
    up: Literal["x", "y", "z"] | None = None,
    per_level: bool = False,
    levels: int | None = None,
    lengths: Sequence[Length] | None = None,
    fwhm: Sequence[Length] | None = None,
    steps: Sequence[float] | None = None,
    voices: int | None = None,
    accuracy: float = _native.ACCURACY,
    progress: ProgressLike = None,
    **operator: Any,
) -> Saliency:
    """Map where a shape, or a signal on it, stands out over all levels (eq. 17 and past it).

    Parameters
    ----------
    shape, faces
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    signal : str or array-like, optional
        As for `decompose`.
    weighting : str
        ``'signed'``: 1/mean by how unevenly the level is spread, with the sign. ``'paper'``: (max − mean)² for each level.
        ``'printed'``: (max − |W|)² at each vertex, as eq. 17 is printed. ``'normalized'``: 1/mean. ``'ranks'``. ``'none'``: 1.
    unsigned : bool
        Bumps and dents alike.
    skip : int, optional
        How many of the finest levels are left out.
    border : float, optional
        Mask what lies within so many σ of a border.
    up : {'x', 'y', 'z'}, optional
        Which axis points up: the map becomes ranks, a third of them by height.
    per_level : bool
        Give what each level adds too.
    levels, lengths, fwhm, steps, voices, accuracy, progress, **operator
        As for `decompose`; without levels, until one is 16 % of the diagonal wide.

    Returns
    -------
    Saliency

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.saliency(aw.sample("creature", vertices=2000))
    >>> found.map.shape, found.sides.split(",")[0]
    ((2024,), '+ convex')
    """
    own = prepared(shape, faces, operator, lengths is not None or fwhm is not None)
    reach = _native.REACH["saliency" if weighting == "signed" else "bands"]
    chosen = own.steps(levels=levels, lengths=lengths, fwhm=fwhm, steps=steps, voices=voices, reach=reach)
    owner, values, _ = own._signal(signal)
    if up is not None and up not in ("x", "y", "z"):
        raise ValueError(f"up: {up!r} is none of 'x', 'y', 'z'")
    axis = None if up is None else "xyz".index(up)
    with reporting(progress, "splitting") as report:
        array, each, rows, sides = _native.saliency_map(
            owner._data, values, chosen, accuracy, weighting, unsigned, skip, border, axis, per_level, report
        )
    kinds = np.dtype([("level", np.int32), *((name, np.float64) for name in ("sigma", "mean", "max", "alpha"))])
    return _saliency_again(array, np.array(rows, dtype=kinds), sides, each)


class Features(np.ndarray):
    """Features as a structured array: vertex, position, level, sigma, response, strength, sign, channel.

    Attributes
    ----------
    descriptors : (features, numbers) array or None
        What each place looks like, for matching; where that was asked for.
    """

    descriptors: NDArray[np.float64] | None

    def __array_finalize__(self, other: Any) -> None:
        self.descriptors = None

    def to_pandas(self) -> pd.DataFrame:
        """A `pandas.DataFrame`, position as x, y and z."""
        import pandas

        columns = {
            name: np.asarray(self[name]) for name in ("vertex", "level", "sigma", "response", "strength", "sign")
        }
        x, y, z = np.asarray(self["position"]).reshape(-1, 3).T
        return pandas.DataFrame({"vertex": columns.pop("vertex"), "x": x, "y": y, "z": z, **columns})

    def __reduce__(self) -> tuple[Any, ...]:
        return _features_again, (np.asarray(self), self.descriptors)


def _features_again(array: NDArray[Any], descriptors: NDArray[np.float64] | None) -> Features:
    features = array.view(Features)
    features.descriptors = descriptors
    return features


def features(
    shape: object,
    faces: object = None,
    *,
    signal: SignalLike = None,
    theta: float = _native.THETA,
    response: Literal["normalized", "literal", "channels", "sigma"] = "normalized",
    per_component: bool = False,
    refine: bool = False,
    edge_ratio: float | None = None,
    border: float | None = None,
    best: int | None = None,
    descriptors: bool = False,
    levels: int | None = None,
    lengths: Sequence[Length] | None = None,
    fwhm: Sequence[Length] | None = None,
    steps: Sequence[float] | None = None,
    voices: int | None = None,
    accuracy: float = _native.ACCURACY,
    progress: ProgressLike = None,
    **operator: Any,
) -> Features:
    """Find the places where a level stands out among its neighbors in space and in scale (Algorithm 2).

    Parameters
    ----------
    shape, faces
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    signal : str or array-like, optional
        As for `decompose`.
    theta : float
        How many times the mean response of its level a feature has.
    response : {'normalized', 'literal', 'channels', 'sigma'}
        What is compared in place and scale: each level by its own mean, W itself, every channel by itself, or W by σ.
    per_component : bool
        Take the mean over each connected component.
    refine : bool
        Place features between vertices and levels.
    edge_ratio : float, optional
        Reject edges: the largest ratio of the response's principal curvatures (SIFT takes 10).
    border : float, optional
        Leave out what lies within so many σ of a border.
    best : int, optional
        Keep only so many, the strong ones well spread.
    descriptors : bool
        Describe each, for matching.
    levels, lengths, fwhm, steps, voices, accuracy, progress, **operator
        As for `decompose`; without levels, until one is 4 % of the diagonal wide.

    Returns
    -------
    Features
        A structured array, by level.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.features(aw.sample("creature", vertices=3000), best=2)
    >>> len(found), found["position"].shape
    (2, (2, 3))
    """
    own = prepared(shape, faces, operator, lengths is not None or fwhm is not None)
    reach = _native.REACH["features"]
    chosen = own.steps(levels=levels, lengths=lengths, fwhm=fwhm, steps=steps, voices=voices, reach=reach)
    owner, values, _ = own._signal(signal)
    with reporting(progress, "splitting") as report:
        columns = _native.find_features(
            owner._data,
            values,
            chosen,
            accuracy,
            theta,
            response,
            per_component,
            refine,
            edge_ratio,
            border,
            best,
            descriptors,
            report,
        )
    found = np.empty(len(columns["vertex"]), dtype=_FEATURE)
    for name in _FEATURE.names or ():
        found[name] = columns[name]
    return _features_again(found, columns.get("descriptor"))


def gaze_scores(
    map: ArrayLike, fixations: ArrayLike, *, threshold: float = 0.0, points: ArrayLike | None = None
) -> dict[str, float]:
    """How well a map agrees with where people look.

    Parameters
    ----------
    map : (n,) array-like
    fixations : (n,) array-like
        Seconds, or counts, that people looked at each vertex; NaN where nobody could.
    threshold : float
        More than this is looked at.
    points : (n, 3) array-like, optional
        Positions: what distance from the center explains is taken out of ``partial_correlation``.

    Returns
    -------
    dict
        ``auc``, ``nss``, ``correlation``, ``partial_correlation``, ``n_vertices``, ``n_positive``.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.gaze_scores([0.1, 0.3, 0.2, 0.9], [0, 0, 1, 3])["auc"]
    0.75
    """
    values = np.ascontiguousarray(np.asarray(map, dtype=np.float64))
    looked = np.ascontiguousarray(np.asarray(fixations, dtype=np.float64))
    if values.ndim != 1 or looked.shape != values.shape:
        raise ValueError(f"map: shape {values.shape}, fixations: shape {looked.shape}; give one number for each vertex")
    at = None if points is None else _adapt.points_array(points)
    return _native.gaze_scores(values, looked, threshold, at)
