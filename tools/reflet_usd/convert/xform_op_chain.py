"""One node per xformOp: keeps the exact keys of op stacks that one node's TRS cannot follow."""

import itertools
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from reflet_usd.convert.context import Context
from reflet_usd.convert.keyframes import OneNode, exact_keys, remembered
from reflet_usd.convert.samples import with_jumps
from reflet_usd.convert.scene import Array, Node
from reflet_usd.convert.spline_keys import set_spline_tracks, spline_keys
from reflet_usd.convert.transform_tolerance import Reach
from reflet_usd.convert.xform import align_hemispheres, column_matrix, place, quaternion

# glTF turns the short way between keys, so steps must stay well below half a turn.
MAX_STEP_DEG = 120.0
# Larger translations and scales are damage; the sampled transform warns about it.
MAX_LENGTH_M = 1e30
_Op = UsdGeom.XformOp
_SINGLE_AXES = {_Op.TypeRotateX: 0, _Op.TypeRotateY: 1, _Op.TypeRotateZ: 2}
# Axes from the outermost node to the innermost: rotateXYZ turns around X first.
_EULER_ORDERS = {
    _Op.TypeRotateXYZ: (2, 1, 0),
    _Op.TypeRotateXZY: (1, 2, 0),
    _Op.TypeRotateYXZ: (2, 0, 1),
    _Op.TypeRotateYZX: (0, 2, 1),
    _Op.TypeRotateZXY: (1, 0, 2),
    _Op.TypeRotateZYX: (0, 1, 2),
}


@dataclass
class Splines:
    """Bounds of the cubic keys of a chain's matrices, and the deviation that they came to."""

    reach: Reach
    keys: int = 0
    deviation: float = 0.0
    """Sum over the matrices, as a share of the transform's or the scene's size."""


def chain_of_ops(
    context: Context, node: Node, xformable: UsdGeom.Xformable, splines: Splines | None = None
) -> Node | None:
    """The outermost of nested nodes that end in `node`; None where an op cannot be exact.

    With `splines`, matrices count too where cubic keys follow them within the tolerance.
    """
    links: list[Node] = []
    static = np.eye(4)
    for op in xformable.GetOrderedXformOps():
        if not op.MightBeTimeVarying():
            static = static @ column_matrix(
                op.GetOpTransform(context.time), context.meters_per_unit
            )
            continue
        animated = _animated_links(context, node.name, op, splines)
        if animated is None:
            return None
        _append_static(links, node.name, static)
        static = np.eye(4)
        links += animated
    outer_of_last = place(node, static)
    for parent, child in itertools.pairwise(links):
        parent.add(child)
    links[-1].add(outer_of_last)
    return links[0]


def _append_static(links: list[Node], name: str, matrix: Array) -> None:
    if np.array_equal(matrix, np.eye(4)):
        return
    inner = Node(f"{name}_xform")
    outer = place(inner, matrix)
    if outer is not inner:
        outer.children.clear()
        links.append(outer)
    links.append(inner)


def _animated_links(
    context: Context, name: str, op: UsdGeom.XformOp, splines: Splines | None
) -> list[Node] | None:
    kind = op.GetOpType()
    codes = context.codes_in_range(sorted(op.GetTimeSamples()))
    if len(codes) < 2 or any(op.Get(Usd.TimeCode(code)) is None for code in codes):
        return None  # blocked samples, or a spline, which has knots instead
    if kind in _SINGLE_AXES:
        angles = np.array([_angle(op, code, None) for code in codes])
        if not np.isfinite(angles).all():
            return None
        return [
            _turning_node(context, f"{name}_{op.GetOpName()}", codes, angles, _SINGLE_AXES[kind])
        ]
    if kind in _EULER_ORDERS:
        order = _EULER_ORDERS[kind]
        if not np.isfinite(np.array([op.Get(Usd.TimeCode(code)) for code in codes])).all():
            return None
        axes = order[::-1] if op.IsInverseOp() else order
        return [
            _turning_node(
                context,
                f"{name}_{op.GetOpName()}_{'XYZ'[axis]}",
                codes,
                np.array([_angle(op, code, axis) for code in codes]),
                axis,
            )
            for axis in axes
        ]
    if kind in (_Op.TypeTranslate, _Op.TypeOrient) or (
        kind == _Op.TypeScale and not op.IsInverseOp()
    ):
        return _simple_link(context, f"{name}_{op.GetOpName()}", op, codes)
    if kind == _Op.TypeTransform and splines is not None:
        return _matrix_link(context, f"{name}_{op.GetOpName()}", op, codes, splines)
    return None


def _matrix_link(
    context: Context, name: str, op: UsdGeom.XformOp, codes: list[float], splines: Splines
) -> list[Node] | None:
    """Node whose cubic keys follow a matrix; None where the matrix shears or turns too fast."""

    @remembered
    def evaluate(code: float) -> Array:
        return column_matrix(op.GetOpTransform(Usd.TimeCode(code)), context.meters_per_unit)

    affine = (np.array([evaluate(code) for code in codes]) - np.eye(4))[:, 3]
    if affine.any() or not np.isfinite([evaluate(code) for code in codes]).all():
        return None
    keys = spline_keys(evaluate, with_jumps(evaluate, codes), splines.reach)
    if keys is None:
        return None
    splines.keys += len(keys.codes)
    splines.deviation += keys.deviation
    node = Node(name)
    set_spline_tracks(context, node, keys)
    return [node]


def _angle(op: UsdGeom.XformOp, code: float, axis: int | None) -> float:
    value = op.Get(Usd.TimeCode(code))
    degrees = float(value if axis is None else value[axis])
    return -degrees if op.IsInverseOp() else degrees


def _turning_node(
    context: Context, name: str, codes: list[float], degrees: Array, axis: int
) -> Node:
    """Rotation around one axis; keys are inserted so that each step is a short turn."""
    times, angles = [context.seconds(codes[0])], [degrees[0]]
    for index in range(1, len(codes)):
        steps = max(1, int(np.ceil(abs(degrees[index] - degrees[index - 1]) / MAX_STEP_DEG)))
        for step in range(1, steps + 1):
            share = step / steps
            code = codes[index - 1] + (codes[index] - codes[index - 1]) * share
            times.append(context.seconds(code))
            angles.append(degrees[index - 1] + (degrees[index] - degrees[index - 1]) * share)
    half = np.radians(np.array(angles)) / 2
    rotations = np.zeros((len(half), 4))
    rotations[:, axis], rotations[:, 3] = np.sin(half), np.cos(half)
    node = Node(name, rotation=rotations[0].copy())
    node.add_track("rotation", np.array(times), rotations)
    return node


def _simple_link(
    context: Context, name: str, op: UsdGeom.XformOp, codes: list[float]
) -> list[Node] | None:
    """Node of a translation, scale or quaternion op whose authored keys are glTF's keys."""
    if op.GetOpType() == _Op.TypeOrient:
        return _orienting_link(context, name, op, codes)
    values = [op.Get(Usd.TimeCode(code)) for code in codes]
    sign = -1.0 if op.IsInverseOp() else 1.0
    if op.GetOpType() == _Op.TypeTranslate:
        path, rows = "translation", np.array(values) * (sign * context.meters_per_unit)
    else:
        path, rows = "scale", np.array(values, dtype=np.float64)
    if not np.isfinite(rows).all() or np.abs(rows).max() > MAX_LENGTH_M:
        return None
    node = Node(name)
    setattr(node, path, rows[0].copy())
    times = np.array([context.seconds(code) for code in codes])
    node.add_track(path, times, rows)
    return [node]


def _orienting_link(
    context: Context, name: str, op: UsdGeom.XformOp, codes: list[float]
) -> list[Node] | None:
    """Node of a quaternion op, by USD's own matrices, whose angle is from the real part alone."""

    def evaluate(code: float) -> Array:
        return column_matrix(op.GetOpTransform(Usd.TimeCode(code)), 1.0)

    if not all(np.isfinite(evaluate(code)).all() for code in codes):
        return None
    rotations = [quaternion(evaluate(code)[:3, :3]) for code in codes]
    # USD rounds to half floats between keys of half floats; glTF need not.
    if str(op.GetTypeName()) != "quath":
        keys = exact_keys(evaluate, codes, OneNode(evaluate), Reach())
        if keys is None:
            return None
        codes, rotations = keys.codes, [pose[0].rotation for pose in keys.poses]
    rows = align_hemispheres(np.array(rotations))
    node = Node(name, rotation=rows[0].copy())
    node.add_track("rotation", np.array([context.seconds(code) for code in codes]), rows)
    return [node]
