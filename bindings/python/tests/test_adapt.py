"""Every kind of shape becomes the same arrays in the same order, and results go back into that kind."""

from __future__ import annotations

import importlib
import pathlib
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from adwave import _adapt
from adwave._adapt import graph_parts, is_path, parts_of, points_array, values_array, with_results

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 1], [5, 5, 5]], float)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3], [1, 4, 2]])
QUADS = np.array([[0, 1, 2, 3], [1, 4, 5, 2]])
MIXED = [[0, 1, 2, 3], [1, 4, 2]]
FAN = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5], [0, 5, 1]])
FOUR_LENGTHS = [[0, 1, 2], [0, 1, 2, 3], [0, 1, 2, 3], [0, 1, 2, 3, 4]]
MOVED = POINTS + np.array([0.125, 0.25, 0.5])
HEIGHT = np.arange(6.0)
PAIRS = np.arange(12, dtype=np.float32).reshape(6, 2)


def library(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        pytest.skip(f"{name} cannot be imported: {error}")


def assert_mesh(parts: _adapt.Parts, points: Any = POINTS, faces: Any = TRIANGLES) -> None:
    assert parts.kind == "mesh"
    assert parts.points is not None
    assert parts.points.dtype == np.float64 and parts.points.flags.c_contiguous and parts.points.dtype.isnative
    assert parts.corners.dtype == np.uint32 and parts.corners.flags.c_contiguous
    assert parts.points.flags.aligned and parts.corners.flags.aligned
    np.testing.assert_array_equal(parts.points, points)
    np.testing.assert_array_equal(parts.corners, np.concatenate(list(faces)))
    lengths = [len(face) for face in faces]
    if set(lengths) == {3}:
        assert parts.offsets is None
    else:
        assert parts.offsets is not None and parts.offsets.dtype == np.uint32
        np.testing.assert_array_equal(np.diff(parts.offsets), lengths)


def read_only(a: Any) -> Any:
    a = a.copy()
    a.flags.writeable = False
    return a


def crooked(a: Any) -> Any:
    """Copy of values at an unaligned address."""
    buffer = np.zeros(a.nbytes + 1, np.uint8)
    view = buffer[1:].view(a.dtype).reshape(a.shape)
    view[...] = a
    assert not view.flags.aligned
    return view


class Subclass(np.ndarray):
    pass


class WithArray:
    def __init__(self, a: Any) -> None:
        self.a = a

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return np.asarray(self.a, dtype)


class WithInterface:
    def __init__(self, a: Any) -> None:
        self.a, self.__array_interface__ = a, a.__array_interface__


class WithDlpack:
    def __init__(self, a: Any, device: int = 1) -> None:
        self.a, self.device = a, device

    def __dlpack__(self, **options: Any) -> Any:
        return self.a.__dlpack__(**options)

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.device, 0


VARIANTS: dict[str, Callable[[Any], Any]] = {
    "as it is": lambda a: a,
    "list": lambda a: a.tolist(),
    "tuples": lambda a: tuple(map(tuple, a.tolist())),
    "list of rows": list,
    "Fortran order": np.asfortranarray,
    "negative strides": lambda a: a[::-1, ::-1].copy()[::-1, ::-1],
    "every second": lambda a: np.repeat(np.repeat(a, 2, 0), 2, 1)[::2, ::2],
    "other byte order": lambda a: a.astype(a.dtype.newbyteorder()),
    "read only": read_only,
    "misaligned": crooked,
    "matrix": lambda a: a.view(np.matrix),
    "subclass": lambda a: a.view(Subclass),
    "masked, none masked": lambda a: np.ma.MaskedArray(a),
    "float16": lambda a: a.astype(np.float16),
    "float32": lambda a: a.astype(np.float32),
    "longdouble": lambda a: a.astype(np.longdouble),
    "int8": lambda a: a.astype(np.int8),
    "uint64": lambda a: a.astype(np.uint64),
    "int32": lambda a: a.astype(np.int32),
    "__array__": WithArray,
    "__array_interface__": WithInterface,
    "__dlpack__": WithDlpack,
    "memoryview": lambda a: np.ascontiguousarray(a).data,
}


@pytest.mark.parametrize("variant", VARIANTS)
def test_every_variant_of_an_array_gives_equal_parts(variant: str) -> None:
    change = VARIANTS[variant]
    for faces in (TRIANGLES, QUADS):
        assert_mesh(parts_of(change(POINTS), change(faces)), faces=faces)
        assert_mesh(parts_of((change(POINTS), change(faces))), faces=faces)
    cloud = parts_of(change(POINTS))
    assert cloud.kind == "cloud" and cloud.corners.size == 0
    np.testing.assert_array_equal(cloud.points, POINTS)
    np.testing.assert_array_equal(values_array(change(POINTS), 6), POINTS)
    edges = graph_parts(6, change(TRIANGLES[:, :2]))
    np.testing.assert_array_equal(edges.rows, TRIANGLES[:, 0])
    np.testing.assert_array_equal(edges.cols, TRIANGLES[:, 1])


def test_memory_maps_are_read_in_place(tmp_path: pathlib.Path) -> None:
    np.save(tmp_path / "points.npy", POINTS)
    mapped = np.load(tmp_path / "points.npy", mmap_mode="r")
    parts = parts_of(mapped, TRIANGLES)
    assert_mesh(parts)
    assert np.shares_memory(parts.points, mapped)


def test_what_fits_already_is_not_copied() -> None:
    corners = TRIANGLES.astype(np.uint32)
    for points in (POINTS, read_only(POINTS), POINTS.view(Subclass), WithDlpack(POINTS)):
        parts = parts_of(points, corners)
        assert np.shares_memory(parts.points, getattr(points, "a", points))
        assert np.shares_memory(parts.corners, corners)
    signed = TRIANGLES.astype(np.int32)
    assert np.shares_memory(parts_of(POINTS, signed).corners, signed)
    assert np.shares_memory(values_array(HEIGHT, 6), HEIGHT)
    assert np.shares_memory(parts_of(POINTS, fields={"pairs": PAIRS}).fields["pairs"], PAIRS)


FACE_FORMS: dict[str, tuple[Any, Any]] = {
    "rows": (TRIANGLES, TRIANGLES),
    "lists of several lengths": (MIXED, MIXED),
    "tuple of two faces": (((0, 1, 2), (0, 2, 3)), TRIANGLES[:2]),
    "tuple of two lengths": (([0, 1, 2, 3], [1, 4, 2]), MIXED),
    "object array": (np.array([[0, 1, 2, 3], [1, 4, 2]], dtype=object), MIXED),
    "padded triangles": (np.insert(TRIANGLES, 0, 3, axis=1).ravel(), TRIANGLES),
    "padded mixed": ([4, 0, 1, 2, 3, 3, 1, 4, 2], MIXED),
    "padded, as long as triangles": ([3, *FAN[0], *[4, 0, 1, 2, 3] * 2, 5, 0, 1, 2, 3, 4], FOUR_LENGTHS),
    "padded, counts look alike": ([3, 3, 1, 2, 4, 0, 1, 2, 3], [[3, 1, 2], [0, 1, 2, 3]]),
    "corners and offsets": ((np.concatenate(MIXED), np.array([0, 4, 7])), MIXED),
    "corners and offsets as lists": (([0, 1, 2, 3, 1, 4, 2], [0, 4, 7]), MIXED),
    "triangles as corners and offsets": ((TRIANGLES.ravel(), np.arange(0, 10, 3)), TRIANGLES),
    "whole floats": (TRIANGLES.astype(float), TRIANGLES),
    "three polygons of five": ([[0, 1, 2, 3, 4]] * 3, [[0, 1, 2, 3, 4]] * 3),
}


@pytest.mark.parametrize("form", FACE_FORMS)
def test_every_form_of_faces(form: str) -> None:
    faces, expected = FACE_FORMS[form]
    assert_mesh(parts_of(POINTS, faces), faces=expected)
    assert_mesh(parts_of([POINTS, faces]), faces=expected)


def test_small_and_flat_shapes() -> None:
    flat = parts_of(POINTS[:, :2], TRIANGLES)
    np.testing.assert_array_equal(flat.points, POINTS * [1, 1, 0])
    for nothing in ([], np.empty((0, 3)), np.empty((0, 2))):
        assert points_array(nothing).shape == (0, 3)
    two_points = parts_of(((0, 0, 0), (1, 1, 1)))
    assert (two_points.kind, two_points.n_vertices) == ("cloud", 2)
    assert parts_of((POINTS, None)).kind == "cloud"
    no_faces = parts_of(POINTS, [])
    assert (no_faces.kind, no_faces.corners.size, no_faces.offsets) == ("mesh", 0, None)
    assert values_array([], 0).shape == (0, 1)


def test_values() -> None:
    assert values_array(HEIGHT, 6).shape == (6, 1)
    assert np.isnan(values_array([1, np.nan, 2, 3, 4, 5], 6)[1, 0])
    masked = np.ma.MaskedArray(np.arange(6), mask=np.arange(6) == 2)
    assert np.isnan(values_array(masked, 6)[2, 0])
    np.testing.assert_array_equal(values_array(HEIGHT > 2, 6)[:, 0], HEIGHT > 2)


def test_fields_keep_their_type() -> None:
    given = {"byte": np.arange(6, dtype=np.uint8), "flag": HEIGHT > 2, "big": HEIGHT.astype(">f4")}
    given |= {
        "long": HEIGHT.astype(np.longdouble),
        "pairs": np.asfortranarray(PAIRS),
        "list": HEIGHT.tolist(),
    }
    parts = parts_of(POINTS, fields=given)
    kinds = {"byte": "u1", "flag": "u1", "big": "f4", "long": "f8", "pairs": "f4", "list": "f8"}
    for name, values in parts.fields.items():
        assert values.dtype == np.dtype(kinds[name]) and values.dtype.isnative and values.flags.c_contiguous
        np.testing.assert_array_equal(values, given[name])


HUGE = np.full((100, 3), 2**63 + 5, np.uint64)
GRAPH_LIKE = np.zeros((6, 6))
VALUE_ERRORS: dict[str, Callable[[], Any]] = {
    "points: row 5 is [nan, nan, nan]; coor": lambda: parts_of(np.where(POINTS == 5, np.nan, POINTS)),
    "points: shape (3, 6) looks transposed; pass points.T": lambda: parts_of(POINTS.T),
    "points: shape (18,) has one dimension; pass points.reshape(-1": lambda: parts_of(POINTS.ravel()),
    "points: shape (6, 4) has 4 columns, but positions have 2 or 3: values at the vertices of a shape are a signal": lambda: parts_of(
        np.ones((6, 4))
    ),
    "points: shape (6, 6) looks like weights between nodes; pass scipy": lambda: parts_of(GRAPH_LIKE),
    "points: shape (4, 3, 3) looks like separate triangles": lambda: parts_of(np.ones((4, 3, 3))),
    "points: row 1 has 2 entries, but row 0 has 3": lambda: parts_of([[0, 0, 0], [1, 1]]),
    "points: row 1 is [inf, 0.0, 0.0]": lambda: parts_of(np.longdouble("1e400") * POINTS),
    "points: row 5 is [nan, nan, nan]; coordinates must be finite": lambda: parts_of(np.ma.masked_equal(POINTS, 5)),
    "faces: row 0 has corner 810, but there are 6 points": lambda: parts_of(POINTS, TRIANGLES + 810),
    "faces: row 1 has corner 6, but there are 6": lambda: parts_of(POINTS, [[0, 1, 2], [3, 4, 6]]),
    "they count from 0: pass faces - 1": lambda: parts_of(POINTS, TRIANGLES + 1 + [[0, 0, 2]]),
    "faces: row 1 has corner 9, but there are": lambda: parts_of(POINTS, [[0, 1, 2, 3], [1, 4, 9]]),
    "faces: row 0 has corner -1, but corners count from 0": lambda: parts_of(POINTS, TRIANGLES - 1),
    "faces: row 0 has corner 9223372036854775813, but there are 6": lambda: parts_of(POINTS, HUGE),
    "faces: row 0 has corner 4294967296, but there are": lambda: parts_of(POINTS, [[0, 1, 2**32]]),
    "faces: row 0 has corner 1.5, which is not an index": lambda: parts_of(POINTS, [[0, 1, 1.5]]),
    "faces: row 0 has corner nan, which is not an index": lambda: parts_of(POINTS, [[0, 1, np.nan]]),
    "faces: row 0 has corner 1e+300, which is not an index": lambda: parts_of(POINTS, [[0, 1, 1e300]]),
    "faces: shape (3, 5) looks transposed": lambda: parts_of(POINTS, FAN.T),
    "faces: shape (3, 2) holds edges, not faces": lambda: parts_of(POINTS, TRIANGLES[:, :2]),
    "faces: shape (2, 3, 3) is not one row": lambda: parts_of(POINTS, np.zeros((2, 3, 3), int)),
    "faces: entry 0 is 0, which is not the number of corners": lambda: parts_of(POINTS, TRIANGLES.ravel()),
    "faces: entry 4 is 3, which is not the number of corners": lambda: parts_of(POINTS, [3, 0, 1, 2, 3, 0]),
    "faces: row 1 has length 2, but at least 3 corn": lambda: parts_of(POINTS, [[0, 1, 2], [3, 4]]),
    "from [0] to [3], but must go": lambda: parts_of(POINTS, (TRIANGLES.ravel(), np.array([0, 3]))),
    "faces: row 1 has length -3": lambda: parts_of(POINTS, (TRIANGLES.ravel(), np.array([0, 6, 3, 9]))),
    "fields['h']: shape (4,) has 4 rows, but ther": lambda: parts_of(POINTS, fields={"h": HEIGHT[:4]}),
    "signal: shape (6,) has 6 rows, but there are 5 vertices": lambda: values_array(HEIGHT, 5),
    "signal: shape (2, 6) looks transposed; pass signal.T": lambda: values_array(PAIRS.T, 6),
    "where: shape () is neither (6,) nor (6, columns)": lambda: values_array(3.0, 6, "where"),
    "signal: shape (6, 0) has no columns": lambda: values_array(np.ones((6, 0)), 6),
    "signal: row 2 is [inf]; values must be finite": lambda: values_array([0, 1, np.inf, 0, 0, 0], 6),
    "edges: row 1 has node 3, but there are 3 nodes": lambda: graph_parts(3, [[0, 1], [1, 3]]),
    "edges: shape (2, 9), but each row must hold two": lambda: graph_parts(9, np.zeros((2, 9), int)),
    "weights: shape (2,) is not one per edge, (1,)": lambda: graph_parts(3, [[0, 1]], [1, 2]),
    "points: row 2 has 2 entries, but row 0 has 3": lambda: parts_of(([*POINTS[:2], [0, 0]], TRIANGLES)),
    "n_vertices must not be negative, got -1": lambda: graph_parts(-1, []),
    "points: 4 rows, but the faces are": lambda: with_results((POINTS, TRIANGLES), points=POINTS[:4]),
}
TYPE_ERRORS: dict[str, Callable[[], Any]] = {
    "points: dtype complex128 is not a type of real numbers": lambda: parts_of(POINTS * 1j),
    "points: coordinates cannot be bool": lambda: parts_of(POINTS > 0),
    "points: dtype object is not a type of real numbers": lambda: parts_of(POINTS.astype(object)),
    "points: dtype <U1 is not a type of real numbers": lambda: parts_of([["a", "b", "c"]]),
    "faces: dtype object is not a type of real numbers": lambda: parts_of(POINTS, [[2**70, 0, 0]]),
    "is not in CPU memory; call .cpu() on it": lambda: parts_of(WithDlpack(POINTS, 2)),
    "shape: 'bunny.obj' is a path; read it first": lambda: parts_of("bunny.obj"),
    "shape: cannot read an object of type NoneType; pass points, (points, faces)": lambda: parts_of(None),
    "shape: a dictionary with the keys 'a' has no points": lambda: parts_of({"a": POINTS}),
    "faces: indices cannot be bool": lambda: parts_of(POINTS, TRIANGLES > 0),
    "faces: dtype complex128 is not a type of real numbers": lambda: parts_of(POINTS, TRIANGLES * 1j),
    "faces: offsets of dtype float64": lambda: parts_of(POINTS, (TRIANGLES.ravel(), HEIGHT)),
    "has its own; pass its p": lambda: parts_of(SimpleNamespace(vertices=POINTS, faces=QUADS), QUADS),
    "fields['h']: dtype <U1 is not a type of real numbers": lambda: parts_of(POINTS, fields={"h": ["a"] * 6}),
    "like: 'a.ply' is a path; ask for arrays": lambda: with_results("a.ply", points=POINTS),
    "like: results cannot be put into an object of type int; ask for arrays": lambda: with_results(3, points=POINTS),
    "plain arrays have no place for fields (h)": lambda: with_results(POINTS, fields={"h": HEIGHT}),
}


@pytest.mark.parametrize("message", [*VALUE_ERRORS, *TYPE_ERRORS])
def test_refusals_name_what_is_wrong(message: str) -> None:
    kind = ValueError if message in VALUE_ERRORS else TypeError
    call = (VALUE_ERRORS | TYPE_ERRORS)[message]
    with pytest.raises(kind) as caught:
        call()
    assert type(caught.value) is kind
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_paths() -> None:
    assert is_path("a.obj") and is_path(pathlib.Path("a.obj")) and not is_path(POINTS) and not is_path(b"a.obj")


@pytest.mark.parametrize(
    "names",
    [("vertices", "faces"), ("vertices", "cells"), ("points", "faces"), ("verts", "faces"), ("v", "t")],
)
def test_objects_of_unknown_libraries(names: tuple[str, str]) -> None:
    assert_mesh(parts_of(SimpleNamespace(**{names[0]: POINTS, names[1]: MIXED})), faces=MIXED)


def test_methods_and_points_of_unknown_libraries() -> None:
    pymeshlab_like = SimpleNamespace(vertex_matrix=lambda: POINTS, face_matrix=lambda: TRIANGLES)
    assert_mesh(parts_of(pymeshlab_like))
    assert parts_of(SimpleNamespace(points=POINTS)).kind == "cloud"
    assert_mesh(parts_of(SimpleNamespace(points=POINTS), TRIANGLES))


def test_arrays_out() -> None:
    points, faces = with_results((POINTS.tolist(), MIXED), points=MOVED)
    np.testing.assert_array_equal(points, MOVED)
    assert faces is MIXED and not np.shares_memory(points, MOVED)
    new = with_results((POINTS, TRIANGLES), points=MOVED[:4], faces=TRIANGLES[:2])
    np.testing.assert_array_equal(new[1], TRIANGLES[:2])
    np.testing.assert_array_equal(with_results(POINTS, points=MOVED), MOVED)
    assert with_results(POINTS[:, :2], points=POINTS * [1, 1, 0]).shape == (6, 2)
    assert with_results(POINTS[:, :2], points=MOVED).shape == (6, 3)


# Other libraries: each case makes an object of TRIANGLES over POINTS with the fields height and pairs


def trimesh_mesh() -> Any:
    attributes = {"height": HEIGHT, "pairs": PAIRS}
    mesh = library("trimesh").Trimesh(POINTS, TRIANGLES, process=False, vertex_attributes=attributes)
    mesh.face_attributes["area"] = np.arange(3.0)
    return mesh


def pyvista_mesh() -> Any:
    mesh = library("pyvista").PolyData(POINTS, np.insert(TRIANGLES, 0, 3, axis=1).ravel())
    mesh.point_data["height"], mesh.point_data["pairs"] = HEIGHT, PAIRS
    mesh.cell_data["area"] = np.arange(3.0)
    return mesh


def pyvista_grid() -> Any:
    return pyvista_mesh().cast_to_unstructured_grid()


def meshio_mesh() -> Any:
    cells = [("vertex", [[5]]), ("triangle", TRIANGLES[:2]), ("line", [[0, 5]]), ("triangle", TRIANGLES[2:])]
    area = [np.full(1, 9.0), np.arange(2.0), np.full(1, 9.0), np.full(1, 2.0)]
    return library("meshio").Mesh(POINTS, cells, {"height": HEIGHT, "pairs": PAIRS}, {"area": area})


def open3d_mesh() -> Any:
    o3d = library("open3d")
    mesh = o3d.t.geometry.TriangleMesh(o3d.core.Tensor(POINTS), o3d.core.Tensor(TRIANGLES))
    mesh.vertex["height"], mesh.vertex["pairs"] = o3d.core.Tensor(HEIGHT), o3d.core.Tensor(PAIRS)
    mesh.triangle["area"] = o3d.core.Tensor(np.arange(3.0))
    return mesh


MESHES = [trimesh_mesh, pyvista_mesh, pyvista_grid, meshio_mesh, open3d_mesh]


@pytest.mark.parametrize("make", MESHES)
def test_meshes_of_libraries_there_and_back(make: Callable[[], Any]) -> None:
    mesh = make()
    parts = parts_of(mesh)
    assert_mesh(parts)
    assert parts.source == make.__name__.partition("_")[0]
    np.testing.assert_array_equal(parts.fields["height"], HEIGHT)
    np.testing.assert_array_equal(parts.fields["pairs"], PAIRS)
    assert parts.fields["pairs"].dtype == np.float32
    np.testing.assert_array_equal(parts.face_fields["area"], [0, 1, 2])

    new = with_results(mesh, points=MOVED, fields={"height": -HEIGHT}, face_fields={"order": np.arange(3)})
    assert type(new) is type(mesh)
    after = parts_of(new)
    assert_mesh(after, points=MOVED)
    np.testing.assert_array_equal(after.fields["height"], -HEIGHT)
    np.testing.assert_array_equal(after.fields["pairs"], PAIRS)
    np.testing.assert_array_equal(after.face_fields["area"], [0, 1, 2])
    np.testing.assert_array_equal(after.face_fields["order"], [0, 1, 2])
    assert_mesh(parts_of(mesh))
    np.testing.assert_array_equal(parts_of(mesh).fields["height"], HEIGHT)
    assert "order" not in parts_of(mesh).face_fields

    smaller = with_results(mesh, points=MOVED[:4], faces=TRIANGLES[:2], fields={"new": HEIGHT[:4]})
    assert type(smaller) is type(mesh)
    assert_mesh(parts_of(smaller), points=MOVED[:4], faces=TRIANGLES[:2])
    assert set(parts_of(smaller).fields) == {"new"}
    with pytest.raises(ValueError, match="points: 4 rows, but the shape has 6 vertices; pass faces too"):
        with_results(mesh, points=MOVED[:4])
    with pytest.raises(ValueError, match=r"fields\['h'\]: 4 rows, but there are 6 vertices"):
        with_results(mesh, fields={"h": HEIGHT[:4]})
    with pytest.raises(ValueError, match=r"face_fields\['h'\]: 6 rows, but there are 3 faces"):
        with_results(mesh, face_fields={"h": HEIGHT})
    with pytest.raises(TypeError, match="has its own; pass its points alone"):
        parts_of(mesh, TRIANGLES)


def test_trimesh_clouds_colors_scenes_and_primitives() -> None:
    trimesh = library("trimesh")
    colors = np.arange(24, dtype=np.uint8).reshape(6, 4)
    mesh = trimesh.Trimesh(POINTS, TRIANGLES, process=False, vertex_colors=colors)
    np.testing.assert_array_equal(parts_of(mesh).fields["color"], colors)
    new = with_results(mesh, points=MOVED, fields={"color": colors[::-1]})
    np.testing.assert_array_equal(new.visual.vertex_colors, colors[::-1])
    np.testing.assert_array_equal(mesh.visual.vertex_colors, colors)

    cloud = trimesh.PointCloud(POINTS, colors=colors)
    assert parts_of(cloud).kind == "cloud"
    np.testing.assert_array_equal(parts_of(with_results(cloud, points=MOVED)).points, MOVED)
    assert len(with_results(cloud, points=MOVED[:2]).vertices) == 2
    with pytest.raises(ValueError, match="a trimesh PointCloud has no place for height but color; ask for arrays"):
        with_results(cloud, fields={"height": HEIGHT})

    turn = np.array([[0, -2.0, 0, 1], [2, 0, 0, 2], [0, 0, 2, 3], [0, 0, 0, 1]])
    scene = trimesh.Scene()
    scene.add_geometry(mesh, transform=turn)
    placed = POINTS @ turn[:3, :3].T + turn[:3, 3]
    assert_mesh(parts_of(scene), points=placed)
    moved = with_results(scene, points=placed + 1)
    assert np.allclose(points_array(parts_of(moved).points), placed + 1, rtol=0, atol=1e-14)
    scene.add_geometry(mesh)
    with pytest.raises(TypeError, match="the scene has 2 geometries; pass one of scene"):
        parts_of(scene)

    box = trimesh.primitives.Box()
    np.testing.assert_array_equal(parts_of(with_results(box, points=box.vertices * 3)).points, box.vertices * 3)


def test_pyvista_lines_mixed_cells_and_refusals() -> None:
    pv = library("pyvista")
    mixed = pv.PolyData(POINTS, faces=[4, 0, 1, 2, 3, 3, 1, 4, 2], lines=[2, 0, 5], verts=[1, 5])
    mixed.cell_data["id"] = np.arange(4)
    parts = parts_of(mixed)
    assert_mesh(parts, faces=MIXED)
    np.testing.assert_array_equal(parts.face_fields["id"], [2, 3])
    new = with_results(mixed, face_fields={"area": np.array([7.0, 8.0])})
    np.testing.assert_array_equal(new.cell_data["area"], [np.nan, np.nan, 7, 8])
    lines = parts_of(pv.PolyData(POINTS, lines=[3, 0, 1, 2, 2, 4, 5]))
    assert (lines.kind, lines.is_symmetric_list) == ("graph", True)
    assert (lines.rows.tolist(), lines.cols.tolist()) == ([0, 1, 4], [1, 2, 5])
    assert parts_of(pv.PolyData(POINTS)).kind == parts_of(pv.PointSet(POINTS)).kind == "cloud"
    ball = pv.Sphere()
    assert ball.points.dtype == np.float32 and "Normals" in parts_of(ball).fields
    bigger = with_results(ball, points=np.asarray(ball.points, float) * 2)
    assert bigger.points.dtype == np.float32 and "Normals" not in bigger.point_data
    assert "Normals" in ball.point_data
    for refused, advice in [
        (ball.strip(), "triangle strips: call .triangulate"),
        (pv.MultiBlock([ball]), "pass one of its blocks"),
    ]:
        with pytest.raises(TypeError, match=advice):
            parts_of(refused)
    vtk = library("vtkmodules.vtkCommonDataModel")
    with pytest.raises(TypeError, match=r"pass pyvista\.wrap of it"):
        parts_of(vtk.vtkPolyData())


def test_meshio_polygons_lines_and_volumes() -> None:
    meshio = library("meshio")
    cells = [("quad", QUADS[:1]), ("triangle", TRIANGLES[2:]), ("polygon", [[0, 1, 4, 2, 3]])]
    assert_mesh(parts_of(meshio.Mesh(POINTS, cells)), faces=[*MIXED, [0, 1, 4, 2, 3]])
    lines = parts_of(meshio.Mesh(POINTS, [("line", [[0, 1], [1, 5]])]))
    assert (lines.kind, lines.rows.tolist(), lines.cols.tolist()) == ("graph", [0, 1], [1, 5])
    assert parts_of(meshio.Mesh(POINTS, [("vertex", [[0]])])).kind == "cloud"
    with pytest.raises(TypeError, match=r"cells of type 'tetra' are no flat polygons: pass pyvista\.from_meshio"):
        parts_of(meshio.Mesh(POINTS, [("tetra", [[0, 1, 2, 4]]), ("triangle", TRIANGLES)]))
    flat = with_results(meshio.Mesh(POINTS[:, :2], [("triangle", TRIANGLES)]), points=POINTS * [2, 2, 0])
    np.testing.assert_array_equal(flat.points, POINTS[:, :2] * 2)


def test_open3d_older_geometries() -> None:
    o3d = library("open3d")
    vectors = o3d.utility.Vector3dVector
    mesh = o3d.geometry.TriangleMesh(vectors(POINTS), o3d.utility.Vector3iVector(TRIANGLES))
    mesh.vertex_colors = vectors(POINTS / 5)
    mesh.compute_vertex_normals()
    parts = parts_of(mesh)
    assert_mesh(parts)
    assert set(parts.fields) == {"color", "normal"} and set(parts.face_fields) == {"normal"}
    new = with_results(mesh, points=MOVED)
    assert_mesh(parts_of(new), points=MOVED)
    assert set(parts_of(new).fields) == {"color"} and not new.has_triangle_normals()
    assert mesh.has_vertex_normals() and np.array_equal(np.asarray(mesh.vertices), POINTS)
    bytes_ = np.full((6, 4), 51, np.uint8)
    colored = with_results(mesh, points=MOVED[:4], faces=TRIANGLES[:2], fields={"color": bytes_[:4]})
    np.testing.assert_allclose(np.asarray(colored.vertex_colors), np.full((4, 3), 0.2))
    with pytest.raises(ValueError, match="no place for height, pairs but color and normal; ask for arrays"):
        with_results(mesh, fields={"pairs": PAIRS, "height": HEIGHT})
    with pytest.raises(ValueError, match=r"fields\['color'\]: shape \(6,\), but Open3D wants \(n, 3\)"):
        with_results(mesh, fields={"color": HEIGHT})

    cloud = o3d.geometry.PointCloud(vectors(POINTS))
    assert parts_of(cloud).kind == "cloud" and not parts_of(cloud).fields
    np.testing.assert_array_equal(np.asarray(with_results(cloud, points=MOVED[:2]).points), MOVED[:2])
    lines = parts_of(o3d.geometry.LineSet(vectors(POINTS), o3d.utility.Vector2iVector([[0, 1], [4, 5]])))
    assert (lines.kind, lines.cols.tolist()) == ("graph", [1, 5])
    assert_mesh(parts_of(vectors(POINTS), TRIANGLES))
    assert_mesh(parts_of(o3d.core.Tensor(POINTS), o3d.core.Tensor(TRIANGLES)))
    with pytest.raises(TypeError, match="pass a TriangleMesh, a PointCloud or a LineSet"):
        parts_of(o3d.geometry.VoxelGrid())

    tensors = o3d.t.geometry.TriangleMesh.from_legacy(mesh)
    assert set(parts_of(tensors).fields) == {"color", "normal"}
    moved = with_results(tensors, points=MOVED, fields={"half": HEIGHT.astype(np.float16)})
    assert moved.vertex["positions"].numpy().dtype == np.float32 and "normals" not in moved.vertex
    assert "normals" in tensors.vertex and moved.vertex["half"].numpy().dtype == np.float32
    tensor_cloud = o3d.t.geometry.PointCloud(o3d.core.Tensor(POINTS))
    np.testing.assert_array_equal(parts_of(with_results(tensor_cloud, fields={"h": HEIGHT})).fields["h"], HEIGHT)


def test_networkx() -> None:
    nx = library("networkx")
    graph = nx.Graph()
    for i, node in enumerate("dacb"):
        graph.add_node(node, height=float(i), label=node, at=(i, 0))
    graph.add_edge("c", "d", weight=2.0)
    graph.add_edge("a", "b")
    parts = parts_of(graph)
    assert (parts.kind, parts.n_vertices, parts.points, parts.is_symmetric_list) == ("graph", 4, None, True)
    assert parts.weights is not None
    ends = np.sort(np.stack([parts.rows, parts.cols]), axis=0).T.tolist()
    assert sorted(zip(ends, parts.weights.tolist(), strict=True)) == [([0, 2], 2.0), ([1, 3], 1.0)]
    assert set(parts.fields) == {"height", "at"}
    new = with_results(graph, fields={"height": np.arange(4) * 2, "pair": PAIRS[:4]})
    assert new.nodes["c"] == {"height": 4, "label": "c", "at": (2, 0), "pair": [4.0, 5.0]}
    assert graph.nodes["c"]["height"] == 2.0 and list(new) == list("dacb")
    directed = parts_of(nx.DiGraph([(0, 1), (1, 0), (1, 2)]))
    assert (directed.is_symmetric_list, directed.weights, directed.rows.tolist()) == (False, None, [0, 1, 1])
    with pytest.raises(TypeError, match="weights: dtype <U"):
        parts_of(nx.Graph([(0, 1, {"weight": "far"})]))
    with pytest.raises(TypeError, match="a networkx graph holds values per node only"):
        with_results(graph, points=POINTS[:4])


def test_scipy_sparse() -> None:
    sparse = library("scipy.sparse")
    dense = np.array([[0, 2, 0], [2, 0, 3], [0, 3, 0]])
    formats = [m.asformat(f) for m in (sparse.csr_matrix(dense), sparse.csr_array(dense)) for f in FORMATS]
    for matrix in [*formats, sparse.csr_array(dense.astype(np.float32)), sparse.csr_array(dense > 0)]:
        parts = parts_of(matrix)
        assert (parts.kind, parts.n_vertices, parts.is_symmetric_list) == ("graph", 3, False)
        assert parts.weights is not None and parts.weights.dtype == np.float64
        back = np.zeros((3, 3))
        np.add.at(back, (parts.rows, parts.cols), parts.weights)
        np.testing.assert_array_equal(back, matrix.toarray())
    with pytest.raises(ValueError, match=r"has shape \(2, 3\), but must be square"):
        parts_of(sparse.csr_array(dense[:2]))
    with pytest.raises(TypeError, match="weights: dtype complex128 is not a type of real numbers"):
        parts_of(sparse.csr_array(dense * 1j))
    with pytest.raises(TypeError, match="a sparse matrix has no place for points or values per node; ask for arr"):
        with_results(sparse.csr_array(dense), fields={"h": HEIGHT[:3]})


FORMATS = ("csr", "csc", "coo", "lil", "dok", "bsr", "dia")


def test_pandas() -> None:
    pd = library("pandas")
    frame = pd.DataFrame({"h": HEIGHT, "z": POINTS[:, 2], "x": POINTS[:, 0], "name": list("abcdef"), "y": POINTS[:, 1]})
    parts = parts_of(frame)
    np.testing.assert_array_equal(parts.points, POINTS)
    assert set(parts.fields) == {"h"}
    assert_mesh(parts_of(frame, pd.DataFrame(TRIANGLES)))
    assert_mesh(parts_of((pd.DataFrame(POINTS), TRIANGLES)))
    np.testing.assert_array_equal(values_array(pd.Series(HEIGHT), 6)[:, 0], HEIGHT)
    assert np.isnan(values_array(pd.Series([1, None, 2], dtype="Int64"), 3)[1, 0])
    new = with_results(frame, points=MOVED, fields={"h": -HEIGHT, "pairs": PAIRS})
    np.testing.assert_array_equal(parts_of(new).points, MOVED)
    assert list(new.columns) == ["h", "z", "x", "name", "y", "pairs_0", "pairs_1"]
    assert frame["x"].tolist() == POINTS[:, 0].tolist()
    with pytest.raises(TypeError, match=r"points: an object of type pandas.+ cannot be read as an array of numbers"):
        parts_of(frame[["name"]])
    with pytest.raises(ValueError, match="the data frame has 6 rows, not one per point"):
        with_results(frame, points=MOVED[:2])
