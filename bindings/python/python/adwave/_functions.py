"""The free functions: one question of one shape each."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._bands import Bands, Layer, Where, _gains, _where
from adwave._decomposer import Decomposer, Length, SignalLike, prepared
from adwave._progress import ProgressLike, reporting
from adwave._shape import Path, Shape, as_shape

if TYPE_CHECKING:
    import pandas as pd

Along = Literal["free", "normal", "surface", "x", "y", "z"]
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
    weighting: Literal["signed", "paper", "printed", "normalised", "ranks", "none"] = "signed",
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
        ``'printed'``: (max − |W|)² at each vertex, as eq. 17 is printed. ``'normalised'``: 1/mean. ``'ranks'``. ``'none'``: 1.
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
    response: Literal["normalised", "literal", "channels", "sigma"] = "normalised",
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
    """Find the places where a level stands out among its neighbours in space and in scale (Algorithm 2).

    Parameters
    ----------
    shape, faces
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    signal : str or array-like, optional
        As for `decompose`.
    theta : float
        How many times the mean response of its level a feature has.
    response : {'normalised', 'literal', 'channels', 'sigma'}
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


class Info(Mapping[str, Any]):
    """What a shape consists of and what is unusual about it, as a mapping; prints as a table."""

    __slots__ = ("_facts",)

    def __init__(self, facts: dict[str, Any]) -> None:
        self._facts = facts

    def __getitem__(self, name: str) -> Any:
        return self._facts[name]

    def __iter__(self) -> Any:
        return iter(self._facts)

    def __len__(self) -> int:
        return len(self._facts)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self._facts:
            raise AttributeError(f"there is no {name!r}; there is {', '.join(self._facts)}")
        return self._facts[name]

    def __reduce__(self) -> tuple[Any, ...]:
        return Info, (self._facts,)

    def __repr__(self) -> str:
        return "\n".join(f"{name:<20} {_plain(value)}" for name, value in self._facts.items())


def _plain(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, tuple):
        return " to ".join(" ".join(f"{c:.4g}" for c in corner) for corner in value)
    return str(value)


def info(shape: object, faces: object = None, **operator: Any) -> Info:
    """What a shape consists of, what is unusual about it, and how its diffusion is built.

    Parameters
    ----------
    shape, faces
        Anything that is a shape (see `Shape`), or a `Decomposer`.
    **operator
        The options of `Decomposer`.

    Examples
    --------
    >>> import adwave as aw
    >>> found = aw.info(aw.sample("torus", vertices=1000))
    >>> found.closed, found.euler_characteristic, found.components
    (True, 0, 1)
    """
    own = prepared(shape, faces, operator)
    kind = {"kind": own.shape.kind, "format": own.shape.format, "fields": list(own.shape.fields)}
    return Info({**kind, **own._data.facts()})


def region(shape: object, region: str, faces: object = None) -> NDArray[np.float64]:
    """The weights of a region, one in [0, 1] for each vertex; see `Decomposer.region`.

    Examples
    --------
    >>> import adwave as aw
    >>> weights = aw.region(aw.sample("sphere", vertices=500), "half-space:point=0 0 0,normal=0 0 1")
    >>> float(weights.min()), float(weights.max())
    (0.0, 1.0)
    """
    return prepared(shape, faces, {}).region(region)


def signal(shape: object, name: str, faces: object = None, *, texture: Path | None = None) -> NDArray[np.float64]:
    """A signal by its name, as values at the vertices.

    Parameters
    ----------
    shape, faces
        Anything that is a shape; see `Shape`.
    name : str
        ``'coords'``, ``'x'``, ``'y'``, ``'z'``, ``'normals'``, ``'mean-curvature'``, ``'gaussian-curvature'``,
        ``'shape-index'``, ``'density'`` (of a cloud), ``'degree'`` (of a graph), ``'luminance'``, ``'lightness'``,
        ``'texture'``, ``'texture-luminance'``, ``'texture-lightness'``, a field of the shape, or a file .npy, .dmat, .csv or .gii.
    texture : path-like, optional
        The picture of the texture, in the place of the one that the materials name.

    Examples
    --------
    >>> import adwave as aw
    >>> curvature = aw.signal(aw.sample("sphere", vertices=2000), "mean-curvature")
    >>> bool(abs(curvature - 1).mean() < 0.05)
    True
    """
    own = shape.shape if isinstance(shape, Decomposer) else as_shape(shape, faces)
    return own.signal(name, texture=texture)


def preset_gains(preset: str, levels: int) -> NDArray[np.float64]:
    """The gains of a preset for so many levels.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.preset_gains("smooth", 3)
    array([0., 0., 2.])
    """
    return np.array(_native.preset_gains(preset, levels))


def memory_needed(shape: object, faces: object = None, *, levels: int = 8, channels: int = 3) -> dict[str, int]:
    """Bytes that `decompose` takes beyond the prepared shape.

    Returns
    -------
    dict
        ``work``: while it runs; ``result``: the bands.
    """
    work, result = prepared(shape, faces, {})._data.bytes(channels, levels)
    return {"work": work, "result": result}


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
        Positions: what distance from the centre explains is taken out of ``partial_correlation``.

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


def report(shape: object, path: Path, faces: object = None) -> None:
    """Write one page about a shape: health, bands, saliency, features and presets, as pictures and tables.

    Parameters
    ----------
    shape, faces
        Anything that is a shape; see `Shape`.
    path : path-like
        The page, ``.html``.

    Raises
    ------
    ValueError
        The shape or the path is wrong.
    """
    import tempfile

    own = as_shape(shape, faces)
    with tempfile.TemporaryDirectory() as folder:
        source = os.path.join(folder, "shape.mtx" if own.kind == "graph" else "shape.ply")
        own.write(source)
        code = _native.run_command(["adwave", "report", source, "-o", os.fspath(path), "--quiet"])
    if code != 0:
        raise ValueError(f"the report was not written (exit code {code}); what is wrong stands on the standard error")
