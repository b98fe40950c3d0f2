"""Owns the checks of texture coordinates and other float primvars, and of their use by textures."""

import dataclasses
import math
from collections.abc import Iterable

import numpy as np

from .allowed_deviations import DISPLACED, UV_CONSTANT, UV_SET
from .checks import BARS, Checks
from .distances import attribute_distance
from .scene_data import Array, Corners, Scene


@dataclasses.dataclass(frozen=True)
class UvUse:
    """A texture of `material` reads `primvar` in the stage and `attribute` in the file."""

    material: str
    primvar: str
    attribute: str


@dataclasses.dataclass(frozen=True)
class CoordinateComparer:
    """Compares float primvars at the corners of one prim with the attributes of the file."""

    checks: Checks
    key: str
    expected: Corners
    found: Corners
    tolerance: float
    """Maximum distance between corners that are the same."""

    @staticmethod
    def for_prim(
        checks: Checks, key: str, expected: Corners, found: Corners, tolerance: float
    ) -> "CoordinateComparer":
        """The comparer of a prim; corners that are displaced are not told apart by their places."""
        if checks.excuse(key, DISPLACED):
            expected, found = (
                dataclasses.replace(side, positions=np.zeros_like(side.positions))
                for side in (expected, found)
            )
        return CoordinateComparer(checks, key, expected, found, tolerance)

    def uvs(self) -> None:
        """Check that the file's UV sets and the stage's are the same."""
        expected, found = self.expected, self.found
        there: set[str] = set()
        for name, values in found.uvs.items():
            rows = self._uv_rows(values)
            if not expected.uvs or not rows.any():
                continue
            reach = _reach(values)
            step = BARS["uvs"].limit * reach
            drawn = (found.positions[rows], values[rows])
            best = math.inf
            for candidate, wished in expected.uvs.items():
                wanted = (expected.positions, wished)
                # Where rows are left out, drawn values must be wanted ones, but not the other way.
                first, second = (wanted, drawn) if rows.all() else (drawn, wanted)
                whole = expected.optional_triangles == 0 and bool(rows.all())
                distance = attribute_distance(first, second, self.tolerance, step, whole)
                best = min(best, distance)
                if distance <= step:
                    there.add(candidate)
            self.checks.add("uvs", self.key, best / reach, name)
        for name in sorted(expected.uvs.keys() - there):
            self._missing(name)
        if not expected.material_paths and len(expected.uvs) == len(found.uvs) == len(there):
            self._order()

    def customs(self) -> None:
        """Check that every other float primvar of the stage is in the file, under its own name."""
        for name, wanted in self.expected.customs.items():
            drawn = (self.found.positions, self.found.customs.get(name))
            both = self.expected.optional_triangles == 0
            self._values(name, (self.expected.positions, wanted), drawn, both)

    def point_values(self) -> None:
        """Compare the primvars of points and lines, including their coordinates and colors."""
        expected, found = self.expected, self.found
        for name in sorted(expected.point_values.keys() | found.point_values.keys()):
            wanted, values = (side.point_values.get(name) for side in (expected, found))
            if wanted is None:
                self.checks.add("uvs", self.key, math.inf, f"{name} is only in the output")
                continue
            check = "colors" if name == "COLOR_0" else "uvs"
            drawn = (found.points, values)
            self._values(name, (expected.points, wanted), drawn, both=True, check=check)

    def use(self, use: UvUse) -> None:
        """Compare primvar and attribute on the corners that carry the material of the use."""
        wanted = _carrying(self.expected, use.material)
        drawn = _carrying(self.found, use.material)
        if wanted.any() and drawn.any():
            self._values(
                f"{use.attribute} for '{use.primvar}' of {use.material}",
                (self.expected.positions[wanted], self.expected.uvs[use.primvar][wanted]),
                (self.found.positions[drawn], self.found.uvs[use.attribute][drawn]),
                both=False,
            )

    def _missing(self, name: str) -> None:
        self.checks.add_lost(self.key, UV_SET, f"'{name}' is not in the output", name, "uvs")

    def _order(self) -> None:
        """Check the order where no material reads any set: `st` first, then the others by name."""
        attributes = sorted(self.found.uvs, key=lambda name: int(name.rpartition("_")[2]))
        names = sorted(self.expected.uvs, key=lambda name: (name != "st", name))
        for name, attribute in zip(names, attributes, strict=True):
            wanted = (self.expected.positions, self.expected.uvs[name])
            drawn = (self.found.positions, self.found.uvs[attribute])
            self._values(f"{attribute} for '{name}'", wanted, drawn, both=False)

    def _uv_rows(self, values: Array) -> np.ndarray:
        """Mask of all corners whose material reads no set that the prim lacks."""
        rows = np.ones(len(values), bool)
        if self.found.materials is None or not self.checks.excuse(self.key, UV_CONSTANT):
            return rows
        for label in np.unique(self.found.materials):
            part = self.found.materials == label
            if np.ptp(values[part], axis=0).max(initial=0.0) == 0.0:
                rows &= ~part
        return rows

    def _values(
        self,
        name: str,
        expected: tuple[Array, Array],
        found: tuple[Array, Array | None],
        both: bool,
        check: str = "uvs",
    ) -> None:
        places, values = found
        if values is None or values.shape[1] != expected[1].shape[1]:
            self._missing(name)
            return
        reach = _reach(expected[1])
        step = BARS[check].limit * reach
        distance = attribute_distance(expected, (places, values), self.tolerance, step, both)
        self.checks.add(check, self.key, distance / reach, name)


def _reach(values: Array) -> float:
    """Maximum absolute value, at least 1, which tolerances are relative to."""
    return max(1.0, float(np.abs(values).max(initial=0.0)))


def compare_uv_uses(
    checks: Checks, truth: Scene, output: Scene, uses: Iterable[UvUse], diagonal: float
) -> None:
    """Compare primvar and attribute on the corners that carry the material, where both exist."""
    reach = diagonal * BARS["positions"].limit
    for use in uses:
        for key, expected in truth.corners.items():
            found = output.corners.get(key)
            if found is None or use.material not in expected.material_paths:
                continue
            if use.primvar in expected.uvs and use.attribute in found.uvs:
                CoordinateComparer.for_prim(checks, key, expected, found, reach).use(use)


def _carrying(corners: Corners, material: str) -> np.ndarray:
    """Mask of the corners that carry the material, by its name."""
    name = material.rsplit("/", 1)[-1]
    same = [i for i, path in enumerate(corners.material_paths) if path.rsplit("/", 1)[-1] == name]
    assert corners.materials is not None
    return np.isin(corners.materials, same)
