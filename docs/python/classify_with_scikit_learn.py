# %% [markdown]
# # Classify shapes with scikit-learn
#
# Sixty shapes of three kinds, each with its own size, pose and mesh. `WaveletFeatures` describes a shape by the
# sizes of its bands: the amount of detail of each width. It does not depend on the size of the shape or the order
# of its vertices, and hardly on its pose.

# %%
import sys
from pathlib import Path

import adwave as aw
import numpy as np

try:
    from adwave.sklearn import WaveletFeatures
    from scipy.spatial.transform import Rotation
    from sklearn.linear_model import LogisticRegression
    from sklearn.model_selection import cross_val_score
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import StandardScaler
except ImportError:
    print("skipped: scikit-learn is not installed")
    sys.exit(0)

PICTURES = Path(__file__).parent / "pictures"
rng = np.random.default_rng(11)

# %% [markdown]
# All shapes are balls with a relief of 1 to 4 % and some roughness: bumps, ridges, or bumps on one side and
# ridges on the other.


# %%
def make(kind):
    ball = aw.sample("sphere", vertices=int(rng.integers(1200, 2500)))
    u = ball.points @ Rotation.random(rng=rng).as_matrix()
    waves = rng.uniform(8, 12)
    bumps, ridges = np.prod(np.sin(waves * u), axis=1), np.sin(waves * u[:, 2])
    bumps, ridges, side = bumps / bumps.std(), ridges / ridges.std(), 1 / (1 + np.exp(-8 * u[:, 0]))
    relief = {"bumps": bumps, "ridges": ridges, "both": side * bumps + (1 - side) * ridges}[kind]
    relief = relief + rng.uniform(0.1, 0.5) * rng.standard_normal(len(u))
    points = u * (1 + rng.uniform(0.01, 0.04) * relief[:, None])
    return aw.Shape(rng.uniform(0.1, 100) * points @ Rotation.random(rng=rng).as_matrix(), ball.faces)


KINDS = ["bumps", "ridges", "both"]
kinds = np.repeat(KINDS, 20)
shapes = [make(kind) for kind in kinds]

# %% [markdown]
# Bands of widths in percent of the bounding box's diagonal, by heat on the surface: nearly the same on any
# mesh of a shape. Position, size and the order of vertices change nothing.

# %%
features = WaveletFeatures(levels=aw.Widths(rms=["1.5%", "3%", "6%", "12%"]), operator="surface")
table = features.fit_transform(shapes)
print(table.shape, *features.get_feature_names_out()[:5], "…")
first = shapes[0]
order = rng.permutation(first.n_vertices)
moved = aw.Shape(7 * first.points[order] + [1, 2, 3], np.argsort(order)[first.faces])
assert np.allclose(features.transform([moved]), table[:1], rtol=1e-6)

# %% [markdown]
# `WaveletFeatures` learns nothing from the shapes, so that one table serves all folds.

# %%
classifier = make_pipeline(StandardScaler(), LogisticRegression(C=10, max_iter=1000))
scores = cross_val_score(classifier, np.log(table), kinds, cv=5)
print(f"cross-validated: {scores.mean():.2f} right, by fold {scores.min():.2f} to {scores.max():.2f}")
assert scores.mean() > 0.8

# Or as the first part of a pipeline, from shapes to classes.
pipeline = make_pipeline(features, *classifier).fit(shapes, kinds)
new_kinds = np.tile(KINDS, 5)
right = pipeline.score([make(kind) for kind in new_kinds], new_kinds)
print(f"15 new shapes: {15 * right:.0f} right")
assert right > 0.7

# %% [markdown]
# Four shapes of each kind, drawn as one mesh.

# %%
rows = [(row, column, shapes[20 * row + column]) for row in range(3) for column in range(4)]
units = [(s.points - s.points.mean(axis=0)) / s.points.std() / 4 + [c, -r, 0] for r, c, s in rows]
starts = np.cumsum([0] + [len(points) for points in units])
faces = np.concatenate([s.faces + start for (_, _, s), start in zip(rows, starts, strict=False)])
palette = np.array([(120, 170, 220), (235, 175, 105), (150, 200, 140)], dtype=np.uint8)
colors = np.repeat(palette[[r for r, _, _ in rows]], np.diff(starts), axis=0)
front = aw.Camera(view="front", up="y", orthographic=True)
aw.render((np.concatenate(units), faces), colors=colors, camera=front, size=(520, 390)).save(PICTURES / "classify_with_scikit_learn.png")
