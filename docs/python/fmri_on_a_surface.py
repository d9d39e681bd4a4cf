# %% [markdown]
# # fMRI on a surface
#
# A series of frames on a folded surface: bands in space and time, smoothing in both, and a patch that switches on
# and off, found under noise that is as large as its signal.

# %%
from itertools import product
from pathlib import Path

import adwave as aw
import numpy as np

PICTURES = Path(__file__).parent / "pictures"
rng = np.random.default_rng(8)

# %% [markdown]
# A surface with folds of 4 mm, as in `cortical_fields.py`.

# %%
ball = aw.sample("sphere", vertices=7000)
ellipsoid = aw.Shape(ball.points * [42, 56, 40], ball.faces)
smooth_shape = aw.Decomposer(ellipsoid, operator="surface")
band = smooth_shape.decompose(rng.standard_normal(ball.n_vertices), levels=aw.Widths(fwhm=[8, 11])).wavelet(2)
folds = aw.smooth(smooth_shape, np.tanh(3 * band / band.std()), fwhm=4)
cortex = ellipsoid.with_points(ellipsoid.points + 4 * folds[:, None] * aw.signal(ellipsoid, "normals"))
surface = aw.Decomposer(cortex, operator="surface")

# %% [markdown]
# The series, in percent: an anatomy that is steady, with detail of 5 mm; a slow drift; a patch that is on and off for
# 24 s in turn, by 1 %; and noise of 1 % at each vertex of each frame.

# %%
n, t = cortex.n_vertices, 2.0 * np.arange(80)
anatomy = aw.smooth(surface, rng.standard_normal(n), fwhm=5)
drift = aw.smooth(surface, rng.standard_normal(n), fwhm=40)
away = np.linalg.norm(cortex.points - cortex.points[np.argmax(cortex.points @ [1.0, 0.1, 0.25])], axis=1)
patch = 1 / (1 + np.exp((away - 22) / 1.5))
task = aw.Time(dt=2.0, fwhm=5.0).smooth(1.0 * (t % 48 >= 24))
steady = 2 * (anatomy / anatomy.std())[:, None]
clean = steady + patch[:, None] * task + 0.3 * (drift / drift.std())[:, None] * np.cos(np.pi * t / 160)
series = clean + rng.standard_normal(clean.shape)

# %% [markdown]
# Bands of space and time, `bands[j, i]`, sum to the series. The anatomy is steady, and in the last column alone.

# %%
bands = aw.decompose(surface, series, fwhm=[4, 8, 16], time=aw.Time(dt=2.0, fwhm=[6, 20, 80]))
assert np.allclose(bands.sum(axis=(0, 1)), series)
print("variance     < 6 s  6–20 s 20–80 s  slower")
for name, row in zip(("< 4 mm", "4–8 mm", "8–16 mm", "wider"), (bands**2).mean(axis=(2, 3)), strict=True):
    print(f"{name:>8}  ", *(f"{share:7.4f}" for share in row))
of_steady = aw.decompose(surface, steady + 0 * t, fwhm=[4, 8, 16], time=aw.Time(dt=2.0, fwhm=[6, 20, 80]))
assert np.abs(of_steady[:, :-1]).max() < 1e-9

# %% [markdown]
# `denoise` keeps the detail of what is steady, and averages what changes over wide places and many frames. The best of
# 16 Gaussian smoothings cannot do both. If the mean over all frames is added after smoothing, the best one is about as
# good, but only the truth tells which one that is.


# %%
def rms(values):
    return np.sqrt(np.mean((values - clean) ** 2))


def smoothed(values, fwhm, seconds):
    return aw.smooth(surface, values, fwhm=fwhm, time=aw.Time(dt=2.0, fwhm=seconds))


mean = series.mean(axis=1, keepdims=True)
best = min(rms(smoothed(series, *widths)) for widths in product((1, 2, 4, 8), (4, 8, 16, 32)))
of_changes = [rms(mean + smoothed(series - mean, *widths)) for widths in product((4, 8, 12, 16), (4, 8, 16, 32))]
denoised, info = aw.denoise(cortex, series, time=aw.Time(dt=2.0))
print(f"noise {info['noise']:.2f} % found; error {rms(series):.2f} %, then {rms(denoised):.3f} %")
print(f"best Gaussian {best:.3f} %; with the mean kept {min(of_changes):.3f} to {max(of_changes):.3f} %")
assert abs(info["noise"] - 1) < 0.03 and rms(denoised) < min(0.6 * best, 1.02 * min(of_changes))

# %% [markdown]
# The change from a frame of rest to one in the middle of the last activation, before and after.

# %%
side = aw.Camera(view=(100, 15), up="z", zoom=1.0)
for name, values in (("noisy", series), ("denoised", denoised)):
    scale = aw.ColorScale(color_map="coolwarm", range=(-1, 1), label="change, %")
    change = values[:, 42] - values[:, 30]
    picture = aw.render(cortex, change, scale=scale, camera=side, size=(440, 330))
    picture.save(PICTURES / f"fmri_on_a_surface_{name}.png")
