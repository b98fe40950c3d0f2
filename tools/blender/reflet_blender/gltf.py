"""Owns models: meshes, and rigs with their animations, as glTF by Blender's own exporter."""

from __future__ import annotations

import contextlib
import io
import json
import struct
import tempfile
from pathlib import Path
from typing import Any

import addon_utils
import bpy

from .folder import ExportError

_EXPORTER = "io_scene_gltf2"
_JSON_CHUNK = 0x4E4F534A


def need_exporter() -> None:
    """Enable Blender's exporter of glTF, which comes with it."""
    if addon_utils.check(_EXPORTER)[1]:
        return
    if addon_utils.enable(_EXPORTER) is None:
        raise ExportError(f"Blender's add-on {_EXPORTER} is missing; install it")


class Workshop:
    """A scene of its own, in which things are exported a few at a time."""

    def __init__(self, like: bpy.types.Scene) -> None:
        self._scene = bpy.data.scenes.new("reflet-export")
        for name in ("frame_start", "frame_end"):
            setattr(self._scene, name, getattr(like, name))
        self._scene.render.fps, self._scene.render.fps_base = like.render.fps, like.render.fps_base

    def close(self) -> None:
        """Remove the scene."""
        bpy.data.scenes.remove(self._scene)

    def mesh_model(self, mesh: bpy.types.Mesh, name: str) -> bytes:
        """A GLB with `mesh` at the origin, whose node and mesh are called `name`."""
        thing = bpy.data.objects.new("reflet-model", mesh)
        try:
            content = self._export([thing], export_animations=False)
        finally:
            bpy.data.objects.remove(thing)
        return _named(content, name)

    def rig_model(self, objects: list[bpy.types.Object]) -> bytes:
        """A GLB with `objects` where they are, skinned, with the animation of all frames."""
        shaped = any(thing.type == "MESH" and thing.data.shape_keys for thing in objects)
        return self._export(
            objects,
            export_animations=True,
            export_animation_mode="SCENE",
            export_anim_scene_split_object=False,
            export_frame_range=True,
            export_force_sampling=True,
            export_optimize_animation_size=True,
            # Blender's exporter cannot apply modifiers to a mesh that has shape keys.
            export_apply=not shaped,
        )

    def _export(self, objects: list[bpy.types.Object], **options: Any) -> bytes:
        held = self._scene.collection.objects
        for thing in objects:
            held.link(thing)
        try:
            return _export(self._scene, **options)
        finally:
            for thing in objects:
                held.unlink(thing)


def _export(scene: bpy.types.Scene, **options: Any) -> bytes:
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "model.glb"
        said = io.StringIO()
        override = bpy.context.temp_override(scene=scene, view_layer=scene.view_layers[0])
        try:
            # The exporter prints its progress for each file.
            with override, contextlib.redirect_stdout(said):
                bpy.ops.export_scene.gltf(
                    filepath=str(path),
                    export_format="GLB",
                    use_active_scene=True,
                    export_cameras=False,
                    export_lights=False,
                    export_extras=False,
                    **options,
                )
            return path.read_bytes()
        except (RuntimeError, OSError) as error:
            names = ", ".join(thing.name for thing in scene.objects)
            raise ExportError(f"Blender's glTF exporter failed for {names}: {error}") from error


def _named(content: bytes, name: str) -> bytes:
    """`content` with the name of its one node and mesh; Blender's own names must be unique."""
    length, kind = struct.unpack_from("<II", content, 12)
    assert kind == _JSON_CHUNK
    document = json.loads(content[20 : 20 + length])
    for thing in document.get("nodes", []) + document.get("meshes", []):
        thing["name"] = name
    for scene in document.get("scenes", []):
        scene.pop("name", None)
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    rest = content[20 + length :]
    header = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), kind)
    return header + text + rest
