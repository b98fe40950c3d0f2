"""Owns the truth about lights: UsdLux's emission in the units of KHR_lights_punctual."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
from pxr import Gf, Usd, UsdLux

from .facts import Array, Light, Lost
from .light_area import is_even, surface_area
from .usd_stage import TruthStage

_MAX_FLOAT32 = float(np.finfo(np.float32).max)
_SHAPES = {
    "SphereLight": ("sphere", ("radius", "radius")),
    "RectLight": ("rectangle", ("width", "height")),
    "DiskLight": ("disk", ("radius", "radius")),
    "CylinderLight": ("cylinder", ("length", "radius")),
}
_AREAS = ("RectLight", "DiskLight", "CylinderLight")
_OF_LIGHTS = r"(inputs:|light:|guideRadius$|poleAxis$|portals$)"
_LEVELS = r"inputs:(color|colorTemperature|diffuse|enableColorTemperature|exposure|intensity)$"
OF_GEOMETRY = _LEVELS + r"|light:filters$"
"""What is compared, or has a check of its own, of geometry that is a light."""
_COMPARED = OF_GEOMETRY + (
    r"|inputs:(angle|height|length|normalize|radius|specular|texture:.*|width)$"
    r"|inputs:(shadow:enable|shaping:(cone:.*|focus|ies:file))$"
)
_SURROUNDING = ("DomeLight", "DomeLight_1", "GeometryLight", "PortalLight", "PluginLight")


def read_light(
    prim: Usd.Prim, time: Usd.TimeCode, truth: TruthStage, world: Gf.Matrix4d
) -> Light | None:
    """The light at `time`; None for kinds that no punctual light can stand in for."""
    if prim.GetTypeName() in _SURROUNDING:
        return None
    light = _punctual(prim, time, truth, world)
    light.lost += _lost_inputs(prim, time)
    return light


def lost_of_dome(prim: Usd.Prim, time: Usd.TimeCode) -> Lost:
    """What an environment in a node's extras does not say; empty for other kinds."""
    return _lost_inputs(prim, time) if prim.GetTypeName().startswith("DomeLight") else []


def _punctual(prim: Usd.Prim, time: Usd.TimeCode, truth: TruthStage, world: Gf.Matrix4d) -> Light:
    kind = prim.GetTypeName()
    matrix = truth.node_world(world)
    radiance = read_radiance(prim, time)
    if kind == "DistantLight":
        light = UsdLux.DistantLight(prim)
        half = min(math.radians(float(light.GetAngleAttr().Get(time))), math.pi) / 2
        # Illuminance of a disk of sky of uniform radiance: L·π·sin²(half angle); `normalize`
        # divides by that size factor, which UsdLux takes as 1 for angle 0.
        factor = math.pi * math.sin(half) ** 2
        bare = _normalized(prim, time) or factor == 0
        return Light("directional", _stored(radiance * (1.0 if bare else factor)), matrix)
    if kind not in _SHAPES:
        return Light("point", radiance, matrix, exact=False)
    shape, names = _SHAPES[kind]
    first, second = (
        abs(float(prim.GetAttribute(f"inputs:{name}").Get(time))) * truth.meters_per_unit
        for name in names
    )
    area = surface_area(shape, (first, second), matrix[:3, :3])
    if shape == "sphere":
        # Of radiance L its mean candela over all directions is L times the mean of what it shows,
        # a quarter of its area; normalize divides by that area, as treatAsPoint does where there
        # is no radius.
        point = UsdLux.SphereLight(prim).GetTreatAsPointAttr().Get(time) and first == 0.0
        bare = point or _normalized(prim, time)
        candela = radiance / 4 * (1.0 if bare else area)
        cone = _cone(prim, time)
        light = Light("point" if cone is None else "spot", _stored(candela), matrix, cone)
        if cone is not None:
            soft = float(UsdLux.ShapingAPI(prim).GetShapingConeSoftnessAttr().Get(time) or 0.0)
            light.inner_cone = cone * (1.0 - float(np.clip(soft, 0.0, 1.0)))
        if first > 0.0 and not is_even(matrix[:3, :3]):
            light.lost.append(("area-light-approximated", "an ellipsoid"))
        return light
    # Equal power Φ = π·L·A. A spot of 90° falls off as cos² in glTF, which fills 2π/3 steradians.
    power = math.pi * radiance * (1.0 if _normalized(prim, time) else area)
    if shape == "cylinder":
        light = Light("point", _stored(power / (4.0 * math.pi)), matrix)
    else:
        light = Light("spot", _stored(power * 1.5 / math.pi), matrix, math.pi / 2)
    light.lost.append(("area-light-approximated", shape))
    return light


def _cone(prim: Usd.Prim, time: Usd.TimeCode) -> float | None:
    """The outer angle of a shaped light, at most glTF's 90°; None where it shines all around."""
    if not prim.HasAPI(UsdLux.ShapingAPI):
        return None
    degrees = float(UsdLux.ShapingAPI(prim).GetShapingConeAngleAttr().Get(time) or 0.0)
    return math.radians(min(degrees, 90.0)) if degrees < 180.0 else None


def _stored(intensity: Array) -> Array:
    """The intensity as a file holds it: 0 where single precision cannot."""
    with np.errstate(invalid="ignore"):
        fits = bool((np.abs(intensity) <= _MAX_FLOAT32).all())
    return intensity if fits else np.zeros(3)


def _lost_inputs(prim: Usd.Prim, time: Usd.TimeCode) -> Lost:
    """What differs from UsdLux's neutral values and has no field in KHR_lights_punctual."""

    def read(name: str, neutral: Any) -> Any:
        attribute = prim.GetAttribute(name)
        value = attribute.Get(time) if attribute else None
        return neutral if value is None else value

    lost: Lost = []
    diffuse, specular = read("inputs:diffuse", 1.0), read("inputs:specular", 1.0)
    if diffuse != specular:
        lost.append(("light-specular-dropped", f"diffuse {diffuse:g}, specular {specular:g}"))
    if prim.IsA(UsdLux.RectLight):
        texture = UsdLux.RectLight(prim).GetTextureFileAttr().Get(time)
        if texture and texture.path:
            lost.append(("light-texture-dropped", texture.path))
    if prim.HasAPI(UsdLux.ShadowAPI) and not UsdLux.ShadowAPI(prim).GetShadowEnableAttr().Get(time):
        lost.append(("light-shadow-dropped", "casts no shadow"))
    if read("treatAsLine", False):
        lost.append(("light-line-dropped", "treatAsLine"))
    if prim.HasAPI(UsdLux.ShapingAPI):
        if read("inputs:shaping:focus", 0.0) != 0.0:
            lost.append(("light-shaping-dropped", "focus"))
        narrow = read("inputs:shaping:cone:angle", 90.0) < 90.0
        if narrow and prim.GetTypeName() in ("DistantLight", *_AREAS):
            lost.append(("light-shaping-dropped", "cone"))
        profile = read("inputs:shaping:ies:file", None)
        if profile and profile.path:
            lost.append(("light-linking-dropped", profile.path))
    return lost + unusual_inputs(prim, time, _COMPARED)


def unusual_inputs(prim: Usd.Prim, time: Usd.TimeCode, compared: str) -> Lost:
    """Inputs of UsdLux's schemas that differ from their fallbacks and are not `compared`."""
    lost: Lost = []
    definition = prim.GetPrimDefinition()
    for name in definition.GetPropertyNames():
        if not re.match(_OF_LIGHTS, name) or re.match(compared, name):
            continue
        item = prim.GetProperty(name)
        if isinstance(item, Usd.Relationship):
            differs = len(item.GetTargets()) > 0
        else:
            value, usual = item.Get(time), definition.GetAttributeFallbackValue(name)
            differs = value is not None and value != usual
        if differs:
            lost.append(("light-input-dropped", f"'{name}'"))
    return lost


def read_radiance(prim: Usd.Prim, time: Usd.TimeCode) -> Array:
    """(3,) nits: the light's color times its intensity, exposure and share of diffuse light."""
    light = UsdLux.LightAPI(prim) if prim.HasAPI(UsdLux.LightAPI) else UsdLux.SphereLight(prim)
    with np.errstate(over="ignore"):
        gain = float(np.exp2(np.float64(light.GetExposureAttr().Get(time))))
    level = float(light.GetIntensityAttr().Get(time)) * gain
    color = np.array(light.GetColorAttr().Get(time), dtype=np.float64)
    if light.GetEnableColorTemperatureAttr().Get(time):
        kelvin = float(light.GetColorTemperatureAttr().Get(time))
        color = color * np.array(UsdLux.BlackbodyTemperatureAsRgb(kelvin))
    level *= float(light.GetDiffuseAttr().Get(time))
    if not math.isfinite(level) or not np.isfinite(color).all():
        return np.zeros(3)
    return np.maximum(color, 0.0) * max(level, 0.0)


def _normalized(prim: Usd.Prim, time: Usd.TimeCode) -> bool:
    return bool(UsdLux.LightAPI(prim).GetNormalizeAttr().Get(time))
