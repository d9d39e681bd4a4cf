"""Part `scipy`: bands by the operator `surface`, compared with e^(−tM⁻¹L) f by SciPy from the same matrices."""

import subprocess
import time

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import expm_multiply

from adwave import SURFACE, Failure
from remeshing import EDGES, norms
from page import paragraph, table
from tables import seconds

SHAPES = ("fandisk", "kitten")
ACCURACY = 1e-6


class Unavailable(Exception):
    """A program that this part needs is missing in the build."""


def surface_matrices(bench, mesh):
    """Masses M (n) and stiffness L (n × n, sparse, positive semidefinite) of `surface`, in the order of the mesh's vertices.

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
    """e^(−tM⁻¹L) f at t = σ²/4, each length computed from the one before, and the seconds for all."""
    rate = sp.diags(1 / masses) @ stiffness
    found, before = [values], 0.0
    start = time.perf_counter()
    for length in lengths:
        found.append(expm_multiply((before**2 - length**2) / 4 * rate, found[-1]))
        before = length
    return np.stack(found), time.perf_counter() - start


def measure(bench):
    """Relative errors of our bands, and the times of both; the matrices are ready for both."""
    found = {}
    if SURFACE not in bench.adwave.operators:
        bench.add_note("scipy: this build has no operator `surface`")
        return found
    for mesh in (mesh for mesh in bench.shapes if mesh.name in SHAPES):
        lengths = [e * mesh.mean_edge for e in EDGES]
        print(f"  {mesh.name}", flush=True)
        try:
            matrices = surface_matrices(bench, mesh)
            ours = bench.adwave.transform(mesh, lengths, SURFACE, accuracy=ACCURACY)
        except (Unavailable, Failure) as reason:
            bench.add_note(f"scipy: {reason}")
            return found
        levels, theirs = heat(*matrices, mesh.points, lengths)
        exact = levels[:-1] - levels[1:]
        errors = norms(ours.wavelet - exact, mesh.vertex_areas) / norms(exact, mesh.vertex_areas)
        found[mesh.name] = {"vertices": len(mesh.points), "errors": errors.tolist(), "scipy": theirs,
                            "ours": ours.info["seconds"]["bands"]}
    return found


def text(found):
    """The section of the page."""
    if not found:
        return "Not measured: see the notes below."
    rows = [[name, f"{entry['vertices']:,}", *(f"{e:.0e}" for e in entry["errors"]), seconds(entry["ours"]),
             seconds(entry["scipy"]), f"{entry['scipy'] / entry['ours']:.3g}"] for name, entry in found.items()]
    head = ["shape", "vertices", *(f"error, {e} edges" for e in EDGES), "ours", "SciPy", "ratio"]
    return paragraph("`expm_multiply` at t = σ²/4 from the same matrices, each level computed from the one before; ours at accuracy "
                     f"{ACCURACY:g}.") + "\n\n" + table(head, rows)
