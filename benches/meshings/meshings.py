"""Other meshings of the same surface, kept in the work folder until their source or their parameters change."""

import hashlib

import numpy as np
import pymeshlab

from closest import Surface
from mesh import Mesh, drop_unused_vertices, edges_and_sides, read, write

ISOTROPIC = {"iterations": 10, "adaptive": False, "featuredeg": 30.0, "checksurfdist": True, "reprojectflag": True}
# The farthest that the remeshing may move the surface, in target edges.
MAX_DISTANCE = 0.5
# The mesh of many sizes: initial vertices; smallest and largest limit of the edge length, in mean edges of the source; number
# of waves of that limit along the longest side of the bounding box.
COARSE_VERTICES, SIZES, WAVES = 600, (0.8, 10.0), 2.5
# Bisection may not end if midpoints are projected far away; this many triangles stop it.
MAX_TRIANGLES = 2_000_000


class Meshings:
    """Creates each mesh once: a comment in `folder/NAME.ply` records its source."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def cached(self, name, source, parameters, make):
        """The mesh that `make` returns, read from its file if source (bytes) and parameters are unchanged."""
        key = hashlib.sha256(source + repr(parameters).encode()).hexdigest()[:32]
        path = self.folder / f"{name}.ply"
        found = read(path, key)
        if found is None:
            print(f"  making {path.name}", flush=True)
            write(path, *make(), key)
            found = read(path, key)
        return Mesh(name, path, *found)

    def original(self, name, file):
        """The mesh of a file, without vertices that no triangle uses."""
        return self.cached(name, file.read_bytes(), "original", lambda: drop_unused_vertices(*arrays(load(file))))

    def isotropic(self, mesh, target=None):
        """Isotropic explicit remeshing, projected on the surface; the target edge is the mean edge of the mesh."""
        target = target or mesh.mean_edge
        parameters = {**ISOTROPIC, "targetlen": target, "maxsurfdist": MAX_DISTANCE * target}

        def make():
            lengths = {k: pymeshlab.PureValue(parameters[k]) for k in ("targetlen", "maxsurfdist")}
            meshes = meshset(mesh)
            meshes.meshing_isotropic_explicit_remeshing(**{**parameters, **lengths})
            return drop_unused_vertices(*arrays(meshes))

        return self.cached(f"{mesh.name}-isotropic", source(mesh), parameters, make)

    def subdivided(self, mesh):
        """The mesh with every triangle cut into four at its edge midpoints."""
        return self.cached(f"{mesh.name}-subdivided", source(mesh), "midpoints", lambda: midpoints(mesh))

    def decimated(self, mesh, faces=0.5):
        """Quadric edge collapse to a share of the triangles, with default settings."""

        def make():
            meshes = meshset(mesh)
            meshes.meshing_decimation_quadric_edge_collapse(targetperc=faces)
            return drop_unused_vertices(*arrays(meshes))

        return self.cached(f"{mesh.name}-decimated", source(mesh), ("quadric", faces), make)

    def many_sizes(self, mesh):
        """A mesh of the same surface whose triangles grow and shrink along it."""

        def make():
            meshes = meshset(mesh)
            meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=2 * COARSE_VERTICES)
            axis = np.ptp(mesh.points, axis=0).argmax()
            start, length = mesh.points[:, axis].min(), np.ptp(mesh.points[:, axis])
            smallest, largest = (s * mesh.mean_edge for s in SIZES)

            def size(points):
                wave = 0.5 - 0.5 * np.cos(2 * np.pi * WAVES * (points[:, axis] - start) / length)
                return smallest * (largest / smallest) ** wave

            surface = Surface(mesh)
            project = lambda points: surface.closest(points).interpolated(mesh.points)
            return refine(*drop_unused_vertices(*arrays(meshes)), size, project)

        return self.cached(f"{mesh.name}-many-sizes", source(mesh), (COARSE_VERTICES, SIZES, WAVES), make)


def load(file):
    """A MeshSet with the mesh of a file."""
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.load_new_mesh(str(file))
    return meshes


def meshset(mesh):
    """A MeshSet with a mesh."""
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(mesh.points, mesh.triangles))
    return meshes


def arrays(meshes):
    """Points and triangles of the current mesh."""
    current = meshes.current_mesh()
    return current.vertex_matrix(), current.face_matrix().astype(np.int64)


def source(mesh):
    """The bytes of points and triangles, for a hash."""
    return mesh.points.tobytes() + mesh.triangles.tobytes()


def midpoints(mesh):
    """Points and triangles after every triangle was cut into four."""
    edges, sides = edges_and_sides(mesh.triangles)
    (a, b, c), (ab, bc, ca) = mesh.triangles.T, len(mesh.points) + sides.T
    middles = mesh.points[edges].mean(axis=1)
    corners = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return np.concatenate([mesh.points, middles]), np.concatenate([np.stack(t, 1) for t in corners])


def refine(points, triangles, size, project):
    """Bisects longest edges (Rivara 1984) until none is longer than `size` at the triangle's center; projects midpoints."""
    while len(triangles) <= MAX_TRIANGLES:
        edges, sides = edges_and_sides(triangles)
        lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
        # Ranks instead of lengths, so that two triangles agree on the longer of two equally long edges.
        ranks = np.argsort(np.lexsort((np.arange(len(edges)), lengths)))
        longest = ranks[sides].argmax(axis=1)
        rows = np.arange(len(triangles))
        too_long = lengths[sides[rows, longest]] > size(points[triangles].mean(axis=1))
        if not too_long.any():
            return points, triangles
        marked = np.zeros(len(edges), bool)
        marked[sides[too_long, longest[too_long]]] = True
        # A triangle that loses an edge loses its longest too.
        while (more := marked[sides].any(axis=1) & ~marked[sides[rows, longest]]).any():
            marked[sides[more, longest[more]]] = True
        middle = np.full(len(edges), -1)
        middle[marked] = len(points) + np.arange(marked.sum())
        points = np.concatenate([points, project(points[edges[marked]].mean(axis=1))])
        turn = (longest[:, None] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(triangles, turn, 1).T
        ab, bc, ca = middle[np.take_along_axis(sides, turn, 1)].T
        halved, cut_ca, cut_bc = ab >= 0, ca >= 0, bc >= 0
        pieces = [
            (~halved, (a, b, c)),
            (halved & ~cut_ca, (a, ab, c)), (halved & cut_ca, (a, ab, ca)), (halved & cut_ca, (ca, ab, c)),
            (halved & ~cut_bc, (ab, b, c)), (halved & cut_bc, (ab, b, bc)), (halved & cut_bc, (ab, bc, c)),
        ]
        triangles = np.concatenate([np.stack(corners, 1)[kept] for kept, corners in pieces])
    raise SystemExit(f"bisection exceeded {MAX_TRIANGLES:,} triangles: the coarse mesh is too far from the surface")
