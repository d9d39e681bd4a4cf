# %% [markdown]
# # Remove noise from a point cloud
# In: points with noise, without triangles. Out: as many points in the same order, close to the surface.
#
#     clean, info = aw.denoise(noisy)

# %%
import adwave as aw
import numpy as np

points = aw.sample("knot", vertices=30_000).points
noisy = points + np.random.default_rng(0).normal(0, 0.02, points.shape)
clean, info = aw.denoise(noisy)

# %%
camera, scale = aw.Camera(view="top"), aw.ColorScale(range=(-0.04, 0.04), bar=False)
pictures = []
for cloud in (noisy, clean):
    error = aw.distances(cloud, aw.sample("knot", vertices=30_000)).values
    print(f"distance from the surface {np.std(error):.4f}")
    pictures.append(aw.render(cloud, error, camera=camera, scale=scale, size=(400, 360)))
picture = pictures[0].hstack(pictures[1])
picture.save("denoise_a_cloud.png")
