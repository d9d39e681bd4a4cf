"""Signals that are NaN at some vertices: each channel has a mask of its own."""

import adwave as aw
import numpy as np
import pytest


@pytest.fixture(scope="module")
def shape():
    return aw.sample("sphere", vertices=2000)


@pytest.fixture(scope="module")
def values(shape):
    rng = np.random.default_rng(7)
    values = rng.normal(size=(shape.n_vertices, 4)) + shape.points[:, :1]
    values[rng.choice(shape.n_vertices, 60, replace=False), 1] = np.nan
    values[:300, 3] = np.nan
    return values


def test_a_gap_in_one_channel_leaves_the_others_alone(shape, values):
    filtered = aw.filter(shape, values, [0, 0, 0])
    for channel in range(4):
        alone = aw.filter(shape, values[:, channel], [0, 0, 0])
        np.testing.assert_allclose(filtered[:, channel], alone, rtol=0, atol=1e-12, equal_nan=True)
    assert (np.isnan(filtered) == np.isnan(values)).all()
    assert np.nanstd(filtered[:, 0] - shape.points[:, 0]) < 0.6


def test_a_channel_without_values_stays(shape, values):
    with_empty = np.column_stack([values[:, 0], np.full(shape.n_vertices, np.nan)])
    filtered = aw.filter(shape, with_empty, [0, 0])
    np.testing.assert_array_equal(filtered[:, 0], aw.filter(shape, values[:, 0], [0, 0]))
    assert np.isnan(filtered[:, 1]).all()
    with pytest.raises(ValueError, match="NaN at all"):
        aw.filter(shape, with_empty[:, 1], [0, 0])


def test_denoising_treats_groups_of_channels(shape, values):
    denoised, info = aw.denoise(shape, signal=values)
    assert [group["channels"] for group in info["groups"]] == [[0], [1], [2], [3]]
    for channel in (0, 1, 3):
        alone = aw.denoise(shape, signal=values[:, channel]).result
        np.testing.assert_allclose(denoised[:, channel], alone, rtol=0, atol=1e-12, equal_nan=True)
