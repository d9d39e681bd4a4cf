"""Diffusion and bands as differentiable functions of PyTorch.

>>> import torch  # doctest: +SKIP
>>> import adwave as aw  # doctest: +SKIP
>>> walk = aw.Decomposer(aw.sample("sphere", vertices=100))  # doctest: +SKIP
>>> f = torch.rand(100, 2, dtype=torch.float64, requires_grad=True)  # doctest: +SKIP
>>> torch.autograd.gradcheck(lambda f: aw.torch.smooth(walk, f, 3.0), f)  # doctest: +SKIP
True
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch

from adwave import _native
from adwave._decomposer import Decomposer

__all__ = ["bands", "smooth", "weighted"]


def _numbers(tensor: torch.Tensor) -> np.ndarray:
    return tensor.detach().to("cpu", torch.float64).contiguous().numpy()


class _Weighted(torch.autograd.Function):
    """``Σ_j factors[j]·W_f(j)``, a polynomial p of Φ₁; its adjoint is ``π·p(Φ₁)(g/π)``."""

    @staticmethod
    def forward(
        ctx: Any, signal: Any, walk: Decomposer, factors: list[float], steps: list[float], accuracy: float
    ) -> Any:
        ctx.asked = (walk, factors, steps, accuracy)
        found = walk.weighted(_numbers(signal), factors, steps, accuracy=accuracy)
        return torch.from_numpy(found).to(signal.device, signal.dtype)

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        walk, factors, steps, accuracy = ctx.asked
        (gradient,) = gradients
        share = walk._data.welding()[1]
        values = _numbers(gradient)
        share = share if values.ndim == 1 else share[:, None]
        found = share * walk.weighted(values / share, factors, steps, accuracy=accuracy)
        return torch.from_numpy(found).to(gradient.device, gradient.dtype), None, None, None, None


def weighted(
    walk: Decomposer,
    signal: torch.Tensor,
    factors: Sequence[float],
    steps: Sequence[float],
    *,
    accuracy: float = _native.ACCURACY,
) -> torch.Tensor:
    """``Σ_j factors[j−1]·W_f(j)`` with its exact gradient; see `adwave.Decomposer.weighted`.

    Parameters
    ----------
    walk : Decomposer
        Of a reversible diffusion.
    signal : (n,) or (n, c) tensor
        On any device; the work is done by the processor in double precision.
    """
    if not walk._data.is_reversible() or walk.mask is not None:
        raise ValueError("gradients need a reversible diffusion; leave out directed and masks")
    return _Weighted.apply(signal, walk, [float(f) for f in factors], [float(n) for n in steps], accuracy)


def smooth(walk: Decomposer, signal: torch.Tensor, steps: float, *, accuracy: float = _native.ACCURACY) -> torch.Tensor:
    """``Φ₁^steps f`` with its exact gradient."""
    return signal + weighted(walk, signal, [-1.0], [steps], accuracy=accuracy)


def bands(walk: Decomposer, signal: torch.Tensor, levels: int, *, accuracy: float = _native.ACCURACY) -> torch.Tensor:
    """The bands of dyadic levels, (levels + 1) × n × …, with their exact gradient."""
    steps = walk.steps(levels=levels)
    found = [
        weighted(walk, signal, [float(j == level) for j in range(levels)], steps, accuracy=accuracy)
        for level in range(levels)
    ]
    return torch.stack([*found, signal - sum(found)])
