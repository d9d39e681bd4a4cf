"""Domains joined into one: rows, parts of surfaces and grids, masks, copies."""

import pickle

import adwave as aw
import numpy as np
import pytest


@pytest.fixture
def left():
    return aw.sample("sphere", vertices=400)


@pytest.fixture
def right():
    return aw.sample("knot", vertices=700)


def test_each_part_is_smoothed_by_itself(left, right):
    grid = aw.grid(np.zeros((5, 6, 7)), spacing=(0.1, 0.1, 0.2))
    both = aw.union([left, right, grid])
    values = np.random.default_rng(1).normal(size=(both.n_vertices, 3))
    smooth = both.smooth(values, fwhm=0.3)
    a, b, c = both.parts
    np.testing.assert_allclose(smooth[a], left.smooth(values[a], fwhm=0.3), atol=1e-8)
    np.testing.assert_allclose(smooth[b], right.smooth(values[b], fwhm=0.3), atol=1e-8)
    np.testing.assert_allclose(
        smooth[c].reshape(5, 6, 7, 3), grid.smooth(values[c].reshape(5, 6, 7, 3), fwhm=0.3), atol=1e-8
    )


def test_bands_sum_to_the_signal(left, right):
    both = aw.union([left, right])
    values = np.random.default_rng(2).normal(size=both.n_vertices)
    bands = both.decompose(values, fwhm=[0.1, 0.4])
    np.testing.assert_allclose(np.asarray(bands).sum(axis=0), values, atol=1e-13)


def test_some_vertices_and_labels(left):
    vertices = np.flatnonzero(left.points[:, 2] > 0)[::-1]
    part = aw.union([(left, vertices)])
    values = np.random.default_rng(3).normal(size=left.n_vertices)
    masked = aw.Decomposer(left, operator="surface").with_mask(left.points[:, 2] <= 0)
    np.testing.assert_allclose(
        part.smooth(values[vertices], fwhm=0.3), masked.smooth(values, fwhm=0.3)[vertices], atol=1e-8
    )
    line = aw.union([(aw.grid(np.zeros(4)), [0, 1, 2, 3], [5, 5, 8, 8])])
    np.testing.assert_allclose(line.smooth([0.0, 2.0, 4.0, 8.0], fwhm=1000), [1, 1, 6, 6], atol=1e-8)


def test_unknown_values_and_copies(left, right):
    both = aw.union([left, right])
    values = np.random.default_rng(4).normal(size=both.n_vertices)
    values[[7, 500]] = np.nan
    smooth = both.smooth(values, fwhm=0.3)
    assert np.isnan(smooth[[7, 500]]).all()
    assert np.isfinite(np.delete(smooth, [7, 500])).all()
    again = pickle.loads(pickle.dumps(both))
    np.testing.assert_array_equal(again.smooth(values, fwhm=0.3), smooth)
    assert repr(again) == "<adwave.Decomposer: heat on 2 parts, 1100 rows>"


def test_wrong_parts_lead_to_the_right_ones(left):
    with pytest.raises(ValueError, match="one part or more"):
        aw.union([])
    with pytest.raises(ValueError, match="part 1 has walk; prepare it by"):
        aw.union([left, aw.Decomposer(left, operator="walk")])
    with pytest.raises(ValueError, match="whole numbers"):
        aw.union([(left, [0.5, 1.0])])
    with pytest.raises(ValueError, match="does not exist"):
        aw.union([(left, [0, 4000])])
    with pytest.raises(TypeError, match="give a list"):
        aw.union("left")
