"""The joints of one Skeleton as nodes: rest pose, keys, and USD's matrices where they stretch."""

import functools
from dataclasses import dataclass

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdSkel

from .animation import animate_matrix
from .context import Context, in_float32
from .instancing import unit_quaternions
from .raw_trs import Parts, RawTrs, Tracks
from .scene import Array, Node
from .transform_tolerance import Reach, reach_of
from .xform import align_hemispheres, assign, column_matrix, nearest_trs, place

# Joints that stretch less than this match glTF's unit quaternions: single precision.
_STRETCH = 1e-6
# Maximum of keys times joints that are followed matrix by matrix; more would take minutes.
MAX_MATRIX_KEYS = 40_000


@dataclass
class Joints:
    """Node of each joint in the skeleton's order, and the outermost nodes, without a parent."""

    nodes: list[Node]
    roots: list[Node]


def make_joints(
    context: Context, prim: Usd.Prim, query: UsdSkel.SkeletonQuery, binds: list[Gf.Matrix4d]
) -> Joints:
    """Pose, animate and link the joints of the Skeleton `prim`."""
    return _Maker(context, prim, query, binds).make()


def carry_animation(context: Context, prim: Usd.Prim, query: UsdSkel.AnimQuery) -> None:
    """Account for the animation that moves `prim`, also under its path in a native instance."""
    context.ledger.carry(query.GetPrim())
    source = UsdSkel.BindingAPI(prim).GetInheritedAnimationSource()
    skeleton = UsdSkel.BindingAPI(prim).GetInheritedSkeleton()
    if not source and skeleton:
        source = UsdSkel.BindingAPI(skeleton.GetPrim()).GetInheritedAnimationSource()
    if source:
        context.ledger.carry(source)


@dataclass
class _Maker:
    context: Context
    prim: Usd.Prim
    query: UsdSkel.SkeletonQuery
    binds: list[Gf.Matrix4d]

    def make(self) -> Joints:
        names = [str(name) for name in self.query.GetJointOrder()]
        nodes = [Node(name.rsplit("/", 1)[-1], extras={"joint": name}) for name in names]
        outer = self._posed(nodes)
        self._animate(names, nodes, outer)
        topology = self.query.GetTopology()
        roots = []
        for index, node in enumerate(outer):
            parent = topology.GetParent(index)
            if parent >= 0:
                nodes[parent].add(node)
            else:
                roots.append(node)
        return Joints(nodes, roots)

    def _posed(self, nodes: list[Node]) -> list[Node]:
        """Place each joint; returns its outermost node: a helper above it where it shears."""
        matrices = self._rest_pose()
        if len(matrices) != len(nodes):
            matrices = self._bind_pose()
        outer = []
        for node, matrix in zip(nodes, matrices, strict=True):
            if not in_float32(matrix).all():
                message = f"joint {node.name} has a transform that is not finite"
                self.context.ledger.warn("transform-non-finite", self.prim, message)
                matrix = np.eye(4)
            outer.append(place(node, matrix))
        sheared = sum(a is not b for a, b in zip(nodes, outer, strict=True))
        if sheared:
            message = f"{sheared} joints shear, carried exactly as two nested nodes each"
            self.context.ledger.warn("shear-split", self.prim, message)
        return outer

    def _rest_pose(self) -> list[Array]:
        """USD's local matrices at the conversion's time; empty where the skeleton has no pose."""
        matrices = self.query.ComputeJointLocalTransforms(self.context.time)
        return [column_matrix(matrix, self.context.meters_per_unit) for matrix in matrices]

    def _bind_pose(self) -> list[Array]:
        """Local matrices of the bind pose, for skeletons without rest transforms and animation."""
        message = "neither restTransforms nor an animation, the bind pose is shown"
        self.context.ledger.warn("rest-pose-missing", self.prim, message)
        topology, binds = self.query.GetTopology(), self.binds
        result = []
        for index, matrix in enumerate(binds):
            parent = topology.GetParent(index)
            local = matrix if parent < 0 else matrix * binds[parent].GetInverse()
            result.append(column_matrix(local, self.context.meters_per_unit))
        return result

    def _animate(self, names: list[str], nodes: list[Node], outer: list[Node]) -> None:
        animation_query = self.query.GetAnimQuery()
        if not animation_query:
            return
        animation = UsdSkel.Animation(animation_query.GetPrim())
        carry_animation(self.context, self.prim, animation_query)
        if animation_query.JointTransformsMightBeTimeVarying() and not self._usable():
            message = "USD ignores it: translations, rotations and scales must fit its joints"
            self.context.ledger.warn("skeleton-animation-dropped", animation.GetPrim(), message)
            return
        order = {str(name): index for index, name in enumerate(animation_query.GetJointOrder())}
        attributes = {
            "translation": animation.GetTranslationsAttr(),
            "rotation": animation.GetRotationsAttr(),
            "scale": animation.GetScalesAttr(),
        }
        tracks: Tracks = {}
        for path, attribute in attributes.items():
            keys = self._keys(path, attribute, len(order))
            if keys is not None:
                tracks[path] = keys
        if not tracks:
            return
        raw = RawTrs(tracks, self._parts())
        codes, stretched = raw.codes(), raw.off_unit() > _STRETCH
        moved = [i for i, name in enumerate(names) if name in order and stretched[order[name]]]
        if moved and len(codes) * len(moved) > MAX_MATRIX_KEYS:
            self._normalize(moved, nodes, outer)
            moved = []
        reach = Reach()
        if moved:
            above = UsdGeom.Imageable(self.prim).ComputeLocalToWorldTransform(self.context.time)
            reach = reach_of(self.context, self.prim, above, own=False)
        for index, (name, node) in enumerate(zip(names, nodes, strict=True)):
            if name not in order:
                continue
            if index in moved:
                evaluate = functools.partial(raw.matrix, order[name])
                outer[index] = animate_matrix(self.context, self.prim, node, evaluate, codes, reach)
            else:
                self._add_tracks(node, tracks, order[name])

    def _normalize(self, chosen: list[int], nodes: list[Node], outer: list[Node]) -> None:
        message = "quaternions not of length 1 were normalized, there are too many to follow"
        self.context.ledger.warn("joint-rotation-normalized", self.prim, message)
        matrices = self._rest_pose()
        for index in chosen:
            assign(nodes[index], nearest_trs(matrices[index]))
            outer[index] = nodes[index]

    def _parts(self) -> Parts:
        """Animation sample at the conversion's time, in its own joint order."""
        found = self.query.GetAnimQuery().ComputeJointLocalTransformComponents(self.context.time)
        translations, rotations, scales = (np.array(values, dtype=np.float64) for values in found)
        return {
            "translation": translations.reshape(-1, 3) * self.context.meters_per_unit,
            "rotation": rotations.reshape(-1, 4),
            "scale": scales.reshape(-1, 3),
        }

    def _usable(self) -> bool:
        """Whether USD itself applies the animation's matrices."""
        return bool(self.query.GetAnimQuery().ComputeJointLocalTransforms(self.context.time))

    def _add_tracks(self, node: Node, tracks: Tracks, place_in_animation: int) -> None:
        """Exact keys, each property with its own times."""
        for path, (codes, values) in tracks.items():
            rows = values[:, place_in_animation]
            if path == "rotation":
                rows = align_hemispheres(unit_quaternions(rows))
            if not np.array_equal(rows, np.broadcast_to(rows[0], rows.shape)):
                times = np.array([self.context.seconds(code) for code in codes])
                node.add_track(path, times, rows)

    def _keys(
        self, path: str, attribute: Usd.Attribute, count: int
    ) -> tuple[list[float], Array] | None:
        """The codes and (keys, joints, components) as authored, translations in meters."""
        codes = self.context.codes_in_range(sorted(attribute.GetTimeSamples()))
        if len(codes) < 2:
            return None
        keys = []
        for code in codes:
            value = attribute.Get(code)
            if value is None:  # a blocked sample: USD would use the joint's rest transform
                message = f"animated {path}s have blocked samples"
                self.context.ledger.warn("skeleton-animation-dropped", self.prim, message)
                return None
            scale = self.context.meters_per_unit if path == "translation" else 1.0
            width = 4 if path == "rotation" else 3
            keys.append(np.array(value, dtype=np.float64).reshape(-1, width) * scale)
        if any(len(key) != count or not in_float32(key).all() for key in keys):
            message = f"animated {path}s do not fit its {count} joints or are not finite"
            self.context.ledger.warn("skeleton-animation-dropped", self.prim, message)
            return None
        return codes, np.array(keys)
