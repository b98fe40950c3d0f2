"""Owns the export: a Blender scene as a project of Reflet.

reflet.toml      the project; written once, then its reader's
scene.toml       the scene to render: a layer over blender.toml; written once, then its reader's
blender.toml     everything that Blender says, written anew by each export
models/*.glb     meshes and rigs
instances/*.csv  places of many instances
report.json/txt  what the scene holds, and what could not be carried
export.json      the files that exports wrote, with their hashes
"""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import bpy

from . import camera as cameras
from . import gltf, picture, scene_text, space, things, world
from . import light as lights
from . import material as materials
from .folder import ExportError, Folder
from .motion import Samples, deforming, frames_of, may_move
from .names import Names, file_stem
from .report import Report

PROJECT = "# A project of scenes for Reflet; exports leave this file alone.\nname = {name}\n"
LAYER = """\
# The scene to render and to change: exports leave this file alone, and write blender.toml anew.
# Keys here win over those of blender.toml; instances are changed by their names:
#
# [[instance]]
# name = "Cube"
# material = {{ roughness = 0.1 }}
version = 1
base = "{base}"
"""
GENERATED = "blender.toml"


@dataclasses.dataclass(frozen=True)
class Options:
    """Settings of an export beside the scene."""

    method: str = "auto"
    samples: int = 64
    diffuse_bounces: int = 4
    # Whether motion is exported; else the scene is what it is at its current frame.
    animate: bool = True
    # Name of the view layer that is exported; the first one where it is empty.
    layer: str = ""


def export_project(scene: bpy.types.Scene, root: Path, options: Options) -> Report:
    """Write `scene` as a project into the folder `root`; raises ExportError where that fails."""
    report = Report()
    layer = scene.view_layers.get(options.layer) or scene.view_layers[0]
    if scene.camera is None:
        raise ExportError(f"the scene {scene.name!r} has no camera; add one and make it active")
    if scene.camera.type != "CAMERA":
        raise ExportError(f"the scene's camera {scene.camera.name!r} is a {scene.camera.type}")
    gltf.need_exporter()
    if bpy.context.mode != "OBJECT" and bpy.context.active_object is not None:
        bpy.ops.object.mode_set(mode="OBJECT")
    folder = Folder(root, report)
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        with things.as_rendered(scene, layer):
            _Export(scene, layer, folder, report, options).run()
    finally:
        scene.frame_set(frame, subframe=subframe)
    return report


class _Export:
    """One export: what was found, and what was written of it."""

    def __init__(
        self,
        scene: bpy.types.Scene,
        layer: bpy.types.ViewLayer,
        folder: Folder,
        report: Report,
        options: Options,
    ) -> None:
        self.scene, self.layer, self.folder = scene, layer, folder
        self.report, self.options = report, options
        self.text = scene_text.SceneText()
        self.models = things.Models()
        self.instance_names = Names()
        self.samples: Samples | None = None

    def run(self) -> None:
        """Find everything, then write it."""
        animate = self.options.animate and may_move(self.scene)
        fps = self.scene.render.fps / self.scene.render.fps_base
        frames = frames_of(self.scene, self.report) if animate else [self.scene.frame_current]
        bent = deforming(self.scene, self.layer, frames) if animate else []
        rigs = self._rigs(bent)
        rigged = {thing.name_full for rig in rigs for thing in rig}
        for thing in bent:
            if thing.name_full not in rigged:
                self.report.lose("deformation-frozen", thing.name)
        if animate:
            self.scene.frame_set(frames[0])
        depsgraph = self.layer.depsgraph
        depsgraph.update()
        try:
            drawn = things.drawn(depsgraph, self.models, rigged, self.report)
            seen, shining = self._cameras(depsgraph, drawn), self._lights()
            base_values = self._values(depsgraph, seen, shining)
            if animate:
                self.samples = Samples(frames, fps)
                for frame in frames:
                    self.scene.frame_set(frame)
                    self.samples.take(self.scene, self.layer.depsgraph, seen, shining)
                self.samples.name_losses(self.scene, self.report)
                self.scene.frame_set(frames[0])
            self.text.settings = picture.tables(
                self.scene, self.options, frames if animate else None, fps, seen, self.report
            )
            self.text.environment = world.values(self.scene, self.folder, self.report)
            self._put_cameras(base_values, seen)
            self._put_lights(base_values, shining)
            self.workshop = gltf.Workshop(self.scene)
            try:
                self._put_rigs(rigs)
                self._put_models(drawn)
            finally:
                self.workshop.close()
            self._put_things(drawn)
        finally:
            self.models.clear()
        self._name_scene_losses()
        self._write()

    def _rigs(self, bent: list[bpy.types.Object]) -> list[list[bpy.types.Object]]:
        """Deforming meshes that glTF can animate: by armature, and those of shape keys alone."""
        by_armature: dict[str, list[bpy.types.Object]] = {}
        for thing in bent:
            armature = thing.find_armature()
            if armature is not None:
                by_armature.setdefault(armature.name_full, [armature]).append(thing)
            elif thing.data.shape_keys is not None:
                by_armature[f"shapes of {thing.name_full}"] = [thing]
        return [rig for _, rig in sorted(by_armature.items())]

    def _cameras(
        self, depsgraph: bpy.types.Depsgraph, drawn: dict[things.Key, things.Thing]
    ) -> dict[str, bpy.types.Object]:
        """Cameras by name, the active one first."""
        active = self.scene.camera
        names, out = Names(), {}
        if active.name_full != "main":
            # Reflet renders a camera `main` where none is named, which shall be the active one.
            names.unique("main")
        found = [thing for thing in self.scene.objects if thing.type == "CAMERA"]
        if active not in found:
            found.append(active)
        for thing in sorted(found, key=lambda thing: (thing != active, thing.name_full)):
            if not space.is_sound(thing.matrix_world):
                self.report.lose("place-invalid", thing.name)
            elif cameras.is_carried(thing, self.report):
                out[names.unique(thing.name_full)] = thing
                cameras.name_losses(thing, self.scene, self.report)
        if active not in out.values():
            raise ExportError(
                f"the active camera {active.name!r} cannot be exported; make it a perspective or "
                "orthographic one, at a finite place"
            )
        middles = [(thing.name, thing.far) for thing in drawn.values()]
        cameras.name_clipped(active.evaluated_get(depsgraph), middles, self.report)
        return out

    def _lights(self) -> dict[str, bpy.types.Object]:
        names, out = Names(), {}
        lit = [thing for thing in self.scene.objects if thing.type == "LIGHT"]
        for thing in sorted(lit, key=lambda thing: thing.name_full):
            if not thing.hide_render and thing.visible_get(view_layer=self.layer):
                lights.name_losses(thing, self.report)
                out[names.unique(thing.name_full)] = thing
        return out

    def _values(
        self,
        depsgraph: bpy.types.Depsgraph,
        seen: dict[str, bpy.types.Object],
        shining: dict[str, bpy.types.Object],
    ) -> dict[tuple[str, str], dict[str, Any]]:
        out = {}
        for name, thing in seen.items():
            evaluated = thing.evaluated_get(depsgraph)
            out["camera", name] = cameras.values(evaluated, self.scene, depsgraph)
        for name, thing in shining.items():
            made = lights.values(thing.evaluated_get(depsgraph), self.report)
            if made is not None:
                out["light", name] = made
        return out

    def _put_cameras(self, values: dict[tuple[str, str], dict[str, Any]], seen: Any) -> None:
        for name in seen:
            tracks = self.samples.of_camera(name) if self.samples else {}
            self.text.add("camera", name, values["camera", name], tracks)
        self.report.counts["cameras"] = len(seen)

    def _put_lights(self, values: dict[tuple[str, str], dict[str, Any]], shining: Any) -> None:
        for name in shining:
            if ("light", name) in values:
                tracks = self.samples.of_light(name, self.report) if self.samples else {}
                self.text.add("light", name, values["light", name], tracks)
        self.report.counts["lights"] = sum(kind == "light" for kind, _ in values)

    def _overrides(self, used: list[bpy.types.Material | None]) -> dict[str, dict[str, Any]]:
        out = {}
        for material in used:
            if material is not None and material.name not in out:
                made = materials.overrides(material, self.report)
                if made:
                    out[material.name] = made
        return out

    def _put_rigs(self, rigs: list[list[bpy.types.Object]]) -> None:
        for rig in rigs:
            name = self.text.model_names.unique(rig[0].name_full)
            file = self._put_glb(name, self.workshop.rig_model(rig))
            used = [slot.material for thing in rig for slot in thing.material_slots]
            playing = {"name": "*", "repeat": "once"}
            model = {"file": file, "lights": False, "animation": playing}
            self.text.add_model(name, model, self._overrides(used))
            self.text.add_instance({"name": self.instance_names.unique(name), "model": name})
        self.report.counts["rigs"] = len(rigs)

    def _put_models(self, drawn: dict[things.Key, things.Thing]) -> None:
        needed = {id(thing.model) for thing in drawn.values() if self._is_shown(thing, drawn)}
        made = [model for model in self.models.all() if id(model) in needed]
        for model in made:
            model.name = self.text.model_names.unique(model.wanted)
            # Blender numbers a material slot that has no material, and glTF gives it a plain one.
            file = self._put_glb(model.name, self.workshop.mesh_model(model.mesh, model.name))
            overrides = self._overrides(list(model.mesh.materials))
            self.text.add_model(model.name, {"file": file}, overrides)
        self.report.counts["models"] = len(made)

    def _put_glb(self, name: str, content: bytes) -> str:
        file = f"models/{self.text.file_names.unique(file_stem(name))}.glb"
        self.folder.put(file, content)
        return file

    def _is_shown(self, thing: things.Thing, drawn: dict[things.Key, things.Thing]) -> bool:
        return thing.shown or self.samples is not None

    def _put_things(self, drawn: dict[things.Key, things.Thing]) -> None:
        placer = scene_text.Placer(self.text, self.folder, self.report, self.instance_names)
        for key, thing in sorted(drawn.items(), key=lambda item: (item[1].name, str(item[0]))):
            shown = self.samples.is_ever_shown(key) if self.samples else thing.shown
            if shown:
                things.name_losses(thing, self.report)
                placer.place(key, thing, self.samples)
        placer.finish()

    def _name_scene_losses(self) -> None:
        scene = self.scene
        if abs(scene.unit_settings.scale_length - 1) > 1e-6:
            self.report.lose("units-dropped", scene.name)
        tree = getattr(scene, "compositing_node_group", None)
        if scene.render.use_compositing and tree is not None:
            self.report.lose("compositor-dropped", scene.name)
        for library in bpy.data.libraries:
            if not Path(bpy.path.abspath(library.filepath)).is_file():
                self.report.lose("library-missing", library.name, str(library.filepath))

    def _write(self) -> None:
        name = self.scene.name
        self.folder.put(GENERATED, self.text.document().encode())
        self.folder.put("report.json", self.report.as_json().encode())
        self.folder.put("report.txt", self.report.as_text().encode())
        self.folder.offer("reflet.toml", PROJECT.format(name=scene_text.quoted(name)).encode())
        self.folder.offer("scene.toml", LAYER.format(base=GENERATED).encode())
        self.folder.finish()
