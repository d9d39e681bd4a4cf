# %% [markdown]
# # Remove noise
#
# `denoise` estimates the amount of noise, the width of the smoothing, and whether sharp edges must be preserved.

# %%
from pathlib import Path

import adwave as aw
import numpy as np

PICTURES = Path(__file__).parent / "pictures"


def rms(shape, clean):
    return np.sqrt(np.mean(np.sum((shape.points - clean.points) ** 2, axis=1)))


# %% [markdown]
# A smooth knot, a creature full of detail and a machined bracket with sharp edges. Each gets noise along the
# normals of 0.3 mean edge lengths; all numbers are in mean edge lengths.

# %%
print("shape     noise  found  error after  times less")
for name in ("knot", "creature", "bracket"):
    clean, noisy = (aw.sample(name, vertices=10_000, noise=noise) for noise in (None, 0.3))
    edge = aw.Decomposer(clean).mean_length
    denoised, info = aw.denoise(noisy)
    before, after = rms(noisy, clean) / edge, rms(denoised, clean) / edge
    print(f"{name:<9} {before:5.2f}  {info['noise'] / edge:5.2f}  {after:11.3f}  {before / after:10.1f}")
    assert abs(info["noise"] / edge - 0.3) < 0.03  # found within a tenth
    assert after < before / (1.3 if name == "creature" else 4)

# %% [markdown]
# The creature gains least: at 10 000 vertices its scales are only a few edges wide, and detail of that size looks
# like noise.
#
# The estimated risk decides whether edges are preserved. On the bracket `"auto"` preserves them;
# smoothing across them rounds them off.

# %%
error = {}
for creases in ("auto", "keep", "none"):
    denoised, info = aw.denoise(noisy, creases=creases)
    error[creases] = rms(denoised, clean) / edge
    print(f"bracket, creases={creases!r}: error {error[creases]:.3f}")
    off = np.linalg.norm(denoised.points - clean.points, axis=1) / edge
    scale = aw.ColorScale(color_map="magma", range=(0, 0.5), label="error, edges")
    if creases != "keep":
        picture = aw.render(denoised, values=off, scale=scale, size=(520, 390))
        picture.save(PICTURES / f"denoise_error_{creases}.png")
assert error["auto"] < 1.1 * error["keep"] and error["auto"] < 0.8 * error["none"]

# %% [markdown]
# A known amount of noise can be given, and `strength` is a factor of the noise: below 1 more careful, above 1 more
# thorough.

# %%
known, _ = aw.denoise(noisy, noise=0.3 * edge)
careful, _ = aw.denoise(noisy, strength=0.5)
print(f"noise given: {rms(known, clean) / edge:.3f}, strength 0.5: {rms(careful, clean) / edge:.3f}")
assert rms(known, clean) < 1.1 * rms(aw.denoise(noisy).result, clean)

# %%
aw.render(noisy, size=(520, 390)).save(PICTURES / "denoise_before.png")
aw.render(aw.denoise(noisy).result, size=(520, 390)).save(PICTURES / "denoise_after.png")
