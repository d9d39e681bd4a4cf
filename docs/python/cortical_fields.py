# %% [markdown]
# # Fields on a cortex
#
# A folded closed surface nearly the size of a hemisphere, a thickness on it with a wide pattern and noise,
# and its bands by full widths at half maximum (FWHM) in millimeters.

# %%
from pathlib import Path

import adwave as aw
import numpy as np

PICTURES = Path(__file__).parent / "pictures"
rng = np.random.default_rng(3)

# %% [markdown]
# The folds: one band of white noise on an ellipsoid, made steeper, moves the surface in and out by 4 mm.

# %%
ball = aw.sample("sphere", vertices=20_000)
ellipsoid = aw.Shape(ball.points * [42, 56, 40], ball.faces)
on_ellipsoid = aw.Decomposer(ellipsoid, operator="surface")
band = on_ellipsoid.decompose(rng.standard_normal(ball.n_vertices), levels=aw.Widths(fwhm=[8, 11])).wavelet(2)
folds = on_ellipsoid.decompose(np.tanh(3 * band / band.std()), levels=aw.Widths(fwhm=[4])).scaling(1)
cortex = ellipsoid.with_points(ellipsoid.points + 4 * folds[:, None] * aw.signal(ellipsoid, "normals"))
found = aw.info(cortex)
print(f"{cortex}, area {found.area / 100:.0f} cm², edges of {found.mean_length:.2f} mm")
assert found.closed and found.euler_characteristic == 2

# %% [markdown]
# A thickness: 2.5 mm, a pattern more than 20 mm wide that varies by 0.3 mm, and as much noise, independent at
# each vertex.

# %%
surface = aw.Decomposer(cortex, operator="surface")
noise = 0.3 * rng.standard_normal(cortex.n_vertices)
pattern = surface.decompose(rng.standard_normal(cortex.n_vertices), levels=aw.Widths(fwhm=[20])).scaling(1)
pattern *= 0.3 / pattern.std()
thickness = 2.5 + pattern + noise

# %% [markdown]
# Smoothing to a width w reduces noise by a known factor: its variance is multiplied by a / (4π s²), where a is
# the area of a vertex and s = w / 2.355. (NaN would mask a vertex, such as those of the medial wall.)

# %%
areas = surface.areas
for w in (4.0, 8.0, 16.0):
    left = surface.decompose(noise, levels=aw.Widths(fwhm=[w])).scaling(1)
    rms = np.sqrt(np.average(left**2, weights=areas))
    law = 0.3 * np.sqrt(np.average(areas, weights=areas) / (4 * np.pi * (w / 2.355) ** 2))
    print(f"noise smoothed to {w:2.0f} mm FWHM: {rms:.4f} mm, by theory {law:.4f} mm")
    assert abs(rms / law - 1) < 0.15

# %% [markdown]
# The bands, and the variance of each. The noise is in the finest bands, the pattern in the wide ones; the bands
# of a sum are the sums of the bands.

# %%
bands = surface.decompose(thickness, levels=aw.Widths(fwhm=[2, 4, 8, 16, 32]))
parts = [surface.decompose(f, levels=aw.Widths(fwhm=bands.fwhm)) for f in (thickness - 2.5, noise, pattern)]
shares = [part.energy() / areas.sum() for part in parts]
print("band             all    noise  pattern  (mm²)")
for j, row in enumerate(zip(*shares, strict=True)):
    name = f"{0 if j == 0 else bands.fwhm[j - 1]:2.0f} to {bands.fwhm[j]:2.0f} mm" if j < 5 else "wider      "
    print(name, *(f"{share:8.4f}" for share in row))
assert np.allclose(parts[1].array + parts[2].array, parts[0].array, atol=1e-9)
_, of_noise, of_pattern = shares
assert of_noise[:2].sum() > 0.85 * of_noise.sum() and of_pattern[3:].sum() > 0.9 * of_pattern.sum()
assert np.allclose(bands.reconstruct(), thickness, atol=1e-12)

# %% [markdown]
# The levels wider than 8 mm show the pattern, nearly without noise.

# %%
wide = bands.scaling(3)
error = np.sqrt(np.average((wide - 2.5 - pattern) ** 2, weights=areas))
print(f"error of the thickness: {noise.std():.3f} mm as given, {error:.3f} mm above 8 mm")
assert error < 0.06

# %%
side = aw.Camera(view=(80, 25), up="z")
for name, label, values in (("", "thickness, mm", thickness), ("_wide", "above 8 mm", wide)):
    scale = aw.ColorScale(range=(1.7, 3.3), label=label)
    picture = aw.render(cortex, values=values, scale=scale, camera=side, size=(440, 330))
    picture.save(PICTURES / f"cortical_fields{name}.png")
