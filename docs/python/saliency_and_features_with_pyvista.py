# %% [markdown]
# # Saliency and features, to PyVista and back
#
# A `pyvista.PolyData` is a shape; results go back into its `point_data` for the filters of PyVista and VTK.

# %%
import sys
from pathlib import Path

import adwave as aw
import numpy as np

try:
    import pyvista as pv
except ImportError:
    print("skipped: PyVista is not installed")
    sys.exit(0)

PICTURES = Path(__file__).parent / "pictures"
mesh = aw.sample("creature", vertices=20_000).to_pyvista()
print(type(mesh).__name__, mesh.n_points, "points,", mesh.n_cells, "cells")

# %% [markdown]
# Saliency is above 0 where the shape is convex (claws, ears, nose), below 0 where it is concave. A `Decomposer` is
# prepared once for all requests.

# %%
shape = aw.Decomposer(mesh)
saliency = aw.saliency(shape)
mesh.point_data["saliency"] = saliency
assert mesh.point_data["saliency"].shape == (mesh.n_points,)
tips = mesh.threshold(np.quantile(saliency, 0.995), scalars="saliency").connectivity()
print(f"sides: {saliency.sides}; the top half percent lies in {tips['RegionId'].max() + 1} places")

# %% [markdown]
# Features are places with a size σ: a structured array of vertex, position, level, sigma, response, strength
# and sign.

# %%
features = aw.features(shape, best=40)
print(features.to_pandas().sort_values("strength", ascending=False).head(5).round(3).to_string(index=False))
assert np.array_equal(features["position"], mesh.points[features["vertex"]].astype(float))

# %% [markdown]
# As points in PyVista, with their values, for instance for glyphs of their sizes:

# %%
places = pv.PolyData(features["position"])
for name in ("sigma", "strength", "sign", "vertex"):
    places.point_data[name] = np.asarray(features[name])
spheres = places.glyph(scale="sigma", geom=pv.Sphere(radius=1.0), orient=False)
print(f"{places.n_points} features, glyphs of {spheres.n_points} points")

# %% [markdown]
# And back: `point_data` are the fields of the shape, and an edit becomes a new `PolyData` with all fields.

# %%
back = aw.as_shape(mesh)
assert np.array_equal(back["saliency"], saliency.map)
crisp = aw.filter(mesh, [2, 2, 1.5, 1])
assert isinstance(crisp, pv.PolyData) and "saliency" in crisp.point_data and crisp.n_cells == mesh.n_cells
assert not np.array_equal(crisp.points, mesh.points)

# %%
marks = [(f["position"], f["sigma"], (220, 60, 40) if f["sign"] > 0 else (40, 90, 220)) for f in features]
aw.render(mesh, values="saliency", size=(500, 480)).save(PICTURES / "saliency_and_features_map.png")
aw.render(mesh, balls=marks, size=(500, 480)).save(PICTURES / "saliency_and_features_places.png")
