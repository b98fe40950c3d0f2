"""Owns what tests of exports do in Blender with collections that empties place.

`blender_exports.py` runs it. Exports OUT/placed, and the same things one by one as OUT/flat.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
from reflet_blender import placed, things
from reflet_blender.export import Options, export_project
from reflet_blender.report import Report

import scenes


def put(name: str, held: bpy.types.Collection, into: Any = None) -> bpy.types.Object:
    """An empty that places a collection."""
    empty = bpy.data.objects.new(name, None)
    (into or bpy.context.scene.collection).objects.link(empty)
    empty.instance_type, empty.instance_collection = "COLLECTION", held
    return empty


def moved(thing: bpy.types.Object, into: bpy.types.Collection) -> bpy.types.Object:
    """Move an object from the scene into a collection."""
    bpy.context.scene.collection.objects.unlink(thing)
    into.objects.link(thing)
    return thing


def inner() -> bpy.types.Collection:
    """A box and a lamp, whose name needs quotes, with an origin of its own."""
    out = bpy.data.collections.new('the "inner"')
    out.instance_offset = (0.2, 0, 0)
    moved(scenes.box("box", (0.2, 0, 0.3), (0.3, 0.4, 0.6), scenes.principled("red")), out)
    moved(scenes.light("POINT", (0.2, 0.5, 1.2), (0, 0, 0), 20), out)
    return out


def scene() -> bpy.types.Scene:
    """Three empties: as it is, mirrored, and stretched aslant; each places two more and a ball."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scenes.camera((0, -8, 4), (0, 0, 0.3), 40)
    outer, hidden = (
        bpy.data.collections.new("outer"),
        bpy.data.collections.new("hidden"),
    )
    outer.children.link(hidden)
    hidden.hide_render = True
    moved(scenes.box("unseen", (0, 0, 50), (1, 1, 1), scenes.principled("green")), hidden)
    moved(scenes.ball("Cube.001", (0, -0.3, 0.25), 0.25, scenes.principled("blue")), outer)
    once = inner()
    put("nest", once, outer).location = (-0.7, 0.3, 0)
    turned = put("nest.001", once, outer)
    turned.location, turned.rotation_euler, turned.scale = (
        (0.7, 0.3, 0),
        (0, 0, 0.7),
        (1, 1.5, 1),
    )
    put("nest.002", once, outer).hide_render = True
    empties = [put(name, outer) for name in ("Empty", "Empty.001", "Empty.002")]
    for place, empty in enumerate(empties):
        empty.location.x = 3 * place
    empties[1].scale = (-1, 1, 1)
    stretched = scenes.add(bpy.data.objects.new("stretched", None))
    stretched.scale = (1, 1, 1.6)
    empties[2].parent, empties[2].rotation_euler = stretched, (0.4, 0, 0.5)
    empties[2].visible_camera = False
    # It has the name of a ball where `Empty` places one.
    scenes.box("Empty.Cube.001", (0, 2, 0.5), (0.5, 0.5, 1), scenes.principled("yellow"))
    return bpy.context.scene


def keyed() -> bpy.types.Scene:
    """The same, where an empty and the lamp in it move, another empty goes, and the lamp does too.

    An inner empty is hidden from the camera, which Blender asks of outer ones alone.
    """
    out = scene()
    out.frame_start, out.frame_end = 1, 5
    for name, at in (("Empty", (-1, 0, 0)), ("point", (0.2, 0.5, 2))):
        thing = bpy.data.objects[name]
        thing.keyframe_insert("location", frame=1)
        thing.location = at
        thing.keyframe_insert("location", frame=5)
    for name in ("Empty.001", "point"):
        gone = bpy.data.objects[name]
        gone.keyframe_insert("hide_render", frame=1)
        gone.hide_render = True
        gone.keyframe_insert("hide_render", frame=4)
    bpy.data.objects["nest"].visible_camera = False
    return out


def waving(root: Path) -> list[str]:
    """Place a mesh that shape keys move, in a collection with an origin of its own."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scenes.camera((0, -8, 4), (0, 0, 0.3), 40)
    held = bpy.data.collections.new("waving")
    held.instance_offset = (1, 0, 0)
    box = moved(scenes.box("flag", (1, 0, 0), (1, 1, 1), scenes.principled("red")), held)
    box.shape_key_add(name="Basis")
    key = box.shape_key_add(name="up")
    key.data[0].co.z += 1
    key.value = 0
    key.keyframe_insert("value", frame=1)
    key.value = 1
    key.keyframe_insert("value", frame=5)
    bpy.context.scene.frame_end = 5
    put("first", held)
    put("second", held).location = (3, 0, 0)
    return codes(bpy.context.scene, root)


def linked(root: Path) -> list[str]:
    """Place a collection of another file, as it is and overridden."""
    scene()
    library = root.parent / "collections.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(library))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scenes.camera((0, -8, 4), (0, 0, 0.3), 40)
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.collections = ["outer"]
    (held,) = wanted.collections
    put("linked", held)
    own = held.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer)
    bpy.context.scene.collection.children.unlink(own)
    ball = next(thing for thing in own.objects if thing.type == "MESH")
    ball.location.z += 1
    put("overridden", own).location = (3, 0, 0)
    return codes(bpy.context.scene, root)


def codes(of: bpy.types.Scene, root: Path) -> list[str]:
    """Export, and name the losses with their texts."""
    return [f"{loss.code}: {loss.text}" for loss in export_project(of, root, Options()).losses]


def flat(root: Path) -> None:
    """The same scene with everything placed one by one."""
    usual = placed.plan
    placed.plan = lambda _layer, depsgraph, _report: placed.Plan(depsgraph)
    try:
        export_project(scene(), root, Options())
    finally:
        placed.plan = usual


def steps(root: Path) -> dict[str, Any]:
    """Export, change one thing, and export again."""
    now = scene()
    out: dict[str, Any] = {}

    def step(name: str) -> None:
        done = export_project(now, root, Options())
        out[name] = {"written": sorted(done.written), "removed": done.removed}

    step("first")
    step("again")
    bpy.data.objects["Empty.001"].location.y = 1
    step("empty moved")
    bpy.data.objects["box"].location.z += 0.1
    step("box moved")
    for name in ("nest", "nest.001"):
        bpy.data.objects.remove(bpy.data.objects[name])
    step("nests deleted")
    return out


def no_scene_holds_it() -> dict[str, list[str]]:
    """Reasons for placing things one by one, by the name of the change to the scene."""

    def area(_: bpy.types.Scene) -> None:
        moved(scenes.light("AREA", (0, 0, 1), (0, 0, 0), 5), bpy.data.collections["outer"])

    def instancer(_: bpy.types.Scene) -> None:
        ball = bpy.data.objects["Cube.001"]
        ball.instance_type = "VERTS"

    def multiplied(_: bpy.types.Scene) -> None:
        block = bpy.data.objects["Empty.Cube.001"]
        block.instance_type = "VERTS"
        bpy.data.objects["Empty"].parent = block

    def too_many(now: bpy.types.Scene) -> None:
        for i in range(998):
            put(f"more {i}", bpy.data.collections['the "inner"']).location.x = i

    out = {}
    for spoil in (area, instancer, multiplied, too_many):
        now = scene()
        spoil(now)
        layer, report = bpy.context.view_layer, Report()
        with things.as_rendered(now, layer):
            made = placed.plan(layer, layer.depsgraph, report)
        lost = sorted({f"{loss.subject}: {loss.text}" for loss in report.losses})
        out[spoil.__name__] = [str(len(made.holders)), *lost]
    return out


def run(out: Path) -> dict[str, Any]:
    """All of it."""
    said: dict[str, Any] = {"losses": codes(scene(), out / "placed")}
    flat(out / "flat")
    said["keyed"] = codes(keyed(), out / "keyed")
    said["waving"] = waving(out / "waving")
    said["linked"] = linked(out / "linked")
    said["steps"] = steps(out / "steps")
    said["flat"] = no_scene_holds_it()
    return said
