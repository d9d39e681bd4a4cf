"""Slopes of fields and heights stay, however irregular the samples are."""

from __future__ import annotations

import adwave as aw
import numpy as np
import pytest


def slope(seed: int = 5, noise: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Points on z = x/2 at random places of a square of side 100, and their true heights."""
    random = np.random.default_rng(seed)
    places = random.uniform(0, 100, (6000, 2))
    truth = places[:, 0] / 2
    return np.c_[places, truth + random.normal(0, 1, len(truth)) * noise], truth


def test_heights_on_a_plane_stay_and_the_plain_operator_moves_them() -> None:
    points, truth = slope()
    for moved in [
        aw.filter(points, "smooth", levels=4, constraints=aw.Constraints(along="z"))[:, 2],
        aw.filter(points, "z", "smooth", levels=4)[:, 2],
        aw.filter(points, truth, "smooth", levels=4),
        aw.denoise(points, signal=truth).result,
    ]:
        assert np.abs(moved - truth).max() < 1e-9 * 100
    plain = aw.filter(points, truth, "smooth", levels=4, local_fit="constant")
    assert np.abs(plain - truth).max() > 0.1


def test_a_noisy_slope_is_smoothed_to_a_third_of_the_noise() -> None:
    points, truth = slope(noise=0.05)
    smooth = aw.filter(points, "smooth", levels=4, constraints=aw.Constraints(along="z"))
    assert np.std(smooth[:, 2] - truth) < 0.35 * 0.05
    assert (smooth[:, :2] == points[:, :2]).all()
    moved, info = aw.denoise(points, signal="z")
    assert np.std(moved[:, 2] - truth) < 0.35 * 0.05
    assert info["noise"] == pytest.approx(0.05, rel=0.1)


def test_an_unknown_fit_is_an_error() -> None:
    points, truth = slope()
    with pytest.raises(ValueError, match="local_fit"):
        aw.filter(points, truth, "smooth", levels=2, local_fit="cubic")  # type: ignore[call-overload]
