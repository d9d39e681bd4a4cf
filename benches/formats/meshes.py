"""Formats of meshes and graphs beside the programs that have them: files written by meshio, Gmsh, trimesh and NetworkX are read by adwave, and
files written by adwave are read by these. Prints a line for each: are points, faces (or edges) and fields the same, to the last bit.

    python -m pip install meshio gmsh trimesh networkx scipy lxml
    python benches/formats/meshes.py target/debug/adwave

`adwave saliency` stands for reading and writing where the format holds fields: it changes no point and adds one. Elsewhere `adwave convert`.
"""

import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import gmsh
import meshio
import networkx
import numpy as np
import trimesh

ADWAVE = Path(sys.argv[1]).resolve()
FAILED = []


def write_again(source, target, *args):
    """The shape of a file in another, with a field more where there is room for it."""
    if target.suffix in (".ply", ".msh", ".graphml"):
        run("saliency", source, "-o", target, *args)
    else:
        run("convert", source, "-o", target)


def run(*args):
    done = subprocess.run([ADWAVE, *map(str, args)], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"adwave {' '.join(map(str, args))}: {done.stderr.strip()}")
    return done.stdout


def say(what, **parts):
    words = ", ".join(f"same {name}: {'yes' if same else 'NO'}" for name, same in parts.items())
    print(f"{what:46} {words}", flush=True)
    if not all(parts.values()):
        FAILED.append(what)


def same(a, b):
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    return a.shape == b.shape and bool(np.array_equal(a, b, equal_nan=True))


TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
         "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8"}


def read_ply(path):
    """Points, faces and fields of the vertices in a binary PLY: meshio stops at fields of faces."""
    raw = path.read_bytes()
    head, _, body = raw.partition(b"end_header\n")
    counts, properties = {}, {}
    for words in map(str.split, head.decode().splitlines()):
        if words[0] == "element":
            name, counts[words[1]], properties[words[1]] = words[1], int(words[2]), []
        elif words[0] == "property":
            properties[name].append(words[1:])
    kind = np.dtype([(p[-1], "<" + TYPES[p[0]]) for p in properties["vertex"]])
    vertices = np.frombuffer(body, kind, counts["vertex"])
    at, lists = kind.itemsize * counts["vertex"], []
    for _ in range(counts.get("face", 0)):
        for p in properties["face"]:
            n = 1
            if p[0] == "list":
                size = np.dtype("<" + TYPES[p[1]])
                n = int(np.frombuffer(body, size, 1, at)[0])
                at += size.itemsize
            item = np.dtype("<" + TYPES[p[-2]])
            if p[0] == "list":
                lists.append(np.frombuffer(body, item, n, at))
            at += n * item.itemsize
    cells = [(name, np.array([f for f in lists if len(f) == n])) for name, n in (("triangle", 3), ("quad", 4))]
    points = np.stack([vertices[a] for a in "xyz"], axis=1)
    return meshio.Mesh(points, [c for c in cells if len(c[1])], point_data={n: vertices[n] for n in kind.names if n not in "xyz"})


def by_ply(path, folder):
    """The content of a file as adwave reads it, converted to PLY."""
    ply = folder / "read.ply"
    run("saliency", path, "-o", ply)
    return read_ply(ply)


def faces(mesh, *kinds):
    kinds = kinds or ("triangle", "quad")
    return [row.tolist() for block in mesh.cells if block.type in kinds for row in block.data]


def sphere():
    """Points that need all of their digits, faces, and fields of both."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    points = np.array(ball.vertices) * [1.0, 0.7, 1.3] + 0.1
    data = {"temp": np.sin(7 * points[:, 0]), "flow": points[:, [2, 0, 1]] / 3.0}
    return points, np.array(ball.faces), data, np.cos(np.arange(len(ball.faces)) / 9.0)


def by_meshio(folder):
    points, triangles, data, load = sphere()
    tags = (np.arange(len(triangles)) // 100 + 1).astype(np.int32)
    rich = meshio.Mesh(points, [("triangle", triangles)], point_data=data,
                       cell_data={"load": [load], "gmsh:physical": [tags], "gmsh:geometrical": [tags]})
    plain = meshio.Mesh(points, [("triangle", triangles)], cell_data={"medit:ref": [tags]})
    for name, format, options in [
        ("22.msh", "gmsh22", {"binary": True}),
        ("22t.msh", "gmsh22", {"binary": False, "float_fmt": ".17g"}),
        ("41.msh", "gmsh", {"binary": True}),
        ("41t.msh", "gmsh", {"binary": False, "float_fmt": ".17g"}),
        ("a.mesh", "medit", {"float_fmt": ".17g"}),
        ("a.meshb", "medit", {}),
    ]:
        path = folder / name
        # Its texts have fields as `np.float64(…)`, which is no number.
        has_fields = format != "medit" and not name.endswith("t.msh")
        tagged = meshio.Mesh(points, rich.cells, cell_data={k: v for k, v in rich.cell_data.items() if k != "load"})
        source = rich if has_fields else plain if format == "medit" else tagged
        meshio.write(path, source, file_format=format, **options)
        read = by_ply(path, folder)
        fields = all(same(read.point_data[key], values) for key, values in
                     [("temp", data["temp"])] + [(f"flow_{a}", data["flow"][:, k]) for k, a in enumerate("xyz")]) if has_fields else True
        say(f"{name} of meshio, read", points=same(read.points, points), faces=same(faces(read), triangles), fields=fields)
        # The file again, with a field more; Medit has no place for it.
        back = folder / f"back-{name}"
        write_again(path, back)
        again = meshio.read(back)
        what = {"points": same(again.points, points), "faces": same(faces(again), triangles)}
        if has_fields:
            what["fields"] = (same(again.point_data["temp"], data["temp"]) and "saliency" in again.point_data
                              and same(np.concatenate(again.cell_data["load"]).ravel(), load)
                              and (format == "gmsh" or same(np.concatenate(again.cell_data["gmsh:physical"]), tags)))
        elif format != "gmsh":
            key = "medit:ref" if format == "medit" else "gmsh:physical"
            what["fields"] = same(np.concatenate(again.cell_data[key]), tags)
        say(f"{name} kept by adwave, meshio reads", **what)
    for binary in (False, True):
        path = folder / f"40{'b' if binary else 't'}.msh"
        meshio.gmsh.write(path, meshio.Mesh(points, [("triangle", triangles)]), "4.0", binary, ".17g")
        read = by_ply(path, folder)
        say(f"{path.name} of meshio, read", points=same(read.points, points), faces=same(faces(read), triangles))
    source = folder / "rich.msh"
    meshio.write(source, rich, file_format="gmsh22", binary=True)
    middle = folder / "middle.ply"
    run("saliency", source, "-o", middle)
    for name in ("new.msh", "new.mesh", "new.meshb"):
        path = folder / name
        write_again(middle, path)
        again = meshio.read(path)
        what = {"points": same(again.points, points), "faces": same(faces(again), triangles)}
        if name == "new.msh":
            what["fields"] = same(again.point_data["temp"], data["temp"]) and same(again.point_data["flow"], data["flow"])
        say(f"{name} new by adwave, meshio reads", **what)
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(str(folder / "new.msh"))
    tags, xyz, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    kinds, _, nodes = gmsh.model.mesh.getElements(2)
    what = {"points": same(xyz.reshape(-1, 3)[order], points), "faces": same(np.sort(nodes[0].reshape(-1, 3) - 1, axis=0), np.sort(triangles, axis=0))}
    say("new.msh by adwave, Gmsh reads", **what, fields=len(gmsh.view.getTags()) >= 2)
    gmsh.finalize()


def by_gmsh(folder):
    """A ball of tetrahedra and its surface, of first and second order, in all versions and forms."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    for order in (1, 2):
        gmsh.clear()
        ball = gmsh.model.occ.addSphere(0, 0, 0, 1)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.4)
        gmsh.model.addPhysicalGroup(2, [s for _, s in gmsh.model.getEntities(2)], 42)
        gmsh.model.addPhysicalGroup(3, [ball], 43)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(order)
        for binary in (0, 1):
            for version in (4.1, 2.2) if binary else (4.1, 2.2, 4.0):
                gmsh.option.setNumber("Mesh.MshFileVersion", version)
                gmsh.option.setNumber("Mesh.Binary", binary)
                path = folder / f"gmsh-{order}-{version}-{'b' if binary else 't'}.msh"
                gmsh.write(str(path))
                # meshio does not read all that Gmsh writes as 4.0: the same mesh as 2.2 stands for it.
                other = meshio.read(path) if version != 4.0 else other
                read = by_ply(path, folder)
                corners = [row[:3] for row in faces(other, "triangle", "triangle6")]
                say(f"{path.name} of Gmsh, read", points=same(read.points, other.points), faces=same(faces(read), corners))
    gmsh.finalize()
    # Volume cells alone: the boundary encloses their volume.
    grid = np.array([[x, y, z] for z in range(4) for y in range(4) for x in range(4)], dtype=float)
    at = lambda x, y, z: 16 * z + 4 * y + x
    hexahedra = np.array([[at(x + i, y + j, z + k) for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
                          for x in range(3) for y in range(3) for z in range(3)])
    for name, format in [("hex.msh", "gmsh"), ("hex.mesh", "medit"), ("hex.meshb", "medit")]:
        meshio.write(folder / name, meshio.Mesh(grid, [("hexahedron", hexahedra)]), file_format=format)
        read = by_ply(folder / name, folder)
        quads = np.array(faces(read, "quad"))
        triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        volume = np.einsum("ij,ij->i", read.points[triangles[:, 0]], np.cross(read.points[triangles[:, 1]], read.points[triangles[:, 2]])).sum() / 6
        say(f"{name}: 27 cells, boundary", points=same(read.points, grid), faces=len(quads) == 54 and abs(volume - 27) < 1e-9)


def manufacturing(folder):
    points, triangles, _, _ = sphere()
    mesh = trimesh.Trimesh(points, triangles, process=False)
    path = folder / "trimesh.3mf"
    mesh.export(path)
    other = trimesh.load(path, process=False).to_mesh()
    read = by_ply(path, folder)
    say("trimesh.3mf, read", points=same(read.points, other.vertices), faces=same(faces(read), other.faces))
    mesh.export(folder / "source.ply", vertex_normal=False, encoding="ascii")
    meshio.write(folder / "source.ply", meshio.Mesh(points, [("triangle", triangles)]))
    write_again(folder / "source.ply", folder / "new.3mf")
    again = trimesh.load(folder / "new.3mf", process=False).to_mesh()
    say("new.3mf by adwave, trimesh reads", points=same(again.vertices, points), faces=same(again.faces, triangles))
    write_again(folder / "source.ply", folder / "new.amf")
    root = ElementTree.parse(folder / "new.amf").getroot()
    numbers = [[float(c.find(a).text) for a in "xyz"] for c in root.iter("coordinates")]
    corners = [[int(t.find(v).text) for v in ("v1", "v2", "v3")] for t in root.iter("triangle")]
    say("new.amf by adwave, ElementTree reads", points=same(numbers, points), faces=same(corners, triangles))
    with zipfile.ZipFile(folder / "zipped.amf", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.write(folder / "new.amf", "new.amf")
    read = by_ply(folder / "zipped.amf", folder)
    say("zipped.amf, read", points=same(read.points, points), faces=same(faces(read), triangles))
    lines = f"OFF\n{len(points)} {len(triangles)} 0\n" + "\n".join(" ".join(map(repr, map(float, p))) for p in points)
    lines += "\n" + "  ".join(f"3 {a}\n{b} {c}" for a, b, c in triangles) + "\n"
    (folder / "words.off").write_text(lines)
    read = by_ply(folder / "words.off", folder)
    say("OFF over lines, read", points=same(read.points, points), faces=same(faces(read), triangles))
    single = points.astype(">f4")
    rows = b"".join(np.array([3, *t, 0], dtype=">i4").tobytes() for t in triangles)
    head = np.array([len(points), len(triangles), 0], dtype=">i4").tobytes()
    (folder / "binary.off").write_bytes(b"OFF BINARY\n" + head + single.tobytes() + rows)
    read = by_ply(folder / "binary.off", folder)
    say("OFF BINARY, read", points=same(read.points, single), faces=same(faces(read), triangles))
    for name, head in [("text.dmat", b""), ("binary.dmat", b"0 0\n")]:
        body = points.T.tobytes() if head else "\n".join(map(repr, map(float, points.T.ravel()))).encode()
        (folder / name).write_bytes(head + f"3 {len(points)}\n".encode() + body)
        read = by_ply(folder / name, folder)
        say(f"{name}, read", points=same(read.points, points))


def graphs(folder):
    graph = networkx.random_geometric_graph(60, 0.35, seed=3)
    for k, (a, b) in enumerate(graph.edges):
        graph.edges[a, b]["weight"] = 0.1 + k / 7.0
    positions = np.array([graph.nodes[v]["pos"] for v in graph])
    for v in graph:
        x, y = graph.nodes[v].pop("pos")
        graph.nodes[v].update(x=float(x), y=float(y))
    wanted = {frozenset((a, b)): w for a, b, w in graph.edges(data="weight")}
    networkx.write_graphml(graph, folder / "nx.graphml")
    networkx.write_weighted_edgelist(graph, folder / "nx.edgelist")
    networkx.write_edgelist(graph, folder / "nxdict.edges")
    with open(folder / "places.tgf", "w") as out:
        out.writelines(f"{v} {x!r} {y!r} 0\n" for v, (x, y) in enumerate(positions.tolist()))
        out.write("#\n")
        out.writelines(f"{a} {b} {w!r}\n" for a, b, w in graph.edges(data="weight"))

    def edges(path, start=0):
        if path.suffix == ".graphml":
            back = networkx.read_graphml(path)
            names = {name: k for k, name in enumerate(back)}
            return {frozenset((names[a], names[b])): w for a, b, w in back.edges(data="weight")}, back
        rows = [line.split() for line in path.read_text().split("#")[-1].splitlines()[1:] if line.strip()]
        return {frozenset((int(a) - start, int(b) - start)): float(w) for a, b, w in rows}, None

    for source in ("nx.graphml", "nx.edgelist", "nxdict.edges", "places.tgf"):
        for target, start in (("out.graphml", 0), ("out.edgelist", 0), ("out.tgf", 1)):
            write_again(folder / source, folder / target, "--field", "degree")
            found, back = edges(folder / target, start)
            parts = {"edges": found == wanted}
            if target == "out.graphml" and source in ("nx.graphml", "places.tgf"):
                parts["points"] = same([[d["x"], d["y"]] for _, d in back.nodes(data=True)], positions)
            say(f"{source} of NetworkX to {target}", **parts)


with tempfile.TemporaryDirectory() as name:
    for part in (by_meshio, by_gmsh, manufacturing, graphs):
        try:
            part(Path(name))
        except Exception as error:  # the others still count
            say(f"{part.__name__}: {error}", run=False)
print(f"{len(FAILED)} differ" if FAILED else "all the same")
sys.exit(bool(FAILED))
