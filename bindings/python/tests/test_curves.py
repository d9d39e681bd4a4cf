"""Curves: graphs with positions and without weights."""

import pickle

import adwave as aw
import numpy as np
import pytest


def helix(noise: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    t = np.linspace(0, 6 * np.pi, 400)
    points = np.stack([np.cos(t), np.sin(t), 0.1 * t], axis=1)
    points += noise * np.random.default_rng(1).normal(size=points.shape)
    return points, np.stack([np.arange(399), np.arange(1, 400)], axis=1)


def test_ends_stay_unless_they_are_free() -> None:
    points, edges = helix(0.02)
    curve = aw.graph(400, edges, points=points)
    kept = aw.filter(curve, "smooth", levels=5)
    assert np.array_equal(kept.points[[0, -1]], points[[0, -1]])
    assert not np.array_equal(kept.points[1:-1], points[1:-1])
    free = aw.filter(curve, "smooth", levels=5, constraints=aw.Constraints(border="free"))
    assert np.all(np.linalg.norm(free.points[[0, -1]] - points[[0, -1]], axis=1) > 1e-6)


def test_noise_of_a_curve_is_removed() -> None:
    (truth, edges), (noisy, _) = helix(), helix(0.02)
    denoised = aw.denoise(aw.graph(400, edges, points=noisy)).result.points
    error = np.sqrt(((denoised - truth) ** 2).mean())
    assert error < 0.7 * np.sqrt(((noisy - truth) ** 2).mean())


def test_pickled_curves_keep_their_edges() -> None:
    points, edges = helix()
    copy = pickle.loads(pickle.dumps(aw.graph(400, edges, points=points).with_field("s", np.arange(400))))
    assert copy.kind == "graph" and np.array_equal(copy.points, points)
    assert np.array_equal(copy.edges()[0], edges) and copy["s"][7] == 7
    before = aw.filter(aw.graph(400, edges, points=points), "smooth", levels=3).points
    assert np.array_equal(aw.filter(copy, "smooth", levels=3).points, before)


def test_a_graph_needs_one_position_per_node() -> None:
    with pytest.raises(ValueError, match="a graph of 3 nodes needs one row for each"):
        aw.graph(3, [[0, 1]], points=np.zeros((2, 3)))


def test_noise_of_a_curve_is_told_by_axis() -> None:
    random = np.random.default_rng(3)
    t = np.arange(400.0)
    truth = np.stack([t, 30 * np.sin(t / 50), 5 * np.cos(t / 80)], axis=1)
    noisy = truth + random.normal(size=truth.shape) * [0.3, 0.3, 1.0]
    edges = np.stack([np.arange(399), np.arange(1, 400)], axis=1)
    info = aw.denoise(aw.graph(400, edges, points=noisy)).info
    assert np.allclose(info["noise_by_axis"], [0.3, 0.3, 1.0], rtol=0.3)
    assert info["noise"] == pytest.approx(np.sqrt(np.mean(np.square(info["noise_by_axis"]))))
    assert info["length"][0] > 1.2 * info["length"][1]
    assert list(info["rounding"]) == [0, 0, 0]
