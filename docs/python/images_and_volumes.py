# %% [markdown]
# # Images and volumes
#
# An image is denoised, mounds are found on the hills of a terrain, and a volume is smoothed inside a mask.

# %%
from pathlib import Path

import adwave as aw
import numpy as np

PICTURES = Path(__file__).parent / "pictures"
rng = np.random.default_rng(4)


def rms(values):
    return np.sqrt(np.mean(values**2))


# %% [markdown]
# A disk on a wave, with noise of 0.2. The noise is estimated, and the edge of the disk stays sharp.

# %%
row, column = np.mgrid[:150, :150]
clean = 1.0 * (np.hypot(row - 70, column - 80) < 45) + 0.2 * np.sin(row / 20)
noisy = clean + rng.normal(0, 0.2, clean.shape)
denoised, info = aw.grid(noisy).denoise()
print(f"noise {info['noise']:.3f} found; error {rms(noisy - clean):.3f}, then {rms(denoised - clean):.3f}")
assert rms(denoised - clean) < 0.25 * rms(noisy - clean)

# %% [markdown]
# A terrain with places 5 m apart: hills that rise 50 m, 16 mounds of 3 m, and noise of 5 cm. The bands sum to it, and
# the first one, up to 15 m, shows the mounds. Each is a feature at its place and of its size, 11 m; hills are wider
# features.

# %%
north, east = 5.0 * np.mgrid[:300, :300]
hills = aw.grid(rng.normal(size=north.shape), spacing=5.0).smooth(sigma=70.0)
hills *= 50 / np.ptp(hills)
tops = 375.0 * np.mgrid[:4, :4].reshape(2, -1).T + 190 + rng.integers(-60, 60, (16, 2))
mounds = sum(3 * np.exp(-((north - y) ** 2 + (east - x) ** 2) / (2 * 11**2)) for y, x in tops)
land = hills + mounds + rng.normal(0, 0.05, north.shape)
terrain = aw.grid(land, spacing=5.0)
bands = np.asarray(terrain.decompose(sigma=[15.0, 60.0]))
assert np.allclose(bands.sum(axis=0), land)
features = terrain.features()
small = features[features["sigma"] < 20]
away = np.linalg.norm(tops[:, None] - small["position"][None, :, :2], axis=2).min(axis=1)
print(f"{len(features)} features, {len(small)} of them small; mounds at most {away.max():.1f} m from one")
assert len(small) == 16 and away.max() < 8 and np.abs(small["sigma"] - 11).max() < 2

# %% [markdown]
# A volume with voxels of 2 × 2 × 3 mm: inside a mask a wide pattern and noise, outside 0. Values outside are not seen
# from inside, so that the smoothed volume has no dark rim.

# %%
spacing = (2.0, 2.0, 3.0)
x, y, z = np.indices((75, 60, 40)) * np.reshape(spacing, (3, 1, 1, 1))
mask = ((x - 74) / 65) ** 2 + ((y - 59) / 52) ** 2 + ((z - 58) / 50) ** 2 < 1
pattern = 1 + 0.3 * np.sin(x / 15) * np.cos(y / 20)
volume = mask * (pattern + rng.normal(0, 0.5, mask.shape))
inside = aw.grid(volume, spacing, mask).smooth(fwhm=8.0)
across = aw.grid(volume, spacing).smooth(fwhm=8.0)
errors = [rms((values - pattern)[mask]) for values in (volume, across, inside)]
print("error {:.3f}, smoothed {:.3f}, smoothed inside the mask {:.3f}".format(*errors))
assert 2 * errors[2] < errors[1] < errors[0] and np.array_equal(inside[~mask], volume[~mask])

# %% [markdown]
# The image, noisy and denoised; the terrain, twice as steep, colored by its first band, with the small features; a
# slice of the volume, smoothed across the mask and inside.


# %%
def gray(values, zoom):
    shade = np.uint8(255 * np.clip((values + 0.3) / 1.9, 0, 1)).repeat(zoom, axis=0).repeat(zoom, axis=1)
    return aw.Picture.from_array(np.stack([shade] * 3, axis=2))


height = 2 * land
corners = np.arange(height.size).reshape(height.shape)[:-1, :-1].ravel()
faces = np.concatenate([corners[:, None] + [0, 300, 1], corners[:, None] + [1, 300, 301]])
relief = aw.Shape(np.stack([east, -north, height], axis=2).reshape(-1, 3), faces)
points = relief.points[small["vertex"]]
marks = [(point, 1.5 * sigma, (250, 210, 40)) for point, sigma in zip(points, small["sigma"], strict=True)]
camera, scale = aw.Camera(view=(10, 55), up="z", zoom=1.05), aw.ColorScale(range=(-1, 1), bar=False)
above = aw.render(relief, bands[0].ravel(), balls=marks, camera=camera, scale=scale, size=(440, 300))
slices = [gray(values[:, :, 20], 4) for values in (across, inside)]
gray(noisy, 2).hstack(gray(denoised, 2), above, *slices).save(PICTURES / "images_and_volumes.png")
