# %% [markdown]
# # An animation
#
# A creature that sways and waves, with jitter: the jitter is removed, the motion is made larger, and a map shows
# where it moves.

# %%
from pathlib import Path

import adwave as aw
import numpy as np

PICTURES = Path(__file__).parent / "pictures"
rng = np.random.default_rng(9)


def rms(values):
    return np.sqrt(np.mean(values**2))


# %% [markdown]
# 40 frames, 25 in a second: the body sways by 9°, and an arm waves by 25° twice as fast. The jitter of each
# coordinate is 0.3 of an edge.


# %%
def turned(points, pivot, angles):
    x, y = (points[:, :2] - pivot).T
    cos, sin = np.cos(angles), np.sin(angles)
    return np.stack([pivot[0] + cos * x - sin * y, pivot[1] + sin * x + cos * y, points[:, 2]], axis=1)


creature = aw.sample("creature", vertices=6000)
jitter = 0.3 * aw.info(creature).mean_length
x, y, z = creature.points.T
arm = np.clip((x - 0.3) / 0.2, 0, 1) * (y > 0.95) * np.clip((1.62 + x - y) / 0.2, 0, 1)
body = np.clip((y - 0.5) / 1.2, 0, 1)
frames = []
for k in range(40):
    waving = turned(creature.points, (0.3, 1.2), np.radians(25) * (np.sin(2 * np.pi * k / 20) - 0.35) * arm)
    frames.append(turned(waving, (0, 0.5), np.radians(9) * np.sin(2 * np.pi * k / 40) * body))
true = np.array(frames)
moving = aw.sequence(true + rng.normal(0, jitter, true.shape), dt=0.04, faces=creature.faces)

# %% [markdown]
# The jitter is estimated and removed in space and time together: the steady shape keeps its detail. Smoothing along
# time alone, with the best of six widths, leaves more.

# %%
clean, info = moving.denoise()
in_time = min(rms(moving.smooth(time=width).points - true) for width in (0.08, 0.12, 0.16, 0.2, 0.3, 0.4))
errors = np.array([rms(moving.points - true), in_time, rms(clean.points - true)]) / jitter
print(f"jitter {info['noise']:.4f} found, {jitter:.4f} true")
print("error in parts of the jitter: {:.2f}, best width along time {:.2f}, denoised {:.2f}".format(*errors))
assert abs(info["noise"] / jitter - 1) < 0.05 and errors[2] < 0.7 * errors[1]

# %% [markdown]
# `filter` multiplies bands along time by gains: motion slower than 0.1 s becomes 1.7 times as large. The rest, above
# 20 s, is the mean over all frames, and stays.

# %%
lively = clean.filter([1.0, 1.7], time=[0.1, 20.0])
mean = clean.points.mean(axis=0)
larger = rms(lively.points - mean) / rms(clean.points - mean)
print(f"motion {larger:.2f} times as large")
assert np.allclose(lively.points.mean(axis=0), mean) and 1.6 < larger < 1.7

# %% [markdown]
# The motion of each vertex, by the size of what moves, and in all. The hand that waves moves most, the feet
# hardly.

# %%
by_size = clean.motion(levels=aw.Widths(fwhm=["5%", "20%", "80%"]))
moves = np.sqrt(np.mean(np.sum((clean.points - mean) ** 2, axis=2), axis=0))
print("motion by size, fine to coarse:", np.sqrt(np.mean(by_size**2, axis=1)).round(4))
print(f"motion of the hand that waves {moves[x > 0.6].mean():.3f}, of the feet {moves[y < 0.1].mean():.4f}")
assert moves[x > 0.6].mean() > 10 * moves[y < 0.1].mean()

# %% [markdown]
# Four frames with jitter, and without; at the bottom with larger motion, colored by the map.

# %%
camera = aw.Camera(view=(15, 8), up="y", zoom=0.98, focus=(0, 1.0, 0))
scale = aw.ColorScale(color_map="coolwarm", range=(-0.25, 0.25), bar=False)
for name, some, values in (("noisy", moving, None), ("denoised", clean, None), ("larger", lively, moves)):
    row = [aw.render(some[k], values, scale=scale, camera=camera, size=(240, 250)) for k in (0, 5, 15, 30)]
    row[0].hstack(*row[1:]).save(PICTURES / f"an_animation_{name}.png")
