"""Write the pictures, the notebooks and the page of the gallery from its scripts.

python build.py                  all pictures, notebooks, and README.md
python build.py --only NAME      one picture; the notebooks and the page in any case
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
#: Groups of the page, with the scripts of each.
GROUPS = {
    "Meshes and scans": (
        "denoise_a_part",
        "equalize_a_creature",
        "denoise_a_cloud",
        "where_it_stands_out",
        "find_every_dimple",
        "match_two_scans",
        "what_changed",
    ),
    "Geometry": (
        "simplify_within_a_bound",
        "bend_and_keep_detail",
        "bend_and_keep_lengths",
        "carry_detail",
        "levels_of_a_sculpture",
    ),
    "Graphs, cells, learning": (
        "roads_without_noise",
        "cells_in_order",
        "tell_graphs_apart",
        "labels_from_a_few",
        "learn_the_gains",
    ),
    "Brains": ("thickness_of_the_cortex", "thickness_on_fewer_vertices", "a_brain_without_noise"),
    "The Earth, the sky, time": (
        "the_earth_by_scale",
        "the_earth_from_few_numbers",
        "relief_by_scale",
        "stars_and_a_galaxy",
        "waves_in_time",
    ),
}
NAMES = tuple(name for names in GROUPS.values() for name in names)
#: Largest number of lines of a script that are not empty.
MOST_LINES = 30
#: Head of a script.
HEAD = re.compile(r"# # (?P<title>.+)\n# In: (?P<given>.+?)\. Out: (?P<result>.+)\n#\n#     (?P<line>.+)\n")
INSTALL = "# %pip "


@dataclass(frozen=True)
class Example:
    """A script in parts.

    Attributes
    ----------
    name, title
        Name of its file without the ending, and what it does.
    given, result, line
        What goes in, what comes out, and the line that does it.
    install
        Command that installs what it needs.
    cells
        Its code.
    """

    name: str
    title: str
    given: str
    result: str
    line: str
    install: str
    cells: tuple[str, ...]


def read(name: str) -> Example:
    """Read a script and check its form.

    Raises
    ------
    ValueError
        If its head is incomplete, its line is not in its code, or it is too long.
    """
    text = (FOLDER / f"{name}.py").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if line.strip()]
    if len(lines) > MOST_LINES:
        raise ValueError(f"{name}.py must have at most {MOST_LINES} lines, got {len(lines)}")
    _, head, *cells = re.split(r"^# %%.*\n", text, flags=re.MULTILINE)
    found = HEAD.match(head)
    if found is None:
        raise ValueError(f"{name}.py must begin with a title, a line of “In: … Out: …”, and the line of code")
    install = "%pip install -q adwave"
    if cells[0].startswith(INSTALL):
        first, _, cells[0] = cells[0].partition("\n")
        install = first.removeprefix("# ")
    code = "\n".join(cells)
    if found["line"] not in code:
        raise ValueError(f"{name}.py must have its line in its code: {found['line']}")
    return Example(name, **found.groupdict(), install=install, cells=tuple(cell.strip() for cell in cells))


def notebook(example: Example) -> str:
    """Text of the notebook of an example: its picture, the installation, its code, and its picture as it comes out."""
    head = f"# {example.title}\n\nIn: {example.given}. Out: {example.result}\n\n![]({example.name}.png)"
    *code, last = example.cells
    cells = [("markdown", head), *(("code", text) for text in (example.install, *code, f"{last}\npicture"))]
    written = []
    for i, (kind, source) in enumerate(cells):
        cell: dict[str, object] = {"cell_type": kind, "id": f"cell-{i}", "metadata": {}}
        if kind == "code":
            cell |= {"execution_count": None, "outputs": []}
        written.append({**cell, "source": source.splitlines(keepends=True)})
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    whole = {"cells": written, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


def page() -> str:
    """Text of the page: for each example its picture, what goes in, what comes out, and the line that does it."""
    parts = [
        "# Gallery",
        "What goes in, what comes out, and the line that does it. Each example is a script of at most "
        f"{MOST_LINES} lines and a\nnotebook, on built-in shapes or on data that a package of pip ships.",
        "Install adwave as its [README](../../../bindings/python/README.md#installing) says; the first cell of a "
        "notebook\ninstalls what else it needs. `python build.py` makes the pictures, the notebooks and this page.",
    ]
    for group, names in GROUPS.items():
        parts.append(f"## {group}")
        for example in map(read, names):
            links = f"[script]({example.name}.py) · [notebook]({example.name}.ipynb)"
            parts += [
                f"### {example.title}",
                f"{example.given[0].upper()}{example.given[1:]} → {example.result}",
                f"```python\n{example.line}\n```",
                f"![{example.title}]({example.name}.png)",
                links,
            ]
    return "\n\n".join(parts) + "\n"


def draw(name: str, folder: Path) -> str:
    """Run a script in a folder, where it writes its picture; returns what it printed.

    Raises
    ------
    RuntimeError
        If it fails.
    """
    environment = {**os.environ, "PYTHONUTF8": "1"}
    script = str(FOLDER / f"{name}.py")
    done = subprocess.run(
        [sys.executable, "-W", "error::DeprecationWarning:__main__", script],
        check=False,
        capture_output=True,
        encoding="utf-8",
        env=environment,
        cwd=folder,
    )
    if done.returncode != 0:
        raise RuntimeError(f"{name}.py failed:\n{done.stdout}{done.stderr}")
    return done.stdout


def main() -> None:
    parser = argparse.ArgumentParser(description="Write the gallery.")
    parser.add_argument("--only", metavar="NAME", choices=NAMES, action="append", help="may be repeated")
    for name in parser.parse_args().only or NAMES:
        print(f"{name}: {draw(name, FOLDER).strip()}", flush=True)
    for name in NAMES:
        (FOLDER / f"{name}.ipynb").write_text(notebook(read(name)), encoding="utf-8")
    (FOLDER / "README.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
