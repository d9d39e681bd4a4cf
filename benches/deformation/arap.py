"""As-rigid-as-possible deformation by libigl and Open3D, on tests such as the four of the survey `botsch2008` and on one
larger mesh.

`python arap.py FOLDER OUT [ITERATIONS]` reads each NAME.off with NAME.sel and NAME.def below FOLDER and writes
OUT/NAME-libigl.off and OUT/NAME-open3d.off, which the example `survey` of adwave-deform measures; it prints the seconds of
the processor for all iterations, and until the stretch of the edges (rms) is within 2 % of its last. Open3D starts anew for
each number of iterations, so that its second time is that of the first of 25, 50, 100, … that comes near enough.
`limbs.py` makes more tests of any shapes. `python arap.py --time MESH.ply` times one iteration of libigl's with the ends
along y as handles. Needs `pip install libigl open3d numpy`, and libusb 1.0 of the
system for Open3D.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import igl
import numpy as np
import open3d

ITERATIONS = 1000
#: Iterations between two looks at the stretch.
AT_A_TIME = 25
#: Stretch relative to the last one from which on a result counts as found.
FOUND = 1.02
MOVED = 2


def read_off(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of an OFF file."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    n, m = map(int, lines[1].split()[:2])
    vertices = np.array([line.split()[:3] for line in lines[2 : 2 + n]], dtype=float)
    return vertices, np.array([line.split()[1:4] for line in lines[2 + n : 2 + n + m]], dtype=np.int64)


def numbers(path: Path) -> np.ndarray:
    """Numbers of a file without its comments."""
    words = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return np.array(" ".join(words).split(), dtype=float)


def write_off(path: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    """Write a mesh with all digits."""
    with path.open("w") as out:
        out.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        np.savetxt(out, vertices, fmt="%.17g")
        np.savetxt(out, np.column_stack([np.full(len(faces), 3), faces]), fmt="%d")


def stretch(vertices: np.ndarray, faces: np.ndarray, found: np.ndarray) -> float:
    """Root of the mean square of the relative change of the edges' lengths."""
    edges = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    before, after = (np.linalg.norm(p[edges[:, 0]] - p[edges[:, 1]], axis=1) for p in (vertices, found))
    return float(np.sqrt(np.mean((after / before - 1) ** 2)))


def bend(
    vertices: np.ndarray, faces: np.ndarray, handles: np.ndarray, targets: np.ndarray, iterations: int
) -> tuple[np.ndarray, float, list[tuple[float, float]]]:
    """The deformed vertices, the seconds of the processor for preparation, and seconds and stretch as they go on."""
    data = igl.ARAPData()
    data.max_iter = min(iterations, AT_A_TIME)
    start = time.process_time()
    igl.arap_precomputation(vertices, faces, 3, handles.astype(np.int32), data)
    prepared = spent = time.process_time() - start
    found, course = vertices.copy(), []
    for _ in range(-(-iterations // data.max_iter)):
        start = time.process_time()
        found = igl.arap_solve(targets, data, found)
        spent += time.process_time() - start
        course.append((spent, stretch(vertices, faces, found)))
    return found, prepared, course


def bend_by_open3d(
    vertices: np.ndarray, faces: np.ndarray, handles: np.ndarray, targets: np.ndarray, iterations: int
) -> tuple[np.ndarray, list[tuple[float, float]]]:
    """The deformed vertices, and seconds of the processor and stretch for growing numbers of iterations."""
    mesh = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(vertices), open3d.utility.Vector3iVector(faces.astype(np.int32))
    )
    held = open3d.utility.IntVector(handles.astype(np.int32))
    to, course = open3d.utility.Vector3dVector(targets), []
    counts = [AT_A_TIME * 2**k for k in range(20) if AT_A_TIME * 2**k < iterations]
    for count in [*counts, iterations]:
        start = time.process_time()
        found = np.asarray(mesh.deform_as_rigid_as_possible(held, to, max_iter=count).vertices)
        course.append((time.process_time() - start, stretch(vertices, faces, found)))
    return found, course


def survey(folder: Path, out: Path, iterations: int) -> None:
    """Bend the shapes of a folder of tests."""
    for selection in sorted(folder.glob("*.sel")):
        name = selection.stem
        vertices, faces = read_off(folder / f"{name}.off")
        state = numbers(selection)
        matrix = numbers(folder / f"{name}.def").reshape(4, 4)
        handles = np.flatnonzero(state != 1)
        targets = vertices[handles].copy()
        moved = state[handles] == MOVED
        targets[moved] = targets[moved] @ matrix[:3, :3].T + matrix[:3, 3]
        by_libigl, _, course = bend(vertices, faces, handles, targets, iterations)
        by_open3d, other_course = bend_by_open3d(vertices, faces, handles, targets, iterations)
        for program, found, spent in (("libigl", by_libigl, course), ("open3d", by_open3d, other_course)):
            seconds, last = spent[-1]
            soon = next(so_far for so_far, value in spent if value <= FOUND * last)
            said = f"stretch {last:.4f} after {seconds:.2f} s, within 2 % of it after {soon:.2f} s"
            print(f"{name}, {program}: {said}", flush=True)
            write_off(out / f"{name}-{program}.off", found, faces)


def timing(path: Path) -> None:
    """Time iterations on a mesh whose tenth at either end along y is a handle."""
    vertices, faces = igl.read_triangle_mesh(str(path))
    low, high = np.quantile(vertices[:, 1], [0.1, 0.9])
    handles = np.flatnonzero((vertices[:, 1] < low) | (vertices[:, 1] > high))
    targets = vertices[handles] + [0.1, 0, 0] * (vertices[handles][:, 1:2] > high)
    for count in (1, 4):
        _, prepared, course = bend(vertices, faces.astype(np.int64), handles, targets, count)
        solved = course[-1][0] - prepared
        print(f"{len(vertices)} vertices: prepared in {prepared:.2f} s, {1000 * solved / count:.0f} ms an iteration")


if __name__ == "__main__":
    if sys.argv[1] == "--time":
        timing(Path(sys.argv[2]))
    else:
        survey(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else ITERATIONS)  # noqa: PLR2004
