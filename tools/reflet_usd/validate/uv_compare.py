"""Owns the check that each texture reads the UV set that stands for its primvar."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable

import numpy as np

from .checks import BARS, Checks
from .distances import attribute_distance
from .facts import Corners, Scene


@dataclasses.dataclass(frozen=True)
class UvUse:
    """A texture of `material` reads `primvar` in the stage and `attribute` in the file."""

    material: str
    primvar: str
    attribute: str


def compare_uv_uses(
    checks: Checks, truth: Scene, output: Scene, uses: Iterable[UvUse], diagonal: float
) -> None:
    """Compare the two on the corners that carry the material, wherever both sides have them."""
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
    """Which corners carry the material, by its name."""
    name = material.rsplit("/", 1)[-1]
    same = [i for i, path in enumerate(corners.material_paths) if path.rsplit("/", 1)[-1] == name]
    assert corners.materials is not None
    return np.isin(corners.materials, same)
