"""Owns the parts of an export, each a scene text: the scene itself, and collections it places."""

from __future__ import annotations

import dataclasses
from typing import Any

import bpy

from . import space, things
from .motion import Samples
from .names import Names
from .placed import Held
from .reach import Key
from .report import Report
from .scene_text import Placer, SceneText


@dataclasses.dataclass
class Part:
    """The content of one scene text."""

    file: str
    text: SceneText
    report: Report
    # The collection that it holds; None for the scene itself.
    held: Held | None = None
    drawn: dict[Key, things.Thing] = dataclasses.field(default_factory=dict)
    rigs: list[list[bpy.types.Object]] = dataclasses.field(default_factory=list)
    # Parts that it places.
    placed: list[tuple[Key, things.Thing, Part]] = dataclasses.field(default_factory=list)
    # Lights by their names, each with its key.
    shining: dict[str, tuple[Key, bpy.types.Object]] = dataclasses.field(default_factory=dict)
    # Names by kind: names given away, and names of entries, with entries of parts that it places.
    names: dict[str, Names] = dataclasses.field(
        default_factory=lambda: {"instance": Names(), "model": Names(), "light": Names()}
    )
    entries: dict[str, set[str]] = dataclasses.field(
        default_factory=lambda: {"instance": set(), "model": set(), "light": set()}
    )

    def _called(self, kind: str, wanted: str) -> str:
        name = self.names[kind].unique(wanted)
        self.entries[kind].add(name)
        return name

    def add_light(self, wanted: str, key: Key, thing: bpy.types.Object) -> None:
        """Take a light under a name of its own."""
        self.shining[self._called("light", wanted)] = (key, thing)

    def put_lights(self, values: dict[Key, dict[str, Any]], samples: Samples | None) -> int:
        """Write the lights that are not dark, with their motion; returns how many."""
        lit = [(name, key) for name, (key, _) in self.shining.items() if key in values]
        for name, key in lit:
            tracks = samples.of_light(key, name, self.report) if samples else {}
            self.text.add("light", name, values[key], tracks)
        return len(lit)

    def put_model(
        self, name: str, values: dict[str, Any], overrides: dict[str, dict[str, Any]]
    ) -> None:
        """Write a model, whose name no other model of the export has."""
        self._called("model", name)
        self.text.add_model(name, values, overrides)

    def put_rig(self, name: str) -> None:
        """Place a model that stands where its objects are in Blender."""
        values: dict[str, Any] = {"name": self._called("instance", name), "model": name}
        offset = self.held.collection.instance_offset if self.held else None
        if offset is not None and any(offset):
            values["translation"] = list(space.vector(-offset))
        self.text.add_instance(values)

    def put_things(self, placer: Placer, samples: Samples | None) -> None:
        """Place everything that is ever shown: first parts, whose entries take names."""
        for key, thing, part in self.placed:
            if not is_ever_shown(key, thing, samples):
                continue
            name = self._free_name(thing.name, part)
            things.name_losses(thing.source, self.report)
            if placer.place(key, dataclasses.replace(thing, name=name), samples):
                for kind, entries in part.entries.items():
                    inner = {f"{name}.{entry}" for entry in entries}
                    self.entries[kind] |= inner
                    self.names[kind].take(inner)
        for key, thing in sorted(self.drawn.items(), key=lambda item: (item[1].name, str(item[0]))):
            if is_ever_shown(key, thing, samples):
                things.name_losses(thing.source, self.report)
                placer.place(key, thing, samples)
        placer.finish()
        self.entries["instance"].update(placer.placed_names)

    def _free_name(self, wanted: str, part: Part) -> str:
        """A name under which no entry of `part` is called as another entry here."""
        name, count = wanted, 1
        while name in self.names["instance"] or any(
            f"{name}.{entry}" in self.names[kind]
            for kind, entries in part.entries.items()
            for entry in entries
        ):
            count += 1
            name = f"{wanted} ({count})"
        return name


def is_ever_shown(key: Key, thing: things.Thing, samples: Samples | None) -> bool:
    """Whether a thing is shown at the exported frame, or at any of them."""
    return samples.is_ever_shown(key) if samples else thing.shown
