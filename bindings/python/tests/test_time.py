"""Bands along time: arrays alone, and with the bands of shapes and grids."""

from __future__ import annotations

import pickle

import adwave as aw
import numpy as np
import pytest

rng = np.random.default_rng(0)
series = rng.normal(size=(30, 80))


def gaussian(step: float, fwhm: float, n: int, places: int) -> np.ndarray:
    """Heat on a line with reflecting ends by its cosines."""
    k = np.arange(n)
    cosines = np.cos(np.pi * np.outer(k, np.arange(n) + 0.5) / n)
    norms = (cosines**2).sum(axis=1)
    sigma = fwhm / 1.6651092223153955 / step
    factor = np.exp(-0.25 * sigma**2 * (2 - 2 * np.cos(np.pi * k / n)))
    return (series[:places] @ cosines.T * factor / norms) @ cosines


def test_smoothing_is_heat_along_the_frames() -> None:
    time = aw.Time(dt=0.5, fwhm=3.0)
    assert np.allclose(time.smooth(series), gaussian(0.5, 3.0, 80, 30), atol=1e-12)
    assert np.allclose(time.smooth(series.T, axis=0).T, time.smooth(series), atol=0)
    cube = series.reshape(5, 6, 80)
    assert np.array_equal(time.smooth(cube).reshape(30, 80), time.smooth(series))
    assert time.smooth(series.astype(np.float32)).dtype == np.float32
    assert time.smooth(np.arange(12).reshape(1, 12)).dtype == np.float64


def test_bands_sum_to_the_series() -> None:
    time = aw.Time(dt=1.0, widths=[1.0, 4.0])
    bands = time.decompose(series)
    assert bands.shape == (3, 30, 80)
    assert np.abs(bands.sum(axis=0) - series).max() < 2e-15 * 10
    assert np.allclose(time.filter(series, [0.5, 2]), 0.5 * bands[0] + 2 * bands[1] + bands[2])
    assert np.array_equal(time.decompose(series.T, axis=0), bands.transpose(0, 2, 1))


def test_causal_values_do_not_depend_on_the_future() -> None:
    time = aw.Time(dt=2.0, fwhm=8.0, causal=True)
    later = series.copy()
    later[:, 50:] = 7.0
    assert np.array_equal(time.smooth(series)[:, :50], time.smooth(later)[:, :50])
    assert time.delay > 2.0
    assert aw.Time(dt=2.0, fwhm=8.0).delay == 0.0


def test_space_and_time_commute_on_all_carriers() -> None:
    time = aw.Time(dt=1.0, fwhm=[3.0, 9.0])
    shape = aw.sample("sphere", vertices=300)
    field = rng.normal(size=(shape.n_vertices, 40))
    both = aw.smooth(shape, field, fwhm=0.3, time=time)
    assert np.allclose(both, aw.smooth(shape, time.smooth(field), fwhm=0.3), atol=1e-8)
    turned = aw.smooth(shape, field.T, fwhm=0.3, time=time)
    assert np.allclose(turned.T, both, atol=1e-12)
    bands = aw.decompose(shape, field, levels=3, time=time)
    assert bands.shape == (4, 3, shape.n_vertices, 40)
    assert np.abs(bands.sum(axis=(0, 1)) - field).max() < 1e-13
    filtered = shape.filter(field, [0, 1], time=time)
    assert np.allclose(filtered, time.smooth(shape.filter(field, [0, 1])), atol=1e-12)
    grid = aw.grid(rng.normal(size=(8, 9, 40)), axes=(0, 1))
    assert np.allclose(grid.smooth(sigma=1, time=time), time.smooth(grid.smooth(sigma=1)), atol=1e-12)
    assert aw.decompose(grid, levels=2, time=time).shape == (3, 3, 8, 9, 40)
    assert np.allclose(aw.filter(grid, [0, 0], time=time), time.smooth(grid.filter([0, 0])), atol=1e-12)
    walk = aw.point_walk(rng.normal(size=(100, 3)), neighbors=6, stay=0.5)
    counts = rng.normal(size=(100, 40))
    assert np.allclose(aw.smooth(walk, counts, 2, time=time), time.smooth(aw.smooth(walk, counts, 2)), atol=1e-12)


def test_uneven_times_and_unknown_values() -> None:
    times = np.cumsum(rng.uniform(0.5, 1.5, size=80))
    time = aw.Time(times=times, fwhm=4.0)
    assert np.allclose(time.smooth(np.ones((2, 80))), 1.0, atol=0)
    gaps = series.copy()
    gaps[3, 10] = np.nan
    smooth = time.smooth(gaps)
    assert np.array_equal(smooth[3], gaps[3], equal_nan=True)
    assert np.array_equal(smooth[4], time.smooth(series)[4])
    again = pickle.loads(pickle.dumps(time))
    assert np.array_equal(again.smooth(series), time.smooth(series))


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: aw.Time(2.0).smooth(series), "widths"),
        (lambda: aw.Time(fwhm=3.0), "dt"),
        (lambda: aw.Time(-1.0, fwhm=3.0), "above 0"),
        (lambda: aw.Time(1.0, fwhm=[3.0, 2.0]), "increasing"),
        (lambda: aw.Time(1.0, fwhm=3.0, ends="mirror"), "reflect"),  # type: ignore[arg-type]
        (lambda: aw.Time(times=[0, 1, 1], fwhm=3.0), "increase"),
        (lambda: aw.Time(times=[0, 1, 3], fwhm=3.0, ends="periodic"), "equal steps"),
        (lambda: aw.Time(1.0, fwhm=3.0).smooth(5.0), "no frames"),
        (lambda: aw.Time(1.0, fwhm=3.0).smooth(np.ones((3, 1))), "at least 2 frames"),
        (
            lambda: aw.smooth(aw.sample("sphere", vertices=100), fwhm=0.3, time=aw.Time(1.0, fwhm=3.0)),
            "numbers with frames",
        ),
        (
            lambda: aw.smooth(aw.sample("sphere", vertices=100), np.ones(100), fwhm=0.3, time=aw.Time(1.0, fwhm=3.0)),
            "no frames",
        ),
    ],
)
def test_what_does_not_fit_is_said(make: object, says: str) -> None:
    with pytest.raises((TypeError, ValueError), match=says):
        make()  # type: ignore[operator]


def test_noise_of_a_series_is_removed_in_space_and_time() -> None:
    grid = aw.grid(np.zeros((20, 22)))
    x, t = np.meshgrid(np.arange(440), np.arange(60), indexing="ij")
    truth = np.cos(0.2 * (x % 22) + 0.1 * t) * np.sin(0.2 * (x // 22))
    noisy = (truth + 0.3 * rng.normal(size=truth.shape)).reshape(20, 22, 60)
    clean, info = grid.denoise(noisy, time=aw.Time(dt=1.0))
    assert abs(info["noise"] / 0.3 - 1) < 0.1
    error = np.sqrt(((np.asarray(clean).reshape(440, 60) - truth) ** 2).mean())
    assert error < 0.07
    turned = aw.denoise(grid, np.moveaxis(noisy, -1, 0), time=aw.Time(dt=1.0)).result
    assert np.allclose(np.moveaxis(turned, 0, -1), clean, atol=1e-12)
    shape = aw.sample("sphere", vertices=300)
    field = rng.normal(size=(shape.n_vertices, 3, 20))
    field[4, 1, 3] = np.nan
    found = shape.denoise(field, time=aw.Time(dt=1.0)).result
    assert found.shape == field.shape
    assert np.array_equal(found[4], field[4], equal_nan=True)
    assert np.abs(found[5:]).mean() < 0.3 * np.abs(field[5:]).mean()


def test_sequences_lose_jitter_and_keep_shape() -> None:
    ball = aw.sample("creature", vertices=2000)
    angles = 0.05 * np.arange(40)
    turns = np.array([[[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]] for a in angles])
    truth = ball.points @ turns.transpose(0, 2, 1)
    size = 0.005 * np.ptp(ball.points)
    noisy = aw.sequence(truth + size * rng.normal(size=truth.shape), dt=0.04, faces=ball.faces)
    clean, info = noisy.denoise()
    assert abs(info["noise"] / size - 1) < 0.1

    def error(found: np.ndarray) -> float:
        return float(np.sqrt(((found - truth) ** 2).mean()))

    single = min(error(noisy.smooth(time=width).points) for width in (0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 0.8, 1.2))
    assert error(clean.points) < single
    still = aw.sequence(truth, faces=ball.faces).without_motion()
    assert np.abs(still.points - still.points[0]).max() < 1e-9 * np.ptp(truth)
    assert still.motion(levels=3).shape == (4, ball.n_vertices)
    assert still.motion(levels=3).max() < 1e-9 * np.ptp(truth)
    damped = noisy.filter([0.0, 1.0], time=[0.1, 0.4])
    assert np.allclose(damped.points.mean(axis=0), noisy.points.mean(axis=0))
    assert np.allclose(noisy.filter([1, 1, 1]).points, noisy.points, atol=1e-12)
    assert len(pickle.loads(pickle.dumps(noisy))) == 40


def test_sequences_come_from_files_and_go_there(tmp_path: object) -> None:
    ball = aw.sample("sphere", vertices=200)
    frames = [ball.with_points(ball.points * (1 + 0.1 * k)) for k in range(3)]
    made = aw.sequence(frames, dt=0.5)
    paths = made.write(tmp_path / "frames")  # type: ignore[operator]
    again = aw.sequence(str(tmp_path / "frames"), dt=0.5)  # type: ignore[operator]
    assert len(paths) == len(again) == 3
    assert np.allclose(again.points, made.points, atol=1e-6)
    assert np.array_equal(again[1].faces, ball.faces)
    for wrong, says in (
        ([ball], "two frames"),
        ([ball, aw.sample("sphere", vertices=500)], "same vertices"),
        (np.zeros((2, 5)), "frames, n, 3"),
        (str(tmp_path / "none"), "0 files"),  # type: ignore[operator]
    ):
        with pytest.raises(ValueError, match=says):
            aw.sequence(wrong)
