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


def add(scene: Table, text: Table) -> None:
    """Adds the fog around everything in a translated scene."""
    fog = text["environment"]["fog"]
    low, high = box(text)
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


def box(text: Table) -> tuple[Any, Any]:
    """The smallest box around all things, lamps and cameras of a scene."""
    from . import export

    points = [camera["eye"] for camera in text["camera"].values()]
    points += [lamp["position"] for lamp in text.get("light", {}).values() if "position" in lamp]
    for instance in text["instance"]:
        shape = text["model"][instance["model"]]["shape"]
        half = half_size(shape)
        place = np.array(export.placement(instance).matrix)
        for corner in range(8):
            signs = [1 if corner >> axis & 1 else -1 for axis in range(3)]
            points.append((place @ [*(np.multiply(half, signs)), 1.0])[:3].tolist())
    corners = np.array(points, float)
    return corners.min(axis=0), corners.max(axis=0)


def half_size(shape: Table) -> list[float]:
    if shape["kind"] == "sphere":
        return [shape.get("radius", 0.5)] * 3
    if shape["kind"] == "plane":
        x, z = shape.get("size", [1, 1])
        return [x / 2, 0.0, z / 2]
    return [edge / 2 for edge in shape.get("size", [1, 1, 1])]
