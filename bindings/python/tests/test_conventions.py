"""Conventions of other libraries: estimators of scikit-learn, images on surfaces, number types, progress, Ctrl-C."""

from __future__ import annotations

import io
import os
import subprocess
import sys
import textwrap
import warnings
from typing import Any

import adwave as aw
import numpy as np
import pytest

SHAPE = aw.sample("sphere", vertices=600)
V, F = np.array(SHAPE.points), np.array(SHAPE.faces, dtype=np.int64)
f = V[:, 2] + 0.05 * np.random.default_rng(1).normal(size=len(V))


#: Checks of scikit-learn that cannot pass, and why.
EXCEPTIONS: dict[str, dict[str, str]] = {"SignalBands": {}, "WaveletFeatures": {}}


@pytest.mark.parametrize("name", ["SignalBands", "WaveletFeatures"])
def test_estimators_pass_the_checks_of_scikit_learn(name: str) -> None:
    pytest.importorskip("sklearn", minversion="1.6")
    from sklearn.utils.estimator_checks import check_estimator

    estimator = getattr(aw.sklearn, name)()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        results: Any = check_estimator(estimator, expected_failed_checks=EXCEPTIONS[name], on_fail=None)
    failed = {each["check_name"]: str(each["exception"]) for each in results if each["status"] == "failed"}
    assert not failed, failed
    # The tags of `WaveletFeatures` say that it takes shapes, which leaves one check.
    assert sum(each["status"] == "passed" for each in results) >= (40 if name == "SignalBands" else 1)


def test_an_unfitted_transformer_says_so() -> None:
    pytest.importorskip("sklearn")
    from sklearn.exceptions import NotFittedError

    for method in ("transform", "inverse_transform"):
        with pytest.raises(NotFittedError, match="fit"):
            getattr(aw.sklearn.SignalBands(SHAPE), method)(f[None])
    with pytest.raises(NotFittedError):
        aw.sklearn.SignalBands(SHAPE).get_feature_names_out()


def test_both_hemispheres_in_one_call() -> None:
    surface = pytest.importorskip("nilearn.surface")
    pytest.importorskip("sklearn")
    half = surface.InMemoryMesh(V, F)
    mesh = surface.PolyMesh(left=half, right=surface.InMemoryMesh(V + 5, F))
    times = np.random.default_rng(0).normal(size=(len(V), 3)).astype(np.float32)
    image = surface.SurfaceImage(mesh, {"left": times, "right": 2 * times})
    masker = aw.sklearn.SignalBands(levels=aw.Widths(fwhm=[0.3]), output="smooth")
    rows = masker.fit_transform(image)
    assert rows.shape == (3, 2 * len(V)) and rows.dtype == np.float32
    expected = aw.smooth((V, F), times, fwhm=0.3)
    assert np.allclose(rows[:, : len(V)].T, expected, atol=1e-5)
    again = masker.inverse_transform(rows)
    assert type(again) is type(image)
    assert np.allclose(again.data.parts["right"], 2 * expected, atol=1e-5)
    one = surface.SurfaceImage(mesh, {"left": f, "right": f})
    split = aw.sklearn.SignalBands(levels=3)
    back = split.fit(one).inverse_transform(split.transform(one))
    assert back.data.parts["left"].shape == f.shape and np.allclose(back.data.parts["left"], f)


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64, np.int32])
def test_numbers_come_back_in_their_type(dtype: type) -> None:
    values = (10 * f).astype(dtype)
    expected = np.dtype(np.float64) if dtype is np.int32 else np.dtype(dtype)
    walk = aw.point_walk(V, neighbors=6, stay=0.5)
    grid = aw.grid(np.ones((20, 30)))
    image = values.astype(dtype)[:600].reshape(20, 30)
    for found in (
        aw.smooth(SHAPE, values, steps=2),
        aw.smooth(SHAPE, values, fwhm=0.3),
        aw.filter(SHAPE, values, [0, 1]),
        aw.denoise(SHAPE, values).result,
        aw.decompose(SHAPE, values, levels=2).array,
        aw.decompose(SHAPE, values, levels=2).apply([0, 1]),
        aw.decompose(SHAPE, values, levels=2).reconstruct(),
        walk.smooth(values, 2),
        aw.Decomposer(SHAPE).smooth(values, 2),
        grid.smooth(image, sigma=2),
        grid.filter(image, [0, 1]),
        aw.grid(image).smooth(sigma=2),
        aw.grid(image).decompose(levels=2).array,
    ):
        assert np.asarray(found).dtype == expected
    points, faces = aw.filter((V.astype(np.float32), F), "smooth", levels=3)
    assert points.dtype == np.float32 and faces is F
    single = aw.decompose(SHAPE, f.astype(np.float32), levels=3)
    assert np.allclose(single, aw.decompose(SHAPE, f, levels=3), atol=1e-6)


def test_progress_shows_without_tqdm_and_ends_at_the_end(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    seen: list[tuple[int, int]] = []
    large = aw.sample("torus", vertices=60_000)
    aw.denoise(large, progress=lambda done, total: seen.append((done, total)))
    assert seen[-1][0] == seen[-1][1]
    for name in ("tqdm", "tqdm.auto"):
        monkeypatch.setitem(sys.modules, name, None)
    aw.decompose(large, levels=6, progress=True)
    shown = capsys.readouterr().err
    assert shown.startswith("splitting") and shown.rstrip().endswith("100 %")
    monkeypatch.setattr(sys, "stderr", stream := io.StringIO())
    monkeypatch.setattr(stream, "isatty", lambda: True, raising=False)
    aw.smooth(large, large.points[:, 0], steps=200, progress=True)
    assert stream.getvalue().startswith("\r") and stream.getvalue().endswith("100 %\n")


#: Long calls, each of a second or more.
LONG = {
    "decompose": "aw.decompose(mesh, levels=12)",
    "denoise": "aw.denoise(mesh)",
    "filter": "aw.filter(mesh, 'smooth', levels=12)",
    "features": "aw.features(mesh)",
    "saliency": "aw.saliency(mesh)",
    "smooth": "aw.smooth(mesh, steps=20000)",
    "simplify": "aw.simplify(mesh, ratio=0.01)",
    "grid": "aw.grid(volume).denoise()",
    "point_walk": "aw.point_walk(X)",
    "impute": "aw.impute(counts, walk)",
    "impute by its own graph": "aw.impute(counts)",
    "scattering": "aw.scattering(walk, X)",
    "walk": "aw.smooth(walk, X, steps=4000)",
    "basis": "aw.Decomposer(small).basis(8)",
}
SCRIPT = """
import os, signal, sys, threading, time
import numpy as np
import adwave as aw
signal.signal(signal.SIGINT, signal.default_int_handler)
rng = np.random.default_rng(0)
call = sys.argv[1]
if "mesh" in call:
    mesh = aw.sample("torus", vertices=400_000)
if "small" in call:
    small = aw.sample("torus", vertices=20_000)
if "volume" in call:
    volume = rng.normal(size=(160, 160, 160))
if "X" in call or "counts" in call:
    X = rng.normal(size=(20_000, 60))
    counts = rng.poisson(2.0, size=(6_000, 1_500)).astype(float)
if "walk" in call and "point_walk" not in call:
    walk = aw.point_walk(X[: 6_000 if "counts" in call else None, :4], neighbors=12, stay=0.5)
sent = []
def interrupt():
    time.sleep(float(sys.argv[2]))
    sent.append(time.perf_counter())
    os.kill(os.getpid(), signal.SIGINT)
thread = threading.Thread(target=interrupt)
thread.start()
try:
    while True:
        eval(call)
except KeyboardInterrupt:
    print(time.perf_counter() - sent[0])
thread.join()
"""


@pytest.mark.skipif(os.name == "nt", reason="no signals of this kind")
@pytest.mark.parametrize("name", LONG)
def test_ctrl_c_ends_every_long_call(name: str) -> None:
    # 50 ms where all cores are free; a machine that does other work wakes threads later.
    code = textwrap.dedent(SCRIPT)
    words = [sys.executable, "-c", code, LONG[name], "0.4"]
    found = subprocess.run(words, capture_output=True, text=True, check=False, timeout=300)
    assert found.stdout, found.stderr
    assert float(found.stdout) < 1.0


THREADS = """
import threading
import numpy as np
import adwave as aw
shape = aw.sample("torus", vertices=200_000)
# Two vertices at one place: the bands are those of their points, and an editor is kept for them.
bands = aw.decompose(aw.Shape(np.vstack([shape.points, shape.points[:9]]), shape.faces), levels=4)
expected = [bands.apply([1, g, 1, 1]) for g in range(3)]
def edit(k):
    for i in range(8):
        g = (k + i) % 3
        assert np.array_equal(bands.apply([1, g, 1, 1]), expected[g])
    print("edited")
threads = [threading.Thread(target=edit, args=(k,)) for k in range(3)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
"""


def test_threads_share_bands() -> None:
    # A thread that waited for another with the interpreter held would wait forever.
    words = [sys.executable, "-c", THREADS]
    found = subprocess.run(words, capture_output=True, text=True, check=False, timeout=120)
    assert found.stdout.split() == ["edited"] * 3, found.stderr


def test_the_same_methods_for_all_that_has_bands() -> None:
    values = f
    graph = aw.graph(len(V), [[i, (i + 1) % len(V)] for i in range(len(V))])
    for carrier in (SHAPE, aw.Decomposer(SHAPE), graph, aw.point_walk(V, neighbors=6, stay=0.5)):
        bands = carrier.decompose(values, levels=3)
        assert np.allclose(bands.sum(axis=0), values)
        assert np.array_equal(bands, aw.decompose(carrier, values, levels=3))
        assert np.array_equal(carrier.smooth(values, steps=2), aw.smooth(carrier, values, steps=2))
        assert np.array_equal(carrier.filter(values, [0, 1]), aw.filter(carrier, values, [0, 1]))
        assert carrier.denoise(values).result.shape == values.shape
        assert carrier.saliency(values).shape == values.shape
        assert len(carrier.features(values, best=2)) <= 2
        assert carrier.region(values > 0).sum() == (values > 0).sum()
        assert carrier.n_vertices == len(V)
    grid = aw.grid(values.reshape(20, 30))
    assert grid.n_vertices == 600
    for name in ("smooth", "decompose", "filter", "denoise", "saliency", "features", "region", "filter_labels"):
        assert callable(getattr(grid, name))
    assert np.array_equal(aw.smooth(grid, fwhm=4), grid.smooth(fwhm=4))
    assert np.array_equal(aw.smooth(grid, values.reshape(20, 30), fwhm=4), grid.smooth(fwhm=4))


def test_former_names_are_taken_with_a_warning() -> None:
    walk = aw.point_walk(V, neighbors=6, stay=0.5)
    counts = np.random.default_rng(0).poisson(3.0, (len(V), 3)).astype(float)
    grid = aw.grid(f.reshape(20, 30))
    for old, new, says in (
        (lambda: aw.points(V, neighbors=6).n_vertices, lambda: aw.point_walk(V, neighbors=6).n_vertices, "point_walk"),
        (lambda: aw.impute(X=counts, walk=walk, t=2).values, lambda: aw.impute(counts, walk, 2).values, "steps="),
        (lambda: walk.bands(f, scales=[1, 2]), lambda: walk.bands(f, steps=[1, 2]), "steps="),
        (lambda: aw.filter(SHAPE, [0, 1], signal=f), lambda: aw.filter(SHAPE, f, [0, 1]), r"filter\(shape, f, gains\)"),
        (lambda: grid.filter([0, 1], grid.mask or f.reshape(20, 30)), lambda: grid.filter([0, 1]), r"grid\.filter"),
        (lambda: grid.n_places, lambda: 600, "n_vertices"),
        (
            lambda: aw.Decomposer(SHAPE).rms_widths([1]),
            lambda: aw.Decomposer(SHAPE).measure_widths([1]),
            "measure_widths",
        ),
        (lambda: aw.morph(a=SHAPE, b=SHAPE, t=0.5).points, lambda: aw.morph(SHAPE, SHAPE, 0.5).points, "="),
    ):
        with pytest.warns(DeprecationWarning, match=says):
            found = old()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert np.array_equal(found, new())


def test_directions_of_a_graph_are_not_dropped_without_a_word() -> None:
    networkx = pytest.importorskip("networkx")
    directed = networkx.DiGraph([(0, 1), (1, 2), (2, 0)])
    with pytest.warns(UserWarning, match=r"is not symmetric.*normalize='row'"):
        aw.smooth(directed, [1.0, 2.0, 3.0], steps=1)
    walk = aw.walk(directed, normalize="row")
    assert walk.smooth([1.0, 2.0, 3.0], 1).tolist() == [2.0, 3.0, 1.0]
    named = networkx.Graph([("a", "b"), ("b", "c")])
    assert np.array_equal(
        aw.smooth(named, {"c": 3.0, "a": 1.0, "b": 2.0}, steps=1), aw.smooth(named, [1.0, 2.0, 3.0], steps=1)
    )


def test_a_message_without_the_text_of_the_call_has_the_usual_names() -> None:
    code = compile("aw.smooth(V, F, f)", "<no text>", "eval")
    with pytest.raises(TypeError, match=r"write aw\.smooth\(\(V, F\), f, steps=3\)"):
        eval(code, {"aw": aw, "V": V, "F": F, "f": f})


def test_the_result_of_denoise_has_the_attributes_of_its_shape() -> None:
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.Trimesh(V, F, process=False)
    found = aw.denoise(mesh)
    assert type(found.result) is type(aw.filter(mesh, "smooth"))
    assert np.array_equal(found.vertices, found.result.vertices)
    with pytest.raises(AttributeError, match="no_such"):
        _ = found.no_such  # type: ignore[attr-defined]
