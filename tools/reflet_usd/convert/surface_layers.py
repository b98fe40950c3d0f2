"""Layers of a surface beyond UsdPreviewSurface's, as glTF's extensions of materials."""

from typing import Any, ClassVar

from .attributes import DisplayColor
from .preview_surface import PREVIEW_INPUTS, PreviewMaterial, Slots, factored
from .sources import Source

# Names of our own; at these values a layer is absent.
_LAYER_INPUTS: dict[str, tuple[float, ...]] = {
    "transmission": (0.0,),
    "thickness": (0.0,),
    "attenuationColor": (1.0, 1.0, 1.0),
    "attenuationDistance": (0.0,),
    "dispersion": (0.0,),
    "sheenColor": (0.0, 0.0, 0.0),
    "sheenRoughness": (0.0,),
    "specular": (1.0,),
    "specularTint": (1.0, 1.0, 1.0),
    "edgeTint": (0.0,),
    "anisotropy": (0.0,),
    "anisotropyRotation": (0.0,),
    "iridescence": (0.0,),
    "iridescenceIor": (1.3,),
    "iridescenceThickness": (100.0,),
    "diffuseRoughness": (0.0,),
    "diffuseTransmission": (0.0,),
    "diffuseTransmissionColor": (1.0, 1.0, 1.0),
    "multiscatterColor": (0.0, 0.0, 0.0),
    "scatterAnisotropy": (0.0,),
    "clearcoatIor": (1.5,),
    "coatNormal": (0.0, 0.0, 1.0),
}
_RED, _GREEN, _ALPHA = 0, 1, 3


class LayeredMaterial(PreviewMaterial):
    """Writer of one material with all layers; a fresh object per material and UV layout."""

    defaults: ClassVar[dict[str, tuple[float, ...]]] = {**PREVIEW_INPUTS, **_LAYER_INPUTS}

    def write(
        self, inputs: dict[str, Source], slots: Slots, display: DisplayColor, has_colors: bool
    ) -> dict[str, Any]:
        """The glTF material without name and sidedness."""
        entry = super().write(inputs, slots, display, has_colors)
        transmission = self._transmission()
        layers = (
            *transmission,
            *self._volume(passes=bool(transmission)),
            self._sheen(),
            self._specular_lobe(),
            self._anisotropy(),
            self._iridescence(),
            self._rough_diffuse(),
            self._diffuse_transmission(),
        )
        self.extend(entry, {name: fields for name, fields in layers if fields})
        coat = entry.get("extensions", {}).get("KHR_materials_clearcoat")
        info = None if coat is None else self.normal_map("coatNormal")
        if coat is not None and info is not None:
            coat["clearcoatNormalTexture"] = info
        ior = max(self._numbers("clearcoatIor")[0], 1.0)
        if coat is not None and ior != 1.5:
            self.extend(coat, {"KHR_materials_clearcoat_ior": {"clearcoatIor": ior}})
        return entry

    def _number(self, name: str, key: str, place: int) -> dict[str, Any]:
        """Factor and texture of one number, which the texture holds in the channel `place`."""
        read = self._texture(name)
        if read is None:
            return {f"{key}Factor": self._unit(name)[0]}
        return self._textured(key, read, place)

    def _color(self, name: str, key: str) -> dict[str, Any]:
        """Factor and texture of a color."""
        read = self._texture(name)
        if read is None:
            return {f"{key}Factor": [max(part, 0.0) for part in self._numbers(name)]}
        factor, channels = factored(read, 3)
        info = self.packer.texture([*channels], True, self.slots)
        return {f"{key}Factor": factor, f"{key}Texture": info}

    def _transmission(self) -> list[tuple[str, dict[str, Any]]]:
        transmission = self._number("transmission", "transmission", _RED)
        if transmission == {"transmissionFactor": 0.0}:
            return []
        layers = [("KHR_materials_transmission", transmission)]
        dispersion = self._numbers("dispersion")[0]
        if dispersion > 0.0 and self._number_of_meters() is not None:
            layers.append(("KHR_materials_dispersion", {"dispersion": dispersion}))
        return layers

    def _volume(self, *, passes: bool) -> list[tuple[str, dict[str, Any]]]:
        """Volume that transmitted light is in, or that scatters light."""
        scattered = self._volume_color("multiscatterColor")
        volume = self._number_of_meters()
        if volume is None or not (passes or any(scattered)):
            return []
        color = self._volume_color("attenuationColor")
        distance = self._numbers("attenuationDistance")[0]
        if distance > 0.0:
            volume["attenuationColor"], volume["attenuationDistance"] = color, distance
        layers = [("KHR_materials_volume", volume)]
        if any(scattered):
            anisotropy = self._numbers("scatterAnisotropy")[0]
            fields = {"multiscatterColor": scattered, "scatterAnisotropy": anisotropy}
            layers.append(("KHR_materials_volume_scatter", fields))
        return layers

    def _volume_color(self, name: str) -> list[float]:
        if not self._texture(name):
            return list(self._unit(name))
        message = "glTF has no texture for the color of a volume, taken as white"
        self._warn("material-texture-dropped", message)
        return [1.0, 1.0, 1.0]

    def _number_of_meters(self) -> dict[str, Any] | None:
        """Thickness of the volume; None for surfaces that enclose none."""
        read = self._texture("thickness")
        if read is None:
            thickness = self._numbers("thickness")[0]
            return {"thicknessFactor": thickness} if thickness > 0.0 else None
        return self._textured("thickness", read, _GREEN)

    def _sheen(self) -> tuple[str, dict[str, Any]]:
        color = self._color("sheenColor", "sheenColor")
        if color == {"sheenColorFactor": [0.0, 0.0, 0.0]}:
            return "", {}
        return "KHR_materials_sheen", {
            **color,
            **self._number("sheenRoughness", "sheenRoughness", _ALPHA),
        }

    def _specular_lobe(self) -> tuple[str, dict[str, Any]]:
        fields = {
            **self._number("specular", "specular", _ALPHA),
            **self._color("specularTint", "specularColor"),
        }
        plain = {"specularFactor": 1.0, "specularColorFactor": [1.0, 1.0, 1.0]}
        if fields == plain:
            return "", {}
        if self._numbers("edgeTint")[0] != 0.0:
            tint = {"specularEdgeColorEnabled": True}
            self.extend(fields, {"EXT_materials_specular_edge_color": tint})
        return "KHR_materials_specular", fields

    def _anisotropy(self) -> tuple[str, dict[str, Any]]:
        strength = self._unit("anisotropy")[0]
        if strength == 0.0:
            return "", {}
        turn = self._numbers("anisotropyRotation")[0]
        return "KHR_materials_anisotropy", {
            "anisotropyStrength": strength,
            "anisotropyRotation": turn,
        }

    def _rough_diffuse(self) -> tuple[str, dict[str, Any]]:
        roughness = self._unit("diffuseRoughness")[0]
        fields = {"diffuseRoughnessFactor": roughness} if roughness > 0.0 else {}
        return "KHR_materials_diffuse_roughness", fields

    def _diffuse_transmission(self) -> tuple[str, dict[str, Any]]:
        share = self._unit("diffuseTransmission")[0]
        if share == 0.0:
            return "", {}
        color = self._color("diffuseTransmissionColor", "diffuseTransmissionColor")
        if len(color) == 1:  # no texture
            color["diffuseTransmissionColorFactor"] = list(self._unit("diffuseTransmissionColor"))
        return "KHR_materials_diffuse_transmission", {"diffuseTransmissionFactor": share, **color}

    def _iridescence(self) -> tuple[str, dict[str, Any]]:
        fields = self._number("iridescence", "iridescence", _RED)
        if fields == {"iridescenceFactor": 0.0}:
            return "", {}
        thickness = max(self._numbers("iridescenceThickness")[0], 0.0)
        return "KHR_materials_iridescence", {
            **fields,
            "iridescenceIor": max(self._numbers("iridescenceIor")[0], 1.0),
            "iridescenceThicknessMinimum": thickness,
            "iridescenceThicknessMaximum": thickness,
        }
