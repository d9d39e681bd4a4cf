# %% [markdown]
# # A brain without noise
# In: an image of magnetic resonance, here the MNI template that nilearn ships, with noise. Out: the same image object.
#
#     clean, info = aw.denoise(noisy, noise="rician")

# %%
# %pip install -q "adwave[neuro]"
import adwave as aw
import numpy as np
from nilearn import datasets, image

template = datasets.load_mni152_template(resolution=2).slicer[:, :, 38:45]
truth, rng = template.get_fdata(), np.random.default_rng(0)
real, imaginary = rng.normal(0, 0.1, (2, *truth.shape))
noisy = image.new_img_like(template, np.hypot(truth + real, imaginary))
clean, info = aw.denoise(noisy, noise="rician")
print(f"noise {info['noise']:.3f} found, 0.1 true")

# %%
slices = [volume[:, :, 3].T[::-1] for volume in (truth, noisy.get_fdata(), clean.get_fdata())]
shades = np.uint8(255 * np.clip(np.concatenate(slices, axis=1), 0, 1)).repeat(3, axis=0).repeat(3, axis=1)
picture = aw.Picture.from_array(np.stack([shades] * 3, axis=2))
picture.save("a_brain_without_noise.png")
