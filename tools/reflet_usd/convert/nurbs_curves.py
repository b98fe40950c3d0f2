"""UsdGeomNurbsCurves evaluated as lines, with their orders, knots, ranges and weights."""

from typing import Any

import numpy as np
from pxr import Usd

from .context import Context, authored
from .scene import Array

SEGMENTS_PER_SPAN = 8
MAX_SAMPLES = 1024
"""Maximum number of samples of a patch in each direction."""
MAX_ORDER = 32
"""Higher orders take long to evaluate, and no program writes them."""


def sample_nurbs(
    context: Context, prim: Usd.Prim, points: Array, counts: Array
) -> tuple[list[Array], list[int]]:
    """Points (n, 3) along each curve that can be drawn, and the numbers of these curves.

    Curves whose orders, knots or weights do not fit are named by one warning.
    """

    def numbers(name: str) -> Array:
        return np.array(authored(prim, name, context.time, []), dtype=np.float64).reshape(-1)

    orders, knots = numbers("order").astype(np.int64), numbers("knots")
    ranges, weights = numbers("ranges").reshape(-1, 2), numbers("pointWeights")
    if len(weights) != len(points) or not (weights > 0.0).all() or not np.isfinite(weights).all():
        weights = np.ones(len(points))
    if len(orders) != len(counts) or len(knots) != int((counts + orders).sum()):
        return [], []
    homogeneous = np.column_stack([points * weights[:, None], weights])
    first, first_knot = np.cumsum(counts) - counts, np.cumsum(counts + orders) - counts - orders
    curves: list[Array] = []
    drawn: list[int] = []
    for index, (count, order) in enumerate(zip(counts.tolist(), orders.tolist(), strict=True)):
        own = knots[first_knot[index] : first_knot[index] + count + order]
        chosen = ranges[index] if len(ranges) == len(counts) else None
        basis = spline_basis(own, count, order if order <= MAX_ORDER else 0, chosen, 1 << 30)
        if basis is None:
            continue
        found = basis @ homogeneous[first[index] : first[index] + count]
        curves.append(found[:, :-1] / found[:, -1:])
        drawn.append(index)
    return curves, drawn


def spline_basis(knots: Array, count: int, order: int, chosen: Any, most: int = MAX_SAMPLES) -> Any:
    """Sparse basis values (samples, control points); None where the parts do not fit together.

    A spline of `count` control points has samples over its visible range, which `chosen` may cut,
    as many for each span as `most` allow.
    """
    from scipy.interpolate import BSpline  # takes long, and few stages have NURBS

    if order < 2 or count < order or len(knots) != count + order:
        return None
    if not np.isfinite(knots).all() or (np.diff(knots) < 0.0).any():
        return None
    low, high = float(knots[order - 1]), float(knots[count])
    if chosen is not None and low <= chosen[0] < chosen[1] <= high:
        low, high = float(chosen[0]), float(chosen[1])
    if not low < high:
        return None
    breaks = np.unique(np.concatenate(([low], knots[(knots > low) & (knots < high)], [high])))
    steps = max(1, min(SEGMENTS_PER_SPAN, most // len(breaks)))
    inner = np.arange((len(breaks) - 1) * steps + 1) / steps
    places = np.interp(inner, np.arange(len(breaks)), breaks)
    return BSpline.design_matrix(places, knots, order - 1)
