"""One peer in a process of its own: `peers.py NAME FOLDER`, then requests as lines of JSON, each answered by a line.

A process each keeps thread pools apart, makes a failure one failure, and lets the system say how much memory it took.
A request is `[method, arguments…]`; the answer has `seconds` of the call and `peak`, the bytes that the process used at most
beyond what it had before, result included.
"""

import gc
import glob
import json
import os
import sys
import time
from pathlib import Path

import numpy as np
import scipy.sparse as sp

DROP_TOLERANCE = 1e-6


def read_mesh(folder):
    points = np.fromfile(folder / "points.f64", "<f8").reshape(-1, 3)
    return points, np.fromfile(folder / "triangles.u32", "<u4").reshape(-1, 3).astype(np.int64)


def read_phi(folder):
    return sp.load_npz(folder / "phi.npz")


def timed(call):
    start = time.perf_counter()
    result = call()
    return time.perf_counter() - start, result


class SquaringPeer:
    """Algorithm 1 of the paper with some library's sparse product: square, drop below 1e-6, divide rows by their sums."""

    def __init__(self, folder):
        self.phi = {"f64": read_phi(folder)}
        self.phi["f32"] = self.phi["f64"].astype(np.float32)
        self.levels = []

    def multiply(self, a):
        return a @ a

    def next_level(self, a):
        a = self.multiply(a)
        a.data[a.data < DROP_TOLERANCE] = 0
        a.eliminate_zeros()
        a.data /= np.repeat(np.asarray(a.sum(axis=1)).ravel().astype(a.dtype), np.diff(a.indptr))
        return a

    def basis(self, n_levels, kind):
        self.levels = []

        def squaring():
            levels = [self.start(kind)]
            while len(levels) < n_levels:
                levels.append(self.next_level(levels[-1]))
            return levels

        seconds, self.levels = timed(squaring)
        return {"seconds": seconds, "nnz": [int(self.nnz(a)) for a in self.levels]}

    def start(self, kind):
        return self.phi[kind]

    def nnz(self, a):
        return a.nnz

    def to_scipy(self, a):
        return a

    def save(self, folder):
        for level, a in enumerate(self.levels, 1):
            a = self.to_scipy(a).tocsr()
            a.sort_indices()
            sp.save_npz(f"{folder}/{level}.npz", a, compressed=False)
        return {"seconds": 0}


class SciPy(SquaringPeer):
    def __init__(self, folder):
        super().__init__(folder)
        self.folder = folder

    def bands(self, n_levels, out=None):
        """All W_f(j) of xyz by 2^(J−1) products."""
        points = read_mesh(self.folder)[0]
        phi = self.phi["f64"]

        def products():
            smooth, steps, wavelets = points, 0, []
            for level in range(1, n_levels + 1):
                before = smooth
                for _ in range(steps, 2 ** (level - 1)):
                    smooth = phi @ smooth
                steps = 2 ** (level - 1)
                wavelets.append(before - smooth)
            return wavelets

        seconds, wavelets = timed(products)
        if out:
            np.save(out, np.array(wavelets))
        return {"seconds": seconds}

    def eigenpairs(self, k):
        """A filter in the basis of the first k manifold harmonics; the Laplacian is built before the clock starts."""
        import scipy.sparse.linalg
        from shapes import cotangent

        points, triangles = read_mesh(self.folder)
        stiffness, mass = cotangent(points, triangles)
        shift = -1 / mass.sum()  # just below the least eigenvalue 0, on the scale of the shape

        def harmonics():
            values, basis = scipy.sparse.linalg.eigsh(stiffness, k=k, M=mass, sigma=shift, which="LM")
            coefficients = basis.T @ (mass @ points)
            gains = np.linspace(0.5, -0.5, k)[:, None]
            return values, basis, points + basis @ (gains * coefficients)

        seconds, (values, basis, _) = timed(harmonics)
        residual = stiffness @ basis - (mass @ basis) * values
        scale = np.linalg.norm(stiffness @ basis[:, -1:])
        return {"seconds": seconds, "residual": float(np.linalg.norm(residual, axis=0).max() / scale)}


class MKL(SquaringPeer):
    def __init__(self, folder):
        # The wheel of MKL has no name without a version, for which sparse_dot_mkl looks.
        os.environ.setdefault("MKL_RT", sorted(glob.glob(sys.prefix + "/lib/libmkl_rt.so*"))[-1])
        import sparse_dot_mkl

        self.product = sparse_dot_mkl.dot_product_mkl
        super().__init__(folder)

    def multiply(self, a):
        return self.product(a, a)


class GraphBLAS(SquaringPeer):
    def __init__(self, folder):
        import graphblas

        self.gb = graphblas
        graphblas.ss.config["nthreads"] = os.cpu_count()
        super().__init__(folder)
        self.phi = {kind: graphblas.io.from_scipy_sparse(a) for kind, a in self.phi.items()}

    def next_level(self, a):
        squared = a.mxm(a, "plus_times").new()
        # A threshold of another type than the matrix selects nothing rightly.
        kept = squared.select(">=", self.gb.Scalar.from_value(DROP_TOLERANCE, dtype=squared.dtype)).new()
        inverse = kept.reduce_rowwise("plus").apply("minv").new()
        scaled = inverse.diag().mxm(kept, "plus_times").new()
        scaled.wait()  # nothing may be left for later
        return scaled

    def nnz(self, a):
        return a.nvals

    def to_scipy(self, a):
        return self.gb.io.to_scipy_sparse(a, "csr")


class VTK:
    """A windowed-sinc low-pass; its weights are uniform, whatever the edges' lengths."""

    def __init__(self, folder):
        import vtk
        from vtk.util import numpy_support

        points, triangles = read_mesh(folder)
        self.mesh = vtk.vtkPolyData()
        held = vtk.vtkPoints()
        held.SetData(numpy_support.numpy_to_vtk(points, deep=True))
        self.mesh.SetPoints(held)
        cells = vtk.vtkCellArray()
        cells.SetData(3, numpy_support.numpy_to_vtkIdTypeArray(triangles.ravel(), deep=True))
        self.mesh.SetPolys(cells)
        self.vtk, self.points, self.as_numpy = vtk, points, numpy_support.vtk_to_numpy

    def low_pass(self, iterations, backend):
        tools = self.vtk.vtkSMPTools
        if not tools.SetBackend(backend):
            raise RuntimeError(f"VTK was built without the backend {backend}")
        if backend != "Sequential":
            tools.Initialize(os.cpu_count())
        smoother = self.vtk.vtkWindowedSincPolyDataFilter()
        smoother.SetInputData(self.mesh)
        smoother.SetNumberOfIterations(iterations)
        smoother.SetPassBand(0.1)
        smoother.NormalizeCoordinatesOn()
        smoother.FeatureEdgeSmoothingOff()
        seconds, _ = timed(smoother.Update)
        smooth = self.as_numpy(smoother.GetOutput().GetPoints().GetData())
        extent = np.ptp(self.points, axis=0).max()
        return {"seconds": seconds, "moved": float(np.sqrt(((smooth - self.points) ** 2).sum(1).mean()) / extent)}


class PyGSP:
    """All bands by one filter bank on a graph whose normalized Laplacian L is similar to 2(I − Φ₁).

    With conductances `c(x,y) = π(x)Φ₁(x,y)`, x ≠ y, which are symmetric, `I − L/2 = D^½ Φ₁ D^−½`, D = diag π.
    """

    def __init__(self, folder):
        import pygsp

        phi = read_phi(folder)
        self.points = read_mesh(folder)[0]
        self.root = np.sqrt(np.fromfile(folder / "stationary.f64"))[:, None]
        conductance = sp.diags(self.root[:, 0] ** 2) @ (phi - sp.diags(phi.diagonal()))
        conductance = ((conductance + conductance.T) / 2).tocsr()
        conductance.eliminate_zeros()
        self.graph = pygsp.graphs.Graph(conductance / conductance.data.mean(), lap_type="normalized")
        self.graph.estimate_lmax(method="bounds")
        self.filters = pygsp.filters

    def bands(self, n_levels, order, out=None):
        steps = [0] + [2**j for j in range(n_levels)]
        kernels = [
            (lambda x, a=a, b=b: (1 - x / 2) ** a - (1 - x / 2) ** b) for a, b in zip(steps, steps[1:])
        ]
        bank = self.filters.Filter(self.graph, kernels)
        call = lambda: bank.filter(self.root * self.points, method="chebyshev", order=order)
        seconds, found = timed(call)
        if out:
            np.save(out, np.moveaxis(found, 2, 0) / self.root)
        return {"seconds": seconds, "lmax": float(self.graph.lmax)}


def memory(field):
    try:
        for line in Path("/proc/self/status").read_text().splitlines():
            if line.startswith(field):
                return 1024 * int(line.split()[1])
    except OSError:
        return None


def reset_peak():
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        return None
    return memory("VmRSS:")


def main():
    # Libraries may print; the answers keep the true output for themselves.
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    kinds = {kind.__name__: kind for kind in (SciPy, MKL, GraphBLAS, VTK, PyGSP)}
    peer = kinds[sys.argv[1]](Path(sys.argv[2]))
    print(json.dumps({"ready": True}), file=answers)
    for line in sys.stdin:
        method, *arguments = json.loads(line)
        gc.collect()  # GraphBLAS's objects refer to one another and would pile up
        before = reset_peak()
        try:
            answer = getattr(peer, method)(*arguments)
            peak = memory("VmHWM:")
            answer["peak"] = peak - before if peak and before else None
        except Exception as error:
            answer = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(answer), file=answers)


if __name__ == "__main__":
    main()
