"""Bands of a shape, and the shape after an edit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeVar, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._caller import Call, public, warn
from adwave._columns import channels_axis, map_columns
from adwave._decomposer import (
    Bands,
    Decomposer,
    GainsLike,
    Layer,
    Where,
    edit_layers,
    prepare_decomposer,
    split_signal,
)
from adwave._diffusion import smoothing_levels
from adwave._layout import Layout, float_type
from adwave._misfit import misfit, working_line
from adwave._option_rules import is_number
from adwave._options import (
    BandsRequest,
    Constraints,
    Float,
    Length,
    LevelsLike,
    Numbers,
    OperatorLike,
    SignalLike,
    as_operator,
    levels_of,
)
from adwave._other_names import PRESETS
from adwave._part import Part, default_signal, exact_operator, grid_method, read_part
from adwave._progress import ProgressLike, report_progress
from adwave._shape import Path, Shape
from adwave._time import Time, frames_axis, split_in_time
from adwave._walk import Walk

if TYPE_CHECKING:
    from typing_extensions import Unpack

    import adwave
    from adwave._part import (
        FilterCall,
        FilterOptions,
        PrecisionOptions,
        SignalOptions,
        SmoothCall,
        SmoothInTimeOptions,
    )

__all__ = ["decompose", "filter", "filter_labels", "smooth"]

#: A kind of object that results come back as.
_Kind = TypeVar("_Kind")
_Faces = TypeVar("_Faces")


@overload
def decompose(
    shape: object,
    signal: NDArray[Float],
    *,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    accuracy: float = ...,
    time: None = None,
    progress: ProgressLike = None,
    **options: Unpack[PrecisionOptions],
) -> Bands[Float]: ...
@overload
def decompose(
    shape: object,
    signal: Numbers,
    *,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    accuracy: float = ...,
    time: None = None,
    progress: ProgressLike = None,
    **options: Unpack[PrecisionOptions],
) -> Bands: ...
@overload
def decompose(
    shape: adwave.Grid[NDArray[Float]],
    signal: None = None,
    *,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    accuracy: float = ...,
    time: None = None,
    progress: ProgressLike = None,
    **options: Unpack[PrecisionOptions],
) -> Bands[Float]: ...
@overload
def decompose(
    shape: Path | Shape | Decomposer | Walk | NDArray[np.float64] | tuple[Any, Any],
    signal: str | None = None,
    *,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    accuracy: float = ...,
    time: None = None,
    progress: ProgressLike = None,
    **options: Unpack[PrecisionOptions],
) -> Bands: ...
@overload
def decompose(
    shape: object,
    signal: SignalLike = None,
    *,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    accuracy: float = ...,
    time: None = None,
    progress: ProgressLike = None,
    **options: Unpack[PrecisionOptions],
) -> Bands[Any]: ...
@overload
def decompose(
    shape: object,
    signal: NDArray[Float],
    *,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    accuracy: float = ...,
    time: Time,
    progress: ProgressLike = None,
    **options: Unpack[PrecisionOptions],
) -> NDArray[Float]: ...
@overload
def decompose(
    shape: object,
    signal: SignalLike = None,
    *,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    accuracy: float = ...,
    time: Time,
    progress: ProgressLike = None,
    **options: Unpack[PrecisionOptions],
) -> NDArray[Any]: ...


@public()
def decompose(
    shape: object,
    signal: SignalLike = None,
    *,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    accuracy: float = _native.ACCURACY,
    time: Time | None = None,
    progress: ProgressLike = None,
    **options: Unpack[PrecisionOptions],
) -> Bands[Any] | NDArray[Any]:
    """Split the positions of a shape, or a signal on it, into bands from fine to coarse.

    ``W_f(j) = S_f(j−1) − S_f(j)`` with ``S_f(j) = Φ₁^(n_j) f``; the bands and S_f(J) sum to the signal (eq. 11, eq. 15).

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    signal : str or array_like, optional
        The coordinates by default, a signal by its name (see `signal`), or numbers at the vertices: (n,), (n, channels),
        (n, 3, times) or (times, n). Each channel is masked where it is NaN: the diffusion goes around these vertices.
    levels : int, Widths, Steps or Octaves, optional
        A number of dyadic levels (1, 2, 4 … steps of the diffusion); widths, such as ``aw.Widths(fwhm=[2, 4, 8])`` in
        model units or ``aw.Widths(rms=["1%", "2%"])`` of the diagonal; numbers of steps, ``aw.Steps([1, 2.5, 8])``; or
        several levels for each doubling, ``aw.Octaves(6, voices=2)``. By default dyadic levels until one is 2 % of the
        diagonal wide.
    operator : str or Operator, optional
        How the diffusion is built. By default the walk, and heat on the surface if `levels` are widths.
    accuracy : float
        Largest error of a band relative to the band, 1e-13 to 0.1.
    time : Time, optional
        Bands along time too, of a signal with frames along its last axis (of (times, n) along its first).
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total), called from this thread.
    **options
        ``faces=`` of an array of points; ``mask=`` or ``only=``, the vertices that take part (the bands of the others are
        NaN); ``fwhm=[2, 4, 8]`` and ``steps=[1, 2.5, 8]``, short for `levels`; ``exact=True``, heat on a surface with the
        masses of the mesh as they are (see `Operator.with_exact_masses`); ``precision='single'`` for bands in 32 bits (by
        default where its error bound keeps to the accuracy; the bound is in ``bands.info``).

    Returns
    -------
    Bands
        An array of (levels + 1) × the shape of the signal, which can be changed band by band, in the number type of a
        signal of floats (float32 for float32). With `time` a plain array, (levels + 1) × (levels of time + 1) × the shape
        of the signal.

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
    >>> heights = aw.decompose(shape, shape.points[:, 2], fwhm=["2%", "4%"])
    >>> heights.shape
    (3, 2024)
    """
    own = grid_method("decompose", shape, options, signal)
    if own is not None:
        given = {} if time is None else {"time": time}
        return own(signal, levels=levels, accuracy=accuracy, progress=progress, **given, **options)
    part = read_part("decompose", shape, options, _DECOMPOSE, signal)
    levels = levels_of(levels, options)
    signal = part.take_signal(default_signal(part, signal))
    decomposer = prepare_decomposer(part.part, exact_operator(operator, options), levels)
    values, layout = decomposer._signal_values(signal)
    precision = options.get("precision") or "auto"
    request = BandsRequest(values, decomposer.schedule(levels), accuracy, precision=precision)
    bands = split_signal(decomposer, request, layout, part.selection, progress, float_type(signal))
    return bands if time is None else split_in_time(time, np.asarray(bands), layout, progress)


@overload
def smooth(
    shape: object, signal: NDArray[Float], steps: float | None = None, **options: Unpack[SmoothCall]
) -> NDArray[Float]: ...
@overload
def smooth(
    shape: object, signal: Numbers, steps: float | None = None, **options: Unpack[SmoothCall]
) -> NDArray[np.float64]: ...
@overload
def smooth(
    shape: adwave.Grid[_Kind], signal: str | None = None, steps: float | None = None, **options: Unpack[SmoothCall]
) -> _Kind: ...
@overload
def smooth(
    shape: Path | Decomposer | Walk,
    signal: str | None = None,
    steps: float | None = None,
    **options: Unpack[SmoothCall],
) -> Shape: ...
@overload
def smooth(
    shape: tuple[NDArray[Float], _Faces], signal: None = None, steps: float | None = None, **options: Unpack[SmoothCall]
) -> tuple[NDArray[Float], _Faces]: ...
@overload
def smooth(
    shape: _Kind, signal: str | None = None, steps: float | None = None, **options: Unpack[SmoothCall]
) -> _Kind: ...


@public()
def smooth(
    shape: object,
    signal: SignalLike = None,
    steps: float | None = None,
    *,
    fwhm: Length | Sequence[float] | None = None,
    rms: Length | Sequence[float] | None = None,
    lazy: bool = True,
    operator: OperatorLike = None,
    accuracy: float = _native.ACCURACY,
    progress: ProgressLike = None,
    **options: Unpack[SmoothInTimeOptions],
) -> object:
    """Smooth a signal on a shape, or the shape itself, by one width or number of steps: ``Φ₁^steps f``.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    signal : str or array_like, optional
        As in `decompose`; the coordinates by default, which shrinks the shape (``aw.filter(shape, "smooth")`` does not).
    steps : float, optional
        Number of steps of the diffusion. Exactly one of the three is given.
    fwhm : float or str, optional
        Full width at half maximum, in model units or as a share of the diagonal such as ``"2%"``; of an image or a volume
        also one for each axis.
    rms : float or str, optional
        Root mean square distance that a value spreads to, in the same units; on a surface √2 times the standard deviation
        along one axis.
    lazy : bool
        The walk stays where it is half of the time, ``½(I + D⁻¹A)`` on a graph with weights A; False for whole steps of the
        walk that always moves, ``D⁻¹A``.
    operator : str or Operator, optional
        As in `decompose`: by default heat on the surface for widths, and the walk for steps. Between whole numbers of
        steps the walk may leave the range of the signal by a few percent; heat never does.
    accuracy : float
        Largest error relative to the change.
    progress : bool or callable, optional
        As in `decompose`.
    **options
        ``faces=``, ``mask=`` or ``only=``, and ``exact=True`` as in `decompose`; ``time=aw.Time(dt=2, fwhm=4)`` smooths a
        signal with frames along its last axis (of (times, n) along its first) along time too.

    Returns
    -------
    array like the signal, or an object like the shape
        Numbers if numbers are given, in the number type of a signal of floats (float32 for float32). Without a signal, or
        for the name of one, an object of the caller's kind: a `Shape` for a `Shape` or a path, a trimesh for a trimesh.

    Raises
    ------
    ValueError, TypeError
        If an argument is invalid; the message is one line.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("sphere", vertices=2000)
    >>> f = shape.points[:, 2]
    >>> smooth = aw.smooth(shape, f, fwhm=0.5)
    >>> smooth.shape, bool(smooth.std() < f.std())
    ((2000,), True)
    """
    time = options.pop("time", None)
    if steps is not None and not is_number(steps) and np.ndim(steps):
        given = {"fwhm": fwhm, "rms": rms, "operator": operator, "time": time, **options}
        given = {name: value for name, value in given.items() if value is not None}
        why = "smooth takes a number of steps third, got an array"
        raise TypeError(misfit(smooth, (shape, signal, steps), given, why))
    own = grid_method("smooth", shape, options, signal)
    if own is not None:
        given = {"fwhm": fwhm, "rms": rms, "operator": operator, "time": time}
        given = {name: value for name, value in given.items() if value is not None}
        return own(signal, steps, accuracy=accuracy, progress=progress, **given, **options)
    is_plain = time is None and not options and lazy
    if isinstance(shape, Walk) and steps is not None and fwhm is None and rms is None and is_plain:
        powers = shape._powers(signal, steps, progress)
        if powers is not None:
            return powers
    part = read_part("smooth", shape, options, _SMOOTH, signal)
    levels = smoothing_levels(steps, rms, fwhm)
    signal = default_signal(part, signal)
    decomposer = prepare_decomposer(part.part, exact_operator(operator, options), levels)
    taken, schedule = part.take_signal(signal), decomposer.schedule(levels)
    refuse_labels(signal, decomposer)
    if lazy:
        values = decomposer._smooth(taken, schedule, accuracy, progress)
    else:
        values = decomposer._walk(taken, levels)
    if signal is not None and not isinstance(signal, str):
        layout = _layout_of(decomposer, taken)
        found = part.spread(values, layout).astype(float_type(signal), copy=False)
        return found if time is None else time.smooth(found, axis=frames_axis(layout), progress=progress)
    refuse_time(time)
    return with_named_signal(part, decomposer.shape, signal or "coords", values)


def refuse_time(time: Time | None) -> None:
    if time is not None:
        raise ValueError("time: it applies to numbers with frames, (n, times); pass them as the signal, (shape, f, …)")


def _layout_of(decomposer: Decomposer, signal: SignalLike) -> Layout:
    return decomposer._signal_values(signal)[1]


def with_named_signal(part: Part, shape: Shape, name: str, values: NDArray[np.float64]) -> Any:
    """The caller's object with new values of a signal that was named."""
    return part.with_named_signal(_changed(shape, name, values), name)


def _changed(shape: Shape, name: str, values: NDArray[np.float64]) -> Shape:
    if name == "coords":
        return shape._with_positions(np.ascontiguousarray(values))
    if name in ("x", "y", "z") and name not in shape.fields:
        points = np.array(shape.points)
        points[:, "xyz".index(name)] = values.reshape(-1)
        return shape.with_points(points)
    rows = np.ascontiguousarray(values.reshape(len(values), -1))
    return Shape._from_data(shape._data.with_signal(name, rows))


LocalFit = Literal["linear", "constant"]

#: Gains of bands, or a function of the eigenvalues of the Laplacian.
FilterGains = Union[GainsLike, Callable[[NDArray[np.float64]], ArrayLike]]


def _gains_last(arguments: tuple[Any, ...], options: dict[str, Any]) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """Arguments of `filter` with the signal before the gains: gains alone change the coordinates."""
    if len(arguments) != 2 or "gains" in options:
        return arguments, options
    if "signal" in options:
        warn(
            "filter(shape, gains, signal=f) is now filter(shape, f, gains), and will go in the next release",
            DeprecationWarning,
        )
        options = dict(options)
        return (arguments[0], options.pop("signal"), arguments[1]), options
    return (arguments[0], None, arguments[1]), options


@overload
def filter(
    shape: object, signal: NDArray[Float], gains: FilterGains, **options: Unpack[FilterCall]
) -> NDArray[Float]: ...
@overload
def filter(
    shape: object, signal: Numbers, gains: FilterGains, **options: Unpack[FilterCall]
) -> NDArray[np.float64]: ...
@overload
def filter(shape: adwave.Grid[_Kind], gains: FilterGains, /, **options: Unpack[FilterCall]) -> _Kind: ...
@overload
def filter(
    shape: adwave.Grid[_Kind], signal: str | None, gains: FilterGains, **options: Unpack[FilterCall]
) -> _Kind: ...
@overload
def filter(shape: Path | Decomposer | Walk, gains: FilterGains, /, **options: Unpack[FilterCall]) -> Shape: ...
@overload
def filter(
    shape: Path | Decomposer | Walk, signal: str | None, gains: FilterGains, **options: Unpack[FilterCall]
) -> Shape: ...
@overload
def filter(
    shape: tuple[NDArray[Float], _Faces], gains: FilterGains, /, **options: Unpack[FilterCall]
) -> tuple[NDArray[Float], _Faces]: ...
@overload
def filter(shape: _Kind, gains: FilterGains, /, **options: Unpack[FilterCall]) -> _Kind: ...
@overload
def filter(shape: _Kind, signal: str | None, gains: FilterGains, **options: Unpack[FilterCall]) -> _Kind: ...


@public(_gains_last)
def filter(
    shape: object,
    signal: SignalLike | FilterGains = None,
    gains: FilterGains | None = None,
    *,
    where: Where = None,
    levels: LevelsLike = None,
    operator: OperatorLike = None,
    constraints: Constraints | None = None,
    local_fit: LocalFit | None = None,
    progress: ProgressLike = None,
    **options: Unpack[FilterOptions],
) -> object:
    """Change the bands of a shape, or of a signal on it: smooth, enhance, keep or drop, everywhere or in a region.

    ``f′ = f + Σ_j (Γ(j,x) − 1)·W_f(j,x)``, where Γ is the product of the layers' gains (eq. 18).

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    signal : str or array_like, optional
        What is changed; it may be left out, ``filter(shape, gains)``: ``'coords'`` (the default), ``'x'``, ``'y'``,
        ``'z'``, a field of the shape, or numbers at the
        vertices, in the axes of `decompose`. Each channel is masked where it is NaN, and stays NaN there. An array of 16
        and more channels that is mapped from a file (``np.load(path, mmap_mode="r")``) is read in groups of channels, and
        the result is mapped from a temporary file.
    gains : sequence of float, str, callable, or one or more Layer
        A gain for each band from fine to coarse: 0 drops a band, 1 keeps it, 2 doubles it. Or a preset by its name:
        ``'smooth'`` (or ``'suppress'``) drops all bands but the last, which it doubles, so that limbs and volume are
        preserved (with one level it drops that band); ``'suppress-paper'`` drops all bands, which shrinks limbs;
        ``'enhance'``, ``'band1'``, ``'band2'``. Or several edits as `Layer`. Or a function of the eigenvalues of the
        Laplacian, ``lambda x: 1 / (1 + x)``, as `adwave.kernels.apply` takes it, with ``accuracy=`` (1e-8 by default) and
        without levels and regions.
    where : str or (n,) array_like, optional
        A region in its text form (``"ball:vertex=120,radius=10%"``; see `Decomposer.region`), a weight for each vertex, or
        indices of vertices; everywhere by default.
    levels : int, Widths, Steps or Octaves, optional
        As in `decompose`; by default one level for each gain.
    operator : str or Operator, optional
        As in `decompose`.
    constraints : Constraints, optional
        How vertices may move if the coordinates are changed; an error for other signals.
    local_fit : {'linear', 'constant'}, optional
        What smoothing leaves unchanged in a signal other than ``'coords'``, and in coordinates that move along one axis:
        ``'linear'`` keeps slopes, however irregular the samples are; ``'constant'`` is the diffusion operator itself,
        as in `decompose` and `Bands.apply`. By default linear, and constant on an image or a volume.
    progress : bool or callable, optional
        As in `decompose`.
    **options
        ``faces=``, ``mask=`` or ``only=`` (the other vertices keep their values), ``fwhm=``, ``steps=`` and, with
        ``local_fit='constant'`` or coordinates, ``precision=`` and ``accuracy=`` as in `decompose`; ``time=`` smooths along
        time too, as in `smooth` (other gains along time are those of `Time.filter`, before or after).

    Returns
    -------
    object like the shape, or an array like the signal if numbers are given
        At new positions or with the field changed: a `Shape` for a `Shape`, a path or a `Decomposer`, with everything else
        that its file had; a trimesh for a trimesh, a pair for a pair, and so on.

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
    >>> heights = aw.filter(noisy, noisy.points[:, 2], [0, 1, 1])
    """
    if callable(gains) or (gains is None and callable(signal)):
        given = {"where": where, "levels": levels, "constraints": constraints, "local_fit": local_fit}
        return _filter_by_kernel(shape, signal, gains, operator, progress, {**given, **options})
    time = options.pop("time", None)
    own = grid_method("filter", shape, options, None if gains is None else signal)
    if own is not None:
        given = {"local_fit": local_fit, "operator": operator, "constraints": constraints, "time": time}
        given = {name: value for name, value in given.items() if value is not None}
        return own(signal, gains, where=where, levels=levels, progress=progress, **given, **options)
    part = read_part("filter", shape, options, _FILTER, gains if signal is None else signal)
    if gains is None:
        line = working_line("filter", lambda call: None, 'aw.filter(shape, "smooth")')
        raise TypeError(f"filter takes a gain for each band or the name of a preset, got none{line}")
    levels = levels_of(levels, options)
    named = default_signal(part, signal)  # type: ignore[arg-type]
    precision = options.get("precision") or "auto"
    accuracy = options.get("accuracy", _native.ACCURACY)
    moves = named is None or (isinstance(named, str) and named == "coords")
    if precision != "auto" and local_fit != "constant" and not moves:
        raise ValueError("precision: it applies to a signal with local_fit='constant'; leave it out")
    _check_gains(gains, part, signal is None)
    if constraints is not None:
        operator = _constrained_operator(part, constraints, named, operator)
    decomposer = prepare_decomposer(part.part, exact_operator(operator, options), levels)
    if local_fit is None:
        local_fit = "constant" if decomposer._sizes else "linear"
    layers = edit_layers(part.take_layers(gains), part.take_where(where), decomposer.n_vertices, decomposer._sizes)
    if levels is None and not isinstance(gains, str) and not _has_layers(gains):
        levels = len(gains)  # type: ignore[arg-type]
    steps = decomposer.schedule(levels)

    def edit(owner: Decomposer, request: BandsRequest, report: Any) -> NDArray[np.float64]:
        return _native.filter_layers(owner._data, request, layers, report)

    if named is not None and not isinstance(named, str):
        with report_progress(progress, "filtering") as report:

            def filtered(owner: Decomposer, values: NDArray[np.float64] | None, _: list[int]) -> NDArray[np.float64]:
                request = BandsRequest(values, steps, accuracy, local_fit, precision)
                return edit(owner, request, report)

            def edited(signal: SignalLike) -> tuple[NDArray[np.float64], Layout]:
                values, layout = decomposer._signal_values(part.take_signal(signal))
                return layout.arrange(decomposer._map_channels(values, filtered)), layout

            axis = channels_axis(named, decomposer.n_vertices) if part.selection is None else None
            if isinstance(named, np.memmap) and axis is not None and time is None:
                return map_columns(named, axis, len(steps) + 4, lambda group: edited(group)[0])
            found, layout = edited(named)
        result = part.spread(found, layout, named).astype(float_type(named), copy=False)
        return result if time is None else time.smooth(result, axis=frames_axis(layout), progress=progress)
    refuse_time(time)
    settings = EditSettings(named or "coords", steps, constraints or Constraints(), local_fit, accuracy, precision)
    return part.with_named_signal(edit_shape(decomposer, settings, edit, progress), settings.signal)


def _filter_by_kernel(
    shape: object, signal: Any, kernel: Any, operator: OperatorLike, progress: ProgressLike, options: dict[str, Any]
) -> Any:
    """`filter` by a function of the eigenvalues of the Laplacian."""
    from adwave import kernels

    if kernel is None:
        signal, kernel = None, signal
    accuracy = options.pop("accuracy", kernels.ACCURACY)
    unused = [name for name, value in options.items() if value is not None]
    if unused:
        raise ValueError(f"{unused[0]}: it does not apply to a function of the eigenvalues; leave it out")
    part = read_part("filter", shape, {}, _FILTER, kernel)
    named = default_signal(part, signal)
    if named is not None and not isinstance(named, str):
        return kernels.apply(shape, named, kernel, operator=operator, accuracy=accuracy, progress=progress).values[0]
    decomposer = prepare_decomposer(part.part, operator, None, analysis=True)
    polynomial = kernels.fit(kernel, _native.spectral_range(decomposer._data), accuracy)

    def edit(owner: Decomposer, request: BandsRequest, report: Any) -> NDArray[np.float64]:
        return kernels.apply_polynomials(owner, request.signal, [polynomial], report)[0]

    settings = EditSettings(named or "coords", [1.0], Constraints(), "constant")
    return part.with_named_signal(edit_shape(decomposer, settings, edit, progress), settings.signal)


def _check_gains(gains: GainsLike, part: Part, is_alone: bool) -> None:
    """Raise if the gains look like a signal, or are the name of no preset."""
    numbers: Any = gains
    n_vertices = part.whole.n_vertices
    if isinstance(gains, str):
        try:
            _native.preset_gains(gains, 1)
            return
        except ValueError as error:
            message = str(error)
        meant = next((ours for ours, names in PRESETS.items() if gains.lower() in names), "smooth")
        is_field = is_alone and isinstance(part.whole, Shape) and gains in (*part.whole.fields, "x", "y", "z")

        def change(call: Call) -> None:
            texts = [*call.arguments]
            call.arguments[:] = [
                f'"{meant}"' if text.strip("'\"") == gains and not is_field else text for text in texts
            ]
            if is_field:
                call.arguments.append('"smooth"')
            if "gains" in call.keywords:
                call.keywords["gains"] = f'"{meant}"'

        raise ValueError(f"{message}{working_line('filter', change)}")
    if not isinstance(gains, Layer) and np.ndim(numbers) and len(numbers) == n_vertices > 64:
        line = working_line("filter", lambda call: call.arguments.append('"smooth"'), 'aw.filter(shape, f, "smooth")')
        raise TypeError(f"gains: got {n_vertices} numbers, one for each vertex: is this the signal?{line}")


def _constrained_operator(
    part: Part, constraints: Constraints, signal: SignalLike, operator: OperatorLike
) -> OperatorLike:
    """The operator that honors the constraints.

    Raises
    ------
    ValueError
        If the signal is not the coordinates, or the operator was prepared without free ends of a curve.
    """
    if not (signal is None or (isinstance(signal, str) and signal == "coords")):
        raise ValueError(
            "constraints: they say how vertices may move, and apply to the coordinates only; leave them out for another "
            "signal"
        )
    if constraints.border != "free":
        return operator
    if not isinstance(part.part, Decomposer):
        return as_operator(operator).with_free_ends()
    if part.shape.kind == "graph" and part.part._options.end_points != "free":
        raise ValueError(
            "constraints: this Decomposer keeps the end points of a curve; pass the shape itself, "
            "aw.filter(decomposer.shape, …), or prepare it with operator=aw.Operator().with_free_ends()"
        )
    return operator


@dataclass(frozen=True)
class EditSettings:
    """The signal of a shape that an edit changes, its levels, and how vertices may move."""

    signal: str
    steps: Sequence[float]
    constraints: Constraints
    local_fit: str = "linear"
    accuracy: float = _native.ACCURACY
    precision: str = "auto"


def edit_shape(
    decomposer: Decomposer,
    settings: EditSettings,
    edit: Callable[[Decomposer, BandsRequest, Any], NDArray[np.float64]],
    progress: ProgressLike,
) -> Shape:
    """The shape with one of its signals edited."""
    signal, shape = settings.signal, decomposer.shape
    values, _ = decomposer._signal_values(signal)
    refuse_labels(signal, decomposer)
    is_linear = settings.local_fit != "constant"
    heights = values is None and is_linear and settings.constraints.along in ("x", "y", "z")
    along = "xyz".index(str(settings.constraints.along)) if heights else 0
    if heights:
        values = np.ascontiguousarray(shape.points[:, along : along + 1])
    # Coordinates that move in several directions are smoothed about their mean; borders have rules of their own.
    fit = settings.local_fit if values is not None else "constant"
    with report_progress(progress, "filtering") as report:

        def filtered(owner: Decomposer, values: NDArray[np.float64] | None, _: list[int]) -> NDArray[np.float64]:
            request = BandsRequest(values, settings.steps, settings.accuracy, fit, settings.precision)
            return edit(owner, request, report)

        edited = decomposer._map_channels(values, filtered)
        if heights:
            points = np.array(shape.points)
            points[:, along] = edited[:, 0]
            edited = points
        if values is None or heights:
            moved = decomposer._data.constrain_positions(edited, settings.constraints, report)
            return shape._with_positions(moved)
    return _changed(shape, signal, edited)


def refuse_labels(signal: SignalLike, decomposer: Decomposer) -> None:
    if not isinstance(signal, str):
        return
    values, _ = decomposer._signal_values(signal)
    if values is not None and _native.labels_of_signal(signal, values):
        raise ValueError(
            f"signal: {signal!r} has labels, and a mean of labels is none: use filter_labels, or give the values as an"
            " array to take them for numbers"
        )


@public()
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
    **options: Unpack[SignalOptions],
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
    gains, where, levels, operator, accuracy, progress, **options
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
    part = read_part("filter_labels", shape, options, _LABELS)
    levels = levels_of(levels, options)
    decomposer = prepare_decomposer(part.part, exact_operator(operator, options), levels)
    layers = edit_layers(part.take_layers(gains), part.take_where(where), decomposer.n_vertices, decomposer._sizes)
    if levels is None and not isinstance(gains, str) and not _has_layers(gains):
        levels = len(gains)  # type: ignore[arg-type]
    owner, values, layout = decomposer._resolve_signal(part.take_signal(labels))
    request = BandsRequest(values, decomposer.schedule(levels), accuracy)
    with report_progress(progress, "filtering") as report:
        filtered = owner._by_place().arrange(_native.filter_labels(owner._data, request, layers, report))
    return part.spread(filtered, layout, part.whole_shape.signal(labels) if isinstance(labels, str) else labels)


def _has_layers(gains: Any) -> bool:
    return isinstance(gains, Layer) or (len(gains) > 0 and all(isinstance(g, Layer) for g in gains))


_DECOMPOSE = ("signal", "levels", "operator", "accuracy", "progress")
_SMOOTH = ("signal", "steps", "fwhm", "rms", "lazy", "operator", "accuracy", "progress")
_FILTER = ("signal", "gains", "where", "levels", "operator", "constraints", "local_fit", "progress")
_LABELS = ("labels", "gains", "where", "levels", "operator", "accuracy", "progress")
