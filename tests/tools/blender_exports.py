"""Owns what tests of exports do in Blender: changed scenes exported again, and bad input.

Runs in Blender's Python: `python blender_exports.py OUT`. Writes OUT/said.json: `changes`, for each
step in turn the files that an export wrote and removed, and `bad`, for each input the codes of its
losses, or the message with which it was refused, and `collections`. Needs no program.
"""

from __future__ import annotations

import json
import math
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "blender"))

import blender_collections  # noqa: E402
import bpy  # noqa: E402
from reflet_blender.export import Options, export_project  # noqa: E402
from reflet_blender.folder import ExportError  # noqa: E402

import scenes  # noqa: E402


def fresh() -> bpy.types.Scene:
    """Blender's own first scene: Cube, Light and Camera."""
    bpy.ops.wm.read_factory_settings()
    return bpy.context.scene


def thing(name: str) -> bpy.types.Object:
    """An object of the file."""
    return bpy.data.objects[name]


def changes(root: Path) -> dict[str, Any]:
    """Export, change one thing, and export again."""
    scene = fresh()
    ball = scenes.ball("ball", (3, 0, 0), 1.0, scenes.principled("red", (0.8, 0.1, 0.1)))
    out: dict[str, Any] = {}

    def step(name: str) -> None:
        done = export_project(scene, root, Options())
        out[name] = {"written": sorted(done.written), "removed": done.removed}

    step("first")
    layer = root / "scene.toml"
    layer.write_text(layer.read_text(encoding="utf-8") + "\n# mine\n", encoding="utf-8")
    step("again")
    ball.location.x = 4
    step("moved")
    ball.data.vertices[0].co.z += 0.5
    ball.data.update()
    step("reshaped")
    bpy.data.objects.remove(thing("Cube"))
    step("deleted")
    out["layer is kept"] = layer.read_text(encoding="utf-8").endswith("# mine\n")
    return out


def kinds(root: Path) -> None:
    """Export an object of each kind that is drawn, two balls of one metaball, and a placed text."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scenes.camera((0, -9, 0), (0, 0, 0), 40)
    for name, make in {
        "Text": bpy.ops.object.text_add,
        "Curve": bpy.ops.curve.primitive_bezier_circle_add,
        "Wire": bpy.ops.curve.primitive_bezier_curve_add,
        "Surface": bpy.ops.surface.primitive_nurbs_surface_sphere_add,
        "Ball": bpy.ops.object.metaball_add,
        "Ball.001": bpy.ops.object.metaball_add,
        "Mesh": bpy.ops.mesh.primitive_cube_add,
    }.items():
        make()
        bpy.context.object.name = name
    thing("Curve").data.bevel_depth = 0.1
    held = bpy.data.collections.new("held")
    held.objects.link(bpy.data.objects.new("Placed", thing("Text").data))
    blender_collections.put("Empty", held)
    export_project(bpy.context.scene, root, Options())


def stopped(root: Path) -> dict[str, Any]:
    """Export where a file of the user's stops it, and again where that is gone."""
    scene = fresh()
    root.mkdir()
    (root / "blender.toml").write_text("mine", encoding="utf-8")
    out: dict[str, Any] = {}
    try:
        export_project(scene, root, Options())
    except ExportError as error:
        out["refused"] = str(error)
    out["mine"] = (root / "blender.toml").read_text(encoding="utf-8")
    (root / "blender.toml").unlink()
    thing("Cube").data.vertices[0].co.z += 0.5
    out["written"] = sorted(export_project(scene, root, Options()).written)
    return out


def at(name: str, place: tuple[float, float, float]) -> Callable[[Path], None]:
    """Move an object."""
    return lambda _: setattr(thing(name), "location", place)


def motion_too_far(_: Path) -> None:
    """Drive a thing farther away than scene text can say."""
    driver = thing("Cube").driver_add("location", 0).driver
    driver.expression = "frame**20"


def growing(_: Path) -> None:
    """Let the cube be nothing in the first frame, and again in the fourth."""
    for frame, size in ((1, 0), (2, 1), (4, 0), (5, 2)):
        thing("Cube").scale.x = size
        thing("Cube").keyframe_insert("scale", frame=frame)
    bpy.context.scene.frame_end = 5


def mirroring(_: Path) -> None:
    """Turn the cube inside out."""
    thing("Cube").keyframe_insert("scale", frame=1)
    thing("Cube").scale.x = -1
    thing("Cube").keyframe_insert("scale", frame=3)
    bpy.context.scene.frame_end = 3


def wide_open(_: Path) -> None:
    """Open the lens without end."""
    lens = thing("Camera").data.dof
    lens.use_dof, lens.aperture_fstop = True, 0


def no_view(_: Path) -> None:
    """Let the camera see no depth."""
    camera = thing("Camera").data
    camera.clip_start = camera.clip_end = 1


def odd_names(_: Path) -> None:
    """Names that climb out of folders, end lines, and need escapes."""
    cube = thing("Cube")
    cube.data.materials[0].name = 'a.b"c]\n'
    cube.data.name, cube.name = "../../etc/passwd", '../x\n"y"\x7f'


def no_camera(_: Path) -> None:
    """Leave the scene without a camera."""
    bpy.context.scene.camera = None


def panorama(_: Path) -> None:
    """Make the active camera a panoramic one."""
    thing("Camera").data.type = "PANO"


def editing(_: Path) -> None:
    """Be in edit mode."""
    bpy.context.view_layer.objects.active = thing("Cube")
    bpy.ops.object.mode_set(mode="EDIT")


def lost_image(_: Path) -> None:
    """Feed the color from an image that is not there."""
    tree = thing("Cube").data.materials[0].node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.new("gone", 4, 4)
    texture.image.source, texture.image.filepath = "FILE", "/nowhere/gone.png"
    tree.links.new(texture.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])


def procedural(_: Path) -> None:
    """Feed the color from noise."""
    tree = thing("Cube").data.materials[0].node_tree
    noise = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])


def sheared(_: Path) -> None:
    """Turn the cube below a parent that is stretched."""
    parent = scenes.add(bpy.data.objects.new("parent", None))
    parent.scale = (1, 3, 1)
    thing("Cube").parent, thing("Cube").rotation_euler = parent, (0, 0, 0.5)


def lost_library(root: Path) -> None:
    """Link an object of a file, and remove the file."""
    library, user = root.parent / "library.blend", root.parent / "user.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(library))
    fresh()
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.objects = ["Cube"]
    scenes.add(wanted.objects[0])
    bpy.ops.wm.save_as_mainfile(filepath=str(user))
    library.unlink()
    bpy.ops.wm.open_mainfile(filepath=str(user))


def hair(_: Path) -> None:
    """Let hair grow on the cube."""
    system = thing("Cube").modifiers.new("hair", "PARTICLE_SYSTEM").particle_system
    system.settings.type, system.settings.count = "HAIR", 10


def holdout(_: Path) -> None:
    """Cut the cube out of the picture by its collection in the view layer."""
    bpy.context.view_layer.layer_collection.children[0].holdout = True


def broken_ledger(root: Path) -> None:
    """Put something else where an export notes its files."""
    root.mkdir()
    (root / "export.json").write_text('{"files": 3}', encoding="utf-8")


def own_file(root: Path) -> None:
    """Put a file of the user's where the export wants to write."""
    (root / "models").mkdir(parents=True)
    (root / "models" / "Cube.glb").write_text("mine", encoding="utf-8")


def no_folder(root: Path) -> None:
    """Put a file where the folder shall be."""
    root.write_text("mine", encoding="utf-8")


BAD: dict[str, Callable[[Path], None]] = {
    "place not a number": at("Cube", (math.nan, 0, 0)),
    "place too far": at("Cube", (1e20, 0, 0)),
    "light not a number": at("Light", (math.nan, 0, 0)),
    "camera not a number": at("Camera", (math.nan, 0, 0)),
    "scale zero": lambda _: setattr(thing("Cube"), "scale", (0, 1, 1)),
    "scale negative": lambda _: setattr(thing("Cube"), "scale", (-1, 1, 1)),
    "power negative": lambda _: setattr(thing("Light").data, "energy", -5),
    "motion too far": motion_too_far,
    "growing": growing,
    "mirroring": mirroring,
    "wide open": wide_open,
    "no view": no_view,
    "odd names": odd_names,
    "no camera": no_camera,
    "panorama": panorama,
    "editing": editing,
    "lost image": lost_image,
    "procedural": procedural,
    "sheared": sheared,
    "lost library": lost_library,
    "hair": hair,
    "holdout": holdout,
    "broken ledger": broken_ledger,
    "own file": own_file,
    "no folder": no_folder,
}


def main() -> None:
    """Run all of it."""
    out = Path(sys.argv[1])
    bad: dict[str, Any] = {}
    for name, spoil in BAD.items():
        fresh()
        root = out / name
        spoil(root)
        try:
            done = export_project(bpy.context.scene, root, Options())
            bad[name] = [loss.code for loss in done.losses]
        except ExportError as error:
            bad[name] = str(error)
    shutil.rmtree(out / "changes", ignore_errors=True)
    said = {"bad": bad, "changes": changes(out / "changes")}
    kinds(out / "kinds")
    said["stopped"] = stopped(out / "stopped")
    said["collections"] = blender_collections.run(out)
    (out / "said.json").write_text(json.dumps(said), encoding="utf-8")


if __name__ == "__main__":
    main()
