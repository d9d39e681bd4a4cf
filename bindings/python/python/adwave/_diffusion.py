"""`PreparedShape`: a shape with its diffusion operator, and what the operator gives on its own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._options import (
    BandsRequest,
    Length,
    LevelsLike,
    Operator,
    OperatorLike,
    SignalLike,
    Steps,
    Widths,
    as_operator,
    check_levels,
)
from adwave._progress import ProgressLike, report_progress
from adwave._shape import Shape, as_shape

if TYPE_CHECKING:
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import LinearOperator

#: Share of the diagonal up to which levels go if none are given: of bands, of features, of a signed saliency map.
EXTENT = _native.EXTENT

_Prepared = TypeVar("_Prepared", bound="PreparedShape")


class PreparedShape:
    """A shape with its diffusion operator Φ₁; `adwave.Decomposer` adds the bands."""

    __slots__ = ("__weakref__", "_data", "_mask", "_options", "shape")

    shape: Shape

    def __init__(self, shape: object, *, operator: OperatorLike = "walk", progress: ProgressLike = None) -> None:
        self.shape = as_shape(shape)
        self._options: Operator = as_operator(operator).with_default_kind("walk")
        with report_progress(progress, "preparing") as report:
            self._data = _native.Prepared(self.shape._data, self._options, report)
        self._mask: NDArray[np.bool_] | None = None

    @property
    def n_vertices(self) -> int:
        """Number of vertices of the shape."""
        return self._data.n_vertices

    @property
    def operator(self) -> str:
        """Kind of the diffusion operator, ``'walk'`` or ``'surface'``."""
        return self._data.operator

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal, in model units; 0 for a graph."""
        return self._data.lengths()[0]

    @property
    def extent(self) -> float:
        """Size of the shape, in model units, to which default levels and lengths in % refer; 0 for a graph.

        The diagonal of the bounding box of the largest connected part, without vertices of no face, placeholders and
        strays. It does not depend on the layout of the parts.
        """
        return self._data.extent()

    @property
    def mean_length(self) -> float:
        """Mean length of the edges, or mean distance of nearest neighbors, in model units."""
        return self._data.lengths()[1]

    @property
    def areas(self) -> NDArray[np.float64]:
        """Area of each vertex, (n,), in squared model units."""
        return self._data.areas()

    @property
    def mask(self) -> NDArray[np.bool_] | None:
        """Mask of the vertices that are left out, (n,); None if there are none."""
        return self._mask

    def with_mask(self: _Prepared, mask: ArrayLike) -> _Prepared:
        """Shape without some vertices: the diffusion goes around them, and their bands are NaN.

        Signals with NaN are masked there without this.

        Parameters
        ----------
        mask : (n,) array of bool
            True at vertices that are left out.

        Raises
        ------
        ValueError
            If `mask` does not have one flag for each vertex.
        """
        flags = np.ascontiguousarray(np.asarray(mask), dtype=bool)
        if flags.shape != (self.n_vertices,):
            raise ValueError(f"mask must have one flag for each of {self.n_vertices} vertices, got shape {flags.shape}")
        other = type(self).__new__(type(self))
        other.shape, other._options, other._mask = self.shape, self._options, flags
        other._data = self._data.with_mask(flags)
        return other

    def schedule(self, levels: LevelsLike = None, *, extent: float | None = None) -> list[float]:
        """Number of diffusion steps of each level.

        Parameters
        ----------
        levels : int, Widths, Steps or Octaves, optional
            Levels as in `adwave.decompose`.
        extent : float, optional
            Share of the diagonal that the widest level reaches if no levels are given.

        Returns
        -------
        list of float
            n_1 … n_J.

        Examples
        --------
        >>> import adwave as aw
        >>> aw.Decomposer(aw.sample("sphere", vertices=500)).schedule(4)
        [1.0, 2.0, 4.0, 8.0]
        """
        checked = check_levels(levels)
        if isinstance(checked, Steps):
            return list(checked.steps)
        return self._data.schedule(checked, extent)

    def rms_widths(self, steps: Sequence[float]) -> NDArray[np.float64]:
        """Widths of levels of these numbers of steps: rms distance, in model units (hops on a graph)."""
        return np.array(self._data.sigma([float(n) for n in steps])[1:])

    def region(self, region: str) -> NDArray[np.float64]:
        """Weights of a region, (n,), in [0, 1].

        Parameters
        ----------
        region : str
            A region as on the command line, joined by ``&``, ``|`` and ``!``: ``"ball:vertex=120,radius=10%"`` or
            ``"ball:point=0 1 0,radius=0.2"``, ``"stroke:path=120 340 560,radius=2%"``,
            ``"box:min=0 0 0,max=1 1 1"``, ``"half-space:point=0 0 0,normal=0 1 0"``,
            ``"field:name=mask,low=0.5,high=1"``, ``"vertices:indices=1 2 3"``. The first four fall to 0 over
            ``falloff=…``, a length. Also ``"facing:direction=0 0 1"``, ``"component:vertex=5"``, and regions made of
            others: ``"grown:by=2%(…)"``, ``"shrunk:by=2%(…)"``, ``"blurred:by=2%(…)"``. Fields are those of the shape,
            or ``saliency``, ``mean-curvature``, ``gaussian-curvature``, ``shape-index``, ``band-3`` (the size of W₃).

        Raises
        ------
        ValueError
            If the text is not a region of this shape.
        """
        return self._data.region(region)

    def combine_bands(
        self,
        signal: SignalLike,
        factors: Sequence[float],
        steps: Sequence[float],
        *,
        accuracy: float = _native.ACCURACY,
    ) -> NDArray[np.float64]:
        """``Σ_j factors[j−1]·W_f(j)`` by a single polynomial of Φ₁, which costs less than the separate bands.

        Parameters
        ----------
        signal : str or array_like
            Signal as in `adwave.decompose`.
        factors : (J,) sequence of float
            Factor of each band, from fine to coarse.
        steps : (J,) sequence of float
            Number of steps of each level.
        accuracy : float
            Largest error relative to the bands.

        Returns
        -------
        (n,) or (n, channels) array
        """
        owner, values, is_flat = self._resolve_signal(signal)
        request = BandsRequest(values, [float(n) for n in steps], accuracy)
        total = owner._data.combine_bands(request, [float(f) for f in factors])
        return total[:, 0] if is_flat else total

    def functions(self, vertex: int, level: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Scaling function φ and wavelet ψ of one vertex on a dyadic level, as values at all vertices.

        Parameters
        ----------
        vertex : int
            Index of the vertex.
        level : int
            Dyadic level, from 1.

        Returns
        -------
        scaling_function : (n,) array
            Values ≥ 0 that sum to 1 over the welded vertices.
        wavelet : (n,) array
            Values that sum to 0.
        """
        if not 0 <= vertex < self.n_vertices:
            raise ValueError(f"vertex must be in 0..={self.n_vertices - 1}, got {vertex}")
        return self._data.vertex_functions(vertex, self.schedule(level))

    def matrix(self) -> csr_array:
        """Φ₁ as an n × n sparse matrix whose rows are ≥ 0 and sum to 1.

        Vertices are in the order of the shape. If some were welded, the matrix is over the welded vertices, and
        `vertex_map` tells which is which.
        """
        from scipy.sparse import csr_array

        return csr_array(_native.diffusion_matrix(self._data))

    def vertex_map(self) -> NDArray[np.uint32]:
        """Index of the welded vertex of each vertex of the shape, (n,)."""
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

        Row x of the j-th matrix is the function of vertex x on level j.

        Parameters
        ----------
        levels : int
            Number of dyadic levels.
        drop_tolerance : float, optional
            Entries below this are dropped.
        max_bytes : int, optional
            Largest memory for the result; more raises `MemoryError`.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

        Returns
        -------
        scaling, wavelets : lists of csr_array
            Φ_1 … Φ_J and Ψ_1 … Ψ_J in the order of the shape, or over the welded vertices if some were welded.
        """
        from scipy.sparse import csr_array

        with report_progress(progress, "multiplying") as report:
            scaling, wavelets = _native.basis_matrices(self._data, levels, drop_tolerance, max_bytes, report)
        return [csr_array(rows) for rows in scaling], [csr_array(rows) for rows in wavelets]

    def smooth(
        self,
        signal: SignalLike,
        steps: float | None = None,
        *,
        rms_width: Length | None = None,
        fwhm: Length | None = None,
        accuracy: float = _native.ACCURACY,
    ) -> NDArray[np.float64]:
        """Smooth a signal: ``Φ₁^steps f``, for any number of steps from 1/64, or by a width.

        Parameters
        ----------
        signal : str or array_like
            Signal as in `adwave.decompose`.
        steps : float, optional
            Number of steps, an integer or not.
        rms_width : float or str, optional
            Root mean square distance instead of steps, in model units or as a share of the diagonal such as ``"2%"``.
        fwhm : float or str, optional
            Full width at half maximum instead of steps.
        accuracy : float
            Largest error relative to the change.

        Returns
        -------
        (n,) or (n, channels) array

        Examples
        --------
        >>> import adwave as aw
        >>> walk = aw.Decomposer(aw.sample("sphere", vertices=500), operator="surface")
        >>> walk.smooth("z", fwhm="10%").shape
        (500,)
        """
        if [steps is None, rms_width is None, fwhm is None].count(False) != 1:
            raise ValueError("smooth takes exactly one of steps, rms_width and fwhm")
        if rms_width is not None:
            (steps,) = self.schedule(Widths(rms=[rms_width]))
        elif fwhm is not None:
            (steps,) = self.schedule(Widths(fwhm=[fwhm]))
        owner, values, is_flat = self._resolve_signal(signal)
        request = BandsRequest(values, [float(steps)], accuracy)  # type: ignore[arg-type]
        change = owner._data.combine_bands(request, [-1.0])
        smoothed = change + (self.shape.points if values is None else values)
        return smoothed[:, 0] if is_flat else smoothed

    def adjoint(self, signal: ArrayLike, steps: float, *, accuracy: float = _native.ACCURACY) -> NDArray[np.float64]:
        """``(Φ₁^steps)ᵀ g``: by reversibility ``π·Φ₁^steps(g/π)``, where π is the stationary distribution.

        Parameters
        ----------
        signal : (n,) or (n, channels) array_like
            g.
        steps : float
            Number of steps.
        accuracy : float
            Largest error relative to the change.

        Raises
        ------
        ValueError
            If the diffusion is not reversible (directed clouds, masks).
        """
        if not self._data.is_reversible() or self._mask is not None:
            raise ValueError("the adjoint needs a reversible diffusion; leave out directed and masks")
        share = self._data.welding()[1]
        values = np.asarray(signal, dtype=np.float64)
        share = share if values.ndim == 1 else share[:, None]
        return share * self.smooth(values / share, steps, accuracy=accuracy)

    def linear_operator(self, steps: float = 1.0, *, accuracy: float = _native.ACCURACY) -> LinearOperator:
        """``Φ₁^steps`` as a `scipy.sparse.linalg.LinearOperator` with its adjoint.

        Parameters
        ----------
        steps : float
            Number of steps, an integer or not.
        accuracy : float
            Largest error relative to the change.

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

        def backward(x: NDArray[np.float64]) -> NDArray[np.float64]:
            return self.adjoint(x.reshape(n, -1), steps, accuracy=accuracy).reshape(x.shape)

        # The untyped class returns an instance of another class here.
        factory: Any = LinearOperator
        return factory((n, n), matvec=forward, rmatvec=backward, matmat=forward, rmatmat=backward, dtype=np.float64)

    def _resolve_signal(self: _Prepared, signal: SignalLike) -> tuple[_Prepared, NDArray[np.float64] | None, bool]:
        """Owner of the signal (masked where it is NaN), its n × channels values (None: coordinates), whether it was 1-D."""
        values, is_flat = self._signal_values(signal)
        if values is None:
            return self, None, is_flat
        return self._masked_where(np.atleast_1d(np.isnan(values).any(axis=1))), values, is_flat

    def _signal_values(self, signal: SignalLike) -> tuple[NDArray[np.float64] | None, bool]:
        """The n × channels values of a signal (None: coordinates), and whether it was 1-D."""
        if signal is None or (isinstance(signal, str) and signal == "coords"):
            return None, False
        if isinstance(signal, str):
            values = self.shape._data.signal(signal)
            return values, values.shape[1] == 1
        return _adapt.values_array(signal, self.n_vertices), np.ndim(signal) == 1

    def _masked_where(self: _Prepared, missing: NDArray[np.bool_]) -> _Prepared:
        """Copy without the vertices where a signal is missing, unless it has a mask already."""
        return self.with_mask(missing) if missing.any() and self._mask is None else self

    def __repr__(self) -> str:
        return f"<adwave.{type(self).__name__}: {self.operator} on {self.shape!r}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (type(self), self.shape, self._options, self._mask)


def _restore(kind: type[_Prepared], shape: Shape, options: Operator, mask: NDArray[np.bool_] | None) -> _Prepared:
    prepared = kind(shape, operator=options)
    return prepared if mask is None else prepared.with_mask(mask)
