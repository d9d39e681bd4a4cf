"""Pairs of scans of one object, aligned by `adwave match` and by Open3D, whose usual recipe is RANSAC on FPFH features of
thinned clouds, then ICP from point to plane on all points.

A scan is what is left of a sample's vertices on one side of a plane; its noise and its vertices are its own. The second is
turned and moved at random. A pair counts as aligned if the rotation is found to a degree and the middle of the overlap to
one percent of the diagonal.
"""

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

POINTS = 500_000
# Samples, and pairs of each.
SAMPLES = {"creature": 2}
# Share of an object that each scan has.
SEEN = 0.7
# Noise of the points in mean edge lengths.
NOISE = 0.2
MOST_DEGREES, MOST_SHIFT = 1.0, 0.01
# Edges of the voxels that Open3D thins by, in diagonals; each is a row of the table.
VOXELS = (0.01, 0.02)

HEAD = ["two scans of a", "program", "seconds", "aligned"]
TEXT = (
    f"Pairs of scans of {POINTS:,} points, each with {SEEN:.0%} of a built-in shape, noise of {NOISE} mean edges and a "
    f"motion at random; aligned means within {MOST_DEGREES:g}° and {MOST_SHIFT:.0%} of the diagonal. Medians of the "
    "pairs, reading included. Open3D runs its usual recipe: voxels, normals, FPFH features, RANSAC, and ICP from point "
    "to plane on all points.")


def write_cloud(path, points):
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
    header += "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    path.write_bytes(header.encode() + points.astype("<f4").tobytes())


def rotation(generator):
    """A random rotation matrix."""
    q, r = np.linalg.qr(generator.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q * np.sign(np.linalg.det(q))


def make_pair(run, adwave, folder, sample, number):
    """Writes two scans and returns their paths, the motion from the first to the second, and the overlap's middle."""
    generator = np.random.default_rng([number, len(sample)])
    direction = rotation(generator)[0]
    true, paths, overlap, whole = np.eye(4), [], [], folder / "whole.ply"
    true[:3, :3], true[:3, 3] = rotation(generator), generator.normal(size=3)
    for k in range(2):
        run([adwave, "sample", sample, "--vertices", int(POINTS / SEEN) + 777 * k, "--noise", NOISE, "--seed",
             2 * number + k, "--as", "cloud", "-o", whole, "--quiet"])
        points = read_cloud(whole)
        along = points @ direction
        low, high = np.quantile(along, [1 - SEEN, SEEN])
        overlap.append(points[(along > low) & (along < high)].mean(axis=0))
        points = generator.permutation(points[along < high] if k == 0 else points[along > low])
        paths.append(folder / f"{sample}-{number}-{k}.ply")
        write_cloud(paths[k], points if k == 0 else points @ true[:3, :3].T + true[:3, 3])
    return paths, true, overlap[0], float(np.linalg.norm(np.ptp(points, axis=0)))


def read_cloud(path):
    """Positions of a binary PLY whose vertices begin with x, y and z."""
    import vtk
    from vtk.util import numpy_support

    reader = vtk.vtkPLYReader()
    reader.SetFileName(str(path))
    reader.Update()
    return numpy_support.vtk_to_numpy(reader.GetOutput().GetPoints().GetData()).astype(float)


def by_open3d(first, second, voxel):
    """Seconds and the motion found by Open3D, reading included."""
    import open3d as o3d

    o3d.utility.set_verbosity_level(o3d.utility.VerbosityLevel.Error)
    o3d.utility.random.seed(1)
    start = time.perf_counter()
    clouds = [o3d.io.read_point_cloud(str(path)) for path in (first, second)]
    extent = np.linalg.norm(clouds[0].get_max_bound() - clouds[0].get_min_bound())
    v, pipelines, near = voxel * extent, o3d.pipelines.registration, o3d.geometry.KDTreeSearchParamHybrid
    thinned = [cloud.voxel_down_sample(v) for cloud in clouds]
    for cloud in thinned:
        cloud.estimate_normals(near(2 * v, 30))
    features = [pipelines.compute_fpfh_feature(cloud, near(5 * v, 100)) for cloud in thinned]
    found = pipelines.registration_ransac_based_on_feature_matching(
        *thinned, *features, True, 1.5 * v, pipelines.TransformationEstimationPointToPoint(False), 3,
        [pipelines.CorrespondenceCheckerBasedOnEdgeLength(0.9), pipelines.CorrespondenceCheckerBasedOnDistance(1.5 * v)],
        pipelines.RANSACConvergenceCriteria(100_000, 0.999))
    clouds[1].estimate_normals(near(v, 30))
    found = pipelines.registration_icp(
        *clouds, 0.4 * v, found.transformation, pipelines.TransformationEstimationPointToPlane())
    return time.perf_counter() - start, found.transformation


def by_adwave(adwave, first, second):
    """Seconds of the command and the motion that it reports; `None` if it reports none."""
    start = time.perf_counter()
    done = subprocess.run([adwave, "match", first, second, "--json"], capture_output=True, text=True)
    seconds = time.perf_counter() - start
    if done.returncode:
        raise SystemExit(f"adwave match ended with {done.returncode}: {done.stderr.strip()}")
    motion = json.loads(done.stdout)["motion"]
    return seconds, motion and np.array(motion["matrix"])


def is_right(found, true, middle, extent):
    """Whether a motion is the true one, but for less than the allowed errors."""
    if found is None:
        return False
    found = np.asarray(found, dtype=float)
    turned = found[:3, :3] @ true[:3, :3].T
    angle = np.degrees(np.arccos(np.clip((np.trace(turned) - 1) / 2, -1, 1)))
    shift = np.linalg.norm((found - true)[:3] @ [*middle, 1])
    return bool(angle <= MOST_DEGREES and shift <= MOST_SHIFT * extent)


def measure(run, adwave, folder):
    """Rows of sample, program, medians of seconds, and how many pairs were aligned."""
    rows = []
    for sample, n_pairs in SAMPLES.items():
        found = {"`adwave match`": [], **{f"Open3D, voxels of {v:.0%} of the diagonal": [] for v in VOXELS}}
        for number in range(n_pairs):
            (first, second), true, middle, extent = make_pair(run, adwave, folder, sample, number)
            results = [by_adwave(adwave, first, second)]
            for voxel in VOXELS:
                told = json.loads(run([sys.executable, __file__, first, second, voxel]).splitlines()[-1])
                results.append((told["seconds"], told["motion"]))
            for name, (seconds, motion) in zip(found, results):
                found[name].append((seconds, is_right(motion, true, middle, extent)))
                print(f"  {sample} {number}, {name}: {seconds:.1f} s, right: {found[name][-1][1]}", flush=True)
        for name, tries in found.items():
            n_right = sum(right for _, right in tries)
            rows.append([sample, name, f"{np.median([s for s, _ in tries]):.1f}", f"{n_right} of {n_pairs}"])
    return rows


if __name__ == "__main__":
    seconds, motion = by_open3d(Path(sys.argv[1]), Path(sys.argv[2]), float(sys.argv[3]))
    print(json.dumps({"seconds": seconds, "motion": motion.tolist()}))
