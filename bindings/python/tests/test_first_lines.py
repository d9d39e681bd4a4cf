"""Lines that people type from memory, and the messages for those that cannot run."""

from __future__ import annotations

import sys

import adwave as aw
import numpy as np
import pytest

SHAPE = aw.sample("creature", vertices=2000)
V, F = np.array(SHAPE.points), np.array(SHAPE.faces, dtype=np.int64)
N = SHAPE.n_vertices
f = V[:, 1] + 0.3 * np.sin(7 * V[:, 0])


def test_the_signal_is_the_second_argument() -> None:
    bands = aw.decompose(SHAPE, f, levels=4)
    assert bands.shape == (5, N) and np.allclose(bands.sum(axis=0), f)
    assert np.array_equal(bands, aw.decompose((V, F), f, levels=4))
    assert np.array_equal(bands, aw.decompose(V, f, faces=F, levels=4))
    assert np.array_equal(aw.saliency(SHAPE, f), aw.saliency(SHAPE, signal=f))
    assert len(aw.features(SHAPE, f, best=2)) <= 2
    assert aw.denoise(SHAPE, f).result.shape == (N,)
    assert aw.render(SHAPE, f, size=(60, 40)).array.shape == (40, 60, 4)


def test_smooth_takes_a_width_or_steps() -> None:
    wide = aw.smooth(SHAPE, f, fwhm=0.3)
    assert wide.shape == f.shape and wide.std() < f.std()
    heat = aw.Decomposer(SHAPE, operator="surface")
    assert np.array_equal(wide, heat.smooth(f, fwhm=0.3))
    walk = aw.Decomposer(SHAPE)
    assert np.array_equal(aw.smooth(SHAPE, f, steps=3), walk.smooth(f, 3))
    assert aw.smooth(SHAPE, fwhm="5%").n_vertices == N
    for options in ({}, {"fwhm": 1, "steps": 2}):
        with pytest.raises(ValueError, match="fwhm=8"):
            aw.smooth(SHAPE, f, **options)

    pytest.importorskip("scipy")
    assert np.allclose(aw.smooth(SHAPE, f, steps=3), np.linalg.matrix_power(walk.matrix().toarray(), 3) @ f)


def test_short_forms_of_levels() -> None:
    by_width = aw.decompose(SHAPE, f, fwhm=[0.1, 0.2])
    assert np.allclose(by_width.fwhm, [0.1, 0.2]) and by_width.decomposer.operator == "surface"
    assert np.array_equal(by_width, aw.decompose(SHAPE, f, levels=aw.Widths(fwhm=[0.1, 0.2])))
    assert aw.decompose(SHAPE, f, steps=[1, 3]).steps.tolist() == [1, 3]
    assert np.array_equal(aw.Decomposer(SHAPE).decompose(f, fwhm=[0.1, 0.2]), by_width)
    with pytest.raises(ValueError, match="levels and fwhm"):
        aw.decompose(SHAPE, f, levels=3, fwhm=[0.1])


def test_faces_in_the_place_of_the_signal_are_asked_about() -> None:
    for call in (aw.decompose, aw.saliency, aw.features, aw.denoise, aw.smooth, aw.render, aw.filter):
        with pytest.raises(TypeError, match=rf"aw\.{call.__name__}\(\(V, F\)(, |\))"):
            call(V, F)
    for call in (aw.match, aw.distances):
        with pytest.raises(TypeError, match=rf"aw\.{call.__name__}\(\(V, F\), \(V2, F2\)\)"):
            call(V, F)
    # Colors, and whole numbers that are no corners, are signals.
    colors = (f[:, None] % 1 * [255, 100, 30]).astype(np.uint8)
    assert aw.decompose(V, colors, levels=2).shape == (3, N, 3)
    assert aw.decompose(V, np.repeat(np.arange(N)[:, None], 3, axis=1), levels=2).shape == (3, N, 3)
    assert aw.decompose(V, np.full((N, 3), N), levels=2).shape == (3, N, 3)


def test_signals_of_any_layout() -> None:
    series = np.stack([np.stack([f, f**2, -f], axis=1) * t for t in (1.0, 2.0)], axis=2)
    bands = aw.decompose(SHAPE, series, levels=3)
    assert bands.shape == (4, N, 3, 2) and np.allclose(bands.reconstruct(), series)
    one = aw.decompose(SHAPE, f, levels=3)
    assert np.allclose(bands[:, :, 2, 1], -2 * one.array)
    rows = np.stack([f, 2 * f, 3 * f])
    by_time = aw.decompose(SHAPE, rows, levels=3)
    assert by_time.shape == (4, 3, N) and np.allclose(by_time[:, 1], 2 * one.array)
    assert np.allclose(
        by_time.apply([0, 0, 0]), np.stack([aw.decompose(SHAPE, row, levels=3).apply([0, 0, 0]) for row in rows])
    )
    assert np.allclose(aw.smooth(SHAPE, rows, steps=2)[2], 3 * aw.smooth(SHAPE, f, steps=2))
    assert aw.filter(SHAPE, rows, [0, 1]).shape == rows.shape
    assert aw.denoise(SHAPE, rows).result.shape == rows.shape
    with pytest.raises(ValueError, match=rf"\(times, {N}\)"):
        aw.decompose(SHAPE, np.zeros(7))


def test_bands_are_an_array_in_numpy() -> None:
    b = aw.decompose(SHAPE, f, levels=3)
    a = b.array
    assert (b.dtype, b.ndim, b.size, b.shape) == (np.float64, 2, a.size, a.shape)
    for found, expected in [
        (b - 1, a - 1),
        (2 * b, 2 * a),
        (abs(b), abs(a)),
        (-b, -a),
        (b**2, a**2),
        (b + b, a + a),
        (b > 0, a > 0),
        (np.exp(b), np.exp(a)),
        (b.mean(axis=1), a.mean(axis=1)),
        (b.sum(axis=0), a.sum(axis=0)),
        (b.std(), a.std()),
        (b.max(), a.max()),
        (b.T, a.T),
        (b.astype(np.float32), a.astype(np.float32)),
        (np.mean(b, axis=0), a.mean(axis=0)),
        (np.sum(b), a.sum()),
        (np.linalg.norm(b, axis=1), np.linalg.norm(a, axis=1)),
        (np.concatenate([b, b]), np.concatenate([a, a])),
        (np.stack([b, a]), np.stack([a, a])),
        (b @ f, a @ f),
        (f @ b.T, f @ a.T),
        (np.einsum("jn,n->j", b, f), np.einsum("jn,n->j", a, f)),
        (b.reshape(-1), a.reshape(-1)),
    ]:
        assert type(found) is not aw.Bands
        # Vector instructions of numpy round by where an array lies.
        np.testing.assert_allclose(found, expected, rtol=1e-14)
    with pytest.raises(TypeError, match="read-only"):
        b += 1
    with pytest.raises(AttributeError, match="no_such"):
        _ = b.no_such


def test_bands_become_an_xarray() -> None:
    pytest.importorskip("xarray")
    found = aw.decompose(SHAPE, np.stack([f, f], axis=1), levels=3).to_xarray()
    assert found.dims == ("level", "vertex", "channel") and found.sizes["level"] == 4
    assert np.allclose(found.sum("level"), np.stack([f, f], axis=1))


def test_options_of_others_are_named_before_targets_are_missed() -> None:
    with pytest.raises(TypeError, match=r"n_vertices.*vertices=100"):
        aw.simplify(SHAPE, n_vertices=100)  # type: ignore[call-overload]  # pyright: ignore


def test_a_module_without_its_package_is_no_attribute(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("torch", "adwave.torch"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setitem(sys.modules, "torch", None)
    monkeypatch.delitem(vars(aw), "torch", raising=False)
    assert not hasattr(aw, "torch")
    with pytest.raises(AttributeError, match="needs the package torch"):
        _ = aw.torch


def test_vertices_is_points() -> None:
    assert np.array_equal(SHAPE.vertices, SHAPE.points)


def test_where_takes_indices() -> None:
    flags = np.zeros(N, dtype=bool)
    flags[[3, 50, 70]] = True
    bands = aw.decompose(SHAPE, f, levels=2)
    assert np.array_equal(bands.apply([0, 1], where=[3, 50, 70]), bands.apply([0, 1], where=flags))
    with pytest.raises(ValueError, match="indices"):
        bands.apply([0, 1], where=[N])
    soft = aw.region(SHAPE, flags, blur="5%")
    assert soft.shape == (N,) and 0 < soft[3] < 1


@pytest.mark.parametrize(
    ("call", "line"),
    [
        (lambda: aw.decompose(SHAPE, f, scales=[0.1, 0.2]), r"levels=aw\.Widths\(fwhm=\[0\.1, 0\.2\]\)"),
        (lambda: aw.decompose(SHAPE, f, t=[1, 2]), r"levels=aw\.Steps\(\[1, 2\]\)"),
        (lambda: aw.smooth(SHAPE, f, t=3), "steps=3"),
        (lambda: aw.decompose(SHAPE, f, k=12), r"operator=aw\.Operator\(neighbors=12\)"),
        (lambda: aw.decompose(SHAPE, f, n_jobs=4), r"with aw\.threads\(4\)"),
        (lambda: aw.filter(SHAPE, "smooth", weights=f), "where="),
        (lambda: aw.render(SHAPE, f, cmap="magma"), r'scale=aw\.ColorScale\(color_map="magma"\)'),
        (lambda: aw.smooth(SHAPE, f, sigma=2), r"fwhm=4\.7096"),
        (lambda: aw.decompose(SHAPE, f, sigma=[1, 2]), r"levels=aw\.Widths\(fwhm=\[2\.3548, 4\.7096\]\)"),
        (lambda: aw.decompose(SHAPE, f, n_levels=5), "levels=5"),
        (lambda: aw.Decomposer(SHAPE).decompose(f, scales=[1, 2]), r"levels=aw\.Widths\(fwhm=\[1, 2\]\)"),
        (lambda: aw.filter(SHAPE, "smooth", region="ball:vertex=3,radius=5%"), 'where="ball:vertex=3,radius=5%"'),
        (lambda: aw.decompose(SHAPE, f, opertor="surface"), 'operator="surface"'),
        (lambda: aw.decompose(SHAPE, levels=[1, 2]), r"levels=aw\.Widths\(fwhm=\[1, 2\]\)"),
        (lambda: aw.decompose(SHAPE, levels=2.5), r"levels=aw\.Steps\(\[2\.5\]\)"),
        (lambda: aw.decompose(SHAPE, levels=-1), "levels=8"),
        (lambda: aw.filter(SHAPE, f), r'write aw\.filter\(SHAPE, f, "smooth"\)'),
        (lambda: aw.decompose(SHAPE, levels=3).apply(2.0), r"bands\.apply\(\[2\.0\] \* 3\)"),
        (lambda: aw.decompose(np.zeros((40, 50))), r"write aw\.decompose\(aw\.grid\(np\.zeros\(\(40, 50\)\)\)\)"),
        (lambda: aw.decompose(np.zeros((20, 30, 3))), r"aw\.grid\(np\.zeros\(\(20, 30, 3\)\), axes=\(0, 1\)\)"),
        (lambda: aw.graph(3, [[0, 1], [1, 2]], weights=[1, -1]), "edge 1 has the weight -1"),
    ],
)
def test_messages_contain_the_right_line(call, line: str) -> None:
    with pytest.raises((TypeError, ValueError), match=line) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_the_same_rule_for_all_functions() -> None:
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.Trimesh(V, F, process=False)
    mesh.vertex_attributes["heat"] = f
    for changed in (
        aw.denoise(mesh).result,
        aw.filter(mesh, "smooth"),
        aw.smooth(mesh, steps=2),
        aw.denoise(mesh, "heat").result,
        aw.filter(mesh, "heat", "smooth"),
        aw.smooth(mesh, "heat", steps=2),
        aw.simplify(mesh, ratio=0.5).shape,
    ):
        assert type(changed) is trimesh.Trimesh
    assert not np.array_equal(aw.smooth(mesh, "heat", steps=2).vertex_attributes["heat"], f)
    assert np.array_equal(aw.smooth(mesh, "heat", steps=2).vertices, mesh.vertices)
    for given in (aw.denoise(mesh, f).result, aw.filter(mesh, f, "smooth"), aw.smooth(mesh, f, steps=2)):
        assert type(given) is np.ndarray and given.shape == f.shape
    points, faces = aw.filter((V, F), "smooth")
    assert np.array_equal(faces, F) and points.shape == V.shape
    assert isinstance(aw.filter(SHAPE, "smooth"), aw.Shape)
    assert np.array_equal(points, aw.filter(SHAPE, "smooth").points)


def test_masks_and_conditions_work_everywhere() -> None:
    shape = SHAPE.with_field("part", (V[:, 1] > 1).astype(np.int32))
    inside = V[:, 1] > 1
    part = shape.select(mask=inside)
    for options in ({"mask": inside}, {"only": "part=1"}):
        bands = aw.decompose(shape, f, levels=3, **options)
        alone = aw.decompose(part, f[inside], levels=3)
        assert bands.shape == (4, N) and np.isnan(bands[:, ~inside]).all()
        assert np.array_equal(bands[:, inside], alone)
        np.testing.assert_allclose(bands.apply([0, 1, 1])[inside], alone.apply([0, 1, 1]), atol=1e-12)
        assert np.allclose(bands.energy(), alone.energy())
        found = aw.saliency(shape, f, **options)
        assert np.isnan(found[~inside]).all() and np.isfinite(found[inside]).all()
        assert inside[aw.features(shape, f, **options)["vertex"]].all()
        smooth = aw.smooth(shape, f, steps=4, **options)
        assert np.isnan(smooth[~inside]).all() and np.allclose(smooth[inside], aw.smooth(part, f[inside], steps=4))
        moved = aw.filter(shape, "smooth", levels=3, **options)
        assert np.array_equal(moved.points[~inside], V[~inside]) and not np.array_equal(moved.points[inside], V[inside])
        assert np.array_equal(moved.points[inside], aw.filter(part, "smooth", levels=3).points)
        clean = aw.denoise(shape, **options).result
        assert np.array_equal(clean.points[inside], aw.denoise(part).result.points)
        assert np.array_equal(clean.points[~inside], V[~inside])
        values = aw.filter(shape, f, [0, 1], **options)
        assert np.array_equal(values[~inside], f[~inside])
        named = aw.filter(shape.with_field("f", f), "f", [0, 1], **options)
        assert np.allclose(named["f"], values)
        assert aw.info(shape, **options).vertices == inside.sum()
        assert aw.render(shape, f, size=(40, 30), **options).array.any()
        assert inside[aw.simplify(shape, ratio=0.5, **options).vertices].all()
    with pytest.raises(ValueError, match=r"shape\.select\(mask=mask\)"):
        aw.decompose(aw.Decomposer(shape), f, mask=inside)
