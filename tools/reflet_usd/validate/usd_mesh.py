"""Owns what one mesh prim draws: its face corners and their attributes, read through usd-core."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

from .facts import Array, Indices

NO_COLOR = 0.18
"""UsdPreviewSurface's diffuseColor, for gprims whose displayColor is missing or does not fit."""
_UV_TYPES = re.compile(r"(texCoord[23][fdh]|float2|double2|half2|Vec2f)\[\]")
_FLOATS = re.compile(r"(?:float|double|half|color|vector|normal|point)([234]?)[fdh]?\[\]")
_HANDLED = ("displayColor", "displayOpacity", "normals")


@dataclasses.dataclass
class LocalMesh:
    """One mesh in its own space. Corners of usable faces lie one after another."""

    positions: Array
    """(n, 3) corner positions."""
    counts: Indices
    """(faces,) corners of each face."""
    optional_positions: Array
    """(m, 3) corners of faces that may be dropped: degenerate by their indices."""
    optional_triangles: int
    normals: Array | None
    uvs: dict[str, Array]
    colors: Array | None
    materials: Indices
    """(faces,) index into `material_paths`, −1 for none."""
    material_paths: list[str]
    flat_shaded: bool
    """Whether each corner's normal is that of its face."""
    double_sided: bool
    optional_counts: Indices = dataclasses.field(default_factory=lambda: np.zeros(0, np.int64))
    """(faces,) corners of each face that may be dropped."""
    undefined_colors: tuple[str, ...] = ()
    """Display primvars on parts whose order USD does not define: they are left out."""
    customs: dict[str, Array] = dataclasses.field(default_factory=dict)
    """Other float primvars at the corners, each (n, k), by the attribute's name."""


def read_mesh(
    prim: Usd.Prim, time: Usd.TimeCode, materials: tuple[Indices, list[str]] | None = None
) -> LocalMesh | None:
    """The mesh at `time`; None when it has no usable face (missing or broken topology)."""
    mesh = UsdGeom.Mesh(prim)
    points = array_of(mesh.GetPointsAttr().Get(time), np.float64, 3)
    counts = array_of(mesh.GetFaceVertexCountsAttr().Get(time), np.int64)
    indices = array_of(mesh.GetFaceVertexIndicesAttr().Get(time), np.int64)
    if not len(counts) or not len(points):
        return None
    corners = _usable_corners(mesh, time, counts, indices, points)
    positions = points[indices[corners.index]]
    face_materials, paths = materials or (np.full(len(counts), -1), [])
    scheme = mesh.GetSubdivisionSchemeAttr().Get(time) or "catmullClark"
    normals = _normals(mesh, time, corners) if scheme == "none" else None
    return LocalMesh(
        positions,
        counts[corners.faces],
        points[indices[corners.optional_index]],
        corners.optional_triangles,
        normals,
        _uvs(prim, time, corners),
        corner_colors(prim, time, corners),
        face_materials[corners.faces],
        paths,
        scheme == "none" and normals is None,
        bool(mesh.GetDoubleSidedAttr().Get(time)),
        corners.optional_counts,
        customs=_customs(prim, time, corners),
    )


@dataclasses.dataclass
class CornerMap:
    """Which authored corners are drawn, and where each one's primvar values lie."""

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
    """How many elements a primvar of each interpolation must have."""
    optional_counts: Indices = dataclasses.field(default_factory=lambda: np.zeros(0, np.int64))

    @classmethod
    def whole(cls, faces: Indices, points: int) -> CornerMap:
        """All corners of (n, k) faces of point indices."""
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
        """(n, …) values at the corners; None where the count does not fit the topology."""
        if interpolation == "constant" and len(values) >= 1:
            return np.repeat(values[:1], len(self.index), axis=0)
        if len(values) != self.totals.get(interpolation, -1):
            return None
        where = {"uniform": self.face, "faceVarying": self.index}.get(interpolation, self.vertex)
        return values[where]


def _usable_corners(
    mesh: UsdGeom.Mesh, time: Usd.TimeCode, counts: Indices, indices: Indices, points: Array
) -> CornerMap:
    stated, authored = len(counts), len(indices)
    # Faces up to the first that does not fit the indices; no other can be told from the rest.
    broken = np.flatnonzero((counts < 0) | (np.cumsum(np.maximum(counts, 0)) > authored))
    counts = counts[: broken[0]] if len(broken) else counts
    indices = indices[: counts.sum()]
    face = np.repeat(np.arange(len(counts)), counts)
    inside = (indices >= 0) & (indices < len(points))
    bad = np.zeros(len(counts), bool)
    np.logical_or.at(bad, face[~inside], True)
    finite = np.zeros(len(indices), bool)
    finite[inside] = np.isfinite(points[indices[inside]]).all(axis=1)
    np.logical_or.at(bad, face[~finite], True)
    holes = array_of(mesh.GetHoleIndicesAttr().Get(time), np.int64)
    hole = np.zeros(len(counts), bool)
    hole[holes[(holes >= 0) & (holes < len(counts))]] = True
    drawn = (counts >= 3) & ~bad & ~hole
    optional = drawn & _is_degenerate(counts, indices, points, drawn)
    required = drawn & ~optional
    keep = np.flatnonzero(required[face])
    loose = np.flatnonzero(optional[face])
    if mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded:
        keep = _reversed_faces(keep, counts[required])
        loose = _reversed_faces(loose, counts[optional])
    totals = {
        "uniform": stated,
        "faceVarying": authored,
        "vertex": len(points),
        "varying": len(points),
    }
    return CornerMap(
        keep,
        indices[keep],
        face[keep],
        np.flatnonzero(required),
        loose,
        int((counts[optional] - 2).sum()),
        totals,
        counts[optional],
    )


def _is_degenerate(counts: Indices, indices: Indices, points: Array, drawn: np.ndarray) -> Any:
    """Faces that repeat a point or have no area: a converter may drop them."""
    result = np.zeros(len(counts), bool)
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)
    for size in np.unique(counts[drawn]):
        faces = np.flatnonzero(drawn & (counts == size))
        table = indices[starts[faces][:, None] + np.arange(size)]
        ordered = np.sort(table, axis=1)
        repeats = (ordered[:, 1:] == ordered[:, :-1]).any(axis=1)
        at = points[table]
        offset = at - at[:, :1]
        vector = np.cross(offset, np.roll(offset, -1, axis=1)).sum(axis=1)
        size2 = (offset**2).sum(axis=2).max(axis=1)
        result[faces] = repeats | (np.linalg.norm(vector, axis=1) <= 1e-9 * size2)
    return result


def _reversed_faces(keep: Indices, counts: Indices) -> Indices:
    """The same corners with every face's order turned around."""
    if not len(keep):
        return keep
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    face = np.repeat(np.arange(len(counts)), counts)
    local = np.arange(len(keep)) - starts[face]
    return keep[starts[face] + counts[face] - 1 - local]


def _normals(mesh: UsdGeom.Mesh, time: Usd.TimeCode, corners: CornerMap) -> Array | None:
    primvar = UsdGeom.PrimvarsAPI(mesh.GetPrim()).GetPrimvar("normals")
    if primvar and primvar.HasAuthoredValue():
        raw, interpolation = primvar.ComputeFlattened(time), primvar.GetInterpolation()
    else:
        raw, interpolation = mesh.GetNormalsAttr().Get(time), mesh.GetNormalsInterpolation()
    values = np.nan_to_num(array_of(raw, np.float64, 3), posinf=0.0, neginf=0.0)
    expanded = corners.expand(values, interpolation) if len(values) else None
    if expanded is None:
        return None
    length = np.linalg.norm(expanded, axis=1, keepdims=True)
    unit = np.divide(expanded, length, out=np.zeros_like(expanded), where=length > 0.0)
    unit[length[:, 0] == 0.0] = (0.0, 1.0, 0.0)  # as documented for those without a direction
    return unit


def _uvs(prim: Usd.Prim, time: Usd.TimeCode, corners: CornerMap) -> dict[str, Array]:
    result = {}
    for primvar in UsdGeom.PrimvarsAPI(prim).FindPrimvarsWithInheritance():
        kind, interpolation = str(primvar.GetTypeName()), primvar.GetInterpolation()
        if not _UV_TYPES.fullmatch(kind):
            continue
        if interpolation == "constant" and not kind.startswith("texCoord"):
            continue  # two numbers that mean something else
        values = flattened(primvar, time, 3 if "3" in kind else 2)
        expanded = corners.expand(values, interpolation)
        if expanded is not None and np.isfinite(expanded).all():
            result[primvar.GetPrimvarName()] = expanded[:, :2]
    return result


def _customs(prim: Usd.Prim, time: Usd.TimeCode, corners: CornerMap) -> dict[str, Array]:
    """Float primvars that are neither coordinates nor read elsewhere, by the file's names."""
    result = {}
    for primvar in UsdGeom.PrimvarsAPI(prim).FindPrimvarsWithInheritance():
        name, kind = str(primvar.GetPrimvarName()), str(primvar.GetTypeName())
        match = _FLOATS.fullmatch(kind)
        handled = name.startswith("skel:") or name in _HANDLED or _UV_TYPES.fullmatch(kind)
        if match is None or handled or primvar.GetInterpolation() == "constant":
            continue
        values = flattened(primvar, time, int(match.group(1) or 1))
        expanded = corners.expand(values, primvar.GetInterpolation())
        if expanded is not None and len(values) and np.isfinite(expanded).all():
            attribute = "_" + re.sub(r"[^A-Za-z0-9_]", "_", name).upper()
            result[attribute] = expanded.reshape(len(expanded), -1)
    return result


def corner_colors(prim: Usd.Prim, time: Usd.TimeCode, corners: CornerMap) -> Array | None:
    """(n, 4) display color and opacity at the corners; None where none fits."""
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
    if primvar and primvar.IsIndexed():
        indices = array_of(primvar.GetIndices(time), np.int64)
        if len(indices) and len(values) and indices.min() >= 0 and indices.max() < len(values):
            return values[indices]
        return values[:0]
    return values


def array_of(value: Any, dtype: type, width: int = 1) -> Any:
    """A value array of usd-core as numpy, (n,) or (n, width); empty where nothing fits."""
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
