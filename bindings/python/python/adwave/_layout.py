"""Axes of a signal: the caller's array as n × channels numbers, and results back in the caller's axes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave._adapt_arrays import Array, Floats, array_of, finite_values, values_array


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
    is_indices = array.ndim == 1 and array.dtype.kind in "iu" and len(array) != n
    if is_indices:
        if array.size and (int(array.min()) < 0 or int(array.max()) >= n):
            raise ValueError(f"{name}: indices must be in 0..={n - 1}, got {int(array.min())} to {int(array.max())}")
        weights = np.zeros(n)
        weights[array] = 1.0
        return weights
    values = values_array(where, n, name)
    if values.shape[1] != 1:
        raise ValueError(f"{name} must have one weight for each vertex, got shape {values.shape}")
    return np.ascontiguousarray(values[:, 0])
