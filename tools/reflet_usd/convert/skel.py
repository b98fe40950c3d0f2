"""UsdSkel skeletons to joints, skins and keys."""

from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdSkel

from .context import Context, in_float32
from .geometry import GeometryBuilder, is_surface
from .gltf_writer import GltfWriter
from .joints import Joints, make_joints
from .scene import Array, Node, Skin
from .skinning import Deformation
from .xform import column_matrix

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
        self._joints: dict[str, Joints | None] = {}
        self._attached: set[str] = set()

    def enter(self, root: Usd.Prim) -> None:
        """Find the bindings below a SkelRoot before its prims are visited."""
        skel_root = UsdSkel.Root(root)
        self._cache.Populate(skel_root, _PREDICATE)
        for binding in self._cache.ComputeSkelBindings(skel_root, _PREDICATE):
            skeleton = binding.GetSkeleton().GetPrim()
            for query in binding.GetSkinningTargets():
                if not is_surface(query.GetPrim()):
                    message = (
                        f"only surfaces are skinned, the {query.GetPrim().GetTypeName()} rests"
                    )
                    self.context.ledger.warn("skinning-invalid", query.GetPrim(), message)
                    continue
                self._bound[str(query.GetPrim().GetPath())] = _Bound(query, skeleton)

    def warn_ignored_binding(self, prim: Usd.Prim) -> None:
        """Warn about an animation that USD ignores because the prim's API schema is missing."""
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
        return self._joints_of(bound.skeleton) is not None

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
            node.skin = self._skin(bound.skeleton)

    def add_joints(self, prim: Usd.Prim, node: Node) -> None:
        """Place the joints of a Skeleton below its node."""
        joints = self._joints_of(prim)
        if joints is None:
            return
        self._attached.add(str(prim.GetPath()))
        for root in joints.roots:
            node.add(root)

    def unattached(self) -> list[Usd.Prim]:
        """Skeletons that move something but were not walked (below invisible prims)."""
        paths = [path for path, joints in self._joints.items() if joints is not None]
        lost = [path for path in paths if path not in self._attached]
        return [self.context.stage.GetPrimAtPath(path) for path in lost]

    def _skin(self, skeleton: Usd.Prim) -> Skin:
        joints = self._joints_of(skeleton)
        assert joints is not None
        binds = [
            column_matrix(matrix, self.context.meters_per_unit)
            for matrix in UsdSkel.Skeleton(skeleton).GetBindTransformsAttr().Get()
        ]
        return Skin(skeleton.GetName(), joints.nodes, np.linalg.inv(np.array(binds)))

    def _joints_of(self, prim: Usd.Prim) -> Joints | None:
        path = str(prim.GetPath())
        if path not in self._joints:
            self._joints[path] = self._make_joints(prim)
        return self._joints[path]

    def _make_joints(self, prim: Usd.Prim) -> Joints | None:
        """Joints with pose and keys; None, with a warning, where the skeleton is unusable."""
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
        if not np.isfinite(matrices).all() or not _invertible(matrices):
            message = "some bindTransforms cannot be inverted"
            self.context.ledger.warn("skeleton-invalid", prim, message)
            return None
        return make_joints(self.context, prim, query, list(binds))


def _invertible(matrices: Array) -> bool:
    """Whether all matrices have an inverse within single precision's range."""
    if (np.abs(np.linalg.det(matrices)) < 1e-30).any():
        return False
    return bool(in_float32(np.linalg.inv(matrices)).all())
