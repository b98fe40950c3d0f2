"""MaterialX surfaces (standard surface, OpenPBR, glTF PBR) approximated by preview inputs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from pxr import Sdf, Usd, UsdShade

from reflet_usd.convert.network import (
    Constant,
    NetworkReader,
    Source,
    TextureRead,
    UvRead,
    shader_id,
)

# Preview input -> MaterialX input, per surface node.
MATERIALX_SURFACES: dict[str, dict[str, str]] = {
    "ND_standard_surface_surfaceshader": {
        "diffuseColor": "base_color",
        "metallic": "metalness",
        "roughness": "specular_roughness",
        "ior": "specular_IOR",
        "clearcoat": "coat",
        "clearcoatRoughness": "coat_roughness",
        "emissiveColor": "emission_color",
        "opacity": "opacity",
    },
    "ND_open_pbr_surface_surfaceshader": {
        "diffuseColor": "base_color",
        "metallic": "base_metalness",
        "roughness": "specular_roughness",
        "ior": "specular_ior",
        "clearcoat": "coat_weight",
        "clearcoatRoughness": "coat_roughness",
        "emissiveColor": "emission_color",
        "opacity": "geometry_opacity",
    },
    "ND_gltf_pbr_surfaceshader": {
        "diffuseColor": "base_color",
        "metallic": "metallic",
        "roughness": "roughness",
        "ior": "ior",
        "clearcoat": "clearcoat",
        "clearcoatRoughness": "clearcoat_roughness",
        "emissiveColor": "emissive",
        "opacity": "alpha",
    },
}
# Fallbacks that differ from UsdPreviewSurface's (MaterialX node definitions).
_DEFAULTS: dict[str, dict[str, tuple[float, ...]]] = {
    "ND_standard_surface_surfaceshader": {
        "diffuseColor": (0.8, 0.8, 0.8),
        "emissiveColor": (1.0, 1.0, 1.0),
        "roughness": (0.2,),
        "clearcoatRoughness": (0.1,),
    },
    "ND_open_pbr_surface_surfaceshader": {
        "diffuseColor": (0.8, 0.8, 0.8),
        "emissiveColor": (1.0, 1.0, 1.0),
        "roughness": (0.3,),
        "clearcoatRoughness": (0.0,),
    },
    "ND_gltf_pbr_surfaceshader": {
        "diffuseColor": (1.0, 1.0, 1.0),
        "metallic": (1.0,),
        "roughness": (1.0,),
        "clearcoatRoughness": (0.0,),
    },
}
_WEIGHTS = {
    "ND_standard_surface_surfaceshader": {"diffuseColor": "base", "emissiveColor": "emission"},
    "ND_open_pbr_surface_surfaceshader": {
        "diffuseColor": "base_weight",
        "emissiveColor": "emission_luminance",
    },
    "ND_gltf_pbr_surfaceshader": {"emissiveColor": "emissive_strength"},
}
_WEIGHT_DEFAULTS = {"base": 1.0, "base_weight": 1.0, "emissive_strength": 1.0}
_IMAGES = ("ND_image_", "ND_tiledimage_", "ND_gltf_image_", "ND_gltf_colorimage")
_WRAPS = {"periodic": "repeat", "clamp": "clamp", "mirror": "mirror", "constant": "black"}


def approximate(
    reader: NetworkReader, prim: Usd.Prim, shader: UsdShade.Shader, kind: str
) -> dict[str, Source]:
    """Preview inputs for the surface; inputs that they cannot express give one warning."""
    inputs: dict[str, Source] = {name: Constant(value) for name, value in _DEFAULTS[kind].items()}
    mapped = MATERIALX_SURFACES[kind]
    for name, other in mapped.items():
        source = _source(reader, shader, other)
        if source is not None:
            inputs[name] = source
    for name, weight_name in _WEIGHTS[kind].items():
        weight = reader.value(shader, weight_name, _WEIGHT_DEFAULTS.get(weight_name, 0.0))
        if name in inputs and isinstance(weight, (int, float)) and weight != 1.0:
            inputs[name] = _weighted(inputs[name], float(weight))
    known = {*mapped.values(), *_WEIGHTS[kind].values()}
    dropped = [
        str(entry.GetBaseName())
        for entry in shader.GetInputs()
        if entry.GetBaseName() not in known and entry.GetValueProducingAttributes()
    ]
    lost = f"; without {', '.join(sorted(dropped))}" if dropped else ""
    message = f"{kind} is approximated by the metallic-roughness model{lost}"
    reader.context.ledger.warn("material-approximated", prim, message)
    return inputs


def _weighted(source: Source, weight: float) -> Source:
    if isinstance(source, Constant):
        return Constant(tuple(value * weight for value in source.value))
    if isinstance(source, TextureRead):
        red, green, blue, alpha = source.scale
        return replace(source, scale=(red * weight, green * weight, blue * weight, alpha))
    return source


def _source(reader: NetworkReader, shader: UsdShade.Shader, name: str) -> Source | None:
    shader_input = shader.GetInput(name)
    attributes = shader_input.GetValueProducingAttributes() if shader_input else []
    if attributes:
        node = UsdShade.Shader(attributes[0].GetPrim())
        if shader_id(node).startswith(_IMAGES):
            return _image(reader, node, shader_input.GetAttr().GetColorSpace())
    return reader.source(shader, name)


def _image(reader: NetworkReader, node: UsdShade.Shader, color_space: str) -> TextureRead:
    """Texture read of a MaterialX image node; only the default texture coordinates are followed."""
    reader.visit(node)
    uv = UvRead()
    if "tiledimage" in shader_id(node):
        tiling, offset = (
            _pair(reader.value(node, f"uv{name}", None), default)
            for name, default in (("tiling", 1.0), ("offset", 0.0))
        )
        uv = UvRead(scale=tiling, translation=(-offset[0], -offset[1]))
    file_input = node.GetInput("file")
    asset = reader.value(node, "file", None)
    if not isinstance(asset, Sdf.AssetPath):
        asset = Sdf.AssetPath("")
    named = color_space or (file_input.GetAttr().GetColorSpace() if file_input else "")
    kind = shader_id(node)
    encoded = "sRGB" if "srgb" in named.lower() else "raw"
    channels = (0,) if kind.endswith("_float") else (0, 1, 2)
    wrap = tuple(
        _WRAPS.get(str(reader.value(node, f"{axis}addressmode", "periodic")), "repeat")
        for axis in "uv"
    )
    return TextureRead(
        prim=str(node.GetPath()),
        file=asset.resolvedPath,
        authored_file=asset.path,
        channels=channels,
        uv=uv,
        wrap=(wrap[0], wrap[1]),
        color_space=encoded,
    )


def _pair(value: object, default: float) -> tuple[float, float]:
    """The first two numbers of a value; one number counts twice."""
    numbers = np.array(default if value is None else value, dtype=np.float64).reshape(-1)
    first, last = (float(number) for number in np.resize(numbers, 2))
    return first, last
