# %% [markdown]
# # What stands out
# In: a mesh. Out: a map over all scales, red on what stands out and blue in hollows.
#
#     found = aw.saliency(shape)

# %%
import adwave as aw

shape = aw.sample("creature", vertices=30_000)
found = aw.saliency(shape)

# %%
scale = aw.ColorScale(bar=False)
cameras = [aw.Camera(view=(angle, 8), zoom=1.5, focus=(0, 1.35, 0)) for angle in (-25, 25, 155)]
pictures = [aw.render(shape, found, scale=scale, camera=camera, size=(290, 320)) for camera in cameras]
picture = pictures[0].hstack(*pictures[1:])
picture.save("where_it_stands_out.png")
