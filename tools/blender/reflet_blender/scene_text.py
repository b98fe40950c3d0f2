"""Owns the text of the exported scene: its tables, and how things are placed in it."""

from __future__ import annotations

import dataclasses
from typing import Any

from . import space
from .folder import Folder
from .motion import Samples
from .names import Names, file_stem
from .report import Report
from .things import Key, Thing
from .toml_text import key, number, quoted, table

__all__ = ["PLACED_HEAD", "Placer", "SceneText", "quoted"]

HEAD = """\
# Written by the export from Blender, and written anew by the next one: change scene.toml instead,
# which lies over this file.
version = 1
"""
PLACED_HEAD = """\
# A collection that blender.toml places, written by the export from Blender, and anew by the next
# one: change scene.toml instead, where names of this file stand behind the place's name and a dot.
version = 1
"""
# From so many instances on that one object makes of one model, a table of points holds them.
_MANY = 32


class SceneText:
    """The tables of a scene, in the order in which they are written."""

    def __init__(self, head: str = HEAD) -> None:
        self._head = head
        self.settings: dict[str, dict[str, Any]] = {}
        self.environment: dict[str, Any] | None = None
        self._tables: list[str] = []
        self._motion: list[str] = []

    def add(self, kind: str, name: str, values: dict[str, Any], tracks: dict[str, Any]) -> None:
        """A camera or light with its motion."""
        self._tables.append(table(f"[{kind}.{key(name)}]", values))
        self.add_motion(kind, name, tracks)

    def add_motion(self, kind: str, name: str, tracks: dict[str, Any]) -> None:
        """The motion of anything; nothing where there are no tracks."""
        if tracks:
            self._motion.append(table(f"[motion.{kind}.{key(name)}]", tracks))

    def add_model(
        self, name: str, values: dict[str, Any], overrides: dict[str, dict[str, Any]]
    ) -> None:
        """A model with values over the materials of its file."""
        self._tables.append(table(f"[model.{key(name)}]", values))
        for material, changed in overrides.items():
            header = f"[model.{key(name)}.material.{key(material)}]"
            self._tables.append(table(header, changed))

    def add_instance(self, values: dict[str, Any]) -> None:
        """A placed model."""
        self._tables.append(table("[[instance]]", values))

    def document(self) -> str:
        """All of it."""
        settings = [table(f"[{name}]", values) for name, values in self.settings.items()]
        if self.environment is not None:
            settings.append(table("[environment]", self.environment))
        return "\n".join([self._head, *settings, *self._tables, *self._motion])


@dataclasses.dataclass
class _Crowd:
    """Instances of one model that one object makes."""

    name: str
    values: dict[str, Any]
    things: list[tuple[Thing, space.Parts]]


class Placer:
    """Places things: each as an instance of its name, crowds of instances as tables of points."""

    def __init__(
        self, text: SceneText, folder: Folder, report: Report, names: Names, file_names: Names
    ) -> None:
        self._text, self._folder, self._report = text, folder, report
        self._names, self._file_names = names, file_names
        self._crowds: dict[tuple[Any, ...], _Crowd] = {}
        self.count = 0
        self.placed_names: list[str] = []

    def place(self, thing_key: Key, thing: Thing, samples: Samples | None) -> bool:
        """Place one thing, with its motion where `samples` has any; false where no text can."""
        if not space.is_sound(thing.place):
            self._report.lose("place-invalid", thing.name)
            return False
        if space.is_flat(thing.place):
            # Its motion hides it until then.
            later = samples.first_solid(thing_key) if samples is not None else None
            if later is None:
                self._report.lose("scale-zero", thing.name)
                return False
            thing = dataclasses.replace(thing, place=later)
        moves = samples is not None and samples.moves(thing_key)
        parts = space.parts(space.matrix(thing.place))
        self.count += 1
        if thing.is_instance and not moves and parts is not None:
            crowd_key = (thing.name, id(thing.model), thing.sight)
            crowd = _Crowd(thing.name, _sight(thing), [])
            self._crowds.setdefault(crowd_key, crowd).things.append((thing, parts))
            return True
        name = self._place_one(thing, parts)
        if moves and samples is not None:
            tracks = samples.of_thing(thing_key, name, self._report)
            self._text.add_motion(thing.model.moved_as, name, tracks)
        return True

    def _place_one(self, thing: Thing, parts: space.Parts | None) -> str:
        name = self._called(thing.name)
        values: dict[str, Any] = {"name": name, "model": thing.model.value}
        values.update(_placement(parts) if parts else _matrix(thing))
        values.update(_sight(thing))
        self._text.add_instance(values)
        return name

    def _called(self, wanted: str) -> str:
        name = self._names.unique(wanted)
        self.placed_names.append(name)
        return name

    def finish(self) -> None:
        """Place the crowds."""
        for crowd in self._crowds.values():
            if len(crowd.things) < _MANY:
                for thing, parts in crowd.things:
                    self._place_one(thing, parts)
                continue
            name = self._called(crowd.name)
            file = f"instances/{self._file_names.unique(file_stem(name))}.csv"
            lines = ["x,y,z,qx,qy,qz,qw,sx,sy,sz"]
            for _, parts in crowd.things:
                turn = parts.rotation
                row = [*parts.translation, turn.x, turn.y, turn.z, turn.w, *parts.scale]
                lines.append(",".join(number(part) for part in row))
            self._folder.put(file, ("\n".join(lines) + "\n").encode())
            model = crowd.things[0][0].model.value
            values = {"name": name, "model": model, "instances_from": file, **crowd.values}
            self._text.add_instance(values)


def _sight(thing: Thing) -> dict[str, Any]:
    names = ("visible", "casts_shadow", "in_reflections")
    return {name: False for name, seen in zip(names, thing.sight, strict=True) if not seen}


def _placement(parts: space.Parts) -> dict[str, Any]:
    turn, scale = parts.rotation, parts.scale
    out: dict[str, Any] = {}
    if any(parts.translation):
        out["translation"] = list(parts.translation)
    if abs(turn.w) < 1 - 1e-7 or any(abs(part) > 1e-7 for part in (turn.x, turn.y, turn.z)):
        out["rotation_quat"] = [turn.x, turn.y, turn.z, turn.w]
    if any(abs(part - 1) > 1e-6 for part in scale):
        even = max(scale) - min(scale) <= 1e-6 * abs(scale[0])
        out["scale"] = scale[0] if even else list(scale)
    return out


def _matrix(thing: Thing) -> dict[str, Any]:
    turned = space.matrix(thing.place)
    columns = [value for column in turned.col for value in column]
    return {"matrix": [*columns[:3], 0, *columns[4:7], 0, *columns[8:11], 0, *columns[12:15], 1]}
