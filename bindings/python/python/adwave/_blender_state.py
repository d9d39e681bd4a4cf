"""State of a split mesh in Blender: gains, region and options, stored in the mesh, and their effect on its points."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import numpy as np
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    StringProperty,
)

from adwave import _blender_mesh as own

Report = Callable[[int, int], object]

#: What is computed from split meshes, by their `session_uid`; made again where it is missing.
splits: dict[int, own.Split] = {}
_quiet = False

ERRORS = (ValueError, TypeError, MemoryError, ArithmeticError, IndexError, RuntimeError)


def sentence(error: BaseException) -> str:
    text = " ".join(str(error).split()) or type(error).__name__
    text = text[0].upper() + text[1:]
    return text if text.endswith((".", "!", "?")) else text + "."


def refuse(mesh: Any) -> None:
    """Raise `ValueError` if the points of a mesh cannot be moved."""
    if mesh.library is not None or not mesh.is_editable:
        raise ValueError(f"the mesh {mesh.name!r} belongs to another file; make it local first")
    if mesh.shape_keys is not None:
        raise ValueError(
            f"the mesh {mesh.name!r} has shape keys, which hold points of their own; apply or remove them first"
        )
    if mesh.is_editmode:
        raise ValueError(f"the mesh {mesh.name!r} is in edit mode; go to object mode first")


def is_split(mesh: Any) -> bool:
    return len(mesh.adwave.bands) > 0 and own.ORIGINAL in mesh.attributes


def is_ours(mesh: Any) -> bool:
    """True if faces and points are unchanged since the sliders moved them."""
    state = mesh.adwave
    return own.connections(mesh) == state.connections and own.checksum(own.points_of(mesh)) == state.written


def split_of(mesh: Any, report: Report | None = None) -> own.Split:
    original = own.points_of(mesh, own.ORIGINAL)
    made_of = (own.checksum(original), mesh.adwave.connections, mesh.adwave.split_levels)
    found = splits.get(mesh.session_uid)
    if found is None or found.made_of != made_of:
        found = splits[mesh.session_uid] = own.Split(mesh, original, mesh.adwave.split_levels, report)
    return found


def owner(mesh: Any, context: Any) -> Any:
    if context.object is not None and context.object.data == mesh:
        return context.object
    return next((thing for thing in bpy.data.objects if thing.data == mesh), None)


def weights(mesh: Any, context: Any, split: own.Split | None = None) -> np.ndarray | None:
    """Weights of the chosen region, (n,); None for all vertices."""
    state = mesh.adwave
    if state.region == "SELECTED":
        return own.selected(mesh)
    if state.region == "ALL" or not state.group:
        return None
    if split is not None and split.group is not None and split.group[0] == state.group:
        return split.group[1]
    thing = owner(mesh, context)
    group = thing.vertex_groups.get(state.group) if thing else None
    if group is None:
        raise ValueError(f"there is no vertex group {state.group!r}")
    weights = own.group_weights(mesh, group.index)
    if split is not None:
        split.group = (state.group, weights)
    return weights


def moved(mesh: Any, context: Any, split: own.Split, gains: list[float]) -> np.ndarray:
    state = mesh.adwave
    where = weights(mesh, context, split)
    return split.points(gains, where, state.along.lower(), state.border.lower(), state.keep_volume)


def write(mesh: Any, points: np.ndarray) -> None:
    own.put_points(mesh, points)
    mesh.adwave.written = own.checksum(points)


def show(mesh: Any, context: Any, report: Report | None = None) -> None:
    """Move the points according to the gains."""
    state = mesh.adwave
    refuse(mesh)
    thing = owner(mesh, context)
    if thing is not None and thing.mode != "OBJECT":
        raise ValueError(f"{thing.name!r} is not in object mode; go there first")
    if not is_ours(mesh):
        raise ValueError("the mesh was edited after it was split; Split takes it as it is now")
    write(mesh, moved(mesh, context, split_of(mesh, report), [band.gain for band in state.bands]))


def changed(self: Any, context: Any) -> None:
    """Update the points after a slider was moved."""
    mesh = self.id_data
    if _quiet or not is_split(mesh):
        return
    try:
        show(mesh, context)
        said = ""
    except ERRORS as error:
        said = sentence(error)
    if mesh.adwave.message != said:
        mesh.adwave.message = said


@contextmanager
def together() -> Iterator[None]:
    """Context in which several properties are set and the points move once."""
    global _quiet
    _quiet = True
    try:
        yield
    finally:
        _quiet = False


def end(mesh: Any) -> None:
    """Remove the bands of a mesh; its points are unchanged."""
    state = mesh.adwave
    state.bands.clear()
    state.message = state.written = state.connections = ""
    if (attribute := mesh.attributes.get(own.ORIGINAL)) is not None:
        mesh.attributes.remove(attribute)
    splits.pop(mesh.session_uid, None)


class AdwaveBand(bpy.types.PropertyGroup):
    """Slider of one band."""

    gain: FloatProperty(
        name="Gain",
        description="0 takes the band away, 1 leaves it, 2 doubles it",
        default=1.0,
        min=-100.0,
        max=100.0,
        soft_min=0.0,
        soft_max=4.0,
        step=5,
        precision=2,
        options=set(),  # not animated: keyframes would not move the points
        update=changed,
    )
    sigma: FloatProperty(name="Width", description="How far the band's waves reach, in the mesh's own units")


class AdwaveState(bpy.types.PropertyGroup):
    """Properties of a mesh in the panel, which are saved and undone with it."""

    bands: CollectionProperty(type=AdwaveBand)
    levels: IntProperty(
        name="Levels", description="How many bands; 0 for as many as fit", default=0, min=0, max=24, soft_max=12
    )
    region: EnumProperty(
        name="Region",
        description="Where the points move",
        items=[
            ("ALL", "Everywhere", "All vertices"),
            ("SELECTED", "Selected", "Vertices that are selected in edit mode"),
            ("GROUP", "Vertex Group", "Vertices of a group, as much as their weights say"),
        ],
        update=changed,
    )
    group: StringProperty(name="Vertex Group", update=changed)
    border: EnumProperty(
        name="Borders",
        description="What becomes of open borders",
        items=[
            ("NATURAL", "Natural", "Open parts move along their normals, so that their outline is not drawn in"),
            ("KEEP", "Keep", "Vertices on a border stay where they are"),
            ("FREE", "Free", "Borders move as the bands have it"),
        ],
        update=changed,
    )
    along: EnumProperty(
        name="Direction",
        description="Which way vertices may move",
        items=[
            ("AUTO", "Any", "All directions; open parts as Borders says"),
            ("NORMAL", "Normals", "Along the normals: the spacing of the vertices stays"),
            ("SURFACE", "Surface", "Within the surface: evens out the spacing of the vertices"),
            ("X", "X", "Along the mesh's x axis"),
            ("Y", "Y", "Along the mesh's y axis"),
            ("Z", "Z", "Along the mesh's z axis, as heights of a terrain should"),
        ],
        update=changed,
    )
    keep_volume: BoolProperty(name="Keep Volume", description="Closed meshes keep their volume; slower", update=changed)
    split_levels: IntProperty()
    connections: StringProperty()
    written: StringProperty()
    message: StringProperty()


@bpy.app.handlers.persistent
def forget_weights(*_: Any) -> None:
    """Discard stored weights, since they may have been painted or undone."""
    thing = bpy.context.object
    if thing is not None and thing.type == "MESH" and thing.mode != "OBJECT" and thing.data.session_uid in splits:
        splits[thing.data.session_uid].group = None


@bpy.app.handlers.persistent
def forget_all_weights(*_: Any) -> None:
    for split in splits.values():
        split.group = None


@bpy.app.handlers.persistent
def forget_all(*_: Any) -> None:
    """Discard the bands of the previous file."""
    splits.clear()


def handlers() -> list[tuple[Any, Callable[..., None]]]:
    of = bpy.app.handlers
    return [
        (of.depsgraph_update_post, forget_weights),
        (of.undo_post, forget_all_weights),
        (of.redo_post, forget_all_weights),
        (of.load_pre, forget_all),
    ]
