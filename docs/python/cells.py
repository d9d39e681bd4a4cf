# %% [markdown]
# # Cells, without a surface
#
# Counts of molecules in cells that lie on a tree of three branches: a walk to the nearest neighbors in principal
# components, counts averaged over similar cells, and the branches found by bands and by scattering features.

# %%
import sys
from pathlib import Path

import adwave as aw
import numpy as np

try:
    from scipy.cluster.vq import kmeans2
except ImportError:
    print("skipped: SciPy is not installed")
    sys.exit(0)

PICTURES = Path(__file__).parent / "pictures"
rng = np.random.default_rng(2)

# %% [markdown]
# The truth: 1500 cells at a place `t` along one of three branches, and 400 genes that rise and fall along the
# branches. Each molecule is seen by chance: 150 molecules a cell, so that most counts are 0.

# %%
n, n_genes = 1500, 400
branch, t = rng.integers(0, 3, n), rng.uniform(0, 1, n)
program = rng.normal(0, 1, (3, 6, n_genes))
basis = np.stack([np.sin((k + 1) * np.pi * t / 2) for k in range(6)], axis=1)
log_rate = np.einsum("nk,nkg->ng", basis, program[branch]) + rng.normal(0, 1, n_genes)
rate = np.exp(log_rate)
rate *= 150 / rate.sum(axis=1, keepdims=True)
counts = rng.poisson(rate)
print(f"{n} cells, {n_genes} genes, {(counts == 0).mean():.0%} of the counts are 0")

# %% [markdown]
# Without a graph, `impute` chooses one, and a number of steps for each gene: some genes are held back, and graphs of
# several numbers of components and neighbors predict them. Here the rates are known, so that the choice can be judged.


# %%
def error(values):
    return np.sqrt(np.mean((values - rate) ** 2))


found = aw.impute(counts)
print(
    f"{found.choice.best.neighbors} neighbors in {found.choice.best.components} components chosen, "
    f"{found.steps_by_gene.mean():.1f} steps on average; error {error(counts):.3f} before, {error(found.values):.3f} after"
)
errors = {
    steps: error(aw.impute(counts, found.walk, steps=steps).values) for steps in range(1, 9)
}
print("error after 1 to 8 steps:", *(f"{value:.3f}" for value in errors.values()))
assert error(found.values) < 1.05 * min(errors.values()) < 0.6 * error(counts)

# %% [markdown]
# Any other signal can be split along this walk too. Its bands along the walk are differences of powers; they sum to the signal.

# %%
walk = found.walk
size = np.log(counts.sum(axis=1))
bands = walk.bands(size, [1, 2, 4, 8, 16])
assert np.allclose(np.sum(bands, axis=0), size)
shares = [float(np.var(band) / np.var(size)) for band in bands]
print(
    "share of the variance of the depth:",
    *(f"{share:.2f}" for share in shares),
    "- it is noise: in the first bands",
)
assert shares[0] > 0.5

# %% [markdown]
# Branches: k-means on the counts of a cell, and on what remains of them after 4 steps, which is the coarsest band.


# %%
def purity(values):
    values = np.sqrt(np.maximum(values, 0))
    centered = values - values.mean(axis=0)
    left, scale, _ = np.linalg.svd(centered, full_matrices=False)
    labels = kmeans2(left[:, :10] * scale[:10], 12, seed=1, minit="++")[1]
    return (
        sum(
            np.bincount(branch[labels == label], minlength=3).max()
            for label in range(12)
        )
        / n
    )


single, smooth = purity(counts), purity(walk.smooth(counts.astype(float), 4))
print(
    f"cells in a group of their branch: {single:.1%} by counts, {smooth:.1%} by the coarsest band"
)
assert smooth > single

# %% [markdown]
# The embedding: two principal components of the counts, and of the imputed counts, colored by the place on the branch.

# %%
for name, values in (("counts", counts), ("imputed", found.values)):
    values = np.sqrt(np.maximum(values, 0))
    left, scale, _ = np.linalg.svd(values - values.mean(axis=0), full_matrices=False)
    places = np.column_stack([left[:, :2] * scale[:2], np.zeros(n)])
    scale = aw.ColorScale(
        color_map="viridis", range=(0, 1), label="place on the branch"
    )
    above = aw.Camera(view="top", up="z", orthographic=True)
    picture = aw.render(
        aw.Shape(places), values=t, scale=scale, camera=above, size=(400, 330)
    )
    picture.save(PICTURES / f"cells_{name}.png")
