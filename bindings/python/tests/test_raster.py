"""Points in cells of the plane, and values of the cells back at points."""

from __future__ import annotations

import adwave as aw
import numpy as np
import pytest


def scan(n: int = 4000) -> np.ndarray:
    """Points of a plane in no order, far from the origin."""
    random = np.random.default_rng(3)
    x, y = np.array([[5e5], [4e6]]) + random.uniform(0, 40, size=(2, n))
    return np.column_stack([x, y, 100 + 0.5 * (x - 5e5) - 0.25 * (y - 4e6)])


def test_cells_have_the_statistics_of_their_points() -> None:
    points = scan()
    extremes = {"mean": np.mean, "min": np.min, "max": np.max, "count": len}
    for statistic, function in extremes.items():
        raster = aw.rasterize(points, 2.5, statistic=statistic)  # type: ignore[arg-type]
        rows, columns = raster.values.shape
        for i in range(rows):
            for j in range(columns):
                away = np.abs(points[:, :2] - (raster.origin + 2.5 * np.array([j, i])))
                inside = points[(away <= 1.25).all(axis=1), 2]
                if len(inside):
                    assert raster.values[i, j] == pytest.approx(function(inside), rel=1e-12)
                else:
                    assert statistic == "count" or np.isnan(raster.values[i, j])


def test_planes_come_back_exactly_and_empty_cells_have_no_weight() -> None:
    x, y = (a.ravel() for a in np.meshgrid(np.arange(12.0), np.arange(9.0)))
    centers = np.column_stack([x, y, 3 * x - 2 * y])
    raster = aw.rasterize(centers, 1.0)
    assert raster.values.shape == (9, 12)
    points = np.random.default_rng(1).uniform(0, [11, 8], size=(500, 2))
    assert np.allclose(raster.interpolate(points), 3 * points[:, 0] - 2 * points[:, 1])
    assert np.isnan(raster.interpolate([[-0.51, 3], [11.51, 3], [np.nan, 3]])).all()
    assert raster.interpolate([[-0.5, 3]])[0] == -6
    holes = aw.rasterize(centers[(x != 4) | (y != 4)], 1.0)
    assert holes.interpolate([[4.0, 4.0], [3.6, 4.0]])[1] == pytest.approx(holes.values[4, 3])
    assert np.isnan(holes.interpolate([[4.0, 4.0]])[0])


def test_heights_are_filtered_on_the_raster_and_put_back() -> None:
    points = scan() * [1, 1, 0.1]
    bump = np.exp(-((points[:, 0] - 500020) ** 2 + (points[:, 1] - 4000020) ** 2) / 8)
    raised = points + np.column_stack([0 * bump, 0 * bump, bump])
    raster = aw.rasterize(raised, 1.0)
    relief = raster.interpolate(raised, raster.values - raster.grid.smooth(fwhm=8))
    inner = (np.abs(points[:, :2] - [500020, 4000020]) < 12).all(axis=1)
    assert np.corrcoef(relief[inner], bump[inner])[0, 1] > 0.9
    assert abs(relief[inner & (bump < 1e-3)]).max() < 0.3


def test_wrong_input_says_what_to_do() -> None:
    points = scan(10)
    for call, told in [
        (lambda: aw.rasterize(points, 0), "cell must be a length above 0"),
        (lambda: aw.rasterize(points, 1e-6), "take a larger one"),
        (lambda: aw.rasterize(points[:, :2], 1), "no third coordinate"),
        (lambda: aw.rasterize(points, 1, statistic="median"), "'mean', 'min'"),  # type: ignore[arg-type]
        (lambda: aw.rasterize(points, 1, values=[1.0]), "one number for each point"),
        (lambda: aw.rasterize(np.full((3, 3), np.nan), 1), "at least one"),
        (lambda: aw.rasterize(points, 8).interpolate(points, [1.0]), "not that of the raster"),
    ]:
        with pytest.raises(ValueError, match=told):
            call()
