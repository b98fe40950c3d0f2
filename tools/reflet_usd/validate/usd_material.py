"""Owns the truth about materials: UsdPreviewSurface networks evaluated at texture coordinates."""

from __future__ import annotations

import dataclasses
import re
import zipfile
from io import BytesIO
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdShade

from .facts import Array
from .images import Texels, decode, sample

DEFAULTS: dict[str, tuple[float, ...]] = {
    "diffuseColor": (0.18, 0.18, 0.18),
    "emissiveColor": (0.0, 0.0, 0.0),
    "metallic": (0.0,),
    "roughness": (0.5,),
    "opacity": (1.0,),
    "opacityThreshold": (0.0,),
    "ior": (1.5,),
    "clearcoat": (0.0,),
    "clearcoatRoughness": (0.01,),
    "occlusion": (1.0,),
    "normal": (0.0, 0.0, 1.0),
}
_TIME = Usd.TimeCode.EarliestTime()
_IDENTITY = np.eye(3)


@dataclasses.dataclass
class TextureRead:
    """One channel group read from a UsdUVTexture."""

    texels: Texels
    channels: list[int]
    scale: Array
    bias: Array
    wrap: tuple[str, str]
    linearize: bool
    transform: Array
    """(3, 3) acting on row vectors (s, t, 1), from the primvar to the texture."""
    primvar: str = ""
    """Name of the primvar that holds the texture coordinates."""

    def at(self, st: Array) -> Array:
        """Values (n, channels) at primvar coordinates `st`."""
        placed = np.column_stack([st, np.ones(len(st))]) @ self.transform
        uv = np.column_stack([placed[:, 0], 1.0 - placed[:, 1]])
        rgba = sample(self.texels, uv, self.wrap, self.linearize)
        return (rgba * self.scale + self.bias)[:, self.channels]

    def centers(self, count: int) -> Array:
        """Primvar coordinates that fall on `count` texel centers, the same ones each run."""
        width, height = self.texels.size
        random = np.random.default_rng(16)
        column = random.integers(0, width, count)
        row = random.integers(0, height, count)
        uv = np.column_stack([(column + 0.5) / width, (row + 0.5) / height, np.ones(count)])
        if abs(np.linalg.det(self.transform)) < 1e-12:
            return uv[:, :2]
        return (uv @ np.linalg.inv(self.transform))[:, :2]


@dataclasses.dataclass
class PreviewInput:
    """One input of a preview surface: a constant, a texture, or something not evaluated."""

    constant: Array | None
    texture: TextureRead | None
    reason: str = ""
    """Why it is not evaluated; empty when it is."""


def preview_shader(material: Usd.Prim) -> UsdShade.Shader | None:
    """The material's UsdPreviewSurface shader; None where it has another surface or none."""
    shader = UsdShade.Material(material).ComputeSurfaceSource()[0]
    if shader and shader.GetIdAttr().Get() == "UsdPreviewSurface":
        return shader
    return None


def read_input(shader: UsdShade.Shader, name: str) -> PreviewInput:
    """Input `name` of a preview surface shader."""
    fallback = np.array(DEFAULTS[name])
    attribute = _producer(shader.GetInput(name))
    if attribute is None:
        return PreviewInput(fallback, None)
    if UsdShade.Input.IsInput(attribute):
        value = attribute.Get(_TIME)
        if value is None:
            return PreviewInput(fallback, None)
        return PreviewInput(np.atleast_1d(np.array(value, dtype=np.float64)), None)
    source = UsdShade.Shader(attribute.GetPrim())
    identifier = source.GetIdAttr().Get() or ""
    if identifier == "UsdUVTexture":
        return _texture(source, UsdShade.Output(attribute).GetBaseName(), len(fallback))
    return PreviewInput(None, None, f"comes from a {identifier}")


def _producer(source: UsdShade.Input | None) -> Usd.Attribute | None:
    if not source:
        return None
    found = UsdShade.Utils.GetValueProducingAttributes(source)
    return found[0] if found else None


def _value(shader: UsdShade.Shader, name: str, fallback: Any) -> Any:
    attribute = _producer(shader.GetInput(name))
    if attribute is None or not UsdShade.Input.IsInput(attribute):
        return fallback
    value = attribute.Get(_TIME)
    return fallback if value is None else value


def _texture(shader: UsdShade.Shader, output: str, width: int) -> PreviewInput:
    attribute = _producer(shader.GetInput("file"))
    asset = attribute.Get(_TIME) if attribute is not None else None
    if not isinstance(asset, Sdf.AssetPath) or "<UDIM>" in asset.path:
        return PreviewInput(None, None, "names no single texture file")
    texels = _load(asset.resolvedPath)
    if texels is None:
        return PreviewInput(None, None, f"texture {asset.path} cannot be read")
    wraps = tuple(str(_value(shader, name, "useMetadata")) for name in ("wrapS", "wrapT"))
    # Sampled at texel centers inside the image, black and useMetadata act as repeat does.
    first, second = (w if w in ("repeat", "mirror", "clamp") else "repeat" for w in wraps)
    space = str(_value(shader, "sourceColorSpace", "auto"))
    linearize = space == "sRGB" or (space == "auto" and texels.eight_bit and texels.channels >= 3)
    channels = {"r": [0], "g": [1], "b": [2], "a": [3], "rgb": [0, 1, 2]}.get(output, [0])
    placed = _transform(shader)
    if placed is None:
        return PreviewInput(None, None, "its texture coordinates are not a primvar's")
    transform, primvar = placed
    if width == 3 and len(channels) == 1:
        channels = channels * 3
    read = TextureRead(
        texels,
        channels[:width],
        np.array(_value(shader, "scale", (1.0, 1.0, 1.0, 1.0)), dtype=np.float64),
        np.array(_value(shader, "bias", (0.0, 0.0, 0.0, 0.0)), dtype=np.float64),
        (first, second),
        linearize,
        transform,
        primvar,
    )
    return PreviewInput(None, read)


def _transform(shader: UsdShade.Shader) -> tuple[Array, str] | None:
    """The chain of UsdTransform2d between the texture and its primvar, and the primvar's name."""
    result = _IDENTITY
    attribute = _producer(shader.GetInput("st"))
    for _ in range(8):
        if attribute is None or UsdShade.Input.IsInput(attribute):
            return None
        source = UsdShade.Shader(attribute.GetPrim())
        identifier = source.GetIdAttr().Get() or ""
        if identifier.startswith("UsdPrimvarReader"):
            return result, str(_value(source, "varname", ""))
        if identifier != "UsdTransform2d":
            return None
        result = _transform2d(source) @ result
        attribute = _producer(source.GetInput("in"))
    return None


def _transform2d(shader: UsdShade.Shader) -> Array:
    """in · scale · rotation (counter-clockwise, degrees) + translation."""
    scale = np.diag([*map(float, _value(shader, "scale", (1.0, 1.0))), 1.0])
    angle = np.radians(float(_value(shader, "rotation", 0.0)))
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    move = np.eye(3)
    move[2, :2] = tuple(map(float, _value(shader, "translation", (0.0, 0.0))))
    return scale @ turn @ move


def _load(resolved: str) -> Texels | None:
    """Decode a texture file, or one inside (nested) usdz packages: `a.usdz[b.usdz[c.png]]`."""
    parts = re.split(r"[\[\]]+", resolved.rstrip("]"))
    try:
        with open(parts[0], "rb") as stream:
            data = stream.read()
        for name in parts[1:]:
            with zipfile.ZipFile(BytesIO(data)) as package:
                data = package.read(name)
    except (OSError, KeyError, zipfile.BadZipFile):
        return None
    return decode(data)
