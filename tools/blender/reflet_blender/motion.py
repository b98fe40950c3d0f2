"""Owns motion: whether anything may move, and a scene's state at each of its frames."""

from __future__ import annotations

import hashlib
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from . import camera as cameras
from . import keys, space
from . import light as lights
from .placed import Plan
from .reach import Key, full_name
from .reach import objects as objects_of
from .report import Report
from .things import places

_MOST_FRAMES = 1_000_000
# Modifiers that move a mesh without any key.
_SIMULATED = {"CLOTH", "SOFT_BODY", "FLUID", "OCEAN", "WAVE", "DYNAMIC_PAINT", "PARTICLE_SYSTEM"}
_SIMULATED |= {"NODES", "MESH_CACHE", "MESH_SEQUENCE_CACHE", "EXPLODE"}
_MOVING_LIGHT = (
    *("position", "direction", "intensity_cd", "intensity_lux", "color"),
    *("inner_deg", "outer_deg"),
)


def may_move(scene: bpy.types.Scene) -> bool:
    """Whether a second frame could differ from the first: keys, drivers, simulations."""
    if scene.frame_end <= scene.frame_start:
        return False
    if scene.rigidbody_world is not None:
        return True
    data = bpy.data
    for owners in (data.objects, data.armatures, data.shape_keys, data.lights, data.cameras):
        for owner in owners:
            animation = owner.animation_data
            if animation and (animation.action or animation.drivers or animation.nla_tracks):
                return True
    return any(
        modifier.type in _SIMULATED for thing in objects_of(scene) for modifier in thing.modifiers
    )


def frames_of(scene: bpy.types.Scene, report: Report) -> list[int]:
    """The scene's frames, within Reflet's range."""
    first, last = max(scene.frame_start, 0), min(scene.frame_end, _MOST_FRAMES)
    if (first, last) != (scene.frame_start, scene.frame_end):
        report.lose("frames-cut", scene.name)
    return list(range(first, max(last, first) + 1))


def deforming(
    scene: bpy.types.Scene, layer: bpy.types.ViewLayer, frames: list[int]
) -> list[bpy.types.Object]:
    """Meshes whose points differ between the first, the middle and the last frame."""
    watched = [
        thing
        for thing in objects_of(scene)
        if thing.type == "MESH" and (thing.modifiers or thing.data.shape_keys)
    ]
    if not watched:
        return []
    found: dict[str, set[bytes]] = {full_name(thing): set() for thing in watched}
    quarters = {frames[len(frames) * part // 4] for part in range(4)} | {frames[-1]}
    for frame in sorted(quarters):
        scene.frame_set(frame)
        depsgraph = layer.depsgraph
        for thing in watched:
            mesh = thing.evaluated_get(depsgraph).data
            points = np.empty(len(mesh.vertices) * 3, np.float32)
            mesh.vertices.foreach_get("co", points)
            found[full_name(thing)].add(hashlib.sha256(points.tobytes()).digest())
    return [thing for thing in watched if len(found[full_name(thing)]) > 1]


def _solid(been: list[tuple[Matrix, bool]], name: str, report: Report) -> list[tuple[Matrix, bool]]:
    """The places of a thing that motion can say: it is hidden where it is scaled to nothing."""
    last = next(place for place, _ in been if not space.is_flat(place))
    is_mirrored, out = last.is_negative, []
    for place, shown in been:
        is_flat = space.is_flat(place)
        if not is_flat and place.is_negative != is_mirrored:
            report.lose("mirror-motion-frozen", name)
        elif not is_flat:
            last = place
        out.append((last, shown and not is_flat))
    return out


class Samples:
    """Values of things, cameras and lights at each frame."""

    def __init__(self, frames: list[int], fps: float) -> None:
        self.frames, self.fps = frames, fps
        self._places: dict[Key, list[tuple[Matrix, bool]]] = {}
        self._values: dict[tuple[str, Any], list[dict[str, Any]]] = {}
        self._changing = False

    def take(
        self,
        scene: bpy.types.Scene,
        depsgraph: bpy.types.Depsgraph,
        plan: Plan,
        seen: dict[str, bpy.types.Object],
        shining: dict[Key, bpy.types.Object],
    ) -> None:
        """Add the current frame: cameras by their names, lights by their keys."""
        at = places(depsgraph, plan)
        if self._places and at.keys() != self._places.keys():
            self._changing = True
        if not self._places:
            self._places = {key: [] for key in at}
        for key, been in self._places.items():
            # A thing that is gone stays where it was.
            been.append(at[key] if key in at else been[-1])
        silent = Report()
        for name, thing in seen.items():
            evaluated = thing.evaluated_get(depsgraph)
            value = cameras.values(evaluated, scene, depsgraph)
            self._values.setdefault(("camera", name), []).append(value)
        for key, thing in shining.items():
            place, shown = self._places[key][-1]
            lit = lights.values(thing.evaluated_get(depsgraph), place, silent) or {}
            if not shown:
                lit.update((what, 0.0) for what in lit if what.startswith("intensity_"))
            self._values.setdefault(("light", key), []).append(lit)

    def name_losses(self, scene: bpy.types.Scene, report: Report) -> None:
        """Name what changes over time and has no track."""
        if self._changing:
            report.lose("instances-frozen", scene.name)

    def moves(self, key: Key) -> bool:
        """Whether a thing is at another place, or hidden, at some frame."""
        been = self._places.get(key, [])
        return any(now[1] != been[0][1] or now[0] != been[0][0] for now in been)

    def is_ever_shown(self, key: Key) -> bool:
        """Whether a thing is shown at some frame."""
        return any(shown for _, shown in self._places.get(key, []))

    def first_solid(self, key: Key) -> Matrix | None:
        """The first place of a thing where it has a volume."""
        been = (place for place, _ in self._places.get(key, []))
        return next((place for place in been if not space.is_flat(place)), None)

    def of_thing(self, key: Key, name: str, report: Report) -> dict[str, Any]:
        """The tracks of `[motion.instance.NAME]`."""
        been = _solid(self._places[key], name, report)
        out: dict[str, Any] = {}
        shown = keys.steps(self.frames, [shown for _, shown in been], self.fps)
        if shown:
            out["shown"] = shown
        found = [space.parts(space.matrix(place)) for place, _ in been]
        parts = [part for part in found if part is not None]
        if len(parts) < len(found):
            if any(place != been[0][0] for place, _ in been):
                report.lose("matrix-motion-frozen", name)
            return out
        turns, last = [], None
        for part in parts:
            last = part.rotation.to_euler("XYZ", last) if last else part.rotation.to_euler("XYZ")
            turns.append([float(np.degrees(angle)) for angle in last])
        moved = {
            "translation": [list(part.translation) for part in parts],
            "rotation_deg": turns,
            "scale": [list(part.scale) for part in parts],
        }
        for what, values in moved.items():
            made = keys.track(self.frames, values, self.fps)
            if made:
                out[what] = made
        return out

    def of_camera(self, name: str) -> dict[str, Any]:
        """The tracks of `[motion.camera.NAME]`."""
        return self._tracks(self._values.get(("camera", name), []), None)

    def of_light(self, key: Key, name: str, report: Report) -> dict[str, Any]:
        """The tracks of `[motion.light.NAME]`."""
        values = self._values.get(("light", key), [])
        if not all(values):
            report.lose("light-animation-frozen", name, "it is off at some frames")
            return {}
        out = self._tracks(values, _MOVING_LIGHT)
        others = [k for k in values[0] if k not in _MOVING_LIGHT] if values else []
        frozen = [k for k in others if any(value.get(k) != values[0][k] for value in values)]
        if frozen:
            report.lose("light-animation-frozen", name, f"{', '.join(frozen)} of the first frame")
        return out

    def _tracks(
        self, values: list[dict[str, Any]], wanted: tuple[str, ...] | None
    ) -> dict[str, Any]:
        out = {}
        for what in values[0] if values else []:
            if wanted is not None and what not in wanted:
                continue
            listed = [v[what] if isinstance(v[what], list) else [v[what]] for v in values]
            made = keys.track(self.frames, listed, self.fps)
            if made:
                out[what] = made
        return out
