"""The graph of cells and the times of genes that imputation chooses."""

from __future__ import annotations

import adwave as aw
import numpy as np
import pytest

scipy_sparse = pytest.importorskip("scipy.sparse")


def _cells(n: int = 400, genes: int = 100, lost: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Expected counts and counts of cells on a closed curve, in random order; a share of the counts is lost."""
    random = np.random.default_rng(3)
    angle = random.permutation(2 * np.pi * np.arange(n) / n)
    waves = 1 + 0.9 * np.sin(np.outer(angle, random.integers(1, 3, genes)) + 6 * random.random(genes))
    rates = waves * random.lognormal(0, 1, genes)
    counts = random.poisson(rates) * (random.random(rates.shape) >= lost)
    return rates * (1 - lost), counts.astype(float)


def _error(values: np.ndarray, rates: np.ndarray) -> float:
    """Mean over the genes of the squared error relative to the variance of the rates."""
    return float((((values - rates) ** 2).mean(axis=0) / rates.var(axis=0)).mean())


def test_dropout_does_not_shorten_the_times_and_the_best_time_is_close() -> None:
    rates, counts = _cells(lost=0.4)
    found = aw.impute(counts)
    assert found.choice is not None
    best = found.choice.best
    assert best.loss <= min(graph.loss for graph in found.choice.compared) + 1e-12
    assert (best.components, best.neighbors) in {(g.components, g.neighbors) for g in found.choice.compared}
    assert found.errors[int(found.steps)] == min(found.errors) and np.isinf(found.errors[0])
    before = aw.impute(counts, steps="molecules")
    assert before.choice is None and before.errors.size and (before.steps_by_gene == before.steps).all()
    own = _error(found.values, rates)
    fixed = [_error(aw.impute(counts, found.walk, steps=t).values, rates) for t in range(1, 13)]
    assert own < 0.6 * _error(before.values, rates)
    assert own < 1.3 * min(fixed)


def test_noisy_genes_take_more_steps_and_each_gene_its_own() -> None:
    rates, counts = _cells(genes=200)
    found = aw.impute(counts)
    small = rates.mean(axis=0) < np.median(rates.mean(axis=0))
    assert found.steps_by_gene[small].mean() > found.steps_by_gene[~small].mean()
    gene = int(found.steps_by_gene.argmax())
    alone = aw.impute(counts, found.walk, steps=found.steps_by_gene[gene]).values[:, gene]
    assert np.array_equal(found.values[:, gene], alone)
    some = aw.impute(counts, genes=[gene, 7])
    assert np.array_equal(some.values, found.values[:, [gene, 7]])
    assert np.array_equal(some.steps_by_gene, found.steps_by_gene[[gene, 7]])


def test_layout_and_order_of_the_counts_do_not_matter() -> None:
    _, counts = _cells(n=150, genes=40)
    counts[20:30] = counts[20]
    counts[30:35] = 2 * counts[20]
    found = aw.impute(counts, library_size="median")
    for layout in (scipy_sparse.csr_matrix(counts), scipy_sparse.csc_array(counts), np.asfortranarray(counts)):
        again = aw.impute(layout, library_size="median")
        assert np.array_equal(again.values, found.values) and again.choice == found.choice
    # Walks to equal cells, with the weight 1 of a loop: equal cells stay equal.
    assert np.ptp(found.values[20:35], axis=0).max() < 1e-12 * found.values.max()
    random = np.random.default_rng(4)
    cells, genes = random.permutation(150), random.permutation(40)
    moved = aw.impute(counts[cells][:, genes], library_size="median")
    assert moved.choice == found.choice
    assert np.array_equal(moved.steps_by_gene, found.steps_by_gene[genes])
    assert np.allclose(moved.values, found.values[cells][:, genes], rtol=1e-6, atol=1e-9)


def test_few_cells_constant_genes_and_unknown_words() -> None:
    _, counts = _cells(n=120, genes=30)
    counts[:, 4], counts[:, 5] = 0.0, 3.0
    found = aw.impute(counts)
    assert found.choice is not None
    assert not found.values[:, 4].any() and np.allclose(found.values[:, 5], 3.0)
    few = aw.impute(counts[:30])
    assert few.choice is None and few.errors.size
    zeros = aw.impute(np.zeros((80, 30)), steps=2)
    assert not zeros.values.any()
    with pytest.raises(ValueError, match="steps must be a number, 'auto' or 'molecules', got 'all'"):
        aw.impute(counts, steps="all")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="at least 0"):
        aw.impute(counts - 4.0)


def test_scaled_counts_need_no_molecules() -> None:
    rates, counts = _cells(n=200, genes=60)
    scaled = counts / counts.sum(axis=1, keepdims=True) * 100.0
    shares = rates / rates.sum(axis=1, keepdims=True) * 100.0
    found = aw.impute(scaled)
    assert found.choice is not None
    assert _error(found.values, shares) < 0.4 * _error(scaled, shares)


class _Annotated:
    """What `aw.impute` reads of an AnnData."""

    def __init__(self, X: np.ndarray, obs: dict[str, np.ndarray], **pairs: object) -> None:
        self.X, self.obs, self.layers, self.obsm, self.obsp = X, obs, {}, {}, pairs
        self.var_names = [f"g{gene}" for gene in range(X.shape[1])]


def test_values_are_averaged_within_batches_alone() -> None:
    _, counts = _cells(n=160, genes=40)
    batch = np.array(["b", "a"])[np.arange(160) % 2]
    cells = _Annotated(counts, {"sample": batch})
    for steps in ("auto", "molecules", 3):
        found = aw.impute(cells, steps=steps, walk="sample")
        steps_between = found.walk.matrix().tocoo()
        assert (batch[steps_between.row] == batch[steps_between.col]).all()
        assert np.array_equal(found.values, aw.impute(counts, steps=steps, walk=batch).values)
    # A batch knows nothing of the values of the other.
    walk = aw.impute(counts, batch).walk
    changed = np.where((batch == "a")[:, None], counts, 0.0)
    both = [aw.impute(x, walk, steps=2).values[batch == "a"] for x in (counts, changed)]
    assert np.array_equal(*both)
    # Steps of a given graph to another batch are left out, and a cell without neighbors of its batch stays as it is.
    pairs = scipy_sparse.csr_array([[0, 1, 1], [1, 0, 1], [1, 1, 0]])
    small = _Annotated(np.array([[1.0], [3.0], [8.0]]), {"sample": np.array([0, 0, 1])}, connectivities=pairs)
    assert aw.impute(small, "sample", steps=1).values.ravel().tolist() == [2.0, 2.0, 8.0]


def test_library_sizes_are_those_of_a_key() -> None:
    counts = np.array([[2.0, 1.0], [4.0, 2.0], [1.0, 3.0]])
    sizes = np.array([10.0, 20.0, 40.0])
    cells = _Annotated(counts, {"total_counts": sizes})
    stay = aw.walk(np.eye(3))
    found = aw.impute(cells, stay, steps=1, library_size="total_counts").values
    assert np.array_equal(found, counts * (20.0 / sizes)[:, None])
    assert np.array_equal(found, aw.impute(counts, stay, steps=1, library_size=sizes).values)
    some = aw.impute(cells, stay, steps=1, library_size="total_counts", genes=["g1"]).values
    assert np.array_equal(some, found[:, 1:])


def test_keys_that_are_not_there_are_named_with_those_that_are() -> None:
    cells = _Annotated(np.ones((3, 2)), {"total_counts": np.ones(3)})
    stay = aw.walk(np.eye(3))
    with pytest.raises(ValueError, match=r"walk: there is no 'sample', obs has \['total_counts'\]"):
        aw.impute(cells, "sample", steps=1)
    with pytest.raises(ValueError, match="library_size: there is no 'total', these counts have no obs"):
        aw.impute(np.ones((3, 2)), stay, steps=1, library_size="total")
    with pytest.raises(ValueError, match=r"walk must have a value for each of 3 cells, got shape \(2,\)"):
        aw.impute(cells, ["a", "b"], steps=1)
    with pytest.raises(ValueError, match="has none for cell 1"):
        aw.impute(cells, ["a", None, "b"], steps=1)
    with pytest.raises(ValueError, match=r"got -1\.0 for cell 2"):
        aw.impute(cells, stay, steps=1, library_size=np.array([1.0, 1.0, -1.0]))
