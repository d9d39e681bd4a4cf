"""Values carried between registered spheres, beside the rule of ADAP_BARY_AREA in NumPy."""

from __future__ import annotations

import warnings

import adwave as aw
import numpy as np
import pytest


def ico(levels: int) -> tuple[np.ndarray, np.ndarray]:
    """A sphere of radius 1 by cutting the triangles of a small one."""
    fine = aw.subdivide(aw.sample("sphere", vertices=40), levels)
    points = np.array(fine.points)
    return points / np.linalg.norm(points, axis=1, keepdims=True), np.array(fine.faces)


def warp(points: np.ndarray, by: float) -> np.ndarray:
    """Points that slide along the sphere, as by a registration."""
    x, y, z = points.T
    angle = 0.4 + by * z**2
    x, y = np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y
    angle = 0.9 + by * x
    y, z = np.cos(angle) * y - np.sin(angle) * z, np.sin(angle) * y + np.cos(angle) * z
    return np.stack([x, y, z], axis=1)


def barycentric(points: np.ndarray, faces: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Weights (len(at), n) of the vertices of the triangle that each direction passes through."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    parts = np.stack([at @ np.cross(b, c).T, at @ np.cross(c, a).T, at @ np.cross(a, b).T], axis=-1)
    total = parts.sum(axis=-1)
    shares = parts / np.where(total > 0, total, np.nan)[..., None]
    inside = np.nan_to_num(shares.min(axis=-1), nan=-np.inf)
    best = inside.argmax(axis=1)
    rows = np.arange(len(at))
    assert inside[rows, best].min() > -1e-9
    found = np.zeros((len(at), len(points)))
    weights = shares[rows, best]
    weights[weights < 1e-10] = 0
    for k in range(3):
        np.add.at(found, (rows, faces[best, k]), weights[:, k])
    return found / found.sum(axis=1, keepdims=True)


def oracle(source, onto, areas, onto_areas):
    """Weights of a mean: barycentric both ways, those of the sources around if one is no corner, corrected by area."""
    gather = barycentric(*source, onto[0])
    spread = barycentric(*onto, source[0]).T
    uses_all = ((gather == 0) & (spread > 0)).any(axis=1)
    weights = np.where(uses_all[:, None], spread, gather) * onto_areas[:, None]
    totals = weights.sum(axis=0)
    weights = weights * (areas / np.where(totals > 0, totals, 1))
    return weights / weights.sum(axis=1, keepdims=True)


CASES = [(2, 1, 0.3), (1, 2, 0.3), (2, 2, 0.5)]


@pytest.mark.parametrize(("first", "second", "by"), CASES)
def test_means_and_labels_are_those_of_the_rule(first, second, by):
    rng = np.random.default_rng(first + 10 * second)
    source, onto = ico(first), ico(second)
    onto = (warp(onto[0], by), onto[1])
    n, m = len(source[0]), len(onto[0])
    areas, onto_areas = rng.uniform(0.5, 1.5, n), rng.uniform(0.5, 1.5, m)
    weights = oracle(source, onto, areas, onto_areas)
    resampler = aw.Resampler(source, onto, areas=areas, onto_areas=onto_areas)
    assert resampler.sizes == [(n, m)]
    values = rng.normal(size=(n, 3))
    assert np.abs(resampler.apply(values) - weights @ values).max() < 1e-9
    labels = rng.integers(0, 4, n) * 7
    shares = np.stack([weights[:, labels == label].sum(axis=1) for label in (0, 7, 14, 21)], axis=1)
    found = resampler.apply(labels)
    assert found.dtype == labels.dtype
    top = np.sort(shares, axis=1)
    is_clear = top[:, -1] > top[:, -2] + 1e-8
    assert is_clear.mean() > 0.95
    assert (found[is_clear] == 7 * shares.argmax(axis=1)[is_clear]).all()


@pytest.mark.parametrize("keep", ["mean", "sum", "integral"])
def test_what_is_kept_is_kept_there_and_back(keep):
    source, onto = ico(4), ico(3)
    onto = (warp(onto[0], 0.4), onto[1])
    rng = np.random.default_rng(3)
    areas, onto_areas = rng.uniform(0.5, 1.5, len(source[0])), rng.uniform(0.5, 1.5, len(onto[0]))
    there = aw.Resampler(source, onto, areas=areas, onto_areas=onto_areas)
    back = aw.Resampler(onto, source, areas=onto_areas, onto_areas=areas)
    values = rng.uniform(0.2, 1.0, len(source[0]))
    if keep == "mean":
        assert np.abs(there.apply(np.full(len(values), 2.5)) - 2.5).max() < 1e-12
        return
    one = there.apply(values, keep=keep)
    two = back.apply(one, keep=keep)
    weights = [(values, areas), (one, onto_areas), (two, areas)]
    kept = [v.sum() if keep == "sum" else v @ a for v, a in weights]
    assert np.ptp(kept) < 1e-12 * kept[0]


def test_both_hemispheres_in_one_call():
    source, onto = ico(3), ico(2)
    other = (warp(onto[0], 0.3), onto[1])
    rng = np.random.default_rng(5)
    left, right = rng.normal(size=(2, len(source[0])))
    pair = ([source, source], [onto, other])
    alone = [aw.resample(source, left, onto=onto), aw.resample(source, right, onto=other)]
    as_list = aw.resample(pair[0], [left, right], onto=pair[1])
    assert isinstance(as_list, list) and all((a == b).all() for a, b in zip(alone, as_list, strict=True))
    joined = aw.resample(pair[0], np.concatenate([left, right]), onto=pair[1])
    assert (joined == np.concatenate(alone)).all()
    series = np.stack([np.concatenate([left, right]), np.concatenate([right, left])])
    assert aw.resample(pair[0], series, onto=pair[1]).shape == (2, 2 * len(onto[0]))
    names = aw.resample(
        {"left": source, "right": source}, {"left": left, "right": right}, onto={"left": onto, "right": other}
    )
    assert list(names) == ["left", "right"] and (names["right"] == alone[1]).all()
    with pytest.raises(ValueError, match="same hemispheres"):
        aw.resample(pair[0], [left, right], onto=onto)


def test_missing_values_masks_and_the_medial_wall():
    source, onto = ico(4), ico(3)
    values = np.random.default_rng(1).uniform(1, 2, len(source[0]))
    cap, other_cap = source[0][:, 2] > 0.8, onto[0][:, 2] > 0.8
    missing = aw.resample(source, np.where(cap, np.nan, values), onto=onto)
    assert abs(np.isnan(missing).mean() - 0.1) < 0.02
    assert np.nanmin(missing) >= 1
    masked = aw.resample(source, np.ma.masked_array(values, cap), onto=onto)
    assert np.array_equal(masked, missing, equal_nan=True)
    with pytest.warns(UserWarning, match="medial wall"):
        wall = aw.resample(source, np.where(cap, 0, values), onto=onto)
    assert np.array_equal(wall, np.nan_to_num(missing))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mixed = aw.resample(source, np.where(cap, 0, values), onto=onto, zeros="values")
        kept = aw.resample(source, values, onto=onto, onto_mask=~other_cap, keep="sum")
    assert ((mixed > 0) & (mixed < 1)).any()
    assert (np.isnan(kept) == other_cap).all()
    assert abs(np.nansum(kept) / values.sum() - 1) < 1e-12
    parcels = aw.resample(source, (values > 1.5).astype(np.int16), onto=onto, onto_mask=~other_cap)
    assert parcels.dtype == np.int16 and not parcels[other_cap].any()


def test_anatomical_areas_count():
    source, onto = ico(3), ico(2)
    wide = source[0] * np.array([1.0, 1.0, 3.0])
    values = source[0][:, 0] ** 2
    by_surface = aw.resample(source, values, onto=onto, areas=(wide, source[1]))
    a, b, c = (wide[source[1][:, k]] for k in range(3))
    thirds = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
    areas = np.bincount(source[1].ravel(), np.repeat(thirds, 3), len(wide))
    assert np.abs(by_surface - aw.resample(source, values, onto=onto, areas=areas)).max() < 1e-12
    assert np.abs(by_surface - aw.resample(source, values, onto=onto)).max() > 1e-4


def test_bad_input_is_one_line():
    source, onto = ico(2), ico(1)
    n = len(source[0])
    stretched = (source[0] * np.array([1, 1, 2.0]), source[1])
    with pytest.raises(ValueError, match=r"onto: the vertices must lie on a sphere.*registered sphere"):
        aw.resample(source, np.ones(n), onto=stretched)
    with pytest.raises(ValueError, match="closed"):
        aw.resample((source[0], source[1][1:]), np.ones(n), onto=onto)
    with pytest.raises(ValueError, match="keep must be mean, sum, integral or labels"):
        aw.resample(source, np.ones(n), onto=onto, keep="max")
    with pytest.raises(ValueError, match="whole numbers"):
        aw.resample(source, np.full(n, 0.5), onto=onto, keep="labels")
    with pytest.raises(ValueError, match="values"):
        aw.resample(source, np.ones(n + 1), onto=onto)
    with pytest.raises(ValueError, match="onto_mask"):
        aw.resample(source, np.ones(n), onto=onto, onto_mask=np.ones(n, bool))
    with pytest.warns(UserWarning, match="center"):
        shifted = aw.resample((source[0] * 80 + 5, source[1]), np.ones(n), onto=onto)
    assert np.abs(shifted - 1).max() < 1e-12
