"""Primvars of prims that draw nothing themselves, kept in their own node's extras."""

from collections.abc import Iterable

from pxr import Usd, UsdGeom

from .context import Context
from .extras import listed, plain_value
from .scene import Node

_NAMESPACE = "primvars:"
_SKELETAL = "primvars:skel:"


def keep_loose_primvars(
    context: Context, prim: Usd.Prim, node: Node | None, names: Iterable[str]
) -> None:
    """Keep the primvars among the authored `names` of a prim that is no gprim, or warn once.

    Gprims have rules of their own, as have varying primvars of instancers.
    """
    if prim.IsA(UsdGeom.Gprim):
        return
    kept, dropped, frozen = {}, [], []
    for name in names:
        if not name.startswith(_NAMESPACE) or name.startswith(_SKELETAL):
            continue
        primvar = UsdGeom.Primvar(prim.GetAttribute(name))
        if not primvar:
            continue
        varies = primvar.GetInterpolation() != UsdGeom.Tokens.constant
        if not primvar.HasValue() or (varies and prim.IsA(UsdGeom.PointInstancer)):
            continue
        short = str(primvar.GetPrimvarName())
        value = plain_value(primvar.ComputeFlattened(context.time))
        if node is None or varies or value is None:
            dropped.append(short)
            continue
        kept[short] = value
        if primvar.ValueMightBeTimeVarying():
            frozen.append(name)
    if kept and node is not None:
        node.extras["primvars"] = kept
    if dropped:
        message = f"of its primvars {listed(dropped)} not carried, nothing here reads them"
        context.ledger.warn("primvar-dropped", prim, message)
    context.ledger.warn_frozen("primvar-animation-frozen", prim, frozen)
