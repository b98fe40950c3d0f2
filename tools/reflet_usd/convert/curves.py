"""Points and curves to glTF points and lines, and their widths, by which `reflet` draws them."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

from .attributes import DisplayColor, GprimPrimvars, Streams, inherited_primvars
from .context import Context, authored, in_float32, type_name
from .geometry import BuiltMesh, mesh_extras, warn_still_points
from .gltf_writer import ELEMENT_ARRAY_BUFFER, LINES, POINTS, GltfWriter
from .material import DISPLAY, MaterialLibrary, painter_of, warn_translucent
from .nurbs_curves import sample_nurbs
from .polygons import read_points
from .primvars import Primvar, Topology, read_primvar, to_stream
from .scene import Array
from .subsets import bound_material
from .surface import Stream

SEGMENTS_PER_SPAN = 8
WIDTH_ATTRIBUTE = "_DIAMETER_M"
MOST_WIDTHS = 64
"""Maximum number of different widths of one prim."""
# Basis matrices: powers of t from 1 to t³ times these times four control points.
_BASES = {
    "bezier": np.array([[1, 0, 0, 0], [-3, 3, 0, 0], [3, -6, 3, 0], [-1, 3, -3, 1]], dtype=float),
    "bspline": np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6.0,
    "catmullRom": np.array([[0, 2, 0, 0], [-1, 0, 1, 0], [2, -5, 4, -1], [-1, 3, -3, 1]]) / 2.0,
}


def draws_lines(prim: Usd.Prim) -> bool:
    """Whether `LineBuilder` converts the type."""
    return type_name(prim) in ("Points", "BasisCurves", "HermiteCurves", "NurbsCurves")


@dataclass
class Samples:
    """Samples along curves, and how values of their control points follow them."""

    counts: Array
    """Control points of each curve, drawn or not."""
    points: int
    curves: list[Array]
    numbers: list[int]
    """The numbers of the curves that are drawn."""
    along: Callable[[Array], tuple[list[Array], list[int]]]
    """Values of control points to values of samples."""
    ends: list[int] = field(default_factory=list)
    """Numbers of varying values of each curve; none where they are not known."""

    def refine(self, primvar: Primvar) -> Primvar:
        """Values at the samples, of control points or of the ends of spans."""
        if primvar.interpolation == "vertex":
            values = np.concatenate(self.along(primvar.flat())[0])
        elif primvar.interpolation == "varying":
            runs = np.split(primvar.flat()[: sum(self.ends)], np.cumsum(self.ends)[:-1])
            pairs = zip(runs, self.curves, strict=True)
            values = np.concatenate([_between(run, len(curve)) for run, curve in pairs])
        else:
            return primvar
        return Primvar(primvar.name, primvar.interpolation, values, None)


def _between(run: Array, count: int) -> Array:
    """`count` values along a curve, between the two nearest of its spans' ends."""
    place = np.arange(count) / SEGMENTS_PER_SPAN
    first = np.minimum(place.astype(np.int64), len(run) - 1)
    share = (place - first)[:, None]
    result: Array = run[first] * (1.0 - share) + run[(first + 1) % len(run)] * share
    return result


@dataclass
class LineBuilder:
    """Converts a prim of points or curves."""

    context: Context
    writer: GltfWriter
    materials: MaterialLibrary
    prim: Usd.Prim

    def build(self) -> BuiltMesh | None:
        """A mesh of glTF points or lines, or None (with a warning) where nothing is to be drawn."""
        warn_still_points(self.context, self.prim)
        points = read_points(self.context, self.prim)
        return self._points(points) if type_name(self.prim) == "Points" else self._curves(points)

    def _warn(self, name: str, message: str) -> None:
        self.context.ledger.warn(name, self.prim, message)

    def _points(self, points: Array) -> BuiltMesh | None:
        finite = in_float32(points).all(axis=1)
        if not finite.any():
            self._warn("mesh-empty", "there are no finite points")
            return None
        if not finite.all():
            self._warn("points-non-finite", "points that are not finite were dropped")
        self._warn_lost()
        count = len(points)
        topology = Topology(count, 1, np.arange(count), np.zeros(count, dtype=np.int64))
        return self._write(points, np.flatnonzero(finite), None, topology)

    def _curves(self, points: Array) -> BuiltMesh | None:
        prim, time = self.prim, self.context.time
        counts = np.array(authored(prim, "curveVertexCounts", time, []), dtype=np.int64)
        if len(counts) == 0 or (counts < 0).any() or counts.sum() > len(points):
            self._warn("curves-invalid", "curveVertexCounts do not fit the points")
            return None
        if (counts < 2).any():
            message = f"{int((counts < 2).sum())} curves have fewer than 2 points and were dropped"
            self._warn("curves-invalid", message)
        if not in_float32(points).all():
            self._warn("points-non-finite", "curves with such points were dropped")
            return None
        self._warn_lost()
        if type_name(prim) == "NurbsCurves":
            message = f"NURBS curves became lines, {SEGMENTS_PER_SPAN} for each span"
            self._warn("curves-approximated", message)
            nurbs = functools.partial(sample_nurbs, self.context, prim, counts=counts)
            curves, numbers = nurbs(points)
            if 0 < len(numbers) < len(counts):
                message = f"{len(counts) - len(numbers)} curves, whose orders and knots do not fit"
                self._warn("curves-invalid", f"{message}, were dropped")
            return self._write_samples(Samples(counts, len(points), curves, numbers, nurbs))
        kind = str(authored(prim, "type", time, "cubic"))
        wrap = str(authored(prim, "wrap", time, "nonperiodic"))
        if type_name(prim) == "HermiteCurves" or kind == "linear":
            if type_name(prim) == "HermiteCurves":
                message = "the curves are drawn straight between their points"
                self._warn("curves-approximated", message)
            lines = _polylines(counts, wrap == "periodic")
            if len(lines) == 0:
                return None
            owners = np.repeat(np.arange(len(counts)), counts)
            owners = np.pad(owners, (0, len(points) - len(owners)))
            topology = Topology(len(points), len(counts), np.arange(len(points)), owners)
            # Points that no line uses would still count in the file's bounds.
            vertices, ends = np.unique(lines, return_inverse=True)
            lines = ends.reshape(lines.shape)
            return self._write(points, vertices, lines, topology)
        basis = str(authored(prim, "basis", time, "bezier"))
        if basis not in _BASES:
            self._warn("curves-dropped", f"the basis '{basis}' is not known")
            return None
        message = f"cubic {basis} curves became lines, {SEGMENTS_PER_SPAN} for each span"
        self._warn("curves-approximated", message)
        cubic = functools.partial(_sample_cubic, counts=counts, basis=basis, wrap=wrap)
        curves, numbers = cubic(points)
        samples = Samples(counts, len(points), curves, numbers, cubic)
        if len(curves) == len(counts):
            closed = wrap == "periodic"
            samples.ends = [len(curve) // SEGMENTS_PER_SPAN + (not closed) for curve in curves]
        return self._write_samples(samples)

    def _write_samples(self, samples: Samples) -> BuiltMesh | None:
        """Write lines along the samples of curves; None where there are none."""
        curves = samples.curves
        if not curves:
            self._warn("curves-invalid", "no curve has points, orders and knots that fit")
            return None
        sampled = np.concatenate(curves)
        lengths = np.array([len(curve) for curve in curves])
        owners, lines = np.repeat(samples.numbers, lengths), _polylines(lengths, False)
        vertices, curve_count = np.arange(len(sampled)), len(samples.counts)
        authored = Topology(samples.points, curve_count, owners, owners)
        topology = Topology(
            len(sampled),
            curve_count,
            vertices,
            owners,
            refine=samples.refine,
            dropped=("faceVarying",) if samples.ends else ("varying", "faceVarying"),
            authored=replace(authored, varying_count=sum(samples.ends)),
        )
        return self._write(sampled, vertices, lines, topology)

    def _write(
        self, points: Array, vertices: Array, lines: Array | None, topology: Topology
    ) -> BuiltMesh:
        """Write points or lines with the gprim's display color; bound materials do not shade them.

        Primvars of an interpolation that the topology drops are named and left out.
        """
        prim = self.prim
        primvars = GprimPrimvars(self.context, prim, inherited_primvars(prim))
        streams = primvars.streams(topology)
        display = primvars.display(topology)
        plan = self.materials.plan(None)
        warn_translucent(self.context, prim, plan, display)
        color = display.stream_for(True, True)
        values = {"POSITION": points[vertices]}
        colors = {} if color is None else {"COLOR_0": color}
        for name, stream in (colors | _vertex_streams(streams)).items():
            values[name] = stream.values[stream.ids[vertices]]
        widths = self._widths(topology)
        if widths is not None:
            values[WIDTH_ATTRIBUTE] = widths[vertices]
        entries = [
            self._entry(values, lines, rows, width) for rows, width in by_width(values, lines)
        ]
        if bound_material(prim) is not None:
            message = "points and lines show displayColor, not the bound material"
            self._warn("material-unsupported", message)

        def paint(shown: DisplayColor) -> int:
            return self.materials.instantiate(plan, {}, False, shown, color is not None)

        look, painter = paint(display), painter_of(DISPLAY, primvars, display, paint)
        primitives = [{**entry, "material": look} for entry in entries]
        mesh = {"name": prim.GetName(), "primitives": primitives}
        mesh["extras"] = mesh_extras(prim, streams)
        extras = {"primvars": primvars.constants} if primvars.constants else {}
        index = self.writer.add("meshes", mesh)
        self.materials.painters[index] = [painter] * len(entries)
        return BuiltMesh(index, extras)

    def _entry(
        self, values: dict[str, Array], lines: Array | None, rows: Array, width: float | None
    ) -> dict[str, Any]:
        """Primitive of some of the points, or of the lines, that are drawn this wide."""
        used = rows
        entry: dict[str, Any] = {"mode": POINTS}
        if lines is not None:
            used, ends = np.unique(lines[rows], return_inverse=True)
            indices = self.writer.add_accessor(
                ends.reshape(-1).astype(np.uint32), ELEMENT_ARRAY_BUFFER
            )
            entry = {"mode": LINES, "indices": indices}
        entry["attributes"] = {
            name: self.writer.add_floats(numbers[used], bounds=name == "POSITION")
            for name, numbers in values.items()
        }
        return entry if width is None else {**entry, "extras": {"width_m": width}}

    def _widths(self, topology: Topology) -> Array | None:
        """Diameters (corners, 1) in meters; None where there are none that fit."""
        primvar = UsdGeom.PrimvarsAPI(self.prim).GetPrimvar("widths")
        read = read_primvar(self.context, self.prim, primvar) if primvar.HasValue() else None
        if read is None:
            schema = UsdGeom.Points if type_name(self.prim) == "Points" else UsdGeom.Curves
            values = np.array(authored(self.prim, "widths", self.context.time, []), dtype=float)
            finite = np.where(in_float32(values), values, -1.0).reshape(-1, 1)
            read = Primvar("widths", schema(self.prim).GetWidthsInterpolation(), finite, None)
        if not len(read.values):
            return None
        if len(read.flat()) == 1:
            read = replace(read, interpolation="constant")
        stream = to_stream(self.context, self.prim, read, topology)
        if stream is None or stream.values.shape[1] != 1:
            return None
        widths = stream.values[stream.ids]
        if (widths < 0.0).any():
            self._warn("widths-wrong", "widths below 0 or of no number are 0, which is drawn thin")
        return np.maximum(widths, 0.0) * self.context.meters_per_unit

    def _warn_lost(self) -> None:
        """Warn about normals and ids, which points and lines lack."""
        for name, warning in (("normals", "normals-dropped"), ("ids", "ids-dropped")):
            attributes = (self.prim.GetAttribute(name), self.prim.GetAttribute(f"primvars:{name}"))
            if any(attribute and attribute.HasAuthoredValue() for attribute in attributes):
                message = f"the {name} of points and curves are not carried"
                self._warn(warning, message)


def by_width(values: dict[str, Array], lines: Array | None) -> list[tuple[Array, float | None]]:
    """Points or lines of each width, a line having the mean of its ends.

    Of more than `MOST_WIDTHS` the widths are rounded to as many, in equal ratios.
    """
    count = len(values["POSITION"]) if lines is None else len(lines)
    if WIDTH_ATTRIBUTE not in values:
        return [(np.arange(count), None)]
    widths = values[WIDTH_ATTRIBUTE][:, 0]
    if lines is not None:
        widths = widths[lines].mean(axis=1)
    drawn, which = np.unique(widths.astype(np.float32), return_inverse=True)
    if len(drawn) > MOST_WIDTHS:
        low = max(float(drawn[0]), float(drawn[-1]) * 1e-3)
        ratio = math.log(float(drawn[-1]) / low) / (MOST_WIDTHS - 1)
        step = np.round(np.log(np.maximum(widths, low) / low) / ratio)
        drawn, which = np.unique(low * np.exp(step * ratio), return_inverse=True)
    rows = [np.flatnonzero(which.reshape(-1) == index) for index in range(len(drawn))]
    return list(zip(rows, drawn.astype(float).tolist(), strict=True))


def _polylines(counts: Array, closed: bool) -> Array:
    """Index pairs (L, 2) along each run of `counts` points."""
    total = int(counts.sum())
    counts = counts[counts > 0]
    ends = np.cumsum(counts) - 1
    pairs = np.stack([np.arange(total), np.arange(1, total + 1)], axis=1)
    if closed:
        pairs[ends, 1] = ends - counts + 1
        return pairs[pairs[:, 0] != pairs[:, 1]]
    return np.delete(pairs, ends, axis=0)


def _sample_cubic(
    points: Array, counts: Array, basis: str, wrap: str
) -> tuple[list[Array], list[int]]:
    """Points (n, 3) along each cubic curve with enough points, and the numbers of these curves."""
    step = 3 if basis == "bezier" else 1
    t = np.linspace(0.0, 1.0, SEGMENTS_PER_SPAN + 1)
    weights = np.stack([np.ones_like(t), t, t * t, t**3], axis=1) @ _BASES[basis]
    curves: list[Array] = []
    numbers: list[int] = []
    start = 0
    for number, count in enumerate(counts):
        control = points[start : start + count]
        start += count
        if wrap == "periodic":
            control = np.vstack([control, control[: 4 - step]])
        elif wrap == "pinned" and step == 1 and count >= 2:
            first, last = 2 * control[0] - control[1], 2 * control[-1] - control[-2]
            control = np.vstack([first, control, last])
        spans = (len(control) - 4) // step + 1
        if len(control) < 4 or spans < 1:
            continue
        windows = control[np.arange(spans)[:, None] * step + np.arange(4)]
        samples = np.einsum("tk,skc->stc", weights, windows)
        curve = np.vstack([samples[:, :-1].reshape(-1, points.shape[1]), samples[-1, -1:]])
        curves.append(curve)
        numbers.append(number)
    return curves, numbers


def _vertex_streams(streams: Streams) -> dict[str, Stream]:
    """Streams by attribute; UV sets in the order of meshes without a material, v pointing down."""
    result = dict(streams.custom)
    names = sorted(streams.uvs, key=lambda name: (name != "st", name))
    for slot, name in enumerate(names):
        uv = streams.uvs[name]
        flipped = np.column_stack([uv.values[:, 0], 1.0 - uv.values[:, 1]])
        result[f"TEXCOORD_{slot}"] = replace(uv, values=flipped)
    return result
