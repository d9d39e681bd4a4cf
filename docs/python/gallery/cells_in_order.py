# %% [markdown]
# # Cells in order
# In: counts of 200 genes in 1000 cells, most of them 0. Out: means over similar cells; the counts choose how many.
#
#     found = aw.impute(counts)

# %%
# %pip install -q "adwave[cells]"
import adwave as aw
import numpy as np

rng = np.random.default_rng(2)
branch, t = rng.integers(0, 3, 1000), rng.uniform(0, 1, 1000)
waves = np.stack([np.sin((k + 1) * np.pi * t / 2) for k in range(6)], axis=1)
rate = np.exp(np.einsum("nk,nkg->ng", waves, rng.normal(0, 1, (3, 6, 200))[branch]) + rng.normal(0, 1, 200))
counts = rng.poisson(150 * rate / rate.sum(axis=1, keepdims=True))
found = aw.impute(counts)
print(f"{np.mean(counts == 0):.0%} of the counts are 0; {found.steps:g} steps chosen")

# %%
paint, pictures = np.array([[214, 93, 63], [60, 160, 110], [70, 100, 200]], np.uint8)[branch], []
for values in (np.sqrt(counts), np.sqrt(found.values)):
    u, s, _ = np.linalg.svd(values - values.mean(axis=0), full_matrices=False)
    places = u[:, :3] * s[:3] / s[0]
    pictures.append(aw.render(places, colors=paint, size=(400, 340)))
picture = pictures[0].hstack(pictures[1])
picture.save("cells_in_order.png")
