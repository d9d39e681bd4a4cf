"""Widths in km on the meshes of ICON, MPAS and UGRID: heat of adwave against spherical harmonics, whose decay is known.

A field is a random harmonic of degree l on each mesh, with two times, of which the second is twice the first. A Gaussian
of full width FWHM at half maximum multiplies it by exp(−l(l+1)σ²/(2R²)), σ = FWHM/2.3548, on a sphere of radius R.
Printed is the root mean square error of the smoothed field relative to the true one.

    pip install -r benches/sky/requirements.txt
    python benches/sky/meshes.py --command target/release/adwave
"""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path

import netCDF4
import numpy as np
from scipy.spatial import ConvexHull, SphericalVoronoi
from scipy.special import sph_harm_y

RADIUS = 6371229.0


def icosahedron(n_splits):
    """Points and triangles of an icosahedron whose triangles are split into four so many times."""
    phi = (1 + 5**0.5) / 2
    points = np.array([[s, t * phi, 0] for s in (-1, 1) for t in (-1, 1)])
    points = np.concatenate([np.roll(points, k, axis=1) for k in range(3)])
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    triangles = outward(points, ConvexHull(points).simplices)
    for _ in range(n_splits):
        sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, index = np.unique(sides, axis=0, return_inverse=True)
        middle = points[unique].sum(axis=1)
        middle /= np.linalg.norm(middle, axis=1, keepdims=True)
        m = index.reshape(-1, 3) + len(points)
        points = np.concatenate([points, middle])
        a, b, c = triangles.T
        corners = [(a, m[:, 0], m[:, 2]), (b, m[:, 1], m[:, 0]), (c, m[:, 2], m[:, 1]), (m[:, 0], m[:, 1], m[:, 2])]
        triangles = np.concatenate([np.stack(corner, axis=1) for corner in corners])
    return points, triangles


def outward(points, triangles):
    """The triangles counterclockwise from outside."""
    a, b, c = points[triangles].transpose(1, 0, 2)
    is_turned = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    return np.where(is_turned[:, None], triangles[:, ::-1], triangles)


def angles(points):
    return np.arctan2(points[:, 1], points[:, 0]), np.arcsin(np.clip(points[:, 2], -1, 1))


def harmonic(points, degree, rng):
    """Values of a random harmonic of a degree, of unit deviation."""
    lon, lat = angles(points)
    values = sum(
        rng.standard_normal() * f(sph_harm_y(degree, m, np.pi / 2 - lat, lon))
        for m in range(degree + 1)
        for f in (np.real, np.imag)
    )
    return values / values.std()


def create(path, kind, dimensions):
    file = netCDF4.Dataset(path, "w", format=kind)
    for name, size in dimensions.items():
        file.createDimension(name, size)
    time = file.createVariable("time", "f8", ("time",))
    time.units, time[:] = "hours since 2000-01-01", [0, 6]
    return file


def add(file, name, axes, values, **attributes):
    values = np.asarray(values)
    variable = file.createVariable(name, values.dtype, axes)
    variable.setncatts(attributes)
    variable[:] = values


def write_icon(path, kind, degree, rng):
    """Triangles as cells; returns the values of the field in them."""
    points, triangles = icosahedron(5)
    centers = points[triangles].sum(axis=1)
    centers /= np.linalg.norm(centers, axis=1, keepdims=True)
    file = create(path, kind, {"cell": len(triangles), "vertex": len(points), "nv": 3, "time": 2})
    file.sphere_radius = RADIUS
    for begin, where, axis in (("c", centers, "cell"), ("v", points, "vertex")):
        for name, angle in zip(("lon", "lat"), angles(where), strict=False):
            add(file, begin + name, (axis,), angle, units="radian")
    add(file, "vertex_of_cell", ("nv", "cell"), (triangles.T + 1).astype("i4"))
    values = harmonic(centers, degree, rng)
    add(file, "temperature", ("time", "cell"), np.stack([values, 2 * values]).astype("f4"))
    file.close()
    return values


def write_mpas(path, kind, degree, rng):
    """Voronoi cells of points that were relaxed ten times; returns the values of the field in them."""
    points = rng.standard_normal((10000, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    for _ in range(10):
        voronoi = SphericalVoronoi(points)
        voronoi.sort_vertices_of_regions()
        points = np.stack([voronoi.vertices[region].mean(axis=0) for region in voronoi.regions])
        points /= np.linalg.norm(points, axis=1, keepdims=True)
    voronoi = SphericalVoronoi(points)
    voronoi.sort_vertices_of_regions()
    counts = np.array([len(region) for region in voronoi.regions], dtype="i4")
    table = np.zeros((len(points), counts.max()), dtype="i4")
    for row, region in zip(table, voronoi.regions, strict=False):
        row[: len(region)] = np.array(region) + 1
    sizes = {"nCells": len(points), "nVertices": len(voronoi.vertices), "maxEdges": counts.max(), "time": 2}
    file = create(path, kind, sizes)
    file.on_a_sphere, file.sphere_radius = "YES", RADIUS
    for end, where, axis in (("Cell", points, "nCells"), ("Vertex", voronoi.vertices, "nVertices")):
        for name, angle in zip(("lon", "lat"), angles(where), strict=False):
            add(file, name + end, (axis,), angle)
    add(file, "nEdgesOnCell", ("nCells",), counts)
    add(file, "verticesOnCell", ("nCells", "maxEdges"), table)
    values = harmonic(points, degree, rng)
    add(file, "temperature", ("time", "nCells"), np.stack([values, 2 * values]))
    file.close()
    return values


def write_ugrid(path, kind, degree, rng):
    """Triangles between nodes that carry the field; returns its values."""
    points, triangles = icosahedron(5)
    file = create(path, kind, {"node": len(points), "face": len(triangles), "corner": 3, "time": 2})
    add(
        file,
        "mesh",
        (),
        np.int32(0),
        cf_role="mesh_topology",
        node_coordinates="lon lat",
        face_node_connectivity="corners",
        topology_dimension=np.int32(2),
    )
    add(file, "crs", (), np.int32(0), grid_mapping_name="latitude_longitude", earth_radius=RADIUS)
    for name, angle in zip(("lon", "lat"), angles(points), strict=False):
        add(file, name, ("node",), np.degrees(angle), units="degrees_north" if name == "lat" else "degrees_east")
    add(file, "corners", ("face", "corner"), triangles.astype("i4"), start_index=np.int32(0))
    values = harmonic(points, degree, rng)
    add(file, "temperature", ("time", "node"), np.stack([values, 2 * values]), location="node", mesh="mesh")
    file.close()
    return values


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--command", default="adwave", help="adwave's command")
    args = parser.parse_args()
    print("convention  kind             places  degree  FWHM in km  kept    error in % of the smoothed field")
    writers = {"ICON": write_icon, "MPAS": write_mpas, "UGRID": write_ugrid}
    kinds = ("NETCDF4", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA")
    with tempfile.TemporaryDirectory() as folder:
        source, result = Path(folder) / "mesh.nc", Path(folder) / "smooth.npy"
        for (convention, write), kind in zip(writers.items(), kinds, strict=False):
            for degree, fwhm in ((4, 3000), (10, 1500), (20, 800)):
                values = write(source, kind, degree, np.random.default_rng(degree))
                words = [args.command, "filter", source, "-o", result, "--fwhm", str(fwhm), "--preset", "suppress"]
                run = subprocess.run([*words, "--json"], capture_output=True, text=True)
                if run.returncode:
                    raise SystemExit(run.stderr)
                json.loads(run.stdout)
                sigma = fwhm * 1000 / RADIUS / np.sqrt(8 * np.log(2))
                kept = np.exp(-degree * (degree + 1) * sigma**2 / 2)
                truth = kept * values[:, None] * [1, 2]
                error = 100 * np.sqrt(np.mean((np.load(result) - truth) ** 2) / np.mean(truth**2))
                print(f"{convention:11} {kind:16} {len(values):6d}  {degree:6d}  {fwhm:10d}  {kept:.4f}  {error:.3f}")


if __name__ == "__main__":
    main()
