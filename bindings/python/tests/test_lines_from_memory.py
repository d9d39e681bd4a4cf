"""Lines that people of several fields typed from memory, before they read a page: each runs, or its message has one that does.

`lines_from_memory.txt` was written before the code was read, and was not looked at while messages were improved. The lines
of `lines_of_libraries.txt` were written before the messages that they lead to, which were improved by them.
"""

from __future__ import annotations

import linecache
import os
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import adwave as aw
import numpy as np
import pytest
from stand_ins import AnnData, Graph, Tensor, fake_open3d, fake_torch, open3d_cloud, open3d_mesh, torch_graph

FOLDER = Path(__file__).parent
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


def annotated(networkx: Any, sparse: Any, pandas: Any) -> Any:
    """A stand-in for an AnnData of 200 cells with neighbors."""
    counts = RANDOM.poisson(3, (200, 12)).astype(float)
    graph = networkx.random_geometric_graph(200, 0.2, seed=2)
    weights = networkx.to_scipy_sparse_array(graph, weight=None)
    return AnnData(
        counts=counts,
        layers={"counts": counts},
        var_names=[str(i) for i in range(12)],
        obsp={"connectivities": sparse.csr_matrix(weights).astype(float)},
        obsm={"X_pca": RANDOM.normal(size=(200, 8))},
        obs=pandas.DataFrame({"n": np.arange(200.0), "score": RANDOM.normal(size=200)}),
    )


def further_objects(names: dict[str, Any]) -> dict[str, Any]:
    """The names of the lines by library: images of PyVista, graphs of igraph, tensors, data frames, files."""
    nibabel, pyvista = pytest.importorskip("nibabel"), pytest.importorskip("pyvista")
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("adwave.pyvista")
    V, F, f, poly, G = (names[name] for name in ("V", "F", "f", "poly", "G"))
    poly["temp"], poly.cell_data["q"] = f, RANDOM.normal(size=poly.n_cells)
    ct = pyvista.ImageData(dimensions=(9, 10, 11), spacing=(1, 1, 2))
    ct["ct"] = RANDOM.normal(size=ct.n_points)
    ug = pyvista.ImageData(dimensions=(6, 7, 8)).cast_to_unstructured_grid()
    ug["temp"] = RANDOM.normal(size=ug.n_points)
    hills = pyvista.ParametricRandomHills()
    hills["h"] = RANDOM.normal(size=hills.n_points)
    df = pandas.DataFrame(V, columns=["x", "y", "z"]).assign(height=f)
    data = torch_graph(x=RANDOM.normal(size=(len(V), 4)), pos=V, edge_index=np.array(list(G.edges)).T)
    nibabel.save(names["t1"], "t1.nii.gz")
    names["mesh"].export("bunny.ply")
    np.save("f.npy", f)
    lattice = names["da"].rename(y="lat", x="lon").rename("t2m")
    return {
        **{"ct": ct, "ug": ug, "hills": hills, "om": open3d_mesh(V, F), "g": Graph(len(V), list(G.edges)), "x": f},
        **{"df": df, "xyz": V, "data": data, "edge_index": data.edge_index, "ds": lattice.to_dataset(), "Path": Path},
        **{"bands": aw.decompose(poly, f, levels=3), "pv": pyvista, "tV": Tensor(V), "tF": Tensor(F), "tf": Tensor(f)},
    }


def run(line: str, name: str, names: dict[str, Any]) -> None:
    """Run a line as a notebook does, which keeps its text."""
    linecache.cache[name] = (len(line), None, [f"{line}\n"], name)
    exec(compile(line, name, "exec"), {**names, "__name__": "__main__"})


def outcome(line: str, number: int, names: Callable[[], dict[str, Any]]) -> str:
    """``'runs'``, ``'leads'`` to the line in the message, which runs, or what went wrong."""
    try:
        run(line, f"<line {number}>", names())
        return "runs"
    except Exception as error:
        message = f"{type(error).__name__}: {error}"
    if "write " not in message:
        return message
    try:
        run(message.rpartition("write ")[2], f"<line in the message {number}>", names())
        return "leads"
    except Exception as error:
        return f"{message} -> {type(error).__name__}: {error}"


def all_objects() -> dict[str, Any]:
    names = objects()
    return {**names, **further_objects(names)}


@pytest.mark.parametrize(
    ("file", "names"), [("lines_from_memory.txt", objects), ("lines_of_libraries.txt", all_objects)]
)
def test_lines_from_memory_run_or_lead_to_one_that_does(
    file: str, names: Callable[[], dict[str, Any]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(os.environ, "BROWSER", "true")
    for module in (fake_open3d(), fake_torch()):
        monkeypatch.setitem(sys.modules, module.__name__, module)
    lines = [line.split(" | ", 1)[1] for line in (FOLDER / file).read_text(encoding="utf-8").splitlines() if line]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # Nothing is changed in place, so one object of each kind does for all lines.
        own = names()
        found = {line: outcome(line, i, lambda: dict(own)) for i, line in enumerate(lines)}
    failed = {line: why for line, why in found.items() if why not in ("runs", "leads")}
    assert len(lines) > 80 and len(failed) <= (1 - LEAST) * len(lines), failed


@pytest.mark.parametrize(
    ("line", "works"),
    [
        ("aw.impute(X, k=5, t=3)", "aw.impute(X, aw.point_walk(X, neighbors=5), steps=3)"),
        ("aw.smooth((V, F), f, n_iter=10)", "aw.smooth((V, F), f, steps=10)"),
        ("aw.smooth(V, F, f, fwhm=0.2)", "aw.smooth((V, F), f, fwhm=0.2)"),
    ],
)
def test_the_line_has_the_names_of_the_caller_where_no_text_is_kept(line: str, works: str) -> None:
    sphere = aw.sample("sphere", vertices=200)
    V, F = np.array(sphere.points), np.array(sphere.faces, dtype=np.int64)
    names: dict[str, Any] = {"aw": aw, "V": V, "F": F, "f": V[:, 2].copy(), "X": RANDOM.poisson(3, (60, 8))}
    # A shell before Python 3.13: there is no file and no text of this name.
    with pytest.raises(TypeError) as caught:
        exec(compile(line, "<no text>", "exec"), names)
    assert str(caught.value).rpartition("write ")[2] == works
    exec(compile(works, "<no text>", "exec"), names)
