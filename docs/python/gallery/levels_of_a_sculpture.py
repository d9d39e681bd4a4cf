# %% [markdown]
# # Levels of a sculpture
# In: quadrilaterals that were subdivided and sculpted. Out: its control mesh, and the sculpture on an edited control mesh.
#
#     posed = levels.with_level(control * stretch, 4, family="linear")

# %%
import adwave as aw
import numpy as np

corners = [[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
smooth = aw.subdivide(aw.Shape(corners, sides), 6, family="catmull-clark")
out = smooth.points / np.linalg.norm(smooth.points, axis=1, keepdims=True)
bumps = 0.03 * np.sin(14 * out).prod(axis=1, keepdims=True)
sculpture = smooth.with_points(smooth.points + bumps * out)
levels = aw.hierarchy(sculpture)
coarse = levels.shape(4, family="linear")
control, stretch = np.asarray(coarse.points), np.array([1, 1, 2])
posed = levels.with_level(control * stretch, 4, family="linear")
versions = (sculpture, coarse, sculpture.with_points(posed))

# %%
camera = aw.Camera(view=(35, 20), up="z")
pictures = [aw.render(each, camera=camera, size=(290, 320)) for each in versions]
picture = pictures[0].hstack(*pictures[1:])
picture.save("levels_of_a_sculpture.png")
