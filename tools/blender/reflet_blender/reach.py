"""Owns which objects an export looks at: kinds of objects, what is in collections, their names."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

DRAWN = {"MESH", "CURVE", "SURFACE", "FONT", "META"}
SILENT = {"EMPTY", "CAMERA", "LIGHT", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE"}
# Blender's filling behind the numbers of an instance, one for each object that places it.
_NO_ID = 2**31 - 1

# Key of a thing in all frames: its name, and for an instance what places it and its number.
Key = tuple[Any, ...]


def full_name(thing: bpy.types.ID) -> str:
    """A name that also tells things of linked libraries apart."""
    return thing.name_full


def instances(
    depsgraph: bpy.types.Depsgraph,
) -> Iterator[bpy.types.DepsgraphObjectInstance]:
    """Everything that the depsgraph shows, each once.

    Text, curves, surfaces and metaballs are listed twice where they have faces: as themselves,
    which nothing draws, and as the mesh that they become.
    """
    for instance in depsgraph.object_instances:
        if instance.object.type not in DRAWN - {"MESH"}:
            yield instance


def is_placed(instance: bpy.types.DepsgraphObjectInstance) -> bool:
    """Whether another object, or nodes, place a thing; not where it is an object's own mesh."""
    if not instance.is_instance:
        return False
    thing, holder = instance.object.original, instance.parent.original
    is_nested = instance.persistent_id[1] != _NO_ID
    return is_nested or thing.type == "MESH" or full_name(thing) != full_name(holder)


def instance_key(instance: bpy.types.DepsgraphObjectInstance) -> Key:
    """The key of a drawn thing at a place."""
    thing = instance.object.original
    if not is_placed(instance):
        return (full_name(thing),)
    holder = instance.parent.original
    return (full_name(holder), full_name(thing), *instance.persistent_id)


def is_holder(thing: bpy.types.Object) -> bool:
    """Whether an object is an empty that places a collection."""
    return thing.instance_type == "COLLECTION" and thing.instance_collection is not None


def is_never_shown(thing: bpy.types.Object) -> bool:
    """Whether no frame of a render shows a thing, nor the collection that it places."""
    return thing.hide_render and thing.animation_data is None


def members(collection: bpy.types.Collection) -> list[bpy.types.Object]:
    """Objects that a placed collection shows in renders, with objects of collections in it."""
    out: dict[str, bpy.types.Object] = {}
    waiting = [collection]
    while waiting:
        current = waiting.pop()
        if not current.hide_render:
            out.update((full_name(thing), thing) for thing in current.objects)
            waiting += current.children
    return [thing for _, thing in sorted(out.items())]


def placed_collections(scene: bpy.types.Scene) -> list[bpy.types.Collection]:
    """Collections that objects of the scene, or of such collections, place."""
    found: dict[str, bpy.types.Collection] = {}
    waiting = list(scene.objects)
    while waiting:
        held = waiting.pop().instance_collection
        if held is not None and full_name(held) not in found:
            found[full_name(held)] = held
            waiting += held.all_objects
    return list(found.values())


def objects(scene: bpy.types.Scene) -> Iterator[bpy.types.Object]:
    """Objects of the scene and of the collections that are placed in it, each once."""
    found = {full_name(thing): thing for thing in scene.objects}
    for collection in placed_collections(scene):
        found.update((full_name(thing), thing) for thing in collection.all_objects)
    return iter(found.values())
