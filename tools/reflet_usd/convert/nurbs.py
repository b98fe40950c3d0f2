"""UsdGeomNurbsPatch evaluated on a grid of quads."""

from dataclasses import dataclass, replace

import numpy as np
from pxr import Usd

from .context import Context, authored
from .nurbs_curves import SEGMENTS_PER_SPAN, spline_basis
from .polygons import Polygons, read_points
from .primvars import Primvar, Topology
from .scene import Array


@dataclass
class Patch:
    """A patch whose counts, knots and weights fit together."""

    u: Array
    """(columns, control points along u) basis values."""
    v: Array
    """(rows, control points along v) basis values."""
    weights: Array
    """(control points,), above 0."""

    @property
    def size(self) -> int:
        """The number of control points."""
        return len(self.weights)

    def evaluate(self, values: Array) -> Array:
        """Surface values (rows × columns, n) at the grid's vertices, from (control points, n)."""
        # Points run along u first (UsdGeomNurbsPatch: u is the fastest index).
        shape = (self.v.shape[1], self.u.shape[1], -1)
        weighted = np.concatenate([values * self.weights[:, None], self.weights[:, None]], axis=1)
        surface = np.einsum("av,bu,vuk->abk", self.v, self.u, weighted.reshape(shape))
        grid: Array = (surface[..., :-1] / surface[..., -1:]).reshape(-1, values.shape[1])
        return grid

    def primvar(self, primvar: Primvar) -> Primvar:
        """Primvars of the control points evaluated at the grid's vertices; others unchanged."""
        if primvar.interpolation != "vertex":
            return primvar
        return replace(primvar, values=self.evaluate(primvar.flat()[: self.size]), indices=None)


def read_patch(context: Context, prim: Usd.Prim) -> Patch | None:
    """The patch; None where its description does not fit together."""
    sizes = [int(authored(prim, f"{axis}VertexCount", context.time, 0)) for axis in "uv"]
    u, v = (_direction(context, prim, axis, size) for axis, size in zip("uv", sizes, strict=True))
    if u is None or v is None:
        return None
    count = sizes[0] * sizes[1]
    weights = np.array(authored(prim, "pointWeights", context.time, []), dtype=np.float64)
    if len(weights) != count or not (weights > 0.0).all():
        weights = np.ones(count)
    return Patch(u, v, weights)


def patch_polygons(context: Context, prim: Usd.Prim) -> Polygons | None:
    """The patch as smooth quads; None, with a warning, where its description does not fit."""
    points = read_points(context, prim)
    patch = read_patch(context, prim)
    if patch is None or len(points) != patch.size:
        context.ledger.warn("curves-invalid", prim, "orders, knots and points do not fit together")
        return None
    if not np.isfinite(points).all():
        context.ledger.warn("points-non-finite", prim, "the patch has points that are not finite")
        return None
    trims = authored(prim, "trimCurve:counts", context.time, [])
    lost = " and is untrimmed" if len(trims) else ""
    message = f"the patch became {SEGMENTS_PER_SPAN} quads for each span{lost}"
    context.ledger.warn("curves-approximated", prim, message)
    left_handed = authored(prim, "orientation", context.time, "") == "leftHanded"
    grid = patch.evaluate(points).reshape(len(patch.v), len(patch.u), 3)
    return _grid_polygons(grid, left_handed)


def patch_topology(context: Context, prim: Usd.Prim, topology: Topology) -> Topology:
    """Topology of the patch's primvars: counts of control points, refined to the grid."""
    patch = read_patch(context, prim)
    if patch is None:
        return topology
    nothing = np.zeros(0, dtype=np.int64)
    return replace(
        topology,
        refine=patch.primvar,
        authored=Topology(patch.size, 1, nothing, nothing),
        dropped=("uniform", "varying", "faceVarying"),
    )


def _direction(context: Context, prim: Usd.Prim, axis: str, count: int) -> Array | None:
    """Basis function values (samples, control points) over the visible range of one direction."""
    order = int(authored(prim, f"{axis}Order", context.time, 0))
    knots = np.array(authored(prim, f"{axis}Knots", context.time, []), dtype=np.float64)
    found = spline_basis(knots, count, order, authored(prim, f"{axis}Range", context.time, None))
    return None if found is None else np.asarray(found.toarray())


def _grid_polygons(grid: Array, left_handed: bool) -> Polygons:
    rows, columns = grid.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    quads = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1)
    count = (rows - 1) * (columns - 1)
    drawn = np.ones(count, dtype=bool)
    return Polygons(
        grid.reshape(-1, 3), np.full(count, 4), quads.reshape(-1), drawn, left_handed, "patch"
    )
