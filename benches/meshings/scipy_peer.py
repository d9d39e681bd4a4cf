"""Part `scipy`: bands of the surface's heat beside e^(−tM⁻¹L) f by SciPy from the same matrices."""

import subprocess
import time

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import expm_multiply

from adwave import SURFACE, Failure
from remeshing import EDGES, norms
from page import table
from tables import seconds

SHAPES = ("fandisk", "kitten")
ACCURACY = 1e-6


class Unavailable(Exception):
    """What is needed is not in this build."""


def surface_matrices(bench, mesh):
    """Masses M (a vector) and stiffness L (sparse, positive) of the operator `surface`, in the order of the mesh's vertices.

    The program of `--matrices` is called with the mesh's file and a name, and writes an .npz file of that name: `mass` (n),
    and the rows of L as `data`, `indices`, `indptr` (n + 1).
    """
    if bench.args.matrices is None:
        raise Unavailable("no program was given that writes the matrices of the operator `surface`")
    out = bench.adwave.work / "surface.npz"
    subprocess.run([bench.args.matrices, mesh.path, out], check=True)
    with np.load(out) as arrays:
        mass = arrays["mass"]
        return mass, sp.csr_matrix((arrays["data"], arrays["indices"], arrays["indptr"]), shape=(len(mass), len(mass)))


def heat(masses, stiffness, values, lengths):
    """e^(−tM⁻¹L) f at t = σ²/4, each length from the one before; also the seconds of it."""
    rate = sp.diags(1 / masses) @ stiffness
    found, before = [values], 0.0
    start = time.perf_counter()
    for length in lengths:
        found.append(expm_multiply((before**2 - length**2) / 4 * rate, found[-1]))
        before = length
    return np.stack(found), time.perf_counter() - start


def measure(bench):
    """The relative errors of our bands, and how many times longer SciPy takes; matrices are ready for both."""
    found = {}
    if SURFACE not in bench.adwave.operators:
        bench.note("scipy: this build has no operator `surface`")
        return found
    for mesh in (mesh for mesh in bench.shapes if mesh.name in SHAPES):
        lengths = [e * mesh.mean_edge for e in EDGES]
        print(f"  {mesh.name}", flush=True)
        try:
            matrices = surface_matrices(bench, mesh)
            ours = bench.adwave.transform(mesh, lengths, SURFACE, accuracy=ACCURACY)
        except (Unavailable, Failure) as reason:
            bench.note(f"scipy: {reason}")
            return found
        levels, theirs = heat(*matrices, mesh.points, lengths)
        exact = levels[:-1] - levels[1:]
        errors = norms(ours.wavelet - exact, mesh.vertex_areas) / norms(exact, mesh.vertex_areas)
        found[mesh.name] = {"vertices": len(mesh.points), "errors": errors.tolist(), "scipy": theirs,
                            "ours": ours.info["seconds"]["bands"]}
    return found


def text(found):
    if not found:
        return "Not measured: see below."
    rows = [[name, f"{of['vertices']:,}", *(f"{e:.0e}" for e in of["errors"]), seconds(of["ours"]), seconds(of["scipy"]),
             f"{of['scipy'] / of['ours']:.3g}"] for name, of in found.items()]
    return (f"`expm_multiply` at t = σ²/4 from the same matrices, each level from the one before; ours at accuracy {ACCURACY:g}.\n\n"
            + table(["shape", "vertices", *(f"error at {e} edges" for e in EDGES), "ours", "SciPy", "ratio"], rows))
