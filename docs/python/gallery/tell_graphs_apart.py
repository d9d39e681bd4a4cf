# %% [markdown]
# # Tell graphs apart
# In: 150 graphs of three kinds. Out: a few features of each by scattering, in which the kinds fall apart.
#
#     aw.scattering(graph, signal, pool="moments").features()

# %%
# %pip install -q "adwave[all]"
import adwave as aw
import networkx as nx
import numpy as np

kinds = (
    lambda seed: nx.watts_strogatz_graph(60, 6, 0.3, seed),
    lambda seed: nx.barabasi_albert_graph(60, 3, seed),
    lambda seed: nx.random_geometric_graph(60, 0.19, seed=seed),
)
kind, rows = np.repeat([0, 1, 2], 50), []
for seed, k in enumerate(kind):
    graph = kinds[k](seed)
    signal = np.log(1 + np.array([degree for _, degree in graph.degree]))
    rows.append(aw.scattering(graph, signal, pool="moments").features()[0])
features = (np.array(rows) - np.mean(rows, axis=0)) / np.std(rows, axis=0)
u, s, _ = np.linalg.svd(features, full_matrices=False)

# %%
paint = [(214, 93, 63), (60, 160, 110), (70, 100, 200)]
marks = [(at, 0.55, paint[k]) for at, k in zip(u[:, :3] * s[:3], kind, strict=True)]
picture = aw.render(u[:, :3] * s[:3], colors=np.array(paint, np.uint8)[kind], balls=marks, size=(600, 360))
picture.save("tell_graphs_apart.png")
