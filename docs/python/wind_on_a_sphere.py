# %% [markdown]
# # Wind on a sphere
#
# Tangent vectors are smoothed, split into bands and denoised; each turns with the surface on its way to a neighbor.

# %%
from pathlib import Path

import adwave as aw
import numpy as np

PICTURES = Path(__file__).parent / "pictures"
rng = np.random.default_rng(6)

# %% [markdown]
# The earth in kilometers. A wind in m/s: one from the west, fastest on the equator, and six vortices of 60 to
# 70 m/s, 1100 km from their centers. The noise of each coordinate is 10 m/s; what of it is along the normal takes no
# part.

# %%
earth = aw.sample("sphere", vertices=10_000)
up = earth.points / np.linalg.norm(earth.points, axis=1, keepdims=True)
earth = earth.with_points(6371 * up)
west = 25 * np.cross([0, 0, 1], up)
wind = west.copy()
latitudes, longitudes = np.radians([[28, -12, 45, -42, 30, -30], [-25, 25, 55, -20, 150, 200]])
for lat, lon, speed in zip(latitudes, longitudes, (70, -60, 60, -60, 60, -60), strict=True):
    center = np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    away = 6371 / 1100 * np.linalg.norm(up - center, axis=1)[:, None]
    wind += speed * 6371 / 1100 * np.cross(center, up) * np.exp((1 - away**2) / 2)
field = aw.vectors(earth, wind + rng.normal(0, 10, wind.shape))

# %% [markdown]
# Smoothing each coordinate by itself averages vectors of different tangent planes, which shortens the wind. The west
# wind loses twice as much of its speed as by directions: 1 − exp(−2t) and 1 − exp(−t), where 2t = (σ / radius)².

# %%
t = (4000 / 2.3548 / 6371) ** 2 / 2
kept = [
    np.linalg.norm(smooth, axis=1).mean() / np.linalg.norm(west, axis=1).mean()
    for smooth in (aw.smooth(earth, west, fwhm=4000), aw.vectors(earth, west).smooth(fwhm=4000).values)
]
print("speed kept: {:.1%} by coordinates, {:.1%} by directions".format(*kept))
assert np.allclose(kept, np.exp([-2 * t, -t]), atol=2e-3)

# %% [markdown]
# `denoise` estimates the noise, and leaves a smaller error than the best of ten widths. These are narrow, so that
# coordinates and directions hardly differ.


# %%
def rms(vectors):
    return np.sqrt(np.mean(np.sum((vectors - wind) ** 2, axis=1)))


clean, info = field.denoise()
by_coordinates = min(rms(aw.smooth(earth, field.values, fwhm=width)) for width in range(300, 1300, 100))
by_directions = min(rms(field.smooth(fwhm=width).values) for width in range(300, 1300, 100))
print(f"noise {info['noise']:.1f} m/s found; error {rms(field.values):.1f} m/s, then {rms(clean.values):.1f}")
print(f"best width: {by_coordinates:.1f} by coordinates, {by_directions:.1f} by directions")
assert abs(info["noise"] - 10) < 1 and rms(clean.values) < 0.95 * min(by_directions, by_coordinates)

# %% [markdown]
# Singularities are the places around which the wind turns. Noise makes hundreds, but their indices sum to 2, the
# Euler characteristic. The bands are complex numbers in the tangent planes, and sum to the wind.

# %%
for name, some in (("noisy", field), ("denoised", clean), ("true", aw.vectors(earth, wind))):
    indices = some.singularities().indices
    print(f"{name}: {len(indices)} singularities, their indices sum to {indices.sum():.0f}")
    assert indices.sum() == 2
bands = field.decompose(levels=aw.Widths(fwhm=[500, 1000, 2000, 4000]))
print("speeds of the bands, fine to coarse, m/s:", np.sqrt(np.mean(np.abs(bands) ** 2, axis=1)).round(1))
assert np.allclose(bands.sum(axis=0), field.complex)

# %% [markdown]
# Arrows at places of even density, as triangles above the sphere; colors show the speed.

# %%
k = np.arange(900) + 0.5
turn = np.pi * (1 + np.sqrt(5)) * k
even = np.stack([np.cos(turn), np.sin(turn), 0 * k], 1) * np.sqrt(1 - (1 - k / 450) ** 2)[:, None]
at = np.argmax((even + np.outer(1 - k / 450, [0, 0, 1])) @ up.T, axis=1)
colors = [(232, 243, 252), (150, 205, 238), (84, 190, 190), (255, 206, 84), (244, 96, 60)]
for name, some in (("noisy", field), ("denoised", clean)):
    along = 13 * some.values[at]
    side, base = np.cross(up[at], along), 6420 * up[at]
    parts = ((-0.5, 0.08), (-0.5, -0.08), (0.1, -0.08), (0.1, 0.08), (0.1, 0.28), (0.1, -0.28), (0.55, 0))
    corners = np.concatenate([base + a * along + b * side for a, b in parts])
    index = earth.n_vertices + np.arange(len(at)) + len(at) * np.arange(7)[:, None]
    faces = np.concatenate([earth.faces, index[[0, 1, 2]].T, index[[0, 2, 3]].T, index[[4, 5, 6]].T])
    speed = np.clip(some.lengths / 17, 0, 4)
    paint = np.stack([np.interp(speed, np.arange(5), channel) for channel in zip(*colors, strict=True)], 1) / 255
    drawn = aw.Shape(np.concatenate([earth.points, corners]), faces)
    paint = np.concatenate([paint, np.full_like(corners, 0.1)])
    picture = aw.render(drawn, colors=paint, camera=aw.Camera(view=(92, 10), up="z", zoom=1.03), size=(440, 440))
    picture.save(PICTURES / f"wind_on_a_sphere_{name}.png")
