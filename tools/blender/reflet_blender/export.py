"""Owns the export: a Blender scene as a project of Reflet.

reflet.toml      the project; written once, then its reader's
scene.toml       the scene to render: a layer over blender.toml; written once, then its reader's
blender.toml     everything that Blender says, written anew by each export
collection-*.toml  collections that it places, each a scene text
models/*.glb     meshes and rigs
instances/*.csv  places of many instances
report.json/txt  content of the scene, and losses
export.json      the files that exports wrote, with their hashes
"""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import bpy
from mathutils import Matrix

from . import camera as cameras
from . import gltf, picture, placed, reach, scene_text, space, things, world
from . import light as lights
from . import material as materials
from .folder import ExportError, Folder
from .motion import Samples, deforming, frames_of, may_move
from .names import Names, file_stem
from .part import Part, is_ever_shown
from .reach import Key, full_name
from .report import Report

PROJECT = "# A project of scenes for Reflet; exports leave this file alone.\nname = {name}\n"
LAYER = """\
# The scene to render and to change: exports leave this file alone, and write blender.toml anew.
# Keys here win over keys of blender.toml; instances are changed by their names:
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
    except BaseException:
        folder.stop()
        raise
    finally:
        scene.frame_set(frame, subframe=subframe)
    return report


class _Export:
    """One export: its input, and its output."""

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
        self.main = Part(GENERATED, scene_text.SceneText(), report)
        self.models = things.Models()
        self.model_names, self.file_names = Names(), Names()
        self.samples: Samples | None = None

    def run(self) -> None:
        """Find everything, then write it."""
        animate = self.options.animate and may_move(self.scene)
        fps = self.scene.render.fps / self.scene.render.fps_base
        frames = frames_of(self.scene, self.report) if animate else [self.scene.frame_current]
        bent = deforming(self.scene, self.layer, frames) if animate else []
        if animate:
            self.scene.frame_set(frames[0])
        depsgraph = self.layer.depsgraph
        depsgraph.update()
        self.plan = placed.plan(self.layer, depsgraph, self.report)
        try:
            parts = self._parts(depsgraph, bent)
            at = things.places(depsgraph, self.plan)
            self._find_lights(parts, depsgraph, at)
            seen = self._cameras(depsgraph)
            shining = {key: thing for part in parts for key, thing in part.shining.values()}
            views = {
                name: cameras.values(thing.evaluated_get(depsgraph), self.scene, depsgraph)
                for name, thing in seen.items()
            }
            if animate:
                self.samples = Samples(frames, fps)
                for frame in frames:
                    self.scene.frame_set(frame)
                    self.samples.take(self.scene, self.layer.depsgraph, self.plan, seen, shining)
                self.samples.name_losses(self.scene, self.report)
                self.scene.frame_set(frames[0])
            lit = self._light_values(self.layer.depsgraph, shining, at)
            self._put_settings(parts, frames if animate else None, fps, seen)
            self._put_cameras(views, seen)
            self._put_parts(parts, lit)
        finally:
            self.models.clear()
        self._name_scene_losses()
        self._write(parts)

    def _parts(self, depsgraph: bpy.types.Depsgraph, bent: list[bpy.types.Object]) -> list[Part]:
        """The scene and the collections that it places, inner ones first; all but their lights."""
        by_name: dict[str, Part] = {}
        rigged: set[str] = set()
        contents = self.plan.scenes
        for held in contents:
            stem = file_stem(held.name)
            file = f"collection-{self.file_names.unique(stem)}.toml"
            text = scene_text.SceneText(scene_text.PLACED_HEAD)
            part = by_name[held.name] = Part(file, text, self.report, held)
            part.rigs = _rigs([thing for thing in held.things if thing in bent])
        visible = [thing for thing in self.layer.objects if thing in bent and not thing.hide_render]
        visible = [thing for thing in visible if thing.visible_get(view_layer=self.layer)]
        self.main.rigs = _rigs(visible)
        parts = [*by_name.values(), self.main]
        for part in parts:
            own = {full_name(thing) for rig in part.rigs for thing in rig}
            if part.held is None:
                part.drawn = things.drawn(depsgraph, self.models, self.plan, own, self.report)
                inside = list(self.plan.holders.values())
            else:
                part.drawn = things.held(part.held, depsgraph, self.models, own, self.report)
                inside = part.held.holders
            rigged |= own
            for thing, held in inside:
                part.placed.append(self._placed(thing, part, by_name[held.name], depsgraph))
        for thing in bent:
            if full_name(thing) not in rigged:
                self.report.lose("deformation-frozen", thing.name)
        return parts

    def _placed(
        self, thing: bpy.types.Object, outer: Part, part: Part, depsgraph: bpy.types.Depsgraph
    ) -> tuple[Key, things.Thing, Part]:
        """A part that `thing` places in another."""
        evaluated = thing.evaluated_get(depsgraph)
        made = things.Thing(
            name=full_name(thing),
            model=things.SceneFile(part.file),
            place=evaluated.matrix_world.copy(),
            shown=not thing.hide_render,
            sight=things.sight_of(evaluated),
            is_instance=False,
            source=thing,
        )
        if outer.held is None:
            return (full_name(thing),), made, part
        # Cycles asks the outermost of the empties alone who sees what they place.
        place, sight = outer.held.place(thing, depsgraph), (True, True, True)
        made = dataclasses.replace(made, place=place, sight=sight)
        return outer.held.key(thing), made, part

    def _cameras(self, depsgraph: bpy.types.Depsgraph) -> dict[str, bpy.types.Object]:
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
        middles = things.middles(depsgraph, self.plan, self.main.drawn)
        cameras.name_clipped(active.evaluated_get(depsgraph), middles, self.report)
        return out

    def _find_lights(
        self,
        parts: list[Part],
        depsgraph: bpy.types.Depsgraph,
        at: dict[Key, tuple[Matrix, bool]],
    ) -> None:
        """Give the parts their lights, those too that are hidden at the first frame."""
        found = []
        lit = [thing for thing in self.scene.objects if thing.type == "LIGHT"]
        for thing in lit:
            if (full_name(thing),) in at and thing.visible_get(view_layer=self.layer):
                found.append((full_name(thing), (full_name(thing),), thing))
        found += things.lights(depsgraph, self.plan)
        for name, key, thing in sorted(found, key=lambda light: (light[0], str(light[1]))):
            self.main.add_light(name, key, thing)
        for part in parts:
            if part.held is None:
                continue
            for thing in part.held.lights:
                part.add_light(full_name(thing), part.held.key(thing), thing)

    def _light_values(
        self,
        depsgraph: bpy.types.Depsgraph,
        shining: dict[Key, bpy.types.Object],
        at: dict[Key, tuple[Matrix, bool]],
    ) -> dict[Key, dict[str, Any]]:
        out = {}
        for key, thing in shining.items():
            is_lit = self.samples.is_ever_shown(key) if self.samples else at[key][1]
            if not is_lit:
                continue
            lights.name_losses(thing, at[key][0], self.report)
            made = lights.values(thing.evaluated_get(depsgraph), at[key][0], self.report)
            if made is not None:
                out[key] = made
        return out

    def _put_settings(
        self,
        parts: list[Part],
        frames: list[int] | None,
        fps: float,
        seen: dict[str, bpy.types.Object],
    ) -> None:
        settings = picture.tables(self.scene, self.options, frames, fps, seen, self.report)
        self.main.text.settings = settings
        self.main.text.environment = world.values(self.scene, self.folder, self.report)
        # A placed scene has the time and the light of the scene around it; alone it needs its own.
        alone: dict[str, dict[str, Any]] = {}
        if frames is not None:
            alone["timeline"] = {key: settings["timeline"][key] for key in ("fps", "start", "end")}
        for part in parts:
            if part.held is not None:
                part.text.settings = alone
                part.text.environment = {"color": [0.5, 0.5, 0.5]}

    def _put_cameras(self, values: dict[str, dict[str, Any]], seen: Any) -> None:
        for name in seen:
            tracks = self.samples.of_camera(name) if self.samples else {}
            self.main.text.add("camera", name, values[name], tracks)
        self.report.counts["cameras"] = len(seen)

    def _put_parts(self, parts: list[Part], lit: dict[Key, dict[str, Any]]) -> None:
        """Write lights, rigs, models and things of all parts."""
        counts = self.report.counts
        counts["lights"] = sum(part.put_lights(lit, self.samples) for part in parts)
        self.workshop = gltf.Workshop(self.scene)
        try:
            for part in reversed(parts):
                self._put_rigs(part)
            self._make_models(parts)
        finally:
            self.workshop.close()
        counts["collections"] = len(parts) - 1
        counts["instances"] = 0
        for part in parts:
            for model in self._shown_models(part):
                part.put_model(model.name, {"file": model.file}, model.overrides)
            names = part.names["instance"]
            placer = scene_text.Placer(part.text, self.folder, self.report, names, self.file_names)
            part.put_things(placer, self.samples)
            counts["instances"] += placer.count

    def _overrides(self, used: list[bpy.types.Material | None]) -> dict[str, dict[str, Any]]:
        out = {}
        for material in used:
            if material is not None and material.name not in out:
                made = materials.overrides(material, self.report)
                if made:
                    out[material.name] = made
        return out

    def _put_rigs(self, part: Part) -> None:
        for rig in part.rigs:
            name = self.model_names.unique(full_name(rig[0]))
            file = self._put_glb(name, self.workshop.rig_model(rig))
            used = [slot.material for thing in rig for slot in thing.material_slots]
            playing = {"name": "*", "repeat": "once"}
            model = {"file": file, "lights": False, "animation": playing}
            part.put_model(name, model, self._overrides(used))
            part.put_rig(name)
        counts = self.report.counts
        counts["rigs"] = counts.get("rigs", 0) + len(part.rigs)

    def _shown_models(self, part: Part) -> list[things.Model]:
        """The models that a part places, in the order of their names."""
        shown = {
            id(thing.model): thing.model
            for key, thing in part.drawn.items()
            if is_ever_shown(key, thing, self.samples) and isinstance(thing.model, things.Model)
        }
        return [model for model in self.models.all() if id(model) in shown]

    def _make_models(self, parts: list[Part]) -> None:
        needed = {id(model) for part in parts for model in self._shown_models(part)}
        made = [model for model in self.models.all() if id(model) in needed]
        for model in made:
            model.name = self.model_names.unique(model.wanted)
            # Blender numbers a material slot that has no material, and glTF gives it a plain one.
            model.file = self._put_glb(model.name, self.workshop.mesh_model(model.mesh, model.name))
            model.overrides = self._overrides(list(model.mesh.materials))
        self.report.counts["models"] = len(made)

    def _put_glb(self, name: str, content: bytes) -> str:
        file = f"models/{self.file_names.unique(file_stem(name))}.glb"
        self.folder.put(file, content)
        return file

    def _name_scene_losses(self) -> None:
        scene = self.scene
        if abs(scene.unit_settings.scale_length - 1) > 1e-6:
            self.report.lose("units-dropped", scene.name)
        tree = getattr(scene, "compositing_node_group", None)
        if scene.render.use_compositing and tree is not None:
            self.report.lose("compositor-dropped", scene.name)
        layer = self.layer
        inside = [layer.layer_collection, *_inside(layer.layer_collection)]
        changed = [held for held in inside if held.holdout or held.indirect_only]
        if layer.material_override or getattr(layer, "world_override", None) or changed:
            self.report.lose("layer-dropped", layer.name)
        for thing in reach.objects(scene):
            if any(_is_hair(modifier) for modifier in thing.modifiers):
                self.report.lose("hair-dropped", thing.name)
        for library in bpy.data.libraries:
            if not Path(bpy.path.abspath(library.filepath)).is_file():
                self.report.lose("library-missing", library.name, str(library.filepath))

    def _write(self, parts: list[Part]) -> None:
        name = self.scene.name
        for part in parts:
            self.folder.put(part.file, part.text.document().encode())
        self.folder.put("report.json", self.report.as_json().encode())
        self.folder.put("report.txt", self.report.as_text().encode())
        self.folder.offer("reflet.toml", PROJECT.format(name=scene_text.quoted(name)).encode())
        self.folder.offer("scene.toml", LAYER.format(base=GENERATED).encode())
        self.folder.finish()


def _rigs(bent: list[bpy.types.Object]) -> list[list[bpy.types.Object]]:
    """Deforming meshes that glTF can animate: by armature, and meshes with shape keys alone."""
    by_armature: dict[str, list[bpy.types.Object]] = {}
    for thing in bent:
        armature = thing.find_armature()
        if armature is not None:
            by_armature.setdefault(full_name(armature), [armature]).append(thing)
        elif thing.data.shape_keys is not None:
            by_armature[f"shapes of {full_name(thing)}"] = [thing]
    return [rig for _, rig in sorted(by_armature.items())]


def _inside(collection: bpy.types.LayerCollection) -> list[bpy.types.LayerCollection]:
    """Collections in a collection of a view layer, at all depths, that are not excluded."""
    shown = [child for child in collection.children if not child.exclude]
    return shown + [inner for child in shown for inner in _inside(child)]


def _is_hair(modifier: bpy.types.Modifier) -> bool:
    if modifier.type != "PARTICLE_SYSTEM" or not modifier.show_render:
        return False
    settings = modifier.particle_system.settings
    return settings.type == "HAIR" and settings.render_type == "PATH"
