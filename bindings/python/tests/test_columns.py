"""Signals of many channels: mapped from files, and in single precision."""

from __future__ import annotations

from pathlib import Path

import adwave as aw
import numpy as np
import pytest
from adwave import _columns

SPHERE = aw.Decomposer(aw.sample("sphere", vertices=80))


@pytest.mark.parametrize("is_last", [False, True])
@pytest.mark.parametrize("mode", ["r", "r+", "c"])
def test_a_mapped_signal_is_filtered_as_the_array(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mode: str, is_last: bool
) -> None:
    monkeypatch.setattr(_columns, "_GROUP_BYTES", 1)
    values = np.random.default_rng(3).normal(size=(80, 101))
    values[5:9, 40] = np.nan
    values = values.T.copy() if is_last else values
    np.save(tmp_path / "f.npy", values)
    mapped = np.load(tmp_path / "f.npy", mmap_mode=mode)
    found = aw.filter(SPHERE, mapped, [0.0, 0.5, 1.0], local_fit="constant")
    expected = aw.filter(SPHERE, values, [0.0, 0.5, 1.0], local_fit="constant")
    assert isinstance(found, np.memmap)
    np.testing.assert_allclose(found, expected, atol=1e-12)
    np.testing.assert_array_equal(mapped, values)


def test_few_channels_and_views_are_arrays(tmp_path: Path) -> None:
    values = np.random.default_rng(3).normal(size=(80, 15)).astype(np.float32)
    np.save(tmp_path / "f.npy", values)
    mapped = np.load(tmp_path / "f.npy", mmap_mode="r")
    found = aw.filter(SPHERE, mapped, "smooth", levels=3)
    assert not isinstance(found, np.memmap) and found.shape == (80, 15)
    with pytest.raises(ValueError, match="80"):
        aw.filter(SPHERE, mapped[:79], "smooth", levels=3)


@pytest.mark.parametrize("channels", [1, 3, 5, 40])
def test_single_precision_keeps_to_its_bound(channels: int) -> None:
    values = np.random.default_rng(3).normal(size=(80, channels))
    exact = np.asarray(SPHERE.decompose(values, levels=3))
    bands = aw.decompose(SPHERE, values, levels=3, precision="single")
    assert bands.info["bits"] == 32 and 1e-7 < bands.info["error_bound"] < 1e-3
    for found, expected in zip(np.asarray(bands)[:-1], exact[:-1], strict=True):
        error = np.linalg.norm(found - expected) / np.linalg.norm(expected)
        assert 1e-10 < error < 3 * bands.info["error_bound"]
    assert aw.decompose(SPHERE, values, levels=3).info["bits"] == 64
    assert aw.decompose(SPHERE, values, levels=3, accuracy=1e-2).info["bits"] == 32
    assert aw.decompose(SPHERE, values, levels=3, accuracy=1e-2, precision="double").info["bits"] == 64
    smooth = aw.filter(SPHERE, values, [0.0, 0.0, 1.0], local_fit="constant", precision="single")
    np.testing.assert_allclose(smooth, aw.filter(SPHERE, values, [0.0, 0.0, 1.0], local_fit="constant"), atol=1e-4)


def test_positions_are_filtered_in_single_precision_on_request() -> None:
    one, two = (aw.filter(SPHERE, [0.0, 0.5], precision=p) for p in ("single", "double"))
    assert 0 < np.abs(one.points - two.points).max() < 1e-5


def test_precision_is_refused_where_it_changes_nothing() -> None:
    with pytest.raises(ValueError, match="fractional"):
        aw.decompose(SPHERE, np.ones((80, 15)), steps=[0.5, 2], operator="walk", precision="single")
    with pytest.raises(ValueError, match="local_fit='constant'"):
        aw.filter(SPHERE, np.ones((80, 20)), "smooth", levels=3, precision="single")
    with pytest.raises(ValueError, match="precision must be one of"):
        aw.decompose(SPHERE, np.ones((80, 20)), precision="half")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="no option 'precision'"):
        aw.saliency(SPHERE, np.ones((80, 20)), precision="single")  # type: ignore[call-arg]
