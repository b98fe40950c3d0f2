"""Owns the repair of xformOps that usd-core cannot evaluate: ops that are missing or broken.

usd-core's cache of transforms throws at them, so they are taken out of the order, in memory.
"""

from collections.abc import Collection

from pxr import Sdf, Tf, Usd, UsdGeom, Vt

from .checks import Checks
from .usd_skel import split_instances

_RESET = "!resetXformStack!"
_INVERSE = "!invert!"
SKIPPED = ("xform-op-invalid",)
"""Warning about an op that the order names but the prim lacks."""


def repair_ops(stage: Usd.Stage) -> dict[str, list[str]]:
    """Take out ops that cannot be evaluated; returns the missing ops by prim."""
    missing: dict[str, list[str]] = {}
    predicate = Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsLoaded)
    broken: dict[str, list[str]] = {}
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), predicate):
        order = prim.GetAttribute("xformOpOrder") if prim.IsA(UsdGeom.Xformable) else None
        tokens = order.Get() if order else None
        if not isinstance(tokens, Vt.TokenArray):
            continue
        absent = [token for token in tokens if token != _RESET and not _attribute(prim, token)]
        good = [t for t in tokens if t == _RESET or (t not in absent and _works(prim, t))]
        if absent:
            missing[str(prim.GetPath())] = absent
        if len(good) < len(tokens):
            broken[str(prim.GetPath())] = good
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for path in broken:
            split_instances(stage, path)
        for path, good in broken.items():
            prim = stage.GetPrimAtPath(path)
            if prim and not prim.IsInstanceProxy():
                prim.GetAttribute("xformOpOrder").Set(good)
    return missing


def compare_ops(checks: Checks, missing: dict[str, list[str]], placed: Collection[str]) -> None:
    """Check that a warning names every missing op, at the prims that the file places."""
    for path in sorted(missing.keys() & set(placed)):
        for token in missing[path]:
            checks.add_lost(path, SKIPPED, f"the op '{token}'", token)


def _attribute(prim: Usd.Prim, token: str) -> Usd.Attribute | None:
    name = token.removeprefix(_INVERSE)
    valid = bool(name) and Sdf.Path.IsValidNamespacedIdentifier(name)
    return (prim.GetAttribute(name) or None) if valid else None


def _works(prim: Usd.Prim, token: str) -> bool:
    try:
        op = UsdGeom.XformOp(_attribute(prim, token))
        op.GetOpTransform(Usd.TimeCode.EarliestTime())
    except Tf.ErrorException:
        return False
    return bool(op)
