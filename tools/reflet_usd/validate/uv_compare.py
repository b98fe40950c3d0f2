"""Owns the checks of texture coordinates and other float primvars, and of their use by textures."""

import dataclasses
import math
from collections.abc import Iterable

import numpy as np

from .allowed_deviations import UV_CONSTANT, UV_SET
from .checks import BARS, Checks
from .distances import attribute_distance
from .scene_data import Array, Corners, Scene


@dataclasses.dataclass(frozen=True)
class UvUse:
    """A texture of `material` reads `primvar` in the stage and `attribute` in the file."""

    material: str
    primvar: str
    attribute: str


def compare_uvs(
    checks: Checks, key: str, expected: Corners, found: Corners, tolerance: float
) -> None:
    """Check that the file's UV sets and the stage's are the same."""
    there: set[str] = set()
    for name, values in found.uvs.items():
        rows = _uv_rows(checks, key, found, values)
        if not expected.uvs or not rows.any():
            continue
        reach = max(1.0, float(np.abs(values).max(initial=0.0)))
        step = BARS["uvs"].limit * reach
        drawn = (found.positions[rows], values[rows])
        best = math.inf
        for candidate, wished in expected.uvs.items():
            wanted = (expected.positions, wished)
            # Where rows are left out, drawn values must be wanted ones, but not the other way.
            first, second = (wanted, drawn) if rows.all() else (drawn, wanted)
            whole = expected.optional_triangles == 0 and bool(rows.all())
            distance = attribute_distance(first, second, tolerance, step, whole)
            best = min(best, distance)
            if distance <= step:
                there.add(candidate)
        checks.add("uvs", key, best / reach, name)
    for name in sorted(expected.uvs.keys() - there):
        _missing(checks, key, name)
    if not expected.material_paths and len(expected.uvs) == len(found.uvs) == len(there):
        _compare_order(checks, key, expected, found, tolerance)


def _missing(checks: Checks, key: str, name: str) -> None:
    told = checks.excuse(key, UV_SET, named=name)
    text = f"'{name}' is not in the output"
    checks.add("uvs", key, math.inf, text, excuses=(told,) if told else ())


def _compare_order(
    checks: Checks, key: str, expected: Corners, found: Corners, tolerance: float
) -> None:
    """Check the order where no material reads any set: `st` first, then the others by name."""
    attributes = sorted(found.uvs, key=lambda name: int(name.rpartition("_")[2]))
    names = sorted(expected.uvs, key=lambda name: (name != "st", name))
    for name, attribute in zip(names, attributes, strict=True):
        reach = max(1.0, float(np.abs(expected.uvs[name]).max(initial=0.0)))
        distance = attribute_distance(
            (expected.positions, expected.uvs[name]),
            (found.positions, found.uvs[attribute]),
            tolerance,
            BARS["uvs"].limit * reach,
            both=False,
        )
        checks.add("uvs", key, distance / reach, f"{attribute} for '{name}'")


def _uv_rows(checks: Checks, key: str, found: Corners, values: Array) -> np.ndarray:
    """Mask of all corners whose material reads no set that the prim lacks."""
    rows = np.ones(len(values), bool)
    if found.materials is None or not checks.excuse(key, UV_CONSTANT):
        return rows
    for label in np.unique(found.materials):
        part = found.materials == label
        if np.ptp(values[part], axis=0).max(initial=0.0) == 0.0:
            rows &= ~part
    return rows


def compare_customs(
    checks: Checks, key: str, expected: Corners, found: Corners, tolerance: float
) -> None:
    """Check that every other float primvar of the stage is in the file, under its own name."""
    both = expected.optional_triangles == 0
    for name, wanted in expected.customs.items():
        drawn = (found.positions, found.customs.get(name))
        _compare_values(checks, key, name, (expected.positions, wanted), drawn, tolerance, both)


def compare_point_values(
    checks: Checks, key: str, expected: Corners, found: Corners, tolerance: float
) -> None:
    """Compare the primvars of points and lines, including their coordinates."""
    for name in sorted(expected.point_values.keys() | found.point_values.keys()):
        wanted, values = (side.point_values.get(name) for side in (expected, found))
        if wanted is None:
            checks.add("uvs", key, math.inf, f"{name} is only in the output")
            continue
        pairs = (expected.points, wanted), (found.points, values)
        _compare_values(checks, key, name, *pairs, tolerance, both=True)


def _compare_values(
    checks: Checks,
    key: str,
    name: str,
    expected: tuple[Array, Array],
    found: tuple[Array, Array | None],
    tolerance: float,
    both: bool,
) -> None:
    places, values = found
    if values is None or values.shape[1] != expected[1].shape[1]:
        _missing(checks, key, name)
        return
    reach = max(1.0, float(np.abs(expected[1]).max(initial=0.0)))
    step = BARS["uvs"].limit * reach
    distance = attribute_distance(expected, (places, values), tolerance, step, both)
    checks.add("uvs", key, distance / reach, name)


def compare_uv_uses(
    checks: Checks, truth: Scene, output: Scene, uses: Iterable[UvUse], diagonal: float
) -> None:
    """Compare primvar and attribute on the corners that carry the material, where both exist."""
    for use in uses:
        for key, expected in truth.corners.items():
            found = output.corners.get(key)
            if found is None or use.material not in expected.material_paths:
                continue
            if use.primvar in expected.uvs and use.attribute in found.uvs:
                _compare_use(checks, key, use, expected, found, diagonal)


def _compare_use(
    checks: Checks, key: str, use: UvUse, expected: Corners, found: Corners, diagonal: float
) -> None:
    wanted = _carrying(expected, use.material)
    drawn = _carrying(found, use.material)
    if not wanted.any() or not drawn.any():
        return
    values = expected.uvs[use.primvar][wanted]
    reach = max(1.0, float(np.abs(values).max()))
    distance = attribute_distance(
        (expected.positions[wanted], values),
        (found.positions[drawn], found.uvs[use.attribute][drawn]),
        diagonal * BARS["positions"].limit,
        BARS["uvs"].limit * reach,
        both=False,
    )
    text = f"{use.attribute} for '{use.primvar}' of {use.material}"
    checks.add("uvs", key, distance / reach, text)


def _carrying(corners: Corners, material: str) -> np.ndarray:
    """Mask of the corners that carry the material, by its name."""
    name = material.rsplit("/", 1)[-1]
    same = [i for i, path in enumerate(corners.material_paths) if path.rsplit("/", 1)[-1] == name]
    assert corners.materials is not None
    return np.isin(corners.materials, same)
