"""Bands of a shape, and the shape after an edit or without its noise."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, Union, overload

import numpy as np
from numpy.typing import NDArray

from adwave import _native
from adwave._decomposer import Bands, Decomposer, GainsLike, Layer, Where, edit_layers, prepare_decomposer
from adwave._options import BandsRequest, Constraints, LevelsLike, OperatorLike, SignalLike, as_operator
from adwave._progress import ProgressLike, report_progress
from adwave._shape import Shape, as_shape

__all__ = ["DenoiseResult", "decompose", "denoise", "filter"]


def decompose(
    shape: object,
    *,
    signal: SignalLike = None,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    accuracy: float = _native.ACCURACY,
    progress: ProgressLike = None,
) -> Bands:
    """Split the positions of a shape, or a signal on it, into bands from fine to coarse.

    ``W_f(j) = S_f(j−1) − S_f(j)`` with ``S_f(j) = Φ₁^(n_j) f``; the bands and S_f(J) sum to the signal (eq. 11, eq. 15).

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    signal : str or (n,) or (n, channels) array_like, optional
        The coordinates by default, a signal by its name (see `signal`), or numbers at the vertices. Vertices where it is
        NaN are masked: the diffusion goes around them.
    levels : int, Widths, Steps or Octaves, optional
        A number of dyadic levels (1, 2, 4 … steps of the diffusion); widths, such as ``aw.Widths(fwhm=[2, 4, 8])`` in
        model units or ``aw.Widths(rms=["1%", "2%"])`` of the diagonal; numbers of steps, ``aw.Steps([1, 2.5, 8])``; or
        several levels for each doubling, ``aw.Octaves(6, voices=2)``. By default dyadic levels until one is 2 % of the
        diagonal wide.
    operator : str or Operator, optional
        How the diffusion is built. By default the walk, and heat on the surface if `levels` are widths.
    accuracy : float
        Largest error of a band relative to the band, 1e-13 to 0.1.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total), called from this thread.

    Returns
    -------
    Bands
        An array-like of (levels + 1) × n × channels, which can be changed band by band.

    Raises
    ------
    ValueError, TypeError
        If an argument is invalid; the message is one line.
    MemoryError
        If the bands need more memory than there is.

    Notes
    -----
    All levels together take about ``√(n_J·ln(1/accuracy))`` products with Φ₁. The result has the same bits on any number
    of threads. Ctrl-C ends the call within 50 ms.

    References
    ----------
    Hou & Qin, "Admissible Diffusion Wavelets", IEEE TVCG 2013.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("creature", vertices=2000)
    >>> bands = aw.decompose(shape, levels=5)
    >>> bands.steps
    array([ 1.,  2.,  4.,  8., 16.])
    """
    decomposer = prepare_decomposer(shape, operator, levels)
    return decomposer.decompose(signal, levels=levels, accuracy=accuracy, progress=progress)


LocalFit = Literal["linear", "constant"]


@overload
def filter(
    shape: object,
    gains: GainsLike,
    *,
    where: Where = ...,
    signal: str = ...,
    levels: LevelsLike = ...,
    operator: OperatorLike = ...,
    constraints: Constraints | None = ...,
    local_fit: LocalFit = ...,
    accuracy: float = ...,
    progress: ProgressLike = ...,
) -> Shape: ...


@overload
def filter(
    shape: object,
    gains: GainsLike,
    *,
    where: Where = ...,
    signal: NDArray[Any] | Sequence[float] | Sequence[Sequence[float]],
    levels: LevelsLike = ...,
    operator: OperatorLike = ...,
    constraints: Constraints | None = ...,
    local_fit: LocalFit = ...,
    accuracy: float = ...,
    progress: ProgressLike = ...,
) -> NDArray[np.float64]: ...


def filter(
    shape: object,
    gains: GainsLike,
    *,
    where: Where = None,
    signal: SignalLike = "coords",
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    constraints: Constraints | None = None,
    local_fit: LocalFit = "linear",
    accuracy: float = _native.ACCURACY,
    progress: ProgressLike = None,
) -> Shape | NDArray[np.float64]:
    """Change the bands of a shape, or of a signal on it: smooth, enhance, keep or drop, everywhere or in a region.

    ``f′ = f + Σ_j (Γ(j,x) − 1)·W_f(j,x)``, where Γ is the product of the layers' gains (eq. 18).

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    gains : sequence of float, str, or one or more Layer
        A gain for each band from fine to coarse: 0 drops a band, 1 keeps it, 2 doubles it. Or a preset by its name:
        ``'smooth'`` (or ``'suppress'``) drops all bands but the last, which it doubles, so that limbs and volume are
        preserved (with one level it drops that band); ``'suppress-paper'`` drops all bands, which shrinks limbs;
        ``'enhance'``, ``'band1'``, ``'band2'``. Or several edits as `Layer`.
    where : str or (n,) array_like, optional
        A region in its text form (``"ball:vertex=120,radius=10%"``; see `Decomposer.region`), or a weight for each
        vertex; everywhere by default.
    signal : str or array_like
        What is changed: ``'coords'``, ``'x'``, ``'y'``, ``'z'``, a field of the shape, or numbers at the vertices. Each
        channel is masked where it is NaN, and stays NaN there.
    levels : int, Widths, Steps or Octaves, optional
        As in `decompose`; by default one level for each gain.
    operator : str or Operator, optional
        As in `decompose`.
    constraints : Constraints, optional
        How vertices may move if the coordinates are changed.
    local_fit : {'linear', 'constant'}
        What smoothing leaves unchanged in a signal other than ``'coords'``, and in coordinates that move along one axis:
        ``'linear'`` keeps slopes, however irregular the samples are; ``'constant'`` is the diffusion operator itself,
        as in `decompose` and `Bands.apply`.
    accuracy : float
        As in `decompose`.
    progress : bool or callable, optional
        As in `decompose`.

    Returns
    -------
    Shape, or an array like the signal if numbers are given
        At new positions or with the field changed, and with everything else that its file had.

    Raises
    ------
    ValueError, TypeError
        If an argument is invalid; the message is one line.

    Examples
    --------
    >>> import adwave as aw
    >>> noisy = aw.sample("sphere", vertices=2000, noise=0.3)
    >>> smooth = aw.filter(noisy, "smooth", levels=4)
    >>> head = aw.filter(noisy, [2, 2, 1], where="ball:vertex=0,radius=20%")
    """
    if constraints is not None and constraints.border == "free" and not isinstance(shape, Decomposer):
        operator = as_operator(operator).with_free_ends()
    decomposer = prepare_decomposer(shape, operator, levels)
    layers = edit_layers(gains, where, decomposer.n_vertices)
    if levels is None and not isinstance(gains, str) and not _has_layers(gains):
        levels = len(gains)  # type: ignore[arg-type]
    steps = decomposer.schedule(levels)

    def edit(editor: _native.EditorData) -> NDArray[np.float64]:
        return editor.apply(layers)

    if signal is not None and not isinstance(signal, str):
        values, is_flat = decomposer._signal_values(signal)
        assert values is not None
        with report_progress(progress, "filtering") as report:

            def filtered(owner: Decomposer, values: NDArray[np.float64], _: list[int]) -> NDArray[np.float64]:
                return edit(_native.EditorData(owner._data, BandsRequest(values, steps, accuracy, local_fit), report))

            edited = _map_channels(decomposer, values, filtered)
        return edited[:, 0] if is_flat else edited
    settings = EditSettings(signal or "coords", steps, constraints or Constraints(), local_fit, accuracy)
    return edit_shape(decomposer, settings, edit, progress)


@dataclass(frozen=True)
class EditSettings:
    """The signal of a shape that an edit changes, its levels, and how vertices may move."""

    signal: str
    steps: Sequence[float]
    constraints: Constraints
    local_fit: str = "linear"
    accuracy: float = _native.ACCURACY


def edit_shape(
    decomposer: Decomposer,
    settings: EditSettings,
    edit: Callable[[_native.EditorData], NDArray[np.float64]],
    progress: ProgressLike,
) -> Shape:
    """The shape with one of its signals edited."""
    signal, shape = settings.signal, decomposer.shape
    values, _ = decomposer._signal_values(signal)
    _refuse_labels(signal, values)
    is_linear = settings.local_fit != "constant"
    heights = values is None and is_linear and settings.constraints.along in ("x", "y", "z")
    along = "xyz".index(str(settings.constraints.along)) if heights else 0
    if heights:
        values = np.ascontiguousarray(shape.points[:, along : along + 1])
    # Coordinates that move in several directions are smoothed about their mean; borders have rules of their own.
    fit = settings.local_fit if values is not None else "constant"
    with report_progress(progress, "filtering") as report:

        def filtered(owner: Decomposer, values: NDArray[np.float64] | None, _: list[int]) -> NDArray[np.float64]:
            request = BandsRequest(values, settings.steps, settings.accuracy, fit)
            return edit(_native.EditorData(owner._data, request, report))

        edited = filtered(decomposer, None, []) if values is None else _map_channels(decomposer, values, filtered)
        if heights:
            points = np.array(shape.points)
            points[:, along] = edited[:, 0]
            edited = points
        if values is None or heights:
            moved = decomposer._data.constrain_positions(edited, settings.constraints, report)
            return shape._with_positions(moved)
    axis = "xyz".find(signal) if len(signal) == 1 and signal not in shape.fields else -1
    if axis >= 0:
        points = np.array(shape.points)
        points[:, axis] = edited[:, 0]
        return shape.with_points(points)
    return Shape._from_data(shape._data.with_signal(signal, edited))


def _map_channels(
    decomposer: Decomposer,
    values: NDArray[np.float64],
    compute: Callable[[Decomposer, NDArray[np.float64], list[int]], NDArray[np.float64]],
) -> NDArray[np.float64]:
    """New n × channels values, computed together for channels that are NaN at the same vertices, which are masked.

    `compute` takes the masked decomposer, the values of some channels, and their indices.
    """
    missing = np.isnan(values)
    patterns, group_of_channel = np.unique(missing, axis=1, return_inverse=True)
    if patterns.shape[1] <= 1:
        return compute(
            decomposer._masked_where(np.atleast_1d(missing.any(axis=1))), values, list(range(values.shape[1]))
        )
    result = np.array(values)
    for group in range(patterns.shape[1]):
        channels = np.flatnonzero(np.ravel(group_of_channel) == group)
        # A channel without any value stays as it is.
        if not patterns[:, group].all():
            owner = decomposer._masked_where(patterns[:, group])
            result[:, channels] = compute(owner, np.ascontiguousarray(values[:, channels]), channels.tolist())
    return result


def _refuse_labels(signal: SignalLike, values: NDArray[np.float64] | None) -> None:
    if isinstance(signal, str) and values is not None and _native.labels_of_signal(signal, values):
        raise ValueError(
            f"signal: {signal!r} has labels, and a mean of labels is none: use filter_labels, or give the values as an"
            " array to take them for numbers"
        )


def filter_labels(
    shape: object,
    labels: SignalLike,
    gains: GainsLike,
    *,
    where: Where = None,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    accuracy: float = _native.ACCURACY,
    progress: ProgressLike = None,
) -> NDArray[np.float64]:
    """Change labels by filtering the share of each label.

    The share of a label is 1 where a vertex has it and 0 elsewhere. Each share is filtered, and a vertex gets the label
    with the largest one; on a tie it keeps its own, or else takes the smallest.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    labels : str or (n,) array_like
        A field of the shape, or a label for each vertex; NaN where there is none.
    gains, where, levels, operator, accuracy, progress
        As in `filter`.

    Returns
    -------
    (n,) array of float
        The new labels.

    Raises
    ------
    ValueError, TypeError
        If an argument is invalid; the message is one line.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("sphere", vertices=500)
    >>> classes = (shape.points[:, 2] > 0).astype(float)
    >>> classes[7] = 5  # a vertex with a wrong label
    >>> bool((aw.filter_labels(shape, classes, [0, 0, 0]) == 5).any())
    False
    """
    decomposer = prepare_decomposer(shape, operator, levels)
    layers = edit_layers(gains, where, decomposer.n_vertices)
    if levels is None and not isinstance(gains, str) and not _has_layers(gains):
        levels = len(gains)  # type: ignore[arg-type]
    owner, values, _ = decomposer._resolve_signal(labels)
    request = BandsRequest(values, decomposer.schedule(levels), accuracy)
    with report_progress(progress, "filtering") as report:
        return _native.filter_labels(owner._data, request, layers, report)[:, 0]


def _has_layers(gains: Any) -> bool:
    return isinstance(gains, Layer) or (len(gains) > 0 and all(isinstance(g, Layer) for g in gains))


class DenoiseResult(NamedTuple):
    """A shape or signal without noise, and the estimates that it is based on.

    Attributes
    ----------
    result : Shape or array
        A `Shape`, or an array like the signal.
    info : dict
        ``noise``: the standard deviation of the noise, in model units of a shape and in the units of a signal. For a
        shape also ``noise_in_edges`` (in mean edges of the noisy shape), ``kept`` (share of the normals that are
        unchanged), ``crease_weights`` and ``smooth_weights`` (shares smoothed by 1, 2, 4 … steps, with and without
        creases kept), ``n_far`` and ``furthest`` (number of vertices that moved farther than 3 times the noise, and the
        largest distance). For a mesh ``impulse_share`` and ``impulse_size`` (share of the vertices that impulses moved,
        and their size in model units), ``turned_share`` (share of the triangles that noise turned over) and
        ``linear_rounds`` (rounds of the linear filter that come first). For a signal ``kept``, ``plain_weights``, ``step_weights`` and ``risk`` (expected squared error
        before and after), for each group of ``channels``.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.denoise(aw.sample("sphere", vertices=500, noise=0.2))
    >>> found.result.n_vertices, sorted(found.info)[:2]
    (500, ['crease_weights', 'furthest'])
    """

    result: Any
    info: dict[str, Any]


@dataclass(frozen=True)
class DenoiseOptions:
    """Options of denoising, as the extension takes them."""

    strength: float = 1.0
    creases: str = "auto"
    noise: Union[float, None] = None
    local_fit: str = "linear"
    outliers: str = "keep"


def denoise(
    shape: object,
    *,
    signal: SignalLike = None,
    strength: float = 1.0,
    creases: Literal["auto", "keep", "none"] = "auto",
    noise: float | None = None,
    local_fit: LocalFit = "linear",
    outliers: Literal["keep", "pull"] = "keep",
    operator: OperatorLike = None,
    progress: ProgressLike = None,
) -> DenoiseResult:
    """Remove noise from a shape, or from a signal on it, without tuning.

    The amount of noise is estimated, and scaling functions of several widths, with and without steps across creases,
    are mixed by the least estimated risk.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    signal : str or (n,) or (n, channels) array_like, optional
        A signal instead of the shape; each channel is masked where it is NaN.
    strength : float
        Factor of the noise: below 1 more careful, above 1 more thorough.
    creases : {'auto', 'keep', 'none'}
        Whether sharp edges are preserved: as the estimated risk prefers, always, or never.
    noise : float, optional
        Standard deviation of the noise along the normals in model units, if it is known.
    local_fit : {'linear', 'constant'}
        What smoothing leaves unchanged in a signal, as in `filter`: with ``'linear'`` slopes are not taken for noise.
    outliers : {'keep', 'pull'}
        Whether outliers of a cloud stay where they are or are moved to their neighbors; ``info["outliers"]`` names them.
    operator : str or Operator, optional
        As in `decompose`; for a shape only ``aw.Operator(weld=…)``.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Returns
    -------
    DenoiseResult
        The shape or array, and the estimates.

    Raises
    ------
    ValueError, TypeError
        If an argument is invalid, or does not apply to a shape or to a signal.

    Examples
    --------
    >>> import adwave as aw
    >>> noisy = aw.sample("torus", vertices=3000, noise=0.3)
    >>> clean, info = aw.denoise(noisy)
    >>> 0.1 < info["noise_in_edges"] < 0.5
    True
    """
    options = DenoiseOptions(strength, creases, noise, local_fit, outliers)
    if signal is None:
        own = shape.shape if isinstance(shape, Decomposer) else as_shape(shape)
        given = as_operator(operator)
        if given != type(given)(weld=given.weld):
            raise TypeError("operator: denoising a shape takes no option but weld; leave the others out")
        with report_progress(progress, "denoising") as report:
            points, info = _native.denoise_points(
                own._data, options, True if given.weld is None else given.weld, report
            )
        return DenoiseResult(own._with_positions(points), info)
    if creases != "auto":
        raise ValueError("creases: applies to shapes; steps of a signal are preserved anyway: leave it out")
    decomposer = prepare_decomposer(shape, operator)
    values, is_flat = decomposer._signal_values(signal)
    _refuse_labels(signal, values)
    found: list[dict[str, Any]] = []
    with report_progress(progress, "denoising") as report:
        if values is None:
            denoised, found = _native.denoise_values(decomposer._data, values, options, report)
        else:

            def denoise_channels(
                owner: Decomposer, values: NDArray[np.float64], channels: list[int]
            ) -> NDArray[np.float64]:
                result, own = _native.denoise_values(owner._data, values, options, report)
                found.extend({**info, "channels": [channels[c] for c in info["channels"]]} for info in own)
                return result

            denoised = _map_channels(decomposer, values, denoise_channels)
            found.sort(key=lambda info: info["channels"])
    info = dict(found[0]) if len(found) == 1 else {"groups": found}
    return DenoiseResult(denoised[:, 0] if is_flat else denoised, info)
