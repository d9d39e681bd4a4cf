"""Behavior within a Python process: imports, signals, forks, threads, memory, pickles."""

from __future__ import annotations

import gc
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import adwave as aw
import numpy as np
import pytest

LARGE = 60_000


@pytest.fixture(scope="module")
def large() -> aw.Shape:
    return aw.sample("torus", vertices=LARGE)


def test_import_loads_neither_numpy_nor_the_extension() -> None:
    code = "import sys, adwave; print('numpy' in sys.modules, any('_native' in m for m in sys.modules))"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.split() == ["False", "False"]


def test_every_public_name_is_there() -> None:
    for name in aw.__all__:
        assert getattr(aw, name) is not None
    assert set(aw.__all__) <= set(dir(aw))
    with pytest.raises(AttributeError, match="no_such"):
        _ = aw.no_such  # type: ignore[attr-defined]


def test_the_same_bits_on_any_number_of_threads(large: aw.Shape) -> None:
    with aw.threads(1):
        one = aw.decompose(large, levels=5).array
    with aw.threads(3):
        three = aw.decompose(large, levels=5).array
    assert np.array_equal(one, three)


def test_threads_are_as_before_after_a_block() -> None:
    before = aw.threads(0).n
    with aw.threads(1) as inner:
        assert inner.n == 1
    assert aw.threads(0).n == before


@pytest.mark.skipif(os.name == "nt", reason="no signals of this kind")
@pytest.mark.parametrize("call", ["decompose", "denoise", "features"])
def test_ctrl_c_ends_a_call_and_leaves_the_state_intact(call: str) -> None:
    # Whoever starts the tests in the background may have told them to ignore it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    shape = aw.sample("torus", vertices=400_000)
    was = np.array(shape.points)

    def interrupt() -> None:
        time.sleep(0.3)
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    sent: list[float] = []
    thread = threading.Thread(target=interrupt)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        while True:
            getattr(aw, call)(shape)
    took = time.perf_counter() - sent[0]
    thread.join()
    # 50 ms where all cores are free; a machine that does other work wakes threads later.
    assert took < 1.0, f"{took:.3f} s"
    assert np.array_equal(shape.points, was)
    assert aw.decompose(aw.sample("sphere", vertices=200), levels=2).n_levels == 2


def test_an_error_in_the_report_ends_the_call(large: aw.Shape) -> None:
    def report(done: int, total: int) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        for _ in range(50):
            aw.decompose(large, levels=10, progress=report)


def test_progress_is_reported_from_the_calling_thread(large: aw.Shape) -> None:
    seen: list[tuple[int, int, int]] = []
    for _ in range(20):
        aw.decompose(large, levels=11, progress=lambda done, total: seen.append((done, total, threading.get_ident())))
        if seen:
            break
    assert seen and all(0 <= done <= total for done, total, _ in seen)
    assert {ident for *_, ident in seen} == {threading.get_ident()}
    with pytest.raises(TypeError, match="progress"):
        aw.decompose(large, levels=2, progress="yes")  # type: ignore[arg-type]


def _first_band(n: int) -> float:
    return float(aw.decompose(aw.sample("torus", vertices=n), levels=4)[0].sum())


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_forked_child_works_at_once(large: aw.Shape) -> None:
    here = _first_band(LARGE)
    for method in ("fork", "spawn"):
        with multiprocessing.get_context(method).Pool(2) as pool:
            found = pool.map_async(_first_band, [LARGE] * 3).get(timeout=120)
        assert found == [here] * 3


def test_other_threads_run_during_a_call(large: aw.Shape) -> None:
    count = 0
    stop = threading.Event()

    def spin() -> None:
        nonlocal count
        while not stop.is_set():
            count += 1

    thread = threading.Thread(target=spin)
    thread.start()
    before = count
    with aw.threads(1):
        aw.denoise(large)
    during = count - before
    stop.set()
    thread.join()
    # A call that holds the interpreter lets none of these through.
    assert during > 10_000


def test_several_threads_may_ask_at_once(large: aw.Shape) -> None:
    walk = aw.Decomposer(large)
    expected = walk.decompose(levels=4).array
    found: list[np.ndarray] = []
    threads = [threading.Thread(target=lambda: found.append(walk.decompose(levels=4).array)) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4 and all(np.array_equal(array, expected) for array in found)


def _resident() -> int:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="no /proc")
def test_memory_goes_back_when_results_are_deleted() -> None:
    shape = aw.sample("torus", vertices=300_000)
    for _ in range(2):
        aw.decompose(shape, levels=8)
    gc.collect()
    before = _resident()
    for _ in range(5):
        bands = aw.decompose(shape, levels=8)
        del bands
    gc.collect()
    assert _resident() < 1.1 * before + 2e7


def test_everything_pickles_with_the_same_bits() -> None:
    shape = aw.sample("creature", vertices=2000)
    shape = shape.with_field("heat", np.arange(shape.n_vertices))
    again = pickle.loads(pickle.dumps(shape))
    assert np.array_equal(again.points, shape.points) and np.array_equal(again.faces, shape.faces)
    assert np.array_equal(again["heat"], shape["heat"]) and again["heat"].dtype == shape["heat"].dtype
    walk = aw.Decomposer(shape, operator="surface")
    assert pickle.loads(pickle.dumps(walk)).operator == "surface"
    for bands in (walk.decompose(levels=3), walk.decompose("heat", levels=3)):
        other = pickle.loads(pickle.dumps(bands))
        assert np.array_equal(other.array, bands.array) and other.shape == bands.shape
    cloud = aw.Shape(shape.points)
    graph = aw.graph(3, [[0, 1], [1, 2]], [1.0, 2.0])
    for other in (cloud, graph):
        assert repr(pickle.loads(pickle.dumps(other))) == repr(other)
    found = aw.features(shape, options=aw.FeatureOptions(descriptors=True))
    same = pickle.loads(pickle.dumps(found))
    assert np.array_equal(same, found) and np.array_equal(same.descriptors, found.descriptors)
    recipe = aw.Recipe("levels = 3\n[[layer]]\npreset = 'smooth'")
    assert pickle.loads(pickle.dumps(recipe)).text == recipe.text
    assert pickle.loads(pickle.dumps(aw.info(shape)))["vertices"] == shape.n_vertices


def test_results_are_fresh_or_cannot_be_written_to() -> None:
    shape = aw.sample("sphere", vertices=200)
    with pytest.raises(ValueError, match="read-only"):
        shape.points[0] = 0
    bands = aw.decompose(shape, levels=2)
    with pytest.raises(ValueError, match="read-only"):
        bands[0][0] = 0
    edited = bands.apply([1, 1])
    edited[0] = 7
    assert not np.array_equal(bands.apply([1, 1]), edited)


def test_points_outlive_their_shape() -> None:
    points = aw.sample("sphere", vertices=20_000).points
    gc.collect()
    assert np.isfinite(points).all() and abs(np.linalg.norm(points, axis=1) - 1).max() < 1e-9
