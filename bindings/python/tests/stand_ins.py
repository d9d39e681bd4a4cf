"""Stand-ins for objects of libraries that are too large to install for tests: what the package uses of them."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np


class PointCloud:
    """A cloud of Open3D."""

    __module__ = "open3d.cpu.pybind.geometry"

    def __init__(self, other: PointCloud | None = None) -> None:
        if other is not None:
            vars(self).update(vars(other))


class TriangleMesh:
    """A mesh of Open3D."""

    __module__ = "open3d.cpu.pybind.geometry"

    def __init__(self, other: TriangleMesh | None = None) -> None:
        if other is not None:
            vars(self).update(vars(other))


def fake_open3d() -> ModuleType:
    """The module whose classes are here, for `sys.modules`."""
    module: Any = ModuleType("open3d")
    vectors = {name: lambda values=(): np.array(values) for name in ("Vector3dVector", "Vector3iVector")}
    module.utility = SimpleNamespace(**vectors)
    return module


def open3d_cloud(points: np.ndarray) -> Any:
    """A cloud of Open3D with these points."""
    cloud: Any = PointCloud()
    cloud.points, cloud.colors, cloud.normals = points, np.empty((0, 3)), np.empty((0, 3))
    return cloud


def open3d_mesh(vertices: np.ndarray, triangles: np.ndarray) -> Any:
    """A mesh of Open3D."""
    mesh: Any = TriangleMesh()
    mesh.vertices, mesh.triangles = vertices, triangles
    mesh.vertex_colors, mesh.vertex_normals, mesh.triangle_normals = (np.empty((0, 3)) for _ in range(3))
    mesh.triangle_uvs = np.empty((0, 2))
    return mesh


class Tensor:
    """A tensor of PyTorch in the memory of the processor."""

    __module__ = "torch"

    def __init__(self, values: Any) -> None:
        self.values = np.asarray(values)
        self.shape, self.ndim, self.T = self.values.shape, self.values.ndim, self.values.T
        self.is_cuda, self.requires_grad, self.device, self.dtype = False, False, "cpu", None

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.array(self.values, dtype=dtype)

    def __dlpack__(self, **options: Any) -> Any:
        return self.values.__dlpack__(**options)

    def __dlpack_device__(self) -> Any:
        return self.values.__dlpack_device__()

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, index: Any) -> Tensor:
        return Tensor(self.values[index])

    def detach(self) -> Tensor:
        return self

    def cpu(self) -> Tensor:
        return self

    def numpy(self) -> np.ndarray:
        return self.values

    def is_floating_point(self) -> bool:
        return self.values.dtype.kind == "f"

    def to(self, *_: Any) -> Tensor:
        return self


class Data:
    """A graph of PyTorch Geometric."""

    __module__ = "torch_geometric.data.data"

    def __init__(self, **tensors: Any) -> None:
        vars(self).update(tensors)

    @property
    def num_nodes(self) -> int:
        return len(vars(self)["x"])

    def keys(self) -> list[str]:
        return list(vars(self))

    def clone(self) -> Data:
        return Data(**vars(self))

    def __getitem__(self, name: str) -> Any:
        return vars(self)[name]

    def __setitem__(self, name: str, value: Any) -> None:
        vars(self)[name] = value


def fake_torch() -> ModuleType:
    """The module whose tensors are here, for `sys.modules`."""
    module: Any = ModuleType("torch")
    module.Tensor, module.from_numpy = Tensor, Tensor
    return module


def torch_graph(**arrays: np.ndarray) -> Any:
    """A graph of PyTorch Geometric with these arrays as tensors."""
    return Data(**{name: Tensor(values) for name, values in arrays.items()})


class AnnData:
    """Cells with expressions, coordinates and neighbors."""

    __module__ = "anndata._core.anndata"

    def __init__(self, **parts: Any) -> None:
        vars(self).update(parts)
        self.n_obs = len(self.X)

    @property
    def X(self) -> np.ndarray:
        return vars(self)["counts"]

    def __getitem__(self, index: Any) -> AnnData:
        cells, genes = index
        at = [self.var_names.index(gene) for gene in genes]
        return AnnData(**{**self._parts(), "counts": self.X[cells][:, at], "var_names": list(genes)})

    def copy(self) -> AnnData:
        return AnnData(**{**self._parts(), "obs": self.obs.copy(), "obsm": dict(self.obsm)})

    def _parts(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name != "n_obs"}


class Graph:
    """An undirected graph of igraph without weights."""

    __module__ = "igraph"

    def __init__(self, n: int, edges: list[tuple[int, int]]) -> None:
        self.n, self.edges = n, edges
        self.es, self.vs = _Attributes(), _Attributes()

    def get_edgelist(self) -> list[tuple[int, int]]:
        return self.edges

    def is_directed(self) -> bool:
        return False

    def vcount(self) -> int:
        return self.n

    def copy(self) -> Graph:
        other = Graph(self.n, self.edges)
        other.vs.update(self.vs)
        return other


class _Attributes(dict[str, Any]):
    def attributes(self) -> list[str]:
        return list(self)
