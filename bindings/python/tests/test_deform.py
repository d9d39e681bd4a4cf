"""Bending, other bases, transfer, morphs and clones."""

from __future__ import annotations

import adwave as aw
import numpy as np
import pytest

SHAPE = aw.sample("creature", vertices=3000)
LOW, HIGH = (np.quantile(SHAPE.points[:, 1], q) for q in (0.2, 0.9))
FEET = SHAPE.points[:, 1] < LOW
HEAD = SHAPE.points[:, 1] > HIGH
TURN = np.array([[0.8, -0.6, 0, 0.1], [0.6, 0.8, 0, 0], [0, 0, 1, 0.2], [0, 0, 0, 1]])


def test_handles_follow_their_motion_and_nothing_else_is_lost() -> None:
    d = SHAPE.deformer(FEET, [HEAD])
    assert np.array_equal(d.points, SHAPE.points)
    d.move(0, TURN)
    moved = d.points
    assert np.array_equal(moved[FEET], SHAPE.points[FEET])
    assert np.allclose(moved[HEAD], SHAPE.points[HEAD] @ TURN[:3, :3].T + TURN[:3, 3], atol=1e-12)
    turns = d.rotations
    assert turns.shape == (SHAPE.n_vertices, 4) and np.allclose(np.linalg.norm(turns, axis=1), 1)
    assert np.allclose(turns[FEET], [1, 0, 0, 0])
    d.move(0, [0, 0, 0])
    assert np.array_equal(d.points, SHAPE.points)
    d.move(0, [0, 0.1, 0])
    energies = [d.step()["energy"] for _ in range(4)]
    assert energies == sorted(energies, reverse=True)
    # Indices, weights and text name the same vertices.
    other = aw.Decomposer(SHAPE).deformer(np.flatnonzero(FEET), [HEAD.astype(float)])
    other.move(0, TURN)
    assert np.array_equal(other.points, moved)


def stretch(points: np.ndarray) -> float:
    """Root of the mean square of the relative change of the edges' lengths."""
    faces = np.asarray(SHAPE.faces)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    before, after = (np.linalg.norm(p[edges[:, 0]] - p[edges[:, 1]], axis=1) for p in (SHAPE.points, points))
    return float(np.sqrt(np.mean((after / before - 1) ** 2)))


def test_lengths_are_kept_by_a_share() -> None:
    found = []
    for share in (0, 0.5, 1):
        d = SHAPE.deformer(FEET, [HEAD], keep_lengths=share)
        d.move(0, TURN)
        assert np.array_equal(d.points[FEET], SHAPE.points[FEET])
        found.append(stretch(d.points))
        assert (d.solve()["length_steps"] > 0) == (share > 0)
    assert found[0] > found[1] > found[2]
    with pytest.raises(ValueError, match=r"share of lengths must be in 0..=1, got 1.5"):
        SHAPE.deformer(FEET, [HEAD], keep_lengths=1.5)


def test_poses_are_blended_by_the_motions_of_handles() -> None:
    d = SHAPE.deformer(FEET, [HEAD])
    d.blend(0, [TURN, [0, 1, 0]], [1, 0])
    blended = d.points
    d.move(0, TURN)
    assert np.allclose(blended, d.points, atol=1e-6)
    # Half of a rotation is a rotation.
    d.blend(0, [TURN], [0.5])
    half = d.points[HEAD]
    size = np.linalg.norm(SHAPE.points[HEAD] - SHAPE.points[HEAD].mean(axis=0))
    assert np.isclose(np.linalg.norm(half - half.mean(axis=0)), size)
    with pytest.raises(ValueError, match="a share for each motion, 1 in all, got 2"):
        d.blend(0, [TURN], [0.5, 0.5])


def test_crossings_name_their_places() -> None:
    d = SHAPE.deformer(FEET, [HEAD])
    assert d.crossings() == []
    # The head moves through the feet.
    d.move(0, [0, SHAPE.points[FEET, 1].mean() - SHAPE.points[HEAD, 1].mean(), 0])
    places = d.crossings()
    assert places and all(place.n_pairs > 0 for place in places)
    assert places[0].n_pairs == max(place.n_pairs for place in places)
    low, high = d.points.min(axis=0), d.points.max(axis=0)
    assert np.all(low <= places[0].point) and np.all(places[0].point <= high)
    assert 0 <= places[0].vertex < SHAPE.n_vertices


def test_a_base_edited_elsewhere_takes_the_detail() -> None:
    bands = aw.decompose(SHAPE, levels=6)
    base = bands.scaling(6)
    assert np.allclose(bands.with_base(base), SHAPE.points, atol=1e-12)
    turned = bands.with_base(base @ TURN[:3, :3].T + TURN[:3, 3])
    assert np.allclose(turned, SHAPE.points @ TURN[:3, :3].T + TURN[:3, 3], atol=1e-12)
    for wrong, text in (
        (base[1:], "must have the"),
        (base[::-1], "another order|mirrored"),
        (base * [1, -1, 1], "mirrored"),
    ):
        with pytest.raises(ValueError, match=text):
            bands.with_base(wrong)
    with pytest.raises(ValueError, match="bands of the coordinates"):
        aw.decompose(SHAPE, SHAPE.points[:, 0], levels=3).with_base(base)


def test_detail_moves_between_shapes_and_places() -> None:
    smooth = aw.smooth(SHAPE, steps=16)
    coarse = aw.simplify(SHAPE, ratio=0.5).shape
    back = aw.transfer(SHAPE, onto=coarse, width="4%")
    assert np.linalg.norm(back.points - coarse.points, axis=1).max() > 1e-3
    assert np.abs(aw.distances(back, SHAPE).values).mean() < 1e-4
    kept = aw.transfer(SHAPE, onto=smooth, where=np.zeros(SHAPE.n_vertices))
    assert np.array_equal(kept.points, smooth.points)
    assert np.allclose(aw.morph(SHAPE, smooth, 0.0).points, SHAPE.points, atol=1e-12)
    assert np.allclose(aw.morph(SHAPE, smooth, 1.0).points, smooth.points, atol=1e-12)
    bands = aw.decompose(SHAPE, levels=5)
    same = bands.clone_detail(7, 7, "10%")
    assert np.allclose(same.points, SHAPE.points, atol=1e-9) and same.n_changed > 0
    assert np.isfinite(bands.clone_detail(7, 900, "10%", angle=1.0, levels=(1, 3)).points).all()


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: SHAPE.deformer(FEET, []), "at least one handle"),
        (lambda: SHAPE.deformer(FEET, [FEET]), "in the fixed part and in handle 1"),
        (lambda: SHAPE.deformer(FEET, [[10**6]]), "indices must be in"),
        (lambda: SHAPE.deformer(FEET, [HEAD]).move(1, [0, 0, 0]), "handle 2 does not exist"),
        (lambda: SHAPE.deformer(FEET, [HEAD]).move(0, np.diag([-1.0, 1, 1, 1])), "keep the orientation"),
        (lambda: SHAPE.deformer(FEET, [HEAD]).move(0, [np.nan, 0, 0]), "finite"),
        (lambda: SHAPE.deformer(FEET, [HEAD], stiffness=-1), "stiffness"),
        (lambda: aw.morph(SHAPE, aw.sample("sphere", vertices=500), 0.5), "same vertices"),
        (lambda: aw.morph(SHAPE, SHAPE, 0.5, by_band=[0.0] * 40), "at most"),
        (lambda: aw.transfer(SHAPE, onto=SHAPE, width=-1), "above 0"),
        (lambda: aw.decompose(SHAPE, levels=3).clone_detail(0, 1, 0), "above 0"),
    ],
)
def test_bad_input_is_named_in_one_line(call: object, text: str) -> None:
    with pytest.raises(ValueError, match=text) as caught:
        call()  # type: ignore[operator]
    assert "\n" not in str(caught.value)
