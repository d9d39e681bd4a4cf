"""Input that is odd or unknown: a result with a warning, or a message that leads to the line which works."""

from __future__ import annotations

import warnings
from typing import Any

import adwave as aw
import numpy as np
import pytest

SPHERE = aw.sample("sphere", vertices=600)
N = SPHERE.n_vertices


def values(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal(N)


@pytest.mark.parametrize("sentinel", [-1.6375e30, 9.96921e36, 1e20, -9999.0, -32768.0])
def test_sentinels_count_as_unknown(sentinel: float) -> None:
    f = values(0)
    f[:60] = sentinel
    known = np.where(f == sentinel, np.nan, f)
    with pytest.warns(UserWarning, match="60 values of the signal are .* and count as unknown; numpy.ma.masked_array"):
        found = aw.filter(SPHERE, f, "smooth")
    np.testing.assert_array_equal(found, aw.filter(SPHERE, known, "smooth"))
    assert np.isnan(found[:60]).all() and np.abs(found[60:]).max() < 10
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        as_numbers = aw.filter(SPHERE, np.ma.masked_array(f, False), "smooth")
    assert np.abs(as_numbers[60:]).max() > 100
    with pytest.warns(UserWarning, match="60 values of"):
        aw.decompose(SPHERE.with_field("depth", f), "depth", levels=3)


def test_indices_of_all_vertices_are_the_whole_shape() -> None:
    whole = np.asarray(aw.filter(SPHERE, "smooth").points)
    for where in (np.arange(N), np.random.default_rng(1).permutation(N), np.ones(N), np.ones(N, bool)):
        np.testing.assert_array_equal(aw.filter(SPHERE, "smooth", where=where).points, whole)
    half = (np.arange(N) % 2).astype(int)
    flags = aw.filter(SPHERE, "smooth", where=half == 1).points
    np.testing.assert_array_equal(aw.filter(SPHERE, "smooth", where=half).points, flags)


@pytest.mark.parametrize(
    ("where", "message"),
    [
        (np.full(N, 7.0), r"weights must be in 0\.\.=1, got 7 at vertex 0; pass flags, as in where=values == 7"),
        (np.full(N, -0.5), r"got -0\.5 at vertex 0; .* numpy\.clip\(where, 0, 1\)"),
        (np.arange(N) % 8, r"got 2 at vertex 2"),
        (np.full(N, np.nan), r"got nan at vertex 0; pass numpy\.nan_to_num\(where\)"),
        ([N], r"indices must be in 0\.\.=\d+, got"),
    ],
)
def test_weights_of_a_region_are_from_0_to_1(where: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        aw.filter(SPHERE, "smooth", where=where)


def test_directed_graphs_and_self_loops_are_not_changed_without_a_word() -> None:
    nx = pytest.importorskip("networkx")
    directed = nx.DiGraph([(0, 1), (1, 2), (2, 0), (2, 3)])
    with pytest.warns(UserWarning, match=r"graph of networkx is not symmetric: \(W \+ W.T\) / 2 is used; adwave.walk"):
        aw.Shape(directed)
    loops = nx.Graph([(0, 1), (1, 2), (2, 2)])
    with pytest.warns(UserWarning, match="graph of networkx has 1 self-loop, which is not used"):
        aw.Shape(loops)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        aw.Shape(nx.karate_club_graph())
        aw.Shape(nx.DiGraph([(0, 1), (1, 0), (1, 2), (2, 1)]))
    # The line of the message keeps directions and loops.
    walk = aw.walk(directed, normalize="row")
    np.testing.assert_allclose(walk.smooth(np.arange(4.0), 1), [1, 2, 1.5, 3])
    np.testing.assert_allclose(aw.walk(loops, normalize="row").smooth(np.arange(3.0), 1), [1, 1, 1.5])


def test_graphs_of_other_libraries_warn_too() -> None:
    pygsp = pytest.importorskip("pygsp")
    weights = np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]])
    with pytest.warns(UserWarning, match="graph of pygsp is not symmetric"):
        aw.Shape(pygsp.graphs.Graph(weights))


def test_messages_lead_to_the_line_that_works() -> None:
    nx = pytest.importorskip("networkx")
    graph = nx.karate_club_graph()
    with pytest.raises(TypeError, match=r"write aw\.walk\(graph, normalize='row'\)"):
        aw.walk(graph)
    lazy = aw.walk(graph, normalize="row", stay=0.5)
    assert aw.scattering(lazy, np.arange(34.0), pool="moments").features().shape[0] == 1
    with pytest.raises(ValueError, match=r"is square, got shape \(34, 3\); .* adwave\.point_walk\(X\)"):
        aw.walk(np.ones((34, 3)))


def test_counts_that_are_none_are_refused_in_words() -> None:
    counts = np.random.default_rng(0).poisson(2.0, (60, 20)).astype(float)
    bad = counts.copy()
    bad[3, 4] = -1
    with pytest.raises(ValueError, match=r"counts must be numbers of at least 0 .*, got -1\.0 in cell 3, gene 4"):
        aw.impute(bad)
    sparse = pytest.importorskip("scipy.sparse")
    for wrong in (np.nan, np.inf):
        bad[3, 4] = wrong
        for given in (bad, sparse.csr_array(bad)):
            with pytest.raises(ValueError, match=r"counts must be finite, got (nan|inf) in cell 3, gene 4"):
                aw.impute(given)


def test_a_width_beyond_the_shape_is_warned_of() -> None:
    with pytest.warns(UserWarning, match="an rms width of 4.804 is larger than the shape, whose diagonal is 3"):
        aw.smooth(SPHERE, values(1), fwhm=8.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        aw.smooth(SPHERE, values(1), fwhm=0.5)
