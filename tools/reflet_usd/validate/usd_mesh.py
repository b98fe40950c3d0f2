"""Owns the drawn content of one mesh prim: face corners and attributes, read through usd-core."""

import dataclasses
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

from .scene_data import Array, Indices
from .usd_primvars import (
    CornerMap,
    array_of,
    carried,
    corner_colors,
    customs,
    misfits,
    points_of,
    uv_sets,
)


@dataclasses.dataclass
class LocalMesh:
    """One mesh in its own space; corners of usable faces lie one after another."""

    positions: Array
    """(n, 3) corner positions."""
    counts: Indices
    """(faces,) corners of each face."""
    materials: Indices
    """(faces,) index into `material_paths`, −1 for none."""
    material_paths: list[str]
    double_sided: bool
    flat_shaded: bool = False
    """Whether each corner has its face's normal."""
    normals: Array | None = None
    uvs: dict[str, Array] = dataclasses.field(default_factory=dict)
    colors: Array | None = None
    optional_positions: Array = dataclasses.field(default_factory=lambda: np.zeros((0, 3)))
    """(m, 3) corners of faces that may be dropped: degenerate by their indices."""
    optional_triangles: int = 0
    optional_counts: Indices = dataclasses.field(default_factory=lambda: np.zeros(0, np.int64))
    """(faces,) corners of each face that may be dropped."""
    undefined_colors: tuple[str, ...] = ()
    """Display primvars on parts whose order USD does not define: they are left out."""
    customs: dict[str, Array] = dataclasses.field(default_factory=dict)
    """Other float primvars at the corners, each (n, k), by the attribute's name."""
    misfits: tuple[str, ...] = ()
    """Primvars of which not all values are used, or none."""


def one_material(path: str | None, faces: int) -> tuple[Indices, list[str]]:
    """`materials` and `material_paths` of a mesh whose faces all have one material, or none."""
    return np.full(faces, 0 if path else -1), [path] if path else []


def read_mesh(
    prim: Usd.Prim, time: Usd.TimeCode, materials: tuple[Indices, list[str]] | None = None
) -> LocalMesh | None:
    """The mesh at `time`; None when it has no usable face (missing or broken topology)."""
    mesh = UsdGeom.Mesh(prim)
    points = points_of(mesh.GetPointsAttr(), time)
    counts = array_of(mesh.GetFaceVertexCountsAttr().Get(time), np.int64)
    indices = array_of(mesh.GetFaceVertexIndicesAttr().Get(time), np.int64)
    if not len(counts) or not len(points):
        return None
    corners = _usable_corners(mesh, time, counts, indices, points)
    positions = points[indices[corners.index]]
    face_materials, paths = materials or (np.full(len(counts), -1), [])
    scheme = mesh.GetSubdivisionSchemeAttr().Get(time) or "catmullClark"
    entries = carried(prim)
    told = {"normals"} if scheme == "none" else set()
    told |= set() if paths else {"displayColor", "displayOpacity"}
    normals = _normals(mesh, time, corners) if scheme == "none" else None
    return LocalMesh(
        positions,
        counts[corners.faces],
        face_materials[corners.faces],
        paths,
        bool(mesh.GetDoubleSidedAttr().Get(time)),
        scheme == "none" and normals is None,
        normals,
        uv_sets(entries, time, corners),
        corner_colors(prim, time, corners),
        points[indices[corners.optional_index]],
        corners.optional_triangles,
        corners.optional_counts,
        customs=customs(entries, time, corners),
        misfits=misfits(prim, entries, time, corners, told) if corners.is_whole else (),
    )


def _usable_corners(
    mesh: UsdGeom.Mesh, time: Usd.TimeCode, counts: Indices, indices: Indices, points: Array
) -> CornerMap:
    stated, authored = len(counts), len(indices)
    # Only faces before the first that does not fit the indices can be told apart.
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
        not len(broken) and len(indices) == authored,
    )


def _is_degenerate(counts: Indices, indices: Indices, points: Array, drawn: np.ndarray) -> Any:
    """Mask of faces that repeat a point or have no area, which a converter may drop."""
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
    """The same corners, with the order of every face reversed."""
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
    unit[length[:, 0] == 0.0] = (0.0, 1.0, 0.0)  # documented value for normals without a direction
    return unit
