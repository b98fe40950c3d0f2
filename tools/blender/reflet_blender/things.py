"""Owns what is drawn: models of the scene, and where they stand at a frame."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator
from typing import Any

import bpy
from mathutils import Matrix, Vector

from . import reach
from .placed import Held, Plan
from .reach import DRAWN, SILENT, Key, full_name, instance_key, is_placed
from .report import Report

# Modifiers whose level in renders is another than in the viewport.
_LEVELS = {"SUBSURF": ("levels", "render_levels"), "MULTIRES": ("levels", "render_levels")}


@dataclasses.dataclass
class Model:
    """A mesh that things share, as modifiers leave it."""

    wanted: str
    mesh: bpy.types.Mesh
    name: str = ""
    file: str = ""
    overrides: dict[str, dict[str, Any]] = dataclasses.field(default_factory=dict)
    # Kind of `[motion]` of the instance or light that places it.
    moved_as = "instance"

    @property
    def value(self) -> str:
        """The key `model` of the instance that places it."""
        return self.name


@dataclasses.dataclass(frozen=True)
class SceneFile:
    """A scene text that is placed in another."""

    file: str
    moved_as = "group"

    @property
    def value(self) -> dict[str, str]:
        """The key `model` of the instance that places it."""
        return {"scene": self.file}


@dataclasses.dataclass(frozen=True)
class Thing:
    """A placed model or scene."""

    name: str
    model: Model | SceneFile
    place: Matrix
    shown: bool
    sight: tuple[bool, bool, bool]
    is_instance: bool
    source: bpy.types.Object


@contextlib.contextmanager
def as_rendered(scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> Iterator[None]:
    """Evaluate the scene of renders, not of the viewport."""
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
        for collection in reach.placed_collections(scene):
            for held in (collection, *collection.children_recursive):
                change(held, "hide_viewport", held.hide_render)
        for thing in hidden:
            thing.hide_set(False, view_layer=layer)
        for thing in reach.objects(scene):
            # An animated `hide_render` is read frame by frame, so that the thing must be there.
            is_gone = reach.is_holder(thing) and reach.is_never_shown(thing)
            change(thing, "hide_viewport", is_gone)
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


def drawn(
    depsgraph: bpy.types.Depsgraph, models: Models, plan: Plan, rigged: set[str], report: Report
) -> dict[Key, Thing]:
    """Things drawn at the current frame, but for things of placed scenes, and objects of rigs."""
    out: dict[Key, Thing] = {}
    for instance in _instances(depsgraph, plan):
        thing, original = instance.object, instance.object.original
        if thing.type not in DRAWN:
            if thing.type not in SILENT:
                report.lose("object-kind-dropped", original.name, f"a {thing.type.lower()}")
            continue
        placed = is_placed(instance)
        if full_name(original) in rigged:
            if not placed:
                continue
            report.lose("deformation-frozen", original.name, "its instances have one shape")
        if not placed and original.is_instancer and not original.show_instancer_for_render:
            continue
        model = models.of(thing, depsgraph, report)
        if model is None:
            continue
        sight = sight_of(thing)
        if instance.is_instance:
            camera, shadow, glossy = sight_of(instance.parent)
            sight = (sight[0] and camera, sight[1] and shadow, sight[2] and glossy)
        out[instance_key(instance)] = Thing(
            name=instance_name(instance),
            model=model,
            place=instance.matrix_world.copy(),
            shown=_is_shown(instance),
            sight=sight,
            is_instance=placed,
            source=original,
        )
    return out


def held(
    content: Held,
    depsgraph: bpy.types.Depsgraph,
    models: Models,
    rigged: set[str],
    report: Report,
) -> dict[Key, Thing]:
    """Things of a placed scene, but for objects of rigs."""
    out: dict[Key, Thing] = {}
    for thing in content.things:
        evaluated = thing.evaluated_get(depsgraph)
        model = None
        if full_name(thing) not in rigged:
            model = models.of(evaluated, depsgraph, report)
        if model is not None:
            out[content.key(thing)] = Thing(
                name=full_name(thing),
                model=model,
                place=content.place(thing, depsgraph),
                shown=not thing.hide_render,
                sight=sight_of(evaluated),
                is_instance=False,
                source=thing,
            )
    return out


def sight_of(thing: bpy.types.Object) -> tuple[bool, bool, bool]:
    """Whether the camera, light and reflections see a thing."""
    return thing.visible_camera, thing.visible_shadow, thing.visible_glossy


def lights(
    depsgraph: bpy.types.Depsgraph, plan: Plan
) -> Iterator[tuple[str, Key, bpy.types.Object]]:
    """Lights that are instances, shown or not, and in no placed scene."""
    for instance in _instances(depsgraph, plan):
        if instance.is_instance and instance.object.type == "LIGHT":
            yield instance_name(instance), instance_key(instance), instance.object.original


def instance_name(instance: bpy.types.DepsgraphObjectInstance) -> str:
    """The name of a drawn thing at a place, behind the name of its placing object."""
    name = full_name(instance.object.original)
    return f"{full_name(instance.parent.original)}/{name}" if is_placed(instance) else name


def _is_shown(instance: bpy.types.DepsgraphObjectInstance) -> bool:
    original = instance.object.original
    holder = instance.parent.original if instance.is_instance else original
    return not (original.hide_render or holder.hide_render)


def _instances(
    depsgraph: bpy.types.Depsgraph, plan: Plan
) -> Iterator[bpy.types.DepsgraphObjectInstance]:
    """Everything drawn that is in no placed scene."""
    for instance in reach.instances(depsgraph):
        of_plan = instance.is_instance and full_name(instance.parent.original) in plan.holders
        if not of_plan:
            yield instance


def middles(
    depsgraph: bpy.types.Depsgraph, plan: Plan, drawn_ones: dict[Key, Thing]
) -> Iterator[tuple[str, Vector]]:
    """Names of all that is drawn, with the middle of its box in the world."""
    found = [(thing.source, thing.place) for thing in drawn_ones.values()]
    found += [(thing, place) for thing, place in plan.leaves() if thing.type in DRAWN]
    for source, place in found:
        low, high = (Vector(source.evaluated_get(depsgraph).bound_box[i]) for i in (0, 6))
        yield source.name, place @ ((low + high) / 2)


def places(depsgraph: bpy.types.Depsgraph, plan: Plan) -> dict[Key, tuple[Matrix, bool]]:
    """Where everything is at the current frame, and whether it is shown."""
    out = plan.places(depsgraph)
    for instance in _instances(depsgraph, plan):
        if instance.object.type in DRAWN or instance.object.type == "LIGHT":
            out[instance_key(instance)] = (instance.matrix_world.copy(), _is_shown(instance))
    return out


def name_losses(source: bpy.types.Object, report: Report) -> None:
    """Name what a thing has and `[[instance]]` has not."""
    if source.is_shadow_catcher or source.is_holdout:
        report.lose("shadow-catcher-dropped", source.name)
    kinds = ("visible_diffuse", "visible_transmission", "visible_volume_scatter")
    missed = [kind for kind in kinds if getattr(source, kind) != source.visible_glossy]
    if missed:
        report.lose("ray-visibility-dropped", source.name, ", ".join(missed))
