"""Signals that are mapped from files, a group of channels at a time."""

from __future__ import annotations

import mmap
import tempfile
from collections.abc import Callable
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from adwave import _native

#: Number of bytes that a group may take, with its bands.
_GROUP_BYTES = 1 << 28
#: Groups are multiples of this, so that no block of the products is narrow.
_GROUP_OF = 32


def channels_axis(signal: object, n_vertices: int) -> Union[int, None]:
    """The axis of the channels of a mapped signal that is processed in groups; None for any other signal."""
    if not isinstance(signal, np.memmap) or signal.ndim != 2:
        return None
    axis = 1 if signal.shape[0] == n_vertices else 0
    is_wide = signal.shape[1 - axis] == n_vertices and signal.shape[axis] >= _native.MANY_CHANNELS
    return axis if is_wide else None


def map_columns(
    signal: np.memmap[Any, Any],
    axis: int,
    n_bands: int,
    compute: Callable[[NDArray[Any]], NDArray[np.float64]],
) -> np.memmap[Any, np.dtype[np.float64]]:
    """Results of `compute` for groups of channels, which take `n_bands` times their memory, side by side.

    The result is mapped from a file without a name in the system's folder for temporary files, and goes with the array.
    """
    n_channels, n_vertices = signal.shape[axis], signal.shape[1 - axis]
    with tempfile.TemporaryFile() as file:
        result = np.memmap(file, dtype=np.float64, mode="w+", shape=signal.shape)
    fitting = _GROUP_BYTES // max(8 * n_vertices * n_bands, 1) // _GROUP_OF * _GROUP_OF
    size = max(fitting, _GROUP_OF)
    for start in range(0, n_channels, size):
        group = (slice(None), slice(start, start + size)) if axis == 1 else slice(start, start + size)
        result[group] = compute(np.array(signal[group]))
        for mapped in (signal, result):
            _release(mapped)
    return result


def _release(mapped: np.memmap[Any, Any]) -> None:
    """Let the system take back the pages of a file that is mapped without private changes."""
    pages = getattr(mapped, "_mmap", None)
    if pages is None or mapped.mode == "c" or not hasattr(mmap, "MADV_DONTNEED"):
        return
    if mapped.mode != "r":
        mapped.flush()
    pages.madvise(mmap.MADV_DONTNEED)
