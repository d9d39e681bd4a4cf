"""Functions of the eigenvalues of a Laplacian: filters of one's own, and banks with a name.

A kernel g is any function of an array of eigenvalues λ. `filter` applies one, ``g(L)f``, and `apply` several at the cost
of the one of greatest degree, without eigenvectors: by a polynomial whose largest error is measured.

For a graph and any other walk, ``L = I − D⁻¹W`` has its eigenvalues in [0, 2]; it is similar to the symmetric normalized
Laplacian. For heat on a surface, the default of meshes, L is the Laplace–Beltrami operator, and λ is one over the square
of a length.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._caller import public
from adwave._decomposer import Decomposer, prepare_decomposer
from adwave._layout import float_type
from adwave._options import OperatorLike, SignalLike
from adwave._part import default_signal, read_part
from adwave._progress import ProgressLike, report_progress

__all__ = [
    "KernelResult",
    "apply",
    "heat",
    "itersine",
    "mexican_hat",
    "meyer",
]

Kernel = Callable[[NDArray[np.float64]], ArrayLike]

_Floats = NDArray[np.float64]

#: Largest error of a polynomial by default, relative to the largest gain.
ACCURACY = 1e-8

#: Largest number of coefficients of a polynomial.
MOST_COEFFICIENTS = 1 << 14

#: Points for each coefficient at which the error is measured.
_DENSITY = 4


@dataclass(frozen=True)
class KernelResult:
    """A signal after each of several kernels.

    Attributes
    ----------
    values : ndarray
        The signals, (n_kernels, …) with the axes of the signal after the first.
    degrees : list of int
        The degree of the polynomial of each kernel.
    errors : list of float
        The largest error of the gain of each kernel, measured at four points for each coefficient. The result differs
        from the exact one by at most as much, relative to the signal, in the norm in which L is symmetric.

    Examples
    --------
    >>> import adwave as aw
    >>> sphere = aw.sample("sphere", vertices=500)
    >>> result = aw.kernels.apply(sphere, "z", [aw.kernels.heat(0.1), aw.kernels.heat(0.2)])
    >>> result.values.shape, max(result.errors) < 1e-8
    ((2, 500), True)
    """

    values: NDArray[Any]
    degrees: list[int]
    errors: list[float]


@dataclass(frozen=True)
class _Polynomial:
    """``g(λ) ≈ g(0) + (1 − φ)·Σ_k a_k T_k(2φ − 1)``, λ = range·(1 − φ)."""

    at_zero: float
    at_most: float
    coefficients: _Floats
    error: float

    @property
    def function(self) -> tuple[float, float, _Floats]:
        return self.at_zero, self.at_most, self.coefficients


def heat(time: float) -> Kernel:
    """The kernel of heat, ``exp(−t·λ)``.

    Parameters
    ----------
    time : float
        t, at least 0: a number of steps of the walk that stays nowhere, or the square of a length; a Gaussian of the
        standard deviation √(2t) along each axis of a surface.

    Returns
    -------
    callable

    Examples
    --------
    >>> import adwave as aw
    >>> float(aw.kernels.heat(2.0)(0.0))
    1.0
    """
    if not time >= 0 or not np.isfinite(time):
        raise ValueError(f"time: it must be a finite number of at least 0, got {time}")
    return lambda x: np.exp(-time * np.asarray(x))


def mexican_hat(n: int = 6, largest: float = 2.0, *, ratio: float = 20.0) -> list[Kernel]:
    """A low-pass kernel and the wavelets ``s·λ·exp(−s·λ)`` at scales s between those of the smallest and the largest λ
    (`hammond2011`).

    Parameters
    ----------
    n : int
        Number of kernels, at least 2.
    largest : float
        Largest eigenvalue: 2 for a walk, `Decomposer.spectral_range` in general.
    ratio : float
        Largest eigenvalue over the smallest one of interest.

    Returns
    -------
    list of callable
        The low-pass kernel, then wavelets from coarse to fine.

    Examples
    --------
    >>> import adwave as aw
    >>> len(aw.kernels.mexican_hat(5))
    5
    """
    _check_bank(n, largest, 2)
    if not ratio > 1:
        raise ValueError(f"ratio: it must exceed 1, got {ratio}")
    least = largest / ratio
    scales = np.geomspace(2 / least, 1 / largest, n - 1)

    def low(x: _Floats) -> _Floats:
        return 1.2 * np.exp(-1.0 - (np.asarray(x) / (0.4 * least)) ** 4)

    return [low, *(lambda x, s=scale: s * np.asarray(x) * np.exp(-s * np.asarray(x)) for scale in scales)]


def meyer(n: int = 6, largest: float = 2.0) -> list[Kernel]:
    """A low-pass kernel and Meyer wavelets of octaves, whose squares sum to 1 (`leonardi2013`).

    Parameters
    ----------
    n : int
        Number of kernels, at least 2.
    largest : float
        Largest eigenvalue, as in `mexican_hat`.

    Returns
    -------
    list of callable
        The low-pass kernel, then wavelets from coarse to fine.

    Examples
    --------
    >>> import adwave as aw
    >>> import numpy as np
    >>> x = np.linspace(0, 2, 7)
    >>> bool(np.allclose(sum(g(x) ** 2 for g in aw.kernels.meyer(4)), 1))
    True
    """
    _check_bank(n, largest, 2)
    scales = 4 / (3 * largest) * 2.0 ** np.arange(n - 2, -1, -1)

    def ramp(x: _Floats) -> _Floats:
        x = np.clip(x, 0, 1)
        return np.pi / 2 * x**4 * (35 - 84 * x + 70 * x**2 - 20 * x**3)

    def low(x: _Floats) -> _Floats:
        return np.cos(ramp(1.5 * scales[0] * np.asarray(x) - 1))

    def wavelet(scale: float) -> Kernel:
        def band(x: _Floats) -> _Floats:
            y = 1.5 * scale * np.asarray(x)
            return np.where(y < 2, np.sin(ramp(y - 1)), np.cos(ramp(y / 2 - 1)))

        return band

    return [low, *(wavelet(scale) for scale in scales)]


def itersine(n: int = 6, largest: float = 2.0) -> list[Kernel]:
    """Kernels of equal width, each overlapping its neighbors, whose squares sum to 1 (`perraudin2014`).

    Parameters
    ----------
    n : int
        Number of kernels, at least 2.
    largest : float
        Largest eigenvalue, as in `mexican_hat`.

    Returns
    -------
    list of callable
        Kernels from coarse to fine.

    Examples
    --------
    >>> import adwave as aw
    >>> import numpy as np
    >>> x = np.linspace(0, 2, 7)
    >>> bool(np.allclose(sum(g(x) ** 2 for g in aw.kernels.itersine(4)), 1))
    True
    """
    _check_bank(n, largest, 2)
    width = largest / (n - 1)

    def kernel(center: float) -> Kernel:
        def bump(x: _Floats) -> _Floats:
            y = (np.asarray(x) - center) / (2 * width)
            return np.where(np.abs(y) < 0.5, np.sin(np.pi / 2 * np.cos(np.pi * y) ** 2), 0.0)

        return bump

    return [kernel(k * width) for k in range(n)]


def _check_bank(n: int, largest: float, least: int) -> None:
    if n < least:
        raise ValueError(f"n: a bank has at least {least} kernels, got {n}")
    if not (largest > 0 and np.isfinite(largest)):
        raise ValueError(f"largest: the largest eigenvalue must be a positive number, got {largest}")


@public()
def apply(
    shape: object,
    signal: SignalLike,
    kernels: Union[Kernel, Sequence[Kernel]],
    *,
    operator: OperatorLike = None,
    accuracy: float = ACCURACY,
    progress: ProgressLike = None,
) -> KernelResult:
    """Apply functions of the Laplacian to a signal, ``g_k(L)f`` for each kernel g_k.

    Each kernel becomes a polynomial of the least degree found whose error stays below the accuracy, and all of them are
    summed by one recurrence. A constant is multiplied by g(0) exactly. Cost: as many sparse products as the greatest
    degree, about √(range·t·ln(1/accuracy)) for heat, and as many again for each ten-fold accuracy of a kernel with a kink.

    Parameters
    ----------
    shape : shape_like, Walk or Decomposer
        Anything that is a shape (see `Shape`); its walk must be reversible, as that of a symmetric graph is.
    signal : str or array_like
        As in `decompose`, without NaN.
    kernels : callable or sequence of callable
        Functions of an array of eigenvalues λ ≥ 0 that return the gain at each.
    operator : str or Operator, optional
        As in `decompose`.
    accuracy : float
        Largest error of the gains, relative to the largest gain of each kernel.
    progress : bool or callable, optional
        As in `decompose`.

    Returns
    -------
    KernelResult

    Raises
    ------
    ValueError, TypeError
        If an argument is invalid, a gain is not finite, or 2¹⁴ coefficients are too few for the accuracy; the message is
        one line.

    Examples
    --------
    >>> import adwave as aw
    >>> import numpy as np
    >>> graph = aw.graph(100, [(i, (i + 1) % 100) for i in range(100)])
    >>> f = np.cos(2 * np.pi * np.arange(100) / 100)
    >>> result = aw.kernels.apply(graph, f, [aw.kernels.heat(10), lambda x: x])
    >>> eigenvalue = 1 - np.cos(2 * np.pi / 100)
    >>> bool(np.allclose(result.values, [np.exp(-10 * eigenvalue) * f, eigenvalue * f]))
    True
    """
    part = read_part("kernels.apply", shape, {}, ())
    decomposer = prepare_decomposer(part.part, operator, None, analysis=True)
    named = default_signal(part, signal)
    values, layout = decomposer._signal_values(part.take_signal(named))
    given = [kernels] if callable(kernels) else list(kernels)
    if not given:
        raise ValueError("kernels: give at least one function of the eigenvalues")
    polynomials = [fit(kernel, _native.spectral_range(decomposer._data), accuracy) for kernel in given]
    with report_progress(progress, "filtering") as report:
        found = apply_polynomials(decomposer, values, polynomials, report)
    each = [part.spread(layout.arrange(one), layout, named) for one in found]
    dtype = float_type(named)
    return KernelResult(
        np.stack(each).astype(dtype, copy=False),
        [len(polynomial.coefficients) for polynomial in polynomials],
        [polynomial.error for polynomial in polynomials],
    )


def apply_polynomials(
    decomposer: Decomposer, values: _Floats | None, polynomials: Sequence[_Polynomial], report: Any
) -> _Floats:
    """The signal (n × channels) after each polynomial, (n_polynomials, n, channels)."""
    functions = [polynomial.function for polynomial in polynomials]
    found = _native.apply_spectral(decomposer._data, values, functions, report)
    return found.reshape(len(functions), decomposer.n_vertices, -1)


def fit(kernel: Kernel, largest: float, accuracy: float = ACCURACY) -> _Polynomial:
    """The polynomial of a kernel on eigenvalues from 0 to `largest`."""
    if not 1e-14 <= accuracy < 1:
        raise ValueError(f"accuracy: it must be at least 1e-14 and less than 1, got {accuracy}")
    at_zero, at_most = gains(kernel, np.array([0.0, largest]))
    n, error, scale = 16, 0.0, 1.0
    while n <= MOST_COEFFICIENTS:
        found = _interpolate(kernel, largest, at_zero, n)
        error, scale = _error(kernel, largest, at_zero, found)
        if error <= 0.5 * accuracy * scale:
            coefficients = _cut(found, 0.5 * accuracy * scale)
            error, _ = _error(kernel, largest, at_zero, coefficients)
            return _Polynomial(float(at_zero), float(at_most), coefficients, error)
        n *= 2
    raise ValueError(
        f"accuracy: {MOST_COEFFICIENTS} coefficients leave an error of {error / scale:.1e} where {accuracy:g} was asked "
        f"for; use a smoother kernel, or accuracy={2 * error / scale:.1g}"
    )


def gains(kernel: Kernel, x: _Floats) -> _Floats:
    """The values of a kernel, which may take single numbers only."""
    try:
        found = np.asarray(kernel(x), dtype=np.float64)
    except (TypeError, ValueError):
        found = np.array([float(np.asarray(kernel(value))) for value in x])  # type: ignore[arg-type]
    if found.shape != x.shape:
        if found.ndim:
            raise ValueError(f"kernel: it must return a gain for each of {len(x)} eigenvalues, got shape {found.shape}")
        found = np.full(x.shape, float(found))
    if not np.isfinite(found).all():
        at = x[~np.isfinite(found)][0]
        raise ValueError(f"kernel: the gain must be finite at all eigenvalues from 0, got {kernel(at)} at {at:g}")
    return found


def _interpolate(kernel: Kernel, largest: float, at_zero: float, n: int) -> _Floats:
    """Coefficients of ``(g − g(0))/(1 − φ)`` in ``T_k(2φ − 1)`` from n values."""
    angle = np.pi * (np.arange(n) + 0.5) / n
    rest = np.sin(angle / 2) ** 2  # 1 − φ, without cancellation
    values = (gains(kernel, largest * rest) - at_zero) / rest
    # A cosine transform by the fast Fourier transform of the even extension.
    spectrum = np.fft.rfft(np.concatenate([values, values[::-1]]))[:n]
    coefficients = np.real(spectrum * np.exp(-0.5j * np.pi * np.arange(n) / n)) / n
    coefficients[0] /= 2
    return coefficients


def _error(kernel: Kernel, largest: float, at_zero: float, coefficients: _Floats) -> tuple[float, float]:
    """The largest error of a polynomial at a grid that is finer than its nodes, and the largest gain there."""
    n = _DENSITY * max(len(coefficients), 64)
    padded = np.zeros(n + 1)
    padded[: len(coefficients)] = coefficients
    padded[1:] /= 2
    values = np.fft.irfft(padded, 2 * n)[: n + 1] * 2 * n
    rest = np.sin(np.pi * np.arange(n + 1) / (2 * n)) ** 2
    exact = gains(kernel, largest * rest)
    return float(np.abs(at_zero + rest * values - exact).max()), float(np.abs(exact).max())


def _cut(coefficients: _Floats, budget: float) -> _Floats:
    """The first coefficients, without a tail whose absolute values sum to at most the budget."""
    tails = np.cumsum(np.abs(coefficients[::-1]))[::-1]
    kept = max(int(np.count_nonzero(tails > budget)), 1)
    return np.ascontiguousarray(coefficients[:kept])
