# %% [markdown]
# # The Earth from few numbers
# In: colors on a sphere that was subdivided. Out: wavelet coefficients, of which 5 % draw the Earth again.
#
#     again = coefficients.keep(share).synthesize()

# %%
# %pip install -q "adwave[vtk]"
import adwave as aw
import numpy as np
from PIL import Image
from pyvista import examples

corners = [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
faces = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]]
earth = aw.subdivide((corners, faces), 7)
x, y, z = (earth.points / np.linalg.norm(earth.points, axis=1, keepdims=True)).T
earth = earth.with_points(np.c_[x, y, z])
world = np.asarray(Image.open(examples.mapfile).convert("RGB")) / 255
row, around = np.arccos(z) / np.pi, np.arctan2(y, x) / (2 * np.pi) + 0.5
colors = world[(row * (len(world) - 1)).astype(int), (around * (world.shape[1] - 1)).astype(int)]
coefficients = aw.hierarchy(earth).analyze(colors)

# %%
camera, pictures = aw.Camera(view=(110, 20), up="z"), []
for share in (1, 0.05, 0.01):
    again = coefficients.keep(share).synthesize()
    pictures.append(aw.render(earth, colors=np.clip(1.3 * again, 0, 1), camera=camera, size=(290, 290)))
picture = pictures[0].hstack(*pictures[1:])
picture.save("the_earth_from_few_numbers.png")
