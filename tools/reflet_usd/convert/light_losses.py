"""Inputs of lights without a glTF field: each is named by its own warning."""

from typing import Any

from pxr import Sdf, Usd, UsdLux

from .context import Context, type_name

_LINKS = ("lightLink", "shadowLink")
_NO_SHAPING = ("RectLight", "DiskLight", "CylinderLight", "DistantLight")
# Inputs that are carried, or named by a warning of their own.
_EMISSION = (
    "inputs:color",
    "inputs:colorTemperature",
    "inputs:diffuse",
    "inputs:enableColorTemperature",
    "inputs:exposure",
    "inputs:intensity",
)
_JUDGED = frozenset(
    (
        *_EMISSION,
        "inputs:angle",
        "inputs:height",
        "inputs:length",
        "inputs:normalize",
        "inputs:radius",
        "inputs:shadow:enable",
        "inputs:shaping:cone:angle",
        "inputs:shaping:cone:softness",
        "inputs:shaping:focus",
        "inputs:shaping:ies:file",
        "inputs:specular",
        "inputs:texture:file",
        "inputs:texture:format",
        "inputs:width",
        "light:filters",
        "treatAsLine",
        "treatAsPoint",
    )
)
_JUDGED_OF_GEOMETRY = frozenset((*_EMISSION, "light:filters"))
_OTHER_NAMES = ("guideRadius", "portals")


def light_value(context: Context, prim: Usd.Prim, name: str, fallback: Any) -> Any:
    """Value of the input `name` of a light, or `fallback`."""
    attribute = prim.GetAttribute(f"inputs:{name}")
    value = attribute.Get(context.time) if attribute else None
    return fallback if value is None else value


def warn_unsupported(context: Context, prim: Usd.Prim) -> None:
    """Warn about all inputs that a punctual light or an environment does not have."""
    warn = context.ledger.warn
    _warn_reflection(context, prim)
    _warn_shape(context, prim)
    warn_links(context, prim)
    _warn_inputs(context, prim, _JUDGED)
    definition = prim.GetPrimDefinition()
    outdated = [
        attribute.GetName()
        for attribute in prim.GetAuthoredAttributes()
        if definition.GetSpecType(f"inputs:{attribute.GetName()}") != Sdf.SpecTypeUnknown
    ]
    if outdated:
        message = f"USD ignores {', '.join(outdated)}, which today are named 'inputs:...'"
        warn("light-input-outdated", prim, message)
    ies = light_value(context, prim, "shaping:ies:file", None)
    if isinstance(ies, Sdf.AssetPath) and ies.path:
        warn("light-linking-dropped", prim, "an IES profile has no counterpart")
    _warn_animated(context, prim)


def warn_geometry_light(context: Context, prim: Usd.Prim) -> None:
    """Warn about the inputs of geometry that is a light."""
    warn_links(context, prim)
    _warn_inputs(context, prim, _JUDGED_OF_GEOMETRY)
    _warn_animated(context, prim)


def _warn_animated(context: Context, prim: Usd.Prim) -> None:
    animated = [
        attribute.GetName()
        for attribute in prim.GetAuthoredAttributes()
        if attribute.GetName().startswith("inputs:") and attribute.ValueMightBeTimeVarying()
    ]
    context.ledger.warn_frozen("light-animation-frozen", prim, animated)


def _warn_inputs(context: Context, prim: Usd.Prim, judged: frozenset[str]) -> None:
    """Warn about authored light inputs that no other rule handles."""
    definition = prim.GetPrimDefinition()
    for item in prim.GetAuthoredProperties():
        name = str(item.GetName())
        known = definition.GetSpecType(name) != Sdf.SpecTypeUnknown
        of_light = name.startswith(("inputs:", "light:")) or name in _OTHER_NAMES
        if name in judged or not known or not of_light:
            continue
        if isinstance(item, Usd.Relationship):
            says = bool(item.GetTargets())
        else:
            value = item.Get(context.time)
            usual = definition.GetAttributeFallbackValue(name)
            says = item.ValueMightBeTimeVarying() or (value is not None and value != usual)
        if says:
            context.ledger.warn("light-input-dropped", prim, f"'{name}' has no counterpart")


def _warn_reflection(context: Context, prim: Usd.Prim) -> None:
    diffuse, specular = (
        float(light_value(context, prim, name, 1.0)) for name in ("diffuse", "specular")
    )
    if diffuse != specular:
        message = f"its factor for specular reflection, {specular:g}, is taken as {diffuse:g}"
        context.ledger.warn("light-specular-dropped", prim, f"{message} (diffuse)")


def _warn_shape(context: Context, prim: Usd.Prim) -> None:
    warn, kind = context.ledger.warn, type_name(prim)
    texture = light_value(context, prim, "texture:file", None)
    if kind == "RectLight" and isinstance(texture, Sdf.AssetPath) and texture.path:
        warn("light-texture-dropped", prim, f"@{texture.path}@ does not color the light")
    if kind == "CylinderLight" and UsdLux.CylinderLight(prim).GetTreatAsLineAttr().Get(
        context.time
    ):
        warn("light-line-dropped", prim, "treatAsLine is not kept, its radius counts")
    if prim.HasAPI(UsdLux.ShadowAPI) and light_value(context, prim, "shadow:enable", True) is False:
        warn("light-shadow-dropped", prim, "a glTF light cannot leave out its shadows")
    if not prim.HasAPI(UsdLux.ShapingAPI):
        return
    focus = float(light_value(context, prim, "shaping:focus", 0.0))
    if focus != 0.0:
        warn("light-shaping-dropped", prim, f"focus {focus} has no counterpart")
    cone = float(light_value(context, prim, "shaping:cone:angle", 90.0))
    if kind in _NO_SHAPING and cone < 90.0:
        warn("light-shaping-dropped", prim, f"the {kind} is not narrowed to a cone of {cone}°")


def warn_links(context: Context, prim: Usd.Prim) -> None:
    """Warn about light linking and shadow linking."""
    found = ["light:filters"] if _targets(prim, "light:filters") else []
    for link in _LINKS:
        collection = f"collection:{link}"
        lists = (f"{collection}:{part}" for part in ("includes", "excludes"))
        found += [name for name in lists if _targets(prim, name)]
        root = prim.GetAttribute(f"{collection}:includeRoot")
        if root and root.HasAuthoredValue() and root.Get() is False:
            found.append(f"{collection}:includeRoot")
        expression = prim.GetAttribute(f"{collection}:membershipExpression")
        if expression and expression.HasAuthoredValue():
            found.append(f"{collection}:membershipExpression")
    for name in found:
        context.ledger.warn("light-linking-dropped", prim, f"'{name}' has no counterpart")


def _targets(prim: Usd.Prim, name: str) -> bool:
    relationship = prim.GetRelationship(name)
    return bool(relationship and relationship.GetTargets())
