"""`__init__.py` of the add-on that `python -m adwave.blender` writes: it looks for adwave, and tells how to install it."""

import sys
from typing import Any

import bpy

try:
    from adwave import blender as _addon

    _why = ""
except ImportError as error:
    _addon = None
    _why = " ".join(str(error).split())

#: What installs adwave into the Python that Blender runs.
COMMAND = f'"{sys.executable}" -m pip install adwave'


class ADWAVE_OT_copy_command(bpy.types.Operator):
    """Copy the command that installs adwave"""

    bl_idname = "adwave.copy_command"
    bl_label = "Copy the Command"

    def execute(self, context: Any) -> set[str]:
        """Called by Blender."""
        context.window_manager.clipboard = COMMAND
        return {"FINISHED"}


class VIEW3D_PT_adwave_missing(bpy.types.Panel):
    """Panel that is shown if adwave is not installed."""

    bl_label = "adwave is not installed"
    bl_category = "adwave"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"

    def draw(self, context: Any) -> None:
        """Called by Blender."""
        column = self.layout.column()
        for line in ("Run this in a terminal,", "then start Blender again:", COMMAND):
            column.label(text=line)
        column.operator("adwave.copy_command", icon="COPYDOWN")
        column.label(text=_why, icon="ERROR")


_CLASSES = (ADWAVE_OT_copy_command, VIEW3D_PT_adwave_missing)


def register() -> None:
    """Register the add-on; Blender calls this when it is enabled."""
    if _addon is not None:
        _addon.register()
        return
    for each in _CLASSES:
        bpy.utils.register_class(each)
    print(f"adwave: {_why}; {COMMAND}")


def unregister() -> None:
    """Unregister the add-on; Blender calls this when it is disabled."""
    if _addon is not None:
        _addon.unregister()
        return
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
