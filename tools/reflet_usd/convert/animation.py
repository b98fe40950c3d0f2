"""Transforms of prims as nodes and keys: exact keys where glTF interpolates like USD."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from .context import Context
from .keyframes import Evaluate, Keys, OneNode, TwoNodes, exact_keys, remembered, sampled_keys
from .missing_xform_ops import warn_missing_ops
from .samples import seconds_of, value_codes, warn_extrapolation, with_jumps
from .scene import Array, Node
from .spline_keys import set_spline_tracks, spline_keys
from .transform_tolerance import Reach, reach_of
from .xform import Trs, align_hemispheres, assign, column_matrix, place
from .xform_op_chain import Splines, chain_of_ops

# Rounding error in the fourth column of affine matrices that are products in float64.
AFFINE_TOLERANCE = 1e-9


def transform_node(context: Context, prim: Usd.Prim) -> tuple[Node, Node, bool]:
    """The prim's node, the outermost helper above it, and whether it leaves its parent's space."""
    node = Node(prim.GetName(), str(prim.GetPath()))
    xformable = UsdGeom.Xformable(prim)
    if not xformable:
        return node, node, False
    if not xformable.GetXformOpOrderAttr().HasAuthoredValue():
        return node, node, False
    warn_missing_ops(context, prim)
    reset = xformable.GetResetXformStack()
    codes = key_codes(context, xformable)
    if len(codes) < 2:
        time = Usd.TimeCode(codes[0]) if codes else context.time
        matrix = _finite(context, prim, xformable.GetLocalTransformation(time))
        return node, _place(context, prim, node, matrix), reset
    return node, _animate(context, prim, node, xformable, codes), reset


def key_codes(context: Context, xformable: UsdGeom.Xformable) -> list[float]:
    """The kept time codes at which the local transform has samples or knots."""
    if not xformable.TransformMightBeTimeVarying():
        return []
    found = set(xformable.GetTimeSamples())
    for attribute in _splines(xformable):
        found.update(value_codes(attribute))
        warn_extrapolation(context, attribute)
    return context.codes_in_range(sorted(code for code in found if np.isfinite(code)))


def _splines(xformable: UsdGeom.Xformable) -> list[Usd.Attribute]:
    attributes = [op.GetAttr() for op in xformable.GetOrderedXformOps()]
    return [attribute for attribute in attributes if attribute.HasSpline()]


def _place(context: Context, prim: Usd.Prim, node: Node, matrix: Array) -> Node:
    outer = place(node, matrix)
    if outer is not node:
        message = "the matrix shears, carried exactly as two nested nodes"
        context.ledger.warn("shear-split", prim, message)
    return outer


def _finite(context: Context, prim: Usd.Prim, matrix: object) -> Array:
    columns = column_matrix(matrix, context.meters_per_unit)  # type: ignore[arg-type]
    x, y, z, w = columns[3].tolist()
    if not all(abs(off) <= AFFINE_TOLERANCE for off in (x, y, z, w - 1.0)):
        _make_affine(context, prim, columns)
    columns[3] = (0.0, 0.0, 0.0, 1.0)
    if np.isfinite(columns).all() and np.abs(columns).max() < 1e30:
        return columns
    message = "the transform is not finite, taken as the identity"
    context.ledger.warn("transform-non-finite", prim, message)
    return np.eye(4)


def _make_affine(context: Context, prim: Usd.Prim, columns: Array) -> None:
    """Make the matrix affine: USD divides points by w, a glTF node cannot where w varies."""
    w = columns[3, 3]
    perspective = bool(columns[3, :3].any())
    if np.isfinite(w) and w != 0.0:
        columns[:3] /= w
        if not perspective:
            return
    message = f"the matrix has the fourth column {tuple(columns[3].tolist())}"
    message += ", its perspective is left out" if perspective else ", by which nothing divides"
    context.ledger.warn("transform-projective", prim, message)


def _animate(
    context: Context, prim: Usd.Prim, node: Node, xformable: UsdGeom.Xformable, codes: list[float]
) -> Node:
    def evaluate(code: float) -> Array:
        return _finite(context, prim, xformable.GetLocalTransformation(Usd.TimeCode(code)))

    def chain(splines: Splines | None) -> Node | None:
        return chain_of_ops(context, node, xformable, splines)

    above = xformable.ComputeParentToWorldTransform(context.time)
    reach = reach_of(context, prim, above)
    return animate_matrix(context, prim, node, evaluate, codes, reach, chain)


def animate_matrix(
    context: Context,
    prim: Usd.Prim,
    node: Node,
    evaluate: Evaluate,
    codes: list[float],
    reach: Reach,
    chain: Callable[[Splines | None], Node | None] = lambda _: None,
) -> Node:
    """Let `node` follow the matrices of `evaluate`, keyed at `codes`; returns the outermost node.

    `chain` may give several nodes where no single one can follow: exact ones, else with splines.
    """
    authored = len(codes)
    evaluate = remembered(evaluate)
    codes = with_jumps(evaluate, codes)
    keys = exact_keys(evaluate, codes, OneNode(evaluate), reach)
    if keys is not None:
        return _set_tracks(context, prim, node, keys)
    outer = chain(None)
    if outer is not None:
        return outer
    spline = spline_keys(evaluate, codes, reach)
    if spline is not None:
        became = f"{len(spline.codes)} cubic keys"
        _warn_resampled(context, prim, authored, became, spline.deviation)
        return set_spline_tracks(context, node, spline)
    keys = exact_keys(evaluate, codes, TwoNodes(evaluate), reach)
    if keys is not None:
        return _set_tracks(context, prim, node, keys)
    # Other ops stand before and after a matrix of the chain: its corners may be anywhere.
    splines = Splines(reach.anywhere())
    outer = chain(splines)
    if outer is not None:
        _warn_resampled(context, prim, authored, f"{splines.keys} cubic keys", splines.deviation)
        return outer
    keys = sampled_keys(evaluate, codes, reach)
    _warn_resampled(context, prim, authored, f"{len(keys.codes)} samples", keys.deviation)
    return _set_tracks(context, prim, node, keys)


def _warn_resampled(
    context: Context, prim: Usd.Prim, authored: int, became: str, deviation: float
) -> None:
    message = f"{authored} keys became {became}, at most {deviation:.1e} of the transform's"
    message += " or the scene's size away between them"
    context.ledger.warn("animation-resampled", prim, message, deviation)


def _set_tracks(context: Context, prim: Usd.Prim, node: Node, keys: Keys) -> Node:
    """Animate the node, or the node and a helper above it; returns the outer one."""
    times = seconds_of(context, keys.codes)
    if len(keys.poses[0]) == 1:
        _set_node_tracks(node, times, [pose[0] for pose in keys.poses])
        return node
    context.ledger.warn("shear-split", prim, "the matrix shears, carried as two nested nodes")
    helper = Node(f"{node.name}_shear")
    _set_node_tracks(helper, times, [pose[0] for pose in keys.poses])
    _set_node_tracks(node, times, [pose[1] for pose in keys.poses])
    helper.add(node)
    return helper


def _set_node_tracks(node: Node, times: Array, parts: list[Trs]) -> None:
    assign(node, parts[0])
    rotations = align_hemispheres(np.array([part.rotation for part in parts]))
    channels = {
        "translation": np.array([part.translation for part in parts]),
        "rotation": rotations,
        "scale": np.array([part.scale for part in parts]),
    }
    for path, values in channels.items():
        if not np.array_equal(values, np.broadcast_to(values[0], values.shape)):
            node.add_track(path, times, values)


@dataclass(frozen=True)
class Visibility:
    """Visibility over time: each value holds from its time code to the next."""

    codes: tuple[float, ...]
    shown: tuple[bool, ...]

    def at(self, code: float) -> bool:
        """Whether the prim is shown at `code`; the first value also holds before its code."""
        return self.shown[max(bisect_right(self.codes, code) - 1, 0)]

    def within(self, outer: Visibility | None) -> Visibility:
        """Visibility of a node inside `outer`: shown where both are."""
        if outer is None:
            return self
        codes = tuple(sorted({*self.codes, *outer.codes}))
        return Visibility(codes, tuple(self.at(code) and outer.at(code) for code in codes))


def own_visibility(context: Context, prim: Usd.Prim) -> Visibility | None:
    """The prim's animated visibility; None where it has none, or where it never changes."""
    attribute = UsdGeom.Imageable(prim).GetVisibilityAttr()
    if attribute.GetNumTimeSamples() < 2:
        return None
    codes = context.codes_in_range(sorted(attribute.GetTimeSamples()))
    shown = [attribute.Get(code) != UsdGeom.Tokens.invisible for code in codes]
    return Visibility(tuple(codes), tuple(shown)) if len(set(shown)) > 1 else None


def add_visibility_track(context: Context, node: Node, visibility: Visibility | None) -> None:
    """Animate visibility through KHR_node_visibility, which only some viewers follow."""
    if visibility is not None:
        times = np.array([context.seconds(code) for code in visibility.codes])
        set_visibility(node, times, np.array(visibility.shown))


def set_visibility(node: Node, times: Array, shown: Array) -> None:
    """Show and hide `node`; one bool for each key."""
    values = shown.astype(np.uint8).reshape(-1, 1)
    node.extras["visible"] = bool(shown[0])
    node.add_track("extensions/KHR_node_visibility/visible", times, values, step=True)
