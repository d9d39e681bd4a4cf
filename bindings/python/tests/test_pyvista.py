"""The accessor of PyVista's datasets."""

from __future__ import annotations

import adwave as aw
import numpy as np
import pytest

pv = pytest.importorskip("pyvista", minversion="0.48", reason="PyVista 0.48 or newer is not installed")


def test_results_are_datasets_like_the_mesh() -> None:
    import adwave.pyvista  # noqa: F401 (where the package is not installed there is no entry point)

    shape = aw.sample("creature", vertices=2000)
    mesh = shape.to_pyvista()
    mesh.cell_data["part"] = np.arange(mesh.n_cells)
    before = np.array(mesh.points)
    whole = mesh.adwave.bands(levels=4)
    assert np.abs(sum(whole.point_data[name] for name in ("W1", "W2", "W3", "W4", "S")) - before).max() < 1e-12
    smooth = mesh.adwave.filter("smooth")
    assert np.array_equal(smooth.points, aw.filter(shape, "smooth").points)
    assert np.array_equal(smooth.cell_data["part"], mesh.cell_data["part"])
    assert np.array_equal(mesh.adwave.denoise().points, aw.denoise(shape).result.points)
    assert np.array_equal(mesh.adwave.saliency().active_scalars, np.asarray(aw.saliency(shape)))
    found = aw.features(shape, theta=1.3)
    assert np.array_equal(mesh.adwave.features(theta=1.3).point_data["sigma"], found["sigma"])
    assert np.array_equal(mesh.points, before)
    grid = mesh.cast_to_unstructured_grid().adwave.filter("smooth")
    assert isinstance(grid, pv.UnstructuredGrid) and np.array_equal(grid.points, smooth.points)
