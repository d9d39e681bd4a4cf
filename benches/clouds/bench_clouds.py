"""A laser scan processed by adwave's tiles and by other programs: seconds, points per second and peak memory.

python bench_clouds.py --adwave PROGRAM --work FOLDER [--points N]

Every task is a process of its own from file to file, or from file to arrays where the other program writes no LAZ; a program that is
missing or fails is listed with the reason. The file is that of `adwave sample terrain`.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

READ = """
import sys, laspy, numpy as np, open3d as o3d
cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(laspy.read(sys.argv[1]).xyz))
"""
OPEN3D = {
    "Open3D, outliers by 10 neighbors": "cloud.remove_statistical_outlier(10, 2.0)",
    "Open3D, normals by 10 neighbors": "cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(10))",
}
# Mean of the ten nearest: one step of smoothing, as one writes it by hand.
SCIPY = """
import sys, laspy, numpy as np
from scipy.spatial import cKDTree
points = laspy.read(sys.argv[1]).xyz
near = cKDTree(points).query(points, k=11, workers=-1)[1]
smooth = np.empty_like(points)
for rows in np.array_split(np.arange(len(points)), max(1, len(points) // 100_000)):
    smooth[rows] = points[near[rows]].mean(axis=1)
"""


def measured(words: list[str], folder: Path) -> tuple[float, float, str]:
    """Seconds, highest resident memory in bytes, and what went wrong."""
    environment = os.environ | {"QT_QPA_PLATFORM": "offscreen"}
    with open(folder / "said.txt", "w+b") as said:
        start = time.perf_counter()
        process = subprocess.Popen(words, cwd=folder, stdout=said, stderr=subprocess.STDOUT, env=environment)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        last = said.read().decode(errors="replace").strip().splitlines()[-1:] or ["it said nothing"]
    return seconds, usage.ru_maxrss * 1024, "" if process.returncode == 0 else f"ended with {process.returncode}: {last[0][:120]}"


def tasks(adwave: str, file: Path, folder: Path) -> dict[str, list[str]]:
    # CloudCompare as Debian packs it reads no LAZ.
    ply = file.with_suffix(".ply")
    gains = ["--gains=0,0,0,.5,1,1,1,1.2", "--magnitudes", "2,6"]
    found = {
        "adwave tiles, 8 bands, gains and two fields": [adwave, "tiles", str(file), "-o", str(folder / "tiles"), *gains],
        "the same, 1 GB of memory": [adwave, "tiles", str(file), "-o", str(folder / "tiles"), *gains, "--memory", "1G"],
    }
    if importlib.util.find_spec("laspy"):
        found["SciPy, mean of 10 neighbors, once"] = [sys.executable, "-c", SCIPY, str(file)]
        found |= {name: [sys.executable, "-c", READ + call, str(file)] for name, call in OPEN3D.items()}
    cloud_compare = ["CloudCompare", "-SILENT", "-AUTO_SAVE", "OFF", "-O", str(ply)]
    found["CloudCompare, outliers by 10 neighbors"] = [*cloud_compare, "-SOR", "10", "2"]
    found["CloudCompare, normals by its octree"] = [*cloud_compare, "-OCTREE_NORMALS", "auto"]
    for name, option in (("outlier", "mean_k"), ("normal", "knn")):
        words = ["pdal", "translate", str(file), str(folder / "pdal.las"), name, f"--filters.{name}.{option}=10"]
        found[f"PDAL, filters.{name}"] = words
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--adwave", required=True)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--points", type=float, default=1e7)
    args = parser.parse_args()
    folder = args.work.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    subprocess.run([args.adwave, "sample", "terrain", "--points", str(int(args.points)), "-o", folder / "flight"], check=True)
    (file,) = sorted((folder / "flight").glob("*.laz"))
    subprocess.run([args.adwave, "convert", file, "-o", file.with_suffix(".ply")], check=True)
    print("| task | seconds | points a second | memory |\n|---|---|---|---|")
    for name, words in tasks(args.adwave, file, folder).items():
        shutil.rmtree(folder / "tiles", ignore_errors=True)
        if shutil.which(words[0]) is None:
            print(f"| {name} | not installed | | |")
            continue
        seconds, memory, failure = measured(words, folder)
        if failure:
            print(f"| {name} | {failure} | | |", flush=True)
        else:
            print(f"| {name} | {seconds:.1f} | {args.points / seconds:,.0f} | {memory / 1e9:.2f} GB |", flush=True)


if __name__ == "__main__":
    main()
