# %% [markdown]
# # Remove noise from a part
# In: a scan of a machined part. Out: flat faces and sharp edges; the amount of noise is estimated.
#
#     clean, info = aw.denoise(scan)

# %%
import adwave as aw

scan = aw.sample("bracket", vertices=20_000, noise=0.4)
clean, info = aw.denoise(scan)
print(f"noise of {info['noise_in_edges']:.2f} edges found")

# %%
camera = aw.Camera(view=(40, 30))
pictures = [aw.render(shape, camera=camera, size=(400, 300)) for shape in (scan, clean)]
picture = pictures[0].hstack(pictures[1])
picture.save("denoise_a_part.png")
