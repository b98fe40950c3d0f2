"""Ops that `xformOpOrder` names but the prim lacks: skipped, as USD does, with a warning."""

from pxr import Sdf, Usd, UsdGeom

from .context import Context, source_path
from .unreadable_values import DAMAGE

_RESET = "!resetXformStack!"
_INVERSE = "!invert!"


def skip_missing_ops(context: Context) -> None:
    """Take missing ops out of the order, in memory: some of USD's evaluations throw at them."""
    stage = context.stage
    found: list[tuple[Usd.Attribute, list[str]]] = []
    for root in (stage.GetPseudoRoot(), *stage.GetPrototypes()):
        for prim in Usd.PrimRange(root, Usd.PrimIsActive & Usd.PrimIsLoaded):
            if not _is_placed(prim):
                continue
            order = UsdGeom.Xformable(prim).GetXformOpOrderAttr()
            try:
                tokens = list(order.Get() or ())
            except DAMAGE:
                continue  # the prim's conversion warns about it
            missing = [token for token in tokens if not _is_there(prim, token)]
            if missing:
                context.missing_ops[str(prim.GetPath())] = missing
                found.append((order, [token for token in tokens if token not in missing]))
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for order, kept in found:
            if not order.GetPrim().IsInPrototype():
                order.Set(kept)
            elif (specs := order.GetPropertyStack()) and specs[0].layer.permissionToEdit:
                specs[0].default = kept  # edits in the session layer do not reach a prototype


def warn_missing_ops(context: Context, prim: Usd.Prim) -> None:
    """Warn about the missing ops of `prim`."""
    for token in context.missing_ops.get(source_path(prim), ()):
        message = f"xformOpOrder names '{token}', which is not there and is skipped"
        context.ledger.warn("xform-op-invalid", prim, message)


def _is_placed(prim: Usd.Prim) -> bool:
    return bool(prim.IsA(UsdGeom.Xformable) and prim.HasAttribute("xformOpOrder"))


def _is_there(prim: Usd.Prim, token: str) -> bool:
    name = token.removeprefix(_INVERSE)
    return token == _RESET or (
        Sdf.Path.IsValidNamespacedIdentifier(name) and bool(prim.HasAttribute(name))
    )
