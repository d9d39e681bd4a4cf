# %% [markdown]
# # Learn the gains
# In: a noisy mesh and the true one. Out: a gain for each band by gradient descent, which denoises another scan too.
#
#     loss = (aw.torch.filter(walk, points, gains) - truth).square().mean()

# %%
# %pip install -q "adwave[torch]"
import adwave as aw
import numpy as np
import torch

truth = torch.from_numpy(np.array(aw.sample("creature", vertices=12_000).points))
scans = [aw.sample("creature", vertices=12_000, noise=0.5, seed=seed) for seed in (1, 2)]
walk, points = aw.Decomposer(scans[0]), torch.from_numpy(np.array(scans[0].points))
gains = torch.ones(5, dtype=torch.float64, requires_grad=True)
descent = torch.optim.Adam([gains], lr=0.1)
for _ in range(40):
    descent.zero_grad()
    loss = (aw.torch.filter(walk, points, gains) - truth).square().mean()
    loss.backward()
    descent.step()
print("gains, fine to coarse:", gains.detach().numpy().round(2))

# %%
clean = aw.filter(scans[1], gains.tolist())
camera = aw.Camera(view=(25, 8), zoom=1.7, focus=(0, 1.25, 0))
pictures = [aw.render(shape, camera=camera, size=(400, 320)) for shape in (scans[1], clean)]
picture = pictures[0].hstack(pictures[1])
picture.save("learn_the_gains.png")
