# %% [markdown]
# # Smooth a scan
#
# A laser scan of a piece of land: an open point cloud with uneven density, a gap, and noise in its heights.
# The land is known here, so that the error before and after can be measured.

# %%
from pathlib import Path

import adwave as aw
import numpy as np

PICTURES = Path(__file__).parent / "pictures"
rng = np.random.default_rng(7)


def height(x, y):
    """The land, in meters: two hills and a winding valley."""
    high = 9 * np.exp(-((x + 20) ** 2 + (y - 10) ** 2) / 250)
    low = 5 * np.exp(-((x - 25) ** 2 + (y + 5) ** 2) / 120)
    return high + low - 4 * np.exp(-((x - 5 * np.sin(y / 12)) ** 2) / 40)


def rms(heights):
    return 100 * np.sqrt(np.mean((heights - clean[:, 2]) ** 2))  # cm


# %% [markdown]
# 20 000 points on 100 m × 100 m, twice as dense on the left, with a gap on the right. An array of points is a
# shape: a cloud.

# %%
x, y = rng.uniform(-50, 50, (2, 40_000))
keep = (rng.random(x.size) < np.where(x < 0, 1, 0.5)) & ((x - 20) ** 2 + (y - 25) ** 2 > 60)
x, y = x[keep][:20_000], y[keep][:20_000]
clean = np.c_[x, y, height(x, y)]
scan = aw.Shape(clean + 0.25 * rng.standard_normal((len(clean), 1)) * [0, 0, 1])
print(scan, f"noise {rms(scan.points[:, 2]):.1f} cm")

# %% [markdown]
# One call: a level with an rms width of 2 m, and the gain 0 for all finer detail. `along="z"` moves heights only.

# %%
smooth = aw.filter(scan, [0], levels=aw.Widths(rms=[2.0]), constraints=aw.Constraints(along="z"))
print(f"filter, rms width 2 m: {rms(smooth.points[:, 2]):.1f} cm")
assert rms(smooth.points[:, 2]) < 25 / 2.5
assert np.array_equal(smooth.points[:, :2], scan.points[:, :2])

# %% [markdown]
# The noisy heights affect the neighbors in space. For land it is better to take neighbors in plan, and the heights
# as a signal on it. A small width leaves noise, a large one removes the hills.

# %%
plan = aw.Decomposer(scan.points[:, :2], operator="surface")
z = scan.points[:, 2]
errors = {width: rms(plan.decompose(z, levels=aw.Widths(rms=[width])).scaling(1)) for width in (0.5, 1, 2, 4, 8)}
print("\n".join(f"in plan, rms width {width} m: {error:.1f} cm" for width, error in errors.items()))
assert min(errors, key=errors.get) in (1, 2)

# %% [markdown]
# `denoise` estimates the amount of noise and mixes widths: better than each single width.

# %%
denoised, info = aw.denoise(plan, z)
print(f"denoise: {rms(denoised):.1f} cm; noise found: {100 * info['noise']:.1f} cm")
assert abs(info["noise"] - 0.25) < 0.02 and rms(denoised) < min(errors.values())

# %% [markdown]
# The errors as colors, drawn on the known land.

# %%
for name, heights in (("before", z), ("after", denoised)):
    error = 100 * (heights - clean[:, 2])
    scale, camera = aw.ColorScale(range=(-60, 60), label="error, cm"), aw.Camera(view=(30, 35), up="z")
    picture = aw.render(clean, values=error, scale=scale, camera=camera, size=(460, 300))
    picture.save(PICTURES / f"smooth_a_scan_{name}.png")
