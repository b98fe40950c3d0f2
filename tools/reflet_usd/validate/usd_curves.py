"""Owns the truth about points, curves and NURBS patches, cubics by scipy's splines."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
from pxr import Usd, UsdGeom
from scipy.interpolate import BPoly, BSpline, CubicHermiteSpline

from .scene_data import Array, Indices, Lost
from .usd_primvars import (
    CornerMap,
    array_of,
    carried,
    corner_colors,
    customs,
    flattened,
    misfits,
    points_of,
    uv_sets,
)

_STEPS = 8
"""Lines per span of a cubic, and quads per span of a patch, as documented."""
_MOST_SAMPLES = 1024
"""Maximum number of samples of a patch in each direction."""
_MOST_ORDER = 32
"""Highest order of a curve that is drawn."""
_BASES = ("bezier", "bspline", "catmullRom")
_UNFIT: Lost = [("curves-invalid", "counts that do not fit the points")]
SHOWN = "COLOR_0"
"""Attribute of the file with the display colors of points and curves."""
DIAMETER = "_DIAMETER_M"
"""Attribute of the file with the widths of points and curves."""
_COLORS = {"displayColor", "displayOpacity"}


@dataclasses.dataclass
class Cloud:
    """Drawn points and curves."""

    points: Array
    """Positions (n, 3)."""
    lost: Lost
    """Inputs that cannot be drawn."""
    corners: CornerMap | None = None
    """Authored values of the points; None where there are none."""

    def values(self, prim: Usd.Prim, time: Usd.TimeCode) -> dict[str, Array]:
        """Values (n, k) by attribute: coordinates in the order of meshes without a material."""
        if self.corners is None:
            return {}
        entries = carried(prim)
        widths = self._widths(prim, time)
        uvs = uv_sets(entries, time, self.corners)
        names = sorted(uvs, key=lambda name: (name != "st", name))
        result = {f"TEXCOORD_{slot}": uvs[name] for slot, name in enumerate(names)}
        wide = {} if widths is None else {DIAMETER: widths}
        return result | customs(entries, time, self.corners) | wide

    def colors(self, prim: Usd.Prim, time: Usd.TimeCode) -> Array | None:
        """Display color and opacity (n, 4); None where there are none that fit."""
        return None if self.corners is None else corner_colors(prim, time, self.corners)

    def _widths(self, prim: Usd.Prim, time: Usd.TimeCode) -> Array | None:
        """Diameters (n, 1) in units of the stage; None where there are none that fit."""
        assert self.corners is not None
        primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("widths")
        if primvar.HasValue():
            values, kind = flattened(primvar, time, 1), primvar.GetInterpolation()
        else:
            schema = UsdGeom.Points if prim.IsA(UsdGeom.Points) else UsdGeom.Curves
            values = array_of(prim.GetAttribute("widths").Get(time), np.float64)
            kind = schema(prim).GetWidthsInterpolation()
        if not len(values):
            return None
        values = np.where(np.isfinite(values), np.maximum(values, 0.0), 0.0)
        found = self.corners.expand(values, "constant" if len(values) == 1 else kind)
        return None if found is None else found.reshape(-1, 1)

    def misfits(self, prim: Usd.Prim, time: Usd.TimeCode) -> tuple[str, ...]:
        """Primvars with values that have no place."""
        if self.corners is None:
            return ()
        return misfits(prim, carried(prim), time, self.corners, _COLORS)


def _drawn(
    points: Array, lost: Lost, owner: Indices, index: Indices, uniform: int, n: int
) -> Cloud:
    """Points with the number of their curve (of `uniform`) and of their authored point (of `n`).

    Samples of cubics, for which `n` is 0, have no authored point: values of those have no place.
    """
    totals = {"uniform": uniform}
    totals |= dict.fromkeys(("vertex", "varying", "faceVarying"), n) if n else {}
    rows = np.arange(len(index))
    return Cloud(points, lost, CornerMap(index, index, owner, rows[:0], rows[:0], 0, totals))


def read_points(prim: Usd.Prim, time: Usd.TimeCode) -> Cloud | None:
    """Points and curves, and their lost inputs; None for other prims."""
    cloud = _read_cloud(prim, time)
    if cloud is not None and cloud.corners is not None:
        cloud.lost = [*cloud.lost, *_without_place(prim)]
    return cloud


def _without_place(prim: Usd.Prim) -> Lost:
    """Inputs that no glTF point or line has."""
    names = {"normals": "normals-dropped", "ids": "ids-dropped"}
    found: Lost = []
    for name, warning in names.items():
        attributes = (prim.GetAttribute(name), prim.GetAttribute(f"primvars:{name}"))
        if any(attribute and attribute.HasAuthoredValue() for attribute in attributes):
            found.append((warning, name))
    return found


def _read_cloud(prim: Usd.Prim, time: Usd.TimeCode) -> Cloud | None:
    kinds = (UsdGeom.BasisCurves, UsdGeom.HermiteCurves, UsdGeom.NurbsCurves)
    curves = any(prim.IsA(kind) for kind in kinds)
    if prim.GetTypeName() == "ParticleField3DGaussianSplat":
        return _splats(prim, time)
    if not (prim.IsA(UsdGeom.Points) or curves):
        return None
    points = points_of(UsdGeom.PointBased(prim).GetPointsAttr(), time)
    finite = np.abs(points) <= float(np.finfo(np.float32).max)
    if not curves:
        kept = np.flatnonzero(finite.all(axis=1))
        return _drawn(points[kept], [], np.zeros_like(kept), kept, 1, len(points))
    counts = array_of(UsdGeom.Curves(prim).GetCurveVertexCountsAttr().Get(time), np.int64)
    if not len(counts) or (counts < 0).any() or counts.sum() > len(points):
        return Cloud(points[:0], _UNFIT if len(points) else [])
    lost: Lost = [("curves-invalid", "curves of one point")] if (counts < 2).any() else []
    if not finite.all():
        return Cloud(points[:0], [*lost, ("points-non-finite", "curves with such points")])
    runs = np.split(points[: counts.sum()], np.cumsum(counts)[:-1])
    if prim.IsA(UsdGeom.NurbsCurves):
        return _nurbs(prim, time, runs, lost)
    schema = UsdGeom.BasisCurves(prim)
    if prim.IsA(UsdGeom.HermiteCurves) or schema.GetTypeAttr().Get(time) == UsdGeom.Tokens.linear:
        owner = np.repeat(np.arange(len(counts)), counts)
        kept = np.flatnonzero(counts[owner] > 1)
        return _drawn(points[kept], lost, owner[kept], kept, len(counts), len(points))
    basis, wrap = str(schema.GetBasisAttr().Get(time)), str(schema.GetWrapAttr().Get(time))
    if basis not in _BASES:
        return None
    drawn = [_cubic(run, basis, wrap) for run in runs]

    def vertex(values: Array) -> Array:
        parts = np.split(values[: counts.sum()], np.cumsum(counts)[:-1])
        return np.concatenate([_cubic(part, basis, wrap) for part in parts])

    cloud = _sampled(drawn, lost)
    if all(len(run) for run in drawn) and cloud.corners is not None:
        spans = [len(run) // _STEPS for run in drawn]
        closed = wrap == UsdGeom.Tokens.periodic
        ends = [count + (not closed) for count in spans]

        def varying(values: Array) -> Array:
            parts = np.split(values[: sum(ends)], np.cumsum(ends)[:-1])
            return np.concatenate(
                [_piecewise(part, n, closed) for part, n in zip(parts, spans, strict=True)]
            )

        cloud.corners = CurveCorners.of(
            cloud.corners, {"vertex": len(points), "varying": sum(ends)}
        )
        cloud.corners.along = {"vertex": vertex, "varying": varying}
    elif cloud.corners is not None:
        cloud.corners = CurveCorners.of(cloud.corners, {"vertex": len(points)})
        cloud.corners.along = {"vertex": vertex}
    return cloud


@dataclasses.dataclass
class Splats(Cloud):
    """Gaussian splats, as wide as two standard deviations, in the constant part of their color."""

    diameters: Array = dataclasses.field(default_factory=lambda: np.zeros((0, 1)))
    constants: Array = dataclasses.field(default_factory=lambda: np.zeros((0, 3)))
    """Coefficients (n, 3) of the spherical harmonic of degree 0."""

    def values(self, prim: Usd.Prim, time: Usd.TimeCode) -> dict[str, Array]:
        """Only their diameters."""
        return {DIAMETER: self.diameters}

    def colors(self, prim: Usd.Prim, time: Usd.TimeCode) -> Array | None:
        """Linear colors: encoded ones are a half more than the harmonic's part (Kerbl et al.)."""
        encoded = np.clip(0.5 + self.constants / math.sqrt(4.0 * math.pi), 0.0, 1.0)
        low, high = encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4
        return np.insert(np.where(encoded <= 0.04045, low, high), 3, 1.0, axis=1)


def _splats(prim: Usd.Prim, time: Usd.TimeCode) -> Splats:
    def read(name: str, width: int) -> Array:
        found = array_of(prim.GetAttribute(name).Get(time), np.float64, width)
        return (
            found
            if len(found)
            else array_of(prim.GetAttribute(f"{name}h").Get(time), np.float64, width)
        )

    points, scales, opacity = read("positions", 3), read("scales", 3), read("opacities", 1)
    scales = scales[: len(points)] if len(scales) >= len(points) else np.ones_like(points)
    rows = np.isfinite(points).all(axis=1) & np.isfinite(scales).all(axis=1)
    if len(opacity) >= len(points):
        rows &= opacity[: len(points)].reshape(-1) >= 0.1
    name = "radiance:sphericalHarmonicsDegree"
    each = (int(prim.GetAttribute(name).Get(time)) + 1) ** 2
    constants = read("radiance:sphericalHarmonicsCoefficients", 3)[::each][: len(points)]
    if len(constants) < len(points):
        constants = np.zeros_like(points)
    sizes = 2.0 * np.abs(scales[:, :1] * scales[:, 1:2] * scales[:, 2:]) ** (1.0 / 3.0)
    return Splats(points[rows], [], diameters=sizes[rows], constants=constants[rows])


def _sampled(drawn: list[Array], lost: Lost) -> Cloud:
    """Samples of all curves, some of which may have none."""
    found = np.vstack([np.zeros((0, 3)), *drawn])
    if not len(found):
        return Cloud(found, _UNFIT)
    owner = np.repeat(np.arange(len(drawn)), [len(run) for run in drawn])
    return _drawn(found, lost, owner, owner, len(drawn), 0)


def _nurbs(prim: Usd.Prim, time: Usd.TimeCode, runs: list[Array], lost: Lost) -> Cloud:
    """Samples of rational splines at every eighth of their visible spans."""
    schema = UsdGeom.NurbsCurves(prim)
    orders = array_of(schema.GetOrderAttr().Get(time), np.int64)
    knots = array_of(schema.GetKnotsAttr().Get(time), np.float64)
    ranges = schema.GetRangesAttr().Get(time) or []
    weights = array_of(schema.GetPointWeightsAttr().Get(time), np.float64)
    total = len(points_of(schema.GetPointsAttr(), time))
    sizes = [len(run) for run in runs]
    if len(orders) != len(runs) or len(knots) != sum(sizes) + orders.sum():
        return Cloud(np.zeros((0, 3)), _UNFIT)
    if len(weights) != total or not (weights > 0.0).all() or not np.isfinite(weights).all():
        weights = np.ones(total)
    drawn, splines = [], []
    for index, run in enumerate(runs):
        own, knots = knots[: len(run) + orders[index]], knots[len(run) + orders[index] :]
        share, weights = weights[: len(run), None], weights[len(run) :]
        limits = ranges[index] if len(ranges) == len(runs) else None
        order = int(orders[index]) if orders[index] <= _MOST_ORDER else 0
        splines.append((own, order, limits, share))
        drawn.append(_rational(run, splines[-1]))
    if any(not len(run) for run in drawn):
        lost = [*lost, ("curves-invalid", "curves whose orders and knots do not fit")]

    def vertex(values: Array) -> Array:
        parts = np.split(values[: sum(sizes)], np.cumsum(sizes)[:-1])
        return np.concatenate([_rational(part, s) for part, s in zip(parts, splines, strict=True)])

    cloud = _sampled(drawn, lost)
    if cloud.corners is not None:
        cloud.corners = CurveCorners.of(cloud.corners, {"vertex": total})
        cloud.corners.along = {"vertex": vertex}
    return cloud


Spline = tuple[Array, int, object, Array]


def _rational(run: Array, spline: Spline) -> Array:
    """Values (n, k) along a rational spline with these knots, order, range and weights."""
    own, order, limits, share = spline
    found = _along(np.column_stack([run * share, share]), own, order, limits, most=1 << 30)
    return run[:0] if found is None else found[:, :-1] / found[:, -1:]


def _piecewise(values: Array, spans: int, closed: bool) -> Array:
    """Values (n, k) at every eighth of the spans, linear between their ends."""
    ends = np.concatenate([values, values[:1]]) if closed else values
    place = np.arange(spans * _STEPS + 1) / _STEPS
    columns = [np.interp(place, np.arange(len(ends)), column) for column in ends.T]
    return np.stack(columns, axis=1)


@dataclasses.dataclass
class CurveCorners(CornerMap):
    """Samples of curves, to which values of control points and of spans' ends are carried."""

    along: dict[str, Callable[[Array], Array]] = dataclasses.field(default_factory=dict)

    @classmethod
    def of(cls, plain: CornerMap, totals: dict[str, int]) -> CurveCorners:
        """The same corners, for which these numbers of values are authored."""
        return cls(**{**vars(plain), "totals": plain.totals | totals})

    def expand(self, values: Array, interpolation: str) -> Array | None:
        """(n, …) values at the samples; None where there are too few."""
        if interpolation not in self.along:
            return super().expand(values, interpolation)
        if len(values) < self.totals[interpolation]:
            return None
        flat = self.along[interpolation](values.reshape(len(values), -1))
        return flat.reshape(-1, *values.shape[1:])


def _cubic(control: Array, basis: str, wrap: str) -> Array:
    """(n, 3) points at every eighth of each span of one curve."""
    step = 3 if basis == "bezier" else 1
    if wrap == UsdGeom.Tokens.periodic:
        control = np.vstack([control, control[: 4 - step]])
    elif wrap == UsdGeom.Tokens.pinned and step == 1 and len(control) > 1:
        ends = 2 * control[0] - control[1], 2 * control[-1] - control[-2]
        control = np.vstack([ends[0], control, ends[1]])
    spans = (len(control) - 4) // step + 1
    if len(control) < 4:
        return control[:0]
    t = np.arange(spans * _STEPS + 1) / _STEPS
    if basis == "bezier":
        rows = np.arange(4)[:, None] + 3 * np.arange(spans)
        return np.asarray(BPoly(control[rows], np.arange(spans + 1))(t))
    if basis == "bspline":
        return np.asarray(BSpline(np.arange(-3.0, len(control) + 1), control, 3)(t))
    slopes = (control[2:] - control[:-2]) / 2
    return np.asarray(CubicHermiteSpline(np.arange(spans + 1), control[1:-1], slopes)(t))


def read_patch(prim: Usd.Prim, time: Usd.TimeCode) -> tuple[Array | None, Lost]:
    """(rows, columns, 3) points on a NURBS patch at every eighth of its spans."""
    points = points_of(UsdGeom.NurbsPatch(prim).GetPointsAttr(), time)
    if not len(points):
        return None, []
    grid = patch_values(prim, time, points)
    if grid is None:
        return None, [("curves-invalid", "orders, knots and points that do not fit")]
    if not np.isfinite(points).all():
        return None, [("points-non-finite", "a patch with such points")]
    return grid, []


def patch_values(prim: Usd.Prim, time: Usd.TimeCode, values: Array) -> Array | None:
    """(rows, columns, k) values on a NURBS patch, from (n, k) values of its control points."""
    schema = UsdGeom.NurbsPatch(prim)
    attributes = [
        (schema.GetVVertexCountAttr(), schema.GetVOrderAttr(), schema.GetVKnotsAttr()),
        (schema.GetUVertexCountAttr(), schema.GetUOrderAttr(), schema.GetUKnotsAttr()),
    ]
    ranges = [schema.GetVRangeAttr().Get(time), schema.GetURangeAttr().Get(time)]
    counts = [int(entry[0].Get(time) or 0) for entry in attributes]
    if counts[0] * counts[1] != len(values):
        return None
    weights = array_of(schema.GetPointWeightsAttr().Get(time), np.float64)
    if len(weights) != len(values) or not (weights > 0.0).all():
        weights = np.ones(len(values))
    grid = np.column_stack([values * weights[:, None], weights]).reshape(*counts, -1)
    for axis, (entry, limits) in enumerate(zip(attributes, ranges, strict=True)):
        knots = array_of(entry[2].Get(time), np.float64)
        moved = _along(np.moveaxis(grid, axis, 0), knots, int(entry[1].Get(time) or 0), limits)
        if moved is None:
            return None
        grid = np.moveaxis(moved, 0, axis)
    return grid[..., :-1] / grid[..., -1:]


@dataclasses.dataclass
class PatchCorners(CornerMap):
    """Corners of the quads on a patch; each value is a mean of control points' values."""

    prim: Usd.Prim = None
    time: Usd.TimeCode = dataclasses.field(default_factory=Usd.TimeCode.Default)

    def expand(self, values: Array, interpolation: str) -> Array | None:
        """(n, …) values at the corners; None where there are too few control points."""
        if interpolation != "vertex":
            return super().expand(values, interpolation)
        shaped = values[: self.totals["vertex"]].reshape(-1, *values.shape[1:])
        grid = patch_values(self.prim, self.time, shaped.reshape(len(shaped), -1))
        if grid is None:
            return None
        return grid.reshape(-1, *values.shape[1:])[self.vertex]


def patch_corners(prim: Usd.Prim, time: Usd.TimeCode, faces: Indices) -> PatchCorners:
    """Corners of (n, 4) faces of grid points."""
    schema = UsdGeom.NurbsPatch(prim)
    control = int(schema.GetUVertexCountAttr().Get(time) or 0)
    control *= int(schema.GetVVertexCountAttr().Get(time) or 0)
    plain = CornerMap.whole(faces, control)
    plain.totals = {"vertex": control}
    return PatchCorners(**vars(plain), prim=prim, time=time)


def _along(
    control: Array, knots: Array, order: int, limits: object, most: int = _MOST_SAMPLES
) -> Array | None:
    """Spline of `control` along its first axis, at every eighth of the visible spans."""
    count = len(control)
    if order < 2 or count < order or len(knots) != count + order:
        return None
    if not np.isfinite(knots).all() or (np.diff(knots) < 0.0).any():
        return None
    low, high = float(knots[order - 1]), float(knots[count])
    chosen = np.array(limits, dtype=np.float64).reshape(-1) if limits is not None else np.zeros(0)
    if len(chosen) == 2 and low <= chosen[0] < chosen[1] <= high:
        low, high = float(chosen[0]), float(chosen[1])
    if not low < high:
        return None
    breaks = np.unique([low, *knots[(knots > low) & (knots < high)], high])
    steps = max(1, min(_STEPS, most // len(breaks)))
    inner = np.arange((len(breaks) - 1) * steps + 1) / steps
    places = np.interp(inner, np.arange(len(breaks)), breaks)
    return np.asarray(BSpline(knots, np.nan_to_num(control), order - 1)(places))
