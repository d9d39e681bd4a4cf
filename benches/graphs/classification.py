"""Node classification by scattering features and logistic regression.

    python benches/graphs/classification.py FOLDER

FOLDER has the data sets that are to be classified, each as far as it is there: `geom-gcn/texas`, `geom-gcn/film`,
`geom-gcn/cora`, `geom-gcn/citeseer`, `geom-gcn/pubmed` (files out1_graph_edges.txt and out1_node_feature_label.txt).
Ten random splits of 48 % training, 32 % validation and 20 % test, as in that collection; the regularization is chosen on the
validation part.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from sklearn.linear_model import LogisticRegression
from sklearn.preprocessing import StandardScaler

import adwave as aw

NAMES = ("texas", "film", "cora", "citeseer", "pubmed")


def read(folder: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edges, features and labels."""
    edges = np.loadtxt(folder / "out1_graph_edges.txt", skiprows=1, dtype=np.int64)
    lines = (folder / "out1_node_feature_label.txt").read_text().splitlines()[1:]
    fields = sorted((int(line.split("\t")[0]), *line.split("\t")[1:]) for line in lines)
    rows = [np.array(field[1].split(","), dtype=np.int64) for field in fields]
    labels = np.array([int(field[2]) for field in fields])
    if folder.name == "film":  # indices of words, not flags
        features = np.zeros((len(rows), 1 + max(row.max() for row in rows)))
        for x, words in enumerate(rows):
            features[x, words] = 1.0
    else:
        features = np.stack(rows).astype(float)
    return edges, features, labels


def accuracy(features: np.ndarray, labels: np.ndarray, n_splits: int) -> tuple[float, float]:
    """Mean and standard deviation of the accuracy on the test part."""
    found = []
    for seed in range(n_splits):
        order = np.random.default_rng(seed).permutation(len(labels))
        first, second = int(0.48 * len(labels)), int(0.8 * len(labels))
        train, check, test = np.split(order, [first, second])
        scaled = StandardScaler().fit(features[train])
        best = (-1.0, 0.0)
        for strength in (1e-4, 1e-3, 1e-2, 1e-1):
            model = LogisticRegression(C=strength, max_iter=300).fit(scaled.transform(features[train]), labels[train])
            score = model.score(scaled.transform(features[check]), labels[check])
            best = max(best, (score, model.score(scaled.transform(features[test]), labels[test])))
        found.append(best[1])
    return float(np.mean(found)), float(np.std(found))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--splits", type=int, default=10)
    arguments = parser.parse_args()
    print("| data set | nodes | features alone | with first order | with first and second order |")
    print("|---|---|---|---|---|")
    for name in NAMES:
        folder = arguments.folder / name
        if not folder.is_dir():
            print(f"<!-- skipped: {folder} is not there -->")
            continue
        edges, features, labels = read(folder)
        both = np.concatenate([edges, edges[:, ::-1]]).T
        both = np.unique(both[:, both[0] != both[1]], axis=1)
        walk = aw.from_edge_index(both, nodes=len(labels))
        # The words with the largest sums, so that features fit in memory.
        words = np.sort(np.argsort(-features.sum(axis=0), kind="stable")[:300])
        kept = features[:, words]
        cells = []
        for orders in ((0,), (0, 1), (0, 1, 2)):
            found = aw.scattering(walk, kept, steps=(1, 2, 4), orders=orders).features()
            mean, spread = accuracy(found, labels, arguments.splits)
            cells.append(f"{100 * mean:.1f} ± {100 * spread:.1f}")
        print(f"| {name} | {len(labels)} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
