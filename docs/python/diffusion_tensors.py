# %% [markdown]
# # Diffusion tensors
#
# A volume of tensors, as of diffusion MRI: smoothed by their logarithms, they stay positive and do not swell; and
# denoised, the fibers have their directions again.

# %%
from pathlib import Path

import adwave as aw
import numpy as np

PICTURES = Path(__file__).parent / "pictures"
rng = np.random.default_rng(7)

# %% [markdown]
# Voxels of 2 mm: fibers along an arch, and a bundle below that goes up through the slices. Along the fibers the
# diffusivity is 1.7, across them 0.3, elsewhere 0.7 in all directions (in 10⁻³ mm²/s).

# %%
sizes = (64, 48, 5)
x, y, z = 2.0 * np.indices(sizes) + 1
radius = np.hypot(x - 64, y - 28)


def along(direction):
    direction = np.stack(np.broadcast_arrays(*direction), axis=-1)
    return 0.3 * np.eye(3) + 1.4 * direction[..., :, None] * direction[..., None, :]


true = np.broadcast_to(0.7 * np.eye(3), (*sizes, 3, 3)).copy()
arch = (np.abs(radius - 47) < 10) & (y > 28) | (np.abs(np.abs(x - 64) - 47) < 10) & (y <= 28)
up = np.hypot(x - 64, y - 32) < 16
above = np.maximum(y - 28, 0)
true[arch] = along((above / radius, np.where(y > 28, (64 - x) / radius, 1), 0 * x))[arch]
true[up] = along((0, 0, 1))

# %% [markdown]
# The noise is in the logarithms of the tensors, so that all of them are positive definite.


# %%
def of_eigenvalues(tensors, function):
    values, vectors = np.linalg.eigh(tensors)
    return (vectors * function(values)[..., None, :]) @ np.swapaxes(vectors, -1, -2)


noise = rng.normal(0, 0.5, true.shape)
noisy = of_eigenvalues(of_eigenvalues(true, np.log) + (noise + np.swapaxes(noise, -1, -2)) / 2, np.exp)
field = aw.tensors(aw.grid(np.zeros(sizes), spacing=2.0), noisy)
assert field.n_not_positive == 0

# %% [markdown]
# The determinant is the size of a tensor. The mean of slender tensors with different directions, here mostly by noise,
# is a thick one, so tensors swell if each component is smoothed by itself. By logarithms the mean of log det stays.

# %%
by_component = aw.grid(noisy, spacing=2.0, axes=(0, 1, 2)).smooth(fwhm=6.0)
smooth = field.smooth(fwhm=6.0).matrices
swelling = [
    np.exp(np.mean(np.log(np.linalg.det(tensors) / np.linalg.det(noisy)))) for tensors in (by_component, smooth)
]
print("determinants: {:.2f} times as large by components, {:.4f} by logarithms".format(*swelling))
assert swelling[0] > 1.3 and abs(swelling[1] - 1) < 1e-6

# %% [markdown]
# `denoise` finds the noise of each component of the logarithms, and preserves the borders of the bundles.


# %%
def angle(tensors):
    vectors = [np.linalg.eigh(some[arch])[1][:, :, 2] for some in (tensors, true)]
    return np.degrees(np.arccos(np.clip(np.abs(np.sum(vectors[0] * vectors[1], axis=1)), 0, 1))).mean()


denoised, info = field.denoise()
print("noise of xx, xy, xz, yy, yz, zz:", *(f"{group['noise']:.2f}" for group in info["groups"]))
for name, some in (("noisy", noisy), ("components", by_component), ("smooth", smooth), ("denoised", denoised.matrices)):
    print(f"{name:>10}: rms error {np.sqrt(np.mean((some - true) ** 2)):.3f}, fibers {angle(some):4.1f}° off")
    assert np.linalg.eigvalsh(some).min() > 0
assert angle(denoised.matrices) < 0.3 * angle(noisy)

# %% [markdown]
# A slice: red, green and blue are the directions x, y and z of the largest eigenvalue; bright where it is much larger
# than the others (the fractional anisotropy).


# %%
def colored(tensors):
    values, vectors = np.linalg.eigh(tensors[:, :, 2])
    anisotropy = np.sqrt(1.5 * np.sum((values - values.mean(-1, keepdims=True)) ** 2, -1) / np.sum(values**2, -1))
    color = np.abs(vectors[..., 2]) * anisotropy[..., None] ** 1.5 * 330
    return aw.Picture.from_array(np.uint8(color.clip(0, 255).swapaxes(0, 1)[::-1].repeat(7, axis=0).repeat(7, axis=1)))


for name, tensors in (("noisy", noisy), ("denoised", denoised.matrices)):
    colored(tensors).save(PICTURES / f"diffusion_tensors_{name}.png")
