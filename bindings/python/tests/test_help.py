"""The table of functions that `help(adwave)` shows: each of its calls runs as it stands there."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import adwave as aw
import numpy as np
import pytest

SHAPE = aw.sample("creature", vertices=2000)
N = SHAPE.n_vertices
#: Calls of the left column, and those that a description has.
CALLS = [
    call
    for line in (aw.__doc__ or "").splitlines()
    for call in re.findall(r"(?<![\w.])[a-zA-Z_.]+\((?:[^()]|\([^()]*\))+\)", line)
    if re.match(r"[\w.]+\(", line) and not line.startswith(">>>") and "…" not in call
]


def objects(folder: Path) -> dict[str, Any]:
    """The names in the table, each with what it stands for."""
    random = np.random.default_rng(0)
    SHAPE.write(folder / "scan.ply")
    (folder / "walk").mkdir()
    for i in range(3):
        SHAPE.with_points(SHAPE.points + 0.01 * i).write(folder / f"walk/{i}.obj")
    ball = aw.sample("sphere", vertices=200)
    weights = np.eye(9, k=1) + np.eye(9, k=-1)
    samples = random.normal(size=(60, 5))
    image = random.random((20, 24))
    return {
        **{name: getattr(aw, name) for name in aw.__all__},
        **{"aw": aw, "shape": SHAPE, "f": SHAPE.points[:, 2], "series": random.normal(size=(N, 12)), "first": SHAPE},
        **{"second": SHAPE, "a": SHAPE, "b": SHAPE, "labels": (SHAPE.points[:, 2] > 0).astype(float), "gains": [0, 0]},
        **{"fixed": "ball:vertex=0,radius=20%", "handles": ["ball:vertex=900,radius=10%"], "name": "mean-curvature"},
        **{"v": random.normal(size=(N, 3)), "W": weights, "X": samples, "array": image, "h": 0.5, "m": image > 0.1},
        **{"counts": random.poisson(3, (60, 9)), "points": SHAPE.points, "faces": SHAPE.faces, "path": "scan.ply"},
        **{"left": (ball.points, ball.faces), "right": (ball.points, ball.faces), "D": np.ones((20, 24, 6))},
    }


def test_calls_of_the_table_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names = objects(tmp_path)
    prepared = {
        "tensors(grid, D)": {"grid": aw.grid(names["array"])},
        "union([left, right, grid])": {"grid": aw.grid(names["array"])},
        "impute(counts, walk)": {"walk": aw.point_walk(names["X"])},
        "scattering(walk, f)": {"walk": aw.point_walk(names["X"]), "f": names["X"][:, 0]},
        "resample(sphere, f, onto=other)": {
            "sphere": aw.sample("sphere", vertices=200),
            "f": np.arange(200.0),
            "other": aw.sample("sphere", vertices=300),
        },
        "hierarchy(shape)": {"shape": aw.subdivide(aw.sample("sphere", vertices=200))},
    }
    calls = [call for call in CALLS if not call.startswith("studio")]
    assert len(calls) > 30 and prepared.keys() <= set(calls)
    for call in calls:
        try:
            eval(call, {**names, **prepared.get(call, {})})
        except Exception as error:
            pytest.fail(f"{call}: {type(error).__name__}: {error}")
