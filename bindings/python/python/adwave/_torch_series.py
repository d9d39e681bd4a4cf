"""Chebyshev series of bands, and bounds of the errors of a recurrence with them."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

#: Degree beyond which a series is refused.
MOST_TERMS = 1 << 14
#: Rounding of a coefficient, relative to the sum of the terms and for each node of the transform.
_ROUNDING = 1e-16


class Semigroup(NamedTuple):
    """Meaning of n steps of Φ₁."""

    #: ``'steps'``, the power Φ₁ⁿ; ``'plain'``, the power (2Φ₁ − I)ⁿ; ``'heat'``, ``exp(−n·rate·(I − Φ₁))``.
    kind: str
    #: Mean number of steps of Φ₁ for each step of heat.
    rate: float = 1.0

    def quotient(self, a: float, b: float, half: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values ``(s_a − s_b)/(1 − λ)`` at λ = cos²(half), where s_n is the value of n steps at the eigenvalue λ."""
        # λ and 1 − λ without cancellation.
        inside, rest = np.cos(half) ** 2, np.sin(half) ** 2
        if self.kind == "heat":
            return np.exp(-self.rate * a * rest) * -np.expm1(-self.rate * (b - a) * rest) / rest
        if self.kind == "steps":
            log = np.where(inside > 0.5, np.log1p(-np.minimum(rest, 0.5)), np.log(inside))
            return np.exp(a * log) * -np.expm1((b - a) * log) / rest
        y = np.cos(2 * half)
        with np.errstate(divide="ignore"):
            log = np.where(y > 0, np.log1p(-2 * np.minimum(rest, 0.5)), 0.0)
        falls = np.where(y > 0, -np.expm1((b - a) * log), 1.0 - np.minimum(y, 0.0) ** (b - a))
        return y**a * falls / rest


class Series(NamedTuple):
    """A polynomial ``Σ_k a_k T_k(2Φ₁ − I)`` whose product with I − Φ₁ is a band."""

    coefficients: NDArray[np.float64]
    #: Sum of the sizes of the coefficients that were left out: bound of the error relative to (I − Φ₁)f.
    tail: float


@lru_cache(maxsize=1024)
def band_series(semigroup: Semigroup, a: float, b: float, remainder: float) -> Series:
    """Series of the band between a and b steps, without terms whose sum is below `remainder` of the sum of all.

    Raises
    ------
    ValueError
        If the series of a fractional power converges too slowly.
    """
    n = 32
    while n <= MOST_TERMS:
        half = np.pi * (2 * np.arange(n) + 1) / (4 * n)
        values = semigroup.quotient(a, b, half)
        # The sum over the nodes is the real part of a Fourier transform of twice the length.
        found = np.fft.rfft(np.concatenate([values, values[::-1]]))[:n]
        found = (found * np.exp(-0.5j * np.pi * np.arange(n) / n)).real / n
        found[0] /= 2
        sizes = np.abs(found)
        tail = sizes[::-1].cumsum()[::-1]
        rounding = _ROUNDING * n * sizes.sum()
        if np.count_nonzero(tail > rounding) <= n // 2:
            kept = max(int(np.count_nonzero(tail > max(rounding, remainder * sizes.sum()))), 1)
            return Series(found[:kept], float(tail[kept]))
        n *= 2
    raise ValueError(
        f"steps {a:g} to {b:g} need more than {MOST_TERMS} products: small fractional powers of a walk converge slowly; "
        "give whole steps, prepare the shape with operator='surface', or leave out the device"
    )


class StepRounding(NamedTuple):
    """Bound of the rounding of a recurrence ``T_{k+1} = A T_k − T_{k−1}`` with the rows A = 4Φ₁ − 2I.

    A step sums m products and T_{k−1} in any order. With the unit roundoff ε, ``γ_m = mε/(1 − mε)`` and the largest sum R
    of the sizes of a row, which bounds the norm of |A| because Φ₁ is self-adjoint, the step is off by at most
    ``c·V``, ``c = (R + 1)·γ_{m+2}``, for vectors of norm at most V (`higham2002`, chapter 3). The error of step i reaches
    ``T_k`` through ``U_{k−i}``, whose norm is at most k − i + 1.
    """

    epsilon: float
    #: Error of a step, and that by underflow, in the norm of the stationary distribution.
    per_step: float
    underflow: float

    @classmethod
    def of_rows(cls, longest: int, row_sum: float, dtype: np.dtype[np.floating]) -> StepRounding:
        """The bound of rows of at most `longest` entries, whose sizes sum to `row_sum` at most."""
        numbers = np.finfo(dtype)
        epsilon = float(numbers.eps) / 2
        return cls(epsilon, (row_sum + 1) * gamma(longest + 2, epsilon), (longest + 3) * float(numbers.tiny))

    def error(self, coefficients: NDArray[np.float64], start: float) -> float:
        """Bound of the error of ``Σ_k coefficients[k]·T_k u`` by rounding for a vector u of norm `start`."""
        per_step = self.per_step + self.underflow / start
        k = np.arange(len(coefficients), dtype=float)
        grown = per_step * k * (k + 1) / 2
        left = 1.0 - self.epsilon - grown[-1]
        if not left > 0:
            return np.inf
        largest = 1.0 / left
        summed = gamma(len(coefficients) + 2, self.epsilon) * largest
        return float(start * (np.abs(coefficients) * (self.epsilon + grown * largest + summed)).sum())


def gamma(n: int, epsilon: float) -> float:
    """``nε/(1 − nε)``, the relative error of n roundings; infinite where that bound fails."""
    return n * epsilon / (1 - n * epsilon) if n * epsilon < 1 else np.inf
