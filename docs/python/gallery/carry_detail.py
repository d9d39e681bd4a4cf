# %% [markdown]
# # Carry detail onto another mesh
# In: a detailed scan, and a smooth mesh of the same thing with other triangles. Out: that mesh, with the detail.
#
#     detailed = aw.transfer(scan, onto=base)

# %%
import adwave as aw

scan = aw.sample("creature", vertices=40_000)
base = aw.smooth(aw.sample("creature", vertices=25_000), fwhm="5%")
detailed = aw.transfer(scan, onto=base)
print(f"detail of {scan.n_vertices} vertices on {base.n_vertices} others")

# %%
camera = aw.Camera(view=(25, 8), zoom=1.5, focus=(0, 1.35, 0))
pictures = [aw.render(mesh, camera=camera, size=(290, 320)) for mesh in (scan, base, detailed)]
picture = pictures[0].hstack(*pictures[1:])
picture.save("carry_detail.png")
