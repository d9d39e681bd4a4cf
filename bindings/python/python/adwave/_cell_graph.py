"""Choice of the graph of cells, and of the times of their genes, by genes that are held back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from adwave import _native
from adwave._walk import Walk, point_walk
from adwave._walk import walk as make_walk


@dataclass(frozen=True)
class ComparedGraph:
    """A graph of cells that was compared, at its best time.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> place = np.linspace(0, 6, 120)[:, None] + np.linspace(0, 6, 40)
    >>> counts = np.random.default_rng(0).poisson(3 + 2 * np.sin(place))
    >>> graph = aw.impute(counts).choice.best
    >>> graph.components, 10 <= graph.neighbors <= 100
    (6, True)
    """

    #: ``'shares'``: components of the square roots of shares; ``'equal-genes'``: of logarithms, each gene divided by
    #: its standard deviation.
    scaling: str
    #: Number of principal components.
    components: int
    #: Number of nearest neighbors.
    neighbors: int
    #: Number of steps of the least loss.
    steps: int
    #: Mean share of the variance of held-back genes that other cells do not explain.
    loss: float


@dataclass(frozen=True)
class GraphChoice:
    """The graph that `adwave.impute` chose, and what it was compared with.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> place = np.linspace(0, 6, 120)[:, None] + np.linspace(0, 6, 40)
    >>> choice = aw.impute(np.random.default_rng(0).poisson(3 + 2 * np.sin(place))).choice
    >>> len(choice.compared), choice.n_cells, choice.n_held_back
    (14, 120, 8)
    """

    #: The chosen graph and its common time.
    best: ComparedGraph
    #: All graphs that were compared.
    compared: tuple[ComparedGraph, ...]
    #: Number of cells on which they were compared.
    n_cells: int
    #: Number of genes that were held back.
    n_held_back: int


@dataclass(frozen=True)
class ComparedValues:
    """Transformation of the counts before diffusion, and the seed of the choice."""

    library_size: float | None
    square_root: bool
    seed: int


@dataclass(frozen=True)
class CellGraph:
    """The chosen graph of all cells, with the times of all genes and the loss of 0, 1, 2, … steps."""

    walk: Walk
    choice: GraphChoice
    steps: NDArray[np.int64]
    losses: NDArray[np.float64]


def cell_walk(coordinates: NDArray[np.float64], neighbors: int, labels: NDArray[np.int64] | None) -> Walk:
    """The walk to the nearest neighbors of cells, of the same batch if these are given by number."""
    if labels is None:
        return point_walk(coordinates, neighbors=neighbors)
    from scipy.sparse import block_diag, csr_array

    order = np.argsort(labels, kind="stable")
    parts = np.split(coordinates[order], np.cumsum(np.bincount(labels))[:-1])
    blocks = [
        point_walk(part, neighbors=min(neighbors, len(part) - 1)).matrix() if len(part) > 1 else csr_array([[1.0]])
        for part in parts
    ]
    place = np.argsort(order)
    return make_walk(csr_array(block_diag(blocks, format="csr"))[place][:, place])


def walk_within(walk: Walk, labels: NDArray[np.int64] | None) -> Walk:
    """A walk whose steps between batches are left out; a cell without neighbors in its batch stays."""
    if labels is None or len(labels) != walk.n_vertices:
        return walk
    if walk.normalization != "row":
        raise ValueError(f"batch needs a walk whose rows sum to 1, got {walk.normalization} normalization")
    steps = walk.matrix().tocoo()
    is_within = labels[steps.row] == labels[steps.col]
    from scipy.sparse import coo_array

    kept = (steps.row[is_within], steps.col[is_within])
    return make_walk(coo_array((steps.data[is_within], kept), shape=steps.shape), normalize="row")


def choose_cell_graph(counts: Any, compared: ComparedValues, labels: NDArray[np.int64] | None) -> CellGraph | None:
    """The graph and times for counts in compressed rows, with neighbors within batches; None of few cells or genes."""
    found = _native.choose_cell_graph(counts, compared)
    if found is None:
        return None
    best, steps, losses, graphs, n_cells, n_held_back = found
    choice = GraphChoice(
        ComparedGraph(*best), tuple(ComparedGraph(*graph) for graph in graphs), int(n_cells), int(n_held_back)
    )
    coordinates = _native.count_components(counts, choice.best.scaling, choice.best.components)
    walk = cell_walk(coordinates, choice.best.neighbors, labels)
    return CellGraph(walk, choice, np.array(steps, dtype=np.int64), np.array([np.inf, *losses]))
