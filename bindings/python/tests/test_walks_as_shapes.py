"""A walk is accepted wherever a shape is, and a graph wherever a walk is."""

import adwave as aw
import numpy as np
import pytest

RANDOM = np.random.default_rng(3)


def test_functions_of_shapes_take_walks() -> None:
    lazy = aw.point_walk(RANDOM.normal(size=(80, 5)), neighbors=6, stay=0.5)
    f = RANDOM.normal(size=80)
    assert np.allclose(aw.smooth(lazy, f, steps=3), lazy.smooth(f, 3), atol=1e-9)
    bands = aw.decompose(lazy, f, levels=4)
    assert np.allclose(np.asarray(bands).sum(axis=0), f, atol=1e-12)
    assert np.allclose(aw.filter(lazy, f, [0, 1, 1]), f - lazy.bands(f, [1])[0], atol=1e-9)
    assert aw.denoise(lazy, f).result.shape == (80,)
    assert np.allclose(aw.Decomposer(aw.graph(2, [[0, 1]])).smooth([1.0, 3.0], 2), 2.0)


def test_functions_of_walks_take_graphs() -> None:
    edges = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]]
    adjacency = np.zeros((4, 4))
    for x, y in edges:
        adjacency[x, y] = adjacency[y, x] = 1
    lazy = aw.walk(adjacency, normalize="row", stay=0.5)
    f = RANDOM.normal(size=(4, 2))
    expected = aw.scattering(lazy, f, steps=[1, 2]).values
    assert np.allclose(aw.scattering(aw.graph(4, edges), f, steps=[1, 2]).values, expected, atol=1e-12)
    networkx = pytest.importorskip("networkx")
    graph = networkx.Graph(edges)
    order = list(graph)
    found = aw.scattering(graph, f[order], steps=[1, 2]).values
    assert np.allclose(found, expected[:, order], atol=1e-12)
