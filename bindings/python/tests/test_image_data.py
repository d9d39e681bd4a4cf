"""Images of PyVista and VTK as grids: axes, lengths, which array is meant, and results as images."""

from __future__ import annotations

import pickle
from typing import Any

import adwave as aw
import numpy as np
import pytest

pv = pytest.importorskip("pyvista")
RANDOM = np.random.default_rng(56)
SIZES = (9, 7, 5)
TURN = np.array([[0.0, -1.0, 0.0], [0.6, 0.0, 0.8], [-0.8, 0.0, 0.6]])


def volume(**places: Any) -> Any:
    """An image of 9 × 7 × 5 points with the scalars 'ct' and another array."""
    image = pv.ImageData(dimensions=SIZES, spacing=(0.5, 1.0, 2.0), origin=(7, -8, 9), **places)
    image["ct"] = RANDOM.normal(size=image.n_points)
    image["other"] = RANDOM.normal(size=image.n_points)
    image.set_active_scalars("ct")
    return image


def as_array(image: Any, name: str = "ct") -> np.ndarray:
    """Scalars of a volume with the axes z, y, x."""
    return np.asarray(image[name]).reshape(SIZES[::-1])


def grid_of(image: Any, name: str = "ct") -> Any:
    return aw.grid(as_array(image, name), (2.0, 1.0, 0.5))


def test_every_function_takes_an_image_as_a_grid() -> None:
    image = volume()
    own = grid_of(image)
    before = np.array(image["ct"])
    smooth, clean = aw.smooth(image, fwhm=2), aw.denoise(image)
    sharp, labels = aw.filter(image, [2, 1]), aw.filter_labels(image, np.round(before), [0, 0])
    assert np.array_equal(as_array(smooth), own.smooth(fwhm=2))
    assert np.array_equal(as_array(clean.result), own.denoise().result) and clean.info["noise"] > 0
    assert np.array_equal(as_array(sharp), own.filter([2, 1]))
    assert np.array_equal(labels.reshape(SIZES[::-1]), own.filter_labels(np.round(as_array(image)), [0, 0]))
    bands = aw.decompose(image, levels=3)
    assert bands.shape == (4, *SIZES[::-1]) and np.allclose(bands.reconstruct(), as_array(image))
    assert np.array_equal(aw.saliency(image), own.saliency())
    assert np.array_equal(aw.features(image, best=2), own.features(best=2))
    ball = "ball:point=4 3 2,radius=2"
    assert np.array_equal(aw.region(image, ball), own.region(ball))
    assert np.array_equal(image["ct"], before)


def test_results_are_images_at_the_same_places() -> None:
    image = volume(direction_matrix=TURN)
    for found in (aw.smooth(image, fwhm=2), aw.denoise(image).result, aw.filter(image, [2, 1])):
        assert type(found) is pv.ImageData and found.dimensions == image.dimensions
        assert found.origin == image.origin and found.spacing == image.spacing
        assert np.array_equal(found.direction_matrix, image.direction_matrix)
        assert np.allclose(found.points, image.points)
        assert found.active_scalars_name == "ct" and np.array_equal(found["other"], image["other"])
        assert not np.array_equal(found["ct"], image["ct"])
    # Lengths are along the axes of the image, however they lie in space.
    straight = volume()
    straight["ct"] = image["ct"]
    assert np.array_equal(aw.smooth(image, fwhm=2)["ct"], aw.smooth(straight, fwhm=2)["ct"])


def test_positions_follow_the_image() -> None:
    image = volume(direction_matrix=TURN)
    x, y, z = 5, 2, 3
    place = x + SIZES[0] * (y + SIZES[1] * z)
    values = np.zeros(image.n_points)
    values[place] = 1.0
    image["ct"] = values
    peak = int(np.argmax(aw.smooth(image, fwhm=1.5)["ct"]))
    assert peak == place and np.allclose(image.points[peak], TURN @ [0.5 * x, y, 2.0 * z] + [7, -8, 9])


def test_features_have_positions_in_the_image() -> None:
    image = pv.ImageData(dimensions=(44, 40, 24), spacing=(0.8, 1.0, 2.0), origin=(7, -8, 9), direction_matrix=TURN)
    x, y, z = 20, 21, 11
    place = x + 44 * (y + 40 * z)
    image["spot"] = np.exp(-((image.points - image.points[place]) ** 2).sum(axis=1) / 18)
    found = aw.features(image, best=1, levels=8)
    assert found["vertex"].tolist() == [place] and np.allclose(found["position"], [[2.0 * z, y, 0.8 * x]])
    # The accessor gives positions in space.
    pytest.importorskip("adwave.pyvista")
    assert np.allclose(image.adwave.features(best=1, levels=8).points, image.points[[place]], atol=1e-5)


def test_a_sheared_image_is_warned_of() -> None:
    sheared = np.eye(3)
    sheared[0, 1] = 0.5
    with pytest.warns(UserWarning, match="sheared"):
        grid = aw.grid(volume(direction_matrix=sheared))
    assert np.allclose(grid.spacing, (2.0, np.hypot(1.0, 0.5), 0.5))


def test_a_part_of_an_image_keeps_its_place() -> None:
    image = volume()
    part = image.extract_subset([2, 7, 1, 5, 1, 3])
    smooth = aw.smooth(part, fwhm=2)
    assert smooth.extent == part.extent and np.allclose(smooth.points, part.points)
    with pytest.raises(ValueError, match="its affine differs"):
        other = part.copy()
        other.origin = (0, 0, 0)
        aw.grid(part, mask=other)


@pytest.mark.parametrize("dimensions", [(9, 7, 1), (9, 1, 7), (1, 9, 7)])
def test_an_image_of_one_slice_is_a_grid_of_two_axes(dimensions: tuple[int, int, int]) -> None:
    image = pv.ImageData(dimensions=dimensions, spacing=(0.5, 1.0, 2.0))
    image["v"] = RANDOM.normal(size=63)
    spacing = tuple(h for h, n in zip((2.0, 1.0, 0.5), dimensions[::-1], strict=True) if n > 1)
    grid = aw.grid(image)
    assert grid.shape == (7, 9) and grid.spacing == spacing
    wanted = aw.grid(np.asarray(image["v"]).reshape(7, 9), spacing).smooth(fwhm=3)
    assert np.array_equal(aw.smooth(image, fwhm=3)["v"], wanted.ravel())
    assert aw.decompose(image, levels=2).shape == (3, 7, 9)


def test_a_line_and_a_point_are_grids_of_one_axis() -> None:
    line = pv.ImageData(dimensions=(1, 30, 1))
    line["v"] = RANDOM.normal(size=30)
    assert aw.grid(line).shape == (30,) and aw.smooth(line, fwhm=3)["v"].shape == (30,)
    point = pv.ImageData(dimensions=(1, 1, 1))
    point["v"] = [4.0]
    assert aw.smooth(point, fwhm=3)["v"].tolist() == [4.0]


def test_values_of_cells_are_voxels() -> None:
    image = pv.ImageData(dimensions=(10, 8, 6), spacing=(0.5, 1.0, 2.0))
    image.cell_data["ct"] = RANDOM.normal(size=image.n_cells)
    assert aw.grid(image).shape == SIZES[::-1]
    smooth = aw.smooth(image, fwhm=2)
    wanted = aw.grid(np.asarray(image["ct"]).reshape(SIZES[::-1]), (2.0, 1.0, 0.5)).smooth(fwhm=2)
    assert np.array_equal(smooth.cell_data["ct"], wanted.ravel()) and not smooth.point_data.keys()
    # Both kinds at once are told apart by the name and by the number of values.
    image.point_data["p"] = RANDOM.normal(size=image.n_points)
    for name in ("p", "ct"):
        assert aw.smooth(image, name, fwhm=2)[name].shape == image[name].shape
        assert np.array_equal(aw.smooth(image, image[name], fwhm=2), aw.smooth(image, name, fwhm=2)[name])
    assert aw.decompose(image, "p", levels=2).shape == (3, 6, 8, 10)
    assert aw.decompose(image, "ct", levels=2).shape == (3, *SIZES[::-1])


def test_the_same_name_at_points_and_in_cells_is_the_active_one() -> None:
    image = pv.ImageData(dimensions=(10, 8, 6))
    image.point_data["v"], image.cell_data["v"] = RANDOM.normal(size=480), RANDOM.normal(size=315)
    image.set_active_scalars("v", preference="cell")
    assert aw.grid(image).shape == SIZES[::-1]
    image.set_active_scalars("v", preference="point")
    assert aw.grid(image).shape == (6, 8, 10)


def test_which_array_is_meant() -> None:
    image = volume()
    by_name = aw.smooth(image, "other", fwhm=2)
    assert np.array_equal(by_name["ct"], image["ct"]) and by_name.active_scalars_name == "ct"
    assert np.array_equal(as_array(by_name, "other"), grid_of(image, "other").smooth(fwhm=2))
    assert np.array_equal(aw.grid(image).smooth("other", fwhm=2)["other"], by_name["other"])
    assert np.array_equal(aw.grid(image).filter("other", [0, 1])["other"], aw.filter(image, "other", [0, 1])["other"])
    assert aw.denoise(image, "other").result["other"].shape == (image.n_points,)
    assert np.array_equal(aw.decompose(image, signal="other", levels=2), grid_of(image, "other").decompose(levels=2))
    image.set_active_scalars(None)
    with pytest.raises(ValueError, match=r"'ct', 'other', and none is active; choose one, image\.set_active_scalars"):
        aw.smooth(image, fwhm=2)
    assert np.array_equal(aw.smooth(image, "other", fwhm=2)["other"], by_name["other"])
    with pytest.raises(ValueError, match=r"no array 'mr'; it has 'ct', 'other'"):
        aw.smooth(image, "mr", fwhm=2)
    with pytest.raises(ValueError, match=r"has no values; store them, image\['values'\] = values"):
        aw.denoise(pv.ImageData(dimensions=SIZES))


def test_numbers_come_back_as_numbers() -> None:
    image = pv.ImageData(dimensions=SIZES, spacing=(0.5, 1.0, 2.0))
    flat = RANDOM.normal(size=image.n_points).astype(np.float32)
    wanted = aw.grid(flat.reshape(SIZES[::-1]), (2.0, 1.0, 0.5)).smooth(fwhm=2)
    assert np.array_equal(aw.smooth(image, flat, fwhm=2), wanted.ravel())
    assert np.array_equal(aw.smooth(image, flat.reshape(SIZES[::-1]), fwhm=2), wanted)
    image["single"] = flat
    assert aw.smooth(image, fwhm=2)["single"].dtype == np.float32
    image["vector"] = RANDOM.normal(size=(image.n_points, 3))
    assert aw.smooth(image, "vector", fwhm=2)["vector"].shape == (image.n_points, 3)


def test_nan_and_masks() -> None:
    image = volume()
    values = np.array(image["ct"])
    values[[3, 100]] = np.nan
    image["ct"] = values
    smooth = aw.smooth(image, fwhm=2)["ct"]
    assert np.flatnonzero(np.isnan(smooth)).tolist() == [3, 100]
    assert np.array_equal(aw.denoise(image).result["ct"], grid_of(image).denoise().result.ravel(), equal_nan=True)
    image = volume()
    inside = np.asarray(image["other"]) > 0
    masked = aw.smooth(image, mask=inside, fwhm=2)["ct"]
    wanted = aw.grid(as_array(image), (2.0, 1.0, 0.5), mask=inside.reshape(SIZES[::-1])).smooth(fwhm=2)
    assert np.array_equal(masked, wanted.ravel()) and np.array_equal(masked[~inside], image["ct"][~inside])


def test_images_of_vtk() -> None:
    vtk = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    image, own = vtk.vtkImageData(), volume()
    image.ShallowCopy(own)
    assert type(image) is not pv.ImageData
    found = aw.smooth(image, fwhm=2)
    assert found.IsA("vtkImageData") and found.GetSpacing() == own.spacing and found.GetOrigin() == own.origin
    assert np.array_equal(found["ct"], aw.smooth(own, fwhm=2)["ct"])


def test_a_grid_of_an_image_can_be_stored() -> None:
    grid = aw.grid(volume())
    again = pickle.loads(pickle.dumps(grid))
    assert again.spacing == grid.spacing and np.array_equal(again.smooth(fwhm=2)["ct"], grid.smooth(fwhm=2)["ct"])


def test_lines_of_other_objects_lead_on() -> None:
    image = volume()
    with pytest.raises(TypeError, match=r"an image is a grid; write aw\.grid\(image\)\.prepare\(\)"):
        aw.Decomposer(image)
    with pytest.raises(ValueError, match="a grid has no surface"):
        aw.simplify(image, ratio=0.5)
    assert aw.Shape(image).kind == "graph"


def test_the_accessor_of_pyvista() -> None:
    pytest.importorskip("adwave.pyvista")

    image = volume()
    bands = image.adwave.bands(levels=2)
    assert np.allclose(bands["W1"] + bands["W2"] + bands["S"], image["ct"])
    assert image.adwave.saliency().active_scalars_name == "saliency"
    assert image.adwave.smooth("other", fwhm=2)["other"].shape == (image.n_points,)
    assert image.adwave.region("ball:point=4 3 2,radius=2").shape == (image.n_points,)
    cells = pv.ImageData(dimensions=(10, 8, 6))
    cells.cell_data["q"] = RANDOM.normal(size=cells.n_cells)
    assert cells.adwave.bands(levels=2).cell_data["W1"].shape == (cells.n_cells,)
    assert cells.adwave.saliency().cell_data["saliency"].shape == (cells.n_cells,)
