"""UsdLux lights to KHR_lights_punctual, with the energy each conversion keeps.

L is the radiance `intensity · 2^exposure`, read as nits. Sources of the factors: UsdLux's
documentation of `normalize` and of `inputs:angle`; KHR_lights_punctual's units (lux, candela).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdLux

from reflet_usd.convert.context import Context, in_float32
from reflet_usd.convert.gltf_writer import GltfWriter
from reflet_usd.convert.scene import Array, Node

_LINKS = ("lightLink", "shadowLink")
_OUTDATED = (
    "intensity",
    "exposure",
    "color",
    "normalize",
    "radius",
    "width",
    "height",
    "length",
    "angle",
    "texture:file",
    "enableColorTemperature",
    "colorTemperature",
)
_NO_SHAPING = ("RectLight", "DiskLight", "CylinderLight", "DistantLight")
_SMALLEST_CONE = 1e-3
# KHR_lights_punctual's cone falloff with inner angle 0 and outer angle 90° is cos²θ, which
# integrates to 2π/3 over the hemisphere.
_COSINE_SQUARED_SR = 2.0 * math.pi / 3.0


@dataclass
class _Source:
    """A light's emission before its shape is known."""

    radiance: float
    color: Array
    normalize: bool


def light_value(context: Context, prim: Usd.Prim, name: str, fallback: Any) -> Any:
    """The input `name` of a light, or `fallback`."""
    attribute = prim.GetAttribute(f"inputs:{name}")
    value = attribute.Get(context.time) if attribute else None
    return fallback if value is None else value


def add_light(context: Context, writer: GltfWriter, prim: Usd.Prim, node: Node) -> None:
    """Give `node` the light of `prim`, or keep it in extras where it is an environment."""
    source = _emission(context, prim)
    _warn_unsupported(context, prim)
    kind = prim.GetTypeName()
    if kind in ("DomeLight", "DomeLight_1"):
        _keep_dome(context, prim, node, source)
        return
    entry = _punctual(context, prim, source)
    if entry is None:
        message = f"a {kind} has no glTF counterpart"
        context.ledger.warn("light-dropped", prim, message)
        return
    brightest = float(source.color.max())
    entry["color"] = (source.color / brightest if brightest > 0.0 else source.color).tolist()
    entry["intensity"] *= brightest
    if not in_float32(np.array(entry["intensity"])):
        context.ledger.warn("light-invalid", prim, "its intensity is not finite, taken as 0")
        entry["intensity"] = 0.0
    entry["name"] = prim.GetName()
    entry["extras"] = {**entry.get("extras", {}), "prim": str(prim.GetPath())}
    node.light = writer.add("lights", entry)


def _emission(context: Context, prim: Usd.Prim) -> _Source:
    intensity = float(light_value(context, prim, "intensity", 1.0))
    exposure = float(light_value(context, prim, "exposure", 0.0))
    color = np.array(light_value(context, prim, "color", (1.0, 1.0, 1.0)), dtype=np.float64)
    if light_value(context, prim, "enableColorTemperature", False):
        kelvin = float(light_value(context, prim, "colorTemperature", 6500.0))
        color = color * np.array(UsdLux.BlackbodyTemperatureAsRgb(kelvin))
    # glTF's one factor; equal ones for diffuse and specular reflection scale the whole light.
    diffuse = float(light_value(context, prim, "diffuse", 1.0))
    with np.errstate(over="ignore"):
        radiance = intensity * float(np.exp2(np.float64(exposure))) * diffuse
    if not math.isfinite(radiance) or not np.isfinite(color).all():
        context.ledger.warn("light-invalid", prim, "its emission is not finite, taken as 0")
        radiance, color = 0.0, np.ones(3)
    if radiance < 0.0 or (color < 0.0).any():
        context.ledger.warn("light-invalid", prim, "its emission is negative, taken as 0")
        radiance, color = max(radiance, 0.0), np.maximum(color, 0.0)
    return _Source(radiance, color, bool(light_value(context, prim, "normalize", False)))


def _world_scale(prim: Usd.Prim, time: Usd.TimeCode) -> float:
    """How much the light's shape grows on its way to world space (the cube root of volume)."""
    matrix = np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(time))[:3, :3]
    volume = abs(float(np.linalg.det(matrix)))
    return volume ** (1.0 / 3.0) if math.isfinite(volume) else 1.0


def _punctual(context: Context, prim: Usd.Prim, source: _Source) -> dict[str, Any] | None:
    kind = prim.GetTypeName()
    radiance, normalize = source.radiance, source.normalize
    scale = context.meters_per_unit * _world_scale(prim, context.time)

    def meters(name: str, fallback: float) -> float:
        length = abs(float(light_value(context, prim, name, fallback))) * scale
        if not in_float32(np.array(length)):
            context.ledger.warn("light-invalid", prim, f"its {name} is not finite, taken as 0")
            return 0.0
        return length

    if kind == "DistantLight":
        angle = math.radians(float(light_value(context, prim, "angle", 0.53)))
        spread = math.pi * math.sin(min(angle, math.pi) / 2) ** 2
        lux = radiance if normalize or spread == 0.0 else radiance * spread
        return {"type": "directional", "intensity": lux}
    if kind == "SphereLight":
        radius = meters("radius", 0.5)
        factor = 0.25 if normalize else math.pi * radius**2
        # Unlike the inputs, this attribute of the schema has no namespace.
        treated = prim.GetAttribute("treatAsPoint")
        point = bool(treated and treated.Get(context.time)) and radius == 0.0
        return _shaped(context, prim, radiance * (0.25 if point else factor))
    area, shape = _area(kind, meters)
    if area is None:
        return None
    flux = math.pi * radiance * (1.0 if normalize else area)
    message = f"its {area:.3g} m² {shape} became a point of equal power, {flux:.6g} lm"
    context.ledger.warn("area-light-approximated", prim, message)
    extras = {"area_light": {"shape": shape, "area_m2": area, "power_lm": flux}}
    if kind == "CylinderLight":
        return {"type": "point", "intensity": flux / (4.0 * math.pi), "extras": extras}
    cone = {"innerConeAngle": 0.0, "outerConeAngle": math.pi / 2}
    return {
        "type": "spot",
        "intensity": flux / _COSINE_SQUARED_SR,
        "spot": cone,
        "extras": extras,
    }


def _area(kind: str, meters: Any) -> tuple[float | None, str]:
    if kind == "DiskLight":
        return math.pi * meters("radius", 0.5) ** 2, "disk"
    if kind == "RectLight":
        return meters("width", 1.0) * meters("height", 1.0), "rectangle"
    if kind == "CylinderLight":
        return 2.0 * math.pi * meters("radius", 0.5) * meters("length", 1.0), "cylinder"
    return None, ""


def _shaped(context: Context, prim: Usd.Prim, candela: float) -> dict[str, Any]:
    """A sphere light, narrowed to a spot by UsdLuxShapingAPI."""
    angle = light_value(context, prim, "shaping:cone:angle", None)
    if not prim.HasAPI(UsdLux.ShapingAPI) or angle is None:
        return {"type": "point", "intensity": candela}
    degrees = float(angle)
    if not degrees < 90.0:
        if degrees < 180.0:
            message = f"a cone of {degrees}° from the axis is wider than glTF's 90°"
            context.ledger.warn("cone-clamped", prim, message)
        else:
            return {"type": "point", "intensity": candela}
    outer = min(max(math.radians(degrees), _SMALLEST_CONE), math.pi / 2)
    softness = float(light_value(context, prim, "shaping:cone:softness", 0.0))
    inner = outer * (1.0 - min(max(softness, 0.0), 1.0))
    inner = min(inner, outer * (1.0 - 1e-6))
    cone = {"innerConeAngle": inner, "outerConeAngle": outer}
    return {"type": "spot", "intensity": candela, "spot": cone}


def _keep_dome(context: Context, prim: Usd.Prim, node: Node, source: _Source) -> None:
    texture = light_value(context, prim, "texture:file", None)
    dome: dict[str, Any] = {
        "color": source.color.tolist(),
        "radiance_nits": source.radiance,
        "texture_format": str(light_value(context, prim, "texture:format", "automatic")),
    }
    if isinstance(texture, Sdf.AssetPath) and texture.path:
        dome["texture"] = texture.path
    else:
        sky = context.dome_radiance or [0.0, 0.0, 0.0]
        context.dome_radiance = [
            before + float(part) * source.radiance
            for before, part in zip(sky, source.color, strict=True)
        ]
    node.extras["dome_light"] = dome
    message = "glTF has no environment; color, radiance and texture are in the node's extras"
    context.ledger.warn("dome-light-external", prim, message)


def keep_mesh_light(context: Context, prim: Usd.Prim, node: Node) -> None:
    """Keep in extras the emission of a mesh or volume that is a light; its geometry is carried."""
    source = _emission(context, prim)
    node.extras["mesh_light"] = {"color": source.color.tolist(), "radiance_nits": source.radiance}
    _warn_links(context, prim)
    message = "glTF has no mesh light; color and radiance are in the node's extras"
    context.ledger.warn("mesh-light-dropped", prim, message)


def _warn_reflection(context: Context, prim: Usd.Prim) -> None:
    diffuse, specular = (
        float(light_value(context, prim, name, 1.0)) for name in ("diffuse", "specular")
    )
    if diffuse != specular:
        message = f"its factor for specular reflection, {specular:g}, is taken as {diffuse:g}"
        context.ledger.warn("light-specular-dropped", prim, f"{message} (diffuse)")


def _warn_shape(context: Context, prim: Usd.Prim) -> None:
    warn, kind = context.ledger.warn, prim.GetTypeName()
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


def _warn_links(context: Context, prim: Usd.Prim) -> None:
    """Name whatever limits what the light lights, or what casts its shadows."""
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


def _warn_unsupported(context: Context, prim: Usd.Prim) -> None:
    warn = context.ledger.warn
    _warn_reflection(context, prim)
    _warn_shape(context, prim)
    _warn_links(context, prim)
    outdated = [
        attribute.GetName()
        for attribute in prim.GetAuthoredAttributes()
        if attribute.GetName() in _OUTDATED
    ]
    if outdated:
        message = f"USD ignores {', '.join(outdated)}, which today are named 'inputs:...'"
        warn("light-input-outdated", prim, message)
    ies = light_value(context, prim, "shaping:ies:file", None)
    if isinstance(ies, Sdf.AssetPath) and ies.path:
        warn("light-linking-dropped", prim, "an IES profile has no counterpart")
    animated = [
        attribute.GetName()
        for attribute in prim.GetAuthoredAttributes()
        if attribute.GetName().startswith("inputs:") and attribute.ValueMightBeTimeVarying()
    ]
    if animated:
        message = f"animated {', '.join(sorted(animated))} stay at their first value"
        warn("light-animation-frozen", prim, message)
