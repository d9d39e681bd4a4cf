"""A request means the same however the shape was prepared, and an option that has no effect is an error."""

from __future__ import annotations

import pickle
import warnings
from pathlib import Path

import adwave as aw
import numpy as np
import pytest

SHAPE = aw.sample("creature", vertices=2000)
N = SHAPE.n_vertices
f = SHAPE.points[:, 1] ** 2
WIDTHS = aw.Widths(fwhm=[0.1, 0.2, 0.4])


def test_a_prepared_shape_takes_the_operator_of_the_request() -> None:
    prepared = aw.Decomposer(SHAPE)
    copy = pickle.loads(pickle.dumps(prepared))
    gap = np.where(np.arange(N) < 9, np.nan, f)
    for levels, kind in ((WIDTHS, "surface"), (4, "walk"), (aw.Steps([1, 2]), "walk")):
        for signal in (f, gap):
            direct = aw.decompose(SHAPE, signal, levels=levels)
            assert direct.decomposer.operator == kind
            for found in (
                prepared.decompose(signal, levels=levels),
                copy.decompose(signal, levels=levels),
                aw.decompose(prepared, signal, levels=levels),
            ):
                np.testing.assert_array_equal(found, direct)
    assert np.array_equal(prepared.smooth(f, fwhm=0.2), aw.smooth(SHAPE, f, fwhm=0.2))
    assert np.array_equal(aw.saliency(prepared, levels=WIDTHS), aw.saliency(SHAPE, levels=WIDTHS))
    smooth = aw.filter(prepared, [0, 1, 1], levels=WIDTHS).points
    assert np.array_equal(smooth, aw.filter(SHAPE, [0, 1, 1], levels=WIDTHS).points)
    masked = prepared.with_mask(np.arange(N) < 9)
    assert np.array_equal(masked.decompose(f, levels=WIDTHS), prepared.decompose(gap, levels=WIDTHS), equal_nan=True)


def test_an_operator_that_was_chosen_stays() -> None:
    walk = aw.Decomposer(SHAPE, operator="walk")
    assert walk.decompose(f, levels=WIDTHS).decomposer.operator == "walk"
    assert aw.Decomposer(SHAPE, operator=aw.Operator(rings=2)).decompose(f, levels=WIDTHS).decomposer.operator == "walk"
    with pytest.raises(ValueError, match="operator: this Decomposer was prepared with"):
        aw.decompose(walk, f, levels=WIDTHS, operator="surface")
    with pytest.raises(ValueError, match="operator='surface'"):
        aw.Decomposer(SHAPE).schedule(WIDTHS)


def test_options_without_effect_are_errors() -> None:
    walk = aw.Decomposer(SHAPE)
    with pytest.raises(ValueError, match="border must be one of 'natural', 'keep', 'free', got 'banana'"):
        aw.Constraints(border="banana")  # type: ignore[arg-type]
    for signal in (f, "x"):
        with pytest.raises(ValueError, match=r"constraints: .* leave them out"):
            aw.filter(walk, signal, [0, 1], constraints=aw.Constraints(volume="keep", along="normal"))
    edges = np.stack([np.arange(30), np.arange(30) + 1], axis=1)
    curve = aw.Decomposer(aw.graph(31, edges, points=np.c_[np.arange(31), np.sin(np.arange(31)), np.zeros(31)]))
    free = aw.Constraints(border="free")
    with pytest.raises(ValueError, match=r"aw\.filter\(decomposer\.shape"):
        aw.filter(curve, [0, 1], constraints=free)
    prepared = aw.Decomposer(curve.shape, operator=aw.Operator().with_free_ends())
    assert np.array_equal(
        aw.filter(prepared, [0, 1], constraints=free).points, aw.filter(curve.shape, [0, 1], constraints=free).points
    )
    with pytest.raises(TypeError, match=r"aw\.denoise\(decomposer\.shape"):
        aw.denoise(aw.Decomposer(SHAPE, operator=aw.Operator(rings=2)))
    with pytest.raises(TypeError, match="mask"):
        aw.denoise(walk.with_mask(np.arange(N) < 3))
    with pytest.raises(ValueError, match="faces"):
        aw.decompose(walk, f, faces=SHAPE.faces)


def test_each_column_has_its_own_mask() -> None:
    values = np.stack([f, f, f], axis=1)
    values[:40, 1] = np.nan
    alone = [aw.decompose(SHAPE, values[:, c], levels=3) for c in range(3)]
    bands = aw.decompose(SHAPE, values, levels=3)
    for c in range(3):
        np.testing.assert_array_equal(bands[:, :, c], alone[c])
    assert np.isfinite(bands[:, :, [0, 2]]).all() and np.isnan(bands[:, :40, 1]).all()
    edited = bands.apply([0, 2, 1])
    for c in range(3):
        np.testing.assert_allclose(edited[:, c], alone[c].apply([0, 2, 1]), atol=1e-12)
    walk = aw.Decomposer(SHAPE)
    for call in (lambda v: walk.smooth(v, 3), lambda v: walk.combine_bands(v, [1, 2], [1, 4])):
        np.testing.assert_allclose(call(values)[:, 1], call(values[:, 1]), atol=1e-12)
        np.testing.assert_allclose(call(values)[:, 0], call(values[:, 0]), atol=1e-12)
    again = pickle.loads(pickle.dumps(bands))
    np.testing.assert_array_equal(again, bands)


def test_a_negative_weight_is_named_as_it_is() -> None:
    with pytest.raises(ValueError, match="edge 1 has the weight -1,"):
        aw.graph(3, [[0, 1], [1, 2]], weights=[2, -1])
    sparse = pytest.importorskip("scipy.sparse")
    with pytest.raises(ValueError, match="weight -1,"):
        aw.Shape(sparse.csr_array(np.array([[0.0, -1.0], [-1.0, 0.0]])))


def test_heat_stays_in_the_range_of_a_mask_where_the_walk_does_not() -> None:
    flags = (SHAPE.points[:, 1] > 1).astype(float)
    walk, heat = (aw.smooth(SHAPE, flags, steps=0.3, operator=kind) for kind in ("walk", "surface"))
    assert walk.min() < -1e-3 and "leave the range" in (aw.smooth.__doc__ or "")
    assert heat.min() > -1e-9 and heat.max() < 1 + 1e-9


def test_raised_masses_are_reported_and_can_be_left_alone() -> None:
    rng = np.random.default_rng(5)
    uneven = SHAPE.with_points(SHAPE.points + 0.01 * rng.normal(size=SHAPE.points.shape))
    raised = aw.info(uneven, operator="surface")
    exact = aw.info(uneven, operator="surface", exact=True)
    assert 0 < raised.raised_masses <= 0.011 * N and raised.added_mass > 0
    assert exact.raised_masses == 0 and exact.added_mass == 0
    assert "raised_masses" not in aw.info(uneven)
    signal = rng.normal(size=N)
    by_default, without = (aw.smooth(uneven, signal, fwhm=0.05, exact=flag) for flag in (False, True))
    assert np.array_equal(
        without, aw.Decomposer(uneven, operator=aw.Operator("surface").with_exact_masses()).smooth(signal, fwhm=0.05)
    )
    assert 0 < np.abs(without - by_default).max() < 0.5
    # The definition: exp(−τ·M⁻¹L), with the masses of the mesh.
    areas = aw.Decomposer(uneven, operator=aw.Operator("surface").with_exact_masses()).areas
    assert np.isclose(areas @ without, areas @ signal, rtol=1e-9)
    assert not np.isclose(areas @ by_default, areas @ signal, rtol=1e-9)
    bands = aw.decompose(uneven, signal, fwhm=[0.05, 0.1])
    assert bands.info["raised_masses"] == raised.raised_masses and bands.info["added_mass"] == raised.added_mass
    assert aw.decompose(uneven, signal, fwhm=[0.05, 0.1], exact=True).info["added_mass"] == 0
    assert "added_mass" not in aw.decompose(uneven, signal, levels=2).info
    with pytest.raises(ValueError, match="prepared with"):
        aw.smooth(aw.Decomposer(uneven, operator="surface"), signal, fwhm=0.05, exact=True)


def test_the_walk_that_always_steps() -> None:
    pytest.importorskip("scipy")
    weights = np.array([[0.0, 2, 1], [2, 0, 0], [1, 0, 0]])
    import scipy.sparse as sparse

    walk = aw.Decomposer(sparse.csr_array(weights), operator="walk")
    assert np.allclose(walk.matrix(lazy=False).toarray(), weights / weights.sum(axis=1, keepdims=True))
    assert np.allclose(walk.matrix().toarray(), 0.5 * (np.eye(3) + walk.matrix(lazy=False).toarray()))
    with pytest.raises(ValueError, match="operator='walk'"):
        aw.Decomposer(SHAPE, operator="surface").matrix(lazy=False)
    shape = sparse.csr_array(weights)
    x = np.array([[1.0, 0], [2, 1], [4, np.nan]])
    step = weights / weights.sum(axis=1, keepdims=True)
    found = aw.smooth(shape, x, steps=2, lazy=False)
    assert np.allclose(found[:, 0], step @ step @ x[:, 0]) and np.allclose(found[:2, 1], [0, 1])
    assert np.isnan(found[2, 1])
    assert np.allclose(walk.smooth(x[:, 0], 2, lazy=False), found[:, 0])
    with pytest.raises(ValueError, match="whole steps"):
        aw.smooth(shape, x, steps=1.5, lazy=False)


def test_texture_coordinates_survive(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    uv = SHAPE.points[:, :2] / 2
    mesh = trimesh.Trimesh(SHAPE.points, SHAPE.faces, process=False)
    mesh.visual = trimesh.visual.TextureVisuals(uv=uv)
    shape = aw.Shape(mesh)
    for name in ("x.obj", "x.glb", "x.ply"):
        assert [loss for loss in shape.write(tmp_path / name) if "texture" in loss] == []
        assert np.allclose(aw.read(tmp_path / name)["texcoord"], uv, atol=1e-6)
    again = aw.read(tmp_path / "x.obj")
    assert np.allclose(again.to_trimesh().visual.uv, uv, atol=1e-6)
    assert np.allclose(aw.filter(mesh, "smooth").visual.uv, uv)
    if (pv := pytest.importorskip("pyvista")) is not None:
        poly = again.to_pyvista()
        assert np.allclose(poly.active_texture_coordinates, uv, atol=1e-6)
        assert np.allclose(aw.Shape(poly)["texcoord"], uv, atol=1e-6)
        assert np.allclose(aw.filter(poly, "smooth").active_texture_coordinates, uv, atol=1e-6)
        assert isinstance(poly, pv.PolyData)


def test_what_does_not_survive_is_named(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("PIL")
    from PIL import Image

    mesh = trimesh.Trimesh(SHAPE.points, SHAPE.faces, process=False)
    mesh.visual = trimesh.visual.TextureVisuals(uv=SHAPE.points[:, :2], image=Image.new("RGB", (4, 4)))
    lost = aw.Shape(mesh).with_points(2 * SHAPE.points).write(tmp_path / "x.obj")
    assert any("material" in each for each in lost)
    # Texture coordinates of corners on a seam have no place at a vertex.
    seam = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 0.5 0.5\nf 1/1 2/2 3/3\nf 2/4 4/1 3/2\n"
    shape = aw.read_bytes(b"".join([seam.encode()]), "seam.obj")
    with pytest.warns(UserWarning, match="without .*texture"):
        shape.to_trimesh()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        SHAPE.to_trimesh()


def test_the_accessor_takes_every_signal() -> None:
    pytest.importorskip("pyvista", minversion="0.48")
    import adwave.pyvista  # noqa: F401 (where the package is not installed there is no entry point)

    mesh = SHAPE.to_pyvista()
    mesh.point_data["elev"] = f
    clean = mesh.adwave.denoise(signal="elev")
    assert np.array_equal(clean.points, mesh.points) and not np.array_equal(clean["elev"], f)
    assert mesh.adwave.filter(f, [0, 1]).shape == (N,)
    assert mesh.adwave.denoise(f).shape == (N,)
    assert mesh.adwave.smooth("elev", fwhm=0.2).n_points == N
    assert mesh.adwave.decompose("elev", levels=3).shape == (4, N)
    assert mesh.adwave.bands("elev", levels=3)["W1"].shape == (N,)
    assert mesh.adwave.simplify(ratio=0.5).n_points < 0.6 * N
    assert mesh.adwave.match(mesh).motion.shape == (4, 4)
    assert mesh.adwave.region([1, 2]).sum() == 2 and mesh.adwave.info().closed
    assert mesh.adwave.render("elev", size=(30, 20)).array.shape == (20, 30, 4)


def test_weights_that_are_not_used_as_they_are_are_warned_of() -> None:
    sparse = pytest.importorskip("scipy.sparse")
    weights = np.array([[0.0, 2, 1], [2, 0, 0], [1, 0, 0]])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        aw.Shape(sparse.csr_array(weights))
    for changed, message in (
        (weights / weights.sum(axis=1, keepdims=True), "looks like a walk"),
        (np.triu(weights), "not symmetric"),
        (weights + np.eye(3), "diagonal"),
    ):
        with pytest.warns(UserWarning, match=message):
            aw.Shape(sparse.csr_array(changed))


def test_recipes_and_baselines_follow_the_rule_of_results() -> None:
    points, faces = np.array(SHAPE.points), np.array(SHAPE.faces)
    recipe = aw.Recipe("levels = 3\n[[layer]]\npreset = 'smooth'")
    moved, same = recipe.apply((points, faces))
    assert np.array_equal(moved, recipe.apply(SHAPE).points) and np.array_equal(same, faces)
    assert isinstance(aw.baselines.taubin((points, faces), iterations=2), tuple)


def test_simplification_keeps_more_vertices_where_weights_are_large():
    shape = aw.sample("sphere", vertices=3000)
    upper = np.asarray(shape.points)[:, 2] > 0
    found = aw.simplify(shape, vertices=300, weights=np.where(upper, 16.0, 1.0))
    assert found.shape.n_vertices == 300
    assert 0.72 < upper[found.vertices].mean() < 0.88  # 16 gives 4 times the density
    with pytest.raises(ValueError, match="weights are for meshes, got a cloud"):
        aw.simplify(np.asarray(shape.points), ratio=0.5, weights=np.ones(3000))
    with pytest.raises(ValueError, match="weights must be finite"):
        aw.simplify(shape, ratio=0.5, weights=np.full(shape.n_vertices, np.nan))
    named = aw.simplify(shape, ratio=0.5, weights="mean-curvature")
    assert named.shape.n_vertices == round(0.5 * shape.n_vertices)
