"""Levels of detail of UsdLod: which child of a root is drawn."""

from pxr import Usd, UsdGeom

ROOT, OVERRIDE = "LODRootAPI", "LODOverrideAPI"


def unshown_level(prim: Usd.Prim, time: Usd.TimeCode) -> str:
    """Message about a level of detail that is not drawn; empty for all other prims.

    The finest level is drawn, which is the first child, unless an override says otherwise.
    """
    root = prim.GetParent()
    if not root or ROOT not in root.GetAppliedSchemas():
        return ""
    levels = [child.GetName() for child in root.GetAllChildren() if child.IsA(UsdGeom.Imageable)]
    if prim.GetName() not in levels:
        return ""
    mode, index = _override(root, time)
    if mode == "allLOD":
        return ""
    shown = "" if mode == "noLOD" else levels[min(max(index, 0), len(levels) - 1)]
    if prim.GetName() == shown:
        return ""
    what = f"only '{shown}' is carried" if shown else "none is carried, by an override"
    return f"of {len(levels)} levels of detail {what}"


def _override(root: Usd.Prim, time: Usd.TimeCode) -> tuple[str, int]:
    """Mode and index of the nearest override at or above the root that gives any."""
    prim = root
    while prim and not prim.IsPseudoRoot():
        if OVERRIDE in prim.GetAppliedSchemas():
            mode = prim.GetAttribute("lod:override:mode").Get(time)
            if mode not in (None, "inherited"):
                index = prim.GetAttribute("lod:override:index").Get(time) or 0.0
                return str(mode), round(index) if mode == "indexedLOD" else 0
        prim = prim.GetParent()
    return "noOverride", 0
