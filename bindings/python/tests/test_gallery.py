"""The gallery of `docs/python/gallery`: scripts run, and draw the pictures that are shown; notebooks have their code."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

FOLDER = Path(__file__).parents[3] / "docs/python/gallery"
#: Packages that an example needs beyond those of the tests.
NEEDS = {"learn_the_gains": "torch"}
#: Largest mean difference of the tiles of a picture from those of the one that is shown, of 255.
MOST_DIFFERENT = 3.0
TILES = 24

pytestmark = pytest.mark.skipif(not FOLDER.exists(), reason="the tests are run without the repository")


def load_build() -> ModuleType:
    spec = importlib.util.spec_from_file_location("gallery_build", FOLDER / "build.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


build = load_build() if FOLDER.exists() else None
NAMES: tuple[str, ...] = build.NAMES if build is not None else ()


def tiles_of(path: Path) -> np.ndarray:
    """Mean colors of TILES × TILES parts of a picture."""
    image = pytest.importorskip("PIL.Image")
    with image.open(path) as picture:
        colors = np.asarray(picture.convert("RGB"), dtype=float)
    rows, columns = (np.array_split(np.arange(size), TILES) for size in colors.shape[:2])
    return np.array([[colors[np.ix_(row, column)].mean(axis=(0, 1)) for column in columns] for row in rows])


@pytest.mark.parametrize("name", NAMES)
def test_a_script_draws_the_picture_that_is_shown(name: str, tmp_path: Path) -> None:
    assert build is not None
    if name in NEEDS:
        pytest.importorskip(NEEDS[name])
    build.draw(name, tmp_path)
    drawn, shown = tiles_of(tmp_path / f"{name}.png"), tiles_of(FOLDER / f"{name}.png")
    difference = np.abs(drawn - shown).mean()
    assert difference < MOST_DIFFERENT, f"{name}.png differs by {difference:.1f}; run docs/python/gallery/build.py"


def test_notebooks_and_page_are_those_of_the_scripts() -> None:
    assert build is not None
    scripts = {path.stem for path in FOLDER.glob("*.py")} - {"build"}
    assert scripts == set(NAMES) and len(NAMES) >= 20
    for name in NAMES:
        written = (FOLDER / f"{name}.ipynb").read_text(encoding="utf-8")
        assert written == build.notebook(build.read(name)), f"{name}.ipynb is old; run docs/python/gallery/build.py"
    assert (FOLDER / "README.md").read_text(encoding="utf-8") == build.page()
    assert {path.stem for path in FOLDER.glob("*.png")} == set(NAMES)


def test_a_script_that_is_too_long_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert build is not None
    name = NAMES[0]
    text = (FOLDER / f"{name}.py").read_text(encoding="utf-8")
    monkeypatch.setattr(build, "FOLDER", tmp_path)
    (tmp_path / f"{name}.py").write_text(text + "print()\n" * build.MOST_LINES, encoding="utf-8")
    with pytest.raises(ValueError, match="at most 30 lines"):
        build.read(name)
    (tmp_path / f"{name}.py").write_text(text.replace("aw.denoise(scan)\n\n", "scan\n\n"), encoding="utf-8")
    with pytest.raises(ValueError, match="must have its line"):
        build.read(name)
