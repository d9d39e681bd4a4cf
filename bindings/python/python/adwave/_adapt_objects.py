"""Content of the shape objects of other libraries.

No library is imported to recognize its objects: the module names of their classes tell. Readers give what is
there as it is; `adwave._adapt` checks and converts it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._adapt_arrays import Array, kind_of
from ._caller import warn

# The names under which further libraries keep vertices and faces: vedo, LaPy, psbody, PyMeshLab and others.
_SHAPE_NAMES = (
    ("vertices", "faces"),
    ("vertices", "triangles"),
    ("vertices", "cells"),
    ("points", "faces"),
    ("verts", "faces"),
    ("v", "f"),
    ("v", "t"),
    ("vertex_matrix", "face_matrix"),
    ("vertices", None),
    ("points", None),
)
# The keys under which dictionaries and archives of numpy keep them, in lower case.
_POINT_KEYS = ("vertices", "points", "verts", "v", "pos", "coords", "coordinates", "xyz")
_FACE_KEYS = ("faces", "triangles", "cells", "tris", "f", "face", "simplices", "connectivity")
# Classes of further libraries that have a reader here.
_NEIGHBORS = {
    ("nilearn", "SurfaceMesh"),
    ("nilearn", "PolyMesh"),
    ("nilearn", "SurfaceImage"),
    ("torch_geometric", "Data"),
    ("pygsp", "Graph"),
    ("laspy", "LasData"),
    ("anndata", "AnnData"),
    ("igraph", "Graph"),
}
# Libraries with objects that are signals on shapes.
SIGNALS = ("nilearn", "pyvista", "torch_geometric")
_VTK_VERTICES, _VTK_LINES, _VTK_FACES = (0, 1, 2), (3, 4), (5, 7, 9)
_NO_ENDS: Array = np.empty(0, np.int64)
# What Open3D's tensor geometries call the fields that other libraries have too.
OPEN3D_NAMES = {"colors": "color", "normals": "normal"}


@dataclass(slots=True)
class Found:
    """Unchecked content of an object: points with faces, with lines or alone; or edges between nodes.

    `lines` are cells of two corners and more; `edges` are rows, columns, weights, and whether each undirected
    edge is listed once, and come with `n_vertices`. `own_signal` names the field that the object is about, if it is a
    signal on a shape, and `lost` what the object has and a `Shape` has no place for.
    """

    source: str
    points: Any = None
    faces: Any = None
    lines: Any = None
    edges: tuple[Any, Any, Any, bool] | None = None
    n_vertices: int = 0
    fields: dict[str, Any] = field(default_factory=dict)
    face_fields: dict[str, Any] = field(default_factory=dict)
    own_signal: str | None = None
    lost: tuple[str, ...] = ()


def library_of(x: object) -> str | None:
    """Name of the library of `x`, if it has a reader here, or None."""
    if isinstance(x, np.ndarray):
        return None
    for cls in type(x).__mro__:
        root, _, rest = cls.__module__.partition(".")
        if root in ("trimesh", "pyvista", "meshio", "networkx"):
            return root
        if (root, cls.__name__) in _NEIGHBORS:
            return root
        if root in ("vtkmodules", "vtk"):
            return "vtk"
        if (root == "scipy" and rest.startswith("sparse")) or (root == "open3d" and "geometry" in rest):
            return root
        if root in ("pandas", "polars") and cls.__name__ == "DataFrame":
            return root
    return None


def class_names(x: object) -> set[str]:
    """Names of the classes of `x`, so that subclasses are recognized."""
    return {cls.__name__ for cls in type(x).__mro__}


def read(x: Any, library: str) -> Found:
    """Content of an object of `library`."""
    found = _READERS[library](x)
    found.source = library
    return found


def has_shape_names(x: object) -> bool:
    """True if `x` has attributes named like vertices or points."""
    return any(hasattr(x, vertices) for vertices, _ in _SHAPE_NAMES)


def by_names(x: Any) -> Found:
    """Content of an object of an unknown library, by the names of its attributes."""

    def value(name: str) -> Any:
        attribute = getattr(x, name)
        return attribute() if callable(attribute) else attribute

    for vertices, faces in _SHAPE_NAMES:
        if hasattr(x, vertices) and (faces is None or hasattr(x, faces)):
            source = type(x).__module__.partition(".")[0]
            return Found(source, points=value(vertices), faces=None if faces is None else value(faces))
    raise _refused(x, "pass points, or (points, faces)")


def key_of(x: Mapping[Any, Any], keys: tuple[str, ...]) -> Any:
    """The key of a dictionary that is one of these, in any case; None if there is none."""
    by_name = {str(key).lower(): key for key in x}
    return next((by_name[key] for key in keys if key in by_name), None)


def point_key(x: Mapping[Any, Any]) -> Any:
    """The key of the points of a dictionary; None if there is none."""
    return key_of(x, _POINT_KEYS)


def face_key(x: Mapping[Any, Any]) -> Any:
    """The key of the faces of a dictionary; None if there is none."""
    return key_of(x, _FACE_KEYS)


def by_keys(x: Mapping[Any, Any]) -> Found:
    """Content of a dictionary or an archive of numpy: points, faces, and fields under the other keys."""
    points, faces = point_key(x), face_key(x)
    if points is None:
        keys = ", ".join(repr(key) for key in list(x)[:6]) or "none"
        raise TypeError(
            f"shape: a dictionary with the keys {keys} has no points; name its arrays 'vertices' and 'faces', or pass a pair, "
            "(vertices, faces)"
        )
    found = Found("dict", points=x[points], faces=None if faces is None else x[faces])
    if isinstance(found.faces, Mapping):  # cells of meshio by their type
        found.faces = found.faces.get("triangle", next(iter(found.faces.values()), None))
    found.fields = {str(key): x[key] for key in x if key not in (points, faces)}
    return found


def _refused(x: object, advice: str) -> TypeError:
    return TypeError(f"shape: cannot read {kind_of(x)}; {advice}")


def _read_trimesh(x: Any) -> Found:
    names = class_names(x)
    if "Scene" in names:
        _, geometry, matrix = only_geometry(x)
        found = _read_trimesh(geometry)
        found.points = np.asarray(found.points) @ matrix[:3, :3].T + matrix[:3, 3]
        return found
    if "PointCloud" in names:
        return Found("trimesh", points=x.vertices, fields={"color": getattr(x, "colors", None)})
    if "Trimesh" not in names:
        raise _refused(x, "pass a Trimesh, a PointCloud or a Scene with one of them")
    found = Found("trimesh", x.vertices, x.faces)
    found.fields = dict(x.vertex_attributes)
    found.face_fields = dict(x.face_attributes)
    if x.visual.kind == "vertex":
        found.fields["color"] = x.visual.vertex_colors
    elif x.visual.kind == "face":
        found.face_fields["color"] = x.visual.face_colors
    elif x.visual.kind == "texture":
        uv = getattr(x.visual, "uv", None)
        if uv is not None and len(uv) == len(x.vertices):
            found.fields["texcoord"] = np.asarray(uv)[:, :2]
        material = getattr(x.visual, "material", None)
        pictures = [getattr(material, name, None) for name in ("image", "baseColorTexture")]
        # A material without a texture has a picture of 2 × 2 pixels of its color.
        if any(picture is not None and max(picture.size) > 2 for picture in pictures):
            found.lost = ("the material and its texture",)
        elif getattr(material, "name", None):
            found.lost = ("the material",)
    return found


def only_geometry(scene: Any) -> tuple[str, Any, Array]:
    """The only geometry of a trimesh scene: its name, the geometry, and its placement matrix."""
    nodes = list(scene.graph.nodes_geometry)
    if len(nodes) != 1:
        raise TypeError(
            f"shape: the scene has {len(nodes)} geometries; pass one of scene.geometry.values(), or "
            "scene.to_mesh() to take all as one mesh"
        )
    matrix, name = scene.graph[nodes[0]]
    return name, scene.geometry[name], np.asarray(matrix)


def _read_pyvista(x: Any) -> Found:
    names = class_names(x)
    if "PolyData" in names:
        found = _read_polydata(x)
    elif "UnstructuredGrid" in names:
        found = _read_grid(x)
    elif "PointSet" in names:
        found = Found("pyvista")
    elif "MultiBlock" in names:
        raise _refused(x, "pass one of its blocks")
    elif hasattr(x, "dimensions"):
        found = _read_lattice(x)
    else:
        raise _refused(x, "pass a PolyData, an UnstructuredGrid or an ImageData")
    found.points, found.fields = x.points, dict(x.point_data)
    texcoord = x.point_data.active_texture_coordinates
    if texcoord is not None and np.ndim(texcoord) == 2:
        name = _vtk_name(x, "GetTCoords")
        found.fields.pop(name, None)
        found.fields["texcoord"] = np.asarray(texcoord)[:, :2]
    if found.edges is not None:
        found.own_signal = _only_scalars(x)
    return found


def _vtk_name(x: Any, getter: str) -> str:
    array = getattr(x.GetPointData(), getter)()
    return "" if array is None else array.GetName()


def _only_scalars(x: Any) -> str | None:
    """Name of the values that a grid is about: the active ones, or the only ones."""
    names = list(x.point_data)
    active = x.point_data.active_scalars_name
    return active if active is not None else names[0] if len(names) == 1 else None


def _read_lattice(x: Any) -> Found:
    """Points of an image or a structured grid as nodes, each joined with the next along each axis.

    Weights are the mean square distance of neighbors over their own, as for heat.
    """
    sizes = tuple(int(size) for size in x.dimensions)
    if x.n_cells and not len(x.point_data) and len(x.cell_data):
        raise _refused(x, "its values are at the cells: call .cell_data_to_point_data() on it first")
    index = np.arange(int(np.prod(sizes))).reshape(sizes, order="F")
    pairs = [
        (np.take(index, range(size - 1), axis).ravel(), np.take(index, range(1, size), axis).ravel())
        for axis, size in enumerate(sizes)
        if size > 1
    ]
    return _weighted_graph(x, *(np.concatenate(ends) for ends in zip(*pairs, strict=True)))


def _weighted_graph(x: Any, first: Array = _NO_ENDS, second: Array = _NO_ENDS) -> Found:
    points = np.asarray(x.points, np.float64)
    squares = ((points[first] - points[second]) ** 2).sum(axis=1)
    is_apart = squares > 0
    first, second, squares = first[is_apart], second[is_apart], squares[is_apart]
    weights = squares.mean() / squares if squares.size else squares
    return Found("pyvista", edges=(first, second, weights, True), n_vertices=len(points))


def _read_polydata(x: Any) -> Found:
    found = Found("pyvista")
    if x.n_strips:
        raise _refused(x, f"it has {x.n_strips} triangle strips: call .triangulate() on it first")
    if n_faces := int(x.GetNumberOfPolys()):
        # Newer versions have both arrays at hand; the padded one is slow to take apart where lengths differ.
        is_new = hasattr(x, "face_connectivity")
        found.faces = (x.face_connectivity, x.face_offsets) if is_new else x.faces
        first = int(x.GetNumberOfVerts() + x.GetNumberOfLines())
        found.face_fields = {name: values[first : first + n_faces] for name, values in x.cell_data.items()}
    elif x.GetNumberOfLines():
        found.lines = x.lines
    return found


def _read_grid(x: Any) -> Found:
    found = Found("pyvista")
    types: Array = np.asarray(x.celltypes)
    if not np.isin(types, _VTK_VERTICES + _VTK_LINES + _VTK_FACES).all():
        # Volumes: a graph of the edges of all cells.
        edges = x.extract_all_edges()
        ends = np.asarray(edges.lines).reshape(-1, 3)[:, 1:]
        return _weighted_graph(x, ends[:, 0], ends[:, 1])
    offsets: Array = np.asarray(x.cell_offsets if hasattr(x, "cell_offsets") else x.offset)
    for cells, kinds in (("faces", _VTK_FACES), ("lines", _VTK_LINES)):
        keep = np.isin(types, kinds)
        if keep.any():
            setattr(found, cells, _subset(np.asarray(x.cell_connectivity), offsets, keep))
            break
    if found.faces is not None:
        keep = is_face_of_grid(x)
        found.face_fields = {name: np.asarray(values)[keep] for name, values in x.cell_data.items()}
    return found


def is_face_of_grid(x: Any) -> NDArray[np.bool_]:
    """Mask of the cells of an UnstructuredGrid that are faces."""
    return np.isin(x.celltypes, _VTK_FACES)


def _subset(connectivity: Array, offsets: Array, keep: NDArray[np.bool_]) -> tuple[Array, Array]:
    if keep.all():
        return connectivity, offsets
    lengths = np.diff(offsets)
    return connectivity[np.repeat(keep, lengths)], np.concatenate([[0], np.cumsum(lengths[keep])])


def _read_vtk(x: Any) -> Found:
    raise _refused(x, "pass pyvista.wrap of it")


def is_meshio_face(block: Any) -> bool:
    """True if the cells of a block are flat polygons."""
    return block.type in ("triangle", "quad") or block.type.startswith("polygon")


def _read_meshio(x: Any) -> Found:
    found = Found("meshio", points=x.points, fields=dict(x.point_data))
    filled = [(i, block) for i, block in enumerate(x.cells) if len(block.data)]
    faces = [(i, np.asarray(block.data)) for i, block in filled if is_meshio_face(block)]
    for _, block in filled:
        if block.type not in ("vertex", "line") and not is_meshio_face(block):
            why = f"its cells of type {block.type!r} are no flat polygons"
            raise _refused(x, f"{why}: pass pyvista.from_meshio(mesh).extract_surface()")
    if faces:
        if len({cells.shape[1] for _, cells in faces}) == 1:
            found.faces = np.concatenate([cells for _, cells in faces])
        else:
            lengths = np.concatenate([np.full(len(cells), cells.shape[1]) for _, cells in faces])
            corners = np.concatenate([cells.ravel() for _, cells in faces])
            found.faces = (corners, np.concatenate([[0], np.cumsum(lengths)]))
        for name, blocks in x.cell_data.items():
            if len({np.shape(blocks[i])[1:] for i, _ in faces}) == 1:
                found.face_fields[name] = np.concatenate([blocks[i] for i, _ in faces])
    elif lines := [np.asarray(block.data) for _, block in filled if block.type == "line"]:
        found.lines = np.concatenate(lines)
    return found


def _read_open3d(x: Any) -> Found:
    kind = open3d_kind(x)
    if is_tensor_geometry(x):
        vertices = x.vertex if kind == "TriangleMesh" else x.point
        points = _tensor(vertices["positions"]) if "positions" in vertices else np.empty((0, 3))
        found = Found("open3d", points, fields=_tensors(vertices, "positions"))
        if kind == "TriangleMesh":
            found.faces = _tensor(x.triangle["indices"]) if "indices" in x.triangle else np.empty((0, 3))
            found.face_fields = _tensors(x.triangle, "indices")
        elif kind == "LineSet":
            found.lines = _tensor(x.line["indices"])
        return found
    if kind == "TriangleMesh":
        found = Found("open3d", np.asarray(x.vertices), np.asarray(x.triangles))
        found.fields = {"color": np.asarray(x.vertex_colors), "normal": np.asarray(x.vertex_normals)}
        found.face_fields = {"normal": np.asarray(x.triangle_normals)}
        if len(x.triangle_uvs):
            found.lost = ("texture coordinates of corners",)
        return found
    found = Found("open3d", np.asarray(x.points))
    if kind == "LineSet":
        found.lines = np.asarray(x.lines)
    else:
        found.fields = {"color": np.asarray(x.colors), "normal": np.asarray(x.normals)}
    return found


def open3d_kind(x: object) -> str:
    """Kind of Open3D geometry of `x`."""
    names = class_names(x)
    for kind in ("TriangleMesh", "PointCloud", "LineSet"):
        if kind in names:
            return kind
    raise _refused(x, "pass a TriangleMesh, a PointCloud or a LineSet")


def is_tensor_geometry(x: object) -> bool:
    """True if `x` belongs to open3d.t.geometry, whose objects have named tensors."""
    return ".t." in type(x).__module__ or any(".t." in cls.__module__ for cls in type(x).__mro__)


def _tensor(tensor: Any) -> Array:
    if tensor.is_cuda:
        raise TypeError("shape: the geometry is not in the processor's memory; call .cpu() on it first")
    return tensor.numpy()


def _tensors(attributes: Any, primary: str) -> dict[str, Any]:
    names = [str(name) for name in attributes if name != primary]
    return {OPEN3D_NAMES.get(name, name): _tensor(attributes[name]) for name in names}


def _read_networkx(x: Any) -> Found:
    place = {node: i for i, node in enumerate(x)}
    edges = list(x.edges(data="weight"))
    rows = np.fromiter((place[u] for u, _, _ in edges), np.int64, len(edges))
    cols = np.fromiter((place[v] for _, v, _ in edges), np.int64, len(edges))
    is_weighted = any(weight is not None for _, _, weight in edges)
    weights = [1.0 if weight is None else weight for _, _, weight in edges] if is_weighted else None
    found = Found("networkx", edges=(rows, cols, weights, not x.is_directed()), n_vertices=len(place))
    for name in next((attributes for _, attributes in x.nodes(data=True)), {}):
        values = [value for _, value in x.nodes(data=name)]
        if isinstance(name, str) and all(value is not None for value in values):
            found.fields[name] = values
    return found


def _read_igraph(x: Any) -> Found:
    ends = np.array(x.get_edgelist(), np.int64).reshape(-1, 2)
    weights = x.es["weight"] if "weight" in x.es.attributes() else None
    found = Found("igraph", edges=(ends[:, 0], ends[:, 1], weights, not x.is_directed()), n_vertices=int(x.vcount()))
    found.fields = {name: x.vs[name] for name in x.vs.attributes()}
    return found


def _read_scipy(x: Any) -> Found:
    if len(x.shape) != 2 or x.shape[0] != x.shape[1]:
        raise ValueError(f"shape: the sparse matrix of weights has shape {x.shape}, but must be square")
    entries = x.tocoo(copy=False)
    return Found("scipy", edges=(entries.row, entries.col, entries.data, False), n_vertices=x.shape[0])


def warn_of_weights(found: Found) -> None:
    """Warn of weights that are not used as they are: those of a walk, of one direction, and on the diagonal."""
    assert found.edges is not None
    rows, cols, given, is_listed_once = found.edges
    rows, cols = np.asarray(rows), np.asarray(cols)
    weights: Array = np.ones(rows.size) if given is None else np.asarray(given)
    if weights.dtype.kind not in "biuf" or not weights.size or weights.shape != rows.shape:
        return
    weights, n = weights.astype(np.float64), found.n_vertices
    if not np.isfinite(weights).all() or min(rows.min(), cols.min()) < 0 or max(rows.max(), cols.max()) >= n:
        return
    what = "matrix" if found.source == "scipy" else f"graph of {found.source}"
    matrix = {
        "networkx": "networkx.to_scipy_sparse_array(graph)",
        "pygsp": "graph.W",
        "torch_geometric": "torch_geometric.utils.to_scipy_sparse_matrix(data.edge_index)",
    }.get(found.source, "W")
    message = None
    # Products with one vector from both sides differ if the matrix is not symmetric.
    vector = np.random.default_rng(0).random(n)
    from_rows = np.bincount(rows, weights * vector[cols], n)
    from_columns = np.bincount(cols, weights * vector[rows], n)
    if not is_listed_once and np.abs(from_rows - from_columns).max() > 1e-9 * np.abs(from_rows).max():
        sums = np.bincount(rows, weights, n)
        if found.source == "scipy" and np.allclose(sums[np.bincount(rows, minlength=n) > 0], 1.0):
            message = "looks like a walk, whose rows sum to 1, and is taken for weights; pass the symmetric weights"
            message += ", or adwave.walk(W) to take it as it is"
        else:
            message = (
                f"is not symmetric: (W + W.T) / 2 is used; adwave.walk({matrix}, normalize='row') keeps directions"
            )
    loops = (rows == cols) & (weights != 0)
    if message is None and loops.any():
        n_loops = np.count_nonzero(loops)
        self_loops = "1 self-loop, which is" if n_loops == 1 else f"{n_loops} self-loops, which are"
        message = f"has {self_loops} not used (the diagonal); adwave.walk({matrix}, normalize='row') keeps loops"
    if message is not None:
        warn(f"the {what} {message}")


def axes_of(x: Any) -> list[Any]:
    """Columns x, y and z, or x and y, of a data frame; None if it has no columns of these names."""
    by_name = {str(column).lower(): column for column in x.columns}
    return [by_name[axis] for axis in "xyz" if axis in by_name] if {"x", "y"} <= by_name.keys() else []


def _read_frame(x: Any) -> Found:
    axes = axes_of(x)
    if not axes:
        return Found("pandas", points=x)
    rest = {str(column): x[column] for column in x.columns if column not in axes}
    return Found("pandas", points=x[axes], fields=rest)


def _read_nilearn(x: Any) -> Found:
    names = class_names(x)
    if "SurfaceMesh" in names:
        return Found("nilearn", points=x.coordinates, faces=x.faces)
    mesh = x.mesh if "SurfaceImage" in names else x
    # Both hemispheres as one mesh of two components.
    parts = [(np.asarray(part.coordinates), np.asarray(part.faces)) for part in mesh.parts.values()]
    starts = np.cumsum([0, *(len(points) for points, _ in parts)])
    points = np.concatenate([points for points, _ in parts])
    faces = np.concatenate([faces + start for (_, faces), start in zip(parts, starts, strict=False)])
    found = Found("nilearn", points=points, faces=faces)
    if mesh is not x:
        found.fields["data"] = np.concatenate([np.asarray(values) for values in x.data.parts.values()])
        found.own_signal = "data"
    return found


def _read_torch_geometric(x: Any) -> Found:
    def array(name: str) -> Any:
        tensor = getattr(x, name, None)
        return None if tensor is None else tensor.detach().cpu().numpy()

    points, faces, ends = array("pos"), array("face"), array("edge_index")
    if faces is not None and points is not None:
        found = Found("torch_geometric", points=points, faces=faces.T)
    elif ends is not None:
        weights = array("edge_weight")
        found = Found("torch_geometric", edges=(ends[0], ends[1], weights, False), n_vertices=int(x.num_nodes))
        found.own_signal = "x" if array("x") is not None else None
    elif points is not None:
        found = Found("torch_geometric", points=points)
    else:
        raise _refused(x, "it has neither edge_index nor pos")
    names: Any = x.keys() if callable(x.keys) else x.keys
    for name in names:
        if name not in ("pos", "face", "edge_index", "edge_weight", "edge_attr") and hasattr(x[name], "detach"):
            found.fields[name] = array(name)
    return found


def _read_pygsp(x: Any) -> Found:
    entries = x.W.tocoo()
    found = Found("pygsp", edges=(entries.row, entries.col, entries.data, False), n_vertices=int(x.N))
    found.fields = dict(getattr(x, "signals", {}))
    return found


def _read_laspy(x: Any) -> Found:
    names = [name for name in x.point_format.dimension_names if name not in ("X", "Y", "Z")]
    return Found("laspy", points=x.xyz, fields={name: np.asarray(x[name]) for name in names})


def _read_anndata(x: Any) -> Found:
    if "connectivities" not in x.obsp:
        raise _refused(
            x, "its cells have no neighbors: run scanpy.pp.neighbors on it, or pass aw.point_walk(coordinates)"
        )
    entries = x.obsp["connectivities"].tocoo()
    found = Found("anndata", edges=(entries.row, entries.col, entries.data, False), n_vertices=int(x.n_obs))
    found.fields = {str(name): x.obs[name].to_numpy() for name in x.obs.columns if x.obs[name].dtype.kind in "biuf"}
    return found


_READERS: dict[str, Callable[[Any], Found]] = {
    "trimesh": _read_trimesh,
    "pyvista": _read_pyvista,
    "vtk": _read_vtk,
    "meshio": _read_meshio,
    "open3d": _read_open3d,
    "networkx": _read_networkx,
    "scipy": _read_scipy,
    "pandas": _read_frame,
    "polars": _read_frame,
    "nilearn": _read_nilearn,
    "torch_geometric": _read_torch_geometric,
    "pygsp": _read_pygsp,
    "laspy": _read_laspy,
    "anndata": _read_anndata,
    "igraph": _read_igraph,
}
