# %% [markdown]
# # Find every dimple
# In: a golf ball. Out: the place and the size of each dimple.
#
#     found = aw.features(ball)

# %%
import adwave as aw
import numpy as np

ball = aw.sample("sphere", vertices=30_000)
up = ball.points / np.linalg.norm(ball.points, axis=1, keepdims=True)
k = np.arange(150) + 0.5  # 150 places of even density
around, z = np.pi * (1 + np.sqrt(5)) * k, 1 - k / 75
places = np.stack([np.cos(around), np.sin(around), 0 * k], 1) * np.sqrt(1 - z**2)[:, None] + np.outer(z, [0, 0, 1])
depth = 0.03 * np.exp(-(np.arccos(np.clip(up @ places.T, -1, 1)) ** 2) / 0.005).sum(axis=1)
ball = ball.with_points(up * (1 - depth)[:, None])
found = aw.features(ball)
print(f"{len(found)} features, {np.count_nonzero(found['sign'] < 0)} of them hollow")

# %%
picture = aw.render(ball, size=(400, 360)).hstack(aw.render(ball, balls=found, size=(400, 360)))
picture.save("find_every_dimple.png")
