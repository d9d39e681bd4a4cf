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
from adwave._options import LevelsLike

__all__ = ["bands", "combine_bands", "smooth"]


def _to_numpy(tensor: torch.Tensor) -> np.ndarray:
    return tensor.detach().to("cpu", torch.float64).contiguous().numpy()


class _CombineBands(torch.autograd.Function):
    """``Σ_j factors[j]·W_f(j)``, a polynomial p of Φ₁; its adjoint is ``π·p(Φ₁)(g/π)``."""

    @staticmethod
    def forward(
        ctx: Any, signal: Any, walk: Decomposer, factors: list[float], steps: list[float], accuracy: float
    ) -> Any:
        ctx.request = (walk, factors, steps, accuracy)
        found = walk.combine_bands(_to_numpy(signal), factors, steps, accuracy=accuracy)
        return torch.from_numpy(found).to(signal.device, signal.dtype)

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        walk, factors, steps, accuracy = ctx.request
        (gradient,) = gradients
        share = walk._data.welding()[1]
        values = _to_numpy(gradient)
        share = share if values.ndim == 1 else share[:, None]
        found = share * walk.combine_bands(values / share, factors, steps, accuracy=accuracy)
        return torch.from_numpy(found).to(gradient.device, gradient.dtype), None, None, None, None


def combine_bands(
    walk: Decomposer,
    signal: torch.Tensor,
    factors: Sequence[float],
    steps: Sequence[float],
    *,
    accuracy: float = _native.ACCURACY,
) -> torch.Tensor:
    """``Σ_j factors[j−1]·W_f(j)`` with its exact gradient; see `adwave.Decomposer.combine_bands`.

    Parameters
    ----------
    walk : Decomposer
        Shape with a reversible diffusion.
    signal : (n,) or (n, channels) tensor
        Signal on any device; the work is done on the CPU in double precision.
    factors : (J,) sequence of float
        Factor of each band, from fine to coarse.
    steps : (J,) sequence of float
        Number of steps of each level.
    accuracy : float
        Largest error relative to the bands.

    Returns
    -------
    tensor like the signal

    Raises
    ------
    ValueError
        If the diffusion is not reversible (directed clouds, masks).

    Examples
    --------
    >>> aw.torch.combine_bands(walk, f, [2.0, 1.0], [1.0, 2.0]).shape  # doctest: +SKIP
    torch.Size([100, 2])
    """
    if not walk._data.is_reversible() or walk.mask is not None:
        raise ValueError("gradients need a reversible diffusion; leave out directed and masks")
    return _CombineBands.apply(signal, walk, [float(f) for f in factors], [float(n) for n in steps], accuracy)


def smooth(walk: Decomposer, signal: torch.Tensor, steps: float, *, accuracy: float = _native.ACCURACY) -> torch.Tensor:
    """``Φ₁^steps f`` with its exact gradient.

    Parameters
    ----------
    walk : Decomposer
        Shape with a reversible diffusion.
    signal : (n,) or (n, channels) tensor
        Signal on any device.
    steps : float
        Number of steps, an integer or not.
    accuracy : float
        Largest error relative to the change.

    Returns
    -------
    tensor like the signal

    Examples
    --------
    >>> aw.torch.smooth(walk, f, 3.0).shape  # doctest: +SKIP
    torch.Size([100, 2])
    """
    return signal + combine_bands(walk, signal, [-1.0], [steps], accuracy=accuracy)


def bands(
    walk: Decomposer, signal: torch.Tensor, levels: LevelsLike, *, accuracy: float = _native.ACCURACY
) -> torch.Tensor:
    """The bands of a signal, (levels + 1) × n × …, with their exact gradient.

    Parameters
    ----------
    walk : Decomposer
        Shape with a reversible diffusion.
    signal : (n,) or (n, channels) tensor
        Signal on any device.
    levels : int, Widths, Steps or Octaves
        As in `adwave.decompose`.
    accuracy : float
        Largest error of a band relative to the band.

    Returns
    -------
    (levels + 1, n, …) tensor

    Examples
    --------
    >>> aw.torch.bands(walk, f, 4).shape  # doctest: +SKIP
    torch.Size([5, 100, 2])
    """
    steps = walk.schedule(levels)
    n_levels = len(steps)
    found = [
        combine_bands(walk, signal, [float(j == level) for j in range(n_levels)], steps, accuracy=accuracy)
        for level in range(n_levels)
    ]
    return torch.stack([*found, signal - sum(found)])
