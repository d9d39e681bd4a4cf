"""Diffusion and bands as differentiable functions of PyTorch.

All functions are linear in the signal, and so are their gradients: they can be differentiated any number of times, under
`torch.func` too, and `torch.vmap` and batches become further channels of one call.

>>> import torch  # doctest: +SKIP
>>> import adwave as aw  # doctest: +SKIP
>>> walk = aw.Decomposer(aw.sample("sphere", vertices=100))  # doctest: +SKIP
>>> f = torch.rand(100, 2, dtype=torch.float64, requires_grad=True)  # doctest: +SKIP
>>> torch.autograd.gradcheck(lambda f: aw.torch.smooth(walk, f, 3.0), f)  # doctest: +SKIP
True
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch

from adwave import _native
from adwave._decomposer import Decomposer, prepare_decomposer
from adwave._options import BandsRequest, LevelsLike, check_steps
from adwave._torch_device import DeviceSplit, DeviceWalk, measured_error
from adwave._walk import SCALES, Walk, as_walk, from_edge_index

__all__ = ["Scattering", "bands", "combine_bands", "filter", "scatter_bands", "smooth"]


@dataclass(frozen=True)
class _Levels:
    """A prepared shape with numbers of steps and an accuracy: everything but the signal."""

    walk: Decomposer
    steps: tuple[float, ...]
    accuracy: float

    def share(self) -> np.ndarray:
        """Share π of each vertex in the stationary distribution, (n, 1)."""
        return self.walk._data.welding()[1][:, None]

    def split(self, signal: np.ndarray) -> np.ndarray:
        """Bands of n × channels values, (J + 1) × n × channels."""
        found, _ = self.walk._data.bands(BandsRequest(signal, self.steps, self.accuracy))
        return found

    def join(self, weights: np.ndarray) -> np.ndarray:
        """Adjoint of `split`: with the bands self-adjoint under π, ``π·Σ_j W_(j)(g_j/π)``, n × channels.

        The rest S(J) = f − Σ_j W_(j) has the adjoint ``g − Σ_j W_(j)ᵀ g``.
        """
        share = self.share()
        rest = weights[-1]
        signals = np.ascontiguousarray((weights[:-1] - rest) / share)
        if self.walk._data.has_sum_of_bands(self.steps):
            total = self.walk._data.sum_of_bands(signals, self.steps)
        else:
            total = sum(
                self.walk._data.combine_bands(
                    BandsRequest(signal, self.steps, self.accuracy),
                    [float(j == level) for j in range(len(self.steps))],
                )
                for level, signal in enumerate(signals)
            )
        return rest + share * total


class _Split(torch.autograd.Function):
    """Bands of an n × channels signal, (J + 1) × n × channels."""

    @staticmethod
    def forward(signal: Any, levels: _Levels) -> Any:
        return _from_numpy(levels.split(_to_numpy(signal)), signal)

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        ctx.levels = inputs[1]

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        return _Join.apply(gradients[0], ctx.levels), None

    @staticmethod
    def jvp(ctx: Any, tangent: Any, _: Any) -> Any:
        return _Split.apply(tangent, ctx.levels)

    @staticmethod
    def vmap(info: Any, in_dims: Any, signal: Any, levels: _Levels) -> Any:
        # A batch becomes channels: (b, n, c) → (n, c·b).
        last = signal.movedim(in_dims[0], -1)
        found = _Split.apply(last.reshape(last.shape[0], -1), levels)
        return found.reshape(found.shape[0], *last.shape), 3


class _Join(torch.autograd.Function):
    """Adjoint of `_Split`: n × channels values from (J + 1) × n × channels."""

    @staticmethod
    def forward(weights: Any, levels: _Levels) -> Any:
        return _from_numpy(levels.join(_to_numpy(weights)), weights)

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        ctx.levels = inputs[1]

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        return _Split.apply(gradients[0], ctx.levels), None

    @staticmethod
    def jvp(ctx: Any, tangent: Any, _: Any) -> Any:
        return _Join.apply(tangent, ctx.levels)

    @staticmethod
    def vmap(info: Any, in_dims: Any, weights: Any, levels: _Levels) -> Any:
        last = weights.movedim(in_dims[0], -1)
        found = _Join.apply(last.reshape(*last.shape[:2], -1), levels)
        return found.reshape(*last.shape[1:]), 2


class _Combine(torch.autograd.Function):
    """``Σ_j factors[j]·W_f(j)`` of an n × channels signal by a single polynomial p of Φ₁; its adjoint is ``π·p(Φ₁)(g/π)``."""

    @staticmethod
    def forward(signal: Any, levels: _Levels, factors: tuple[float, ...], is_adjoint: bool) -> Any:
        values = _to_numpy(signal)
        share = levels.share() if is_adjoint else 1.0
        request = BandsRequest(np.ascontiguousarray(values / share), levels.steps, levels.accuracy)
        return _from_numpy(share * levels.walk._data.combine_bands(request, factors), signal)

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        _, ctx.levels, ctx.factors, ctx.is_adjoint = inputs

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        return _Combine.apply(gradients[0], ctx.levels, ctx.factors, not ctx.is_adjoint), None, None, None

    @staticmethod
    def jvp(ctx: Any, tangent: Any, *_: Any) -> Any:
        return _Combine.apply(tangent, ctx.levels, ctx.factors, ctx.is_adjoint)

    @staticmethod
    def vmap(
        info: Any, in_dims: Any, signal: Any, levels: _Levels, factors: tuple[float, ...], is_adjoint: bool
    ) -> Any:
        last = signal.movedim(in_dims[0], -1)
        found = _Combine.apply(last.reshape(last.shape[0], -1), levels, factors, is_adjoint)
        return found.reshape(last.shape), 2


def _to_numpy(tensor: torch.Tensor) -> np.ndarray:
    return tensor.detach().to("cpu", torch.float64).contiguous().numpy()


def _from_numpy(values: np.ndarray, like: torch.Tensor) -> torch.Tensor:
    return torch.from_numpy(np.ascontiguousarray(values)).to(like.device, like.dtype)


def _levels(walk: Decomposer, steps: Sequence[float], accuracy: float) -> _Levels:
    if torch.is_tensor(steps) or any(torch.is_tensor(n) for n in steps):
        raise TypeError("steps must be numbers: there is no gradient with respect to them; pass float(steps)")
    if not walk._data.is_reversible() or walk.mask is not None:
        raise ValueError("gradients need a reversible diffusion; leave out directed and masks")
    return _Levels(walk, tuple(check_steps(steps)), accuracy)


def _rows(signal: torch.Tensor, n: int) -> tuple[torch.Tensor, tuple[int, ...], int]:
    """A signal as n × channels with the axes that the channels stand for, and the axis of the vertices.

    The vertices are the first axis if it has their number, or else the last but one, or the last: a batch is
    (batch, n, channels) or (batch, n).
    """
    if not torch.is_tensor(signal):
        raise TypeError(f"signal must be a tensor, got {type(signal).__name__}; torch.as_tensor(f) of an array")
    axes = [axis for axis in (0, signal.ndim - 2, signal.ndim - 1) if axis >= 0 and signal.shape[axis] == n]
    if not axes:
        raise ValueError(
            f"signal: shape {tuple(signal.shape)} has no axis of {n} vertices; give ({n},), ({n}, channels), "
            f"(batch, {n}) or (batch, {n}, channels)"
        )
    rows = signal.movedim(axes[0], 0)
    return rows.reshape(n, -1), tuple(rows.shape[1:]), axes[0]


def combine_bands(
    walk: object,
    signal: torch.Tensor,
    factors: Sequence[float] | torch.Tensor,
    steps: Sequence[float],
    *,
    accuracy: float = _native.ACCURACY,
) -> torch.Tensor:
    """``Σ_j factors[j−1]·W_f(j)`` with its exact gradient; see `adwave.Decomposer.combine_bands`.

    Parameters
    ----------
    walk : Decomposer, Walk or shape_like
        Shape or walk with a reversible diffusion; a `Decomposer` is prepared once, anything else in each call.
    signal : tensor
        Signal on any device, (n,), (n, channels), or a batch, (batch, n) or (batch, n, channels); the work is done on the CPU
        in double precision.
    factors : (J,) sequence of float, or tensor
        Factor of each band, from fine to coarse. A tensor has a gradient too, and costs the separate bands.
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
    own = prepare_decomposer(walk)
    levels = _levels(own, steps, accuracy)
    rows, channels, axis = _rows(signal, own.n_vertices)
    if len(factors) != len(levels.steps):
        raise ValueError(f"factors must be one for each of {len(levels.steps)} levels, got {len(factors)}")
    if torch.is_tensor(factors):
        found = torch.einsum("j,jnc->nc", factors.to(rows), _Split.apply(rows, levels)[:-1])
    else:
        found = _Combine.apply(rows, levels, tuple(float(f) for f in factors), False)
    return found.reshape(rows.shape[0], *channels).movedim(0, axis)


def smooth(walk: object, signal: torch.Tensor, steps: float, *, accuracy: float = _native.ACCURACY) -> torch.Tensor:
    """``Φ₁^steps f`` with its exact gradient.

    Parameters
    ----------
    walk : Decomposer, Walk or shape_like
        Shape or walk with a reversible diffusion; a `Decomposer` is prepared once, anything else in each call.
    signal : tensor
        Signal or batch as in `combine_bands`.
    steps : float
        Number of steps, an integer or not.
    accuracy : float
        Largest error relative to the change.

    Returns
    -------
    tensor like the signal

    Raises
    ------
    TypeError
        If `steps` is a tensor.

    Examples
    --------
    >>> aw.torch.smooth(walk, f, 3.0).shape  # doctest: +SKIP
    torch.Size([100, 2])
    """
    return signal + combine_bands(walk, signal, [-1.0], [steps], accuracy=accuracy)


def bands(
    walk: object,
    signal: torch.Tensor,
    levels: LevelsLike,
    *,
    accuracy: float = _native.ACCURACY,
    device: torch.device | str | None = None,
) -> torch.Tensor:
    """The bands of a signal, (levels + 1) × n × …, with their exact gradient.

    It takes the time of `adwave.decompose`, and so does its gradient. With `device`, the signal stays there: the
    polynomials are applied by sparse products of PyTorch in the type of the signal. One channel, a sum of all with random
    signs, is computed by `adwave.decompose` as well, and its error is the measure of all. In single precision
    it is about 1e-6 for a few steps; give an accuracy such as 1e-4.

    Parameters
    ----------
    walk : Decomposer, Walk or shape_like
        Shape or walk with a reversible diffusion; a `Decomposer` is prepared once, anything else in each call.
    signal : tensor
        Signal or batch as in `combine_bands`.
    levels : int, Widths, Steps or Octaves
        As in `adwave.decompose`.
    accuracy : float
        Largest error of a band relative to the band.
    device : torch.device or str, optional
        Device that computes, such as ``"cuda"``, for a walk.

    Returns
    -------
    (levels + 1) × shape of the signal tensor

    Raises
    ------
    ValueError
        If the measured error on the device exceeds the accuracy, or the operator is no walk.

    Examples
    --------
    >>> aw.torch.bands(walk, f, 4).shape  # doctest: +SKIP
    torch.Size([5, 100, 2])
    """
    own = prepare_decomposer(walk, levels=levels)
    given = _levels(own, own.schedule(levels), accuracy)
    rows, channels, axis = _rows(signal, own.n_vertices)
    found = _Split.apply(rows, given) if device is None else _on_device(rows, given, device)
    return found.reshape(*found.shape[:2], *channels).movedim(1, axis + 1)


def _on_device(rows: torch.Tensor, given: _Levels, device: torch.device | str) -> torch.Tensor:
    """Bands of an n × channels signal on a device.

    Raises
    ------
    ValueError
        If the measured error exceeds the accuracy.
    """
    rows = rows.to(device)
    if not rows.is_floating_point():
        raise TypeError(f"signal must be a tensor of floats, got {rows.dtype}; such as signal.float()")
    found = DeviceSplit.apply(rows, DeviceWalk.prepare(given.walk, given.steps, rows.device, rows.dtype))
    error = measured_error(given.walk, rows.detach(), found.detach(), (given.steps, given.accuracy))
    if not error <= given.accuracy:
        raise ValueError(
            f"the error of a band on {rows.device} is {error:.1e}, and accuracy={given.accuracy:g} was asked for; "
            f"give a signal of 64-bit floats, or accuracy={10 * error:.0e}"
        )
    return found


def filter(
    walk: object,
    signal: torch.Tensor,
    gains: torch.Tensor | Sequence[float],
    levels: LevelsLike = None,
    *,
    accuracy: float = _native.ACCURACY,
) -> torch.Tensor:
    """``f + Σ_j (g_j − 1)·W_f(j)`` with gradients of the signal and of the gains, which may be learned.

    Parameters
    ----------
    walk : Decomposer, Walk or shape_like
        Shape or walk with a reversible diffusion; a `Decomposer` is prepared once, anything else in each call.
    signal : tensor
        Signal or batch as in `combine_bands`.
    gains : (J,) or (J, n) tensor
        A gain for each band from fine to coarse, or for each band and vertex.
    levels : int, Widths, Steps or Octaves, optional
        As in `adwave.decompose`; by default one dyadic level for each gain.
    accuracy : float
        Largest error of a band relative to the band.

    Returns
    -------
    tensor like the signal

    Raises
    ------
    ValueError
        If there is not one gain for each level.

    Examples
    --------
    >>> gains = torch.ones(4, dtype=torch.float64, requires_grad=True)  # doctest: +SKIP
    >>> aw.torch.filter(walk, f, gains).square().sum().backward()  # doctest: +SKIP
    >>> gains.grad.shape  # doctest: +SKIP
    torch.Size([4])
    """
    gains = torch.as_tensor(gains).to(signal)
    own = prepare_decomposer(walk, levels=levels)
    given = _levels(own, own.schedule(len(gains) if levels is None else levels), accuracy)
    if gains.shape not in ((len(given.steps),), (len(given.steps), own.n_vertices)):
        raise ValueError(
            f"gains must be one for each of {len(given.steps)} levels, or for each level and vertex, got shape "
            f"{tuple(gains.shape)}"
        )
    rows, channels, axis = _rows(signal, own.n_vertices)
    wavelets = _Split.apply(rows, given)[:-1]
    change = torch.einsum("j,jnc->nc" if gains.ndim == 1 else "jn,jnc->nc", gains - 1.0, wavelets)
    return (rows + change).reshape(own.n_vertices, *channels).movedim(0, axis)


@dataclass(frozen=True)
class _Scales:
    """A walk with the numbers of steps between which its bands lie."""

    walk: Walk
    scales: tuple[int, ...]


class _Powers(torch.autograd.Function):
    """Bands between powers of a walk of an n × channels signal, (J + 1) × n × channels."""

    @staticmethod
    def forward(signal: Any, scales: _Scales) -> Any:
        return _from_numpy(scales.walk._data.bands(_to_numpy(signal), list(scales.scales)), signal)

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        ctx.scales = inputs[1]

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        return _PowersAdjoint.apply(gradients[0], ctx.scales), None

    @staticmethod
    def jvp(ctx: Any, tangent: Any, _: Any) -> Any:
        return _Powers.apply(tangent, ctx.scales)


class _PowersAdjoint(torch.autograd.Function):
    """Adjoint of `_Powers`, by the transposed walk: n × channels values from (J + 1) × n × channels."""

    @staticmethod
    def forward(weights: Any, scales: _Scales) -> Any:
        return _from_numpy(scales.walk._data.adjoint(_to_numpy(weights), list(scales.scales)), weights)

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        ctx.scales = inputs[1]

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> Any:
        return _Powers.apply(gradients[0], ctx.scales), None

    @staticmethod
    def jvp(ctx: Any, tangent: Any, _: Any) -> Any:
        return _PowersAdjoint.apply(tangent, ctx.scales)


def scatter_bands(walk: object, signal: torch.Tensor, scales: Sequence[int] = SCALES) -> torch.Tensor:
    """Bands ``(P^{n_{j−1}} − P^{n_j}) f`` and the rest, (J + 1) × n × channels, with their gradient.

    Directed walks have gradients too: the adjoint uses the transposed walk, at the cost of the bands.

    Parameters
    ----------
    walk : Walk or shape_like
        The walk; of a graph or any other shape, the lazy walk of `Decomposer`.
    signal : (n, channels) tensor
        Values at the nodes.
    scales : sequence of int
        n_1 < n_2 < … < n_J.

    Examples
    --------
    >>> aw.torch.scatter_bands(walk, f, [1, 2]).shape  # doctest: +SKIP
    torch.Size([3, 100, 2])
    """
    own = as_walk(walk)
    if not torch.is_tensor(signal) or signal.ndim != 2 or signal.shape[0] != own.n_nodes:
        raise ValueError(f"signal must be a tensor of {own.n_nodes} rows and some channels, got {_shape(signal)}")
    return _Powers.apply(signal, _Scales(own, tuple(int(n) for n in scales)))


def _shape(value: object) -> str:
    return f"shape {tuple(value.shape)}" if torch.is_tensor(value) else type(value).__name__


class Scattering(torch.nn.Module):
    """Geometric scattering as a layer: the signal, |W_j f| and |W_k |W_j f||, k > j, with gradients and learned gains.

    Call it with a signal and a `Walk`, or with a graph of PyTorch Geometric (``x``, ``edge_index``, ``edge_weight``,
    ``batch``) or of DGL (``ndata["x"]``, ``edges()``). A batch is a graph of several components. Powers of the walk are
    exact for each component.

    Parameters
    ----------
    steps : sequence of int
        Scales n_1 < n_2 < ….
    orders : sequence of int
        Orders, of 0, 1 and 2.
    pool : 'mean', 'max' or 'norms', optional
        Statistics over the nodes of each graph; without it the result has a row for each node.
    learn_gains : bool
        Gives each band a gain, 1 at first.

    Examples
    --------
    >>> layer = aw.torch.Scattering(steps=[1, 2, 4])  # doctest: +SKIP
    >>> layer(f, walk).shape  # (nodes, paths × channels)  # doctest: +SKIP
    torch.Size([100, 14])
    """

    def __init__(
        self,
        steps: Sequence[int] = SCALES,
        orders: Sequence[int] = (0, 1, 2),
        pool: str | None = None,
        *,
        learn_gains: bool = False,
    ) -> None:
        super().__init__()
        if any(order not in (0, 1, 2) for order in orders):
            raise ValueError(f"orders of scattering are 0, 1 and 2, got {list(orders)}")
        if pool not in (None, "mean", "max", "norms"):
            raise ValueError(f"pool must be 'mean', 'max' or 'norms', got {pool!r}")
        self.steps = tuple(int(n) for n in steps)
        self.orders = tuple(sorted({int(order) for order in orders}))
        self.pool = pool
        self.gains = torch.nn.Parameter(torch.ones(len(self.steps)), requires_grad=learn_gains)

    def paths(self) -> list[tuple[int, ...]]:
        """Bands of each path, from 1, in the order of the result."""
        n = len(self.steps)
        of_order = (
            [()],
            [(j,) for j in range(1, n + 1)],
            [(j, k) for j in range(1, n + 1) for k in range(j + 1, n + 1)],
        )
        return [path for order in self.orders for path in of_order[order]]

    def forward(self, signal: Any, walk: Walk | None = None, batch: torch.Tensor | None = None) -> torch.Tensor:
        """Coefficients, (n, paths × channels), or (graphs, paths × channels × statistics) if pooled."""
        if not torch.is_tensor(signal):
            signal, walk, batch = _from_graph(signal, walk, batch)
        if walk is None:
            raise ValueError("give a walk, such as aw.from_edge_index(edge_index), or a graph with edge_index")
        rows = signal[:, None] if signal.ndim == 1 else signal
        gains = self.gains.to(rows)
        n_scales = len(self.steps)
        parts = [rows[None]] if 0 in self.orders else []
        if 1 in self.orders or 2 in self.orders:
            first = (gains[:, None, None] * scatter_bands(walk, rows, self.steps)[:-1]).abs()
            if 1 in self.orders:
                parts.append(first)
            if 2 in self.orders and n_scales > 1:
                n, n_channels = rows.shape
                stacked = first[:-1].movedim(0, 1).reshape(n, -1)
                second = scatter_bands(walk, stacked, self.steps)[:-1].reshape(n_scales, n, n_scales - 1, n_channels)
                second = (gains[:, None, None, None] * second).abs()
                before, after = np.triu_indices(n_scales, 1)
                parts.append(second[after, :, before])
        if not parts:
            return rows.new_zeros(rows.shape[0], 0)
        found = torch.cat(parts).movedim(0, 1).reshape(rows.shape[0], -1)
        return found if self.pool is None else _pool(found, self.pool, batch)


def _pool(values: torch.Tensor, pool: str, batch: torch.Tensor | None) -> torch.Tensor:
    """Statistics of n × features values over the nodes of each graph."""
    labels = values.new_zeros(len(values), dtype=torch.long) if batch is None else batch.to(values.device).long()
    n_graphs = 1 if batch is None else int(labels.max()) + 1 if len(labels) else 0
    index = labels[:, None].expand_as(values)
    if pool == "max":
        start = values.new_zeros(n_graphs, values.shape[1])
        return start.scatter_reduce(0, index, values, "amax", include_self=False)
    if pool == "norms":
        values = torch.cat([values.abs() ** q for q in range(1, 5)], dim=1)
        index = labels[:, None].expand_as(values)
    sums = values.new_zeros(n_graphs, values.shape[1]).scatter_add(0, index, values)
    if pool == "norms":
        return sums
    counts = torch.bincount(labels, minlength=n_graphs).clamp(min=1).to(values)
    return sums / counts[:, None]


def _from_graph(graph: Any, walk: Walk | None, batch: Any) -> tuple[torch.Tensor, Walk, Any]:
    """Signal, walk and batch of a graph of PyTorch Geometric or DGL."""
    if hasattr(graph, "edge_index"):
        signal = graph.x
        if walk is None:
            walk = from_edge_index(graph.edge_index, getattr(graph, "edge_weight", None), nodes=signal.shape[0])
        return signal, walk, getattr(graph, "batch", None) if batch is None else batch
    if hasattr(graph, "ndata") and hasattr(graph, "edges"):
        signal = graph.ndata["x"]
        if walk is None:
            sources, targets = graph.edges()
            walk = from_edge_index(torch.stack([sources, targets]), nodes=signal.shape[0])
        if batch is None and hasattr(graph, "batch_num_nodes"):
            counts = graph.batch_num_nodes()
            batch = torch.repeat_interleave(torch.arange(len(counts)), counts.cpu())
        return signal, walk, batch
    raise TypeError(f"signal must be a tensor or a graph with x and edge_index, got {type(graph).__name__}")
