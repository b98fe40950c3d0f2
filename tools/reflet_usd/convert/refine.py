"""Refines a USD mesh to a stated level: points, primvars, faces; or warns why the cage stays."""

from dataclasses import dataclass, replace

import numpy as np
from pxr import Usd, UsdGeom

from .context import Context, authored
from .polygons import Polygons
from .primvars import Primvar, Topology
from .scene import Array
from .subdiv import INFINITE, Cage, Step, edge_keys, refine_steps
from .surface import unique_rows

MAX_REFINED_FACES = 20_000_000
REFINABLE = ("catmullClark", "loop")
"""Schemes of subdivision that round a cage."""
# Creases of this sharpness stay sharp at any level (UsdGeomMesh: SHARPNESS_INFINITE).
_SHARP = 10.0


@dataclass
class Refiner:
    """The refinement of one mesh, applied to its points and primvars."""

    steps: list[Step]
    authored_topology: Topology
    counts: Array
    linear_rule: str
    """Value of faceVaryingLinearInterpolation."""

    def points(self, values: Array) -> Array:
        """Values at vertices, by the rules of the scheme."""
        for step in self.steps:
            values = step.smooth(values)
        return values

    def face_parents(self) -> Array:
        """(F,) the authored face of each refined face."""
        parents = np.arange(len(self.counts))
        for step in self.steps:
            parents = parents[step.child_faces]
        return parents

    def primvar(self, primvar: Primvar) -> Primvar:
        """The primvar on the refined mesh; its size fits the authored one."""
        kind = primvar.interpolation
        if kind == "constant":
            return primvar
        flat = primvar.flat()
        if kind == "uniform":
            return replace(primvar, values=flat[self.face_parents()], indices=None)
        if kind == "vertex":
            values = self.points(flat[: self.authored_topology.point_count])
            return replace(primvar, values=values, indices=None)
        if kind == "varying":
            values = flat[: self.authored_topology.point_count]
            for step in self.steps:
                values = step.linear(values)
            return replace(primvar, values=values, indices=None)
        corners = len(self.authored_topology.corner_points)
        return self._face_varying(primvar, flat[:corners])

    def _face_varying(self, primvar: Primvar, flat: Array) -> Primvar:
        """Refine a faceVarying primvar: corners of the same point and value join; seams part."""
        groups = unique_rows(flat)
        pairs = self.authored_topology.corner_points * (int(groups.max()) + 1) + groups
        _, first, ids = np.unique(pairs, return_index=True, return_inverse=True)
        ids = ids.reshape(-1)
        cage = Cage(self.counts, ids, len(first))
        cage.smooth_triangles = self.steps[0].cage.smooth_triangles
        cage.is_loop = self.steps[0].cage.is_loop
        cage.pin_corners = self.linear_rule != "none"
        cage.pin_boundary = self.linear_rule == "boundaries"
        if self.linear_rule in ("cornersPlus1", "cornersPlus2"):
            cage.pinned = self._crowded(first)
        values = flat[first]
        corner_ids = ids
        for step in refine_steps(cage, len(self.steps)):
            values = step.linear(values) if self.linear_rule == "all" else step.smooth(values)
            corner_ids = step.child().corners
        return replace(primvar, values=values, indices=corner_ids)

    def _crowded(self, first: Array) -> Array:
        """Mask of values at points where more than two faceVarying regions meet."""
        points = self.authored_topology.corner_points[first]
        regions = np.bincount(points, minlength=self.authored_topology.point_count)
        return regions[points] > 2


def refine_polygons(
    context: Context, prim: Usd.Prim, polygons: Polygons, level: int
) -> tuple[Polygons, Refiner | None]:
    """The mesh after `level` steps; the mesh itself, with a warning, where that is not possible."""
    if polygons.scheme not in REFINABLE:
        if polygons.scheme not in ("none", "bilinear", "patch"):
            reason = f"the scheme '{polygons.scheme}' is unknown; its smooth cage is carried"
            context.ledger.warn("subdivision-cage", prim, reason)
        return polygons, None
    reason = _why_not(context, prim, polygons, level)
    if reason:
        context.ledger.warn("subdivision-cage", prim, reason)
        corners = polygons.corner_points
        if _inside(corners, len(polygons.points)):
            cage = Cage(polygons.counts, corners, len(polygons.points))
            _read_sharpness(context, prim, cage)
            polygons.sharp_edges = _sharp_edges(cage)
        return polygons, None
    topology = polygons.topology()
    cage = Cage(polygons.counts, polygons.corner_points, len(polygons.points))
    boundary = str(authored(prim, "interpolateBoundary", context.time, "edgeAndCorner"))
    cage.pin_corners = boundary == "edgeAndCorner"
    triangles = str(authored(prim, "triangleSubdivisionRule", context.time, "catmullClark"))
    cage.smooth_triangles = triangles == UsdGeom.Tokens.smooth
    cage.is_loop = polygons.scheme == "loop"
    _read_sharpness(context, prim, cage)
    rule = str(authored(prim, "faceVaryingLinearInterpolation", context.time, "cornersPlus1"))
    refiner = Refiner(refine_steps(cage, level), topology, polygons.counts, rule)
    drawn = polygons.drawn
    if boundary == "none":
        drawn = drawn & ~_touches_boundary(refiner.steps[0])
    child = refiner.steps[-1].child()
    refined = Polygons(
        refiner.points(polygons.points),
        child.counts,
        child.corners,
        drawn[refiner.face_parents()],
        polygons.left_handed,
        polygons.scheme,
        _sharp_edges(child),
    )
    return refined, refiner


def _sharp_edges(cage: Cage) -> Array:
    """Keys of crease edges that no refinement rounds."""
    return cage.crease_keys[cage.crease_values >= _SHARP]


def _why_not(context: Context, prim: Usd.Prim, polygons: Polygons, level: int) -> str:
    if level == 0:
        return f"the {polygons.scheme} cage is carried with smooth normals; refine with --subdiv 2"
    if polygons.scheme == "loop" and (polygons.counts != 3).any():
        return "the scheme 'loop' refines triangles only; its smooth cage is carried"
    faces = int(polygons.counts.sum()) * 4 ** (level - 1)
    if faces > MAX_REFINED_FACES:
        return f"level {level} would give {faces} faces, its cage is carried"
    broken = (polygons.counts < 3).any() or not np.isfinite(polygons.points).all()
    corners = polygons.corner_points
    if broken or corners.min() < 0 or corners.max() >= len(polygons.points):
        return "its topology or points are damaged, its cage is carried"
    return ""


def _read_sharpness(context: Context, prim: Usd.Prim, cage: Cage) -> None:
    def read(name: str, dtype: type) -> Array:
        return np.array(authored(prim, name, context.time, []), dtype=dtype).reshape(-1)

    indices, lengths = read("creaseIndices", np.int64), read("creaseLengths", np.int64)
    values = read("creaseSharpnesses", np.float64)
    corners, sharpness = read("cornerIndices", np.int64), read("cornerSharpnesses", np.float64)
    if len(corners):
        fits = len(corners) == len(sharpness) and _inside(corners, cage.vertex_count)
        if fits:
            cage.corner_sharpness = np.zeros(cage.vertex_count)
            cage.corner_sharpness[corners] = _limited(sharpness)
        else:
            context.ledger.warn("crease-invalid", prim, "corner sharpness does not fit the mesh")
    if not len(indices):
        return
    valid = (lengths >= 2).all() and lengths.sum() == len(indices)
    valid = valid and _inside(indices, cage.vertex_count)
    edge_total = int((lengths - 1).sum())
    if not valid or len(values) not in (len(lengths), edge_total):
        context.ledger.warn("crease-invalid", prim, "creases do not fit the mesh")
        return
    ends = np.cumsum(lengths) - 1
    firsts = np.delete(np.arange(len(indices)), ends)
    if len(values) != edge_total:
        values = np.repeat(values, lengths - 1)
    keys = edge_keys(indices[firsts], indices[firsts + 1], cage.vertex_count)
    order = np.argsort(keys, kind="stable")
    cage.crease_keys, cage.crease_values = keys[order], _limited(values)[order]


def _limited(sharpness: Array) -> Array:
    return np.where(sharpness >= _SHARP, INFINITE, np.maximum(np.nan_to_num(sharpness), 0.0))


def _inside(indices: Array, count: int) -> bool:
    return bool(len(indices)) and bool(indices.min() >= 0) and bool(indices.max() < count)


def _touches_boundary(step: Step) -> Array:
    """(F,) whether a face has a boundary vertex; interpolateBoundary none leaves it out."""
    boundary = np.zeros(step.cage.vertex_count, dtype=bool)
    boundary[step.edges[step.edge_faces == 1].reshape(-1)] = True
    return np.logical_or.reduceat(boundary[step.cage.corners], step.starts)
