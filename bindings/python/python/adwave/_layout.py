"""Axes of a signal: the caller's array as n × channels numbers, and results back in the caller's axes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _native
from adwave._adapt_arrays import Array, Floats, array_of, finite_values, float_type, values_array
from adwave._caller import warn

__all__ = [
    "Layout",
    "coordinates",
    "float_type",
    "region_weights",
    "signal_values",
    "vertex_weights",
    "without_unknown",
]


@dataclass(frozen=True)
class Layout:
    """Axes of a signal: that of the vertices is the first, or the last; all others are channels.

    Parameters
    ----------
    n_vertices : int
        Number of vertices.
    channels : tuple of int
        Lengths of the other axes, in their order.
    is_last : bool
        Whether the axis of the vertices is the last one, as in time × vertices.
    """

    n_vertices: int
    channels: tuple[int, ...] = ()
    is_last: bool = False

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the signal."""
        return (*self.channels, self.n_vertices) if self.is_last else (self.n_vertices, *self.channels)

    @property
    def n_channels(self) -> int:
        """Number of values at each vertex."""
        return math.prod(self.channels)

    def arrange(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values of (…, n, channels) numbers in the axes of the signal, as a view where possible."""
        lead = values.ndim - 2
        found = values.reshape(*values.shape[:lead], values.shape[lead], *self.channels)
        return np.moveaxis(found, lead, -1) if self.is_last else found

    def flatten(self, values: NDArray[Any]) -> NDArray[Any]:
        """The reverse of `arrange`: values in the axes of the signal as (…, n, channels) numbers."""
        lead = values.ndim - len(self.channels) - 1
        rows = np.moveaxis(values, -1, lead) if self.is_last else values
        return rows.reshape(*rows.shape[: lead + 1], self.n_channels)

    def axis_names(self) -> list[str]:
        """Names of the axes of the signal."""
        n = len(self.channels)
        names = ["channel"] if n == 1 else [f"axis_{i}" for i in range(n)]
        return [*names, "vertex"] if self.is_last else ["vertex", *names]

    def with_vertices(self, n_vertices: int) -> Layout:
        """The layout with another number of vertices."""
        return Layout(n_vertices, self.channels, self.is_last)


def coordinates(n_vertices: int) -> Layout:
    """Layout of positions, n × 3."""
    return Layout(n_vertices, (3,))


def signal_values(signal: Any, n_vertices: int, name: str = "signal") -> tuple[Floats, Layout]:
    """Values of a signal as n × channels numbers, and the axes that they come from.

    The axis of the vertices is the first if it has their number, or else the last: (n,), (n, channels), (n, 3, times)
    and (times, n) are signals.

    Raises
    ------
    TypeError
        The array holds no real numbers.
    ValueError
        No axis has the number of vertices, or a value is infinite.
    """
    is_plain = type(signal) is np.ndarray and signal.dtype == np.float64
    array = signal if is_plain else array_of(signal, name)
    layout = _layout_of(array, n_vertices, name)
    if layout.n_channels == 0:
        raise ValueError(f"{name}: shape {array.shape} has no columns")
    return finite_values(layout.flatten(array), name), layout


def without_unknown(values: Floats, name: str = "the signal") -> Floats:
    """n × channels values with NaN for −9999, 1e20, HEALPix's UNSEEN and other sentinels far from all others, with a warning."""
    found = _native.mark_unknown(values)
    if found is None:
        return values
    known, text = found
    advice = "numpy.ma.masked_array(values, False) takes them as numbers"
    warn(f"{text}; {advice}")
    return known


def _layout_of(array: Array, n: int, name: str) -> Layout:
    if array.ndim and array.shape[0] == n:
        return Layout(n, array.shape[1:])
    if array.ndim > 1 and array.shape[-1] == n:
        return Layout(n, array.shape[:-1], is_last=True)
    wanted = f"({n},), ({n}, channels), ({n}, 3, times) or (times, {n})"
    if array.ndim == 0:
        raise ValueError(f"{name}: a single number is no signal; give one value for each vertex, {wanted}")
    rows = f"{array.shape[0]} rows, but there are {n} vertices"
    raise ValueError(f"{name}: shape {array.shape} has {rows}; give {wanted}")


def vertex_weights(where: ArrayLike, n: int, name: str = "where") -> NDArray[np.float64]:
    """Weights of all vertices from (n,) numbers or flags, or from indices of vertices.

    Raises
    ------
    ValueError
        The shape is another, or an index is of no vertex.
    """
    array = np.asarray(where)
    if array.ndim == 1 and array.dtype.kind in "iu" and len(array) != n:
        return _weights_of_indices(array, n, name)
    values = values_array(where, n, name)
    if values.shape[1] != 1:
        raise ValueError(f"{name} must have one weight for each vertex, got shape {values.shape}")
    return np.ascontiguousarray(values[:, 0])


def region_weights(where: ArrayLike, n: int, name: str = "where") -> NDArray[np.float64]:
    """Weights of a region, 0 to 1, from (n,) flags or weights, or from different indices of vertices, also of all.

    Raises
    ------
    ValueError
        The shape is another, an index is of no vertex, or a weight is not in [0, 1].
    """
    array = np.asarray(where)
    if array.ndim == 1 and len(array) == n and array.dtype.kind in "iu" and n:
        low, high = int(array.min()), int(array.max())
        if low >= 0 and 1 < high < n and len(np.unique(array)) == n:
            return _weights_of_indices(array, n, name)
    weights = vertex_weights(where, n, name)
    is_bad = ~((weights >= 0) & (weights <= 1))
    if is_bad.any():
        vertex = int(np.argmax(is_bad))
        value = weights[vertex]
        advice = (
            f"pass numpy.nan_to_num({name}) to leave out vertices without a value"
            if np.isnan(value)
            else f"pass flags, as in {name}=values == {value:g}, or numpy.clip({name}, 0, 1)"
        )
        raise ValueError(f"{name}: weights must be in 0..=1, got {value:g} at vertex {vertex}; {advice}")
    return weights


def _weights_of_indices(indices: Array, n: int, name: str) -> NDArray[np.float64]:
    """1 at the vertices of these indices, and 0 elsewhere."""
    if indices.size and (int(indices.min()) < 0 or int(indices.max()) >= n):
        raise ValueError(f"{name}: indices must be in 0..={n - 1}, got {int(indices.min())} to {int(indices.max())}")
    weights = np.zeros(n)
    weights[indices] = 1.0
    return weights
