"""Normals of a shape whose points move."""

from pathlib import Path

import adwave as aw
import numpy as np

TEXT = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n"


def test_normals_follow_the_points_unless_they_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text(TEXT)
    shape = aw.read(path)
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1]], float)
    assert np.array_equal(shape.with_points(points).fields["normal"], [[0, -1, 0]] * 3)
    assert np.array_equal(shape.with_points(points, keep_normals=True).fields["normal"], [[0, 0, 1]] * 3)
