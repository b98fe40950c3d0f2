"""Owns the list of checks: their bars, what they found, and which losses were declared."""

from __future__ import annotations

import dataclasses
import fnmatch
import math
from collections.abc import Iterable
from typing import Any

_MAX_FINDINGS = 50


@dataclasses.dataclass(frozen=True)
class Bar:
    """What a check measures and how much it tolerates."""

    title: str
    limit: float
    unit: str
    excuses: tuple[str, ...] = ()
    """Patterns of the names of warnings that declare this kind of loss for a prim."""


_FROZEN = (
    "geometry-animation-frozen",
    "instancer-animation-frozen",
    "points-animation-frozen",
    "skeleton-animation-dropped",
)
_BROKEN = (
    "curves-invalid",
    "index-out-of-range",
    "instancer-invalid",
    "points-non-finite",
    "prim-damaged",
    "topology-invalid",
    "transform-non-finite",
    "transform-projective",
)
_ABSENT = (
    *_BROKEN,
    "camera-invalid",
    "curves-dropped",
    "dome-light-external",
    "instancer-cycle",
    "instancer-empty",
    "instances-too-many",
    "invisible-skipped",
    "light-dropped",
    "light-invalid",
    "mesh-empty",
    "nurbs-*",
    "[A-Z]*-dropped",
    "purpose-skipped",
    "schema-ignored",
    "subset-dropped",
)
_SHAPE = (
    *_FROZEN,
    *_BROKEN,
    "curves-approximated",
    "face-degenerate",
    "time-sample-dropped",
    "velocities-dropped",
)
_PLACED = ("animation-resampled", "instance-rotation-normalized")
"""Places that deviate by what the warning states, and nothing else of the prim."""
_PRIMVAR = ("primvar-*", "instance-primvar-dropped")
_SKIN = ("skinning-*", "skeleton-*", "joint-*", "blend-shape-*", "inbetween-dropped", "weights-*")
_MATERIAL = (
    *_PRIMVAR,
    "color-space-assumed",
    "material-*",
    "normal-scale-missing",
    "occlusion-dropped",
    "opacity-approximated",
    "shader-connection-invalid",
    "texture-missing",
    "texture-packed-transform",
    "texture-too-large",
    "texture-unreadable",
    "asset-*",
    "udim-partial",
    "uv-*",
    "wrap-black-clamped",
)
BARS: dict[str, Bar] = {
    "carried": Bar("prims carried or warned about", 0, "missing", _ABSENT),
    "unexpected": Bar("prims the stage does not draw", 0, "extra", (*_FROZEN, *_BROKEN, *_SKIN)),
    "positions": Bar("world corners, both ways", 1e-5, "of the diagonal", (*_SHAPE, *_PLACED)),
    "bounds": Bar("bounding box", 1e-5, "of the diagonal"),
    "triangles": Bar("triangle count", 0, "difference", _SHAPE),
    "area": Bar("surface area", 1e-5, "relative", (*_SHAPE, *_PLACED)),
    "winding": Bar("area vector and signed volume", 1e-5, "relative", (*_SHAPE, *_PLACED)),
    "surfaces": Bar("points on curved gprims", 1e-5, "of the diagonal", (*_SHAPE, *_PLACED)),
    "normals": Bar("normals", 0.5, "degrees", (*_SHAPE, *_PLACED, *_PRIMVAR, "normal-*")),
    "uvs": Bar(
        "texture coordinates",
        1e-5,
        "absolute",
        (*_FROZEN, *_PRIMVAR, "uv-*"),
    ),
    "colors": Bar("display colors", 1e-4, "absolute", (*_FROZEN, *_PRIMVAR, "color-*")),
    "sides": Bar("double-sided flag", 0, "difference"),
    "bindings": Bar(
        "corners of each material", 1e-5, "of the diagonal", ("material-*", "subset-*")
    ),
    "materials": Bar("material values at sample points", 1 / 255, "absolute", _MATERIAL),
    "matrices": Bar(
        "world matrices",
        1e-5,
        "relative",
        ("time-sample-dropped", "transform-non-finite", "transform-projective", *_PLACED, *_FROZEN),
    ),
    "joints": Bar("world matrices of joints", 1e-5, "relative", (*_SKIN, *_FROZEN)),
    "cameras": Bar("camera lenses and places", 1e-5, "relative", ("lens-dropped", "camera-*")),
    "lights": Bar(
        "light intensities and places",
        1e-5,
        "relative",
        ("light-animation-frozen", "light-invalid", "cone-clamped", "area-light-approximated"),
    ),
    "inputs": Bar("inputs of lights and cameras that glTF lacks", 0, "lost"),
    "skinning": Bar(
        "skinned and morphed corners", 1e-5, "of the diagonal", (*_SKIN, *_FROZEN, *_BROKEN)
    ),
    "reader": Bar("trimesh's bounding box", 1e-5, "of the diagonal"),
}


_ADD_UP = 4.0
"""Three entries of a matrix and its place add up in a corner."""


@dataclasses.dataclass
class Finding:
    """One value above its bar, or one thing missing."""

    prim: str
    value: float
    text: str
    declared: str | None = None
    """The warning in the sidecar that told of it; None for a silent deviation."""


@dataclasses.dataclass
class Check:
    """The result of one kind of comparison over all prims and times."""

    name: str
    bar: Bar
    compared: int = 0
    worst: float = 0.0
    worst_prim: str = ""
    findings: list[Finding] = dataclasses.field(default_factory=list)
    silent: int = 0
    declared: int = 0

    @property
    def passed(self) -> bool:
        """Whether nothing deviates silently."""
        return self.silent == 0

    def to_json(self) -> dict[str, Any]:
        """Plain data for the JSON report."""
        return {
            "check": self.name,
            "title": self.bar.title,
            "compared": self.compared,
            "worst": _finite(self.worst),
            "limit": self.bar.limit,
            "unit": self.bar.unit,
            "prim": self.worst_prim,
            "passed": self.passed,
            "silent": self.silent,
            "declared": self.declared,
            "findings": [
                {**dataclasses.asdict(finding), "value": _finite(finding.value)}
                for finding in self.findings
            ],
        }


class Checks:
    """Collects values of all checks against their bars and the sidecar's warnings."""

    def __init__(self, warnings: Iterable[dict[str, Any]]) -> None:
        self.checks = {name: Check(name, bar) for name, bar in BARS.items()}
        self.related: dict[str, tuple[str, ...]] = {}
        """By prim the other prims that it is made of: a skinned mesh's skeleton and animation."""
        self._warnings: dict[str, list[tuple[str, float]]] = {}
        for warning in warnings:
            reach = warning.get("deviation")
            entry = (warning["name"], math.inf if reach is None else _ADD_UP * float(reach))
            self._warnings.setdefault(warning["prim"], []).append(entry)

    def add_lost(self, prim: str, warnings: tuple[str, ...], text: str) -> None:
        """Record an input that cannot be in the output; only one of `warnings` excuses that."""
        self.add("inputs", prim, 1, text, excuses=warnings)

    def add(
        self,
        name: str,
        prim: str,
        value: float,
        text: str = "",
        slack: float = 0.0,
        excuses: tuple[str, ...] | None = None,
    ) -> None:
        """Record one compared value; above the bar plus `slack` it becomes a finding.

        `excuses` are patterns of warnings in place of those of the bar.
        """
        check = self.checks[name]
        check.compared += 1
        value = float(value)
        if math.isnan(value):
            value = math.inf
        declared = None
        if value > check.bar.limit + slack:
            names = check.bar.excuses if excuses is None else excuses
            share = math.radians(value) if check.bar.unit == "degrees" else value
            declared = self.excuse(prim, names, share)
            check.declared += declared is not None
            check.silent += declared is None
            if len(check.findings) < _MAX_FINDINGS:
                check.findings.append(Finding(prim, value, text, declared))
        if declared is None and value > check.worst:
            check.worst, check.worst_prim = value, prim

    def excuse(self, prim: str, names: tuple[str, ...], value: float = 0.0) -> str | None:
        """The warning on the prim, one related, above or below it, that fits one of the patterns.

        One that states how far the file deviates excuses no more than that.
        """
        for other in self.related.get(prim, ()):
            declared = self._excuse(other, names, value)
            if declared:
                return declared
        return self._excuse(prim, names, value)

    def _excuse(self, prim: str, names: tuple[str, ...], value: float) -> str | None:
        for path, found in self._warnings.items():
            above = prim == path or prim.startswith(path + "/")
            if path == "/":
                continue  # a warning at the root speaks of no single prim
            if above or path.startswith(prim + "/"):
                for name, reach in found:
                    fits = any(fnmatch.fnmatchcase(name, pattern) for pattern in names)
                    if fits and value <= reach:
                        return name
        return None

    def declared(self) -> int:
        """How many deviations so far were told of by a warning."""
        return sum(check.declared for check in self.checks.values())

    def results(self) -> list[Check]:
        """Checks that compared anything, in their fixed order."""
        return [check for check in self.checks.values() if check.compared]


def _finite(value: float) -> float | str:
    return value if math.isfinite(value) else "infinite"
