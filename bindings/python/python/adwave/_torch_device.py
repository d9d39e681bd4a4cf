"""Bands on a device of PyTorch: the polynomials of the extension, by sparse products of PyTorch."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from adwave._decomposer import Decomposer
from adwave._options import BandsRequest

#: Remainder of a series, relative to the sum of its terms, below which further terms are omitted.
_REMAINDER = 1e-16
#: Degree beyond which a series is refused.
_MOST_TERMS = 1 << 14
#: Seed of the signs of the channels in the probe.
_SEED = 37


@lru_cache(maxsize=256)
def series(a: float, b: float) -> NDArray[np.float64]:
    """Chebyshev coefficients of ``(λᵃ − λᵇ)/(1 − λ)`` in ``T_k(2λ − 1)``, whose product with I − Φ₁ is a band.

    Raises
    ------
    ValueError
        If the series of a fractional power converges too slowly.
    """
    n = 32
    while n <= _MOST_TERMS:
        half = np.pi * (2 * np.arange(n) + 1) / (4 * n)
        # λ and 1 − λ at the zeros of T_n, without cancellation.
        inside, rest = np.cos(half) ** 2, np.sin(half) ** 2
        log = np.where(inside > 0.5, np.log1p(-np.minimum(rest, 0.5)), np.log(inside))
        values = np.exp(a * log) * -np.expm1((b - a) * log) / rest
        # The sum over the nodes is the real part of a Fourier transform of twice the length.
        found = np.fft.rfft(np.concatenate([values, values[::-1]]))[:n]
        found = (found * np.exp(-0.5j * np.pi * np.arange(n) / n)).real / n
        found[0] /= 2
        total = np.abs(found).sum()
        tail = np.abs(found[::-1]).cumsum()[::-1]
        kept = int(np.count_nonzero(tail > _REMAINDER * n * total))
        if kept <= n // 2:
            return found[: max(kept, 1)]
        n *= 2
    raise ValueError(
        f"steps {a:g} to {b:g} need more than {_MOST_TERMS} products: small fractional powers converge slowly; give whole "
        "steps, or leave out device"
    )


@dataclass(frozen=True)
class DeviceWalk:
    """The walk as sparse tensors of a device, with the series of some bands."""

    #: I − Φ₁ in double precision, where the device has it.
    difference: Any
    #: 4·(Φ₁ − ½) in the type of the signal.
    twice: Any
    #: Welded vertex of each vertex, and the number of vertices of each; None where nothing is welded.
    welded: Any
    n_members: Any
    #: Share of each vertex in the stationary distribution, (n, 1).
    share: Any
    coefficients: tuple[NDArray[np.float64], ...]

    @classmethod
    def prepare(cls, walk: Decomposer, steps: tuple[float, ...], device: Any, dtype: Any) -> DeviceWalk:
        """The walk of a prepared shape on a device. O(entries).

        Raises
        ------
        ValueError
            If the operator is no walk, or the device has no double precision.
        """
        if walk.operator != "walk":
            raise ValueError("device needs the walk; prepare the shape with operator='walk'")
        from scipy.sparse import csr_array, identity

        step = csr_array(walk.matrix())
        one = identity(step.shape[0], format="csr")
        welded, share = walk._data.welding()
        counts = np.bincount(welded, minlength=step.shape[0])
        is_welded = step.shape[0] < walk.n_vertices

        def tensor(matrix: Any, kind: Any) -> Any:
            matrix = csr_array(matrix)
            matrix.eliminate_zeros()
            indices = [torch.from_numpy(part.astype(np.int64)) for part in (matrix.indptr, matrix.indices)]
            values = torch.from_numpy(matrix.data).to(kind)
            return torch.sparse_csr_tensor(*indices, values, size=matrix.shape, device=device)

        return cls(
            tensor(one - step, torch.float64),
            tensor(4 * step - 2 * one, dtype),
            torch.from_numpy(welded.astype(np.int64)).to(device) if is_welded else None,
            torch.from_numpy(counts.astype(np.float64)).to(device)[:, None] if is_welded else None,
            torch.from_numpy(share).to(device)[:, None],
            tuple(series(a, b) for a, b in zip((0.0, *steps[:-1]), steps, strict=True)),
        )

    def mean(self, values: Any) -> Any:
        """Mean over the vertices of each welded vertex, in double precision."""
        values = values.double()
        if self.welded is None:
            return values
        sums = values.new_zeros(self.n_members.shape[0], values.shape[1])
        return sums.index_add_(0, self.welded, values) / self.n_members

    def scatter(self, values: Any) -> Any:
        """Values of the welded vertices at each vertex."""
        return values if self.welded is None else values[self.welded]

    def split(self, signal: Any) -> Any:
        """Bands of n × channels values, (J + 1) × n × channels, in double precision on the way into and out of the recurrence."""
        mean = self.mean(signal)
        # The mean over the vertices has no bands, but its rounding would have.
        now = (self.difference @ (mean - mean.mean(0))).to(self.twice.dtype)
        before = None
        bands = [torch.zeros_like(mean) for _ in self.coefficients]
        for k in range(max(len(own) for own in self.coefficients)):
            for band, own in zip(bands, self.coefficients, strict=True):
                if k < len(own):
                    band.add_(now, alpha=float(own[k]))
            # T_1 = Y·T_0, then T_{k+1} = 2Y·T_k − T_{k−1}.
            after = self.twice @ now
            after = after / 2 if before is None else after - before
            before, now = now, after
        rows = [self.scatter(band) for band in bands]
        if self.welded is not None:
            rows[0] = rows[0] + (signal.double() - self.scatter(mean))
        found = torch.stack([*rows, signal.double() - sum(rows)])
        return found.to(signal.dtype)

    def join(self, weights: Any) -> Any:
        """Adjoint of `split` by one recurrence, n × channels, from (J + 1) × n × channels."""
        rest = weights[-1].double()
        scaled = [(own.double() - rest) / self.share for own in weights[:-1]]
        means = [self.mean(own) for own in scaled]
        size = max(len(own) for own in self.coefficients)
        kind = self.twice.dtype
        b1 = torch.zeros_like(means[0], dtype=kind)
        b2 = torch.zeros_like(b1)
        for k in range(size - 1, -1, -1):
            terms = (mean * float(own[k]) for mean, own in zip(means, self.coefficients, strict=True) if k < len(own))
            product = self.twice @ b1
            new = sum(terms).to(kind) + (product if k else product / 2) - b2
            b1, b2 = new, b1
        total = self.scatter(self.difference @ b1.double())
        if self.welded is not None:
            total = total + scaled[0] - self.scatter(means[0])
        return (rest + self.share * total).to(weights.dtype)


class DeviceSplit(torch.autograd.Function):
    """Bands of an n × channels signal on its device, (J + 1) × n × channels."""

    @staticmethod
    def forward(ctx: Any, signal: Any, walk: DeviceWalk) -> Any:
        ctx.walk = walk
        return walk.split(signal)

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        return DeviceJoin.apply(gradients[0], ctx.walk), None


class DeviceJoin(torch.autograd.Function):
    """Adjoint of `DeviceSplit`."""

    @staticmethod
    def forward(ctx: Any, weights: Any, walk: DeviceWalk) -> Any:
        ctx.walk = walk
        return walk.join(weights)

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        return DeviceSplit.apply(gradients[0], ctx.walk), None


def measured_error(walk: Decomposer, signal: Any, found: Any, request: tuple[tuple[float, ...], float]) -> float:
    """Largest relative error of a band, measured on one channel: a sum of all with random signs, computed in double
    precision by the extension."""
    steps, accuracy = request
    signs = torch.from_numpy(np.random.default_rng(_SEED).choice([-1.0, 1.0], signal.shape[1])).to(signal.device)
    probe = (signal.double() @ signs).cpu().numpy()[:, None]
    expected, _ = walk._data.bands(BandsRequest(np.ascontiguousarray(probe), steps, accuracy))
    share = walk._data.welding()[1][:, None]
    worst = 0.0
    for level in range(len(steps)):
        own = (found[level].double() @ signs).cpu().numpy()[:, None]
        size = float((share * expected[level] ** 2).sum())
        off = float((share * (own - expected[level]) ** 2).sum())
        if off > 0:
            worst = max(worst, np.sqrt(off / size) if size > 0 else np.inf)
    return worst
