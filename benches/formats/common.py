"""Parts that the checks of formats share: the command, shapes to write, and the comparison of two shapes.

A check writes a file with another library, lets `adwave` write what it read as PLY or in another format, and compares what
the libraries read: points to the last bit, faces by the places of their corners, fields by name.
"""

import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np


@dataclass
class Shape:
    """Points, faces as lists of points' numbers, and values by name."""

    points: np.ndarray
    faces: list
    fields: dict = field(default_factory=dict)
    face_fields: dict = field(default_factory=dict)


class Adwave:
    """The command."""

    def __init__(self, path):
        self.path = str(path)

    def run(self, *arguments):
        """Runs it; its own line where it fails."""
        done = subprocess.run([self.path, *map(str, arguments)], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(done.stderr.strip() or done.stdout.strip())

    def convert(self, source, target):
        """Writes a file again in the format of another name; points move by rounding alone."""
        self.run("filter", source, "-o", target, "--gains", "1,1")
        return Path(target)

    def mask(self, source, folder):
        """A file as `adwave` reads it: points, faces and fields of vertices unchanged in a PLY."""
        target = Path(folder) / "read.ply"
        self.run("region", source, "--region", "all", "-o", target)
        return read_ply(target)

    def refield(self, source, target, name):
        """Writes a file again in another format; all but the field of that name is unchanged."""
        self.run("filter", source, "-o", target, "--field", name, "--gains", "1,1")
        return Path(target)

    def field(self, source, name, folder):
        """A signal as `adwave` reads it: the first scaling band."""
        target = Path(folder) / "bands.npz"
        self.run("transform", source, "-o", target, "--field", name, "--levels", "1")
        return np.load(target)["scaling"][0]


PLY_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "int64": "i8", "uint64": "u8", "float": "f4", "double": "f8",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8",
}


def read_ply(path):
    """Points, faces and fields of a binary PLY. An own reader: meshio knows half of the types."""
    content = Path(path).read_bytes()
    end = content.index(b"end_header\n") + len(b"end_header\n")
    order = ">" if b"binary_big_endian" in content[:end] else "<"
    elements, at = [], end
    for line in content[:end].decode().splitlines():
        words = line.split()
        if words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property":
            elements[-1][2].append(words[1:])
    shape = Shape(np.zeros((0, 3)), [])
    for name, n, properties in elements:
        if all(words[0] != "list" for words in properties):
            row = np.dtype([(words[-1], order + PLY_TYPES[words[0]]) for words in properties])
            rows = np.frombuffer(content, row, n, at)
            at += n * row.itemsize
            if name == "vertex":
                shape.points = np.stack([rows[c].astype(float) for c in "xyz"], axis=1)
                shape.fields = {c: rows[c] for c in row.names if c not in "xyz"}
            continue
        for _ in range(n):
            for words in properties:
                count = 1
                if words[0] == "list":
                    count = int(np.frombuffer(content, order + PLY_TYPES[words[1]], 1, at)[0])
                    at += np.dtype(PLY_TYPES[words[1]]).itemsize
                kind = np.dtype(order + PLY_TYPES[words[-2]])
                values = np.frombuffer(content, kind, count, at)
                at += count * kind.itemsize
                if words[0] == "list":
                    shape.faces.append([int(v) for v in values])
    return shape


def corners(shape):
    """Faces by the places of their corners, from the smallest on: equal for equal surfaces in any numbering."""
    points = [tuple(p) for p in np.asarray(shape.points, dtype=float)]

    def turned(face):
        listed = [points[v] for v in face]
        start = listed.index(min(listed))
        return tuple(listed[start:] + listed[:start])

    return sorted(turned(face) for face in shape.faces)


def unordered(shape):
    """Faces as sets of places, for libraries that turn faces round."""
    return sorted(tuple(sorted(face)) for face in corners(shape))


def same_points(a, b):
    """True if the points are bit-identical, in order."""
    return a.points.shape == b.points.shape and bool(np.array_equal(np.asarray(a.points, float), np.asarray(b.points, float)))


def same_places(a, b):
    """True if the points are at the same positions, in any order and number."""
    return set(map(tuple, np.asarray(a.points, float))) == set(map(tuple, np.asarray(b.points, float)))


def same_values(a, b):
    """True if two arrays hold the same numbers; NaN equals NaN."""
    a, b = np.asarray(a, dtype=float).squeeze(), np.asarray(b, dtype=float).squeeze()
    return a.shape == b.shape and bool(np.array_equal(a, b, equal_nan=True))


class Report:
    """Lines of what agrees."""

    def __init__(self):
        self.failures = 0

    def check(self, name, run):
        """Prints a line for a check, which gives what was compared and whether it is the same."""
        try:
            outcome = run()
        except Exception as error:  # a check that breaks is one that fails
            outcome = {f"{type(error).__name__}: {error}"[:160]: False}
        self.failures += not all(outcome.values())
        words = ", ".join(f"same {what}: {'yes' if ok else 'NO'}" for what, ok in outcome.items())
        print(f"{name:46s} {words}", flush=True)

    def end(self):
        """Ends the program with the number of failures."""
        print(f"{self.failures} differ" if self.failures else "all the same")
        sys.exit(min(self.failures, 100))


def sphere(n=12):
    """A sphere of quadrilaterals and triangles, in double precision."""
    points, faces = [[0.0, 0.0, 1.0]], []
    for k in range(1, n):
        for j in range(2 * n):
            t, p = np.pi * k / n, np.pi * j / n
            points.append([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)])
    points.append([0.0, 0.0, -1.0])
    last, m = len(points) - 1, 2 * n
    for j in range(m):
        faces.append([0, 1 + j, 1 + (j + 1) % m])
        for k in range(n - 2):
            a, b = 1 + k * m + j, 1 + k * m + (j + 1) % m
            faces.append([a, a + m, b + m, b])
        faces.append([last, 1 + (n - 2) * m + (j + 1) % m, 1 + (n - 2) * m + j])
    return Shape(np.array(points), faces)
