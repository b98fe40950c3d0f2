"""Visible size of a transform's deviation: lever arm and scene size, from USD's bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pxr import Gf, Tf, Usd, UsdGeom

from .context import Context


@dataclass(frozen=True)
class Reach:
    """Conversion of a matrix's deviation into the deviation of corners, as a share of the scene."""

    lever: float = 0.0
    """Distance of the farthest corner from the origin, in the space before the matrix."""
    unit: float = math.inf
    """Diagonal of the scene in the space after the matrix, in the unit of translations."""

    def corner(self, linear: float, place: float) -> float:
        """Largest shift of a corner where the matrix's entries are off by this much."""
        return (linear * self.lever + place) / self.unit

    def anywhere(self) -> Reach:
        """The reach of a part of the transform, whose corners may be anywhere in the scene."""
        return Reach(self.unit, self.unit) if math.isfinite(self.unit) else self


def reach_of(context: Context, prim: Usd.Prim, above: Gf.Matrix4d, own: bool = True) -> Reach:
    """The reach of a matrix that places `prim` below `above`, its parent space in the world.

    `own=False` where the matrix places only a part, which may be anywhere in the scene.
    """
    try:
        cache = _boxes(context)
        scene = cache.ComputeWorldBound(prim.GetStage().GetPseudoRoot()).ComputeAlignedRange()
        local = cache.ComputeUntransformedBound(prim).ComputeAlignedRange()
    except Tf.ErrorException:  # a damaged prim has no bounds
        return Reach()
    scale = float(np.abs(np.array(above)[:3, :3]).max())
    if scene.IsEmpty() or not math.isfinite(scale) or scale <= 0.0:
        return Reach()
    size = scene.GetSize().GetLength()
    unit = size * context.meters_per_unit / scale
    corners = np.array([local.GetMin(), local.GetMax()]) if not local.IsEmpty() else np.zeros(1)
    lever = float(np.linalg.norm(np.abs(corners).max(axis=0))) * context.meters_per_unit
    if not math.isfinite(unit) or unit <= 0.0 or not math.isfinite(lever):
        return Reach()
    reach = Reach(lever, unit)
    return reach if own else reach.anywhere()


def _boxes(context: Context) -> UsdGeom.BBoxCache:
    if context.boxes is None:
        context.boxes = UsdGeom.BBoxCache(context.time, list(context.options.purpose))
    return context.boxes
