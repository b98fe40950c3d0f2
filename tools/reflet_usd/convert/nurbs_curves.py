"""UsdGeomNurbsCurves evaluated as lines, with their orders, knots, ranges and weights."""

import numpy as np
from pxr import Usd

from .context import Context, authored
from .scene import Array

SEGMENTS_PER_SPAN = 8
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
        places = _places(own, count, order, chosen)
        if places is None:
            continue
        control = homogeneous[first[index] : first[index] + count]
        found = _de_boor(control, own, order, places)
        curves.append(found[:, :-1] / found[:, -1:])
        drawn.append(index)
    return curves, drawn


def _places(knots: Array, count: int, order: int, chosen: Array | None) -> Array | None:
    """Parameters of the samples; None for a curve that does not fit together."""
    if not 2 <= order <= MAX_ORDER or count < order:
        return None
    if not np.isfinite(knots).all() or (np.diff(knots) < 0.0).any():
        return None
    low, high = float(knots[order - 1]), float(knots[count])
    if chosen is not None and low <= chosen[0] < chosen[1] <= high:
        low, high = float(chosen[0]), float(chosen[1])
    if not low < high:
        return None
    breaks = np.unique(np.concatenate(([low], knots[(knots > low) & (knots < high)], [high])))
    inner = np.arange((len(breaks) - 1) * SEGMENTS_PER_SPAN + 1) / SEGMENTS_PER_SPAN
    return np.interp(inner, np.arange(len(breaks)), breaks)


def _de_boor(control: Array, knots: Array, order: int, places: Array) -> Array:
    """Points of a spline by de Boor's algorithm, from the `order` control points of each span."""
    degree = order - 1
    spans = np.clip(np.searchsorted(knots, places, side="right") - 1, degree, len(control) - 1)
    window = spans[:, None] - degree + np.arange(order)
    values = control[window]
    for level in range(1, order):
        for place in range(degree, level - 1, -1):
            low = knots[window[:, place]]
            high = knots[window[:, place] + order - level]
            width = high - low
            share = np.divide(places - low, width, out=np.zeros(len(places)), where=width > 0.0)
            values[:, place] += (1.0 - share[:, None]) * (values[:, place - 1] - values[:, place])
    return values[:, degree]
