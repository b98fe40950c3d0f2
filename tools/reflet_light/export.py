"""Scene text, parsed, as a dictionary of Mitsuba 3: the subset that docs/light.md compares."""

import math
import pathlib
from typing import Any

import mitsuba as mi
import numpy as np

from . import fog

Table = dict[str, Any]
Place = mi.ScalarTransform4f
# Distance of the disk that stands for a directional light with an angle.
FAR_M = 1e4
PANORAMA = (512, 1024)


def rgb(color: list[float], scale: float = 1.0) -> Table:
    return {"type": "rgb", "value": [c * scale for c in color]}


def scene(text: Table, folder: pathlib.Path, size: tuple[int, int], depth: int) -> Table:
    """The whole scene; files are searched in `folder`, paths have at most `depth` segments."""
    out: Table = {"type": "scene", "integrator": {"type": "path", "max_depth": depth}}
    out["integrator"]["rr_depth"] = 1000
    out["sensor"] = camera(next(iter(text["camera"].values())), size)
    out["sky"] = environment(text.get("environment", {}), folder)
    for name, light in text.get("light", {}).items():
        out[f"light_{name}"] = emitter(light)
    for index, instance in enumerate(text["instance"]):
        model = text["model"][instance["model"]]
        out[f"thing_{index}"] = shape(model["shape"], placement(instance))
        out[f"thing_{index}"] |= surface(text["material"][model["material"]])
    if "fog" in text.get("environment", {}):
        fog.add(out, text["environment"]["fog"], *box(text))
    return out


def camera(text: Table, size: tuple[int, int]) -> Table:
    aim = Place().look_at(origin=text["eye"], target=text["target"], up=text.get("up", [0, 1, 0]))
    film = {"type": "hdrfilm", "width": size[0], "height": size[1], "pixel_format": "rgb"}
    film |= {"component_format": "float32", "rfilter": {"type": "box"}}
    fov_deg = text.get("fov_deg", 60.0)
    lens: Table = {"type": "perspective", "fov": fov_deg, "fov_axis": "y"}
    if "aperture_f" in text:
        focal_m = 0.012 / math.tan(math.radians(fov_deg / 2))
        focus_m = text.get("focus_m", math.dist(text["eye"], text["target"]))
        lens |= {"type": "thinlens", "focus_distance": focus_m}
        lens["aperture_radius"] = focal_m / text["aperture_f"] / 2
    return lens | {"to_world": aim, "film": film, "sampler": {"type": "independent"}}


def environment(text: Table, folder: pathlib.Path) -> Table:
    scale = text.get("intensity", 1.0)
    if "file" in text:
        return {"type": "envmap", "filename": str(folder / text["file"]), "scale": scale}
    black = [0.0, 0.0, 0.0]
    if "zenith" not in text:
        return {"type": "constant", "radiance": rgb(text.get("color", black), scale)}
    # The gradient is linear in the sine of the latitude.
    sine = np.cos((np.arange(PANORAMA[0]) + 0.5) / PANORAMA[0] * math.pi)[:, None]
    zenith, horizon, ground = (np.array(text[k]) for k in ("zenith", "horizon", "ground"))
    row = horizon + (zenith - horizon) * np.maximum(sine, 0)
    row += (ground - horizon) * np.maximum(-sine, 0)
    texels = np.repeat(row[:, None, :], PANORAMA[1], axis=1).astype(np.float32)
    return {"type": "envmap", "bitmap": mi.Bitmap(texels), "scale": scale}


def emitter(text: Table) -> Table:
    color = text.get("color", [1.0, 1.0, 1.0])
    kind = text["kind"]
    strength: Any = text.get("intensity_cd", text.get("intensity_lux"))
    radius = text.get("radius_m", 0.0)
    if kind == "directional":
        return sun(text, color, strength)
    at = text["position"]
    if kind == "point" and radius == 0:
        return {"type": "point", "position": at, "intensity": rgb(color, strength)}
    if kind == "point":
        area = math.pi * radius**2
        ball = {"type": "sphere", "center": at, "radius": radius}
        return ball | {"glow": {"type": "area", "radiance": rgb(color, strength / area)}}
    target = text.get("target") or [a + d for a, d in zip(at, text["direction"], strict=True)]
    aim = Place().look_at(origin=at, target=target, up=text.get("up", [0.0, 1.0, 0.01]))
    if kind == "spot":
        beam = {"cutoff_angle": text["outer_deg"], "beam_width": text["inner_deg"]}
        return {"type": "spot", "to_world": aim, "intensity": rgb(color, strength), **beam}
    if kind == "rect":
        width, height = text["size"]
        flat: Table = {"type": "rectangle"}
        flat["to_world"] = aim @ Place().scale([width / 2, height / 2, 1])
        area = width * height
    else:
        flat = {"type": "disk", "to_world": aim @ Place().scale([radius, radius, 1])}
        area = math.pi * radius**2
    return flat | {"glow": {"type": "area", "radiance": rgb(color, strength / area)}}


def sun(text: Table, color: list[float], lux: float) -> Table:
    direction = np.array(text["direction"], float)
    direction /= np.linalg.norm(direction)
    half = math.radians(text.get("angle_deg", 0.0)) / 2
    if half == 0:
        irradiance = rgb(color, lux)
        return {"type": "directional", "direction": direction.tolist(), "irradiance": irradiance}
    radius = FAR_M * math.tan(half)
    at = (-FAR_M * direction).tolist()
    aim = Place().look_at(origin=at, target=[0, 0, 0], up=[0.01, 1, 0.02])
    disk = {"type": "disk", "to_world": aim @ Place().scale([radius, radius, 1])}
    radiance = rgb(color, lux / (math.pi * math.sin(half) ** 2))
    return disk | {"glow": {"type": "area", "radiance": radiance}}


def placement(text: Table) -> Any:
    x, y, z = text.get("rotation_deg", [0, 0, 0])
    scale = text.get("scale", 1.0)
    turned = Place().rotate([0, 0, 1], z).rotate([0, 1, 0], y).rotate([1, 0, 0], x)
    return Place().translate(text.get("translation", [0, 0, 0])) @ turned @ Place().scale(scale)


def box(text: Table) -> tuple[Any, Any]:
    """The smallest box around all things, lamps and cameras of a scene."""
    points = [camera["eye"] for camera in text["camera"].values()]
    points += [lamp["position"] for lamp in text.get("light", {}).values() if "position" in lamp]
    for instance in text["instance"]:
        half = half_size(text["model"][instance["model"]]["shape"])
        place = np.array(placement(instance).matrix)
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


def shape(text: Table, place: Any) -> Table:
    kind = text["kind"]
    if kind == "sphere":
        # Mitsuba's sphere is exact, Reflet's is tessellated.
        return {"type": "sphere", "radius": text.get("radius", 0.5), "to_world": place}
    if kind == "plane":
        x, z = text.get("size", [1, 1])
        flat = Place().rotate([1, 0, 0], -90).scale([x / 2, z / 2, 1])
        return {"type": "rectangle", "to_world": place @ flat}
    if kind == "box":
        half = [edge / 2 for edge in text.get("size", [1, 1, 1])]
        return {"type": "cube", "to_world": place @ Place().scale(half)}
    raise ValueError(f"shape {kind!r} is not compared")


def surface(text: Table) -> Table:
    """BSDF of a material, and the emitter where it is emissive."""
    glow: Table = {}
    emission = text.get("emission", [0, 0, 0])
    if any(emission):
        strength = text.get("emission_strength", 1.0)
        glow = {"glow": {"type": "area", "radiance": rgb(emission, strength)}}
    return glow | {"bsdf": bsdf(text)}


def bsdf(text: Table) -> Table:
    red, green, blue = text.get("base_color", [1.0, 1.0, 1.0])
    color = {"red": red, "green": green, "blue": blue}
    roughness = text.get("roughness", 1.0)
    ior = text.get("ior", 1.5)
    if text.get("transmission", 0) == 1:
        if text.get("thickness_m", 0) == 0:
            return {"type": "thin_pane", "ior": ior, **color}
        if roughness == 0:
            return {"type": "dielectric", "int_ior": ior, "ext_ior": 1.0}
        rough = {"distribution": "ggx", "alpha": roughness**2}
        return {"type": "roughdielectric", "int_ior": ior, "ext_ior": 1.0, **rough}
    if text.get("reflectivity") == 0 and text.get("metallic", 0) == 0:
        matte = {"type": "diffuse", "reflectance": rgb([red, green, blue])}
        return {"type": "twosided", "nested": matte}
    if "anisotropy" in text:
        if [red, green, blue, text["metallic"]] != [1, 1, 1, 1]:
            raise ValueError("grooves are compared on white metal alone")
        across = float(roughness) ** 2
        along = across + (1 - across) * text["anisotropy"] ** 2
        alphas = {"alpha_u": along, "alpha_v": across}
        return {"type": "roughconductor", "material": "none", "distribution": "ggx", **alphas}
    names = ["metallic", "reflectivity", "specular", "clearcoat", "clearcoat_roughness"]
    names += ["sheen_roughness"]
    numbers = {name: float(text[name]) for name in names if name in text}
    for name in ("specular", "sheen"):
        for channel, value in zip(
            ("red", "green", "blue"), text.get(f"{name}_color", ()), strict=False
        ):
            numbers[f"{name}_{channel}"] = float(value)
    return {"type": "khronos", "roughness": float(roughness), **numbers, **color}
