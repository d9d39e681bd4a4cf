"""Points, values, faces and edges as checked arrays of the types that the extension takes.

Whatever real type, order and byte order an array has, it is converted; where it needs none of that it is
passed on as it is. Every check is one pass over the array, and looks for the row to name only once it failed.
"""

from __future__ import annotations

import math
from itertools import chain, pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Floats = NDArray[np.float64]
Indices = NDArray[np.uint32]
Offsets = NDArray[np.int64]

_MAX_CORNERS = 2**32 - 1
_DLPACK_HOST = (1, 3)  # kDLCPU, kDLCUDAHost: memory that the processor reads directly
# A view into packed bytes can be contiguous and yet lie across word boundaries.
_DIRECT: tuple[Literal["C"], Literal["A"]] = ("C", "A")


def kind_of(x: object) -> str:
    """Type of `x`, for messages."""
    cls = type(x)
    name = cls.__qualname__ if cls.__module__ == "builtins" else f"{cls.__module__}.{cls.__qualname__}"
    return f"an object of type {name}"


def is_array(x: object) -> bool:
    """True if `x` is a NumPy array or implements one of the array interfaces."""
    return any(hasattr(x, name) for name in ("__array__", "__array_interface__", "__dlpack__"))


def depth(x: Any) -> int:
    """Number of dimensions; of nested lists by their first elements."""
    if (shape := getattr(x, "shape", None)) is not None:
        return len(shape)
    if is_array(x):
        return array_of(x, "shape").ndim
    if isinstance(x, (str, bytes)) or not (hasattr(x, "__len__") and hasattr(x, "__getitem__")):
        return 0
    return 1 + (depth(x[0]) if len(x) else 0)


def array_of(x: Any, name: str) -> Array:
    """`x` as an array of real numbers of any type and order, without a copy if it is one."""
    if hasattr(x, "toarray") and hasattr(x, "nnz"):  # a sparse matrix
        x = x.toarray()
    if np.ma.is_masked(x):
        x = np.ma.filled(np.ma.asarray(x, np.float64), np.nan)
    is_foreign = not isinstance(x, np.ndarray)
    if is_foreign and hasattr(x, "__dlpack_device__"):
        device = x.__dlpack_device__()[0]
        # Open3D's enumeration is not an integer.
        if getattr(device, "value", device) not in _DLPACK_HOST:
            raise TypeError(f"{name}: {kind_of(x)} is not in CPU memory; call .cpu() on it first")
    array: Array
    try:
        if is_foreign and hasattr(x, "__dlpack__") and not hasattr(x, "__array__"):
            array = np.from_dlpack(x)
        else:
            array = np.asarray(x)
        if array.dtype.kind == "O" and (to_numpy := getattr(x, "to_numpy", None)) is not None:
            # Columns of pandas' nullable types come as objects; their missing values are to become NaN.
            array = to_numpy(dtype=np.float64, na_value=np.nan)
    except (TypeError, ValueError, RuntimeError, BufferError, OverflowError, AttributeError) as error:
        _refuse_uneven(x, name)
        why = " ".join(str(error).split())
        raise TypeError(f"{name}: {kind_of(x)} cannot be read as an array of numbers: {why}") from error
    if array.dtype.kind not in "biuf":
        _refuse_uneven(x, name)
        raise TypeError(
            f"{name}: dtype {array.dtype} is not a type of real numbers; pass an array of integers or floats"
        )
    return array


def float_type(signal: object) -> np.dtype[Any]:
    """Number type of results: that of a signal of 16 or 32 bits, and float64 for all others."""
    dtype: Any = getattr(signal, "dtype", None)
    is_short = isinstance(dtype, np.dtype) and dtype.kind == "f" and dtype.itemsize < 8
    return dtype.newbyteorder("=") if is_short else np.dtype(np.float64)


def _refuse_uneven(x: Any, name: str) -> None:
    if not isinstance(x, (list, tuple)) or not x:
        return
    lengths = [len(row) if hasattr(row, "__len__") else 1 for row in x]
    row = next((row for row, length in enumerate(lengths) if length != lengths[0]), None)
    if row is not None:
        raise ValueError(f"{name}: row {row} has {lengths[row]} entries, but row 0 has {lengths[0]}")


def _float64(array: Array) -> Floats:
    flags = array.flags
    if array.dtype == np.float64 and flags.c_contiguous and flags.aligned and array.dtype.isnative:
        return array
    # A long double too large for a double becomes an infinity, which the callers report.
    with np.errstate(over="ignore"):
        return np.require(array, np.float64, _DIRECT)


def points_array(points: object, name: str = "points") -> Floats:
    """Points as an (n, 3) float64 array, without a copy if they are one; (n, 2) gets z = 0.

    Raises
    ------
    TypeError
        The array holds no real numbers.
    ValueError
        The shape is not (n, 3) or (n, 2), or a coordinate is NaN or infinite.
    """
    array = array_of(points, name)
    if array.dtype.kind == "b":
        raise TypeError(f"{name}: coordinates cannot be bool; pass an array of integers or floats")
    if array.shape == (0,):
        return np.empty((0, 3))
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise ValueError(f"{name}: shape {array.shape} {_points_hint(array.shape, name)}")
    result = _float64(array)
    if array.shape[1] == 2:
        result = np.column_stack([result, np.zeros(len(result))])
    finite = np.isfinite(result)
    if not finite.all():
        row = int(np.argmin(finite.all(axis=1)))
        raise ValueError(f"{name}: row {row} is {result[row].tolist()}; coordinates must be finite")
    return result


def _points_hint(shape: tuple[int, ...], name: str) -> str:
    if len(shape) == 2 and shape[0] in (2, 3) and shape[1] > 3:
        return f"looks transposed; pass {name}.T"
    if len(shape) == 2 and shape[0] == shape[1]:
        return "looks like weights between nodes; pass scipy.sparse.csr_array of it for a graph"
    if len(shape) == 2 and shape[1] > 3:
        return (
            f"has {shape[1]} columns, but positions have 2 or 3: values at the vertices of a shape are a signal, "
            "aw.decompose(shape, values); samples with many features are the nodes of a graph, "
            "aw.decompose(aw.point_walk(X, stay=0.5), X); columns x, y, z and others are "
            f"aw.decompose({name}[:, :3], {name}[:, 3:]); an image is aw.decompose(aw.grid({name}))"
        )
    if len(shape) == 3 and shape[2] in (3, 4) and min(shape[:2]) > 3:
        return "looks like an image, which is a grid of channels: aw.decompose(aw.grid(image, axes=(0, 1)))"
    if len(shape) == 1 and shape[0] % 3 == 0:
        return f"has one dimension; pass {name}.reshape(-1, 3)"
    if len(shape) == 3 and shape[1:] != (3, 3):
        return "looks like a volume, which is a grid: aw.decompose(aw.grid(volume))"
    if shape[1:] == (3, 3):
        return "looks like separate triangles; join equal corners, and pass points and faces"
    return "is not one row per vertex, (n, 3) or (n, 2)"


def values_array(values: object, n_vertices: int, name: str = "signal") -> Floats:
    """Values per vertex, (n,) or (n, c), as an (n, c) float64 array.

    NaN means that there is no value; masked entries become NaN.

    Raises
    ------
    TypeError
        The array holds no real numbers.
    ValueError
        The shape is another, or a value is infinite.
    """
    array = _rows_of(array_of(values, name), n_vertices, name)
    if array.shape[1:] == (0,):
        raise ValueError(f"{name}: shape {array.shape} has no columns")
    return finite_values(array[:, np.newaxis] if array.ndim == 1 else array, name)


def finite_values(array: Array, name: str) -> Floats:
    """An (n, c) array as float64 without infinite values; NaN means that there is no value.

    Raises
    ------
    ValueError
        A value is infinite.
    """
    result = _float64(array)
    # The sum of finite numbers is finite, unless it overflows.
    if math.isfinite(result.sum()):
        return result
    infinite = np.isinf(result)
    if infinite.any():
        row = int(np.argmax(infinite.any(axis=1)))
        raise ValueError(f"{name}: row {row} is {result[row].tolist()}; values must be finite, or NaN for none")
    return result


def field_array(values: object, n_rows: int, name: str) -> Array:
    """Values per vertex or face in their own type, made contiguous and of the machine's byte order."""
    array = _rows_of(array_of(values, name), n_rows, name)
    if array.dtype.kind == "b":
        array = array.view(np.uint8)
    if array.dtype.itemsize > 8:
        return _float64(array)
    return np.require(array, array.dtype.newbyteorder("="), _DIRECT)


def _rows_of(array: Array, n_rows: int, name: str) -> Array:
    if array.ndim in (1, 2) and array.shape[0] == n_rows:
        return array
    if array.ndim == 2 and array.shape[1] == n_rows:
        raise ValueError(f"{name}: shape {array.shape} looks transposed; pass {name}.T")
    if array.ndim in (1, 2):
        rows = f"{array.shape[0]} rows, but there are {n_rows} vertices"
        raise ValueError(f"{name}: shape {array.shape} has {rows}")
    raise ValueError(f"{name}: shape {array.shape} is neither ({n_rows},) nor ({n_rows}, columns)")


def weights_array(weights: object, n_edges: int) -> Floats | None:
    """Weights of the edges, one for each; None stays None."""
    if weights is None:
        return None
    array = _float64(array_of(weights, "weights"))
    if array.shape != (n_edges,):
        raise ValueError(f"weights: shape {array.shape} is not one per edge, ({n_edges},)")
    # Entries of 0 are no edges.
    is_bad = ~np.isfinite(array) | (array < 0)
    if is_bad.any():
        row = int(np.argmax(is_bad))
        raise ValueError(
            f"weights: edge {row} has the weight {array[row]:g}, but weights are positive and finite: they say how "
            "alike both ends are; take exp(-distance²/scale²) of distances"
        )
    return array


def faces_arrays(faces: Any, n_points: int) -> tuple[Indices, Indices | None]:
    """Corners and offsets of faces in any accepted form; no offsets if all are triangles."""
    corners, offsets = _cells(faces, n_points, "faces", fewest=3)
    if isinstance(offsets, int):
        return corners, None if offsets == 3 else np.arange(0, corners.size + 1, offsets, dtype=np.uint32)
    return corners, offsets.astype(np.uint32)


def edges_of_lines(lines: Any, n_points: int) -> tuple[Indices, Indices]:
    """Both ends of every edge of polylines."""
    corners, offsets = _cells(lines, n_points, "lines", fewest=2)
    ends = np.arange(0, corners.size + 1, offsets) if isinstance(offsets, int) else offsets
    begins = np.delete(np.arange(corners.size), ends[1:] - 1)
    return corners[begins], corners[begins + 1]


def _cells(cells: Any, n_points: int, name: str, fewest: int) -> tuple[Indices, Offsets | int]:
    """Corners of all cells, with the offsets of the cells or their common length."""
    if isinstance(cells, np.ndarray) and cells.dtype.kind == "O" and cells.ndim == 1:
        cells = cells.tolist()
    lengths = _lengths(cells)
    if _is_corners_and_offsets(cells, fewest):
        corners = array_of(cells[0], name)
        offsets = _checked_offsets(array_of(cells[1], name), corners, name)
    elif lengths is not None and (lengths != lengths[0]).any():
        corners = array_of(list(chain.from_iterable(cells)), name)
        offsets = np.concatenate([np.zeros(1, np.int64), np.cumsum(lengths)])
    else:
        corners = array_of(cells, name)
        if corners.size == 0:
            return np.empty(0, np.uint32), 3
        offsets = None
        if corners.ndim == 1:
            corners, offsets = _unpadded(corners, name)
        elif corners.ndim != 2 or corners.shape[1] < fewest or _is_transposed(corners, n_points):
            raise ValueError(f"{name}: shape {corners.shape} {_cells_hint(corners, n_points, name)}")
    if corners.size > _MAX_CORNERS:
        raise ValueError(f"{name}: {corners.size} corners are more than the {_MAX_CORNERS} that can be indexed")
    width = corners.shape[1] if offsets is None else _common_length(offsets, name, fewest)
    flat = index_array(corners, n_points, name, "corner", offsets)
    return flat, width if offsets is None or width else offsets


def _common_length(offsets: Offsets, name: str, fewest: int) -> int:
    """Common length of all cells, or 0."""
    lengths = np.diff(offsets)
    shortest = int(lengths.min(initial=2**62))
    if shortest < fewest:
        row = int(np.argmax(lengths < fewest))
        raise ValueError(f"{name}: row {row} has length {lengths[row]}, but at least {fewest} corners are needed")
    return shortest if lengths.size and shortest == lengths.max() else 0


def _lengths(cells: Any) -> Offsets | None:
    """Length of each row of a list of lists."""
    if not isinstance(cells, (list, tuple)) or not cells or not all(hasattr(cell, "__len__") for cell in cells):
        return None
    return np.fromiter(map(len, cells), np.int64, len(cells))


def _cells_hint(cells: Array, n_points: int, name: str) -> str:
    if cells.ndim == 2 and _is_transposed(cells, n_points):
        return f"looks transposed; pass {name}.T"
    if cells.ndim == 2 and cells.shape[1] == 2:
        return "holds edges, not faces; make a graph of them"
    return "is not one row of corners per face, (m, 3)"


def _is_transposed(cells: Array, n_points: int) -> bool:
    """True if three or four long rows are transposed faces: a polygon would have each vertex once."""
    if cells.shape[0] not in (3, 4) or cells.shape[1] <= 4:
        return False
    return cells.shape[1] > n_points or any(np.unique(row).size < row.size for row in cells)


def _is_corners_and_offsets(cells: Any, fewest: int) -> bool:
    """True if a pair is (corners, offsets): two 1-D arrays, or two lists the second of which can be offsets."""
    if not isinstance(cells, tuple) or len(cells) != 2 or any(depth(part) != 1 for part in cells):
        return False
    corners, offsets = cells
    if hasattr(corners, "dtype") and hasattr(offsets, "dtype"):
        return True
    steps = [after - before for before, after in pairwise(offsets)]
    return bool(steps) and offsets[0] == 0 and offsets[-1] == len(corners) and min(steps) >= fewest


def _checked_offsets(offsets: Array, corners: Array, name: str) -> Offsets:
    if offsets.dtype.kind not in "iu":
        raise TypeError(f"{name}: offsets of dtype {offsets.dtype}; pass (corners, offsets), both of integers")
    if offsets.size == 0 or offsets[0] != 0 or offsets[-1] != corners.size:
        raise ValueError(
            f"{name}: offsets go from {offsets[:1].tolist()} to {offsets[-1:].tolist()}, but must go from 0 "
            f"to {corners.size}, the number of corners"
        )
    return offsets.astype(np.int64, copy=False)


def _unpadded(padded: Array, name: str) -> tuple[Array, Offsets | None]:
    """Corners and offsets of [3, a, b, c, 4, ...]; rows of corners if all lengths are equal."""
    padded = _whole(padded, name, "entry")
    width = int(padded[0]) + 1
    if width > 1 and padded.size % width == 0 and (padded[::width] == width - 1).all():
        return padded.reshape(-1, width)[:, 1:], None
    counts: list[int] = padded.tolist()
    starts: list[int] = []
    at = 0
    while at < len(counts):
        if not 0 < counts[at] < len(counts) - at:
            raise ValueError(
                f"{name}: entry {at} is {counts[at]}, which is not the number of corners that follow; a 1-D array "
                f"is read as [3, a, b, c, 4, ...]; pass {name}.reshape(-1, 3) if these are triangles"
            )
        starts.append(at)
        at += counts[at] + 1
    ends = np.array([*starts, at], np.int64)
    return np.delete(padded, starts), ends - np.arange(ends.size)


def _whole(array: Array, name: str, item: str, offsets: Offsets | None = None) -> Array:
    """Indices as integers; floats must be integers."""
    if array.dtype.kind == "b":
        raise TypeError(f"{name}: indices cannot be bool; pass an array of integers")
    if array.dtype.kind != "f":
        return array
    with np.errstate(invalid="ignore"):
        whole = array.astype(np.int64)
    if (whole != array).any():
        raise ValueError(f"{name}: {_bad(array, whole != array, item, offsets)}, which is not an index")
    return whole


def index_array(array: Array, n: int, name: str, item: str, offsets: Offsets | None = None) -> Indices:
    """All entries of `array` as flat uint32, checked to be below `n`; `offsets` tell the rows of corners."""
    array = _whole(array, name, item, offsets)
    if array.size:
        # One pass for both ends: read as unsigned, a negative number is larger than any count.
        is_signed = array.dtype.kind == "i"
        largest = int((array.view(array.dtype.str.replace("i", "u")) if is_signed else array).max())
        if largest >= n:
            raise ValueError(_outside(array, n, name, item, offsets))
    if array.dtype == np.int32:
        array = array.view(np.uint32)
    return np.require(array, np.uint32, _DIRECT).reshape(-1)


def _outside(array: Array, n: int, name: str, item: str, offsets: Offsets | None) -> str:
    if (array < 0).any():
        hint = "; faces of several lengths go as a list of lists" if item == "corner" else ""
        return f"{name}: {_bad(array, array < 0, item, offsets)}, but {item}s count from 0{hint}"
    hint = f"; they count from 0: pass {name} - 1" if array.min() == 1 and array.max() == n else ""
    things = "points" if item == "corner" else f"{item}s"
    return f"{name}: {_bad(array, array >= n, item, offsets)}, but there are {n} {things}{hint}"


def _bad(array: Array, is_bad: NDArray[np.bool_], item: str, offsets: Offsets | None) -> str:
    """Description of the first bad entry, for messages."""
    at = int(np.argmax(is_bad))
    if offsets is not None and array.ndim == 1:
        row = int(np.searchsorted(offsets, at, "right")) - 1
    else:
        row = at // (array.shape[1] if array.ndim == 2 else 1)
    return f"row {row} has {item} {array.reshape(-1)[at].item()}"
