# %% [markdown]
# # Match two scans
# In: two scans of one thing in different poses, each with its own vertices and noise. Out: the motion between them.
#
#     found = aw.match(first, second)

# %%
import adwave as aw
import numpy as np

first = aw.sample("creature", vertices=12_000, noise=0.1)
second = aw.sample("creature", vertices=15_000, noise=0.1, seed=2)
second = second.with_points(second.points[:, [1, 2, 0]] + [0.3, -0.9, 0.2])
found = aw.match(first, second)
assert found.motion is not None  # it is None if no motion fits better than chance
print(f"{len(found.pairs)} pairs of features; median distance of the surfaces {found.median:.4f}")

# %%
moved = first.with_points(first.points @ found.motion[:3, :3].T + found.motion[:3, 3])
paint = np.repeat(np.array([[236, 150, 60], [70, 130, 200]], np.uint8), [first.n_vertices, second.n_vertices], axis=0)
pictures = []
for shape in (first, moved):
    faces = np.concatenate([shape.faces, second.faces + np.uint32(shape.n_vertices)])
    both = aw.Shape(np.concatenate([shape.points, second.points]), faces)
    pictures.append(aw.render(both, colors=paint, camera=aw.Camera(view=(60, 20)), size=(400, 320)))
picture = pictures[0].hstack(pictures[1])
picture.save("match_two_scans.png")
