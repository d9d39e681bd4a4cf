"""Methods that bands are compared with: harmonics, spectral graph wavelets, diffusion wavelets, signatures, saliency, smoothing.

>>> import adwave as aw
>>> values, functions = aw.baselines.harmonics(aw.sample("sphere", vertices=500), 9)
>>> bool(abs(values[1:4] - 2).max() < 0.1)
True
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._decomposer import Decomposer, SignalLike, prepared
from adwave._progress import ProgressLike, reporting
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


def harmonics(
    shape: object, k: int, faces: object = None, *, progress: ProgressLike = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The first eigenvalues and eigenfunctions of the Laplacian (intrinsic Delaunay, lumped masses).

    Parameters
    ----------
    shape, faces
        Anything that is a shape; see `adwave.Shape`.
    k : int
        How many.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total).

    Returns
    -------
    values : (k,) array
        By rising value, 1 / squared model units; one 0 for each component.
    functions : (n, k) array
        Of norm 1 by the masses.

    References
    ----------
    Vallet & Lévy, "Spectral geometry processing with manifold harmonics", 2008.
    """
    with reporting(progress, "eigenfunctions") as report:
        return _native.harmonics(as_shape(shape, faces)._data, k, report)


def heat_kernel_signature(
    shape: object, faces: object = None, *, k: int = 100, scales: int = 16, progress: ProgressLike = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """``HKS(x, t) = Σ_k e^(−λ_k t) φ_k(x)²``: the heat that stays.

    Returns
    -------
    times : (scales,) array
        Squared model units.
    values : (n, scales) array

    References
    ----------
    Sun, Ovsjanikov & Guibas, "A concise and provably informative multi-scale signature based on heat diffusion", 2009.
    """
    with reporting(progress, "eigenfunctions") as report:
        return _native.signature(as_shape(shape, faces)._data, "heat", k, scales, report)


def wave_kernel_signature(
    shape: object, faces: object = None, *, k: int = 100, scales: int = 16, progress: ProgressLike = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The wave kernel signature of each vertex.

    Returns
    -------
    energies : (scales,) array
        ln λ.
    values : (n, scales) array

    References
    ----------
    Aubry, Schlickewei & Cremers, "The wave kernel signature", 2011.
    """
    with reporting(progress, "eigenfunctions") as report:
        return _native.signature(as_shape(shape, faces)._data, "wave", k, scales, report)


def lee_saliency(
    shape: object, faces: object = None, *, progress: ProgressLike = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The saliency of a mesh by differences of Gaussians of its mean curvature, five scales.

    Returns
    -------
    saliency : (n,) array
        ≥ 0.
    curvature : (n,) array
        Mean curvature, 1 / model units.

    References
    ----------
    Lee, Varshney & Jacobs, "Mesh saliency", 2005.
    """
    with reporting(progress, "saliency") as report:
        return _native.lee(as_shape(shape, faces)._data, report)


def taubin(
    shape: object,
    faces: object = None,
    *,
    signal: SignalLike = None,
    lam: float = 0.5,
    mu: float = -0.53,
    iterations: int = 10,
    weights: _Weights = "uniform",
) -> Shape | NDArray[np.float64]:
    """Taubin's λ|μ smoothing: ``((1 − μK)(1 − λK))^iterations f``.

    Returns
    -------
    Shape, or an array like the signal where one is given.

    References
    ----------
    Taubin, "A signal processing approach to fair surface design", 1995.
    """
    own = prepared(shape, faces, {})
    _, values, is_flat = own._signal(signal)
    given = np.array(own.shape.points) if values is None else values
    smoothed = _native.taubin(own.shape._data, given, weights, lam, mu, iterations)
    if values is None:
        return own.shape._with(smoothed)
    return smoothed[:, 0] if is_flat else smoothed


def differential_coordinates(
    shape: object, faces: object = None, *, signal: SignalLike = None, weights: _Weights = "cotangent"
) -> NDArray[np.float64]:
    """``δ = (I − P) f``, P a mean over the neighbors: by how much each vertex differs from it.

    Parameters
    ----------
    shape, faces
        Anything that is a shape; see `adwave.Shape`.
    signal : str or array-like, optional
        As for `adwave.decompose`; the coordinates where none is given.
    weights : {'uniform', 'cotangent'}
        Which mean.

    Returns
    -------
    (n, c) array, or (n,) of a signal of one dimension.

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
    own = prepared(shape, faces, {})
    _, values, is_flat = own._signal(signal)
    given = np.array(own.shape.points) if values is None else values
    delta = _native.differential_coordinates(own.shape._data, given, weights)
    return delta[:, 0] if is_flat else delta


def from_differential_coordinates(
    shape: object,
    coordinates: ArrayLike,
    anchors: ArrayLike,
    targets: ArrayLike,
    faces: object = None,
    *,
    anchor_weight: float = 1.0,
    weights: _Weights = "cotangent",
) -> NDArray[np.float64]:
    """The signal whose differential coordinates are nearest to these, with some vertices near places of their own.

    Least squares: ``(LᵀL + W²) f = Lᵀδ + W²t``, by one sparse factorization.

    Parameters
    ----------
    shape, faces
        Anything that is a shape; see `adwave.Shape`.
    coordinates : (n, c) or (n,) array-like
        δ.
    anchors : (k,) array-like of int
        Vertices that are wanted somewhere; at least one of each component.
    targets : (k, c) or (k,) array-like
        Where.
    anchor_weight : float
        w, against 1 of every differential coordinate.
    weights : {'uniform', 'cotangent'}
        As the coordinates were made.

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
    own = as_shape(shape, faces)
    delta = _adapt.values_array(coordinates, own.n_vertices, "coordinates")
    at = np.asarray(anchors)
    if at.ndim != 1 or (at.size and at.dtype.kind not in "iu") or (at < 0).any():
        raise ValueError(f"anchors: shape {at.shape}, {at.dtype}; give the numbers of vertices")
    where = _adapt.values_array(targets, len(at), "targets")
    if where.shape[1] != delta.shape[1]:
        raise ValueError(f"targets: {where.shape[1]} columns, coordinates: {delta.shape[1]}")
    solved = _native.from_differential(own._data, delta, at.tolist(), where, float(anchor_weight), weights)
    return solved[:, 0] if np.ndim(coordinates) == 1 else solved


class CriticalPoints(NamedTuple):
    """Critical points of a function at one scale."""

    time: float
    """t, squared model units."""
    smoothed: NDArray[np.float64]
    """The function at that scale, (n,)."""
    points: NDArray[Any]
    """vertex; kind: 1 a maximum, −1 a minimum, 0 a saddle; multiplicity; value."""
    index_sum: int
    """The sum of the indices: the Euler characteristic of the mesh."""


def feature_map(
    shape: object,
    times: Sequence[float],
    faces: object = None,
    *,
    signal: SignalLike = "mean-curvature",
    progress: ProgressLike = None,
) -> list[CriticalPoints]:
    """Critical points of a function that is smoothed by heat: ``e^(−tΔ) f`` for each time t.

    Parameters
    ----------
    shape, faces
        Anything that is a mesh; see `adwave.Shape`.
    times : sequence of float
        t, squared model units: smoothed over about ``√(2t)``.
    signal : str or (n,) array-like
        f.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total).

    Examples
    --------
    >>> import adwave as aw
    >>> (level,) = aw.baselines.feature_map(aw.sample("creature", vertices=2000), [0.01])
    >>> level.index_sum
    2
    """
    own = as_shape(shape, faces)
    values = own.signal(signal) if isinstance(signal, str) else np.asarray(signal, dtype=np.float64)
    flat = _adapt.values_array(values, own.n_vertices, "signal")
    if flat.shape[1] != 1:
        raise ValueError(f"signal: shape {np.shape(values)}; a feature map is of one number at each vertex")
    kinds = np.dtype([("vertex", np.int64), ("kind", np.int8), ("multiplicity", np.int32), ("value", np.float64)])
    with reporting(progress, "smoothing") as report:
        found = _native.feature_map(own._data, flat[:, 0], [float(t) for t in times], report)
    return [
        CriticalPoints(time, smoothed, np.array(points, dtype=kinds), index_sum)
        for time, smoothed, points, index_sum in found
    ]


class GraphWavelets:
    """Spectral graph wavelets: kernels ``g_i`` of the normalized Laplacian of the same diffusion, as Chebyshev polynomials.

    Parameters
    ----------
    shape, faces
        Anything that is a shape (see `adwave.Shape`), or a `adwave.Decomposer` whose diffusion is reversible.
    kernels : int
        How many, the low pass among them.
    family : {'meyer', 'mexican-hat', 'abspline', 'itersine'}
        Meyer's and itersine are tight frames.
    accuracy : float
        Largest error of a kernel's polynomial.
    **operator
        The options of `adwave.Decomposer`.

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
        faces: object = None,
        *,
        family: Literal["meyer", "mexican-hat", "abspline", "itersine"] = "meyer",
        accuracy: float = 1e-6,
        **operator: Any,
    ) -> None:
        self.decomposer: Decomposer = prepared(shape, faces, operator)
        self._arguments = (kernels, family, accuracy)
        self._data = _native.FrameData(self.decomposer._data, family, kernels, accuracy)

    @property
    def bounds(self) -> tuple[float, float]:
        """A and B of the frame: ``A‖f‖² ≤ Σ‖c_i‖² ≤ B‖f‖²``; both 1 of a tight one."""
        return self._data.bounds

    @property
    def degree(self) -> int:
        """Of the polynomials: how many products with the Laplacian an analysis takes."""
        return self._data.degree

    def kernels(self, values: ArrayLike) -> NDArray[np.float64]:
        """``g_i(λ)`` at these λ in [0, 2], kernels × values, the low pass first."""
        return self._data.kernels(np.asarray(values, dtype=np.float64).tolist())

    def analyze(self, signal: SignalLike = None, *, progress: ProgressLike = None) -> NDArray[np.float64]:
        """``c_i = g_i(L) f``, kernels × n (× channels), the low pass first."""
        _, values, is_flat = self.decomposer._signal(signal)
        given = np.array(self.decomposer.shape.points) if values is None else values
        with reporting(progress, "splitting") as report:
            found = self._data.analyze(given, report)
        return found[:, :, 0] if is_flat else found

    def synthesize(
        self, coefficients: ArrayLike, *, tolerance: float = 1e-10, progress: ProgressLike = None
    ) -> NDArray[np.float64]:
        """The signal whose coefficients are nearest to these, by conjugate gradients."""
        given = np.asarray(coefficients, dtype=np.float64)
        is_flat = given.ndim == 2
        stacked = np.ascontiguousarray(given[:, :, None] if is_flat else given)
        if stacked.ndim != 3:
            raise ValueError(f"coefficients: shape {given.shape}; give kernels × n, or kernels × n × channels")
        with reporting(progress, "putting together") as report:
            back, _ = self._data.synthesize(stacked, tolerance, report)
        return back[:, 0] if is_flat else back

    def __reduce__(self) -> tuple[Any, ...]:
        return _frame_again, (self.decomposer, *self._arguments)


def _frame_again(decomposer: Decomposer, kernels: int, family: Any, accuracy: float) -> GraphWavelets:
    return GraphWavelets(decomposer, kernels, family=family, accuracy=accuracy)


class DiffusionWavelets:
    """Diffusion wavelets with fewer functions level by level, orthogonal or biorthogonal; dense, for a few thousand vertices.

    Parameters
    ----------
    shape, faces
        Anything that is a shape (see `adwave.Shape`), or a `adwave.Decomposer` whose diffusion is reversible.
    levels : int
        At most; fewer where the rank falls to 1.
    biorthogonal : bool
        Local functions with duals in the place of orthonormal ones.
    precision : float
        What is left of a column and counted as nothing.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total).
    **operator
        The options of `adwave.Decomposer`.

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
        faces: object = None,
        *,
        biorthogonal: bool = False,
        precision: float = 1e-6,
        progress: ProgressLike = None,
        **operator: Any,
    ) -> None:
        self.decomposer: Decomposer = prepared(shape, faces, operator)
        self._arguments = (levels, biorthogonal, precision)
        with reporting(progress, "compressing") as report:
            self._data = _native.MultiscaleData(self.decomposer._data, not biorthogonal, levels, precision, report)

    @property
    def ranks(self) -> list[int]:
        """How many scaling functions each level has, from 0 on."""
        return self._data.ranks

    def analyze(self, signal: ArrayLike) -> list[NDArray[np.float64]]:
        """Coefficients of a signal of one number at each vertex: of the wavelets of each level, then of the last scaling functions."""
        values = _adapt.values_array(signal, self.decomposer.n_vertices, "signal")
        if values.shape[1] != 1:
            raise ValueError(f"signal: shape {np.shape(signal)}; give one number for each vertex")
        return self._data.analyze(values[:, 0])

    def synthesize(self, coefficients: Sequence[ArrayLike]) -> NDArray[np.float64]:
        """The signal of coefficients."""
        return self._data.synthesize([np.asarray(c, dtype=np.float64) for c in coefficients])

    def scaling_functions(self, level: int) -> NDArray[np.float64]:
        """Those of a level from 1, a row for each, of unit length in the symmetric form."""
        return self._data.functions(level, 0)

    def wavelets(self, level: int) -> NDArray[np.float64]:
        """Those of a level from 1, a row for each."""
        return self._data.functions(level, 1)

    def duals(self, level: int) -> NDArray[np.float64]:
        """The functions dual to `scaling_functions`; of orthogonal wavelets the same."""
        return self._data.functions(level, 2)

    def __reduce__(self) -> tuple[Any, ...]:
        return _wavelets_again, (self.decomposer, *self._arguments)


def _wavelets_again(decomposer: Decomposer, levels: int, biorthogonal: bool, precision: float) -> DiffusionWavelets:
    return DiffusionWavelets(decomposer, levels, biorthogonal=biorthogonal, precision=precision)
