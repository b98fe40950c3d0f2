"""Owns the truth about gprims that are not meshes: surfaces, cubes, planes, patches, tetrahedra."""

import dataclasses

import numpy as np
from pxr import Usd, UsdGeom

from .scene_data import Array, Indices, Surface
from .usd_curves import patch_corners
from .usd_material import bound_material
from .usd_mesh import LocalMesh, one_material
from .usd_primvars import (
    NO_COLOR,
    CornerMap,
    array_of,
    carried,
    corner_colors,
    customs,
    flattened,
    points_of,
    uv_sets,
)

_AXES = {"X": 0, "Y": 1, "Z": 2}
# Points and faces in the order of UsdGeomCube's mesh in Hydra, which per-face and per-point
# primvars follow (and OpenUSD's own testUsdImagingGLEmptyMesh writes out).
_CUBE_POINTS = (
    (1, 1, 1),
    (-1, 1, 1),
    (-1, -1, 1),
    (1, -1, 1),
    (-1, -1, -1),
    (-1, 1, -1),
    (1, 1, -1),
    (1, -1, -1),
)
_CUBE_FACES = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 6, 5, 1), (4, 7, 3, 2), (0, 3, 7, 6), (4, 2, 1, 5))
_PLANE_FACES = {False: ((0, 1, 2, 3),), True: ((0, 3, 2, 1),)}


def read_surface(prim: Usd.Prim, time: Usd.TimeCode, matrix: Array) -> Surface | None:
    """The curved gprims; None for other prims."""

    def number(name: str, fallback: float) -> float:
        value = prim.GetAttribute(name).Get(time) if prim.HasAttribute(name) else None
        # A negative size gives the same surface.
        return fallback if value is None else abs(float(value))

    # The prim's type, or its fallback in `fallbackPrimTypes` where USD lacks it.
    kind = str(prim.GetPrimTypeInfo().GetSchemaTypeName())
    axis = _AXES.get(str(prim.GetAttribute("axis").Get() or "Z"), 2) if kind != "Sphere" else 2
    height = 0.0
    if kind == "Sphere":
        radius = (number("radius", 1.0),) * 2
    elif kind in ("Cylinder", "Capsule"):
        radius = (number("radius", 1.0 if kind == "Cylinder" else 0.5),) * 2
        height = number("height", 2.0 if kind == "Cylinder" else 1.0)
    elif kind == "Cone":
        radius, height = (number("radius", 1.0), 0.0), number("height", 2.0)
    elif kind in ("Cylinder_1", "Capsule_1"):
        fallback = 1.0 if kind == "Cylinder_1" else 0.5
        radius = (number("radiusBottom", fallback), number("radiusTop", fallback))
        height = number("height", 2.0 * fallback)
    else:
        return None
    shape = kind.removesuffix("_1").lower()
    material = bound_material(prim)
    color, undefined = _color(prim, time)
    return Surface(shape, radius, height, axis, matrix, color, undefined, material)


def _color(prim: Usd.Prim, time: Usd.TimeCode) -> tuple[Array | None, tuple[str, ...]]:
    """Constant display color and opacity, and names of primvars with several values (ignored)."""
    api = UsdGeom.PrimvarsAPI(prim)
    names = ("displayColor", "displayOpacity")
    rgb, alpha = (
        flattened(api.FindPrimvarWithInheritance(name), time, width)
        for name, width in zip(names, (3, 1), strict=True)
    )
    if not len(rgb) and not len(alpha):
        return None, ()
    several = tuple(n for n, v in zip(names, (rgb, alpha), strict=True) if len(v) > 1)
    color = rgb[0] if len(rgb) == 1 else np.full(3, NO_COLOR)
    color = np.append(color, alpha[0] if len(alpha) == 1 else 1.0)
    return np.clip(color, 0.0, 1.0), several


def read_polyhedron(prim: Usd.Prim, time: Usd.TimeCode) -> LocalMesh | None:
    """Cubes and planes, whose corners are exact, and the boundary of tetrahedra."""
    if prim.IsA(UsdGeom.Cube):
        half = float(prim.GetAttribute("size").Get(time) or 0.0) / 2
        return _flat_mesh(prim, time, np.array(_CUBE_POINTS) * half, np.array(_CUBE_FACES))
    if prim.IsA(UsdGeom.TetMesh):
        return _boundary(prim, time)
    if not prim.IsA(UsdGeom.Plane):
        return None
    width = float(prim.GetAttribute("width").Get(time) or 0.0) / 2
    length = float(prim.GetAttribute("length").Get(time) or 0.0) / 2
    axis = _AXES[str(prim.GetAttribute("axis").Get(time) or "Z")]
    # Width runs along X (along Z for axis X); length along Y (along Z for axis Y).
    along = {0: (2, 1), 1: (0, 2), 2: (0, 1)}[axis]
    points = np.zeros((4, 3))
    points[:, along[0]] = np.array([-1, 1, 1, -1]) * width
    points[:, along[1]] = np.array([-1, -1, 1, 1]) * length
    return _flat_mesh(prim, time, points, np.array(_PLANE_FACES[axis != 2]))


def _boundary(prim: Usd.Prim, time: Usd.TimeCode) -> LocalMesh | None:
    """Boundary faces of a TetMesh; None where any is no triangle."""
    schema = UsdGeom.TetMesh(prim)
    points = points_of(schema.GetPointsAttr(), time)
    raw = schema.GetSurfaceFaceVertexIndicesAttr().Get(time)
    raw = raw if raw else UsdGeom.TetMesh.ComputeSurfaceFaces(schema, time)
    faces = array_of(raw, np.int64, 3)
    ordered = np.sort(faces, axis=1)
    whole = len(faces) and ordered[:, 0].min() >= 0 and ordered[:, 2].max() < len(points)
    if not whole or (np.diff(ordered, axis=1) == 0).any() or not np.isfinite(points).all():
        return None
    return _oriented(prim, time, points, faces)


def read_grid(prim: Usd.Prim, time: Usd.TimeCode, grid: Array) -> LocalMesh:
    """Quads between the (rows, columns, 3) points on a patch."""
    index = np.arange(grid.shape[0] * grid.shape[1]).reshape(grid.shape[:2])
    sides = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = np.stack(sides, axis=-1).reshape(-1, 4)
    result = _oriented(prim, time, grid.reshape(-1, 3), faces)
    turned = UsdGeom.Gprim(prim).GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded
    corners = patch_corners(prim, time, faces[:, ::-1] if turned else faces)
    entries = carried(prim)
    return dataclasses.replace(
        result,
        flat_shaded=False,
        colors=corner_colors(prim, time, corners),
        undefined_colors=(),
        uvs=uv_sets(entries, time, corners),
        customs=customs(entries, time, corners),
    )


def _oriented(prim: Usd.Prim, time: Usd.TimeCode, points: Array, faces: Indices) -> LocalMesh:
    turned = UsdGeom.Gprim(prim).GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded
    return _flat_mesh(prim, time, points, faces[:, ::-1] if turned else faces)


def _flat_mesh(prim: Usd.Prim, time: Usd.TimeCode, points: Array, faces: Indices) -> LocalMesh:
    color, undefined = _color(prim, time)
    colors = None if color is None else np.tile(color, (faces.size, 1))
    if prim.IsA(UsdGeom.Cube):
        colors = corner_colors(prim, time, CornerMap.whole(faces, len(points)))
        undefined = ()
    return LocalMesh(
        points[faces].reshape(-1, 3).astype(np.float64),
        np.full(len(faces), faces.shape[1]),
        *one_material(bound_material(prim), len(faces)),
        bool(UsdGeom.Gprim(prim).GetDoubleSidedAttr().Get(time)),
        flat_shaded=True,
        colors=colors,
        undefined_colors=undefined,
    )
