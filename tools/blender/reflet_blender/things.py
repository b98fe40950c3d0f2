"""Owns what is drawn: models of the scene, and where they stand at a frame."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator
from typing import Any

import bpy
from mathutils import Matrix, Vector

from .report import Report

_DRAWN = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
_SILENT = {"EMPTY", "CAMERA", "LIGHT", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE"}
# Modifiers whose level in renders is another than in the viewport.
_LEVELS = {"SUBSURF": ("levels", "render_levels"), "MULTIRES": ("levels", "render_levels")}

# Key of a thing in all frames: its name, and for an instance what places it and its number.
Key = tuple[Any, ...]


@dataclasses.dataclass
class Model:
    """A mesh that things share, as modifiers leave it."""

    wanted: str
    mesh: bpy.types.Mesh
    name: str = ""


@dataclasses.dataclass(frozen=True)
class Thing:
    """A placed model."""

    name: str
    model: Model
    place: Matrix
    shown: bool
    sight: tuple[bool, bool, bool]
    is_instance: bool
    source: bpy.types.Object
    far: Vector


@contextlib.contextmanager
def as_rendered(scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> Iterator[None]:
    """Evaluate what a render shows, rather than what the viewport shows."""
    before: list[tuple[Any, str, Any]] = []

    def change(owner: Any, name: str, wanted: Any) -> None:
        was = getattr(owner, name)
        if was != wanted:
            before.append((owner, name, was))
            setattr(owner, name, wanted)

    def walk(collection: bpy.types.LayerCollection) -> None:
        change(collection, "hide_viewport", False)
        change(collection.collection, "hide_viewport", collection.collection.hide_render)
        for child in collection.children:
            walk(child)

    hidden = [thing for thing in layer.objects if thing.hide_get(view_layer=layer)]
    try:
        walk(layer.layer_collection)
        for thing in hidden:
            thing.hide_set(False, view_layer=layer)
        for thing in scene.objects:
            # An animated `hide_render` is read frame by frame, so that the thing must be there.
            change(thing, "hide_viewport", False)
            for modifier in thing.modifiers:
                change(modifier, "show_viewport", modifier.show_render)
                if modifier.type in _LEVELS:
                    viewport, render = _LEVELS[modifier.type]
                    change(modifier, viewport, getattr(modifier, render))
        layer.update()
        yield
    finally:
        for owner, name, was in reversed(before):
            setattr(owner, name, was)
        for thing in hidden:
            thing.hide_set(True, view_layer=layer)


class Models:
    """The models of a scene, made when a thing first needs them."""

    def __init__(self) -> None:
        self._by_data: dict[Key, Model | None] = {}

    def of(
        self, thing: bpy.types.Object, depsgraph: bpy.types.Depsgraph, report: Report
    ) -> Model | None:
        """The model of an evaluated object; None where it has no faces."""
        slots = tuple(slot.material.as_pointer() if slot.material else 0 for slot in _slots(thing))
        key = (thing.data.as_pointer(), slots)
        if key not in self._by_data:
            self._by_data[key] = self._made(thing, depsgraph)
        return self._by_data[key]

    def _made(self, thing: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Model | None:
        mesh = bpy.data.meshes.new_from_object(
            thing, preserve_all_data_layers=True, depsgraph=depsgraph
        )
        if mesh is None or not mesh.polygons:
            if mesh is not None:
                bpy.data.meshes.remove(mesh)
            return None
        original = thing.original
        own = bool(original.modifiers) and original.data is not None and original.data.users > 1
        return Model(original.name if own or not original.data else original.data.name, mesh)

    def all(self) -> list[Model]:
        """Every model, ordered by the name that it wants."""
        made = [model for model in self._by_data.values() if model is not None]
        return sorted(made, key=lambda model: model.wanted)

    def clear(self) -> None:
        """Remove the meshes that were made."""
        for model in self.all():
            bpy.data.meshes.remove(model.mesh)
        self._by_data.clear()


def _slots(thing: bpy.types.Object) -> list[bpy.types.MaterialSlot]:
    return list(thing.material_slots)


def _key(instance: bpy.types.DepsgraphObjectInstance) -> Key:
    thing = instance.object.original
    if not instance.is_instance:
        return (_full_name(thing),)
    holder = instance.parent.original
    return (_full_name(holder), _full_name(thing), *instance.persistent_id)


def _full_name(thing: bpy.types.Object) -> str:
    """A name that also tells things of linked libraries apart."""
    return thing.name_full


def drawn(
    depsgraph: bpy.types.Depsgraph, models: Models, left_out: set[str], report: Report
) -> dict[Key, Thing]:
    """Things drawn at the current frame, but for the objects `left_out`."""
    out: dict[Key, Thing] = {}
    for instance in depsgraph.object_instances:
        thing, original = instance.object, instance.object.original
        if _full_name(original) in left_out:
            continue
        if thing.type not in _DRAWN:
            if thing.type not in _SILENT:
                report.lose("object-kind-dropped", original.name, f"a {thing.type.lower()}")
            continue
        holder = instance.parent.original if instance.is_instance else original
        is_instancer = not instance.is_instance and original.is_instancer
        if is_instancer and not original.show_instancer_for_render:
            continue
        model = models.of(thing, depsgraph, report)
        if model is None:
            continue
        name = _full_name(original)
        if instance.is_instance:
            name = f"{_full_name(holder)}/{name}"
        out[_key(instance)] = Thing(
            name=name,
            model=model,
            place=instance.matrix_world.copy(),
            shown=not (original.hide_render or holder.hide_render),
            sight=(thing.visible_camera, thing.visible_shadow, thing.visible_glossy),
            is_instance=instance.is_instance,
            source=original,
            far=_farthest(thing, instance.matrix_world),
        )
    return out


def _farthest(thing: bpy.types.Object, place: Matrix) -> Vector:
    """The middle of a thing's box."""
    low, high = Vector(thing.bound_box[0]), Vector(thing.bound_box[6])
    return place @ ((low + high) / 2)


def places(depsgraph: bpy.types.Depsgraph) -> dict[Key, tuple[Matrix, bool]]:
    """Where everything is drawn at the current frame, and whether it is shown."""
    out = {}
    for instance in depsgraph.object_instances:
        original = instance.object.original
        if original.type in _DRAWN:
            holder = instance.parent.original if instance.is_instance else original
            shown = not (original.hide_render or holder.hide_render)
            out[_key(instance)] = (instance.matrix_world.copy(), shown)
    return out


def name_losses(thing: Thing, report: Report) -> None:
    """Name what a thing has and `[[instance]]` has not."""
    source = thing.source
    if source.is_shadow_catcher or source.is_holdout:
        report.lose("shadow-catcher-dropped", source.name)
    kinds = ("visible_diffuse", "visible_transmission", "visible_volume_scatter")
    missed = [kind for kind in kinds if getattr(source, kind) != source.visible_glossy]
    if missed:
        report.lose("ray-visibility-dropped", source.name, ", ".join(missed))
