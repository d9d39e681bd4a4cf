"""A library's denoiser with its defaults, in a process of its own: `rival.py NAME IN OUT` prints the seconds of the call.

Positions and triangles are passed as arrays, so that no library's file reader changes their order.
"""

import sys
import time

import numpy as np

from measure import Mesh, read, write_obj


def meshlib(mesh):
    """Denoises by MeshLib: Mumford–Shah normals, then vertices that fit them. Returns seconds and points."""
    from meshlib import mrmeshnumpy, mrmeshpy

    held = mrmeshnumpy.meshFromFacesVerts(mesh.triangles.astype(np.int32), mesh.points)
    start = time.perf_counter()
    mrmeshpy.meshDenoiseViaNormals(held)
    return time.perf_counter() - start, mrmeshnumpy.getNumpyVerts(held)[: len(mesh.points)]


def meshlab(mesh, filter_name):
    """Applies a filter of MeshLab with its defaults. Returns seconds and points."""
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(mesh.points, mesh.triangles))
    start = time.perf_counter()
    meshes.apply_filter(filter_name)
    return time.perf_counter() - start, meshes.current_mesh().vertex_matrix()


CALLS = {
    "meshlib": meshlib,
    "two-step": lambda mesh: meshlab(mesh, "apply_coord_two_steps_smoothing"),
    "taubin": lambda mesh: meshlab(mesh, "apply_coord_taubin_smoothing"),
}


def main():
    name, source, out = sys.argv[1:]
    mesh = read(source)
    seconds, points = CALLS[name](mesh)
    if points.shape != mesh.points.shape:
        sys.exit(f"{name} returned {len(points)} vertices, expected {len(mesh.points)}")
    write_obj(out, Mesh(points, mesh.triangles))
    print(seconds)


if __name__ == "__main__":
    main()
