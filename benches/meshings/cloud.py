"""Part `cloud`: a mesh compared with its vertices as a cloud, at the same positions."""

from adwave import Failure
from remeshing import norms, octave_levels
from page import table
from tables import figure

EDGES = (4, 8, 12)


def difference(bench, mesh, operator):
    """‖W_mesh − W_cloud‖/‖W_mesh‖, weighted by the area of the mesh, one value per width."""
    lengths, counted = octave_levels([e * mesh.mean_edge for e in EDGES])
    try:
        here, there = (bench.adwave.transform(mesh, lengths, operator, kind=kind).wavelet[counted] for kind in ("mesh", "cloud"))
    except Failure as failure:
        bench.add_note(str(failure))
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
    """The section of the page."""
    rows = [[name, operator, *map(figure, figures)]
            for name, by_operator in found.items() for operator, figures in by_operator.items()]
    return table(["shape", "operator", *(f"{e} edges" for e in EDGES)], rows)
