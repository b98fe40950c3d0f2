"""Owns the truth about primvars: values at corners, and the vertex attributes that hold them."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterable
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

from .scene_data import Array, Indices
from .usd_stage import has_samples, stated_codes

NO_COLOR = 0.18
"""UsdPreviewSurface's diffuseColor, for gprims whose displayColor is missing or does not fit."""
_UV_TYPES = re.compile(r"(texCoord[23][fdh]|float2|double2|half2|Vec2f)\[\]")
_FLOATS = re.compile(r"(?:float|double|half|color|vector|normal|point)([234]?)[fdh]?\[\]")
HANDLED = {"displayColor": 3, "displayOpacity": 1, "normals": 3}
"""Primvars with rules of their own, and how many numbers an element has."""
_MOST = 4
"""Maximum number of components of a vertex attribute."""


@dataclasses.dataclass
class CornerMap:
    """Mapping from drawn corners to the authored elements that hold their primvar values."""

    index: Indices
    """(n,) authored corner (faceVarying element), in drawing order."""
    vertex: Indices
    """(n,) point index."""
    face: Indices
    """(n,) authored face."""
    faces: Indices
    """(faces,) authored faces that are drawn."""
    optional_index: Indices
    optional_triangles: int
    totals: dict[str, int]
    """Number of elements that a primvar of each interpolation must have; other ones need one."""
    optional_counts: Indices = dataclasses.field(default_factory=lambda: np.zeros(0, np.int64))
    is_whole: bool = True
    """Whether all faces fit the indices, so that the totals mean what they say."""

    @classmethod
    def whole(cls, faces: Indices, points: int) -> CornerMap:
        """Map of all corners of (n, k) faces of point indices."""
        index = np.arange(faces.size)
        owner = np.repeat(np.arange(len(faces)), faces.shape[1])
        totals = {
            "uniform": len(faces),
            "faceVarying": faces.size,
            "vertex": points,
            "varying": points,
        }
        return cls(index, faces.reshape(-1), owner, np.arange(len(faces)), index[:0], 0, totals)

    def expand(self, values: Array, interpolation: str) -> Array | None:
        """(n, …) values at the corners; None where there are too few for the topology."""
        single = interpolation not in self.totals and len(values) == 1
        if single or (interpolation == "constant" and len(values) >= 1):
            return np.repeat(values[:1], len(self.index), axis=0)
        if len(values) < self.totals.get(interpolation, len(values) + 1):
            return None
        where = {"uniform": self.face, "faceVarying": self.index}.get(interpolation, self.vertex)
        return values[where]


@dataclasses.dataclass(frozen=True)
class Carried:
    """A primvar that becomes vertex attributes, and the number of components of an element."""

    name: str
    primvar: UsdGeom.Primvar
    width: int
    is_uv: bool
    attribute: str
    """Attribute of the whole primvar; coordinates have one only with a third component."""


def carried(prim: Usd.Prim) -> list[Carried]:
    """The float primvars with an element per part that reach a prim, and all coordinates.

    An attribute has its primvar's name in capitals, other characters as underscores. Where a
    primvar before it, by name, has that attribute already, it is numbered.
    """
    found = UsdGeom.PrimvarsAPI(prim).FindPrimvarsWithInheritance()
    result: list[Carried] = []
    taken: set[str] = set()
    for primvar in sorted(found, key=lambda entry: str(entry.GetPrimvarName())):
        name, kind = str(primvar.GetPrimvarName()), str(primvar.GetTypeName())
        varies = primvar.GetInterpolation() != "constant"
        is_uv = bool(_UV_TYPES.fullmatch(kind)) and (varies or kind.startswith("texCoord"))
        match = _FLOATS.fullmatch(kind) if varies else None
        handled = name.startswith("skel:") or name in HANDLED or not primvar.HasValue()
        if handled or not (is_uv or match):
            continue
        attribute = ""
        if not is_uv or "3" in kind:
            base = attribute = "_" + re.sub(r"[^A-Za-z0-9_]", "_", name).upper()
            while attribute in taken:
                number = int(attribute.removeprefix(base).removeprefix("_") or 1) + 1
                attribute = f"{base}_{number}"
            taken.add(attribute)
        width = (3 if "3" in kind else 2) if is_uv or match is None else int(match.group(1) or 1)
        width *= max(1, primvar.GetElementSize())
        result.append(Carried(name, primvar, width, is_uv, attribute))
    return result


def uv_sets(entries: list[Carried], time: Usd.TimeCode, corners: CornerMap) -> dict[str, Array]:
    """Coordinates (n, 2) at the corners, by primvar."""
    result = {}
    for entry in entries:
        values = _at_corners(entry, time, corners) if entry.is_uv and entry.width < _MOST else None
        if values is not None:
            result[entry.name] = values[:, :2]
    return result


def customs(entries: list[Carried], time: Usd.TimeCode, corners: CornerMap) -> dict[str, Array]:
    """Values (n, k) at the corners, by attribute; coordinates only where a third one is used."""
    result = {}
    for entry in entries:
        usable = entry.attribute and entry.width <= (_MOST - 1 if entry.is_uv else _MOST)
        values = _at_corners(entry, time, corners) if usable else None
        if values is not None and (not entry.is_uv or values[:, 2:].any()):
            result[entry.attribute] = values
    return result


def _at_corners(entry: Carried, time: Usd.TimeCode, corners: CornerMap) -> Array | None:
    values = flattened(entry.primvar, time, entry.width)
    expanded = corners.expand(values, entry.primvar.GetInterpolation()) if len(values) else None
    if expanded is None or not np.isfinite(expanded).all():
        return None
    return expanded.reshape(len(expanded), -1)


def misfits(
    prim: Usd.Prim,
    entries: list[Carried],
    time: Usd.TimeCode,
    corners: CornerMap,
    told: set[str],
) -> tuple[str, ...]:
    """Primvars with values that have no place: too many, too few, or too long elements.

    `entries` are the primvars that are `carried`, `told` the drawn colors and normals.
    """
    found = {entry.name: entry for entry in entries}
    for name in sorted(told):
        primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
        if primvar and primvar.HasValue() and primvar.GetTypeName().isArray:
            width = HANDLED[name] * max(1, primvar.GetElementSize())
            found[name] = Carried(name, primvar, width, False, "")
    return tuple(name for name, entry in sorted(found.items()) if not _fits(entry, time, corners))


def _fits(entry: Carried, time: Usd.TimeCode, corners: CornerMap) -> bool:
    if not entry.primvar.Get(time):
        return True  # without values nothing is lost
    interpolation = entry.primvar.GetInterpolation()
    values = flattened(entry.primvar, time, entry.width)
    count = len(values) if np.isfinite(values).all() else -1
    needed = corners.totals.get(interpolation, 1)
    return count == needed and entry.width <= (_MOST - 1 if entry.is_uv else _MOST)


def corner_colors(prim: Usd.Prim, time: Usd.TimeCode, corners: CornerMap) -> Array | None:
    """Display color and opacity (n, 4) at the corners; None where none fits."""
    api = UsdGeom.PrimvarsAPI(prim)
    color = api.FindPrimvarWithInheritance("displayColor")
    opacity = api.FindPrimvarWithInheritance("displayOpacity")
    rgb = corners.expand(flattened(color, time, 3), color.GetInterpolation()) if color else None
    alpha = None
    if opacity:
        alpha = corners.expand(flattened(opacity, time, 1), opacity.GetInterpolation())
    if rgb is None and alpha is None:
        return None
    count = len(corners.index)
    rgb = np.full((count, 3), NO_COLOR) if rgb is None else rgb
    alpha = np.ones((count, 1)) if alpha is None else alpha.reshape(-1, 1)
    return np.clip(np.hstack([rgb, alpha]), 0.0, 1.0)


def flattened(primvar: UsdGeom.Primvar, time: Usd.TimeCode, width: int) -> Array:
    """A primvar's values with its indices applied; empty where there are none that fit."""
    raw = primvar.Get(time) if primvar else None
    values = array_of(raw, np.float64, width)
    if primvar and primvar.GetElementSize() > 1 and len(values):
        whole = values.size % width == 0
        shape = (-1,) if width == 1 else (-1, width)
        values = values.reshape(shape) if whole else values[:0]
    if primvar and primvar.IsIndexed():
        indices = array_of(primvar.GetIndices(time), np.int64)
        if len(indices) and len(values) and indices.min() >= 0 and indices.max() < len(values):
            return values[indices]
        return values[:0]
    return values


def points_of(attribute: Usd.Attribute, time: Usd.TimeCode) -> Array:
    """Points (n, 3) at `time`, by velocities; the first authored ones where there are none."""
    if time.IsEarliestTime():
        time = first_moved(attribute.GetPrim(), ("points",)) or time
    if has_samples(attribute.GetPrim(), "accelerations") and not time.IsEarliestTime():
        return _between_quarters(attribute, time.GetValue())
    return _points_at(attribute, time)


def first_moved(prim: Usd.Prim, names: Iterable[str]) -> Usd.TimeCode | None:
    """Start of the stage, or the first sample before it, where velocities move one of `names`."""
    codes = [codes[0] for name in names if (codes := prim.GetAttribute(name).GetTimeSamples())]
    if not codes or not has_samples(prim, "velocities", "angularVelocities"):
        return None
    start, _ = stated_codes(prim.GetStage())
    return Usd.TimeCode(min(codes if start is None else [*codes, start]))


def _points_at(attribute: Usd.Attribute, time: Usd.TimeCode) -> Array:
    value = attribute.Get(time)
    samples = (attribute.Get(code) for code in attribute.GetTimeSamples())
    if value is None:
        value = next((sample for sample in samples if sample is not None), None)
    elif time.IsNumeric() and not time.IsEarliestTime():
        value = UsdGeom.PointBased(attribute.GetPrim()).ComputePointsAtTime(time, time) or value
    return np.asarray(array_of(value, np.float64, 3))


def _between_quarters(attribute: Usd.Attribute, code: float) -> Array:
    """Points on straight ways between quarters of a time code from the sample before."""
    codes = attribute.GetTimeSamples()
    after = int(np.searchsorted(codes, code, side="right"))
    origin = codes[max(after - 1, 0)]
    first = origin + np.floor((code - origin) * 4.0) / 4.0
    last = min([first + 0.25, *(np.nextafter(later, -np.inf) for later in codes[after:])])
    share = (code - first) / (last - first)
    a, b = (_points_at(attribute, Usd.TimeCode(float(end))) for end in (first, last))
    return np.asarray(a + (b - a) * share)


def array_of(value: Any, dtype: type, width: int = 1) -> Any:
    """A value array of usd-core as numpy, (n,) or (n, width); empty where it does not fit."""
    shape = (0,) if width == 1 else (0, width)
    if value is None:
        return np.zeros(shape, dtype)
    try:
        array: Any = np.asarray(value, dtype=dtype)
    except (TypeError, ValueError):  # authored with another type
        return np.zeros(shape, dtype)
    if array.ndim == 0 or (width > 1 and array.ndim == 1):
        array = array.reshape(1, -1) if width > 1 else array.reshape(1)
    return array if array.size else np.zeros(shape, dtype)
