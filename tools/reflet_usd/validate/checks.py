"""Owns the list of checks: their bars, their findings, and the declared losses."""

import dataclasses
import fnmatch
import math
from collections.abc import Iterable
from typing import Any

from .allowed_deviations import ABSENT, DISPLACED, PLACED, SUBTREE

_MAX_FINDINGS = 50


@dataclasses.dataclass(frozen=True)
class Bar:
    """One check's measure and its tolerance."""

    title: str
    limit: float
    unit: str
    excuses: tuple[str, ...] = ()
    """Patterns of the names of warnings that declare this kind of loss for a prim."""


MOVED = (*PLACED, *DISPLACED)
"""Warnings that allow corners to deviate by a stated length."""
BARS: dict[str, Bar] = {
    "carried": Bar("prims carried or warned about", 0, "missing", ABSENT),
    "unexpected": Bar("prims the stage does not draw", 0, "extra"),
    "positions": Bar("world corners, both ways", 1e-5, "of the diagonal", MOVED),
    "bounds": Bar("bounding box", 1e-5, "of the diagonal"),
    "triangles": Bar("triangle count", 0, "difference"),
    "area": Bar("surface area", 1e-5, "relative", PLACED),
    "winding": Bar("area vector and signed volume", 1e-5, "relative", PLACED),
    "surfaces": Bar("points on curved gprims", 1e-5, "of the diagonal", PLACED),
    "normals": Bar("normals", 0.5, "degrees", PLACED),
    "uvs": Bar("texture coordinates", 1e-5, "absolute"),
    "colors": Bar("display colors", 1e-4, "absolute"),
    "sides": Bar("double-sided flag", 0, "difference"),
    "bindings": Bar("corners of each material", 1e-5, "of the diagonal", MOVED),
    "materials": Bar("material values at sample points", 1 / 255, "absolute"),
    "matrices": Bar("world matrices", 1e-5, "relative", PLACED),
    "joints": Bar("world matrices of joints", 1e-5, "relative", PLACED),
    "cameras": Bar("camera lenses and places", 1e-5, "relative", PLACED),
    "lights": Bar("light intensities and places", 1e-5, "relative", PLACED),
    "inputs": Bar("inputs that glTF lacks", 0, "lost"),
    "skinning": Bar("skinned and morphed corners", 1e-5, "of the diagonal", PLACED),
    "animation": Bar("animation channels", 0, "wrong"),
    "extras": Bar("extras", 0, "wrong"),
    "reader": Bar("trimesh's bounding box", 1e-5, "of the diagonal"),
}
"""Compared properties, and warnings that allow them to differ."""


_SHAPE = ("area", "winding", "normals")
"""Checks of a mesh that compare no corners of a displaced one."""
_ADD_UP = 4.0
"""Three entries of a matrix and its translation add up in a corner."""


@dataclasses.dataclass
class Finding:
    """One value above its bar, or one missing thing."""

    prim: str
    value: float
    text: str
    declared: str | None = None
    """Sidecar warning that declares it; None for an undeclared deviation."""


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
        """Whether there is no undeclared deviation."""
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


@dataclasses.dataclass(frozen=True)
class _Told:
    """One warning of the sidecar."""

    name: str
    message: str
    reach: float
    """Deviation up to which the warning excuses."""

    def fits(self, names: tuple[str, ...], value: float, named: str) -> bool:
        """Whether the warning is one of `names`, reaches `value`, and quotes `named`, if any."""
        fits = any(fnmatch.fnmatchcase(self.name, pattern) for pattern in names)
        return fits and value <= self.reach and (not named or f"'{named}'" in self.message)


class Checks:
    """Collects the values of all checks, against their bars and the sidecar's warnings."""

    def __init__(self, warnings: Iterable[dict[str, Any]]) -> None:
        self.checks = {name: Check(name, bar) for name, bar in BARS.items()}
        self.made_of: dict[str, set[str]] = {}
        """Prims that an instancer draws, by instancer; their warnings count as its own."""
        self._warnings: dict[str, list[_Told]] = {}
        for warning in warnings:
            reach = warning.get("deviation")
            if warning["name"] in MOVED:
                reach = _ADD_UP * float(reach or 0.0)
            entry = _Told(
                warning["name"], warning.get("message", ""), math.inf if reach is None else reach
            )
            self._warnings.setdefault(warning["prim"], []).append(entry)

    def add_lost(
        self, prim: str, warnings: tuple[str, ...], text: str, named: str = "", name: str = "inputs"
    ) -> None:
        """Record what cannot be in the output; only one of `warnings` excuses that.

        `named`, if any, must stand in quotes in the message.
        """
        told = self.excuse(prim, warnings, named=named)
        value = 1 if name == "inputs" else math.inf
        self.add(name, prim, value, text, excuses=(told,) if told else ())

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

        `excuses` are patterns of warnings in place of the bar's.
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
            if declared is None and name in _SHAPE:
                declared = self.excuse(prim, DISPLACED)
            check.declared += declared is not None
            check.silent += declared is None
            if len(check.findings) < _MAX_FINDINGS:
                check.findings.append(Finding(prim, value, text, declared))
        if declared is None and value > check.worst:
            check.worst, check.worst_prim = value, prim

    def excuse(
        self, prim: str, names: tuple[str, ...], value: float = 0.0, named: str = ""
    ) -> str | None:
        """The warning on the prim that fits one of the patterns, and reaches `value`.

        Warnings on drawn prims of an instancer count as its own, warnings on whole subtrees for all
        prims below. `named` must stand in quotes in the message.
        """
        for path in sorted({prim} | self.made_of.get(prim, set())):
            for told in self._warnings.get(path, ()):
                if told.fits(names, value, named):
                    return told.name
            while path not in ("", "/"):
                path = path.rpartition("/")[0]
                for told in self._warnings.get(path, ()):
                    if told.name in SUBTREE and told.fits(names, value, named):
                        return told.name
        return None

    def says(self, names: tuple[str, ...], named: str) -> bool:
        """Whether a warning that has a name of `names` quotes `named`, on any prim."""
        return any(t.fits(names, 0.0, named) for many in self._warnings.values() for t in many)

    def declared(self) -> int:
        """Number of deviations so far that a warning declares."""
        return sum(check.declared for check in self.checks.values())

    def results(self) -> list[Check]:
        """Results of the checks that compared anything, in their fixed order."""
        return [check for check in self.checks.values() if check.compared]


def _finite(value: float) -> float | str:
    return value if math.isfinite(value) else "infinite"
