"""Shapes of any kind as plain arrays.

`parts_of` takes arrays, lists, a pair of points and faces, or an object of trimesh, PyVista, meshio, Open3D, NetworkX,
SciPy or pandas, and returns `Parts`: checked arrays in the types that the extension takes. C-contiguous float64 points are
not copied. `with_results` is the reverse. The order and number of vertices and faces never change, and the caller's
objects are never written to.
"""

from __future__ import annotations

import operator
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeGuard

import numpy as np

from ._adapt_arrays import (
    Array,
    Floats,
    Indices,
    array_of,
    depth,
    edges_of_lines,
    faces_arrays,
    field_array,
    float_type,
    index_array,
    is_array,
    kind_of,
    points_array,
    values_array,
    weights_array,
)
from ._adapt_objects import (
    SIGNALS,
    Found,
    by_keys,
    by_names,
    face_key,
    has_shape_names,
    library_of,
    point_key,
    read,
    warn_of_weights,
)
from ._adapt_results import has_place, rebuild
from ._grid_objects import is_image, library_of_grid

__all__ = [
    "Parts",
    "can_hold_results",
    "depth",
    "graph_parts",
    "has_nodes",
    "holds_fields",
    "is_path",
    "own_signal",
    "parts_of",
    "points_array",
    "stores_normals",
    "values_array",
    "with_results",
]


def _no_indices() -> Indices:
    return np.empty(0, np.uint32)


@dataclass(slots=True)
class Parts:
    """A shape as plain arrays.

    Attributes
    ----------
    kind
        What the shape is walked on as.
    n_vertices
        Number of vertices, or nodes of a graph.
    points
        Positions, (n, 3), C-contiguous and of the machine's byte order; the caller's own memory where it was
        so already (it may be read-only). None for a graph without positions.
    corners
        The corners of all faces, one face after the other; empty for clouds and graphs.
    offsets
        Where each face begins in `corners`, and the end of the last, (m + 1,); None where all are triangles.
    rows, cols, weights
        Edges of a graph; weights None where every edge counts 1.
    is_symmetric_list
        True where each undirected edge is listed once; False where each entry is one of a matrix, so that an
        undirected edge is listed in both directions.
    fields, face_fields
        Values per vertex and per face, (n,) or (n, c), of any real type of at most 8 bytes.
    source
        The library the shape came from: 'trimesh', 'pyvista', ..., 'dlpack' or 'arrays'.
    lost
        What the object has and a `Shape` has no place for.
    """

    kind: Literal["mesh", "cloud", "graph"]
    n_vertices: int
    points: Floats | None = None
    corners: Indices = field(default_factory=_no_indices)
    offsets: Indices | None = None
    rows: Indices = field(default_factory=_no_indices)
    cols: Indices = field(default_factory=_no_indices)
    weights: Floats | None = None
    is_symmetric_list: bool = True
    fields: dict[str, Array] = field(default_factory=dict)
    face_fields: dict[str, Array] = field(default_factory=dict)
    source: str = "arrays"
    lost: tuple[str, ...] = ()


def is_path(shape: object) -> TypeGuard[str | os.PathLike[str]]:
    """True if `shape` names a file: a `str` or a path object."""
    return isinstance(shape, (str, os.PathLike))


def parts_of(shape: object, faces: object = None, *, fields: Mapping[str, object] | None = None) -> Parts:
    """Arrays of anything that is a shape.

    Parameters
    ----------
    shape
        Points, (n, 3) or (n, 2), the latter taken as z = 0: an array, nested lists, a data frame (its columns
        x, y and z, where it has these; the others are fields), or anything with `__array__` or `__dlpack__`.
        Alone they are a point cloud. Or a pair (points, faces). Or a mesh, cloud or graph of trimesh,
        PyVista, meshio, Open3D or NetworkX; a `scipy.sparse` matrix of edge weights; an object with
        `vertices` and `faces`.
    faces
        With points: an (m, k) array, a list of lists of any lengths, a 1-D array [3, a, b, c, 4, ...] as in
        VTK, or a tuple (corners, offsets) of 1-D arrays. Corners count from 0.
    fields
        Values per vertex to attach, by name; they take the place of the object's own of the same name.

    Raises
    ------
    TypeError
        The shape or an array is of a kind that cannot be read.
    ValueError
        An array has a wrong shape, a coordinate that is not finite, or a corner that does not exist.
    """
    found = _find(shape, faces)
    parts = _parts_from(found)
    n_faces = parts.corners.size // 3 if parts.offsets is None else parts.offsets.size - 1
    parts.fields = _own_fields(found.fields, parts.n_vertices)
    parts.face_fields = _own_fields(found.face_fields, n_faces)
    for name, values in (fields or {}).items():
        parts.fields[name] = field_array(values, parts.n_vertices, f"fields[{name!r}]")
    return parts


def graph_parts(n_vertices: int, edges: object, weights: object = None) -> Parts:
    """Parts of an undirected graph from its edges, (m, 2), each listed once.

    Weights are (m,), or None where every edge counts 1; an edge listed twice counts with the sum.

    Raises
    ------
    TypeError
        An array holds no numbers of its kind.
    ValueError
        An array has a wrong shape, or an edge names a node that does not exist.
    """
    n_vertices = operator.index(n_vertices)
    if n_vertices < 0:
        raise ValueError(f"n_vertices must not be negative, got {n_vertices}")
    pairs = array_of(edges, "edges")
    if pairs.size == 0:
        pairs = np.empty((0, 2), np.int64)
    if pairs.ndim != 2 or pairs.shape[1] != 2:
        hint = "; pass edges.T" if pairs.ndim == 2 and pairs.shape[0] == 2 else ""
        raise ValueError(f"edges: shape {pairs.shape}, but each row must hold two nodes, (m, 2){hint}")
    ends = index_array(pairs, n_vertices, "edges", "node").reshape(-1, 2)
    rows, cols = np.ascontiguousarray(ends.T)
    return Parts("graph", n_vertices, rows=rows, cols=cols, weights=weights_array(weights, rows.size))


def with_results(
    like: object,
    *,
    points: Array | None = None,
    fields: Mapping[str, Array] | None = None,
    face_fields: Mapping[str, Array] | None = None,
    faces: Array | None = None,
) -> Any:
    """A new object of the type of `like` with new points, values or faces; `like` is not changed.

    Parameters
    ----------
    like
        What `parts_of` took: an object of another library, a pair (points, faces) or an array of points.
    points
        New positions, (n, 3); None keeps the old. PyVista, meshio and Open3D tensors keep their floating
        type, and so do arrays, so positions are rounded where that is float32. What had no z has
        none again while z is 0. Normals that are stored are left out, because they belong to the old points.
    fields, face_fields
        Values per vertex and per face, (n,) or (n, c), to attach under their names. The field 'color' becomes
        the colors that trimesh and Open3D show, 'normal' the normals of Open3D.
    faces
        New faces, (m, k). With new faces, or a cloud of another number of points, no old values are kept.

    Raises
    ------
    TypeError
        The kind has no place for results at all: paths, sparse matrices, arrays where there are fields.
    ValueError
        The kind cannot hold one of the fields, or a number of rows is wrong.
    """
    fields, face_fields = dict(fields or {}), dict(face_fields or {})
    if is_path(like):
        raise TypeError(f"like: {os.fspath(like)!r} is a path; ask for arrays, or write the result to a file")
    if (library := library_of(like)) is not None:
        return rebuild(like, library, points, fields, face_fields, faces)
    if isinstance(like, Mapping):
        return _with_results_by_key(like, points, {**fields, **face_fields}, faces)
    pair = _pair_of(like)
    if pair is None and not _is_array_like(like):
        raise TypeError(f"like: results cannot be put into {kind_of(like)}; ask for arrays")
    if fields or face_fields:
        names = ", ".join([*fields, *face_fields])
        raise TypeError(f"like: plain arrays have no place for fields ({names}); ask for arrays")
    old_points = array_of(like if pair is None else pair[0], "like")
    if points is None:
        points = old_points
    elif old_points.shape[1:] == (2,) and not points[:, 2:].any():
        points = points[:, :2]
    points = np.array(points, dtype=float_type(old_points))
    if pair is None:
        return points
    if faces is None and len(points) != len(old_points):
        raise ValueError(f"points: {len(points)} rows, but the faces are of {len(old_points)}; pass faces too")
    return points, (pair[1] if faces is None else np.array(faces))


def _with_results_by_key(
    like: Mapping[Any, Any], points: Array | None, fields: dict[str, Array], faces: Array | None
) -> dict[Any, Any]:
    """A dictionary with other points, faces and fields under the keys of the given one."""
    new: dict[Any, Any] = {key: like[key] for key in like}
    own = point_key(like)
    if points is not None:
        old = array_of(like[own], "like")
        flat = old.shape[1:] == (2,) and not points[:, 2:].any()
        new[own] = np.array(points[:, :2] if flat else points, dtype=float_type(old))
    if faces is not None:
        new[face_key(like) or "faces"] = np.array(faces)
    return {**new, **{name: np.array(values) for name, values in fields.items()}}


def is_domain(given: object) -> bool:
    """True for an object of another library, or of this one, that is a shape, a graph or an image, and never a signal."""
    library = library_of(given)
    if library is not None:
        return library not in ("scipy", "pandas", "polars")
    return is_image(given) or hasattr(type(given), "_as_domain") or hasattr(type(given), "to_trimesh")


def can_hold_results(given: object) -> bool:
    """True if `with_results` can make an object of the kind of `given`."""
    if (library := library_of(given)) is not None:
        return has_place(given, library)
    if isinstance(given, Mapping):
        return point_key(given) is not None
    return _pair_of(given) is not None or (_is_array_like(given) and not has_shape_names(given))


def holds_fields(given: object) -> bool:
    """True if an object can store values at its vertices."""
    return library_of(given) is not None or isinstance(given, Mapping)


def has_nodes(given: object) -> bool:
    """True if an object is a graph whose nodes have names."""
    return library_of(given) == "networkx"


def stores_normals(given: object) -> bool:
    """True if an object stores normals instead of computing them."""
    return library_of(given) in ("pyvista", "meshio", "open3d")


def own_signal(given: object) -> str | None:
    """Name of the field that an object is about, if it is a signal on a shape rather than a shape."""
    library = library_of(given)
    return read(given, library).own_signal if library in SIGNALS else None


def _find(shape: object, faces: object) -> Found:
    """Content of a shape, recognized by its library, as a pair, as an array, or by the names of its attributes."""
    if is_path(shape):
        raise TypeError(f"shape: {os.fspath(shape)!r} is a path; read it first, with adwave.read")
    if (library := library_of(shape)) is not None:
        found = read(shape, library)
    elif (library := library_of_grid(shape)) in ("nibabel", "SimpleITK", "rasterio"):
        raise TypeError(
            f"shape: an image of {library} is a grid; pass aw.grid(image), as in aw.smooth(aw.grid(image), fwhm=8)"
        )
    elif faces is None and _is_group(shape):
        found = _joined(shape)  # type: ignore[arg-type]
    elif faces is None and (pair := _pair_of(shape)) is not None:
        return Found("arrays", points=pair[0], faces=pair[1])
    elif isinstance(shape, Mapping):
        found = by_keys(shape)
    elif _is_array_like(shape):
        is_foreign = hasattr(shape, "__dlpack__") and not isinstance(shape, np.ndarray)
        found = Found("dlpack" if is_foreign else "arrays", points=shape)
    elif has_shape_names(shape):
        found = by_names(shape)
    else:
        raise TypeError(
            f"shape: cannot read {kind_of(shape)}; pass points, (points, faces), a scipy.sparse matrix, or a mesh, cloud or "
            "graph of trimesh, PyVista, meshio, Open3D, NetworkX, igraph, nilearn, PyTorch Geometric, PyGSP or laspy"
        )
    if faces is not None:
        if found.faces is not None or found.lines is not None or found.edges is not None:
            raise TypeError(f"faces: {kind_of(shape)} has its own; pass its points alone to give them others")
        found.faces = faces
    return found


def _is_group(shape: object) -> bool:
    """True for two shapes or more, such as the hemispheres of a brain: meshes of other libraries, or pairs."""
    if not isinstance(shape, (tuple, list)) or len(shape) < 2:
        return False
    return all(
        library_of(each) in ("trimesh", "pyvista", "meshio", "nilearn", "open3d")
        or (isinstance(each, tuple) and len(each) == 2 and depth(each[0]) == 2 and depth(each[1]) == 2)
        for each in shape
    )


def _joined(shapes: Sequence[object]) -> Found:
    """Meshes as one mesh of several components, one after the other."""
    points, corners, n = [], [], 0
    for each in shapes:
        found = _find(each, None)
        own = points_array(found.points)
        triangles, offsets = faces_arrays(found.faces, len(own)) if found.faces is not None else (_no_indices(), None)
        if offsets is not None or not triangles.size:
            raise TypeError("shape: of several shapes each must be a mesh of triangles; pass them one by one")
        points.append(own)
        corners.append(triangles.reshape(-1, 3).astype(np.int64) + n)
        n += len(own)
    return Found("arrays", points=np.concatenate(points), faces=np.concatenate(corners))


def _parts_from(found: Found) -> Parts:
    if found.edges is not None:
        rows, cols, weights, is_listed_once = found.edges
        warn_of_weights(found)
        parts = Parts("graph", found.n_vertices, is_symmetric_list=is_listed_once)
        parts.rows = index_array(rows, parts.n_vertices, "edges", "node")
        parts.cols = index_array(cols, parts.n_vertices, "edges", "node")
        parts.weights = weights_array(weights, parts.rows.size)
        if found.points is not None:
            parts.points = points_array(found.points)
    else:
        points = points_array(found.points)
        parts = Parts("cloud", len(points), points)
        if found.faces is not None:
            parts.kind = "mesh"
            parts.corners, parts.offsets = faces_arrays(found.faces, len(points))
        elif found.lines is not None:
            parts.kind = "graph"
            parts.rows, parts.cols = edges_of_lines(found.lines, len(points))
    parts.source, parts.lost = found.source, found.lost
    return parts


def _own_fields(fields: Mapping[str, object], n_rows: int) -> dict[str, Array]:
    """Fields of an object, without texts, matrices and metadata."""
    kept: dict[str, Array] = {}
    for name, values in fields.items():
        try:
            kept[name] = field_array(values, n_rows, name)
        except (TypeError, ValueError):
            continue
    return kept


def _pair_of(shape: object) -> tuple[Any, Any] | None:
    """Points and faces of a pair; None for other sequences, such as two points, whose first element has no rows."""
    if not isinstance(shape, (tuple, list)) or len(shape) != 2:
        return None
    first, second = shape
    is_pair = second is None or depth(first) == 2 or (isinstance(first, (tuple, list)) and not first)
    return (first, second) if is_pair else None


def _is_array_like(x: object) -> bool:
    if isinstance(x, (list, tuple)) or is_array(x):
        return True
    if has_shape_names(x) or isinstance(x, Mapping):
        return False
    return isinstance(x, Sequence) or (hasattr(x, "__len__") and hasattr(x, "__getitem__"))
