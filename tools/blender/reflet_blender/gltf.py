"""Owns models: meshes, and rigs with their animations, as glTF by Blender's own exporter."""

from __future__ import annotations

import contextlib
import io
import json
import struct
import tempfile
from collections.abc import Iterable, Iterator
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


@contextlib.contextmanager
def _scene_of(
    objects: Iterable[bpy.types.Object], like: bpy.types.Scene
) -> Iterator[bpy.types.Scene]:
    """A scene that holds `objects` alone, with the frames of `like`."""
    scene = bpy.data.scenes.new("reflet-export")
    try:
        for name in ("frame_start", "frame_end"):
            setattr(scene, name, getattr(like, name))
        scene.render.fps, scene.render.fps_base = like.render.fps, like.render.fps_base
        for thing in objects:
            scene.collection.objects.link(thing)
        yield scene
    finally:
        bpy.data.scenes.remove(scene)


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


def mesh_model(mesh: bpy.types.Mesh, name: str, like: bpy.types.Scene) -> bytes:
    """A GLB with `mesh` at the origin, whose node and mesh are called `name`."""
    thing = bpy.data.objects.new("reflet-model", mesh)
    try:
        with _scene_of([thing], like) as scene:
            content = _export(scene, export_animations=False)
    finally:
        bpy.data.objects.remove(thing)
    return _named(content, name)


def rig_model(objects: list[bpy.types.Object], like: bpy.types.Scene) -> bytes:
    """A GLB with `objects` where they are, skinned and with the animation of the scene's frames."""
    shaped = any(thing.type == "MESH" and thing.data.shape_keys for thing in objects)
    with _scene_of(objects, like) as scene:
        return _export(
            scene,
            export_animations=True,
            export_animation_mode="SCENE",
            export_anim_scene_split_object=False,
            export_frame_range=True,
            export_force_sampling=True,
            export_optimize_animation_size=True,
            # Blender's exporter cannot apply modifiers to a mesh that has shape keys.
            export_apply=not shaped,
        )


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
