"""Custom properties, which no schema knows, kept in the node's extras."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, UsdSkel

from .context import Context
from .scene import Node

# Properties that other modules read, each by rules of its own.
_BINDING = (
    "skel:animationSource",
    "skel:blendShapeTargets",
    "skel:blendShapes",
    "skel:joints",
    "skel:skeleton",
)
_EXTENTS = ("extent", "extentsHint")
_SHADING = ("info", "inputs", "outputs")
_USER = "userProperties"
_MAX_VALUES = 64
_SHOWN = 8


def keep_custom_properties(
    context: Context, prim: Usd.Prim, node: Node | None, names: Iterable[str]
) -> None:
    """Keep the authored `names` outside all schemas in the node's extras, or warn once.

    Names of `userProperties:` go without that prefix to `extras.userProperties`, others to
    `extras.attributes`. Prims without a node keep none.
    """
    dropped, frozen = [], []
    for item in _custom_properties(prim, names):
        name = str(item.GetName())
        value = None
        if node is not None:
            value = property_value(context, item)
        if value is None:
            dropped.append(name)
            continue
        if isinstance(item, Usd.Attribute) and item.ValueMightBeTimeVarying():
            frozen.append(name)
        group, _, tail = name.partition(":")
        place, key = (group, tail) if group == _USER and tail else ("attributes", name)
        assert node is not None
        node.extras.setdefault(place, {})[key] = value
    parts = []
    if dropped:
        parts.append(f"{listed(dropped)} not carried")
    if frozen:
        parts.append(f"{listed(frozen)} carried with the first value only")
    if parts:
        context.ledger.warn("attribute-dropped", prim, "; ".join(parts))


def is_custom(prim: Usd.Prim, name: str) -> bool:
    """Whether no schema of `prim` knows the property, so that it cannot change what is drawn."""
    if _has_rules(prim, name):
        return False
    return bool(prim.GetPrimDefinition().GetSpecType(name) == Sdf.SpecTypeUnknown)


def _has_rules(prim: Usd.Prim, name: str) -> bool:
    """Whether names of that form are read on such prims, though no schema lists them."""
    group = name.partition(":")[0]
    if group in _SHADING:
        return bool(prim.IsA(UsdShade.NodeGraph) or prim.IsA(UsdShade.Shader))
    if group == "xformOp":
        return bool(prim.IsA(UsdGeom.Xformable))
    if group == "inbetweens":
        return bool(prim.IsA(UsdSkel.BlendShape))
    if group == "material":
        return name == "material:binding" or name.startswith("material:binding:")
    return group in ("collection", "primvars") or name in _BINDING or name in _EXTENTS


def _custom_properties(prim: Usd.Prim, names: Iterable[str]) -> Iterator[Usd.Property]:
    for name in names:
        if not is_custom(prim, name):
            continue
        item = prim.GetProperty(name)
        if isinstance(item, Usd.Attribute) and not item.HasAuthoredValue():
            continue
        yield item


def property_value(context: Context, item: Usd.Property) -> Any:
    """The property's targets or first value as JSON data; None where not plain or too long."""
    if isinstance(item, Usd.Relationship):
        targets = item.GetTargets()
        return [str(path) for path in targets] if len(targets) <= _MAX_VALUES else None
    if not isinstance(item, Usd.Attribute):  # a damaged file may name a property without having one
        return None
    return plain_value(item.Get(context.time))


def quoted(names: list[str]) -> str:
    """The first names in quotes, and the number of the others."""
    shown = ", ".join(f"'{name}'" for name in names[:_SHOWN])
    return shown + (f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else "")


def listed(names: list[str]) -> str:
    """The names as `quoted`, and the verb."""
    return f"{quoted(names)} {'is' if len(names) == 1 else 'are'}"


def plain_value(value: Any) -> Any:
    """`value` as JSON data, or None where it is not plain or too long."""
    if isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        return value if np.isfinite(value) else None
    if isinstance(value, Sdf.AssetPath):
        return value.path
    if isinstance(value, Sdf.PathExpression):
        return value.GetText()
    if isinstance(value, Sdf.TimeCode):
        value = value.GetValue()
    if isinstance(value, (Gf.Quath, Gf.Quatf, Gf.Quatd)):
        value = (*value.GetImaginary(), value.GetReal())
    try:
        array = np.array(value)
    except (TypeError, ValueError):
        return None
    if array.dtype.kind in "biuf" and array.size <= _MAX_VALUES and np.isfinite(array).all():
        return array.tolist()
    if array.dtype.kind in "US" and array.size <= _MAX_VALUES:
        return [str(entry) for entry in array.ravel()]
    return None
