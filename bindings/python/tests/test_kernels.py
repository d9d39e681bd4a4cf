"""Functions of the Laplacian, beside eigenvectors."""

from __future__ import annotations

import math
from typing import Any

import adwave as aw
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import sparse

RNG = np.random.default_rng(11)


def random_weights(n: int = 60) -> NDArray[np.float64]:
    """Weights of a connected graph, n × n."""
    weights = np.triu(RNG.random((n, n)) * (RNG.random((n, n)) < 0.1), 1)
    weights[np.arange(n - 1), np.arange(1, n)] = 0.5
    return weights + weights.T


def random_graph() -> sparse.csr_array:
    """Weights of a connected graph, n × n."""
    return sparse.csr_array(random_weights())


def spectrum(weights: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Eigenvalues and eigenvectors of the symmetric normalized Laplacian, and the roots of the degrees."""
    root = np.sqrt(weights.sum(1))
    values, vectors = np.linalg.eigh(np.eye(len(weights)) - weights / np.outer(root, root))
    return values, vectors, root


def exact(weights: NDArray[np.float64], f: NDArray[np.float64], kernel: Any) -> NDArray[np.float64]:
    values, vectors, root = spectrum(weights)
    gains = np.array([float(kernel(max(value, 0.0))) for value in values])
    return np.asarray(((vectors * gains) @ (vectors.T @ (root[:, None] * f))) / root[:, None])


KERNELS = [
    aw.kernels.heat(3.0),
    lambda x: 1 / (1 + 5 * x),
    lambda x: np.cos(9 * x),
    *aw.kernels.mexican_hat(5),
    *aw.kernels.meyer(4),
    *aw.kernels.itersine(5),
]


def test_each_kernel_is_that_of_the_eigenvectors_within_its_error() -> None:
    weights = random_weights()
    f = RNG.normal(size=(60, 2))
    walk = aw.walk(weights, normalize="row")
    degrees = []
    for accuracy in (1e-3, 1e-6):
        result = aw.kernels.apply(walk, f, KERNELS, accuracy=accuracy)
        root = np.sqrt(weights.sum(1))[:, None]
        for values, error, kernel in zip(result.values, result.errors, KERNELS, strict=True):
            off = np.linalg.norm(root * (values - exact(weights, f, kernel)))
            assert error <= accuracy * 1.2  # the largest gain of these kernels is 1.2 at most
            assert off <= (1.05 * error + 1e-13) * np.linalg.norm(root * f)
        degrees.append(result.degrees)
    assert all(coarse <= fine for coarse, fine in zip(*degrees, strict=True)) and max(degrees[1]) > max(degrees[0]) > 3


def test_filter_takes_a_kernel_for_each_kind_of_input() -> None:
    weights = random_weights()
    f = RNG.normal(size=60)
    expected = exact(weights, f[:, None], lambda x: 1 / (1 + x))[:, 0]
    assert np.allclose(aw.filter(sparse.csr_array(weights), f, lambda x: 1 / (1 + x)), expected, atol=1e-7)
    found = aw.filter(aw.walk(weights, normalize="row"), f.astype(np.float32), lambda x: 1 / (1 + x))
    assert found.dtype == np.float32 and np.allclose(found, expected, atol=1e-5)
    sphere = aw.sample("sphere", vertices=2000)
    smooth = aw.filter(sphere, aw.kernels.heat(0.05))
    assert isinstance(smooth, aw.Shape) and smooth.n_faces == sphere.n_faces
    # Coordinates of the unit sphere have the eigenvalue 2.
    assert np.allclose(smooth.points, np.exp(-0.1) * sphere.points, atol=2e-3)
    heights = aw.filter(sphere, sphere.points[:, 2], aw.kernels.heat(0.05))
    assert np.allclose(heights, smooth.points[:, 2], atol=1e-12)


def test_images_have_the_laplacian_of_their_places() -> None:
    f = np.cos(2 * np.pi * (np.arange(40) + 0.5) / 40)[:, None] * np.ones((40, 30))
    eigenvalue = (2 - 2 * np.cos(2 * np.pi / 40)) / 4
    grid = aw.grid(f, spacing=(2, 2))
    for found in (aw.filter(grid, aw.kernels.heat(9.0)), aw.filter(grid, f, aw.kernels.heat(9.0))):
        assert np.allclose(found, np.exp(-9 * eigenvalue) * f, atol=1e-7)


def test_a_kernel_of_single_numbers_and_a_constant_gain_will_do() -> None:
    weights, f = random_graph(), RNG.normal(size=60)
    single = aw.filter(weights, f, lambda x: math.exp(-x))
    assert np.array_equal(single, aw.filter(weights, f, lambda x: np.array([math.exp(-v) for v in x])))
    assert np.allclose(aw.filter(weights, f, lambda x: 2.0), 2 * f, atol=1e-14)
    assert np.allclose(aw.filter(weights, np.ones(60), lambda x: 3 + x**2), 3.0, atol=1e-12)


def test_vertices_at_one_position_keep_the_gain_of_the_finest_detail_between_them() -> None:
    sphere = aw.sample("sphere", vertices=2000)
    points = np.concatenate([sphere.points, sphere.points[:1]])
    faces = np.array(sphere.faces).reshape(-1, 3)
    doubled = aw.Shape(points, faces)
    f = np.append(sphere.points[:, 2], sphere.points[0, 2] + 1)
    largest = aw.Decomposer(doubled, operator="surface").spectral_range
    found = aw.filter(doubled, f, lambda x: x / largest)
    assert found[-1] - found[0] == pytest.approx(1.0, abs=1e-9)


def test_kinks_take_more_terms_and_say_when_they_are_too_many() -> None:
    weights, f = random_graph(), RNG.normal(size=60)
    result = aw.kernels.apply(weights, f, lambda x: np.abs(x - 1), accuracy=1e-3)
    assert 100 < result.degrees[0] < 4000 and result.errors[0] <= 1e-3
    with pytest.raises(ValueError, match="use a smoother kernel, or accuracy="):
        aw.kernels.apply(weights, f, lambda x: np.where(x < 1, 1.0, 0.0))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda w, f: aw.filter(w, f, lambda x: np.where(x > 0, x, np.inf)), "finite at all eigenvalues"),
        (lambda w, f: aw.filter(w, f, lambda x: np.ones(3)), "a gain for each of"),
        (lambda w, f: aw.filter(w, f, lambda x: x, levels=3), "levels: it does not apply"),
        (lambda w, f: aw.kernels.apply(w, f, []), "at least one function"),
        (lambda w, f: aw.kernels.apply(w, f, np.exp, accuracy=2), "accuracy: it must be"),
        (lambda w, f: aw.filter(aw.walk(np.triu(w.toarray()) + 0.1, normalize="row"), f, np.exp), "symmetric graph"),
        (lambda w, f: aw.filter(w, np.append(f[1:], np.nan), np.exp), "nan"),
        (lambda w, f: aw.kernels.heat(-1), "at least 0"),
        (lambda w, f: aw.kernels.meyer(1), "at least 2 kernels"),
    ],
)
def test_wrong_calls_are_told_in_one_line(call: Any, message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=f"(?i){message}") as raised:
        call(random_graph(), RNG.normal(size=60))
    assert "\n" not in str(raised.value)


def test_banks_are_those_of_pygsp() -> None:
    pygsp = pytest.importorskip("pygsp")
    graph = pygsp.graphs.Ring(20, lap_type="normalized")
    graph._lmax = 2.0
    x = np.linspace(0, 2, 101)
    theirs = pygsp.filters
    assert np.allclose([g(x) for g in aw.kernels.meyer(5)], theirs.Meyer(graph, Nf=5).evaluate(x), atol=1e-12)
    assert np.allclose([g(x) for g in aw.kernels.itersine(5)], theirs.Itersine(graph, Nf=5).evaluate(x), atol=1e-12)
    hat = [g(x) for g in aw.kernels.mexican_hat(5)]
    assert np.allclose(hat, theirs.MexicanHat(graph, Nf=5).evaluate(x), atol=1e-12)
