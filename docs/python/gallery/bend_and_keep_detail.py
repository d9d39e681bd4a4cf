# %% [markdown]
# # Bend a shape, keep its detail
# In: a mesh, a part that stays, a handle and its motion. Out: a bent body whose scales turned with it.
#
#     deformer.move(0, motion)

# %%
import adwave as aw
import numpy as np

shape = aw.sample("creature", vertices=30_000)
deformer = shape.deformer("half-space:point=0 0.4 0,normal=0 -1 0", ["half-space:point=0 1.5 0,normal=0 1 0"])
versions = []
for degrees in (-40, 0, 40):
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn, pivot = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]]), np.array([0, 1.0, 0])
    motion = np.c_[turn, pivot - turn @ pivot]
    deformer.move(0, motion)
    versions.append(shape.with_points(deformer.points))

# %%
camera = aw.Camera(view="front")
pictures = [aw.render(version, camera=camera, size=(290, 320)) for version in versions]
picture = pictures[0].hstack(*pictures[1:])
picture.save("bend_and_keep_detail.png")
