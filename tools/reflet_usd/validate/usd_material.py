"""Owns the truth about materials: UsdPreviewSurface networks evaluated at texture coordinates."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdShade

from reflet_usd.stage_files import is_plain_file, is_within, read_asset

from .images import Texels, decode, enlarged, linear_to_srgb, sample, srgb_to_linear
from .scene_data import Array

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
    "specularColor": (0.0, 0.0, 0.0),
    "normal": (0.0, 0.0, 1.0),
}
_PREVIEW_SURFACES = ("UsdPreviewSurface", "ND_UsdPreviewSurface_surfaceshader")
"""Identifiers of preview surfaces; the second is MaterialX's."""
TIME = Usd.TimeCode.EarliestTime()
_IDENTITY = np.eye(3)
_MOST_TILED = 8192
"""Pixels across and down of the largest image of UDIM tiles that are not reduced."""
_FEW = 16
_BLOCK = 1 << 18
"""Number of texels that are compared at a time."""


@dataclasses.dataclass
class TextureRead:
    """A read of several channels of a UsdUVTexture."""

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
    prim: str = ""
    """Path of the texture's shader."""
    assumed_space: bool = False
    """Whether the color space depends only on the image format."""

    @property
    def is_plain(self) -> bool:
        """Whether glTF's factors hold the scale of the read, so that texels stay as they are."""
        scale, bias = self.scale[self.channels], self.bias[self.channels]
        return bool((bias == 0.0).all() and ((scale >= 0.0) & (scale <= 1.0)).all())

    @property
    def strongest(self) -> float:
        """Highest value that a texel can give."""
        scale, bias = self.scale[self.channels], self.bias[self.channels]
        return float(np.maximum(bias, scale + bias).max())

    def resized(self, size: tuple[int, int], srgb: bool) -> TextureRead:
        """The read of the image that the documentation says is written at another size.

        Its values are encoded as the slot asks, rounded to 8 bits, and interpolated linearly.
        """
        values = self.texels.values.copy()
        if self.linearize:
            values[:, :, :3] = srgb_to_linear(values[:, :, :3])
        plain = self.is_plain
        if not plain:
            values = np.clip(values * self.scale + self.bias, 0.0, 1.0)
        if srgb:
            values[:, :, :3] = linear_to_srgb(values[:, :, :3])
        texels = Texels(enlarged(np.round(values * 255.0) / 255.0, size), 4, True)
        scale, bias = (self.scale, self.bias) if plain else (np.ones(4), np.zeros(4))
        return dataclasses.replace(self, texels=texels, scale=scale, bias=bias, linearize=srgb)

    def at(self, st: Array) -> Array:
        """Values (n, channels) at primvar coordinates `st`."""
        placed = np.column_stack([st, np.ones(len(st))]) @ self.transform
        uv = np.column_stack([placed[:, 0], 1.0 - placed[:, 1]])
        rgba = sample(self.texels, uv, self.wrap, self.linearize)
        return (rgba * self.scale + self.bias)[:, self.channels]

    def centers(self, whole: bool) -> Iterator[Array]:
        """Primvar coordinates of texel centers, in parts: all of them, or a few."""
        width, height = self.texels.size
        count = width * height
        few = np.random.default_rng(16).integers(0, count, _FEW)
        for first in range(0, count if whole else 1, _BLOCK):
            texel = np.arange(first, min(first + _BLOCK, count)) if whole else few
            place = [(texel % width + 0.5) / width, (texel // width + 0.5) / height]
            uv = np.column_stack([*place, np.ones(len(texel))])
            if abs(np.linalg.det(self.transform)) >= 1e-12:
                uv = uv @ np.linalg.inv(self.transform)
            yield uv[:, :2]


@dataclasses.dataclass
class PreviewInput:
    """One input of a preview surface: a constant, a texture, or something not evaluated."""

    constant: Array | None
    texture: TextureRead | None
    reason: str = ""
    """Reason why the input is not evaluated; empty where it is."""
    fallback: Array | None = None
    """Value that a texture's shader states for the case that its file cannot be read."""
    prim: str = ""
    """Path of the texture's shader, if any."""
    values: Callable[[Array], Array] | None = None
    """Values (n, channels) at texture coordinates, for networks of more than one texture read."""
    primvars: tuple[str, ...] = ()
    """Primvars that hold the coordinates of such networks."""
    images: tuple[str, ...] = ()
    """Paths of their image nodes."""
    sizes: tuple[tuple[int, int], ...] = ()
    """Sizes of their images."""
    nodes: tuple[str, ...] = ()
    """Paths of all their nodes."""

    def without_file(self) -> PreviewInput:
        """The input where the texture's file is lost: its fallback."""
        return PreviewInput(self.fallback, None)


def bound_material(prim: Usd.Prim) -> str:
    """Path of the material bound for final renders, else for previews; empty without."""
    api = UsdShade.MaterialBindingAPI(prim)
    for purpose in (UsdShade.Tokens.full, UsdShade.Tokens.preview):
        material = api.ComputeBoundMaterial(purpose)[0]
        if material:
            return str(material.GetPath())
    return ""


def surface_shader(material: Usd.Prim) -> UsdShade.Shader | None:
    """The shader of the material's surface, for any renderer or for MaterialX; None without."""
    for context in ("", "mtlx"):
        shader = UsdShade.Material(material).ComputeSurfaceSource(context)[0]
        if shader:
            return shader
    return None


def preview_shader(material: Usd.Prim) -> UsdShade.Shader | None:
    """The material's UsdPreviewSurface shader; None where it has another surface or none."""
    shader = surface_shader(material)
    return shader if shader and shader.GetIdAttr().Get() in _PREVIEW_SURFACES else None


def read_input(shader: UsdShade.Shader, name: str, roots: tuple[str, ...]) -> PreviewInput:
    """Input `name` of a preview surface shader; files outside `roots` are lost."""
    fallback = np.array(DEFAULTS.get(name, (0.0,)))
    attribute = producer(shader.GetInput(name))
    if attribute is None:
        return PreviewInput(fallback, None)
    if UsdShade.Input.IsInput(attribute):
        value = attribute.Get(TIME)
        if value is None:
            return PreviewInput(fallback, None)
        number = np.atleast_1d(np.array(value, dtype=np.float64))
        return PreviewInput(number if np.isfinite(number).all() else fallback, None)
    source = UsdShade.Shader(attribute.GetPrim())
    identifier = source.GetIdAttr().Get() or ""
    if identifier == "UsdUVTexture":
        return _texture(source, UsdShade.Output(attribute).GetBaseName(), len(fallback), roots)
    return PreviewInput(None, None, f"comes from a {identifier}")


def producer(source: UsdShade.Input | None) -> Usd.Attribute | None:
    """Attribute from which an input gets its value; None where nothing is authored."""
    if not source:
        return None
    found = UsdShade.Utils.GetValueProducingAttributes(source)
    return found[0] if found else None


def input_value(shader: UsdShade.Shader, name: str, fallback: Any) -> Any:
    """A plain value of input `name`, also from the material's interface."""
    attribute = producer(shader.GetInput(name))
    if attribute is None or not UsdShade.Input.IsInput(attribute):
        return fallback
    value = attribute.Get(TIME)
    return fallback if value is None else value


def _texture(
    shader: UsdShade.Shader, output: str, width: int, roots: tuple[str, ...]
) -> PreviewInput:
    prim = str(shader.GetPath())
    channels = {"r": [0], "g": [1], "b": [2], "a": [3], "rgb": [0, 1, 2]}.get(output, [0])
    if width == 3 and len(channels) == 1:
        channels = channels * 3
    channels = channels[:width]
    stated = np.array(input_value(shader, "fallback", (0.0, 0.0, 0.0, 1.0)), dtype=np.float64)
    fallback = stated[channels]
    attribute = producer(shader.GetInput("file"))
    asset = attribute.Get(TIME) if attribute is not None else None
    if not isinstance(asset, Sdf.AssetPath):
        return PreviewInput(None, None, "names no texture file", fallback, prim)
    texels, grid = None, None
    if "<UDIM>" in asset.path:
        texels, grid = _tiles(attribute, asset.path, roots)
        if texels is not None and grid is None:
            return PreviewInput(None, None, "its tiles have several sizes", fallback, prim)
    else:
        texels = load_texture(asset.resolvedPath, roots)
    if texels is None:
        reason = f"texture {asset.path} cannot be read"
        return PreviewInput(None, None, reason, fallback, prim)
    wraps = tuple(str(input_value(shader, name, "useMetadata")) for name in ("wrapS", "wrapT"))
    # glTF has no black outside of images: as documented, their edge goes on.
    first, second = (w if w in ("repeat", "mirror", "clamp") else "clamp" for w in wraps)
    space = str(input_value(shader, "sourceColorSpace", "auto"))
    linearize = space == "sRGB" or (space == "auto" and texels.eight_bit and texels.channels >= 3)
    placed = _transform(shader)
    if placed is None:
        return PreviewInput(None, None, "its texture coordinates are not a primvar's")
    transform, primvar = placed
    if grid is not None:  # coordinates of the one image that the file has of all tiles
        sides = (max(grid),) * 2 if transform[0, 1] else grid
        transform = transform @ np.diag([1.0 / sides[0], 1.0 / sides[1], 1.0])
        first = second = "clamp"
        texels = _square(texels, grid, sides, fallback)
    read = TextureRead(
        texels,
        channels,
        np.array(input_value(shader, "scale", (1.0, 1.0, 1.0, 1.0)), dtype=np.float64),
        np.array(input_value(shader, "bias", (0.0, 0.0, 0.0, 0.0)), dtype=np.float64),
        (first, second),
        linearize,
        transform,
        primvar,
        prim,
        space == "auto",
    )
    return PreviewInput(None, read, "", fallback, prim)


def _tiles(
    attribute: Usd.Attribute, path: str, roots: tuple[str, ...]
) -> tuple[Texels | None, tuple[int, int] | None]:
    """One image of all UDIM tiles, NaN where there is none, and the numbers of columns and rows.

    The numbers are None where tiles differ in size, or are reduced.
    """
    layer = attribute.GetPropertyStack(TIME)[0].layer
    found = {}
    for place, name in UsdShade.UdimUtils.ResolveUdimTilePaths(path, layer):
        number = int(name) - 1001
        tile = load_texture(place, roots)
        if tile is not None and number >= 0:
            found[number % 10, number // 10] = tile
    if not found:
        return None, None
    columns, rows = (max(key[axis] for key in found) + 1 for axis in (0, 1))
    some = next(iter(found.values()))
    width, height = some.size
    even = all(tile.size == some.size for tile in found.values())
    if not even or columns * width > _MOST_TILED or rows * height > _MOST_TILED:
        return some, None
    whole = np.full((rows * height, columns * width, 4), np.nan)
    for (column, row), tile in found.items():
        bottom = len(whole) - row * height
        whole[bottom - height : bottom, column * width : (column + 1) * width] = tile.values
    channels = max(tile.channels for tile in found.values())
    return Texels(whole, channels, all(tile.eight_bit for tile in found.values())), (columns, rows)


def _square(
    texels: Texels, grid: tuple[int, int], sides: tuple[int, int], fallback: Array
) -> Texels:
    """The image with empty tiles up to `sides`, and the fallback where there is no tile."""
    height, width = texels.values.shape[0] // grid[1], texels.values.shape[1] // grid[0]
    more = (sides[1] - grid[1]) * height, (sides[0] - grid[0]) * width
    values = np.pad(texels.values, ((more[0], 0), (0, more[1]), (0, 0)), constant_values=np.nan)
    plain = np.append(np.resize(np.clip(fallback, 0.0, 1.0), 3), 1.0)
    values = np.where(np.isnan(values), plain, values)
    return dataclasses.replace(texels, values=values)


def _transform(shader: UsdShade.Shader) -> tuple[Array, str] | None:
    """The chain of UsdTransform2d between the texture and its primvar, and the primvar's name."""
    result = _IDENTITY
    attribute = producer(shader.GetInput("st"))
    for _ in range(8):
        if attribute is None or UsdShade.Input.IsInput(attribute):
            return None
        source = UsdShade.Shader(attribute.GetPrim())
        identifier = source.GetIdAttr().Get() or ""
        if identifier.startswith("UsdPrimvarReader"):
            return result, str(input_value(source, "varname", ""))
        if identifier != "UsdTransform2d":
            return None
        result = _transform2d(source) @ result
        attribute = producer(source.GetInput("in"))
    return None


def _transform2d(shader: UsdShade.Shader) -> Array:
    """in · scale · rotation (counter-clockwise, degrees) + translation."""
    scale = np.diag([*map(float, input_value(shader, "scale", (1.0, 1.0))), 1.0])
    angle = np.radians(float(input_value(shader, "rotation", 0.0)))
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    move = np.eye(3)
    move[2, :2] = tuple(map(float, input_value(shader, "translation", (0.0, 0.0))))
    return scale @ turn @ move


def load_texture(resolved: str, roots: tuple[str, ...], clip: bool = True) -> Texels | None:
    """Decode a file within `roots`, or in a (nested) package: `a.usdz[b.usdz[c.png]]`."""
    allowed = resolved and is_within(resolved, roots) and is_plain_file(resolved)
    return decode(read_asset(resolved), clip) if allowed else None
