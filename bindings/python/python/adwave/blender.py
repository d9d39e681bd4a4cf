"""An add-on for Blender 4.2 and newer: an equalizer for meshes in the sidebar of the 3D view, with denoising and saliency.

`python -m adwave.blender --zip adwave-blender.zip` writes what Blender installs (Edit, Preferences, Get Extensions, Install from Disk);
the panel is then in the tab *adwave*. In a script, where Blender's Python has adwave, two lines do:

    import adwave.blender
    adwave.blender.register()

Only coordinates change: faces, modifiers, materials and attributes stay. The original points and the gains are kept in the mesh, so that
Blender's undo, copies and saved files have them. Errors are one sentence, where Blender shows its own.
"""

if __name__ == "__main__":  # not in Blender: make the add-on
    from adwave._blender_zip import main

    raise SystemExit(main())

import textwrap
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

import adwave
from adwave import _blender_mesh as own
from adwave._blender_state import (
    ERRORS,
    AdwaveBand,
    AdwaveState,
    Report,
    end,
    handlers,
    is_ours,
    is_split,
    moved,
    refuse,
    sentence,
    show,
    splits,
    together,
    weights,
    write,
)

__all__ = ["bl_info", "register", "unregister"]

bl_info = {
    "name": "adwave",
    "description": "An equalizer for shapes: smooth, enhance and denoise meshes by bands from fine to coarse",
    "author": "The adwave developers",
    "version": (0, 1, 0),
    "blender": (4, 2, 0),
    "location": "3D View > Sidebar > adwave",
    "category": "Mesh",
}


@contextmanager
def _waiting(context: Any) -> Iterator[Report]:
    """Blender's wait cursor with its percentage."""
    window, manager = context.window, context.window_manager
    if window is not None:
        window.cursor_modal_set("WAIT")
    manager.progress_begin(0, 100)
    try:
        yield lambda done, total: manager.progress_update(100 * done / max(total, 1))
    finally:
        manager.progress_end()
        if window is not None:
            window.cursor_modal_restore()


class _OnMesh(bpy.types.Operator):
    """An operator on the mesh of the active object."""

    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012 (as Blender wants it)
    needs_split = False

    @classmethod
    def poll(cls, context: Any) -> bool:
        thing = context.active_object
        if thing is None or thing.type != "MESH":
            cls.poll_message_set("The active object is no mesh.")
            return False
        if thing.mode != "OBJECT":
            cls.poll_message_set("Go to object mode first.")
            return False
        if cls.needs_split and not is_split(thing.data):
            cls.poll_message_set("Split the mesh into bands first.")
            return False
        return True

    def execute(self, context: Any) -> set[str]:
        """Called by Blender."""
        mesh = context.active_object.data
        try:
            with _waiting(context) as report:
                self._do(context, mesh, report)
        except ERRORS as error:
            self.report({"ERROR"}, sentence(error))
            return {"CANCELLED"}
        mesh.adwave.message = ""
        return {"FINISHED"}

    def _do(self, context: Any, mesh: Any, report: Report) -> None:
        raise NotImplementedError


class AdwaveSplit(_OnMesh):
    """Split the mesh into bands from fine to coarse, with a slider for each. A split mesh keeps its gains"""

    bl_idname = "adwave.split"
    bl_label = "Split into Bands"
    levels: IntProperty(name="Levels", description="How many bands; 0 for as many as fit", default=0, min=0, max=24)

    def invoke(self, context: Any, event: Any) -> set[str]:
        """Run with the options of the panel."""
        self.levels = context.active_object.data.adwave.levels
        return self.execute(context)

    def _do(self, context: Any, mesh: Any, report: Report) -> None:
        refuse(mesh)
        state = mesh.adwave
        alive = {other.session_uid for other in bpy.data.meshes}
        for gone in splits.keys() - alive:
            del splits[gone]
        again = is_split(mesh) and is_ours(mesh)
        original = own.points_of(mesh, own.ORIGINAL if again else "position")
        split = own.Split(mesh, original, self.levels, report)
        sigmas = split.bands.sigma
        kept = [band.gain for band in state.bands] if again else []
        gains = [*kept, *[1.0] * len(sigmas)][: len(sigmas)]
        # What may fail comes before the first change, and what the first slider would wait for is made.
        points = moved(mesh, context, split, gains)
        own.put_field(mesh, own.ORIGINAL, "FLOAT_VECTOR", "vector", original)
        splits[mesh.session_uid] = split
        state.levels = state.split_levels = self.levels
        state.connections = own.connections(mesh)
        with together():
            state.bands.clear()
            for gain, sigma in zip(gains, sigmas, strict=True):
                band = state.bands.add()
                band.gain, band.sigma = gain, sigma
        write(mesh, points)


class AdwaveGains(_OnMesh):
    """Set all sliders at once"""

    bl_idname = "adwave.gains"
    bl_label = "Preset"
    needs_split = True
    preset: EnumProperty(
        name="Preset",
        items=[
            ("reset", "Reset", "All gains 1: the original points"),
            ("smooth", "Smooth", "All bands away but the last, which is doubled: limbs and volume stay"),
            ("enhance", "Enhance", "Details stronger"),
            ("base", "Base", "All gains 0: the base without its detail, to be sculpted or posed"),
        ],
    )

    def _do(self, context: Any, mesh: Any, report: Report) -> None:
        bands = mesh.adwave.bands
        level = {"reset": 1.0, "base": 0.0}.get(self.preset)
        gains = adwave.preset_gains(self.preset, len(bands)) if level is None else [level] * len(bands)
        before = [band.gain for band in bands]
        with together():
            for band, gain in zip(bands, gains, strict=True):
                band.gain = gain
            try:
                show(mesh, context, report)
            except ERRORS:
                for band, gain in zip(bands, before, strict=True):
                    band.gain = gain
                raise


class AdwaveRebase(_OnMesh):
    """Put the original's detail onto the sculpted base. Set the preset Base, sculpt or pose it, and press this"""

    bl_idname = "adwave.rebase"
    bl_label = "Put Detail Back"
    needs_split = True

    def _do(self, context: Any, mesh: Any, report: Report) -> None:
        refuse(mesh)
        state = mesh.adwave
        if own.connections(mesh) != state.connections:
            raise ValueError("the mesh has other faces than when it was split; sculpt without adding or removing any")
        if any(band.gain != 0 for band in state.bands):
            raise ValueError("the detail is still there; set the preset Base, sculpt, and put the detail back then")
        split = splits.get(mesh.session_uid)
        original = own.points_of(mesh, own.ORIGINAL)
        if split is None:
            split = own.Split(mesh, original, state.split_levels, report)
        points = split.with_base(own.points_of(mesh))
        # The result is the new original, with all of its detail.
        fresh = own.Split(mesh, points, state.split_levels, report)
        own.put_field(mesh, own.ORIGINAL, "FLOAT_VECTOR", "vector", points)
        splits[mesh.session_uid] = fresh
        with together():
            for band, sigma in zip(state.bands, fresh.bands.sigma, strict=False):
                band.gain, band.sigma = 1.0, sigma
        write(mesh, points)


class AdwaveApply(_OnMesh):
    """Keep the current points, and remove the sliders"""

    bl_idname = "adwave.apply"
    bl_label = "Apply"
    needs_split = True

    def _do(self, context: Any, mesh: Any, report: Report) -> None:
        end(mesh)


class AdwaveCancel(_OnMesh):
    """Restore the points from before the split, and remove the sliders"""

    bl_idname = "adwave.cancel"
    bl_label = "Cancel"
    needs_split = True

    def _do(self, context: Any, mesh: Any, report: Report) -> None:
        refuse(mesh)
        if own.connections(mesh) != mesh.adwave.connections:
            raise ValueError("the mesh has other faces than when it was split; Apply keeps it as it is, Undo goes back")
        own.put_points(mesh, own.points_of(mesh, own.ORIGINAL))
        end(mesh)


class AdwaveDenoise(_OnMesh):
    """Remove noise without tuning; creases are preserved"""

    bl_idname = "adwave.denoise"
    bl_label = "Denoise"
    strength: FloatProperty(
        name="Strength",
        description="1 for the noise that is found, less to keep more of it, more to take more away",
        default=1.0,
        min=0.0,
        soft_max=3.0,
    )
    creases: EnumProperty(
        name="Creases",
        items=[
            ("auto", "Automatic", "What the noise leaves to see"),
            ("keep", "Keep", "Sharp edges stay"),
            ("none", "Smooth", "Sharp edges are smoothed as all else"),
        ],
    )

    def _do(self, context: Any, mesh: Any, report: Report) -> None:
        refuse(mesh)
        if is_split(mesh):
            raise ValueError("the mesh is split into bands; Apply or Cancel first")
        before = own.points_of(mesh)
        shape = own.shape_of(mesh, before)
        if shape.kind == "graph":
            raise ValueError("the mesh has edges alone; denoising needs faces")
        where = weights(mesh, context)
        clean, found = adwave.denoise(shape, strength=self.strength, creases=self.creases, progress=report)
        after = clean.points.astype(np.float32)
        if where is not None:
            was = before.reshape(-1, 3)
            after = (was + where[:, None] * (clean.points - was)).astype(np.float32)
        own.put_points(mesh, after.ravel())
        self.report({"INFO"}, f"Noise of {found['noise_in_edges']:.2g} mean edges.")


class AdwaveSaliency(_OnMesh):
    """Show convex (red) and concave (blue) parts of the surface, as an attribute of numbers and one of colors"""

    bl_idname = "adwave.saliency"
    bl_label = "Saliency"
    name: StringProperty(name="Name", description="Of the attribute; the colors' ends in _color", default="saliency")
    show: BoolProperty(name="Show", description="Color this view's solid shading by attributes", default=True)

    def _do(self, context: Any, mesh: Any, report: Report) -> None:
        if mesh.is_editmode or not mesh.is_editable:
            refuse(mesh)
        shape = own.shape_of(mesh, own.points_of(mesh))
        if shape.kind == "graph":
            raise ValueError("the mesh has edges alone; saliency needs faces")
        values = np.nan_to_num(np.asarray(adwave.saliency(shape, progress=report)))
        colors = f"{self.name}_color"
        own.put_field(mesh, self.name, "FLOAT", "value", values.astype(np.float32))
        own.put_field(mesh, colors, "FLOAT_COLOR", "color", own.colors_of(values))
        mesh.color_attributes.active_color = mesh.color_attributes[colors]
        mesh.update()
        space = context.space_data
        if self.show and space is not None and space.type == "VIEW_3D":
            space.shading.color_type = "VERTEX"


# The panel


class VIEW3D_PT_adwave(bpy.types.Panel):
    """The tab *adwave*."""

    bl_label = "Bands"
    bl_category = "adwave"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"

    def draw(self, context: Any) -> None:
        """Called by Blender."""
        column = self.layout.column()
        thing = context.active_object
        if thing is None or thing.type != "MESH":
            column.label(text="Choose a mesh.")
            return
        mesh, state = thing.data, thing.data.adwave
        column.enabled = thing.mode == "OBJECT"
        if thing.mode != "OBJECT":
            column.label(text="In object mode only.", icon="INFO")
        if is_split(mesh):
            units = context.scene.unit_settings
            for j, band in enumerate(state.bands, 1):
                size = band.sigma * units.scale_length
                width = bpy.utils.units.to_string(units.system, "LENGTH", size, precision=4)
                column.prop(band, "gain", text=f"{j}  ({width})", slider=True)
            row = column.row(align=True)
            for preset, name in (("reset", "Reset"), ("smooth", "Smooth"), ("enhance", "Enhance"), ("base", "Base")):
                row.operator("adwave.gains", text=name).preset = preset
            column.operator("adwave.rebase", icon="MOD_MULTIRES")
        if state.message:
            # A label has one line, and letters are about 7 wide.
            for k, line in enumerate(textwrap.wrap(state.message, max(20, context.region.width // 7))):
                column.label(text=line, icon="BLANK1" if k else "ERROR")
        row = column.row(align=True)
        row.prop(state, "levels", text="Levels" if state.levels else "Levels (automatic)")
        row.operator("adwave.split", text="Split Again" if is_split(mesh) else "Split")
        column.separator()
        column.prop(state, "region")
        if state.region == "GROUP":
            column.prop_search(state, "group", thing, "vertex_groups", text="Group")
        if is_split(mesh):
            column.prop(state, "along")
            column.prop(state, "border")
            column.prop(state, "keep_volume")
            row = column.row(align=True)
            row.operator("adwave.apply", icon="CHECKMARK")
            row.operator("adwave.cancel", icon="X")
        column.separator()
        row = column.row(align=True)
        row.operator("adwave.denoise")
        row.operator("adwave.saliency")


# Registration

_CLASSES = (
    AdwaveBand,
    AdwaveState,
    AdwaveSplit,
    AdwaveGains,
    AdwaveRebase,
    AdwaveApply,
    AdwaveCancel,
    AdwaveDenoise,
    AdwaveSaliency,
    VIEW3D_PT_adwave,
)


def register() -> None:
    """Register the add-on; Blender calls this when it is enabled."""
    for each in _CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Mesh.adwave = PointerProperty(type=AdwaveState)
    for called, function in handlers():
        called.append(function)


def unregister() -> None:
    """Unregister the add-on; Blender calls this when it is disabled."""
    for called, function in handlers():
        if function in called:
            called.remove(function)
    del bpy.types.Mesh.adwave
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
    splits.clear()
