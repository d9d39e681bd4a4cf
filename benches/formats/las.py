"""LAS and LAZ against laspy: fields that have no standard place become extra bytes, and the coordinate system and all else stays.

    python -m pip install "laspy[lazrs]" numpy
    python benches/formats/las.py target/release/adwave
"""

import sys
import tempfile
from pathlib import Path

import laspy
import numpy as np
from common import Adwave, Report

TYPES = ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"]


def cloud(path, n=500):
    """A PLY of points with a field of each type."""
    rng = np.random.default_rng(5)
    columns = {"x": rng.normal(size=n), "y": rng.normal(size=n), "z": rng.normal(size=n)}
    names = {"u1": "uchar", "i1": "char", "u2": "ushort", "i2": "short", "u4": "uint", "i4": "int", "f4": "float", "f8": "double"}
    fields = {f"of_{kind}": rng.normal(size=n).astype(kind) if kind[0] == "f" else rng.integers(0, 100, n).astype(kind) for kind in names}
    rows = np.zeros(n, [(name, "<f8") for name in columns] + [(name, "<" + values.dtype.str[1:]) for name, values in fields.items()])
    for name, values in {**columns, **fields}.items():
        rows[name] = values
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {n}"] + [f"property double {c}" for c in columns]
    head += [f"property {names[name[3:]]} {name}" for name in fields] + ["end_header", ""]
    path.write_bytes("\n".join(head).encode() + rows.tobytes())
    return columns, fields


def main():
    adwave, report = Adwave(sys.argv[1]), Report()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        columns, fields = cloud(folder / "a.ply")
        for ending in ("las", "laz"):
            target = folder / f"a.{ending}"
            adwave.run("convert", folder / "a.ply", "-o", target)
            las = laspy.read(target)
            same = all(np.array_equal(np.asarray(las[name]), values) for name, values in fields.items())
            kinds = all(las[name].dtype == values.dtype for name, values in fields.items())
            near = all(np.abs(np.asarray(las[c]) - columns[c]).max() < 1e-8 for c in "xyz")
            what = {"fields": same, "types": kinds, "points": near}
            report.check(f"adwave .{ending} read by laspy", lambda what=what: what)

        # What laspy wrote, with a coordinate system and extra bytes, and one field more.
        header = laspy.LasHeader(point_format=7, version="1.4")
        header.add_extra_dim(laspy.ExtraBytesParams("amplitude", "f4"))
        header.add_extra_dim(laspy.ExtraBytesParams("scaled", "i2", scales=np.array([0.5]), offsets=np.array([10.0])))
        header.vlrs.append(laspy.VLR("LASF_Projection", 2112, "WKT", b"PROJCS[\"somewhere\"]\0"))
        header.scales, header.offsets = [0.001] * 3, [0.0] * 3
        las = laspy.LasData(header)
        rng = np.random.default_rng(6)
        las.x, las.y, las.z = rng.normal(size=(3, 400))
        las.amplitude = rng.normal(size=400).astype("f4")
        las.scaled = 10 + 0.5 * rng.integers(0, 50, 400)
        las.gps_time = rng.normal(size=400)
        las.red = rng.integers(0, 65535, 400)
        for ending in ("las", "laz"):
            source, target = folder / f"b.{ending}", folder / f"c.{ending}"
            las.write(source)
            adwave.run("saliency", source, "-o", target)
            again = laspy.read(target)
            kept = ["amplitude", "scaled", "gps_time"]
            same = all(np.array_equal(np.asarray(again[name]), np.asarray(las[name])) for name in kept)
            points = all(np.array_equal(np.asarray(again[c]), np.asarray(las[c])) for c in "XYZ")
            crs = any(vlr.user_id == "LASF_Projection" for vlr in again.header.vlrs)
            has = "saliency" in again.point_format.dimension_names and np.isfinite(again["saliency"]).all()
            what = {"fields": same, "points": points, "coordinate system": crs, "map": bool(has)}
            report.check(f"laspy .{ending} with a map of adwave", lambda what=what: what)
    report.end()


if __name__ == "__main__":
    main()
