"""The same tasks by adwave and by other Python packages: seconds, and lines that a user writes.

python compare.py [--vertices N] [--mesh FILE] [--repeat K]

Each task is a function whose body is what a user would write after loading points V and faces F; the time is the median of K runs in this
process, and the lines are those of the body. A package that is not installed, or fails, is listed with the reason. The shape is the built-in
creature, or that of a file.
"""

from __future__ import annotations

import argparse
import inspect
import statistics
import sys
import time
from collections.abc import Callable
from typing import Any

import adwave as aw
import numpy as np

TASKS: list[tuple[str, str, Callable[..., Any]]] = []


def task(title: str, package: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    def add(function: Callable[..., Any]) -> Callable[..., Any]:
        TASKS.append((title, package, function))
        return function

    return add


BANDS = "eight bands of the positions"
SMOOTH = "smooth a mesh and keep its volume"
EIGEN = "fifty eigenfunctions of the Laplacian"
SPREAD = "distance along the surface from one vertex"


@task(BANDS, "adwave")
def _(V, F):
    return aw.decompose((V, F), levels=8)


@task(BANDS, "PyGSP, Chebyshev of order 30")
def _(V, F):
    import scipy.sparse as sp
    from pygsp import filters, graphs

    i = F[:, [0, 1, 2]].ravel()
    j = F[:, [1, 2, 0]].ravel()
    W = sp.coo_matrix((np.ones(len(i)), (i, j)), (len(V), len(V)))
    G = graphs.Graph(((W + W.T) > 0).astype(float))
    G.estimate_lmax()
    heat = filters.Heat(G, 2.0 ** np.arange(8) * 10)
    S = np.concatenate([V[:, None, :], np.moveaxis(heat.filter(V, order=30), -1, 1)], axis=1)
    return np.concatenate([S[:, :-1] - S[:, 1:], S[:, -1:]], axis=1)


@task(BANDS, "SciPy, products one by one")
def _(V, F):
    import scipy.sparse as sp

    i = F[:, [0, 1, 2]].ravel()
    j = F[:, [1, 2, 0]].ravel()
    W = sp.csr_array((np.ones(len(i)), (i, j)), (len(V), len(V)))
    W = ((W + W.T) > 0).astype(float)
    P = (sp.eye_array(len(V)) + sp.diags_array(1 / W.sum(axis=1)) @ W) / 2
    S, bands, done = V, [], 0
    for steps in 2 ** np.arange(8):
        T = S
        for _ in range(steps - done):
            T = P @ T
        bands.append(S - T)
        S, done = T, steps
    return [*bands, S]


@task(SMOOTH, "adwave")
def _(V, F):
    return aw.filter((V, F), "smooth", levels=5)


@task(SMOOTH, "PyVista smooth_taubin")
def _(V, F):
    import pyvista as pv

    mesh = pv.PolyData.from_regular_faces(V, F)
    return mesh.smooth_taubin(n_iter=30, pass_band=0.05)


@task(SMOOTH, "trimesh filter_taubin")
def _(V, F):
    import trimesh

    mesh = trimesh.Trimesh(V, F, process=False)
    return trimesh.smoothing.filter_taubin(mesh, iterations=30)


@task(SMOOTH, "PyMeshLab Taubin")
def _(V, F):
    import pymeshlab

    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(V, F))
    ms.apply_coord_taubin_smoothing(stepsmoothnum=30)
    return ms.current_mesh().vertex_matrix()


@task(SMOOTH, "MeshLib relaxKeepVolume")
def _(V, F):
    from meshlib import mrmeshnumpy
    from meshlib import mrmeshpy as mm

    mesh = mrmeshnumpy.meshFromFacesVerts(F, V)
    params = mm.MeshRelaxParams()
    params.iterations = 30
    mm.relaxKeepVolume(mesh, params)
    return mrmeshnumpy.getNumpyVerts(mesh)


@task(EIGEN, "adwave")
def _(V, F):
    return aw.baselines.harmonics((V, F), 50)


@task(EIGEN, "robust_laplacian and eigsh")
def _(V, F):
    import robust_laplacian
    import scipy.sparse.linalg as sla

    L, M = robust_laplacian.mesh_laplacian(np.asarray(V), np.asarray(F, dtype=np.int64))
    return sla.eigsh(L, 50, M, sigma=-1e-8)


@task(SPREAD, "adwave, as a soft region of 30 % of the diagonal")
def _(V, F):
    return aw.region((V, F), "ball:vertex=0,radius=30%,falloff=30%")


@task(SPREAD, "potpourri3d, heat method")
def _(V, F):
    import potpourri3d as pp3d

    solver = pp3d.MeshHeatMethodDistanceSolver(np.asarray(V), np.asarray(F, dtype=np.int64))
    return solver.compute_distance(0)


def lines_of(function: Callable[..., Any]) -> int:
    body = inspect.getsource(function).splitlines()[2:]
    return sum(bool(line.strip()) for line in body)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--vertices", type=int, default=35_000)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--slowest", type=float, default=60.0, help="seconds after which one run is enough")
    parser.add_argument("--mesh", help="a file with a mesh, in the place of the creature")
    arguments = parser.parse_args()
    made = {"vertices": arguments.vertices, "noise": 0.2}
    shape = aw.read(arguments.mesh) if arguments.mesh else aw.sample("creature", **made)
    V, F = np.array(shape.points), np.array(shape.faces, dtype=np.int64)
    print(f"{len(V)} vertices, {len(F)} faces, {aw.threads(0).n} threads\n")
    print("| task | package | seconds | against adwave | lines |\n|---|---|---|---|---|")
    own = {}
    for title, package, function in TASKS:
        try:
            times = []
            for _ in range(1 + arguments.repeat):
                start = time.perf_counter()
                function(V, F)
                times.append(time.perf_counter() - start)
                if times[-1] > arguments.slowest:
                    break
        except Exception as error:
            print(f"| {title} | {package} | {type(error).__name__}: {str(error).splitlines()[0][:80]} | | |")
            continue
        # The first run loads the package.
        seconds = statistics.median(times[1:] or times)
        own.setdefault(title, seconds)
        ratio = seconds / own[title]
        print(f"| {title} | {package} | {seconds:.3f} | {ratio:.1f} × | {lines_of(function)} |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
