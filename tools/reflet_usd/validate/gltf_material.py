"""Owns evaluating a glTF material's channels at texture coordinates, from the re-read file."""

import functools
from typing import Any, NamedTuple

import numpy as np

from .gltf_file import GltfFile
from .images import Texels, decode, sample
from .scene_data import Array

_WRAP_NAMES = {10497: "repeat", 33648: "mirror", 33071: "clamp"}
_RGB = [0, 1, 2]
_BLACK, _WHITE = (0.0,) * 3, (1.0,) * 3
_SURFACE = "pbrMetallicRoughness"
_METAL_ROUGH = "metallicRoughnessTexture"


class _Place(NamedTuple):
    """Where a material keeps a channel; the factor is `default` where it is not stated."""

    part: str
    """Name of the part or extension; empty for the material itself."""
    texture: str
    factor: str
    default: tuple[float, ...]
    texels: list[int]
    """Channels of the texture that hold the value."""
    encoded: bool = False
    """Whether the texels are in sRGB."""


_PLACES = {
    "diffuseColor": _Place(_SURFACE, "baseColorTexture", "baseColorFactor", _WHITE, _RGB, True),
    "opacity": _Place(_SURFACE, "baseColorTexture", "baseColorFactor", (1.0,), [3]),
    "metallic": _Place(_SURFACE, _METAL_ROUGH, "metallicFactor", (1.0,), [2]),
    "roughness": _Place(_SURFACE, _METAL_ROUGH, "roughnessFactor", (1.0,), [1]),
    "emissiveColor": _Place("", "emissiveTexture", "emissiveFactor", _BLACK, _RGB, True),
    "occlusion": _Place("", "occlusionTexture", "", (1.0,), [0]),
    "normal": _Place("", "normalTexture", "", _WHITE, _RGB),
    "ior": _Place("ior", "", "ior", (1.5,), [0]),
    "clearcoat": _Place("clearcoat", "clearcoatTexture", "clearcoatFactor", (0.0,), [0]),
    "clearcoatRoughness": _Place(
        "clearcoat", "clearcoatRoughnessTexture", "clearcoatRoughnessFactor", (0.0,), [1]
    ),
    "clearcoatIor": _Place("clearcoat_ior", "", "clearcoatIor", (1.5,), [0]),
    "edgeTint": _Place("specular_edge_color", "", "specularEdgeColorEnabled", (0.0,), [0]),
    "diffuseRoughness": _Place("diffuse_roughness", "", "diffuseRoughnessFactor", (0.0,), [0]),
    "diffuseTransmission": _Place(
        "diffuse_transmission",
        "diffuseTransmissionTexture",
        "diffuseTransmissionFactor",
        (0.0,),
        [3],
    ),
    "diffuseTransmissionColor": _Place(
        "diffuse_transmission",
        "diffuseTransmissionColorTexture",
        "diffuseTransmissionColorFactor",
        _WHITE,
        _RGB,
        True,
    ),
    "specular": _Place("specular", "specularTexture", "specularFactor", (1.0,), [3]),
    "specularTint": _Place(
        "specular", "specularColorTexture", "specularColorFactor", _WHITE, _RGB, True
    ),
    "sheenColor": _Place("sheen", "sheenColorTexture", "sheenColorFactor", _BLACK, _RGB, True),
    "transmission": _Place(
        "transmission", "transmissionTexture", "transmissionFactor", (0.0,), [0]
    ),
    "thickness": _Place("volume", "thicknessTexture", "thicknessFactor", (0.0,), [1]),
    "attenuationColor": _Place("volume", "", "attenuationColor", _WHITE, _RGB),
    "attenuationDistance": _Place("volume", "", "attenuationDistance", (0.0,), [0]),
    "multiscatterColor": _Place("volume_scatter", "", "multiscatterColor", _BLACK, _RGB),
    "scatterAnisotropy": _Place("volume_scatter", "", "scatterAnisotropy", (0.0,), [0]),
}
# The color reflected head on by a surface of ior 1.5, which is 0.04 times the tint.
_PLACES["specularColor"] = _PLACES["specularTint"]
_WITHIN = {
    "clearcoat_ior": ("KHR_materials_clearcoat", "KHR_materials_clearcoat_ior"),
    "specular_edge_color": ("KHR_materials_specular", "EXT_materials_specular_edge_color"),
}
"""Names of the extensions that stand within another: the other's and their own."""


def is_mesh_light(material: Any) -> bool:
    """Whether the material is marked as a light, by its extras."""
    return isinstance((material.extras or {}).get("mesh_light"), dict)


class OutputMaterial:
    """One material of a file; its channels are named like UsdPreviewSurface inputs."""

    def __init__(self, file: GltfFile, index: int) -> None:
        self.file = file
        self.material = file.materials[index]
        self.fields: dict[str, Any] = file.tree["materials"][index]

    def channel(self, name: str, st: Array) -> Array:
        """Values (n, 1 or 3) of channel `name` at primvar coordinates `st` (t upward)."""
        place, info = _PLACES[name], self._info(name)
        if info is None:
            neutral = (0.0, 0.0, 1.0) if name == "normal" else self._factor(name)
            return np.tile(neutral, (len(st), 1))
        texels = self._texels(info, st, place.encoded)[:, place.texels]
        if name == "occlusion":
            return 1.0 + info.get("strength", 1.0) * (texels - 1.0)
        if name == "normal":
            scale = info.get("scale", 1.0)
            return (texels * 2.0 - 1.0) * np.array([scale, scale, 1.0])
        return self._factor(name) * texels

    def texcoord(self, name: str) -> int | None:
        """The UV set that the texture of channel `name` reads; None without such a texture."""
        info = self._info(name)
        if info is None:
            return None
        moved = info.get("extensions", {}).get("KHR_texture_transform", {})
        return int(moved.get("texCoord", info.get("texCoord", 0)))

    def image(self, name: str) -> Texels | None:
        """The image of channel `name`; None without one that can be read."""
        info = self._info(name)
        return None if info is None else _decoded(self.file, self._texture(info)["source"])

    def wrap(self, name: str) -> tuple[str, str]:
        """Wrap modes of the texture of channel `name`."""
        return self._wrap(self._info(name))

    def spread(self, name: str) -> float:
        """Range over which the texels of channel `name` move its value; 0 without a texture."""
        texels = self.image(name)
        if texels is None:
            return 0.0
        ranges = np.ptp(texels.values[:, :, _PLACES[name].texels], axis=(0, 1))
        return float(ranges.max() * self._factor(name).max())

    def has_image(self, name: str) -> bool:
        """Whether channel `name` has a texture."""
        return self._info(name) is not None

    def _part(self, name: str) -> dict[str, Any]:
        part = _PLACES[name].part
        if not part:
            return self.fields
        return self.fields.get(part) or self._extension(part)

    def _extension(self, name: str) -> dict[str, Any]:
        own = self.fields.get("extensions", {})
        parent, full = _WITHIN.get(name, ("", f"KHR_materials_{name}"))
        if parent:
            own = own.get(parent, {}).get("extensions", {})
        found: dict[str, Any] = own.get(full, {})
        return found

    def _info(self, name: str) -> dict[str, Any] | None:
        return self._part(name).get(_PLACES[name].texture) if name in _PLACES else None

    def _factor(self, name: str) -> Array:
        place = _PLACES[name]
        factor = np.atleast_1d(self._part(name).get(place.factor, place.default)).astype(float)
        if factor.size == 4:
            factor = factor[place.texels]
        if name == "specularColor":
            return 0.04 * factor
        if name == "emissiveColor":
            return factor * self._extension("emissive_strength").get("emissiveStrength", 1.0)
        return factor

    def _texture(self, info: dict[str, Any]) -> dict[str, Any]:
        return self.file.tree["textures"][info["index"]]

    def _wrap(self, info: Any) -> tuple[str, str]:
        number = self._texture(info).get("sampler")
        sampler = {} if number is None else self.file.tree["samplers"][number]
        across, along = (_WRAP_NAMES[sampler.get(f"wrap{axis}", 10497)] for axis in "ST")
        return across, along

    def _texels(self, info: dict[str, Any], st: Array, encoded: bool) -> Array:
        uv = np.column_stack([st[:, 0], 1.0 - st[:, 1]])
        moved = info.get("extensions", {}).get("KHR_texture_transform")
        if moved:
            uv = _moved(uv, moved)
        texels = _decoded(self.file, self._texture(info)["source"])
        if texels is None:
            return np.full((len(st), 4), np.nan)
        return sample(texels, uv, self._wrap(info), encoded)


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
def _decoded(file: GltfFile, image: int) -> Texels | None:
    return decode(file.image_bytes(image))
