"""An operator that stores no rows, a ring by a path with holes: all that works on shapes works as on its rows."""

from __future__ import annotations

import pickle

import adwave as aw
import numpy as np
import pytest

scipy_sparse = pytest.importorskip("scipy.sparse")

AROUND, ALONG = 40, 25
N = AROUND * ALONG
HOLES = [130, 131, 170, 171, 511, 900]


class Cylinder:
    """Steps to each of four sides with 1/8, unless there is a hole or an end; I − Φ₁ by differences."""

    shape = (N, N)

    def __init__(self, holes: np.ndarray) -> None:
        open_ = ~holes.reshape(ALONG, AROUND)
        self.around = (open_ & np.roll(open_, -1, 1))[..., None] / 8
        self.along = (open_[:-1] & open_[1:])[..., None] / 8

    def __matmul__(self, x: np.ndarray) -> np.ndarray:
        f = x.reshape(ALONG, AROUND, -1)
        out = np.zeros_like(f)
        step = self.around * (f - np.roll(f, -1, 1))
        out += step - np.roll(step, 1, 1)
        step = self.along * (f[:-1] - f[1:])
        out[:-1] += step
        out[1:] -= step
        return out.reshape(x.shape)


def flags(rows: list[int]) -> np.ndarray:
    found = np.zeros(N, dtype=bool)
    found[rows] = True
    return found


def without(masked: np.ndarray) -> Cylinder:
    return Cylinder(masked | flags(HOLES))


def both(masked=without) -> tuple[aw.Decomposer, aw.Decomposer]:
    """The cylinder by its stencil, and by rows of the same walk."""
    own = Cylinder(flags(HOLES))
    matrix = scipy_sparse.csr_array(np.eye(N) - own @ np.eye(N))
    matrix.data[np.abs(matrix.data) < 1e-15] = 0
    matrix.eliminate_zeros()
    edges = scipy_sparse.triu(matrix, 1).tocoo()
    angle = 2 * np.pi * (np.arange(N) % AROUND) / AROUND
    points = np.column_stack([np.cos(angle), np.sin(angle), 0.15 * (np.arange(N) // AROUND)])
    shape = aw.graph(N, np.column_stack([edges.row, edges.col]), np.ones(edges.nnz), points=points)
    prepared = aw.Decomposer(shape, operator="walk")
    stored = prepared.with_walk(aw.walk(matrix))
    step_length = stored._data.lengths()[2]
    return prepared.with_operator(own, step_length=step_length, masked=masked), stored


def field(seed: int = 1, channels: int = 1) -> np.ndarray:
    noise = np.random.default_rng(seed).normal(size=(N, channels))
    return (np.arange(N) % AROUND // 8)[:, None] + 0.1 * noise


def test_bands_filters_and_maps_are_those_of_the_stored_rows() -> None:
    own, stored = both()
    f = field()[:, 0]
    results = {
        "bands": lambda d: np.asarray(d.decompose(f, levels=6)),
        "bands of channels": lambda d: np.asarray(d.decompose(field(2, 20), levels=4)),
        "smooth": lambda d: aw.smooth(d, f, steps=5),
        "filter": lambda d: aw.filter(d, f, "smooth", levels=5),
        "region": lambda d: aw.filter(d, f, aw.Layer([0, 0, 1], "ball:vertex=300,radius=0.5"), levels=3),
        "saliency": lambda d: aw.saliency(d, signal=f, levels=5),
        "denoise": lambda d: aw.denoise(d, signal=f).result,
    }
    for name, result in results.items():
        a, b = result(own), result(stored)
        # The size of the noise is searched for, so rounding grows in what it decides.
        assert np.allclose(a, b, atol=1e-6 if name == "denoise" else 1e-9, rtol=0), name
        assert not np.allclose(a, f if a.shape == f.shape else 0), name
    a, b = aw.features(own, signal=f, levels=5), aw.features(stored, signal=f, levels=5)
    assert len(a) > 0
    assert np.array_equal(a["vertex"], b["vertex"])


def test_gaps_take_the_operator_without_them() -> None:
    own, _ = both()
    f = field()[:, 0]
    f[[3, 4, 44, 700]] = np.nan
    found = aw.smooth(own, f, steps=6)
    around = Cylinder(flags([*HOLES, 3, 4, 44, 700]))
    expected = np.nan_to_num(f)[:, None]
    for _ in range(6):
        expected = expected - around @ expected
    known = ~np.isnan(f)
    assert np.isnan(found[~known]).all()
    assert np.allclose(found[known], expected[known, 0], atol=1e-10)
    plain, _ = both(masked=None)
    with pytest.raises(ValueError, match="mask"):
        aw.smooth(plain, f, steps=6)


def test_functions_are_operators_too_and_may_call_the_package() -> None:
    ring = aw.graph(5000, [(i, (i + 1) % 5000) for i in range(5000)])
    inner = aw.Decomposer(ring, operator="walk")

    def laplacian(x: np.ndarray) -> np.ndarray:
        return x - aw.smooth(inner, x, steps=1)

    own = aw.Decomposer(ring, operator="walk").with_operator(laplacian)
    f = np.sin(np.arange(5000) / 40.0)
    with aw.threads(1):
        assert np.allclose(aw.smooth(own, f, steps=4), aw.smooth(inner, f, steps=4), atol=1e-10)


@pytest.mark.parametrize("n", [60, 6000])
def test_exceptions_of_a_function_are_passed_on(n: int) -> None:
    ring = aw.Decomposer(aw.graph(n, [(i, (i + 1) % n) for i in range(n)]))
    calls = [0]

    def laplacian(x: np.ndarray) -> np.ndarray:
        calls[0] += 1
        if calls[0] > 8:
            raise KeyError("as it was raised")
        return ((x - np.roll(x, 1, 0)) + (x - np.roll(x, -1, 0))) / 4

    own = ring.with_operator(laplacian)
    with pytest.raises(KeyError, match="as it was raised"):
        for _ in range(10):
            own.decompose(np.arange(n) % 7.0, levels=6)


def test_what_is_no_operator_is_refused_in_words() -> None:
    n = 60
    ring = aw.Decomposer(aw.graph(n, [(i, (i + 1) % n) for i in range(n)]))
    cases = [
        (3, TypeError, "must be a function"),
        (np.eye(4), ValueError, "must be 60 × 60"),
        (lambda x: x[:-1], ValueError, "shape of its argument"),
        (lambda x: x * np.nan, ValueError, "must be finite"),
        (lambda x: x, ValueError, "constant"),
        (lambda x: (x - np.roll(x, 1, 0)) / 2, ValueError, "reversible"),
    ]
    for laplacian, kind, words in cases:
        with pytest.raises(kind, match=words):
            ring.with_operator(laplacian)
    with pytest.raises(ValueError, match="step_length"):
        ring.with_operator(lambda x: 0 * x, step_length=0.0)
    with pytest.raises(ValueError, match="weights"):
        ring.with_operator(lambda x: 0 * x, weights=np.zeros(n))


def test_a_directed_operator_takes_whole_steps() -> None:
    n = 60
    ring = aw.Decomposer(aw.graph(n, [(i, (i + 1) % n) for i in range(n)]))
    onward = ring.with_operator(lambda x: (x - np.roll(x, 1, 0)) / 2, reversible=False)
    f = np.arange(n) % 5.0
    expected = (f + np.roll(f, 1)) / 2
    assert np.allclose(aw.smooth(onward, f, steps=1), expected)


def test_operators_with_weights_and_pickles() -> None:
    n = 50
    path = aw.Decomposer(aw.graph(n, [(i, i + 1) for i in range(n - 1)]))
    mass = 1.0 + np.arange(n) % 3
    edge = 0.2
    stiff = scipy_sparse.diags_array(
        [-np.ones(n - 1), np.r_[1, np.full(n - 2, 2.0), 1], -np.ones(n - 1)], offsets=(-1, 0, 1)
    )
    laplacian = scipy_sparse.csr_array(scipy_sparse.diags_array(edge / mass) @ stiff)
    own = path.with_operator(laplacian, weights=mass)
    f = np.random.default_rng(3).normal(size=n)
    found = aw.smooth(own, f, steps=7)
    expected = np.linalg.matrix_power(np.eye(n) - laplacian.toarray(), 7) @ f
    assert np.allclose(found, expected, atol=1e-10)
    assert np.isclose(mass @ found, mass @ f)
    again = pickle.loads(pickle.dumps(own))
    assert np.array_equal(aw.smooth(again, f, steps=7), found)
