# %% [markdown]
# # Remove noise on a graph
# In: the roads of Minnesota, which PyGSP ships, and values at the crossings. Out: the values without noise.
#
#     clean, info = aw.denoise(roads, noisy)

# %%
# %pip install -q "adwave[all]" pygsp
import adwave as aw
import numpy as np
from pygsp import graphs

roads = graphs.Minnesota()
x, y = roads.coords.T
truth = np.where(y > 45.5, 1.0, -1.0) + 0.5 * np.sin(3 * x)
noisy = truth + np.random.default_rng(0).normal(0, 0.8, truth.shape)
clean, info = aw.denoise(roads, noisy)
print(f"noise {info['noise']:.2f} found; error {np.std(noisy - truth):.2f}, then {np.std(clean - truth):.2f}")

# %%
places, (first, second) = np.c_[x, 1.4 * y, 0 * x], np.nonzero(np.triu(roads.W.toarray()))
along = places[second] - places[first]
side = 0.03 * np.cross(along / (np.linalg.norm(along, axis=1, keepdims=True) + 1e-9), [0, 0, 1])
corners = np.concatenate([places[first] - side, places[first] + side, places[second] + side, places[second] - side])
drawn = aw.Shape(corners, np.arange(len(corners)).reshape(4, -1).T)  # a rectangle for each road
camera, scale = aw.Camera(view="front"), aw.ColorScale(range=(-1.6, 1.6), bar=False)
at = np.concatenate([first, first, second, second])
pictures = [aw.render(drawn, f[at], scale=scale, camera=camera, size=(290, 330)) for f in (truth, noisy, clean)]
picture = pictures[0].hstack(*pictures[1:])
picture.save("roads_without_noise.png")
