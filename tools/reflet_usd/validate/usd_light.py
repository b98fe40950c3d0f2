"""Owns the truth about lights: UsdLux's emission in the units of KHR_lights_punctual."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from pxr import Gf, Usd, UsdLux

from .facts import Array, Light, Lost
from .usd_stage import TruthStage

_SURROUNDING = ("DomeLight", "DomeLight_1", "GeometryLight", "PortalLight", "PluginLight")


def read_light(
    prim: Usd.Prim, time: Usd.TimeCode, truth: TruthStage, world: Gf.Matrix4d
) -> Light | None:
    """The light at `time`; None for kinds that no punctual light can stand in for."""
    if prim.GetTypeName() in _SURROUNDING:
        return None
    light = _punctual(prim, time, truth, world)
    light.lost = _lost_inputs(prim, time)
    return light


def _punctual(prim: Usd.Prim, time: Usd.TimeCode, truth: TruthStage, world: Gf.Matrix4d) -> Light:
    kind = prim.GetTypeName()
    matrix = truth.node_world(world)
    radiance = _radiance(prim, time)
    if kind == "DistantLight":
        light = UsdLux.DistantLight(prim)
        half = math.radians(float(light.GetAngleAttr().Get(time))) / 2
        # Illuminance of a disk of sky of uniform radiance: L·π·sin²(half angle); `normalize`
        # divides by that size factor, which UsdLux takes as 1 for angle 0.
        factor = math.pi * math.sin(half) ** 2
        bare = _normalized(prim, time) or factor == 0
        return Light("directional", radiance * (1.0 if bare else factor), matrix)
    shaping = UsdLux.ShapingAPI(prim)
    cone = None
    if prim.HasAPI(UsdLux.ShapingAPI):
        cone = math.radians(float(shaping.GetShapingConeAngleAttr().Get(time) or 0.0))
    spot = cone is not None and cone < math.pi / 2
    if kind != "SphereLight":
        return Light("spot" if spot else "point", radiance, matrix, cone, exact=False)
    light = UsdLux.SphereLight(prim)
    scale = float(np.cbrt(abs(np.linalg.det(matrix[:3, :3]))))
    radius = float(light.GetRadiusAttr().Get(time)) * truth.meters_per_unit * scale
    # A sphere of radiance L seen from afar: candela = L·π·r²; normalize divides by 4·π·r².
    candela = radiance / 4 if _normalized(prim, time) else radiance * math.pi * radius**2
    exact = not light.GetTreatAsPointAttr().Get(time) and radius > 0
    return Light("spot" if spot else "point", candela, matrix, cone if spot else None, exact)


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
    if prim.HasAPI(UsdLux.ShapingAPI) and read("inputs:shaping:focus", 0.0) != 0.0:
        lost.append(("light-shaping-dropped", "focus"))
    return lost


def _radiance(prim: Usd.Prim, time: Usd.TimeCode) -> Array:
    light = UsdLux.LightAPI(prim) if prim.HasAPI(UsdLux.LightAPI) else UsdLux.SphereLight(prim)
    with np.errstate(over="ignore"):
        gain = float(np.exp2(np.float64(light.GetExposureAttr().Get(time))))
    level = float(light.GetIntensityAttr().Get(time)) * gain
    color = np.array(light.GetColorAttr().Get(time), dtype=np.float64)
    if light.GetEnableColorTemperatureAttr().Get(time):
        kelvin = float(light.GetColorTemperatureAttr().Get(time))
        color = color * np.array(UsdLux.BlackbodyTemperatureAsRgb(kelvin))
    return color * level * float(light.GetDiffuseAttr().Get(time))


def _normalized(prim: Usd.Prim, time: Usd.TimeCode) -> bool:
    return bool(UsdLux.LightAPI(prim).GetNormalizeAttr().Get(time))
