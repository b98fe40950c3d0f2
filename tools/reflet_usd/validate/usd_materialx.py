"""Owns the truth about MaterialX surfaces: the rule by which a file approximates them."""

from __future__ import annotations

import dataclasses

import numpy as np
from pxr import Sdf, Usd, UsdShade

from .scene_data import Array
from .usd_material import (
    DEFAULTS,
    TIME,
    PreviewInput,
    TextureRead,
    input_value,
    load_texture,
    producer,
    surface_shader,
)
from .usd_stage import is_within


@dataclasses.dataclass(frozen=True)
class _Slot:
    """Place of a channel's value, and the node definition's default for it."""

    name: str
    default: tuple[float, ...] = ()
    weight: str = ""
    weight_default: float = 1.0


_WHITE = (1.0, 1.0, 1.0)
_GRAY = (0.8, 0.8, 0.8)
_SURFACES: dict[str, dict[str, _Slot]] = {
    "ND_standard_surface_surfaceshader": {
        "diffuseColor": _Slot("base_color", _GRAY, "base"),
        "metallic": _Slot("metalness"),
        "roughness": _Slot("specular_roughness", (0.2,)),
        "ior": _Slot("specular_IOR"),
        "clearcoat": _Slot("coat"),
        "clearcoatRoughness": _Slot("coat_roughness", (0.1,)),
        "emissiveColor": _Slot("emission_color", _WHITE, "emission", 0.0),
        "opacity": _Slot("opacity"),
    },
    "ND_open_pbr_surface_surfaceshader": {
        "diffuseColor": _Slot("base_color", _GRAY, "base_weight"),
        "metallic": _Slot("base_metalness"),
        "roughness": _Slot("specular_roughness", (0.3,)),
        "ior": _Slot("specular_ior"),
        "clearcoat": _Slot("coat_weight"),
        "clearcoatRoughness": _Slot("coat_roughness", (0.0,)),
        "emissiveColor": _Slot("emission_color", _WHITE, "emission_luminance", 0.0),
        "opacity": _Slot("geometry_opacity"),
    },
    "ND_gltf_pbr_surfaceshader": {
        "diffuseColor": _Slot("base_color", _WHITE),
        "metallic": _Slot("metallic", (1.0,)),
        "roughness": _Slot("roughness", (1.0,)),
        "ior": _Slot("ior"),
        "clearcoat": _Slot("clearcoat"),
        "clearcoatRoughness": _Slot("clearcoat_roughness", (0.0,)),
        "emissiveColor": _Slot("emissive", (), "emissive_strength"),
        "opacity": _Slot("alpha"),
    },
}
_IMAGES = ("ND_image_", "ND_tiledimage_", "ND_gltf_image_", "ND_gltf_colorimage")
_WRAPS = {"clamp": "clamp", "mirror": "mirror"}
_NEUTRAL = ("displacement", "useSpecularWorkflow")


def surface_inputs(identifier: str) -> set[str]:
    """Inputs of a MaterialX surface, from which the file's approximated values follow."""
    slots = _SURFACES.get(identifier, {}).values()
    return {name for slot in slots for name in (slot.name, slot.weight) if name}


def materialx_inputs(
    material: Usd.Prim, roots: tuple[str, ...] | None
) -> dict[str, PreviewInput] | None:
    """Channels of a surface that the documentation says is approximated; None for others."""
    shader = surface_shader(material)
    slots = _SURFACES.get(str(shader.GetIdAttr().Get())) if shader else None
    if slots is None:
        return None
    result = {name: PreviewInput(np.array(value), None) for name, value in DEFAULTS.items()}
    result.update({name: PreviewInput(np.zeros(1), None) for name in _NEUTRAL})
    for name, slot in slots.items():
        weight = 1.0
        if slot.weight:
            weight = float(input_value(shader, slot.weight, slot.weight_default))
        default = np.array(slot.default or DEFAULTS[name])
        result[name] = _channel(shader, slot.name, default, weight, roots)
    return result


def _channel(
    shader: UsdShade.Shader,
    name: str,
    default: Array,
    weight: float,
    roots: tuple[str, ...] | None,
) -> PreviewInput:
    attribute = producer(shader.GetInput(name))
    if attribute is None:
        return PreviewInput(default * weight, None)
    if UsdShade.Input.IsInput(attribute):
        value = attribute.Get(TIME)
        numbers = default if value is None else np.atleast_1d(np.array(value, dtype=np.float64))
        numbers = numbers if np.isfinite(numbers).all() else default
        # A colored opacity counts by its red; a number in place of a color is gray.
        return PreviewInput(np.resize(numbers, len(default)) * weight, None)
    node = UsdShade.Shader(attribute.GetPrim())
    if not str(node.GetIdAttr().Get()).startswith(_IMAGES):
        return PreviewInput(None, None, "comes from a node")
    return _image(node, shader.GetInput(name), len(default), weight, roots)


def _image(
    node: UsdShade.Shader,
    reader: UsdShade.Input,
    width: int,
    weight: float,
    roots: tuple[str, ...] | None,
) -> PreviewInput:
    prim, fallback = str(node.GetPath()), np.zeros(width)
    source = producer(node.GetInput("file"))
    asset = source.Get(TIME) if source is not None else None
    texels = None
    if isinstance(asset, Sdf.AssetPath) and (roots is None or is_within(asset.resolvedPath, roots)):
        texels = load_texture(asset.resolvedPath)
    if texels is None:
        return PreviewInput(None, None, "its image cannot be read", fallback, prim)
    spaces = [reader.GetAttr().GetColorSpace(), source.GetColorSpace() if source else ""]
    modes = (str(input_value(node, f"{axis}addressmode", "periodic")) for axis in "uv")
    first, second = (_WRAPS.get(mode, "repeat") for mode in modes)
    scale = np.array([weight, weight, weight, 1.0])
    read = TextureRead(
        texels,
        [0, 1, 2][:width],
        scale,
        np.zeros(4),
        (first, second),
        "srgb" in next(filter(None, spaces), "").lower(),
        _tiling(node),
        "",
        prim,
    )
    return PreviewInput(None, read, "", fallback, prim)


def _tiling(node: UsdShade.Shader) -> Array:
    """Matrix (3, 3) of a tiled image for row vectors: in · uvtiling − uvoffset; else identity."""
    result = np.eye(3)
    if "tiledimage" in str(node.GetIdAttr().Get()):
        np.fill_diagonal(result[:2, :2], np.array(input_value(node, "uvtiling", (1.0, 1.0))))
        result[2, :2] = -np.array(input_value(node, "uvoffset", (0.0, 0.0)), dtype=np.float64)
    return result
