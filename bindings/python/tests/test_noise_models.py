"""Noise of a signal that depends on its values."""

from __future__ import annotations

import adwave as aw
import numpy as np
import pytest


def counts() -> tuple[aw.Shape, np.ndarray, np.ndarray]:
    """A sphere, the true means of counts there, and counts."""
    shape = aw.sample("sphere", vertices=4000)
    truth = np.where(shape.points[:, 2] > 0, 40.0, 5.0)
    return shape, truth, np.random.default_rng(3).poisson(truth).astype(float)


def test_counts_are_smoothed_with_their_noise() -> None:
    shape, truth, noisy = counts()
    found, info = aw.denoise(shape, noisy, noise="poisson")
    assert info["noise_model"] == "poisson"
    # The estimate has a deviation of 4 %, and the step raises it by 5 % on so few vertices.
    assert info["noise"] == pytest.approx(1.0, abs=0.15)
    flat = np.random.default_rng(5).poisson(40.0, len(truth)).astype(float)
    assert aw.denoise(shape, flat, noise="poisson").info["noise"] == pytest.approx(1.0, abs=0.1)
    assert 0.0 < info["remaining"] < 0.2
    assert np.mean((found - truth) ** 2 / truth) < 0.15 * np.mean((noisy - truth) ** 2 / truth)
    given, info = aw.denoise(shape, noisy, noise=("poisson", 1.0))
    assert info["noise"] == 1.0
    assert np.abs(given - found).max() < 10.0


def test_relative_noise_has_a_model_and_values_below_zero_are_refused() -> None:
    shape, truth, noisy = counts()
    speckle = truth * np.exp(0.2 * np.random.default_rng(4).standard_normal(len(truth)))
    assert aw.denoise(shape, speckle, noise="multiplicative").info["noise"] == pytest.approx(0.2, abs=0.02)
    noisy[7] = -1.0
    with pytest.raises(ValueError, match="vertex 7 has -1"):
        aw.denoise(shape, noisy, noise="poisson")
    with pytest.raises(ValueError, match="not of positions"):
        aw.denoise(shape, noise="poisson")
    with pytest.raises(ValueError, match="noise"):
        aw.denoise(shape, truth, noise="pink")  # type: ignore[arg-type]


def test_noise_that_neighbors_share_is_removed_on_request() -> None:
    clean = aw.sample("sphere", vertices=4000)
    random = np.random.default_rng(5)
    heights = aw.filter(clean, random.standard_normal(clean.n_vertices), [0, 0, 1])
    edge = np.linalg.norm(clean.points[clean.faces[:, 0]] - clean.points[clean.faces[:, 1]], axis=1).mean()
    heights *= 0.2 * edge / heights.std()
    noisy = aw.Shape(clean.points * (1 + heights[:, None]), clean.faces)

    def error(shape: aw.Shape) -> float:
        return float(np.std(np.linalg.norm(shape.points, axis=1)))

    kept, info = aw.denoise(noisy)
    assert info["shared_noise"] == 0 and 0.1 * edge < info["shared_noise_at_most"] < 0.4 * edge
    removed, own = aw.denoise(noisy, noise="shared")
    assert own["shared_noise"] == info["shared_noise_at_most"]
    given, _ = aw.denoise(noisy, noise=("shared", own["shared_noise"]))
    assert np.array_equal(given.points, removed.points)
    assert error(removed) < 0.9 * error(kept)
    with pytest.raises(ValueError, match="applies to meshes"):
        aw.denoise(clean.points, noise="shared")
    with pytest.raises(ValueError, match="not to a signal"):
        aw.denoise(clean, heights, noise="shared")
