"""`Walk`: a random walk on a graph or on points of any dimension, its powers and its scattering."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._adapt_objects import library_of
from adwave._adapt_objects import read as read_object
from adwave._argument_order import refuse_edge_index
from adwave._caller import Call, public, written_call
from adwave._layout import float_type, signal_values
from adwave._methods import Carrier
from adwave._progress import ProgressLike, report_progress

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from adwave._decomposer import Decomposer

#: Ways to divide the weights of a graph.
Normalization = Literal["row", "column", "symmetric"]
#: Weights of neighbors by their distances.
Kernel = Literal["adaptive", "paper", "self-tuning", "density-invariant"]
#: Statistics over the nodes of a graph.
Pool = Literal["mean", "max", "norms", "moments"]

#: Scales of scattering: numbers of steps between which the bands lie.
SCALES = (1, 2, 4, 8, 16)
#: Neighbor whose distance is the scale of a point.
SCALE_NEIGHBOR = 5


@dataclass(frozen=True)
class _WalkChoices:
    """Construction of a walk from weights."""

    self_loops: str
    symmetrize: str | None
    normalize: str
    stay: float


@dataclass(frozen=True)
class _ScatteringChoices:
    """Scales, orders and number format of scattering."""

    scales: list[int]
    orders: list[int]
    precision: str


@dataclass(frozen=True)
class _KernelChoice:
    """Weights of neighbors by their distances."""

    name: str
    decay: float
    scale_neighbor: int


class Walk(Carrier):
    """A random walk P on n nodes, as `adwave.walk`, `adwave.point_walk` and `adwave.neighbors` make it.

    ``repr`` tells how it was made. Results do not depend on the number of threads. Every function takes a walk in the place
    of a shape, and ``walk @ f`` is one step.

    Parameters
    ----------
    graph, normalize, self_loops, symmetrize, stay
        As in `adwave.walk`.

    Examples
    --------
    >>> import adwave as aw
    >>> pair = aw.walk([[0, 1], [1, 0]])
    >>> pair
    <adwave.Walk: 2 nodes, as given>
    >>> pair @ [1.0, 3.0]
    array([3., 1.])
    """

    __slots__ = ("_data", "_decomposer", "_source", "origin")

    #: Construction of the walk in words.
    origin: str

    @public()
    def __init__(
        self,
        graph: object,
        *,
        normalize: Normalization | None = None,
        self_loops: float | Literal["keep"] = "keep",
        symmetrize: Literal["mean", "maximum"] | None = None,
        stay: float = 0.0,
    ) -> None:
        own = _make_walk(graph, normalize, self_loops, symmetrize, stay)
        self._source, self._data, self._decomposer, self.origin = own._source, own._data, own._decomposer, own.origin

    @classmethod
    def _from_source(cls, source: tuple[NDArray[Any], ...], choices: _WalkChoices | None, origin: str) -> Walk:
        values, columns, offsets = source
        walk = cls.__new__(cls)
        walk._source = (source, choices)
        walk._data = _native.WalkData(offsets, columns, values, choices)
        walk._decomposer = None
        walk.origin = origin
        return walk

    @property
    def n_vertices(self) -> int:
        """Number of nodes."""
        return self._data.n_nodes

    @property
    def n_nodes(self) -> int:
        """Number of nodes, as `n_vertices`."""
        return self._data.n_nodes

    @property
    def n_isolated(self) -> int:
        """Number of nodes without neighbors, whose values stay as they are."""
        return self._data.n_isolated

    @property
    def is_reversible(self) -> bool:
        """True if weights are symmetric. A directed walk is applied power by power, in whole steps."""
        return self._data.is_reversible

    @property
    def normalization(self) -> str:
        """Divisors of the weights: ``'row'``, ``'column'`` or ``'symmetric'``."""
        return self._data.normalization

    def matrix(self) -> csr_array:
        """P as a sparse n × n matrix."""
        from scipy.sparse import csr_array

        values, columns, offsets = self._data.matrix()
        return csr_array((values, columns, offsets), shape=(self.n_nodes, self.n_nodes))

    def _powers(self, signal: object, steps: float, progress: ProgressLike = None) -> NDArray[Any] | None:
        """``P^steps f`` for a whole number of steps of a signal without gaps; None for others, which go by bands."""
        if signal is None or isinstance(signal, str) or steps != int(steps) or steps < 0:
            return None
        values, layout = signal_values(signal, self.n_vertices)
        if self.normalization == "row" and not np.isfinite(values.sum()):
            return None
        with report_progress(progress, "smoothing") as report:
            found = layout.arrange(self._data.apply(values, int(steps), report))
        return found.astype(float_type(signal), copy=False)

    def power(self, steps: int) -> Walk:
        """The walk of a number of steps, ``P^steps``, whose matrix is full where the graph is not large.

        Examples
        --------
        >>> import adwave as aw
        >>> aw.walk([[0, 1], [1, 0]]).power(2).matrix().toarray()
        array([[1., 0.],
               [0., 1.]])
        """
        if steps != int(steps) or steps < 1:
            raise ValueError(f"steps must be a whole number of at least 1, got {steps}")
        if self.normalization != "row":
            raise ValueError(f"power needs a walk whose rows sum to 1, got {self.normalization} normalization")
        step = total = self.matrix()
        for bit in bin(int(steps))[3:]:
            total = total @ total
            total = total @ step if bit == "1" else total
        return Walk._from_source(_rows(total), None, f"{int(steps)} steps of {self.origin}")

    __pow__ = power

    def __matmul__(self, signal: ArrayLike) -> NDArray[np.float64]:
        values, layout = signal_values(signal, self.n_vertices)
        return layout.arrange(self._data.apply(values, 1, None))

    @public(scales="steps")
    def bands(self, signal: ArrayLike, steps: Sequence[int] = SCALES) -> NDArray[np.float64]:
        """Bands ``(P^{n_{j−1}} − P^{n_j}) f``, n_0 = 0, and the rest ``P^{n_J} f``; they sum to the signal.

        Parameters
        ----------
        signal : (n,) or (n, channels) array
            Values at the nodes.
        steps : sequence of int
            n_1 < n_2 < … < n_J.

        Returns
        -------
        (J + 1, n) or (J + 1, n, channels) array

        Examples
        --------
        >>> import adwave as aw
        >>> aw.walk([[0.5, 0.5], [0.5, 0.5]]).bands([1.0, 3.0], [1])
        array([[-1.,  1.],
               [ 2.,  2.]])
        """
        values, layout = signal_values(signal, self.n_vertices)
        return layout.arrange(self._data.bands(values, [int(n) for n in steps]))

    def prepare(self) -> Decomposer:
        """The graph of the walk as an `adwave.Decomposer`: bands, filters, denoising, saliency and features.

        Walks that stay half of the time or more take any levels; others take whole numbers of steps.

        Raises
        ------
        ValueError
            Unless rows are normalized.

        Examples
        --------
        >>> import adwave as aw
        >>> pair = aw.walk([[0, 1], [1, 0]]).prepare()
        >>> pair.decompose([1.0, 3.0], levels=1).scaling(1)
        array([3., 1.])
        """
        from adwave._decomposer import Decomposer
        from adwave._shape import graph

        if self._decomposer is None:
            from scipy.sparse import triu

            steps = self.matrix()
            edges = triu(steps + steps.T, 1).tocoo()
            shape = graph(self.n_nodes, np.column_stack([edges.row, edges.col]), edges.data)
            self._decomposer = Decomposer(shape, operator="walk").with_walk(self)
        return self._decomposer

    def _as_domain(self) -> Decomposer:
        """The walk as a domain, which functions of shapes take in its place."""
        return self.prepare()

    def __repr__(self) -> str:
        return f"<adwave.Walk: {self.n_nodes} nodes, {self.origin}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return Walk._from_source, (*self._source, self.origin)


@public(matrix="graph")
def walk(
    graph: object,
    *,
    normalize: Normalization | None = None,
    self_loops: float | Literal["keep"] = "keep",
    symmetrize: Literal["mean", "maximum"] | None = None,
    stay: float = 0.0,
) -> Walk:
    """A walk as given, or from the weights of a graph.

    Parameters
    ----------
    graph : (n, n) array, sparse matrix, or graph of NetworkX, PyGSP, AnnData or PyTorch Geometric; or shape_like
        A matrix without `normalize` is the walk itself: entries ≥ 0, rows that sum to 1 with the diagonal. With it, weights,
        of which those of a directed graph lead from the row to the column. Of a mesh or a cloud, the lazy walk Φ₁ of
        `Decomposer`.
    normalize : 'row', 'column' or 'symmetric', optional
        Divides weights W with row sums D: ``D⁻¹W`` averages values, ``WD⁻¹`` moves amounts, ``D^(−½)WD^(−½)`` is
        symmetric.
    self_loops : float or 'keep'
        Weight of the loop at each node; ``"keep"`` takes the diagonal as it is.
    symmetrize : 'mean' or 'maximum', optional
        Makes directed weights symmetric. A directed walk takes whole steps only.
    stay : float
        Share of the steps that stay: the walk is ``stay·I + (1 − stay)·P``.

    Raises
    ------
    ValueError
        If an entry is negative or not finite, or a row of a given walk does not sum to 1.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.walk([[0, 1, 0], [1, 0, 3], [0, 3, 0]], normalize="row").matrix().toarray()
    array([[0.  , 1.  , 0.  ],
           [0.25, 0.  , 0.75],
           [0.  , 1.  , 0.  ]])
    """
    return _make_walk(graph, normalize, self_loops, symmetrize, stay)


def _make_walk(graph: Any, normalize: Normalization | None, self_loops: Any, symmetrize: Any, stay: float) -> Walk:
    if isinstance(normalize, bool):
        raise TypeError(f"normalize must be 'row', 'column' or 'symmetric', got {normalize}{_normalized_line()}")
    library = graph_library(graph)
    if library is not None:
        if normalize is None:
            raise TypeError(
                f"graph: a graph of {library} has weights, and a walk has rows that sum to 1{_normalized_line()}"
            )
        graph = graph_matrix(graph, library)
    elif isinstance(graph, (Carrier, str, tuple)) or library_of(graph) in _MESHES:
        return as_walk(graph)
    source = _rows(graph)
    if normalize is None:
        changed = {"self_loops": self_loops != "keep", "symmetrize": symmetrize is not None, "stay": stay != 0.0}
        for name, is_changed in changed.items():
            if is_changed:
                raise ValueError(f"{name} applies to weights, and this is a walk as given; add normalize='row'")
        try:
            return Walk._from_source(source, None, "as given")
        except ValueError as error:
            raise ValueError(f"{error}{_normalized_line()}") from None
    choices = _WalkChoices(_loops(self_loops), symmetrize, normalize, float(stay))
    return Walk._from_source(source, choices, _describe("a graph", choices))


#: Libraries whose objects are meshes and clouds.
_MESHES = ("trimesh", "pyvista", "meshio", "open3d", "nilearn", "laspy")


def _normalized_line() -> str:
    """The user's call with weights divided by their sums."""
    call = written_call("walk") or written_call("Walk") or Call("aw.walk", ["graph"], {})
    call.keywords["normalize"] = "'row'"
    return f"; write {call}"


@public()
def point_walk(
    X: ArrayLike,
    *,
    neighbors: int = 15,
    kernel: Kernel = "adaptive",
    decay: float = 1.0,
    scale_neighbor: int = SCALE_NEIGHBOR,
    self_loops: float = 1.0,
    stay: float = 0.0,
    progress: ProgressLike = None,
) -> Walk:
    """A walk on points of any dimension, to their exact nearest neighbors.

    Neighbors at the same distance as the last one are all taken, as for point clouds in space. The search compares all
    pairs, in about 20 s for 100 000 points in 50 dimensions; for many more, use `adwave.neighbors` with those of another
    program.

    Parameters
    ----------
    X : (n, d) array
        Points.
    neighbors : int
        Number of nearest neighbors.
    kernel : str
        ``"adaptive"``: exp(−(d/σ)^decay), σ the distance to the `scale_neighbor`-th neighbor, mean of both directions;
        ``"self-tuning"``: exp(−d²/σσ′); ``"paper"``: exp(−d²/2E²), E the mean distance; ``"density-invariant"``: the
        last one divided by the density of the points.
    decay, scale_neighbor : float, int
        Parameters of the kernel.
    self_loops : float
        Weight of the loop at each point; a kernel has 1 at the distance 0.
    stay : float
        Share of the steps that stay.
    progress : bool or callable, optional
        ``True`` for a bar, or a function of (done, total).

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> aw.point_walk(np.eye(5), neighbors=2).n_vertices
    5
    """
    values = np.ascontiguousarray(np.atleast_2d(np.asarray(X, dtype=np.float64)))
    if values.ndim != 2:
        raise ValueError(f"points must be an n × d array, got shape {values.shape}")
    with report_progress(progress, "finding neighbors") as report:
        offsets, indices, distances = _native.nearest(values, int(neighbors), report)
    chosen = _KernelChoice(kernel, float(decay), int(scale_neighbor))
    if len(offsets) == 1:  # no points
        offsets, indices = np.zeros(1, dtype=np.int64), np.empty(0, dtype=np.uint32)
    weights = _native.neighbor_weights(offsets, indices.astype(np.int64), distances, chosen)
    choices = _WalkChoices(str(float(self_loops)), None, "row", float(stay))
    origin = f"{neighbors} nearest neighbors in {values.shape[1]} dimensions, kernel {kernel}"
    return Walk._from_source(weights, choices, _describe(origin, choices))


@public()
def neighbors(
    indices: ArrayLike,
    distances: ArrayLike,
    *,
    kernel: Kernel = "adaptive",
    decay: float = 1.0,
    scale_neighbor: int = SCALE_NEIGHBOR,
    self_loops: float = 1.0,
    stay: float = 0.0,
) -> Walk:
    """A walk on points whose neighbors another program found, such as pynndescent, faiss or scikit-learn.

    Parameters
    ----------
    indices, distances : (n, k) arrays
        Neighbors of each point, and their distances. −1 means none; a point in its own list is left out.
    kernel, decay, scale_neighbor, self_loops, stay
        As in `adwave.point_walk`.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.neighbors([[1], [0]], [[2.0], [2.0]], self_loops=0.0).matrix().toarray()
    array([[0., 1.],
           [1., 0.]])
    """
    found = np.ascontiguousarray(np.asarray(indices), dtype=np.int64)
    lengths = np.ascontiguousarray(np.asarray(distances), dtype=np.float64)
    if found.ndim != 2 or lengths.shape != found.shape:
        raise ValueError(f"indices and distances must be n × k arrays, got shapes {found.shape} and {lengths.shape}")
    chosen = _KernelChoice(kernel, float(decay), int(scale_neighbor))
    counts = np.array([len(found)], dtype=np.int64)
    weights = _native.neighbor_weights(counts, found.ravel(), lengths.ravel(), chosen)
    choices = _WalkChoices(str(float(self_loops)), None, "row", float(stay))
    return Walk._from_source(weights, choices, _describe(f"given neighbors, kernel {kernel}", choices))


@public()
def from_edge_index(
    edge_index: object,
    edge_weight: object = None,
    *,
    nodes: int | None = None,
    normalize: Normalization = "row",
    self_loops: float | Literal["keep"] = 0.0,
    symmetrize: Literal["mean", "maximum"] | None = None,
    stay: float = 0.5,
) -> Walk:
    """A walk on a graph of PyTorch Geometric: 2 × E indices, in any order; repeated edges are added.

    A batch is a graph of several components. The default is the lazy walk of geometric scattering.

    Parameters
    ----------
    edge_index : (2, E) array or tensor
        Edge e goes from ``edge_index[0, e]`` to ``edge_index[1, e]``.
    edge_weight : (E,) array or tensor, optional
        Weights.
    nodes : int, optional
        Number of nodes, if the last have no edges.
    normalize, self_loops, symmetrize, stay
        As in `adwave.walk`.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.from_edge_index([[0, 1], [1, 0]]).matrix().toarray()
    array([[0.5, 0.5],
           [0.5, 0.5]])
    """
    from scipy.sparse import coo_array

    ends = as_array(edge_index)
    if ends.ndim != 2 or ends.shape[0] != 2:
        raise ValueError(f"edge_index must be a 2 × E array, got shape {ends.shape}")
    ends = ends.astype(np.int64)
    n = int(ends.max(initial=-1)) + 1 if nodes is None else int(nodes)
    if ends.size and (ends.min() < 0 or ends.max() >= n):
        raise ValueError(f"edge_index must be in 0..={n - 1}, got {ends.min()} to {ends.max()}")
    weights = np.ones(ends.shape[1]) if edge_weight is None else as_array(edge_weight).astype(np.float64).ravel()
    if weights.shape != (ends.shape[1],):
        raise ValueError(f"edge_weight must have one value for each of {ends.shape[1]} edges, got {weights.shape[0]}")
    matrix = coo_array((weights, (ends[0], ends[1])), shape=(n, n))
    return walk(matrix, normalize=normalize, self_loops=self_loops, symmetrize=symmetrize, stay=stay)


@dataclass(frozen=True)
class ScatteringResult:
    """Scattering coefficients of a signal.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.scattering(aw.walk([[0, 1], [1, 0]]), [1.0, 3.0], steps=[1]).features()
    array([[1., 2.],
           [3., 2.]])
    """

    #: Coefficients: (paths, n, channels), or (graphs, paths, channels, statistics) if pooled.
    values: NDArray[np.float64]
    #: Bands of each path, from 1: ``()`` the signal, ``(j,)`` |W_j f|, ``(j, k)`` |W_k |W_j f||.
    paths: tuple[tuple[int, ...], ...]
    #: Number format of the products, ``'single'`` or ``'double'``.
    precision: str = "double"
    #: Bound of the rounding errors of the coefficients before pooling, relative to the signal: of the largest size of a
    #: value in the channel if rows of the walk are normalized, of the sum of the sizes for columns, and of the root of the
    #: sum of the squares for the symmetric walk.
    error_bound: float = 0.0

    def features(self) -> NDArray[np.float64]:
        """One row of features for each node, or for each graph if pooled."""
        if self.values.ndim == 4:
            return self.values.reshape(len(self.values), -1)
        return np.moveaxis(self.values, 1, 0).reshape(self.values.shape[1], -1)


def as_walk(given: object) -> Walk:
    """A walk as it is; of any shape or graph, the lazy walk Φ₁ of its operator.

    Raises
    ------
    ValueError, TypeError
        If the argument is no shape; see `Shape`.

    Examples
    --------
    >>> import adwave as aw
    >>> from adwave._walk import as_walk
    >>> as_walk(aw.graph(2, [[0, 1]])).matrix().toarray()
    array([[0.5, 0.5],
           [0.5, 0.5]])
    """
    if isinstance(given, Walk):
        return given
    from adwave._decomposer import prepare_decomposer

    return walk(prepare_decomposer(given).matrix())


@public(scales="steps")
def scattering(
    walk: object,
    signal: ArrayLike,
    *,
    steps: Sequence[int] = SCALES,
    orders: Sequence[int] = (0, 1, 2),
    pool: Pool | None = None,
    batch: ArrayLike | None = None,
    precision: Literal["auto", "single", "double"] = "double",
    progress: ProgressLike = None,
) -> ScatteringResult:
    """Geometric scattering: the signal, the sizes of its bands, and the sizes of the coarser bands of each of these.

    Parameters
    ----------
    walk : Walk or shape_like
        The walk, usually lazy (``stay=0.5``); of a graph or any other shape, the lazy walk of `Decomposer`.
    signal : (n,) or (n, channels) array
        Values at the nodes.
    steps : sequence of int
        Scales n_1 < n_2 < …; the bands are ``P^{n_{j−1}} − P^{n_j}`` with n_0 = 0.
    orders : sequence of int
        Orders, of 0, 1 and 2.
    pool : str, optional
        Statistics over the nodes: ``"mean"``, ``"max"``, ``"norms"`` (sums of the powers 1 to 4 of the sizes) or
        ``"moments"`` (mean, variance, skewness, excess kurtosis).
    batch : (n,) array of int, optional
        Graph of each node, for pooling over several graphs; graphs without nodes have zeros.
    precision : {'double', 'single', 'auto'}
        Number format of the products. ``"single"`` takes half of the memory and is faster; ``ScatteringResult.error_bound``
        bounds its errors. ``"auto"`` takes it if they are at most 1e-10. Means, sums and pooling are in double precision.
    progress : bool or callable, optional
        ``True`` for a bar, or a function of (done, total).

    Examples
    --------
    >>> import adwave as aw
    >>> lazy = aw.walk([[0, 1], [1, 0]], normalize="row", stay=0.5)
    >>> found = aw.scattering(lazy, [1.0, 3.0], steps=[1, 2])
    >>> found.paths
    ((), (1,), (2,), (1, 2))
    >>> found.values[1, :, 0]
    array([1., 1.])
    """
    refuse_edge_index("scattering", walk, [])
    own = as_walk(walk)
    values, _ = signal_values(signal, own.n_vertices)
    with report_progress(progress, "scattering") as report:
        scales, wanted = [int(n) for n in steps], [int(order) for order in orders]
        choices = _ScatteringChoices(scales, wanted, precision)
        found, paths, accuracy = own._data.scatter(values, choices, report)
    named = tuple(tuple(path) for path in paths)
    if pool is None:
        if batch is not None:
            raise ValueError("batch applies to pooling; give pool too")
        return ScatteringResult(found, named, *accuracy)
    return ScatteringResult(pool_nodes(found, pool, batch), named, *accuracy)


def pool_nodes(values: NDArray[np.float64], pool: Pool, batch: ArrayLike | None) -> NDArray[np.float64]:
    """Statistics of (paths, n, channels) values over the nodes of each graph."""
    n_paths, n, n_channels = values.shape
    labels = np.zeros(n, dtype=np.int64) if batch is None else as_array(batch).astype(np.int64).ravel()
    if labels.shape != (n,) or (n and labels.min() < 0):
        raise ValueError(f"batch must have the graph of each of {n} nodes, from 0")
    n_graphs = int(labels.max(initial=0 if batch is None else -1)) + 1
    flat = _native.pool_graphs(values, labels.astype(np.uint32), n_graphs, pool)
    return flat.reshape(n_graphs, n_paths, n_channels, -1 if n_paths * n_channels * n_graphs else 1)


def as_array(values: object) -> NDArray[Any]:
    """An array, also from a tensor that needs a gradient or lies on a device."""
    detached = getattr(values, "detach", None)
    if detached is not None:
        values = detached().cpu().numpy()
    return np.asarray(values)


def graph_library(x: object) -> str | None:
    """Library of a graph object whose weights can be read, or None."""
    library = library_of(x)
    return library if library in ("networkx", "pygsp", "torch_geometric", "anndata") else None


def graph_matrix(x: object, library: str) -> Any:
    """Weights of a graph of another library, with its directions and self-loops."""
    from scipy.sparse import coo_array

    found = read_object(x, library)
    if found.edges is None:
        raise TypeError(f"matrix: the {type(x).__name__} of {library} has no edges; pass a graph with edges")
    rows, cols, weights, is_listed_once = found.edges
    rows, cols = np.asarray(rows), np.asarray(cols)
    weights = np.ones(rows.size) if weights is None else np.asarray(weights, dtype=np.float64)
    if is_listed_once:
        is_apart = rows != cols
        rows, cols = np.concatenate([rows, cols[is_apart]]), np.concatenate([cols, rows[is_apart]])
        weights = np.concatenate([weights, weights[is_apart]])
    return coo_array((weights, (rows, cols)), shape=(found.n_vertices, found.n_vertices))


def _rows(matrix: object) -> tuple[NDArray[np.float64], NDArray[np.uint32], NDArray[np.int64]]:
    """Values, columns and offsets of a square matrix with sorted rows."""
    from scipy.sparse import csr_array, issparse

    rows: Any = matrix if issparse(matrix) else csr_array(np.atleast_2d(np.asarray(matrix, dtype=np.float64)))
    if len(rows.shape) != 2 or rows.shape[0] != rows.shape[1]:
        raise ValueError(
            f"the matrix of a graph is square, got shape {rows.shape}; pass (n, n) weights or probabilities, or "
            "adwave.point_walk(X) for points in rows"
        )
    if rows.shape[0] >= 2**32 - 1:
        raise ValueError(f"a graph has fewer than 2³² − 1 nodes, got {rows.shape[0]}")
    rows = csr_array(rows, dtype=np.float64, copy=True)
    rows.sum_duplicates()
    return rows.data, rows.indices.astype(np.uint32), rows.indptr.astype(np.int64)


def _loops(self_loops: float | str) -> str:
    return "keep" if self_loops == "keep" else str(float(self_loops))


def _describe(source: str, choices: _WalkChoices) -> str:
    loops = "loops as given" if choices.self_loops == "keep" else f"loops of weight {choices.self_loops}"
    symmetric = "" if choices.symmetrize is None else f", {choices.symmetrize} of both directions"
    return f"{source}, {loops}{symmetric}, {choices.normalize} normalization, {choices.stay} of the steps stay"
