"""UsdGeomNurbsPatch evaluated on a grid of quads."""

import itertools
from dataclasses import dataclass, replace

import numpy as np
from pxr import Usd

from .context import Context, authored
from .polygons import Polygons, read_points
from .primvars import Primvar, Topology
from .scene import Array

SEGMENTS_PER_SPAN = 8
MAX_SAMPLES = 1024


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
    if order < 2 or count < order or len(knots) != count + order:
        return None
    if not np.isfinite(knots).all() or (np.diff(knots) < 0.0).any():
        return None
    low, high = knots[order - 1], knots[count]
    chosen = authored(prim, f"{axis}Range", context.time, None)
    if chosen is not None and low <= chosen[0] < chosen[1] <= high:
        low, high = float(chosen[0]), float(chosen[1])
    if not low < high:
        return None
    breaks = np.unique(np.concatenate(([low], knots[(knots > low) & (knots < high)], [high])))
    steps = max(1, min(SEGMENTS_PER_SPAN, MAX_SAMPLES // len(breaks)))
    inner = [np.linspace(a, b, steps, endpoint=False) for a, b in itertools.pairwise(breaks)]
    return _basis(np.concatenate([*inner, [high]]), knots, order, count)


def _basis(samples: Array, knots: Array, order: int, count: int) -> Array:
    """B-spline basis by the Cox-de Boor recursion, (samples, count)."""
    spans = np.clip(np.searchsorted(knots, samples, side="right") - 1, order - 1, count - 1)
    values = np.zeros((len(samples), len(knots) - 1))
    values[np.arange(len(samples)), spans] = 1.0
    for degree in range(1, order):
        raised = np.zeros((len(samples), len(knots) - 1 - degree))
        for i in range(raised.shape[1]):
            left, right = knots[i + degree] - knots[i], knots[i + degree + 1] - knots[i + 1]
            if left > 0.0:
                raised[:, i] += (samples - knots[i]) / left * values[:, i]
            if right > 0.0:
                raised[:, i] += (knots[i + degree + 1] - samples) / right * values[:, i + 1]
        values = raised
    return values


def _grid_polygons(grid: Array, left_handed: bool) -> Polygons:
    rows, columns = grid.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    quads = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1)
    count = (rows - 1) * (columns - 1)
    drawn = np.ones(count, dtype=bool)
    return Polygons(
        grid.reshape(-1, 3), np.full(count, 4), quads.reshape(-1), drawn, left_handed, "patch"
    )
