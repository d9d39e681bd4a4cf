"""`VectorField` and `TensorField`: directions and symmetric tensors, compared in the tangent planes of a surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._decomposer import Decomposer, GainsLike, Where, as_domain, prepare_decomposer
from adwave._denoise import DenoiseResult, denoise
from adwave._denoise_info import DenoiseInfo
from adwave._diffusion import smoothing_levels
from adwave._methods import Members
from adwave._options import Length, LevelsLike, OperatorLike, Widths, as_operator
from adwave._progress import ProgressLike, report_progress
from adwave._shape import as_shape

_Floats = NDArray[np.float64]

Symmetry = Literal[1, 2, 4]
TensorOrder = Literal["upper", "lower", "diagonal"]

#: Place in `_ORDERS[name]` of xx, xy, xz, yy, yz, zz.
_ORDERS: dict[str, list[int]] = {
    "upper": [0, 1, 2, 3, 4, 5],
    "lower": [0, 1, 3, 2, 4, 5],
    "diagonal": [0, 3, 4, 1, 5, 2],
}
#: Row and column of xx, xy, xz, yy, yz, zz.
_ROWS, _COLUMNS = [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]


class Singularities(NamedTuple):
    """Triangles around which a field of directions turns.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> ball = aw.sample("sphere", vertices=1000)
    >>> found = aw.vectors(ball, np.cross([0, 0, 1], ball.points)).singularities()
    >>> found.indices.tolist(), [round(abs(p[2])) for p in found.points]  # one turn around each pole
    ([1.0, 1.0], [1, 1])
    """

    #: Numbers of the triangles.
    triangles: NDArray[np.intp]
    #: Their centers, (k, 3), in model units.
    points: _Floats
    #: Numbers of turns, multiples of 1/s; on a closed surface they sum to its Euler characteristic.
    indices: _Floats

    def __repr__(self) -> str:
        return f"<adwave.Singularities: {len(self.indices)} triangles, indices sum to {self.indices.sum():g}>"


@dataclass(frozen=True)
class _Directions:
    """The operator of directions, in place of that of a shape."""

    order: int

    def replace_operator(self, data: _native.Prepared) -> _native.Prepared:
        return _native.DirectionsData(data, self.order).to_prepared(data)


class VectorField(Members):
    """Tangent vectors, lines or crosses on a mesh or a point cloud; `adwave.vectors` makes it.

    A direction at a vertex is a complex number in its tangent plane, ``|v|·exp(i·s·θ)``, with s = 1 for vectors, 2 for lines
    (v and −v are the same) and 4 for crosses. On its way to a neighbor it turns with the surface, so that directions are
    compared, not coordinates (`knoppel2013`). All methods return new fields.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> ball = aw.sample("sphere", vertices=1000)
    >>> wind = np.cross([0, 0, 1], ball.points) + 0.3 * np.random.default_rng(0).normal(size=(1000, 3))
    >>> field = aw.vectors(ball, wind)
    >>> smooth = field.smooth(fwhm=0.5)
    >>> smooth.values.shape, len(smooth.singularities().indices)
    ((1000, 3), 2)
    """

    __slots__ = ("_channels", "_data", "decomposer", "normal", "normal_share")

    #: The surface with the operator of directions, for signals of two numbers for each vector.
    decomposer: Decomposer
    #: Parts of the given vectors along the normals, (n,), which take no part.
    normal: _Floats
    #: Share of their squares that lies along the normals, 0 to 1.
    normal_share: float
    _data: _native.DirectionsData
    _channels: _Floats

    @classmethod
    def _from_vectors(cls, owner: Decomposer, vectors: _Floats, symmetry: int, progress: ProgressLike) -> VectorField:
        field = cls.__new__(cls)
        with report_progress(progress, "preparing") as report:
            field._data = _native.DirectionsData(owner._data, symmetry, report)
        field.decomposer = owner._with_given(_Directions(symmetry))
        field._channels, field.normal, field.normal_share = field._data.split(vectors)
        return field

    def _with_channels(self, channels: _Floats) -> VectorField:
        other = type(self).__new__(type(self))
        other._data, other.decomposer = self._data, self.decomposer
        other._channels = np.ascontiguousarray(channels)
        other.normal, other.normal_share = np.zeros(len(channels)), 0.0
        return other

    @property
    def symmetry(self) -> int:
        """Order s of the symmetry: 1 for vectors, 2 for lines, 4 for crosses."""
        given: Any = self.decomposer._given_walk
        return given.order

    @property
    def values(self) -> _Floats:
        """Tangent vectors, (n, 3); of a line or a cross one of the directions that are the same."""
        return self._data.join(self._channels)

    @property
    def complex(self) -> NDArray[np.complex128]:
        """Complex numbers ``|v|·exp(i·s·θ)`` in the tangent planes, (n,); θ counts from ``planes[:, 0]``."""
        return self._channels.view(np.complex128)[:, 0]

    @property
    def lengths(self) -> _Floats:
        """Lengths of the vectors, (n,)."""
        return np.abs(self.complex)

    @property
    def planes(self) -> _Floats:
        """Two orthogonal unit vectors in each tangent plane, (n, 2, 3)."""
        return self._data.planes().reshape(-1, 2, 3)

    def from_complex(self, numbers: ArrayLike) -> VectorField:
        """A field of the same surface from complex numbers in the tangent planes.

        Parameters
        ----------
        numbers : (n,) array_like of complex
            Such as a band of `decompose`.
        """
        given = np.ascontiguousarray(numbers, dtype=np.complex128)
        if given.shape != (len(self._channels),):
            raise ValueError(f"numbers must have shape ({len(self._channels)},), got {given.shape}")
        return self._with_channels(given.view(np.float64).reshape(-1, 2))

    def smooth(
        self,
        steps: float | None = None,
        *,
        rms: Length | None = None,
        fwhm: Length | None = None,
        accuracy: float = _native.ACCURACY,
        progress: ProgressLike = None,
    ) -> VectorField:
        """Smooth the directions by one width or number of steps.

        Parameters
        ----------
        steps : float, optional
            Number of steps of the diffusion.
        rms, fwhm : float or str, optional
            A width instead, in model units or as a share of the diagonal such as ``"2%"``.
        accuracy : float
            Largest error relative to the change.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
        """
        owner = self.decomposer
        schedule = owner.schedule(smoothing_levels(steps, rms, fwhm))
        return self._with_channels(owner._smooth(self._channels, schedule, accuracy, progress))

    def decompose(
        self, *, levels: LevelsLike = None, accuracy: float = _native.ACCURACY, progress: ProgressLike = None
    ) -> NDArray[np.complex128]:
        """Bands from fine to coarse and the rest, (J + 1) × n complex numbers in the tangent planes, which sum to `complex`.

        Parameters
        ----------
        levels : int, Widths, Steps or Octaves, optional
            Levels as in `adwave.decompose`.
        accuracy : float
            Largest error of a band relative to the band, 1e-13 to 0.1.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> ball = aw.sample("sphere", vertices=500)
        >>> field = aw.vectors(ball, ball.points[:, [1, 2, 0]])
        >>> bands = field.decompose(levels=4)
        >>> bands.shape, bool(np.allclose(bands.sum(axis=0), field.complex))
        ((5, 500), True)
        >>> field.from_complex(bands[-1]).values.shape  # the coarsest as vectors
        (500, 3)
        """
        bands = self.decomposer.decompose(self._channels, levels=levels, accuracy=accuracy, progress=progress)
        return np.ascontiguousarray(bands.array).view(np.complex128)[..., 0]

    def filter(
        self,
        gains: GainsLike,
        *,
        where: Where = None,
        levels: LevelsLike = None,
        accuracy: float = _native.ACCURACY,
        progress: ProgressLike = None,
    ) -> VectorField:
        """Multiply the bands by gains, everywhere or in a region.

        Parameters
        ----------
        gains : sequence of float, str or Layer
            A gain for each band, fine to coarse, or the name of a preset.
        where : str or array_like, optional
            A region in its text form, or a weight for each vertex.
        levels : int, Widths, Steps or Octaves, optional
            By default one level for each gain.
        accuracy : float
            Largest error of a band relative to the band.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
        """
        return self._with_channels(_filter(self.decomposer, self._channels, gains, where, levels, accuracy, progress))

    def denoise(
        self, *, strength: float = 1.0, noise: float | None = None, progress: ProgressLike = None
    ) -> DenoiseResult[VectorField]:
        """Remove noise without tuning: what arrives from a neighbor is turned on its way, and jumps stay.

        Parameters
        ----------
        strength : float
            Factor of the noise: below 1 more careful, above 1 more thorough.
        noise : float, optional
            Standard deviation of the noise of each of the two numbers of `complex`, if it is known.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

        Returns
        -------
        DenoiseResult
            The field, and the estimates as for a signal in `adwave.denoise`.

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> ball = aw.sample("sphere", vertices=2000)
        >>> wind = np.cross([0, 0, 1], ball.points)
        >>> noisy = wind + 0.3 * np.random.default_rng(0).normal(size=(2000, 3))
        >>> calm, info = aw.vectors(ball, noisy).denoise()
        >>> round(info["noise"], 1), bool(np.abs(calm.values - wind).mean() < 0.05)
        (0.3, True)
        """
        found, info = denoise(self.decomposer, self._channels, strength=strength, noise=noise, progress=progress)
        return DenoiseResult(self._with_channels(found), info)

    def singularities(self, *, progress: ProgressLike = None) -> Singularities:
        """Triangles around which the field turns, with the numbers of turns.

        Parameters
        ----------
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

        Raises
        ------
        ValueError
            Unless the shape is a mesh whose edges have at most two triangles with one orientation.
        """
        with report_progress(progress, "counting") as report:
            triangles, points, indices = self._data.singularities(self._channels, report)
        return Singularities(np.array(triangles, dtype=np.intp), points, indices)

    def __repr__(self) -> str:
        noun = {1: "vectors", 2: "lines", 4: "crosses"}[self.symmetry]
        return f"<adwave.VectorField: {len(self._channels)} {noun}>"


class TensorField(Members):
    """Symmetric tensors on a surface or a grid; `adwave.tensors` makes it.

    On a surface a tensor is the trace of its part in the tangent plane, a scalar, and the line of its larger principal
    direction. On a grid it is the matrix logarithm (log-Euclidean), so that tensors stay positive definite and
    ``log det`` diffuses as a scalar (`arsigny2006`).

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> size = np.random.default_rng(0).uniform(1, 3, (8, 8, 8, 1))
    >>> D = np.concatenate([3 * size, 0 * size, 0 * size, size, 0 * size, size], axis=-1)  # xx, xy, xz, yy, yz, zz
    >>> smooth = aw.tensors(aw.grid(size[..., 0], spacing=2.0), D).smooth(fwhm=6)
    >>> smooth.values.shape, bool(np.linalg.eigvalsh(smooth.matrices).min() > 0)
    ((8, 8, 8, 6), True)
    """

    __slots__ = ("_lines", "_order", "_owner", "_shape", "_values", "n_not_positive", "normal_share")

    #: Number of tensors of a grid that are not positive definite, which are masked.
    n_not_positive: int
    #: Share of the squares outside the tangent planes of a surface, which takes no part.
    normal_share: float
    _order: str
    _owner: Decomposer
    #: Of a surface the lines without values; None on a grid.
    _lines: VectorField | None
    #: Scalars that diffuse, n × 6 logarithms on a grid, n × 3 (trace and line) on a surface.
    _values: _Floats
    _shape: tuple[int, ...]

    @classmethod
    def _from_upper(cls, owner: Decomposer, tensors: _Floats, order: str, shape: tuple[int, ...]) -> TensorField:
        field = cls.__new__(cls)
        field._owner, field._order, field._shape = owner, order, shape
        field.n_not_positive, field.normal_share, field._lines = 0, 0.0, None
        if owner._sizes:
            field._values, field.n_not_positive = _native.tensor_logarithms(tensors)
        else:
            nothing = np.zeros((len(tensors), 3))
            field._lines = VectorField._from_vectors(owner, nothing, 2, None)
            trace, lines, field.normal_share = field._lines._data.split_tensors(tensors)
            field._values = np.column_stack([trace, lines])
        return field

    def _with_values(self, values: _Floats) -> TensorField:
        other = type(self).__new__(type(self))
        other._owner, other._order, other._shape, other._lines = self._owner, self._order, self._shape, self._lines
        other._values, other.n_not_positive, other.normal_share = values, self.n_not_positive, 0.0
        return other

    @property
    def _upper(self) -> _Floats:
        if self._lines is None:
            return _native.tensor_exponentials(np.ascontiguousarray(self._values))
        lines = np.ascontiguousarray(self._values[:, 1:])
        return self._lines._data.join_tensors(self._values[:, 0].tolist(), lines)

    def _ordered(self, upper: _Floats) -> _Floats:
        """Components xx, xy, xz, yy, yz, zz of each tensor in the order in which the tensors were given."""
        out = np.empty_like(upper)
        out[:, _ORDERS[self._order]] = upper
        return out.reshape(*self._shape, 6)

    @property
    def values(self) -> _Floats:
        """Six components of each tensor, in the order in which they were given; NaN where a tensor was masked."""
        return self._ordered(self._upper)

    @property
    def matrices(self) -> _Floats:
        """The tensors as symmetric matrices, (…, 3, 3)."""
        upper = self._upper
        out = np.empty((len(upper), 3, 3))
        out[:, _ROWS, _COLUMNS] = out[:, _COLUMNS, _ROWS] = upper
        return out.reshape(*self._shape, 3, 3)

    def smooth(
        self,
        steps: float | None = None,
        *,
        rms: Length | None = None,
        fwhm: Length | None = None,
        accuracy: float = _native.ACCURACY,
        progress: ProgressLike = None,
    ) -> TensorField:
        """Smooth the tensors by one width or number of steps.

        Parameters
        ----------
        steps : float, optional
            Number of steps of the diffusion.
        rms, fwhm : float or str, optional
            A width instead, in model units or as a share of the diagonal such as ``"2%"``.
        accuracy : float
            Largest error relative to the change.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
        """
        levels = smoothing_levels(steps, rms, fwhm)

        def smooth(owner: Decomposer, values: _Floats) -> _Floats:
            return owner._smooth(values, owner.schedule(levels), accuracy, progress)

        return self._with_values(self._map(smooth))

    def filter(
        self,
        gains: GainsLike,
        *,
        where: Where = None,
        levels: LevelsLike = None,
        accuracy: float = _native.ACCURACY,
        progress: ProgressLike = None,
    ) -> TensorField:
        """Multiply the bands of the tensors by gains, everywhere or in a region.

        Parameters
        ----------
        gains : sequence of float, str or Layer
            A gain for each band, fine to coarse, or the name of a preset.
        where : str or array_like, optional
            A region in its text form, or a weight for each place.
        levels : int, Widths, Steps or Octaves, optional
            By default one level for each gain.
        accuracy : float
            Largest error of a band relative to the band.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
        """

        def apply(owner: Decomposer, values: _Floats) -> _Floats:
            return _filter(owner, values, gains, where, levels, accuracy, progress)

        return self._with_values(self._map(apply))

    def decompose(
        self, *, levels: LevelsLike = None, accuracy: float = _native.ACCURACY, progress: ProgressLike = None
    ) -> _Floats:
        """Bands from fine to coarse and the rest, (J + 1) × the shape of `values`.

        On a surface they are tensors, which sum to the parts in the tangent planes. On a grid they are bands of the
        logarithms, which sum to the logarithms.

        Parameters
        ----------
        levels : int, Widths, Steps or Octaves, optional
            Levels as in `adwave.decompose`.
        accuracy : float
            Largest error of a band relative to the band, 1e-13 to 0.1.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

        Examples
        --------
        >>> import adwave as aw, numpy as np
        >>> torus = aw.sample("torus", vertices=800)
        >>> strain = aw.tensors(torus, np.random.default_rng(0).normal(size=(torus.n_vertices, 6)))
        >>> bands = strain.decompose(levels=3)
        >>> bands.shape, bool(np.allclose(bands.sum(axis=0), strain.values))
        ((4, 800, 6), True)
        """

        def bands(owner: Decomposer, values: _Floats) -> _Floats:
            found = owner.decompose(values, levels=levels, accuracy=accuracy, progress=progress)
            return np.asarray(found.array, dtype=np.float64)

        if self._lines is None:
            found = bands(self._owner, self._values.reshape(*self._shape, 6))
            return np.stack([self._ordered(band.reshape(-1, 6)) for band in found])
        traces = bands(self._owner, self._values[:, :1]).reshape(-1, len(self._values))
        lines = bands(self._lines.decomposer, np.ascontiguousarray(self._values[:, 1:]))
        join = self._lines._data.join_tensors
        parts = zip(traces, lines, strict=True)
        return np.stack([self._ordered(join(trace.tolist(), np.ascontiguousarray(line))) for trace, line in parts])

    def denoise(self, *, strength: float = 1.0, progress: ProgressLike = None) -> DenoiseResult[TensorField]:
        """Remove noise without tuning: of the traces and the lines on a surface, of the logarithms on a grid.

        Parameters
        ----------
        strength : float
            Factor of the noise: below 1 more careful, above 1 more thorough.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

        Returns
        -------
        DenoiseResult
            The field, and in ``info["groups"]`` the estimates of each part as for a signal in `adwave.denoise`.
        """
        groups: list[DenoiseInfo] = []

        def clean(owner: Decomposer, values: _Floats) -> _Floats:
            found, info = denoise(owner, values, strength=strength, progress=progress)
            groups.extend(info.get("groups", [info]))
            return found

        return DenoiseResult(self._with_values(self._map(clean)), cast(DenoiseInfo, {"groups": groups}))

    def _map(self, compute: Any) -> _Floats:
        """New scalars: all together on a grid; the trace with the operator of scalars and the line with its own."""
        if self._lines is None:
            return np.ascontiguousarray(compute(self._owner, self._values.reshape(*self._shape, 6)).reshape(-1, 6))
        trace = compute(self._owner, self._values[:, :1]).reshape(-1, 1)
        line = compute(self._lines.decomposer, np.ascontiguousarray(self._values[:, 1:]))
        return np.hstack([trace, line])

    def __repr__(self) -> str:
        return f"<adwave.TensorField: {len(self._values)} tensors>"


def vectors(
    shape: object,
    values: ArrayLike,
    *,
    symmetry: Symmetry = 1,
    operator: OperatorLike = None,
    progress: ProgressLike = None,
) -> VectorField:
    """Tangent vectors, lines or crosses on a mesh or a point cloud, to smooth, split into bands and filter.

    Parameters
    ----------
    shape : shape_like
        A mesh or a point cloud (see `Shape`), or a `Decomposer` of one.
    values : (n, 3) array_like
        A vector at each vertex, in space. Its part along the normal takes no part; the field says how large it is. Vertices
        with NaN are masked.
    symmetry : {1, 2, 4}
        1 for vectors; 2 for lines, such as principal curvatures, where v and −v are the same; 4 for crosses.
    operator : str or Operator, optional
        How the diffusion is built; by default heat on the surface, which hardly depends on the mesh.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Returns
    -------
    VectorField

    Raises
    ------
    ValueError
        Unless the shape is a mesh or a cloud, and there are three numbers for each vertex.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> torus = aw.sample("torus", vertices=800)
    >>> around = np.cross([0, 0, 1], torus.points)
    >>> field = aw.vectors(torus, around)
    >>> field.normal_share < 1e-2, float(field.smooth(fwhm="5%").singularities().indices.sum())
    (True, 0.0)
    """
    owner = _heat_on(shape, operator)
    array = np.ascontiguousarray(np.asarray(values, dtype=np.float64))
    if array.shape != (owner.n_vertices, 3):
        raise ValueError(
            f"values must have three numbers for each of {owner.n_vertices} vertices, ({owner.n_vertices}, 3), "
            f"got shape {array.shape}"
        )
    return VectorField._from_vectors(owner, array, int(symmetry), progress)


def tensors(
    shape: object,
    values: ArrayLike,
    *,
    order: TensorOrder = "upper",
    operator: OperatorLike = None,
) -> TensorField:
    """Symmetric tensors on a mesh, a point cloud or a grid, to smooth and filter.

    Parameters
    ----------
    shape : shape_like or Grid
        A mesh, a cloud, or a grid such as a diffusion-tensor volume.
    values : (n, 6), (n, 3, 3) or sizes + (6,) or sizes + (3, 3) array_like
        A symmetric tensor at each place. On a grid tensors that are not positive definite are masked and counted in
        ``n_not_positive``; zeros, as outside of a brain, are masked.
    order : {'upper', 'lower', 'diagonal'}
        Order of six components: xx, xy, xz, yy, yz, zz (FSL); xx, xy, yy, xz, yz, zz (NIfTI, DIPY, ANTs); or xx, yy, zz, xy,
        xz, yz (MRtrix).
    operator : str or Operator, optional
        How the diffusion is built; by default heat.

    Returns
    -------
    TensorField

    Raises
    ------
    ValueError
        Unless there is a tensor for each place.

    Examples
    --------
    >>> import adwave as aw, numpy as np
    >>> torus = aw.sample("torus", vertices=800)
    >>> strain = np.tile([2.0, 0, 0, 1, 0, 1], (torus.n_vertices, 1))
    >>> even = aw.tensors(torus, strain).smooth(fwhm="5%")
    >>> even.values.shape
    (800, 6)
    """
    if order not in _ORDERS:
        raise ValueError(f"order must be 'upper', 'lower' or 'diagonal', got {order!r}")
    owner = _heat_on(shape, operator)
    array = np.asarray(values, dtype=np.float64)
    if array.shape[-2:] == (3, 3):
        array = array[..., _ROWS, _COLUMNS]
    elif array.ndim and array.shape[-1] == 6:
        array = array[..., _ORDERS[order]]
    n = int(np.prod(array.shape[:-1])) if array.ndim else 0
    if array.ndim < 2 or array.shape[-1] != 6 or n != owner.n_vertices:
        raise ValueError(
            f"values must have 6 numbers or 3 × 3 for each of {owner.n_vertices} places, got shape {np.shape(values)}"
        )
    return TensorField._from_upper(owner, np.ascontiguousarray(array.reshape(-1, 6)), order, array.shape[:-1])


def _heat_on(shape: object, operator: OperatorLike) -> Decomposer:
    """A shape or a grid with the operator that directions use by default: heat."""
    domain = as_domain(shape)
    if not isinstance(domain, Decomposer):
        return Decomposer(as_shape(domain), operator=as_operator(operator).with_default_kind("surface"))
    if operator is not None:
        return prepare_decomposer(domain, operator)
    return domain.for_levels(Widths(rms=[1.0]))


def _filter(
    owner: Decomposer,
    values: _Floats,
    gains: GainsLike,
    where: Where,
    levels: LevelsLike,
    accuracy: float,
    progress: ProgressLike,
) -> _Floats:
    """Values with changed bands, by default of one level for each gain."""
    if levels is None and isinstance(gains, Sequence) and not isinstance(gains, str):
        levels = sum(isinstance(gain, (int, float)) for gain in gains) or None
    bands = owner.decompose(values, levels=levels, accuracy=accuracy, progress=progress)
    return np.asarray(bands.apply(gains, where=where), dtype=np.float64)
