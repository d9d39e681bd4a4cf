"""Lines that people of several fields typed from memory, before they read a page: each runs, or its message has one that does.

`lines_from_memory.txt` was written before the code was read, and was not looked at while messages were improved.
"""

from __future__ import annotations

import linecache
import os
import sys
import warnings
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import adwave as aw
import numpy as np
import pytest

LINES = Path(__file__).with_suffix("").with_name("lines_from_memory.txt")
#: Share of the lines that run or lead to one that runs in one step.
LEAST = 0.9
RANDOM = np.random.default_rng(0)


def objects() -> dict[str, Any]:
    """The names that the lines use, each with an object of its library."""
    nibabel, networkx = pytest.importorskip("nibabel"), pytest.importorskip("networkx")
    pyvista, trimesh = pytest.importorskip("pyvista"), pytest.importorskip("trimesh")
    pandas, sparse = pytest.importorskip("pandas"), pytest.importorskip("scipy.sparse")
    xarray = pytest.importorskip("xarray")
    sphere = trimesh.creation.icosphere(3)
    F, n = np.array(sphere.faces), len(sphere.vertices)
    V = np.array(sphere.vertices) * (1 + 0.03 * RANDOM.normal(size=(n, 1)))
    f = V[:, 2] + 0.1 * RANDOM.normal(size=n)
    mesh = trimesh.Trimesh(V, F, process=False)
    mesh.export("bunny.obj")
    poly = pyvista.wrap(mesh)
    poly["elevation"] = f
    G = networkx.random_geometric_graph(n, 0.1, seed=1)
    networkx.set_node_attributes(G, dict(enumerate(f.tolist())), "value")
    DG = networkx.gnp_random_graph(n, 0.02, seed=1, directed=True)
    DG.add_edges_from((i, (i + 1) % n) for i in range(n))
    W = sparse.csr_array(networkx.to_scipy_sparse_array(G, weight=None)).astype(float)
    vol = RANDOM.normal(size=(24, 20, 16)).astype(np.float32)
    mask = np.ones(vol.shape, bool)
    mask[:3] = False
    t1 = nibabel.Nifti1Image(vol, np.diag([1.0, 1, 2, 1]))
    image = RANDOM.normal(size=(48, 64))
    da = xarray.DataArray(image, dims=("y", "x"), coords={"y": np.arange(48.0), "x": np.arange(64.0)})
    X = RANDOM.normal(size=(200, 10))
    return {
        **{"np": np, "aw": aw, "V": V, "F": F, "f": f, "f32": f.astype(np.float32), "mesh": mesh, "poly": poly},
        **{"pcd": open3d_cloud(V), "G": G, "DG": DG, "W": W, "A": W.toarray(), "X": X, "img": t1, "t1": t1, "da": da},
        **{"labels": RANDOM.integers(0, 3, 200), "vol": vol, "image": image, "mask": mask, "DEM": image.copy()},
        **{
            "fmri": RANDOM.normal(size=(n, 12)),
            "lh": (V, F),
            "rh": (V + 3, F),
            "adata": annotated(networkx, sparse, pandas),
        },
    }


class PointCloud:
    """A stand-in for a cloud of Open3D, which is too large to install."""

    __module__ = "open3d.cpu.pybind.geometry"

    def __init__(self, other: PointCloud | None = None) -> None:
        if other is not None:
            vars(self).update(vars(other))


def open3d_cloud(points: np.ndarray) -> Any:
    """A stand-in for a cloud of Open3D with these points."""
    module = ModuleType("open3d")
    module.utility = SimpleNamespace(Vector3dVector=lambda values=(): np.array(values))  # type: ignore[attr-defined]
    sys.modules.setdefault("open3d", module)
    cloud = PointCloud()
    cloud.points, cloud.colors, cloud.normals = points, np.empty((0, 3)), np.empty((0, 3))  # type: ignore[attr-defined]
    return cloud


def annotated(networkx: Any, sparse: Any, pandas: Any) -> Any:
    """A stand-in for an AnnData of 200 cells with neighbors."""
    cells = type("AnnData", (), {"__module__": "anndata._core.anndata"})()
    cells.X = RANDOM.poisson(3, (200, 12)).astype(float)
    cells.layers, cells.n_obs, cells.var_names = {"counts": cells.X}, 200, [str(i) for i in range(12)]
    graph = networkx.random_geometric_graph(200, 0.2, seed=2)
    weights = networkx.to_scipy_sparse_array(graph, weight=None)
    cells.obsp = {"connectivities": sparse.csr_matrix(weights).astype(float)}
    cells.obsm = {"X_pca": RANDOM.normal(size=(200, 8))}
    cells.obs = pandas.DataFrame({"n": np.arange(200.0)})
    return cells


def run(line: str, name: str) -> None:
    """Run a line as a notebook does, which keeps its text."""
    linecache.cache[name] = (len(line), None, [f"{line}\n"], name)
    exec(compile(line, name, "exec"), {**objects(), "__name__": "__main__"})


def outcome(line: str, number: int) -> str:
    """``'runs'``, ``'leads'`` to the line in the message, which runs, or what went wrong."""
    try:
        run(line, f"<line {number}>")
        return "runs"
    except Exception as error:
        message = f"{type(error).__name__}: {error}"
    if "write " not in message:
        return message
    try:
        run(message.rpartition("write ")[2], f"<line in the message {number}>")
        return "leads"
    except Exception as error:
        return f"{message} -> {type(error).__name__}: {error}"


def test_lines_from_memory_run_or_lead_to_one_that_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(os.environ, "BROWSER", "true")
    lines = [line.split(" | ", 1)[1] for line in LINES.read_text(encoding="utf-8").splitlines() if line]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = {line: outcome(line, i) for i, line in enumerate(lines)}
    failed = {line: why for line, why in found.items() if why not in ("runs", "leads")}
    assert len(lines) > 100 and len(failed) <= (1 - LEAST) * len(lines), failed
