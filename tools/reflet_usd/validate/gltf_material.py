"""Owns evaluating a glTF material's channels at texture coordinates, from the re-read file."""

import functools
from typing import Any

import numpy as np

from .gltf_file import GltfFile
from .images import Texels, decode, sample
from .scene_data import Array

_CHANNELS = {"opacity": [3], "metallic": [2], "roughness": [1], "occlusion": [0]}
_WRAP_NAMES = {10497: "repeat", 33648: "mirror", 33071: "clamp"}


def is_mesh_light(material: Any) -> bool:
    """Whether the material is marked as a light, by its extras."""
    return isinstance((material.extras or {}).get("mesh_light"), dict)


class OutputMaterial:
    """One material of a file; its channels are named like UsdPreviewSurface inputs."""

    def __init__(self, file: GltfFile, index: int) -> None:
        self.file = file
        self.material = file.materials[index]
        self.extensions: dict[str, Any] = self.material.extensions or {}
        self.pbr = self.material.pbrMetallicRoughness

    def channel(self, name: str, st: Array) -> Array:
        """Values (n, 1 or 3) of channel `name` at primvar coordinates `st` (t upward)."""
        return getattr(self, "_" + name)(st)

    def texcoord(self, name: str) -> int | None:
        """The UV set that the texture of channel `name` reads; None without such a texture."""
        info = self._info(name)
        if info is None:
            return None
        own = info if isinstance(info, dict) else vars(info)
        moved = (own.get("extensions") or {}).get("KHR_texture_transform", {})
        return int(moved.get("texCoord", own.get("texCoord") or 0))

    def image(self, name: str) -> Texels | None:
        """The image of channel `name`; None without one that can be read."""
        info = self._info(name)
        if info is None:
            return None
        index = info["index"] if isinstance(info, dict) else info.index
        return _texels(self.file, self.file.gltf.textures[index].source)

    def wrap(self, name: str) -> tuple[str, str]:
        """Wrap modes of the texture of channel `name`."""
        info = self._info(name)
        index = info["index"] if isinstance(info, dict) else info.index
        return self._wrap(self.file.gltf.textures[index])

    def spread(self, name: str) -> float:
        """Range over which the texels of channel `name` move its value; 0 without a texture."""
        texels = self.image(name)
        if texels is None:
            return 0.0
        channels = _CHANNELS.get(name, [0, 1, 2])
        return float(np.ptp(texels.values[:, :, channels], axis=(0, 1)).max()) * self._factor(name)

    def _factor(self, name: str) -> float:
        """The largest factor that multiplies the texels of a channel that may share them."""
        base = (self.pbr and self.pbr.baseColorFactor) or (1.0, 1.0, 1.0, 1.0)
        stated = {
            "diffuseColor": max(base[:3]),
            "opacity": base[3],
            "metallic": self.pbr and self.pbr.metallicFactor,
            "roughness": self.pbr and self.pbr.roughnessFactor,
        }.get(name)
        return 1.0 if stated is None else float(stated)

    def has_image(self, name: str) -> bool:
        """Whether channel `name` has a texture."""
        return self._info(name) is not None

    def _wrap(self, texture: Any) -> tuple[str, str]:
        if texture.sampler is None:
            return ("repeat", "repeat")
        sampler = self.file.gltf.samplers[texture.sampler]
        codes = (sampler.wrapS or 10497, sampler.wrapT or 10497)
        return (_WRAP_NAMES[codes[0]], _WRAP_NAMES[codes[1]])

    def _info(self, name: str) -> Any:
        pbr, material = self.pbr, self.material
        specular = self.extensions.get("KHR_materials_specular", {})
        coat = self.extensions.get("KHR_materials_clearcoat", {})
        slots = {
            "diffuseColor": pbr and pbr.baseColorTexture,
            "opacity": pbr and pbr.baseColorTexture,
            "metallic": pbr and pbr.metallicRoughnessTexture,
            "roughness": pbr and pbr.metallicRoughnessTexture,
            "emissiveColor": material.emissiveTexture,
            "occlusion": material.occlusionTexture,
            "normal": material.normalTexture,
            "specularColor": specular.get("specularColorTexture"),
            "clearcoat": coat.get("clearcoatTexture"),
            "clearcoatRoughness": coat.get("clearcoatRoughnessTexture"),
        }
        return slots.get(name)

    def _diffuseColor(self, st: Array) -> Array:  # noqa: N802 - named as the USD input
        return self._base(st)[:, :3]

    def _opacity(self, st: Array) -> Array:
        return self._base(st)[:, 3:]

    def _base(self, st: Array) -> Array:
        factor = self.pbr.baseColorFactor if self.pbr else None
        texture = self.pbr.baseColorTexture if self.pbr else None
        result = np.tile(np.array(factor or (1.0, 1.0, 1.0, 1.0)), (len(st), 1))
        return result * self._texture(texture, st, linearize=True)

    def _metallic(self, st: Array) -> Array:
        return self._metal_rough(st, "metallicFactor", 2)

    def _roughness(self, st: Array) -> Array:
        return self._metal_rough(st, "roughnessFactor", 1)

    def _metal_rough(self, st: Array, factor_name: str, channel: int) -> Array:
        factor = getattr(self.pbr, factor_name) if self.pbr else None
        texture = self.pbr.metallicRoughnessTexture if self.pbr else None
        values = self._texture(texture, st, linearize=False)[:, channel : channel + 1]
        return values * (1.0 if factor is None else factor)

    def _emissiveColor(self, st: Array) -> Array:  # noqa: N802
        strength = self.extensions.get("KHR_materials_emissive_strength", {})
        factor = np.array(self.material.emissiveFactor or (0.0, 0.0, 0.0))
        factor = factor * strength.get("emissiveStrength", 1.0)
        return factor * self._texture(self.material.emissiveTexture, st, linearize=True)[:, :3]

    def _occlusion(self, st: Array) -> Array:
        info = self.material.occlusionTexture
        strength = 1.0 if info is None or info.strength is None else info.strength
        values = self._texture(info, st, linearize=False)[:, :1]
        return 1.0 + strength * (values - 1.0)

    def _normal(self, st: Array) -> Array:
        info = self.material.normalTexture
        if info is None:
            return np.tile([0.0, 0.0, 1.0], (len(st), 1))
        scale = 1.0 if info.scale is None else info.scale
        values = self._texture(info, st, linearize=False)[:, :3] * 2.0 - 1.0
        return values * np.array([scale, scale, 1.0])

    def _clearcoat(self, st: Array) -> Array:
        coat = self.extensions.get("KHR_materials_clearcoat", {})
        values = self._texture(coat.get("clearcoatTexture"), st, linearize=False)[:, :1]
        return values * coat.get("clearcoatFactor", 0.0)

    def _clearcoatRoughness(self, st: Array) -> Array:  # noqa: N802
        coat = self.extensions.get("KHR_materials_clearcoat", {})
        texture = coat.get("clearcoatRoughnessTexture")
        values = self._texture(texture, st, linearize=False)[:, 1:2]
        return values * coat.get("clearcoatRoughnessFactor", 0.0)

    def _specularColor(self, st: Array) -> Array:  # noqa: N802
        """The color reflected head on by a surface of ior 1.5, which is 0.04 times the factor."""
        specular = self.extensions.get("KHR_materials_specular", {})
        factor = np.array(specular.get("specularColorFactor", (1.0, 1.0, 1.0)))
        values = self._texture(specular.get("specularColorTexture"), st, linearize=True)[:, :3]
        return 0.04 * factor * values

    def _specular(self, st: Array) -> Array:
        return self._layer(st, "specular", "specular", [3], (1.0,))

    def _specularTint(self, st: Array) -> Array:  # noqa: N802
        return self._layer(st, "specular", "specularColor", [0, 1, 2], (1.0,) * 3)

    def _sheenColor(self, st: Array) -> Array:  # noqa: N802
        return self._layer(st, "sheen", "sheenColor", [0, 1, 2], (0.0,) * 3)

    def _transmission(self, st: Array) -> Array:
        return self._layer(st, "transmission", "transmission", [0], (0.0,))

    def _thickness(self, st: Array) -> Array:
        return self._layer(st, "volume", "thickness", [1], (0.0,))

    def _attenuationColor(self, st: Array) -> Array:  # noqa: N802
        volume = self.extensions.get("KHR_materials_volume", {})
        return np.tile(volume.get("attenuationColor", (1.0, 1.0, 1.0)), (len(st), 1))

    def _attenuationDistance(self, st: Array) -> Array:  # noqa: N802
        volume = self.extensions.get("KHR_materials_volume", {})
        return np.full((len(st), 1), volume.get("attenuationDistance", 0.0))

    def _layer(
        self, st: Array, name: str, key: str, channels: list[int], default: tuple[float, ...]
    ) -> Array:
        """Factor times texture of an extension's layer; the default where it is not there."""
        fields = self.extensions.get(f"KHR_materials_{name}", {})
        factor = np.array(fields.get(f"{key}Factor", default), dtype=np.float64)
        texels = self._texture(fields.get(f"{key}Texture"), st, linearize=len(channels) == 3)
        return factor * texels[:, channels]

    def _ior(self, st: Array) -> Array:
        ior = self.extensions.get("KHR_materials_ior", {}).get("ior", 1.5)
        return np.full((len(st), 1), ior)

    def _texture(self, info: Any, st: Array, linearize: bool) -> Array:
        """(n, 4) texels; ones where there is no texture."""
        if info is None:
            return np.ones((len(st), 4))
        index = info["index"] if isinstance(info, dict) else info.index
        extensions = (info.get("extensions") if isinstance(info, dict) else info.extensions) or {}
        uv = np.column_stack([st[:, 0], 1.0 - st[:, 1]])
        moved = extensions.get("KHR_texture_transform")
        if moved:
            uv = _moved(uv, moved)
        texture = self.file.gltf.textures[index]
        texels = _texels(self.file, texture.source)
        if texels is None:
            return np.full((len(st), 4), np.nan)
        return sample(texels, uv, self._wrap(texture), linearize)


def _moved(uv: Array, transform: dict[str, Any]) -> Array:
    """Coordinates after KHR_texture_transform, by its text, not its sample matrix (glTF#1563)."""
    scaled = uv * np.array(transform.get("scale", (1.0, 1.0)))
    angle = transform.get("rotation", 0.0)
    cosine, sine = np.cos(angle), np.sin(angle)
    turned = np.column_stack(
        [
            cosine * scaled[:, 0] + sine * scaled[:, 1],
            -sine * scaled[:, 0] + cosine * scaled[:, 1],
        ]
    )
    return turned + np.array(transform.get("offset", (0.0, 0.0)))


@functools.lru_cache(maxsize=2)  # an image of 4096 × 4096 takes 0.5 GiB here
def _texels(file: GltfFile, image: int) -> Texels | None:
    return decode(file.image_bytes(image))
