"""Owns the comparison of cameras, lights and world matrices, one value at a time."""

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import TypeVar

import numpy as np
from scipy.spatial import cKDTree

from .scene_data import Array, Camera, Light

Device = TypeVar("Device", Camera, Light)
_FEW = 1024
"""Maximum number of pairs of devices that are all compared."""
_FAR = 1e30


def matrix_distance(expected: Array, found: Array, diagonal: float) -> float:
    """Largest difference: of axes relative to their length, of places relative to the scene."""
    scale = max(float(np.abs(expected[:3, :3]).max()), 1e-30)
    linear = float(np.abs(expected[:3, :3] - found[:3, :3]).max()) / scale
    move = float(np.abs(expected[3, :3] - found[3, :3]).max())
    reach = max(diagonal, float(np.abs(expected[3, :3]).max()))
    return max(linear, move / reach)


def camera_values(expected: Camera, found: Camera, diagonal: float) -> Iterable[tuple[str, float]]:
    """Compared values of a camera, each with its relative difference."""
    if (expected.yfov is None) != (found.yfov is None):
        yield "projection", math.inf
        return
    if expected.yfov is not None and found.yfov is not None:
        yield "yfov", _relative(expected.yfov, found.yfov)
    if expected.ymag is not None and found.ymag is not None:
        yield "ymag", _relative(expected.ymag, found.ymag)
    yield "aspect", _relative(expected.aspect, found.aspect)
    yield "shift", max(abs(a - b) for a, b in zip(expected.shift, found.shift, strict=True))
    if expected.planes or found.planes:
        planes = np.array(expected.planes), np.array(found.planes)
        same = planes[0].shape == planes[1].shape
        yield "clip planes", float(np.abs(planes[0] - planes[1]).max()) if same else math.inf
    yield "near", _relative(expected.near_m, found.near_m)
    if math.isfinite(found.far_m):
        yield "far", _relative(expected.far_m, found.far_m)
    yield "place", _place_distance(expected.matrix, found.matrix, diagonal)
    yield "view", _axis_distance(expected.matrix, found.matrix, (1, 2))


def light_values(expected: Light, found: Light, diagonal: float) -> Iterable[tuple[str, float]]:
    """Compared values of a light, each with its relative difference."""
    if expected.kind != found.kind and expected.exact:
        yield f"is {found.kind}, expected {expected.kind}", math.inf
        return
    if expected.exact:
        level = max(float(np.abs(expected.intensity).max()), 1e-30)
        yield "intensity", float(np.abs(expected.intensity - found.intensity).max()) / level
    if found.kind != "directional":
        yield "place", _place_distance(expected.matrix, found.matrix, diagonal)
    if found.kind != "point" and expected.exact:
        yield "direction", _axis_distance(expected.matrix, found.matrix, (2,))
    if expected.outer_cone is not None and found.outer_cone is not None:
        yield "cone", _relative(expected.outer_cone, found.outer_cone)
        soft = abs(expected.inner_cone - found.inner_cone)
        yield "softness of the cone", soft / max(expected.outer_cone, 1e-12)


def nearby(expected: Sequence[Device], found: Sequence[Device]) -> Iterator[Iterable[int]]:
    """For each device of the stage, the devices of the file to compare: all, or of many the
    nearest.

    Devices as near as the nearest one, within rounding, are all compared.
    """
    if len(expected) * len(found) <= _FEW:
        yield from (range(len(found)) for _ in expected)
        return
    places = np.array([one.matrix[3, :3] for one in found])
    wanted = np.array([one.matrix[3, :3] for one in expected])
    tree = cKDTree(np.where(np.isfinite(places), places, _FAR))
    wanted = np.where(np.isfinite(wanted), wanted, _FAR)
    step = 1e-5 * float(np.ptp(wanted, axis=0).max())
    for place, distance in zip(wanted, tree.query(wanted)[0].tolist(), strict=True):
        yield tree.query_ball_point(place, distance + step)


def _place_distance(expected: Array, found: Array, diagonal: float) -> float:
    reach = max(diagonal, float(np.abs(expected[3, :3]).max()))
    return float(np.linalg.norm(expected[3, :3] - found[3, :3])) / reach


def _relative(expected: float, found: float) -> float:
    return abs(expected - found) / max(abs(expected), 1e-12)


def _axis_distance(expected: Array, found: Array, axes: tuple[int, ...]) -> float:
    """Largest chord between the unit vectors of the named local axes."""
    worst = 0.0
    for axis in axes:
        first, second = expected[axis, :3], found[axis, :3]
        lengths = np.linalg.norm(first), np.linalg.norm(second)
        if min(lengths) > 0:
            worst = max(worst, float(np.linalg.norm(first / lengths[0] - second / lengths[1])))
    return worst
