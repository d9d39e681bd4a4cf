"""First arguments in another order or another grouping than a shape and its signal, and the line that works."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from adwave import _adapt
from adwave._caller import Call
from adwave._misfit import (
    SURPLUS,
    elements,
    is_edge_index,
    is_simple,
    is_square,
    looks_like_faces,
    values_of,
    working_line,
)
from adwave._option_rules import is_number, rename_keyword, wrap_grid
from adwave._other_names import NEIGHBOR_NAMES

#: Largest number of corners of a face.
MAX_CORNERS = 4
#: Largest number of columns of an array that may be positions with values, such as x, y, z, red, green, blue.
MOST_COLUMNS = 6
#: Smallest number of rows of such an array for each column; an image of so few columns has fewer.
ROWS_PER_COLUMN = 20


def check_order(function: str, shape: Any, signal: Any, known: list[str]) -> None:
    """Raise TypeError if the first arguments are in another order, or are others than a shape and a signal."""
    if function not in ("smooth", "decompose", "filter", "denoise", "saliency", "features"):
        return
    _refuse_triple(function, shape)
    _refuse_parts_by_name(function, shape)
    refuse_edge_index(function, shape, known)
    _refuse_edge_index_second(function, shape, signal, known)
    _refuse_table(function, shape, signal)
    _refuse_signal_first(function, shape, signal)
    is_array = isinstance(shape, np.ndarray)
    is_wide = is_array and shape.ndim == 2 and shape.shape[0] > 1 and shape.shape[1] > 3 and shape.shape[0] > 3
    is_volume = is_array and shape.ndim == 3 and shape.shape[1:] != (3, 3)
    if not (is_wide or is_volume) and not is_number(signal):
        return
    is_graph = is_wide and is_square(shape) and (shape == shape.T).all() and (shape >= 0).all()
    has_rows = (
        is_wide and signal is not None and np.shape(signal)[:1] == shape.shape[:1] and np.shape(signal) != shape.shape
    )
    is_samples = is_wide and not is_square(shape) and signal is not None and (has_rows or signal is shape)

    def change(call: Call) -> None:
        at = 0 if call.is_method else 1
        if is_number(signal) and len(call.arguments) > at:
            name = "sigma" if function == "smooth" and (is_wide or is_volume) else SURPLUS.get(function)
            text = call.arguments.pop(at)
            if name is not None:
                call.keywords[name] = text
        if call.is_method or not call.arguments:
            return
        text, package = call.arguments[0], call.package
        is_grid = (is_wide or is_volume) and not (is_graph or is_samples)
        neighbors = ""
        for name in [name for name in call.keywords if name not in known and not (is_grid and name == "sigma")]:
            if is_samples and name in NEIGHBOR_NAMES:
                neighbors = f"neighbors={call.keywords.pop(name)}, "
            else:
                rename_keyword(call, name, [*known, *(("sigma",) if is_grid else ())])
        text = call.arguments[0]
        if is_graph:
            call.arguments[0] = f'{package}walk({text}, normalize="row", stay=0.5)'
        elif is_samples:
            call.arguments[0] = f"{package}point_walk({text}, {neighbors}stay=0.5)"
        elif is_volume and min(shape.shape[0], shape.shape[2]) <= MAX_CORNERS:
            wrap_grid(call, axes="(0, 1)" if shape.shape[2] <= MAX_CORNERS else "(1, 2)")
        elif is_wide or is_volume:
            wrap_grid(call)

    if is_graph:
        what = "a matrix of weights between nodes is a walk, aw.walk(W, normalize='row')"
    elif is_samples:
        what = "samples of many features are the nodes of a graph of neighbors, aw.point_walk(X)"
    elif is_wide or is_volume:
        what = f"an array of shape {np.shape(shape)} is no list of points; an image or a volume is aw.grid(array)"
    else:
        what = f"a single number is no signal, got {signal!r}"
    raise TypeError(f"{function}: {what}{working_line(function, change, f'aw.{function}(aw.grid(array))')}")


def _refuse_signal_first(function: str, shape: Any, signal: Any) -> None:
    """Raise TypeError for a signal before its shape."""
    is_flat = np.ndim(shape) == 1 if isinstance(shape, np.ndarray) else type(shape).__name__ == "Series"
    is_flat = is_flat or (type(shape) is list and _adapt.depth(shape) == 1)
    is_shape = isinstance(signal, tuple) or np.ndim(signal) == 2 if is_flat and not _adapt.is_domain(signal) else False
    if not is_shape and not ((is_flat or isinstance(shape, np.ndarray)) and _adapt.is_domain(signal)):
        return

    def swap(call: Call) -> None:
        call.arguments[:2] = [call.arguments[1], call.arguments[0]]

    line = working_line(function, swap, f"aw.{function}(shape, f)")
    raise TypeError(f"{function}: the shape comes first and its signal second{line}")


def _refuse_triple(function: str, shape: Any) -> None:
    """Raise TypeError for points, faces and values in one tuple."""
    if not isinstance(shape, (tuple, list)) or len(shape) != 3 or _adapt.depth(shape[0]) != 2:
        return
    if not looks_like_faces(shape[0], shape[1]):
        return

    def split(call: Call) -> None:
        parts = elements(call.arguments[0]) if call.arguments else None
        if parts is None:
            text = call.arguments[0] if call.arguments else "shape"
            parts = [f"{text}[0]", f"{text}[1]", f"{text}[2]"]
        call.arguments[:1] = [f"({parts[0]}, {parts[1]})", parts[2]]

    line = working_line(function, split, f"aw.{function}((V, F), f)")
    raise TypeError(f"{function}: points and faces go in a pair, and values at the vertices come second{line}")


def refuse_edge_index(function: str, shape: Any, known: list[str]) -> None:
    """Raise TypeError for the edges of a graph, 2 × E indices."""
    if not is_edge_index(shape):
        return
    sizes = np.shape(shape)

    def wrap(call: Call) -> None:
        if call.arguments and not call.is_method:
            call.arguments[0] = f"{call.package}from_edge_index({call.arguments[0]})"
        for name in [name for name in call.keywords if name not in known]:
            rename_keyword(call, name, known)

    line = working_line(function, wrap, f"aw.{function}(aw.from_edge_index(edge_index), x)")
    raise TypeError(f"{function}: an array of 2 × {sizes[1]} indices is the edges of a graph{line}")


def _refuse_edge_index_second(function: str, shape: Any, signal: Any, known: list[str]) -> None:
    """Raise TypeError for features of nodes before the edges of their graph."""
    if not hasattr(type(shape), "__array__") or _adapt.is_domain(shape) or not is_edge_index(signal):
        return
    sizes = np.shape(shape)
    if not sizes or np.asarray(signal).max() >= sizes[0]:
        return

    def swap(call: Call) -> None:
        if len(call.arguments) > 1 and not call.is_method:
            call.arguments[:2] = [f"{call.package}from_edge_index({call.arguments[1]})", call.arguments[0]]
        for name in [name for name in call.keywords if name not in known]:
            rename_keyword(call, name, known)

    line = working_line(function, swap, f"aw.{function}(aw.from_edge_index(edge_index), x)")
    raise TypeError(f"{function}: the graph comes first, and the features of its nodes second{line}")


def _refuse_table(function: str, shape: Any, signal: Any) -> None:
    """Raise TypeError for an array whose rows are positions and values: x, y, z and one to three more."""
    if not isinstance(shape, np.ndarray) or shape.ndim != 2 or signal is not None or shape.dtype.kind not in "fiu":
        return
    n, width = shape.shape
    if not 3 < width <= MOST_COLUMNS or n < ROWS_PER_COLUMN * width:
        return
    values = "3" if width == 4 else "3:"

    def split(call: Call) -> None:
        if call.arguments and not call.is_method:
            text = call.arguments[0] if is_simple(call.arguments[0]) else f"({call.arguments[0]})"
            call.arguments[:1] = [f"{text}[:, :3]", f"{text}[:, {values}]"]

    line = working_line(function, split, f"aw.{function}(points[:, :3], points[:, {values}])")
    raise TypeError(
        f"{function}: are the {width} columns x, y, z and values? Points have 3, and values come second; an image is "
        f"aw.grid(array), samples of {width} features are aw.point_walk(X){line}"
    )


def _refuse_parts_by_name(function: str, shape: Any) -> None:
    """Raise TypeError for several shapes in a dictionary, such as both hemispheres."""
    if not isinstance(shape, Mapping) or len(shape) < 2:
        return
    if not all(_adapt.is_domain(part) or _is_pair(part) for part in shape.values()):
        return

    def join(call: Call) -> None:
        if call.arguments and not call.is_method:
            parts = values_of(call.arguments[0])
            call.arguments[0] = f"({', '.join(parts)})" if parts else f"tuple({call.arguments[0]}.values())"

    line = working_line(function, join, f"aw.{function}((left, right), f)")
    raise TypeError(f"{function}: several shapes go in a tuple, and their values one after the other{line}")


def _is_pair(part: Any) -> bool:
    return isinstance(part, (tuple, list)) and len(part) == 2 and _adapt.depth(part[0]) == 2


def ask_about_faces(function: str, shape: object, second: object, known: Sequence[str] = ()) -> None:
    """Raise TypeError if the second argument looks like the faces of an array of points.

    Parameters
    ----------
    function : str
        Name of the function, for the message.
    shape, second : object
        The first two arguments.
    known : sequence of str
        Options of the function; those that are none of them are renamed in the line.
    """
    if isinstance(second, str) or not isinstance(shape, (np.ndarray, list)):
        return
    if _adapt.depth(shape) != 2 or _adapt.depth(second) not in (1, 2) or not looks_like_faces(shape, second):
        return
    rest = {"match": "(V2, F2)", "distances": "(V2, F2)", "filter": '"smooth"'}.get(function, "f")

    def join(call: Call) -> None:
        if len(call.arguments) > 1:
            call.arguments[:2] = [f"({call.arguments[0]}, {call.arguments[1]})"]
        for name in [name for name in call.keywords if known and name not in known]:
            rename_keyword(call, name, known)
        if function in ("match", "distances"):
            call.arguments.append(rest)

    otherwise = f"aw.{function}((V, F))" if rest == "f" and function != "smooth" else f"aw.{function}((V, F), {rest})"
    line = working_line(function, join, otherwise)
    advice = "; a signal of whole numbers goes as F.astype(float)" if rest in ("f", '"smooth"') else ""
    raise TypeError(
        f"{function}: are these the faces of the points? They go in a pair, (V, F), or as faces=F{advice}{line}"
    )
