# %% [markdown]
# # Thickness on another mesh
# In: fsaverage5 with its sphere and thickness, which nilearn ships, and another sphere. Out: both on the other mesh.
#
#     values = there.apply(thickness, zeros="wall")

# %%
# %pip install -q "adwave[neuro]"
import adwave as aw
import numpy as np
from nilearn import datasets, surface

brain = datasets.fetch_surf_fsaverage("fsaverage5")
inflated, sphere = surface.load_surf_mesh(brain.infl_left), surface.load_surf_mesh(brain.sphere_left)
thickness = np.asarray(surface.load_surf_data(brain.thick_left), dtype=float)
other = aw.sample("sphere", vertices=1500)
there = aw.Resampler(sphere, other)
values = there.apply(thickness, zeros="wall")  # the cut through the middle, all zeros, stays apart
carried = other.with_points(there.apply(np.asarray(inflated.coordinates, dtype=float)))
classes = there.apply(np.digitize(thickness, [0.01, 2.2, 2.8]).astype(float), keep="labels")
parcels = aw.Parcels(classes.astype(int))  # thin, middling and thick places; 0 is the cut
means = parcels.fill(parcels.means(values))

# %%
camera, scale = aw.Camera(view=(-90, 5), up="z"), aw.ColorScale(range=(1.5, 3.8), bar=False)
views = ((inflated, thickness), (carried, values), (carried, means))
pictures = [aw.render(mesh, each, scale=scale, camera=camera, size=(290, 230)) for mesh, each in views]
picture = pictures[0].hstack(*pictures[1:])
picture.save("thickness_on_fewer_vertices.png")
