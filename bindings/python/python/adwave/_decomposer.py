"""`Decomposer`: a shape prepared once, to be asked often."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._progress import ProgressLike, reporting
from adwave._shape import Shape, as_shape

if TYPE_CHECKING:
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import LinearOperator

    from adwave._bands import Bands

Length = Union[float, str]
SignalLike = Union[str, ArrayLike, None]
Operator = Literal["walk", "surface"]

#: Up to which share of the diagonal levels go where none are asked for: of bands, of features, of a map with a sign.
REACH = _native.REACH


class Decomposer:
    """A shape with its diffusion operator, prepared once; each question then costs its products only.

    The operator Φ₁ is one step of a diffusion on the shape: a lazy random walk over the mesh (`houqin2013`, eq. 4) or heat on the
    surface. Level j of a signal f is ``S_f(j) = Φ₁^(n_j) f``, and its bands are ``W_f(j) = S_f(j−1) − S_f(j)`` (eq. 11).

    Parameters
    ----------
    shape, faces
        Anything that is a shape; see `Shape`.
    operator : {'walk', 'surface'}
        By what signals are smoothed: the paper's lazy random walk, or heat on the surface, whose widths hardly depend on the
        mesh.
    weld : bool
        Whether vertices at exactly equal positions are one for the analysis.
    rings : int
        Walk on a mesh: how many rings of neighbors one step takes in.
    mesh_area : {'barycentric', 'mixed-voronoi'}
        Walk on a mesh: the area of a vertex.
    neighbors : int
        Cloud: how many nearest neighbors one step takes in.
    directed : bool
        Walk on a cloud: step to the nearest of each point only, as the paper has it.
    cloud_area : {'kth-neighbor', 'unit', 'tangent-voronoi'}
        Walk on a cloud: the area of a point.
    density_invariant : bool
        Walk: take out how densely the shape was sampled.
    keep_creases : bool
        Do not step across creases, where normals turn sharply.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total).

    Notes
    -----
    O(n log n) time; it keeps about 200 bytes a vertex. Safe to ask from several threads, and in a forked child.

    Examples
    --------
    >>> import adwave as aw
    >>> walk = aw.Decomposer(aw.sample("sphere", vertices=1000))
    >>> bands = walk.decompose(levels=4)
    >>> heights = walk.decompose(walk.shape.points[:, 2], levels=4)
    >>> heights.shape
    (5, 1000)
    """

    __slots__ = ("__weakref__", "_data", "_mask", "_options", "shape")

    def __init__(
        self,
        shape: object,
        faces: object = None,
        *,
        operator: Operator = "walk",
        weld: bool | None = None,
        rings: int | None = None,
        mesh_area: str | None = None,
        neighbors: int | None = None,
        directed: bool | None = None,
        cloud_area: str | None = None,
        density_invariant: bool | None = None,
        keep_creases: bool | None = None,
        progress: ProgressLike = None,
    ) -> None:
        options = {
            "operator": operator,
            "weld": weld,
            "rings": rings,
            "mesh_area": mesh_area,
            "neighbors": neighbors,
            "directed": directed,
            "cloud_area": cloud_area,
            "density_invariant": density_invariant,
            "keep_creases": keep_creases,
        }
        self.shape: Shape = as_shape(shape, faces)
        self._options: dict[str, Any] = {name: given for name, given in options.items() if given is not None}
        with reporting(progress, "preparing") as report:
            self._data = _native.Prepared(self.shape._data, self._options, report)
        self._mask: NDArray[np.bool_] | None = None

    @property
    def n_vertices(self) -> int:
        """Number of vertices of the shape."""
        return self._data.n_vertices

    @property
    def operator(self) -> str:
        """``'walk'`` or ``'surface'``."""
        return self._data.operator

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal, model units; 0 of a graph."""
        return self._data.lengths()[0]

    @property
    def mean_length(self) -> float:
        """Mean length of the edges, or mean distance of nearest neighbors, model units."""
        return self._data.lengths()[1]

    @property
    def areas(self) -> NDArray[np.float64]:
        """The area of each vertex, squared model units."""
        return self._data.areas()

    @property
    def mask(self) -> NDArray[np.bool_] | None:
        """Which vertices are left out; None where none are."""
        return self._mask

    def masked(self, mask: ArrayLike) -> Decomposer:
        """The same shape without some vertices: the diffusion goes round them. Their bands are NaN.

        Signals that are NaN somewhere are masked there by themselves.

        Parameters
        ----------
        mask : (n,) array of bool
            True at vertices that are left out.
        """
        flags = np.ascontiguousarray(np.asarray(mask), dtype=bool)
        if flags.shape != (self.n_vertices,):
            raise ValueError(f"mask: shape {flags.shape} for {self.n_vertices} vertices; give one flag for each")
        other = Decomposer.__new__(Decomposer)
        other.shape, other._options, other._mask = self.shape, self._options, flags
        other._data = self._data.masked(flags)
        return other

    def steps(
        self,
        *,
        levels: int | None = None,
        lengths: Sequence[Length] | None = None,
        fwhm: Sequence[Length] | None = None,
        steps: Sequence[float] | None = None,
        voices: int | None = None,
        reach: float | None = None,
    ) -> list[float]:
        """How many steps of the diffusion each level stands for.

        Parameters
        ----------
        levels : int, optional
            So many levels of 1, 2, 4 … steps. Where nothing is given, until a level is 2 % of the diagonal wide.
        lengths : sequence of float or str, optional
            Levels of these widths σ, in model units or in ``"2%"`` of the diagonal: the root mean square distance that one
            value spreads to.
        fwhm : sequence of float or str, optional
            Levels of these full widths at half maximum: 1.665 σ.
        steps : sequence of float, optional
            Levels of these numbers of steps, whole or not.
        voices : int, optional
            So many levels for each doubling of the steps.
        reach : float, optional
            Share of the diagonal that the levels go to where none are asked for.
        """
        if steps is not None and levels is lengths is fwhm is voices is None:
            return [float(n) for n in steps]
        given = [name for name, value in (("lengths", lengths), ("fwhm", fwhm), ("steps", steps)) if value is not None]
        if levels is not None or voices is not None:
            given.append("levels and voices" if voices is not None else "levels")
        if len(given) > 1:
            raise ValueError(f"{' and '.join(given)} cannot be given together; levels are given one way")

        def widths(which: Any) -> list[Length] | None:
            if which is None:
                return None
            each = [which] if isinstance(which, str) or np.ndim(which) == 0 else which
            return [w if isinstance(w, str) else float(w) for w in each]

        return self._data.levels(levels, voices, widths(lengths), widths(fwhm), reach)[0]

    def sigma(self, steps: Sequence[float]) -> NDArray[np.float64]:
        """The width σ of levels of so many steps, model units (hops on a graph): the root mean square distance."""
        return np.array(self._data.sigma([float(n) for n in steps])[1:])

    def decompose(
        self,
        signal: SignalLike = None,
        *,
        levels: int | None = None,
        lengths: Sequence[Length] | None = None,
        fwhm: Sequence[Length] | None = None,
        steps: Sequence[float] | None = None,
        voices: int | None = None,
        accuracy: float = _native.ACCURACY,
        progress: ProgressLike = None,
    ) -> Bands:
        """Split a signal into its bands; see `adwave.decompose`."""
        from adwave._bands import Bands

        chosen = self.steps(levels=levels, lengths=lengths, fwhm=fwhm, steps=steps, voices=voices)
        owner, values, is_flat = self._signal(signal)
        with reporting(progress, "splitting") as report:
            array, error, degree, n_bytes = owner._data.bands(values, chosen, accuracy, report)
        info = {"error_bound": error, "degree": degree, "bytes": n_bytes, "accuracy": accuracy}
        return Bands._of(owner, values, array, chosen, is_flat, info)

    def region(self, region: str) -> NDArray[np.float64]:
        """The weights of a region, one in [0, 1] for each vertex.

        Parameters
        ----------
        region : str
            As on the command line, joined by ``&``, ``|`` and ``!``: ``"ball:vertex=120,radius=10%"`` or
            ``"ball:point=0 1 0,radius=0.2"``, ``"stroke:path=120 340 560,radius=2%"``, ``"box:min=0 0 0,max=1 1 1"``,
            ``"half-space:point=0 0 0,normal=0 1 0"``, ``"field:name=mask,low=0.5,high=1"``, ``"vertices:indices=1 2 3"``. The
            first four fall to 0 over ``falloff=…``, a length. Also ``"facing:direction=0 0 1"``, ``"component:vertex=5"``, and
            regions made of others: ``"grown:by=2%(…)"``, ``"shrunk:by=2%(…)"``, ``"blurred:by=2%(…)"``. Fields are those of the
            shape, or ``saliency``, ``mean-curvature``, ``gaussian-curvature``, ``shape-index``, ``band-3`` (the size of W₃).
        """
        return self._data.region(region)

    def weighted(
        self,
        signal: SignalLike,
        factors: Sequence[float],
        steps: Sequence[float],
        *,
        accuracy: float = _native.ACCURACY,
    ) -> NDArray[np.float64]:
        """``Σ_j factors[j−1]·W_f(j)`` by a single polynomial of Φ₁: much cheaper than the bands one by one."""
        owner, values, is_flat = self._signal(signal)
        total = owner._data.weighted(values, [float(n) for n in steps], [float(f) for f in factors], accuracy)
        return total[:, 0] if is_flat else total

    def functions(self, vertex: int, level: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The scaling function φ and the wavelet ψ of one vertex on a dyadic level, as values at all vertices.

        Returns
        -------
        scaling_function : (n,) array
            ≥ 0; sums to 1 over the welded vertices.
        wavelet : (n,) array
            Sums to 0.
        """
        if not 0 <= vertex < self.n_vertices:
            raise ValueError(f"vertex: {vertex} is none of 0 to {self.n_vertices - 1}")
        phi, psi, _ = self._data.vertex_functions(vertex, self.steps(levels=level))
        return phi, psi

    def matrix(self) -> csr_array:
        """Φ₁ as a sparse matrix: rows are ≥ 0 and sum to 1.

        In the order of the shape; where vertices were welded over the welded ones, and `welded` says which is which.
        """
        from scipy.sparse import csr_array

        return csr_array(_native.diffusion_matrix(self._data))

    def welded(self) -> NDArray[np.uint32]:
        """Which welded vertex each vertex of the shape is."""
        return self._data.welding()[0]

    def basis(
        self,
        levels: int,
        *,
        drop_tolerance: float | None = None,
        max_bytes: int | None = None,
        progress: ProgressLike = None,
    ) -> tuple[list[csr_array], list[csr_array]]:
        """All scaling functions and wavelets of dyadic levels as sparse matrices (Algorithm 1).

        Row x of the j-th is the function of vertex x on level j; entries below ``drop_tolerance`` are dropped.

        Parameters
        ----------
        levels : int
        drop_tolerance : float, optional
        max_bytes : int, optional
            Refuse (`MemoryError`) what needs more.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total).

        Returns
        -------
        scaling, wavelets : lists of csr_array
            Φ_1 … Φ_J and Ψ_1 … Ψ_J, in the order of the shape; over the welded vertices where some were welded.
        """
        from scipy.sparse import csr_array

        with reporting(progress, "walking") as report:
            scaling, wavelets = _native.basis_matrices(self._data, levels, drop_tolerance, max_bytes, report)
        return [csr_array(rows) for rows in scaling], [csr_array(rows) for rows in wavelets]

    def smooth(
        self,
        signal: SignalLike,
        steps: float | None = None,
        *,
        length: Length | None = None,
        fwhm: Length | None = None,
        accuracy: float = _native.ACCURACY,
    ) -> NDArray[np.float64]:
        """``Φ₁^steps f``, for any number of steps from 1/64, whole or not, or by a width.

        Parameters
        ----------
        signal : str or array-like
            As for `decompose`.
        steps : float, optional
        length : float or str, optional
            The width σ in the place of steps, in model units or in ``"2%"`` of the diagonal.
        fwhm : float or str, optional
            The full width at half maximum in the place of steps.
        """
        if [steps is None, length is None, fwhm is None].count(False) != 1:
            raise ValueError("give one of steps, length and fwhm")
        if steps is None:
            widths = (None if width is None else [width] for width in (length, fwhm))
            (steps,) = self.steps(**dict(zip(("lengths", "fwhm"), widths, strict=True)))
        owner, values, is_flat = self._signal(signal)
        change = owner._data.weighted(values, [float(steps)], [-1.0], accuracy)
        smoothed = change + (self.shape.points if values is None else values)
        return smoothed[:, 0] if is_flat else smoothed

    def adjoint(self, signal: ArrayLike, steps: float, *, accuracy: float = _native.ACCURACY) -> NDArray[np.float64]:
        """``(Φ₁^steps)ᵀ g``: by reversibility ``π·Φ₁^steps(g/π)``, π being the stationary distribution.

        Raises
        ------
        ValueError
            When the diffusion is not reversible (directed clouds, masks).
        """
        if not self._data.is_reversible() or self._mask is not None:
            raise ValueError("the adjoint needs a reversible diffusion; leave out directed and masks")
        share = self._data.welding()[1]
        values = np.asarray(signal, dtype=np.float64)
        share = share if values.ndim == 1 else share[:, None]
        return share * self.smooth(values / share, steps, accuracy=accuracy)

    def linear_operator(self, steps: float = 1.0, *, accuracy: float = _native.ACCURACY) -> LinearOperator:
        """``Φ₁^steps`` as a `scipy.sparse.linalg.LinearOperator` with its adjoint, for any number of steps, whole or not.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> walk = aw.Decomposer(aw.sample("sphere", vertices=200))
        >>> P = walk.linear_operator(3)
        >>> f, g = np.arange(200.0), np.ones(200)
        >>> bool(np.isclose(g @ P.matvec(f), P.rmatvec(g) @ f))
        True
        """
        from scipy.sparse.linalg import LinearOperator

        n = self.n_vertices

        def forward(x: NDArray[np.float64]) -> NDArray[np.float64]:
            return self.smooth(x.reshape(n, -1), steps, accuracy=accuracy).reshape(x.shape)

        def back(x: NDArray[np.float64]) -> NDArray[np.float64]:
            return self.adjoint(x.reshape(n, -1), steps, accuracy=accuracy).reshape(x.shape)

        # The class without types makes an object of another class here.
        made: Any = LinearOperator
        return made((n, n), matvec=forward, rmatvec=back, matmat=forward, rmatmat=back, dtype=np.float64)

    def _signal(self, signal: SignalLike) -> tuple[Decomposer, NDArray[np.float64] | None, bool]:
        """The signal as n × channels (None: the coordinates), masked where it is NaN, and whether it had one dimension."""
        if signal is None or (isinstance(signal, str) and signal == "coords"):
            return self, None, False
        if isinstance(signal, str):
            values = self.shape._data.signal(signal)
            is_flat = values.shape[1] == 1
        else:
            is_flat = np.ndim(signal) == 1
            values = _adapt.values_array(signal, self.n_vertices)
        missing = np.isnan(values).any(axis=1)
        if missing.any() and self._mask is None:
            return self.masked(missing), values, is_flat
        return self, values, is_flat

    def __repr__(self) -> str:
        return f"<adwave.Decomposer: {self.operator} on {self.shape!r}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self.shape, self._options, self._mask)


def _restored(shape: Shape, options: dict[str, Any], mask: NDArray[np.bool_] | None) -> Decomposer:
    decomposer = Decomposer(shape, **options)
    return decomposer if mask is None else decomposer.masked(mask)


_OPTIONS = (
    "operator",
    "weld",
    "rings",
    "mesh_area",
    "neighbors",
    "directed",
    "cloud_area",
    "density_invariant",
    "keep_creases",
)
_COMMON = ("signal", "levels", "lengths", "fwhm", "steps", "voices", "accuracy", "progress")


def prepared(shape: object, faces: object, options: dict[str, Any], by_width: bool = False) -> Decomposer:
    """The shape prepared: as it is where it is a `Decomposer`; by heat on the surface where levels are given by width."""
    if isinstance(shape, Decomposer):
        if faces is not None or options:
            raise ValueError("a Decomposer has its faces and options already; leave them out")
        return shape
    for name in options:
        if name not in _OPTIONS:
            import difflib

            near = difflib.get_close_matches(name, (*_OPTIONS, *_COMMON), 1)
            told = f"; is {near[0]!r} meant?" if near else f"; options of the diffusion are {', '.join(_OPTIONS)}"
            raise TypeError(f"there is no option {name!r}{told}")
    given = {name: value for name, value in options.items() if value is not None}
    of_walk = {"rings", "mesh_area", "directed", "cloud_area", "density_invariant"}
    given.setdefault("operator", "surface" if by_width and not of_walk & given.keys() else "walk")
    return Decomposer(shape, faces, **given)
