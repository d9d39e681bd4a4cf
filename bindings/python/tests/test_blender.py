"""The add-on, in Blender without a window.

Blender as a module is some hundreds of megabytes and fits one Python each, so that it is not among the packages of the tests; where it
is, these run: ``pip install bpy==4.5.*`` with Python 3.11, then ``pytest tests/test_blender.py``.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import adwave as aw
import numpy as np
import pytest

pytest.importorskip("bpy", reason="Blender as a Python module (bpy) is not installed")

import bpy
from adwave import _blender_mesh as own
from adwave import _blender_state, _blender_zip, blender

#: Positions of single precision.
SINGLE = 1e-6
SHAPE = aw.sample("creature", vertices=2000)
# Two quads, a triangle and a pentagon.
ODD = [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 6], [4, 5, 7, 8, 6]]
PLACES = [
    [-0.0, 0, 0],
    [1, 0, 0.3],
    [2, 0, 0],
    [0, 1, 0.2],
    [1, 1, 0.9],
    [2, 1, 0],
    [0.5, 2, 0],
    [2, 2, 1 / 3],
    [1.2, 2.5, 0.1],
]


@pytest.fixture(autouse=True)
def addon() -> Iterator[None]:
    blender.register()
    yield
    if bpy.context.object is not None and bpy.context.object.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    blender.unregister()


def added(places: Any, faces: Any = (), edges: Any = ()) -> Any:
    mesh = bpy.data.meshes.new("mesh")
    lists = [np.asarray(places).tolist(), np.asarray(edges, int).tolist(), [[int(v) for v in face] for face in faces]]
    mesh.from_pydata(*lists)
    thing = bpy.data.objects.new("thing", mesh)
    bpy.context.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    return thing


def creature() -> Any:
    return added(SHAPE.points, SHAPE.faces)


def single(shape: aw.Shape) -> aw.Shape:
    """The shape at the positions that Blender has."""
    return shape.with_points(np.asarray(shape.points, np.float32).astype(float))


def points(mesh: Any) -> np.ndarray:
    return own.points_of(mesh).reshape(-1, 3)


def bits(array: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(array, np.float32).view(np.uint32)


def refused(operator: Callable[..., object], match: str, **given: Any) -> None:
    """It says so in one sentence, which Blender turns into an exception where a script called it."""
    with pytest.raises(RuntimeError, match=match) as caught:
        operator(**given)
    assert "Traceback" not in str(caught.value) and str(caught.value).rstrip().endswith(".")


def test_a_slider_moves_the_points_as_the_library_does() -> None:
    mesh = creature().data
    before = points(mesh)
    normals = np.array([vertex.normal[:] for vertex in mesh.vertices])
    assert bpy.ops.adwave.split(levels=5) == {"FINISHED"}
    assert len(mesh.adwave.bands) == 5 and np.array_equal(bits(points(mesh)), bits(before))
    bands = aw.decompose(single(SHAPE), levels=5)
    assert np.allclose([band.sigma for band in mesh.adwave.bands], bands.sigma)
    split = _blender_state.splits[mesh.session_uid]
    mesh.adwave.bands[0].gain = 3
    assert np.array_equal(points(mesh), bands.apply([3, 1, 1, 1, 1]).astype(np.float32))
    mesh.adwave.bands[3].gain = 0
    # Bands are made once, and not by each slider.
    assert _blender_state.splits[mesh.session_uid] is split
    assert np.array_equal(points(mesh), bands.apply([3, 1, 1, 0, 1]).astype(np.float32))
    # Blender knows of it.
    assert np.abs(np.array([vertex.normal[:] for vertex in mesh.vertices]) - normals).max() > 0.01
    bpy.ops.adwave.gains(preset="smooth")
    assert np.array_equal(points(mesh), bands.apply("smooth").astype(np.float32))
    bpy.ops.adwave.gains(preset="reset")
    assert np.array_equal(bits(points(mesh)), bits(before)) and mesh.adwave.message == ""


def test_only_coordinates_change_and_cancel_gives_every_bit_back() -> None:
    thing = added(PLACES, ODD)
    mesh = thing.data
    mesh.uv_layers.new(name="map").data.foreach_set("uv", np.linspace(0, 1, 2 * len(mesh.loops)))
    mesh.attributes.new("mine", "INT", "FACE").data.foreach_set("value", np.arange(4, dtype=np.int32))
    thing.modifiers.new("finer", "SUBSURF").levels = 2
    thing.vertex_groups.new(name="some").add([1, 2], 0.5, "REPLACE")

    def rest() -> list[Any]:
        arrays = [own.raw(mesh, "map", "vector", 2, np.float32), own.raw(mesh, "mine", "value", 1, np.int32)]
        faces = [tuple(face.vertices) for face in mesh.polygons]
        return [
            *(a.tolist() for a in arrays),
            faces,
            thing.modifiers["finer"].levels,
            own.group_weights(mesh, 0).tolist(),
        ]

    before, others, names = points(mesh), rest(), {attribute.name for attribute in mesh.attributes}
    for operator, is_back in ((bpy.ops.adwave.cancel, True), (bpy.ops.adwave.apply, False)):
        mesh.adwave.border = "NATURAL"
        bpy.ops.adwave.split(levels=2)
        assert np.array_equal(bits(points(mesh)), bits(before))
        mesh.adwave.border = "FREE"
        mesh.adwave.bands[0].gain = 2.5
        moved = points(mesh)
        assert np.abs(moved - before).max() > 0.01 and rest() == others
        assert operator() == {"FINISHED"}
        assert np.array_equal(bits(points(mesh)), bits(before if is_back else moved))
        assert rest() == others and len(mesh.adwave.bands) == 0
        assert {attribute.name for attribute in mesh.attributes} == names
    assert np.signbit(before[0, 0]) and before[7, 2] == np.float32(1 / 3)


def test_undo_and_redo_take_sliders_and_points_together() -> None:
    name = creature().data.name
    bpy.ops.adwave.split(levels=4)
    mesh = bpy.data.meshes[name]
    bpy.ops.ed.undo_push(message="split")
    mesh.adwave.bands[0].gain = 3
    one = points(mesh)
    bpy.ops.ed.undo_push(message="one")
    mesh.adwave.bands[1].gain = 0
    two = points(mesh)
    bpy.ops.ed.undo_push(message="two")
    bpy.ops.ed.undo()
    mesh = bpy.data.meshes[name]
    assert np.array_equal(points(mesh), one) and [b.gain for b in mesh.adwave.bands] == [3, 1, 1, 1]
    bpy.ops.ed.redo()
    mesh = bpy.data.meshes[name]
    assert np.array_equal(points(mesh), two) and mesh.adwave.bands[1].gain == 0
    mesh.adwave.bands[1].gain = 1
    assert np.array_equal(points(mesh), one) and mesh.adwave.message == ""
    bpy.ops.adwave.apply()
    bpy.ops.ed.undo_push(message="applied")
    bpy.ops.ed.undo()
    # Even what was applied can be cancelled again.
    bpy.ops.adwave.cancel()
    assert np.array_equal(points(bpy.data.meshes[name]), np.asarray(SHAPE.points, np.float32))


def test_regions_blend_the_change() -> None:
    thing = creature()
    mesh, bands = thing.data, aw.decompose(single(SHAPE), levels=3)
    group = thing.vertex_groups.new(name="half")
    group.add(list(range(0, 1000)), 0.25, "REPLACE")
    weights = np.where(np.arange(len(mesh.vertices)) < 1000, 0.25, 0.0)
    bpy.ops.adwave.split(levels=3)
    mesh.adwave.bands[0].gain = 4
    mesh.adwave.group = "half"
    mesh.adwave.region = "GROUP"
    assert np.array_equal(points(mesh), bands.apply([4, 1, 1], weights).astype(np.float32))
    # What is painted counts.
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    group.add([0], 1.0, "REPLACE")
    bpy.context.view_layer.update()
    bpy.ops.object.mode_set(mode="OBJECT")
    mesh.adwave.bands[0].gain = 3
    weights[0] = 1.0
    assert np.array_equal(points(mesh), bands.apply([3, 1, 1], weights).astype(np.float32))
    flags = np.arange(len(mesh.vertices)) % 3 == 0
    mesh.vertices.foreach_set("select", flags)
    mesh.adwave.region = "SELECTED"
    assert np.array_equal(points(mesh), bands.apply([3, 1, 1], flags).astype(np.float32))
    assert np.array_equal(bits(points(mesh)[~flags]), bits(np.asarray(SHAPE.points, np.float32)[~flags]))
    mesh.adwave.group = "none"
    mesh.adwave.region = "GROUP"
    assert mesh.adwave.message == "There is no vertex group 'none'."


@pytest.mark.parametrize("levels", [0, 6])
def test_levels_are_automatic_or_a_number_and_gains_outlive_another_split(levels: int) -> None:
    mesh = creature().data
    bpy.ops.adwave.split(levels=levels)
    assert len(mesh.adwave.bands) == (levels or aw.decompose(SHAPE).n_levels)
    mesh.adwave.bands[1].gain = 2
    here = points(mesh)
    bpy.ops.adwave.split(levels=3)
    assert [band.gain for band in mesh.adwave.bands] == [1, 2, 1]
    # The same bands whatever their number, to the accuracy that each split has.
    assert np.abs(points(mesh) - here).max() < SINGLE
    bpy.ops.adwave.cancel()
    assert np.array_equal(points(mesh), np.asarray(SHAPE.points, np.float32))


def test_borders_directions_and_the_volume_are_those_of_the_library() -> None:
    plane = single(aw.sample("plane", vertices=900))
    mesh = added(plane.points, plane.faces).data
    bpy.ops.adwave.split(levels=3)
    mesh.adwave.bands[1].gain = 4
    for border in ("natural", "keep", "free"):
        for along in (None, "normal", "z"):
            mesh.adwave.border, mesh.adwave.along = border.upper(), (along or "auto").upper()
            expected = aw.filter(plane, [1, 4, 1], constraints=aw.Constraints(border=border, along=along))
            assert np.abs(points(mesh) - expected.points).max() < SINGLE, (border, along, mesh.adwave.message)
    mesh.adwave.keep_volume = True
    assert "closed" in mesh.adwave.message or "volume" in mesh.adwave.message
    closed = creature().data
    bpy.ops.adwave.split(levels=3)
    closed.adwave.keep_volume = True
    closed.adwave.bands[2].gain = 0
    expected = aw.filter(single(SHAPE), [1, 1, 0], constraints=aw.Constraints(volume="keep"))
    assert np.abs(points(closed) - expected.points).max() < SINGLE


def test_saliency_is_an_attribute_and_a_color() -> None:
    mesh = creature().data
    before = points(mesh)
    bpy.ops.adwave.saliency()
    expected = np.asarray(aw.saliency(single(SHAPE)))
    values = own.raw(mesh, "saliency", "value", 1, np.float32)
    assert np.array_equal(values, expected.astype(np.float32))
    colors = own.raw(mesh, "saliency_color", "color", 4, np.float32).reshape(-1, 4)
    assert mesh.color_attributes.active_color.name == "saliency_color"
    strong = np.abs(expected) > 0.01 * np.abs(expected).max()
    assert np.array_equal(colors[strong, 0] > colors[strong, 2], expected[strong] > 0) and (colors[:, 3] == 1).all()
    assert np.allclose(colors[expected.argmax(), :3], own.COLORS[2])
    assert np.array_equal(bits(points(mesh)), bits(before))
    bpy.ops.adwave.saliency()
    mesh.attributes.new("taken", "INT", "FACE")
    refused(bpy.ops.adwave.saliency, "'taken' is there and is of another kind", name="taken")


def test_denoising_is_that_of_the_library_and_keeps_to_the_region() -> None:
    noisy = single(aw.sample("sphere", vertices=2000, noise=0.2))
    mesh = added(noisy.points, noisy.faces).data
    clean = aw.denoise(noisy).result.points
    flags = noisy.points[:, 2] > 0
    mesh.vertices.foreach_set("select", flags)
    mesh.adwave.region = "SELECTED"
    bpy.ops.adwave.denoise()
    assert np.array_equal(points(mesh)[flags], clean[flags].astype(np.float32))
    assert np.array_equal(points(mesh)[~flags], noisy.points[~flags].astype(np.float32))
    bpy.ops.adwave.split(levels=2)
    refused(bpy.ops.adwave.denoise, "Apply or Cancel first")


def test_what_cannot_be_moved_is_refused_in_a_sentence() -> None:
    thing = creature()
    mesh = thing.data
    thing.shape_key_add(name="base")
    for operator in (bpy.ops.adwave.split, bpy.ops.adwave.denoise):
        refused(operator, "has shape keys, which hold points of their own")
    added([])
    refused(bpy.ops.adwave.split, "The mesh has no vertices")
    added([[0, 0, 0], [1, 0, float("nan")], [0, 1, 0]], [[0, 1, 2]])
    refused(bpy.ops.adwave.split, "row 1 is")
    mesh = creature().data
    bpy.ops.object.mode_set(mode="EDIT")
    refused(bpy.ops.adwave.split, "Go to object mode first")
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.adwave.split(levels=2)
    bpy.ops.object.mode_set(mode="EDIT")
    mesh.adwave.bands[0].gain = 2
    assert "edit mode" in mesh.adwave.message
    bpy.ops.object.mode_set(mode="SCULPT")
    mesh.adwave.bands[0].gain = 3
    assert "not in object mode" in mesh.adwave.message
    bpy.ops.object.mode_set(mode="OBJECT")
    mesh.adwave.bands[0].gain = 1
    assert mesh.adwave.message == ""


def test_work_of_other_tools_is_not_lost() -> None:
    mesh = creature().data
    bpy.ops.adwave.split(levels=2)
    mesh.vertices[5].co.x += 1
    here = points(mesh)
    mesh.adwave.bands[0].gain = 2
    assert np.array_equal(points(mesh), here) and "was edited after it was split" in mesh.adwave.message
    refused(bpy.ops.adwave.gains, "was edited", preset="smooth")
    assert mesh.adwave.bands[1].gain == 1
    bpy.ops.adwave.split(levels=2)
    assert np.array_equal(points(mesh), here) and mesh.adwave.bands[0].gain == 1 and mesh.adwave.message == ""
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    mesh.adwave.bands[0].gain = 2
    assert "was edited" in mesh.adwave.message
    refused(bpy.ops.adwave.cancel, "has other faces than when it was split")
    bpy.ops.adwave.apply()
    assert own.ORIGINAL not in mesh.attributes


def test_edges_alone_and_points_alone_have_bands_too() -> None:
    turn = np.linspace(0, 20, 400)
    places = np.column_stack([np.cos(turn), np.sin(turn), turn / 10]).astype(np.float32)
    edges = np.column_stack([np.arange(399), np.arange(1, 400)])
    for between in (edges, ()):
        mesh = added(places, edges=between).data
        bpy.ops.adwave.split(levels=2)
        mesh.adwave.bands[1].gain = 3
        assert mesh.adwave.message == "" and np.abs(points(mesh) - places).max() > 1e-4
        bpy.ops.adwave.cancel()
        assert np.array_equal(bits(points(mesh)), bits(places))
    added(places, edges=edges)
    refused(bpy.ops.adwave.saliency, "saliency needs faces")


def test_a_file_and_a_copy_hold_the_split(tmp_path: Path) -> None:
    thing = creature()
    bpy.ops.adwave.split(levels=3)
    thing.data.adwave.bands[0].gain = 3
    here, name = points(thing.data), thing.data.name
    copy = thing.data.copy()
    copy.adwave.bands[0].gain = 1
    assert np.array_equal(points(copy), np.asarray(SHAPE.points, np.float32))
    assert np.array_equal(points(thing.data), here)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"), check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    mesh = bpy.data.meshes[name]
    assert not _blender_state.splits and np.array_equal(points(mesh), here)
    mesh.adwave.bands[0].gain = 1
    assert mesh.adwave.message == "" and np.array_equal(points(mesh), np.asarray(SHAPE.points, np.float32))


class Recorder:
    """A layout that takes what Blender's would take, and refuses what that would refuse."""

    icons = frozenset(
        item.identifier for item in bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items
    )

    def __init__(self, said: list[str]) -> None:
        self.said, self.enabled, self.preset = said, True, ""

    def column(self, **_: Any) -> Recorder:
        return self

    row = column

    def separator(self) -> None:
        pass

    def label(self, text: str = "", icon: str = "NONE") -> None:
        assert icon in self.icons
        self.said.append(text)

    def prop(self, of: Any, name: str, text: str = "", slider: bool = False) -> None:
        assert name in of.bl_rna.properties
        self.said.append(text or of.bl_rna.properties[name].name)

    def prop_search(self, of: Any, name: str, other: Any, listed: str, text: str = "") -> None:
        assert name in of.bl_rna.properties and listed in other.bl_rna.properties
        self.said.append(text)

    def operator(self, name: str, text: str = "", icon: str = "NONE") -> Recorder:
        assert icon in self.icons
        self.said.append(text or getattr(bpy.ops.adwave, name.removeprefix("adwave.")).get_rna_type().name)
        return self


def drawn() -> list[str]:
    said: list[str] = []
    context = type("Context", (), {"active_object": bpy.context.active_object, "scene": bpy.context.scene})()
    context.region = type("Region", (), {"width": 200})()
    blender.VIEW3D_PT_adwave.draw(type("Panel", (), {"layout": Recorder(said)})(), context)
    return said


def test_the_panel_has_a_slider_for_each_band() -> None:
    thing = creature()
    assert drawn() == ["Levels (automatic)", "Split", "Region", "Denoise", "Saliency"]
    bpy.ops.adwave.split(levels=3)
    said = drawn()
    assert [text.split()[0] for text in said[:3]] == ["1", "2", "3"] and "m)" in said[0]
    assert said[3:6] == ["Reset", "Smooth", "Enhance"] and said[-4:] == ["Apply", "Cancel", "Denoise", "Saliency"]
    thing.data.adwave.region = "GROUP"
    assert "Group" in drawn()
    thing.data.vertices[0].co.x += 1
    thing.data.adwave.bands[0].gain = 2
    assert "was edited after it was split" in " ".join(drawn())
    bpy.ops.object.mode_set(mode="EDIT")
    assert drawn()[0] == "In object mode only."
    bpy.context.view_layer.objects.active = None
    assert drawn() == ["Choose a mesh."]
    bpy.context.view_layer.objects.active = thing


def test_nothing_is_left_when_it_is_switched_off() -> None:
    assert ".".join(map(str, blender.bl_info["version"])) == aw.__version__
    blender.unregister()
    assert not hasattr(bpy.types.Mesh, "adwave") and not hasattr(bpy.types, "VIEW3D_PT_adwave")
    for called, function in _blender_state.handlers():
        assert function not in called
    blender.register()


INSTALL = """
import sys, bpy
print(bpy.ops.extensions.package_install_files(filepath=sys.argv[1], repo="user_default", enable_on_install=True))
print(hasattr(bpy.types, "VIEW3D_PT_adwave"), hasattr(bpy.types, "VIEW3D_PT_adwave_missing"))
"""


@pytest.mark.parametrize("with_adwave", [True, False])
def test_blender_installs_the_zip(tmp_path: Path, with_adwave: bool) -> None:
    """In a Python whose only adwave is the one in the add-on."""
    path = tmp_path / "adwave-blender.zip"
    try:
        _blender_zip.write_addon(path, None if with_adwave else [])
    except ValueError as error:
        pytest.skip(f"{error}: there is no wheel to put into the add-on")
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment["BLENDER_USER_RESOURCES"] = str(tmp_path / "user")
    if (Path(bpy.__file__).parent.parent / "adwave").exists():
        pytest.skip("adwave is installed beside Blender: put it on PYTHONPATH instead")
    words = [sys.executable, "-c", INSTALL, str(path)]
    done = subprocess.run(words, capture_output=True, text=True, env=environment, cwd=tmp_path)
    said = "True False" if with_adwave else "False True"
    assert said in done.stdout, done.stdout + done.stderr
    assert with_adwave or "-m pip install adwave" in done.stdout


def test_the_detail_goes_back_onto_a_sculpted_base() -> None:
    mesh = creature().data
    before = points(mesh)
    bpy.ops.adwave.split(levels=5)
    refused(bpy.ops.adwave.rebase, "preset Base")
    bpy.ops.adwave.gains(preset="base")
    # Unchanged, the base gives the shape back, up to the single precision of what Blender stores.
    base = points(mesh)
    assert bpy.ops.adwave.rebase() == {"FINISHED"}
    assert np.abs(points(mesh) - before).max() < 1e-5
    assert [band.gain for band in mesh.adwave.bands] == [1.0] * 5
    bpy.ops.adwave.gains(preset="base")
    bent = (base + [0.3, 0, 0] * base[:, 1:2] ** 2).astype(np.float32)
    own.put_points(mesh, bent.ravel())
    bpy.ops.adwave.rebase()
    wanted = aw.decompose(single(SHAPE), levels=5).with_base(bent.astype(float))
    assert np.abs(points(mesh) - wanted).max() < 1e-4
    bpy.ops.adwave.gains(preset="reset")
    assert np.abs(points(mesh) - wanted).max() < 1e-4
