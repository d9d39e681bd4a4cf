"""Bands of a shape, and the shape after an edit or without its noise."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from adwave import _native
from adwave._bands import Bands, Layer, Where, _gains, _where
from adwave._decomposer import Decomposer, Length, SignalLike, prepared
from adwave._progress import ProgressLike, reporting
from adwave._shape import Shape, as_shape

Along = Literal["free", "normal", "surface", "x", "y", "z"]


def decompose(
    shape: object,
    faces: object = None,
    *,
    signal: SignalLike = None,
    levels: int | None = None,
    lengths: Sequence[Length] | None = None,
    fwhm: Sequence[Length] | None = None,
    steps: Sequence[float] | None = None,
    voices: int | None = None,
    accuracy: float = _native.ACCURACY,
    progress: ProgressLike = None,
    **operator: Any,
) -> Bands:
    """Split the positions of a shape, or a signal on it, into bands from fine to coarse.

    ``W_f(j) = S_f(j−1) − S_f(j)`` with ``S_f(j) = Φ₁^(n_j) f``; the bands and S_f(J) sum to the signal (eq. 11, eq. 15).

    Parameters
    ----------
    shape, faces
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    signal : str or (n,) or (n, c) array-like, optional
        What is split: the coordinates where nothing is given, a signal by its name (see `signal`), or numbers at the vertices.
        Vertices where it is NaN are masked: the diffusion goes round them.
    levels : int, optional
        So many levels of 1, 2, 4 … steps of the diffusion. Where nothing is given, until a level is 2 % of the diagonal wide.
    lengths : sequence of float or str, optional
        Levels of these widths σ, in model units or in ``"2%"`` of the diagonal: the root mean square distance that one value
        spreads to. They take ``operator="surface"`` where none is given.
    fwhm : sequence of float or str, optional
        Levels of these full widths at half maximum: 1.665 σ.
    steps : sequence of float, optional
        Levels of these numbers of steps, whole or not, from 1/64.
    voices : int, optional
        So many levels for each doubling of the steps: ``levels=6, voices=2`` are 11 levels from 1 to 32 steps.
    accuracy : float
        Largest error of a band relative to the band, 1e-13 to 0.1.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total), called from this thread.
    **operator
        How the diffusion is built: the options of `Decomposer`.

    Returns
    -------
    Bands
        An array-like of (levels + 1) × n × channels, which can be changed band by band.

    Raises
    ------
    ValueError, TypeError
        In one line, what is wrong and where.
    MemoryError
        It would take more memory than there is.

    Notes
    -----
    About ``√(n_J·ln(1/accuracy))`` products with Φ₁ for all levels together. The same bits on any number of threads. Ctrl-C ends it
    within 50 ms.

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
    own = prepared(shape, faces, operator, lengths is not None or fwhm is not None)
    return own.decompose(
        signal,
        levels=levels,
        lengths=lengths,
        fwhm=fwhm,
        steps=steps,
        voices=voices,
        accuracy=accuracy,
        progress=progress,
    )


@overload
def filter(
    shape: object,
    faces: object = ...,
    *,
    gains: Sequence[float] | None = ...,
    preset: str | None = ...,
    layers: Sequence[Layer] | None = ...,
    where: Where = ...,
    signal: str = ...,
    levels: int | None = ...,
    lengths: Sequence[Length] | None = ...,
    fwhm: Sequence[Length] | None = ...,
    steps: Sequence[float] | None = ...,
    along: Along | None = ...,
    border: Literal["natural", "keep", "free"] = ...,
    volume: Literal["free", "keep"] = ...,
    accuracy: float = ...,
    progress: ProgressLike = ...,
    **operator: Any,
) -> Shape: ...


@overload
def filter(
    shape: object,
    faces: object = ...,
    *,
    gains: Sequence[float] | None = ...,
    preset: str | None = ...,
    layers: Sequence[Layer] | None = ...,
    where: Where = ...,
    signal: NDArray[Any] | Sequence[float] | Sequence[Sequence[float]],
    levels: int | None = ...,
    lengths: Sequence[Length] | None = ...,
    fwhm: Sequence[Length] | None = ...,
    steps: Sequence[float] | None = ...,
    along: Along | None = ...,
    border: Literal["natural", "keep", "free"] = ...,
    volume: Literal["free", "keep"] = ...,
    accuracy: float = ...,
    progress: ProgressLike = ...,
    **operator: Any,
) -> NDArray[np.float64]: ...


def filter(
    shape: object,
    faces: object = None,
    *,
    gains: Sequence[float] | None = None,
    preset: str | None = None,
    layers: Sequence[Layer] | None = None,
    where: Where = None,
    signal: SignalLike = "coords",
    levels: int | None = None,
    lengths: Sequence[Length] | None = None,
    fwhm: Sequence[Length] | None = None,
    steps: Sequence[float] | None = None,
    along: Along | None = None,
    border: Literal["natural", "keep", "free"] = "natural",
    volume: Literal["free", "keep"] = "free",
    accuracy: float = _native.ACCURACY,
    progress: ProgressLike = None,
    **operator: Any,
) -> Shape | NDArray[np.float64]:
    """Change the bands of a shape, or of a field on it: smooth, enhance, keep or drop, everywhere or in a region.

    ``f′ = f + Σ_j (Γ(j,x) − 1)·W_f(j,x)``, Γ being the product of the layers' gains (eq. 18).

    Parameters
    ----------
    shape, faces
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    gains : sequence of float, optional
        A gain for each band, fine to coarse: 0 drops a band, 1 keeps it, 2 doubles it. Without levels there are as many as gains.
    preset : {'suppress', 'smooth', 'suppress-paper', 'enhance', 'band1', 'band2'}, optional
        Gains by name. ``'smooth'`` (or ``'suppress'``) drops all bands but the last, which it doubles: that keeps limbs and
        volume where dropping all, ``'suppress-paper'``, shrinks them; by one level it drops that.
    layers : sequence of Layer, optional
        Several edits at once, in the place of one.
    where : str or (n,) array-like, optional
        A region in its text form (``"ball:vertex=120,radius=10%"``), or a weight for each vertex; everywhere where none is given.
    signal : str or array-like
        What is changed: ``'coords'``, ``'x'``, ``'y'``, ``'z'``, a field of the shape, or numbers at the vertices.
    levels, lengths, fwhm, steps, accuracy, progress, **operator
        As for `decompose`.
    along : {'free', 'normal', 'surface', 'x', 'y', 'z'}, optional
        Which way vertices may move. Without one clouds move along their normals, and meshes freely but for their borders,
        which `border` is about; ``'free'`` frees borders too.
    border : {'natural', 'keep', 'free'}
        What becomes of open borders.
    volume : {'free', 'keep'}
        Whether a closed surface keeps its volume, by an offset.

    Returns
    -------
    Shape, or an array like the signal where numbers are given
        At new positions, or with the field changed; with all that its file had.

    Examples
    --------
    >>> import adwave as aw
    >>> noisy = aw.sample("sphere", vertices=2000, noise=0.3)
    >>> smooth = aw.filter(noisy, preset="smooth", levels=4)
    >>> head = aw.filter(noisy, gains=[2, 2, 1], where="ball:vertex=0,radius=20%")
    """
    asked = [name for name, given in (("gains", gains), ("preset", preset), ("layers", layers)) if given is not None]
    if len(asked) != 1:
        said = f"not {' and '.join(asked)}" if asked else "to say what becomes of the bands"
        raise ValueError(f"give one of gains, preset and layers, {said}")
    by_width = lengths is not None or fwhm is not None
    own = prepared(shape, faces, operator, by_width)
    if levels is None and gains is not None and not by_width and steps is None:
        levels = len(gains)
    chosen = own.steps(levels=levels, lengths=lengths, fwhm=fwhm, steps=steps)
    if layers is not None:
        if where is not None:
            raise ValueError("where: each layer has its own; leave it out")
        edits = list(layers)
    else:
        edits = [Layer(preset if preset is not None else gains, where)]  # type: ignore[arg-type]
    plain = [(_gains(edit.gains), _where(edit.where, own.n_vertices)) for edit in edits]

    def edit_of(editor: _native.EditorData) -> NDArray[np.float64]:
        return editor.apply(plain)

    if signal is not None and not isinstance(signal, str):
        owner, values, is_flat = own._signal(signal)
        with reporting(progress, "filtering") as report:
            edited = edit_of(owner._data.editor(values, chosen, accuracy, report))
        return edited[:, 0] if is_flat else edited
    return edited_shape(own, signal or "coords", chosen, edit_of, (along, border, volume), accuracy, progress)


def edited_shape(
    own: Decomposer,
    signal: str,
    steps: list[float],
    edit: Callable[[_native.EditorData], NDArray[np.float64]],
    positions: tuple[str | None, str, str],
    accuracy: float,
    progress: ProgressLike,
) -> Shape:
    """The shape with one of its signals edited."""
    owner, values, _ = own._signal(signal)
    with reporting(progress, "filtering") as report:
        edited = edit(owner._data.editor(values, steps, accuracy, report))
        if values is None:
            return own.shape._with(own._data.settled(edited, *positions, report))
    axis = "xyz".find(signal) if len(signal) == 1 and signal not in own.shape.fields else -1
    if axis >= 0:
        points = np.array(own.shape.points)
        points[:, axis] = edited[:, 0]
        return own.shape.with_points(points)
    return Shape._of(own.shape._data.with_signal(signal, edited))


class Denoised(NamedTuple):
    """A shape or signal without noise, and what was found out about the noise."""

    result: Any
    """A `Shape`, or an array like the signal."""
    info: dict[str, Any]
    """``noise``: its standard deviation, in model units of a shape and in the units of a signal.

    Of a shape also ``noise_in_edges`` (in mean edges of the noisy shape), ``kept`` (the share of the normals that stay as they
    were), ``crease_weights`` and ``smooth_weights`` (the shares that were smoothed by 1, 2, 4 … steps, with and without creases
    kept), ``n_far`` and ``furthest`` (vertices that moved farther than 3 times the noise, and how far). Of a signal ``kept``,
    ``plain_weights``, ``step_weights`` and ``risk`` (the expected squared error before and after), for each group of
    ``channels``.
    """


def denoise(
    shape: object,
    faces: object = None,
    *,
    signal: SignalLike = None,
    strength: float = 1.0,
    creases: Literal["auto", "keep", "none"] = "auto",
    noise: float | None = None,
    progress: ProgressLike = None,
    **operator: Any,
) -> Denoised:
    """Take noise off a shape, or off a signal on it. How much there is, and whether creases stay, is found by itself.

    Scaling functions of several widths, with and without steps across creases, are mixed by the least estimated risk.

    Parameters
    ----------
    shape, faces
        Anything that is a shape (see `Shape`), or for a signal a `Decomposer`.
    signal : str or (n,) or (n, c) array-like, optional
        A signal in the place of the shape.
    strength : float
        Times the noise that is taken for noise: below 1 careful, above 1 thorough.
    creases : {'auto', 'keep', 'none'}
        Whether sharp edges stay: what the estimated risk prefers, yes, or no.
    noise : float, optional
        Its standard deviation along the normals in model units, where it is known.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total).
    **operator
        As for `decompose`; of a shape only ``weld``.

    Returns
    -------
    Denoised
        The shape or array, and what was found.

    Examples
    --------
    >>> import adwave as aw
    >>> noisy = aw.sample("torus", vertices=3000, noise=0.3)
    >>> clean, info = aw.denoise(noisy)
    >>> 0.1 < info["noise_in_edges"] < 0.5
    True
    """
    if signal is None:
        own = shape.shape if isinstance(shape, Decomposer) else as_shape(shape, faces)
        weld = bool(operator.pop("weld", True))
        if operator:
            raise TypeError(f"{next(iter(operator))}: a shape is denoised without this option; leave it out")
        with reporting(progress, "denoising") as report:
            points, info = _native.denoise_points(own._data, strength, creases, noise, weld, report)
        return Denoised(own._with(points), info)
    if creases != "auto":
        raise ValueError(
            "creases: those of a shape may stay; of a signal steps stay where they are no noise: leave it out"
        )
    decomposer = prepared(shape, faces, operator)
    owner, values, is_flat = decomposer._signal(signal)
    with reporting(progress, "denoising") as report:
        denoised, found = _native.denoise_values(owner._data, values, strength, creases, noise, report)
    info = dict(found[0]) if len(found) == 1 else {"groups": found}
    return Denoised(denoised[:, 0] if is_flat else denoised, info)
