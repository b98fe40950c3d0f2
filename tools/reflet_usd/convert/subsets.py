"""Materials of a gprim's faces: its own binding and its material-bind GeomSubsets."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom, UsdShade

from .context import Context
from .scene import Array

_BINDING = "material:binding:"
_PREVIEW = UsdShade.Tokens.preview


@dataclass
class FaceGroup:
    """Faces that share one material."""

    material: Usd.Prim | None
    faces: Array | None
    """Authored face indices; None for all faces."""
    subset: Usd.Prim | None = None


def bound_material(prim: Usd.Prim) -> Usd.Prim | None:
    """The winning material of `prim`: inherited, collection and purpose bindings included.

    Bindings for `preview` count where nothing is bound for `full` or for all purposes.
    """
    return _material_for(prim, UsdShade.Tokens.full) or _material_for(prim, _PREVIEW)


def _material_for(prim: Usd.Prim, purpose: str) -> Usd.Prim | None:
    api = UsdShade.MaterialBindingAPI(prim)
    material, _ = api.ComputeBoundMaterial(materialPurpose=purpose)
    return material.GetPrim() if material else None


def note_binding_purposes(context: Context, prim: Usd.Prim, names: Iterable[str]) -> None:
    """Warn about bindings among the authored `names` for purposes that are not followed."""
    for name in names:
        if name.startswith(_BINDING):
            parts = name.removeprefix(_BINDING).split(":")
            purposes = parts[1:-1] if parts[0] == "collection" else parts
            if purposes and purposes[0] == _PREVIEW:
                context.previewed = True
            elif purposes and purposes[0] != UsdShade.Tokens.full:
                message = f"'{name}' is for a purpose that is not followed"
                context.ledger.warn("binding-purpose-dropped", prim, message)


def _winner(context: Context, prim: Usd.Prim) -> Usd.Prim | None:
    """The bound material, with a warning where previews are bound to another one."""
    own = bound_material(prim)
    other = _material_for(prim, _PREVIEW) if own and context.previewed else None
    if own and other and own != other:
        message = f"its material for 'preview', {other.GetPath()}, is not carried"
        context.ledger.warn("binding-purpose-dropped", prim, message)
    return own


def face_groups(context: Context, prim: Usd.Prim) -> list[FaceGroup]:
    """One group per material-bind subset, then one for the faces that no subset names."""
    own = _winner(context, prim)
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
        material = _winner(context, subset.GetPrim()) or own
        groups.append(FaceGroup(material, faces, subset.GetPrim()))
        context.ledger.carry(subset.GetPrim())
    if free.any():
        groups.append(FaceGroup(own, np.flatnonzero(free)))
    return groups
