"""Points and curves to glTF points and lines; widths and exact curves are warnings."""

from dataclasses import replace
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

from reflet_usd.convert.attributes import (
    Streams,
    inherited_primvars,
    primvar_streams,
    read_display,
    read_primvars,
)
from reflet_usd.convert.context import Context, authored, in_float32, type_name
from reflet_usd.convert.geometry import BuiltMesh, mesh_extras, warn_still_points
from reflet_usd.convert.gltf_writer import (
    ARRAY_BUFFER,
    ELEMENT_ARRAY_BUFFER,
    LINES,
    POINTS,
    GltfWriter,
)
from reflet_usd.convert.material import MaterialLibrary, warn_translucent
from reflet_usd.convert.nurbs_curves import sample_nurbs
from reflet_usd.convert.polygons import read_points
from reflet_usd.convert.primvars import Topology
from reflet_usd.convert.scene import Array
from reflet_usd.convert.subsets import bound_material
from reflet_usd.convert.surface import Stream

SEGMENTS_PER_SPAN = 8
# Basis matrices: powers of t from 1 to t³ times these times four control points.
_BASES = {
    "bezier": np.array([[1, 0, 0, 0], [-3, 3, 0, 0], [3, -6, 3, 0], [-1, 3, -3, 1]], dtype=float),
    "bspline": np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6.0,
    "catmullRom": np.array([[0, 2, 0, 0], [-1, 0, 1, 0], [2, -5, 4, -1], [-1, 3, -3, 1]]) / 2.0,
}


def is_curves(prim: Usd.Prim) -> bool:
    """Whether `build_curves` converts the type."""
    return type_name(prim) in ("BasisCurves", "HermiteCurves", "NurbsCurves")


def build_points(
    context: Context, writer: GltfWriter, materials: MaterialLibrary, prim: Usd.Prim
) -> BuiltMesh | None:
    """A mesh of glTF points, or None (with a warning) where there are none."""
    warn_still_points(context, prim)
    points = read_points(context, prim)
    finite = in_float32(points).all(axis=1)
    if not finite.any():
        context.ledger.warn("mesh-empty", prim, "there are no finite points")
        return None
    if not finite.all():
        context.ledger.warn("points-non-finite", prim, "points that are not finite were dropped")
    _warn_lost(context, prim, "a glTF point has no size")
    vertices = np.flatnonzero(finite)
    return _write(context, writer, materials, prim, points, vertices, None)


def build_curves(
    context: Context, writer: GltfWriter, materials: MaterialLibrary, prim: Usd.Prim
) -> BuiltMesh | None:
    """A mesh of glTF lines, or None (with a warning) where there is nothing to draw."""
    warn_still_points(context, prim)
    points = read_points(context, prim)
    counts = np.array(authored(prim, "curveVertexCounts", context.time, []), dtype=np.int64)
    if len(counts) == 0 or (counts < 0).any() or counts.sum() > len(points):
        context.ledger.warn("curves-invalid", prim, "curveVertexCounts do not fit the points")
        return None
    if (counts < 2).any():
        message = f"{int((counts < 2).sum())} curves have fewer than 2 points and were dropped"
        context.ledger.warn("curves-invalid", prim, message)
    if not in_float32(points).all():
        context.ledger.warn("points-non-finite", prim, "curves with such points were dropped")
        return None
    _warn_lost(context, prim, "a glTF line has no width")
    if type_name(prim) == "NurbsCurves":
        message = f"NURBS curves became lines, {SEGMENTS_PER_SPAN} for each span"
        context.ledger.warn("curves-approximated", prim, message)
        curves, numbers = sample_nurbs(context, prim, points, counts)
        if 0 < len(numbers) < len(counts):
            message = f"{len(counts) - len(numbers)} curves, whose orders and knots do not fit"
            context.ledger.warn("curves-invalid", prim, f"{message}, were dropped")
        return _write_samples(
            context, writer, materials, prim, counts, len(points), curves, numbers
        )
    kind = str(authored(prim, "type", context.time, "cubic"))
    wrap = str(authored(prim, "wrap", context.time, "nonperiodic"))
    if type_name(prim) == "HermiteCurves" or kind == "linear":
        if type_name(prim) == "HermiteCurves":
            message = "the curves are drawn straight between their points"
            context.ledger.warn("curves-approximated", prim, message)
        lines = _polylines(counts, wrap == "periodic")
        if len(lines) == 0:
            return None
        owners = np.repeat(np.arange(len(counts)), counts)
        owners = np.pad(owners, (0, len(points) - len(owners)))
        topology = Topology(len(points), len(counts), np.arange(len(points)), owners)
        # Points that no line uses would still count in the file's bounds.
        vertices, ends = np.unique(lines, return_inverse=True)
        lines = ends.reshape(lines.shape)
        return _write(context, writer, materials, prim, points, vertices, lines, topology)
    basis = str(authored(prim, "basis", context.time, "bezier"))
    if basis not in _BASES:
        context.ledger.warn("curves-dropped", prim, f"the basis '{basis}' is not known")
        return None
    message = f"cubic {basis} curves became lines, {SEGMENTS_PER_SPAN} for each span"
    context.ledger.warn("curves-approximated", prim, message)
    curves, numbers = _sample_cubic(points, counts, basis, wrap)
    return _write_samples(context, writer, materials, prim, counts, len(points), curves, numbers)


def _write_samples(
    context: Context,
    writer: GltfWriter,
    materials: MaterialLibrary,
    prim: Usd.Prim,
    counts: Array,
    authored_points: int,
    curves: list[Array],
    numbers: list[int],
) -> BuiltMesh | None:
    """Write lines along the samples of curves with these numbers; None where there are none."""
    if not curves:
        context.ledger.warn(
            "curves-invalid", prim, "no curve has points, orders and knots that fit"
        )
        return None
    sampled = np.concatenate(curves)
    lengths = np.array([len(curve) for curve in curves])
    owners, lines = np.repeat(numbers, lengths), _polylines(lengths, False)
    # Values per control point do not fit the samples; values per curve do.
    topology = Topology(len(sampled), len(counts), np.arange(len(sampled)), owners)
    topology = replace(topology, authored=Topology(authored_points, len(counts), owners, owners))
    drop = ("vertex", "varying", "faceVarying")
    vertices = np.arange(len(sampled))
    return _write(context, writer, materials, prim, sampled, vertices, lines, topology, drop)


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


def _write(
    context: Context,
    writer: GltfWriter,
    materials: MaterialLibrary,
    prim: Usd.Prim,
    points: Array,
    vertices: Array,
    lines: Array | None,
    topology: Topology | None = None,
    dropped: tuple[str, ...] = (),
) -> BuiltMesh:
    """Write points or lines with the gprim's display color; bound materials do not shade them.

    Primvars of an interpolation in `dropped` are named and left out.
    """
    if topology is None:
        count = len(points)
        topology = Topology(count, 1, np.arange(count), np.zeros(count, dtype=np.int64))
    topology = replace(topology, dropped=dropped)
    primvars = read_primvars(context, prim, inherited_primvars(prim))
    streams = primvar_streams(context, prim, primvars, topology)
    display = read_display(context, prim, primvars.owned, topology)
    plan = materials.plan(None)
    warn_translucent(context, prim, plan, display)
    color = display.stream_for(True, True)
    attributes = {"POSITION": _accessor(writer, points[vertices], bounds=True)}
    if color is not None:
        attributes["COLOR_0"] = _accessor(writer, color.values[color.ids[vertices]])
    for name, stream in _vertex_streams(streams).items():
        attributes[name] = _accessor(writer, stream.values[stream.ids[vertices]])
    entry: dict[str, Any] = {"attributes": attributes, "mode": POINTS if lines is None else LINES}
    if lines is not None:
        indices = lines.reshape(-1).astype(np.uint32)
        entry["indices"] = writer.add_accessor(indices, ELEMENT_ARRAY_BUFFER)
    if bound_material(prim) is not None:
        message = "points and lines show displayColor, not the bound material"
        context.ledger.warn("material-unsupported", prim, message)
    entry["material"] = materials.instantiate(plan, {}, False, display, color is not None)
    mesh = {"name": prim.GetName(), "primitives": [entry], "extras": mesh_extras(prim, streams)}
    extras = {"primvars": primvars.constants} if primvars.constants else {}
    return BuiltMesh(writer.add("meshes", mesh), extras)


def _vertex_streams(streams: Streams) -> dict[str, Stream]:
    """Streams by attribute; UV sets in the order of meshes without a material, v pointing down."""
    result = dict(streams.custom)
    names = sorted(streams.uvs, key=lambda name: (name != "st", name))
    for slot, name in enumerate(names):
        uv = streams.uvs[name]
        flipped = np.column_stack([uv.values[:, 0], 1.0 - uv.values[:, 1]])
        result[f"TEXCOORD_{slot}"] = replace(uv, values=flipped)
    return result


def _accessor(writer: GltfWriter, values: Array, bounds: bool = False) -> int:
    shaped = values[:, 0] if values.shape[1] == 1 else values
    return writer.add_accessor(shaped.astype(np.float32), ARRAY_BUFFER, bounds)


def _warn_lost(context: Context, prim: Usd.Prim, message: str) -> None:
    """Warn about widths (`message` says why), normals and ids, which glTF points and lines lack."""
    widths = UsdGeom.PrimvarsAPI(prim).GetPrimvar("widths")
    attribute = prim.GetAttribute("widths")
    if (widths and widths.HasValue()) or (attribute and attribute.HasAuthoredValue()):
        context.ledger.warn("width-dropped", prim, message)
    for name, warning in (("normals", "normals-dropped"), ("ids", "ids-dropped")):
        attributes = (prim.GetAttribute(name), prim.GetAttribute(f"primvars:{name}"))
        if any(attribute and attribute.HasAuthoredValue() for attribute in attributes):
            message = f"the {name} of points and curves are not carried"
            context.ledger.warn(warning, prim, message)
