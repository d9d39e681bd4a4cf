"""Geometric scattering as a layer, on walks, on operators of a device and on graphs of PyTorch Geometric."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import torch

from adwave._torch_device import Operator
from adwave._torch_library import split_powers
from adwave._walk import SCALES, Walk, as_walk

#: Weight of its own number of steps in a learned scale at first.
_FIRST_WEIGHT = 0.9


class EdgeWalk(NamedTuple):
    """The lazy walk on the edges of a graph, as `adwave.from_edge_index` makes it, by operations of PyTorch alone."""

    sources: torch.Tensor
    targets: torch.Tensor
    #: Half of the weight of each edge, relative to the sum over the edges of its source.
    weights: torch.Tensor
    #: Share of the steps that stay, (n, 1): ½, and 1 for nodes without edges.
    stay: torch.Tensor

    @classmethod
    def of_edges(cls, edge_index: torch.Tensor, edge_weight: torch.Tensor | None, like: torch.Tensor) -> EdgeWalk:
        """The walk of 2 × E edges on as many nodes as a signal has rows, in the type of the signal."""
        if edge_index.layout != torch.strided:
            # A transposed adjacency, whose rows are the targets.
            adjacency = edge_index.to_sparse_coo().coalesce()
            edge_index, edge_weight = adjacency.indices().flip(0), adjacency.values()
        if edge_index.ndim != 2 or edge_index.shape[0] != 2 or edge_index.is_floating_point():
            raise ValueError(
                f"edge_index must be a 2 × E tensor of integers, got {edge_index.dtype} of shape {tuple(edge_index.shape)}"
            )
        sources, targets = edge_index
        weights = like.new_ones(sources.shape[0]) if edge_weight is None else edge_weight.to(like).reshape(-1)
        if weights.shape != sources.shape:
            raise ValueError(
                f"edge_weight must have a value for each of {sources.shape[0]} edges, got {weights.shape[0]}"
            )
        weights = torch.where(sources == targets, weights.new_zeros(()), weights)
        sums = like.new_zeros(like.shape[0]).index_add(0, sources, weights)
        moves = sums > 0
        weights = 0.5 * weights / torch.where(moves, sums, 1.0)[sources]
        return cls(sources, targets, weights, torch.where(moves, 0.5, 1.0).to(like)[:, None])

    def step(self, values: torch.Tensor) -> torch.Tensor:
        """One step, P·values of n × channels values."""
        return (self.stay * values).index_add(0, self.sources, self.weights[:, None] * values[self.targets])

    def powers(self, values: torch.Tensor, stops: Sequence[int]) -> torch.Tensor:
        """``P^n values`` for ascending whole numbers n, stops × n × channels."""
        found, taken = [], 0
        for stop in stops:
            for _ in range(stop - taken):
                values = self.step(values)
            taken = stop
            found.append(values)
        return torch.stack(found)


def scatter_bands(walk: object, signal: torch.Tensor, scales: Sequence[int] = SCALES) -> torch.Tensor:
    """Bands ``(P^{n_{j−1}} − P^{n_j}) f`` and the rest, (J + 1) × n × channels, with their gradient.

    Directed walks have gradients too: the adjoint uses the transposed walk, at the cost of the bands.

    Parameters
    ----------
    walk : Walk, Operator or shape_like
        The walk; of a graph or any other shape, the lazy walk of `Decomposer`. An `Operator` computes on its device.
    signal : (n, channels) tensor
        Values at the nodes.
    scales : sequence of int
        n_1 < n_2 < … < n_J.

    Examples
    --------
    >>> import adwave as aw, torch
    >>> walk = aw.walk([[0, 1], [1, 0]], normalize="row", stay=0.5)
    >>> aw.torch.scatter_bands(walk, torch.tensor([[1.0], [3.0]]), [1, 2])[:, :, 0]
    tensor([[-1.,  1.],
            [ 0.,  0.],
            [ 2.,  2.]])
    """
    own = walk if isinstance(walk, Operator) else as_walk(walk)
    n = own.n_vertices if isinstance(own, Operator) else own.n_nodes
    if not torch.is_tensor(signal) or signal.ndim != 2 or signal.shape[0] != n:
        raise ValueError(f"signal must be a tensor of {n} rows and some channels, got {_shape(signal)}")
    return split_powers(own, signal, check_scales(scales))


def check_scales(scales: Sequence[int]) -> tuple[int, ...]:
    """Ascending whole numbers of steps, at least 1.

    Raises
    ------
    ValueError
        If they are none.
    """
    found = tuple(int(n) for n in scales)
    if not found or any(n != m for n, m in zip(found, scales, strict=True)) or list(found) != sorted({0, *found})[1:]:
        raise ValueError(f"steps must be whole numbers from 1 that ascend, such as [1, 2, 4], got {list(scales)}")
    return found


class Scattering(torch.nn.Module):
    """Geometric scattering as a layer: the signal, |W_j f| and |W_k |W_j f||, k > j, with gradients.

    Call it as other layers of PyTorch Geometric, ``layer(x, edge_index)``, with a graph or a batch (``x``, ``edge_index``,
    ``edge_weight``, ``batch``) or one of DGL (``ndata["x"]``, ``edges()``), or with a signal and a `Walk` or `Operator`.
    Edges are those of `adwave.from_edge_index`: rows are normalized, half of the steps stay, and edges from x to y are steps
    from x to y. They stay on their device, weights have gradients, and ``torch.compile`` makes one graph of it if
    `batch_size` is given for pooling. A batch is a graph of several components.

    Parameters
    ----------
    steps : sequence of int
        Scales n_1 < n_2 < ….
    orders : sequence of int
        Orders, of 0, 1 and 2.
    pool : 'mean', 'max', 'norms' or 'moments', optional
        Statistics over the nodes of each graph, as in `adwave.scattering`; without it the result has a row for each node.
    learn_gains : bool
        Gives each band a gain, 1 at first.
    learn_scales : bool
        Learns the scales, as LEGS (Tong et al., MLSP 2021): ``S_j = Σ_t F_jt Pᵗ f`` for t up to the last of `steps`,
        with rows of F that are positive and sum to 1, and bands ``S_{j−1} − S_j``. At first F is 0.9 at the given steps. See
        `scales`.

    Examples
    --------
    >>> import adwave as aw, torch
    >>> layer = aw.torch.Scattering(steps=[1, 2, 4])
    >>> layer(torch.rand(3, 2), torch.tensor([[0, 1, 1, 2], [1, 0, 2, 1]])).shape  # (nodes, paths × channels)
    torch.Size([3, 14])
    """

    def __init__(
        self,
        steps: Sequence[int] = SCALES,
        orders: Sequence[int] = (0, 1, 2),
        pool: str | None = None,
        *,
        learn_gains: bool = False,
        learn_scales: bool = False,
    ) -> None:
        super().__init__()
        if any(order not in (0, 1, 2) for order in orders):
            raise ValueError(f"orders of scattering are 0, 1 and 2, got {list(orders)}")
        if pool not in (None, "mean", "max", "norms", "moments"):
            raise ValueError(f"pool must be 'mean', 'max', 'norms' or 'moments', got {pool!r}")
        self.steps = check_scales(steps)
        self.orders = tuple(sorted({int(order) for order in orders}))
        self.pool = pool
        self.gains = torch.nn.Parameter(torch.ones(len(self.steps)), requires_grad=learn_gains)
        #: Logarithms of F up to a constant for each row, (levels, largest number of steps); None unless learned.
        self.scale_logits: torch.nn.Parameter | None = None
        if learn_scales:
            most = self.steps[-1]
            logits = torch.zeros(len(self.steps), most)
            own = math.log(_FIRST_WEIGHT / (1 - _FIRST_WEIGHT) * (most - 1)) if most > 1 else 0.0
            logits[torch.arange(len(self.steps)), torch.tensor(self.steps) - 1] = own
            self.scale_logits = torch.nn.Parameter(logits)

    def paths(self) -> list[tuple[int, ...]]:
        """Bands of each path, from 1, in the order of the result."""
        n = len(self.steps)
        of_order = (
            [()],
            [(j,) for j in range(1, n + 1)],
            [(j, k) for j in range(1, n + 1) for k in range(j + 1, n + 1)],
        )
        return [path for order in self.orders for path in of_order[order]]

    def scales(self) -> torch.Tensor:
        """Number of steps of each level, (levels,); of learned scales the mean ``Σ_t F_jt·t``."""
        if self.scale_logits is None:
            return torch.tensor(self.steps, dtype=self.gains.dtype, device=self.gains.device)
        t = torch.arange(1, self.steps[-1] + 1, dtype=self.scale_logits.dtype, device=self.scale_logits.device)
        return self.scale_logits.softmax(1) @ t

    def forward(
        self,
        x: Any,
        edge_index: Any = None,
        edge_weight: torch.Tensor | None = None,
        batch: torch.Tensor | None = None,
        batch_size: int | None = None,
    ) -> torch.Tensor:
        """Coefficients, (n, paths × channels), or (graphs, paths × channels × statistics) if pooled.

        Parameters
        ----------
        x : (n,) or (n, channels) tensor, or graph
            Signal; or a graph of PyTorch Geometric or DGL, which has all the rest.
        edge_index : (2, E) or sparse (n, n) tensor, Walk or Operator
            Edges; a sparse tensor is a transposed adjacency. Or the walk itself.
        edge_weight : (E,) tensor, optional
            Weights ≥ 0.
        batch : (n,) tensor of int, optional
            Graph of each node, for pooling.
        batch_size : int, optional
            Number of graphs; without it the largest label of `batch` is read from the device.
        """
        if not torch.is_tensor(x):
            x, edge_index, edge_weight, batch, batch_size = _read_graph(x, edge_index, edge_weight, batch, batch_size)
        if edge_index is None:
            raise ValueError("give the edges, layer(x, edge_index), a walk, or a graph with x and edge_index")
        rows = x[:, None] if x.ndim == 1 else x
        walk = edge_index
        if torch.is_tensor(walk):
            walk = EdgeWalk.of_edges(walk, edge_weight, rows)
        elif edge_weight is not None:
            if batch is not None:
                raise ValueError(
                    "edge_weight belongs to edge_index; a walk has its weights, layer(x, walk, batch=batch)"
                )
            # The arguments of earlier releases: a signal, a walk and a batch.
            batch = edge_weight
        gains = self.gains.to(rows)
        n_scales = len(self.steps)
        parts = [rows[None]] if 0 in self.orders else []
        if 1 in self.orders or 2 in self.orders:
            first = (gains[:, None, None] * self._bands(walk, rows)).abs()
            if 1 in self.orders:
                parts.append(first)
            if 2 in self.orders and n_scales > 1:
                n, n_channels = rows.shape
                stacked = first[:-1].movedim(0, 1).flatten(1)
                second = self._bands(walk, stacked).reshape(n_scales, n, n_scales - 1, n_channels)
                second = (gains[:, None, None, None] * second).abs()
                before, after = torch.triu_indices(n_scales, n_scales, 1, device=rows.device)
                parts.append(second[after, :, before])
        if not parts:
            return rows.new_zeros(rows.shape[0], 0)
        found = torch.cat(parts).movedim(0, 1).flatten(1)
        return found if self.pool is None else pool_nodes(found, self.pool, batch, batch_size)

    def _bands(self, walk: Walk | Operator | EdgeWalk, rows: torch.Tensor) -> torch.Tensor:
        """Bands of n × channels values, levels × n × channels."""
        stops = self.steps if self.scale_logits is None else tuple(range(1, self.steps[-1] + 1))
        if isinstance(walk, EdgeWalk):
            smoothed = walk.powers(rows, stops)
        else:
            pieces = scatter_bands(walk, rows, stops)
            if self.scale_logits is None:
                return pieces[:-1]
            # The power after some steps is the sum of all pieces beyond.
            smoothed = pieces.flip(0).cumsum(0).flip(0)[1:]
        if self.scale_logits is not None:
            smoothed = torch.einsum("jt,tnc->jnc", self.scale_logits.softmax(1).to(rows), smoothed)
        return torch.cat([rows[None], smoothed[:-1]]) - smoothed


def pool_nodes(
    values: torch.Tensor, pool: str, batch: torch.Tensor | None, batch_size: int | None = None
) -> torch.Tensor:
    """Statistics of n × features values over the nodes of each graph: graphs × (features × statistics)."""
    labels = values.new_zeros(len(values), dtype=torch.long) if batch is None else batch.to(values.device).long()
    if labels.shape != values.shape[:1]:
        raise ValueError(f"batch must have the graph of each of {len(values)} nodes, got shape {tuple(labels.shape)}")
    if batch_size is None:
        batch_size = 1 if batch is None else int(labels.max()) + 1 if len(labels) else 0
    if pool == "max":
        start = values.new_zeros(batch_size, values.shape[1])
        return start.scatter_reduce(0, labels[:, None].expand_as(values), values, "amax", include_self=False)

    def total(each: torch.Tensor) -> torch.Tensor:
        return each.new_zeros(batch_size, each.shape[1]).index_add(0, labels, each)

    if pool == "norms":
        sizes = values.abs()
        return torch.stack([total(sizes**q) for q in range(1, 5)], dim=2).flatten(1)
    counts = total(values.new_ones(len(values), 1)).clamp(min=1)
    mean = total(values) / counts
    if pool == "mean":
        return mean
    off = values - mean[labels]
    second, third, fourth = (total(off**q) / counts for q in (2, 3, 4))
    # Below this the deviations are rounding.
    least = max(1e-12, 8 * torch.finfo(values.dtype).eps)
    varies = second > (least * mean).square()
    safe = torch.where(varies, second, 1.0)
    zero = torch.zeros_like(mean)
    statistics = (torch.where(varies, own, zero) for own in (second, third / safe**1.5, fourth / safe**2 - 3.0))
    return torch.stack([mean, *statistics], dim=2).flatten(1)


def _read_graph(graph: Any, walk: Any, edge_weight: Any, batch: Any, batch_size: int | None) -> tuple[Any, ...]:
    """Signal, edges, weights, batch and number of graphs of a graph of PyTorch Geometric or DGL; given ones come first."""
    if hasattr(graph, "edge_index"):
        signal, labels, n_graphs = graph.x, getattr(graph, "batch", None), getattr(graph, "num_graphs", None)
        if walk is None:
            walk, edge_weight = graph.edge_index, getattr(graph, "edge_weight", None)
    elif hasattr(graph, "ndata") and hasattr(graph, "edges"):
        signal, labels, n_graphs = graph.ndata["x"], None, None
        if walk is None:
            walk = torch.stack(tuple(graph.edges()))
        if hasattr(graph, "batch_num_nodes"):
            counts = graph.batch_num_nodes()
            n_graphs = len(counts)
            labels = torch.repeat_interleave(torch.arange(n_graphs, device=counts.device), counts)
    else:
        raise TypeError(f"x must be a tensor or a graph with x and edge_index, got {type(graph).__name__}")
    if batch is None and labels is not None:
        batch, batch_size = labels, n_graphs if batch_size is None else batch_size
    return signal, walk, edge_weight, batch, batch_size


def _shape(value: object) -> str:
    return f"shape {tuple(value.shape)}" if torch.is_tensor(value) else type(value).__name__
