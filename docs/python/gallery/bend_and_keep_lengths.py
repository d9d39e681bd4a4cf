# %% [markdown]
# # Bend a shape, keep its lengths
# In: a mesh, a part that stays, a handle and its motion. Out: a bent body, with its detail kept, and with its lengths kept.
#
#     deformer = shape.deformer(stays, [moves], keep_lengths=keep)

# %%
import adwave as aw
import numpy as np

shape = aw.sample("creature", vertices=15_000)
stays, moves = "half-space:point=0 0.4 0,normal=0 -1 0", "half-space:point=0 1.5 0,normal=0 1 0"
cos, sin, pivot = np.cos(np.radians(70)), np.sin(np.radians(70)), np.array([0, 1.0, 0])
turn = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
faces = np.asarray(shape.faces)
ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def lengths(points):
    return np.linalg.norm(np.diff(points[ends], axis=1)[:, 0], axis=1)


bent, stretch = [], []
for keep in (0, 1):
    deformer = shape.deformer(stays, [moves], keep_lengths=keep)
    deformer.move(0, np.c_[turn, pivot - turn @ pivot])
    bent.append(shape.with_points(deformer.points))
    stretch.append(np.abs(lengths(deformer.points) / lengths(shape.points) - 1).mean())
print(f"mean change of an edge: {stretch[0]:.1%} and {stretch[1]:.1%}")

# %%
pictures = [aw.render(each, camera=aw.Camera(view="front"), size=(290, 320)) for each in (shape, *bent)]
picture = pictures[0].hstack(*pictures[1:])
picture.save("bend_and_keep_lengths.png")
