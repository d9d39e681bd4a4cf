"""Methods that bands are compared with: manifold harmonics, kernel signatures, Lee's saliency, Taubin smoothing.

>>> import adwave as aw
>>> values, functions = aw.baselines.harmonics(aw.sample("sphere", vertices=500), 9)
>>> bool(abs(values[1:4] - 2).max() < 0.1)
True
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from adwave import _native
from adwave._decomposer import SignalLike, prepared
from adwave._progress import ProgressLike, reporting
from adwave._shape import Shape, as_shape

__all__ = ["harmonics", "heat_kernel_signature", "lee_saliency", "taubin", "wave_kernel_signature"]


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
    weights: Literal["uniform", "cotangent"] = "uniform",
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
