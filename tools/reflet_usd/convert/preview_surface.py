"""UsdPreviewSurface inputs to a glTF material, both workflows."""

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from pxr import Usd

from .attributes import DisplayColor
from .channel_packing import Channel, Packer
from .context import Context
from .gltf_writer import GltfWriter
from .mesh_light import write_emission
from .sources import Constant, Part, PrimvarRead, Source, TextureRead

# Names and fallbacks: https://openusd.org/release/spec_usdpreviewsurface.html
PREVIEW_INPUTS: dict[str, tuple[float, ...]] = {
    "diffuseColor": (0.18, 0.18, 0.18),
    "emissiveColor": (0.0, 0.0, 0.0),
    "useSpecularWorkflow": (0.0,),
    "specularColor": (0.0, 0.0, 0.0),
    "metallic": (0.0,),
    "roughness": (0.5,),
    "clearcoat": (0.0,),
    "clearcoatRoughness": (0.01,),
    "opacity": (1.0,),
    "opacityMode": (1.0,),
    "opacityThreshold": (0.0,),
    "ior": (1.5,),
    "normal": (0.0, 0.0, 1.0),
    "displacement": (0.0,),
    "occlusion": (1.0,),
}
# Inputs that are one number in glTF, for the whole material.
_WITHOUT_TEXTURE = ("useSpecularWorkflow", "opacityMode", "opacityThreshold", "ior")
# glTF's dielectric reflects ((ior − 1) / (ior + 1))² head on, 0.04 at ior 1.5.
DIELECTRIC_F0 = 0.04

_AFFINE = ("scale", "bias")

Slots = dict[str, int]


def _specular_share(specular: Sequence[float], diffuse: Sequence[float]) -> float:
    """Share of a specular color by which a surface in even light deviates least in glTF.

    There the largest component is taken off all components of the diffuse color, in
    UsdPreviewSurface each off its own.
    """
    strongest = max(specular)
    # The derivative of the squared deviations by the share is 0.
    slopes = [k - strongest * d for k, d in zip(specular, diffuse, strict=True)]
    wanted = [k * (1.0 - d) for k, d in zip(specular, diffuse, strict=True)]
    squares = sum(s * s for s in slopes)
    if squares < 1e-9:
        return 1.0  # colors of one hue, which deviate alike by any share
    best = sum(s * w for s, w in zip(slopes, wanted, strict=True)) / squares
    return min(max(best, 0.0), 1.0)


class PreviewMaterial:
    """Writer of one material; a fresh object per material and UV layout."""

    defaults: ClassVar[dict[str, tuple[float, ...]]] = PREVIEW_INPUTS
    """Values of inputs that nothing gives."""

    def __init__(
        self, context: Context, writer: GltfWriter, packer: Packer, prim: Usd.Prim | None
    ) -> None:
        self.context = context
        self.writer = writer
        self.packer = packer
        self.prim = prim
        self.inputs: dict[str, Source] = {}
        self.slots: Slots = {}

    def write(
        self, inputs: dict[str, Source], slots: Slots, display: DisplayColor, has_colors: bool
    ) -> dict[str, Any]:
        """The glTF material without name and sidedness."""
        self.inputs, self.slots = inputs, slots
        entry: dict[str, Any] = {"pbrMetallicRoughness": {}}
        self._base_color(entry, display, has_colors)
        self._surface_maps(entry)
        self._normal(entry)
        self._emission(entry)
        self._specular(entry)
        self._clearcoat(entry)
        if self._numbers("displacement")[0] != 0.0 or self._texture("displacement"):
            self._warn(
                "displacement-dropped",
                "displaced are meshes that nothing deforms, by 1000 of their sizes at most",
            )
        return entry

    def _warn(self, name: str, message: str) -> None:
        self.context.ledger.warn(name, self.prim, message)

    def _texture(self, name: str) -> TextureRead | None:
        """Texture of the input, where its file can be used."""
        source = self.inputs.get(name)
        if isinstance(source, TextureRead) and self.packer.usable(source):
            return source
        return None

    def _numbers(self, name: str) -> tuple[float, ...]:
        """The input's constant; else a lost texture's or primvar's fallback; else the schema's."""
        default = self.defaults[name]
        if name in _WITHOUT_TEXTURE and self._texture(name):
            message = f"glTF has no texture for '{name}', taken as {default[0]:g}"
            self._warn("material-texture-dropped", message)
            return default
        source = self.inputs.get(name)
        value: tuple[float, ...] | None = None
        if isinstance(source, Constant):
            value = source.value
        elif isinstance(source, PrimvarRead):
            value = source.fallback
        elif isinstance(source, TextureRead):
            value = tuple(part.fallback for part in source.parts)
        if value is None:
            return default
        if len(value) < len(default):
            return (value[0],) * len(default)
        return value[: len(default)]

    def _unit(self, name: str) -> tuple[float, ...]:
        """Like `_numbers`, clamped to 0…1 with a warning."""
        value = self._numbers(name)
        clamped = tuple(min(max(number, 0.0), 1.0) for number in value)
        if clamped != value:
            self._warn("material-value-clamped", f"'{name}' {value} is outside 0…1, clamped")
        return clamped

    def _base_color(self, entry: dict[str, Any], display: DisplayColor, has_colors: bool) -> None:
        diffuse, opacity = self._texture("diffuseColor"), self._texture("opacity")
        color = [1.0, 1.0, 1.0] if diffuse else list(self._unit("diffuseColor"))
        alpha = 1.0 if opacity else self._unit("opacity")[0]
        reads_color = isinstance(self.inputs.get("diffuseColor"), PrimvarRead)
        reads_alpha = isinstance(self.inputs.get("opacity"), PrimvarRead)
        if reads_color:
            color = [1.0, 1.0, 1.0] if has_colors else list(display.constant[:3])
        if reads_alpha:
            alpha = 1.0 if has_colors else display.constant[3]
        translucent = alpha < 1.0 or (reads_alpha and display.translucent)
        channels: list[Channel | None] = [None, None, None, None]
        if diffuse:
            factors, channels[:3] = factored(diffuse, 3)
            color = list(factors)
        elif opacity:
            channels[:3] = [Channel(constant=1.0)] * 3
        if opacity:
            factors, (channels[3],) = factored(opacity, 1)
            alpha = factors[0]
            translucent = alpha < 1.0 or self._lowest(channels[3]) < 1.0
            if not translucent:
                channels[3] = None
                opacity = None
        mode = self._alpha_mode(entry, translucent)
        if diffuse and not opacity and mode == "OPAQUE":
            channels = channels[:3]
        pbr = entry["pbrMetallicRoughness"]
        if diffuse or opacity:
            pbr["baseColorTexture"] = self.packer.texture(channels, True, self.slots)
        pbr["baseColorFactor"] = [*color, alpha]

    def _lowest(self, channel: Channel | None) -> float:
        assert channel is not None and channel.read is not None
        file = self.packer.library.image(channel.read)
        assert file is not None
        is_opaque = channel.index == 3 and not file.has_alpha
        lowest = 1.0 if is_opaque else file.lowest(channel.index)
        return lowest * channel.scale + channel.bias

    def _alpha_mode(self, entry: dict[str, Any], translucent: bool) -> str:
        threshold = self._numbers("opacityThreshold")[0]
        if threshold > 0.0:
            entry["alphaMode"] = "MASK"
            entry["alphaCutoff"] = threshold
        elif translucent:
            entry["alphaMode"] = "BLEND"
            message = "opacity became alpha blending, which also fades reflections"
            self._warn("opacity-approximated", message)
        return str(entry.get("alphaMode", "OPAQUE"))

    def _surface_maps(self, entry: dict[str, Any]) -> None:
        """Metallic, roughness and occlusion: blue, green and red of as few textures as possible."""
        pbr = entry["pbrMetallicRoughness"]
        specular = self._numbers("useSpecularWorkflow")[0] >= 0.5
        rough, metal = self._texture("roughness"), self._texture("metallic")
        if specular:
            metal = None
        roughness = self._unit("roughness")[0]
        metallic = 0.0 if specular else self._unit("metallic")[0]
        green = blue = None
        if rough:
            (roughness,), (green,) = factored(rough, 1)
        elif metal and roughness > 0.0:
            green = Channel(constant=1.0)
        if metal:
            (metallic,), (blue,) = factored(metal, 1)
        elif rough and metallic > 0.0:
            blue = Channel(constant=1.0)
        red = self._occlusion_channel()
        if rough or metal:
            shared = [red, green, blue]
            alone = red is None or self.packer.copy_index([red, None, None], False) is not None
            if alone and self.packer.copy_index(shared, False) is None:
                shared[0] = None
            info = self.packer.texture(shared, False, self.slots)
            pbr["metallicRoughnessTexture"] = info
            if shared[0] is not None:
                entry["occlusionTexture"] = info
                red = None
        if red is not None:
            entry["occlusionTexture"] = self.packer.texture([red, None, None], False, self.slots)
        pbr["metallicFactor"], pbr["roughnessFactor"] = metallic, roughness

    def _occlusion_channel(self) -> Channel | None:
        read = self._texture("occlusion")
        if read is None:
            if self._numbers("occlusion")[0] < 1.0:
                self._warn("occlusion-dropped", "a constant occlusion has no glTF counterpart")
            return None
        part = read.parts[0]
        return Channel(read, part.channel, part.scale, part.bias)

    def _normal(self, entry: dict[str, Any]) -> None:
        info = self.normal_map("normal")
        if info is not None:
            entry["normalTexture"] = info

    def normal_map(self, name: str) -> dict[str, Any] | None:
        """Texture info of a normal map with its scale; None where the input has no texture."""
        read = self._texture(name)
        if read is None:
            if self._numbers(name) != self.defaults[name]:
                self._warn("normal-constant-dropped", "a constant normal has no counterpart")
            return None
        if read.color_space == "auto":
            self._warn("color-space-assumed", "the normal map names no color space, taken as raw")
        parts = (read.parts * 3)[:3]
        scale, bias = (np.array([getattr(part, name) for part in parts]) for name in _AFFINE)
        if np.array_equal(scale, np.ones(3)) and not bias.any():
            message = "the normal map has no scale 2 and bias −1, taken as if it had"
            self._warn("normal-scale-missing", message)
            scale, bias = np.full(3, 2.0), np.full(3, -1.0)
        # USD's normal is texel · scale + bias, glTF's is texel · 2 − 1.
        strength = 1.0
        if scale[0] == scale[1] == -2.0 * bias[0] == -2.0 * bias[1] and scale[0] > 0.0:
            strength = float(scale[0]) / 2.0
            scale[:2], bias[:2] = 2.0, -1.0
        channels: list[Channel | None] = [
            Channel(read, part.channel, float(k) / 2, (float(b) + 1) / 2, raw=True)
            for part, k, b in zip(parts, scale, bias, strict=True)
        ]
        info = self.packer.texture(channels, False, self.slots)
        return {**info, "scale": strength} if strength != 1.0 else info

    def _emission(self, entry: dict[str, Any]) -> None:
        read = self._texture("emissiveColor")
        if read is None:
            emitted = np.array(self._numbers("emissiveColor"))
            color = np.maximum(emitted, 0.0)
            if (emitted < 0.0).any():
                message = f"'emissiveColor' {tuple(emitted.tolist())} is below 0, clamped"
                self._warn("material-value-clamped", message)
        else:
            parts = [_shining(read, part) for part in (read.parts * 3)[:3]]
            color = np.array([factor for factor, _ in parts])
            channels: list[Channel | None] = [channel for _, channel in parts]
            if color.any():
                entry["emissiveTexture"] = self.packer.texture(channels, True, self.slots)
        write_emission(self.writer, entry, color)

    def _specular(self, entry: dict[str, Any]) -> None:
        """Set ior, or the specular workflow: F0 = specularColor through KHR_materials_specular."""
        extensions: dict[str, Any] = {}
        if self._numbers("useSpecularWorkflow")[0] >= 0.5:
            read = self._texture("specularColor")
            if read:
                color, channels = factored(read, 3)
                info = self.packer.texture([*channels], True, self.slots)
                extensions["KHR_materials_specular"] = {"specularColorTexture": info}
            else:
                color = list(self._unit("specularColor"))
                extensions["KHR_materials_specular"] = {}
                varies = isinstance(self.inputs.get("diffuseColor"), PrimvarRead)
                varies = varies or self._texture("diffuseColor") is not None
                diffuse = (1.0,) * 3 if varies else self._numbers("diffuseColor")
                if any((max(color) - k) * d > 0.05 for k, d in zip(color, diffuse, strict=True)):
                    share = _specular_share(color, diffuse)
                    color = [share * k for k in color]
                    message = (
                        "glTF takes the largest component of 'specularColor' off all components"
                        f" of the diffuse color; the file has {share:.2f} of it, to take less"
                    )
                    self._warn("specular-approximated", message)
            factor = [part / DIELECTRIC_F0 for part in color]
            extensions["KHR_materials_specular"]["specularColorFactor"] = factor
        else:
            ior = self._numbers("ior")[0]
            # glTF allows 1 and above, or 0 for "reflects everything".
            if ior == 0.0:
                message = "ior 0 is no refractive index, glTF reflects everything with it"
                self._warn("material-value-invalid", message)
            if ior < 1.0 and ior != 0.0:
                self._warn("material-value-clamped", f"ior {ior} is below 1, taken as 1")
                ior = 1.0
            if ior != 1.5:
                extensions["KHR_materials_ior"] = {"ior": ior}
        self.extend(entry, extensions)

    def _clearcoat(self, entry: dict[str, Any]) -> None:
        coat, rough = self._texture("clearcoat"), self._texture("clearcoatRoughness")
        factor = self._unit("clearcoat")[0]
        if coat is None and factor == 0.0:
            return
        extension: dict[str, Any] = {
            "clearcoatFactor": factor,
            "clearcoatRoughnessFactor": self._unit("clearcoatRoughness")[0],
        }
        if coat:
            extension |= self._textured("clearcoat", coat, 0)
        if rough:
            extension |= self._textured("clearcoatRoughness", rough, 1)
        self.extend(entry, {"KHR_materials_clearcoat": extension})

    def _textured(self, key: str, read: TextureRead, place: int) -> dict[str, Any]:
        """Factor and texture of one number, which the texture holds in the channel `place`."""
        (factor,), (channel,) = factored(read, 1)
        channels: list[Channel | None] = [None] * max(3, place + 1)
        channels[place] = channel
        info = self.packer.texture(channels, False, self.slots)
        return {f"{key}Factor": factor, f"{key}Texture": info}

    def extend(self, entry: dict[str, Any], extensions: dict[str, Any]) -> None:
        """Add extensions to the material."""
        for name in extensions:
            self.writer.use_extension(name)
        if extensions:
            entry.setdefault("extensions", {}).update(extensions)


def _shining(read: TextureRead, part: Part) -> tuple[float, Channel]:
    """Emissive factor, and the scale that is left for the texels, whose values stay within 0…1."""
    scale, bias = part.scale, part.bias
    if bias == 0.0 and scale >= 0.0:
        return scale, Channel(read, part.channel)
    strongest = max(1.0, bias, scale + bias)
    return strongest, Channel(read, part.channel, scale / strongest, bias / strongest)


def factored(read: TextureRead, count: int) -> tuple[list[float], list[Channel | None]]:
    """Factors and remaining channels of a read: a plain scale within 0…1 becomes the factor."""
    factors: list[float] = []
    channels: list[Channel | None] = []
    for part in (read.parts * count)[:count]:
        plain = part.bias == 0.0 and 0.0 <= part.scale <= 1.0
        factors.append(part.scale if plain else 1.0)
        scale, bias = (1.0, 0.0) if plain else (part.scale, part.bias)
        channels.append(Channel(read, part.channel, scale, bias))
    return factors, channels
