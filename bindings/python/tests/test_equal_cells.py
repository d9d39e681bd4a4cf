"""Imputation of equal cells, of every layout of the matrix, and of values that are no counts."""

from __future__ import annotations

import adwave as aw
import numpy as np
import pytest

scipy_sparse = pytest.importorskip("scipy.sparse")


def _cells(seed: int, n: int = 200, genes: int = 40) -> np.ndarray:
    """Counts of three kinds of cells, 30 of which are equal and 10 have three times their counts."""
    random = np.random.default_rng(seed)
    means = random.gamma(1.0, 2.0, (3, genes))
    counts = random.poisson(means[random.integers(0, 3, n)]).astype(float)
    counts[20:50] = counts[20]
    counts[50:60] = 3 * counts[20]
    return counts


@pytest.mark.parametrize("seed", range(3))
def test_equal_cells_have_equal_values_in_every_layout(seed: int) -> None:
    counts = _cells(seed)
    results = [
        aw.impute(layout, steps=3).values
        for layout in (
            counts,
            np.asfortranarray(counts),
            counts[::2].repeat(2, axis=0) * 0 + counts,
            scipy_sparse.csr_matrix(counts),
            scipy_sparse.csc_matrix(counts),
            scipy_sparse.coo_array(counts),
        )
    ]
    for values in results:
        assert np.array_equal(values, results[0])
        assert np.ptp(values[20:50], axis=0).max() == 0


def test_cells_of_one_kind_and_panels_of_few_genes() -> None:
    few = np.random.default_rng(5).poisson(0.4, (120, 3)).astype(float)
    values = aw.impute(few, steps=2).values
    for kind in np.unique(few, axis=0):
        same = (few == kind).all(axis=1)
        assert np.ptp(values[same], axis=0).max() < 1e-12
    assert np.allclose(aw.impute(np.tile([3.0, 1.0, 2.0], (20, 1)), steps=2).values, [3.0, 1.0, 2.0])


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
@pytest.mark.parametrize("layout", [np.asarray, scipy_sparse.csr_matrix])
def test_values_that_are_no_counts_are_refused(value: float, layout: object) -> None:
    counts = _cells(1)
    counts[7, 3] = value
    with pytest.raises(ValueError, match=r"cell 7, gene 3"):
        aw.impute(layout(counts), steps=2)  # type: ignore[operator]
