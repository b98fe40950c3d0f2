"""Owns the world: a color, or a panorama with its turn and strength."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import Any

import bpy

from .folder import Folder
from .report import Report

_PANORAMAS = {".hdr", ".exr"}
# A panorama's middle is +X in Blender and +Z in Reflet, a quarter turn about the axis up.
_QUARTER_DEG = 90.0


def values(scene: bpy.types.Scene, folder: Folder, report: Report) -> dict[str, Any]:
    """The keys of `[environment]`; puts the panorama into the folder."""
    world = scene.world
    if world is None:
        return {"color": [0, 0, 0]}
    if world.node_tree is None or not world.use_nodes:
        return _plain(list(world.color))
    output = next((n for n in world.node_tree.nodes if n.type == "OUTPUT_WORLD"), None)
    if output is None or not output.inputs["Surface"].is_linked:
        return {"color": [0, 0, 0]}
    if output.inputs["Volume"].is_linked:
        report.lose("volume-dropped", world.name)
    background = output.inputs["Surface"].links[0].from_node
    if background.type != "BACKGROUND" or background.inputs["Strength"].is_linked:
        report.lose("world-approximated", world.name, "only a Background with a plain strength")
        return _plain(list(world.color))
    strength = max(background.inputs["Strength"].default_value, 0.0)
    color = background.inputs["Color"]
    if not color.is_linked:
        return _plain([max(part, 0.0) * strength for part in color.default_value[:3]])
    texture = color.links[0].from_node
    if texture.type != "TEX_ENVIRONMENT" or texture.image is None:
        report.lose("world-approximated", world.name, f"{texture.bl_label} is left out")
        return {"color": [0, 0, 0]}
    if texture.projection != "EQUIRECTANGULAR":
        report.lose("world-approximated", world.name, "a mirror ball is read as a panorama")
    name = _put_image(texture.image, folder, report)
    if name is None:
        return {"color": [0, 0, 0]}
    turned = _turn_deg(texture, world.name, report)
    # The lookup is turned, so that the picture turns the other way.
    return {"file": name, "rotation_deg": _QUARTER_DEG - turned, "intensity": strength}


def _plain(color: list[float]) -> dict[str, Any]:
    # Cycles's worlds cast shadows; Reflet's plain ones do not unless they are told to.
    return {"color": color, "shadow": "ray"}


def _turn_deg(texture: bpy.types.Node, name: str, report: Report) -> float:
    """The rotation about Z of a Mapping node before the texture, degrees."""
    if not texture.inputs["Vector"].is_linked:
        return 0.0
    mapping = texture.inputs["Vector"].links[0].from_node
    if mapping.type == "TEX_COORD":
        return 0.0
    if mapping.type != "MAPPING" or mapping.inputs["Rotation"].is_linked:
        report.lose("world-approximated", name, f"{mapping.bl_label} before the panorama")
        return 0.0
    x, y, z = mapping.inputs["Rotation"].default_value
    scale, moved = mapping.inputs["Scale"].default_value, mapping.inputs["Location"].default_value
    if abs(x) + abs(y) > 1e-6 or any(abs(s - 1) > 1e-6 for s in scale) or any(moved):
        report.lose("world-approximated", name, "only its turn about Z is kept")
    return math.degrees(z) if mapping.vector_type == "POINT" else -math.degrees(z)


def _put_image(image: bpy.types.Image, folder: Folder, report: Report) -> str | None:
    """Put the panorama into the folder, as it is where Reflet reads it; its name there."""
    suffix = Path(image.filepath).suffix.lower()
    if image.source == "FILE" and suffix in _PANORAMAS and not image.is_dirty:
        try:
            packed = image.packed_file
            path = Path(bpy.path.abspath(image.filepath, library=image.library))
            content = packed.data if packed else path.read_bytes()
        except OSError as error:
            report.lose("image-missing", image.name, str(error.strerror))
            return None
        folder.put(f"world{suffix}", content)
        return f"world{suffix}"
    if image.size[0] == 0:
        report.lose("image-missing", image.name)
        return None
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "world.exr"
        # Saved by a scene of its own: settings of the user's scene stay out of it.
        writer = bpy.data.scenes.new("reflet-world")
        try:
            settings = writer.render.image_settings
            settings.file_format = "OPEN_EXR"
            settings.color_mode = "RGB"
            settings.color_depth = "32"
            image.save_render(str(path), scene=writer)
        finally:
            bpy.data.scenes.remove(writer)
        folder.put("world.exr", path.read_bytes())
    return "world.exr"
