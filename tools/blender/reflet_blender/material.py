"""Owns what the export of glTF does not carry of materials: values of scene text over the file's.

Blender's exporter writes Principled materials with their textures. Here is the rest that Reflet
has: that glass is solid, what light does below a surface, that glowing surfaces light others, plain
shaders other than Principled; and the names of losses.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import bpy

from .report import Report

# Nodes that Blender's exporter follows from an image or a color attribute to an input.
_FOLLOWED = {
    *("TEX_IMAGE", "UVMAP", "MAPPING", "TEX_COORD", "NORMAL_MAP", "SEPARATE_COLOR", "REROUTE"),
    *("VERTEX_COLOR", "ATTRIBUTE", "RGB", "VALUE", "MIX", "MATH", "COMBINE_COLOR", "INVERT"),
}
# Depth of any solid: Reflet follows the real way through the mesh, and asks only whether it is 0.
_SOLID = {"thickness_m": 1}


def overrides(material: bpy.types.Material, report: Report) -> dict[str, Any]:
    """Keys of `[model.NAME.material.MATERIAL]` over glTF's values of `material`."""
    name = material.name
    if material.node_tree is None or not material.use_nodes:
        return {}
    output = material.node_tree.get_output_node("CYCLES") or material.node_tree.get_output_node(
        "ALL"
    )
    if output is None:
        report.lose("material-approximated", name, "it has no output")
        return {}
    if output.inputs["Volume"].is_linked:
        report.lose("volume-dropped", name)
    if output.inputs["Displacement"].is_linked:
        report.lose("displacement-dropped", name)
    if material.node_tree.animation_data and _is_animated(material.node_tree.animation_data):
        report.lose("material-animation-frozen", name)
    shader = _source(output.inputs["Surface"])
    if shader is None:
        return {"base_color": [0, 0, 0], "specular": 0, "roughness": 1, "metallic": 0}
    made = _BY_KIND.get(shader.type)
    if made is None:
        label = shader.bl_label
        report.lose("material-approximated", name, f"{label} is as Blender writes it to glTF")
        return {}
    return made(shader, name, report)


def _source(socket: bpy.types.NodeSocket) -> bpy.types.Node | None:
    """The node that feeds `socket`, through reroutes."""
    for _ in range(1000):
        if not socket.is_linked:
            return None
        node = socket.links[0].from_node
        if node.type != "REROUTE":
            return node
        socket = node.inputs[0]
    return None


def _upstream(node: bpy.types.Node) -> Iterator[bpy.types.Node]:
    seen, waiting = set(), [node]
    while waiting:
        current = waiting.pop()
        if current in seen:
            continue
        seen.add(current)
        yield current
        waiting += [link.from_node for socket in current.inputs for link in socket.links]


def _name_procedural(shader: bpy.types.Node, name: str, report: Report) -> None:
    for socket in shader.inputs:
        source = _source(socket)
        if source is None:
            continue
        for node in _upstream(source):
            if node.type == "TEX_IMAGE" and (node.image is None or not node.image.has_data):
                if node.image is None or not _loads(node.image):
                    report.lose("image-missing", name, f"the image of {socket.name}")
            elif node.type not in _FOLLOWED:
                text = f"{socket.name} is fed by {node.bl_label}"
                report.lose("procedural-dropped", name, text)


def _loads(image: bpy.types.Image) -> bool:
    """Whether the pixels of an image that was not needed yet can be read."""
    return image.size[0] > 0 and image.size[1] > 0


def _is_animated(data: bpy.types.AnimData) -> bool:
    return bool(data.action or data.drivers or data.nla_tracks)


def _number(shader: bpy.types.Node, name: str) -> float:
    """The value of an input; one that is linked counts as 1, since something is there."""
    socket = shader.inputs.get(name)
    if socket is None:
        return 0.0
    return 1.0 if socket.is_linked else float(socket.default_value)


def _color(shader: bpy.types.Node, name: str) -> list[float]:
    return [min(max(float(part), 0.0), 1.0) for part in shader.inputs[name].default_value[:3]]


def _share(shader: bpy.types.Node, name: str) -> float:
    return min(max(_number(shader, name), 0.0), 1.0)


def _own_number(
    shader: bpy.types.Node, key: str, name: str, bounds: tuple[float, float, float]
) -> dict[str, float]:
    """The own value of an input as a key; nothing at its plain value, the first of `bounds`."""
    plain, least, most = bounds
    socket = shader.inputs.get(name)
    value = plain if socket is None else float(socket.default_value)
    return {} if value == plain else {key: min(max(value, least), most)}


def _principled(shader: bpy.types.Node, name: str, report: Report) -> dict[str, Any]:
    out: dict[str, Any] = {}
    _name_procedural(shader, name, report)
    out.update(_subsurface(shader, name, report))
    if _number(shader, "Transmission Weight") > 0:
        out.update(_SOLID)
    glow = shader.inputs["Emission Color"]
    if _number(shader, "Emission Strength") > 0 and (
        glow.is_linked or max(glow.default_value[:3]) > 0
    ):
        out["light"] = True
    out.update(_own_number(shader, "diffuse_roughness", "Diffuse Roughness", (0.0, 0.0, 1.0)))
    if _number(shader, "Coat Weight") > 0:
        out.update(_own_number(shader, "clearcoat_ior", "Coat IOR", (1.5, 1.0, 4.0)))
    for socket in ("Diffuse Roughness", "Coat IOR"):
        if socket in shader.inputs and shader.inputs[socket].is_linked:
            text = f"{socket} has its own value, not what is linked to it"
            report.lose("material-approximated", name, text)
    out.update(_tinted_edges(shader, name, report))
    film = _number(shader, "Thin Film Thickness")
    if film > 0:
        ior = min(max(_number(shader, "Thin Film IOR"), 1.0), 4.0)
        out.update(iridescence=1, iridescence_ior=ior, iridescence_thickness_nm=film)
    return out


def _tinted_edges(shader: bpy.types.Node, name: str, report: Report) -> dict[str, Any]:
    """The tint of the edges of metals."""
    metallic, tint, level = (
        shader.inputs[key] for key in ("Metallic", "Specular Tint", "Specular IOR Level")
    )
    is_white = not tint.is_linked and min(tint.default_value[:3]) >= 1
    if is_white or (not metallic.is_linked and metallic.default_value <= 0):
        return {}
    # The level is no part of a metal's tint in Blender, and `edge_tint` takes both.
    is_plain = not level.is_linked and level.default_value == 0.5
    if metallic.is_linked or metallic.default_value < 1 or tint.is_linked or not is_plain:
        text = "Specular Tint of metals is right for Metallic 1, IOR Level 0.5 and no links alone"
        report.lose("material-approximated", name, text)
    return {"edge_tint": True} if is_plain and not tint.is_linked else {}


def _subsurface(shader: bpy.types.Node, name: str, report: Report) -> dict[str, Any]:
    """Scattering inside of light that enters and leaves scattered, by Cycles's mean free paths."""
    weight = _share(shader, "Subsurface Weight")
    if weight == 0:
        return {}
    radius, scale, turn, color = (
        shader.inputs[key]
        for key in ("Subsurface Radius", "Subsurface Scale", "Subsurface Anisotropy", "Base Color")
    )
    linked = (shader.inputs["Subsurface Weight"], radius, scale, turn, color)
    if any(each.is_linked for each in linked) or _number(shader, "Transmission Weight") > 0:
        report.lose("subsurface-dropped", name)
        return {}
    colors, onward = _color(shader, "Base Color"), min(max(turn.default_value, -0.99), 0.9)
    paths_m = [max(each * scale.default_value, 0.0) for each in radius.default_value]
    if max(paths_m) == 0 or max(colors) == 0:
        return {}
    kind, shares = shader.subsurface_method, [0.25 / math.pi] * 3
    scattered = [_entered(part, _number(shader, "IOR")) for part in colors]
    if kind == "BURLEY":
        scattered = colors
        report.lose("material-approximated", name, "Christensen-Burley is a random walk")
    elif kind == "RANDOM_WALK_SKIN":
        ior = min(max(_number(shader, "Subsurface IOR"), 1.01), 3.8)
        shares = [_skin_share(part, ior) for part in colors]
        # Half of the light enters scattered.
        scattered = [(part + _entered(part, ior)) / 2 for part in colors]
    paths_m = [path * share * (1 - onward) for path, share in zip(paths_m, shares, strict=True)]
    longest_m = max(paths_m)
    left = [math.exp(-longest_m / max(path, longest_m * 1e-6)) for path in paths_m]
    look = {"diffuse_transmission": weight, "scattering_color": scattered, **_SOLID}
    look.update(attenuation_color=left, attenuation_distance_m=longest_m)
    return {**look, **({"scattering_anisotropy": onward} if onward != 0 else {})}


def _entered(color: float, ior: float) -> float:
    """Color of a thick solid that light enters refracted by a rough surface, as in Cycles.

    Light gets deeper than light that enters scattered, which would return `color`. From there,
    (1 - q) / (1 + 2 q cosine) of it returns (Hapke 1981), q: root of the share absorbed at a
    scattering, by van de Hulst's fit (1980), as Reflet has it; by the mean cosines of both.
    """
    ior, slope = min(max(ior, 1.01), 3.8), 1.139 + 1.17 * color
    q = (slope - math.sqrt(slope**2 - 4 * 0.139 * (1 - color))) / (2 * 0.139)
    refracted = 2 / 3 * ior**2 * (1 - (1 - 1 / ior**2) ** 1.5)
    return color * (1 + 4 / 3 * q) / (1 + 2 * refracted * q)


def _skin_share(color: float, ior: float) -> float:
    """Mean free path of Cycles's skin over its radius: a dipole's that returns this color.

    Mean free path over diffusion length, by equation 15 of Jensen et al. 2001 solved for the
    albedo, with their fit of the mean Fresnel reflectance.
    """
    mean = (-1.440 / ior + 0.710) / ior + 0.668 + 0.0636 * ior
    inner = 4 / 3 * (1 + mean) / (1 - mean)
    least, most, root = 0.0, 1.0, 0.0
    for _ in range(12):  # as many halvings as in Cycles
        middle = (least + most) / 2
        root = math.sqrt(3 * (1 - middle))
        returned = middle / 2 * (1 + math.exp(-inner * root)) * math.exp(-root)
        least, most = (middle, most) if returned < color else (least, middle)
    return root


def _diffuse(shader: bpy.types.Node, name: str, report: Report) -> dict[str, Any]:
    _name_linked(shader, name, report)
    look = {"base_color": _color(shader, "Color"), "metallic": 0, "roughness": 1, "specular": 0}
    return {**look, **_own_number(shader, "diffuse_roughness", "Roughness", (0.0, 0.0, 1.0))}


def _glossy(shader: bpy.types.Node, name: str, report: Report) -> dict[str, Any]:
    _name_linked(shader, name, report)
    # A metal whose reflectance rises to white at grazing angles, which Glossy's does not.
    report.lose("material-approximated", name, "Glossy is a metal, brighter at grazing angles")
    rough = _share(shader, "Roughness")
    return {"base_color": _color(shader, "Color"), "metallic": 1, "roughness": rough}


def _glass(shader: bpy.types.Node, name: str, report: Report) -> dict[str, Any]:
    _name_linked(shader, name, report)
    ior = min(max(_number(shader, "IOR"), 1.0), 4.0)
    look = {"base_color": _color(shader, "Color"), "metallic": 0, "ior": ior}
    return {**look, "roughness": _share(shader, "Roughness"), "transmission": 1, **_SOLID}


def _refraction(shader: bpy.types.Node, name: str, report: Report) -> dict[str, Any]:
    return {**_glass(shader, name, report), "specular": 0}


def _emission(shader: bpy.types.Node, name: str, report: Report) -> dict[str, Any]:
    _name_linked(shader, name, report)
    look = {"base_color": [0, 0, 0], "specular": 0, "metallic": 0, "roughness": 1}
    strength = max(_number(shader, "Strength"), 0.0)
    color = [max(float(part), 0.0) for part in shader.inputs["Color"].default_value[:3]]
    glow = {"emission": color, "emission_strength": strength}
    return {**look, **glow, "light": strength * max(color) > 0}


def _name_linked(shader: bpy.types.Node, name: str, report: Report) -> None:
    """Inputs of plain shaders count by their own values; the exporter reads Principled's."""
    for socket in shader.inputs:
        if socket.is_linked and socket.name != "Normal":
            text = f"{socket.name} of {shader.bl_label} has its own value, not what is linked to it"
            report.lose("material-approximated", name, text)


_BY_KIND = {
    "BSDF_PRINCIPLED": _principled,
    "BSDF_DIFFUSE": _diffuse,
    "BSDF_GLOSSY": _glossy,
    "BSDF_ANISOTROPIC": _glossy,
    "BSDF_GLASS": _glass,
    "BSDF_REFRACTION": _refraction,
    "EMISSION": _emission,
}
