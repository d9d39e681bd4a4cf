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
from pathlib import Path
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
    work: Callable[[Callable[[str, str, Any], Any]], None], monkeypatch: pytest.MonkeyPatch
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
        return aw.studio(SHAPE)
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


def test_what_cannot_be_shown_is_said(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="this graph has none"):
        aw.studio(aw.graph(3, [[0, 1], [1, 2]]), open_browser=False)
