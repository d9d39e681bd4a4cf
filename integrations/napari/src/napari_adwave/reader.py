"""The reader of meshes and point clouds."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import adwave as aw
import numpy as np

LayerData = tuple[Any, dict[str, Any], str]


def reader_of(path: str | list[str]) -> Callable[[str | list[str]], list[LayerData]] | None:
    """Function that reads a path, or None if there is nothing to read; its content is checked when it is read."""
    paths = [path] if isinstance(path, str) else path
    return read if paths and all(Path(name).is_file() for name in paths) else None


def read(path: str | list[str]) -> list[LayerData]:
    """Layers of files: a surface for a mesh, points for a cloud.

    Coordinates are those of the file, x, y, z. A field of one number at each vertex becomes the values of the surface;
    the points keep all of them as features.

    Raises
    ------
    ValueError
        If a file is no mesh or cloud; the message is a line with its place.
    """
    return [layer_of(aw.read(name), Path(name).name) for name in ([path] if isinstance(path, str) else path)]


def layer_of(shape: Any, name: str) -> LayerData:
    """Layer of a shape."""
    points = np.asarray(shape.points)
    fields = {key: np.asarray(shape[key]) for key in shape.fields}
    numbers = {
        key: values for key, values in fields.items() if values.ndim == 1 and np.issubdtype(values.dtype, np.number)
    }
    faces = np.asarray(shape.faces) if shape.kind == "mesh" else np.empty((0, 3), int)
    if len(faces) == 0:
        return points, {"name": name, "features": numbers, "size": spacing(points)}, "points"
    metadata = {"adwave_fields": list(numbers)}
    if not numbers:
        return (points, faces), {"name": name, "metadata": metadata}, "surface"
    values = np.asarray(next(iter(numbers.values())), dtype=float)
    return (points, faces, values), {"name": name, "metadata": metadata, "colormap": "viridis"}, "surface"


def spacing(points: np.ndarray) -> float:
    """Mean distance of neighbors if the points lay evenly on a square of their extent: a size to draw them with."""
    if len(points) < 2:
        return 1.0
    extent = np.sort(np.ptp(points, axis=0))[::-1]
    return float(max(np.sqrt(extent[0] * extent[1] / len(points)), extent[0] / len(points)))
