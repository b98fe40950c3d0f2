"""Owns cameras: place, field of view, near plane, lens."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import bpy
from mathutils import Vector

from . import space
from .folder import ExportError
from .report import Report

# The sensor height that Reflet's f-numbers refer to, mm.
_SENSOR_MM = 24.0
_KINDS = {"PERSP", "ORTHO"}


def is_carried(camera: bpy.types.Object, report: Report) -> bool:
    """Whether Reflet has this kind of camera; names it as a loss where not."""
    if camera.data.type in _KINDS:
        return True
    report.lose("camera-kind-dropped", camera.name, f"a camera of the kind {camera.data.type}")
    return False


def values(
    camera: bpy.types.Object, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph
) -> dict[str, Any]:
    """The keys of `[camera.NAME]` for an evaluated camera at the current frame."""
    data, render = camera.data, scene.render
    place = camera.matrix_world
    eye = space.vector(place.translation)
    # A camera's own scale does not change its picture.
    turn = place.to_quaternion()
    ahead = space.vector(turn @ Vector((0, 0, -1)))
    focus = _focus_m(camera)
    projection = camera.calc_matrix_camera(
        depsgraph,
        x=render.resolution_x,
        y=render.resolution_y,
        scale_x=render.pixel_aspect_x,
        scale_y=render.pixel_aspect_y,
    )
    if projection[1][1] == 0:
        raise ExportError(f"the view of the camera {camera.name!r} ends where it begins")
    half_height = 1 / projection[1][1]
    out: dict[str, Any] = {
        "eye": list(eye),
        "target": list(eye + ahead * focus),
        "up": list(space.vector(turn @ Vector((0, 1, 0)))),
        "near_m": max(data.clip_start, 1e-6),
    }
    # Where the middle of the picture is, in halves of its size from the view direction.
    is_flat = data.type == "ORTHO"
    across, above = (-projection[i][3] if is_flat else projection[i][2] for i in (0, 1))
    shift = [across / (half_height * projection[0][0]) / 2, above / 2]
    if any(abs(part) > 1e-6 for part in shift):
        out["lens_shift"] = [min(max(part, -10.0), 10.0) for part in shift]
    if is_flat:
        out["orthographic_height_m"] = 2 * half_height
        return out
    out["fov_deg"] = min(max(math.degrees(2 * math.atan(half_height)), 1.0), 170.0)
    if data.dof.use_dof:
        # The same width of the lens in meters: of Blender's, and of one with a sensor of 24 mm.
        width_mm = data.lens / max(data.dof.aperture_fstop, 1e-5)
        focal_mm = _SENSOR_MM / 2 / half_height
        out["aperture_f"] = min(max(focal_mm / width_mm, 0.1), 1000.0)
        out["focus_m"] = focus
    return out


def _focus_m(camera: bpy.types.Object) -> float:
    """The distance in focus along the view, meters; without depth of field 1."""
    dof = camera.data.dof
    if not dof.use_dof:
        return 1.0
    if dof.focus_object is None:
        return max(dof.focus_distance, 1e-3)
    away = dof.focus_object.matrix_world.translation - camera.matrix_world.translation
    ahead = camera.matrix_world.to_quaternion() @ Vector((0, 0, -1))
    return max(abs(away.dot(ahead)), 1e-3)


def name_losses(camera: bpy.types.Object, scene: bpy.types.Scene, report: Report) -> None:
    """Name what a camera has and `[camera.NAME]` has not."""
    data, dof = camera.data, camera.data.dof
    if scene.render.pixel_aspect_x != scene.render.pixel_aspect_y:
        report.lose("pixel-aspect-dropped", scene.name)
    if not dof.use_dof:
        return
    if data.type == "ORTHO":
        report.lose("dof-dropped", camera.name)
    elif dof.aperture_blades or dof.aperture_ratio != 1:
        report.lose("bokeh-dropped", camera.name)


def name_clipped(
    camera: bpy.types.Object, middles: Iterable[tuple[str, Vector]], report: Report
) -> None:
    """Name the loss where a thing, by the middle of its box, is beyond the camera's end of view."""
    inverse = camera.matrix_world.inverted_safe()
    for name, point in middles:
        if -(inverse @ point).z > camera.data.clip_end:
            report.lose("clip-end-dropped", camera.name, f"{name} is beyond its end of view")
            return
