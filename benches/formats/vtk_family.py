"""VTK's formats against VTK itself and meshio: what they write is read the same, and what is written they read the same.

    python benches/formats/vtk_family.py target/release/adwave
"""

import sys
import tempfile
from pathlib import Path

import meshio
import numpy as np
import pyvista as pv
import vtk
from common import Adwave, Report, Shape, same_places, same_points, same_values, sphere, unordered

TYPES = ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"]


def values(n, kind, seed=1):
    """Numbers of a type that all readers hold in 64-bit floats."""
    numbers = np.random.default_rng(seed).normal(size=n) * 40
    return numbers.astype(kind) if kind.startswith("float") else np.abs(numbers).astype(kind)


def polydata(shape):
    """A surface of VTK with values of all types."""
    flat = np.concatenate([[len(face), *face] for face in shape.faces])
    mesh = pv.PolyData(shape.points, faces=flat)
    for k, kind in enumerate(TYPES):
        mesh.point_data[f"of {kind}"] = values(mesh.n_points, kind, k)
    mesh.point_data["heat"] = values(mesh.n_points, "float64", 77)
    mesh.point_data["flow"] = values(3 * mesh.n_points, "float32", 78).reshape(-1, 3)
    mesh.cell_data["part"] = values(mesh.n_cells, "int32", 79)
    return mesh


def shape_of(mesh):
    """A shape from a surface of VTK."""
    mesh = mesh if isinstance(mesh, pv.PolyData) else mesh.extract_surface(algorithm=None)
    faces = [[int(v) for v in cell.point_ids] for cell in mesh.cell if cell.dimension == 2]
    return Shape(np.asarray(mesh.points, float), faces, dict(mesh.point_data), dict(mesh.cell_data))


def write(mesh, path, storage):
    """Writes by VTK with one of its ways to store arrays."""
    kinds = {
        ".vtp": vtk.vtkXMLPolyDataWriter,
        ".vtu": vtk.vtkXMLUnstructuredGridWriter,
        ".vti": vtk.vtkXMLImageDataWriter,
        ".vtr": vtk.vtkXMLRectilinearGridWriter,
        ".vts": vtk.vtkXMLStructuredGridWriter,
        ".vtk": vtk.vtkDataSetWriter,
    }
    writer = kinds[path.suffix]()
    writer.SetInputData(mesh)
    writer.SetFileName(str(path))
    if path.suffix == ".vtk":
        writer.SetFileTypeToBinary() if storage["binary"] else writer.SetFileTypeToASCII()
        writer.SetFileVersion(storage["version"])
    else:
        writer.SetDataMode({"ascii": 0, "binary": 1, "appended": 2}[storage["mode"]])
        writer.SetEncodeAppendedData(storage.get("base64", False))
        writer.SetCompressorTypeToZLib() if storage.get("zlib") else writer.SetCompressorTypeToNone()
        writer.SetHeaderTypeToUInt64() if storage.get("wide") else writer.SetHeaderTypeToUInt32()
        writer.SetByteOrder(0 if storage.get("big") else 1)
    writer.Write()


XML = [
    {"mode": "ascii"},
    {"mode": "binary"},
    {"mode": "binary", "zlib": True, "wide": True},
    {"mode": "binary", "big": True},
    {"mode": "appended"},
    {"mode": "appended", "zlib": True},
    {"mode": "appended", "base64": True},
    {"mode": "appended", "base64": True, "zlib": True, "wide": True},
    {"mode": "appended", "big": True, "wide": True},
]
LEGACY = [{"binary": b, "version": v} for b in (False, True) for v in (42, 51)]


def solids():
    """An unstructured grid of cells of many types."""
    box = pv.ImageData(dimensions=(4, 3, 3)).cast_to_unstructured_grid()
    cells = [
        (box, "voxels"),
        (pv.examples.cells.Hexahedron(), "hexahedron"),
        (pv.examples.cells.Tetrahedron(), "tetrahedron"),
        (pv.examples.cells.Wedge(), "wedge"),
        (pv.examples.cells.Pyramid(), "pyramid"),
        (pv.examples.cells.PentagonalPrism(), "pentagonal prism"),
        (pv.examples.cells.HexagonalPrism(), "hexagonal prism"),
        (pv.examples.cells.Polyhedron(), "polyhedron"),
        (pv.examples.cells.TriangleStrip(), "strip"),
        (pv.examples.cells.Polygon(), "polygon"),
        (pv.examples.cells.Pixel(), "pixel"),
        (pv.UnstructuredGrid(pv.StructuredGrid(*np.meshgrid(*[np.arange(4.0)] * 3)).triangulate()), "tetrahedra"),
    ]
    return cells


def grids():
    """Grids of all kinds."""
    image = pv.ImageData(dimensions=(4, 5, 3), spacing=(0.1, 0.3, 0.7), origin=(1, 2, 3))
    flat = pv.ImageData(dimensions=(6, 5, 1), spacing=(0.1, 0.3, 0.7))
    axes = pv.RectilinearGrid(np.array([0.0, 0.1, 0.5]), np.array([0.0, 2.0, 2.5, 7.0]), np.array([1.0, 1.7, 9.0]))
    x, y, z = np.meshgrid(np.arange(4.0), np.arange(3.0), np.arange(5.0), indexing="ij")
    bent = pv.StructuredGrid(x + 0.1 * y * y, y, z + 0.3 * np.sin(x))
    for grid in (image, flat, axes, bent):
        grid.point_data["heat"] = values(grid.n_points, "float64", 5)
        grid.cell_data["part"] = values(grid.n_cells, "int32", 6)
    return [(image, ".vti"), (flat, ".vti"), (axes, ".vtr"), (bent, ".vts")]


def by_place(shape, name):
    """The values of a field by the places of their points."""
    return {tuple(p): float(x) for p, x in zip(np.asarray(shape.points, float), shape.fields[name])}


def column(fields, name):
    """A field of a PLY, whose names are single words and whose vectors are columns."""
    name = name.replace(" ", "_")
    if name in fields:
        return fields[name]
    return np.stack([fields[f"{name}_{c}"] for c in "xyz"], axis=1)


def main():
    adwave, report = Adwave(sys.argv[1]), Report()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        surface = polydata(sphere())
        expected = shape_of(surface)
        for suffix, mesh in ((".vtp", surface), (".vtu", pv.UnstructuredGrid(surface.cast_to_unstructured_grid())), (".vtk", surface)):
            for storage in LEGACY if suffix == ".vtk" else XML:
                def run(mesh=mesh, suffix=suffix, storage=storage):
                    path = folder / f"a{suffix}"
                    write(mesh, path, storage)
                    read = adwave.mask(path, folder)
                    again = pv.read(path)
                    truth = shape_of(again) if suffix != ".vtu" else Shape(np.asarray(again.points, float), expected.faces, dict(again.point_data))
                    return {
                        "points": same_points(read, truth),
                        "faces": unordered(read) == unordered(Shape(truth.points, expected.faces)),
                        "fields": all(same_values(column(read.fields, name), x) for name, x in truth.fields.items()),
                    }
                words = " ".join(k if v is True else str(v) for k, v in storage.items() if v)
                report.check(f"VTK {suffix} {words}", run)
        for mesh, name in solids():
            def run(mesh=mesh):
                path = folder / "cells.vtu"
                write(mesh, path, {"mode": "appended", "zlib": True})
                read, truth = adwave.mask(path, folder), shape_of(mesh.extract_surface(algorithm="dataset_surface"))
                return {"faces": unordered(read) == unordered(truth)}
            report.check(f"VTK .vtu {name}", run)
        for grid, suffix in grids():
            for path, storage in ((folder / f"g{suffix}", {"mode": "appended", "zlib": True}), (folder / "g.vtk", LEGACY[1]), (folder / "g.vtk", LEGACY[3])):
                def run(grid=grid, path=path, storage=storage):
                    write(grid, path, storage)
                    again = pv.read(path)
                    read = adwave.mask(path, folder)
                    truth = shape_of(again.extract_surface(algorithm="dataset_surface").clean())
                    return {
                        "places": same_places(read, truth),
                        "faces": unordered(read) == unordered(truth),
                        "fields": by_place(read, "heat") == by_place(truth, "heat"),
                    }
                report.check(f"VTK {type(grid).__name__} {path.suffix} {'binary' if storage.get('binary') else ''}", run)
        source = folder / "source.vtp"
        write(surface, source, {"mode": "appended", "zlib": True})
        # meshio reads no PolyData.
        for suffix, readers in ((".vtp", ["VTK"]), (".vtu", ["VTK", "meshio"]), (".vtk", ["VTK"])):
            target = adwave.refield(source, folder / f"out{suffix}", "heat")
            for reader in readers:
                def run(target=target, reader=reader):
                    if reader == "meshio":
                        mesh = meshio.read(target)
                        faces = [list(map(int, row)) for block in mesh.cells for row in block.data]
                        read = Shape(np.asarray(mesh.points, float), faces, mesh.point_data)
                        parts = np.concatenate([np.asarray(x) for x in mesh.cell_data["part"]])
                    else:
                        mesh = pv.read(target)
                        cells = [[int(v) for v in cell.point_ids] for cell in mesh.cell]
                        read = Shape(np.asarray(mesh.points, float), cells, dict(mesh.point_data))
                        parts = mesh.cell_data["part"]
                    names = [name for name in expected.fields if name != "heat"]
                    return {
                        "points": same_points(read, expected),
                        "faces": unordered(read) == unordered(expected),
                        "fields": all(same_values(read.fields[name], expected.fields[name]) for name in names),
                        "types": all(np.asarray(read.fields[f"of {kind}"]).dtype == kind for kind in TYPES),
                        "values of faces": sorted(np.asarray(parts)) == sorted(surface.cell_data["part"]),
                    }
                report.check(f"adwave {suffix} read by {reader}", run)
    report.end()


if __name__ == "__main__":
    main()
