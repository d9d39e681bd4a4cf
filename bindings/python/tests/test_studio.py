"""The studio from Python, with requests instead of the page."""

from __future__ import annotations

import json
import os
import queue
import signal
import threading
import urllib.request
import webbrowser
from collections.abc import Callable
from typing import Any

import adwave as aw
import numpy as np
import pytest

SHAPE = aw.sample("creature", vertices=2000)


def asking(address: str) -> Callable[[str, str, Any], Any]:
    base, token = address.split("#")

    def ask(method: str, path: str, content: Any = None) -> Any:
        body = None if content is None else json.dumps(content).encode()
        request = urllib.request.Request(base + path, body, {"Authorization": f"Bearer {token}"}, method=method)
        with urllib.request.urlopen(request, timeout=60) as answer:
            return json.loads(answer.read())

    return ask


def while_it_runs(
    work: Callable[[Callable[[str, str, Any], Any]], None], monkeypatch: pytest.MonkeyPatch, shape: aw.Shape = SHAPE
) -> aw.StudioResult:
    """Result of the studio while `work` runs instead of the browser that it opens."""
    pages: queue.Queue[str] = queue.Queue()
    monkeypatch.setattr(webbrowser, "open", pages.put)
    failed: list[BaseException] = []

    def do_work() -> None:
        try:
            # It leads to the page, whose address holds the token.
            with urllib.request.urlopen(pages.get(timeout=60), timeout=60) as page:
                work(asking(page.url))
        except BaseException as error:
            failed.append(error)
            os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=do_work)
    thread.start()
    try:
        return aw.studio(shape)
    finally:
        thread.join()
        if failed:
            raise failed[0]


def test_the_edit_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    def work(ask: Callable[[str, str, Any], Any]) -> None:
        n_levels = len(ask("GET", "api/shapes/1", None)["levels"])
        layer = {"name": "all", "on": True, "opacity": 0.5, "gains": [0.0] * n_levels, "region": None}
        ask("PUT", "api/shapes/1/edit", {"revision": 1, "layers": [layer]})
        ask("POST", "api/done", {})

    edited = while_it_runs(work, monkeypatch)
    assert not np.array_equal(edited.shape.points, SHAPE.points)
    assert np.array_equal(edited.recipe.apply(SHAPE).points, edited.shape.points)


@pytest.mark.skipif(os.name == "nt", reason="no signals of this kind")
def test_ctrl_c_ends_it_and_gives_what_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    edited = while_it_runs(lambda ask: os.kill(os.getpid(), signal.SIGINT), monkeypatch)
    assert np.array_equal(edited.shape.points, SHAPE.points) and edited.recipe.text


def test_fields_come_back_also_of_a_graph_without_positions(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(5)
    n = 400
    edges = np.array([[u, (u + step) % n] for u in range(n) for step in (1, 7)])
    values = rng.normal(size=n)
    graph = aw.graph(n, edges).with_field("level", values)

    def work(ask: Callable[[str, str, Any], Any]) -> None:
        n_levels = len(ask("GET", "api/shapes/1", None)["levels"])
        layer = {"name": "all", "on": True, "opacity": 1.0, "gains": [0.0] + [1.0] * (n_levels - 1), "region": None}
        ask(
            "PUT", "api/shapes/1/edit", {"revision": 1, "layers": [], "fields": [{"field": "level", "layers": [layer]}]}
        )
        ask("POST", "api/done", {})

    edited = while_it_runs(work, monkeypatch, graph)
    assert edited.shape.kind == "graph" and list(edited.shape.fields) == ["level"]
    assert list(edited.field_recipes) == ["level"]
    level = edited.shape["level"]
    assert not np.array_equal(level, values) and abs(level.mean() - values.mean()) < 0.1
    assert np.array_equal(edited.field_recipes["level"].apply(graph)["level"], level)


def test_turned_parts_come_back(monkeypatch: pytest.MonkeyPatch) -> None:
    def work(ask: Callable[[str, str, Any], Any]) -> None:
        ask("PUT", "api/shapes/1/edit", {"revision": 1, "layers": [], "turned": [0]})
        ask("POST", "api/done", {})

    edited = while_it_runs(work, monkeypatch)
    assert np.array_equal(edited.shape.points, SHAPE.points)
    assert edited.shape.faces is not None and SHAPE.faces is not None
    # A turned triangle begins anywhere.
    turned, before = np.asarray(edited.shape.faces), np.asarray(SHAPE.faces)[:, ::-1]
    rotations = [np.roll(before, k, axis=1) for k in range(3)]
    assert all(any(np.array_equal(turned[f], r[f]) for r in rotations) for f in range(len(turned)))
