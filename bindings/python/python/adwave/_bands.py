"""`Bands`: a signal split from fine to coarse, and changed band by band."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._native import FWHM

if TYPE_CHECKING:
    from adwave._decomposer import Decomposer
    from adwave._shape import Shape

Where = Union[str, ArrayLike, None]


@dataclass(frozen=True)
class Layer:
    """One edit: a gain for each band, and where it applies.

    Attributes
    ----------
    gains : sequence of float, or str
        g_1 … g_J, fine to coarse: 0 drops a band, 1 keeps it, 2 doubles it. Or the name of a preset: ``'suppress'`` (or
        ``'smooth'``), ``'suppress-paper'``, ``'enhance'``, ``'band1'``, ``'band2'``.
    where : str or (n,) array-like, optional
        A region in its text form, or a weight for each vertex; everywhere where none is given.
    """

    gains: Union[Sequence[float], str]
    where: Any = None


class Bands:
    """The bands of a signal: ``W_f(1), …, W_f(J)`` from fine to coarse, and what is left, ``S_f(J)``.

    It behaves as an array of (J + 1) × n × channels (× n of a signal of one dimension); its sum over the first axis is the
    signal. Made by `adwave.decompose`.

    Notes
    -----
    `apply` costs milliseconds. Where vertices are welded or masked the first one keeps a second copy of the bands.

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

    __slots__ = ("__weakref__", "_array", "_editor", "_flat", "_plain", "_signal", "_steps", "decomposer", "info")

    decomposer: Decomposer
    info: dict[str, float]

    @classmethod
    def _of(
        cls,
        decomposer: Decomposer,
        signal: NDArray[np.float64] | None,
        array: NDArray[np.float64],
        steps: list[float],
        is_flat: bool,
        info: dict[str, float],
    ) -> Bands:
        bands = cls.__new__(cls)
        array.setflags(write=False)
        bands.decomposer, bands._array, bands._steps, bands.info = decomposer, array, steps, info
        # What the caller may change later is kept as it was.
        bands._signal = None if signal is None else np.array(signal)
        bands._flat, bands._editor, bands._plain = is_flat, None, None
        return bands

    @property
    def array(self) -> NDArray[np.float64]:
        """All of it as one read-only array: (J + 1) × n × channels, or (J + 1) × n."""
        return self._array[:, :, 0] if self._flat else self._array

    @property
    def shape(self) -> tuple[int, ...]:
        """That of `array`."""
        return self.array.shape

    @property
    def n_levels(self) -> int:
        """J."""
        return len(self._steps)

    @property
    def steps(self) -> NDArray[np.float64]:
        """n_1 … n_J: steps of the diffusion on each level."""
        return np.array(self._steps)

    @property
    def sigma(self) -> NDArray[np.float64]:
        """σ_1 … σ_J, model units (hops on a graph): the root mean square distance that one value spreads to."""
        return self.decomposer.sigma(self._steps)

    @property
    def fwhm(self) -> NDArray[np.float64]:
        """Full widths at half maximum: 1.665 σ."""
        return FWHM * self.sigma

    def wavelet(self, level: int) -> NDArray[np.float64]:
        """``W_f(level)``, level = 1 … J: what level ``level`` loses of the one before."""
        return self.array[self._checked(level, 1) - 1]

    def scaling(self, level: int) -> NDArray[np.float64]:
        """``S_f(level)``, level = 0 … J: the signal without the finest ``level`` bands."""
        return self.array[self._checked(level, 0) :].sum(axis=0)

    def _checked(self, level: int, least: int) -> int:
        if not least <= level <= self.n_levels:
            raise IndexError(f"level: {level} is none of {least} to {self.n_levels}")
        return level

    def reconstruct(self) -> NDArray[np.float64]:
        """The signal again: the sum of all (eq. 15)."""
        return self.array.sum(axis=0)

    def energy(self, weights: ArrayLike | None = None) -> NDArray[np.float64]:
        """``Σ_x a(x)·‖W_f(j,x)‖²`` of each band, and of S_f(J).

        Parameters
        ----------
        weights : (n,) array-like, optional
            a(x); the areas of the vertices where none are given.
        """
        a = self.decomposer.areas if weights is None else np.asarray(weights, dtype=np.float64)
        if a.shape != (self.decomposer.n_vertices,):
            raise ValueError(f"weights: shape {a.shape} for {self.decomposer.n_vertices} vertices; give one for each")
        return np.einsum("jxc,jxc,x->j", self._array, self._array, a)

    def apply(
        self,
        gains: Sequence[float] | str | Layer | Sequence[Layer],
        where: Where = None,
        *,
        out: NDArray[np.float64] | None = None,
    ) -> NDArray[np.float64]:
        """Change the bands, and put the signal together: ``f + Σ_j (Γ(j,x) − 1)·W_f(j,x)`` (eq. 18).

        Parameters
        ----------
        gains : sequence of float, str, or one or more `Layer`
            One gain for each band, fine to coarse, or the name of a preset. Of several layers the gains multiply.
        where : str or (n,) array-like, optional
            A region in its text form, or a weight for each vertex (bool or any number); everywhere where none is given.
        out : array, optional
            Where the result goes, a C-contiguous float64 array of the signal's shape; it is given back. Spares the pages of a new one.

        Returns
        -------
        array
            The signal changed, in its own shape. Where no gain applies it is the same to the last bit.
        """
        if isinstance(gains, Layer):
            layers: list[Layer] = [gains]
        elif not isinstance(gains, str) and len(gains) > 0 and all(isinstance(g, Layer) for g in gains):
            layers = list(gains)  # type: ignore[arg-type]
        else:
            layers = [Layer(gains, where)]  # type: ignore[arg-type]
        plain = [(_gains(layer.gains), _where(layer.where, self.decomposer.n_vertices)) for layer in layers]
        into = None
        if out is not None:
            expected = self.array.shape[1:]
            if not isinstance(out, np.ndarray) or out.dtype != np.float64 or out.shape != expected:
                told = f"{out.dtype}, shape {out.shape}" if isinstance(out, np.ndarray) else type(out).__name__
                raise ValueError(f"out: {told}; give a C-contiguous float64 array of shape {expected}")
            into = out[:, None] if self._flat else out
        if self._is_plain():
            edited = _native.apply_bands(self.decomposer._data, self._signal, self._array, plain, into)
        else:
            edited = self._kept().apply(plain, into)
        if out is not None:
            return out
        return edited[:, 0] if self._flat else edited

    def to_shape(self, points: ArrayLike) -> Shape:
        """The shape of these bands at other positions."""
        return self.decomposer.shape.with_points(points)

    def _is_plain(self) -> bool:
        """Whether no vertices are welded or masked: then an edit needs these bands alone."""
        if self._plain is None:
            welded = self.decomposer.welded()
            self._plain = self.decomposer.mask is None and len(welded) == (int(welded.max()) + 1 if len(welded) else 0)
        return self._plain

    def _kept(self) -> _native.EditorData:
        if self._editor is None:
            self._editor = self.decomposer._data.editor(self._signal, self._steps, self.info["accuracy"])
        return self._editor

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if copy is False and dtype is not None and np.dtype(dtype) != np.float64:
            raise ValueError("bands are float64; another type needs a copy")
        array = self.array if dtype is None else self.array.astype(dtype, copy=False)
        return array.copy() if copy else array

    def __len__(self) -> int:
        return len(self._array)

    def __getitem__(self, at: Any) -> NDArray[np.float64]:
        return self.array[at]

    def __iter__(self) -> Iterator[NDArray[np.float64]]:
        return iter(self.array)

    def __repr__(self) -> str:
        widths = ", ".join(f"{s:.4g}" for s in self.sigma)
        return f"<adwave.Bands: {self.n_levels} levels of {self.shape[1:]}, sigma {widths}>"

    def __reduce__(self) -> tuple[Any, ...]:
        signal = self._signal[:, 0] if self._flat and self._signal is not None else self._signal
        return _restored, (self.decomposer, signal, self._steps, self.info["accuracy"])


def _restored(decomposer: Decomposer, signal: Any, steps: list[float], accuracy: float) -> Bands:
    return decomposer.decompose(signal, steps=steps, accuracy=accuracy)


def _gains(gains: Sequence[float] | str) -> Any:
    if isinstance(gains, str):
        return gains
    array = np.asarray(gains, dtype=np.float64)
    if array.ndim != 1:
        raise ValueError(f"gains: shape {array.shape}; give one number for each band")
    return array.tolist()


def _where(where: Where, n: int) -> Any:
    if where is None or isinstance(where, str):
        return where
    weights = _adapt.values_array(where, n, "where")
    if weights.shape[1] != 1:
        raise ValueError(f"where: shape {weights.shape}; give one weight for each vertex")
    return np.ascontiguousarray(weights[:, 0])
