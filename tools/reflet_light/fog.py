"""Fog of scene text as a medium of Mitsuba 3, in a box without a surface of its own."""

from typing import Any

import mitsuba as mi
import numpy as np

Table = dict[str, Any]
# Distance by which the box of homogeneous fog is larger than Reflet's, meters, so that no surface
# lies in its sides.
MARGIN_M = 1e-3
# Half the width of the box that stands for fog without end, and the number of falloffs above the
# layer that it holds.
WIDE_M = 150.0
HIGH = 20
SLICES = 1024


def add(scene: Table, fog: Table, low: Any, high: Any) -> None:
    """Adds the fog to a translated scene that lies between two corners."""
    if "falloff_m" in fog:
        low = np.array([-WIDE_M, low[1] - MARGIN_M, -WIDE_M])
        high = np.array([WIDE_M, fog.get("height_m", 0.0) + HIGH * fog["falloff_m"], WIDE_M])
    else:
        low, high = low - MARGIN_M, high + MARGIN_M
    place = mi.ScalarTransform4f().translate(low.tolist()).scale((high - low).tolist())
    medium: Table = {"type": "homogeneous", "sigma_t": float(fog["density"])}
    if "falloff_m" in fog:
        medium = {"type": "heterogeneous", "scale": float(fog["density"])}
        medium["sigma_t"] = densities(fog, low[1], high[1], place)
    color = fog.get("color", [1.0, 1.0, 1.0])
    medium["albedo"] = {"type": "constvolume", "value": {"type": "rgb", "value": color}}
    medium["phase"] = {"type": "hg", "g": float(fog.get("anisotropy", 0.0))}
    scene["fog"] = medium
    inside = {"type": "ref", "id": "fog"}
    scene["fog_box"] = {
        "type": "cube",
        "to_world": place @ mi.ScalarTransform4f().translate([0.5, 0.5, 0.5]).scale(0.5),
        "bsdf": {"type": "null"},
        "interior": inside,
    }
    # Cameras and lamps without a size are in the fog, as its box holds them.
    for name, made in scene.items():
        if name == "sensor" or (isinstance(made, dict) and made.get("type") in ("point", "spot")):
            made["medium"] = inside
    scene["integrator"]["type"] = "volpath"


def densities(fog: Table, bottom: float, top: float, place: Any) -> Table:
    """Densities over that in the layer, in slices, between which Mitsuba interpolates."""
    y = bottom + (np.arange(SLICES) + 0.5) / SLICES * (top - bottom)
    above = np.maximum(y - fog.get("height_m", 0.0), 0.0)
    slices = np.exp(-above / fog["falloff_m"]).astype(np.float32)
    grid = mi.VolumeGrid(slices.reshape(1, SLICES, 1))
    return {"type": "gridvolume", "grid": grid, "to_world": place, "wrap_mode": "clamp"}
