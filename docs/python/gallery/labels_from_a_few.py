# %% [markdown]
# # Labels from a few
# In: 1797 images of digits, 30 of them labeled. Out: the labels of the others, by a linear classifier on bands.
#
#     bands = aw.point_walk(images, stay=0.5).bands(images, [1, 4, 16])

# %%
# %pip install -q "adwave[all]"
import adwave as aw
import numpy as np
from sklearn.datasets import load_digits
from sklearn.linear_model import RidgeClassifier

images, digit = load_digits(return_X_y=True)
bands = aw.point_walk(images, stay=0.5).bands(images, [1, 4, 16])
rng = np.random.default_rng(0)
known = np.concatenate([rng.choice(np.flatnonzero(digit == k), 3, replace=False) for k in range(10)])
found = {}
for name, columns in {"pixels": images, "bands": np.concatenate([*bands[:-1], 4 * bands[-1]], axis=1)}.items():
    found[name] = RidgeClassifier(alpha=100).fit(columns[known], digit[known]).predict(columns)
    print(f"{name}: {np.mean(np.delete(found[name] == digit, known)):.0%} of the others are right")

# %%
u, s, _ = np.linalg.svd(bands[-1] - bands[-1].mean(axis=0), full_matrices=False)
paint = np.array([[225, 225, 220], [200, 40, 40]], np.uint8)  # wrong ones are red
pictures = [aw.render(u[:, :3] * s[:3], colors=paint[1 * (got != digit)], size=(400, 340)) for got in found.values()]
picture = pictures[0].hstack(pictures[1])
picture.save("labels_from_a_few.png")
