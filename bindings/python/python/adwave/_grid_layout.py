"""Axes of images and volumes: which of an array are the grid's, and results back in the caller's axes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from adwave._adapt_arrays import Array, Floats, array_of
from adwave._layout import Layout

#: Largest number of axes of a grid.
MAX_AXES = 3
#: Largest number of places along an axis that may be channels instead: gray and alpha, RGB, RGBA.
MAX_COLORS = 4


@dataclass(frozen=True)
class GridLayout(Layout):
    """Axes of a signal on a grid: those of the grid, in its order, and all others, which are channels.

    Parameters
    ----------
    sizes : tuple of int
        Number of places along each axis of the grid.
    axes : tuple of int
        Axis of the signal for each of these; ``is_last`` unless they are the first ones in their order.
    """

    sizes: tuple[int, ...] = ()
    axes: tuple[int, ...] = ()

    @classmethod
    def for_axes(cls, shape: tuple[int, ...], axes: tuple[int, ...]) -> GridLayout:
        """Layout of a signal of this shape with these axes of the grid."""
        sizes = tuple(shape[axis] for axis in axes)
        channels = tuple(size for axis, size in enumerate(shape) if axis not in axes)
        return cls(math.prod(sizes), channels, axes != tuple(range(len(axes))), sizes, axes)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the signal."""
        sizes, channels = dict(zip(self.axes, self.sizes, strict=True)), iter(self.channels)
        return tuple(sizes[i] if i in sizes else next(channels) for i in range(len(self.sizes) + len(self.channels)))

    def arrange(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values of (…, n, channels) numbers in the axes of the signal, as a view where possible."""
        lead = values.ndim - 2
        found = values.reshape(*values.shape[:lead], *self.sizes, *self.channels)
        if not self.is_last:
            return found
        return np.moveaxis(found, range(lead, lead + len(self.axes)), [lead + axis for axis in self.axes])

    def flatten(self, values: NDArray[Any]) -> NDArray[Any]:
        """The reverse of `arrange`: values in the axes of the signal as (…, n, channels) numbers."""
        lead = values.ndim - len(self.axes) - len(self.channels)
        if self.is_last:
            values = np.moveaxis(values, [lead + axis for axis in self.axes], range(lead, lead + len(self.axes)))
        return values.reshape(*values.shape[:lead], self.n_vertices, self.n_channels)

    def axis_names(self) -> list[str]:
        """Names of the axes of the signal."""
        own, n_others = dict(zip(self.axes, "ijk", strict=False)), len(self.channels)
        others = iter(["channel"] if n_others == 1 else [f"channel_{i}" for i in range(n_others)])
        return [own[i] if i in own else next(others) for i in range(len(self.axes) + n_others)]


def grid_axes(shape: tuple[int, ...], axes: object = None) -> tuple[int, ...]:
    """The axes of an array of this shape that are the grid's.

    Raises
    ------
    TypeError
        If `axes` is no axis and no sequence of axes.
    ValueError
        If the array has none, several readings, or not these axes.
    """
    if not shape:
        raise ValueError("array: a single number is no grid; pass an image or a volume, aw.grid(np.zeros((64, 64)))")
    if 0 in shape:
        raise ValueError(
            f"array: shape {shape} has no places; a grid has at least one, as in aw.grid(np.zeros((64, 64)))"
        )
    if axes is None:
        return _own_axes(shape)
    return _chosen_axes(shape, axes)


def _own_axes(shape: tuple[int, ...]) -> tuple[int, ...]:
    n = len(shape)
    if n < MAX_AXES:
        return tuple(range(n))
    volume = "aw.grid(array, axes=(0, 1, 2))"
    if n == MAX_AXES:
        if shape[-1] > MAX_COLORS and shape[0] > MAX_COLORS:
            return (0, 1, 2)
        is_last = shape[-1] <= MAX_COLORS
        image, count = ("(0, 1)", shape[-1]) if is_last else ("(1, 2)", shape[0])
        raise ValueError(
            f"array: shape {shape} is an image of {count} channels or a volume of {count} slices; say which, "
            f"aw.grid(array, axes={image}) for the image or {volume} for the volume"
        )
    raise ValueError(
        f"array: shape {shape} has {n} axes, of which at most {MAX_AXES} are the grid's; name them, {volume} for volumes "
        f"whose channels or times come last, aw.grid(array, axes={tuple(range(n - MAX_AXES, n))}) if they come first, or "
        "aw.grid(array, axes=(0, 1)) for images"
    )


def _chosen_axes(shape: tuple[int, ...], axes: Any) -> tuple[int, ...]:
    given: list[Any] = list(axes) if isinstance(axes, (tuple, list, range)) else [axes]
    if not all(isinstance(axis, (int, np.integer)) and not isinstance(axis, bool) for axis in given):
        raise TypeError(f"axes must be axes of the array, such as axes=(0, 1), got {axes!r}")
    n = len(shape)
    found = tuple(int(axis) + n if axis < 0 else int(axis) for axis in given)
    if not 1 <= len(found) <= MAX_AXES or len(set(found)) < len(found) or not all(0 <= axis < n for axis in found):
        first = tuple(range(min(n, 2)))
        raise ValueError(
            f"axes must be 1 to {min(n, MAX_AXES)} different axes in {-n}..={n - 1} of an array of shape {shape}, such as "
            f"axes={first}, got {axes!r}"
        )
    return found


def plain_array(array: object, name: str = "array") -> Array:
    """An array of real numbers in its own type, from an array or nested lists.

    Raises
    ------
    TypeError
        If the numbers are complex or no numbers, with the line that works.
    ValueError
        If a list is short enough to be sizes.
    """
    if isinstance(array, (list, tuple)):
        _refuse_sizes(array)
    if getattr(getattr(array, "dtype", None), "kind", "") == "c":
        raise TypeError(
            f"{name}: complex numbers; pass abs({name}), or both parts as channels, "
            f"aw.grid(np.stack([{name}.real, {name}.imag], axis=-1), axes=(0, 1))"
        )
    dtype = getattr(array, "dtype", None)
    if getattr(dtype, "kind", "") == "O":
        raise TypeError(f"{name}: dtype object is not a type of numbers; pass {name}.astype(float)")
    if getattr(dtype, "names", None):
        raise TypeError(f"{name}: its entries have fields; pass one of them, {name}[{dtype.names[0]!r}]")  # type: ignore[union-attr]
    found = array_of(array, name)
    if np.ma.isMaskedArray(array) and not np.ma.is_masked(array):
        return np.asarray(array)
    return found


def _refuse_sizes(array: Sequence[Any]) -> None:
    whole = all(isinstance(size, (int, np.integer)) and not isinstance(size, bool) for size in array)
    if 1 <= len(array) <= MAX_AXES and whole:
        sizes = tuple(int(size) for size in array)
        raise TypeError(
            f"array: {array!r} is either sizes or values; pass aw.grid(np.zeros({sizes})) for a grid of these sizes, or "
            f"aw.grid(np.array({list(sizes)})) for these values"
        )


def finite_grid(values: Array, layout: GridLayout, name: str = "signal") -> Floats:
    """Values of a signal as n × channels numbers; NaN means that there is no value.

    Raises
    ------
    ValueError
        If a value is infinite, with its place.
    """
    rows = np.require(layout.flatten(values), np.float64, ("C", "A"))
    # The sum of finite numbers is finite, unless it overflows.
    if not math.isfinite(rows.sum()):
        infinite = np.isinf(rows)
        if infinite.any():
            place = np.unravel_index(int(np.argmax(infinite.any(axis=1))), layout.sizes)
            at = ", ".join(str(int(i)) for i in place)
            raise ValueError(
                f"{name}: the value at ({at}) is infinite; values must be finite, or NaN for none: pass "
                f"np.where(np.isinf({name}), np.nan, {name})"
            )
    return rows
