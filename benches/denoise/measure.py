"""Distance of denoised meshes from the clean one: `measure.py CLEAN RESULT [RESULT …]` prints a row for each result.

All meshes have the same faces in the same order (OBJ or PLY in ASCII or binary). The measures:

* `angle`: mean over the faces of the angle between the normals, degrees; faces without area in one of the meshes are left out.
* `to_clean`, `from_clean`: mean distance of the result's vertices to the clean surface and of the clean vertices to the
  result's, in mean edges of the clean mesh.
* `moved`: root mean square distance of corresponding vertices, in mean edges of the clean mesh.
* `flipped`: triangles whose normal is more than 90° from the clean one's.
* `volume`: V / V_clean − 1, if the clean mesh is closed.
"""

import json
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parent.parent))  # modules shared by all comparisons
from closest import Surface  # noqa: E402

TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "<i2", "int16": "<i2", "ushort": "<u2",
         "uint16": "<u2", "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4", "float": "<f4",
         "float32": "<f4", "double": "<f8", "float64": "<f8"}


@dataclass
class Mesh:
    """Positions (n × 3) and corners of the triangles (m × 3, from 0)."""

    points: np.ndarray
    triangles: np.ndarray


def read(path):
    path = Path(path)
    mesh = read_ply(path) if path.suffix.lower() == ".ply" else read_obj(path)
    if not len(mesh.triangles):
        sys.exit(f"{path} has no faces; give a mesh")
    return mesh


def read_obj(path):
    points, triangles = [], []
    for line in path.read_text(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(w.split("/")[0]) - 1 for w in words[1:]]
            triangles += [[corners[0], corners[k], corners[k + 1]] for k in range(1, len(corners) - 1)]
    return Mesh(np.array(points).reshape(-1, 3), np.array(triangles, int).reshape(-1, 3))


def read_ply(path):
    """Triangles of a binary PLY as `adwave` writes it: rows of fixed length, lists of three in the faces."""
    header, _, body = path.read_bytes().partition(b"end_header\n")
    lines = [line.split() for line in header.decode(errors="replace").splitlines()]
    if ["format", "binary_little_endian", "1.0"] not in lines:
        sys.exit(f"{path} is not a binary little-endian PLY; write it as OBJ")
    elements = {}
    for words in lines:
        if words[:1] == ["element"]:
            row = elements.setdefault(words[1], (int(words[2]), []))[1]
        elif words[:2] == ["property", "list"]:
            row += [(f"n_{words[4]}", TYPES[words[2]]), (words[4], TYPES[words[3]], (3,))]
        elif words[:1] == ["property"]:
            row.append((words[2], TYPES[words[1]]))
    found = {}
    for name, (count, row) in elements.items():
        found[name] = np.frombuffer(body, row, count)
        body = body[found[name].nbytes:]
    faces = found["face"]
    corners = next((name for name in ("vertex_indices", "vertex_index") if name in faces.dtype.names), None)
    if corners is None or not (faces[f"n_{corners}"] == 3).all():
        sys.exit(f"{path} has faces that are not triangles; write it as OBJ")
    points = np.stack([found["vertex"][c] for c in "xyz"], axis=1).astype(float)
    return Mesh(points, faces[corners].astype(int))


def write_obj(path, mesh):
    with open(path, "w") as out:
        out.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in mesh.points.tolist())
        out.writelines(f"f {a} {b} {c}\n" for a, b, c in (mesh.triangles + 1).tolist())


def doubled_normals(mesh):
    a, b, c = mesh.points[mesh.triangles].transpose(1, 0, 2)
    return np.cross(b - a, c - a)


def angles(clean, result):
    """Angle in degrees between the normals of corresponding faces; NaN if one has no area."""
    u, v = doubled_normals(clean), doubled_normals(result)
    across, along = np.linalg.norm(np.cross(u, v), axis=1), np.einsum("ij,ij->i", u, v)
    degenerate = (np.linalg.norm(u, axis=1) == 0) | (np.linalg.norm(v, axis=1) == 0)
    return np.where(degenerate, np.nan, np.degrees(np.arctan2(across, along)))


def edges(mesh):
    """Pairs of vertices, and the number of triangles at each edge."""
    sides = np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]])
    return np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)


def mean_edge(mesh):
    a, b = mesh.points[edges(mesh)[0]].transpose(1, 0, 2)
    return float(np.linalg.norm(a - b, axis=1).mean())


def is_closed(mesh):
    return bool((edges(mesh)[1] == 2).all())


def volume(mesh):
    a, b, c = (mesh.points[mesh.triangles] - mesh.points[0]).transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


class Clean:
    """A clean mesh, prepared to measure several results against it."""

    def __init__(self, mesh):
        self.mesh, self.edge, self.closed = mesh, mean_edge(mesh), is_closed(mesh)
        self.surface, self.used = Surface(mesh), np.unique(mesh.triangles)

    def measures(self, result, distances=True):
        """The measures of the module as a dictionary; `distances=False` leaves out the slow distances to surfaces."""
        mesh = self.mesh
        if len(result.points) != len(mesh.points) or not np.array_equal(result.triangles, mesh.triangles):
            raise ValueError("the result must have the faces of the clean mesh")
        if not np.isfinite(result.points).all():
            raise ValueError("positions of the result must be finite")
        angle = angles(mesh, result)
        moved = np.linalg.norm((result.points - mesh.points)[self.used], axis=1)
        found = {"angle": float(np.nanmean(angle)), "moved": float(np.sqrt((moved**2).mean()) / self.edge),
                 "flipped": int((angle > 90).sum()),
                 "volume": volume(result) / volume(mesh) - 1 if self.closed else None}
        if distances:
            there = self.surface.closest(result.points[self.used]).distances
            back = Surface(result).closest(mesh.points[self.used]).distances
            found |= {"to_clean": float(there.mean() / self.edge), "from_clean": float(back.mean() / self.edge)}
        return found


def main():
    words = [w for w in sys.argv[1:] if w != "--json"]
    if len(words) < 2:
        sys.exit("usage: measure.py CLEAN RESULT [RESULT …] [--json]")
    clean, found = Clean(read(words[0])), {}
    for path in words[1:]:
        try:
            found[path] = clean.measures(read(path))
        except ValueError as error:
            sys.exit(f"{path}: {error}")
    if "--json" in sys.argv:
        print(json.dumps(found, indent=1))
        return
    print(f"{'angle':>7} {'to clean':>9} {'from':>7} {'moved':>7} {'flipped':>7} {'volume':>8}")
    for path, measures in found.items():
        change = "–" if measures["volume"] is None else f"{100 * measures['volume']:+.2f}%"
        print(f"{measures['angle']:6.2f}° {measures['to_clean']:9.4f} {measures['from_clean']:7.4f} {measures['moved']:7.4f} "
              f"{measures['flipped']:7} {change:>8}  {path}")


if __name__ == "__main__":
    main()
