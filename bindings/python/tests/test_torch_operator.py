"""Operators on a device beside the library; the device of these tests is the CPU.

With ``TRITON_INTERPRET=1`` the kernels of a GPU run there by Triton's interpreter.
"""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable
from typing import Any

import adwave as aw
import numpy as np
import pytest
from scipy import sparse

torch = pytest.importorskip("torch", reason="PyTorch is not installed")

#: Error of double precision, relative to the signal, over a few hundred products.
ROUNDING = 1e-11
SPHERE = aw.sample("sphere", vertices=60)
POINTS = np.array(SPHERE.points)
WALK = aw.Decomposer(SPHERE, operator="walk")
HEAT = aw.Decomposer(SPHERE, operator="surface")
WELDED = aw.Shape(np.vstack([POINTS, POINTS[:5]]), SPHERE.faces)
IS_INTERPRETED = os.environ.get("TRITON_INTERPRET") == "1"


def ring(n: int, stay: float) -> aw.Walk:
    return aw.walk(np.roll(np.eye(n), 1, 1) + np.roll(np.eye(n), -1, 1), normalize="row", stay=stay)


def random_graph(n: int, seed: int, mean_degree: float = 4.0) -> Any:
    generator = np.random.default_rng(seed)
    ends = generator.integers(0, n, (2, int(n * mean_degree / 2)))
    weights = sparse.coo_array((generator.random(ends.shape[1]) + 0.1, tuple(ends)), shape=(n, n))
    return sparse.csr_array(weights + weights.T)


def star(n: int) -> aw.Shape:
    """A graph with one long row, which a thread for each row would wait for."""
    return aw.graph(n, np.column_stack([np.zeros(n - 1, dtype=int), np.arange(1, n)]))


def sample(name: str, n: int, operator: str) -> Callable[[], aw.Decomposer]:
    return lambda: aw.Decomposer(aw.sample(name, vertices=2000 if name == "creature" else n), operator=operator)


DOMAINS: dict[str, Callable[[], Any]] = {
    **{
        f"{name}, {operator}": sample(name, 150, operator)
        for name in ("sphere", "torus", "plane", "knot", "creature")
        for operator in ("walk", "surface")
    },
    "welded mesh, walk": lambda: aw.Decomposer(WELDED, operator="walk"),
    "welded mesh, surface": lambda: aw.Decomposer(WELDED, operator="surface"),
    "cloud, walk": lambda: aw.Decomposer(POINTS, operator="walk"),
    "cloud, surface": lambda: aw.Decomposer(POINTS, operator="surface"),
    "two rings": lambda: aw.Decomposer(SPHERE, operator=aw.Operator("walk", rings=2)),
    "exact masses": lambda: aw.Decomposer(SPHERE, operator=aw.Operator("surface").with_exact_masses()),
    "curve": lambda: aw.Decomposer(
        aw.graph(60, np.column_stack([np.arange(59), np.arange(1, 60)]), points=POINTS[np.argsort(POINTS[:, 2])])
    ),
    "graph, walk": lambda: aw.Decomposer(random_graph(80, 1), operator="walk"),
    "graph, surface": lambda: aw.Decomposer(random_graph(80, 1), operator="surface"),
    "graph with isolated nodes": lambda: aw.Decomposer(random_graph(80, 2, 1.0), operator="walk"),
    "star": lambda: aw.Decomposer(star(50), operator="walk"),
    "lazy ring": lambda: ring(40, 0.5),
    "bipartite ring": lambda: ring(40, 0.0),
    "almost plain walk": lambda: aw.walk(random_graph(70, 3, 8.0), normalize="row", self_loops=0.5),
    "points in 5 dimensions": lambda: aw.points(np.random.default_rng(4).normal(size=(60, 5))),
    "two nodes": lambda: aw.walk([[0.5, 0.5], [0.5, 0.5]]),
}


if IS_INTERPRETED:
    # A second for each hundred products.
    FEW = ("sphere, surface", "welded mesh, walk", "graph with isolated nodes", "bipartite ring")
    DOMAINS = {name: DOMAINS[name] for name in FEW}


def signal(n: int, *channels: int, dtype: torch.dtype = torch.float64) -> torch.Tensor:
    generator = torch.Generator().manual_seed(3)
    return torch.rand((n, *channels), dtype=dtype, generator=generator)


def prepared(domain: Any) -> aw.Decomposer:
    return domain.prepare() if isinstance(domain, aw.Walk) else domain


@pytest.mark.parametrize("name", DOMAINS)
def test_it_has_the_bands_of_the_library(name: str) -> None:
    domain = DOMAINS[name]()
    own = prepared(domain)
    operator = aw.torch.Operator(domain, dtype=torch.float64)
    f = signal(own.n_vertices, 3) + 1e3
    for levels in (1, 5, aw.Steps([1, 3, 300])):
        exact = np.asarray(own.decompose(f.numpy(), levels=levels, accuracy=1e-13))
        found = aw.torch.bands(operator, f, levels)
        np.testing.assert_allclose(found, exact, atol=ROUNDING)
        np.testing.assert_allclose(found.sum(0), f, rtol=1e-14)
    factors, steps = [2.0, -1.0, 0.5], [1.0, 3.0, 10.0]
    combined = aw.torch.combine_bands(operator, f, factors, steps)
    np.testing.assert_allclose(combined, own.combine_bands(f.numpy(), factors, steps, accuracy=1e-13), atol=ROUNDING)
    np.testing.assert_allclose(aw.torch.smooth(operator, f, 6), own.smooth(f.numpy(), 6, accuracy=1e-13), atol=1e-10)


@pytest.mark.parametrize("name", DOMAINS)
def test_single_precision_keeps_its_bounds(name: str) -> None:
    domain = DOMAINS[name]()
    own = prepared(domain)
    operator = aw.torch.Operator(domain, dtype=torch.float32)
    f = signal(own.n_vertices, 3, dtype=torch.float32) - 0.5
    share = own._data.welding()[1][:, None]
    exact = np.asarray(own.decompose(f.double().numpy(), levels=6, accuracy=1e-13))
    found = aw.torch.bands(operator, f, 6)
    assert found.dtype == torch.float32
    bounds = operator.error_bounds(f, 6)
    pairs = zip(found[:-1].double().numpy(), exact[:-1], strict=True)
    for level, (found_band, exact_band) in enumerate(pairs):
        error, size = ((share * part**2).sum() for part in (found_band - exact_band, exact_band))
        assert error == 0 or np.sqrt(error / size) <= bounds[level]
    # The bound of the finest band says something: three digits, whatever the operator.
    assert bounds[0] < 1e-3


def test_bounds_are_those_of_an_accuracy() -> None:
    operator = aw.torch.Operator(WALK, dtype=torch.float32)
    f = signal(60, 5, dtype=torch.float32)
    aw.torch.bands(operator, f, 4, accuracy=1e-3)
    with pytest.raises(ValueError, match=r"error of a band on cpu may be .* accuracy=1e-10 was asked for"):
        aw.torch.bands(operator, f, 4, accuracy=1e-10)
    with pytest.raises(ValueError, match=r"error of a band on cpu may be .* accuracy=1e-10 was asked for"):
        aw.torch.bands(WALK, f, 4, device="cpu")
    with pytest.raises(ValueError, match="an operator computes in its type"):
        aw.torch.smooth(operator, f, 4, accuracy=1e-3)
    double = aw.torch.Operator(WALK, dtype=torch.float64)
    assert max(double.error_bounds(f.double(), 4)) < 1e-12
    assert double.error_bounds(torch.ones(60, dtype=torch.float64), 4) == [0.0] * 4


@pytest.mark.skipif(IS_INTERPRETED, reason="thousands of products, which are long in the interpreter")
def test_values_between_steps_and_constants() -> None:
    heat = aw.torch.Operator(HEAT, dtype=torch.float64)
    f = signal(60, 2)
    levels = aw.Steps([0.25, 0.3, 2.5])
    expected = HEAT.decompose(f.numpy(), levels=levels, accuracy=1e-13)
    np.testing.assert_allclose(aw.torch.bands(heat, f, levels), expected, atol=ROUNDING)
    widths = aw.Widths(fwhm=[0.3, 0.6])
    expected = HEAT.decompose(f.numpy(), levels=widths, accuracy=1e-13)
    np.testing.assert_allclose(aw.torch.bands(heat, f, widths), expected, atol=ROUNDING)
    constant = aw.torch.bands(heat, torch.full((60, 2), 3.0, dtype=torch.float64), 2)
    assert (constant[:-1] == 0).all() and (constant[-1] == 3).all()
    walk = aw.torch.Operator(WALK, dtype=torch.float64)
    expected = WALK.decompose(f.numpy(), levels=aw.Steps([3.5, 40.25]), accuracy=1e-13)
    np.testing.assert_allclose(aw.torch.bands(walk, f, aw.Steps([3.5, 40.25])), expected, atol=ROUNDING)
    with pytest.raises(ValueError, match="converge slowly"):
        aw.torch.bands(walk, f, aw.Steps([0.5]))
    with pytest.raises(ValueError, match="steps must be whole"):
        aw.torch.smooth(aw.torch.Operator(ring(60, 0.0), dtype=torch.float64), f, 1.5)


@pytest.mark.parametrize(
    "name", ["sphere, surface", "welded mesh, walk", "bipartite ring", "graph with isolated nodes"]
)
def test_derivatives(name: str) -> None:
    domain = DOMAINS[name]()
    operator = aw.torch.Operator(domain, dtype=torch.float64)
    f = signal(operator.n_vertices, 2).requires_grad_()
    gains = torch.tensor([0.5, 2.0, 1.5], dtype=torch.float64, requires_grad=True)
    one = f.detach()[:, 0].clone().requires_grad_()
    for function in (
        lambda f: aw.torch.bands(operator, f, 3),
        lambda f: aw.torch.combine_bands(operator, f, [2.0, -1.0], [1, 4]),
        lambda f: aw.torch.scatter_bands(operator, f[:, None], [1, 2, 5]),
    ):
        assert torch.autograd.gradcheck(function, one, fast_mode=True)
        assert torch.autograd.gradgradcheck(lambda f, function=function: function(f) ** 2, one, fast_mode=True)
    assert torch.autograd.gradcheck(lambda f, g: aw.torch.filter(operator, f, g), (f, gains), fast_mode=True)
    # The gradients are those of the library.
    own = prepared(domain)
    weights = signal(4, operator.n_vertices, 2)
    (expected,) = torch.autograd.grad((weights * aw.torch.bands(own, f, 3, accuracy=1e-13)).sum(), f)
    (found,) = torch.autograd.grad((weights * aw.torch.bands(operator, f, 3)).sum(), f)
    np.testing.assert_allclose(found, expected, atol=1e-11)


def test_functional_transforms_and_batches() -> None:
    operator = aw.torch.Operator(WALK, dtype=torch.float64)
    f = signal(60)

    def loss(f: torch.Tensor) -> torch.Tensor:
        return (aw.torch.bands(operator, f, 2) ** 3).sum()

    batch = torch.stack([f, 2 * f, f**2])
    single = torch.stack([torch.func.grad(loss)(own) for own in batch])
    torch.testing.assert_close(torch.func.vmap(torch.func.grad(loss))(batch), single)
    _, tangent = torch.func.jvp(lambda f: aw.torch.smooth(operator, f, 3), (f,), (f**2,))
    torch.testing.assert_close(tangent, aw.torch.smooth(operator, f**2, 3))
    assert aw.torch.bands(operator, batch, 2).shape == (3, 3, 60)
    assert aw.torch.bands(operator, signal(60, 0), 2).shape == (3, 60, 0)


def test_scattering_and_imputation() -> None:
    lazy, plain = ring(40, 0.5), ring(40, 0.0)
    directed = aw.walk(np.triu(np.random.default_rng(5).random((30, 30))), normalize="row", self_loops=1.0)
    column = aw.walk(random_graph(30, 6), normalize="column", self_loops=1.0)
    for walk in (lazy, plain, directed, column):
        operator = aw.torch.Operator(walk, dtype=torch.float64)
        f = signal(walk.n_nodes, 2)
        np.testing.assert_allclose(
            aw.torch.scatter_bands(operator, f, [1, 2, 7]), walk.bands(f.numpy(), [1, 2, 7]), atol=1e-13
        )
        layer = aw.torch.Scattering([1, 2, 4], pool="moments").double()
        expected = aw.scattering(walk, f.numpy(), steps=[1, 2, 4], pool="moments").features()
        np.testing.assert_allclose(layer(f, operator).detach(), expected, atol=1e-10)
        assert torch.autograd.gradcheck(
            lambda f, operator=operator: aw.torch.scatter_bands(operator, f, [1, 3]), f.requires_grad_(), fast_mode=True
        )
    counts = torch.poisson(signal(40, 6) * 5)
    counts[3] = 0
    operator = aw.torch.Operator(lazy, dtype=torch.float64)
    for t, size, root in ((0, None, False), (3, None, False), (2, 100.0, True)):
        found = aw.torch.impute(operator, counts, t, library_size=size, square_root=root)
        expected = aw.impute(counts.numpy(), lazy, t=t, library_size=size, square_root=root).values
        np.testing.assert_allclose(found, expected, atol=1e-12)
    with pytest.raises(ValueError, match="whole number of steps"):
        aw.torch.impute(operator, counts, 1.5)
    with pytest.raises(ValueError, match="use scatter_bands, Scattering or impute"):
        aw.torch.bands(aw.torch.Operator(directed, dtype=torch.float64), signal(30), 2)


def test_it_states_what_it_is() -> None:
    operator = aw.torch.Operator(SPHERE)
    assert (operator.kind, operator.dtype, operator.device.type) == ("steps", torch.get_default_dtype(), "cpu")
    assert operator.is_fused == IS_INTERPRETED and operator.n_bytes > 60 * 7 * 12
    assert aw.torch.Operator(star(50)).is_fused is False
    again = pickle.loads(pickle.dumps(operator))
    assert repr(again) == repr(operator) == "<adwave.torch.Operator: 60 vertices, steps, torch.float32 on cpu>"
    f = signal(60, dtype=torch.float32)
    assert torch.equal(aw.torch.smooth(again, f, 2), aw.torch.smooth(operator, f, 2))


def test_wrong_arguments_are_refused() -> None:
    operator = aw.torch.Operator(WALK, dtype=torch.float64)
    for half in (torch.float16, torch.bfloat16):
        with pytest.raises(TypeError, match=r"pass signal\.float\(\)"):
            aw.torch.Operator(WALK, dtype=half)
        with pytest.raises(TypeError, match="the type of the operator"):
            aw.torch.smooth(operator, signal(60).to(half), 2)
    with pytest.raises(TypeError, match="floats"):
        aw.torch.bands(WALK, torch.ones(60, dtype=torch.int64), 2, device="cpu")
    with pytest.raises(ValueError, match="the operator on cpu"):
        aw.torch.smooth(operator, torch.empty(60, dtype=torch.float64, device="meta"), 2)
    with pytest.raises(ValueError, match="no mask"):
        aw.torch.Operator(WALK.with_mask(np.arange(60) < 3))
    with pytest.raises(ValueError, match="operator='surface'"):
        aw.torch.bands(aw.torch.Operator(SPHERE, dtype=torch.float64), signal(60), aw.Widths(fwhm=[0.3]))
    with pytest.raises(ValueError, match=r"no axis of 60 vertices"):
        aw.torch.smooth(operator, signal(7), 2)
    with pytest.raises(TypeError, match=r"float\(steps\)"):
        aw.torch.smooth(operator, signal(60), torch.tensor(2.0))


def test_compiled_functions_are_one_graph() -> None:
    operator = aw.torch.Operator(WALK, dtype=torch.float64)
    f = signal(60, 2).requires_grad_()

    def function(f: torch.Tensor) -> torch.Tensor:
        return aw.torch.bands(operator, aw.torch.smooth(operator, f, 3).relu(), 3).square().sum()

    compiled = torch.compile(function, fullgraph=True, backend="aot_eager")
    torch.testing.assert_close(compiled(f), function(f))
    (expected,) = torch.autograd.grad(function(f), f)
    (found,) = torch.autograd.grad(compiled(f), f)
    torch.testing.assert_close(found, expected)
