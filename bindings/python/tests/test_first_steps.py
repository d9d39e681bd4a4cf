"""The notebook `docs/python/first_steps.ipynb`: its cells run in their order, and end in a figure."""

from __future__ import annotations

import json
import linecache
from pathlib import Path
from typing import Any

import pytest

NOTEBOOK = Path(__file__).parents[3] / "docs/python/first_steps.ipynb"


@pytest.mark.skipif(not NOTEBOOK.exists(), reason="the tests are run without the repository")
def test_the_notebook_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": "__main__"}
    for i, cell in enumerate(json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]):
        text = "".join(cell["source"])
        if cell["cell_type"] != "code" or text.startswith("%pip"):
            continue
        name = f"<cell {i}>"
        linecache.cache[name] = (len(text), None, text.splitlines(keepends=True), name)
        exec(compile(text, name, "exec"), names)
    assert (tmp_path / "first_steps.png").read_bytes().startswith(b"\x89PNG")
    assert names["figure"].array.std() > 10 and names["bands"].n_levels == 6
    assert abs(names["bands"].sum(axis=0) - names["clean"].points).max() < 1e-12
    # The line of the message runs too.
    line = capsys.readouterr().out.rpartition("write ")[2]
    assert line.startswith("aw.smooth((clean.points, clean.faces), steps=10")
    points, faces = eval(line, names)
    assert points.shape == names["clean"].points.shape and len(faces) == names["clean"].n_faces
