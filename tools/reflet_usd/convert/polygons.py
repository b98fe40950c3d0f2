"""Reads a UsdGeomMesh's topology and points and drops, by name, the faces that cannot be drawn."""

from dataclasses import dataclass, field

import numpy as np
from pxr import Usd, UsdGeom

from .context import Context, authored, first_value, in_float32
from .primvars import Topology
from .scene import Array

# Maximum number of corners of a face; ear clipping takes quadratic time.
MAX_FACE_CORNERS = 20_000


@dataclass
class Polygons:
    """A mesh as authored, with a mask of the faces that are drawn."""

    points: Array
    """(N, 3) float64, meters."""
    counts: Array
    """(F,) corners of each face."""
    corner_points: Array
    """(C,); the corners of faces that are not drawn may name no point."""
    drawn: Array
    """(F,) whether each face is drawn."""
    left_handed: bool
    scheme: str
    sharp_edges: Array = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """Sorted keys, see `edge_keys`, of edges over which smooth normals are not shared: creases."""
    computed_normals: bool = False
    """Whether normals follow from the points, so that they follow deformations too."""

    def topology(self) -> Topology:
        """Counts that primvars refer to."""
        faces = np.repeat(np.arange(len(self.counts)), self.counts)
        return Topology(len(self.points), len(self.counts), self.corner_points, faces)


def read_points(context: Context, prim: Usd.Prim) -> Array:
    """The (N, 3) points in meters; points that are not finite stay so.

    Where the stage begins without a value, the first later value counts.
    """
    value = authored(prim, "points", context.time, None)
    if value is None and prim.HasAttribute("points"):
        value = first_value(prim.GetAttribute("points"))
    if value is None or len(value) == 0:
        return np.zeros((0, 3))
    return np.array(value, dtype=np.float64).reshape(-1, 3) * context.meters_per_unit


def read_polygons(context: Context, prim: Usd.Prim) -> Polygons | None:
    """The mesh, or None (with a warning) where nothing of it can be drawn."""
    points = read_points(context, prim)
    counts = _integers(context, prim, "faceVertexCounts")
    corners = _integers(context, prim, "faceVertexIndices")
    if len(points) == 0 or len(counts) == 0 or len(corners) == 0:
        missing = "points" if len(points) == 0 else "faces"
        context.ledger.warn("mesh-empty", prim, f"the mesh has no {missing}")
        return None
    counts, corners = _repair_counts(context, prim, counts, corners)
    if len(corners) == 0:
        context.ledger.warn("mesh-empty", prim, "no face of the mesh can be drawn")
        return None
    drawn = _drawable(context, prim, points, counts, corners)
    _cut_holes(context, prim, drawn)
    if not drawn.any():
        context.ledger.warn("mesh-empty", prim, "no face of the mesh can be drawn")
        return None
    orientation = authored(prim, "orientation", context.time, UsdGeom.Tokens.rightHanded)
    scheme = authored(prim, "subdivisionScheme", context.time, UsdGeom.Tokens.catmullClark)
    left_handed = orientation == UsdGeom.Tokens.leftHanded
    return Polygons(points, counts, corners, drawn, left_handed, str(scheme))


def tet_polygons(context: Context, prim: Usd.Prim) -> Polygons | None:
    """The boundary of a TetMesh; a warning names the loss of its inside."""
    points = read_points(context, prim)
    faces = authored(prim, "surfaceFaceVertexIndices", context.time, None)
    if faces is None or len(faces) == 0:
        computed = UsdGeom.TetMesh.ComputeSurfaceFaces(UsdGeom.TetMesh(prim), context.time)
        faces = [] if computed is None else computed
    corners = np.array(faces, dtype=np.int64).reshape(-1)
    if len(points) == 0 or len(corners) == 0:
        context.ledger.warn("mesh-empty", prim, "the TetMesh has no points or no faces")
        return None
    counts = np.full(len(corners) // 3, 3)
    drawn = _drawable(context, prim, points, counts, corners)
    if not drawn.any():
        context.ledger.warn("mesh-empty", prim, "no face of the TetMesh can be drawn")
        return None
    message = "glTF has no tetrahedra; the boundary is carried"
    context.ledger.warn("tetrahedra-dropped", prim, message)
    left_handed = authored(prim, "orientation", context.time, None) == UsdGeom.Tokens.leftHanded
    return Polygons(points, counts, corners, drawn, left_handed, "none")


def _integers(context: Context, prim: Usd.Prim, name: str) -> Array:
    value = authored(prim, name, context.time, None)
    return np.array([] if value is None else value, dtype=np.int64)


def _repair_counts(
    context: Context, prim: Usd.Prim, counts: Array, corners: Array
) -> tuple[Array, Array]:
    """Counts and corners of the faces before the first one that does not fit the index array."""
    if counts.min() >= 0 and counts.sum() == len(corners):
        return counts, corners
    broken = np.flatnonzero(counts < 0)
    end = int(broken[0]) if len(broken) else len(counts)
    totals = np.cumsum(counts[:end])
    fitting = int(np.searchsorted(totals, len(corners), side="right"))
    if fitting < len(counts):
        message = f"{len(counts) - fitting} faces do not fit faceVertexIndices and were dropped"
        context.ledger.warn("topology-invalid", prim, message)
    elif fitting and totals[-1] < len(corners):
        message = f"{len(corners) - int(totals[-1])} indices belong to no face"
        context.ledger.warn("topology-invalid", prim, message)
    used = int(totals[fitting - 1]) if fitting else 0
    return counts[:fitting], corners[:used]


def _drawable(
    context: Context, prim: Usd.Prim, points: Array, counts: Array, corners: Array
) -> Array:
    """Mask of the faces with three corners or more, all of them finite points."""
    if _are_good_triangles(points, counts, corners) or _are_good_polygons(points, counts, corners):
        return np.ones(len(counts), dtype=bool)
    drawn = counts >= 3
    if not drawn.all():
        message = f"{int((~drawn).sum())} faces have fewer than 3 corners and were dropped"
        context.ledger.warn("face-degenerate", prim, message)
    huge = counts > MAX_FACE_CORNERS
    if huge.any():
        message = f"{int(huge.sum())} faces have more than {MAX_FACE_CORNERS} corners, dropped"
        context.ledger.warn("face-too-large", prim, message)
        drawn &= ~huge
    collapsed = _collapsed(counts, corners)
    if (collapsed & drawn).any():
        message = f"{int((collapsed & drawn).sum())} triangles have no area and were dropped"
        context.ledger.warn("face-degenerate", prim, message)
        drawn &= ~collapsed
    corner_faces = np.repeat(np.arange(len(counts)), counts)
    outside = (corners < 0) | (corners >= len(points))
    if outside.any():
        bad = np.unique(corner_faces[outside])
        drawn[bad] = False
        message = f"{len(bad)} faces name points that do not exist and were dropped"
        context.ledger.warn("index-out-of-range", prim, message)
    finite: Array = np.asarray(in_float32(points).all(axis=1))
    if not finite.all():
        safe = np.where(outside, 0, corners)
        bad = np.unique(corner_faces[~finite[safe] & ~outside])
        drawn[bad] = False
        message = f"{len(bad)} faces have points that are not finite and were dropped"
        context.ledger.warn("points-non-finite", prim, message)
    return drawn


def _are_good_triangles(points: Array, counts: Array, corners: Array) -> bool:
    """Whether all faces are triangles of three different finite points: a fast test."""
    if not (counts == 3).all() or corners.min() < 0 or corners.max() >= len(points):
        return False
    a, b, c = corners.reshape(-1, 3).T
    whole = (a != b).all() and (b != c).all() and (c != a).all()
    return bool(whole and in_float32(points).all())


def _are_good_polygons(points: Array, counts: Array, corners: Array) -> bool:
    """Whether all faces have more than three corners, all of them finite points."""
    sizes = counts.min() > 3 and counts.max() <= MAX_FACE_CORNERS
    known = corners.min() >= 0 and corners.max() < len(points)
    return bool(sizes and known and in_float32(points).all())


def _collapsed(counts: Array, corners: Array) -> Array:
    """(F,) whether a triangle repeats a point."""
    result = np.zeros(len(counts), dtype=bool)
    triangles = np.flatnonzero(counts == 3)
    first = (np.cumsum(counts) - counts)[triangles]
    a, b, c = (corners[first + offset] for offset in range(3))
    result[triangles] = (a == b) | (b == c) | (c == a)
    return result


def _cut_holes(context: Context, prim: Usd.Prim, drawn: Array) -> None:
    """Remove the faces that are holes from `drawn`."""
    indices = _integers(context, prim, "holeIndices")
    if len(indices) == 0:
        return
    inside = (indices >= 0) & (indices < len(drawn))
    if not inside.all():
        message = f"{int((~inside).sum())} hole indices name faces that do not exist"
        context.ledger.warn("index-out-of-range", prim, message)
    drawn[indices[inside]] = False
