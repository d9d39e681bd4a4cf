"""`Decomposer`, a shape prepared once, and `Bands`, a signal split from fine to coarse."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from html import escape
from typing import TYPE_CHECKING, Any, Generic, TypeVar, Union, overload

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike, DTypeLike, NDArray

from adwave import _native
from adwave._caller import public
from adwave._deform import CloneOptions, CloneResult, Deformer
from adwave._diffusion import PreparedShape
from adwave._grid_objects import is_image
from adwave._layout import Layout, float_type, region_weights
from adwave._misfit import refuse_unknown
from adwave._native import FWHM
from adwave._options import BandsRequest, LevelsLike, OperatorLike, SignalLike, Widths, as_operator, levels_of
from adwave._progress import ProgressLike, report_progress
from adwave._shape import Shape, as_shape
from adwave._unknown import unknown_member
from adwave._viewer import bands_html

if TYPE_CHECKING:
    from typing_extensions import Unpack
    from xarray import DataArray

    from adwave._band_types import Number, Operators
    from adwave._options import Float, LevelOptions, Numbers
else:
    Number = TypeVar("Number")

    class Operators(NDArrayOperatorsMixin, Generic[Number]):
        """Operators of arrays, whose types are in `adwave._band_types`."""


#: Number type of a copy.
_Other = TypeVar("_Other", bound=np.generic)

Where = Union[str, ArrayLike, None]


@dataclass(frozen=True)
class Layer:
    """One edit: a gain for each band, and the region where it applies.

    Parameters
    ----------
    gains : sequence of float, or str
        g_1 … g_J from fine to coarse: 0 drops a band, 1 keeps it, 2 doubles it. Or the name of a preset:
        ``'suppress'`` (or ``'smooth'``), ``'suppress-paper'``, ``'enhance'``, ``'band1'``, ``'band2'``.
    where : str or (n,) array_like, optional
        A region in its text form, or a weight for each vertex; everywhere by default.

    Examples
    --------
    >>> import adwave as aw
    >>> layers = [aw.Layer("smooth"), aw.Layer([2, 2, 1, 1], "ball:vertex=0,radius=20%")]
    >>> aw.filter(aw.sample("sphere", vertices=500), layers, levels=4)
    <adwave.Shape: mesh, 500 vertices, 996 faces>
    """

    gains: Union[Sequence[float], str]
    where: Any = None


GainsLike = Union[Sequence[float], str, Layer, Sequence[Layer]]
"""An edit: a gain for each band, the name of a preset, or one or more `Layer`."""


class Decomposer(PreparedShape):
    """A shape with its diffusion operator, prepared once; each request then costs its sparse products only.

    The operator Φ₁ is one step of a diffusion on the shape: a lazy random walk over the mesh (`houqin2013`, eq. 4) or
    heat on the surface. Level j of a signal f is ``S_f(j) = Φ₁^(n_j) f``, and its bands are
    ``W_f(j) = S_f(j−1) − S_f(j)`` (eq. 11).

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape; see `Shape`.
    operator : str or Operator, optional
        How signals are smoothed: ``'walk'``, the paper's lazy random walk, or ``'surface'``, heat, whose widths hardly depend
        on the mesh; `Operator` has further options. Without one each request takes what `adwave.decompose` takes: heat for
        levels that are widths, and the walk for others.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Raises
    ------
    ValueError, TypeError
        If the shape or an option is invalid; the message is one line.

    Notes
    -----
    Takes O(n log n) time and about 200 bytes for each vertex. It may be used from several threads, and in a forked child.

    Examples
    --------
    >>> import adwave as aw
    >>> walk = aw.Decomposer(aw.sample("sphere", vertices=1000))
    >>> bands = walk.decompose(levels=4)
    >>> heights = walk.decompose(walk.shape.points[:, 2], levels=4)
    >>> heights.shape
    (5, 1000)
    """

    __slots__ = ()

    @overload  # type: ignore[override]
    def decompose(
        self,
        signal: NDArray[Float],
        *,
        levels: LevelsLike = None,
        accuracy: float = ...,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> Bands[Float]: ...
    @overload
    def decompose(
        self,
        signal: Numbers | str | None = None,
        *,
        levels: LevelsLike = None,
        accuracy: float = ...,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> Bands: ...
    @overload
    def decompose(
        self,
        signal: SignalLike = None,
        *,
        levels: LevelsLike = None,
        accuracy: float = ...,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> Bands[Any]: ...

    @public()
    def decompose(
        self,
        signal: SignalLike = None,
        *,
        levels: LevelsLike = None,
        accuracy: float = _native.ACCURACY,
        progress: ProgressLike = None,
        **options: Unpack[LevelOptions],
    ) -> Bands[Any]:
        """Split a signal into its bands; see `adwave.decompose`.

        Parameters
        ----------
        signal : str or (n,) or (n, channels) array_like, optional
            The coordinates by default.
        levels : int, Widths, Steps or Octaves, optional
            By default until a level is 2 % of the diagonal wide.
        accuracy : float
            Largest error of a band relative to the band, 1e-13 to 0.1.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
        **options
            ``fwhm=[2, 4, 8]`` and ``steps=[1, 2.5, 8]``, short for `levels`.
        """
        if options:
            refuse_unknown("decompose", options, ("signal", "levels", "accuracy", "progress"), ("fwhm", "steps"))
            levels = levels_of(levels, options)
        owner = self.for_levels(levels)
        values, layout = owner._signal_values(signal)
        request = BandsRequest(values, owner.schedule(levels), accuracy)
        return split_signal(owner, request, layout, None, progress, float_type(signal))

    def deformer(
        self,
        fixed: Where,
        handles: Sequence[str | ArrayLike],
        *,
        levels: LevelsLike = None,
        stiffness: float | str | None = None,
        keep_lengths: float = 0.0,
        progress: ProgressLike = None,
    ) -> Deformer:
        """Bind the shape to handles; see `Deformer`.

        Parameters
        ----------
        fixed : str or array_like or None
            What stays: a region in its text form, a flag or weight for each vertex, or the indices of vertices. ``None`` if
            nothing does.
        handles : sequence
            Regions that are moved, each given like `fixed`.
        levels : int, Widths, Steps or Octaves, optional
            The base is the last level; by default one of 4.5 % of the diagonal.
        stiffness : float or str, optional
            Bending length, in model units or as a share of the diagonal; 0.75 times the width of the base by default.
        keep_lengths : float
            Share of lengths in [0, 1]: 0 keeps the detail, 1 the lengths of edges.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).
        """
        return Deformer(
            self, fixed, handles, levels=levels, stiffness=stiffness, keep_lengths=keep_lengths, progress=progress
        )


_DOUBLE: np.dtype[Any] = np.dtype(np.float64)


@dataclass(frozen=True)
class Selection:
    """The vertices of a shape that take part."""

    whole: Shape
    rows: NDArray[np.intp]


def split_signal(
    decomposer: Decomposer,
    request: BandsRequest,
    layout: Layout,
    selection: Selection | None = None,
    progress: ProgressLike = None,
    dtype: np.dtype[Any] = _DOUBLE,
) -> Bands[Any]:
    """The bands of a signal, channels that are NaN at the same vertices together, as numbers of a type."""
    info: dict[str, float] = {}
    with report_progress(progress, "splitting") as report:

        def split(owner: Decomposer, values: NDArray[np.float64] | None, _: list[int]) -> NDArray[np.float64]:
            array, found = owner._data.bands(replace(request, signal=values), report)
            bits = min(found["bits"], info.get("bits", 64))
            info.update({name: max(value, info.get(name, 0.0)) for name, value in found.items()}, bits=bits)
            return array

        array = decomposer._map_channels(request.signal, split)
    raised = decomposer._data.raised_masses()
    if raised is not None:
        info["raised_masses"], info["added_mass"] = raised
    return Bands._from_parts(decomposer, request, array, layout, info, selection, dtype)


#: Public attributes of arrays, which `Bands` has too.
_OF_ARRAYS = frozenset(name for name in dir(np.ndarray) if not name.startswith("_"))


class Bands(Operators[Number]):
    """The bands of a signal, ``W_f(1), …, W_f(J)`` from fine to coarse, and the rest, ``S_f(J)``.

    It behaves as an array of (J + 1) × n × channels, that is (J + 1) × the shape of the signal: it has the attributes and
    operators of `numpy.ndarray`, numpy's functions take it, and its sum over the first axis is the signal. Results are plain
    arrays. `adwave.decompose` computes it. Type checkers know its number type: ``Bands`` is ``Bands[np.float64]``, and the bands
    of an array of float32 are ``Bands[np.float32]``.

    Notes
    -----
    ``bands[0]`` is ``bands.wavelet(1)``, and ``bands[-1]`` is ``bands.scaling(J)``. `apply` takes milliseconds. If vertices
    are welded or masked, the first call keeps a second copy of the bands.

    Examples
    --------
    >>> import adwave as aw
    >>> shape = aw.sample("creature", vertices=2000)
    >>> bands = aw.decompose(shape, levels=5)
    >>> bands[0].shape, bands.n_levels
    ((2024, 3), 5)
    >>> rough = bands.apply([3, 2, 1, 1, 1], where="ball:vertex=0,radius=10%")
    >>> rough.shape
    (2024, 3)
    >>> bands.dtype, (2 * bands).shape, abs(bands).max(axis=(1, 2)).shape
    (dtype('float64'), (6, 2024, 3), (6,))
    """

    _array: NDArray[np.float64]
    _dtype: np.dtype[Any]
    _shown: NDArray[Any] | None
    _editors: list[tuple[_native.EditorData, list[int]]] | None
    _is_plain: bool | None
    _layout: Layout
    _part_layout: Layout
    _request: BandsRequest
    _selection: Selection | None
    decomposer: Decomposer
    #: Bound of the relative error, degree of the polynomials, bytes of memory, bits of the numbers in products, and for heat on a surface the number of
    #: vertices whose masses were raised and the share of the area that this adds (see `Operator.with_exact_masses`).
    info: dict[str, float]

    @classmethod
    def _from_parts(
        cls,
        decomposer: Decomposer,
        request: BandsRequest,
        array: NDArray[np.float64],
        layout: Layout,
        info: dict[str, float],
        selection: Selection | None,
        dtype: np.dtype[Any] = _DOUBLE,
    ) -> Bands[Any]:
        bands = cls.__new__(cls)
        bands._dtype, bands._shown = dtype, None
        # A copy, since the caller may change the array later.
        signal = None if request.signal is None else np.array(request.signal)
        bands._request = replace(request, signal=signal)
        bands._part_layout, bands._selection, bands.info = layout, selection, info
        bands._editors, bands._is_plain = None, None
        # The one shape whose vertices without a value are masked, if all channels have them in common.
        groups = decomposer._channel_groups(signal)
        bands.decomposer = groups[0][0] if len(groups) == 1 else decomposer
        if selection is not None:
            whole = np.full((len(array), selection.whole.n_vertices, array.shape[2]), np.nan)
            whole[:, selection.rows] = array
            array, layout = whole, layout.with_vertices(selection.whole.n_vertices)
        array.setflags(write=False)
        bands._array, bands._layout = array, layout
        return bands

    @property
    def array(self) -> NDArray[Number]:
        """All bands as one read-only array: (J + 1) × the shape of the signal."""
        if self._shown is None:
            self._shown = self._layout.arrange(self._array.astype(self._dtype, copy=False))
            self._shown.setflags(write=False)
        return self._shown

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of `array`."""
        return (len(self._array), *self._layout.shape)

    @property
    def dtype(self) -> np.dtype[Number]:
        """Type of the numbers: that of a signal of 16 or 32 bits, and float64 otherwise."""
        return self._dtype

    @property
    def ndim(self) -> int:
        """Number of axes of `array`."""
        return len(self.shape)

    @property
    def size(self) -> int:
        """Number of values of `array`."""
        return self._array.size

    @property
    def T(self) -> NDArray[Number]:
        """`array` with its axes in the reverse order, as a view."""
        return self.array.T

    @overload
    def mean(self, axis: None = None) -> Number: ...
    @overload
    def mean(self, axis: int | tuple[int, ...], **options: Any) -> NDArray[Number]: ...

    def mean(self, axis: int | tuple[int, ...] | None = None, **options: Any) -> Number | NDArray[Number]:
        """Mean over an axis, as `numpy.mean`."""
        return self.array.mean(axis, **options)

    @overload
    def sum(self, axis: None = None) -> Number: ...
    @overload
    def sum(self, axis: int | tuple[int, ...], **options: Any) -> NDArray[Number]: ...

    def sum(self, axis: int | tuple[int, ...] | None = None, **options: Any) -> Number | NDArray[Number]:
        """Sum over an axis, as `numpy.sum`; over axis 0 it is the signal."""
        return self.array.sum(axis, **options)

    @overload
    def astype(self, dtype: type[_Other], **options: Any) -> NDArray[_Other]: ...
    @overload
    def astype(self, dtype: DTypeLike, **options: Any) -> NDArray[Any]: ...

    def astype(self, dtype: DTypeLike, **options: Any) -> NDArray[Any]:
        """A copy of `array` in another number type."""
        return self.array.astype(dtype, **options)

    def to_xarray(self) -> DataArray:
        """An `xarray.DataArray` with the axes level, vertex (of a grid i, j and k) and channel, and steps and widths of the levels.

        Level j = 1 … J is ``W_f(j)`` and level J + 1 the rest, whose steps and widths are those of level J.
        """
        import xarray

        axes = self._layout.axis_names()
        steps, widths = self.steps, self.rms_widths
        along = {
            "level": np.arange(1, len(self) + 1),
            "steps": ("level", np.append(steps, steps[-1:])),
            "rms_width": ("level", np.append(widths, widths[-1:])),
        }
        return xarray.DataArray(self.array, dims=("level", *axes), coords=along, name="bands", attrs=dict(self.info))

    @property
    def n_levels(self) -> int:
        """Number of levels J."""
        return len(self._request.steps)

    @property
    def steps(self) -> NDArray[np.float64]:
        """Diffusion steps n_1 … n_J of the levels."""
        return np.array(self._request.steps)

    @property
    def rms_widths(self) -> NDArray[np.float64]:
        """Widths of the levels, (J,): root mean square distance that one value spreads to, in model units.

        The unit is hops on a graph. On a surface this is √2 times the standard deviation along one axis.
        """
        return self.decomposer.measure_widths(self._request.steps)

    @property
    def fwhm(self) -> NDArray[np.float64]:
        """Full widths at half maximum of the levels, (J,): 1.665 times `rms_widths`."""
        return FWHM * self.rms_widths

    def wavelet(self, level: int) -> NDArray[Number]:
        """``W_f(level)`` for level = 1 … J: the detail that this level removes from the one before, (n,) or (n, channels)."""
        return self.array[self._check_level(level, 1) - 1]

    def scaling(self, level: int) -> NDArray[Number]:
        """``S_f(level)`` for level = 0 … J: the signal without the finest `level` bands, (n,) or (n, channels)."""
        return self.array[self._check_level(level, 0) :].sum(axis=0)

    def _check_level(self, level: int, least: int) -> int:
        if not least <= level <= self.n_levels:
            raise IndexError(f"level must be in {least}..={self.n_levels}, got {level}")
        return level

    def reconstruct(self) -> NDArray[Number]:
        """The signal, as the sum of all bands (eq. 15)."""
        return self.array.sum(axis=0)

    def with_base(self, points: ArrayLike, *, progress: ProgressLike = None) -> NDArray[np.float64]:
        """The shape on another base: an edited copy of ``scaling(J)``, from any program that keeps the vertices.

        ``f' = S' + R (f - S_J)``, where R turns each vertex's neighborhood from S_J to the new base S'. The unchanged base
        gives the shape, and the S_J of another pose with the same faces poses it.

        Parameters
        ----------
        points : (n, 3) array_like
            The new base, in the order of the shape.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

        Returns
        -------
        (n, 3) array
            New positions of the shape.

        Raises
        ------
        ValueError
            If these are no bands of the coordinates, or the base has another number or order of vertices, is mirrored or
            has collapsed.

        Examples
        --------
        >>> import adwave as aw
        >>> shape = aw.sample("creature", vertices=2000)
        >>> bands = aw.decompose(shape, levels=6)
        >>> base = bands.scaling(6)
        >>> bent = bands.with_base(base + [0.1, 0, 0] * base[:, 1:2] ** 2)
        >>> bent.shape
        (2024, 3)
        """
        base = np.ascontiguousarray(points, dtype=np.float64)
        self._check_coordinates("with_base")
        if base.ndim != 2:
            raise ValueError(f"points must be (n, 3), got shape {base.shape}")
        with report_progress(progress, "splitting") as report:
            return _native.with_base(self.decomposer._data, list(self._request.steps), base, report)

    def clone_detail(
        self,
        source: int,
        target: int,
        radius: float | str,
        *,
        angle: float = 0.0,
        levels: tuple[int, int] | None = None,
    ) -> CloneResult:
        """Clone detail from one place to another: a clone stamp.

        Around both vertices the base S_J is unrolled onto a plane (the discrete exponential map, `schmidt2006`). At equal
        places of the two maps the target takes the detail of the source, turned from frame to frame, and fades into its own
        detail from half the radius on.

        Parameters
        ----------
        source, target : int
            Vertices in the middle of both places.
        radius : float or str
            Distance at which the clone has faded out, in model units or as a share of the diagonal.
        angle : float
            Turn about the normal in radians, counterclockwise seen from outside.
        levels : (int, int), optional
            First and last level that is cloned, counted from 1; all by default.

        Returns
        -------
        CloneResult
            The new points, the numbers of vertices that changed and that found no source, and the distortion of the maps.

        Raises
        ------
        ValueError
            If these are no bands of the coordinates, or an argument is out of range.

        Examples
        --------
        >>> import adwave as aw
        >>> bands = aw.decompose(aw.sample("creature", vertices=2000), levels=5)
        >>> bands.clone_detail(0, 0, "10%").distortion >= 1
        True
        """
        self._check_coordinates("clone_detail")
        first, last = (1, self.n_levels) if levels is None else levels
        options = CloneOptions(source, target, radius, angle, first, last)
        return CloneResult(*_native.clone_detail(self.decomposer._data, list(self._request.steps), options))

    def _check_coordinates(self, name: str) -> None:
        """Refuses bands of another signal than the coordinates of the whole shape."""
        own = self.decomposer.shape
        is_own = self._selection is None and self._layout.shape == (own.n_vertices, 3) and own.kind != "graph"
        if not is_own or not np.allclose(self.array.sum(axis=0), own.points, atol=1e-6 * float(np.ptp(own.points))):
            raise ValueError(f"{name} needs bands of the coordinates of a whole mesh or cloud, aw.decompose(shape)")

    def energy(self, weights: ArrayLike | None = None) -> NDArray[np.float64]:
        """``Σ_x a(x)·‖W_f(j,x)‖²`` of each band and of S_f(J), (J + 1,); vertices without a value count nothing.

        Parameters
        ----------
        weights : (n,) array_like, optional
            a(x); by default the areas of the vertices.
        """
        n = self._layout.n_vertices
        if weights is not None:
            a = np.asarray(weights, dtype=np.float64)
        elif self._selection is not None:
            a = np.zeros(n)
            a[self._selection.rows] = self.decomposer.areas
        else:
            a = self.decomposer.areas
        if a.shape != (n,):
            raise ValueError(f"weights must have one number for each of {n} vertices, got shape {a.shape}")
        array = self._array if np.isfinite(self._array[-1]).all() else np.nan_to_num(self._array)
        return np.einsum("jxc,jxc,x->j", array, array, a)

    def shares(self) -> NDArray[np.float64]:
        """Shares of the bands and of S_f(J) in the variance of the signal, (J + 1,): they sum to 1; 0 for a constant.

        The share of band j is ``(‖S_f(j−1)‖² − ‖S_f(j)‖²)/‖f‖²``, less the mean, by the stationary distribution of the
        operator. It is not negative for bands about the local mean.
        """
        share = self.decomposer._data.welding()[1]
        weights = share
        if self._selection is not None:
            weights = np.zeros(self._layout.n_vertices)
            weights[self._selection.rows] = share
        array = self._array if np.isfinite(self._array[-1]).all() else np.nan_to_num(self._array)
        weights = np.where(np.isfinite(self._array[-1]).all(axis=-1), weights, 0.0)
        scaling = np.cumsum(array[::-1], axis=0)[::-1]
        mean = np.einsum("xc,x->c", array[-1], weights) / max(float(weights.sum()), np.finfo(float).tiny)
        scaling = scaling - mean
        squares = np.einsum("jxc,jxc,x->j", scaling, scaling, weights)
        sums = scaling[:-1] + scaling[1:]
        parts = np.append(np.einsum("jxc,jxc,x->j", array[:-1], sums, weights), squares[-1])
        variance = float(parts.sum())
        return parts / variance if variance > 0.0 else np.zeros_like(parts)

    @overload
    def apply(self, gains: GainsLike, where: Where = None, *, out: None = None) -> NDArray[Number]: ...
    @overload
    def apply(self, gains: GainsLike, where: Where = None, *, out: NDArray[np.float64]) -> NDArray[np.float64]: ...

    def apply(
        self, gains: GainsLike, where: Where = None, *, out: NDArray[np.float64] | None = None
    ) -> NDArray[Number] | NDArray[np.float64]:
        """Change the bands and sum them: ``f + Σ_j (Γ(j,x) − 1)·W_f(j,x)`` (eq. 18).

        Parameters
        ----------
        gains : sequence of float, str, or one or more Layer
            One gain for each band from fine to coarse, or the name of a preset. The gains of several layers multiply.
        where : str or (n,) array_like, optional
            A region in its text form, a weight for each vertex (bool or any number), or indices of vertices; everywhere by
            default.
        out : array, optional
            A C-contiguous float64 array of the signal's shape that receives the result and is returned.

        Returns
        -------
        array
            The changed signal, in its own shape. Where no gain applies it is unchanged to the last bit.

        Raises
        ------
        ValueError
            If there are not J gains, or `where` or `out` does not fit the shape.
        """
        if isinstance(gains, (int, float, np.number)):
            raise TypeError(
                f"gains must be one number for each of {self.n_levels} bands, got {gains}; for all bands alike "
                f"bands.apply([{gains}] * {self.n_levels})"
            )
        layers = edit_layers(gains, where, self._layout.n_vertices, self.decomposer._sizes)
        if out is not None:
            expected = self._layout.shape
            is_array = isinstance(out, np.ndarray) and out.dtype == np.float64 and out.shape == expected
            if not is_array or not out.flags.c_contiguous:
                found = (
                    f"{out.dtype}, shape {out.shape}, strides {out.strides}"
                    if isinstance(out, np.ndarray)
                    else type(out).__name__
                )
                raise ValueError(f"out: must be a C-contiguous float64 array of shape {expected}, got {found}")
        if self._has_plain_vertices():
            # Written in place where the axes allow.
            target = self._layout.flatten(out) if out is not None and not self._layout.is_last else None
            edited = _native.apply_bands(self.decomposer._data, self._request.signal, self._array, layers, target)
        else:
            target, edited = None, self._edit(layers)
        if out is None:
            return self._layout.arrange(edited).astype(self._dtype, copy=False)
        if target is None:
            out[...] = self._layout.arrange(edited)
        return out

    def _edit(self, layers: list[tuple[Any, Any]]) -> NDArray[np.float64]:
        """The edited n × channels values, by an editor of each group of channels."""
        if self._editors is None:
            request = self._request
            self._editors = [
                (_native.EditorData(owner._data, replace(request, signal=part)), channels)
                for owner, part, channels in self.decomposer._channel_groups(request.signal)
            ]
        selection = self._selection
        if selection is not None:
            layers = [(gains, _at_rows(weights, selection.rows)) for gains, weights in layers]
        values = self.decomposer.shape.points if self._request.signal is None else self._request.signal
        if len(self._editors) == 1 and selection is None and len(self._editors[0][1]) == values.shape[1]:
            return self._editors[0][0].apply(layers)
        edited = np.array(values)
        for editor, channels in self._editors:
            edited[:, channels] = editor.apply(layers)
        if selection is None:
            return edited
        whole = (
            np.array(self._array.sum(axis=0)) if self._request.signal is not None else np.array(selection.whole.points)
        )
        whole[selection.rows] = edited
        return whole

    def to_shape(self, points: ArrayLike) -> Shape:
        """The shape of these bands at other positions, n × 3."""
        shape = self.decomposer.shape if self._selection is None else self._selection.whole
        return shape.with_points(points)

    def _has_plain_vertices(self) -> bool:
        """True if no vertices are welded or masked, so that an edit needs only these bands."""
        if self._is_plain is None:
            signal = self._request.signal
            has_gaps = signal is not None and bool(np.isnan(signal).any())
            welded = self.decomposer.vertex_map()
            n_welded = int(welded.max()) + 1 if len(welded) else 0
            is_whole = self._selection is None and self.decomposer.mask is None and not has_gaps
            self._is_plain = is_whole and len(welded) == n_welded
        return self._is_plain

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if copy is False and dtype is not None and np.dtype(dtype) != self._dtype:
            raise ValueError(f"bands are {self._dtype}; another type needs a copy")
        array = self.array if dtype is None else self.array.astype(dtype, copy=False)
        return array.copy() if copy else array

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        if any(isinstance(out, Bands) for out in options.get("out") or ()):
            raise TypeError("bands are read-only; write `new = bands + 1` instead of `bands += 1`")
        plain = [each.array if isinstance(each, Bands) else each for each in inputs]
        return getattr(ufunc, method)(*plain, **options)

    def __getattr__(self, name: str) -> Any:
        if name not in _OF_ARRAYS:
            raise AttributeError(unknown_member(Bands, name), name=name, obj=self)
        return getattr(self.array, name)

    def __len__(self) -> int:
        return len(self._array)

    def __getitem__(self, index: Any) -> NDArray[Number]:
        return self.array[index]

    def __iter__(self) -> Iterator[NDArray[Number]]:
        return iter(self.array)

    def __matmul__(self, other: Any) -> NDArray[Any]:
        return self.array @ np.asarray(other)

    def __repr__(self) -> str:
        widths = ", ".join(f"{width:.4g}" for width in self.rms_widths)
        return f"<adwave.Bands: {self.n_levels} levels of {self.shape[1:]}, rms widths {widths}>"

    def _repr_html_(self) -> str:
        widths = self.rms_widths
        titles = [f"{j} · {width:.3g}" for j, width in enumerate(widths, start=1)]
        view = ""
        if self.decomposer._sizes:
            return f"<div>{escape(repr(self))}</div>"
        shape = self.decomposer.shape if self._selection is None else self._selection.whole
        if shape.kind == "mesh":
            view = bands_html(shape._data, self._array, [*titles, "rest"], self._request.signal is None)
        return f"<div>{escape(repr(self))}</div>{view}"

    def __reduce__(self) -> tuple[Any, ...]:
        return split_signal, (self.decomposer, self._request, self._part_layout, self._selection, None, self._dtype)


def _at_rows(weights: Any, rows: NDArray[np.intp]) -> Any:
    return np.ascontiguousarray(weights[rows]) if isinstance(weights, np.ndarray) else weights


def as_domain(given: object) -> object:
    """Returns the carrier of a signal: a `Walk` or an image as its `Decomposer`, any other object unchanged.

    Every function that takes a shape takes walks and images by this.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.smooth(aw.walk([[0, 1], [1, 0]]), [1.0, 3.0], steps=1)
    array([3., 1.])
    """
    # By a method, so that the module of walks may import this one.
    own = getattr(type(given), "_as_domain", None)
    if own is None and is_image(given):
        import adwave  # the package loads the module of `Grid`, which is above this one

        return adwave.Grid(given).prepare()
    return given if own is None else own(given)


def prepare_decomposer(
    shape: object, operator: OperatorLike = None, levels: LevelsLike = None, *, analysis: bool = False
) -> Decomposer:
    """A `Decomposer` of a shape; of one that is given, the operator that suits the levels.

    Without a kind, levels by width, and the analysis of a mesh (saliency and features), take heat on the surface unless an
    option of the walk is given.

    Raises
    ------
    ValueError
        If a `Decomposer` is to have another operator than its own.
    """
    shape = as_domain(shape)
    if isinstance(shape, Decomposer):
        own = shape.for_levels(levels, analysis=analysis)
        if operator is not None and as_operator(operator) not in (
            as_operator(own.operator),
            own._options,
            shape._options,
        ):
            raise ValueError(
                f"operator: this Decomposer was prepared with {own._options}; leave the options of the operator out, or pass "
                "the shape itself, decomposer.shape"
            )
        return own
    options = as_operator(operator)
    shape = as_shape(shape)
    needs_surface = isinstance(levels, Widths) or (analysis and shape.kind == "mesh")
    is_surface = needs_surface and not options.needs_walk()
    return Decomposer(shape, operator=options.with_default_kind("surface" if is_surface else "walk"))


def edit_layers(gains: GainsLike, where: Where, n_vertices: int, sizes: tuple[int, ...] = ()) -> list[tuple[Any, Any]]:
    """Gains and weights of each layer, as the extension takes them; on a grid of these sizes weights may have its axes.

    Raises
    ------
    ValueError
        If gains or weights have the wrong shape, or `where` is given beside layers.
    """
    if isinstance(gains, Layer):
        layers = [gains]
    elif not isinstance(gains, str) and len(gains) > 0 and all(isinstance(g, Layer) for g in gains):
        layers: list[Layer] = list(gains)  # type: ignore[arg-type]
    else:
        return [(_plain_gains(gains), _plain_weights(where, n_vertices, sizes))]  # type: ignore[arg-type]
    if where is not None:
        raise ValueError("where: each layer has its own region; leave it out")
    return [(_plain_gains(layer.gains), _plain_weights(layer.where, n_vertices, sizes)) for layer in layers]


def _plain_gains(gains: Sequence[float] | str) -> Any:
    if isinstance(gains, str):
        return gains
    array = np.asarray(gains, dtype=np.float64)
    if array.ndim != 1:
        raise ValueError(f"gains must be one number for each band, such as [0, 1, 1], got shape {array.shape}")
    return array.tolist()


def _plain_weights(where: Where, n: int, sizes: tuple[int, ...] = ()) -> Any:
    if where is None or isinstance(where, str):
        return where
    if sizes:
        if np.shape(where) not in (sizes, (n,)):
            raise ValueError(
                f"where: shape {np.shape(where)} is not that of the grid, {sizes}; give a weight for each place"
            )
        where = np.reshape(where, -1)
    weights = region_weights(where, n)
    # Weights of 1 at all vertices are no region, and give the same bits as without.
    return None if (weights == 1).all() else weights
