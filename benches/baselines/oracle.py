"""The baselines against implementations that others wrote.

Run by `cargo xtask oracle-baselines`. Eigenvalues: SciPy's eigsh (shift-invert) on libigl's stiffness and mass matrices.
Spectral graph wavelets: PyGSP's kernels, exactly (by all eigenpairs), on PyGSP's bunny and Minnesota graphs.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import igl
import numpy as np
import scipy.io
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from pygsp import filters, graphs

# Relative to the largest eigenvalue compared: both solvers iterate.
EIGENVALUES = 1e-8
# Of the intrinsic Delaunay triangulation, which is not unique where four corners lie on a circle.
EIGENVALUES_DELAUNAY = 1e-7
# Relative to the norm of the signal.
WAVELETS = 1e-6
# adwave's time over the peer's.
RATIO = 1.0


def run(program, *arguments):
    result = subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, text=True)
    return result.stdout.split("\n")


def grid_sphere(n):
    """A sphere of latitudes and longitudes: a mesh of our own where there is no data.

    Its vertices are nudged: four corners on a circle have two Delaunay triangulations, and masses for each.
    """
    theta = np.linspace(0, np.pi, n)[1:-1]
    phi = np.linspace(0, 2 * np.pi, 2 * n, endpoint=False)
    nudge = np.random.default_rng(0).uniform(-0.2, 0.2, (len(theta), len(phi), 2)) * np.pi / n
    ring = [
        [np.sin(t + dt) * np.cos(p + dp), np.sin(t + dt) * np.sin(p + dp), np.cos(t + dt)]
        for t, row in zip(theta, nudge)
        for p, (dt, dp) in zip(phi, row)
    ]
    v = np.array(ring + [[0, 0, 1], [0, 0, -1]])
    m, rows = len(phi), len(theta)
    f = []
    for j in range(m):
        k = (j + 1) % m
        f.append([m * rows, j, k])
        f.append([m * rows + 1, (rows - 1) * m + k, (rows - 1) * m + j])
        for i in range(rows - 1):
            a, b, c, d = i * m + j, i * m + k, (i + 1) * m + j, (i + 1) * m + k
            f += [[a, c, d], [a, d, b]]
    return v, np.array(f)


def spectrum(program, folder, name, v, f, k, delaunay, timed):
    # Vertices of no face have no mass; libigl would leave M singular.
    used = np.unique(f)
    index = np.full(len(v), -1)
    index[used] = np.arange(len(used))
    v, f = v[used], index[f]
    path = folder / "mesh.txt"
    with open(path, "w") as out:
        out.writelines("v %r %r %r\n" % tuple(map(float, p)) for p in v)
        out.writelines("f %d %d %d\n" % tuple(t) for t in f)
    start = time.perf_counter()
    if delaunay:
        stiffness, intrinsic, faces = igl.intrinsic_delaunay_cotmatrix(v, f)
        mass = igl.massmatrix_intrinsic(intrinsic, faces, igl.MASSMATRIX_TYPE_BARYCENTRIC)
    else:
        stiffness = igl.cotmatrix(v, f)
        mass = igl.massmatrix(v, f, igl.MASSMATRIX_TYPE_BARYCENTRIC)
    area = mass.diagonal().sum()
    sigma = -0.01 * 4 * np.pi / area
    theirs = np.sort(spla.eigsh(sp.csc_matrix(-stiffness), k, sp.csc_matrix(mass), sigma=sigma)[0])
    seconds = time.perf_counter() - start
    lines = run(program, "spectrum", path, k, "delaunay" if delaunay else "as-given")
    ours = np.array([float(x) for x in lines[1:] if x])
    mine = float(lines[0].split()[1])
    error = np.abs(ours - theirs).max() / theirs[-1]
    good = error <= (EIGENVALUES_DELAUNAY if delaunay else EIGENVALUES) and (not timed or mine <= RATIO * seconds)
    kind = "intrinsic Delaunay" if delaunay else "as given"
    print(
        f"{name:<12} {len(v):>7} {kind:<19} {k:>4} eigenvalues {error:>10.2e}"
        f"   {mine:>7.3f} s, SciPy {seconds:>7.3f} s, {seconds / mine:>5.2f} times{'' if good else '  FAILED'}"
    )
    return good


def wavelets(program, folder, name, graph):
    graph.compute_laplacian("combinatorial")
    graph.compute_fourier_basis()
    rng = np.random.default_rng(1)
    signal = rng.standard_normal(graph.N)
    w = sp.triu(graph.W, 1).tocoo()
    path = folder / "graph.txt"
    with open(path, "w") as out:
        out.writelines(f"{u} {v} {float(x)!r}\n" for u, v, x in zip(w.row, w.col, w.data))
        out.writelines(f"s {float(x)!r}\n" for x in signal)
    all_good = True
    for family in ("MexicanHat", "Abspline", "Itersine", "Meyer"):
        theirs = getattr(filters, family)(graph, 6).filter(signal, method="exact").T
        lines = run(program, "sgwt", path, family, 6, repr(float(graph.lmax)))
        ours = np.array([[float(x) for x in line.split()] for line in lines if line]).reshape(6, graph.N, 2)
        errors = [np.linalg.norm(ours[:, :, i] - theirs, axis=1).max() / np.linalg.norm(signal) for i in (0, 1)]
        good = max(errors) <= WAVELETS
        all_good &= good
        print(f"{name:<12} {graph.N:>7} {family:<19} exact {errors[0]:>9.2e}, polynomial {errors[1]:>9.2e}{'' if good else '  FAILED'}")
    return all_good


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", help="the program oracle_values of benches/helpers")
    parser.add_argument("--data", type=Path, help="folder with shapes and graphs")
    args = parser.parse_args()
    results = []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        v, f = grid_sphere(40)
        for delaunay in (False, True):
            results.append(spectrum(args.program, folder, "sphere", v, f, 50, delaunay, False))
        bunny = args.data / "paper/common-3d-test-models/stanford-bunny.obj" if args.data else Path("-")
        if bunny.is_file():
            v, f = igl.read_triangle_mesh(str(bunny))
            results.append(spectrum(args.program, folder, "bunny", v, f, 100, True, True))
            for k in (100, 300):
                results.append(spectrum(args.program, folder, "bunny", v, f, k, False, True))
        else:
            print("skipped: no paper/common-3d-test-models/stanford-bunny.obj in the data folder")
        folder_of_graphs = args.data / "benchmarks/pygsp" if args.data else Path("-")
        if folder_of_graphs.is_dir():
            points = scipy.io.loadmat(folder_of_graphs / "bunny.mat")["bunny"]
            results.append(wavelets(args.program, folder, "bunny", graphs.NNGraph(points, NNtype="radius", epsilon=0.2)))
            adjacency = scipy.io.loadmat(folder_of_graphs / "minnesota.mat")["A"]
            adjacency = sp.lil_matrix(adjacency)
            adjacency[348, 354] = adjacency[354, 348] = 1  # as PyGSP connects it
            adjacency = sp.csr_matrix(sp.csr_matrix(adjacency) > 0).astype(float)
            results.append(wavelets(args.program, folder, "minnesota", graphs.Graph(adjacency)))
        else:
            print("skipped: no benchmarks/pygsp in the data folder")
    print(f"{sum(results)} passed, {len(results) - sum(results)} failed")
    sys.exit(0 if all(results) else 1)


if __name__ == "__main__":
    main()
