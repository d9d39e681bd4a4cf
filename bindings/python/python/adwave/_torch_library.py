"""Requests that the library computes on the CPU in double precision, and those of an operator on a device."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch

from adwave import _native
from adwave._decomposer import Decomposer
from adwave._options import BandsRequest, LevelsLike, check_steps
from adwave._torch_device import Operator, positive_share
from adwave._torch_functions import Combine, Split, compiled_number, compiled_split
from adwave._walk import Walk, as_walk


@dataclass(frozen=True, eq=False)
class LibraryBands:
    """A prepared shape with numbers of steps and an accuracy: everything but the signal."""

    walk: Decomposer
    steps: tuple[float, ...]
    accuracy: float

    @property
    def n_pieces(self) -> int:
        """Number of bands and the rest."""
        return len(self.steps) + 1

    def share(self) -> np.ndarray:
        """Share π of each vertex in the stationary distribution, (n, 1), and 1 for isolated vertices.

        Raises
        ------
        ValueError
            If a vertex without area leads to others.
        """
        share = self.walk._data.welding()[1]
        if (share == 0).any():
            step = self.walk.matrix()
            is_welded = step.shape[0] < self.walk.n_vertices
            share = positive_share(step, self.walk.vertex_map() if is_welded else np.arange(len(share)), share)
            if (share == 0).any():
                raise ValueError(
                    f"gradients need an area at each vertex, and vertex {int((share == 0).argmax())} has none; compute with "
                    "aw.torch.Operator(shape, dtype=torch.float64), or remove the faces of area 0"
                )
        return share[:, None]

    def split(self, signal: torch.Tensor) -> torch.Tensor:
        """Bands of n × channels values, (J + 1) × n × channels."""
        found, _ = self.walk._data.bands(BandsRequest(_to_numpy(signal), self.steps, self.accuracy))
        return _from_numpy(found, signal)

    def join(self, weights: torch.Tensor) -> torch.Tensor:
        """Adjoint of `split`: with the bands self-adjoint under π, ``π·Σ_j W_(j)(g_j/π)``, n × channels.

        The rest S(J) = f − Σ_j W_(j) has the adjoint ``g − Σ_j W_(j)ᵀ g``.
        """
        given, share = _to_numpy(weights), self.share()
        rest = given[-1]
        signals = np.ascontiguousarray((given[:-1] - rest) / share)
        if self.walk._data.has_sum_of_bands(self.steps):
            total = self.walk._data.sum_of_bands(signals, self.steps)
        else:
            total = sum(
                self._weighted(signal, [float(j == level) for j in range(len(self.steps))])
                for level, signal in enumerate(signals)
            )
        return _from_numpy(rest + share * total, weights)

    def combine(self, signal: torch.Tensor, factors: Sequence[float], is_adjoint: bool) -> torch.Tensor:
        """``Σ_j factors[j]·W_f(j)`` by one polynomial p of Φ₁; its adjoint is ``π·p(Φ₁)(g/π)``."""
        share = self.share() if is_adjoint else 1.0
        found = self._weighted(np.ascontiguousarray(_to_numpy(signal) / share), factors)
        return _from_numpy(share * found, signal)

    def _weighted(self, signal: np.ndarray, factors: Sequence[float]) -> Any:
        return self.walk._data.combine_bands(BandsRequest(signal, self.steps, self.accuracy), factors)


@dataclass(frozen=True, eq=False)
class LibraryPowers:
    """A walk with the numbers of steps between which its bands lie."""

    walk: Walk
    stops: tuple[int, ...]

    @property
    def n_pieces(self) -> int:
        """Number of bands and the rest."""
        return len(self.stops) + 1

    def split(self, signal: torch.Tensor) -> torch.Tensor:
        """Bands between powers of n × channels values, (J + 1) × n × channels."""
        return _from_numpy(self.walk._data.bands(_to_numpy(signal), list(self.stops)), signal)

    def join(self, weights: torch.Tensor) -> torch.Tensor:
        """Adjoint of `split`, by the transposed walk."""
        return _from_numpy(self.walk._data.adjoint(_to_numpy(weights), list(self.stops)), weights)


def split_bands(
    walk: Decomposer | Operator, rows: torch.Tensor, steps: Sequence[float], accuracy: float | None
) -> torch.Tensor:
    """Bands of n × channels values with their gradient, (J + 1) × n × channels."""
    if torch.compiler.is_compiling() and isinstance(walk, Operator):
        return compiled_split(rows, _number_of_bands(walk, tuple(steps)))
    return Split.apply(rows, _bands_request(walk, steps, accuracy))


def weighted_bands(
    walk: Decomposer | Operator,
    rows: torch.Tensor,
    factors: Sequence[float],
    steps: Sequence[float],
    accuracy: float | None,
) -> torch.Tensor:
    """``Σ_j factors[j]·W_f(j)`` of n × channels values with its gradient, n × channels."""
    if len(factors) != len(steps):
        raise ValueError(f"factors must be one for each of {len(steps)} levels, got {len(factors)}")
    if torch.is_tensor(factors) or torch.compiler.is_compiling():
        weights = torch.as_tensor(factors).to(rows)
        return torch.einsum("j,jnc->nc", weights, split_bands(walk, rows, steps, accuracy)[:-1])
    request = _bands_request(walk, steps, accuracy)
    return Combine.apply(rows, request, tuple(float(factor) for factor in factors), False)


def split_powers(walk: object, rows: torch.Tensor, stops: Sequence[int]) -> torch.Tensor:
    """Bands between powers of n × channels values with their gradient, (J + 1) × n × channels."""
    if isinstance(walk, Operator):
        if torch.compiler.is_compiling():
            return compiled_split(rows, _number_of_powers(walk, tuple(stops)))
        return Split.apply(rows, walk.power_request(stops))
    return Split.apply(rows, LibraryPowers(as_walk(walk), tuple(stops)))


def schedule(walk: Decomposer | Operator, levels: LevelsLike) -> Sequence[float]:
    """Number of steps of each level."""
    return _constant_schedule(walk, levels) if torch.compiler.is_compiling() else walk.schedule(levels)


@torch.compiler.assume_constant_result
def _constant_schedule(walk: Decomposer | Operator, levels: LevelsLike) -> Sequence[float]:
    return tuple(walk.schedule(levels))


@torch.compiler.assume_constant_result
def _number_of_bands(operator: Operator, steps: tuple[float, ...]) -> int:
    return compiled_number(operator.request(steps))


@torch.compiler.assume_constant_result
def _number_of_powers(operator: Operator, stops: tuple[int, ...]) -> int:
    return compiled_number(operator.power_request(stops))


def _bands_request(walk: Decomposer | Operator, steps: Sequence[float], accuracy: float | None) -> Any:
    if torch.is_tensor(steps) or any(torch.is_tensor(n) for n in steps):
        raise TypeError("steps must be numbers: there is no gradient with respect to them; pass float(steps)")
    if isinstance(walk, Operator):
        return walk.request(steps)
    if not walk._data.is_reversible() or walk.mask is not None:
        raise ValueError("gradients need a reversible diffusion; leave out directed and masks")
    return LibraryBands(walk, tuple(check_steps(steps)), _native.ACCURACY if accuracy is None else accuracy)


def _to_numpy(tensor: torch.Tensor) -> np.ndarray:
    return tensor.detach().to("cpu", torch.float64).contiguous().numpy()


def _from_numpy(values: np.ndarray, like: torch.Tensor) -> torch.Tensor:
    return torch.from_numpy(np.ascontiguousarray(values)).to(like.device, like.dtype)
