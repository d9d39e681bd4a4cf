"""`Shape`: points, faces or edges with fields, from a file, arrays or another library's object."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._progress import ProgressLike, reporting

Kind = Literal["mesh", "cloud", "graph"]
Path = Union[str, "os.PathLike[str]"]


class Fields(Mapping[str, "NDArray[Any]"]):
    """The values per vertex (or face) of a shape by their names: a read-only mapping of arrays."""

    __slots__ = ("_get", "_names")

    def __init__(self, names: list[str], get: Any) -> None:
        self._names = names
        self._get = get

    def __getitem__(self, name: str) -> NDArray[Any]:
        values = self._get(name)
        if values is None:
            raise KeyError(f"{name!r}; there is {', '.join(map(repr, self._names)) or 'none'}")
        return values

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return f"Fields({', '.join(self._names)})"


class Shape:
    """A triangle or polygon mesh, a point cloud or a graph, with values at its vertices and faces.

    It never changes: `with_points` and `with_field` give new shapes that share what stayed the same.

    Parameters
    ----------
    points : shape-like
        Anything that is a shape: an array of points (n × 3, any type and order; n × 2 has z = 0), a path, a sparse matrix
        of weights (a graph), or an object of trimesh, PyVista, meshio, Open3D or networkx.
    faces : array-like, optional
        Corners of the faces, counted from 0: m × k, or a list of polygons of any length. Without faces, points are a cloud.
    fields : mapping, optional
        Values per vertex by their names, each of n or n × c numbers.
    kind : {'mesh', 'cloud', 'graph'}, optional
        What the shape is taken as, whatever it has: a mesh as a cloud is its vertices.

    Raises
    ------
    ValueError, TypeError
        In one line: which argument, its shape and type, and the first row that is wrong.

    Notes
    -----
    The order and the number of vertices stay. Points at exactly equal positions are welded for the analysis only.
    Points and faces are copied once, about 1 ms for a million vertices, so that nobody can change them from outside.

    Examples
    --------
    >>> import adwave as aw
    >>> square = aw.Shape([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> square
    <adwave.Shape: mesh, 4 vertices, 2 faces>
    >>> square.points[2]
    array([1., 1., 0.])
    """

    __slots__ = ("__weakref__", "_data")

    def __init__(
        self,
        points: object,
        faces: object = None,
        *,
        fields: Mapping[str, ArrayLike] | None = None,
        kind: Kind | None = None,
    ) -> None:
        if isinstance(points, Shape) and faces is None:
            data = points._data
        elif _adapt.is_path(points) and faces is None:
            data = _native.ShapeData.read(os.fspath(points))  # type: ignore[call-overload]
        else:
            data = _of_parts(_adapt.parts_of(points, faces))
        for name, values in (fields or {}).items():
            data = data.with_field(name, _field_values(values, data.n_vertices, name))
        self._data: _native.ShapeData = data.taken_as(kind) if kind is not None else data

    @classmethod
    def _of(cls, data: _native.ShapeData) -> Shape:
        shape = cls.__new__(cls)
        shape._data = data
        return shape

    # What it consists of

    @property
    def kind(self) -> Kind:
        """``'mesh'``, ``'cloud'`` or ``'graph'``."""
        return self._data.kind

    @property
    def n_vertices(self) -> int:
        """Number of vertices, or of nodes of a graph."""
        return self._data.n_vertices

    @property
    def n_faces(self) -> int:
        """Number of faces."""
        return self._data.n_faces

    @property
    def points(self) -> NDArray[np.float64]:
        """Positions, n × 3, model units: a read-only view of the shape's own memory. Of a graph without positions 0 × 3."""
        return self._data.points

    @property
    def faces(self) -> NDArray[np.uint32]:
        """Triangles, m × 3: a read-only view.

        Raises
        ------
        ValueError
            When the faces have more than three corners; `polygons` has them.
        """
        triangles = self._data.triangles
        if triangles is None:
            raise ValueError("the faces have more than three corners; take Shape.polygons()")
        return triangles

    def polygons(self) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
        """Faces of any number of corners.

        Returns
        -------
        offsets : (m + 1,) array
            Face f has the corners ``corners[offsets[f]:offsets[f + 1]]``.
        corners : array
            Vertices, counted from 0.
        """
        return self._data.polygons()

    def edges(self) -> tuple[NDArray[np.uint32], NDArray[np.float64]]:
        """The edges that the file or the graph lists itself, not those of the faces.

        Returns
        -------
        pairs : (e, 2) array
        weights : (e,) array
            1 where there are none.
        """
        pairs, weights, _ = self._data.edges()
        return pairs, weights if len(weights) else np.ones(len(pairs))

    @property
    def fields(self) -> Fields:
        """Values per vertex by name, in the type of numbers that the file has."""
        return Fields(self._data.field_names(), self._data.field)

    @property
    def face_fields(self) -> Fields:
        """Values per face by name."""
        return Fields(self._data.face_field_names(), self._data.face_field)

    @property
    def format(self) -> str | None:
        """The format of the file it was read from."""
        return self._data.format

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.fields[name]

    # Changed, as a new one

    def with_points(self, points: ArrayLike) -> Shape:
        """The same shape at other positions.

        Parameters
        ----------
        points : (n, 3) array-like
            One row for each vertex, in the same order.

        Examples
        --------
        >>> import adwave as aw
        >>> shape = aw.sample("sphere", vertices=100)
        >>> float(shape.with_points(2 * shape.points).points.max() / shape.points.max())
        2.0
        """
        return Shape._of(self._data.with_points(_adapt.points_array(points)))

    def _with(self, points: NDArray[np.float64]) -> Shape:
        return Shape._of(self._data.with_points(points))

    def with_field(self, name: str, values: ArrayLike) -> Shape:
        """The same shape with values at its vertices, in place of those of that name.

        Parameters
        ----------
        name : str
        values : (n,) or (n, c) array-like
            Kept in their type of numbers.
        """
        return Shape._of(self._data.with_field(name, _field_values(values, self.n_vertices, name)))

    def with_fields(self, fields: Mapping[str, ArrayLike]) -> Shape:
        """`with_field` for several."""
        shape = self
        for name, values in fields.items():
            shape = shape.with_field(name, values)
        return shape

    # Out

    def write(self, path: Path, *, format: str | None = None, progress: ProgressLike = None) -> list[str]:
        """Write the shape to a file, as a whole or not at all.

        In the format that it was read from, the file keeps everything else that it had: comments, materials, header.

        Parameters
        ----------
        path : path-like
            Its ending chooses the format; ``.gz`` after it compresses.
        format : str, optional
            A format by its name, whatever the ending.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total).

        Returns
        -------
        list of str
            What the shape has and the format cannot hold; empty where all was written.
        """
        with reporting(progress, "writing") as report:
            return self._data.write(os.fspath(path), format, report)

    def to_bytes(self, format: str = "ply") -> bytes:
        """The content of a file of that format."""
        return self._data.to_bytes(format)

    def to(self, like: object) -> Any:
        """A new object of another library with the points and fields of this shape; arrays take the points alone.

        Parameters
        ----------
        like : object
            What the shape came from, or another shape of the same connectivity: a trimesh, PyVista, meshio or Open3D object
            or a pair ``(points, faces)``. It is not changed.

        Examples
        --------
        >>> import adwave as aw
        >>> sphere = aw.sample("sphere", vertices=100)
        >>> points, faces = sphere.to((sphere.points, sphere.faces))
        >>> points.shape
        (100, 3)
        """
        points = np.array(self.points) if self.points.size else None
        if isinstance(like, (tuple, list, np.ndarray)):
            return _adapt.with_results(like, points=points, fields={})
        return _adapt.with_results(like, points=points, fields=dict(self.fields), face_fields=dict(self.face_fields))

    def to_trimesh(self) -> Any:
        """A `trimesh.Trimesh` with the same vertices in the same order; values per vertex are its vertex attributes."""
        import trimesh

        mesh = trimesh.Trimesh(np.array(self.points), self._triangles(), process=False)
        mesh.vertex_attributes.update(self.fields)
        return mesh

    def to_pyvista(self) -> Any:
        """A `pyvista.PolyData` with the same points and faces; values are its point and cell data."""
        import pyvista

        if self.kind == "cloud" or not self.n_faces:
            poly = pyvista.PolyData(np.array(self.points))
        else:
            offsets, corners = self.polygons()
            sizes = np.diff(offsets.astype(np.int64))
            padded = np.insert(corners.astype(np.int64), offsets[:-1].astype(np.int64), sizes)
            poly = pyvista.PolyData(np.array(self.points), padded)
        for name, values in self.fields.items():
            poly.point_data[name] = values
        for name, values in self.face_fields.items():
            poly.cell_data[name] = values
        return poly

    def _triangles(self) -> NDArray[np.int64]:
        return np.array(self.faces, dtype=np.int64)

    def signal(self, name: str, *, texture: Path | None = None) -> NDArray[np.float64]:
        """A signal by its name; see `adwave.signal`."""
        values = self._data.signal(name, None if texture is None else os.fspath(texture))
        return values[:, 0] if values.shape[1] == 1 else values

    def __repr__(self) -> str:
        faces = f", {self.n_faces} faces" if self.n_faces and self.kind == "mesh" else ""
        names = self._data.field_names()
        fields = f", fields {', '.join(names)}" if names else ""
        return f"<adwave.Shape: {self.kind}, {self.n_vertices} vertices{faces}{fields}>"

    def _repr_html_(self) -> str:
        from adwave._picture import shape_html

        return shape_html(self)

    def __reduce__(self) -> tuple[Any, ...]:
        data = self._data
        if not data.points.size:
            pairs, weights, undirected = data.edges()
            connected: tuple[Any, ...] = (pairs, weights, undirected)
        else:
            connected = (np.array(data.points), *data.polygons())
        fields = {name: self.fields[name] for name in self.fields}
        face_fields = {name: self.face_fields[name] for name in self.face_fields}
        return _restored, (data.kind, data.n_vertices, connected, fields, face_fields)


def _restored(
    kind: Kind, n: int, connected: tuple[Any, ...], fields: dict[str, Any], face_fields: dict[str, Any]
) -> Shape:
    if isinstance(connected[2], bool):
        pairs, weights, undirected = connected
        pairs = np.ascontiguousarray(pairs.T)
        data = _native.ShapeData.from_graph(n, pairs[0], pairs[1], weights if len(weights) else None, undirected)
    else:
        points, offsets, corners = connected
        data = _native.ShapeData.from_arrays(points, corners, offsets, kind)
    for name, values in fields.items():
        data = data.with_field(name, values)
    for name, values in face_fields.items():
        data = data.with_face_field(name, values)
    return Shape._of(data)


def _of_parts(parts: _adapt.Parts) -> _native.ShapeData:
    if parts.kind == "graph" or parts.points is None:
        data = _native.ShapeData.from_graph(
            parts.n_vertices, parts.rows, parts.cols, parts.weights, parts.is_symmetric_list
        )
    else:
        data = _native.ShapeData.from_arrays(parts.points, parts.corners, parts.offsets, None)
    for name, values in parts.fields.items():
        data = data.with_field(name, _field_values(values, parts.n_vertices, name))
    for name, values in parts.face_fields.items():
        data = data.with_face_field(name, _field_values(values, data.n_faces, name))
    return data


def _field_values(values: ArrayLike, n: int, name: str) -> NDArray[Any]:
    array = np.asarray(values)
    if array.dtype == bool:
        array = array.astype(np.uint8)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"field {name!r}: dtype {array.dtype} is no type of real numbers")
    if array.dtype.itemsize > 8 or array.dtype == np.float16:
        array = array.astype(np.float64)
    if array.ndim not in (1, 2) or array.shape[0] != n:
        raise ValueError(f"field {name!r}: shape {array.shape} for {n} vertices; give one row for each")
    return np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("="))


def as_shape(shape: object, faces: object = None) -> Shape:
    """Anything that is a shape as a `Shape`; one that is one already is given back as it is.

    Parameters
    ----------
    shape, faces
        As for `Shape`.
    """
    if isinstance(shape, Shape) and faces is None:
        return shape
    return Shape(shape, faces)


def _bounds(box: ArrayLike) -> tuple[list[float], list[float]]:
    """The least and the greatest coordinates of a box of four numbers, where z is free, or six."""
    numbers = np.asarray(box, dtype=float).ravel().tolist()
    if len(numbers) not in (4, 6):
        raise ValueError(f"box: {len(numbers)} numbers; give xmin, ymin, zmin, xmax, ymax, zmax, or four without z")
    half = len(numbers) // 2
    low, high = numbers[:half], numbers[half:]
    return (low, high) if half == 3 else ([*low, -np.inf], [*high, np.inf])


def read(
    path: Path,
    *,
    kind: Kind | None = None,
    box: ArrayLike | None = None,
    resolution: float | None = None,
    progress: ProgressLike = None,
) -> Shape:
    """Read a shape from a file.

    The format is found from the content first and from the name second: OBJ, PLY, OFF, STL, glTF, GLB, XYZ, PTS, PWN, CSV, PCD,
    LAS, LAZ, E57, GIFTI, FreeSurfer, VTK (VTP, VTU, VTI, VTR, VTS, legacy), Gmsh, Medit, AMF, 3MF, Geomview, DMAT; MatrixMarket,
    TGF, GraphML and lists of edges (graphs); plain or gzip.

    Parameters
    ----------
    path : path-like
    kind : {'mesh', 'cloud', 'graph'}, optional
        What to take the file as.
    box : array-like, optional
        Only the points in this box, in model units, its faces included: (xmin, ymin, zmin, xmax, ymax, zmax), or (xmin, ymin, xmax, ymax);
        of LAS, LAZ, COPC and EPT (``ept.json``). Of the last two only the nodes that meet it are read.
    resolution : float, optional
        Points about this far apart, in model units: no finer levels of a COPC or EPT are read than that needs.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, where that is installed), or a function of (done, total).

    Raises
    ------
    OSError
        The file cannot be opened.
    ValueError
        It is broken, or no shape: with the line or byte. No point lies in the box: with the bounds of the file.
    MemoryError
        It asks for more than it may.
    """
    with reporting(progress, "reading") as report:
        bounds = None if box is None else _bounds(box)
        return Shape._of(_native.ShapeData.read(os.fspath(path), kind, report, bounds, resolution))


def read_bytes(content: bytes, name: str | None = None, *, kind: Kind | None = None) -> Shape:
    """Read a shape from the content of a file; ``name`` helps where the content does not tell the format.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.read_bytes(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", "a.obj")
    <adwave.Shape: mesh, 3 vertices, 1 faces>
    """
    return Shape._of(_native.ShapeData.read_bytes(bytes(content), name, kind))


def sample(name: str = "creature", *, vertices: int | None = None, noise: float | None = None, seed: int = 1) -> Shape:
    """A built-in shape.

    Parameters
    ----------
    name : {'creature', 'sphere', 'torus', 'plane', 'knot', 'bracket', ...}
        ``'bracket'`` has creases, ``'plane'`` a border. A wrong name lists them all.
    vertices : int, optional
        About so many: `Shape.n_vertices` says how many.
    noise : float, optional
        Standard deviation of noise along the normals, in mean edge lengths.
    seed : int
        Of the noise.
    """
    return Shape._of(_native.ShapeData.sample(name, vertices, noise, seed))


def graph(n_vertices: int, edges: ArrayLike, weights: ArrayLike | None = None) -> Shape:
    """A graph from a list of edges, each listed once.

    Parameters
    ----------
    n_vertices : int
        Number of nodes.
    edges : (e, 2) array-like
        Nodes at both ends, counted from 0.
    weights : (e,) array-like, optional
        Positive; 1 where none are given.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.graph(3, [[0, 1], [1, 2]])
    <adwave.Shape: graph, 3 vertices>
    """
    return Shape._of(_of_parts(_adapt.graph_parts(n_vertices, edges, weights)))
