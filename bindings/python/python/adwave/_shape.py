"""`Shape`: points, faces or edges with fields, from a file, arrays or another library's object."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from adwave import _adapt, _native
from adwave._caller import Call, public, warn
from adwave._deform import Deformer
from adwave._methods import Carrier
from adwave._misfit import working_line
from adwave._notebook import shape_html
from adwave._progress import ProgressLike, report_progress

Kind = Literal["mesh", "cloud", "graph"]
Path = Union[str, "os.PathLike[str]"]
Conditions = Union[str, Sequence[str]]


@dataclass(frozen=True)
class SelectionOptions:
    """Vertices that take part, as the extension takes them."""

    only: list[str] = field(default_factory=list)
    mask: Union[str, None] = None
    invert_mask: bool = False
    all_points: bool = False


@dataclass(frozen=True)
class ReadOptions:
    """Part of a file to read, as the extension takes it."""

    kind: Union[Kind, None] = None
    bounds: Union[tuple[list[float], list[float]], None] = None
    resolution: Union[float, None] = None
    selection: SelectionOptions = field(default_factory=SelectionOptions)


class Fields(Mapping[str, "NDArray[Any]"]):
    """Values of the vertices (or faces) of a shape by their names: a read-only mapping of arrays."""

    __slots__ = ("_get", "_names")

    def __init__(self, names: list[str], get: Any) -> None:
        self._names = names
        self._get = get

    def __getitem__(self, name: str) -> NDArray[Any]:
        values = self._get(name)
        if values is None:
            raise KeyError(f"{name!r}; the shape has {', '.join(map(repr, self._names)) or 'no fields'}")
        return values

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return f"Fields({', '.join(self._names)})"


class Shape(Carrier):
    """A triangle or polygon mesh, a point cloud or a graph, with values at its vertices and faces.

    A shape is immutable: `with_points` and `with_field` give new shapes that share the unchanged parts.

    Parameters
    ----------
    points : shape_like
        Anything that is a shape: an array of points (n × 3, any type and order; n × 2 has z = 0), a pair
        ``(points, faces)``, several meshes such as both hemispheres of a brain (which become one), a path, a sparse matrix
        of weights (a graph), a dictionary or an archive of numpy with ``'vertices'`` and ``'faces'``, or an object of
        trimesh, PyVista, meshio, Open3D, networkx, igraph, nilearn, AnnData, PyTorch Geometric, PyGSP, laspy or pandas.
        Both hemispheres of nilearn are one mesh, and the points of a structured grid of PyVista the nodes of a graph. An
        `ImageData` is a `grid` to all functions, and a graph only here.
    faces : array_like, optional
        Corners of the faces, counted from 0: m × k, or a list of polygons of any length. Without faces, points are a
        cloud.
    fields : mapping, optional
        Values of the vertices by their names, each of n or n × channels numbers.
    kind : {'mesh', 'cloud', 'graph'}, optional
        Kind that the shape is treated as: a mesh as a cloud is its vertices.

    Raises
    ------
    ValueError, TypeError
        If an argument is invalid; the message is one line with the argument, its shape and type, and the first row that
        is wrong.

    Notes
    -----
    The order and the number of vertices are preserved. Points at exactly equal positions are welded for the analysis
    only. Points and faces are copied once, which takes about 1 ms for a million vertices.

    Examples
    --------
    >>> import adwave as aw
    >>> square = aw.Shape([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> square
    <adwave.Shape: mesh, 4 vertices, 2 faces>
    >>> square.points[2]
    array([1., 1., 0.])
    """

    __slots__ = ("__weakref__", "_data", "_lost")

    @public()
    def __init__(
        self,
        points: object,
        faces: object = None,
        *,
        fields: Mapping[str, ArrayLike] | None = None,
        kind: Kind | None = None,
    ) -> None:
        self._lost: tuple[str, ...] = ()
        if isinstance(points, Shape) and faces is None:
            data, self._lost = points._data, points._lost
        elif _adapt.is_path(points) and faces is None:
            data = _native.ShapeData.read(os.fspath(points), ReadOptions())  # type: ignore[call-overload]
            _warn_of_flagged(data)
        else:
            parts = _adapt.parts_of(points, faces)
            data, self._lost = _data_from_parts(parts), parts.lost
        for name, values in (fields or {}).items():
            data = data.with_field(name, _field_values(values, data.n_vertices, name))
        self._data: _native.ShapeData = data.with_kind(kind) if kind is not None else data

    @classmethod
    def _from_data(cls, data: _native.ShapeData, lost: tuple[str, ...] = ()) -> Shape:
        shape = cls.__new__(cls)
        shape._data, shape._lost = data, lost
        return shape

    @property
    def kind(self) -> Kind:
        """``'mesh'``, ``'cloud'`` or ``'graph'``."""
        return self._data.kind

    @property
    def n_vertices(self) -> int:
        """Number of vertices, or of nodes of a graph."""
        return self._data.n_vertices

    @property
    def file_rows(self) -> NDArray[np.uint32]:
        """Row of the file of each vertex, from 0.

        Points without a position, as written by depth cameras, are rows of the file and no vertices.
        """
        return self._data.file_rows()

    def in_file_rows(self, values: ArrayLike) -> NDArray[np.float64]:
        """Values with a row for each row of the file, NaN where the row is no vertex.

        Parameters
        ----------
        values : array_like
            Values with a row for each vertex.

        Returns
        -------
        numpy.ndarray
            As many rows as the file has points.

        Examples
        --------
        >>> import adwave
        >>> cloud = adwave.read_bytes(b"0 0 1\\nnan nan nan\\n2 0 3\\n", "a.xyz")
        >>> cloud.file_rows.tolist()
        [0, 2]
        >>> cloud.in_file_rows([7, 9]).tolist()
        [7.0, nan, 9.0]
        """
        rows = np.asarray(values, dtype=np.float64)
        if not rows.ndim or len(rows) != self.n_vertices:
            raise ValueError(f"values must have {self.n_vertices} rows, one per vertex; got shape {rows.shape}")
        everywhere = np.full((self._data.n_file_rows, *rows.shape[1:]), np.nan)
        everywhere[self.file_rows] = rows
        return everywhere

    @property
    def n_faces(self) -> int:
        """Number of faces."""
        return self._data.n_faces

    @property
    def points(self) -> NDArray[np.float64]:
        """Positions, n × 3, in model units: a read-only view. 0 × 3 for a graph without positions."""
        return self._data.points

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Alias of `points`."""
        return self._data.points

    @property
    def faces(self) -> NDArray[np.uint32]:
        """Triangles, m × 3: a read-only view.

        Raises
        ------
        ValueError
            If a face has more than three corners; see `polygons`.
        """
        triangles = self._data.triangles
        if triangles is None:
            raise ValueError("some faces have more than three corners; use Shape.polygons()")
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
        """Edges that the file or the graph lists, without those of the faces.

        Returns
        -------
        pairs : (e, 2) array
            Vertices at both ends.
        weights : (e,) array
            1 if the edges have no weights.
        """
        pairs, weights, _ = self._data.edges()
        return pairs, weights if len(weights) else np.ones(len(pairs))

    @property
    def fields(self) -> Fields:
        """Values of the vertices by name, in the number type of the file."""
        return Fields(self._data.field_names(), self._data.field)

    @property
    def face_fields(self) -> Fields:
        """Values of the faces by name."""
        return Fields(self._data.face_field_names(), self._data.face_field)

    @property
    def format(self) -> str | None:
        """Format of the file that the shape was read from; None if there was none."""
        return self._data.format

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.fields[name]

    def with_points(self, points: ArrayLike, *, keep_normals: bool = False) -> Shape:
        """Shape with the same faces and fields at other positions.

        Normals (the field ``normal``, or those of the face corners of a file) and tangents follow the positions: they
        are recomputed where the shape moved.

        Parameters
        ----------
        points : (n, 3) array_like
            One row for each vertex, in the same order, in model units.
        keep_normals : bool
            Keep the old normals and tangents.

        Examples
        --------
        >>> import adwave as aw
        >>> shape = aw.sample("sphere", vertices=100)
        >>> float(shape.with_points(2 * shape.points).points.max() / shape.points.max())
        2.0
        """
        return Shape._from_data(self._data.with_points(_adapt.points_array(points), keep_normals), self._lost)

    def _with_positions(self, points: NDArray[np.float64]) -> Shape:
        return Shape._from_data(self._data.with_points(points), self._lost)

    def with_field(self, name: str, values: ArrayLike) -> Shape:
        """Shape with values at its vertices; a field of the same name is replaced.

        Parameters
        ----------
        name : str
            Name of the field.
        values : (n,) or (n, channels) array_like
            Values, whose number type is preserved.

        Examples
        --------
        >>> import adwave as aw
        >>> shape = aw.sample("sphere", vertices=100).with_field("heat", range(100))
        >>> int(shape["heat"].max())
        99
        """
        data = self._data.with_field(name, _field_values(values, self.n_vertices, name))
        return Shape._from_data(data, self._lost)

    def with_fields(self, fields: Mapping[str, ArrayLike]) -> Shape:
        """Shape with several fields; see `with_field`.

        Parameters
        ----------
        fields : mapping
            Values by their names.
        """
        shape = self
        for name, values in fields.items():
            shape = shape.with_field(name, values)
        return shape

    def deformer(
        self,
        fixed: object,
        handles: Sequence[object],
        *,
        levels: object = None,
        stiffness: float | str | None = None,
        keep_lengths: float = 0.0,
    ) -> Deformer:
        """Bind the shape to handles; see `Deformer`.

        Parameters
        ----------
        fixed : str or array_like or None
            What stays: a region in its text form, a flag or weight for each vertex, or the indices of vertices.
        handles : sequence
            Regions that are moved, each given like `fixed`.
        levels : int, Widths, Steps or Octaves, optional
            The base is the last level; by default one of 4.5 % of the diagonal.
        stiffness : float or str, optional
            Bending length, in model units or as a share of the diagonal; 0.75 times the width of the base by default.
        keep_lengths : float
            Share of lengths in [0, 1]: 0 keeps the detail, 1 the lengths of edges.
        """
        import adwave  # the package loads the module of `Decomposer`, which is above this one, when it is first named

        bound = adwave.Decomposer(self)
        return bound.deformer(fixed, handles, levels=levels, stiffness=stiffness, keep_lengths=keep_lengths)  # type: ignore[arg-type]

    def select(
        self, only: Conditions | None = None, *, mask: ArrayLike | Path | None = None, invert_mask: bool = False
    ) -> Shape:
        """Part of the shape with the vertices that take part; the others are nobody's neighbors.

        The part remembers where it comes from: `file_rows` has the row of each vertex, `in_file_rows` puts results back,
        and `write` writes all vertices, the others with the positions and values that they had.

        Parameters
        ----------
        only : str or sequence of str, optional
            Conditions on fields, all of which must hold: ``'classification=2,6'`` or ``'height=1..20'``, where either
            end may be missing. ``x``, ``y`` and ``z`` are the coordinates. NaN fulfills none.
        mask : array_like or path_like, optional
            One number for each vertex, or for each row of the file: all but 0 and NaN take part. Or a file: .npy, .csv,
            .gii and others of numbers, a FreeSurfer label (its vertices take part; of that of the medial wall the
            others), or an .annot (the regions of the cortex take part, or those after a colon).
        invert_mask : bool
            The vertices that are not in the mask take part.

        Returns
        -------
        Shape
            Faces and edges stay if all their vertices do.

        Raises
        ------
        ValueError
            If a field does not exist or has several channels, the mask has another length, or no vertex is left.

        Examples
        --------
        >>> import adwave as aw
        >>> cloud = aw.Shape([[0, 0, 0], [1, 0, 5], [2, 0, 0]], fields={"classification": [2, 5, 2]})
        >>> ground = cloud.select("classification=2")
        >>> ground.n_vertices, ground.file_rows.tolist()
        (2, [0, 2])
        >>> cloud.select(mask=[0, 1, 0]).points.tolist()
        [[1.0, 0.0, 5.0]]
        """
        conditions = _conditions(only)
        if mask is None or _adapt.is_path(mask):
            path = None if mask is None else os.fspath(mask)  # type: ignore[call-overload]
            options = SelectionOptions(conditions, path, invert_mask, all_points=True)
            return Shape._from_data(self._data.select(options), self._lost)
        options = SelectionOptions(conditions, all_points=True)
        return Shape._from_data(self._data.select(options, self._mask_flags(mask, invert_mask)), self._lost)

    def _mask_flags(self, mask: object, invert: bool) -> NDArray[np.bool_]:
        values = np.asarray(mask)
        n, n_rows = self.n_vertices, self._data.n_file_rows
        if values.ndim != 1 or len(values) not in (n, n_rows) or values.dtype.kind not in "buif":
            raise ValueError(
                f"mask must have one number for each of {n} vertices; got shape {values.shape} of {values.dtype}"
            )
        inside = (values != 0) & ~np.isnan(values.astype(np.float64, copy=False))
        if len(inside) != n:
            inside = inside[self.file_rows]
        inside = ~inside if invert else inside
        if n and not inside.any():
            raise ValueError("mask must have a vertex that takes part; got none")
        return np.ascontiguousarray(inside)

    def write(self, path: Path, *, format: str | None = None, progress: ProgressLike = None) -> list[str]:
        """Write the shape to a file, completely or not at all.

        In the format that it was read from, the file keeps everything else that it had: comments, materials, header.

        Parameters
        ----------
        path : path_like
            File whose extension chooses the format; ``.gz`` after it compresses.
        format : str, optional
            Name of a format, whatever the extension.
        progress : bool or callable, optional
            ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

        Returns
        -------
        list of str
            Parts of the shape that the format cannot store, and of the object that the shape came from; empty if everything
            was written.

        Raises
        ------
        ValueError
            If the format is unknown.
        OSError
            If the file cannot be written.
        """
        with report_progress(progress, "writing") as report:
            return [*self._data.write(os.fspath(path), format, report), *self._lost]

    def to_bytes(self, format: str = "ply") -> bytes:
        """Content of a file.

        Parameters
        ----------
        format : str
            Name of the format.

        Examples
        --------
        >>> import adwave as aw
        >>> aw.sample("sphere", vertices=100).to_bytes("obj")[:2]
        b'v '
        """
        return self._data.to_bytes(format)

    def to(self, like: object) -> Any:
        """A new object of another library with the points and fields of this shape; arrays take the points only.

        Parameters
        ----------
        like : object
            The source of the shape, or another shape of the same connectivity: a trimesh, PyVista, meshio or Open3D object
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
        """A `trimesh.Trimesh` with the same vertices in the same order; fields become its vertex and face attributes.

        Texture coordinates and colors become its visuals. A warning names what it has no place for.
        """
        import trimesh

        mesh = trimesh.Trimesh(np.array(self.points), self._triangles(), process=False)
        self._warn_of_loss("trimesh")
        return _adapt.with_results(mesh, fields=dict(self.fields), face_fields=dict(self.face_fields))

    def to_pyvista(self) -> Any:
        """A `pyvista.PolyData` with the same points and faces; fields become its point and cell data.

        Texture coordinates become its active ones. A warning names what it has no place for.
        """
        import pyvista

        if self.kind == "cloud" or not self.n_faces:
            poly = pyvista.PolyData(np.array(self.points))
        else:
            offsets, corners = self.polygons()
            sizes = np.diff(offsets.astype(np.int64))
            padded = np.insert(corners.astype(np.int64), offsets[:-1].astype(np.int64), sizes)
            poly = pyvista.PolyData(np.array(self.points), padded)
        self._warn_of_loss("PyVista")
        return _adapt.with_results(poly, fields=dict(self.fields), face_fields=dict(self.face_fields))

    def _warn_of_loss(self, library: str) -> None:
        """Warn of content of the file or object that another library's object is not given."""
        lost = [*self._data.extras, *self._lost]
        if lost:
            warn(f"the {library} object is without {', '.join(lost)}; Shape.write keeps what the file had")

    def _triangles(self) -> NDArray[np.int64]:
        return np.array(self.faces, dtype=np.int64)

    def signal(self, name: str, *, texture: Path | None = None) -> NDArray[np.float64]:
        """A signal by its name; see `adwave.signal`.

        Parameters
        ----------
        name : str
            Name of the signal.
        texture : path_like, optional
            Picture of the texture, instead of the one that the materials name.
        """
        values = self._data.signal(name, None if texture is None else os.fspath(texture))
        return values[:, 0] if values.shape[1] == 1 else values

    def __repr__(self) -> str:
        faces = f", {self.n_faces} faces" if self.n_faces and self.kind == "mesh" else ""
        names = self._data.field_names()
        fields = f", fields {', '.join(names)}" if names else ""
        return f"<adwave.Shape: {self.kind}, {self.n_vertices} vertices{faces}{fields}>"

    def _repr_html_(self) -> str:
        return shape_html(self._data)

    def __reduce__(self) -> tuple[Any, ...]:
        data = self._data
        if data.kind == "graph" and not data.n_faces:
            pairs, weights, undirected = data.edges()
            points = np.array(data.points) if data.points.size else None
            connected: tuple[Any, ...] = (pairs, weights, undirected, points)
        else:
            connected = (np.array(data.points), *data.polygons())
        fields = {name: self.fields[name] for name in self.fields}
        face_fields = {name: self.face_fields[name] for name in self.face_fields}
        return _restore_shape, (data.kind, data.n_vertices, connected, fields, face_fields)


def _restore_shape(
    kind: Kind, n: int, connected: tuple[Any, ...], fields: dict[str, Any], face_fields: dict[str, Any]
) -> Shape:
    if isinstance(connected[2], bool):
        pairs, weights, undirected, points = connected
        pairs = np.ascontiguousarray(pairs.T)
        weights = weights if len(weights) else None
        data = _native.ShapeData.from_graph(n, pairs[0], pairs[1], weights, undirected, points)
    else:
        points, offsets, corners = connected
        data = _native.ShapeData.from_arrays(points, corners, offsets, kind)
    for name, values in fields.items():
        data = data.with_field(name, values)
    for name, values in face_fields.items():
        data = data.with_face_field(name, values)
    return Shape._from_data(data)


def _data_from_parts(parts: _adapt.Parts) -> _native.ShapeData:
    if parts.kind == "graph" or parts.points is None:
        data = _native.ShapeData.from_graph(
            parts.n_vertices, parts.rows, parts.cols, parts.weights, parts.is_symmetric_list, parts.points
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
        raise TypeError(f"field {name!r}: must be real numbers, got {array.dtype}")
    if array.dtype.itemsize > 8 or array.dtype == np.float16:
        array = array.astype(np.float64)
    if array.ndim not in (1, 2) or array.shape[0] != n:
        raise ValueError(f"field {name!r}: must have one row for each of {n} vertices, got shape {array.shape}")
    return np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("="))


@public()
def as_shape(shape: object, faces: object = None) -> Shape:
    """Anything that is a shape as a `Shape`; a `Shape` is returned unchanged.

    Parameters
    ----------
    shape : shape_like
        Anything that is a shape; see `Shape`.
    faces : array_like, optional
        Faces, if `shape` is an array of points.

    Raises
    ------
    ValueError, TypeError
        If an argument is invalid; see `Shape`.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.as_shape(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    <adwave.Shape: mesh, 3 vertices, 1 faces>
    """
    if faces is None:
        if isinstance(shape, Shape):
            return shape
        # A `Decomposer`.
        own = getattr(shape, "shape", None)
        if isinstance(own, Shape):
            return own
    return Shape(shape, faces)


def _conditions(only: Conditions | None) -> list[str]:
    if only is None:
        return []
    return [only] if isinstance(only, str) else list(only)


def _warn_of_flagged(data: _native.ShapeData) -> None:
    """Warn of points that a file flags as withheld or noise, which are left out."""
    if data.n_flagged:
        warn(
            f"{data.n_flagged} of {data.n_file_rows} points are flagged as withheld or classified as noise (7, 18) and "
            "take no part; all_points=True includes them"
        )


def _bounds(box: ArrayLike) -> tuple[list[float], list[float]]:
    """Least and greatest coordinates of a box of six numbers, or of four, which leave z free."""
    numbers = np.asarray(box, dtype=float).ravel().tolist()
    if len(numbers) not in (4, 6):
        raise ValueError(
            f"box: must be xmin, ymin, zmin, xmax, ymax, zmax, or four numbers without z, got {len(numbers)} numbers"
        )
    half = len(numbers) // 2
    low, high = numbers[:half], numbers[half:]
    return (low, high) if half == 3 else ([*low, -np.inf], [*high, np.inf])


@public()
def read(
    path: Path,
    *,
    kind: Kind | None = None,
    box: ArrayLike | None = None,
    resolution: float | None = None,
    only: Conditions | None = None,
    mask: Path | None = None,
    invert_mask: bool = False,
    all_points: bool = False,
    progress: ProgressLike = None,
) -> Shape:
    """Read a shape from a file.

    The format is recognized by the content first and by the name second: OBJ, PLY, OFF, STL, glTF, GLB, XYZ, PTS, PWN, CSV, PCD,
    LAS, LAZ, E57, GIFTI, FreeSurfer, VTK (VTP, VTU, VTR, VTS, legacy), Gmsh, Medit, AMF, 3MF, Geomview, DMAT; MatrixMarket,
    TGF, GraphML and lists of edges (graphs); plain or gzip.

    Parameters
    ----------
    path : path_like
        The file.
    kind : {'mesh', 'cloud', 'graph'}, optional
        Kind that the file is treated as.
    box : array_like, optional
        Read only the points in this closed box, in model units: (xmin, ymin, zmin, xmax, ymax, zmax), or
        (xmin, ymin, xmax, ymax). For LAS, LAZ, COPC and EPT (``ept.json``); of the last two only the nodes that meet the
        box are read.
    resolution : float, optional
        Distance of the points, in model units: the levels of a COPC or EPT that are finer are not read.
    only : str or sequence of str, optional
        Conditions on fields that the vertices of the shape fulfill, such as ``'classification=2'``; see `Shape.select`.
        The others keep their values when the shape is written.
    mask : path_like, optional
        File that says which vertices take part; see `Shape.select`, which takes arrays too.
    invert_mask : bool
        The vertices that are not in the mask take part.
    all_points : bool
        Let points of a LAS, LAZ or EPT take part that are flagged as withheld or classified as noise (7 and 18). Without
        it they are left out with a warning, and come back when the shape is written.
    progress : bool or callable, optional
        ``True`` for a bar (by tqdm, if installed), or a function of (done, total).

    Returns
    -------
    Shape

    Raises
    ------
    OSError
        If the file cannot be opened.
    ValueError
        If it is broken or not a shape (the message has the line or byte), or no point lies in the box (the message has the
        bounds of the file).
    MemoryError
        If it needs more memory than allowed.

    Examples
    --------
    >>> import adwave as aw, os, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = os.path.join(folder, "sphere.ply")
    ...     not_written = aw.sample("sphere", vertices=100).write(path)
    ...     aw.read(path)
    <adwave.Shape: mesh, 100 vertices, 196 faces>
    """
    with report_progress(progress, "reading") as report:
        bounds = None if box is None else _bounds(box)
        selection = SelectionOptions(
            _conditions(only), None if mask is None else os.fspath(mask), invert_mask, all_points
        )
        options = ReadOptions(kind, bounds, resolution, selection)
        data = _native.ShapeData.read(os.fspath(path), options, report)
    _warn_of_flagged(data)
    return Shape._from_data(data)


def read_bytes(content: bytes, name: str | None = None, *, kind: Kind | None = None, all_points: bool = False) -> Shape:
    """Read a shape from the content of a file.

    Parameters
    ----------
    content : bytes
        Content of the file.
    name : str, optional
        Name of the file, for formats that the content does not tell.
    kind : {'mesh', 'cloud', 'graph'}, optional
        Kind that the file is treated as.
    all_points : bool
        Let points of a LAS or LAZ take part that are flagged as withheld or classified as noise; see `read`.

    Raises
    ------
    ValueError
        If the content is not a shape.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.read_bytes(b"v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n", "a.obj")
    <adwave.Shape: mesh, 3 vertices, 1 faces>
    """
    data = _native.ShapeData.read_bytes(bytes(content), name, kind, all_points)
    _warn_of_flagged(data)
    return Shape._from_data(data)


@public()
def sample(name: str = "creature", *, vertices: int | None = None, noise: float | None = None, seed: int = 1) -> Shape:
    """A built-in shape.

    Parameters
    ----------
    name : {'creature', 'sphere', 'torus', 'plane', 'knot', 'bracket', ...}
        ``'bracket'`` has creases, ``'plane'`` a border. A wrong name lists all names.
    vertices : int, optional
        Approximate number of vertices; `Shape.n_vertices` is the exact one.
    noise : float, optional
        Standard deviation of noise along the normals, in mean edge lengths.
    seed : int
        Seed of the noise.

    Raises
    ------
    ValueError
        If there is no such shape.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.sample("sphere", vertices=100)
    <adwave.Shape: mesh, 100 vertices, 196 faces>
    """
    try:
        return Shape._from_data(_native.ShapeData.sample(name, vertices, noise, seed))
    except ValueError as error:
        if "there is no sample" not in str(error):
            raise
        raise ValueError(f"{error}{working_line('sample', _any_sample, 'aw.sample()')}") from None


def _any_sample(call: Call) -> None:
    call.arguments[:] = ['"creature"']
    call.keywords.pop("name", None)


@public()
def graph(
    n_vertices: int, edges: ArrayLike, weights: ArrayLike | None = None, *, points: ArrayLike | None = None
) -> Shape:
    """A graph from a list of edges, each listed once; with positions and without weights, a curve.

    On a curve signals diffuse by arc length, and `filter` and `denoise` move its vertices.

    Parameters
    ----------
    n_vertices : int
        Number of nodes.
    edges : (e, 2) array_like
        Nodes at both ends, counted from 0.
    weights : (e,) array_like, optional
        Positive weights; 1 by default.
    points : (n_vertices, 3) array_like, optional
        Positions of the nodes, in model units. If there are weights too, these decide the steps.

    Raises
    ------
    ValueError
        If an edge has a node that is not there, a weight is not positive, or there is not one position per node.

    Examples
    --------
    >>> import adwave as aw
    >>> aw.graph(3, [[0, 1], [1, 2]])
    <adwave.Shape: graph, 3 vertices>
    >>> track = aw.graph(3, [[0, 1], [1, 2]], points=[[0, 0, 0], [1, 0.2, 0], [2, 0, 0]])
    >>> aw.filter(track, "smooth", levels=2).points[[0, 2]].tolist()
    [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]
    """
    parts = _adapt.graph_parts(n_vertices, edges, weights)
    if points is None:
        return Shape._from_data(_data_from_parts(parts))
    positions = _adapt.points_array(points)
    if len(positions) != parts.n_vertices:
        raise ValueError(
            f"points: a graph of {parts.n_vertices} nodes needs one row for each, (n_vertices, 3), got {len(positions)}"
        )
    data = _native.ShapeData.from_graph(parts.n_vertices, parts.rows, parts.cols, parts.weights, True, positions)
    return Shape._from_data(data)
