"""UsdSkel skeletons to joints, skins and keys."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdSkel

from reflet_usd.convert.context import Context, in_float32
from reflet_usd.convert.geometry import GeometryBuilder
from reflet_usd.convert.gltf_writer import GltfWriter
from reflet_usd.convert.instancer import unit_quaternions
from reflet_usd.convert.scene import Array, Node, Skin
from reflet_usd.convert.skinning import Deformation
from reflet_usd.convert.xform import (
    align_hemispheres,
    assign,
    column_matrix,
    decompose,
    nearest_trs,
)

_PREDICATE = Usd.TraverseInstanceProxies(
    Usd.PrimIsActive & Usd.PrimIsLoaded & Usd.PrimHasDefiningSpecifier
)


@dataclass
class _Bound:
    """A gprim's skinning and the skeleton that moves it."""

    query: UsdSkel.SkinningQuery
    skeleton: Usd.Prim


class Skeletons:
    """All skeletons of one conversion; joint nodes are made once for each skeleton prim."""

    def __init__(self, context: Context, writer: GltfWriter, geometry: GeometryBuilder) -> None:
        self.context = context
        self.writer = writer
        self.geometry = geometry
        self._cache = UsdSkel.Cache()
        self._bound: dict[str, _Bound] = {}
        self._joints: dict[str, list[Node] | None] = {}
        self._attached: set[str] = set()

    def enter(self, root: Usd.Prim) -> None:
        """Find the bindings below a SkelRoot before its prims are visited."""
        skel_root = UsdSkel.Root(root)
        self._cache.Populate(skel_root, _PREDICATE)
        for binding in self._cache.ComputeSkelBindings(skel_root, _PREDICATE):
            skeleton = binding.GetSkeleton().GetPrim()
            for query in binding.GetSkinningTargets():
                self._bound[str(query.GetPrim().GetPath())] = _Bound(query, skeleton)

    def warn_ignored_binding(self, prim: Usd.Prim) -> None:
        """Name an animation that USD does not apply because the prim's API schema is missing."""
        relationship = prim.GetRelationship("skel:animationSource")
        if relationship and relationship.GetTargets() and not prim.HasAPI(UsdSkel.BindingAPI):
            message = "USD ignores skel:animationSource here, SkelBindingAPI is not applied"
            self.context.ledger.warn("skel-binding-ignored", prim, message)

    def is_bound(self, prim: Usd.Prim) -> bool:
        """Whether joints or blend shapes move this gprim."""
        return str(prim.GetPath()) in self._bound

    def is_skinned(self, prim: Usd.Prim) -> bool:
        """Whether joints move this gprim, so that its own transform does not count."""
        bound = self._bound.get(str(prim.GetPath()))
        if bound is None or not bound.query.HasJointInfluences():
            return False
        return self._joint_nodes(bound.skeleton) is not None

    def fill(self, prim: Usd.Prim, node: Node) -> None:
        """Give `node` the mesh with its skin and blend shapes."""
        bound = self._bound[str(prim.GetPath())]
        query = self._cache.GetSkelQuery(UsdSkel.Skeleton(bound.skeleton))
        skinned = self.is_skinned(prim)
        if prim.GetAttribute("points").ValueMightBeTimeVarying():
            message = "animated points of a mesh with joints or shapes stay at their first value"
            self.context.ledger.warn("points-animation-frozen", prim, message)
        deformation = Deformation(self.context, self.writer, prim, bound.query, query, skinned)
        built = self.geometry.build(prim, deformation)
        if built is None:
            return
        node.mesh = built.index
        node.extras.update(built.extras)
        deformation.animate(node)
        if skinned:
            node.skin = self._skin(bound.skeleton, query)

    def add_joints(self, prim: Usd.Prim, node: Node) -> None:
        """Place the joints of a Skeleton below its node."""
        joints = self._joint_nodes(prim)
        if joints is None:
            return
        query = self._cache.GetSkelQuery(UsdSkel.Skeleton(prim))
        topology = query.GetTopology()
        self._attached.add(str(prim.GetPath()))
        for index, joint in enumerate(joints):
            if topology.GetParent(index) < 0:
                node.add(joint)

    def unattached(self) -> list[Usd.Prim]:
        """Skeletons that move something but were not walked (below invisible prims)."""
        paths = [path for path, joints in self._joints.items() if joints is not None]
        lost = [path for path in paths if path not in self._attached]
        return [self.context.stage.GetPrimAtPath(path) for path in lost]

    def _skin(self, skeleton: Usd.Prim, query: UsdSkel.SkeletonQuery) -> Skin:
        joints = self._joint_nodes(skeleton)
        assert joints is not None
        binds = [
            column_matrix(matrix, self.context.meters_per_unit)
            for matrix in UsdSkel.Skeleton(skeleton).GetBindTransformsAttr().Get()
        ]
        return Skin(skeleton.GetName(), joints, np.linalg.inv(np.array(binds)))

    def _joint_nodes(self, prim: Usd.Prim) -> list[Node] | None:
        path = str(prim.GetPath())
        if path not in self._joints:
            self._joints[path] = self._make_joints(prim)
        return self._joints[path]

    def _make_joints(self, prim: Usd.Prim) -> list[Node] | None:
        """One node per joint with its pose and keys, parents linked; None when unusable."""
        query = self._cache.GetSkelQuery(UsdSkel.Skeleton(prim))
        if not query:
            self.context.ledger.warn("skeleton-invalid", prim, "USD cannot read the skeleton")
            return None
        names = [str(name) for name in query.GetJointOrder()]
        binds = UsdSkel.Skeleton(prim).GetBindTransformsAttr().Get()
        if not names or binds is None or len(binds) != len(names):
            count = 0 if binds is None else len(binds)
            message = f"{len(names)} joints and {count} bindTransforms make no skin"
            self.context.ledger.warn("skeleton-invalid", prim, message)
            return None
        matrices = np.array([np.array(matrix) for matrix in binds])
        if not np.isfinite(matrices).all() or (np.abs(np.linalg.det(matrices)) < 1e-30).any():
            message = "some bindTransforms cannot be inverted"
            self.context.ledger.warn("skeleton-invalid", prim, message)
            return None
        nodes = [Node(name.rsplit("/", 1)[-1], extras={"joint": name}) for name in names]
        topology = query.GetTopology()
        for index, node in enumerate(nodes):
            parent = topology.GetParent(index)
            if parent >= 0:
                nodes[parent].add(node)
        self._pose(prim, query, nodes)
        self._animate(prim, query, names, nodes)
        return nodes

    def _pose(self, prim: Usd.Prim, query: UsdSkel.SkeletonQuery, nodes: list[Node]) -> None:
        locals_ = query.ComputeJointLocalTransforms(self.context.time)
        if not locals_:
            locals_ = self._bind_pose(prim, query)
        for node, matrix in zip(nodes, locals_, strict=True):
            columns = column_matrix(matrix, self.context.meters_per_unit)
            if not np.isfinite(columns).all():
                message = f"joint {node.name} has a transform that is not finite"
                self.context.ledger.warn("transform-non-finite", prim, message)
                continue
            if decompose(columns) is None:
                message = f"joint {node.name} shears, its shear is left out"
                self.context.ledger.warn("joint-shear-dropped", prim, message)
            assign(node, nearest_trs(columns))

    def _bind_pose(self, prim: Usd.Prim, query: UsdSkel.SkeletonQuery) -> list[object]:
        """Without rest transforms and animation the bind pose stands in."""
        message = "neither restTransforms nor an animation, the bind pose is shown"
        self.context.ledger.warn("rest-pose-missing", prim, message)
        binds = list(UsdSkel.Skeleton(prim).GetBindTransformsAttr().Get())
        topology = query.GetTopology()
        result = []
        for index, matrix in enumerate(binds):
            parent = topology.GetParent(index)
            result.append(matrix if parent < 0 else matrix * binds[parent].GetInverse())
        return result

    def _animate(
        self,
        prim: Usd.Prim,
        query: UsdSkel.SkeletonQuery,
        names: list[str],
        nodes: list[Node],
    ) -> None:
        animation_query = query.GetAnimQuery()
        if not animation_query:
            return
        animation = UsdSkel.Animation(animation_query.GetPrim())
        self.context.ledger.carry(animation.GetPrim())
        order = {str(name): index for index, name in enumerate(animation_query.GetJointOrder())}
        attributes = {
            "translation": animation.GetTranslationsAttr(),
            "rotation": animation.GetRotationsAttr(),
            "scale": animation.GetScalesAttr(),
        }
        for path, attribute in attributes.items():
            keys = self._keys(prim, path, attribute, len(order))
            if keys is None:
                continue
            times, values = keys
            for name, node in zip(names, nodes, strict=True):
                if name not in order:
                    continue
                rows = values[:, order[name]]
                rows = align_hemispheres(rows) if path == "rotation" else rows
                if not np.array_equal(rows, np.broadcast_to(rows[0], rows.shape)):
                    node.add_track(path, times, rows)

    def _keys(
        self, prim: Usd.Prim, path: str, attribute: Usd.Attribute, count: int
    ) -> tuple[Array, Array] | None:
        codes = self.context.codes_in_range(sorted(attribute.GetTimeSamples()))
        if len(codes) < 2:
            return None
        keys = []
        for code in codes:
            value = attribute.Get(code)
            if value is None:  # a block: the joint's rest transform would stand here
                message = f"animated {path}s have blocked samples"
                self.context.ledger.warn("skeleton-animation-dropped", prim, message)
                return None
            if path == "rotation":
                keys.append(unit_quaternions(value))
            else:
                scale = self.context.meters_per_unit if path == "translation" else 1.0
                keys.append(np.array(value, dtype=np.float64).reshape(-1, 3) * scale)
        if any(len(key) != count or not in_float32(key).all() for key in keys):
            message = f"animated {path}s do not fit its {count} joints or are not finite"
            self.context.ledger.warn("skeleton-animation-dropped", prim, message)
            return None
        return np.array([self.context.seconds(code) for code in codes]), np.array(keys)
