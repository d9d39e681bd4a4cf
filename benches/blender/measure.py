"""Time of a slider of the Blender add-on, from the property to new coordinates in the mesh.

pip install -r requirements.txt (Python 3.11), and adwave; then: python measure.py
"""

from __future__ import annotations

import time

import adwave as aw
import adwave.blender
import bpy
import numpy as np

MOVES = 21


def added(shape: aw.Shape, name: str) -> bpy.types.Object:
    """The shape as the active object."""
    corners = np.asarray(shape.faces, np.int32)
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(shape.n_vertices)
    mesh.vertices.foreach_set("co", np.asarray(shape.points, np.float32).ravel())
    mesh.loops.add(corners.size)
    mesh.loops.foreach_set("vertex_index", corners.ravel())
    mesh.polygons.add(len(corners))
    mesh.polygons.foreach_set("loop_start", np.arange(0, corners.size, 3, dtype=np.int32))
    mesh.update(calc_edges=True)
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    return thing


def moved(mesh: bpy.types.Mesh, k: int) -> float:
    """Milliseconds of one move of the third slider."""
    started = time.perf_counter()
    mesh.adwave.bands[2].gain = 1.01 + k / MOVES
    took = 1e3 * (time.perf_counter() - started)
    if mesh.adwave.message:
        raise RuntimeError(mesh.adwave.message)
    return took


def main() -> None:
    """Print a row for each shape."""
    adwave.blender.register()
    print("| shape | vertices | bands | Split, s | slider, ms | in a vertex group, ms |\n|---|---|---|---|---|---|")
    for name in ("creature", "plane"):
        for vertices in (50_000, 500_000):
            thing = added(aw.sample(name, vertices=vertices), name)
            mesh = thing.data
            started = time.perf_counter()
            bpy.ops.adwave.split()
            split = time.perf_counter() - started
            everywhere = np.median([moved(mesh, k) for k in range(MOVES)])
            thing.vertex_groups.new(name="half").add(list(range(0, len(mesh.vertices), 2)), 0.5, "REPLACE")
            mesh.adwave.group = "half"
            mesh.adwave.region = "GROUP"
            within = np.median([moved(mesh, k) for k in range(MOVES)])
            row = f"{name} | {len(mesh.vertices)} | {len(mesh.adwave.bands)} | {split:.1f}"
            print(f"| {row} | {everywhere:.1f} | {within:.1f} |")
            bpy.ops.adwave.cancel()


if __name__ == "__main__":
    main()
