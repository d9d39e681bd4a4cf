# %% [markdown]
# # Relief by scale
# In: heights of a valley, a raster that Matplotlib ships. Out: its wide form, and the ridges and gullies on it.
#
#     bands = aw.grid(height, spacing).decompose(sigma=[500])

# %%
# %pip install -q adwave matplotlib
import adwave as aw
import numpy as np
from matplotlib import cbook, colormaps

height = np.load(cbook.get_sample_data("jacksboro_fault_dem.npz", asfileobj=False))["elevation"][60:330, 10:300]
spacing = (92.7, 74.4)  # meters
bands = aw.grid(height, spacing).decompose(sigma=[500])
ridges, form = bands[0], bands[1]


# %%
def relief(values, colors, limits):
    south, east = np.gradient(values, *spacing)
    light = np.clip(1 - 1.5 * (south + east) / np.sqrt(1 + south**2 + east**2), 0.3, 1.4)
    paint = colormaps[colors]((values - limits[0]) / (limits[1] - limits[0]))[:, :, :3]
    return aw.Picture.from_array(np.uint8(255 * np.clip(light[:, :, None] * paint, 0, 1)))


wide, fine = relief(form, "gist_earth", (150, 1100)), relief(ridges, "coolwarm", (-200, 200))
picture = relief(height.astype(float), "gist_earth", (150, 1100)).hstack(wide, fine)
picture.save("relief_by_scale.png")
