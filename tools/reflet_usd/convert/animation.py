"""Transforms of prims to nodes and keys: exact keys where glTF interpolates like USD."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from pxr import Usd, UsdGeom

from reflet_usd.convert.context import Context
from reflet_usd.convert.opchain import chain_of_ops
from reflet_usd.convert.scene import Array, Node
from reflet_usd.convert.xform import (
    Trs,
    align_hemispheres,
    assign,
    column_matrix,
    decompose,
    nearest_trs,
    place,
)

# Between keys a matrix may deviate by this share of its largest entries and still be exact.
EXACT_TOLERANCE = 2e-6
SAMPLED_TOLERANCE = 1e-5
EXACT_DEPTH = 3
SAMPLED_DEPTH = 7
# Halving a step must shrink the deviation to this share, else more keys do not help (shear).
USEFUL_SHRINKAGE = 0.7
MAX_SAMPLES = 20_000
_PROBES = (0.25, 0.5, 0.75)

Evaluate = Callable[[float], Array]


def transform_node(context: Context, prim: Usd.Prim) -> tuple[Node, Node, bool]:
    """The prim's node, the outermost helper above it, and whether it leaves its parent's space."""
    node = Node(prim.GetName(), str(prim.GetPath()))
    xformable = UsdGeom.Xformable(prim)
    if not xformable:
        return node, node, False
    if not xformable.GetXformOpOrderAttr().HasAuthoredValue():
        return node, node, False
    matrix = _finite(context, prim, xformable.GetLocalTransformation(context.time))
    reset = xformable.GetResetXformStack()
    codes = key_codes(context, xformable)
    if len(codes) < 2:
        return node, _place(context, prim, node, matrix), reset
    return node, _animate(context, prim, node, xformable, codes), reset


def key_codes(context: Context, xformable: UsdGeom.Xformable) -> list[float]:
    """The kept time codes at which the local transform has samples."""
    if not xformable.TransformMightBeTimeVarying():
        return []
    codes = sorted(code for code in xformable.GetTimeSamples() if np.isfinite(code))
    return context.codes_in_range(codes)


def _place(context: Context, prim: Usd.Prim, node: Node, matrix: Array) -> Node:
    outer = place(node, matrix)
    if outer is not node:
        message = "the matrix shears, carried exactly as two nested nodes"
        context.ledger.warn("shear-split", prim, message)
    return outer


def _finite(context: Context, prim: Usd.Prim, matrix: object) -> Array:
    columns = column_matrix(matrix, context.meters_per_unit)  # type: ignore[arg-type]
    if np.isfinite(columns).all() and np.abs(columns).max() < 1e30:
        return columns
    message = "the transform is not finite, taken as the identity"
    context.ledger.warn("transform-non-finite", prim, message)
    return np.eye(4)


def _animate(
    context: Context, prim: Usd.Prim, node: Node, xformable: UsdGeom.Xformable, codes: list[float]
) -> Node:
    def evaluate(code: float) -> Array:
        return _finite(context, prim, xformable.GetLocalTransformation(Usd.TimeCode(code)))

    if context.held:
        parts = [nearest_trs(evaluate(code)) for code in codes]
        _set_tracks(context, node, codes, parts, step=True)
        return node
    exact = refine_keys(evaluate, codes, EXACT_TOLERANCE, EXACT_DEPTH)
    if exact is not None:
        _set_tracks(context, node, exact[0], exact[1])
        return node
    outer = chain_of_ops(context, node, xformable)
    if outer is not None:
        return outer
    sampled, parts, deviation = _sample(evaluate, codes)
    _set_tracks(context, node, sampled, parts)
    message = (
        f"{len(codes)} keys became {len(sampled)} samples,"
        f" at most {deviation:.1e} of the transform's size away between them"
    )
    context.ledger.warn("animation-resampled", prim, message)
    return node


def _set_tracks(
    context: Context, node: Node, codes: list[float], parts: list[Trs], step: bool = False
) -> None:
    assign(node, parts[0])
    times = np.array([context.seconds(code) for code in codes])
    rotations = align_hemispheres(np.array([part.rotation for part in parts]))
    channels = {
        "translation": np.array([part.translation for part in parts]),
        "rotation": rotations,
        "scale": np.array([part.scale for part in parts]),
    }
    for path, values in channels.items():
        if not np.array_equal(values, np.broadcast_to(values[0], values.shape)):
            node.add_track(path, times, values, step)


def interpolate(first: Trs, last: Trs, share: float) -> Trs:
    """What glTF shows between two keys: linear, and spherical linear for the rotation."""
    a, b = first.rotation, last.rotation
    dot = float(a @ b)
    if dot < 0.0:
        b, dot = -b, -dot
    angle = np.arccos(min(dot, 1.0))
    if angle < 1e-9:
        rotation = a + (b - a) * share
    else:
        rotation = (np.sin((1 - share) * angle) * a + np.sin(share * angle) * b) / np.sin(angle)
    rotation = rotation / np.linalg.norm(rotation)
    return Trs(
        first.translation + (last.translation - first.translation) * share,
        rotation,
        first.scale + (last.scale - first.scale) * share,
    )


def _deviation(trs: Trs, matrix: Array, reach: float) -> float:
    difference = np.abs(trs.matrix() - matrix)
    size = max(float(np.abs(matrix[:3, :3]).max()), 1e-30)
    return max(float(difference[:3, :3].max()) / size, float(difference[:3, 3].max()) / reach)


def _reach(evaluate: Evaluate, codes: list[float]) -> float:
    """How far the origin gets from 0: the unit in which its deviation is judged."""
    return max(max(float(np.abs(evaluate(code)[:3, 3]).max()) for code in codes), 1e-30)


def refine_keys(
    evaluate: Evaluate, codes: list[float], tolerance: float, depth: int
) -> tuple[list[float], list[Trs]] | None:
    """Keys, halved up to `depth` times, between which glTF stays within `tolerance`; else None."""
    reach = _reach(evaluate, codes)
    first = decompose(evaluate(codes[0]))
    if first is None:
        return None
    kept, parts = [codes[0]], [first]
    stack = [(a, b, 0) for a, b in itertools.pairwise(codes)][::-1]
    while stack:
        a, b, level = stack.pop()
        last = decompose(evaluate(b))
        if last is None or len(kept) > MAX_SAMPLES:
            return None
        if _worst(evaluate, a, b, parts[-1], last, reach) <= tolerance:
            kept.append(b)
            parts.append(last)
        elif level >= depth:
            return None
        else:
            middle = (a + b) / 2
            stack += [(middle, b, level + 1), (a, middle, level + 1)]
    return kept, parts


def _worst(evaluate: Evaluate, a: float, b: float, first: Trs, last: Trs, reach: float) -> float:
    return max(
        _deviation(interpolate(first, last, share), evaluate(a + (b - a) * share), reach)
        for share in _PROBES
    )


def _sample(evaluate: Evaluate, codes: list[float]) -> tuple[list[float], list[Trs], float]:
    """Keys halved until close enough, and the worst deviation that is left."""
    reach = _reach(evaluate, codes)
    kept, parts, worst = [codes[0]], [nearest_trs(evaluate(codes[0]))], 0.0
    stack = [(a, b, 0) for a, b in itertools.pairwise(codes)][::-1]
    while stack:
        a, b, level = stack.pop()
        last = nearest_trs(evaluate(b))
        error = _worst(evaluate, a, b, parts[-1], last, reach)
        full = level >= SAMPLED_DEPTH or len(kept) + len(stack) > MAX_SAMPLES
        if error <= SAMPLED_TOLERANCE or full or not _halving_helps(evaluate, a, b, error, reach):
            worst = max(worst, error)
            kept.append(b)
            parts.append(last)
        else:
            middle = (a + b) / 2
            stack += [(middle, b, level + 1), (a, middle, level + 1)]
    return kept, parts, worst


def _halving_helps(evaluate: Evaluate, a: float, b: float, error: float, reach: float) -> bool:
    middle = (a + b) / 2
    ends = [nearest_trs(evaluate(code)) for code in (a, middle, b)]
    halves = max(
        _worst(evaluate, a, middle, ends[0], ends[1], reach),
        _worst(evaluate, middle, b, ends[1], ends[2], reach),
    )
    return halves < USEFUL_SHRINKAGE * error


def add_visibility_track(context: Context, prim: Usd.Prim, node: Node) -> None:
    """Animated visibility through KHR_node_visibility, which only some viewers follow."""
    attribute = UsdGeom.Imageable(prim).GetVisibilityAttr()
    codes = context.codes_in_range(sorted(attribute.GetTimeSamples()))
    shown = [attribute.Get(code) != UsdGeom.Tokens.invisible for code in codes]
    if len(set(shown)) < 2:
        return
    times = np.array([context.seconds(code) for code in codes])
    values = np.array(shown, dtype=np.uint8).reshape(-1, 1)
    node.extras["visible"] = shown[0]
    node.add_track("extensions/KHR_node_visibility/visible", times, values, step=True)
