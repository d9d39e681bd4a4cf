# %% [markdown]
# # Thickness of the cortex
# In: fsaverage and its thickness, which nilearn ships. Out: the thickness along the surface, wider than 15 mm.
#
#     smooth = aw.smooth(pial, thickness, fwhm=15, mask=cortex)

# %%
# %pip install -q "adwave[neuro]"
import adwave as aw
import numpy as np
from nilearn import datasets, surface

brain = datasets.fetch_surf_fsaverage("fsaverage5")
pial, inflated = surface.load_surf_mesh(brain.pial_left), surface.load_surf_mesh(brain.infl_left)
thickness = np.asarray(surface.load_surf_data(brain.thick_left), dtype=float)
cortex = thickness > 0  # not on the cut through the middle
smooth = aw.smooth(pial, thickness, fwhm=15, mask=cortex)

# %%
camera, scale = aw.Camera(view=(-90, 5), up="z"), aw.ColorScale(range=(1.5, 3.8), bar=False)
views = ((pial, thickness), (pial, smooth), (inflated, smooth))
pictures = [aw.render(mesh, values, scale=scale, camera=camera, size=(290, 230)) for mesh, values in views]
picture = pictures[0].hstack(*pictures[1:])
picture.save("thickness_of_the_cortex.png")
