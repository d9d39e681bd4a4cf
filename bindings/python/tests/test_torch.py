"""Gradients of bands in PyTorch: any number of times, of gains, under transforms, and in batches."""

from __future__ import annotations

import time

import adwave as aw
import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="PyTorch is not installed")

#: Accuracy at which finite differences see the function itself.
ACCURACY = 1e-12
WALK = aw.Decomposer(aw.sample("sphere", vertices=60), operator="walk")
HEAT = aw.Decomposer(aw.sample("sphere", vertices=60), operator="surface")
POINTS = np.array(aw.sample("sphere", vertices=60).points)
WELDED = aw.Decomposer(aw.Shape(np.vstack([POINTS, POINTS[:5]]), aw.sample("sphere", vertices=60).faces))


def signal(walk: aw.Decomposer, *channels: int) -> torch.Tensor:
    generator = torch.Generator().manual_seed(3)
    shape = (walk.n_vertices, *channels)
    return torch.rand(shape, dtype=torch.float64, generator=generator).requires_grad_()


def functions(walk: aw.Decomposer) -> list:
    return [
        lambda f: aw.torch.smooth(walk, f, 3, accuracy=ACCURACY),
        lambda f: aw.torch.combine_bands(walk, f, [2.0, -1.0], [1, 4], accuracy=ACCURACY),
        lambda f: aw.torch.bands(walk, f, 3, accuracy=ACCURACY),
        lambda f: aw.torch.bands(walk, f, aw.Steps([0.5, 2.5]), accuracy=ACCURACY),
    ]


@pytest.mark.parametrize("walk", [WALK, HEAT, WELDED])
def test_first_and_second_derivatives(walk: aw.Decomposer) -> None:
    f = signal(walk, 2)
    for function in functions(walk):
        assert torch.autograd.gradcheck(function, f)
        assert torch.autograd.gradgradcheck(function, f)
        # A linear function alone has a second derivative of 0; a gradient penalty has not.
        assert torch.autograd.gradgradcheck(lambda f, function=function: function(f) ** 3, f)


def test_values_are_those_of_decompose() -> None:
    f = signal(WALK, 2)
    expected = WALK.decompose(f.detach().numpy(), levels=4)
    np.testing.assert_allclose(aw.torch.bands(WALK, f, 4).detach(), expected, atol=1e-12)
    np.testing.assert_allclose(aw.torch.smooth(WALK, f, 3).detach(), WALK.smooth(f.detach().numpy(), 3), atol=1e-12)
    by_width = aw.torch.bands(aw.Decomposer(WALK.shape), f, aw.Widths(fwhm=[0.5])).detach()
    expected = aw.decompose(WALK.shape, f.detach().numpy(), fwhm=[0.5])
    np.testing.assert_allclose(by_width, expected, atol=1e-12)


def test_gains_have_gradients() -> None:
    f = signal(WALK, 2)
    gains = torch.tensor([0.5, 2.0, 1.5], dtype=torch.float64, requires_grad=True)
    per_vertex = torch.rand(3, WALK.n_vertices, dtype=torch.float64).requires_grad_()
    for g in (gains, per_vertex):
        assert torch.autograd.gradcheck(lambda f, g: aw.torch.filter(WALK, f, g, accuracy=ACCURACY), (f, g))
        assert torch.autograd.gradgradcheck(lambda f, g: aw.torch.filter(WALK, f, g, accuracy=ACCURACY), (f, g))
    assert torch.autograd.gradcheck(
        lambda f, g: aw.torch.combine_bands(WALK, f, g, [1, 2, 4], accuracy=ACCURACY), (f, gains)
    )
    edited = aw.torch.filter(WALK, f, gains).detach().numpy()
    expected = WALK.decompose(f.detach().numpy(), levels=3).apply([0.5, 2.0, 1.5])
    np.testing.assert_allclose(edited, expected, atol=1e-12)


def test_functional_transforms() -> None:
    from torch import func

    f = signal(WALK).detach()
    for function in functions(WALK):

        def loss(f: torch.Tensor, function=function) -> torch.Tensor:
            return (function(f) ** 2).sum()

        g = f.clone().requires_grad_()
        loss(g).backward()
        torch.testing.assert_close(func.grad(loss)(f), g.grad)
        batch = torch.stack([f, 2 * f, f**2])
        torch.testing.assert_close(func.vmap(function)(batch), torch.stack([function(one) for one in batch]))
        torch.testing.assert_close(
            func.vmap(func.grad(loss))(batch), torch.stack([func.grad(loss)(one) for one in batch])
        )
        _, tangent = func.jvp(function, (f,), (f**2,))
        torch.testing.assert_close(tangent, function(f**2))
        hessian = func.hessian(loss)(f)
        jacobian = func.jacrev(function)(f).reshape(-1, WALK.n_vertices)
        torch.testing.assert_close(hessian, 2 * jacobian.T @ jacobian, atol=1e-8, rtol=1e-6)


def test_batches_are_further_channels() -> None:
    f = signal(WALK, 2).detach()
    batch = torch.stack([f, f**2, -f])
    for function in functions(WALK):
        found = function(batch)
        for i, one in enumerate(batch):
            expected = function(one)
            torch.testing.assert_close(found[:, i] if found.ndim == 4 else found[i], expected)
    assert aw.torch.smooth(WALK, batch[..., 0], 2).shape == (3, WALK.n_vertices)
    assert aw.torch.smooth(WALK, f.float(), 2).dtype == torch.float32


def test_wrong_arguments_are_refused() -> None:
    f = signal(WALK)
    with pytest.raises(TypeError, match=r"float\(steps\)"):
        aw.torch.smooth(WALK, f, torch.tensor(2.0, requires_grad=True))
    with pytest.raises(ValueError, match="no axis of 60 vertices"):
        aw.torch.smooth(WALK, f[:7], 2)
    with pytest.raises(ValueError, match="3 levels"):
        aw.torch.filter(WALK, f, [1.0, 2.0], 3)
    masked = WALK.with_mask(np.arange(60) < 3)
    with pytest.raises(ValueError, match="reversible"):
        aw.torch.bands(masked, f, 3)


def test_it_takes_about_the_time_of_decompose() -> None:
    walk = aw.Decomposer(aw.sample("torus", vertices=60_000))
    values = np.array(walk.shape.points)
    f = torch.from_numpy(values).requires_grad_()

    def fastest(function) -> float:
        times = []
        for _ in range(5):
            start = time.perf_counter()
            function()
            times.append(time.perf_counter() - start)
        return min(times)

    split = fastest(lambda: walk.decompose(values, levels=8))
    forward = fastest(lambda: aw.torch.bands(walk, f, 8))
    # 1.1 on a quiet machine.
    assert forward < 2 * split, f"{forward:.4f} s beside {split:.4f} s"
