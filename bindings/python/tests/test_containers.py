"""Containers of people's own: dictionaries, graphs of igraph, AnnData, files; and widths for each axis of a grid."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import adwave as aw
import numpy as np
import pytest
from stand_ins import AnnData, Graph

SHAPE = aw.sample("sphere", vertices=500)
V, F = np.array(SHAPE.points), np.array(SHAPE.faces, dtype=np.int64)
f = V[:, 2] + np.random.default_rng(0).normal(size=len(V))


@pytest.mark.parametrize(
    "keys", [("vertices", "faces"), ("points", "cells"), ("V", "F"), ("verts", "tris"), ("pos", "triangles")]
)
def test_a_dictionary_is_a_mesh_and_comes_back_as_one(keys: tuple[str, str]) -> None:
    given: dict[str, Any] = {keys[0]: V, keys[1]: F, "heat": f, "name": "ball"}
    assert np.array_equal(aw.smooth(given, f, fwhm=0.3), aw.smooth((V, F), f, fwhm=0.3))
    named = aw.smooth(given, "heat", fwhm=0.3)
    assert np.array_equal(named["heat"], aw.smooth((V, F), f, fwhm=0.3)) and named["name"] == "ball"
    moved = aw.filter(given, "smooth")
    assert np.array_equal(moved[keys[0]], aw.filter((V, F), "smooth")[0]) and moved[keys[1]] is F
    assert given["heat"] is f and given[keys[0]] is V


def test_an_archive_of_numpy_and_a_cloud_in_a_dictionary(tmp_path: Path) -> None:
    np.savez(tmp_path / "mesh.npz", vertices=V.astype(np.float32), faces=F)
    with np.load(tmp_path / "mesh.npz") as archive:
        assert aw.Shape(archive).kind == "mesh"
        assert aw.denoise(archive).result["vertices"].dtype == np.float32
    assert aw.Shape({"xyz": V}).kind == "cloud"
    assert aw.Shape({"points": V, "cells": {"triangle": F}}).n_faces == len(F)
    with pytest.raises(TypeError, match=r"the keys 'a', 'b' has no points; name its arrays 'vertices' and 'faces'"):
        aw.smooth({"a": V, "b": F}, f, fwhm=1)


def ring(kind: Any, n: int = 30) -> Any:
    return kind(n, [(i, (i + 1) % n) for i in range(n)])


def igraph_kinds() -> list[Any]:
    try:
        import igraph
    except ImportError:
        return [Graph]
    return [Graph, lambda n, edges: igraph.Graph(n=n, edges=edges)]


@pytest.mark.parametrize("kind", igraph_kinds())
def test_graphs_of_igraph(kind: Any) -> None:
    graph, wave = ring(kind), np.cos(np.arange(30))
    graph.vs["wave"] = wave.tolist()
    ends = np.arange(30)
    same = aw.smooth(aw.graph(30, np.column_stack([ends, (ends + 1) % 30])), wave, steps=2)
    assert np.allclose(aw.smooth(graph, wave, steps=2), same)
    named = aw.smooth(graph, "wave", steps=2)
    assert type(named) is type(graph) and np.allclose(named.vs["wave"], same)
    assert graph.vs["wave"] == wave.tolist()


def test_values_of_cells_of_an_anndata_come_back_in_one() -> None:
    sparse, pandas = pytest.importorskip("scipy.sparse"), pytest.importorskip("pandas")
    ends = np.arange(30)
    weights = sparse.coo_matrix((np.ones(30), (ends, (ends + 1) % 30)), shape=(30, 30)).tocsr()
    obs = pandas.DataFrame({"score": np.cos(ends)})
    cells = AnnData(counts=np.ones((30, 2)), obs=obs, obsm={}, obsp={"connectivities": weights + weights.T})
    named = aw.smooth(cells, "score", steps=2)
    assert isinstance(named, AnnData)
    assert np.allclose(named.obs["score"], aw.smooth(weights + weights.T, np.cos(ends), steps=2))
    assert np.array_equal(cells.obs["score"], np.cos(ends))


def test_first_arguments_in_another_order_lead_to_the_line() -> None:
    trimesh = pytest.importorskip("trimesh")
    mesh, edges = trimesh.Trimesh(V, F, process=False), SHAPE.faces[:, :2].T
    triple = (V, F, f)
    for call, line in [
        (lambda: aw.smooth(f, mesh, fwhm=1), r"write aw\.smooth\(mesh, f, fwhm=1\)"),
        (lambda: aw.denoise(f.tolist(), mesh), r"write aw\.denoise\(mesh, f\.tolist\(\)\)"),
        (lambda: aw.smooth((V, F, f), fwhm=1), r"write aw\.smooth\(\(V, F\), f, fwhm=1\)"),
        (lambda: aw.decompose(triple, levels=2), r"write aw\.decompose\(\(triple\[0\], triple\[1\]\), triple\[2\], l"),
        (lambda: aw.smooth(V, F, f, fwhm=1), r"write aw\.smooth\(\(V, F\), f, fwhm=1\)"),
        (lambda: aw.smooth(edges, f, t=2), r"write aw\.smooth\(aw\.from_edge_index\(edges\), f, steps=2\)"),
        (lambda: aw.smooth(mesh, f, fwhm=[1, 2]), r"write aw\.decompose\(mesh, f, fwhm=\[1, 2\]\)"),
    ]:
        with pytest.raises((TypeError, ValueError), match=line):
            call()


def test_files_of_images_and_of_signals(tmp_path: Path) -> None:
    for name in ("t1.nii.gz", "brain.MGZ"):
        with pytest.raises(TypeError, match=r"write import nibabel; aw\.smooth\(nibabel\.load\(name\), fwhm=6\)"):
            aw.smooth(name, fwhm=6)
    with pytest.raises(TypeError, match=r"SimpleITK\.ReadImage"):
        aw.grid("scan.nrrd")
    SHAPE.write(tmp_path / "ball.ply")
    np.save(tmp_path / "f.npy", f)
    by_path = aw.decompose(tmp_path / "ball.ply", tmp_path / "f.npy", levels=2)
    assert np.allclose(by_path.reconstruct(), f)


def test_values_at_faces_of_pyvista_lead_to_values_at_points() -> None:
    pv = pytest.importorskip("pyvista")
    poly = pv.Sphere()
    poly.cell_data["q"] = np.arange(poly.n_cells, dtype=float)
    with pytest.raises(ValueError, match=r'write aw\.smooth\(poly\.cell_data_to_point_data\(\), "q", fwhm=0\.2\)'):
        aw.smooth(poly, "q", fwhm=0.2)
    assert aw.smooth(poly.cell_data_to_point_data(), "q", fwhm=0.2)["q"].shape == (poly.n_points,)


def test_a_width_for_each_axis_is_one_along_each() -> None:
    volume = np.zeros((41, 41, 41))
    volume[20, 20, 20] = 1.0
    smooth = aw.smooth(volume, sigma=(2, 3, 4))
    by_axis = volume
    for axis, sigma in enumerate((2.0, 3.0, 4.0)):
        line = smooth.sum(axis=tuple({0, 1, 2} - {axis}))
        assert np.isclose((line * (np.arange(41) - 20) ** 2).sum(), sigma**2, rtol=2e-2)
        by_axis = aw.grid(by_axis, axes=axis).smooth(sigma=sigma)
    assert np.allclose(smooth, by_axis, rtol=1e-6, atol=1e-12)
    # In the unit of the spacing, with the mask and the kind of object of the grid.
    spaced = aw.grid(volume, spacing=(1.0, 1.5, 2.0), mask=np.indices(volume.shape)[0] > 3)
    even = aw.grid(volume, spacing=(1.0, 1.5, 2.0), mask=spaced.mask)
    assert np.allclose(spaced.smooth(fwhm=[4, 4, 4]), even.smooth(fwhm=4))
    nibabel = pytest.importorskip("nibabel")
    image = nibabel.Nifti1Image(volume.astype(np.float32), np.diag([1.0, 1.5, 2.0, 1.0]))
    assert type(aw.smooth(image, fwhm=[4, 4, 6])) is nibabel.Nifti1Image
    with pytest.raises(ValueError, match="sigma: got 2 numbers for 3 axes"):
        aw.smooth(volume, sigma=[1, 2])
    with pytest.raises(ValueError, match=r"left out, aw\.grid\(array, axes="):
        aw.smooth(volume, sigma=[0, 1, 2])


def test_facts_about_a_grid() -> None:
    found = aw.info(aw.grid(np.ones((8, 9)), spacing=(1.0, 2.0), mask=np.indices((8, 9))[0] > 2))
    assert found.kind == "grid" and found.shape == [8, 9] and found.spacing == [1.0, 2.0]
    assert (found.places, found.places_with_data) == (72, 45) and "places" in repr(found)
