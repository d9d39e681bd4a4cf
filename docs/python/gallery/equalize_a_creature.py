# %% [markdown]
# # An equalizer for shapes
# In: a mesh and a gain for each band. Out: the mesh, smoother or with deeper detail, of the same vertices.
#
#     crisp = bands.apply([1, 2, 3, 3, 2, 1])

# %%
import adwave as aw

shape = aw.sample("creature", vertices=30_000)
bands = aw.decompose(shape, levels=6)
smooth = bands.apply([0, 0, 0, 0, 0.5, 1])
crisp = bands.apply([1, 2, 3, 3, 2, 1])

# %%
camera = aw.Camera(view=(25, 8), zoom=1.5, focus=(0, 1.35, 0))
versions = [shape.with_points(points) for points in (smooth, shape.points, crisp)]
pictures = [aw.render(version, camera=camera, size=(290, 320)) for version in versions]
picture = pictures[0].hstack(*pictures[1:])
picture.save("equalize_a_creature.png")
