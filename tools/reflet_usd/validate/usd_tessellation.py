"""Owns the documented tessellation of curved gprims: 32 segments around, 16 from pole to pole."""

import dataclasses
import math

import numpy as np
from pxr import Usd, UsdGeom

from .scene_data import Array, Indices, Surface
from .surfaces import axis_turn
from .usd_mesh import LocalMesh, one_material

_AROUND = 32
_RINGS = 16
_SIZES = ("radius", "height", "radiusBottom", "radiusTop")


@dataclasses.dataclass
class _Band:
    """A profile that turns around Z: radii and heights, bottom to top, and its normals."""

    radius: Array
    height: Array
    out: Array
    """Share of the normal that points away from the axis."""
    up: Array


def read_tessellated(prim: Usd.Prim, time: Usd.TimeCode, surface: Surface) -> LocalMesh | None:
    """The faces of a curved gprim with exact normals; None where a size is 0 or negative."""
    sizes = [prim.GetAttribute(name).Get(time) for name in _SIZES if prim.HasAttribute(name)]
    signs = [math.copysign(1.0, size) for size in sizes if size is not None]
    flat = surface.kind != "sphere" and surface.height == 0.0
    pointed = surface.kind in ("cone", "cylinder") and max(surface.radius) > 0.0
    if min(signs, default=1.0) < 0.0 or flat or (min(surface.radius) == 0.0 and not pointed):
        return None
    corners, normals, counts = _faces(surface)
    turn = axis_turn(surface.axis).T
    corners, normals = corners @ turn, normals @ turn
    gprim = UsdGeom.Gprim(prim)
    if gprim.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded:
        # The counts are reversed like the corners.
        corners, normals, counts = corners[::-1], -normals[::-1], counts[::-1]
    colors = None if surface.color is None else np.tile(surface.color, (len(corners), 1))
    return LocalMesh(
        corners,
        counts,
        *one_material(surface.material, len(counts)),
        bool(gprim.GetDoubleSidedAttr().Get(time)),
        normals=normals,
        colors=colors,
        undefined_colors=surface.undefined_colors,
    )


def _faces(surface: Surface) -> tuple[Array, Array, Indices]:
    """Corners, their normals, and number of corners of each face, with the axis along Z."""
    bottom, top = surface.radius
    half = surface.height / 2
    if surface.kind == "sphere":
        return _turned(_arc(bottom, 0.0, -1.0, 1.0, _RINGS))
    if surface.kind == "capsule":
        arcs = (
            _arc(bottom, -half, -1.0, 0.0, _RINGS // 2),
            _arc(top, half, 0.0, 1.0, _RINGS // 2),
        )
        names = [field.name for field in dataclasses.fields(_Band)]
        return _turned(_Band(*(np.hstack([getattr(arc, name) for arc in arcs]) for name in names)))
    slope = np.array([surface.height, bottom - top]) / np.hypot(surface.height, bottom - top)
    side = _Band(
        np.array([bottom, top]), np.array([-half, half]), np.full(2, slope[0]), np.full(2, slope[1])
    )
    parts = [_turned(side)]
    # Lids: profiles that run out from the axis below, and back to it above.
    for radius, height, up in ((bottom, -half, -1.0), (top, half, 1.0)):
        if radius > 0.0:
            run = np.array([0.0, radius]) if up < 0.0 else np.array([radius, 0.0])
            parts.append(_turned(_Band(run, np.full(2, height), np.zeros(2), np.full(2, up))))
    corners, normals, counts = zip(*parts, strict=True)
    return np.vstack(corners), np.vstack(normals), np.concatenate(counts)


def _arc(radius: float, center: float, first: float, last: float, steps: int) -> _Band:
    """Part of a circle, from `first` to `last` in quarter turns of latitude."""
    angles = np.linspace(first, last, steps + 1) * (math.pi / 2)
    out, up = np.cos(angles), np.sin(angles)
    out[np.abs(out) < 1e-12] = 0.0
    return _Band(radius * out, center + radius * up, out, up)


def _turned(band: _Band) -> tuple[Array, Array, Indices]:
    """Faces between neighboring rings; triangles where one ring is a point."""
    angles = np.arange(_AROUND) * (2.0 * math.pi / _AROUND)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    points = np.stack([_ring(r, h, circle) for r, h in zip(band.radius, band.height, strict=True)])
    normals = np.stack([_ring(o, u, circle) for o, u in zip(band.out, band.up, strict=True)])
    corners: list[Array] = []
    directions: list[Array] = []
    counts: list[Indices] = []
    here = np.arange(_AROUND)
    after = np.roll(here, -1)
    for low in range(len(points) - 1):
        quad = [(low, here), (low, after), (low + 1, after), (low + 1, here)]
        if band.radius[low] == 0.0:
            quad.pop(0)
        elif band.radius[low + 1] == 0.0:
            quad.pop(3)
        for found, source in ((corners, points), (directions, normals)):
            found.append(np.stack([source[ring, at] for ring, at in quad], axis=1).reshape(-1, 3))
        counts.append(np.full(_AROUND, len(quad)))
    return np.vstack(corners), np.vstack(directions), np.concatenate(counts)


def _ring(radius: float, height: float, circle: Array) -> Array:
    return np.column_stack([radius * circle, np.full(len(circle), height)])
