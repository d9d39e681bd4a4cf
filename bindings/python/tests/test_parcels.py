"""Parcels as signals."""

from __future__ import annotations

import adwave as aw
import numpy as np
import pytest


def test_means_and_values_of_parcels():
    rng = np.random.default_rng(2)
    labels = rng.integers(-1, 6, 300) * 10
    areas = rng.uniform(0.5, 2.0, 300)
    parcels = aw.Parcels(labels, areas=areas, background=(-10, 0))
    assert parcels.labels.tolist() == [10, 20, 30, 40, 50] and len(parcels) == 5
    values = rng.normal(size=(300, 4))
    values[rng.random((300, 4)) < 0.1] = np.nan
    means = parcels.means(values)
    for k, label in enumerate(parcels.labels):
        own = labels == label
        assert abs(parcels.areas[k] - areas[own].sum()) < 1e-10
        for c in range(4):
            known = own & ~np.isnan(values[:, c])
            assert abs(means[k, c] - np.average(values[known, c], weights=areas[known])) < 1e-12
    assert np.array_equal(parcels.means(values.T), means.T)
    filled = parcels.fill(means)
    assert np.abs(parcels.means(filled) - means).max() < 1e-12
    assert (np.isnan(filled[:, 0]) == (labels <= 0)).all()
    assert (filled[labels == 30] == means[2]).all()


def test_a_parcel_without_values_has_no_mean():
    parcels = aw.Parcels([1, 1, 2])
    assert np.array_equal(parcels.means([1.0, 3.0, np.nan]), [2.0, np.nan], equal_nan=True)


def test_bad_parcels_are_one_line():
    with pytest.raises(ValueError, match="whole number"):
        aw.Parcels([0.5, 1.0])
    with pytest.raises(ValueError, match="background"):
        aw.Parcels([0, 0])
    with pytest.raises(ValueError, match="positive number"):
        aw.Parcels([1, 2], areas=[1.0, 0.0])
    with pytest.raises(ValueError, match="values"):
        aw.Parcels([1, 2]).fill([1.0, 2.0, 3.0])
