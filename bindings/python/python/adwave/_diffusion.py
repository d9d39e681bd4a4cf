"""`PreparedShape`: a shape with its diffusion operator, and what the operator gives on its own."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._caller import Call, public, warn
from adwave._grid_objects import is_image
from adwave._layout import Layout, coordinates, float_type, region_weights, signal_values, without_unknown
from adwave._methods import Carrier
from adwave._misfit import line_with, working_line
from adwave._option_rules import wrap_grid
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
    check_steps,
)
from adwave._own_operator import GivenOperator, LaplacianLike
from adwave._progress import ProgressLike, report_progress
from adwave._shape import Shape, as_shape

if TYPE_CHECKING:
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import LinearOperator

#: Share of the diagonal up to which levels go if none are given: of bands, of features, of a signed saliency map.
EXTENT = _native.EXTENT

_Prepared = TypeVar("_Prepared", bound="PreparedShape")


def _prepare_grid(call: Call) -> None:
    """The call of a constructor on an image as that of a grid."""
    wrap_grid(call)
    call.function, call.arguments, call.keywords = f"{call.arguments[0]}.prepare", [], {}


class PreparedShape(Carrier):
    """A shape with its diffusion operator Φ₁; `adwave.Decomposer` adds the bands."""

    __slots__ = ("__weakref__", "_by_width", "_data", "_given_walk", "_last_masked", "_mask", "_options", "shape")

    shape: Shape

    @public()
    def __init__(self, shape: object, *, operator: OperatorLike = None, progress: ProgressLike = None) -> None:
        if is_image(shape):
            line = working_line("Decomposer", _prepare_grid, "aw.grid(image).prepare()")
            raise TypeError(f"shape: an image is a grid{line}")
        self.shape = as_shape(shape)
        self._options: Operator = as_operator(operator)
        with report_progress(progress, "preparing") as report:
            self._data = _native.Prepared(self.shape._data, self._options.with_default_kind("walk"), report)
        self._mask: NDArray[np.bool_] | None = None
        self._given_walk: Any = None
        self._by_width: Any = None
        self._last_masked: Any = None

    def for_levels(self: _Prepared, levels: LevelsLike, *, analysis: bool = False) -> _Prepared:
        """This shape with the operator that suits these levels, unless it was prepared with one: heat for widths.

        The second operator is prepared when it is first needed.

        Parameters
        ----------
        levels : int, Widths, Steps or Octaves, optional
            Levels as in `adwave.decompose`.
        analysis : bool
            True for saliency and features: heat for all levels of a mesh, so that its triangles do not matter.

        Examples
        --------
        >>> import adwave as aw
        >>> prepared = aw.Decomposer(aw.sample("sphere", vertices=500))
        >>> prepared.for_levels(4).operator, prepared.for_levels(aw.Widths(fwhm=[0.2])).operator
        ('walk', 'surface')
        """
        needs_surface = isinstance(levels, Widths) or (analysis and self.shape.kind == "mesh")
        if not needs_surface or not self.chooses_operator:
            return self
        if self._by_width is None:
            other = type(self)(self.shape, operator=self._options.with_default_kind("surface"))
            self._by_width = other if self._mask is None else other.with_mask(self._mask)
        return self._by_width

    @property
    def chooses_operator(self) -> bool:
        """True if each request chooses the operator that suits its levels, because none was given."""
        return self._given_walk is None and self._options.kind is None and not self._options.needs_walk()

    @property
    def n_vertices(self) -> int:
        """Number of vertices of the shape."""
        return self._data.n_vertices

    @property
    def operator(self) -> str:
        """Kind of the diffusion operator, ``'walk'`` or ``'surface'``; see also `for_levels`."""
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
    def spectral_range(self) -> float:
        """Largest eigenvalue that the Laplacian can have: 2 for a walk, and for heat one over the square of a length."""
        return _native.spectral_range(self._data)

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
        other._given_walk = self._given_walk
        other._by_width = other._last_masked = None
        other._data = self._data.with_mask(flags)
        return other

    def with_walk(self: _Prepared, walk: Any) -> _Prepared:
        """Shape with the given walk as its diffusion: a step of the walk is a step of the bands.

        Parameters
        ----------
        walk : Walk
            A walk with a node for each vertex and rows that sum to 1.

        Raises
        ------
        ValueError
            If the walk has another number of nodes or another normalization.

        Examples
        --------
        >>> import adwave as aw
        >>> pair = aw.Decomposer(aw.graph(2, [[0, 1]])).with_walk(aw.walk([[0, 1], [1, 0]]))
        >>> pair.decompose([1.0, 3.0], levels=1).scaling(1)
        array([3., 1.])
        """
        return self._with_given(walk)

    def with_operator(
        self: _Prepared,
        laplacian: LaplacianLike,
        *,
        reversible: bool = True,
        step_length: float = 1.0,
        weights: ArrayLike | None = None,
        masked: Callable[[NDArray[np.bool_]], LaplacianLike] | None = None,
    ) -> _Prepared:
        """Shape with a diffusion of one's own that stores no rows: Φ₁ = I − L.

        The shape says where its vertices are, which are neighbors, and how large they are; the function says how a
        signal diffuses.

        Parameters
        ----------
        laplacian : LinearOperator or callable
            L, with ``@``, or as a function of an (n, channels) array, whose order of vertices is that of the shape. A row
            of L is best a sum of differences, which keeps constants to the last bit.
        reversible : bool
            Whether ``weights[x] * L[x, y] == weights[y] * L[y, x]``, with eigenvalues of L in [0, 1]. If not, the operator
            is applied step by step, in whole steps.
        step_length : float
            Root mean square length of a step, in model units, from which widths follow.
        weights : (n,) array_like, optional
            Stationary distribution, > 0; uniform by default.
        masked : callable, optional
            Function of (n,) flags that returns L without the flagged vertices. Masks and NaN need it.

        Raises
        ------
        TypeError
            If L is neither a function nor an operator.
        ValueError
            If L has another number of rows, does not keep constants, or is not reversible although it should be.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> n = 64
        >>> ring = aw.graph(n, [(i, (i + 1) % n) for i in range(n)])
        >>> own = aw.Decomposer(ring).with_operator(
        ...     lambda x: ((x - np.roll(x, 1, 0)) + (x - np.roll(x, -1, 0))) / 4
        ... )
        >>> wave = np.cos(2 * np.pi * np.arange(n) / n)  # an eigenvector, to cos²(π/n)
        >>> np.allclose(own.decompose(wave, levels=1).scaling(1), np.cos(np.pi / n) ** 2 * wave)
        True
        """
        return self._with_given(GivenOperator(laplacian, reversible, step_length, weights, masked))

    def _with_given(self: _Prepared, given: Any) -> _Prepared:
        """Shape with a walk or an operator of one's own in place of its own."""
        other = type(self).__new__(type(self))
        other.shape, other._options, other._mask, other._given_walk = self.shape, self._options, None, given
        other._by_width = other._last_masked = None
        replace = getattr(type(given), "replace_operator", None)
        other._data = self._data.with_walk(given._data) if replace is None else replace(given, self._data)
        return other if self._mask is None else other.with_mask(self._mask)

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

        Raises
        ------
        ValueError
            If levels are widths and the shape was prepared without an operator, on which their steps depend.

        Examples
        --------
        >>> import adwave as aw
        >>> aw.Decomposer(aw.sample("sphere", vertices=500)).schedule(4)
        [1.0, 2.0, 4.0, 8.0]
        """
        checked = check_levels(levels)
        if isinstance(checked, Steps):
            return list(checked.steps)
        if isinstance(checked, Widths) and self.chooses_operator:
            raise ValueError(
                "levels: the steps of a width depend on the operator, and none was given; prepare the shape with one, "
                "aw.Decomposer(shape, operator='surface')"
            )
        steps = self._data.schedule(checked, extent)
        widest = float(self.measure_widths(steps)[-1]) if isinstance(checked, Widths) else 0.0
        if 0 < self.extent < widest:
            warn(
                f"levels: an rms width of {widest:.4g} is larger than the shape, whose diagonal is {self.extent:.4g}, and "
                "flattens it; give widths in the unit of the points, or in % of the diagonal, as in fwhm='2%'"
            )
        return steps

    def measure_widths(self, steps: Sequence[float]) -> NDArray[np.float64]:
        """Widths of levels of these numbers of steps: rms distance, in model units (hops on a graph)."""
        return np.array(self._data.sigma([float(n) for n in steps])[1:])

    def rms_widths(self, steps: Sequence[float]) -> NDArray[np.float64]:
        """Former name of `measure_widths`."""
        warn("Decomposer.rms_widths is now Decomposer.measure_widths", DeprecationWarning)
        return self.measure_widths(steps)

    def region(self, region: str | ArrayLike) -> NDArray[np.float64]:  # type: ignore[override]
        """Weights of a region, (n,), in [0, 1].

        Parameters
        ----------
        region : str or array_like
            A weight or flag for each vertex, indices of vertices, or a region as on the command line, joined by ``&``, ``|``
            and ``!``: ``"ball:vertex=120,radius=10%"`` or
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
        if not isinstance(region, str):
            return region_weights(region, self.n_vertices, "region")
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
        given, weights = check_steps(steps), [float(f) for f in factors]
        values, layout = self._signal_values(signal)

        def combine(owner: PreparedShape, values: NDArray[np.float64] | None, _: list[int]) -> NDArray[np.float64]:
            return owner._data.combine_bands(BandsRequest(values, given, accuracy), weights)

        return layout.arrange(self._map_channels(values, combine))

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

    def matrix(self, *, lazy: bool = True) -> csr_array:
        """Φ₁ as an n × n sparse matrix whose rows are ≥ 0 and sum to 1.

        Vertices are in the order of the shape. If some were welded, the matrix is over the welded vertices, and
        `vertex_map` tells which is which. The diagonal of given weights is not used, and the edges of a point cloud's
        nearest neighbors go both ways unless ``directed``.

        Parameters
        ----------
        lazy : bool
            The walk of the bands, Φ₁ = ½(I + Q), whose eigenvalues are in [0, 1], stays where it is half of the time.
            False for Q, the walk that always steps: ``D⁻¹A`` of a graph with weights A.

        Raises
        ------
        ValueError
            If the operator is heat on the surface, and no walk is asked for.

        Examples
        --------
        >>> import adwave as aw
        >>> walk = aw.Decomposer(aw.graph(3, [[0, 1], [1, 2]]))
        >>> walk.matrix(lazy=False).toarray()
        array([[0. , 1. , 0. ],
               [0.5, 0. , 0.5],
               [0. , 1. , 0. ]])
        """
        from scipy.sparse import csr_array, identity

        step: Any = csr_array(_native.diffusion_matrix(self._data))
        if lazy:
            return step
        if self.operator != "walk":
            raise ValueError("lazy: heat on the surface is no walk; prepare the shape with operator='walk'")
        walk = csr_array(2 * step - identity(step.shape[0], format="csr"))
        walk.eliminate_zeros()
        return walk

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

    @public()
    def smooth(  # type: ignore[override]
        self,
        signal: SignalLike = None,
        steps: float | None = None,
        *,
        rms: Length | None = None,
        fwhm: Length | None = None,
        lazy: bool = True,
        accuracy: float = _native.ACCURACY,
        progress: ProgressLike = None,
    ) -> NDArray[np.float64]:
        """Smooth a signal: ``Φ₁^steps f``, for any number of steps from 1/64, or by a width.

        Unless the shape was prepared with an operator, widths are those of heat on the surface and steps those of the
        walk. Between whole numbers of steps the walk may leave the range of the signal by a few percent; heat never does.

        Parameters
        ----------
        signal : str or array_like, optional
            Signal as in `adwave.decompose`; the coordinates by default.
        steps : float, optional
            Number of steps, an integer or not.
        rms : float or str, optional
            Root mean square distance instead of steps, in model units or as a share of the diagonal such as ``"2%"``.
        fwhm : float or str, optional
            Full width at half maximum instead of steps.
        lazy : bool
            False for steps of the walk that always moves, ``Q^steps f``; see `matrix`. Steps must be whole.
        accuracy : float
            Largest error relative to the change.
        progress : bool or callable, optional
            ``True`` for a bar, or a function of (done, total).

        Returns
        -------
        array like the signal

        Examples
        --------
        >>> import adwave as aw
        >>> prepared = aw.Decomposer(aw.sample("sphere", vertices=500))
        >>> prepared.smooth("z", fwhm="10%").shape
        (500,)
        """
        levels = smoothing_levels(steps, rms, fwhm)
        owner = self.for_levels(levels)
        if not lazy:
            return owner._walk(signal, levels).astype(float_type(signal), copy=False)
        return owner._smooth(signal, owner.schedule(levels), accuracy, progress).astype(float_type(signal), copy=False)

    def _smooth(
        self, signal: SignalLike, steps: Sequence[float], accuracy: float, progress: ProgressLike = None
    ) -> NDArray[np.float64]:
        values, layout = self._signal_values(signal)
        with report_progress(progress, "smoothing") as report:

            def smooth(owner: PreparedShape, values: NDArray[np.float64] | None, _: list[int]) -> NDArray[np.float64]:
                change = owner._data.combine_bands(BandsRequest(values, steps, accuracy), [-1.0], report)
                change += self.shape.points if values is None else values
                return change

            return layout.arrange(self._map_channels(values, smooth))

    def _walk(self, signal: SignalLike, levels: LevelsLike) -> NDArray[np.float64]:
        """``Q^steps f`` with the walk that always moves."""
        steps = levels.steps[0] if isinstance(levels, Steps) else 0.5
        if steps != int(steps):
            raise ValueError("lazy: the walk that always moves takes whole steps, such as steps=3, lazy=False")
        values, layout = self._signal_values(signal)

        def walk(owner: PreparedShape, values: NDArray[np.float64] | None, _: list[int]) -> NDArray[np.float64]:
            given = self.shape.points if values is None else np.nan_to_num(values)
            matrix: Any = owner.matrix(lazy=False)
            n = matrix.shape[0]
            # Vertices are in the order of the shape, unless some are welded.
            place = owner.vertex_map() if n < self.n_vertices else np.arange(n)
            now = np.stack([np.bincount(place, column, n) for column in given.T], axis=1)
            now /= np.bincount(place, minlength=n)[:, None]
            for _step in range(int(steps)):
                now = matrix @ now
            result = now[place]
            if owner.mask is not None:
                result[owner.mask] = np.nan
            return result

        return layout.arrange(self._map_channels(values, walk))

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
        share = self._data.welding()[1][:, None]
        values, layout = signal_values(signal, self.n_vertices)
        return layout.arrange(share * self.smooth(values / share, steps, accuracy=accuracy))

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

    @property
    def _sizes(self) -> tuple[int, ...]:
        """Sizes of a grid, whose axes weights may have; none for a shape."""
        return ()

    def _own_signal(self) -> SignalLike:
        """The signal that this is prepared with, which functions take by default; None for the coordinates."""
        return None

    def _outsiders(self) -> NDArray[np.bool_] | None:
        """Places of a grid outside of its mask; none of a shape."""
        return None

    def _by_place(self) -> Layout:
        """Axes of one number for each vertex."""
        return Layout(self.n_vertices)

    def _resolve_signal(self: _Prepared, signal: SignalLike) -> tuple[_Prepared, NDArray[np.float64] | None, Layout]:
        """Owner of the signal (masked where a channel is NaN), its n × channels values (None: coordinates), its axes."""
        values, layout = self._signal_values(signal)
        if values is None or math.isfinite(values.sum()):
            return self, values, layout
        return self._masked_where(np.atleast_1d(np.isnan(values).any(axis=1))), values, layout

    def _signal_values(self, signal: SignalLike) -> tuple[NDArray[np.float64] | None, Layout]:
        """The n × channels values of a signal (None: coordinates), and its axes."""
        if signal is None or (isinstance(signal, str) and signal == "coords"):
            return None, coordinates(self.n_vertices)
        if isinstance(signal, str):
            values = without_unknown(self.shape._data.signal(signal), signal)
            return values, Layout(self.n_vertices, () if values.shape[1] == 1 else (values.shape[1],))
        values, layout = signal_values(signal, self.n_vertices)
        # A masked array says itself what is unknown.
        return values if isinstance(signal, np.ma.MaskedArray) else without_unknown(values), layout

    def _channel_groups(
        self: _Prepared, values: NDArray[np.float64] | None
    ) -> list[tuple[_Prepared, NDArray[np.float64] | None, list[int]]]:
        """Channels that are NaN at the same vertices, with this shape masked there; without those that are NaN all over.

        A single channel without any value is an error of the extension.
        """
        if values is None:
            return [(self, None, [0, 1, 2])]
        n_channels = values.shape[1]
        if n_channels == 0 or math.isfinite(values.sum()):
            return [(self, values, list(range(n_channels)))]
        groups: list[tuple[_Prepared, NDArray[np.float64] | None, list[int]]] = []
        for channels, missing in _native.channels_by_mask(values):
            owner = self if missing is None else self._masked_where(missing)
            part = values if len(channels) == n_channels else np.ascontiguousarray(values[:, channels])
            groups.append((owner, part, channels))
        return groups

    def _map_channels(
        self: _Prepared,
        values: NDArray[np.float64] | None,
        compute: Callable[[_Prepared, NDArray[np.float64] | None, list[int]], NDArray[np.float64]],
    ) -> NDArray[np.float64]:
        """New values of (…, n, channels), computed together for channels that are NaN at the same vertices.

        `compute` takes the masked shape, the values of some channels, and their indices. Channels without any value stay
        as they are.
        """
        groups = self._channel_groups(values)
        if values is None or (len(groups) == 1 and len(groups[0][2]) == values.shape[1]):
            return compute(*groups[0])
        result: NDArray[np.float64] | None = None
        for owner, part, channels in groups:
            found = compute(owner, part, channels)
            if result is None:
                result = np.full((*found.shape[:-1], values.shape[1]), np.nan)
            result[..., channels] = found
        assert result is not None
        return result

    def _masked_where(self: _Prepared, missing: NDArray[np.bool_]) -> _Prepared:
        """Copy without the vertices where a signal is missing, unless it has a mask already."""
        if self._mask is not None or not missing.any():
            return self
        # Signals of one study have their gaps in common, and building a masked operator takes longer than using it.
        last = self._last_masked
        if last is None or not np.array_equal(last._mask, missing):
            last = self._last_masked = self.with_mask(missing)
        return last

    def __repr__(self) -> str:
        operator = f"{self.operator} (surface for widths)" if self.chooses_operator else self.operator
        return f"<adwave.{type(self).__name__}: {operator} on {self.shape!r}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (type(self), self.shape, self._options, self._mask, self._given_walk)


def smoothing_levels(
    steps: float | None, rms: Length | Sequence[float] | None, fwhm: Length | Sequence[float] | None
) -> Steps | Widths:
    """The single level of a smoothing.

    Raises
    ------
    ValueError
        If not exactly one measure is given, it has several widths, or `steps` is none.
    """
    given = {name: value for name, value in (("steps", steps), ("rms", rms), ("fwhm", fwhm)) if value is not None}
    if len(given) != 1:
        found = " and ".join(given) or "none"
        if given:
            raise ValueError(f'smooth takes one of fwhm=8, rms="2%" and steps=3, got {found}; leave one out')
        line = line_with("smooth", steps="3")
        raise ValueError(f'smooth takes one of fwhm=8, rms="2%" and steps=3, got {found}{line}')
    if steps is not None:
        return Steps(check_steps([steps]))
    widths = rms if fwhm is None else fwhm
    if isinstance(widths, (str, int, float, np.number)):
        widths = [widths]  # type: ignore[list-item]
    if np.size(widths) != 1:  # type: ignore[arg-type]

        def split(call: Call) -> None:
            call.function = f"{call.prefix}decompose"
            if "rms" in call.keywords:
                call.keywords["levels"] = f"{call.package}Widths(rms={call.keywords.pop('rms')})"

        line = working_line("smooth", split, "aw.decompose(shape, f, fwhm=[2, 4])")
        raise ValueError(f"smooth takes one width, got {np.size(widths)}; bands between several{line}")  # type: ignore[arg-type]
    return Widths(rms=None, fwhm=widths) if fwhm is not None else Widths(rms=widths)


def _restore(
    kind: type[_Prepared],
    shape: Shape,
    options: Operator,
    mask: NDArray[np.bool_] | None,
    walk: Any = None,
) -> _Prepared:
    prepared = kind(shape, operator=options)
    if walk is not None:
        prepared = prepared._with_given(walk)
    return prepared if mask is None else prepared.with_mask(mask)
