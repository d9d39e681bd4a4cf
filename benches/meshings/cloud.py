"""Part `cloud`: a mesh beside its vertices as a cloud, which are at the same places."""

from adwave import Failure
from remeshing import norms, octave_levels
from page import table
from tables import figure

EDGES = (4, 8, 12)


def difference(bench, mesh, operator):
    """‖W_mesh − W_cloud‖/‖W_mesh‖ weighted by the area of the mesh."""
    lengths, counted = octave_levels([e * mesh.mean_edge for e in EDGES])
    try:
        here, there = (bench.adwave.transform(mesh, lengths, operator, kind=kind).wavelet[counted] for kind in ("mesh", "cloud"))
    except Failure as failure:
        bench.note(str(failure))
        return [None] * len(EDGES)
    return (norms(here - there, mesh.vertex_areas) / norms(here, mesh.vertex_areas)).tolist()


def measure(bench):
    """Each shape, and its isotropic remeshing, as a mesh and as a cloud."""
    found = {}
    for mesh in bench.shapes:
        for name, m in ((mesh.name, mesh), (f"{mesh.name}, isotropic", bench.meshings.isotropic(mesh))):
            print(f"  {name}", flush=True)
            found[name] = {operator: difference(bench, m, operator) for operator in bench.adwave.operators}
    return found


def text(found):
    rows = [[name, operator, *map(figure, figures)] for name, of in found.items() for operator, figures in of.items()]
    return table(["shape", "operator", *(f"{e} edges" for e in EDGES)], rows)
