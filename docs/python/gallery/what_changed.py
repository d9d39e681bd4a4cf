# %% [markdown]
# # What changed between two scans
# In: a shape before and after. Out: signed distances, split by scale: a fine dent and a wide bulge come apart.
#
#     bands = aw.decompose(before, change, fwhm=[0.25])

# %%
import adwave as aw
import numpy as np

before = aw.sample("torus", vertices=20_000)
x, y, z = before.points.T
dents = 0.02 * np.exp(-((np.hypot(x, y) - 1) ** 2 + (np.cos(6 * np.arctan2(y, x)) - 1) ** 2 / 4) / 0.01) * (z > 0)
bulge = 0.06 * np.exp(-((x - 1) ** 2 + y**2) / 0.5)
after = before.with_points(before.points + (bulge - dents)[:, None] * aw.signal(before, "normals"))
change = aw.distances(before, after).values
bands = aw.decompose(before, change, fwhm=[0.25])

# %%
camera, scale = aw.Camera(view=(30, 50), up="z"), aw.ColorScale(range=(-0.06, 0.06), bar=False)
parts = (change, bands.wavelet(1), bands.scaling(1))
pictures = [aw.render(after, part, scale=scale, camera=camera, size=(290, 240)) for part in parts]
picture = pictures[0].hstack(*pictures[1:])
picture.save("what_changed.png")
