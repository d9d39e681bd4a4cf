"""Tests of the plug-in in napari itself, without a window.

QT_QPA_PLATFORM=offscreen python -m pytest integrations/napari/tests
"""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
napari = pytest.importorskip("napari", reason="needs napari with Qt")
aw = pytest.importorskip("adwave")

from napari.components import ViewerModel  # noqa: E402
from napari_adwave.equalizer import Equalizer  # noqa: E402
from napari_adwave.layers import signal_of  # noqa: E402
from napari_adwave.reader import reader_of  # noqa: E402
from qtpy.QtWidgets import QApplication  # noqa: E402

#: Longest time that a computation of the tests may take, in seconds.
PATIENCE = 60.0
#: Rounding of sums of bands.
ROUNDING = 1e-6


@pytest.fixture(scope="module")
def application() -> QApplication:
    return QApplication.instance() or QApplication([])


@pytest.fixture
def widget(application: QApplication) -> Equalizer:
    return Equalizer(ViewerModel())


def finish(widget: Equalizer, call: Any) -> None:
    """Call a method that computes in a thread, and wait for its result."""
    call()
    end = time.monotonic() + PATIENCE
    while not widget.buttons["Split"].isEnabled():
        QApplication.processEvents()
        assert time.monotonic() < end, f"no result within {PATIENCE} s: {widget.message.text()}"
        time.sleep(0.005)


def image() -> np.ndarray:
    y, x = np.mgrid[:48, :64]
    return np.sin(x / 9.0) + np.cos(y / 7.0) + 0.3 * np.sin(2 * np.pi * x / 4)


def test_sliders_sum_the_bands(widget: Equalizer) -> None:
    widget.viewer.add_image(image(), name="waves", scale=(2.0, 0.5))
    finish(widget, widget.split)
    assert len(widget.sliders) == 6
    wanted = aw.grid(image(), spacing=(2.0, 0.5)).decompose(levels=6)
    widget.sliders[0].setValue(0)
    widget.sliders[2].setValue(200)
    layer = widget.viewer.layers["waves equalized"]
    assert np.abs(layer.data - np.asarray(wanted.apply([0, 1, 2, 1, 1, 1]))).max() < ROUNDING
    assert tuple(layer.scale) == (2.0, 0.5)
    widget.buttons["Reset"].click()
    assert widget.gains() == [1.0] * 6
    assert np.abs(layer.data - image()).max() < ROUNDING
    assert len(widget.viewer.layers) == 2


@pytest.mark.parametrize("kind", ["volume", "colors", "surface", "values", "points"])
def test_every_kind_of_layer_has_bands_noise_and_a_map(widget: Equalizer, kind: str) -> None:
    rng = np.random.default_rng(0)
    shape = aw.sample("creature", vertices=2000)
    rough = shape.points + rng.normal(0, 0.003, shape.points.shape)
    if kind == "volume":
        layer = widget.viewer.add_image(rng.normal(size=(12, 16, 16)).astype(np.float32), name="it")
    elif kind == "colors":
        layer = widget.viewer.add_image(rng.integers(0, 256, (32, 32, 3), dtype=np.uint8), rgb=True, name="it")
    elif kind == "surface":
        layer = widget.viewer.add_surface((rough, shape.faces), name="it")
    elif kind == "values":
        layer = widget.viewer.add_surface((shape.points, shape.faces, shape.points[:, 1] + 0.1), name="it")
    else:
        layer = widget.viewer.add_points(rough, name="it")
    widget.levels.setValue(3)
    finish(widget, widget.split)
    widget.set_gains([0.0, 1.0, 1.0])
    equalized = widget.viewer.layers["it equalized"]
    assert type(equalized) is type(layer)
    finish(widget, widget.denoise)
    denoised = widget.viewer.layers["it denoised"]
    part = {"surface": 0, "values": 2}.get(kind)

    def numbers(of: Any) -> np.ndarray:
        return np.asarray(of.data if part is None else of.data[part], dtype=float)

    for result in (equalized, denoised):
        assert numbers(result).shape == numbers(layer).shape
        assert np.isfinite(numbers(result)).all()
    assert np.abs(numbers(equalized) - numbers(layer)).max() > 0
    if kind == "colors":
        assert denoised.rgb and denoised.data.dtype == np.uint8
    finish(widget, widget.stands_out)
    assert "it saliency" in widget.viewer.layers


def test_lengths_are_those_of_the_scale(widget: Equalizer) -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform(size=(400, 2))
    widget.viewer.add_points(points, name="cells", scale=(1.0, 4.0))
    finish(widget, widget.split)
    widget.set_gains([1.0] * 6)
    equalized = widget.viewer.layers["cells equalized"]
    assert np.abs(equalized.data - points).max() < ROUNDING
    assert tuple(equalized.scale) == (1.0, 4.0)
    wanted = aw.decompose(np.column_stack([points * (1.0, 4.0), np.zeros(400)]), levels=6)
    np.testing.assert_allclose(np.ravel(widget.bands.fwhm), np.ravel(wanted.fwhm), rtol=1e-6)
    widget.set_gains([0.0] + [1.0] * 5)
    changed = np.asarray(wanted.apply([0.0] + [1.0] * 5))[:, :2] / (1.0, 4.0)
    assert np.abs(equalized.data - changed).max() < ROUNDING


def test_what_has_no_bands_is_refused_with_a_line(widget: Equalizer) -> None:
    widget.viewer.add_labels(np.zeros((8, 8), int), name="labels")
    widget.buttons["Split"].click()
    assert "choose an image of one scale" in widget.message.text()
    assert "Labels" in widget.message.text()
    with pytest.raises(ValueError, match="no layer"):
        signal_of(None)
    widget.viewer.layers.clear()
    widget.viewer.add_image(np.zeros((2, 3, 4, 5)), name="series")
    widget.buttons["Split"].click()
    assert "at most 3 axes, got 4" in widget.message.text()


def test_an_error_of_the_computation_is_shown(widget: Equalizer) -> None:
    widget.viewer.add_image(np.full((8, 8), np.nan), name="nothing", contrast_limits=(0, 1))
    finish(widget, widget.split)
    assert widget.bands is None
    assert widget.message.text() not in ("", "Splitting …")


def test_meshes_and_clouds_are_read(tmp_path: Path) -> None:
    shape = aw.sample("creature", vertices=2000)
    heights = np.asarray(shape.points[:, 1])
    shape.with_field("height", heights).write(tmp_path / "creature.ply")
    aw.Shape(shape.points).write(tmp_path / "points.xyz")
    names = [str(tmp_path / name) for name in ("creature.ply", "points.xyz")]
    read = reader_of(names)
    assert read is not None
    (surface, options, kind), (points, _, other_kind) = read(names)
    assert (kind, other_kind) == ("surface", "points")
    assert options["name"] == "creature.ply"
    np.testing.assert_allclose(surface[0], shape.points, atol=1e-6)
    np.testing.assert_array_equal(surface[1], shape.faces)
    np.testing.assert_allclose(surface[2], heights, atol=1e-6)
    assert points.shape == shape.points.shape
    viewer = ViewerModel()
    viewer.add_surface(surface, **options)
    viewer.add_points(points)
    assert reader_of(str(tmp_path / "none.ply")) is None
    (tmp_path / "bad.ply").write_text("ply\nformat ascii 1.0\nelement vertex 9\n")
    with pytest.raises(ValueError, match=r"bad\.ply|header"):
        reader_of(str(tmp_path / "bad.ply"))(str(tmp_path / "bad.ply"))


def test_the_manifest_names_what_exists() -> None:
    npe2 = pytest.importorskip("npe2")
    manifest = npe2.PluginManifest.from_file(Path(__file__).parents[1] / "src/napari_adwave/napari.yaml")
    manifest.validate_imports()
    assert {command.id for command in manifest.contributions.commands} == {
        "napari-adwave.read",
        "napari-adwave.equalizer",
    }
