"""UsdLux lights to KHR_lights_punctual, and the energy that each conversion keeps.

L is the radiance `intensity · 2^exposure`, read as nits. Sources of the factors: UsdLux's
documentation of `normalize` and of `inputs:angle`; KHR_lights_punctual's units (lux, candela).
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from pxr import Usd, UsdLux

from .context import Context, in_float32, type_name
from .environment import read_dome
from .gltf_writer import GltfWriter
from .light_losses import light_value, warn_unsupported
from .light_size import Emitter
from .scene import Array, Node
from .texture import TextureLibrary

_SMALLEST_CONE = 1e-3
# KHR_lights_punctual's cone falloff with inner angle 0 and outer angle 90° is cos²θ, which
# integrates to 2π/3 over the hemisphere.
_COSINE_SQUARED_SR = 2.0 * math.pi / 3.0
_SPHERE_SR = 4.0 * math.pi
# Shape, the inputs that give its size, and the solid angle of its power, by type of light.
_SHAPES = {
    "SphereLight": ("sphere", ("radius", "radius"), _SPHERE_SR),
    "RectLight": ("rectangle", ("width", "height"), _COSINE_SQUARED_SR),
    "DiskLight": ("disk", ("radius", "radius"), _COSINE_SQUARED_SR),
    "CylinderLight": ("cylinder", ("length", "radius"), _SPHERE_SR),
}


@dataclass
class Source:
    """A light's emission before its shape is known."""

    radiance: float
    color: Array
    normalize: bool


def add_light(context: Context, writer: GltfWriter, prim: Usd.Prim, node: Node) -> Emitter | None:
    """Give `node` the light of `prim`, or note it for the environment.

    Returns a light whose power depends on its size in the world, see `size_lights`.
    """
    kind = type_name(prim)
    if kind == "PortalLight":
        message = "a portal sends no light of its own, it guides how domes are sampled"
        context.ledger.warn("portal-light-ignored", prim, message)
        return None
    source = light_emission(context, prim)
    warn_unsupported(context, prim)
    if kind in ("DomeLight", "DomeLight_1"):
        read_dome(context, TextureLibrary(context, writer), prim, source.color * source.radiance)
        context.ledger.carry(prim)
        return None
    entry = _punctual(context, prim, source)
    if entry is None:
        message = f"a {kind} has no glTF counterpart"
        context.ledger.warn("light-dropped", prim, message)
        return None
    brightest = float(source.color.max())
    entry["color"] = (source.color / brightest if brightest > 0.0 else source.color).tolist()
    if not in_float32(np.array(entry["intensity"] * brightest)):
        context.ledger.warn("light-invalid", prim, "its intensity is not finite, taken as 0")
        entry["intensity"] = 0.0
    entry["intensity"] *= brightest
    entry["name"] = prim.GetName()
    entry["extras"] = {"prim": str(prim.GetPath())}
    node.light = writer.add("lights", entry)
    return _emitter(context, prim, source, brightest)


def light_emission(context: Context, prim: Usd.Prim) -> Source:
    """Emission of any light; negative or non-finite values become 0, with a warning."""
    intensity = float(light_value(context, prim, "intensity", 1.0))
    exposure = float(light_value(context, prim, "exposure", 0.0))
    color = np.array(light_value(context, prim, "color", (1.0, 1.0, 1.0)), dtype=np.float64)
    if light_value(context, prim, "enableColorTemperature", False):
        kelvin = float(light_value(context, prim, "colorTemperature", 6500.0))
        color = color * np.array(UsdLux.BlackbodyTemperatureAsRgb(kelvin))
    # glTF lights have one factor; equal diffuse and specular factors scale the whole light.
    diffuse = float(light_value(context, prim, "diffuse", 1.0))
    with np.errstate(over="ignore"):
        radiance = intensity * float(np.exp2(np.float64(exposure))) * diffuse
    if not math.isfinite(radiance) or not np.isfinite(color).all():
        context.ledger.warn("light-invalid", prim, "its emission is not finite, taken as 0")
        radiance, color = 0.0, np.ones(3)
    if radiance < 0.0 or (color < 0.0).any():
        context.ledger.warn("light-invalid", prim, "its emission is negative, taken as 0")
        radiance, color = max(radiance, 0.0), np.maximum(color, 0.0)
    return Source(radiance, color, bool(light_value(context, prim, "normalize", False)))


def _punctual(context: Context, prim: Usd.Prim, source: Source) -> dict[str, Any] | None:
    """The light's entry; a light with a size gets a placeholder for its intensity."""
    kind = type_name(prim)
    if kind == "DistantLight":
        angle = math.radians(float(light_value(context, prim, "angle", 0.53)))
        spread = math.pi * math.sin(min(angle, math.pi) / 2) ** 2
        bare = source.normalize or spread == 0.0
        lux = source.radiance if bare else source.radiance * spread
        return {"type": "directional", "intensity": lux}
    if kind == "SphereLight":
        return _shaped(context, prim)
    if kind == "CylinderLight":
        return {"type": "point", "intensity": 0.0}
    if kind in ("RectLight", "DiskLight"):
        cone = {"innerConeAngle": 0.0, "outerConeAngle": math.pi / 2}
        return {"type": "spot", "intensity": 0.0, "spot": cone}
    return None


def _emitter(context: Context, prim: Usd.Prim, source: Source, brightest: float) -> Emitter | None:
    """The facts that decide the power of a light with a size."""
    kind = type_name(prim)
    if kind not in _SHAPES:
        return None
    shape, names, steradians = _SHAPES[kind]
    fallbacks = {"radius": 0.5}
    first, second = (
        abs(float(light_value(context, prim, name, fallbacks.get(name, 1.0))))
        * context.meters_per_unit
        for name in names
    )
    # This attribute of the schema has no namespace, other than the inputs.
    treated = prim.GetAttribute("treatAsPoint")
    point = bool(treated and treated.Get(context.time)) and kind == "SphereLight" and first == 0.0
    power = math.pi * source.radiance
    bare = source.normalize or point
    return Emitter(prim, brightest, shape, (first, second), power, bare, steradians)


def _shaped(context: Context, prim: Usd.Prim) -> dict[str, Any]:
    """Entry of a sphere light, narrowed to a spot by UsdLuxShapingAPI."""
    angle = light_value(context, prim, "shaping:cone:angle", None)
    if not prim.HasAPI(UsdLux.ShapingAPI) or angle is None:
        return {"type": "point", "intensity": 0.0}
    degrees = float(angle)
    if not degrees <= 90.0:
        if degrees < 180.0:
            message = f"a cone of {degrees}° from the axis is wider than glTF's 90°"
            context.ledger.warn("cone-clamped", prim, message)
        else:
            return {"type": "point", "intensity": 0.0}
    outer = min(max(math.radians(degrees), _SMALLEST_CONE), math.pi / 2)
    softness = float(light_value(context, prim, "shaping:cone:softness", 0.0))
    inner = outer * (1.0 - min(max(softness, 0.0), 1.0))
    inner = min(inner, outer * (1.0 - 1e-6))
    cone = {"innerConeAngle": inner, "outerConeAngle": outer}
    return {"type": "spot", "intensity": 0.0, "spot": cone}
