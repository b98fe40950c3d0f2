"""Geometry that is a light: the emission of its materials, which light the scene.

MeshLightAPI on a gprim, or a GeometryLight (deprecated) that names one. `materialSyncMode` is
materialGlowTintsLight unless authored: a material's own emission is a factor of the light's.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom, UsdLux

from .context import Context, in_float32, type_name
from .gltf_writer import GltfWriter
from .light import light_emission
from .light_losses import warn_geometry_light
from .scene import Array, Node

_TINTED = "materialGlowTintsLight"


@dataclass(frozen=True)
class Glow:
    """Radiance of a surface that is a light, the same in all directions."""

    nits: tuple[float, float, float]
    tinted: bool
    """Whether a material's own emission, where it has some, multiplies the light."""


class MeshLights:
    """The gprims whose surface sends light, and their emission."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._named: dict[str, Usd.Prim] | None = None
        """GeometryLight that names a gprim, by the gprim's path; filled at first use."""

    def glow(self, prim: Usd.Prim) -> Glow | None:
        """Emission of a gprim's light; None where it is no light."""
        light = self.light_of(prim)
        if light is None:
            return None
        source = light_emission(self._context, light)
        nits = source.color * source.radiance
        if not in_float32(nits).all():
            message = "its emission is not finite, taken as 0"
            self._context.ledger.warn("light-invalid", light, message)
            return None
        if not nits.any():
            return None
        mode = light.GetAttribute("light:materialSyncMode")
        # A GeometryLight falls back to the mode of plain lights, which have no material.
        tinted = light == prim and (not mode or mode.Get() == _TINTED)
        return Glow((float(nits[0]), float(nits[1]), float(nits[2])), tinted)

    def light_of(self, prim: Usd.Prim) -> Usd.Prim | None:
        """The light of a gprim: the prim itself, or the GeometryLight that names it."""
        if not prim.IsA(UsdGeom.Gprim):
            return None
        if prim.HasAPI(UsdLux.LightAPI):
            return prim
        if self._named is None:
            self._named = dict(self._geometry_lights())
        return self._named.get(str(prim.GetPath()))

    def shines(self, light: Usd.Prim) -> bool:
        """Whether a GeometryLight names a gprim that sends its light."""
        return any(
            (gprim := self._context.stage.GetPrimAtPath(target)) and self.light_of(gprim) == light
            for target in _geometry(light)
        )

    def _geometry_lights(self) -> list[tuple[str, Usd.Prim]]:
        predicate = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
        prims = Usd.PrimRange(self._context.stage.GetPseudoRoot(), predicate)
        lights = [prim for prim in prims if type_name(prim) == "GeometryLight"]
        visible = [
            light
            for light in lights
            if UsdGeom.Imageable(light).ComputeVisibility(self._context.time)
            != UsdGeom.Tokens.invisible
        ]
        # The first of several lights counts.
        return [(str(path), light) for light in reversed(visible) for path in _geometry(light)]


def _geometry(light: Usd.Prim) -> list[Any]:
    relationship = light.GetRelationship("geometry")
    return list(relationship.GetForwardedTargets()) if relationship else []


def add_geometry_light(context: Context, lights: MeshLights, prim: Usd.Prim) -> None:
    """Account for a GeometryLight, whose light the gprim that it names sends."""
    warn_geometry_light(context, prim)
    if lights.shines(prim):
        context.ledger.carry(prim)
    else:
        message = "a GeometryLight whose 'geometry' names no other gprim that is no light"
        context.ledger.warn("light-dropped", prim, message)


def keep_mesh_light(context: Context, prim: Usd.Prim, node: Node, drawn: bool) -> None:
    """Warn about losses of a gprim with LightAPI; materials carry a `drawn` surface's emission."""
    warn_geometry_light(context, prim)
    if drawn:
        return
    source = light_emission(context, prim)
    node.extras["mesh_light"] = {"color": source.color.tolist(), "radiance_nits": source.radiance}
    message = f"a {type_name(prim)} does not shine; color and radiance are in the node's extras"
    context.ledger.warn("mesh-light-dropped", prim, message)


def shine(writer: GltfWriter, entry: dict[str, Any], glow: Glow) -> None:
    """Give the material `entry` the emission, and mark it as a light."""
    nits = np.array(glow.nits)
    strength = entry.get("extensions", {}).pop("KHR_materials_emissive_strength", {})
    own = np.array(entry.pop("emissiveFactor", (0.0, 0.0, 0.0)))
    own = own * strength.get("emissiveStrength", 1.0)
    if not entry.get("extensions", True):
        del entry["extensions"]
    if glow.tinted and own.any():
        nits = nits * own
    else:
        entry.pop("emissiveTexture", None)
    write_emission(writer, entry, nits)
    entry.setdefault("extras", {})["mesh_light"] = {"nits": list(glow.nits)}


def write_emission(writer: GltfWriter, entry: dict[str, Any], color: Array) -> None:
    """Write an emission in nits as the material's factor and emissive strength."""
    strongest = float(color.max())
    if strongest > 1.0:
        writer.use_extension("KHR_materials_emissive_strength")
        extension = {"KHR_materials_emissive_strength": {"emissiveStrength": strongest}}
        entry.setdefault("extensions", {}).update(extension)
        color = color / strongest
    if strongest > 0.0:
        entry["emissiveFactor"] = [min(float(part), 1.0) for part in color]
