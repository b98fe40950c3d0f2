"""Points and curves to glTF points and lines; widths and exact curves are warnings."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

from .attributes import DisplayColor, GprimPrimvars, Streams, inherited_primvars
from .context import Context, authored, in_float32, type_name
from .geometry import BuiltMesh, mesh_extras, warn_still_points
from .gltf_writer import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, LINES, POINTS, GltfWriter
from .material import DISPLAY, MaterialLibrary, painter_of, warn_translucent
from .nurbs_curves import sample_nurbs
from .polygons import read_points
from .primvars import Topology
from .scene import Array
from .subsets import bound_material
from .surface import Stream

SEGMENTS_PER_SPAN = 8
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
        self._warn_lost("a glTF point has no size")
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
        self._warn_lost("a glTF line has no width")
        if type_name(prim) == "NurbsCurves":
            message = f"NURBS curves became lines, {SEGMENTS_PER_SPAN} for each span"
            self._warn("curves-approximated", message)
            curves, numbers = sample_nurbs(self.context, prim, points, counts)
            if 0 < len(numbers) < len(counts):
                message = f"{len(counts) - len(numbers)} curves, whose orders and knots do not fit"
                self._warn("curves-invalid", f"{message}, were dropped")
            return self._write_samples(counts, len(points), curves, numbers)
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
        curves, numbers = _sample_cubic(points, counts, basis, wrap)
        return self._write_samples(counts, len(points), curves, numbers)

    def _write_samples(
        self, counts: Array, authored_points: int, curves: list[Array], numbers: list[int]
    ) -> BuiltMesh | None:
        """Write lines along the samples of curves with these numbers; None where there are none."""
        if not curves:
            self._warn("curves-invalid", "no curve has points, orders and knots that fit")
            return None
        sampled = np.concatenate(curves)
        lengths = np.array([len(curve) for curve in curves])
        owners, lines = np.repeat(numbers, lengths), _polylines(lengths, False)
        # Values per control point do not fit the samples; values per curve do.
        vertices = np.arange(len(sampled))
        topology = Topology(
            len(sampled),
            len(counts),
            vertices,
            owners,
            dropped=("vertex", "varying", "faceVarying"),
            authored=Topology(authored_points, len(counts), owners, owners),
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
        attributes = {"POSITION": self._accessor(points[vertices], bounds=True)}
        colors = {} if color is None else {"COLOR_0": color}
        for name, stream in (colors | _vertex_streams(streams)).items():
            attributes[name] = self._accessor(stream.values[stream.ids[vertices]])
        mode = POINTS if lines is None else LINES
        entry: dict[str, Any] = {"attributes": attributes, "mode": mode}
        if lines is not None:
            indices = lines.reshape(-1).astype(np.uint32)
            entry["indices"] = self.writer.add_accessor(indices, ELEMENT_ARRAY_BUFFER)
        if bound_material(prim) is not None:
            message = "points and lines show displayColor, not the bound material"
            self._warn("material-unsupported", message)

        def paint(shown: DisplayColor) -> int:
            return self.materials.instantiate(plan, {}, False, shown, color is not None)

        entry["material"] = paint(display)
        mesh = {"name": prim.GetName(), "primitives": [entry], "extras": mesh_extras(prim, streams)}
        extras = {"primvars": primvars.constants} if primvars.constants else {}
        index = self.writer.add("meshes", mesh)
        self.materials.painters[index] = [painter_of(DISPLAY, primvars, display, paint)]
        return BuiltMesh(index, extras)

    def _accessor(self, values: Array, bounds: bool = False) -> int:
        shaped = values[:, 0] if values.shape[1] == 1 else values
        return self.writer.add_accessor(shaped.astype(np.float32), ARRAY_BUFFER, bounds)

    def _warn_lost(self, message: str) -> None:
        """Warn about widths (`message` says why), normals and ids, which points and lines lack."""
        widths = UsdGeom.PrimvarsAPI(self.prim).GetPrimvar("widths")
        attribute = self.prim.GetAttribute("widths")
        if (widths and widths.HasValue()) or (attribute and attribute.HasAuthoredValue()):
            self._warn("width-dropped", message)
        for name, warning in (("normals", "normals-dropped"), ("ids", "ids-dropped")):
            attributes = (self.prim.GetAttribute(name), self.prim.GetAttribute(f"primvars:{name}"))
            if any(attribute and attribute.HasAuthoredValue() for attribute in attributes):
                message = f"the {name} of points and curves are not carried"
                self._warn(warning, message)


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
        curve = np.vstack([samples[:, :-1].reshape(-1, 3), samples[-1, -1:]])
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
