"""Strays, placeholders and the first corner of a polygon change nothing, and `info` names them."""

from __future__ import annotations

import adwave as aw
import numpy as np

SPHERE = aw.sample("sphere", vertices=2000)


def test_a_vertex_of_no_face_changes_neither_the_extent_nor_the_levels() -> None:
    stray = aw.Shape(np.vstack([SPHERE.points, [[500.0, 0.0, 0.0]]]), SPHERE.faces)
    clean, more = aw.Decomposer(SPHERE), aw.Decomposer(stray)
    assert clean.extent == clean.diagonal
    assert more.extent == clean.extent and more.diagonal > 400
    expected, found = clean.decompose(), more.decompose()
    assert len(found) == len(expected)
    smooth = found.scaling(len(found) - 1)
    assert np.abs(smooth[:-1] - expected.scaling(len(expected) - 1)).max() < 1e-9
    assert np.array_equal(smooth[-1], [500.0, 0.0, 0.0])


def test_placeholders_and_strays_of_a_cloud_are_named() -> None:
    i, j = np.mgrid[:40, :40]
    heights = 300 + np.sin(i / 4)
    points = np.stack([500_000.0 + i, 5_400_000.0 + j, heights], axis=-1).reshape(-1, 3)
    more = np.vstack([points, [[0.0, 0.0, 0.0], [500_003.5, 5_400_003.5, 900.0]]])
    clean, found = aw.Decomposer(aw.Shape(points)), aw.Decomposer(aw.Shape(more))
    assert abs(found.extent - clean.extent) < 1e-9 * clean.extent
    assert abs(found.mean_length - clean.mean_length) < 1e-9
    facts = aw.info(aw.Shape(more))
    assert facts["placeholders"] == [1600] and facts["strays"] == [1601] and facts["unused"] == []
    assert abs(facts["extent"] - clean.extent) < 1e-9 * clean.extent


def test_the_first_corner_of_a_polygon_does_not_matter() -> None:
    n = 32
    angle = 2 * np.pi * np.arange(n) / n
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.vstack([np.column_stack([ring, np.full(n, z)]) for z in (0.0, 0.3)])
    sides = [[k, (k + 1) % n, n + (k + 1) % n, n + k] for k in range(n)]
    caps = [list(range(n))[::-1], list(range(n, 2 * n))]
    rotated = [cap[5:] + cap[:5] for cap in caps]
    for operator in ("walk", "surface"):
        one, two = (
            aw.Decomposer(aw.Shape(points, sides + both), operator=operator).decompose(levels=4)
            for both in (caps, rotated)
        )
        assert np.abs(one.array - two.array).max() <= 1e-12
        assert np.ptp(np.linalg.norm(one.scaling(4)[:n, :2], axis=1)) < 1e-12


def test_default_levels_keep_half_of_a_cube() -> None:
    corners = np.array([[k & 1, k >> 1 & 1, k >> 2 & 1] for k in range(8)], dtype=float)
    sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    cube = aw.Shape(corners, sides)
    bands = aw.Decomposer(cube).decompose()
    smooth = bands.scaling(len(bands) - 1)
    assert np.ptp(smooth, axis=0).prod() > 0.5
