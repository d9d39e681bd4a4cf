"""Speed of reading and writing files, compared with VTK, trimesh, meshio, Open3D, PyMeshLab, laspy and NiBabel in the same run.

    python -m pip install vtk trimesh meshio open3d pymeshlab "laspy[lazrs]" nibabel lxml networkx scipy numpy    # and adwave
    python benches/formats/speed.py bunny.obj --cut 2 --command target/release/adwave
    python benches/formats/speed.py bunny.obj --cut 2 --only ply,stl,glb

The shape is cut finer (each triangle in four, `--cut` times; the Stanford bunny gives 556 051 vertices) and written once in each
format, by the program that is named in the table. The programs read it in turns from the system's copy in memory, with a pause
between two, since threads of some go on spinning for a while; shown is the median, and how many bytes of the file are read in a
second. Writing is measured where a peer writes the format too. A program that needs more than `--patience` seconds is asked once
(marked `¹`); one that has another number of vertices or faces is named below the tables, as is one that fails.

Not all do the same work: meshio gives the numbers in the type that the file has, NiBabel the triangles in its byte order too; adwave
gives 64-bit points, checks that each corner is a vertex, and keeps what the file had for writing it again. Programs merge equal
corners of STL or not, as they do unless told otherwise; VTK's reader is told not to, as adwave does not.
"""

import argparse
import contextlib
import gc
import gzip
import io
import os
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import laspy
import meshio
import nibabel
import numpy as np
import open3d
import pymeshlab
import trimesh
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

import adwave

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "peers"))
from shapes import read_obj, subdivided

MEGABYTE = 1e6
# Between two calls, in seconds: threads of some pools spin for a while before they sleep, and take the cores of who comes next.
PAUSE = 0.25
# Bytes that are touched and freed before each call, more than any of them takes: a virtual machine gives memory that is free for some seconds
# back to its host, and the first who touches it again waits several times as long as for memory that is there.
TOUCHED = 640_000_000
open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)
vtk.vtkObject.GlobalWarningDisplayOff()


# What each library needs to hold the shape


@dataclass
class Source:
    """The shape as each program has it."""

    points: np.ndarray
    faces: np.ndarray

    def __post_init__(self):
        self.ours = adwave.Shape(self.points, self.faces)
        self.cloud = adwave.Shape(self.points)
        self.trimesh = trimesh.Trimesh(self.points, self.faces, process=False)
        self.meshio = meshio.Mesh(self.points, [("triangle", self.faces.astype(np.int32))])
        self.open3d = open3d.geometry.TriangleMesh(
            open3d.utility.Vector3dVector(self.points), open3d.utility.Vector3iVector(self.faces.astype(np.int32))
        )
        self.open3d_cloud = open3d.geometry.PointCloud(self.open3d.vertices)
        self.meshlab = pymeshlab.MeshSet()
        self.meshlab.add_mesh(pymeshlab.Mesh(self.points, self.faces.astype(np.int32)))
        self.poly = vtk.vtkPolyData()
        places = vtk.vtkPoints()
        places.SetData(numpy_to_vtk(self.points, deep=True))
        self.poly.SetPoints(places)
        self.poly.SetPolys(vtk_cells(self.faces))
        self.grid = vtk.vtkUnstructuredGrid()
        self.grid.SetPoints(places)
        self.grid.SetCells(vtk.VTK_TRIANGLE, vtk_cells(self.faces))


def vtk_cells(faces):
    cells = vtk.vtkCellArray()
    offsets = np.arange(0, faces.size + 1, 3, dtype=np.int64)
    cells.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True), numpy_to_vtkIdTypeArray(faces.astype(np.int64).ravel(), deep=True))
    return cells


# Readers: a path in, an object of the library out; `counted` looks at it


def by_vtk(reader, *settings):
    def read(path):
        made = getattr(vtk, reader)()
        made.SetFileName(str(path))
        for name, *values in settings:
            getattr(made, name)(*values)
        made.Update()
        return made.GetOutput()

    return read


def by_trimesh(path):
    with open(path, "rb") as file:
        return trimesh.load(file, file_type=path.suffix[1:], process=False, maintain_order=True)


def by_trimesh_gzip(path):
    with gzip.open(path, "rb") as file:
        return trimesh.load(io.BytesIO(file.read()), file_type=Path(path.stem).suffix[1:], process=False)


def by_meshio(name):
    return lambda path: meshio.read(path, file_format=name)


def by_open3d(path):
    return open3d.io.read_triangle_mesh(str(path))


def cloud_by_open3d(path):
    return open3d.io.read_point_cloud(str(path))


def by_meshlab(path):
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(path))
    return meshes


def by_laspy(path):
    return np.asarray(laspy.read(path).xyz)


def by_nibabel(path):
    return nibabel.freesurfer.read_geometry(path)


def by_numpy_text(path):
    return np.loadtxt(path)


def counted(read):
    """Numbers of vertices and faces."""
    if isinstance(read, adwave.Shape):
        return read.n_vertices, read.n_faces
    if isinstance(read, vtk.vtkMultiBlockDataSet):
        parts, it = [], read.NewIterator()
        while not it.IsDoneWithTraversal():
            parts.append(counted(it.GetCurrentDataObject()))
            it.GoToNextItem()
        return tuple(map(sum, zip(*parts)))
    if isinstance(read, vtk.vtkDataSet):
        return read.GetNumberOfPoints(), read.GetNumberOfCells()
    if isinstance(read, trimesh.Scene):
        return tuple(map(sum, zip(*map(counted, read.geometry.values()))))
    if isinstance(read, trimesh.PointCloud):
        return len(read.vertices), 0
    if isinstance(read, trimesh.Trimesh):
        return len(read.vertices), len(read.faces)
    if isinstance(read, meshio.Mesh):
        return len(read.points), sum(len(block.data) for block in read.cells if block.type == "triangle")
    if isinstance(read, open3d.geometry.TriangleMesh):
        return len(read.vertices), len(read.triangles)
    if isinstance(read, open3d.geometry.PointCloud):
        return len(read.points), 0
    if isinstance(read, pymeshlab.MeshSet):
        meshes = [read.mesh(k) for k in range(read.mesh_number())]
        return sum(m.vertex_number() for m in meshes), sum(m.face_number() for m in meshes)
    if isinstance(read, tuple):
        return len(read[0]), len(read[1])
    return len(read), 0


# Writers: a source and a path in


def ours(name, cloud=False):
    return lambda s, path: (s.cloud if cloud else s.ours).write(path, format=name)


def vtk_writes(writer, *settings, grid=False):
    def write(s, path):
        made = getattr(vtk, writer)()
        made.SetInputData(s.grid if grid else s.poly)
        made.SetFileName(str(path))
        for name, *values in settings:
            getattr(made, name)(*values)
        if not made.Write():
            raise RuntimeError("not written")

    return write


def trimesh_writes(**options):
    return lambda s, path: s.trimesh.export(path, **options)


def meshio_writes(name, **options):
    return lambda s, path: meshio.write(path, s.meshio, file_format=name, **options)


def open3d_writes(**options):
    def write(s, path):
        if not open3d.io.write_triangle_mesh(str(path), s.open3d, write_vertex_normals=False, **options):
            raise RuntimeError("not written")

    return write


def open3d_writes_cloud(**options):
    def write(s, path):
        if not open3d.io.write_point_cloud(str(path), s.open3d_cloud, **options):
            raise RuntimeError("not written")

    return write


def meshlab_writes(**options):
    return lambda s, path: s.meshlab.save_current_mesh(str(path), **options)


def laspy_writes(s, path):
    header = laspy.LasHeader(point_format=6, version="1.4")
    header.scales, header.offsets = [1e-7] * 3, s.points.mean(axis=0)
    las = laspy.LasData(header)
    las.xyz = s.points
    las.write(path)


def nibabel_writes(s, path):
    nibabel.freesurfer.write_geometry(path, s.points, s.faces)


def gzip_writes(s, path):
    with gzip.open(path, "wb", compresslevel=6) as file:
        file.write(s.trimesh.export(file_type="ply", vertex_normal=False))


@dataclass
class Kind:
    """A format: who wrote the file that all read, and who reads and writes it."""

    key: str
    title: str
    ending: str
    written_by: str
    readers: dict
    writers: dict = field(default_factory=dict)
    has_faces: bool = True
    is_text: bool = False


RAW = [("SetDataModeToAppended",), ("EncodeAppendedDataOff",), ("SetCompressorTypeToNone",)]
ZLIB = [("SetDataModeToAppended",), ("EncodeAppendedDataOff",), ("SetCompressorTypeToZLib",)]
TEXT = [("SetDataModeToAscii",)]


def kinds():
    """All formats; the writer named in `written_by` is called for the file, the others are only timed."""
    ply = {"VTK": by_vtk("vtkPLYReader"), "trimesh": by_trimesh, "meshio": by_meshio("ply"), "Open3D": by_open3d, "PyMeshLab": by_meshlab}
    stl = {
        "VTK": by_vtk("vtkSTLReader", ("MergingOff",)),
        "trimesh": by_trimesh,
        "meshio": by_meshio("stl"),
        "Open3D": by_open3d,
        "PyMeshLab": by_meshlab,
    }
    off = {"VTK": by_vtk("vtkOFFReader"), "trimesh": by_trimesh, "meshio": by_meshio("off"), "Open3D": by_open3d, "PyMeshLab": by_meshlab}
    obj = {"VTK": by_vtk("vtkOBJReader"), "trimesh": by_trimesh, "meshio": by_meshio("obj"), "Open3D": by_open3d, "PyMeshLab": by_meshlab}
    vtp, vtu = {"VTK": by_vtk("vtkXMLPolyDataReader")}, {"VTK": by_vtk("vtkXMLUnstructuredGridReader"), "meshio": by_meshio("vtu")}
    legacy = {"VTK": by_vtk("vtkPolyDataReader")}
    legacy_grid = {"VTK": by_vtk("vtkUnstructuredGridReader"), "meshio": by_meshio("vtk")}
    pcd = {"Open3D": cloud_by_open3d}
    return [
        Kind("ply", "PLY binary, 32-bit floats", ".ply", "trimesh", ply, {
            "trimesh": trimesh_writes(encoding="binary", vertex_normal=False), "VTK": vtk_writes("vtkPLYWriter", ("SetFileTypeToBinary",))}),
        Kind("ply64", "PLY binary, 64-bit floats", ".ply", "adwave", ply, {
            "adwave": ours("ply"), "meshio": meshio_writes("ply"), "Open3D": open3d_writes(), "PyMeshLab": meshlab_writes(binary=True)}),
        Kind("stl", "STL binary", ".stl", "adwave", stl, {
            "adwave": ours("stl"), "VTK": vtk_writes("vtkSTLWriter", ("SetFileTypeToBinary",)), "trimesh": trimesh_writes(),
            "meshio": meshio_writes("stl", binary=True), "PyMeshLab": meshlab_writes(binary=True)}),
        Kind("glb", "GLB", ".glb", "trimesh", {
            "VTK": by_vtk("vtkGLTFReader"), "trimesh": by_trimesh, "Open3D": by_open3d, "PyMeshLab": by_meshlab},
            {"trimesh": trimesh_writes(), "adwave": ours("glb"), "Open3D": open3d_writes()}),
        Kind("vtp", "VTP appended, raw", ".vtp", "VTK", vtp, {"VTK": vtk_writes("vtkXMLPolyDataWriter", *RAW)}),
        Kind("vtp-zlib", "VTP appended, zlib", ".vtp", "VTK", vtp, {
            "VTK": vtk_writes("vtkXMLPolyDataWriter", *ZLIB), "adwave": ours("vtp")}),
        Kind("vtu", "VTU appended, raw", ".vtu", "VTK", vtu, {
            "VTK": vtk_writes("vtkXMLUnstructuredGridWriter", *RAW, grid=True)}),
        Kind("vtu-zlib", "VTU appended, zlib", ".vtu", "VTK", vtu, {
            "VTK": vtk_writes("vtkXMLUnstructuredGridWriter", *ZLIB, grid=True), "adwave": ours("vtu")}),
        Kind("vtk", "VTK legacy binary", ".vtk", "VTK", legacy, {
            "VTK": vtk_writes("vtkPolyDataWriter", ("SetFileTypeToBinary",)), "adwave": ours("vtk")}),
        Kind("vtk42", "VTK legacy binary, grid 4.2", ".vtk", "meshio", legacy_grid, {"meshio": meshio_writes("vtk42", binary=True)}),
        Kind("msh2", "MSH 2.2 binary", ".msh", "adwave", {"meshio": by_meshio("gmsh")}, {
            "adwave": ours("msh"), "meshio": meshio_writes("gmsh22", binary=True)}),
        Kind("msh4", "MSH 4.1 binary", ".msh", "meshio", {"meshio": by_meshio("gmsh")}, {"meshio": meshio_writes("gmsh", binary=True)}),
        Kind("meshb", "Medit binary", ".meshb", "meshio", {"meshio": by_meshio("medit")}, {
            "meshio": meshio_writes("medit"), "adwave": ours("meshb")}),
        Kind("pcd", "PCD binary", ".pcd", "Open3D", pcd, {"Open3D": open3d_writes_cloud(), "adwave": ours("pcd", True)}, False),
        Kind("las", "LAS", ".las", "laspy", {"laspy": by_laspy}, {"laspy": laspy_writes, "adwave": ours("las", True)}, False),
        Kind("freesurfer", "FreeSurfer surface", ".pial", "NiBabel", {"NiBabel": by_nibabel}, {
            "NiBabel": nibabel_writes, "adwave": ours("freesurfer")}),
        Kind("laz", "LAZ", ".laz", "laspy", {"laspy": by_laspy}, {"laspy": laspy_writes, "adwave": ours("laz", True)}, False),
        Kind("pcd-compressed", "PCD compressed", ".pcd", "Open3D", pcd, {
            "Open3D": open3d_writes_cloud(compressed=True), "adwave": ours("pcd-compressed", True)}, False),
        Kind("ply-gz", "PLY binary, gzip", ".ply.gz", "Python's gzip", {"trimesh and gzip": by_trimesh_gzip}, {
            "Python's gzip": gzip_writes, "adwave": ours("ply")}),
        Kind("3mf", "3MF", ".3mf", "adwave", {"trimesh": by_trimesh, "PyMeshLab": by_meshlab}, {
            "adwave": ours("3mf"), "trimesh": trimesh_writes()}),
        Kind("ply-text", "PLY text", ".ply", "adwave", ply, {
            "adwave": ours("ply-ascii"), "VTK": vtk_writes("vtkPLYWriter", ("SetFileTypeToASCII",)),
            "trimesh": trimesh_writes(encoding="ascii", vertex_normal=False), "Open3D": open3d_writes(write_ascii=True)}, is_text=True),
        Kind("stl-text", "STL text", ".stl", "adwave", stl, {
            "adwave": ours("stl-ascii"), "VTK": vtk_writes("vtkSTLWriter", ("SetFileTypeToASCII",)),
            "meshio": meshio_writes("stl", binary=False)}, is_text=True),
        Kind("obj", "OBJ", ".obj", "adwave", obj, {
            "adwave": ours("obj"), "VTK": vtk_writes("vtkOBJWriter"), "trimesh": trimesh_writes(include_normals=False),
            "Open3D": open3d_writes(), "PyMeshLab": meshlab_writes()}, is_text=True),
        Kind("off", "OFF", ".off", "adwave", off, {
            "adwave": ours("off"), "trimesh": trimesh_writes(), "Open3D": open3d_writes(), "PyMeshLab": meshlab_writes()}, is_text=True),
        Kind("vtp-text", "VTP text", ".vtp", "VTK", vtp, {"VTK": vtk_writes("vtkXMLPolyDataWriter", *TEXT)}, is_text=True),
        Kind("vtu-text", "VTU text", ".vtu", "VTK", vtu, {"VTK": vtk_writes("vtkXMLUnstructuredGridWriter", *TEXT, grid=True)}, is_text=True),
        Kind("vtk-text", "VTK legacy text", ".vtk", "VTK", legacy, {"VTK": vtk_writes("vtkPolyDataWriter", ("SetFileTypeToASCII",))}, is_text=True),
        Kind("msh2-text", "MSH 2.2 text", ".msh", "adwave", {"meshio": by_meshio("gmsh")}, {
            "adwave": ours("msh-ascii"), "meshio": meshio_writes("gmsh22", binary=False)}, is_text=True),
        Kind("msh4-text", "MSH 4.1 text", ".msh", "meshio", {"meshio": by_meshio("gmsh")}, {
            "meshio": meshio_writes("gmsh", binary=False)}, is_text=True),
        Kind("medit", "Medit text", ".mesh", "adwave", {"meshio": by_meshio("medit")}, {
            "adwave": ours("medit"), "meshio": meshio_writes("medit")}, is_text=True),
        Kind("xyz", "XYZ", ".xyz", "adwave", {
            "Open3D": cloud_by_open3d, "trimesh": by_trimesh, "PyMeshLab": by_meshlab, "NumPy": by_numpy_text},
            {"adwave": ours("xyz", True), "Open3D": open3d_writes_cloud()}, False, True),
        Kind("pcd-text", "PCD text", ".pcd", "Open3D", pcd, {
            "Open3D": open3d_writes_cloud(write_ascii=True), "adwave": ours("pcd-ascii", True)}, False, True),
    ]


# The race


@contextlib.contextmanager
def silent():
    """Without what the libraries print, also from C."""
    sys.stdout.flush(), sys.stderr.flush()
    kept, nowhere = [os.dup(k) for k in (1, 2)], os.open(os.devnull, os.O_WRONLY)
    try:
        for k in (1, 2):
            os.dup2(nowhere, k)
        yield
    finally:
        sys.stdout.flush(), sys.stderr.flush()
        for k, copy in zip((1, 2), kept):
            os.dup2(copy, k)
            os.close(copy)
        os.close(nowhere)


@dataclass
class Time:
    """The median time of a program, in seconds."""

    seconds: float
    counts: tuple = ()
    is_once: bool = False


def race(calls, repeats, patience, look=lambda result: ()):
    """The times of programs that take turns, without those that fail; `look` says what came out, off the clock."""
    times, counts, failures = {}, {}, {}

    def once(name):
        gc.collect()
        time.sleep(PAUSE)
        np.empty(TOUCHED, np.uint8).fill(1)
        start = time.perf_counter()
        result = calls[name]()
        seconds = time.perf_counter() - start
        counts[name] = look(result)
        return seconds

    with silent():
        for name in calls:
            try:
                times[name] = [once(name)]
            except Exception as error:  # another library's, of any kind
                failures[name] = f"{type(error).__name__}: {str(error).strip().splitlines()[0] if str(error).strip() else ''}"[:120]
        patient = [name for name, (first,) in times.items() if first <= patience]
        for name in patient:
            times[name] = []  # the first was to warm up
        for k in range(repeats):
            # Nobody always follows the same one.
            for name in patient if k % 2 == 0 else patient[::-1]:
                times[name].append(once(name))
    return {name: Time(statistics.median(t), counts[name], name not in patient) for name, t in times.items()}, failures


def seconds_text(t):
    return f"{t.seconds:.3f}" + ("¹" if t.is_once else "")


def best(times):
    """The fastest peer."""
    return min((name for name in times if name != "adwave"), key=lambda name: times[name].seconds, default=None)


def compare(kind, source, folder, options, notes):
    """Two rows of the tables, reading and writing."""
    path = folder / f"{kind.key}{kind.ending}"
    if not path.exists():
        with silent():
            kind.writers[kind.written_by](source, path)
    n_bytes = path.stat().st_size
    calls = {"adwave": lambda: adwave.read(path), **{name: lambda r=r: r(path) for name, r in kind.readers.items()}}
    read, failures = race(calls, options.repeats, options.patience, counted)
    expected = (len(source.points), len(source.faces) if kind.has_faces else 0)
    for name, t in read.items():
        corners = (3 * expected[1], expected[1])
        if t.counts != expected and not (kind.key.startswith("stl") and t.counts == corners):
            notes.append(f"{kind.title}: {name} has {t.counts[0]} vertices and {t.counts[1]} faces in place of {expected[0]} and {expected[1]}")
    notes.extend(f"{kind.title}: {name} does not read it ({why})" for name, why in failures.items())
    row = [kind.title, kind.written_by, f"{n_bytes / MEGABYTE:.1f}"]
    row += row_of(read, n_bytes)

    wrote = []
    if "adwave" in kind.writers and len(kind.writers) > 1 and not options.no_writing:
        targets = {name: folder / f"written{kind.ending}" for name in kind.writers}
        calls = {name: lambda w=w, name=name: w(source, targets[name]) for name, w in kind.writers.items()}
        sizes = {}
        written, failures = race({n: sized(c, targets[n], sizes, n) for n, c in calls.items()}, options.repeats, options.patience)
        notes.extend(f"{kind.title}: {name} does not write it ({why})" for name, why in failures.items())
        targets["adwave"].unlink(missing_ok=True)
        wrote = [kind.title, f"{sizes['adwave'] / MEGABYTE:.1f}", *row_of(written, sizes["adwave"])] if "adwave" in written else []
    return row, wrote


def sized(call, target, sizes, name):
    """The call, on a place where no file is; keeps the size of what it wrote."""

    def run():
        call()
        sizes[name] = target.stat().st_size

    return run


def row_of(times, n_bytes):
    mine, peer = times["adwave"], best(times)
    peers = ", ".join(f"{name} {seconds_text(t)}" for name, t in sorted(times.items(), key=lambda e: e[1].seconds) if name != "adwave")
    ratio = f"{times[peer].seconds / mine.seconds:.1f}" if peer else "–"
    return [seconds_text(mine), f"{n_bytes / MEGABYTE / mine.seconds:.0f}", peers or "–", ratio]


def print_table(head, rows):
    print("\n| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print(flush=True)


def by_command(command, folder, repeats):
    """The whole command `info` on a file, with its start and the analysis of the shape."""
    for kind in kinds():
        path = folder / f"{kind.key}{kind.ending}"
        if kind.key in ("ply", "ply64", "stl", "glb", "vtp") and path.exists():
            seconds = []
            for _ in range(repeats + 1):
                start = time.perf_counter()
                subprocess.run([command, "info", path, "--json"], check=True, capture_output=True)
                seconds.append(time.perf_counter() - start)
            yield [kind.title, f"{path.stat().st_size / MEGABYTE:.1f}", f"{statistics.median(seconds[1:]):.3f}"]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("shape", type=Path, help="an OBJ of triangles")
    arguments.add_argument("--cut", type=int, default=0, metavar="N", help="cut each triangle in four, N times")
    arguments.add_argument("--only", help="formats, by commas")
    arguments.add_argument("--repeats", type=int, default=5)
    arguments.add_argument("--patience", type=float, default=3.0, metavar="SECONDS")
    arguments.add_argument("--no-writing", action="store_true")
    arguments.add_argument("--command", help="the program `adwave`, to time `adwave info` too")
    arguments.add_argument("--folder", type=Path, help="keeps the files here, and takes those that are here")
    options = arguments.parse_args()

    points, faces = read_obj(options.shape)
    for _ in range(options.cut):
        points, faces = subdivided(points, faces)
    # As many digits as text usually has.
    source = Source(np.round(points / np.ptp(points, axis=0).max(), 7), faces)
    wanted = options.only.split(",") if options.only else None
    known = [kind.key for kind in kinds()]
    if unknown := set(wanted or []) - set(known):
        arguments.error(f"{', '.join(sorted(unknown))}: not among {', '.join(known)}")
    chosen = [kind for kind in kinds() if wanted is None or kind.key in wanted]
    print(f"{len(points)} vertices, {len(faces)} faces, {os.cpu_count()} cores; medians of {options.repeats}", flush=True)

    reading, writing, notes = [], [], []
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for kind in chosen:
            row, wrote = compare(kind, source, folder, options, notes)
            reading.append(row)
            writing += [wrote] if wrote else []
            print(f"{kind.key}: {' · '.join(row[2:])}", file=sys.stderr, flush=True)
        print_table(["reading", "written by", "MB", "adwave s", "MB/s", "peers s", "best peer / adwave"], reading)
        if writing:
            print_table(["writing", "MB", "adwave s", "MB/s", "peers s", "best peer / adwave"], writing)
        if options.command and (rows := list(by_command(options.command, folder, options.repeats))):
            print_table(["`adwave info --json`", "MB", "s"], rows)
    if notes:
        print("\n".join(f"* {note}" for note in notes))


main()
