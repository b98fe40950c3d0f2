"""One node per xformOp: keeps the exact keys of op stacks that one node's TRS cannot follow."""

import itertools
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from .context import Context
from .keyframes import OneNode, exact_keys, remembered
from .samples import with_jumps
from .scene import Array, Node
from .spline_keys import set_spline_tracks, spline_keys
from .transform_tolerance import Reach
from .xform import align_hemispheres, column_matrix, place, quaternion

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
            matrix = op.GetOpTransform(context.time)
            static = static @ column_matrix(matrix, context.meters_per_unit)
            continue
        codes = context.codes_in_range(sorted(op.GetTimeSamples()))
        animated = _AnimatedOp(context, f"{node.name}_{op.GetOpName()}", op, codes).links(splines)
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


@dataclass
class _AnimatedOp:
    """An op with keys, and the name of its node."""

    context: Context
    name: str
    op: UsdGeom.XformOp
    codes: list[float]

    def links(self, splines: Splines | None) -> list[Node] | None:
        """The nodes of the op, outermost first; None where none can be exact."""
        op, kind = self.op, self.op.GetOpType()
        values = [op.Get(Usd.TimeCode(code)) for code in self.codes]
        if len(values) < 2 or any(value is None for value in values):
            return None  # blocked samples, or a spline, which has knots instead
        sign = -1.0 if op.IsInverseOp() else 1.0
        if kind in _SINGLE_AXES or kind in _EULER_ORDERS:
            degrees = sign * np.array(values, dtype=np.float64)
            if not np.isfinite(degrees).all():
                return None
            if kind in _SINGLE_AXES:
                return [self._turning_node(self.name, degrees, _SINGLE_AXES[kind])]
            axes = _EULER_ORDERS[kind][:: int(sign)]
            return [
                self._turning_node(f"{self.name}_{'XYZ'[axis]}", degrees[:, axis], axis)
                for axis in axes
            ]
        if kind == _Op.TypeTranslate:
            rows = np.array(values) * (sign * self.context.meters_per_unit)
            return self._simple_link("translation", rows)
        if kind == _Op.TypeScale and not op.IsInverseOp():
            return self._simple_link("scale", np.array(values, dtype=np.float64))
        if kind == _Op.TypeOrient:
            return self._orienting_link()
        if kind == _Op.TypeTransform and splines is not None:
            return self._matrix_link(splines)
        return None

    def _matrix_link(self, splines: Splines) -> list[Node] | None:
        """Node whose cubic keys follow a matrix; None where the matrix shears or turns too fast."""
        evaluate = remembered(lambda code: self._matrix(code, self.context.meters_per_unit))
        matrices = np.array([evaluate(code) for code in self.codes])
        if (matrices - np.eye(4))[:, 3].any() or not np.isfinite(matrices).all():
            return None
        keys = spline_keys(evaluate, with_jumps(evaluate, self.codes), splines.reach)
        if keys is None:
            return None
        splines.keys += len(keys.codes)
        splines.deviation += keys.deviation
        node = Node(self.name)
        set_spline_tracks(self.context, node, keys)
        return [node]

    def _matrix(self, code: float, meters_per_unit: float) -> Array:
        return column_matrix(self.op.GetOpTransform(Usd.TimeCode(code)), meters_per_unit)

    def _turning_node(self, name: str, degrees: Array, axis: int) -> Node:
        """Rotation around one axis; keys are inserted so that each step is a short turn."""
        codes, context = self.codes, self.context
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

    def _simple_link(self, path: str, rows: Array) -> list[Node] | None:
        """Node of an op whose authored keys are glTF's keys."""
        if not np.isfinite(rows).all() or np.abs(rows).max() > MAX_LENGTH_M:
            return None
        return [self._keyed(path, self.codes, rows)]

    def _keyed(self, path: str, codes: list[float], rows: Array) -> Node:
        node = Node(self.name, **{path: rows[0].copy()})
        node.add_track(path, np.array([self.context.seconds(code) for code in codes]), rows)
        return node

    def _orienting_link(self) -> list[Node] | None:
        """Node of a quaternion op, by USD's own matrices: the angle is from the real part alone."""
        evaluate, codes = lambda code: self._matrix(code, 1.0), self.codes
        if not all(np.isfinite(evaluate(code)).all() for code in codes):
            return None
        rotations = [quaternion(evaluate(code)[:3, :3]) for code in codes]
        # USD rounds to half floats between keys of half floats; glTF need not.
        if str(self.op.GetTypeName()) != "quath":
            keys = exact_keys(evaluate, codes, OneNode(evaluate), Reach())
            if keys is None:
                return None
            codes, rotations = keys.codes, [pose[0].rotation for pose in keys.poses]
        return [self._keyed("rotation", codes, align_hemispheres(np.array(rotations)))]
