"""Results as new objects of other libraries.

The library is loaded already, because the caller holds an object of it; so what is needed of it is taken from
`sys.modules`, and nothing is imported here.
"""

from __future__ import annotations

import copy
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._adapt_arrays import Array
from ._adapt_objects import (
    OPEN3D_NAMES,
    axes_of,
    class_names,
    is_face_of_grid,
    is_meshio_face,
    is_tensor_geometry,
    only_geometry,
    open3d_kind,
    read,
)

_NORMALS = ("normal", "normals")


@dataclass(slots=True)
class _Results:
    """Content of a new object; `is_fresh` if nothing of the old object fits it."""

    points: Array | None
    fields: dict[str, Array]
    face_fields: dict[str, Array]
    faces: Array | None
    is_fresh: bool = False


def rebuild(
    like: Any,
    library: str,
    points: Array | None,
    fields: dict[str, Array],
    face_fields: dict[str, Array],
    faces: Array | None,
) -> Any:
    """A new object of the type of `like` with the results; `like` is not changed."""
    if library not in _REBUILDERS:
        raise TypeError(f"like: {_WITHOUT_PLACE[library]}; ask for arrays")
    results = _Results(points, fields, face_fields, faces)
    if library in ("networkx", "pygsp"):
        n_vertices = len(like) if library == "networkx" else int(like.N)
    elif (found := read(like, library)).points is None:
        n_vertices = found.n_vertices
    else:
        n_old = len(found.points)
        n_vertices = n_old if points is None else len(points)
        if n_vertices != n_old and faces is None and (found.faces is not None or found.lines is not None):
            count = f"{n_vertices} rows, but the shape has {n_old} vertices"
            raise ValueError(f"points: {count}; pass faces too, to change both")
        results.is_fresh = faces is not None or n_vertices != n_old
        if results.is_fresh and points is None:
            results.points = np.asarray(found.points)
    for name, values in fields.items():
        if len(values) != n_vertices:
            raise ValueError(f"fields[{name!r}]: {len(values)} rows, but there are {n_vertices} vertices")
    return _REBUILDERS[library](like, results)


def _refuse_fields(like: object, names: Iterable[str], can: str) -> None:
    if names := list(names):
        kind = f"{type(like).__module__.partition('.')[0]} {type(like).__name__}"
        raise ValueError(f"fields: a {kind} has no place for {', '.join(names)}{can}; ask for arrays")


def _points_like(points: Array, old: Any) -> Array:
    """A copy of `points` in the floating type of `old`; without z if `old` has none and z is still 0."""
    old = np.asarray(old)
    if old.shape[1:] == (2,) and not points[:, 2:].any():
        points = points[:, :2]
    return np.array(points, old.dtype if old.dtype.kind == "f" else np.float64)


def _spread(name: str, values: Array, is_face: NDArray[np.bool_]) -> Array:
    """Values per face as values per cell: NaN, or 0 for integers, where a cell is not a face."""
    values = np.asarray(values)
    if len(values) != np.count_nonzero(is_face):
        count = np.count_nonzero(is_face)
        raise ValueError(f"face_fields[{name!r}]: {len(values)} rows, but there are {count} faces")
    cells = np.full((is_face.size, *values.shape[1:]), np.nan if values.dtype.kind == "f" else 0, values.dtype)
    cells[is_face] = values
    return cells


def _is_color(values: Array) -> bool:
    return np.ndim(values) == 2 and np.shape(values)[1] in (3, 4)


def _rebuild_trimesh(like: Any, results: _Results) -> Any:
    names = class_names(like)
    if "Scene" in names:
        name, geometry, matrix = only_geometry(like)
        if results.points is not None:
            results.points = np.linalg.solve(matrix[:3, :3], (results.points - matrix[:3, 3]).T).T
        scene = like.copy()
        scene.geometry[name] = _rebuild_trimesh(geometry, results)
        return scene
    if "PointCloud" in names:
        _refuse_fields(like, ({**results.fields, **results.face_fields}.keys() - {"color"}), " but color")
        new = like.copy() if not results.is_fresh else type(like)(results.points)
        if results.points is not None:
            new.vertices = np.array(results.points)
        if "color" in results.fields:
            new.colors = np.array(results.fields["color"])
        return new
    plain = sys.modules["trimesh"].Trimesh
    if results.is_fresh:
        new = plain(np.array(results.points), np.array(results.faces), process=False)
        new.metadata.update(like.metadata)
    elif "Primitive" in names:
        # A sphere stays one whatever its vertices are set to: only its mesh can hold results.
        new = plain(like.vertices.copy(), like.faces.copy(), process=False)
    else:
        new = like.copy()
    if results.points is not None:
        new.vertices = np.array(results.points)
    if "texcoord" in results.fields:
        material = getattr(like.visual, "material", None)
        uv = np.array(results.fields["texcoord"], np.float64)
        new.visual = sys.modules["trimesh"].visual.TextureVisuals(uv=uv, material=material)
    for name, values in results.fields.items():
        if name == "texcoord":
            continue
        if name == "color" and _is_color(values) and hasattr(type(new.visual), "vertex_colors"):
            new.visual.vertex_colors = np.array(values)
        else:
            new.vertex_attributes[name] = np.array(values)
    for name, values in results.face_fields.items():
        new.face_attributes[name] = _spread(name, values, np.ones(len(new.faces), bool))
    return new


def _rebuild_pyvista(like: Any, results: _Results) -> Any:
    points, faces = results.points, results.faces
    names = class_names(like)
    is_grid = "UnstructuredGrid" in names
    if points is not None and names & {"ImageData", "RectilinearGrid"}:
        raise TypeError("like: the points of an image are fixed; give a signal, such as the name of its values")
    if results.is_fresh and points is not None:
        new = sys.modules["pyvista"].PolyData(_points_like(points, like.points))
        if faces is not None:
            new.verts = np.empty(0, np.int64)
            new.faces = np.insert(np.asarray(faces, np.int64), 0, np.shape(faces)[1], axis=1).ravel()
        new = new.cast_to_unstructured_grid() if is_grid else new
    else:
        new = like.copy()
        if points is not None:
            new.points = _points_like(points, like.points)
            for data in (new.point_data, new.cell_data):
                for name in [name for name in data if name.lower() in _NORMALS]:
                    del data[name]
    for name, values in results.fields.items():
        if name == "texcoord":
            new.point_data.active_texture_coordinates = np.array(values)
        else:
            new.point_data[name] = np.array(values)
    if results.face_fields:
        if is_grid:
            is_face = is_face_of_grid(new)
        else:
            n_others = int(new.GetNumberOfVerts() + new.GetNumberOfLines())
            is_face = np.arange(new.n_cells) >= n_others
        for name, values in results.face_fields.items():
            new.cell_data[name] = _spread(name, values, is_face)
    return new


def _rebuild_meshio(like: Any, results: _Results) -> Any:
    points, faces = results.points, results.faces
    if results.is_fresh and points is not None:
        cells = []
        if faces is not None:
            kind = {3: "triangle", 4: "quad"}.get(np.shape(faces)[1], "polygon")
            cells = [(kind, np.array(faces))]
        new = type(like)(_points_like(points, like.points), cells)
    else:
        new = like.copy()
        if points is not None:
            new.points = _points_like(points, like.points)
            for data in (new.point_data, new.cell_data):
                for name in [name for name in data if name.lower() in _NORMALS]:
                    del data[name]
    for name, values in results.fields.items():
        new.point_data[name] = np.array(values)
    sizes = [len(block.data) for block in new.cells]
    is_face = np.repeat([is_meshio_face(block) for block in new.cells], sizes).astype(bool)
    for name, values in results.face_fields.items():
        new.cell_data[name] = np.split(_spread(name, values, is_face), np.cumsum(sizes)[:-1])
    return new


def _rebuild_open3d(like: Any, results: _Results) -> Any:
    kind = open3d_kind(like)
    if kind == "LineSet":
        raise TypeError("like: an Open3D LineSet has no place for results; ask for arrays")
    if kind == "PointCloud":
        _refuse_fields(like, results.face_fields, ", because it has no faces")
    build = _rebuild_tensors if is_tensor_geometry(like) else _rebuild_vectors
    return build(like, results, kind == "TriangleMesh")


def _rebuild_vectors(like: Any, results: _Results, is_mesh: bool) -> Any:
    """Rebuild a geometry that stores vectors of fixed types only."""
    others = [*(results.fields.keys() - {"color", "normal"}), *results.face_fields]
    _refuse_fields(like, sorted(others), " but color and normal")
    utility = sys.modules["open3d"].utility
    new = type(like)() if results.is_fresh else type(like)(like)
    prefix = "vertex_" if is_mesh else ""
    if results.points is not None:
        vectors = utility.Vector3dVector(np.array(results.points, np.float64))
        setattr(new, "vertices" if is_mesh else "points", vectors)
        setattr(new, f"{prefix}normals", utility.Vector3dVector())
        if is_mesh:
            new.triangle_normals = utility.Vector3dVector()
    if results.faces is not None:
        new.triangles = utility.Vector3iVector(np.ascontiguousarray(results.faces, np.int32))
    for name, values in results.fields.items():
        if np.ndim(values) != 2 or np.shape(values)[1] < 3:
            raise ValueError(f"fields[{name!r}]: shape {np.shape(values)}, but Open3D wants (n, 3)")
        # Open3D shows colors from 0 to 1, the others keep bytes.
        scale = 255.0 if name == "color" and np.asarray(values).dtype.kind in "iu" else 1.0
        setattr(new, f"{prefix}{name}s", utility.Vector3dVector(np.asarray(values)[:, :3] / scale))
    return new


def _rebuild_tensors(like: Any, results: _Results, is_mesh: bool) -> Any:
    core = sys.modules["open3d"].core

    def tensor(values: Array) -> Any:
        values = np.ascontiguousarray(values)
        return core.Tensor(values.astype(np.float32) if values.dtype == np.float16 else values)

    new = like.clone()
    vertices = new.vertex if is_mesh else new.point
    old_points = vertices["positions"].numpy()
    maps = [(vertices, "positions"), (new.triangle, "indices")] if is_mesh else [(vertices, "positions")]
    for attributes, primary in maps:
        for name in [name for name in attributes if name != primary]:
            if results.is_fresh or (results.points is not None and name in _NORMALS):
                del attributes[name]
    if results.points is not None:
        vertices["positions"] = tensor(_points_like(results.points, old_points))
    if results.faces is not None:
        new.triangle["indices"] = tensor(np.asarray(results.faces, np.int64))
    own_names = {ours: theirs for theirs, ours in OPEN3D_NAMES.items()}
    for name, values in results.fields.items():
        vertices[own_names.get(name, name)] = tensor(values)
    for name, values in results.face_fields.items():
        is_face = np.ones(len(new.triangle["indices"]), bool)
        new.triangle[own_names.get(name, name)] = tensor(_spread(name, values, is_face))
    return new


def _rebuild_networkx(like: Any, results: _Results) -> Any:
    if results.points is not None or results.faces is not None or results.face_fields:
        raise TypeError("like: a networkx graph holds values per node only, no points or faces; ask for arrays")
    new = like.copy()
    for name, values in results.fields.items():
        # Plain numbers, because writers of graph files refuse numpy's.
        for node, value in zip(new, np.asarray(values).tolist(), strict=True):
            new.nodes[node][name] = value
    return new


def _rebuild_igraph(like: Any, results: _Results) -> Any:
    if results.points is not None or results.faces is not None or results.face_fields:
        raise TypeError("like: an igraph graph holds values per node only, no points or faces; ask for arrays")
    new = like.copy()
    for name, values in results.fields.items():
        new.vs[name] = np.asarray(values).tolist()
    return new


def _rebuild_anndata(like: Any, results: _Results) -> Any:
    if results.points is not None or results.faces is not None or results.face_fields:
        raise TypeError("like: an AnnData holds values per cell only, no points or faces; ask for arrays")
    new = like.copy()
    for name, values in results.fields.items():
        (new.obs if np.ndim(values) == 1 else new.obsm)[name] = np.array(values)
    return new


def _rebuild_pandas(like: Any, results: _Results) -> Any:
    if results.face_fields or results.faces is not None:
        raise TypeError("like: a data frame holds values per vertex only, no faces; ask for arrays")
    new = like.copy()
    if results.is_fresh:
        raise ValueError(f"like: the data frame has {len(like)} rows, not one per point; ask for arrays")
    if results.points is not None:
        for column, values in zip(axes_of(like) or list(like.columns), results.points.T, strict=False):
            new[column] = values
    for name, values in results.fields.items():
        if np.ndim(values) == 1:
            new[name] = np.array(values)
            continue
        for i, column in enumerate(np.asarray(values).T):
            new[f"{name}_{i}"] = np.array(column)
    return new


def _rebuild_nilearn(like: Any, results: _Results) -> Any:
    surface = sys.modules["nilearn.surface"]
    names = class_names(like)
    if "SurfaceMesh" in names:
        _refuse_fields(like, [*results.fields, *results.face_fields], "")
        points = like.coordinates if results.points is None else results.points
        return surface.InMemoryMesh(np.array(points), np.array(like.faces if results.faces is None else results.faces))
    if results.is_fresh:
        raise TypeError("like: the hemispheres of another number of vertices cannot be told apart; ask for arrays")
    is_image = "SurfaceImage" in names
    _refuse_fields(like, [n for n in (*results.fields, *results.face_fields) if not is_image or n != "data"], "")
    mesh = like.mesh if is_image else like
    ends = np.cumsum([len(part.coordinates) for part in mesh.parts.values()])[:-1]
    if results.points is not None:
        split = np.split(np.array(results.points), ends)
        parts = zip(mesh.parts.items(), split, strict=True)
        mesh = surface.PolyMesh(**{name: surface.InMemoryMesh(at, np.array(part.faces)) for (name, part), at in parts})
    if not is_image:
        return mesh
    if "data" in results.fields:
        values = dict(zip(mesh.parts, np.split(np.array(results.fields["data"]), ends), strict=True))
    else:
        values = {name: np.array(part) for name, part in like.data.parts.items()}
    return type(like)(mesh=mesh, data=values)


def _rebuild_torch_geometric(like: Any, results: _Results) -> Any:
    torch = sys.modules["torch"]
    if results.is_fresh and results.faces is None and getattr(like, "edge_index", None) is not None:
        raise TypeError("like: a graph of another number of nodes has other edges; ask for arrays")
    if results.points is not None and getattr(like, "pos", None) is None:
        raise TypeError("like: the graph has no positions; ask for arrays")
    new = type(like)() if results.is_fresh else like.clone()

    def tensor(values: Array, old: Any) -> Any:
        made = torch.from_numpy(np.ascontiguousarray(values))
        return made.to(old.device, old.dtype) if old is not None and old.is_floating_point() else made

    if results.points is not None:
        new.pos = tensor(_points_like(results.points, like.pos.detach().cpu().numpy()), like.pos)
    if results.faces is not None:
        new.face = tensor(np.asarray(results.faces, np.int64).T, None)
    for name, values in results.fields.items():
        new[name] = tensor(values, getattr(like, name, None))
    return new


def _rebuild_pygsp(like: Any, results: _Results) -> Any:
    if results.points is not None or results.faces is not None or results.face_fields:
        raise TypeError("like: a PyGSP graph holds signals only; ask for arrays")
    new = copy.copy(like)
    new.signals = {
        **getattr(like, "signals", {}),
        **{name: np.array(values) for name, values in results.fields.items()},
    }
    return new


def _rebuild_laspy(like: Any, results: _Results) -> Any:
    laspy = sys.modules["laspy"]
    if results.faces is not None or results.face_fields:
        raise TypeError("like: a LAS holds points only; ask for arrays")
    if results.is_fresh:
        new = laspy.create(point_format=like.header.point_format, file_version=like.header.version)
        new.header.offsets, new.header.scales = like.header.offsets, like.header.scales
    else:
        new = laspy.LasData(copy.deepcopy(like.header), like.points.copy())
    if results.points is not None:
        new.x, new.y, new.z = np.array(results.points).T
    known = set(new.point_format.dimension_names)
    for name, values in results.fields.items():
        if name not in known:
            kind = f"{values.shape[1]}{values.dtype.str[1:]}" if np.ndim(values) == 2 else values.dtype
            new.add_extra_dim(laspy.ExtraBytesParams(name=name, type=kind))
        new[name] = np.array(values)
    return new


def has_place(like: Any, library: str) -> bool:
    """True if results can be put into an object of `library`."""
    return library in _REBUILDERS and not (library == "open3d" and open3d_kind(like) == "LineSet")


_WITHOUT_PLACE = {
    "scipy": "a sparse matrix has no place for points or values per node",
    "polars": "a polars frame takes no results",
    "vtk": "a bare VTK object takes no results; pass pyvista.wrap of it",
}
_REBUILDERS: dict[str, Callable[[Any, _Results], Any]] = {
    "trimesh": _rebuild_trimesh,
    "pyvista": _rebuild_pyvista,
    "meshio": _rebuild_meshio,
    "open3d": _rebuild_open3d,
    "networkx": _rebuild_networkx,
    "igraph": _rebuild_igraph,
    "anndata": _rebuild_anndata,
    "pandas": _rebuild_pandas,
    "nilearn": _rebuild_nilearn,
    "torch_geometric": _rebuild_torch_geometric,
    "pygsp": _rebuild_pygsp,
    "laspy": _rebuild_laspy,
}
