"""`Decomposer`, a shape prepared once, and `Bands`, a signal split from fine to coarse."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._diffusion import PreparedShape
from adwave._native import FWHM
from adwave._options import BandsRequest, LevelsLike, OperatorLike, SignalLike, Steps, Widths, as_operator
from adwave._progress import ProgressLike, report_progress
from adwave._shape import Shape

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
    operator : str or Operator
        How signals are smoothed: ``'walk'``, the paper's lazy random walk, or ``'surface'``, heat, whose widths hardly depend on the
        mesh; `Operator` has further options.
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

    def decompose(
        self,
        signal: SignalLike = None,
        *,
        levels: LevelsLike = None,
        accuracy: float = _native.ACCURACY,
        progress: ProgressLike = None,
    ) -> Bands:
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
        """
        steps = self.schedule(levels)
        owner, values, is_flat = self._resolve_signal(signal)
        with report_progress(progress, "splitting") as report:
            array, info = owner._data.bands(BandsRequest(values, steps, accuracy), report)
        return Bands._from_parts(owner, BandsRequest(values, steps, accuracy), array, is_flat, info)


class Bands:
    """The bands of a signal, ``W_f(1), …, W_f(J)`` from fine to coarse, and the rest, ``S_f(J)``.

    It behaves as an array of (J + 1) × n × channels ((J + 1) × n for a signal of one dimension); its sum over the first
    axis is the signal. `adwave.decompose` computes it.

    Notes
    -----
    `apply` takes milliseconds. If vertices are welded or masked, the first call keeps a second copy of the bands.

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
    """

    __slots__ = ("__weakref__", "_array", "_editor", "_is_flat", "_is_plain", "_request", "decomposer", "info")

    decomposer: Decomposer
    info: dict[str, float]

    @classmethod
    def _from_parts(
        cls,
        decomposer: Decomposer,
        request: BandsRequest,
        array: NDArray[np.float64],
        is_flat: bool,
        info: dict[str, float],
    ) -> Bands:
        bands = cls.__new__(cls)
        array.setflags(write=False)
        # A copy, since the caller may change the array later.
        signal = None if request.signal is None else np.array(request.signal)
        bands._request = BandsRequest(signal, request.steps, request.accuracy)
        bands.decomposer, bands._array, bands.info = decomposer, array, info
        bands._is_flat, bands._editor, bands._is_plain = is_flat, None, None
        return bands

    @property
    def array(self) -> NDArray[np.float64]:
        """All bands as one read-only array: (J + 1) × n × channels, or (J + 1) × n."""
        return self._array[:, :, 0] if self._is_flat else self._array

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of `array`."""
        return self.array.shape

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
        return self.decomposer.rms_widths(self._request.steps)

    @property
    def fwhm(self) -> NDArray[np.float64]:
        """Full widths at half maximum of the levels, (J,): 1.665 times `rms_widths`."""
        return FWHM * self.rms_widths

    def wavelet(self, level: int) -> NDArray[np.float64]:
        """``W_f(level)`` for level = 1 … J: the detail that this level removes from the one before, (n,) or (n, channels)."""
        return self.array[self._check_level(level, 1) - 1]

    def scaling(self, level: int) -> NDArray[np.float64]:
        """``S_f(level)`` for level = 0 … J: the signal without the finest `level` bands, (n,) or (n, channels)."""
        return self.array[self._check_level(level, 0) :].sum(axis=0)

    def _check_level(self, level: int, least: int) -> int:
        if not least <= level <= self.n_levels:
            raise IndexError(f"level must be in {least}..={self.n_levels}, got {level}")
        return level

    def reconstruct(self) -> NDArray[np.float64]:
        """The signal, as the sum of all bands (eq. 15)."""
        return self.array.sum(axis=0)

    def energy(self, weights: ArrayLike | None = None) -> NDArray[np.float64]:
        """``Σ_x a(x)·‖W_f(j,x)‖²`` of each band and of S_f(J), (J + 1,).

        Parameters
        ----------
        weights : (n,) array_like, optional
            a(x); by default the areas of the vertices.
        """
        a = self.decomposer.areas if weights is None else np.asarray(weights, dtype=np.float64)
        n = self.decomposer.n_vertices
        if a.shape != (n,):
            raise ValueError(f"weights must have one number for each of {n} vertices, got shape {a.shape}")
        return np.einsum("jxc,jxc,x->j", self._array, self._array, a)

    def apply(
        self, gains: GainsLike, where: Where = None, *, out: NDArray[np.float64] | None = None
    ) -> NDArray[np.float64]:
        """Change the bands and sum them: ``f + Σ_j (Γ(j,x) − 1)·W_f(j,x)`` (eq. 18).

        Parameters
        ----------
        gains : sequence of float, str, or one or more Layer
            One gain for each band from fine to coarse, or the name of a preset. The gains of several layers multiply.
        where : str or (n,) array_like, optional
            A region in its text form, or a weight for each vertex (bool or any number); everywhere by default.
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
        layers = edit_layers(gains, where, self.decomposer.n_vertices)
        target = None
        if out is not None:
            expected = self.array.shape[1:]
            if not isinstance(out, np.ndarray) or out.dtype != np.float64 or out.shape != expected:
                found = f"{out.dtype}, shape {out.shape}" if isinstance(out, np.ndarray) else type(out).__name__
                raise ValueError(f"out: must be a C-contiguous float64 array of shape {expected}, got {found}")
            target = out[:, None] if self._is_flat else out
        if self._has_plain_vertices():
            edited = _native.apply_bands(self.decomposer._data, self._request.signal, self._array, layers, target)
        else:
            edited = self._cached_editor().apply(layers, target)
        if out is not None:
            return out
        return edited[:, 0] if self._is_flat else edited

    def to_shape(self, points: ArrayLike) -> Shape:
        """The shape of these bands at other positions, n × 3."""
        return self.decomposer.shape.with_points(points)

    def _has_plain_vertices(self) -> bool:
        """Tells whether no vertices are welded or masked: then an edit needs these bands alone."""
        if self._is_plain is None:
            welded = self.decomposer.vertex_map()
            n_welded = int(welded.max()) + 1 if len(welded) else 0
            self._is_plain = self.decomposer.mask is None and len(welded) == n_welded
        return self._is_plain

    def _cached_editor(self) -> _native.EditorData:
        if self._editor is None:
            self._editor = _native.EditorData(self.decomposer._data, self._request)
        return self._editor

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if copy is False and dtype is not None and np.dtype(dtype) != np.float64:
            raise ValueError("bands are float64; another type needs a copy")
        array = self.array if dtype is None else self.array.astype(dtype, copy=False)
        return array.copy() if copy else array

    def __len__(self) -> int:
        return len(self._array)

    def __getitem__(self, index: Any) -> NDArray[np.float64]:
        return self.array[index]

    def __iter__(self) -> Iterator[NDArray[np.float64]]:
        return iter(self.array)

    def __repr__(self) -> str:
        widths = ", ".join(f"{width:.4g}" for width in self.rms_widths)
        return f"<adwave.Bands: {self.n_levels} levels of {self.shape[1:]}, rms widths {widths}>"

    def __reduce__(self) -> tuple[Any, ...]:
        request = self._request
        signal = request.signal[:, 0] if self._is_flat and request.signal is not None else request.signal
        return _restore_bands, (self.decomposer, signal, request.steps, request.accuracy)


def _restore_bands(decomposer: Decomposer, signal: Any, steps: Sequence[float], accuracy: float) -> Bands:
    return decomposer.decompose(signal, levels=Steps(steps), accuracy=accuracy)


def prepare_decomposer(shape: object, operator: OperatorLike = None, levels: LevelsLike = None) -> Decomposer:
    """A `Decomposer` of a shape; one that is given is returned.

    Without a kind, levels by width take heat on the surface unless an option of the walk is given.
    """
    if isinstance(shape, Decomposer):
        if operator is not None:
            raise ValueError("a Decomposer has an operator already; leave operator out")
        return shape
    options = as_operator(operator)
    by_width = isinstance(levels, Widths) and not options.needs_walk()
    return Decomposer(shape, operator=options.with_default_kind("surface" if by_width else "walk"))


def edit_layers(gains: GainsLike, where: Where, n_vertices: int) -> list[tuple[Any, Any]]:
    """Gains and weights of each layer, as the extension takes them.

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
        return [(_plain_gains(gains), _plain_weights(where, n_vertices))]  # type: ignore[arg-type]
    if where is not None:
        raise ValueError("where: each layer has its own region; leave it out")
    return [(_plain_gains(layer.gains), _plain_weights(layer.where, n_vertices)) for layer in layers]


def _plain_gains(gains: Sequence[float] | str) -> Any:
    if isinstance(gains, str):
        return gains
    array = np.asarray(gains, dtype=np.float64)
    if array.ndim != 1:
        raise ValueError(f"gains must be one number for each band, got shape {array.shape}")
    return array.tolist()


def _plain_weights(where: Where, n: int) -> Any:
    if where is None or isinstance(where, str):
        return where
    weights = _adapt.values_array(where, n, "where")
    if weights.shape[1] != 1:
        raise ValueError(f"where must have one weight for each vertex, got shape {weights.shape}")
    return np.ascontiguousarray(weights[:, 0])
