"""`docs/blender.png`: the built-in creature before, smoothed, enhanced and colored by saliency, drawn by Blender.

pip install -r requirements.txt (Python 3.11), and adwave; then: python picture.py ../../docs/blender.png
"""

from __future__ import annotations

import math
import sys
import tempfile
from pathlib import Path

import adwave as aw
import adwave.blender
import bpy
import numpy as np
from mathutils import Vector
from PIL import Image

SIZE = (1400, 470)
DISTANCE = 1.75
#: Fine to coarse.
STRONGER = (1, 2, 2.5, 2.5, 2.5, 2, 1.5)


def material(colors: str | None) -> bpy.types.Material:
    """Clay, or the colors of an attribute."""
    made = bpy.data.materials.new("surface")
    made.use_nodes = True
    surface = made.node_tree.nodes["Principled BSDF"]
    surface.inputs["Roughness"].default_value = 0.45
    surface.inputs["Base Color"].default_value = (0.5, 0.36, 0.22, 1)
    if colors:
        node = made.node_tree.nodes.new("ShaderNodeVertexColor")
        node.layer_name = colors
        made.node_tree.links.new(node.outputs["Color"], surface.inputs["Base Color"])
    return made


def added(shape: aw.Shape, place: int) -> bpy.types.Mesh:
    """The shape as the active object, in one of the places from left to right."""
    points = np.asarray(shape.points)
    center = (points.min(axis=0) + points.max(axis=0)) / 2
    mesh = bpy.data.meshes.new("creature")
    mesh.from_pydata((points - center).tolist(), [], np.asarray(shape.faces).tolist())
    mesh.shade_smooth()
    thing = bpy.data.objects.new("creature", mesh)
    thing.location.x = DISTANCE * place
    thing.rotation_euler = (math.radians(90), 0, math.radians(-12))
    bpy.context.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    return mesh


def turned(thing: bpy.types.Object, toward: Vector) -> None:
    """Point a camera or a light somewhere, and put it into the scene."""
    thing.rotation_euler = toward.to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(thing)


def scene() -> None:
    """Camera, lights, a plain background."""
    here = bpy.context.scene
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 3 * DISTANCE + 1.98
    middle = Vector((1.5 * DISTANCE, 0, -0.05))
    camera.location = middle + Vector((0, -10, 3))
    turned(camera, middle - camera.location)
    here.camera = camera
    for place, energy, width in (((-4, -2.5, 3.5), 2.6, 0.2), ((5, -2, 1), 0.9, 0.6)):
        sun = bpy.data.lights.new("sun", "SUN")
        sun.energy, sun.angle = energy, width
        turned(bpy.data.objects.new("sun", sun), -Vector(place))
    world = here.world = bpy.data.worlds.new("world")
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    light, seen = nodes["Background"], nodes.new("ShaderNodeBackground")
    light.inputs[0].default_value, light.inputs[1].default_value = (1, 1, 1, 1), 0.35
    seen.inputs[0].default_value = (0.87, 0.88, 0.9, 1)
    path, mix = nodes.new("ShaderNodeLightPath"), nodes.new("ShaderNodeMixShader")
    links.new(path.outputs["Is Camera Ray"], mix.inputs[0])
    links.new(light.outputs[0], mix.inputs[1])
    links.new(seen.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], nodes["World Output"].inputs[0])
    here.render.engine, here.cycles.device = "CYCLES", "CPU"
    here.cycles.samples, here.cycles.use_denoising = 32, True
    here.render.resolution_x, here.render.resolution_y = SIZE
    here.view_settings.view_transform = "Standard"
    here.render.image_settings.color_mode = "RGB"


def main(target: Path) -> None:
    """Draw it, in 256 colors."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    adwave.blender.register()
    shape = aw.sample("creature", vertices=40_000)
    for place in range(4):
        mesh = added(shape, place)
        if place in (1, 2):
            bpy.ops.adwave.split(levels=len(STRONGER))
            if place == 1:
                bpy.ops.adwave.gains(preset="smooth")
            else:
                for band, gain in zip(mesh.adwave.bands, STRONGER, strict=True):
                    band.gain = gain
            bpy.ops.adwave.apply()
        if place == 3:
            bpy.ops.adwave.saliency()
        mesh.materials.append(material("saliency_color" if place == 3 else None))
    scene()
    with tempfile.TemporaryDirectory() as folder:
        bpy.context.scene.render.filepath = f"{folder}/raw.png"
        bpy.ops.render.render(write_still=True)
        picture = Image.open(f"{folder}/raw.png").convert("RGB")
    # Largest coverage first, since red and blue are few; then the nearest of all.
    few = picture.quantize(256, method=Image.Quantize.MAXCOVERAGE, kmeans=40, dither=Image.Dither.NONE)
    few.save(target, optimize=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
