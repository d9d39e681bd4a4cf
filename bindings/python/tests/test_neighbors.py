"""Objects of neighboring packages, read and given back attribute by attribute."""

from __future__ import annotations

import adwave as aw
import numpy as np
import pytest

SHAPE = aw.sample("sphere", vertices=400)
V, F = np.array(SHAPE.points), np.array(SHAPE.faces, dtype=np.int64)
N = SHAPE.n_vertices
f = V[:, 0] + V[:, 1] ** 2


def test_nilearn() -> None:
    surface = pytest.importorskip("nilearn.surface")
    mesh = surface.InMemoryMesh(V, F)
    assert np.array_equal(aw.decompose(mesh, f, levels=3), aw.decompose((V, F), f, levels=3))
    moved = aw.filter(mesh, "smooth")
    assert isinstance(moved, surface.InMemoryMesh) and np.array_equal(moved.faces, F)
    assert np.array_equal(moved.coordinates, aw.filter(SHAPE, "smooth").points)
    both = surface.PolyMesh(left=mesh, right=surface.InMemoryMesh(V + np.array([5, 0, 0]), F))
    assert aw.Shape(both).n_vertices == 2 * N and aw.info(both).components == 2
    clean = aw.denoise(both).result
    assert isinstance(clean, surface.PolyMesh) and clean.parts["right"].coordinates.shape == (N, 3)
    image = surface.SurfaceImage(both, {"left": np.stack([f, -f], axis=1), "right": np.stack([2 * f, f], axis=1)})
    smooth = aw.smooth(image, fwhm=0.5)
    assert isinstance(smooth, surface.SurfaceImage) and smooth.data.parts["left"].shape == (N, 2)
    alone = aw.smooth(both, np.concatenate([image.data.parts["left"], image.data.parts["right"]]), fwhm=0.5)
    assert np.allclose(np.concatenate(list(smooth.data.parts.values())), alone)
    assert aw.decompose(image, levels=3).shape == (4, 2 * N, 2)
    assert np.array_equal(smooth.mesh.parts["left"].coordinates, V)


def test_torch_geometric() -> None:
    torch = pytest.importorskip("torch")
    data_module = pytest.importorskip("torch_geometric.data")
    rng = np.random.default_rng(1)
    ends = np.array([[i, (i + step) % 40] for i in range(40) for step in (1, 3)]).T
    both = np.concatenate([ends, ends[::-1]], axis=1)
    x = rng.normal(size=(40, 5)).astype(np.float32)
    graph = data_module.Data(x=torch.from_numpy(x), edge_index=torch.from_numpy(both), y=torch.arange(40))
    expected = aw.decompose(aw.graph(40, ends.T), x, levels=3)
    assert np.allclose(aw.decompose(graph, x, levels=3), expected)
    assert np.allclose(aw.decompose(graph, levels=3), expected), "the features are the signal of a graph"
    smooth = aw.smooth(graph, steps=2)
    assert isinstance(smooth, data_module.Data) and smooth.x.dtype == torch.float32
    assert torch.equal(smooth.edge_index, graph.edge_index) and torch.equal(smooth.y, graph.y)
    assert not torch.equal(smooth.x, graph.x) and torch.equal(graph.x, torch.from_numpy(x))
    mesh = data_module.Data(pos=torch.from_numpy(V), face=torch.from_numpy(F.T.copy()), heat=torch.from_numpy(f))
    moved = aw.filter(mesh, "smooth")
    assert np.array_equal(moved.pos.numpy(), aw.filter(SHAPE, "smooth").points) and torch.equal(moved.face, mesh.face)
    assert torch.equal(moved.heat, mesh.heat) and np.array_equal(aw.Shape(mesh)["heat"], f)
    cloud = data_module.Data(pos=torch.from_numpy(V))
    assert aw.Shape(cloud).kind == "cloud"


def test_pygsp() -> None:
    graphs = pytest.importorskip("pygsp").graphs
    ring = graphs.Ring(50)
    wave = np.cos(np.arange(50.0))
    edges = [[i, (i + 1) % 50] for i in range(50)]
    assert np.allclose(aw.decompose(ring, wave, levels=3), aw.decompose(aw.graph(50, edges), wave, levels=3))
    ring.signals = {"wave": wave}
    smooth = aw.smooth(ring, "wave", steps=2)
    assert type(smooth) is type(ring) and np.allclose(smooth.signals["wave"], aw.smooth(ring, wave, steps=2))
    assert np.array_equal(ring.signals["wave"], wave) and (smooth.W != ring.W).nnz == 0


def test_laspy() -> None:
    laspy = pytest.importorskip("laspy")
    las = laspy.create(point_format=3)
    las.header.offsets, las.header.scales = [0, 0, 0], [1e-4] * 3
    las.x, las.y, las.z = V.T
    las.classification = np.arange(N) % 3
    las.intensity = np.arange(N)
    shape = aw.Shape(las)
    assert shape.kind == "cloud" and np.allclose(shape.points, V, atol=1e-4)
    assert np.array_equal(shape["classification"], np.arange(N) % 3)
    clean = aw.denoise(las).result
    assert isinstance(clean, laspy.LasData) and np.array_equal(clean.intensity, las.intensity)
    assert np.array_equal(clean.classification, las.classification)
    assert np.allclose(clean.xyz, aw.denoise(shape).result.points, atol=1e-4)
    # Only the points of a class take part, and the others stay.
    part = aw.smooth(las, steps=2, only="classification=1")
    still = np.asarray(las.classification) != 1
    assert np.array_equal(part.xyz[still], las.xyz[still]) and not np.array_equal(part.xyz, las.xyz)
    heights = aw.smooth(las, "intensity", steps=2)
    assert heights.intensity.dtype == las.intensity.dtype and not np.array_equal(heights.intensity, las.intensity)
    assert aw.simplify(las, ratio=0.5).shape.xyz.shape[0] < 0.7 * N


def test_grids_of_pyvista() -> None:
    pv = pytest.importorskip("pyvista")
    image = pv.ImageData(dimensions=(12, 10, 6), spacing=(1, 1, 2))
    rng = np.random.default_rng(2)
    image.point_data["density"] = rng.normal(size=image.n_points)
    image.point_data["other"] = np.arange(image.n_points)
    image.point_data.active_scalars_name = "density"
    lattice = image.cast_to_rectilinear_grid()
    bands = aw.decompose(lattice, levels=3)
    assert bands.shape == (4, image.n_points) and np.allclose(bands.reconstruct(), image["density"])
    smooth = aw.smooth(lattice, steps=3)
    assert isinstance(smooth, pv.RectilinearGrid) and smooth["density"].std() < image["density"].std()
    assert np.array_equal(smooth["other"], image["other"]) and np.array_equal(smooth.z, lattice.z)
    # A step along the long axis is a quarter as likely.
    center = 5 + 12 * (5 + 10 * 3)
    for given in (lattice, aw.Shape(image)):
        matrix = aw.Decomposer(given, operator="walk").matrix(lazy=False)
        assert np.isclose(matrix[center, center + 120], matrix[center, center + 1] / 4)
    grid = image.cast_to_unstructured_grid()
    by_cells = aw.decompose(grid, grid["density"], levels=3)
    assert np.allclose(by_cells, bands)
    assert isinstance(aw.smooth(grid, "density", steps=3), pv.UnstructuredGrid)
    assert np.allclose(aw.smooth(grid, "density", steps=3)["density"], smooth["density"])
    with pytest.raises(TypeError, match="give a signal"):
        aw.filter(lattice, "coords", "smooth", levels=2)


def test_results_without_a_place_are_shapes_or_arrays() -> None:
    sparse = pytest.importorskip("scipy.sparse")
    ends = np.arange(30)
    ring = sparse.coo_array((np.ones(30), (ends, (ends + 1) % 30)), shape=(30, 30))
    assert aw.smooth(ring + ring.T, np.cos(ends), steps=2).shape == (30,)
    networkx = pytest.importorskip("networkx")
    graph = networkx.cycle_graph(30)
    networkx.set_node_attributes(graph, {i: float(np.cos(i)) for i in range(30)}, "wave")
    smooth = aw.smooth(graph, "wave", steps=2)
    assert isinstance(smooth, networkx.Graph)
    assert np.allclose([smooth.nodes[i]["wave"] for i in range(30)], aw.smooth(ring + ring.T, np.cos(ends), steps=2))


def test_stored_normals_follow_the_positions() -> None:
    pv = pytest.importorskip("pyvista")
    mesh = SHAPE.to_pyvista().compute_normals(cell_normals=False, split_vertices=False)
    stretched = aw.filter(mesh, [0, 0, 3])
    assert isinstance(stretched, pv.PolyData) and "Normals" in stretched.point_data
    expected = stretched.compute_normals(cell_normals=False, split_vertices=False)["Normals"]
    assert np.abs((stretched["Normals"] * expected).sum(axis=1)).min() > 0.9
    assert not np.array_equal(stretched["Normals"], mesh["Normals"])
