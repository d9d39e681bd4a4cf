"""glTF, GLB and E57 against independent libraries: `python gltf.py path/to/adwave`.

trimesh and pygltflib write files that adwave reads, and read files that adwave writes; pye57 writes a scan. Points are compared to the last
bit, faces by their corners, fields by their values. Needs `pip install trimesh pygltflib pye57 pillow`.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pye57
import pygltflib
import trimesh


def run(adwave, *words):
    done = subprocess.run([adwave, *map(str, words)], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"adwave {' '.join(map(str, words))}: {done.stderr}")
    return done.stdout


def read_ply(path):
    """Points, triangles and columns of a binary PLY as adwave writes it."""
    mesh = trimesh.load(path, process=False)
    columns = mesh.metadata["_ply_raw"]["vertex"]["data"]
    return np.asarray(mesh.vertices), np.asarray(getattr(mesh, "faces", [])), columns


def said(what, holds):
    print(f"{what}: {'yes' if holds else 'NO'}")
    return bool(holds)


def positions(path):
    """All positions of a file as pygltflib finds them, in the order of meshes and primitives."""
    file = pygltflib.GLTF2().load(path)
    found = []
    for mesh in file.meshes:
        for primitive in mesh.primitives:
            accessor = file.accessors[primitive.attributes.POSITION]
            view = file.bufferViews[accessor.bufferView]
            blob = file.get_data_from_buffer_uri(file.buffers[view.buffer].uri) if file.buffers[view.buffer].uri else file.binary_blob()
            start = (view.byteOffset or 0) + (accessor.byteOffset or 0)
            stride = view.byteStride or 12
            raw = np.frombuffer(blob, np.uint8, count=stride * (accessor.count - 1) + 12, offset=start)
            rows = np.lib.stride_tricks.as_strided(raw, (accessor.count, 12), (stride, 1))
            found.append(np.ascontiguousarray(rows).view("<f4"))
    return np.concatenate(found)


def main():
    adwave = sys.argv[1]
    good = True
    with tempfile.TemporaryDirectory() as folder:
        at = Path(folder).joinpath
        mesh = trimesh.creation.icosphere(subdivisions=3)
        mesh.vertices *= [1.0, 2.0, 3.5]
        mesh.visual.vertex_colors = np.random.default_rng(1).integers(0, 256, (len(mesh.vertices), 4), dtype=np.uint8)
        for ending in ("glb", "gltf"):
            if ending == "glb":
                mesh.export(at("t.glb"))
            else:
                for name, content in trimesh.exchange.gltf.export_gltf(trimesh.Scene(mesh)).items():
                    at("t.gltf" if name.endswith(".gltf") else name).write_bytes(content)
            run(adwave, "convert", at(f"t.{ending}"), "-o", at("a.ply"))
            points, faces, columns = read_ply(at("a.ply"))
            own = positions(str(at(f"t.{ending}")))
            good &= said(f"{ending} of trimesh read, same points", np.array_equal(points.astype("f4"), own))
            good &= said(f"{ending} of trimesh read, same faces", np.array_equal(faces, mesh.faces))
            colors = np.stack([columns[c] for c in ("red", "green", "blue", "alpha")], axis=1)
            good &= said(f"{ending} of trimesh read, same colors", np.array_equal(colors, mesh.visual.vertex_colors))
            run(adwave, "convert", "sample:knot", "-o", at(f"k.{ending}"))
            run(adwave, "convert", "sample:knot", "-o", at("k.ply"))
            points, faces, _ = read_ply(at("k.ply"))
            again = trimesh.load(at(f"k.{ending}"), process=False, force="mesh")
            good &= said(f"{ending} of adwave in trimesh, same points", np.array_equal(np.asarray(again.vertices, "f4"), points.astype("f4")))
            good &= said(f"{ending} of adwave in trimesh, same faces", np.array_equal(again.faces, faces))
            good &= said(f"{ending} of adwave in pygltflib, same points", np.array_equal(positions(str(at(f"k.{ending}"))), points.astype("f4")))
            run(adwave, "saliency", "sample:knot", "-o", at(f"s.{ending}"))
            names = vars(pygltflib.GLTF2().load(str(at(f"s.{ending}"))).meshes[0].primitives[0].attributes)
            good &= said(f"{ending} of adwave in pygltflib, the field", any(name.startswith("_") and value is not None for name, value in names.items()))
        # Two nodes that turn and shift one mesh.
        scene = trimesh.Scene()
        turn = trimesh.transformations.euler_matrix(0.3, -0.4, 1.1)
        turn[:3, 3] = [5, 6, 7]
        scene.add_geometry(mesh, transform=turn, geom_name="one")
        scene.add_geometry(mesh, transform=np.eye(4), geom_name="one")
        scene.export(at("scene.glb"))
        run(adwave, "convert", at("scene.glb"), "-o", at("scene.ply"))
        points, faces, _ = read_ply(at("scene.ply"))
        other = trimesh.load(at("scene.glb"), process=False).to_geometry()
        good &= said("scene of trimesh read, as many points and faces", (len(points), len(faces)) == (len(other.vertices), len(other.faces)))
        def order(p):
            return p[np.lexsort(np.round(p, 6).T)]

        far = np.abs(order(points) - order(np.asarray(other.vertices))).max()
        good &= said(f"scene of trimesh read, where its nodes put it (within {far:.1e})", far < 1e-5)
        run(adwave, "filter", at("scene.glb"), "-o", at("smooth.glb"), "--preset", "smooth")
        smooth = pygltflib.GLTF2().load(str(at("smooth.glb")))
        before = pygltflib.GLTF2().load(str(at("scene.glb")))
        good &= said("scene after a filter, the same nodes and materials", len(smooth.nodes) == len(before.nodes) and smooth.materials == before.materials)
        # A scan with a pose.
        n = 5000
        points = np.random.default_rng(2).normal(size=(n, 3))
        with pye57.E57(str(at("scan.e57")), mode="w") as file:
            columns = {"cartesianX": points[:, 0], "cartesianY": points[:, 1], "cartesianZ": points[:, 2], "intensity": points[:, 2] ** 2}
            columns |= {f"color{c}": np.arange(n, dtype=np.uint8) for c in ("Red", "Green", "Blue")}
            file.write_scan_raw(columns, rotation=np.array([np.sqrt(0.5), 0, 0, np.sqrt(0.5)]), translation=np.array([1.0, 2.0, 3.0]))
        run(adwave, "convert", at("scan.e57"), "-o", at("scan.ply"))
        with pye57.E57(str(at("scan.e57"))) as file:
            raw = file.read_scan(0, ignore_missing_fields=True, transform=True, intensity=True, colors=True)
        own, _, columns = read_ply(at("scan.ply"))
        placed = np.stack([raw["cartesianX"], raw["cartesianY"], raw["cartesianZ"]], axis=1)
        good &= said("scan of pye57 read, same points", np.abs(own - placed).max() < 1e-12)
        good &= said("scan of pye57 read, same colors and intensity", np.array_equal(columns["red"], raw["colorRed"]) and np.allclose(columns["intensity"], raw["intensity"], atol=0))
        told = json.loads(run(adwave, "info", at("scan.e57"), "--json"))
        good &= said("scan of pye57 in info", str(n) in json.dumps(told))
    raise SystemExit(0 if good else 1)


if __name__ == "__main__":
    main()
