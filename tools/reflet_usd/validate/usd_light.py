"""Owns the truth about lights: UsdLux's emission in the units of KHR_lights_punctual."""

import dataclasses
import math
import re
from typing import Any

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdLux

from .light_area import is_even, surface_area
from .scene_data import Array, Light, Lost, MeshLight
from .usd_stage import TruthStage

_APPROXIMATED = "area-light-approximated"
_MAX_FLOAT32 = float(np.finfo(np.float32).max)
_SHAPES = {
    "SphereLight": ("sphere", ("radius", "radius")),
    "RectLight": ("rectangle", ("width", "height")),
    "DiskLight": ("disk", ("radius", "radius")),
    "CylinderLight": ("cylinder", ("length", "radius")),
}
_AREAS = ("RectLight", "DiskLight", "CylinderLight")
_OF_LIGHTS = r"(inputs:|light:|guideRadius$|portals$)"
_LEVELS = r"inputs:(color|colorTemperature|diffuse|enableColorTemperature|exposure|intensity)$"
OF_GEOMETRY = _LEVELS + r"|light:filters$"
"""Inputs of geometry lights that are compared, or have a check of their own."""
_COMPARED = OF_GEOMETRY + (
    r"|inputs:(angle|height|length|normalize|radius|specular|texture:.*|width)$"
    r"|inputs:(shadow:enable|shaping:(cone:.*|focus|ies:file))$"
)
_SURROUNDING = ("DomeLight", "DomeLight_1", "GeometryLight", "PortalLight", "PluginLight")


@dataclasses.dataclass
class Source:
    """Emission of a light before it has a place."""

    kind: str
    """directional, point or spot."""
    radiance: Array
    """Radiance (3,) in nits; illuminance in lux for a directional light."""
    shape: str
    """Shape; empty for lights whose power does not depend on their size."""
    sizes: tuple[float, float]
    """Sizes for `surface_area`."""
    normalized: bool
    """Whether the power is normalized, independent of the area."""
    cone: tuple[float, float] | None
    """Inner and outer angle of a spot."""
    lost: Lost
    exact: bool = True

    def placed(self, truth: TruthStage, world: Gf.Matrix4d) -> Light:
        """The light at the place that `world` gives it."""
        matrix = truth.node_world(world)
        lost = list(self.lost)
        power = math.pi * self.radiance
        if not self.shape:
            return Light(self.kind, _stored(self.radiance), matrix, exact=self.exact, lost=lost)
        if not self.normalized:
            with np.errstate(invalid="ignore"):
                power = power * surface_area(self.shape, self.sizes, matrix[:3, :3])
        # Equal power in all directions, by the mean projected area of a body: a quarter of its
        # surface. A spot of 90° falls off as cos² in glTF, which fills 2π/3 steradians.
        spread = 2.0 * math.pi / 3.0 if self.shape in ("rectangle", "disk") else 4.0 * math.pi
        if self.shape != "sphere":
            lost.append((_APPROXIMATED, self.shape))
        elif self.sizes[0] > 0.0 and not is_even(matrix[:3, :3]):
            lost.append((_APPROXIMATED, "an ellipsoid"))
        light = Light(self.kind, _stored(power / spread), matrix, lost=lost)
        if self.cone is not None:
            light.inner_cone, light.outer_cone = self.cone
        return light


def read_source(prim: Usd.Prim, time: Usd.TimeCode, truth: TruthStage) -> Source | None:
    """The light at `time`; None for kinds that no punctual light can approximate."""
    kind = str(prim.GetPrimTypeInfo().GetSchemaTypeName())
    if kind in _SURROUNDING:
        return None
    radiance, lost = read_radiance(prim, time), _lost_inputs(prim, time)
    if kind == "DistantLight":
        half = min(math.radians(float(prim.GetAttribute("inputs:angle").Get(time))), math.pi) / 2
        # Illuminance of a disk of sky of uniform radiance: L·π·sin²(half angle); `normalize`
        # divides by that size factor, which UsdLux takes as 1 for angle 0.
        factor = math.pi * math.sin(half) ** 2
        bare = _normalized(prim, time) or factor == 0
        lux = radiance * (1.0 if bare else factor)
        return Source("directional", lux, "", (0.0, 0.0), True, None, lost)
    if kind not in _SHAPES:
        return Source("point", radiance, "", (0.0, 0.0), True, None, lost, exact=False)
    shape, names = _SHAPES[kind]
    first, second = (
        abs(float(prim.GetAttribute(f"inputs:{name}").Get(time))) * truth.meters_per_unit
        for name in names
    )
    cone = _cone(prim, time) if shape == "sphere" else None
    normalized = _normalized(prim, time)
    if shape == "sphere" and first == 0.0:
        normalized |= bool(UsdLux.SphereLight(prim).GetTreatAsPointAttr().Get(time))
    if shape in ("rectangle", "disk"):
        cone = (0.0, math.pi / 2)
    sort = "point" if cone is None else "spot"
    return Source(sort, radiance, shape, (first, second), normalized, cone, lost)


def read_mesh_light(light: Usd.Prim, time: Usd.TimeCode, of_itself: bool) -> MeshLight:
    """Light of a surface that is a light itself (`of_itself`), or that a light names."""
    nits = _stored(read_radiance(light, time))
    mode = light.GetAttribute("light:materialSyncMode").Get()
    return MeshLight(nits, of_itself and mode == "materialGlowTintsLight")


def geometry_lights(stage: Usd.Stage) -> dict[str, Usd.Prim]:
    """Light by the path of the gprim that each GeometryLight names; the first one counts."""
    found: dict[str, Usd.Prim] = {}
    for prim in stage.Traverse(Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)):
        if prim.GetPrimTypeInfo().GetSchemaTypeName() != "GeometryLight":
            continue
        shown = UsdGeom.Imageable(prim).ComputeVisibility(Usd.TimeCode.EarliestTime())
        if shown == UsdGeom.Tokens.invisible:
            continue
        for path in UsdLux.GeometryLight(prim).GetGeometryRel().GetForwardedTargets():
            target = stage.GetPrimAtPath(path)
            if target and target.IsA(UsdGeom.Gprim) and not target.HasAPI(UsdLux.LightAPI):
                found.setdefault(str(path), prim)
    return found


def lost_of_dome(prim: Usd.Prim, time: Usd.TimeCode) -> Lost | None:
    """Inputs of a dome light that the file's environment does not have; None for other kinds."""
    return _lost_inputs(prim, time) if prim.GetTypeName().startswith("DomeLight") else None


def _cone(prim: Usd.Prim, time: Usd.TimeCode) -> tuple[float, float] | None:
    """Inner and outer angle of a shaped light, at most glTF's 90°; None where it has no cone."""
    if not prim.HasAPI(UsdLux.ShapingAPI):
        return None
    shaping = UsdLux.ShapingAPI(prim)
    degrees = float(shaping.GetShapingConeAngleAttr().Get(time) or 0.0)
    if degrees >= 180.0:
        return None
    outer = math.radians(min(degrees, 90.0))
    soft = float(shaping.GetShapingConeSoftnessAttr().Get(time) or 0.0)
    return outer * (1.0 - float(np.clip(soft, 0.0, 1.0))), outer


def _stored(intensity: Array) -> Array:
    """Intensity as a file holds it: 0 where single precision cannot."""
    with np.errstate(invalid="ignore"):
        fits = bool((np.abs(intensity) <= _MAX_FLOAT32).all())
    return intensity if fits else np.zeros(3)


def _lost_inputs(prim: Usd.Prim, time: Usd.TimeCode) -> Lost:
    """Inputs that differ from UsdLux's neutral values and have no field in KHR_lights_punctual."""

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
        if narrow and prim.GetPrimTypeInfo().GetSchemaTypeName() in ("DistantLight", *_AREAS):
            lost.append(("light-shaping-dropped", "cone"))
        profile = read("inputs:shaping:ies:file", None)
        if profile and profile.path:
            lost.append(("light-linking-dropped", profile.path))
    return lost + unusual_inputs(prim, time, _COMPARED)


def unusual_inputs(prim: Usd.Prim, time: Usd.TimeCode, compared: str) -> Lost:
    """Inputs of UsdLux's schemas that differ from their fallbacks and are not in `compared`."""
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
    """Radiance (3,) in nits: color times intensity, exposure and share of diffuse light."""
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
