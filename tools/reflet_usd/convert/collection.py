"""Collections that neither bind a material nor link a light, kept in the node's extras."""

from collections.abc import Iterable
from typing import Any

from pxr import Usd, UsdLux

from .context import Context
from .extras import listed, property_value
from .scene import Node

_PREFIX = "collection:"
_BINDING = "material:binding:collection"
_LINKS = ("lightLink", "shadowLink", "filterLink")


def keep_collections(
    context: Context, prim: Usd.Prim, node: Node | None, names: Iterable[str]
) -> None:
    """Keep the collections among the authored `names` in `extras.collections`, or warn once.

    A collection that binds materials is carried by its bindings; one that links a light has a
    warning with the light.
    """
    found: dict[str, dict[str, Any]] = {}
    for whole_name in names:
        if not whole_name.startswith(_PREFIX):
            continue
        name, _, part = whole_name.removeprefix(_PREFIX).rpartition(":")
        if name and not _is_read(context, prim, name):
            item = prim.GetProperty(whole_name)
            value = property_value(context, item) if node is not None else None
            found.setdefault(name, {})[part] = value
    whole = {name: parts for name, parts in found.items() if None not in parts.values()}
    if whole and node is not None:
        node.extras["collections"] = whole
    dropped = [f"{_PREFIX}{name}" for name in found if name not in whole]
    if dropped:
        context.ledger.warn("attribute-dropped", prim, f"{listed(dropped)} not carried")


def _is_read(context: Context, prim: Usd.Prim, name: str) -> bool:
    if name in _LINKS and (prim.HasAPI(UsdLux.LightAPI) or prim.IsA(UsdLux.LightFilter)):
        return True
    if context.bound_collections is None:
        context.bound_collections = _bound_collections(context.stage)
    return str(prim.GetPath().AppendProperty(_PREFIX + name)) in context.bound_collections


def _bound_collections(stage: Usd.Stage) -> set[str]:
    """Paths of all collections that material bindings name."""
    found: set[str] = set()
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
        for item in prim.GetAuthoredPropertiesInNamespace(_BINDING):
            if isinstance(item, Usd.Relationship):
                found.update(str(path) for path in item.GetTargets() if path.IsPropertyPath())
    return found
