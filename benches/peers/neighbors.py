"""Time of the nearest neighbors of a cloud, compared with the trees of SciPy and Open3D.

    python -m pip install numpy scipy open3d
    cargo build --release -p adwave-bench-helpers --bin neighbor_time
    python benches/peers/neighbors.py --points 1e6 1e7

The cloud is a terrain as from a flight: hills, noise of a few centimeters, one point in seven up to 15 m above the ground, in no
order. Everybody finds the ten nearest of each point with both cores, its tree or order included; the sum of the distances to the
tenth must be the same. adwave also finds those that are tied with the tenth.
"""

import argparse
import json
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import open3d as o3d
from scipy.spatial import cKDTree

NEIGHBORS = 10
# Sums of as many distances in another order.
ROUNDING = 1e-9


def terrain(n: int) -> np.ndarray:
    """So many points, 2.5 on a square meter."""
    random = np.random.default_rng(1)
    x, y = 2000 * np.sqrt(n / 1e7) * random.random((2, n))
    z = 20 * np.sin(x / 70) * np.cos(y / 90) + random.normal(0, 0.05, n)
    z += np.where(random.random(n) < 0.15, 15 * random.random(n), 0)
    return np.column_stack([x, y, z])


def write_ply(points: np.ndarray, path: Path) -> None:
    axes = "".join(f"property double {axis}\n" for axis in "xyz")
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{axes}end_header\n"
    path.write_bytes(head.encode() + points.astype("<f8").tobytes())


def by_scipy(points: np.ndarray, **options: bool) -> tuple[float, float]:
    start = time.perf_counter()
    distances, _ = cKDTree(points, **options).query(points, NEIGHBORS + 1, workers=-1)
    return time.perf_counter() - start, distances[:, NEIGHBORS].sum()


def by_open3d(points: np.ndarray) -> tuple[float, float]:
    start = time.perf_counter()
    tensor = o3d.core.Tensor(points)
    search = o3d.core.nns.NearestNeighborSearch(tensor)
    search.knn_index()
    _, squares = search.knn_search(tensor, NEIGHBORS + 1)
    return time.perf_counter() - start, np.sqrt(squares.numpy()[:, NEIGHBORS]).sum()


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--points", type=float, nargs="+", default=[1e6, 1e7])
    arguments.add_argument("--program", type=Path, default=Path("target/release/neighbor_time"))
    given = arguments.parse_args()
    print("| points | adwave | SciPy `cKDTree` | the same, not balanced | Open3D | fastest peer / adwave |")
    print("|---|---|---|---|---|---|")
    for n in map(int, given.points):
        points = terrain(n)
        with tempfile.TemporaryDirectory() as folder:
            cloud = Path(folder) / "cloud.ply"
            write_ply(points, cloud)
            command = [given.program, cloud, str(NEIGHBORS), "3"]
            ours = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
        seconds = sorted(ours["seconds"])[1]
        peers = [by_scipy(points), by_scipy(points, balanced_tree=False, compact_nodes=False), by_open3d(points)]
        for _, radii in peers:
            assert abs(radii / ours["radii"] - 1) < ROUNDING, (radii, ours["radii"])
        shown = " | ".join(f"{taken:.2f} s" for taken in [seconds, *(taken for taken, _ in peers)])
        print(f"| {n:,} | {shown} | {min(taken for taken, _ in peers) / seconds:.1f} |", flush=True)


if __name__ == "__main__":
    main()
