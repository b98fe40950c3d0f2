"""Owns lights: from watts to Reflet's candela and lux.

Blender's light of P watts gives radiance without an efficacy of light, and white at 1, as Reflet
does: an illuminance of pi lux lights a white surface to 1. So a point or spot has P / (4 pi)
candela, a flat light P / pi straight ahead, and a sun of strength E has E lux. These are Cycles's
values: `Light::shade` and the tests, which render both.
"""

from __future__ import annotations

import math
from typing import Any

import bpy
from mathutils import Matrix, Vector

from . import space
from .report import Report

# Reflet's cones end below 90 degrees.
_WIDEST_CONE_DEG = 89.9
_LEAST_COSINE = math.cos(math.radians(_WIDEST_CONE_DEG))
# Cycles's border is a smooth step of the cosine, Reflet's a square: its ends, as shares of the
# range of the step, with which it passes as much light. It differs by .033 of full brightness on
# average, by .104 at most, and shines .012 outside; from 0 to .75 it differs by .047 and .156.
_BORDER = (0.8, -0.1)


def values(light: bpy.types.Object, place: Matrix, report: Report) -> dict[str, Any] | None:
    """The keys of `[light.NAME]` for an evaluated light; None, and a loss, where it is dark."""
    data = light.data
    color, brightest = _color(data)
    power = data.energy * 2**data.exposure * brightest
    if data.energy < 0 or (data.use_nodes and data.node_tree is None):
        report.lose("light-off", light.name)
        return None
    if not space.is_sound(place):
        report.lose("place-invalid", light.name)
        return None
    position = list(space.vector(place.translation))
    turn = place.to_quaternion()
    direction = list(space.vector(turn @ Vector((0, 0, -1))))
    shared = {"color": color, "shadow": "ray" if data.use_shadow else "none"}
    if data.type == "SUN":
        angle = min(data.angle, math.pi)
        lux = power if data.normalize else power * math.pi * math.sin(min(angle, math.pi) / 2) ** 2
        degrees = min(math.degrees(angle), 90.0)
        kind = {"kind": "directional", "direction": direction, "intensity_lux": lux}
        return {**kind, "angle_deg": degrees, **shared}
    if data.type == "AREA":
        return {**_area(light, place, power, position, direction), **shared}
    radius = data.shadow_soft_size
    if not data.normalize:
        power *= 4 * math.pi * radius**2 if radius > 0 else 1.0
    out = {"position": position, "intensity_cd": power / (4 * math.pi), "radius_m": radius}
    if data.type == "POINT":
        return {"kind": "point", **out, **shared}
    outer = min(math.degrees(data.spot_size / 2), _WIDEST_CONE_DEG)
    edge = (1 - math.cos(math.radians(outer))) * data.spot_blend
    ends = [math.cos(math.radians(outer)) + share * edge for share in _BORDER]
    inner, outer = (math.degrees(math.acos(min(max(end, _LEAST_COSINE), 1.0))) for end in ends)
    cone = {"inner_deg": inner, "outer_deg": outer}
    return {"kind": "spot", **out, "direction": direction, **cone, **shared}


def _color(data: bpy.types.Light) -> tuple[list[float], float]:
    """The light's color with a largest part of 1, and what to multiply its power by."""
    color = Vector(data.color)
    if data.use_temperature:
        color = Vector(a * b for a, b in zip(color, data.temperature_color, strict=True))
    brightest = max(color)
    if brightest <= 0:
        return [0.0, 0.0, 0.0], 0.0
    return [max(part, 0.0) / brightest for part in color], brightest


def _area(
    light: bpy.types.Object,
    place: Matrix,
    power: float,
    position: list[float],
    direction: list[float],
) -> dict[str, Any]:
    data = light.data
    scale = place.to_scale()
    size_x = abs(data.size * scale.x)
    tall = data.size_y if data.shape in {"RECTANGLE", "ELLIPSE"} else data.size
    size_y = abs(tall * scale.y)
    round_one = data.shape in {"DISK", "ELLIPSE"}
    size_x, size_y = max(size_x, 1e-6), max(size_y, 1e-6)
    if not data.normalize:
        # The power is then given per square meter.
        power *= size_x * size_y * (math.pi / 4 if round_one else 1.0)
    out = {"position": position, "direction": direction, "intensity_cd": power / math.pi}
    if round_one and abs(size_x - size_y) <= 1e-4 * size_x:
        return {"kind": "disk", **out, "radius_m": size_x / 2}
    shrink = math.sqrt(math.pi / 4) if round_one else 1.0
    up = list(space.vector(place.to_quaternion() @ Vector((0, 1, 0))))
    return {"kind": "rect", **out, "up": up, "size": [size_x * shrink, size_y * shrink]}


def name_losses(light: bpy.types.Object, place: Matrix, report: Report) -> None:
    """Name what a light has and `[light.NAME]` has not."""
    data, name = light.data, light.name
    scale = place.to_scale()
    if data.use_nodes and data.node_tree and _has_own_nodes(data.node_tree):
        report.lose("light-nodes-dropped", name)
    if data.type == "AREA":
        if data.spread < math.pi - 1e-3:
            spread = f"a spread of {math.degrees(data.spread):.4g} degrees is one of 180"
            report.lose("area-spread-dropped", name, spread)
        if data.shape == "ELLIPSE" and abs(data.size * scale.x - data.size_y * scale.y) > 1e-6:
            report.lose("light-kind-approximated", name)
    if data.type == "SPOT":
        scaled = max(scale) - min(scale) > 1e-3 * max(scale)
        if scaled or data.spot_size / 2 > math.radians(_WIDEST_CONE_DEG):
            report.lose("spot-approximated", name)
    if light.visible_camera:
        report.lose("light-seen-dropped", name)
    linking = light.light_linking
    if linking.receiver_collection or linking.blocker_collection:
        report.lose("light-linking-dropped", name)


def _has_own_nodes(tree: bpy.types.NodeTree) -> bool:
    return any(node.type not in {"EMISSION", "OUTPUT_LIGHT"} for node in tree.nodes)
