"""Labels are not numbers: they are smoothed by the share of each label."""

from __future__ import annotations

import adwave as aw
import numpy as np
import pytest


def test_labels_follow_their_surroundings_and_are_never_averaged() -> None:
    x, y = np.meshgrid(np.arange(20.0), np.arange(20.0))
    points = np.c_[x.ravel(), y.ravel(), np.zeros(400)]
    classes = np.where(points[:, 0] < 10, 2.0, 6.0)
    noisy = classes.copy()
    noisy[[205, 215]] = [6, 9]
    smooth = aw.filter_labels(points, noisy, [0, 0, 0])
    assert set(smooth) == {2.0, 6.0}
    assert (smooth[[205, 215]] == [2, 6]).all()
    assert (aw.filter_labels(points, noisy, [1, 1]) == noisy).all()


def test_a_named_field_of_labels_is_refused() -> None:
    shape = aw.sample("sphere", vertices=300)
    shape = shape.with_field("classification", np.arange(shape.n_vertices, dtype=np.uint8) % 5)
    with pytest.raises(ValueError, match="labels"):
        aw.filter(shape, "classification", [0.0])
    with pytest.raises(ValueError, match="labels"):
        aw.denoise(shape, signal="classification")
    assert len(aw.filter(shape, shape.fields["classification"], [0.0])) == shape.n_vertices
