"""Type checkers in their strict mode accept right calls, and complain of every wrong one."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import adwave
import pytest

FILES = Path(__file__).parent / "typing"


def complaints(name: str, folder: Path) -> set[int]:
    """Lines of a file of which the type checker complains."""
    (folder / f"{name}.py").write_text((FILES / f"{name}.txt").read_text(encoding="utf-8"), encoding="utf-8")
    settings = {
        "typeCheckingMode": "strict",
        "pythonVersion": "3.10",
        "include": [f"{name}.py"],
        "extraPaths": [str(Path(adwave.__file__).parent.parent)],
    }
    (folder / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    words = [sys.executable, "-m", "basedpyright", "--outputjson", "--pythonpath", sys.executable]
    found = json.loads(subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False).stdout)
    assert found["summary"]["filesAnalyzed"] == 1
    return {1 + each["range"]["start"]["line"] for each in found["generalDiagnostics"] if each["severity"] == "error"}


@pytest.mark.skipif(find_spec("basedpyright") is None, reason="basedpyright is not installed")
def test_right_calls_pass_and_wrong_ones_do_not(tmp_path: Path) -> None:
    assert complaints("gallery", tmp_path) == set()
    lines = (FILES / "wrong.txt").read_text(encoding="utf-8").splitlines()
    wrong = {number for number, line in enumerate(lines, start=1) if line.endswith("# wrong")}
    assert len(wrong) > 15 and complaints("wrong", tmp_path) == wrong


@pytest.mark.skipif(find_spec("mypy") is None, reason="mypy is not installed")
def test_right_calls_pass_mypy_too(tmp_path: Path) -> None:
    file = tmp_path / "gallery.py"
    file.write_text((FILES / "gallery.txt").read_text(encoding="utf-8"), encoding="utf-8")
    words = [sys.executable, "-m", "mypy", "--strict", "--follow-imports", "silent", "--python-version", "3.10"]
    settings = {**os.environ, "MYPYPATH": str(Path(adwave.__file__).parent.parent)}
    found = subprocess.run([*words, file.name], cwd=tmp_path, env=settings, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout + found.stderr
