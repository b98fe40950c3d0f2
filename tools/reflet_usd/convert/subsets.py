"""Which faces of a gprim use which material: its binding and its material-bind GeomSubsets."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom, UsdShade

from reflet_usd.convert.context import Context
from reflet_usd.convert.scene import Array

_BINDING = "material:binding:"


@dataclass
class FaceGroup:
    """Faces that share one material."""

    material: Usd.Prim | None
    faces: Array | None
    """Authored face numbers; None stands for all faces."""
    subset: Usd.Prim | None = None


def bound_material(prim: Usd.Prim) -> Usd.Prim | None:
    """The material that wins for `prim`: inherited, collection and purpose bindings included."""
    material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(
        materialPurpose=UsdShade.Tokens.full
    )
    return material.GetPrim() if material else None


def warn_binding_purposes(context: Context, prim: Usd.Prim, names: Iterable[str]) -> None:
    """Name the bindings among the authored `names` that are for other purposes than `full`."""
    for name in names:
        if name.startswith(_BINDING):
            parts = name.removeprefix(_BINDING).split(":")
            purposes = parts[1:-1] if parts[0] == "collection" else parts
            if purposes and purposes[0] != UsdShade.Tokens.full:
                message = f"'{name}' is not followed, only bindings for all purposes and 'full'"
                context.ledger.warn("binding-purpose-dropped", prim, message)


def face_groups(context: Context, prim: Usd.Prim) -> list[FaceGroup]:
    """One group per material-bind subset, then one for the faces that no subset names."""
    own = bound_material(prim)
    if not prim.IsA(UsdGeom.Mesh) or not prim.GetAllChildrenNames():
        return [FaceGroup(own, None)]
    subsets = UsdGeom.Subset.GetAllGeomSubsets(UsdGeom.Imageable(prim))
    binding = []
    for subset in subsets:
        family = subset.GetFamilyNameAttr().Get(context.time)
        element = subset.GetElementTypeAttr().Get(context.time)
        if family == UsdShade.Tokens.materialBind and element in (None, UsdGeom.Tokens.face):
            binding.append(subset)
        else:
            message = f"a {element} subset of family '{family}' has no glTF counterpart"
            context.ledger.warn("subset-dropped", subset.GetPrim(), message)
    if not binding:
        return [FaceGroup(own, None)]
    return _split(context, prim, own, binding)


def _split(
    context: Context, prim: Usd.Prim, own: Usd.Prim | None, subsets: list[UsdGeom.Subset]
) -> list[FaceGroup]:
    counts = UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().Get(context.time)
    face_count = 0 if counts is None else len(counts)
    free = np.ones(face_count, dtype=bool)
    groups = []
    for subset in subsets:
        if subset.GetIndicesAttr().ValueMightBeTimeVarying():
            message = "its animated indices, and with them the bindings, stay at their first value"
            context.ledger.warn("subset-animation-frozen", subset.GetPrim(), message)
        indices = np.array(subset.GetIndicesAttr().Get(context.time) or [], dtype=np.int64)
        inside = (indices >= 0) & (indices < face_count)
        if not inside.all():
            message = f"{int((~inside).sum())} indices name faces that do not exist"
            context.ledger.warn("index-out-of-range", subset.GetPrim(), message)
        faces = np.unique(indices[inside])
        taken = faces[~free[faces]]
        if len(taken):
            message = f"{len(taken)} faces are in an earlier subset too and stay there"
            context.ledger.warn("subset-overlap", subset.GetPrim(), message)
        faces = faces[free[faces]]
        free[faces] = False
        material = bound_material(subset.GetPrim()) or own
        groups.append(FaceGroup(material, faces, subset.GetPrim()))
        context.ledger.carry(subset.GetPrim())
    if free.any():
        groups.append(FaceGroup(own, np.flatnonzero(free)))
    return groups
