"""Owns the exact geometry of curved gprims: distance of points to them and their boxes."""

import itertools

import numpy as np

from .scene_data import Array, Surface, transform_points

_MAX_PAIRS = 20_000_000


def distances_to_surfaces(surfaces: list[Surface], points: Array) -> Array:
    """(n,) distance of each point to the nearest surface, meters.

    Lengths within a prim are scaled by its largest axis; infinite for flattened prims. Points are
    thinned where they and the surfaces are too many to pair.
    """
    if len(surfaces) * len(points) > _MAX_PAIRS:
        points = points[:: len(surfaces) * len(points) // _MAX_PAIRS + 1]
    best = np.full(len(points), np.inf)
    for surface in surfaces:
        local = _to_local(points, surface)
        if local is not None:
            best = np.minimum(best, np.abs(_distance(surface, local)) * _scale(surface))
    return best


def untouched_extent(surfaces: list[Surface], points: Array) -> float:
    """How far points on a surface stay inside its box, meters; infinite without such points."""
    worst = 0.0
    if len(surfaces) * len(points) > _MAX_PAIRS:
        return worst
    for surface in surfaces:
        local = _to_local(points, surface)
        if local is None:
            continue
        reach = _extent(surface)
        near = local[np.abs(_distance(surface, local)) <= 1e-4 * reach.max()]
        if not len(near):
            return np.inf
        worst = max(worst, float((reach - np.abs(near).max(axis=0)).max()) * _scale(surface))
    return worst


def _scale(surface: Surface) -> float:
    return float(np.linalg.norm(surface.matrix[:3, :3], axis=1).max())


def surface_box(surface: Surface) -> Array:
    """The eight world corners of the surface's own box; exact where the axes stay aligned."""
    extent = _extent(surface)
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return transform_points(signs * extent @ axis_turn(surface.axis).T, surface.matrix)


def _to_local(points: Array, surface: Surface) -> Array | None:
    """World points in the prim's space with its axis turned to Z; None for a flattened prim."""
    if abs(np.linalg.det(surface.matrix)) < 1e-30:
        return None
    local = transform_points(points, np.asarray(np.linalg.inv(surface.matrix), np.float64))
    return local @ axis_turn(surface.axis)


def axis_turn(axis: int) -> Array:
    """A cyclic permutation that moves `axis` to Z (row vectors)."""
    return np.roll(np.eye(3), 2 - axis, axis=1)


def _extent(surface: Surface) -> Array:
    """Half sizes along X, Y, Z, with the axis on Z."""
    radius = max(surface.radius)
    if surface.kind == "sphere":
        return np.full(3, radius)
    half = surface.height / 2
    if surface.kind == "capsule":
        half += radius
    return np.array([radius, radius, half])


def _distance(surface: Surface, local: Array) -> Array:
    """Distance of points to the surface, centered with its axis along Z."""
    around = np.hypot(local[:, 0], local[:, 1])
    z, half = local[:, 2], surface.height / 2
    bottom, top = surface.radius
    if surface.kind == "sphere":
        return np.hypot(around, z) - bottom
    if surface.kind == "capsule":
        return _capsule_distance(around, z, half, bottom, top)
    profile = np.array([[0.0, -half], [bottom, -half], [top, half], [0.0, half]])
    return _polyline_distance(np.column_stack([around, z]), profile)


def _capsule_distance(around: Array, z: Array, half: float, bottom: float, top: float) -> Array:
    """Distance to a capsule: half spheres of two radii joined by a straight side."""
    side = _polyline_distance(
        np.column_stack([around, z]), np.array([[bottom, -half], [top, half]])
    )
    low = np.where(z <= -half, np.abs(np.hypot(around, z + half) - bottom), np.inf)
    high = np.where(z >= half, np.abs(np.hypot(around, z - half) - top), np.inf)
    return np.minimum(side, np.minimum(low, high))


def _polyline_distance(points: Array, line: Array) -> Array:
    best = np.full(len(points), np.inf)
    for start, end in itertools.pairwise(line):
        span = end - start
        length2 = float(span @ span)
        if length2 == 0:
            nearest = np.broadcast_to(start, points.shape)
        else:
            along = np.clip((points - start) @ span / length2, 0.0, 1.0)
            nearest = start + along[:, None] * span
        best = np.minimum(best, np.linalg.norm(points - nearest, axis=1))
    return best
