"""Images and volumes: laws of heat on grids, axes, masks, objects of other libraries, and messages."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
from typing import Any

import adwave as aw
import numpy as np
import pytest
from numpy.typing import NDArray

scipy_fft = pytest.importorskip("scipy.fft")
ndimage = pytest.importorskip("scipy.ndimage")

#: FWHM of a Gaussian in standard deviations.
FWHM = 2 * np.sqrt(2 * np.log(2))
#: The accuracy that results are asked for by default is 1e-10; values here are of the order of 1.
EXACT = 1e-9
RANDOM = np.random.default_rng(5)


def noise(*shape: int) -> NDArray[np.float64]:
    return RANDOM.normal(size=shape)


def heat(values: NDArray[Any], sigma: float, spacing: Any = 1.0) -> NDArray[np.float64]:
    """Heat with reflecting borders by its eigenvectors, the cosines: exp(−2t(1 − cos(πk/n))) with t = σ²/2h² an axis."""
    spacing = np.broadcast_to(spacing, values.ndim)
    spectrum = scipy_fft.dctn(values, type=2, norm="ortho")
    for axis, (n, h) in enumerate(zip(values.shape, spacing, strict=True)):
        factor = np.exp(-((sigma / h) ** 2) * (1 - np.cos(np.pi * np.arange(n) / n)))
        spectrum *= factor.reshape([-1 if i == axis else 1 for i in range(values.ndim)])
    return scipy_fft.idctn(spectrum, type=2, norm="ortho")


# Laws


@pytest.mark.filterwarnings("ignore:levels. an rms width")
@pytest.mark.parametrize("shape", [(50,), (24, 37), (12, 9, 15)])
@pytest.mark.parametrize("sigma", [0.4, 1.0, 3.3, 40.0])
def test_heat_is_that_of_the_cosines(shape: tuple[int, ...], sigma: float) -> None:
    values, spacing = noise(*shape), (0.7, 1.0, 2.5)[: len(shape)]
    found = aw.grid(values, spacing).smooth(sigma=sigma)
    assert np.abs(found - heat(values, sigma, spacing)).max() < EXACT


def test_the_eigenvalue_of_a_cosine_is_that_of_its_formula() -> None:
    n, k, sigma = 40, 7, 1.5
    wave = np.cos(np.pi * k * (np.arange(n) + 0.5) / n)
    t = sigma**2 / 2
    assert np.allclose(
        aw.grid(wave).smooth(sigma=sigma), np.exp(-2 * t * (1 - np.cos(np.pi * k / n))) * wave, atol=EXACT
    )


def test_the_three_names_of_a_width_agree() -> None:
    grid = aw.grid(noise(20, 30), spacing=0.5)
    by_sigma = grid.smooth(sigma=2.0)
    assert np.array_equal(grid.smooth(fwhm=FWHM * 2.0).round(9), by_sigma.round(9))
    assert np.array_equal(grid.smooth(rms=np.sqrt(2) * 2.0).round(9), by_sigma.round(9))
    # One step has the variance h²/2 along each axis.
    assert np.allclose(grid.smooth(steps=2.0**2 / (0.5**2 / 2)), by_sigma, atol=EXACT)


def crossing(line: NDArray[np.float64]) -> float:
    """Width of a symmetric line at half its maximum, in places, by its logarithm, nearly linear in the square."""
    right = line[len(line) // 2 :] / line.max()
    i = int(np.argmax(right < 0.5))
    low, high = np.log(right[i - 1]), np.log(right[i])
    return 2 * float(np.sqrt((i - 1) ** 2 + (np.log(0.5) - low) / (high - low) * (i**2 - (i - 1) ** 2)))


@pytest.mark.parametrize("spacing", [(1.0, 1.0, 1.0), (0.8, 1.0, 1.6), (1.0, 1.0, 3.0)])
@pytest.mark.parametrize("with_mask", [False, True])
def test_the_width_of_an_impulse_is_the_one_asked_for(spacing: tuple[float, ...], with_mask: bool) -> None:
    impulse = np.zeros((41, 43, 45))
    impulse[20, 21, 22] = 1
    mask = np.pad(np.ones((39, 41, 43)), 1) if with_mask else None
    kernel = aw.grid(impulse, spacing, mask).smooth(fwhm=4.0)
    for axis, h in enumerate(spacing):
        line = np.moveaxis(kernel, axis, 0).sum(axis=(1, 2))
        x = h * (np.arange(len(line)) - len(line) // 2)
        assert abs(FWHM * np.sqrt((line * x**2).sum()) / 4.0 - 1) < 1e-6
        # The tails of a discrete Gaussian are longer than those of a continuous one, so that it crosses its half closer.
        w = 4.0 / h
        if w > 2:
            assert -1.6 / w**2 < crossing(line) * h / 4.0 - 1 < -0.7 / w**2


def test_a_kernel_of_several_places_crosses_its_half_within_one_percent() -> None:
    impulse = np.zeros((161, 101))
    impulse[80, 50] = 1
    kernel = aw.grid(impulse, (0.2, 0.35)).smooth(fwhm=4.0)
    assert abs(crossing(kernel[:, 50]) * 0.2 / 4.0 - 1) < 0.01 and abs(crossing(kernel[80]) * 0.35 / 4.0 - 1) < 0.01


@pytest.mark.parametrize("mask", [None, "half"])
def test_constants_sums_and_the_range_are_kept(mask: str | None) -> None:
    values = noise(30, 40)
    kept = None if mask is None else np.arange(1200).reshape(30, 40) % 40 < 25
    grid = aw.grid(values, mask=kept)
    inside = np.ones((30, 40), dtype=bool) if kept is None else kept
    smooth = grid.smooth(sigma=3)
    assert np.abs(grid.smooth(np.full((30, 40), 7.25), sigma=3) - 7.25).max() < EXACT
    assert abs(smooth[inside].sum() - values[inside].sum()) < 1e-7
    assert values[inside].min() <= smooth[inside].min() and smooth[inside].max() <= values[inside].max()
    assert np.array_equal(smooth[~inside], values[~inside])


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.uint8, np.int16])
def test_bands_and_base_sum_to_the_values(dtype: type) -> None:
    values = (100 * RANDOM.random((20, 24, 12))).astype(dtype)
    bands = aw.grid(values, (1, 1, 2)).decompose(sigma=[1, 2, 4])
    assert bands.shape == (4, 20, 24, 12) and bands.fwhm == pytest.approx([FWHM, 2 * FWHM, 4 * FWHM])
    total = bands.sum(axis=0)
    assert np.abs(total - values).max() < (1e-4 if dtype == np.float32 else 1e-12)
    assert bands.dtype == (np.float32 if dtype == np.float32 else np.float64)
    assert dtype == np.float32 or dtype == np.float64 or np.array_equal(np.rint(total).astype(dtype), values)
    assert np.abs(bands.scaling(2) - heat(values.astype(float), 2, (1, 1, 2))).max() < (
        1e-5 if dtype == np.float32 else 1e-7
    )


@pytest.mark.filterwarnings("ignore:levels. an rms width")
def test_nothing_crosses_a_wall() -> None:
    values = noise(21, 30)
    kept = np.ones((21, 30), dtype=bool)
    kept[:, 14] = False
    grid = aw.grid(values, mask=kept)
    other = values.copy()
    other[:, 15:] = 1000 * noise(21, 15)
    for sigma in (0.7, 5.0, 100.0):
        first, second = grid.smooth(sigma=sigma), grid.smooth(other, sigma=sigma)
        assert np.abs(first[:, :14] - second[:, :14]).max() < EXACT
        # Each chamber is a grid of its own.
        assert np.abs(first[:, :14] - heat(values[:, :14], sigma)).max() < EXACT
    gaps = np.where(kept, values, np.nan)
    by_gaps = aw.grid(gaps).smooth(sigma=5.0)
    assert np.isnan(by_gaps[~kept]).all() and np.array_equal(np.isnan(by_gaps), ~kept)
    assert np.abs(by_gaps - grid.smooth(sigma=5.0))[kept].max() < EXACT


def test_a_mask_of_all_places_is_none() -> None:
    values = noise(12, 15)
    full = aw.grid(values, mask=np.ones((12, 15)))
    assert full.mask is None and np.array_equal(full.smooth(fwhm=3), aw.grid(values).smooth(fwhm=3))


@pytest.mark.parametrize("with_mask", [False, True])
def test_flips_and_transposes_change_nothing(with_mask: bool) -> None:
    values, spacing = noise(14, 11, 9), (1.0, 0.7, 2.0)
    mask = RANDOM.random((14, 11, 9)) > 0.2 if with_mask else None
    wanted = aw.grid(values, spacing, mask).smooth(fwhm=3)
    for axis in range(3):
        flipped = aw.grid(np.flip(values, axis), spacing, None if mask is None else np.flip(mask, axis)).smooth(fwhm=3)
        assert np.abs(np.flip(flipped, axis) - wanted).max() < EXACT
    for order in ((1, 0, 2), (2, 1, 0), (2, 0, 1)):
        turned = aw.grid(
            values.transpose(order),
            tuple(spacing[axis] for axis in order),
            None if mask is None else mask.transpose(order),
        ).smooth(fwhm=3)
        assert np.abs(turned - wanted.transpose(order)).max() < EXACT


def test_a_periodic_axis_has_no_place_of_its_own() -> None:
    values = noise(16, 24)
    grid = aw.grid(values, periodic=(False, True))
    shifted = grid.smooth(np.roll(values, 7, axis=1), sigma=4)
    assert np.abs(shifted - np.roll(grid.smooth(sigma=4), 7, axis=1)).max() < EXACT
    assert np.abs(grid.smooth(sigma=4) - aw.grid(values).smooth(sigma=4)).max() > 0.01
    wave = np.exp(2j * np.pi * 3 * np.arange(24) / 24).real * np.ones((16, 1))
    factor = np.exp(-(4**2) * (1 - np.cos(2 * np.pi * 3 / 24)))
    assert np.abs(grid.smooth(wave, sigma=4) - factor * wave).max() < EXACT


def test_wide_kernels_are_gaussians() -> None:
    values = noise(120, 100)
    ours, theirs = aw.grid(values).smooth(sigma=8), ndimage.gaussian_filter(values, 8, mode="reflect", truncate=8)
    assert np.abs(ours - theirs).max() < 1e-3 * np.abs(values).max()
    assert np.abs(ours - theirs).max() < 0.02 * np.abs(theirs).max()


def test_channels_are_those_alone() -> None:
    image = noise(18, 25, 3)
    last = aw.grid(image, axes=(0, 1)).smooth(fwhm=3)
    first = aw.grid(image.transpose(2, 0, 1), axes=(1, 2)).smooth(fwhm=3)
    between = aw.grid(image.transpose(0, 2, 1), axes=(0, -1))
    alone = np.stack([aw.grid(image[..., c]).smooth(fwhm=3) for c in range(3)], axis=-1)
    for found in (last, first.transpose(1, 2, 0), between.smooth(fwhm=3).transpose(0, 2, 1)):
        assert np.abs(found - alone).max() < EXACT
    bands = between.decompose(levels=3)
    assert bands.shape == (4, 18, 3, 25) and np.allclose(bands.sum(axis=0), image.transpose(0, 2, 1), atol=1e-12)
    frames = noise(6, 5, 7, 4)
    assert aw.grid(frames, axes=(0, 1, 2)).decompose(sigma=[1]).shape == (2, 6, 5, 7, 4)
    # The order of the axes is that of the spacings.
    turned = aw.grid(image, (2.0, 1.0), axes=(1, 0))
    assert turned.shape == (25, 18)
    assert np.abs(turned.smooth(fwhm=3) - aw.grid(image, (1.0, 2.0), axes=(0, 1)).smooth(fwhm=3)).max() < EXACT


def test_a_channel_is_masked_where_it_is_nan() -> None:
    image = noise(15, 20, 3)
    image[4:7, 5:9, 1] = np.nan
    found = aw.grid(image, axes=(0, 1)).smooth(fwhm=4)
    assert np.array_equal(np.isnan(found), np.isnan(image))
    assert np.abs(found[..., 0] - aw.grid(image[..., 0]).smooth(fwhm=4)).max() < EXACT


# Methods


def test_functions_of_shapes_take_grids() -> None:
    values = noise(20, 30)
    grid = aw.grid(values, spacing=2.0)
    assert np.array_equal(aw.smooth(grid, values, fwhm=5), grid.smooth(fwhm=5))
    assert np.array_equal(aw.smooth(grid, fwhm=5), grid.smooth(fwhm=5))
    assert np.array_equal(aw.decompose(grid, fwhm=[4, 8]), grid.decompose(fwhm=[4, 8]))
    assert np.array_equal(aw.filter(grid, [0, 1, 1], fwhm=[4, 8, 16]), grid.filter([0, 1, 1], fwhm=[4, 8, 16]))
    labels = (np.add.outer(np.arange(20), np.arange(30)) > 25).astype(float)
    labels[3, 3] = 9
    assert 9 not in aw.filter_labels(grid, labels, [0, 0]) and aw.filter_labels(grid, labels, [0, 0]).shape == (20, 30)
    operator = grid.prepare().linear_operator(3)
    f, g = noise(600), noise(600)
    assert g @ operator.matvec(f) == pytest.approx(f @ operator.rmatvec(g))


def test_regions_and_weights_have_the_axes_of_the_grid() -> None:
    values = noise(20, 30)
    grid = aw.grid(values, spacing=(1.0, 2.0))
    inside = np.zeros((20, 30))
    inside[5:9, 10:20] = 1
    for found in (
        grid.filter([0, 0], where=inside),
        grid.filter(aw.Layer([0, 0], inside > 0), levels=2),
        grid.decompose(levels=2).apply([0, 0], where=inside),
        grid.filter([0, 0], where="box:min=4.5 19 -1,max=8.5 39 1,falloff=0.1"),
    ):
        assert np.array_equal(found[inside == 0], values[inside == 0])
        assert (found[inside == 1] != values[inside == 1]).all()
    ball = grid.region("ball:point=10 30 0,radius=4.5")
    assert np.array_equal(ball, aw.region(grid, "ball:point=10 30 0,radius=4.5"))
    rows, columns = np.nonzero(ball)
    assert ball.shape == (20, 30) and (np.hypot(rows - 10, 2 * columns - 30) <= 4.5).all() and len(rows) > 20
    with pytest.raises(ValueError, match=r"where: shape \(30, 20\) is not that of the grid, \(20, 30\)"):
        grid.filter([0, 0], where=inside.T)


def test_gains_of_one_change_nothing_and_of_zero_smooth() -> None:
    values = noise(24, 20)
    grid = aw.grid(values)
    assert np.abs(grid.filter([1, 1, 1]) - values).max() < 1e-12
    smooth = grid.filter([0, 0], sigma=[1, 2])
    assert np.abs(smooth - heat(values, 2)).max() < 1e-7
    slope = np.add.outer(np.arange(24.0), 2 * np.arange(20.0))
    assert np.abs(grid.filter(slope, [0, 0], local_fit="linear") - slope).max() < 1e-6
    assert np.abs(grid.filter(slope, [0, 0]).sum() / slope.sum() - 1) < 1e-9
    assert np.abs(aw.filter(grid, values, [0, 0]) - grid.filter([0, 0])).max() < 1e-12


def test_noise_is_removed_and_steps_are_kept() -> None:
    step = np.where(np.arange(60) < 30, 0.0, 10.0) * np.ones((60, 1))
    clean, info = aw.grid(step + noise(60, 60)).denoise()
    assert 0.8 < info["noise"] < 1.2
    assert np.sqrt(((clean - step) ** 2).mean()) < 0.45
    assert (clean[:, 30] - clean[:, 29]).mean() > 7


def test_saliency_and_features_find_spots() -> None:
    i, j = np.mgrid[:64, :80]
    image = np.exp(-((i - 20) ** 2 + (j - 30) ** 2) / 18) - np.exp(-((i - 45) ** 2 + (j - 60) ** 2) / 18)
    grid = aw.grid(image, spacing=0.5)
    salient = grid.saliency()
    assert salient.shape == (64, 80) and salient.map.shape == (64, 80)
    assert np.unravel_index(salient.argmax(), salient.shape) == (20, 30)
    assert np.unravel_index(salient.argmin(), salient.shape) == (45, 60)
    found = grid.features(best=2, levels=aw.Octaves(8))
    assert {tuple(position) for position in found["position"]} == {(10.0, 15.0, 0.0), (22.5, 30.0, 0.0)}
    per_level = grid.saliency(options=aw.SaliencyOptions(per_level=True)).per_level
    assert all(each.shape == (64, 80) for each in per_level) and len(per_level) > 1


def test_maps_and_noise_are_of_the_places_in_the_mask() -> None:
    mask = np.zeros((30, 40), dtype=bool)
    mask[4:26, 5:20] = True
    values = np.where(mask, noise(30, 40), 1e6)
    grid = aw.grid(values, mask=mask)
    salient = grid.saliency(options=aw.SaliencyOptions(per_level=True))
    assert all(np.array_equal(np.isfinite(each), mask) for each in (salient, *salient.per_level))
    assert mask.ravel()[grid.features()["vertex"]].all()
    clean, info = grid.denoise()
    assert np.array_equal(clean[~mask], values[~mask]) and 0.7 < info["noise"] < 1.3
    bands = grid.decompose(levels=3)
    assert (bands[:-1][:, ~mask] == 0).all() and np.abs(bands.sum(axis=0) - values).max() < 1e-9
    unknown = aw.grid(np.where(mask, values, np.nan)).smooth(fwhm=3)
    assert np.allclose(unknown[mask], grid.smooth(fwhm=3)[mask], atol=EXACT) and np.isnan(unknown[~mask]).all()


def test_volumes_have_features() -> None:
    at = np.mgrid[:24, :24, :24]
    spacing = np.array([1.0, 1.0, 2.0])
    away = spacing.reshape(3, 1, 1, 1) * (at - np.array([8, 12, 15]).reshape(3, 1, 1, 1))
    found = aw.grid(np.exp(-(away**2).sum(axis=0) / 8), spacing).features(levels=aw.Octaves(7))
    assert found["position"].tolist() == [[8.0, 12.0, 30.0]] and abs(found["sigma"][0] - 2) < 0.2


def test_number_types_are_kept_on_request() -> None:
    image = (255 * RANDOM.random((16, 20))).astype(np.uint8)
    kept = aw.grid(image, keep_dtype=True)
    smooth = kept.smooth(fwhm=3)
    assert smooth.dtype == np.uint8 and np.array_equal(smooth, np.rint(aw.grid(image).smooth(fwhm=3)))
    assert kept.smooth(image.astype(np.float32), fwhm=3).dtype == np.float32
    assert aw.grid(image).smooth(fwhm=3).dtype == np.float64
    assert aw.grid(image > 99, keep_dtype=True).smooth(fwhm=3).dtype == bool
    with pytest.raises(ValueError, match=r"does not fit into uint8, 0 to 255; .*np\.clip\(result, 0, 255\)"):
        kept.filter([9, 9])
    gaps = np.ma.masked_array(image, image > 200)
    masked = aw.grid(gaps, keep_dtype=True).smooth(fwhm=3)
    assert masked.dtype == np.uint8 and np.array_equal(masked[image > 200], image[image > 200])
    assert np.isnan(aw.grid(gaps).smooth(fwhm=3)[image > 200]).all()


def test_numbers_that_stand_for_no_value_are_masked() -> None:
    heights = 100 + noise(20, 30)
    heights[2:5, 3:9] = -9999
    with pytest.warns(UserWarning, match="-9999"):
        found = aw.grid(heights.astype(np.float32)).smooth(fwhm=4)
    assert np.array_equal(np.isnan(found), heights == -9999) and np.nanmin(found) > 90


def test_a_grid_is_itself_again() -> None:
    image = noise(9, 12, 2)
    grid = aw.grid(image, (1.0, 2.0), image[..., 0] > -1, (True, False), axes=(0, 1))
    for other in (pickle.loads(pickle.dumps(grid)), copy.deepcopy(grid)):
        assert repr(other) == repr(grid) and np.array_equal(other.smooth(fwhm=2), grid.smooth(fwhm=2))
    prepared = pickle.loads(pickle.dumps(grid.prepare().with_mask(image[..., 0] > 1)))
    assert np.isnan(prepared.smooth(image, 3)[image[..., 0] > 1]).all()
    assert "9 × 12 places, spacing 1 × 2, 2 channels" in repr(grid) and "periodic along 0" in repr(grid)
    assert grid.mask is not None and grid.mask.shape == (9, 12) and grid.axes == (0, 1) and grid.ndim == 2
    assert grid.decompose(levels=2).to_xarray().dims == ("level", "i", "j", "channel")


def test_the_same_bits_on_any_number_of_threads() -> None:
    image = noise(80, 90)
    grid = aw.grid(image, mask=image > -2)
    with aw.threads(1):
        one = [grid.smooth(fwhm=5), aw.grid(image).smooth(fwhm=5)]
    with aw.threads(3):
        three = [grid.smooth(fwhm=5), aw.grid(image).smooth(fwhm=5)]
    assert all(np.array_equal(a, b) for a, b in zip(one, three, strict=True))


def test_sizes_of_one_and_orders_in_memory() -> None:
    values = noise(1, 30)
    assert np.allclose(aw.grid(values).smooth(fwhm=3), aw.grid(values[0]).smooth(fwhm=3), atol=EXACT)
    image = noise(20, 30)
    wanted = aw.grid(image).smooth(fwhm=3)
    assert np.array_equal(aw.grid(np.asfortranarray(image)).smooth(fwhm=3), wanted)
    assert np.array_equal(aw.grid(image[::-1, ::-1]).smooth(fwhm=3)[::-1, ::-1].round(9), wanted.round(9))
    assert np.array_equal(aw.grid(image.astype(">f8")).smooth(fwhm=3), wanted)
    assert np.array_equal(aw.grid(image.tolist()).smooth(fwhm=3), wanted)
    assert aw.grid([[0.0, 1.0], [2.0, 3.0]]).shape == (2, 2)
    assert aw.grid(np.ones(1)).smooth(fwhm=1).tolist() == [1.0]


# Objects of other libraries


def test_no_library_is_imported_before_its_objects() -> None:
    code = (
        "import sys, numpy as np, adwave as aw; aw.grid(np.zeros((5, 6))).smooth(fwhm=2); "
        "print([n for n in ('xarray', 'nibabel', 'SimpleITK', 'pyvista', 'rasterio', 'scipy') if n in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_data_arrays() -> None:
    xarray = pytest.importorskip("xarray")
    values = noise(20, 30)
    field = xarray.DataArray(
        values,
        dims=("lat", "lon"),
        coords={"lat": np.linspace(80, -80, 20), "lon": 12.0 * np.arange(30)},
        name="t2m",
        attrs={"units": "K"},
    )
    grid = aw.grid(field, periodic=(False, True))
    assert grid.spacing == pytest.approx((160 / 19, 12.0))
    smooth = grid.smooth(fwhm=40)
    assert isinstance(smooth, xarray.DataArray) and smooth.dims == field.dims and smooth.attrs == field.attrs
    assert smooth.coords.equals(field.coords) and smooth.name == "t2m"
    wanted = aw.grid(values, (160 / 19, 12.0), periodic=(False, True)).smooth(fwhm=40)
    assert np.array_equal(smooth.values, wanted)
    assert isinstance(grid.denoise().result, xarray.DataArray)
    assert isinstance(grid.smooth(values, fwhm=40), np.ndarray)
    assert aw.grid(field.drop_vars("lat")).spacing == (1.0, 12.0)
    cube = xarray.concat([field, field + 1], "time").assign_coords(time=np.array(["2020", "2021"], "datetime64[ns]"))
    named = aw.grid(cube, axes=("lat", "lon"))
    assert named.shape == (20, 30) and named.smooth(fwhm=40).dims == ("time", "lat", "lon")
    with pytest.raises(ValueError, match=r"aw\.grid\(array, axes=\('lat', 'lon'\)\)"):
        aw.grid(cube)
    with pytest.raises(ValueError, match=r"'x' is no dimension; the DataArray has time, lat, lon"):
        aw.grid(cube, axes="x")
    with pytest.raises(ValueError, match=r"steps of 1 to 5, .*interpolate it"):
        aw.grid(xarray.DataArray(noise(3), dims="x", coords={"x": [0.0, 1.0, 6.0]}))
    with pytest.raises(TypeError, match=r"aw\.grid\(dataset\['name'\]\)"):
        aw.grid(field.to_dataset())


def test_nibabel_images() -> None:
    nibabel = pytest.importorskip("nibabel")
    values = noise(12, 14, 10).astype(np.float32)
    affine = np.array([[0, -1.5, 0, 90], [0.8, 0, 0, -70], [0, 0, 3.0, 5], [0, 0, 0, 1]])
    image = nibabel.Nifti1Image(values, affine)
    grid = aw.grid(image)
    assert grid.spacing == pytest.approx((0.8, 1.5, 3.0)) == image.header.get_zooms()
    smooth = grid.smooth(fwhm=6)
    assert isinstance(smooth, nibabel.Nifti1Image) and np.array_equal(smooth.affine, affine)
    assert np.array_equal(smooth.get_fdata(), aw.grid(values, grid.spacing).smooth(fwhm=6))
    assert aw.grid(image, keep_dtype=True).smooth(fwhm=6).get_data_dtype() == np.float32
    mask = nibabel.Nifti1Image((values > -1).astype(np.uint8), affine)
    inside = aw.grid(image, mask=mask)
    assert inside.mask is not None and np.array_equal(inside.mask, values > -1)
    with pytest.raises(ValueError, match=r"mask: its affine differs .*resample_to_img"):
        aw.grid(image, mask=nibabel.Nifti1Image(np.ones((12, 14, 10), np.uint8), np.eye(4)))
    frames = nibabel.Nifti1Image(noise(6, 7, 5, 3), np.diag([2.0, 2.0, 2.0, 1.0]))
    assert aw.grid(frames).shape == (6, 7, 5) and aw.grid(frames).smooth(fwhm=4).shape == (6, 7, 5, 3)
    sheared = affine.copy()
    sheared[0, 2] = 1.0
    with pytest.warns(UserWarning, match="sheared") as caught:
        aw.grid(nibabel.Nifti1Image(values, sheared))
    assert caught[0].filename == __file__
    integers = nibabel.Nifti1Image((1000 * values).astype(np.int16), affine)
    again = nibabel.Nifti1Image.from_bytes(aw.grid(integers).smooth(fwhm=6).to_bytes())
    assert np.allclose(again.get_fdata(), aw.grid(integers.get_fdata(), grid.spacing).smooth(fwhm=6))
    few = aw.grid(nibabel.Nifti1Image(noise(9, 8, 3), np.eye(4)))
    assert few.shape == (9, 8, 3)


def test_simpleitk_images() -> None:
    sitk = pytest.importorskip("SimpleITK")
    values = noise(10, 12, 14)
    image = sitk.GetImageFromArray(values)
    image.SetSpacing((0.5, 1.0, 2.5))
    image.SetOrigin((3.0, 4.0, 5.0))
    grid = aw.grid(image)
    assert grid.shape == (10, 12, 14) and grid.spacing == (2.5, 1.0, 0.5)
    smooth = grid.smooth(fwhm=3)
    assert isinstance(smooth, sitk.Image)
    assert smooth.GetSpacing() == (0.5, 1.0, 2.5) and smooth.GetOrigin() == (3.0, 4.0, 5.0)
    assert np.array_equal(sitk.GetArrayFromImage(smooth), aw.grid(values, (2.5, 1.0, 0.5)).smooth(fwhm=3))
    color = sitk.GetImageFromArray((255 * RANDOM.random((20, 30, 3))).astype(np.uint8), isVector=True)
    found = aw.grid(color, keep_dtype=True).smooth(fwhm=3)
    assert found.GetSize() == (30, 20) and found.GetPixelIDTypeAsString() == color.GetPixelIDTypeAsString()


def test_pyvista_grids() -> None:
    pyvista = pytest.importorskip("pyvista")
    image = pyvista.ImageData(dimensions=(6, 5, 4), spacing=(0.5, 1.0, 2.0), origin=(7, 8, 9))
    image["heat"] = noise(120)
    grid = aw.grid(image)
    assert grid.shape == (4, 5, 6) and grid.spacing == (2.0, 1.0, 0.5)
    smooth = grid.smooth(fwhm=2)
    assert isinstance(smooth, pyvista.ImageData) and smooth.origin == (7, 8, 9) and smooth.spacing == (0.5, 1.0, 2.0)
    wanted = aw.grid(np.asarray(image["heat"]).reshape(4, 5, 6), (2.0, 1.0, 0.5), axes=(0, 1, 2)).smooth(fwhm=2)
    assert np.array_equal(np.asarray(smooth["heat"]).reshape(4, 5, 6), wanted)
    assert not np.array_equal(image["heat"], smooth["heat"])
    # The first axis is the fastest.
    x = np.asarray(image.points[:, 0]).reshape(4, 5, 6)
    assert (np.diff(x, axis=2) == 0.5).all()
    cells = pyvista.ImageData(dimensions=(6, 5, 1))
    cells.cell_data["class"] = noise(20)
    assert aw.grid(cells).shape == (4, 5) and aw.grid(cells).smooth(fwhm=2).cell_data["class"].shape == (20,)
    cells.cell_data["other"] = noise(20)
    cells.set_active_scalars(None)
    with pytest.raises(ValueError, match=r"'class', 'other', .*image\.set_active_scalars\('class'\)"):
        aw.grid(cells)


def test_rasters() -> None:
    rasterio = pytest.importorskip("rasterio")
    heights = (100 + noise(1, 20, 30)).astype(np.float32)
    heights[0, 3:6, 4:9] = -9999
    profile = {
        "driver": "GTiff",
        "width": 30,
        "height": 20,
        "count": 1,
        "dtype": "float32",
        "nodata": -9999,
        "crs": "EPSG:32633",
        "transform": rasterio.transform.from_origin(5e5, 4e6, 10.0, 20.0),
    }
    with rasterio.MemoryFile() as memory:
        with memory.open(**profile) as out:
            out.write(heights)
        with memory.open() as dataset:
            grid = aw.grid(dataset)
            assert grid.shape == (20, 30) and grid.spacing == (20.0, 10.0)
            found = grid.smooth(fwhm=60)
            kept = aw.grid(dataset, keep_dtype=True).smooth(fwhm=60)
    assert kept.dtype == np.float32
    assert found.shape == (1, 20, 30) and np.array_equal(np.isnan(found), heights == -9999)


# Messages

IMAGE = noise(8, 9)
RGB = noise(8, 9, 3)


@pytest.mark.parametrize(
    ("call", "line"),
    [
        (lambda: aw.grid(IMAGE, spacing=0), r"spacing=\(1\.0, 1\.0\)\), got 0 along axis 0"),
        (lambda: aw.grid(IMAGE, spacing=(1.0, np.nan)), r"spacing=\(1\.0, 1\.0\)\), got nan along axis 1"),
        (lambda: aw.grid(IMAGE, spacing=(1.0, -2.0)), "got -2 along axis 1"),
        (lambda: aw.grid(IMAGE, spacing=(1, 1, 1)), r"got 3 numbers, .* has 2 axes; .*spacing=\(1\.0, 1\.0\)"),
        (lambda: aw.grid(IMAGE, spacing="1mm"), r"aw\.grid\(array, spacing=\(1\.0, 1\.0\)\), got '1mm'"),
        (lambda: aw.grid(IMAGE, mask=IMAGE[:5] > 0), r"mask: shape \(5, 9\) is not that of the grid, \(8, 9\)"),
        (lambda: aw.grid(IMAGE, mask=IMAGE.T > 0), r"aw\.grid\(array, mask=mask\.T\)"),
        (lambda: aw.grid(IMAGE, mask=np.zeros((8, 9))), r"leaves out every place, .*aw\.grid\(array, mask=~mask\)"),
        (lambda: aw.grid(IMAGE, mask=np.full((8, 9), np.nan)), r"mask=np\.nan_to_num\(mask\) > 0"),
        (lambda: aw.grid(IMAGE, periodic=(True,)), r"aw\.grid\(array, periodic=\(False, True\)\)"),
        (lambda: aw.grid(IMAGE, periodic="wrap"), r"periodic must be True or False, .*got 'wrap'"),
        (lambda: aw.grid(IMAGE + 1j), r"pass abs\(array\), .*np\.stack\(\[array\.real, array\.imag\], axis=-1\)"),
        (lambda: aw.grid(IMAGE.astype(object)), r"array\.astype\(float\)"),
        (lambda: aw.grid(np.zeros(3, dtype=[("a", "f8")])), r"array\['a'\]"),
        (
            lambda: aw.grid(noise(3, 4, 5, 6)),
            r"aw\.grid\(array, axes=\(0, 1, 2\)\).*aw\.grid\(array, axes=\(1, 2, 3\)\)",
        ),
        (
            lambda: aw.grid(RGB),
            r"aw\.grid\(array, axes=\(0, 1\)\) for the image or aw\.grid\(array, axes=\(0, 1, 2\)\)",
        ),
        (lambda: aw.grid(RGB.transpose(2, 0, 1)), r"aw\.grid\(array, axes=\(1, 2\)\) for the image"),
        (lambda: aw.grid(RGB, axes=(0, 3)), r"such as axes=\(0, 1\), got \(0, 3\)"),
        (lambda: aw.grid(RGB, axes=(0, 0)), r"different axes"),
        (lambda: aw.grid(RGB, axes="yx"), r"such as axes=\(0, 1\), got 'yx'"),
        (lambda: aw.grid((64, 64)), r"aw\.grid\(np\.zeros\(\(64, 64\)\)\) for a grid of these sizes"),
        (lambda: aw.grid([[1.0, 2.0], [3.0]]), "row 1 has 1 entries, but row 0 has 2"),
        (lambda: aw.grid(np.zeros((0, 5))), r"has no places; .*aw\.grid\(np\.zeros\(\(64, 64\)\)\)"),
        (lambda: aw.grid(3.0), r"a single number is no grid; .*aw\.grid\(np\.zeros\(\(64, 64\)\)\)"),
        (lambda: aw.grid("brain.nii.gz"), r'write import nibabel; aw\.grid\(nibabel\.load\("brain\.nii\.gz"\)\)'),
        (lambda: aw.grid("brain.txt"), r"aw\.grid\(nibabel\.load\(path\)\)"),
        (lambda: aw.grid(None), r"aw\.grid\(np\.zeros\(\(64, 64\)\)\)"),
        (lambda: aw.grid(IMAGE).smooth(4.0), r"write aw\.grid\(IMAGE\)\.smooth\(sigma=4\.0\)"),
        (lambda: aw.grid(IMAGE).smooth(), r"write aw\.grid\(IMAGE\)\.smooth\(sigma=2\)"),
        (lambda: aw.grid(IMAGE).smooth(fwhm=2, sigma=1), "sigma and another"),
        (
            lambda: aw.grid(IMAGE).smooth(sigma=(1, 2, 3)),
            "got 3 numbers for 2 axes; give one number, or one for each axis",
        ),
        (lambda: aw.grid(IMAGE).smooth(sigma=0), r"sigma=2\.0, got 0"),
        (lambda: aw.grid(IMAGE).smooth(sigma="2%"), r'fwhm="2%"'),
        (lambda: aw.grid(IMAGE).smooth(IMAGE.T, fwhm=2), r"does not fit the grid, \(8, 9\).*pass signal\.T"),
        (lambda: aw.grid(IMAGE).smooth(IMAGE[:4], fwhm=2), r"give \(8, 9\), or \(8, 9, 3\) with channels"),
        (
            lambda: aw.grid(IMAGE).smooth(np.where(IMAGE > 1, np.inf, 0), fwhm=2),
            r"np\.isinf\(signal\), np\.nan, signal",
        ),
        (lambda: aw.grid(np.full((8, 9), np.nan)).smooth(fwhm=2), "NaN|no value"),
        (lambda: aw.grid(IMAGE).smooth("height", fwhm=2), r"no named signals, got 'height'; .*shape \(8, 9\)"),
        (lambda: aw.grid(IMAGE).decompose(sigmas=[1, 2]), r"that is sigma=\[1, 2\]"),
        (lambda: aw.render(aw.grid(IMAGE), IMAGE), r"a grid has no surface.*grid\.smooth\(fwhm=8\)"),
        (lambda: aw.grid(IMAGE).decompose(sigma=[1, 2], fwhm=[2, 4]), "given twice, by sigma"),
        (lambda: aw.grid(IMAGE).filter([0, 1, 1], where=IMAGE[:3]), r"where: shape \(3, 9\) is not that of the grid"),
        (lambda: aw.decompose(RGB), r"write aw\.decompose\(aw\.grid\(RGB, axes=\(0, 1\)\)\)"),
    ],
)
def test_messages_contain_the_line_that_works(call: Any, line: str) -> None:
    with pytest.raises((TypeError, ValueError), match=line) as caught:
        call()
    assert "\n" not in str(caught.value)
