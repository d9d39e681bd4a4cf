# %% [markdown]
# # Edit one place
#
# More detail on the head of the built-in creature; the rest is unchanged, to the last bit.

# %%
import time
from pathlib import Path

import adwave as aw
import numpy as np

PICTURES = Path(__file__).parent / "pictures"
creature = aw.sample("creature")
print(creature)

# %% [markdown]
# The bands are computed once. A region is a text: here a ball about a point, by distance along the surface, with
# a radius in percent of the bounding box's diagonal. Its weights rise smoothly from 0 to 1, so that an edit has no
# seam.

# %%
bands = aw.decompose(creature, levels=8)
head = "ball:point=0 1.5 0.32,radius=14%"
weights = aw.region(bands.decomposer, head)
inside, wholly = (weights > 0).sum(), (weights == 1).sum()
print(f"{inside} of {creature.n_vertices} vertices are in the region, {wholly} of them wholly")

# %% [markdown]
# Gains, from fine to coarse: the finest three bands become 2.5 times as strong, the next two less. The first edit
# prepares, and each further one takes milliseconds: fast enough for a slider.

# %%
gains = [2.5, 2.5, 2.5, 2, 1.5, 1, 1, 1]
crisp = bands.apply(gains, where=head)
start = time.perf_counter()
for _ in range(10):
    crisp = bands.apply(gains, where=head)
print(f"{100 * (time.perf_counter() - start):.1f} ms for an edit of {creature.n_vertices} vertices")
outside = weights == 0
assert np.array_equal(crisp[outside], creature.points[outside])
assert not np.array_equal(crisp[~outside], creature.points[~outside])

# %% [markdown]
# The same region as an array: any weights, one for each vertex.

# %%
masked = bands.apply(gains, where=weights)
assert np.abs(masked - crisp).max() < 1e-12
hard = bands.apply(gains, where=creature.points[:, 1] > 1.3)  # a mask of bool: with a seam
print(f"a hard mask at the neck moves {(hard != creature.points).any(axis=1).sum()} vertices")

# %% [markdown]
# Several edits at once: the head crisp, the rest smooth.

# %%
both = bands.apply([aw.Layer(gains, head), aw.Layer("smooth", f"!{head}")])
assert np.abs(both - crisp)[weights == 1].max() < 1e-12

# %%
close = aw.Camera(view=(25, 8), focus=(0, 1.45, 0.2), zoom=1.9)
for name, points in (("before", creature.points), ("after", crisp), ("both", both)):
    picture = aw.render(bands.to_shape(points), camera=close, size=(440, 440))
    picture.save(PICTURES / f"local_edit_{name}.png")
scale = aw.ColorScale(label="weight")
picture = aw.render(creature, values=weights, scale=scale, camera=close, size=(440, 440))
picture.save(PICTURES / "local_edit_region.png")
