"""Owns which collections become placed scenes, and their content.

An empty that places a collection becomes an instance that places a scene, where a scene can hold
all that Blender shows there; else the things of the collection are placed one by one.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import bpy
from mathutils import Matrix

from .reach import DRAWN, SILENT, Key, full_name, instances, is_holder, is_never_shown, members
from .report import Report

# Limits of Reflet for scenes that are placed in a scene, and for their files.
_MOST_PLACED, _MOST_FILES = 1000, 100
# From so many things on, the text that placed scenes become is too large.
_MOST_THINGS = 100_000
_TOLERANCE = 1e-4


@dataclasses.dataclass(frozen=True)
class Held:
    """The content of a collection."""

    collection: bpy.types.Collection
    things: list[bpy.types.Object]
    lights: list[bpy.types.Object]
    holders: list[tuple[bpy.types.Object, Held]]

    @property
    def name(self) -> str:
        """The collection's name."""
        return full_name(self.collection)

    def key(self, thing: bpy.types.Object) -> Key:
        """The key of a thing in it."""
        return ("in", self.name, full_name(thing))

    def place(self, thing: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Matrix:
        """Where a thing is, relative to the empty that places the collection."""
        offset = Matrix.Translation(-self.collection.instance_offset)
        return offset @ thing.evaluated_get(depsgraph).matrix_world

    def leaves(
        self, depsgraph: bpy.types.Depsgraph, place: Matrix
    ) -> Iterator[tuple[bpy.types.Object, Matrix]]:
        """Things and lights that `place` places, also of collections that it places."""
        for thing in (*self.things, *self.lights):
            yield thing, place @ self.place(thing, depsgraph)
        for thing, inner in self.holders:
            yield from inner.leaves(depsgraph, place @ self.place(thing, depsgraph))

    def all(self) -> Iterator[Held]:
        """Collections that are placed in it, inner ones first, and itself."""
        for _, inner in self.holders:
            yield from inner.all()
        yield self

    @property
    def is_empty(self) -> bool:
        """Whether it shows nothing."""
        return not (self.things or self.lights or self.holders)

    @property
    def weight(self) -> tuple[int, int]:
        """Scenes that placing it places, and their things."""
        inner = [held.weight for _, held in self.holders]
        own = len(self.things) + len(self.lights)
        return 1 + sum(scenes for scenes, _ in inner), own + sum(count for _, count in inner)


class _NotHeldError(Exception):
    """Why no placed scene can hold a collection."""


class Plan:
    """Empties of the scene that place scenes, by their full names, with the scenes' content."""

    def __init__(self, depsgraph: bpy.types.Depsgraph) -> None:
        self.holders: dict[str, tuple[bpy.types.Object, Held]] = {}
        self._depsgraph = depsgraph

    @property
    def scenes(self) -> list[Held]:
        """Collections that become files, each after the collections that it places."""
        found: dict[str, Held] = {}
        for _, held in self.holders.values():
            for inner in held.all():
                found.setdefault(inner.name, inner)
        return list(found.values())

    def leaves(self) -> Iterator[tuple[bpy.types.Object, Matrix]]:
        """Everything that placed scenes show, with its place in the world."""
        for thing, held in self.holders.values():
            place = thing.evaluated_get(self._depsgraph).matrix_world
            yield from held.leaves(self._depsgraph, place)

    def places(self, depsgraph: bpy.types.Depsgraph) -> dict[Key, tuple[Matrix, bool]]:
        """Places, at the current frame, of empties that place scenes, and of their things."""
        out = {}
        for name, (thing, _) in self.holders.items():
            place = thing.evaluated_get(depsgraph).matrix_world.copy()
            out[(name,)] = (place, not thing.hide_render)
        for held in self.scenes:
            for thing in (*held.things, *held.lights, *(thing for thing, _ in held.holders)):
                out[held.key(thing)] = (held.place(thing, depsgraph), not thing.hide_render)
        return out


def plan(layer: bpy.types.ViewLayer, depsgraph: bpy.types.Depsgraph, report: Report) -> Plan:
    """The empties whose collections placed scenes can hold; names why others cannot."""
    out = Plan(depsgraph)
    placing = [
        thing for thing in layer.objects if is_holder(thing) and thing.visible_get(view_layer=layer)
    ]
    if not placing:
        return out
    shown = _shown(depsgraph)
    known: dict[str, Held | _NotHeldError] = {}
    for thing in sorted(placing, key=full_name):
        try:
            held = _held_by(thing, known)
            if held.is_empty:
                continue
            place = thing.evaluated_get(depsgraph).matrix_world
            if not _agree(shown.get(full_name(thing), []), list(held.leaves(depsgraph, place))):
                raise _NotHeldError("Blender shows other things there than those of the collection")
            if _is_scaled(place) and _has_area_light(held):
                raise _NotHeldError("it is scaled, and an area light in it with it")
            out.holders[full_name(thing)] = (thing, held)
        except _NotHeldError as reason:
            report.lose("collection-flat", thing.name, str(reason))
    _keep_within_limits(out, report)
    return out


def _held_by(holder: bpy.types.Object, known: dict[str, Held | _NotHeldError]) -> Held:
    """The content of the collection that `holder` places."""
    if _is_multiplied(holder):
        raise _NotHeldError(f"{holder.parent.name} places {holder.name}")
    collection = holder.instance_collection
    name = full_name(collection)
    if name not in known:
        try:
            known[name] = _content(collection, known)
        except _NotHeldError as reason:
            known[name] = reason
    found = known[name]
    if isinstance(found, _NotHeldError):
        raise found
    return found


def _content(collection: bpy.types.Collection, known: dict[str, Held | _NotHeldError]) -> Held:
    held = Held(collection, [], [], [])
    for thing in members(collection):
        if is_holder(thing):
            if is_never_shown(thing):
                continue
            inner = _held_by(thing, known)
            if _is_scaled(thing.matrix_world) and _has_area_light(inner):
                raise _NotHeldError(f"{thing.name} is scaled, and an area light in it with it")
            if not inner.is_empty:
                held.holders.append((thing, inner))
        elif thing.is_instancer or _is_multiplied(thing):
            raise _NotHeldError(f"{thing.name} places instances, or is placed by one that does")
        elif thing.type in DRAWN:
            held.things.append(thing)
        elif thing.type == "LIGHT":
            held.lights.append(thing)
        elif thing.type not in SILENT:
            raise _NotHeldError(f"{thing.name} is a {thing.type.lower()}")
    return held


def _is_multiplied(thing: bpy.types.Object) -> bool:
    """Whether vertices or faces of its parent place an object, in place of itself."""
    return thing.parent is not None and thing.parent.instance_type in {"VERTS", "FACES"}


def _shown(
    depsgraph: bpy.types.Depsgraph,
) -> dict[str, list[tuple[bpy.types.Object, Matrix]]]:
    """Instances of things and lights by the object that places them."""
    out: dict[str, list[tuple[bpy.types.Object, Matrix]]] = {}
    for instance in instances(depsgraph):
        if instance.is_instance and instance.object.type not in SILENT - {"LIGHT"}:
            made = (instance.object.original, instance.matrix_world.copy())
            out.setdefault(full_name(instance.parent.original), []).append(made)
    return out


def _agree(
    shown: list[tuple[bpy.types.Object, Matrix]], held: list[tuple[bpy.types.Object, Matrix]]
) -> bool:
    """Whether both have the same things, and these the same places on average."""
    means = [_means(shown), _means(held)]
    if means[0].keys() != means[1].keys():
        return False
    for name, (count, mean) in means[0].items():
        other_count, other = means[1][name]
        largest = max(max(abs(part) for part in row) for row in mean)
        near = all(
            abs(a - b) <= _TOLERANCE * max(largest, 1.0)
            for row, other_row in zip(mean, other, strict=True)
            for a, b in zip(row, other_row, strict=True)
        )
        if count != other_count or not near:
            return False
    return True


def _means(leaves: list[tuple[bpy.types.Object, Matrix]]) -> dict[str, tuple[int, Matrix]]:
    sums: dict[str, tuple[int, Matrix]] = {}
    for thing, place in leaves:
        count, total = sums.get(full_name(thing), (0, Matrix.Diagonal((0, 0, 0, 0))))
        sums[full_name(thing)] = (count + 1, total + place)
    return {name: (count, total * (1 / count)) for name, (count, total) in sums.items()}


def _is_scaled(place: Matrix) -> bool:
    return any(abs(part - 1) > 1e-4 for part in place.to_scale())


def _has_area_light(held: Held) -> bool:
    lights = [thing for inner in held.all() for thing in inner.lights]
    return any(thing.data.type == "AREA" for thing in lights)


def _keep_within_limits(made: Plan, report: Report) -> None:
    """Leave out empties of the collections that are placed most often, where there are too many."""
    by_collection: dict[str, list[str]] = {}
    for name, (_, held) in made.holders.items():
        by_collection.setdefault(held.name, []).append(name)

    def cost(item: tuple[str, list[str]]) -> tuple[int, int, str]:
        scenes, things = made.holders[item[1][0]][1].weight
        return scenes * len(item[1]), things * len(item[1]), item[0]

    left, room, files = _MOST_PLACED, _MOST_THINGS, set[str]()
    for item in sorted(by_collection.items(), key=cost):
        scenes, things, _ = cost(item)
        more = files | {held.name for held in made.holders[item[1][0]][1].all()}
        if scenes <= left and things <= room and len(more) <= _MOST_FILES:
            left, room, files = left - scenes, room - things, more
            continue
        placed = [made.holders.pop(name) for name in item[1]]
        text = f"it is placed too often for a scene, {len(placed)} times"
        report.lose("collection-flat", placed[0][1].name, text)
