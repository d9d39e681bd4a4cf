"""Bands by sparse products of PyTorch; the device of these tests is the CPU."""

from __future__ import annotations

import adwave as aw
import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="PyTorch is not installed")

SPHERE = aw.sample("sphere", vertices=60)
WALK = aw.Decomposer(SPHERE, operator="walk")
POINTS = np.array(SPHERE.points)
WELDED = aw.Decomposer(aw.Shape(np.vstack([POINTS, POINTS[:5]]), SPHERE.faces), operator="walk")


def signal(walk: aw.Decomposer, *channels: int, dtype: torch.dtype = torch.float64) -> torch.Tensor:
    generator = torch.Generator().manual_seed(3)
    return torch.rand((walk.n_vertices, *channels), dtype=dtype, generator=generator)


@pytest.mark.parametrize("walk", [WALK, WELDED])
@pytest.mark.parametrize("levels", [1, 4, aw.Steps([1, 3, 700])])
def test_the_device_has_the_bands_of_the_library(walk: aw.Decomposer, levels: aw.LevelsLike) -> None:
    f = signal(walk, 3) + 1e3
    found = aw.torch.bands(walk, f, levels, device="cpu")
    np.testing.assert_allclose(found, aw.torch.bands(walk, f, levels), atol=1e-11)
    np.testing.assert_allclose(found.sum(0), f, rtol=1e-14)


def test_single_precision_is_measured_and_refused_where_it_falls_short() -> None:
    f = signal(WALK, 5, dtype=torch.float32)
    found = aw.torch.bands(WALK, f, 4, accuracy=1e-4, device="cpu")
    assert found.dtype == torch.float32
    exact = WALK.decompose(f.double().numpy(), levels=4)
    for own, expected in zip(found[:-1].double().numpy(), np.asarray(exact)[:-1], strict=True):
        error = np.linalg.norm(own - expected) / np.linalg.norm(expected)
        assert 1e-9 < error < 1e-4
    with pytest.raises(ValueError, match=r"error of a band on cpu is .* accuracy=1e-10 was asked for"):
        aw.torch.bands(WALK, f, 4, device="cpu")


@pytest.mark.parametrize("doubled", [0, 3])
def test_derivatives_on_the_device(doubled: int) -> None:
    small = aw.sample("sphere", vertices=12)
    points = np.array(small.points)
    walk = aw.Decomposer(aw.Shape(np.vstack([points, points[:doubled]]), small.faces), operator="walk")
    f = signal(walk).requires_grad_()

    def bands(f: torch.Tensor) -> torch.Tensor:
        return aw.torch.bands(walk, f, 2, accuracy=1e-8, device="cpu")

    assert torch.autograd.gradcheck(bands, f)
    assert torch.autograd.gradgradcheck(bands, f)


def test_shapes_of_batches_and_constants() -> None:
    assert aw.torch.bands(WALK, signal(WALK), 2, device="cpu").shape == (3, 60)
    assert aw.torch.bands(WALK, signal(WALK, 2).movedim(0, 1), 2, device="cpu").shape == (3, 2, 60)
    constant = aw.torch.bands(WALK, torch.full((60, 2), 3.0, dtype=torch.float64), 2, device="cpu")
    assert (constant[:-1] == 0).all() and (constant[-1] == 3).all()


def test_heat_and_slow_powers_are_refused() -> None:
    heat = aw.Decomposer(SPHERE, operator="surface")
    with pytest.raises(ValueError, match="device needs the walk"):
        aw.torch.bands(heat, signal(heat), 2, device="cpu")
    with pytest.raises(ValueError, match="converge slowly"):
        aw.torch.bands(WALK, signal(WALK), aw.Steps([0.5]), device="cpu")
    with pytest.raises(TypeError, match="floats"):
        aw.torch.bands(WALK, torch.ones(60, dtype=torch.int64), 2, device="cpu")
