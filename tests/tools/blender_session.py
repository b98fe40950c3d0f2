"""Owns what tests do in Blender: exports scenes whose light is known, and renders one.

Runs in Blender's Python: `python blender_session.py OUT`, with the program on the PATH. Writes the
projects OUT/sun, OUT/point, OUT/odd and OUT/wax, the pictures OUT/engine.exr and OUT/passes.exr,
and OUT/said.json with the losses and refusals.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools" / "blender"))

import bpy  # noqa: E402
import reflet_blender  # noqa: E402
from reflet_blender.export import Options, export_project  # noqa: E402
from reflet_blender.folder import ExportError  # noqa: E402

import scenes  # noqa: E402

OPTIONS = Options(method="rt", samples=1)
# Height of the point light over the floor, meters.
HEIGHT_M = 2.0


def lit(kind: str, energy: float) -> bpy.types.Scene:
    """A floor that scatters 0.8 of the light of one lamp, seen from above."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scenes.floor(scenes.plain("white", "ShaderNodeBsdfDiffuse", (0.8, 0.8, 0.8)))
    scenes.light(kind, (0, 0, HEIGHT_M), (0, 0, 0), energy)
    scenes.camera((0.05, 0, 6), (0, 0, 0), 4)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 32, 18
    scene.view_settings.view_transform = "Standard"
    return scene


def odd() -> bpy.types.Scene:
    """Names with quotes, a thing that is not scaled evenly, and a copy of its mesh."""
    scene = lit("SUN", 1.0)
    block = scenes.box('a "b" \\ c', (1, 0, 0.5), (1, 2, 3), scenes.principled("the 'red' one"))
    twin = scenes.add(bpy.data.objects.new("twin", block.data))
    twin.location = (-1, 0, 0)
    return scene


def use_engine(scene: bpy.types.Scene, kind: str, path: Path) -> None:
    """Let the engine of the add-on render a scene into an OpenEXR file of 32 bits."""
    scene.render.engine = "REFLET"
    scene.reflet.method, scene.reflet.samples = "rt", 1
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):  # Blender 5 asks for it before a format of layers
        settings.media_type = "MULTI_LAYER_IMAGE" if kind == "OPEN_EXR_MULTILAYER" else "IMAGE"
    settings.file_format, settings.color_depth = kind, "32"
    scene.render.filepath = str(path)


def passes() -> bpy.types.Scene:
    """A floor and a glowing slope, by tiles in a region, with all passes that the engine has."""
    scene = lit("SUN", math.pi)
    lamp = scenes.plain("lamp", "ShaderNodeEmission", (0.25, 0.5, 0.75), Strength=2)
    block = scenes.box("slope", (-0.06, 0, 0.1), (0.1, 0.1, 0.1), lamp)
    block.rotation_euler = (0, math.radians(30), 0)
    scene.reflet.tile_px = 10
    render = scene.render
    render.use_border, render.use_crop_to_border = True, False
    render.border_min_x, render.border_max_x = 0.25, 0.875
    render.border_min_y, render.border_max_y = 0.125, 1
    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_normal = True
    layer.use_pass_diffuse_color = layer.use_pass_emit = True
    return scene


def main() -> None:
    """Make, export and render."""
    out = Path(sys.argv[1])
    said: dict[str, object] = {}
    # Irradiance pi: the floor sends out 0.8 times pi / pi. A point of P watts gives P / (4 pi h^2).
    for name, scene in [
        ("sun", lambda: lit("SUN", math.pi)),
        ("point", lambda: lit("POINT", 4 * math.pi**2 * HEIGHT_M**2)),
        ("odd", odd),
        ("wax", lambda: (scenes.empty(), scenes.wax())[0]),
    ]:
        report = export_project(scene(), out / name, OPTIONS)
        said[name] = [loss.code for loss in report.losses]
    again = export_project(odd(), out / "odd", OPTIONS)
    said["again"] = again.written
    without = odd()
    without.camera = None
    try:
        export_project(without, out / "blind", OPTIONS)
    except ExportError as error:
        said["blind"] = str(error)
    reflet_blender.register()
    for name, scene, kind in [
        ("engine", lambda: lit("SUN", math.pi), "OPEN_EXR"),
        ("passes", passes, "OPEN_EXR_MULTILAYER"),
    ]:
        use_engine(scene(), kind, out / f"{name}.exr")
        bpy.ops.render.render(write_still=True)
    (out / "said.json").write_text(json.dumps(said), encoding="utf-8")


if __name__ == "__main__":
    main()
