"""The layer of geometric scattering on edges, batches and graphs of PyTorch Geometric."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import adwave as aw
import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="PyTorch is not installed")

POOLS = ("mean", "max", "norms", "moments")


def edges(n: int, seed: int, isolated: int = 1) -> tuple[torch.Tensor, torch.Tensor]:
    """Edges in both directions with weights, repeated ones and self-loops among them; the last nodes have none."""
    generator = torch.Generator().manual_seed(seed)
    half = torch.randint(0, n - isolated, (2, 3 * n), generator=generator)
    weights = torch.rand(3 * n, generator=generator, dtype=torch.float64) + 0.1
    return torch.cat([half, half.flip(0)], 1), torch.cat([weights, weights])


def signal(n: int, *channels: int) -> torch.Tensor:
    return torch.rand((n, *channels), dtype=torch.float64, generator=torch.Generator().manual_seed(7))


@pytest.mark.parametrize("pool", [None, *POOLS])
def test_edges_are_the_walk_of_from_edge_index(pool: Any) -> None:
    edge_index, edge_weight = edges(20, 1)
    f = signal(20, 3)
    layer = aw.torch.Scattering([1, 2, 4], pool=pool).double()
    for weight in (None, edge_weight):
        walk = aw.from_edge_index(edge_index, weight, nodes=20)
        expected = aw.scattering(walk, f.numpy(), steps=[1, 2, 4], pool=pool).features()
        np.testing.assert_allclose(layer(f, edge_index, weight).detach(), expected, atol=1e-11)
        np.testing.assert_allclose(layer(f, walk).detach(), expected, atol=1e-11)
    directed = edge_index[:, : edge_index.shape[1] // 2]
    expected = aw.scattering(aw.from_edge_index(directed, nodes=20), f.numpy(), steps=[1, 2, 4], pool=pool).features()
    np.testing.assert_allclose(layer(f, directed).detach(), expected, atol=1e-11)


@pytest.mark.parametrize("pool", POOLS)
def test_a_batch_is_its_graphs(pool: str) -> None:
    parts = [(edges(n, n), signal(n, 2)) for n in (5, 9, 12)]
    starts = np.cumsum([0, 5, 9])
    edge_index = torch.cat([part[0] + int(start) for (part, _), start in zip(parts, starts, strict=True)], 1)
    x, batch = (
        torch.cat([x for _, x in parts]),
        torch.repeat_interleave(torch.tensor([0, 1, 3]), torch.tensor([5, 9, 12])),
    )
    layer = aw.torch.Scattering([1, 2], pool=pool).double()
    found = layer(x, edge_index, batch=batch)
    assert found.shape[0] == 4 and not found[2].any()
    for row, ((own, _), f) in zip((0, 1, 3), parts, strict=True):
        torch.testing.assert_close(found[row], layer(f, own)[0], atol=1e-11, rtol=1e-11)
    graph = SimpleNamespace(x=x, edge_index=edge_index, batch=batch, num_graphs=4)
    torch.testing.assert_close(layer(graph), found)
    assert torch.equal(layer(x, edge_index, None, batch, 6)[:4], found)
    walk = aw.from_edge_index(edge_index, nodes=26)
    # The arguments of earlier releases.
    torch.testing.assert_close(layer(x, walk, batch), found, atol=1e-11, rtol=1e-11)


def test_pytorch_geometric_calls_it_as_its_own_layers() -> None:
    geometric = pytest.importorskip("torch_geometric", reason="PyTorch Geometric is not installed")
    from torch_geometric.loader import DataLoader

    graphs = [geometric.data.Data(x=signal(n, 2), edge_index=edges(n, n, 0)[0]) for n in (6, 8, 11)]
    layer = aw.torch.Scattering([1, 2, 4], pool="moments").double()
    (batch,) = DataLoader(graphs, batch_size=3)
    expected = torch.cat([layer(graph) for graph in graphs])
    torch.testing.assert_close(layer(batch), expected)
    torch.testing.assert_close(layer(batch.x, batch.edge_index, batch=batch.batch, batch_size=3), expected)
    nested = geometric.nn.Sequential(
        "x, edge_index, batch", [(aw.torch.Scattering([1, 2]).double(), "x, edge_index -> x"), torch.nn.ReLU()]
    )
    assert nested(batch.x, batch.edge_index, batch.batch).shape == (25, 2 * 4)
    adjacency = geometric.utils.to_torch_csr_tensor(batch.edge_index, size=(25, 25)).to(torch.float64).t()
    # A sparse adjacency has each edge once.
    single = geometric.utils.coalesce(batch.edge_index)
    torch.testing.assert_close(layer(batch.x, adjacency), layer(batch.x, single))


def test_weights_scales_and_gains_have_gradients() -> None:
    edge_index, edge_weight = edges(9, 2)
    f = signal(9, 2).requires_grad_()
    layer = aw.torch.Scattering([1, 2, 4], pool="moments", learn_gains=True, learn_scales=True).double()
    parameters = {name: own.detach().clone().requires_grad_() for name, own in layer.named_parameters()}
    assert set(parameters) == {"gains", "scale_logits"}

    def run(f: torch.Tensor, weight: torch.Tensor, *own: torch.Tensor) -> torch.Tensor:
        named = dict(zip(parameters, own, strict=True))
        return torch.func.functional_call(layer, named, (f, edge_index, weight))

    inputs = (f, edge_weight.clone().requires_grad_(), *parameters.values())
    assert torch.autograd.gradcheck(run, inputs, atol=1e-5)


def test_learned_scales_begin_near_the_given_ones() -> None:
    edge_index, _ = edges(15, 3)
    f = signal(15, 2)
    steps = [1, 2, 4]
    layer, fixed = aw.torch.Scattering(steps, learn_scales=True).double(), aw.torch.Scattering(steps).double()
    assert layer.scale_logits is not None and fixed.scale_logits is None
    torch.testing.assert_close(layer.scale_logits.softmax(1).max(1).values, torch.full((3,), 0.9, dtype=torch.float64))
    assert (layer.scales() - fixed.scales()).abs().max() < 0.35
    walk = aw.from_edge_index(edge_index, nodes=15)
    torch.testing.assert_close(layer(f, edge_index), layer(f, walk))
    with torch.no_grad():
        layer.scale_logits.mul_(100.0)
    torch.testing.assert_close(layer(f, edge_index), fixed(f, edge_index))
    # A step towards the scales of another layer.
    target = aw.torch.Scattering([1, 3, 4]).double()(f, edge_index)
    layer = aw.torch.Scattering(steps, learn_scales=True).double()
    optimizer = torch.optim.Adam([layer.scale_logits], lr=0.05)
    losses = []
    for _ in range(60):
        optimizer.zero_grad()
        loss = (layer(f, edge_index) - target).square().sum()
        loss.backward()
        optimizer.step()
        losses.append(float(loss))
    assert losses[-1] < 0.1 * losses[0]


@pytest.mark.parametrize("learned", [False, True])
def test_it_compiles_to_one_graph(learned: bool) -> None:
    edge_index, edge_weight = edges(12, 4)
    batch = torch.repeat_interleave(torch.tensor([0, 1]), torch.tensor([5, 7]))
    layer = aw.torch.Scattering([1, 2, 4], pool="moments", learn_gains=learned, learn_scales=learned).double()
    compiled = torch.compile(layer, fullgraph=True, backend="aot_eager")
    f = signal(12, 2).requires_grad_()
    found, expected = (own(f, edge_index, edge_weight, batch, 2) for own in (compiled, layer))
    torch.testing.assert_close(found, expected)
    gradients = (torch.autograd.grad(own.square().sum(), f)[0] for own in (found, expected))
    torch.testing.assert_close(*gradients)
    operator = aw.torch.Operator(aw.from_edge_index(edge_index, nodes=12), dtype=torch.float64)
    torch.testing.assert_close(compiled(f, operator, None, batch, 2), layer(f, operator, None, batch, 2))


def test_moments_of_single_precision_have_no_noise() -> None:
    f = torch.full((7, 1), 0.1)
    found = aw.torch.Scattering([1], orders=[0], pool="moments")(f, torch.tensor([[0, 1], [1, 0]]))
    torch.testing.assert_close(found, torch.tensor([[0.1, 0.0, 0.0, 0.0]]))
    assert aw.torch.Scattering([1], pool="mean")(torch.empty(0, 2), torch.empty(2, 0, dtype=torch.long)).shape == (1, 4)


def test_wrong_arguments_are_refused() -> None:
    layer = aw.torch.Scattering()
    with pytest.raises(ValueError, match="2 × E tensor of integers"):
        layer(torch.rand(3, 2), torch.rand(2, 4))
    with pytest.raises(ValueError, match="each of 2 edges"):
        layer(torch.rand(3, 2), torch.tensor([[0, 1], [1, 0]]), torch.ones(3))
    with pytest.raises(ValueError, match="give the edges"):
        layer(torch.rand(3, 2))
    with pytest.raises(ValueError, match="pool must be"):
        aw.torch.Scattering(pool="sum")
    with pytest.raises(ValueError, match="that ascend"):
        aw.torch.Scattering([2, 1])
    with pytest.raises(ValueError, match="graph of each of 3 nodes"):
        aw.torch.Scattering(pool="mean")(torch.rand(3, 2), torch.tensor([[0], [1]]), batch=torch.tensor([0]))
