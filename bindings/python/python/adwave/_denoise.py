"""Noise of a shape, of a signal and of a series of frames: its estimate and its removal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, Literal, NamedTuple, TypeVar, Union, cast, overload

import numpy as np
from numpy.typing import DTypeLike, NDArray

from adwave import _native
from adwave._caller import public
from adwave._decomposer import Decomposer, prepare_decomposer
from adwave._denoise_info import DenoiseInfo
from adwave._edits import LocalFit, refuse_labels, refuse_time, with_named_signal
from adwave._layout import Layout, float_type
from adwave._options import Float, Numbers, Operator, OperatorLike, SignalLike, as_operator
from adwave._part import NoiseModel, Part, default_signal, exact_operator, grid_method, read_part
from adwave._progress import ProgressLike, report_progress
from adwave._shape import Path, Shape
from adwave._time import Time, channels_of, frames_of
from adwave._walk import Walk

if TYPE_CHECKING:
    from typing_extensions import Unpack

    import adwave
    from adwave._part import DenoiseCall, DenoiseKeywords

__all__ = ["DenoiseResult", "denoise"]

#: A kind of object that results come back as.
_Kind = TypeVar("_Kind")
_Faces = TypeVar("_Faces")

_DENOISE = ("signal", "strength", "creases", "noise", "local_fit", "outliers", "operator", "progress")


if TYPE_CHECKING:

    class DenoiseResult(NamedTuple, Generic[_Kind]):
        """A shape or signal without noise, and the estimates that it is based on."""

        result: _Kind
        info: DenoiseInfo

        def __array__(self, dtype: DTypeLike = None, copy: bool | None = None) -> NDArray[Any]: ...

else:

    class DenoiseResult(NamedTuple):
        """A shape or signal without noise, and the estimates that it is based on.

        Attributes
        ----------
        result : object like the shape, or array
            A `Shape` for a `Shape` or a path, a trimesh for a trimesh, a pair for a pair, and so on; an array like the signal if
            numbers are given. Its attributes are those of the `DenoiseResult` too: ``aw.denoise(mesh).vertices``.
        info : dict
            ``noise``: the standard deviation of the noise, in model units of a shape and in the units of a signal. For a
            shape also ``noise_in_edges`` (in mean edges of the noisy shape), ``kept`` (share of the normals that are
            unchanged), ``crease_weights`` and ``smooth_weights`` (shares smoothed by 1, 2, 4 … steps, with and without
            creases kept), ``n_far`` and ``furthest`` (number of vertices that would have moved farther than 3 times the noise,
            where those of a mesh stop, and the largest distance) and ``noise_map`` (the noise at each vertex, in model units: no
            vertex moves farther than 3 times it, impulses aside). For a mesh ``noise_range`` (5 % and 95 % quantile of the noise
            over the vertices, equal if it is the same everywhere), ``kept_by_place`` (share of the normals that are unchanged
            where the surface bends least, in between and most; empty if these are smoothed alike), ``shared_noise`` and
            ``shared_noise_at_most`` (noise that neighbors share as it was assumed, and the most that the mesh admits),
            ``impulse_share`` and ``impulse_size`` (share of the vertices that impulses moved, and their size in model units),
            ``turned_share`` (share of the triangles that noise turned over) and ``linear_rounds`` (rounds of the linear filter
            that come first). For a cloud ``strong_noise`` (the noise that wide fits see where it is larger than half the
            distance of the points and hides among the nearest ones, or None), ``noise_interval`` (holds the true noise in
            9 of 10 generated clouds), ``noise_is_doubtful`` (whether the noise may be larger, because less than half
            of the places have a flat neighborhood: ``flat_share``), ``neighbors`` (nearest points from which 48 are
            drawn: more than 48 in scan lines) and ``two_surfaces`` (whether most neighborhoods seem to hold two, by
            ``residual_ratio``, the mean absolute residual over the root mean square: 0.80 for noise on one). For a
            curve ``noise_by_axis`` (the noise along x, y and z, whose root mean square is ``noise``;
            ``noise_in_edges`` is in mean edges of the result), ``rounding`` (the step to which each coordinate is
            rounded, or 0) and ``length`` (before and after). For a signal ``kept``, ``plain_weights``,
            ``step_weights`` and ``risk`` (expected squared error before and after), for each group of ``channels``.
            With ``time=`` also
            ``widths`` (σ of the bands along time), ``steps`` and ``mean_steps`` (in space) and ``weights``: of each band along
            time, of what is slower and of the mean, as it is, after each of these steps, and left out.

        Examples
        --------
        >>> import adwave as aw
        >>> found = aw.denoise(aw.sample("sphere", vertices=500, noise=0.2))
        >>> found.result.n_vertices, sorted(found.info)[:2]
        (500, ['crease_weights', 'furthest'])
        """

        result: object
        info: DenoiseInfo

        def __getattr__(self, name: str) -> object:
            # So that `denoise(mesh).vertices` is what `filter(mesh, "smooth").vertices` is.
            if name.startswith("_"):
                raise AttributeError(name)
            try:
                return getattr(self.result, name)
            except AttributeError:
                kind = type(self.result).__name__
                raise AttributeError(
                    f"DenoiseResult has result and info, and its result, a {kind}, no {name!r}"
                ) from None

        def __array__(self, dtype: DTypeLike = None, copy: bool | None = None) -> NDArray[Any]:
            return np.array(self.result, dtype=dtype)


@dataclass(frozen=True)
class DenoiseOptions:
    """Options of denoising, as the extension takes them."""

    strength: float = 1.0
    creases: str = "auto"
    noise: Union[float, None] = None
    noise_model: str = "gaussian"
    local_fit: str = "linear"
    outliers: str = "keep"
    shared_noise: Union[float, str] = "detail"


@overload
def denoise(shape: object, signal: NDArray[Float], **options: Unpack[DenoiseCall]) -> DenoiseResult[NDArray[Float]]: ...
@overload
def denoise(shape: object, signal: Numbers, **options: Unpack[DenoiseCall]) -> DenoiseResult[NDArray[np.float64]]: ...
@overload
def denoise(
    shape: adwave.Grid[_Kind], signal: str | None = None, **options: Unpack[DenoiseCall]
) -> DenoiseResult[_Kind]: ...
@overload
def denoise(
    shape: Path | Decomposer | Walk, signal: str | None = None, **options: Unpack[DenoiseCall]
) -> DenoiseResult[Shape]: ...
@overload
def denoise(
    shape: tuple[NDArray[Float], _Faces], signal: None = None, **options: Unpack[DenoiseCall]
) -> DenoiseResult[tuple[NDArray[Float], _Faces]]: ...
@overload
def denoise(shape: _Kind, signal: str | None = None, **options: Unpack[DenoiseCall]) -> DenoiseResult[_Kind]: ...


@public()
def denoise(
    shape: object,
    signal: SignalLike = None,
    *,
    strength: float = 1.0,
    creases: Literal["auto", "keep", "none"] = "auto",
    noise: float | NoiseModel | tuple[NoiseModel, float] | None = None,
    local_fit: LocalFit = "linear",
    outliers: Literal["keep", "pull"] = "keep",
    operator: OperatorLike = None,
    progress: ProgressLike = None,
    **options: Unpack[DenoiseKeywords],
) -> DenoiseResult[Any]:
    """Remove noise from a shape, or from a signal on it, without tuning.

    The amount of noise is estimated, and scaling functions of several widths, with and without steps across creases,
    are mixed by the least estimated risk.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    signal : str or array_like, optional
        A signal instead of the shape, in the axes of `decompose`; each channel is masked where it is NaN.
    strength : float
        Factor of the noise: below 1 more careful, above 1 more thorough.
    creases : {'auto', 'keep', 'none'}
        Whether sharp edges are preserved: as the estimated risk prefers, always, or never.
    noise : float or str or (str, float), optional
        Standard deviation of the noise along the normals in model units, or of the signal, if it is known. For a signal
        also the dependence of the noise on the values: ``'poisson'`` for counts, of which the variance is proportional to
        the value, ``'multiplicative'`` if the standard deviation is proportional to it, ``'rician'`` for magnitudes
        of complex values, as in MRI, whose bias goes too, and ``'gaussian'``, the default.
        With a number, ``('poisson', 1.0)``, that is the standard deviation at a value of 1. For a mesh ``'shared'`` removes
        noise that neighbors share too, as scanners make it: as much as the mesh admits
        (``info["shared_noise_at_most"]``), detail of that size included, or with a number that standard deviation along the
        normals. By default it stays, because it looks like detail.
    local_fit : {'linear', 'constant'}
        What smoothing leaves unchanged in a signal, as in `filter`: with ``'linear'`` slopes are not taken for noise.
    outliers : {'keep', 'pull'}
        Whether outliers of a cloud stay where they are or are moved to their neighbors; ``info["outliers"]`` names them.
    operator : str or Operator, optional
        As in `decompose`; for a shape only ``aw.Operator(weld=…)``.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
    **options
        ``faces=``, and ``mask=`` or ``only=``, the vertices that take part: the others stay as they are.
        ``time=aw.Time(dt=2)`` removes noise in space and time together, from a signal with frames along its last axis (of
        (times, n) along its first): what is steady keeps its detail, and what changes is averaged over what changes alike.

    Returns
    -------
    DenoiseResult
        The result and the estimates. Numbers come back for numbers; without a signal, or for the name of one, an object of
        the caller's kind: a `Shape` for a `Shape` or a path, a trimesh for a trimesh.

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
    time = options.pop("time", None)
    own = grid_method("denoise", shape, options, signal)
    if own is not None:
        given: dict[str, Any] = {} if operator is None else {"operator": operator}
        given.update({} if creases == "auto" else {"creases": creases})
        given.update({} if time is None else {"time": time})
        return own(signal, strength=strength, noise=noise, local_fit=local_fit, progress=progress, **given, **options)
    part = read_part("denoise", shape, options, _DENOISE, signal)
    noise_model, deviation = _noise_model(noise)
    shared: Union[float, str] = "detail"
    if noise_model == "shared":
        shared, deviation = "auto" if deviation is None else deviation, None
    model = "gaussian" if noise_model == "shared" else noise_model
    settings = DenoiseOptions(strength, creases, deviation, model, local_fit, outliers, shared)
    signal = default_signal(part, signal)
    if signal is None or isinstance(signal, str):
        refuse_time(time)
    if signal is None:
        if noise_model not in ("gaussian", "shared"):
            raise ValueError(
                f"noise: {noise_model} noise is that of a signal, not of positions; pass a number or leave it out"
            )
        weld = _only_weld(part, operator)
        with report_progress(progress, "denoising") as report:
            points, info = _native.denoise_points(part.shape._data, settings, weld, report)
        return DenoiseResult(part.moved(part.shape._with_positions(points)), info)
    if creases != "auto":
        raise ValueError("creases: applies to shapes; steps of a signal are preserved anyway: leave it out")
    if noise_model == "shared":
        raise ValueError("noise: 'shared' applies to the positions of a mesh, not to a signal; leave it out")
    decomposer = prepare_decomposer(part.part, exact_operator(operator, options))
    taken = part.take_signal(signal)
    values, layout = decomposer._signal_values(taken)
    refuse_labels(signal, decomposer)
    if time is not None and values is not None:
        clean, series_info = _denoise_frames(decomposer, values, layout, time, settings, progress)
        result = part.spread(layout.arrange(clean), layout, signal)
        return DenoiseResult(result.astype(float_type(signal), copy=False), series_info)
    found: list[DenoiseInfo] = []
    with report_progress(progress, "denoising") as report:

        def denoise_channels(
            owner: Decomposer, values: NDArray[np.float64] | None, channels: list[int]
        ) -> NDArray[np.float64]:
            result, own = _native.denoise_values(owner._data, values, settings, report)
            found.extend(
                cast(DenoiseInfo, {**info, "channels": [channels[c] for c in info["channels"]]}) for info in own
            )
            return result

        denoised = decomposer._map_channels(values, denoise_channels)
        found.sort(key=lambda info: info["channels"])
    info = found[0] if len(found) == 1 else cast(DenoiseInfo, {"groups": found})
    if isinstance(signal, str):
        return DenoiseResult(with_named_signal(part, decomposer.shape, signal, denoised), info)
    found_values = part.spread(layout.arrange(denoised), layout, signal)
    return DenoiseResult(found_values.astype(float_type(signal), copy=False), info)


def _denoise_frames(
    decomposer: Decomposer,
    values: NDArray[np.float64],
    layout: Layout,
    time: Time,
    settings: DenoiseOptions,
    progress: ProgressLike,
) -> tuple[NDArray[np.float64], DenoiseInfo]:
    """A series of n × channels numbers without noise; vertices that are NaN in some frames keep their values."""
    frames = frames_of(values, layout)
    n_components = frames.shape[2]
    series = frames.reshape(len(frames), -1)
    unknown = np.atleast_1d(np.isnan(series).any(axis=1))
    if unknown.any():
        series = series.copy()
        series[unknown] = np.nan
    info = cast(DenoiseInfo, {})
    with report_progress(progress, "denoising") as report:

        def work(owner: Decomposer, part: NDArray[np.float64] | None, _: list[int]) -> NDArray[np.float64]:
            assert part is not None
            result, found = _native.denoise_frames(owner._data, part, n_components, time._options, settings, report)
            info.update(found)
            return result

        found = decomposer._map_channels(series, work)
    clean = channels_of(found.reshape(frames.shape), layout)
    return np.where(unknown[:, None], values, clean), info


def _noise_model(noise: float | str | tuple[str, float] | None) -> tuple[str, float | None]:
    """The model of the noise and its standard deviation, if that is given."""
    if isinstance(noise, str):
        return noise, None
    if isinstance(noise, tuple):
        if len(noise) != 2:
            raise ValueError(f"noise: a pair must be a model and a number, got {len(noise)} entries")
        return noise
    return "gaussian", noise


def _only_weld(part: Part, operator: OperatorLike) -> bool | float:
    """The tolerance of welding, the only option of the operator that denoising a shape honors.

    Raises
    ------
    TypeError
        If there is another option, or a `Decomposer` has some.
    """
    given = as_operator(operator)
    if given != Operator(weld=given.weld):
        raise TypeError("operator: denoising a shape takes no option but weld; leave the others out")
    if isinstance(part.part, Decomposer):
        own = part.part._options
        if own != Operator(kind=own.kind, weld=own.weld) or part.part.mask is not None:
            raise TypeError(
                "shape: denoising builds operators of its own, so that the options and the mask of this Decomposer would have "
                "no effect; pass the shape, aw.denoise(decomposer.shape, mask=…)"
            )
        given = own if given.weld is None else given
    return True if given.weld is None else given.weld
