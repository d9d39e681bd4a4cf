"""Directions and tensors: laws that hold on any surface, and the functions beside independent numbers."""

from __future__ import annotations

import pickle

import adwave as aw
import numpy as np
import pytest

RANDOM = np.random.default_rng(3)


@pytest.fixture(scope="module")
def ball() -> aw.Shape:
    return aw.sample("sphere", vertices=1500)


@pytest.mark.parametrize("symmetry", [1, 2, 4])
def test_bands_sum_and_filters_are_sums_of_bands(ball: aw.Shape, symmetry: int) -> None:
    field = aw.vectors(ball, RANDOM.normal(size=(1500, 3)), symmetry=symmetry)
    bands = field.decompose(levels=5)
    np.testing.assert_allclose(bands.sum(axis=0), field.complex, atol=1e-13)
    gains = [0.0, 0.5, 1.0, 2.0, 1.0]
    expected = (np.array([*gains, 1.0])[:, None] * bands).sum(axis=0)
    np.testing.assert_allclose(field.filter(gains).complex, expected, atol=1e-8)
    np.testing.assert_allclose(field.from_complex(bands[-1]).complex, bands[-1])
    np.testing.assert_allclose(np.abs(field.complex), np.linalg.norm(field.values, axis=1))
    part = field.filter([0.0] * 5, where="half-space:point=0 0 0,normal=0 0 1")
    below = ball.points[:, 2] < 0
    np.testing.assert_array_equal(part.complex[below], field.complex[below])
    assert not np.allclose(part.complex[~below], field.complex[~below])


def test_rotation_of_a_sphere_decays_as_its_eigenvalue(ball: aw.Shape) -> None:
    field = aw.vectors(ball, np.cross([0, 0, 1], ball.points))
    fwhm = 0.8
    time = (fwhm / 1.6651) ** 2 / 4  # the kernel exp(−d²/σ²) of heat after t = σ²/4
    kept = np.vdot(field.complex, field.smooth(fwhm=fwhm).complex).real / np.vdot(field.complex, field.complex).real
    assert kept == pytest.approx(np.exp(-time), abs=2e-3)


def test_a_plane_is_smoothed_as_two_scalars() -> None:
    plane = aw.sample("plane", vertices=900)
    flat = aw.Shape(plane.points * [1, 0, 1], plane.faces)
    v = RANDOM.normal(size=(flat.n_vertices, 3)) * [1, 0, 1]
    smooth = aw.vectors(flat, v).smooth(fwhm="10%").values
    np.testing.assert_allclose(smooth, aw.smooth(flat, v, fwhm="10%", operator="surface"), atol=1e-9)


def test_lines_do_not_know_their_sign_and_crosses_no_quarter_turn(ball: aw.Shape) -> None:
    v = np.cross(ball.points, RANDOM.normal(size=3))
    signs = RANDOM.choice([-1.0, 1.0], size=(1500, 1))
    one, other = (aw.vectors(ball, w, symmetry=2).smooth(steps=20).complex for w in (v, signs * v))
    np.testing.assert_allclose(one, other, atol=1e-12)
    planes = aw.vectors(ball, v).planes
    normals = np.cross(planes[:, 0], planes[:, 1])
    turned = np.cross(normals, v)
    one, other = (aw.vectors(ball, w, symmetry=4).smooth(steps=20).complex for w in (v, turned))
    np.testing.assert_allclose(one, other, atol=1e-9)


def test_vertices_without_a_vector_are_masked(ball: aw.Shape) -> None:
    v = np.cross([0, 0, 1], ball.points)
    v[::9] = np.nan
    smooth = aw.vectors(ball, v).smooth(steps=10).values
    np.testing.assert_array_equal(np.isnan(smooth).any(axis=1), np.isnan(v).any(axis=1))


def test_arguments_that_do_not_fit_say_what_must_hold(ball: aw.Shape) -> None:
    with pytest.raises(ValueError, match=r"three numbers for each of 1500 vertices.*got shape \(1500,\)"):
        aw.vectors(ball, ball.points[:, 0])
    with pytest.raises(ValueError, match="symmetry must be 1"):
        aw.vectors(ball, ball.points, symmetry=3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="tangent planes of a mesh or a point cloud"):
        aw.vectors(aw.graph(3, [[0, 1], [1, 2]]), np.ones((3, 3)))
    with pytest.raises(ValueError, match="order must be 'upper'"):
        aw.tensors(ball, np.ones((1500, 6)), order="dti")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="6 numbers or 3 × 3 for each of 1500 places"):
        aw.tensors(ball, np.ones((1500, 5)))
    cloud = aw.vectors(aw.Shape(ball.points), ball.points)
    with pytest.raises(ValueError, match="singularities are counted on a mesh"):
        cloud.singularities()


def positive(sizes: tuple[int, ...]) -> np.ndarray:
    roots = RANDOM.normal(size=(*sizes, 3, 3))
    return roots @ np.swapaxes(roots, -1, -2) + 0.1 * np.eye(3)


def test_tensors_of_a_volume_are_smoothed_by_their_logarithms() -> None:
    matrices = positive((7, 6, 5))
    matrices[0, 0, 0] = 0
    matrices[1, 0, 0] = np.diag([-1.0, 1, 1])
    grid = aw.grid(np.zeros((7, 6, 5)), spacing=(1.0, 2.0, 2.0))
    field = aw.tensors(grid, matrices)
    assert field.n_not_positive == 1
    smooth = field.smooth(fwhm=4).matrices
    assert np.isnan(smooth[:2, 0, 0]).all()
    known = ~np.isnan(smooth[..., 0, 0])
    assert np.linalg.eigvalsh(smooth[known]).min() > 0
    log_det = np.full((7, 6, 5), np.nan)
    is_positive = np.linalg.eigvalsh(matrices).min(axis=-1) > 0
    log_det[is_positive] = np.linalg.slogdet(matrices[is_positive])[1]
    np.testing.assert_allclose(np.linalg.slogdet(smooth[known])[1], grid.smooth(log_det, fwhm=4)[known], atol=1e-9)
    again = aw.tensors(grid, field.values)
    np.testing.assert_allclose(again.values, field.values, atol=1e-12)
    upper = matrices[..., [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]]
    mrtrix = upper[..., [0, 3, 5, 1, 2, 4]]
    np.testing.assert_allclose(aw.tensors(grid, mrtrix, order="diagonal").matrices, field.matrices, atol=1e-12)
    gained = field.filter([0.0, 0.0], levels=2)
    assert np.linalg.eigvalsh(gained.matrices[known]).min() > 0


def test_tensors_of_a_surface_are_a_trace_and_a_line(ball: aw.Shape) -> None:
    planes = aw.vectors(ball, ball.points).planes
    u, w = planes[:, 0], planes[:, 1]
    matrices = 3 * u[:, :, None] * u[:, None, :] + w[:, :, None] * w[:, None, :]
    field = aw.tensors(ball, matrices)
    assert field.normal_share < 1e-12
    np.testing.assert_allclose(field.matrices, matrices, atol=1e-12)
    smooth = field.smooth(steps=5).matrices
    np.testing.assert_allclose(np.trace(smooth, axis1=1, axis2=2), 4, atol=1e-9)
    calm = field.filter([0.0, 1.0], levels=2)
    assert calm.values.shape == (1500, 6)


def test_the_operator_of_directions_is_pickled(ball: aw.Shape) -> None:
    field = aw.vectors(ball, ball.points[:, [1, 2, 0]])
    numbers = field.complex.view(np.float64).reshape(-1, 2)
    again = pickle.loads(pickle.dumps(field.decomposer))
    np.testing.assert_array_equal(again.smooth(numbers, steps=3), field.decomposer.smooth(numbers, steps=3))


def test_noise_of_directions_is_found_and_goes():
    ball = aw.sample("sphere", vertices=3000)
    truth = aw.vectors(ball, np.cross([0, 0, 1], ball.points))
    rng = np.random.default_rng(5)
    noisy = truth.from_complex(truth.complex + 0.2 * (rng.normal(size=3000) + 1j * rng.normal(size=3000)))
    calm, info = noisy.denoise()
    assert isinstance(calm, aw.VectorField) and abs(info["noise"] - 0.2) < 0.01
    error = np.abs(calm.complex - truth.complex)
    assert np.sqrt((error**2).mean()) < 0.25 * 0.2 * np.sqrt(2)
    same = noisy.denoise(noise=0.2, strength=0)
    np.testing.assert_array_equal(same.result.complex, noisy.complex)
    # A vector that is unknown stays unknown, and its neighbors lose their noise.
    holes = noisy.values
    holes[7] = np.nan
    calm = aw.vectors(ball, holes).denoise().result.values
    assert np.isnan(calm[7]).all() and np.isfinite(np.delete(calm, 7, axis=0)).all()


def test_noise_of_tensors_goes():
    rng = np.random.default_rng(6)
    logs = 0.2 * rng.normal(size=(10, 10, 10, 3, 3))
    truth = np.diag([2.0, 1.0, 0.5])
    noisy = np.einsum(
        "ij,...jk,kl->...il", np.sqrt(truth), np.eye(3) + 0.1 * (logs + logs.swapaxes(-1, -2)), np.sqrt(truth)
    )
    calm, info = aw.tensors(aw.grid(np.zeros((10, 10, 10)), spacing=2.0), noisy).denoise()
    assert len(info["groups"]) == 6
    assert np.abs(calm.matrices - truth).mean() < 0.3 * np.abs(noisy - truth).mean()
    ball = aw.sample("sphere", vertices=1500)
    strain = np.eye(3) - ball.points[:, :, None] * ball.points[:, None, :]
    rough = strain + 0.2 * rng.normal(size=(1500, 1, 1)) * strain
    calm, info = aw.tensors(ball, rough).denoise()
    assert len(info["groups"]) == 2
    assert np.abs(calm.matrices - strain).mean() < 0.3 * np.abs(rough - strain).mean()


def test_bands_of_tensors_sum_to_what_they_are_taken_of():
    rng = np.random.default_rng(7)
    roots = rng.normal(size=(5, 6, 7, 3, 3)) + 3 * np.eye(3)
    matrices = roots @ roots.swapaxes(-1, -2)
    sizes, frames = np.linalg.eigh(matrices)
    logarithms = np.einsum("...ij,...j,...kj->...ik", frames, np.log(sizes), frames)
    field = aw.tensors(aw.grid(np.zeros((5, 6, 7)), spacing=2.0), matrices, order="diagonal")
    bands = field.decompose(levels=3)
    expected = logarithms[..., [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    assert bands.shape == (4, 5, 6, 7, 6)
    np.testing.assert_allclose(bands.sum(axis=0), expected, atol=1e-10)
    text = repr(aw.vectors(aw.sample("sphere", vertices=500), np.ones((500, 3))).singularities())
    assert text.startswith("<adwave.Singularities: ") and "sum to 2" in text
