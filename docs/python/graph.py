# %% [markdown]
# # A signal on a graph
#
# A road network, a signal on its crossings, the bands of the signal, and the signal without noise; and the same
# bands by plain SciPy.

# %%
import sys
from pathlib import Path

import adwave as aw
import numpy as np

try:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import minimum_spanning_tree
    from scipy.spatial import Delaunay
except ImportError:
    print("skipped: SciPy is not installed")
    sys.exit(0)

PICTURES = Path(__file__).parent / "pictures"
rng = np.random.default_rng(5)

# %% [markdown]
# Roads: the shortest spanning tree of the Delaunay triangulation of 2600 random places, and some of its other
# edges: nearly all crossings have one to four roads.

# %%
n = 2600
places = rng.uniform(0, 100, (n, 2))
corners = Delaunay(places).simplices
edges = np.unique(np.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0)
lengths = np.linalg.norm(places[edges[:, 0]] - places[edges[:, 1]], axis=1)
edges, lengths = edges[lengths < 6], lengths[lengths < 6]
tree = minimum_spanning_tree(coo_array((lengths, edges.T), (n, n))).tocoo()
in_tree = np.isin(edges @ [n, 1], np.sort([tree.row, tree.col], axis=0).T @ [n, 1])
edges = edges[in_tree | (rng.random(len(edges)) < 0.15)]
roads = aw.graph(n, edges)
print(roads, f"{len(edges)} roads, {len(edges) * 2 / n:.1f} at a crossing")
assert aw.info(roads).components == 1

# %% [markdown]
# A signal: two districts, a slow change, and noise.

# %%
x, y = places.T
clean = np.where(x + 15 * np.sin(y / 15) > 50, 1.0, -1.0) + y / 100
noisy = clean + 0.5 * rng.standard_normal(n)

# %% [markdown]
# The bands: level j is smoothed by 2^(j-1) steps of a lazy random walk P, and its band is the difference from the
# level before. `matrix()` gives P to SciPy, whose powers give the same bands.

# %%
walk = aw.Decomposer(roads)
bands = walk.decompose(noisy, levels=6)
P, smooth, steps = walk.matrix(), noisy, 0
assert np.allclose(P.sum(axis=1), 1) and P.min() >= 0
for level in range(1, 7):
    before = smooth
    while steps < bands.steps[level - 1]:
        smooth, steps = P @ smooth, steps + 1
    difference = np.abs(bands.wavelet(level) - (before - smooth)).max()
    width = bands.rms_widths[level - 1]
    print(f"level {level}: {steps:2} steps, width {width:.2f} hops, difference from SciPy {difference:.0e}")
    assert difference < 1e-9 * np.abs(bands.wavelet(level)).max()

# %% [markdown]
# Dropping the fine bands removes noise, but also blurs the border between the districts. `denoise` mixes levels,
# and steps less across places where the signal jumps.


# %%
def rms(signal):
    return np.sqrt(np.mean((signal - clean) ** 2))


levels = [rms(bands.scaling(level)) for level in range(7)]
denoised, info = aw.denoise(walk, noisy)
print("rms error without the first 0, 1 … 6 bands:", *(f"{error:.3f}" for error in levels))
print(f"denoise: {rms(denoised):.3f}; noise of {info['noise']:.2f} found")
assert abs(info["noise"] - 0.5) < 0.05 and rms(denoised) < 0.9 * min(levels)

# %% [markdown]
# The picture: a graph has no positions, so the roads are drawn as a mesh, one rectangle each.

# %%
a, b = places[edges].transpose(1, 0, 2)
side = 0.4 * ((b - a) / np.linalg.norm(b - a, axis=1, keepdims=True))[:, ::-1] * [-1, 1]
corner = np.arange(len(edges)) + len(edges) * np.arange(4)[:, None]
drawn = aw.Shape(np.concatenate([a - side, a + side, b + side, b - side]), corner.T)
for name, signal in (("noisy", noisy), ("denoised", denoised)):
    at = signal[np.concatenate([edges[:, 0], edges[:, 0], edges[:, 1], edges[:, 1]])]
    above = aw.Camera(view="top", up="z", orthographic=True)
    scale = aw.ColorScale(color_map="viridis", range=(-1.5, 2.5), label=name)
    picture = aw.render(drawn, values=at, scale=scale, camera=above, size=(400, 330))
    picture.save(PICTURES / f"graph_{name}.png")
