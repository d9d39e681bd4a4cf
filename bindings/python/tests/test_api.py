"""The public functions on shapes of every kind, by laws and against the command."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
from pathlib import Path

import adwave as aw
import numpy as np
import pytest

CREATURE = aw.sample("creature", vertices=2000)
CLOUD = aw.Shape(aw.sample("torus", vertices=900).points)
RING = aw.graph(60, [[i, (i + 1) % 60] for i in range(60)])
POLYGONS = aw.Shape(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0], [3, 0.5, 0]],
    [[0, 1, 2, 3], [1, 4, 5, 2], [4, 6, 5]],
)
SHAPES = [CREATURE, CLOUD, POLYGONS]


def command(*words: object) -> None:
    subprocess.run([sys.executable, "-m", "adwave", *map(str, words), "--quiet"], check=True)


@pytest.mark.parametrize("shape", SHAPES)
def test_bands_add_to_the_shape(shape: aw.Shape) -> None:
    bands = aw.decompose(shape, levels=4)
    assert bands.shape == (5, shape.n_vertices, 3) and len(bands) == 5
    assert np.abs(bands.reconstruct() - shape.points).max() < 1e-12
    assert np.allclose(bands.scaling(2) + bands.wavelet(1) + bands.wavelet(2), shape.points)
    assert np.allclose(np.asarray(bands).sum(axis=0), shape.points)
    assert (np.diff(bands.rms_widths) > 0).all() and np.allclose(bands.fwhm, 1.665 * bands.rms_widths, rtol=1e-3)


def test_graphs_take_signals_of_one_or_more_channels() -> None:
    heights = np.sin(np.arange(60.0))
    one = aw.decompose(RING, signal=heights, levels=3)
    two = aw.decompose(RING, signal=np.stack([heights, -heights], axis=1), levels=3)
    assert one.shape == (4, 60) and two.shape == (4, 60, 2)
    assert np.array_equal(two.array[:, :, 0], one.array) and np.array_equal(two.array[:, :, 1], -one.array)
    with pytest.raises(ValueError, match=r"needs a signal.*write aw\.decompose\(RING, f, levels=2\)"):
        aw.decompose(RING, levels=2)


def test_a_matrix_is_a_graph() -> None:
    sparse = pytest.importorskip("scipy.sparse")
    ends = np.arange(60)
    weights = sparse.coo_array((np.ones(60), (ends, (ends + 1) % 60)), shape=(60, 60))
    shape = aw.Shape(weights + weights.T)
    f = np.cos(ends)
    assert shape.kind == "graph"
    assert np.allclose(aw.decompose(shape, signal=f, levels=3), aw.decompose(RING, signal=f, levels=3))


def test_bands_match_powers_of_the_matrix() -> None:
    pytest.importorskip("scipy")
    walk = aw.Decomposer(CREATURE)
    power = walk.matrix()
    assert np.allclose(power.sum(axis=1), 1)
    smooth = CREATURE.points
    bands = walk.decompose(levels=3)
    for level, steps in ((1, 1), (2, 2), (3, 4)):
        smooth = np.linalg.matrix_power(power.toarray(), steps) @ CREATURE.points
        assert np.allclose(bands.scaling(level), smooth, atol=1e-9)
        assert np.allclose(walk.smooth(None, steps), smooth, atol=1e-9)
    scaling, wavelets = walk.basis(3, drop_tolerance=0.0)
    assert np.allclose(scaling[2] @ CREATURE.points, smooth, atol=1e-5)
    assert np.allclose(wavelets[1] @ CREATURE.points, bands.wavelet(2), atol=1e-5)
    phi, psi = walk.functions(7, 3)
    assert np.allclose(phi, scaling[2][[7]].toarray()[0], atol=1e-6)
    assert abs(phi.sum() - 1) < 1e-9 and abs(psi.sum()) < 1e-9


@pytest.mark.parametrize("steps", [1, 0.5, 6.25])
def test_the_adjoint_is_exact(steps: float) -> None:
    pytest.importorskip("scipy")
    welded = aw.Shape(np.vstack([CREATURE.points, CREATURE.points[:50]]), CREATURE.faces)
    for shape in (CREATURE, welded):
        operator = aw.Decomposer(shape).linear_operator(steps, accuracy=1e-12)
        f, g = np.random.default_rng(1).normal(size=(2, shape.n_vertices))
        assert np.isclose(g @ operator.matvec(f), operator.rmatvec(g) @ f, rtol=1e-9)


def test_gains_change_what_they_name_and_nothing_else() -> None:
    bands = aw.decompose(CREATURE, levels=4)
    assert np.array_equal(bands.apply([1, 1, 1, 1]), CREATURE.points)
    dropped = bands.apply([0, 1, 1, 1])
    assert np.allclose(dropped, CREATURE.points - bands.wavelet(1))
    mask = np.zeros(CREATURE.n_vertices)
    mask[:100] = 1
    local = bands.apply([0, 1, 1, 1], where=mask)
    assert np.array_equal(local[100:], CREATURE.points[100:]) and np.array_equal(local[:100], dropped[:100])
    both = bands.apply([aw.Layer([0, 1, 1, 1], mask), aw.Layer([2, 1, 1, 1])])
    assert np.allclose(both[100:], CREATURE.points[100:] + bands.wavelet(1)[100:])
    assert np.allclose(bands.apply("smooth"), bands.apply(aw.preset_gains("smooth", 4)))
    for wrong, said in (([1, 1], "got 2"), ("loud", "got 'loud'"), ([1, 1, 1, np.inf], "gain")):
        with pytest.raises(ValueError, match=said):
            bands.apply(wrong)
    with pytest.raises(ValueError, match="where"):
        bands.apply([1, 1, 1, 1], where=np.ones(3))


def test_filters_give_the_bits_of_the_command(tmp_path: Path) -> None:
    source, recipe = tmp_path / "a.ply", tmp_path / "edit.toml"
    CREATURE.write(source)
    text = "lengths = ['2%', '4%', '8%']\nalong = 'normal'\n[[layer]]\ngains = [3.0, 2.0, 1.0]\nregion = 'ball:vertex=4,radius=20%'\n"
    recipe.write_text(text)
    command("filter", source, "--recipe", recipe, "-o", tmp_path / "by-recipe.ply")
    by_recipe = aw.read_recipe(recipe).apply(source)
    assert np.array_equal(aw.read(tmp_path / "by-recipe.ply").points, by_recipe.points)
    command("filter", source, "--preset", "suppress", "-j", "4", "--border", "keep", "-o", tmp_path / "by-preset.ply")
    by_preset = aw.filter(source, "suppress", levels=4, constraints=aw.Constraints(border="keep"))
    assert np.array_equal(aw.read(tmp_path / "by-preset.ply").points, by_preset.points)
    command("denoise", source, "-o", tmp_path / "clean.ply")
    assert np.array_equal(aw.read(tmp_path / "clean.ply").points, aw.denoise(source).result.points)
    command("saliency", source, "-o", tmp_path / "map.npy")
    assert np.array_equal(np.load(tmp_path / "map.npy"), aw.saliency(source))
    aw.read_recipe(recipe).write(tmp_path / "again.toml")
    assert aw.read_recipe(tmp_path / "again.toml").text == aw.read_recipe(recipe).text


RESHAPED = """levels = 3
turned = [0]
[[layer]]
preset = 'enhance'
[[clone]]
source = 100
targets = [700, 720]
radius = '6%'
angle = 30.0
strength = 0.5
[pose]
fixed = 'half-space:point=0 0 0,normal=0 0 -1'
[[pose.handle]]
region = 'ball:vertex=7,radius=10%'
by = [0.1, 0.0, 0.2]
turn = [0.0, 30.0, 0.0]
"""


@pytest.mark.parametrize("operator", ["walk", "surface"])
def test_clones_poses_and_turned_parts_give_the_bits_of_the_command(tmp_path: Path, operator: str) -> None:
    source, recipe, by_command = tmp_path / "a.ply", tmp_path / "edit.toml", tmp_path / "edited.ply"
    CREATURE.with_field("normal", CREATURE.signal("normals")).write(source)
    recipe.write_text(f"operator = '{operator}'\n{RESHAPED}")
    command("filter", source, "--recipe", recipe, "-o", by_command)
    edited = aw.read_recipe(recipe).apply(source)
    edited.write(tmp_path / "own.ply")
    assert (tmp_path / "own.ply").read_bytes() == by_command.read_bytes()
    only = aw.Recipe(RESHAPED[RESHAPED.index("[[layer]]") : RESHAPED.index("[[clone]]")].join(["levels = 3\n", ""]))
    assert not np.array_equal(only.apply(source).points, edited.points)
    assert not np.array_equal(edited.faces, CREATURE.faces)
    # Objects of other libraries keep their kind, unless their faces change.
    bent = aw.Recipe(RESHAPED.replace("turned = [0]\n", ""))
    points, faces = bent.apply((CREATURE.points, CREATURE.faces))
    assert np.array_equal(points, bent.apply(CREATURE).points) and np.array_equal(faces, CREATURE.faces)
    if operator == "walk":
        assert np.array_equal(points, edited.points)
    turned = aw.Recipe("turned = [0]").apply((CREATURE.points, CREATURE.faces))
    assert isinstance(turned, aw.Shape) and np.array_equal(turned.points, CREATURE.points)


def test_recipes_that_do_not_fit_are_refused() -> None:
    shape = CREATURE.with_field("level", CREATURE.points[:, 0])
    for text, options, said in (
        (RESHAPED.replace("levels = 3", "field = 'level'"), {}, "'level'; remove"),
        (RESHAPED, {"only": "level=0.."}, "leave mask= and only= out"),
        (RESHAPED.replace("turned = [0]", "turned = [1]"), {}, "first"),
        (RESHAPED.replace("source = 100", "source = 100000"), {}, "100000"),
        (RESHAPED.replace("vertex=7", "vertex=70000"), {}, "70000"),
    ):
        with pytest.raises(ValueError, match=said):
            aw.Recipe(text).apply(shape, **options)
    with pytest.raises(ValueError, match="must be a corner of a face"):
        aw.Recipe("turned = [0]").apply(CREATURE.points)


def test_recipes_are_made_of_layers() -> None:
    keep = aw.Constraints(border="keep")
    recipe = aw.Recipe.from_layers(
        [aw.Layer([2, 1, 1], "ball:vertex=4,radius=20%"), aw.Layer("smooth")], levels=3, constraints=keep
    )
    assert recipe.levels == 3 and "border" in recipe.text
    edited = recipe.apply(CREATURE)
    layers = [aw.Layer([2, 1, 1], "ball:vertex=4,radius=20%"), aw.Layer("smooth")]
    assert np.array_equal(edited.points, aw.filter(CREATURE, layers, levels=3, constraints=keep).points)
    with pytest.raises(ValueError, match="no weights for each vertex"):
        aw.Recipe.from_layers([aw.Layer([1], np.ones(3))])
    with pytest.raises(ValueError, match="line"):
        aw.Recipe("levels = 'many'")


def test_fields_are_filtered_and_kept(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    shape = CREATURE.with_fields({"heat": rng.normal(size=CREATURE.n_vertices), "id": np.arange(CREATURE.n_vertices)})
    smooth = aw.filter(shape, "heat", "smooth", levels=3)
    assert smooth["heat"].std() < shape["heat"].std() and np.array_equal(smooth["id"], shape["id"])
    flat = aw.filter(shape, "z", "smooth", levels=3)
    assert np.array_equal(flat.points[:, :2], shape.points[:, :2]) and not np.array_equal(flat.points, shape.points)
    smooth.write(tmp_path / "a.ply")
    assert np.array_equal(aw.read(tmp_path / "a.ply")["heat"], smooth["heat"])


def test_vertices_without_a_value_are_masked() -> None:
    signal = CREATURE.points[:, 1].copy()
    signal[10:20] = np.nan
    bands = aw.decompose(CREATURE, signal=signal, levels=3)
    assert np.isnan(bands.array[:, 10:20]).all() and np.isfinite(bands.array[:, 20:]).all()
    assert np.isfinite(bands.apply([0, 0, 0])[20:]).all()
    clean, found = aw.denoise(CREATURE, signal=signal)
    assert clean.shape == signal.shape and "noise" in found


def test_widths_mean_what_they_say() -> None:
    walk = aw.Decomposer(CREATURE, operator="surface")
    bands = walk.decompose(levels=aw.Widths(rms=[0.1, "10%"]))
    assert np.allclose(bands.rms_widths, [0.1, 0.1 * walk.diagonal])
    assert np.allclose(walk.decompose(levels=aw.Widths(fwhm=[0.2])).fwhm, [0.2])
    assert aw.decompose(CREATURE, levels=aw.Widths(rms=["5%"])).decomposer.operator == "surface"
    for wrong in ({}, {"rms": [0.1], "fwhm": [0.1]}):
        with pytest.raises(ValueError, match="exactly one of rms and fwhm"):
            aw.Widths(**wrong)
    with pytest.raises(TypeError, match=r"levels must be .*aw\.Widths"):
        walk.decompose(levels=[0.1])  # type: ignore[arg-type]


def test_levels_between_the_octaves() -> None:
    walk = aw.Decomposer(CREATURE)
    assert walk.schedule(aw.Octaves(3, voices=2)) == pytest.approx([1, 2**0.5, 2, 2**1.5, 4])
    assert walk.schedule(aw.Steps([1, 2.5])) == [1.0, 2.5] and walk.schedule(3) == [1.0, 2.0, 4.0]


def test_saliency_and_features() -> None:
    found = aw.saliency(CREATURE, options=aw.SaliencyOptions(per_level=True))
    assert found.map.shape == (CREATURE.n_vertices,) and len(found.per_level) == len(found.levels)
    assert np.allclose(sum(found.per_level), found.map)
    assert aw.saliency(CREATURE, options=aw.SaliencyOptions(unsigned=True)).map.min() >= 0
    assert aw.saliency(CREATURE, weighting="paper").sides == "unsigned"
    places = aw.features(CREATURE, options=aw.FeatureOptions(descriptors=True))
    assert len(places) == len(places.descriptors) and (np.diff(places["level"]) >= 0).all()
    assert len(aw.features(CREATURE, theta=1e9)) == 0
    with pytest.raises(ValueError, match="got 'loud'"):
        aw.features(CREATURE, options=aw.FeatureOptions(response="loud"))


def test_features_become_a_data_frame() -> None:
    pytest.importorskip("pandas")
    places = aw.features(CREATURE)
    frame = places.to_pandas()
    assert list(frame["vertex"]) == list(places["vertex"]) and np.allclose(frame[["x", "y", "z"]], places["position"])


def test_pictures_and_pages(tmp_path: Path) -> None:
    picture = aw.render(
        CREATURE, values="mean-curvature", size=(160, 120), balls=[(CREATURE.points[0], 0.1, (255, 0, 0))]
    )
    assert picture.png.startswith(b"\x89PNG") and picture.array.shape == (120, 160, 4)
    assert np.unique(picture.array.reshape(-1, 4), axis=0).shape[0] > 100
    assert aw.render(CLOUD, size=(80, 60), background=None).array[0, 0, 3] == 0
    assert "<table>" in CREATURE._repr_html_() and "data:image/png" in CREATURE._repr_html_()
    assert "<table>" in RING._repr_html_()
    aw.report(CREATURE, tmp_path / "page.html")
    assert (tmp_path / "page.html").stat().st_size > 50_000
    with pytest.raises(ValueError, match="got 'loud'"):
        aw.render(CREATURE, values="x", scale=aw.ColorScale(color_map="loud"))


def test_baselines() -> None:
    sphere = aw.sample("sphere", vertices=800)
    values, functions = aw.baselines.harmonics(sphere, 9)
    assert (
        np.allclose(values[1:4], 2, atol=0.1) and np.allclose(values[4:9], 6, atol=0.3) and functions.shape == (800, 9)
    )
    assert aw.baselines.heat_kernel_signature(sphere, k=20, scales=5)[1].shape == (800, 5)
    assert aw.baselines.wave_kernel_signature(sphere, k=20, scales=5)[1].shape == (800, 5)
    assert aw.baselines.lee_saliency(CREATURE)[0].min() >= 0
    assert isinstance(aw.baselines.taubin(CREATURE), aw.Shape)
    assert np.allclose(aw.baselines.taubin(CREATURE, signal=np.ones(CREATURE.n_vertices)), 1)


@pytest.mark.parametrize("family", ["meyer", "mexican-hat", "abspline", "itersine"])
def test_graph_wavelets_go_there_and_back(family: str) -> None:
    small = aw.sample("torus", vertices=400)
    frame = aw.baselines.GraphWavelets(small, 6, family=family, accuracy=1e-4)
    f = small.points[:, 0]
    coefficients = frame.analyze(f)
    assert coefficients.shape == (6, small.n_vertices)
    assert np.abs(frame.synthesize(coefficients) - f).max() < 1e-6
    assert np.allclose(frame.analyze("coords")[:, :, 0], coefficients)
    squares = (frame.kernels(np.linspace(0, 2, 50)) ** 2).sum(axis=0)
    assert frame.bounds[0] - 1e-9 <= squares.min() and squares.max() <= frame.bounds[1] + 1e-9
    assert np.array_equal(pickle.loads(pickle.dumps(frame)).analyze(f), coefficients)
    # By the matrix itself: I − Q is twice what Φ₁ loses, and its symmetric form has the same functions.
    pytest.importorskip("scipy")
    dense = np.eye(small.n_vertices) - frame.decomposer.matrix().toarray()
    values, vectors = np.linalg.eig(2 * dense)
    by_eigen = (vectors * frame.kernels(values.real)[2]) @ np.linalg.solve(vectors, f)
    assert np.abs(by_eigen.real - coefficients[2]).max() < 1e-3 * np.abs(f).max()


@pytest.mark.parametrize("biorthogonal", [False, True])
def test_diffusion_wavelets_go_there_and_back(biorthogonal: bool) -> None:
    wavelets = aw.baselines.DiffusionWavelets(RING, 6, biorthogonal=biorthogonal)
    f = np.sin(np.arange(60.0))
    coefficients = wavelets.analyze(f)
    assert wavelets.ranks[0] == 60 and wavelets.ranks[-1] < 60
    assert sum(len(c) for c in coefficients) == 60
    assert np.abs(wavelets.synthesize(coefficients) - f).max() < 1e-9
    level = len(wavelets.ranks) - 1
    phi, dual = wavelets.scaling_functions(level), wavelets.duals(level)
    assert phi.shape == (wavelets.ranks[-1], 60) and np.allclose(dual @ phi.T, np.eye(len(phi)), atol=1e-4)
    with pytest.raises(ValueError, match=r"level must be in 1..=.*, got 99"):
        wavelets.wavelets(99)


def test_differential_coordinates_bring_the_shape_back() -> None:
    delta = aw.baselines.differential_coordinates(CREATURE)
    held = [0, 700, 1500]
    back = aw.baselines.from_differential_coordinates(CREATURE, delta, held, CREATURE.points[held])
    assert np.abs(back - CREATURE.points).max() < 1e-6
    with pytest.raises(ValueError, match="anchor"):
        aw.baselines.from_differential_coordinates(CREATURE, delta, [10**6], np.zeros((1, 3)))
    half = aw.baselines.differential_coordinates(CREATURE, signal="x", weights="uniform")
    assert half.shape == (CREATURE.n_vertices, 1) or half.shape == (CREATURE.n_vertices,)


def test_the_feature_map_obeys_eulers_law() -> None:
    found = aw.baselines.feature_map(CREATURE, [0.0, 0.01, 0.1])
    assert [level.index_sum for level in found] == [2, 2, 2]
    for level in found:
        kinds = level.points["kind"].astype(int)
        signs = np.where(kinds == 0, -level.points["multiplicity"], 1)
        assert signs.sum() == 2
    assert len(found[2].points) < len(found[0].points)
    with pytest.raises(ValueError, match="time 0 must be finite, at least 0"):
        aw.baselines.feature_map(CREATURE, [-1.0])


def test_features_are_found_again_on_changed_shapes(tmp_path: Path) -> None:
    found = aw.repeatability(CREATURE, trials=aw.Trials(noise=[0.0, 0.3], runs=1), theta=1.2)
    changes = {str(row["change"]): row for row in found.changes}
    assert changes["noise 0"]["share"] == 1 and changes["rotation"]["share"] == 1 and changes["scaling"]["share"] == 1
    assert found.levels["features"][found.levels["change"] == "rotation"].sum() == len(found.features)
    # The command counts the same.
    source = tmp_path / "c.ply"
    CREATURE.write(source)
    words = ["evaluate", source, "--percent", "30", "--runs", "1", "--theta", "1.2", "--json", "--quiet"]
    told = subprocess.run([sys.executable, "-m", "adwave", *map(str, words)], check=True, capture_output=True)
    rows = {row["change"]: row for row in json.loads(told.stdout)["changes"]}
    for ours, theirs in (
        ("noise 0.3", "noise 30 %"),
        ("resampling", "4 × the faces"),
        ("other-vertices", "other vertices"),
    ):
        levels = rows[theirs]["levels"]
        share = sum(level["found"] for level in levels) / sum(level["features"] for level in levels)
        assert changes[ours]["share"] == pytest.approx(share) and changes[ours]["right"] == rows[theirs]["precision"]
    bigger = aw.ChangedShape(CREATURE, "scaling", 2.0)
    assert np.allclose(bigger.undo_motion(bigger.shape.points), CREATURE.points)
    assert np.array_equal(pickle.loads(pickle.dumps(bigger)).shape.points, bigger.shape.points)
    with pytest.raises(ValueError, match="got 'melt'"):
        aw.ChangedShape(CREATURE, "melt")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="no coordinates"):
        aw.repeatability(RING, signal="coords", trials=aw.Trials(noise=[]))


def test_a_result_goes_where_it_is_told() -> None:
    for signal in (None, CREATURE.points[:, 1]):
        bands = aw.decompose(CREATURE, signal=signal, levels=3)
        fresh = bands.apply([2, 1, 0])
        out = np.full_like(fresh, 7.0)
        assert bands.apply([2, 1, 0], out=out) is out and np.array_equal(out, fresh)
        assert bands.apply([1, 1, 1], "ball:vertex=0,radius=10%", out=out) is out
        assert np.array_equal(out, bands.apply([1, 1, 1]))
        for wrong in (np.empty(3), np.empty(fresh.shape, dtype=np.float32), fresh.tolist()):
            with pytest.raises(ValueError, match=r"^out: "):
                bands.apply([2, 1, 0], out=wrong)
        out.setflags(write=False)
        with pytest.raises(ValueError, match="cannot be written"):
            bands.apply([2, 1, 0], out=out)
    with pytest.raises(ValueError, match="C-contiguous"):
        aw.decompose(CREATURE, levels=2).apply([1, 1], out=np.empty((3, CREATURE.n_vertices)).T)


def test_a_filter_takes_arrays_too() -> None:
    heights = np.array(CREATURE.points[:, 2])
    changed = aw.filter(CREATURE, heights, [0, 0, 1], local_fit="constant")
    assert isinstance(changed, np.ndarray) and changed.shape == heights.shape
    # Bands are those of the operator itself, without a local fit; gains that hold everywhere are one polynomial.
    by_bands = aw.decompose(CREATURE, signal=heights, levels=3).apply([0, 0, 1])
    assert np.abs(changed - by_bands).max() < 1e-9 * np.abs(heights).max()


def test_files_keep_what_they_had(tmp_path: Path) -> None:
    source = tmp_path / "a.obj"
    source.write_text("# kept\nv 0 0 0\nv 1.50 0 0\nv 0 1 0\nf 1 2 3\n")
    shape = aw.read(source)
    points = np.array(shape.points)
    points[0, 2] = 0.25
    assert shape.with_points(points).write(tmp_path / "b.obj") == []
    assert (tmp_path / "b.obj").read_text() == "# kept\nv 0 0 0.25\nv 1.50 0 0\nv 0 1 0\nf 1 2 3\n"
    assert aw.read_bytes(source.read_bytes(), "a.obj").n_faces == 1
    assert shape.with_field("heat", [1.0, 2.0, 3.0]).write(tmp_path / "c.stl") != []


@pytest.mark.parametrize(
    ("wrong", "error", "said"),
    [
        (lambda: aw.read("no-such-file.obj"), FileNotFoundError, "no-such-file.obj"),
        (lambda: aw.read_bytes(b"\x00\x01\x02"), ValueError, "content: is of an unknown format"),
        (lambda: aw.sample("teapot"), ValueError, "teapot"),
        (lambda: aw.decompose([]), ValueError, "no vertices"),
        (lambda: aw.decompose(np.empty((0, 3))), ValueError, "no vertices"),
        (lambda: aw.decompose([[0, 0, np.nan]]), ValueError, "row 0"),
        (lambda: aw.decompose(CREATURE, levels=0), ValueError, "level"),
        (lambda: aw.decompose(CREATURE, levels=99), ValueError, "level"),
        (lambda: aw.decompose(CREATURE, accuracy=3.0), ValueError, "accuracy"),
        (lambda: aw.decompose(CREATURE, signal=np.ones(3)), ValueError, "signal"),
        (lambda: aw.decompose(CREATURE, signal="no-such"), ValueError, "no-such"),
        (lambda: aw.decompose(CREATURE, loud=True), TypeError, "loud"),
        (lambda: aw.decompose(CREATURE, operator="loud"), ValueError, "got 'loud'"),
        (lambda: aw.decompose(CREATURE, operator=aw.Operator(rings=0)), ValueError, "rings"),
        (lambda: aw.filter(CREATURE), TypeError, r"write aw\.filter\(CREATURE, \"smooth\"\)"),
        (lambda: aw.region(CREATURE, "ball:nowhere"), ValueError, "region"),
        (lambda: aw.Decomposer(CREATURE).functions(-1, 2), ValueError, "vertex"),
        (lambda: CREATURE.write("a.nothing"), ValueError, "a.nothing"),
        (lambda: CREATURE.with_points(np.zeros((3, 3))), ValueError, "one per vertex; got 3"),
        (lambda: CREATURE.with_field("a", np.zeros(3)), ValueError, "field 'a'"),
        (lambda: aw.threads(-1), ValueError, "threads"),
    ],
)
def test_errors_say_what_is_wrong(wrong, error, said) -> None:
    with pytest.raises(error, match=said) as caught:
        wrong()
    assert "\n" not in str(caught.value)


def test_extreme_shapes_end(capfd: pytest.CaptureFixture[str]) -> None:
    one = aw.decompose([[1.0, 2.0, 3.0]], levels=2)
    assert np.array_equal(one.reconstruct(), [[1.0, 2.0, 3.0]])
    same = aw.decompose(np.ones((50, 3)), levels=2)
    assert np.array_equal(same.reconstruct(), np.ones((50, 3)))
    huge = aw.decompose(CREATURE.with_points(1e90 * CREATURE.points), levels=3)
    assert np.isfinite(huge.array).all()
    assert capfd.readouterr() == ("", "")


def test_the_command_is_in_the_package() -> None:
    out = subprocess.run(
        [sys.executable, "-m", "adwave", "info", "sample:sphere", "--json"], capture_output=True, text=True
    )
    assert out.returncode == 0 and '"kind": "mesh"' in out.stdout
    wrong = subprocess.run([sys.executable, "-m", "adwave", "info", "sample:teapot"], capture_output=True, text=True)
    assert wrong.returncode == 2 and "teapot" in wrong.stderr


def test_part_of_a_cloud(tmp_path: Path) -> None:
    x, y, z = np.meshgrid(np.arange(9.0), np.arange(8.0), np.arange(2.0))
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    path = tmp_path / "a.laz"
    aw.Shape(points).write(path)
    low, high = np.array([2.0, 1.0, 1.0]), np.array([5.0, 3.0, 9.0])
    inside = points[((points >= low) & (points <= high)).all(axis=1)]
    for box in ([*low, *high], (low, high), np.array([low, high])):
        np.testing.assert_array_equal(aw.read(path, box=box).points, inside)
    flat = points[((points[:, :2] >= low[:2]) & (points[:, :2] <= high[:2])).all(axis=1)]
    np.testing.assert_array_equal(aw.read(path, box=(2, 1, 5, 3)).points, flat)
    with pytest.raises(ValueError, match=r"^box: .*, got 3 numbers"):
        aw.read(path, box=(1, 2, 3))
    with pytest.raises(ValueError, match="box"):
        aw.read(path, box=(90, 90, 99, 99))
    with pytest.raises(ValueError, match="resolution"):
        aw.read(path, resolution=-1)


def test_rows_without_a_position_keep_their_numbers() -> None:
    cloud = aw.read_bytes(b"0 0 1\nnan nan nan\n2 0 3\n", "a.xyz")
    assert (cloud.n_vertices, cloud.file_rows.tolist()) == (2, [0, 2])
    heights = cloud.in_file_rows(cloud.points[:, 2])
    assert heights[[0, 2]].tolist() == [1.0, 3.0] and np.isnan(heights[1])
    with pytest.raises(ValueError, match="must have 2 rows"):
        cloud.in_file_rows([1.0, 2.0, 3.0])


def test_a_part_is_computed_on_and_the_rest_comes_back(tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    points = np.column_stack([rng.uniform(0, 20, (900, 2)), rng.normal(0, 0.03, 900)])
    is_ground = np.arange(900) % 3 != 1
    points[~is_ground, 2] += 5
    cloud = aw.Shape(points, fields={"classification": np.where(is_ground, 2, 5).astype(np.uint8)})
    ground = cloud.select("classification=2")
    assert ground.kind == "cloud" and ground.file_rows.tolist() == np.flatnonzero(is_ground).tolist()
    alone = aw.denoise(aw.Shape(points[is_ground])).result.points
    np.testing.assert_array_equal(aw.denoise(ground).result.points, alone)
    assert np.isnan(ground.in_file_rows(ground.points[:, 2])[~is_ground]).all()
    path = tmp_path / "all.ply"
    ground.with_points(alone).write(path)
    back = aw.read(path)
    np.testing.assert_array_equal(back.points[~is_ground], points[~is_ground])
    np.testing.assert_array_equal(back.points[is_ground], alone)
    for same in (
        cloud.select(mask=is_ground),
        cloud.select(mask=np.where(is_ground, 3.5, np.nan)),
        cloud.select(mask=~is_ground, invert_mask=True),
        cloud.select(["classification=..3", "z=-1..1"]),
        aw.read(path, only="classification=2"),
    ):
        assert same.file_rows.tolist() == ground.file_rows.tolist()
    np.save(tmp_path / "mask.npy", is_ground)
    assert aw.read(path, mask=tmp_path / "mask.npy").n_vertices == is_ground.sum()
    # A mask with a row for each row of the file works on a part too.
    assert ground.select(mask=np.arange(900) < 30).file_rows.tolist() == np.flatnonzero(is_ground[:30]).tolist()
    for wrong, message in (
        ({"only": "class=2"}, "use classification, x, y, z"),
        ({"only": "classification"}, "must be FIELD=VALUE"),
        ({"only": "classification=9"}, "no vertex fulfills classification=9; the values of the field are 2 to 5"),
        ({"mask": [1, 0]}, "one number for each of 900 vertices"),
        ({"mask": np.zeros(900)}, "a vertex that takes part"),
        ({"mask": "none.npy"}, "there is no mask file"),
    ):
        with pytest.raises(ValueError, match=message):
            cloud.select(**wrong)


def test_withheld_and_noise_points_are_left_out_with_a_warning(tmp_path: Path) -> None:
    points = np.random.default_rng(3).uniform(0, 9, (60, 3)).round(2)
    classes, flags = np.full(60, 2, dtype=np.uint8), np.zeros(60, dtype=np.uint8)
    classes[[4, 9]], flags[20] = (7, 18), 4
    path = tmp_path / "scan.las"
    aw.Shape(points, fields={"classification": classes, "classification_flags": flags}).write(path)
    with pytest.warns(UserWarning, match="3 of 60 points are flagged"):
        scan = aw.read(path)
    assert scan.n_vertices == 57 and 20 not in scan.file_rows
    assert aw.read(path, all_points=True).n_vertices == 60
    assert aw.read_bytes(path.read_bytes(), all_points=True).n_vertices == 60
    scan.with_points(scan.points + 1).write(tmp_path / "out.las")
    out = aw.read(tmp_path / "out.las", all_points=True)
    moved = np.abs(out.points - points).max(axis=1) > 0.5
    assert np.flatnonzero(~moved).tolist() == [4, 9, 20]
