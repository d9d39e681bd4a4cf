# %% [markdown]
# # Stars and a galaxy
# In: counts of photons. Out: the sky without their noise; the last picture is the true one.
#
#     clean, info = aw.grid(photons).denoise(noise="poisson")

# %%
import adwave as aw
import numpy as np

rng = np.random.default_rng(3)
y, x = np.mgrid[:220, :290] - 110.0
r, turn = np.hypot(x / 1.2, y), np.arctan2(y, x / 1.2)
sky = 1 + 25 * np.exp(-r / 22) * (1 + 0.7 * np.cos(2 * turn - 6 * np.log(r + 5))) + 80 * np.exp(-(r**2) / 90)
stars = rng.uniform(-105, 175, (60, 2))
for (north, east), light in zip(stars, rng.pareto(1.2, 60) * 10 + 8, strict=True):
    sky += light * np.exp(-((y - north) ** 2 + (x - east) ** 2) / 4.5)
photons = rng.poisson(sky)
clean, info = aw.grid(photons).denoise(noise="poisson")
print(f"error {np.std(photons - sky):.2f}, then {np.std(clean - sky):.2f}")


# %%
def shown(values):
    light = np.sqrt(np.clip(values / 50, 0, 1))
    return aw.Picture.from_array(np.uint8(255 * np.stack([light**1.1, light**1.3, light**0.8], axis=2)))


picture = shown(photons).hstack(shown(clean), shown(sky))
picture.save("stars_and_a_galaxy.png")
