"""Bands computed by SciPy from the definitions, and the differences of adwave from them.

Run by `cargo xtask oracle`. Nothing here shares code with adwave: faces are read by meshio, neighbors found by SciPy's
tree, products done by SciPy's sparse matrices.

    S_f(j) = Phi^(2^(j-1)) f,  W_f(j) = S_f(j-1) - S_f(j),  Phi = rows of T divided by their sum
    T(x,y) = A(y) exp(-|x-y|^2 / 4t),  T(x,x) = sum of the rest of the row,  t = E^2 / 2
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import meshio
import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

# Agreement asked for, in units of the bounding box's diagonal.
TOLERANCE = 1e-10
LEVELS = 8
# Distances closer than this part are ties: see `nearest_neighbors`.
TIE = 1e-9
MOST_TIED = 54


def weld(points):
    """Index of the welded vertex of each point, and the welded positions."""
    positions, index = np.unique(points + 0.0, axis=0, return_inverse=True)
    return index.reshape(-1), positions


def triangles_of(cells, index):
    """Triangles of the welded mesh: fans, with the corners of degenerate ones kept."""
    out = []
    for block in cells:
        corners = index[np.asarray(block.data)]
        for k in range(2, corners.shape[1]):
            out.append(corners[:, [0, k - 1, k]])
    return np.concatenate(out) if out else np.zeros((0, 3), int)


def mesh_operator(positions, triangles):
    """Neighbor pairs, areas and mean edge length of a mesh."""
    n = len(positions)
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    areas = np.zeros(n)
    for k in range(3):
        np.add.at(areas, triangles[:, k], area / 3)
    i = np.concatenate([triangles[:, k] for k in (0, 1, 2)])
    j = np.concatenate([triangles[:, k] for k in (1, 2, 0)])
    edges = np.unique(np.sort(np.stack([i, j], 1), axis=1), axis=0)
    edges = edges[edges[:, 0] != edges[:, 1]]
    length = np.linalg.norm(positions[edges[:, 0]] - positions[edges[:, 1]], axis=1).mean() if len(edges) else 0.0
    pairs = np.concatenate([edges, edges[:, ::-1]])
    return pairs, areas, length


def cloud_operator(positions, directed, k=10):
    """Neighbor pairs, areas and mean distance of a cloud: the 10 nearest, with all at the distance of the tenth."""
    n = len(positions)
    k = min(k, n - 1)
    near = min(n, k + 1 + MOST_TIED)
    distances, indices = cKDTree(positions).query(positions, k=near)
    own = np.arange(n)[:, None]
    other = indices != own
    rank = np.cumsum(other, axis=1)
    radius = np.where(other & (rank == k), distances, 0).max(axis=1)
    kept = other & (distances <= radius[:, None] * (1 + TIE)) & (rank <= k + MOST_TIED)
    pairs = np.stack([np.broadcast_to(own, indices.shape)[kept], indices[kept]], 1)
    length = distances[kept].mean()
    if not directed:
        pairs = np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)
    return pairs, np.pi * radius**2 / k, length


def diffusion(positions, pairs, areas, length):
    n = len(positions)
    d2 = ((positions[pairs[:, 0]] - positions[pairs[:, 1]]) ** 2).sum(axis=1)
    lowest = np.full(n, np.inf)
    has_area = areas[pairs[:, 1]] > 0
    np.minimum.at(lowest, pairs[has_area, 0], d2[has_area])
    shift = np.where(np.isfinite(lowest), lowest, 0)[pairs[:, 0]]
    values = areas[pairs[:, 1]] * np.exp(-np.maximum(d2 - shift, 0) / (2 * length**2))
    off = sp.csr_matrix((values, (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    sums = np.asarray(off.sum(axis=1)).ravel()
    t = off + sp.diags(np.where(sums > 0, sums, 1.0))
    return sp.diags(1 / np.asarray(t.sum(axis=1)).ravel()) @ t


def transform(adwave, path, directed, as_cloud):
    """Arrays of all levels as the program computes them."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "bands.npz"
        command = [adwave, "transform", str(path), "-o", str(out), "--levels", str(LEVELS), "--quiet"]
        command += ["--directed"] if directed else []
        command += ["--as", "cloud"] if as_cloud else []
        subprocess.run(command, check=True)
        return {name: array for name, array in np.load(out).items()}


def compare(adwave, path, directed, as_cloud):
    """Largest difference of any S and any W, in diagonals."""
    bands = transform(adwave, path, directed, as_cloud)
    if as_cloud:
        # Normals of a file keep neighbors off the other side of a thin wall; here positions alone choose them.
        with tempfile.TemporaryDirectory() as folder:
            positions_alone = Path(folder) / "points.xyz"
            np.savetxt(positions_alone, bands["points"], fmt="%.17g")
            bands = transform(adwave, positions_alone, directed, as_cloud)
    points = bands["points"]
    index, positions = weld(points)
    cells = [] if as_cloud else read_faces(path)
    if cells:
        operator = mesh_operator(positions, triangles_of(cells, index))
    else:
        operator = cloud_operator(positions, directed)
    phi = diffusion(positions, *operator)
    diagonal = np.linalg.norm(points.max(axis=0) - points.min(axis=0))
    smooth, steps = positions.copy(), 0
    worst_s = np.abs(bands["scaling"][0] - points).max()
    worst_w, before = 0.0, points
    for j in range(1, LEVELS + 1):
        while steps < 2 ** (j - 1):
            smooth, steps = phi @ smooth, steps + 1
        level = smooth[index]
        worst_s = max(worst_s, np.abs(bands["scaling"][j] - level).max())
        worst_w = max(worst_w, np.abs(bands["wavelet"][j - 1] - (before - level)).max())
        before = level
    return len(points), worst_s / diagonal, worst_w / diagonal


def read_faces(path):
    if path.suffix not in {".obj", ".ply", ".off"}:
        return []
    if path.suffix in {".obj", ".off"}:
        return list(faces_of_text(path))
    return [c for c in meshio.read(path).cells if c.type in {"triangle", "quad", "polygon"}]


class Block:
    def __init__(self, data):
        self.data = data


def faces_of_text(path):
    """Faces of an OBJ or OFF file, which meshio does not read when they have attributes."""
    faces = {}
    lines = path.read_text(errors="replace").splitlines()
    if path.suffix == ".obj":
        for line in lines:
            if line.startswith("f "):
                corners = [int(c.split("/")[0]) - 1 for c in line.split()[1:]]
                faces.setdefault(len(corners), []).append(corners)
    else:
        words = [line.split() for line in lines if line.strip() and not line.startswith("#")]
        n_points, n_faces = int(words[1][0]), int(words[1][1])
        for row in words[2 + n_points : 2 + n_points + n_faces]:
            faces.setdefault(int(row[0]), []).append([int(c) for c in row[1 : 1 + int(row[0])]])
    for corners in faces.values():
        yield Block(np.array(corners))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("adwave", help="the program")
    parser.add_argument("samples", type=Path, help="folder with shapes that the program made itself")
    parser.add_argument("--data", type=Path, help="folder with further shapes")
    args = parser.parse_args()
    shapes = [(p, False, False) for p in sorted(args.samples.iterdir())]
    shapes += [(args.samples / "torus.ply", directed, True) for directed in (False, True)]
    if args.data and args.data.is_dir():
        found = sorted(args.data.glob("paper/**/*.obj")) + sorted(args.data.glob("paper/**/*.ply"))
        found += sorted(args.data.glob("paper/**/*.off")) + [args.data / "fields/spot-textured/spot.obj"]
        shapes += [(p, False, False) for p in found]
        clouds = [p for p in sorted(args.data.glob("pointclouds/**/*")) if p.is_file()]
        shapes += [(p, directed, True) for p in clouds for directed in (False, True)]
    else:
        print("no folder with further shapes: only the built-in ones are compared")
    failed = 0
    print(f"{'shape':<28} {'kind':<16} {'vertices':>8}  {'S, diagonals':>13}  {'W, diagonals':>13}")
    for path, directed, as_cloud in shapes:
        n, s, w = compare(args.adwave, path, directed, as_cloud)
        kind = ("directed cloud" if directed else "cloud") if as_cloud else "mesh"
        good = s <= TOLERANCE and w <= TOLERANCE
        failed += not good
        print(f"{path.name:<28} {kind:<16} {n:>8}  {s:>13.2e}  {w:>13.2e}{'' if good else '  FAILED'}")
    print(f"{len(shapes) - failed} passed, {failed} failed")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
