"""The filters for ParaView, in VTK."""

from __future__ import annotations

from typing import Any

import adwave as aw
import numpy as np
import pytest

pytest.importorskip("vtkmodules.util.vtkAlgorithm", reason="VTK is not installed")

from adwave import paraview
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData


def surface(shape: aw.Shape) -> vtkPolyData:
    points, cells, data = vtkPoints(), vtkCellArray(), vtkPolyData()
    points.SetData(numpy_to_vtk(np.array(shape.points), deep=True))
    faces = np.asarray(shape.faces)
    ends = np.arange(0, 3 * len(faces) + 1, 3, dtype=np.int64)
    corners = faces.astype(np.int64).ravel()
    cells.SetData(numpy_to_vtkIdTypeArray(ends, deep=True), numpy_to_vtkIdTypeArray(corners, deep=True))
    data.SetPoints(points)
    data.SetPolys(cells)
    return data


def run(kind: Any, data: vtkPolyData, **given: Any) -> vtkPolyData:
    made = kind()
    for name, value in given.items():
        getattr(made, f"Set{name}")(value)
    made.SetInputDataObject(0, data)
    made.Update()
    return made.GetOutputDataObject(0)


def points(data: vtkPolyData) -> np.ndarray:
    return vtk_to_numpy(data.GetPoints().GetData())


def field(data: vtkPolyData, name: str) -> np.ndarray:
    return vtk_to_numpy(data.GetPointData().GetArray(name))


SHAPE = aw.sample("creature", vertices=2000)


def test_bands_add_up_to_the_points() -> None:
    out = run(paraview.WaveletBands, surface(SHAPE), Levels=5)
    whole = field(out, "S") + sum(field(out, f"W{level}") for level in range(1, 6))
    assert np.abs(whole - SHAPE.points).max() < 1e-12
    assert np.allclose(field(out, "|W3|"), np.linalg.norm(field(out, "W3"), axis=1))
    assert out.GetNumberOfPolys() == len(SHAPE.faces)


def test_the_equalizer_is_that_of_the_library() -> None:
    before = surface(SHAPE)
    out = run(paraview.Equalizer, before, Gains="2, 1.5 1", Levels=4, Region="ball:vertex=7,radius=20%")
    bands = aw.decompose(SHAPE, levels=4)
    assert np.array_equal(points(out), bands.apply([2, 1.5, 1, 1], where="ball:vertex=7,radius=20%"))
    assert np.array_equal(points(before), SHAPE.points)
    smooth = run(paraview.Equalizer, before, Preset="smooth")
    assert not np.array_equal(points(smooth), SHAPE.points)


def test_saliency_features_and_denoising() -> None:
    assert np.array_equal(field(run(paraview.Saliency, surface(SHAPE)), "saliency"), np.asarray(aw.saliency(SHAPE)))
    found = aw.features(SHAPE, theta=1.3)
    out = run(paraview.Features, surface(SHAPE), Theta=1.3)
    assert out.GetNumberOfPoints() == out.GetNumberOfVerts() == len(found) > 0
    assert np.array_equal(field(out, "sigma"), found["sigma"])
    noisy = aw.sample("sphere", vertices=2000, noise=0.2)
    assert np.array_equal(points(run(paraview.Denoise, surface(noisy))), aw.denoise(noisy).result.points)


def test_polygons_of_several_lengths_and_empty_input() -> None:
    data, places, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    for place in ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 2, 0)):
        places.InsertNextPoint(place)
    cells.InsertNextCell(4, [0, 1, 2, 3])
    cells.InsertNextCell(3, [3, 2, 4])
    data.SetPoints(places)
    data.SetPolys(cells)
    out = run(paraview.Equalizer, data, Gains="1", Levels=1)
    # In the number type of the input.
    assert points(out).dtype == np.float32 and np.array_equal(points(out), points(data))
    with pytest.raises(ValueError, match="no points"):
        paraview._shape(vtkPolyData())
