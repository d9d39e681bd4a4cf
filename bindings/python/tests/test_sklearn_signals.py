"""The transformer of signals on one shape, and features matched by their descriptors."""

from __future__ import annotations

import adwave as aw
import numpy as np
import pytest


def test_signals_on_a_graph_become_features() -> None:
    pytest.importorskip("sklearn")
    from adwave.sklearn import SignalBands
    from sklearn.base import clone
    from sklearn.linear_model import Ridge
    from sklearn.model_selection import GridSearchCV
    from sklearn.pipeline import make_pipeline

    ring = aw.graph(60, [[i, (i + 1) % 60] for i in range(60)])
    rng = np.random.default_rng(0)
    X = rng.normal(size=(40, 60))
    split = SignalBands(ring, levels=3)
    bands = split.fit_transform(X)
    expected = aw.decompose(ring, X.T, levels=3)
    assert np.allclose(bands.reshape(40, 4, 60)[7], expected[:, :, 7])
    assert np.allclose(split.inverse_transform(bands), X) and len(split.get_feature_names_out()) == 240
    energy = clone(split).set_params(output="energy").fit_transform(X)
    assert np.allclose(energy[3] ** 2 * 60, (expected[:, :, 3] ** 2).sum(axis=1))
    assert np.allclose(clone(split).set_params(output="smooth").fit_transform(X), expected[-1].T)
    # The roughness of a sample is in its bands.
    y = energy[:, 0]
    search = GridSearchCV(
        make_pipeline(SignalBands(ring, output="energy"), Ridge(alpha=1e-6)), {"signalbands__levels": [2, 3]}, cv=3
    )
    assert search.fit(X, y).best_score_ > 0.9
    with pytest.raises(ValueError, match=r"X\.T"):
        split.transform(X[:60].T)
    # Without a shape the columns are a chain.
    chain = aw.graph(60, [[i, i + 1] for i in range(59)])
    assert np.array_equal(SignalBands(levels=3).fit_transform(X), SignalBands(chain, levels=3).fit_transform(X))


def test_features_match_by_their_descriptors() -> None:
    scan = aw.sample("creature", vertices=12_000)
    angle = 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    moved = scan.with_points(scan.points @ turn.T + [1, 2, 3])
    options = aw.FeatureOptions(descriptors=True)
    one, two = (aw.features(shape, operator="surface", options=options) for shape in (scan, moved))
    found = aw.match(one, two)
    assert found.motion is not None and len(found.pairs) >= 6
    assert np.allclose(found.motion[:3, :3], turn, atol=0.01) and np.allclose(found.motion[:3, 3], [1, 2, 3], atol=0.03)
    assert found.n_features == (len(one), len(two)) and (found.pairs["distance"] < 1).all()
    with pytest.raises(ValueError, match=r"aw\.FeatureOptions\(descriptors=True\)"):
        aw.match(aw.features(scan), two)
