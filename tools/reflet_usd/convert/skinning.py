"""Deformation of a gprim: joint influences per vertex, and blend shapes as morph targets."""

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdSkel

from .context import Context, in_float32
from .gltf_writer import ARRAY_BUFFER, GltfWriter
from .joints import carry_animation
from .morph import morph_target
from .normals import unit_rows
from .polygons import Polygons
from .primitive import PrimitiveParts
from .scene import Array, Node
from .surface import Surface
from .xform import column_matrix

# Weight sums within this of 1 need no warning: USD does not normalize, glTF wants a sum of 1.
_WEIGHT_TOLERANCE = 2e-6


class Deformation:
    """Adds the skin and shapes of one gprim to its surface, primitives and node."""

    def __init__(
        self,
        context: Context,
        writer: GltfWriter,
        prim: Usd.Prim,
        skinning: UsdSkel.SkinningQuery,
        skeleton: UsdSkel.SkeletonQuery,
        skinned: bool,
    ) -> None:
        self.context = context
        self.writer = writer
        self.prim = prim
        self.skinning = skinning
        self.skeleton = skeleton
        self.skinned = skinned
        self.shape_names: list[str] = []
        self._influences: tuple[Array, Array] | None = None
        self._offsets: list[Array] = []
        self._normal_offsets: list[Array | None] = []
        self._bind = np.eye(4)

    def prepare(self, surface: Surface, polygons: Polygons | None) -> None:
        """Read everything for the surface's points and bake geomBindTransform into them."""
        self._read_shapes(len(surface.points))
        if not self.skinned:
            return
        self._bind = column_matrix(
            self.skinning.GetGeomBindTransform(self.context.time), self.context.meters_per_unit
        )
        linear = self._bind[:3, :3]
        surface.points = surface.points @ linear.T + self._bind[:3, 3]
        if polygons is not None:
            polygons.points = surface.points
        if abs(np.linalg.det(linear)) > 1e-30 and surface.normals is not None:
            surface.normals.values = unit_rows(surface.normals.values @ np.linalg.inv(linear))
        # USD tells a mesh's front by its own transform, which a glTF skin does not have.
        world = UsdGeom.Xformable(self.prim).ComputeLocalToWorldTransform(self.context.time)
        if world.GetDeterminant3() < 0.0:
            surface.triangles = surface.triangles[:, [0, 2, 1]]
        self._offsets = [offset @ linear.T for offset in self._offsets]
        self._normal_offsets = [
            None if offset is None else offset @ linear.T for offset in self._normal_offsets
        ]
        self._influences = self._read_influences(len(surface.points))

    def finish(self, surface: Surface, parts: PrimitiveParts, polygons: Polygons | None) -> None:
        """Add JOINTS_n, WEIGHTS_n and targets to one primitive."""
        attributes = parts.entry["attributes"]
        if self._influences is not None:
            joints, weights = self._influences
            for group in range(joints.shape[1] // 4):
                columns = slice(group * 4, group * 4 + 4)
                attributes[f"JOINTS_{group}"] = self.writer.add_accessor(
                    joints[parts.points, columns].astype(np.uint16), ARRAY_BUFFER
                )
                attributes[f"WEIGHTS_{group}"] = self.writer.add_accessor(
                    weights[parts.points, columns].astype(np.float32), ARRAY_BUFFER
                )
        if self._offsets:
            parts.entry["targets"] = [
                morph_target(self.writer, surface, parts, polygons, offsets, normals)
                for offsets, normals in zip(self._offsets, self._normal_offsets, strict=True)
            ]

    def animate(self, node: Node) -> None:
        """Give `node` the weights of its shapes and their keys."""
        animation_query = self.skeleton.GetAnimQuery() if self.skeleton else None
        if not self.shape_names or not animation_query:
            return
        order = [str(name) for name in animation_query.GetBlendShapeOrder() or []]
        columns = [order.index(name) if name in order else -1 for name in self.shape_names]
        animation = UsdSkel.Animation(animation_query.GetPrim())
        carry_animation(self.context, self.prim, animation_query)
        attribute = animation.GetBlendShapeWeightsAttr()

        def weights(time: Usd.TimeCode) -> list[float]:
            value = attribute.Get(time)
            values = [] if value is None else [float(weight) for weight in value]
            chosen = [values[c] if 0 <= c < len(values) else 0.0 for c in columns]
            if not in_float32(np.array(chosen)).all():
                message = "weights of blend shapes are not finite, taken as 0"
                self.context.ledger.warn("points-non-finite", self.prim, message)
            return [weight if in_float32(np.array(weight)) else 0.0 for weight in chosen]

        node.weights = weights(self.context.time)
        codes = self.context.codes_in_range(sorted(attribute.GetTimeSamples()))
        if len(codes) > 1:
            times = np.array([self.context.seconds(code) for code in codes])
            values = np.array([weights(Usd.TimeCode(code)) for code in codes])
            node.add_track("weights", times, values)

    def _read_influences(self, point_count: int) -> tuple[Array, Array] | None:
        """Joints and weights (N, 4 n) in the skeleton's joint order, weights summing to 1."""
        warn = self.context.ledger.warn
        width = self.skinning.GetNumInfluencesPerComponent()
        influences = self.skinning.ComputeJointInfluences(self.context.time)
        if not influences or width < 1:
            warn("skinning-invalid", self.prim, "its joint influences cannot be read")
            return None
        joints: Array = np.array(influences[0], dtype=np.int64).reshape(-1, width)
        weights: Array = np.array(influences[1], dtype=np.float64).reshape(-1, width)
        if self.skinning.IsRigidlyDeformed():
            joints, weights = (np.tile(rows[:1], (point_count, 1)) for rows in (joints, weights))
        if len(joints) != point_count or len(weights) != point_count:
            message = f"{len(joints)} joint influences do not fit {point_count} points"
            warn("skinning-invalid", self.prim, message)
            return None
        if str(self.skinning.GetSkinningMethod()) == "dualQuaternion":
            message = "dual quaternion skinning is carried as linear blend skinning"
            warn("skinning-dq-as-linear", self.prim, message)
        joints, weights = self._in_skeleton_order(joints, weights)
        weights = np.where(np.isfinite(weights) & (weights > 0.0), weights, 0.0)
        totals = weights.sum(axis=1)
        off = float(np.abs(totals - 1.0).max(initial=0.0))
        if off > _WEIGHT_TOLERANCE:
            message = f"weights that sum to other than 1 (by up to {off:.1e}) were normalized"
            warn("weights-normalized", self.prim, message)
        weights[totals <= 0.0, 0] = 1.0
        return _packed(joints, weights)

    def _in_skeleton_order(self, joints: Array, weights: Array) -> tuple[Array, Array]:
        order = [str(name) for name in self.skeleton.GetJointOrder()]
        own = self.skinning.GetJointOrder()
        count = len(order) if own is None else len(own)
        outside = (joints < 0) | (joints >= count)
        if (outside & (weights != 0.0)).any():
            message = "some joint indices name joints that do not exist, their weight is 0"
            self.context.ledger.warn("joint-index-out-of-range", self.prim, message)
        joints, weights = np.where(outside, 0, joints), np.where(outside, 0.0, weights)
        if own is None:
            return joints, weights
        positions = {name: index for index, name in enumerate(order)}
        table = np.array([positions.get(str(name), -1) for name in own], dtype=np.int64)
        mapped = table[joints]
        if ((mapped < 0) & (weights != 0.0)).any():
            message = "it names joints that its skeleton does not have, their weight is 0"
            self.context.ledger.warn("joint-index-out-of-range", self.prim, message)
        return np.maximum(mapped, 0), np.where(mapped < 0, 0.0, weights)

    def _read_shapes(self, point_count: int) -> None:
        if not self.skinning.HasBlendShapes():
            return
        order = self.skinning.GetBlendShapeOrder()
        targets = self.skinning.GetBlendShapeTargetsRel().GetTargets()
        for name, target in zip(order or [], targets, strict=False):
            shape_prim = self.context.stage.GetPrimAtPath(_proxy_path(self.prim, target))
            shape = UsdSkel.BlendShape(shape_prim) if shape_prim else None
            if not shape:
                message = f"blend shape {target} does not exist"
                self.context.ledger.warn("blend-shape-invalid", self.prim, message)
                continue
            offsets = self._dense(shape, shape.GetOffsetsAttr(), point_count)
            normals = self._dense(shape, shape.GetNormalOffsetsAttr(), point_count)
            if offsets is None and normals is None:
                message = "the blend shape has no offsets that fit"
                self.context.ledger.warn("blend-shape-invalid", shape_prim, message)
                continue
            if offsets is None:
                offsets = np.zeros((point_count, 3))
            self.context.ledger.carry(shape_prim)
            if shape.GetInbetweens():
                message = f"{len(shape.GetInbetweens())} in-between shapes are left out"
                self.context.ledger.warn("inbetween-dropped", shape_prim, message)
            self.shape_names.append(str(name))
            self._offsets.append(offsets * self.context.meters_per_unit)
            self._normal_offsets.append(normals)

    def _dense(
        self, shape: UsdSkel.BlendShape, attribute: Usd.Attribute, point_count: int
    ) -> Array | None:
        """(N, 3) offsets, zero where the shape names no point; None where nothing is authored."""
        value = attribute.Get()
        if value is None or len(value) == 0:
            return None
        values = np.array(value, dtype=np.float64).reshape(-1, 3)
        indices = shape.GetPointIndicesAttr().Get()
        rows = np.arange(len(values)) if indices is None or not len(indices) else np.array(indices)
        bad = len(rows) != len(values) or not in_float32(values).all()
        if bad or rows.min() < 0 or rows.max() >= point_count:
            message = f"'{attribute.GetName()}' does not fit the {point_count} points"
            self.context.ledger.warn("blend-shape-invalid", shape.GetPrim(), message)
            return None
        dense = np.zeros((point_count, 3))
        dense[rows] = values
        return dense


def _proxy_path(prim: Usd.Prim, target: Sdf.Path) -> Sdf.Path:
    """Path of a target of `prim`; within a native instance USD gives the path in the prototype."""
    if not prim.IsInstanceProxy():
        return target
    instance, prototype = prim, prim.GetPrimInPrototype()
    while not instance.IsInstance():
        instance, prototype = instance.GetParent(), prototype.GetParent()
    return target.ReplacePrefix(prototype.GetPath(), instance.GetPath())


def _packed(joints: Array, weights: Array) -> tuple[Array, Array]:
    """Influences with equal joints joined, strongest first, in groups of four; weights sum to 1."""
    joints, weights = joints.copy(), weights.copy()
    for later in range(1, joints.shape[1]):
        for earlier in range(later):
            same = joints[:, later] == joints[:, earlier]
            weights[same, earlier] += weights[same, later]
            weights[same, later] = 0.0
    order = np.argsort(-weights, axis=1, kind="stable")
    joints = np.take_along_axis(joints, order, 1)
    weights = np.take_along_axis(weights, order, 1)
    used = max(1, int((weights > 0.0).any(axis=0).sum()))
    missing = -used % 4
    joints = np.pad(joints[:, :used], ((0, 0), (0, missing)))
    weights = np.pad(weights[:, :used], ((0, 0), (0, missing)))
    joints[weights == 0.0] = 0
    return joints, weights / weights.sum(axis=1, keepdims=True)
