"""`impute`: counts averaged over similar cells."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._caller import public
from adwave._cell_graph import CellGraph, ComparedValues, GraphChoice, cell_walk, choose_cell_graph, walk_within
from adwave._walk import Walk, as_walk
from adwave._walk import walk as make_walk

#: Genes that are processed together.
BLOCK = 256
#: Share of the molecules that is diffused in cross-validation.
SHARE = 0.9
#: Largest number of steps that cross-validation tries.
MOST_STEPS = 256
#: Principal components of cells without a graph.
N_COMPONENTS = 50


@dataclass(frozen=True)
class _Split:
    """Split of the molecules."""

    share: float
    library_size: float | None
    seed: int
    most_steps: int


@dataclass(frozen=True)
class _Counts:
    """Counts in compressed rows."""

    offsets: NDArray[np.int64]
    columns: NDArray[np.uint32]
    values: NDArray[np.float64]
    n_channels: int


@dataclass(frozen=True)
class Imputation:
    """Imputed values, and the time that was taken.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.impute([[2.0], [4.0]], aw.walk([[0.5, 0.5], [0.5, 0.5]]), steps=1).values
    array([[3.],
           [3.]])
    """

    #: Values, cells × genes.
    values: NDArray[np.float64]
    #: Number of steps; where genes have times of their own, the common one.
    steps: float
    #: Error of 0, 1, 2, … steps: the mean share of the variance of held-back genes that other cells do not explain, or by
    #: molecules that are held back the mean squared error. Empty if the time was given.
    errors: NDArray[np.float64]
    #: Columns of the values in the matrix that was given.
    genes: NDArray[np.int64]
    #: The walk.
    walk: Walk = field(repr=False)
    #: Assumptions that were made.
    notes: tuple[str, ...] = ()
    #: Number format of the products, ``'single'`` or ``'double'``.
    precision: str = "double"
    #: Bound of the rounding errors relative to ``Pᵗ|X|``: for counts the relative error of each value.
    error_bound: float = 0.0
    #: Number of steps of each gene of the values; all are `steps` unless the graph was chosen.
    steps_by_gene: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    #: The chosen graph and what it was compared with; None if the graph or the time was given.
    choice: GraphChoice | None = field(default=None, repr=False)


@public(t="steps", X="counts")
def impute(
    counts: Any,
    walk: object = None,
    steps: float | Literal["auto", "molecules"] = "auto",
    *,
    genes: Sequence[int] | Sequence[str] | None = None,
    layer: str | None = None,
    library_size: float | Literal["median"] | str | ArrayLike | None = None,
    square_root: bool = False,
    seed: int = 0,
    precision: Literal["auto", "single", "double"] = "double",
) -> Imputation:
    """Average counts over similar cells, ``Pᵗ X``, on a graph and for numbers of steps t that are chosen.

    Without a graph, graphs of several numbers of principal components and neighbors are compared by genes that they have
    not seen: how well other cells predict them, each gene counting the same. Genes that are mostly noise take more steps
    than others (`Imputation.steps_by_gene`). On a given graph the time is chosen by molecules that are held back. A graph
    that was made from the same counts knows these molecules, so that the time comes out too short.

    Parameters
    ----------
    counts : (cells, genes) array, sparse matrix or AnnData
        Raw counts, finite. They are processed by blocks of genes; a sparse matrix is never made dense as a whole.
    walk : Walk, graph, key of obs or (cells,) labels, optional
        The walk, or anything that `adwave.walk` takes. Of an AnnData the default is that of ``obsp["connectivities"]``, else that of ``obsm["X_pca"]``; of
        other counts it is chosen, or with `steps` that of the 15 nearest neighbors in 50 principal components. A key of ``obs``
        or a label for each cell names batches: the walk is that without them, and neighbors are of the same batch only.
    steps : float, 'auto' or 'molecules'
        Number of steps t. ``"auto"`` chooses the graph and the times of the genes; of a given graph, of fewer than 50 cells or
        of fewer than 20 genes that vary it is ``"molecules"``: a tenth of the molecules is held back, and one time is taken
        for all genes, that which predicts them best. This needs raw counts. Fractional steps need a walk that stays half of
        the time.
    genes : sequence of int or str, optional
        Columns of the result, by number or (of an AnnData) by name; all by default.
    layer : str, optional
        Layer of the AnnData.
    library_size : float, 'median', key of obs or (cells,) array, optional
        Sum to which the counts of each cell are scaled before diffusion. A key or an array has the sums that the cells had,
        such as ``"total_counts"`` of all genes where these are some; they are scaled to the median.
    square_root : bool
        Takes square roots before diffusion; the result stays in square roots.
    seed : int
        Seed of the cells and genes, or of the molecules, by which is chosen.
    precision : {'double', 'single', 'auto'}
        Number format of the products. ``"single"`` is faster and off by (t + 1)·6e-8 of each value; ``"auto"`` takes it if
        errors are at most 1e-10. The time is chosen in double precision, and fractional steps are taken in it.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> ring = aw.walk(np.roll(np.eye(30), 1, 1) + np.roll(np.eye(30), -1, 1), normalize="row", self_loops=1)
    >>> counts = np.random.default_rng(0).poisson(5.0, (30, 4))
    >>> found = aw.impute(counts, ring, steps=3)
    >>> bool(abs(found.values - np.linalg.matrix_power(ring.matrix().toarray(), 3) @ counts).max() < 1e-12)
    True
    """
    notes: list[str] = []
    given = counts
    counts, names = _matrix(given, layer)
    if isinstance(steps, str) and steps not in ("auto", "molecules"):
        raise ValueError(f"steps must be a number, 'auto' or 'molecules', got {steps!r}")
    n, n_genes = counts.shape
    labels = None
    if _names_batches(given, walk):
        labels, walk = _batches(_of_cells(given, walk, "walk", n)), None
    own = _given_walk(given, walk, labels, notes)
    if own is not None and n != own.n_vertices:
        hint = (
            "; it has a column per node, so it seems to be genes × cells: transpose it"
            if n_genes == own.n_vertices
            else ""
        )
        raise ValueError(f"counts must have one row for each of {own.n_vertices} nodes, got shape {counts.shape}{hint}")
    chosen = _columns(genes, names, n_genes)
    size, totals = _library_size(given, counts, library_size)
    cells = None
    if own is None and steps == "auto":
        cells = _chosen_graph(counts, ComparedValues(size, square_root, int(seed)), labels, notes)
        own = None if cells is None else cells.walk
    is_own_graph = own is None
    if own is None:
        notes.append(f"walk to the 15 nearest neighbors in {N_COMPONENTS} principal components of all counts")
        own = cell_walk(principal_components(counts, N_COMPONENTS), 15, labels)
    if cells is not None:
        errors, by_gene, steps = cells.losses, cells.steps[chosen].astype(np.float64), float(cells.choice.best.steps)
    else:
        errors = np.empty(0)
        if isinstance(steps, str):
            split = _Split(SHARE, size, int(seed), MOST_STEPS)
            molecules = _sparse(counts)
            # A graph of all molecules knows those that are held back, and the least error would be found too early.
            judge = _walk_of_train(molecules, split.seed, labels) if is_own_graph else own
            if not is_own_graph:
                notes.append("time by the given graph: too short if the graph was made from these counts")
            steps, errors = _steps_by_molecules(molecules, judge, split, notes)
        by_gene = np.full(len(chosen), float(steps))
    values = np.empty((n, len(chosen)))
    accuracy: tuple[str, float] = ("double", 0.0)
    for place, t in _groups(by_gene):
        block = _dense_columns(counts, chosen[place])
        if size is not None:
            block *= np.divide(size, totals, out=np.ones(n), where=totals > 0)[:, None]
        values[:, place], found = own._data.impute(block, t, square_root, precision)
        accuracy = max(accuracy, found, key=lambda a: a[1])
    return Imputation(
        values,
        float(steps),
        errors,
        chosen,
        own,
        tuple(notes),
        *accuracy,
        by_gene,
        None if cells is None else cells.choice,
    )


def _of_cells(given: Any, values: object, name: str, n: int) -> NDArray[Any]:
    """A value for each cell, of a key of ``obs`` or as given."""
    if isinstance(values, str):
        obs = getattr(given, "obs", {})
        if values not in obs:
            known = f"obs has {sorted(map(str, obs.keys()))}" if len(obs.keys()) else "these counts have no obs"
            raise ValueError(f"{name}: there is no {values!r}, {known}; pass one of its keys or an array of {n} values")
        values = obs[values]
    found = np.asarray(values)
    if found.shape != (n,):
        raise ValueError(f"{name} must have a value for each of {n} cells, got shape {found.shape}")
    return found


def _names_batches(given: Any, walk: object) -> bool:
    """True for a key of ``obs`` and for labels, which a walk, a graph and a shape are not."""
    if isinstance(walk, str):
        return hasattr(given, "obs")
    is_array: bool = isinstance(walk, list | np.ndarray) or hasattr(walk, "iloc")
    return is_array and np.ndim(walk) == 1  # type: ignore[arg-type]


def _batches(given: NDArray[Any]) -> NDArray[np.int64]:
    """Numbers of the batches from 0, in the order of their first cells."""
    missing = np.flatnonzero([value is None or value != value for value in given])  # NaN too
    if missing.size:
        raise ValueError(f"walk must name the batch of each cell, and has none for cell {missing[0]} (from 0)")
    _, first, found = np.unique(given.astype(str), return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[found].astype(np.int64)


def _library_size(given: Any, counts: Any, library_size: object) -> tuple[float | None, NDArray[np.float64]]:
    """The sum to which cells are scaled, and the sums that they have."""
    if library_size is None:
        return None, np.zeros(counts.shape[0])
    is_number = not isinstance(library_size, str) and np.ndim(library_size) == 0  # type: ignore[arg-type]
    if is_number or (isinstance(library_size, str) and library_size == "median"):
        rows = _canonical_rows(counts)
        _check_counts(rows, "library_size")
        totals = np.asarray(rows.sum(axis=1), dtype=np.float64).ravel()
    else:
        totals = _of_cells(given, library_size, "library_size", counts.shape[0]).astype(np.float64)
        bad = np.flatnonzero(~(np.isfinite(totals) & (totals >= 0)))
        if bad.size:
            raise ValueError(
                f"library_size must be finite and at least 0, got {totals[bad[0]]} for cell {bad[0]} (from 0)"
            )
    positive = totals[totals > 0]
    size = float(library_size) if is_number else float(np.median(positive)) if positive.size else 1.0  # type: ignore[arg-type]
    if not size > 0 or not np.isfinite(size):
        raise ValueError(f"library_size must be greater than 0, got {library_size}")
    return size, totals


def _chosen_graph(
    counts: Any, compared: ComparedValues, labels: NDArray[np.int64] | None, notes: list[str]
) -> CellGraph | None:
    """The chosen graph of counts; None of few cells or genes."""
    _check_counts(counts, "the nearest neighbors in principal components")
    found = choose_cell_graph(_sparse(counts), compared, labels)
    if found is not None:
        best, choice = found.choice.best, found.choice
        notes.append(
            f"walk to the {best.neighbors} nearest neighbors in {best.components} principal components ({best.scaling}), the best "
            f"of {len(choice.compared)} graphs by {choice.n_held_back} genes that were held back from {choice.n_cells} cells"
        )
    return found


def _steps_by_molecules(
    molecules: _Counts, judge: Walk, split: _Split, notes: list[str]
) -> tuple[float, NDArray[np.float64]]:
    """The number of steps by molecules that are held back, and the error of 0, 1, 2, … steps."""
    steps, errors, _, is_at_limit = judge._data.cross_validate(molecules, split)
    if is_at_limit:
        notes.append(f"the error still falls at {MOST_STEPS} steps, the most that were tried")
    return float(steps), np.array(errors)


def _matrix(X: Any, layer: str | None) -> tuple[Any, list[str] | None]:
    """Counts, and the names of the genes if there are any."""
    is_annotated = all(hasattr(X, name) for name in ("X", "layers", "obsm", "var_names"))
    if not is_annotated:
        if layer is not None:
            raise ValueError("layer applies to an AnnData, and these counts are a matrix")
        counts: Any = X if hasattr(X, "tocsc") else np.asarray(X)
        names = None
    else:
        if layer is not None and layer not in X.layers:
            raise ValueError(f"the AnnData has no layer {layer!r}; it has {sorted(X.layers)}")
        counts, names = X.X if layer is None else X.layers[layer], [str(name) for name in X.var_names]
    if len(counts.shape) != 2:
        raise ValueError(f"counts must be cells × genes, got shape {counts.shape}")
    if hasattr(counts, "tocsc"):
        counts = counts.tocsc()
    _check_counts(counts, None)
    return counts, names


def _walk_of_train(counts: _Counts, seed: int, labels: NDArray[np.int64] | None) -> Walk:
    """The walk to the nearest neighbors in principal components of the molecules that are not held back."""
    from scipy.sparse import csr_array

    train = _native.split_molecules(counts, SHARE, seed)
    shape = (len(counts.offsets) - 1, counts.n_channels)
    rows = csr_array((train, counts.columns.astype(np.int64), counts.offsets), shape=shape)
    return cell_walk(principal_components(rows, N_COMPONENTS), 15, labels)


def _given_walk(X: Any, walk: object, labels: NDArray[np.int64] | None, notes: list[str]) -> Walk | None:
    """The given walk, or that of an AnnData's neighbors, within batches; None if there is none."""
    if walk is not None:
        return as_walk(walk)
    pairs, coordinates = getattr(X, "obsp", {}), getattr(X, "obsm", {})
    if "connectivities" in pairs:
        notes.append("walk on obsp['connectivities'], with loops of weight 1")
        return walk_within(make_walk(pairs["connectivities"], normalize="row", self_loops=1.0), labels)
    if "X_pca" in coordinates:
        notes.append("walk to the 15 nearest neighbors in obsm['X_pca']")
        return cell_walk(coordinates["X_pca"], 15, labels)
    return None


def principal_components(counts: Any, n_components: int) -> NDArray[np.float64]:
    """Coordinates of cells in the first principal components of the square roots of their normalized counts.

    Cells with equal shares of all genes have equal coordinates, and the layout of the matrix does not change a bit of them.
    """
    from scipy.sparse.linalg import ArpackError, LinearOperator, svds

    rows = _canonical_rows(counts)
    _check_counts(rows, "the nearest neighbors in principal components")
    totals = np.asarray(rows.sum(axis=1), dtype=np.float64).ravel()
    # Quotients are rounded once, so that equal shares are equal numbers.
    rows.data = np.sqrt(1e4 * (rows.data / np.repeat(totals, np.diff(rows.indptr))))
    mean = np.asarray(rows.mean(axis=0)).ravel()
    n_components = min(n_components, min(rows.shape) - 1)
    if n_components < 1:
        raise ValueError(f"principal components need at least two cells and two genes, got shape {rows.shape}")

    def forward(v: NDArray[np.float64]) -> NDArray[np.float64]:
        return rows @ v - mean @ v

    def backward(u: NDArray[np.float64]) -> NDArray[np.float64]:
        return rows.T @ u - np.multiply.outer(mean, u.sum(axis=0)).reshape(len(mean), *u.shape[1:])

    first = _first_equal_rows(rows)
    if np.ptp(first) == 0:  # one kind of cell, without a direction in which cells differ
        return np.zeros((rows.shape[0], n_components))
    factory: Any = LinearOperator
    centered = factory(rows.shape, matvec=forward, rmatvec=backward, matmat=forward, rmatmat=backward, dtype=np.float64)
    start = np.ones(min(rows.shape))
    try:
        left, sizes, _ = svds(centered, k=n_components, v0=start)
    except (ArpackError, np.linalg.LinAlgError) as error:
        raise ValueError(
            f"the {n_components} principal components of the counts were not found ({error}); give a walk, as "
            "adwave.impute(counts, adwave.point_walk(coordinates))"
        ) from error
    # Rounding would tell equal cells apart, and the scale of a kernel would be that of rounding.
    return np.ascontiguousarray((left * sizes)[first, ::-1])  # type: ignore[operator]


def _canonical_rows(counts: Any) -> Any:
    """A copy in compressed rows that is the same for every layout of the matrix: sorted, without duplicates and zeros."""
    from scipy.sparse import csr_array

    rows: Any = csr_array(counts, dtype=np.float64, copy=True)
    rows.sum_duplicates()
    rows.sort_indices()
    rows.eliminate_zeros()
    return rows


def _first_equal_rows(rows: Any) -> NDArray[np.int64]:
    """Number of the first row that is equal to each row."""
    seen: dict[bytes, int] = {}
    first = np.empty(rows.shape[0], dtype=np.int64)
    for x in range(rows.shape[0]):
        part = slice(rows.indptr[x], rows.indptr[x + 1])
        first[x] = seen.setdefault(rows.indices[part].tobytes() + rows.data[part].tobytes(), x)
    return first


def _check_counts(counts: Any, use: str | None) -> None:
    """Refuses values that are not finite, and negative ones for a use that needs counts."""
    values = counts.data if hasattr(counts, "tocsr") else counts
    if values.dtype.kind not in "biuf":
        raise TypeError(f"counts must hold numbers, got an array of type {values.dtype}")
    is_bad = ~np.isfinite(values) if use is None else values < 0
    if not is_bad.any():
        return
    if hasattr(counts, "tocsr"):
        entries = counts.tocoo()
        at = int(np.flatnonzero(~np.isfinite(entries.data) if use is None else entries.data < 0)[0])
        cell, gene, value = int(entries.row[at]), int(entries.col[at]), entries.data[at]
    else:
        cell, gene = (int(i[0]) for i in np.nonzero(is_bad))
        value = counts[cell, gene]
    if use is None:
        raise ValueError(
            f"counts must be finite, got {value} in cell {cell}, gene {gene} (from 0); replace it, or leave the cell or gene out"
        )
    raise ValueError(
        f"counts must be numbers of at least 0 for {use}, got {value} in cell {cell}, gene {gene} (from 0); give raw counts"
        + ("" if use.startswith("library") else ", or a walk and steps")
    )


def _columns(genes: Any, names: list[str] | None, n_genes: int) -> NDArray[np.int64]:
    """Columns by number or by name."""
    if genes is None:
        return np.arange(n_genes)
    chosen = []
    for gene in genes:
        if isinstance(gene, str):
            if names is None or gene not in names:
                known = "the matrix has no names" if names is None else "the AnnData has no such name"
                raise ValueError(f"genes: {gene!r} is unknown, {known}")
            chosen.append(names.index(gene))
        elif 0 <= int(gene) < n_genes:
            chosen.append(int(gene))
        else:
            raise ValueError(f"genes must be in 0..={n_genes - 1}, got {gene}")
    return np.array(chosen, dtype=np.int64)


def _groups(steps: NDArray[np.float64]) -> Iterator[tuple[NDArray[np.int64] | slice, float]]:
    """Places of genes that are processed together, and their number of steps."""
    for t in np.unique(steps):
        places = np.flatnonzero(steps == t)
        for start in range(0, len(places), BLOCK):
            part = places[start : start + BLOCK]
            # A range of columns is copied as a whole.
            is_range = part[-1] - part[0] + 1 == len(part)
            yield slice(int(part[0]), int(part[-1]) + 1) if is_range else part, float(t)


def _dense_columns(counts: Any, columns: NDArray[np.int64]) -> NDArray[np.float64]:
    """Some columns as a dense array of their own."""
    block = counts[:, columns]
    if hasattr(block, "toarray"):
        block = block.toarray()
    return np.array(block, dtype=np.float64, order="C")


def _sparse(counts: Any) -> _Counts:
    """Counts in compressed rows."""
    from scipy.sparse import csr_array

    rows: Any = csr_array(counts, dtype=np.float64)
    rows.sum_duplicates()
    return _Counts(rows.indptr.astype(np.int64), rows.indices.astype(np.uint32), rows.data, rows.shape[1])
