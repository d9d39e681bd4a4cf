# %% [markdown]
# # Simplify within a bound
# In: a mesh and a largest distance. Out: few vertices, and a proof that no point moved farther than the bound.
#
#     small = aw.simplify(shape, error="0.5%")

# %%
import adwave as aw
import numpy as np

shape = aw.sample("creature", vertices=40_000)
small = aw.simplify(shape, error="0.5%")
print(f"{shape.n_vertices} vertices, then {small.shape.n_vertices}; no point farther than {small.greatest:.4f}")


# %%
def with_flat_faces(mesh):
    return aw.Shape(mesh.points[mesh.faces].reshape(-1, 3), np.arange(3 * mesh.n_faces).reshape(-1, 3))


camera = aw.Camera(view=(25, 8), zoom=1.7, focus=(0, 1.25, 0))
pictures = [aw.render(with_flat_faces(mesh), camera=camera, size=(400, 320)) for mesh in (shape, small.shape)]
picture = pictures[0].hstack(pictures[1])
picture.save("simplify_within_a_bound.png")
