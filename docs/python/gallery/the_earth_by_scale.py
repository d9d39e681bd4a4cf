# %% [markdown]
# # The Earth by scale
# In: a map of the world, which PyVista ships, on a sphere. Out: what is wider than 1500 km, without seams and poles.
#
#     wide = aw.smooth(earth, colors, fwhm=1500)

# %%
# %pip install -q "adwave[vtk]"
import adwave as aw
import numpy as np
from PIL import Image
from pyvista import examples

world = np.asarray(Image.open(examples.mapfile).convert("RGB")) / 255
earth = aw.sample("sphere", vertices=50_000)
x, y, z = (earth.points / np.linalg.norm(earth.points, axis=1, keepdims=True)).T
earth = earth.with_points(6371 * np.c_[x, y, z])
row = (np.arccos(z) / np.pi * (len(world) - 1)).astype(int)
column = ((np.arctan2(y, x) / (2 * np.pi) + 0.5) * (world.shape[1] - 1)).astype(int)
colors = world[row, column]
wide = aw.smooth(earth, colors, fwhm=1500)
vivid = aw.filter(earth, colors, [1, 2.5, 1.5], fwhm=[150, 1000, 3000])

# %%
camera = aw.Camera(view=(20, 20), up="z")
paint = [np.clip(1.3 * each, 0, 1) for each in (colors, wide, vivid)]
pictures = [aw.render(earth, colors=each, camera=camera, size=(290, 290)) for each in paint]
picture = pictures[0].hstack(*pictures[1:])
picture.save("the_earth_by_scale.png")
