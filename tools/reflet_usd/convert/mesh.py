"""UsdGeomMesh to a `Surface`: normals by scheme, triangulation, handedness, refinement."""

from dataclasses import dataclass, replace

import numpy as np
from pxr import Usd, UsdGeom

from .context import Context
from .normals import face_area_vectors, smooth_groups, smooth_normals, unit_rows
from .polygons import Polygons
from .primvars import Primvar, Topology, read_primvar, to_stream
from .refine import refine_polygons
from .scene import Array
from .surface import Stream, Surface
from .triangulate import triangulate


@dataclass
class DrawnFaces:
    """The faces of a mesh that are drawn, compacted, with their authored corners."""

    faces: Array
    """(D,) authored face numbers."""
    corners: Array
    """(K,) authored corner numbers, in the order of `faces`."""
    counts: Array
    """(D,) corners of each face."""


def mesh_surface(
    context: Context, prim: Usd.Prim, polygons: Polygons | None, level: int
) -> tuple[Surface, Topology, Polygons] | None:
    """The surface of `polygons` without primvars; None where there are none.

    `level` Catmull-Clark steps refine subdivision meshes; triangles keep their authored face.
    """
    if polygons is None:
        return None
    refined, refiner = refine_polygons(context, prim, polygons, level)
    surface = polygons_surface(context, prim, refined)
    topology = refined.topology()
    if refiner is not None:
        surface.triangle_faces = refiner.face_parents()[surface.triangle_faces]
        original = refiner.authored_topology
        topology = replace(topology, refine=refiner.primvar, authored=original)
    return surface, topology, refined


def polygons_surface(context: Context, prim: Usd.Prim, polygons: Polygons) -> Surface:
    """Triangles and normals of the drawn faces."""
    drawn = drawn_faces(polygons)
    corner_points = polygons.corner_points[drawn.corners]
    local, face_of = triangulate(polygons.points, corner_points, drawn.counts)
    triangles = drawn.corners[local]
    if polygons.left_handed:
        triangles = triangles[:, [0, 2, 1]]
    surface = Surface(polygons.points, polygons.corner_points, triangles, drawn.faces[face_of])
    surface.normals = _normals(context, prim, polygons, drawn)
    return surface


def drawn_faces(polygons: Polygons) -> DrawnFaces:
    """The faces that are drawn, compacted."""
    if polygons.drawn.all():
        corners = np.arange(len(polygons.corner_points))
        return DrawnFaces(np.arange(len(polygons.counts)), corners, polygons.counts)
    faces = np.flatnonzero(polygons.drawn)
    corner_drawn = np.repeat(polygons.drawn, polygons.counts)
    return DrawnFaces(faces, np.flatnonzero(corner_drawn), polygons.counts[faces])


def _normals(context: Context, prim: Usd.Prim, polygons: Polygons, drawn: DrawnFaces) -> Stream:
    """Authored normals where the scheme is `none`; else flat or smooth ones (UsdGeomMesh)."""
    if polygons.scheme == "none":
        authored = _authored_normals(context, prim, polygons)
        if authored is not None:
            return authored
    polygons.computed_normals = True
    return computed_normals(polygons, polygons.points, drawn)


def is_smooth(polygons: Polygons) -> bool:
    """Whether faces share the normals at a point."""
    return polygons.scheme not in ("none", "bilinear")


def computed_normals(polygons: Polygons, points: Array, drawn: DrawnFaces) -> Stream:
    """Normals from `points` over the drawn faces: faceted or smooth as the scheme says."""
    corner_points = polygons.corner_points[drawn.corners]
    areas = face_area_vectors(points, corner_points, drawn.counts)
    if polygons.left_handed:
        areas = -areas
    if is_smooth(polygons):
        if len(polygons.sharp_edges):
            groups = smooth_groups(corner_points, drawn.counts, len(points), polygons.sharp_edges)
            values = smooth_normals(groups, drawn.counts, areas, int(groups.max()) + 1)
            ids = np.zeros(len(polygons.corner_points), dtype=np.int64)
            ids[drawn.corners] = groups
            return Stream(values, ids, by_point=False)
        values = smooth_normals(corner_points, drawn.counts, areas, len(points))
        return Stream(values, polygons.corner_points, by_point=True)
    ids = np.zeros(len(polygons.corner_points), dtype=np.int64)
    ids[drawn.corners] = np.repeat(np.arange(len(drawn.faces)), drawn.counts)
    return Stream(unit_rows(areas), ids, by_point=False)


def _authored_normals(context: Context, prim: Usd.Prim, polygons: Polygons) -> Stream | None:
    """Authored normals: `primvars:normals` wins over attribute `normals` (UsdGeomPointBased)."""
    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("normals")
    read: Primvar | None = None
    if primvar and primvar.HasValue():
        read = read_primvar(context, prim, primvar)
    else:
        mesh = UsdGeom.PointBased(prim)
        value = mesh.GetNormalsAttr().Get(context.time)
        if value is not None and len(value):
            values = np.array(value, dtype=np.float64)
            if not np.isfinite(values).all():
                values = np.nan_to_num(values, posinf=0.0, neginf=0.0)
            read = Primvar("normals", str(mesh.GetNormalsInterpolation()), values, None)
    if read is None or len(read.values) == 0:
        return None
    if read.values.shape[1] != 3:
        message = f"'normals' have elements of {read.values.shape[1]} numbers, left out"
        context.ledger.warn("primvar-size-wrong", prim, message)
        return None
    stream = to_stream(context, prim, read, polygons.topology())
    if stream is None:
        return None
    if not (np.abs(stream.values).max(axis=1, initial=0.0) > 0.0).all():
        message = "some authored normals have no direction, taken as +Y"
        context.ledger.warn("normal-zero", prim, message)
    stream.values = unit_rows(stream.values)
    return stream
