"""Saliency maps and features, and scores of how well a map agrees with where people look."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._caller import public
from adwave._decomposer import prepare_decomposer
from adwave._diffusion import EXTENT
from adwave._options import BandsRequest, LevelsLike, OperatorLike, SignalLike, levels_of
from adwave._part import default_signal, exact_operator, grid_method, read_part
from adwave._progress import ProgressLike, report_progress

if TYPE_CHECKING:
    import pandas as pd
    from typing_extensions import Unpack

    from adwave._part import SignalOptions

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


_SALIENCY = ("signal", "weighting", "options", "levels", "operator", "accuracy", "progress")
_FEATURES = ("signal", "theta", "best", "options", "levels", "operator", "accuracy", "progress")

Weighting = Literal["signed", "paper", "printed", "normalized", "ranks", "none"]
Response = Literal["normalized", "literal", "channels", "sigma"]


class Saliency(np.ndarray):
    """Saliency of each vertex: an (n,) array with the numbers of its levels.

    With a sign if one side is outside: + convex, − concave; for a scalar signal + above its surroundings. NaN where
    masked.

    Attributes
    ----------
    levels : structured array
        level, sigma (rms width, model units), mean and max of the wavelets, and alpha, the weight of the level.
    sides : str
        Meaning of the signs, or why there are none.
    per_level : list of (n,) arrays
        Contribution of each level, if requested.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.saliency(aw.sample("creature", vertices=2000))
    >>> found.levels.dtype.names
    ('level', 'sigma', 'mean', 'max', 'alpha')
    """

    levels: NDArray[Any]
    sides: str
    per_level: list[NDArray[np.float64]]

    def __array_finalize__(self, other: Any) -> None:
        self.levels, self.sides, self.per_level = np.empty(0), "", []

    @property
    def map(self) -> NDArray[np.float64]:
        """The values as a plain array, (n,)."""
        return np.asarray(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore_saliency, (np.asarray(self), self.levels, self.sides, self.per_level)


def _restore_saliency(
    array: NDArray[np.float64], levels: NDArray[Any], sides: str, per_level: list[NDArray[np.float64]]
) -> Saliency:
    found = array.view(Saliency)
    found.levels, found.sides, found.per_level = levels, sides, per_level
    return found


@dataclass(frozen=True, kw_only=True)
class SaliencyOptions:
    """Options of `saliency` beyond its weighting.

    Parameters
    ----------
    unsigned : bool
        Treat bumps and dents alike.
    skip : int, optional
        Number of the finest levels to leave out.
    border : float, optional
        Mask vertices within this many rms widths of a border.
    up : {'x', 'y', 'z'}, optional
        Axis that points up: the map becomes ranks, a third of them by height.
    per_level : bool
        Return the contribution of each level too.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("creature", vertices=2000)
    >>> found = aw.saliency(shape, options=aw.SaliencyOptions(unsigned=True, per_level=True))
    >>> len(found.per_level) == len(found.levels) and bool(found.min() >= 0)
    True
    """

    unsigned: bool = False
    skip: Union[int, None] = None
    border: Union[float, None] = None
    up: Union[Literal["x", "y", "z"], None] = None
    per_level: bool = False


@public()
def saliency(
    shape: object,
    signal: SignalLike = None,
    *,
    weighting: Weighting = "signed",
    options: SaliencyOptions | None = None,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    accuracy: float | None = None,
    progress: ProgressLike = None,
    **selection: Unpack[SignalOptions],
) -> Saliency:
    """Map where a shape, or a signal on it, stands out over all levels (eq. 17 and extensions of it).

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    signal : str or array_like, optional
        As in `decompose`; a vertex takes no part where any of its channels is NaN.
    weighting : str
        ``'signed'``: 1/mean times how unevenly the level is spread, with the sign. ``'paper'``: (max − mean)² for each
        level. ``'printed'``: (max − |W|)² at each vertex, as eq. 17 is printed. ``'normalized'``: 1/mean. ``'ranks'``.
        ``'none'``: 1.
    options : SaliencyOptions, optional
        Signs, levels to skip, borders, height.
    levels : int, Widths, Steps or Octaves, optional
        As in `decompose`; by default until one is 16 % of the diagonal wide.
    operator : str or Operator, optional
        As in `decompose`.
    accuracy : float, optional
        As in `decompose`; 1e-4 by default for heat on a mesh, whose triangles cause larger errors, and on a grid.
    progress : bool or callable, optional
        As in `decompose`.
    **selection
        ``faces=``, ``mask=`` or ``only=`` (the map is NaN at the other vertices), ``fwhm=`` and ``steps=`` as in `decompose`.

    Returns
    -------
    Saliency
        An (n,) array.

    Raises
    ------
    ValueError, TypeError
        If an argument is invalid; the message is one line.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.saliency(aw.sample("creature", vertices=2000))
    >>> found.map.shape, found.sides.split(",")[0]
    ((2024,), '+ convex')
    """
    own = grid_method("saliency", shape, selection, signal)
    if own is not None:
        given: dict[str, Any] = {} if operator is None else {"operator": operator}
        return own(
            signal,
            weighting=weighting,
            options=options,
            levels=levels_of(levels, selection),
            accuracy=accuracy,
            progress=progress,
            **given,
        )
    options = options or SaliencyOptions()
    part = read_part("saliency", shape, selection, _SALIENCY, signal)
    levels = levels_of(levels, selection)
    decomposer = prepare_decomposer(
        part.part, exact_operator(operator, selection), levels, analysis=weighting == "signed"
    )
    signal = part.take_signal(default_signal(part, signal))
    steps = decomposer.schedule(levels, extent=EXTENT["saliency" if weighting == "signed" else "bands"])
    owner, values, _ = decomposer._resolve_signal(signal)
    request = BandsRequest(values, steps, owner._data.analysis_accuracy() if accuracy is None else accuracy)
    with report_progress(progress, "splitting") as report:
        array, each, rows, sides = _native.saliency_map(owner._data, request, weighting, options, report)
    kinds = np.dtype([("level", np.int32), *((name, np.float64) for name in ("sigma", "mean", "max", "alpha"))])
    layout, outside = owner._by_place(), owner._outsiders()
    if outside is not None:
        for one in (array, *each):
            one[outside] = np.nan
    array, *each = [part.spread(layout.arrange(one[:, np.newaxis]), layout) for one in (array, *each)]
    return _restore_saliency(array, np.array(rows, dtype=kinds), sides, each)


class Features(np.ndarray):
    """Features as a structured array of vertex, position, level, sigma, response, strength, sign and channel.

    sigma is the size of a feature: the rms width of its level, or near it, in model units. strength is in standard
    deviations of what the mesh and noise can cause; for Algorithm 2 it is in multiples of the mean of the level.

    Attributes
    ----------
    descriptors : (features, numbers) array or None
        Description of each place for matching, if requested.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.features(aw.sample("creature", vertices=5000), best=3)
    >>> found["position"].shape, found["vertex"].dtype
    ((3, 3), dtype('int64'))
    """

    descriptors: NDArray[np.float64] | None

    def __array_finalize__(self, other: Any) -> None:
        self.descriptors = None

    def to_pandas(self) -> pd.DataFrame:
        """A `pandas.DataFrame` with the position as x, y and z."""
        import pandas

        columns = {
            name: np.asarray(self[name]) for name in ("vertex", "level", "sigma", "response", "strength", "sign")
        }
        x, y, z = np.asarray(self["position"]).reshape(-1, 3).T
        return pandas.DataFrame({"vertex": columns.pop("vertex"), "x": x, "y": y, "z": z, **columns})

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore_features, (np.asarray(self), self.descriptors)


def _restore_features(array: NDArray[Any], descriptors: NDArray[np.float64] | None) -> Features:
    features = array.view(Features)
    features.descriptors = descriptors
    return features


@dataclass(frozen=True, kw_only=True)
class FeatureOptions:
    """Options of `features` beyond its threshold.

    Parameters
    ----------
    response : {'normalized', 'literal', 'channels', 'sigma'}
        Quantity compared in space and scale: each level divided by its own mean, W itself, every channel on its own, or W
        divided by the width.
    per_component : bool
        Take the mean over each connected component.
    refine : bool
        Place features between vertices and levels.
    edge_ratio : float, optional
        Reject edges: largest ratio of the response's principal curvatures (SIFT takes 10).
    border : float, optional
        Leave out features within this many rms widths of a border.
    descriptors : bool
        Describe each feature, for matching.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("creature", vertices=5000)
    >>> found = aw.features(shape, best=3, options=aw.FeatureOptions(descriptors=True))
    >>> len(found.descriptors)
    3
    """

    response: Response = "normalized"
    per_component: bool = False
    refine: bool = False
    edge_ratio: Union[float, None] = None
    border: Union[float, None] = None
    descriptors: bool = False


@dataclass(frozen=True)
class FeatureThreshold:
    """Threshold and number of features, as the extension takes them."""

    theta: Union[float, None]
    best: Union[int, None]


@public()
def features(
    shape: object,
    signal: SignalLike = None,
    *,
    theta: float | None = None,
    best: int | None = None,
    options: FeatureOptions | None = None,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    accuracy: float | None = None,
    progress: ProgressLike = None,
    **selection: Unpack[SignalOptions],
) -> Features:
    """Find the places where a level stands out among its neighbors in space and in scale.

    For the coordinates of a mesh or a cloud the response is the part of a band along the normal, and only features that
    stand out against the triangles or the drawing of the points, and against noise, are returned: plain shapes have none.
    Other signals, ``theta``, and ``operator="walk"`` on a mesh give Algorithm 2 of the paper.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    signal : str or array_like, optional
        As in `decompose`.
    theta : float, optional
        Threshold of Algorithm 2: smallest response of a feature, in multiples of the mean response of its level; 2.4 where
        Algorithm 2 applies.
    best : int, optional
        Keep this many features, the strong ones well spread.
    options : FeatureOptions, optional
        Response, refinement, borders, descriptors.
    levels : int, Widths, Steps or Octaves, optional
        As in `decompose`; by default until one is 4 % of the diagonal wide.
    operator : str or Operator, optional
        As in `decompose`.
    accuracy : float, optional
        As in `decompose`; 1e-4 by default for heat on a mesh, whose triangles cause larger errors, and on a grid.
    progress : bool or callable, optional
        As in `decompose`.
    **selection
        ``faces=``, ``mask=`` or ``only=`` (vertices keep their numbers in the whole shape), ``fwhm=`` and ``steps=`` as in
        `decompose`.

    Returns
    -------
    Features
        A structured array, by level.

    Raises
    ------
    ValueError, TypeError
        If an argument is invalid; the message is one line.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.features(aw.sample("creature", vertices=3000), best=2)
    >>> len(found), found["position"].shape
    (2, (2, 3))
    """
    own = grid_method("features", shape, selection, signal)
    if own is not None:
        given: dict[str, Any] = {} if operator is None else {"operator": operator}
        return own(
            signal,
            theta=theta,
            best=best,
            options=options,
            levels=levels_of(levels, selection),
            accuracy=accuracy,
            progress=progress,
            **given,
        )
    options = options or FeatureOptions()
    part = read_part("features", shape, selection, _FEATURES, signal)
    levels = levels_of(levels, selection)
    decomposer = prepare_decomposer(part.part, exact_operator(operator, selection), levels, analysis=True)
    signal = part.take_signal(default_signal(part, signal))
    steps = decomposer.schedule(levels, extent=decomposer._data.feature_extent())
    owner, values, _ = decomposer._resolve_signal(signal)
    request = BandsRequest(values, steps, owner._data.analysis_accuracy() if accuracy is None else accuracy)
    threshold = FeatureThreshold(theta, best)
    with report_progress(progress, "splitting") as report:
        columns = _native.find_features(owner._data, request, threshold, options, report)
    found = np.empty(len(columns["vertex"]), dtype=_FEATURE)
    for name in _FEATURE.names or ():
        found[name] = columns[name]
    if part.selection is not None:
        found["vertex"] = part.selection.rows[found["vertex"]]
    return _restore_features(found, columns.get("descriptor"))


def gaze_scores(
    map: ArrayLike, fixations: ArrayLike, *, threshold: float = 0.0, points: ArrayLike | None = None
) -> dict[str, float]:
    """Scores of how well a map agrees with where people look.

    Parameters
    ----------
    map : (n,) array_like
        Saliency of each vertex.
    fixations : (n,) array_like
        Seconds, or counts, that people looked at each vertex; NaN where nobody could.
    threshold : float
        A vertex with more than this counts as looked at.
    points : (n, 3) array_like, optional
        Positions, to remove from ``partial_correlation`` what the distance from the center explains.

    Returns
    -------
    dict
        ``auc``, ``nss``, ``correlation``, ``partial_correlation`` (NaN without points), ``n_vertices``, ``n_positive``.

    Raises
    ------
    ValueError
        If the arrays do not have one number for each vertex.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.gaze_scores([0.1, 0.3, 0.2, 0.9], [0, 0, 1, 3])["auc"]
    0.75
    """
    values = np.ascontiguousarray(np.asarray(map, dtype=np.float64))
    looked = np.ascontiguousarray(np.asarray(fixations, dtype=np.float64))
    if values.ndim != 1 or looked.shape != values.shape:
        raise ValueError(
            f"map and fixations must have one number for each vertex, got shapes {values.shape} and {looked.shape}"
        )
    return _native.gaze_scores(values, looked, threshold, None if points is None else _adapt.points_array(points))
