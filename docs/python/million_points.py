# %% [markdown]
# # A million points
#
# Time and memory for a large cloud. `ADWAVE_GALLERY_SCALE=0.05 python million_points.py` takes a twentieth of the
# points.

# %%
import os
import time
from pathlib import Path

import adwave as aw
import numpy as np

PICTURES = Path(__file__).parent / "pictures"
SCALE = float(os.environ.get("ADWAVE_GALLERY_SCALE", "1.0"))


def timed(what, call):
    start = time.perf_counter()
    result = call()
    print(f"{what:<40} {time.perf_counter() - start:7.2f} s")
    return result


# %% [markdown]
# A scan of a knot: points without faces, with noise along the normals of half the distance between them.

# %%
clean = aw.sample("knot", vertices=round(1_000_000 * SCALE))
noisy = aw.sample("knot", vertices=round(1_000_000 * SCALE), noise=0.5)
cloud = aw.Shape(noisy.points)
print(cloud)

# %% [markdown]
# Preparation finds the neighbors of each point and builds the diffusion. All requests after that are cheap.

# %%
walk = timed("prepare", lambda: aw.Decomposer(cloud))
needed = aw.memory_needed(walk, levels=6)
print("decompose will take", ", ".join(f"{size / 1e6:.0f} MB ({name})" for name, size in needed.items()))
bands = timed("decompose into 6 levels", lambda: walk.decompose(levels=6))
assert bands.array.nbytes == needed["result"]
assert np.abs(bands.reconstruct() - cloud.points).max() < 1e-12

# %% [markdown]
# One filter without stored bands; or edits of stored bands, of which the first prepares and the others are quick.

# %%
smooth = timed("filter: smooth, along the normals", lambda: aw.filter(walk, "smooth", levels=6))
timed("first edit of the bands", lambda: bands.apply([0, 0, 1, 1, 1, 1]))
edited = timed("next edit", lambda: bands.apply([0, 0, 0, 1, 1, 1]))
assert np.allclose(edited, bands.array[3:].sum(axis=0), atol=1e-9)

# %% [markdown]
# The error before and after.

# %%
before, after = (np.sqrt(np.mean((shape.points - clean.points) ** 2) * 3) for shape in (cloud, smooth))
print(f"rms distance from the clean points: {before:.1e}, then {after:.1e}, {before / after:.1f} times less")
assert after < before / 3

# %% [markdown]
# A part of the knot, noisy on the left and smoothed on the right. The sample has faces, which are drawn faster
# than a million discs.

# %%
left = clean.points[:, :1] < 0.45
halves = noisy.with_points(np.where(left, cloud.points, smooth.points))
near = aw.Camera(view="front", zoom=max(1, 2.2 * SCALE**0.5), focus=(0.45, 0.1, 0.2))
aw.render(halves, camera=near, size=(380, 285)).save(PICTURES / "million_points.png")
