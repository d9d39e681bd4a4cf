"""Walks, imputation and scattering."""

from __future__ import annotations

import pickle
from types import SimpleNamespace
from typing import Any

import adwave as aw
import numpy as np
import pytest
from scipy import sparse

RNG = np.random.default_rng(5)


def ring(n: int, stay: float = 0.0) -> aw.Walk:
    """Walk to both neighbors on a ring of n nodes."""
    weights = np.roll(np.eye(n), 1, 1) + np.roll(np.eye(n), -1, 1)
    return aw.walk(weights, normalize="row", stay=stay)


def test_powers_of_a_ring_are_those_of_its_eigenvalues() -> None:
    n, k, t = 24, 5, 7
    wave = np.cos(2 * np.pi * k * np.arange(n) / n)
    plain = np.cos(2 * np.pi * k / n)
    assert np.allclose(ring(n).smooth(wave, t), plain**t * wave, atol=1e-14)
    lazy = 0.5 * (1 + plain)
    assert np.allclose(ring(n, stay=0.5).smooth(wave, t), lazy**t * wave, atol=1e-14)


def test_normalizations_are_those_of_dense_matrices() -> None:
    weights = RNG.random((9, 9))
    weights = weights + weights.T
    np.fill_diagonal(weights, 0.0)
    degree = weights.sum(1)
    dense = {
        "row": weights / degree[:, None],
        "column": weights / degree,
        "symmetric": weights / np.sqrt(np.outer(degree, degree)),
    }
    for name, expected in dense.items():
        walk = aw.walk(sparse.csr_matrix(weights), normalize=name)  # pyright: ignore[reportArgumentType]
        assert np.allclose(walk.matrix().toarray(), expected, atol=1e-15)
        assert walk.normalization == name and name in repr(walk)


def test_bands_of_a_given_walk_are_differences_of_its_powers() -> None:
    P = RNG.random((12, 12))
    P /= P.sum(1, keepdims=True)
    walk, f = aw.walk(P), RNG.normal(size=(12, 3))
    assert not walk.is_reversible
    found = walk.bands(f, [1, 3])
    cube = np.linalg.matrix_power(P, 3)
    assert np.allclose(found, [f - P @ f, P @ f - cube @ f, cube @ f], atol=1e-14)
    assert np.allclose(found.sum(0), f, atol=1e-14)
    assert np.allclose(pickle.loads(pickle.dumps(walk)).smooth(f, 2), walk.smooth(f, 2))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: aw.walk([[0.5, 0.4], [0, 1]]), "row 0"),
        (lambda: aw.walk([[0, -1], [1, 0]], normalize="row"), "at least 0"),
        (lambda: aw.walk([[0, np.nan], [1, 0]], normalize="row"), "finite"),
        (lambda: aw.walk(np.ones((2, 3))), "square"),
        (lambda: aw.walk(np.eye(2), stay=0.5), "normalize"),
        (lambda: aw.walk([[0, 1], [0, 0]], normalize="column"), "symmetric"),
        (lambda: aw.from_edge_index([[0, 5], [1, 0]], nodes=3), "0..=2"),
        (lambda: aw.from_edge_index([[0], [1]], [1.0, 2.0]), "edge_weight"),
        (lambda: aw.neighbors([[1], [9]], [[1.0], [1.0]]), "names neighbor 9"),
        (lambda: aw.point_walk([[np.nan]]), "coordinate 0"),
        (lambda: aw.point_walk(np.ones((3, 2)), kernel="box"), "kernel"),  # pyright: ignore[reportArgumentType]
    ],
)
def test_wrong_walks_are_refused(make: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


def test_neighbors_are_exact_and_duplicates_harmless() -> None:
    X = RNG.normal(size=(200, 7))
    X[50] = X[51]
    walk = aw.point_walk(X, neighbors=4, self_loops=0.0)
    rows = walk.matrix().tolil().rows
    distances = np.linalg.norm(X[:, None] - X, axis=2)
    np.fill_diagonal(distances, np.inf)
    for x in range(200):
        assert set(np.argsort(distances[x])[:4]) <= set(rows[x])
    order = np.argsort(distances, axis=1)[:, :4]
    given = aw.neighbors(order, np.take_along_axis(distances, order, 1), self_loops=0.0)
    assert abs(given.matrix() - walk.matrix()).max() < 1e-12


def test_isolated_nodes_and_empty_graphs() -> None:
    walk = aw.from_edge_index(np.empty((2, 0)), nodes=3)
    assert walk.n_isolated == 3
    assert np.array_equal(walk.smooth([1.0, 2.0, 3.0], 5), [1.0, 2.0, 3.0])
    assert aw.from_edge_index(np.empty((2, 0))).n_nodes == 0


def test_imputation_is_the_power_for_dense_sparse_and_integer_counts() -> None:
    walk = aw.point_walk(RNG.normal(size=(60, 5)), neighbors=6)
    counts = RNG.poisson(1.0, (60, 300))
    counts[:, 7] = 0
    expected = np.linalg.matrix_power(walk.matrix().toarray(), 3) @ counts
    for X in (counts, counts.astype(np.int8), sparse.csr_matrix(counts), sparse.csc_array(counts.astype(np.float32))):
        found = aw.impute(X, walk, steps=3)
        assert np.allclose(found.values, expected, atol=1e-12)
    assert not found.values[:, 7].any()
    some = aw.impute(sparse.csr_matrix(counts), walk, steps=3, genes=[299, 4]).values
    assert np.array_equal(some, found.values[:, [299, 4]])
    root = aw.impute(counts, walk, steps=1, library_size=100.0, square_root=True).values
    scaled = np.sqrt(100.0 * counts / counts.sum(1, keepdims=True))
    assert np.allclose(root, walk.matrix() @ scaled, atol=1e-12)


def test_the_time_is_chosen_by_cross_validation() -> None:
    n = 300
    angle = 2 * np.pi * np.arange(n) / n
    truth = 2.0 + np.cos(np.outer(angle, [1, 2, 3, 1, 2]) + np.arange(5))
    counts = RNG.poisson(truth)
    found = aw.impute(counts, ring(n, stay=0.5))
    walk = ring(n, stay=0.5)
    errors = [((walk.smooth(counts, t) - truth) ** 2).mean() for t in range(len(found.errors))]
    assert errors[int(found.steps)] < 1.1 * min(errors)
    assert found.errors[int(found.steps)] == min(found.errors)
    with pytest.raises(ValueError, match="raw counts"):
        aw.impute(counts + 0.5, walk)


def test_wrong_counts_are_refused() -> None:
    walk = ring(6)
    with pytest.raises(ValueError, match="transpose"):
        aw.impute(np.ones((4, 6)), walk, steps=1)
    with pytest.raises(ValueError, match="got nan in cell 0, gene 0"):
        aw.impute(np.full((6, 1), np.nan), walk, steps=1)
    with pytest.raises(ValueError, match="whole steps"):
        aw.impute(np.ones((6, 1)), walk, steps=0.5)
    with pytest.raises(ValueError, match="genes"):
        aw.impute(np.ones((6, 1)), walk, steps=1, genes=["CD3E"])
    with pytest.raises(ValueError, match="layer"):
        aw.impute(np.ones((6, 1)), walk, steps=1, layer="counts")


def test_an_annotated_matrix_brings_its_graph_and_names() -> None:
    weights = sparse.csr_matrix(np.roll(np.eye(8), 1, 1) + np.roll(np.eye(8), -1, 1))
    counts = RNG.poisson(2.0, (8, 3))
    adata = SimpleNamespace(
        X=counts,
        layers={"raw": sparse.csr_matrix(2 * counts)},
        obsm={},
        obsp={"connectivities": weights},
        var_names=list("abc"),
    )
    found = aw.impute(adata, steps=2, genes=["c"], layer="raw")
    P = (weights.toarray() + np.eye(8)) / 3.0
    assert np.allclose(found.values[:, 0], P @ P @ (2.0 * counts[:, 2]), atol=1e-12)
    assert "connectivities" in found.notes[0]


def test_scattering_is_its_definition() -> None:
    lazy, f = ring(20, stay=0.5), RNG.normal(size=(20, 2))
    found = aw.scattering(lazy, f, steps=[1, 2, 4])
    assert found.paths == ((), (1,), (2,), (3,), (1, 2), (1, 3), (2, 3))
    P = lazy.matrix().toarray()
    power = [np.linalg.matrix_power(P, n) for n in (0, 1, 2, 4)]
    wavelets = [power[j] - power[j + 1] for j in range(3)]
    for values, path in zip(found.values, found.paths, strict=True):
        expected = f
        for j in path:
            expected = abs(wavelets[j - 1] @ expected)
        assert np.allclose(values, expected, atol=1e-14)
    assert found.features().shape == (20, 14)


def test_single_precision_keeps_to_its_bound() -> None:
    walk, f = ring(50, stay=0.5), RNG.normal(size=(50, 3))
    double, single = (aw.scattering(walk, f, precision=precision) for precision in ("double", "single"))
    assert (double.precision, single.precision) == ("double", "single")
    error = abs(double.values - single.values).max() / abs(f).max()
    assert double.error_bound < 1e-12 < error <= single.error_bound < 1e-5
    counts = RNG.poisson(2.0, (50, 300))
    thirds = ring(50, stay=0.3)  # halves would be exact in single precision too
    exact, near = (aw.impute(counts, thirds, steps=3, precision=precision) for precision in ("auto", "single"))
    assert (exact.precision, near.precision) == ("double", "single")
    error = abs(exact.values - near.values).max()
    assert error > 0 and (abs(exact.values - near.values) <= near.error_bound * exact.values).all()
    assert near.error_bound < 4 * 6e-8
    patient = ring(50, stay=0.75)
    assert aw.impute(counts, patient, steps=0.5, precision="single").precision == "double"
    with pytest.raises(ValueError, match="precision must be one of"):
        aw.scattering(walk, f, precision="half")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="precision must be one of"):
        aw.impute(counts, walk, steps=1, precision="half")  # type: ignore[arg-type]


def test_pooled_scattering_of_a_batch_is_that_of_its_graphs() -> None:
    a, b = ring(5, stay=0.5), ring(9, stay=0.5)
    both = aw.walk(sparse.block_diag([a.matrix(), b.matrix()]))
    f = RNG.normal(size=14)
    batch = np.repeat([0, 2], [5, 9])
    for pool in ("mean", "max", "norms", "moments"):
        found = aw.scattering(both, f, pool=pool, batch=batch)
        assert np.allclose(found.values[0], aw.scattering(a, f[:5], pool=pool).values[0], atol=1e-13)
        assert not found.values[1].any()
        assert np.allclose(found.values[2], aw.scattering(b, f[5:], pool=pool).values[0], atol=1e-13)


def test_a_prepared_walk_has_bands_and_filters() -> None:
    prepared = ring(30).prepare()
    f = RNG.normal(size=30)
    bands = prepared.decompose(f, levels=4)
    assert np.allclose(bands.scaling(4), ring(30).smooth(f, 8), atol=1e-10)
    assert np.allclose(bands.reconstruct(), f, atol=1e-12)
    with pytest.raises(ValueError, match="whole"):
        prepared.smooth(f, 0.5)
    lazy = ring(30, stay=0.5).prepare()
    assert np.allclose(lazy.smooth(lazy.smooth(f, 1), 2), lazy.smooth(f, 3), atol=1e-9)


def test_scattering_of_torch_has_gradients() -> None:
    torch = pytest.importorskip("torch")
    walk = ring(10, stay=0.5)
    f = torch.tensor(RNG.normal(size=(10, 2)), requires_grad=True)
    layer = aw.torch.Scattering(steps=[1, 2, 4], learn_gains=True).double()
    found = layer(f, walk)
    expected = aw.scattering(walk, f.detach().numpy(), steps=[1, 2, 4]).features()
    assert np.allclose(found.detach().numpy(), expected, atol=1e-13)
    gains = layer.gains.detach().clone().requires_grad_()

    def run(f: Any, gains: Any) -> Any:
        return torch.func.functional_call(layer, {"gains": gains}, (f, walk))

    assert torch.autograd.gradcheck(run, (f, gains), eps=1e-6, atol=1e-8)
    graph = SimpleNamespace(x=f, edge_index=torch.tensor([[0, 1], [1, 0]]), batch=torch.zeros(10, dtype=torch.long))
    assert aw.torch.Scattering(pool="norms").double()(graph).shape == (1, 16 * 2 * 4)
