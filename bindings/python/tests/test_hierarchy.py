"""Levels of subdivision and lifted wavelets."""

from __future__ import annotations

import adwave as aw
import numpy as np
import pytest

TETRAHEDRON = aw.Shape([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
SIZES = (514, 130, 34, 10, 4)


def ball() -> aw.Shape:
    """A tetrahedron cut four times, in another order of vertices and faces."""
    fine = aw.subdivide(TETRAHEDRON, 4)
    rng = np.random.default_rng(7)
    order = rng.permutation(fine.n_vertices)
    faces = np.argsort(order)[np.array(fine.faces)]
    return aw.Shape(np.array(fine.points)[order], rng.permutation(faces))


def test_levels_are_found_in_any_order():
    shape = ball()
    h = aw.hierarchy(shape)
    assert h.levels == 4 and h.sizes == SIZES
    assert [p.shape for p in h.parents] == [(n, 2) for n in SIZES[:-1]]
    corners = np.array(h.shape(4).points)
    assert {tuple(p) for p in corners} == {tuple(p) for p in np.array(TETRAHEDRON.points)}
    points = np.array(shape.points)
    for level in range(h.levels):
        vertices, coarser = h.vertices(level), h.vertices(level + 1)
        middle = points[coarser[h.parents[level]]].mean(axis=1)
        assert np.abs(middle - points[vertices]).max() < 1e-12


@pytest.mark.parametrize("family", ["butterfly", "linear", "loop", "irregular"])
def test_fields_come_back_and_keep_their_mean(family):
    shape = ball()
    h = aw.hierarchy(shape, kind="irregular" if family == "irregular" else "subdivision")
    field = np.sin(np.array(shape.points) @ [1.0, 2.0, 0.5])
    c = h.analyze(field, family=family)
    assert c.array.shape == field.shape and len(c.levels) == len(field)
    assert np.abs(c.synthesize() - field).max() < 1e-12
    constant = h.analyze(np.full(len(field), 3.0), family=family)
    assert np.abs(constant.array[constant.levels <= h.levels]).max() < 1e-12
    few = c.keep(0.2).synthesize()
    assert np.sqrt(np.mean((few - field) ** 2)) < 0.15 * field.std()
    both = np.stack([field, 2 * field], axis=1)
    assert np.abs(h.analyze(both, family=family).array[:, 1] - 2 * c.array).max() < 1e-12


def test_a_field_goes_down_and_up():
    h = aw.hierarchy(ball())
    field = np.array(h.shape(0).points)[:, 2]
    coarse = h.down(field, 2)
    assert coarse.shape == (SIZES[2],)
    assert h.up(coarse, 2).shape == field.shape
    assert np.abs(h.down(np.ones(SIZES[0]), 3) - 1).max() < 1e-12


def test_bad_input_is_refused():
    with pytest.raises(ValueError, match="subdivision"):
        aw.hierarchy(aw.sample("creature", vertices=2000))
    h = aw.hierarchy(ball())
    with pytest.raises(ValueError, match=r"0\.\.=1|0 to 1"):
        h.analyze(np.ones(SIZES[0])).keep(2.0)
    with pytest.raises(ValueError):
        h.down(np.ones(SIZES[0] - 1))
    with pytest.raises(ValueError):
        h.shape(9)


def test_shares_of_bands_sum_to_one():
    shape = aw.sample("creature", vertices=2000)
    bands = aw.decompose(shape, levels=5)
    shares = bands.shares()
    assert shares.shape == (6,) and shares.min() >= 0
    assert abs(shares.sum() - 1) < 1e-12


def test_labels_stay_labels_and_means_over_cells_stay_in_range():
    h = aw.hierarchy(ball())
    random = np.random.default_rng(3)
    labels = random.choice([35, 1002, 7], SIZES[0]).astype(np.int32)
    for level in range(h.levels + 1):
        coarse = h.down(labels, level)
        assert coarse.dtype == labels.dtype and set(coarse) <= {35, 1002, 7}
        assert set(h.up(coarse, level)) <= {35, 1002, 7}
        values = random.exponential(size=(SIZES[0], 2))
        means = h.down(values, level, by="cells")
        assert means.shape == (SIZES[level], 2)
        assert (means >= values.min(axis=0)).all() and (means <= values.max(axis=0)).all()
    assert np.array_equal(h.down(labels, 0), labels)
    assert np.array_equal(h.down(np.full(SIZES[0], 12), 2), np.full(SIZES[2], 12))
    # A half with a label keeps it, but for the vertices beside the border.
    z = h.shape(0).points[:, 2]
    far = np.abs(z[h.vertices(1)]) > 0.5
    assert np.array_equal(h.down(z > 0, 1)[far], (z[h.vertices(1)] > 0)[far])
    with pytest.raises(ValueError, match=r"levels of any mesh have no cells"):
        aw.hierarchy(ball(), kind="irregular").down(labels, 1)


def shuffled(shape: aw.Shape, seed: int = 3) -> tuple[aw.Shape, np.ndarray]:
    """The mesh in another order of vertices and faces, and the new place of each vertex."""
    rng = np.random.default_rng(seed)
    order = rng.permutation(shape.n_vertices)
    place = np.argsort(order)
    offsets, corners = shape.polygons()
    faces = np.split(place[corners], offsets[1:-1])
    faces = [np.roll(faces[k], rng.integers(4)) for k in rng.permutation(len(faces))]
    return aw.Shape(np.array(shape.points)[order], faces), place


def house() -> aw.Shape:
    """A box without floor, with a roof of triangles."""
    points = [[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)] + [[0.1, 0, 2]]
    walls = [[0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return aw.Shape(points, [*walls, [4, 5, 8], [5, 7, 8], [7, 6, 8], [6, 4, 8]])


@pytest.mark.parametrize("family", ["catmull-clark", "linear"])
def test_quadrilaterals_come_back_to_their_control_mesh(family):
    control = house()
    shape, place = shuffled(aw.subdivide(control, 3, family=family))
    h = aw.hierarchy(shape)
    assert h.levels == 3 and h.sizes[-1] == 9
    coarse = h.shape(3, family=family)
    assert sorted(np.diff(coarse.polygons()[0])) == [3, 3, 3, 3, 4, 4, 4, 4]
    found = np.empty((shape.n_vertices, 3))
    found[h.vertices(3)] = coarse.points
    assert np.abs(found[place[:9]] - control.points).max() < 1e-12
    c = h.analyze(shape.points, family=family)
    assert np.abs(c.array[c.levels <= 3]).max() < 1e-12
    assert np.abs(c.synthesize() - shape.points).max() < 1e-13
    labels = (np.array(shape.points)[:, 2] > 0).astype(int)
    assert set(np.unique(h.down(labels, 2))) == {0, 1}
    by_cells = h.down(np.array(shape.points)[:, 0], 1, by="cells")
    assert by_cells.shape == (h.sizes[1],) and np.abs(by_cells).max() <= np.abs(shape.points).max()
    parents = h.parents[2]
    assert parents.shape == (h.sizes[2], 4)
    assert sorted((parents >= 0).sum(axis=1))[:9] == [1] * 9 and ((parents >= 0).sum(axis=1) == 3).sum() == 4


def test_creases_and_corners_are_kept():
    control = house()
    fine = aw.subdivide(control, 2, family="catmull-clark")
    plain = aw.hierarchy(fine)
    sharp = aw.hierarchy(fine, creases=25.0)
    fixed = aw.hierarchy(fine, corners="sharp")
    assert plain.sizes == sharp.sizes == fixed.sizes
    details = [np.abs((c := h.analyze(fine.points)).array[c.levels <= 2]).max() for h in (plain, sharp)]
    assert details[0] < 1e-12 < details[1]
    edge = fine.polygons()[1][:2].astype(int)
    assert aw.hierarchy(fine, creases=[edge]).sizes == plain.sizes
    for creases, text in [([[0, 1]], "no edge"), (200.0, "0 to 180"), ([[0.5, 1]], "integers"), ([[-1, 1]], "range")]:
        with pytest.raises(ValueError, match=text):
            aw.hierarchy(fine, creases=creases)
    with pytest.raises(ValueError, match="quadrilaterals"):
        aw.hierarchy(ball(), creases=30.0)
    with pytest.raises(ValueError, match="corners must be"):
        aw.hierarchy(fine, corners="round")


def test_an_edited_level_carries_its_detail():
    rng = np.random.default_rng(0)
    fine = aw.subdivide(house(), 3, family="catmull-clark")
    bumpy = aw.Shape(np.array(fine.points) + 0.02 * rng.standard_normal((fine.n_vertices, 3)), fine_faces(fine))
    h = aw.hierarchy(bumpy)
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    for level in (1, 2, 3):
        base = np.array(h.shape(level, family="catmull-clark").points)
        assert np.array_equal(h.with_level(base, level), bumpy.points)
        assert np.abs(h.with_level(base @ turn.T + 2, level) - (np.array(bumpy.points) @ turn.T + 2)).max() < 1e-12
    with pytest.raises(ValueError, match="level 1 has"):
        h.with_level(base, 1)


def fine_faces(shape: aw.Shape) -> np.ndarray:
    return np.array(shape.polygons()[1]).reshape(-1, 4)
