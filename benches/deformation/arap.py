"""As-rigid-as-possible deformation by libigl, on the four tests of the survey `botsch2008` and on one larger mesh.

`python arap.py FOLDER OUT [ITERATIONS]` reads NAME.off, NAME.sel and NAME.def below FOLDER and writes OUT/NAME-arap.off, which the
example `survey` of adwave-deform measures. `python arap.py --time MESH.ply` times one iteration with the ends along y as
handles. Needs `pip install libigl numpy`.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import igl
import numpy as np

NAMES = ("plane", "cylinder", "bar", "cactus")
#: The plane converges sooner, and an iteration takes longer.
PLANE_ITERATIONS = 100
ITERATIONS = 1000
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


def bend(
    vertices: np.ndarray, faces: np.ndarray, handles: np.ndarray, targets: np.ndarray, iterations: int
) -> tuple[np.ndarray, float, float]:
    """The deformed vertices, and the seconds of the processor for preparation and for all iterations."""
    data = igl.ARAPData()
    data.max_iter = iterations
    start = time.process_time()
    igl.arap_precomputation(vertices, faces, 3, handles.astype(np.int32), data)
    prepared = time.process_time()
    found = igl.arap_solve(targets, data, vertices.copy())
    return found, prepared - start, time.process_time() - prepared


def survey(folder: Path, out: Path, iterations: int) -> None:
    """Bend the shapes of the survey."""
    for name in NAMES:
        vertices, faces = read_off(folder / f"{name}.off")
        state = numbers(folder / f"{name}.sel")
        matrix = numbers(folder / f"{name}.def").reshape(4, 4)
        handles = np.flatnonzero(state != 1)
        targets = vertices[handles].copy()
        moved = state[handles] == MOVED
        targets[moved] = targets[moved] @ matrix[:3, :3].T + matrix[:3, 3]
        count = PLANE_ITERATIONS if name == "plane" else iterations
        found, prepared, solved = bend(vertices, faces, handles, targets, count)
        print(f"{name}: prepared in {prepared:.2f} s, {1000 * solved / count:.1f} ms an iteration", flush=True)
        write_off(out / f"{name}-arap.off", found, faces)


def timing(path: Path) -> None:
    """Time iterations on a mesh whose tenth at either end along y is a handle."""
    vertices, faces = igl.read_triangle_mesh(str(path))
    low, high = np.quantile(vertices[:, 1], [0.1, 0.9])
    handles = np.flatnonzero((vertices[:, 1] < low) | (vertices[:, 1] > high))
    targets = vertices[handles] + [0.1, 0, 0] * (vertices[handles][:, 1:2] > high)
    for count in (1, 4):
        _, prepared, solved = bend(vertices, faces.astype(np.int64), handles, targets, count)
        print(f"{len(vertices)} vertices: prepared in {prepared:.2f} s, {1000 * solved / count:.0f} ms an iteration")


if __name__ == "__main__":
    if sys.argv[1] == "--time":
        timing(Path(sys.argv[2]))
    else:
        survey(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else ITERATIONS)  # noqa: PLR2004
