"""Other methods for comparison: harmonics, graph wavelets, diffusion wavelets, signatures, saliency, smoothing.

>>> import adwave as aw
>>> values, functions = aw.baselines.harmonics(aw.sample("sphere", vertices=500), 9)
>>> bool(abs(values[1:4] - 2).max() < 0.1)
True
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._caller import public
from adwave._decomposer import Decomposer, prepare_decomposer
from adwave._options import OperatorLike, SignalLike
from adwave._part import read_part
from adwave._progress import ProgressLike, report_progress
from adwave._shape import Shape, as_shape

__all__ = [
    "CriticalPoints",
    "DiffusionWavelets",
    "GraphWavelets",
    "differential_coordinates",
    "feature_map",
    "from_differential_coordinates",
    "harmonics",
    "heat_kernel_signature",
    "lee_saliency",
    "taubin",
    "wave_kernel_signature",
]

_Weights = Literal["uniform", "cotangent"]


@public()
def harmonics(
    shape: object, k: int, *, progress: ProgressLike = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The first eigenvalues and eigenfunctions of the Laplacian (intrinsic Delaunay, lumped masses).

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape; see `adwave.Shape`.
    k : int
        Number of eigenvalues.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Returns
    -------
    values : (k,) array
        Eigenvalues in ascending order, in 1 / squared model units; one 0 for each component.
    functions : (n, k) array
        Eigenfunctions of norm 1 by the masses.

    Raises
    ------
    ValueError
        If the shape has fewer than k vertices, or no surface.

    References
    ----------
    Vallet & Lévy, "Spectral geometry processing with manifold harmonics", 2008.

    Examples
    --------
    >>> import adwave as aw
    >>> values, functions = aw.baselines.harmonics(aw.sample("sphere", vertices=300), 4)
    >>> functions.shape, bool(abs(values[1:] - 2).max() < 0.1)
    ((300, 4), True)
    """
    with report_progress(progress, "eigenfunctions") as report:
        return _native.harmonics(as_shape(shape)._data, k, report)


@public()
def heat_kernel_signature(
    shape: object, *, k: int = 100, scales: int = 16, progress: ProgressLike = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Heat kernel signature ``HKS(x, t) = Σ_k e^(−λ_k t) φ_k(x)²``: the heat that remains at each vertex.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape; see `adwave.Shape`.
    k : int
        Number of eigenfunctions.
    scales : int
        Number of times.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Returns
    -------
    times : (scales,) array
        Times, in squared model units.
    values : (n, scales) array
        Signature of each vertex, ≥ 0.

    References
    ----------
    Sun, Ovsjanikov & Guibas, "A concise and provably informative multi-scale signature based on heat diffusion", 2009.

    Examples
    --------
    >>> import adwave as aw
    >>> times, values = aw.baselines.heat_kernel_signature(aw.sample("sphere", vertices=300), k=20, scales=5)
    >>> values.shape
    (300, 5)
    """
    with report_progress(progress, "eigenfunctions") as report:
        return _native.signature(as_shape(shape)._data, "heat", k, scales, report)


@public()
def wave_kernel_signature(
    shape: object, *, k: int = 100, scales: int = 16, progress: ProgressLike = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Wave kernel signature of each vertex.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape; see `adwave.Shape`.
    k : int
        Number of eigenfunctions.
    scales : int
        Number of energies.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Returns
    -------
    energies : (scales,) array
        Energies ln λ.
    values : (n, scales) array
        Signature of each vertex, ≥ 0.

    References
    ----------
    Aubry, Schlickewei & Cremers, "The wave kernel signature", 2011.

    Examples
    --------
    >>> import adwave as aw
    >>> energies, values = aw.baselines.wave_kernel_signature(aw.sample("sphere", vertices=300), k=20, scales=5)
    >>> values.shape
    (300, 5)
    """
    with report_progress(progress, "eigenfunctions") as report:
        return _native.signature(as_shape(shape)._data, "wave", k, scales, report)


def lee_saliency(shape: object, *, progress: ProgressLike = None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Saliency of a mesh by differences of Gaussians of its mean curvature, on five scales.

    Parameters
    ----------
    shape : shape_like
        Anything that is a mesh; see `adwave.Shape`.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Returns
    -------
    saliency : (n,) array
        Saliency, ≥ 0.
    curvature : (n,) array
        Mean curvature, in 1 / model units.

    References
    ----------
    Lee, Varshney & Jacobs, "Mesh saliency", 2005.

    Examples
    --------
    >>> import adwave as aw
    >>> saliency, curvature = aw.baselines.lee_saliency(aw.sample("creature", vertices=2000))
    >>> bool(saliency.min() >= 0)
    True
    """
    with report_progress(progress, "saliency") as report:
        return _native.lee(as_shape(shape)._data, report)


@dataclass(frozen=True)
class _TaubinOptions:
    """Options of Taubin's smoothing, as the extension takes them."""

    lam: float
    mu: float
    iterations: int
    weights: _Weights


@public()
def taubin(
    shape: object,
    *,
    signal: SignalLike = None,
    lam: float = 0.5,
    mu: float = -0.53,
    iterations: int = 10,
    weights: _Weights = "uniform",
) -> Shape | NDArray[np.float64]:
    """Taubin's λ|μ smoothing: ``((1 − μK)(1 − λK))^iterations f``.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape; see `adwave.Shape`.
    signal : str or array_like, optional
        As in `adwave.decompose`; the coordinates by default.
    lam, mu : float
        Factors λ > 0 and μ < −λ of the two steps.
    iterations : int
        Number of pairs of steps.
    weights : {'uniform', 'cotangent'}
        Weights of the neighbors in K.

    Returns
    -------
    object like the shape, or an array like the signal if one is given

    References
    ----------
    Taubin, "A signal processing approach to fair surface design", 1995.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.baselines.taubin(aw.sample("sphere", vertices=300, noise=0.3), iterations=5)
    <adwave.Shape: mesh, 300 vertices, 596 faces>
    """
    part = read_part("taubin", shape, {}, (), signal)
    own = prepare_decomposer(part.part)
    _, values, layout = own._resolve_signal(signal)
    given = np.array(own.shape.points) if values is None else values
    smoothed = _native.taubin(own.shape._data, given, _TaubinOptions(lam, mu, iterations, weights))
    if values is None:
        return part.moved(own.shape._with_positions(smoothed))
    return layout.arrange(smoothed)


@public()
def differential_coordinates(
    shape: object, *, signal: SignalLike = None, weights: _Weights = "cotangent"
) -> NDArray[np.float64]:
    """Difference of each vertex from the mean P of its neighbors: ``δ = (I − P) f``.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape; see `adwave.Shape`.
    signal : str or array_like, optional
        As in `adwave.decompose`; the coordinates by default.
    weights : {'uniform', 'cotangent'}
        Weights of the mean.

    Returns
    -------
    (n, channels) array, or (n,) for a signal of one dimension

    References
    ----------
    Sorkine et al., "Laplacian surface editing", 2004.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("sphere", vertices=500)
    >>> aw.baselines.differential_coordinates(shape).shape
    (500, 3)
    """
    own = prepare_decomposer(shape)
    _, values, layout = own._resolve_signal(signal)
    given = np.array(own.shape.points) if values is None else values
    delta = _native.differential_coordinates(own.shape._data, given, weights)
    return layout.arrange(delta)


def from_differential_coordinates(
    shape: object,
    coordinates: ArrayLike,
    anchors: ArrayLike,
    targets: ArrayLike,
    *,
    anchor_weight: float = 1.0,
    weights: _Weights = "cotangent",
) -> NDArray[np.float64]:
    """The signal whose differential coordinates are nearest to the given ones, with some vertices near given targets.

    Least squares: ``(LᵀL + W²) f = Lᵀδ + W²t``, by one sparse factorization.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape; see `adwave.Shape`.
    coordinates : (n, channels) or (n,) array_like
        Differential coordinates δ.
    anchors : (k,) array_like of int
        Vertices with a target; at least one of each component.
    targets : (k, channels) or (k,) array_like
        Values of the signal at the anchors.
    anchor_weight : float
        Weight w of an anchor, relative to 1 for a differential coordinate.
    weights : {'uniform', 'cotangent'}
        Weights that the coordinates were computed with.

    Returns
    -------
    (n, channels) or (n,) array

    Raises
    ------
    ValueError
        If an anchor is not a vertex, or the arrays do not fit.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("sphere", vertices=500)
    >>> delta = aw.baselines.differential_coordinates(shape)
    >>> held = [0, 250, 499]
    >>> again = aw.baselines.from_differential_coordinates(shape, delta, held, shape.points[held])
    >>> bool(abs(again - shape.points).max() < 1e-8)
    True
    """
    own = as_shape(shape)
    delta = _adapt.values_array(coordinates, own.n_vertices, "coordinates")
    at = np.asarray(anchors)
    if at.ndim != 1 or (at.size and at.dtype.kind not in "iu") or (at < 0).any():
        raise ValueError(f"anchors must be indices of vertices, got shape {at.shape} of {at.dtype}")
    where = _adapt.values_array(targets, len(at), "targets")
    if where.shape[1] != delta.shape[1]:
        raise ValueError(f"targets must have {delta.shape[1]} columns like coordinates, got {where.shape[1]}")
    held = _Anchors(at.tolist(), where, float(anchor_weight))
    solved = _native.from_differential(own._data, delta, held, weights)
    return solved[:, 0] if np.ndim(coordinates) == 1 else solved


@dataclass(frozen=True)
class _Anchors:
    """Vertices with targets, as the extension takes them."""

    vertices: list[int]
    targets: NDArray[np.float64]
    weight: float


class CriticalPoints(NamedTuple):
    """Critical points of a function at one scale.

    Attributes
    ----------
    time : float
        t, in squared model units.
    smoothed : (n,) array
        The function at that scale.
    points : structured array
        vertex; kind: 1 a maximum, −1 a minimum, 0 a saddle; multiplicity; value.
    index_sum : int
        Sum of the indices: the Euler characteristic of the mesh.

    Examples
    --------
    >>> import adwave as aw
    >>> (level,) = aw.baselines.feature_map(aw.sample("torus", vertices=1000), [0.01])
    >>> level.index_sum
    0
    """

    time: float
    smoothed: NDArray[np.float64]
    points: NDArray[Any]
    index_sum: int


@public()
def feature_map(
    shape: object,
    times: Sequence[float],
    *,
    signal: SignalLike = "mean-curvature",
    progress: ProgressLike = None,
) -> list[CriticalPoints]:
    """Critical points of a function that is smoothed by heat: ``e^(−tΔ) f`` for each time t.

    Parameters
    ----------
    shape : shape_like
        Anything that is a mesh; see `adwave.Shape`.
    times : sequence of float
        Times t in squared model units: f is smoothed over about ``√(2t)``.
    signal : str or (n,) array_like
        Function f.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Examples
    --------
    >>> import adwave as aw
    >>> (level,) = aw.baselines.feature_map(aw.sample("creature", vertices=2000), [0.01])
    >>> level.index_sum
    2
    """
    own = as_shape(shape)
    values = own.signal(signal) if isinstance(signal, str) else np.asarray(signal, dtype=np.float64)
    flat = _adapt.values_array(values, own.n_vertices, "signal")
    if flat.shape[1] != 1:
        raise ValueError(f"signal must be one number for each vertex, got shape {np.shape(values)}")
    kinds = np.dtype([("vertex", np.int64), ("kind", np.int8), ("multiplicity", np.int32), ("value", np.float64)])
    with report_progress(progress, "smoothing") as report:
        found = _native.feature_map(own._data, flat[:, 0], [float(t) for t in times], report)
    return [
        CriticalPoints(time, smoothed, np.array(points, dtype=kinds), index_sum)
        for time, smoothed, points, index_sum in found
    ]


class GraphWavelets:
    """Spectral graph wavelets: kernels ``g_i`` of the normalized Laplacian of the same diffusion, as polynomials.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `adwave.Shape`), or an `adwave.Decomposer` whose diffusion is reversible.
    kernels : int
        Number of kernels, with the low pass.
    family : {'meyer', 'mexican-hat', 'abspline', 'itersine'}
        Family of the kernels; those of Meyer and itersine are tight frames.
    accuracy : float
        Largest error of a kernel's polynomial.
    operator : str or Operator, optional
        As in `adwave.decompose`.

    References
    ----------
    Hammond, Vandergheynst & Gribonval, "Wavelets on graphs via spectral graph theory", 2011; Leonardi & Van De Ville, "Tight
    wavelet frames on multislice graphs", 2013.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("creature", vertices=2000)
    >>> frame = aw.baselines.GraphWavelets(shape, 5)
    >>> coefficients = frame.analyze()
    >>> coefficients.shape
    (5, 2024, 3)
    >>> bool(abs(frame.synthesize(coefficients) - shape.points).max() < 1e-8)
    True
    """

    __slots__ = ("_arguments", "_data", "decomposer")

    def __init__(
        self,
        shape: object,
        kernels: int = 9,
        *,
        family: Literal["meyer", "mexican-hat", "abspline", "itersine"] = "meyer",
        accuracy: float = 1e-6,
        operator: OperatorLike = None,
    ) -> None:
        self.decomposer: Decomposer = prepare_decomposer(shape, operator)
        self._arguments = (kernels, family, accuracy)
        self._data = _native.FrameData(self.decomposer._data, family, kernels, accuracy)

    @property
    def bounds(self) -> tuple[float, float]:
        """Bounds A and B of the frame: ``A‖f‖² ≤ Σ‖c_i‖² ≤ B‖f‖²``; both are 1 for a tight frame."""
        return self._data.bounds

    @property
    def degree(self) -> int:
        """Degree of the polynomials: number of products with the Laplacian in an analysis."""
        return self._data.degree

    def kernels(self, values: ArrayLike) -> NDArray[np.float64]:
        """``g_i(λ)`` at these λ in [0, 2], kernels × values, with the low pass first."""
        return self._data.kernels(np.asarray(values, dtype=np.float64).tolist())

    def analyze(self, signal: SignalLike = None, *, progress: ProgressLike = None) -> NDArray[np.float64]:
        """Coefficients ``c_i = g_i(L) f``, kernels × n (× channels), with the low pass first."""
        _, values, layout = self.decomposer._resolve_signal(signal)
        given = np.array(self.decomposer.shape.points) if values is None else values
        with report_progress(progress, "splitting") as report:
            found = self._data.analyze(given, report)
        return layout.arrange(found)

    def synthesize(
        self, coefficients: ArrayLike, *, tolerance: float = 1e-10, progress: ProgressLike = None
    ) -> NDArray[np.float64]:
        """The signal whose coefficients are nearest to the given ones, by conjugate gradients."""
        given = np.asarray(coefficients, dtype=np.float64)
        is_flat = given.ndim == 2
        stacked = np.ascontiguousarray(given[:, :, None] if is_flat else given)
        if stacked.ndim != 3:
            raise ValueError(f"coefficients must be kernels × n, or kernels × n × channels, got shape {given.shape}")
        with report_progress(progress, "synthesizing") as report:
            back, _ = self._data.synthesize(stacked, tolerance, report)
        return back[:, 0] if is_flat else back

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore_frame, (self.decomposer, *self._arguments)


def _restore_frame(decomposer: Decomposer, kernels: int, family: Any, accuracy: float) -> GraphWavelets:
    return GraphWavelets(decomposer, kernels, family=family, accuracy=accuracy)


class DiffusionWavelets:
    """Diffusion wavelets whose levels have fewer and fewer functions, orthogonal or biorthogonal.

    The matrices are dense: for a few thousand vertices.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape (see `adwave.Shape`), or an `adwave.Decomposer` whose diffusion is reversible.
    levels : int
        Largest number of levels; there are fewer if the rank falls to 1.
    biorthogonal : bool
        Use local functions with duals instead of orthonormal ones.
    precision : float
        Remainder of a column that counts as zero.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
    operator : str or Operator, optional
        As in `adwave.decompose`.

    References
    ----------
    Coifman & Maggioni, "Diffusion wavelets", 2006; Maggioni et al., "Biorthogonal diffusion wavelets for multiscale
    representations on manifolds and graphs", 2005.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> ring = aw.graph(32, [[i, (i + 1) % 32] for i in range(32)])
    >>> wavelets = aw.baselines.DiffusionWavelets(ring, levels=4)
    >>> f = np.cos(np.arange(32))
    >>> bool(abs(wavelets.synthesize(wavelets.analyze(f)) - f).max() < 1e-10)
    True
    """

    __slots__ = ("_arguments", "_data", "decomposer")

    def __init__(
        self,
        shape: object,
        levels: int = 10,
        *,
        biorthogonal: bool = False,
        precision: float = 1e-6,
        progress: ProgressLike = None,
        operator: OperatorLike = None,
    ) -> None:
        self.decomposer: Decomposer = prepare_decomposer(shape, operator)
        self._arguments = (levels, biorthogonal, precision)
        with report_progress(progress, "compressing") as report:
            self._data = _native.MultiscaleData(self.decomposer._data, not biorthogonal, levels, precision, report)

    @property
    def ranks(self) -> list[int]:
        """Number of scaling functions of each level, from level 0."""
        return self._data.ranks

    def analyze(self, signal: ArrayLike) -> list[NDArray[np.float64]]:
        """Coefficients of an (n,) signal: of the wavelets of each level, then of the last scaling functions."""
        values = _adapt.values_array(signal, self.decomposer.n_vertices, "signal")
        if values.shape[1] != 1:
            raise ValueError(f"signal must be one number for each vertex, got shape {np.shape(signal)}")
        return self._data.analyze(values[:, 0])

    def synthesize(self, coefficients: Sequence[ArrayLike]) -> NDArray[np.float64]:
        """The signal with the given coefficients, (n,)."""
        return self._data.synthesize([np.asarray(c, dtype=np.float64) for c in coefficients])

    def scaling_functions(self, level: int) -> NDArray[np.float64]:
        """Scaling functions of a level from 1, as rows of n values, of unit length in the symmetric form."""
        return self._data.functions(level, 0)

    def wavelets(self, level: int) -> NDArray[np.float64]:
        """Wavelets of a level from 1, as rows of n values."""
        return self._data.functions(level, 1)

    def duals(self, level: int) -> NDArray[np.float64]:
        """Functions dual to `scaling_functions`, which are the same for orthogonal wavelets."""
        return self._data.functions(level, 2)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore_wavelets, (self.decomposer, *self._arguments)


def _restore_wavelets(decomposer: Decomposer, levels: int, biorthogonal: bool, precision: float) -> DiffusionWavelets:
    return DiffusionWavelets(decomposer, levels, biorthogonal=biorthogonal, precision=precision)
