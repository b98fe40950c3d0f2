"""Owns the comparison of material values: preview surfaces against the file's materials."""

import dataclasses
import math

import numpy as np
from pxr import Usd

from .allowed_deviations import (
    DISPLACED,
    FROZEN_INPUT,
    LOST_FILE,
    NO_PLACE,
    NO_TEXTURE,
    NORMAL_SCALE,
    OTHER_SURFACE,
    PACKED,
    REWRITTEN,
    UNFIT_NODE,
    UNREAD_FILE,
)
from .checks import Checks
from .gltf_file import GltfFile
from .gltf_material import OutputMaterial, is_mesh_light
from .images import linear_to_srgb
from .scene_data import Array, Scene
from .unauthored_materials import non_default_values, unexpected_extensions
from .usd_animated_inputs import animated_inputs
from .usd_material import DEFAULTS, PreviewInput, TextureRead, preview_shader, read_input
from .usd_materialx import is_gltf_surface, materialx_inputs
from .usd_stage import TruthStage
from .uv_compare import UvUse

_SAMPLES = 16
_MANY = 512
LAYERS = (
    "clearcoatIor",
    "diffuseRoughness",
    "diffuseTransmission",
    "diffuseTransmissionColor",
    "specular",
    "specularTint",
    "sheenColor",
    "transmission",
    "thickness",
    "attenuationColor",
    "attenuationDistance",
    "multiscatterColor",
    "scatterAnisotropy",
)
"""Channels beyond UsdPreviewSurface's."""
_OF_COAT = ("clearcoatIor", "clearcoatRoughness")
_CLEAR = "clear"
"""Transmission of a UsdPreviewSurface of next to no opacity."""
_CLEAR_PARTS = ("KHR_materials_transmission", "specularFactor", "clearcoatNormalTexture")
"""Parts of such a material that no other UsdPreviewSurface has."""
_NOT_EVALUATED = PreviewInput(None, None, "not given")
_ENCODED = ("diffuseColor", "diffuseTransmissionColor", "emissiveColor", "specularColor")
_NEUTRAL = {"displacement": (0.0,), "normal": (0.0, 0.0, 1.0), "occlusion": (1.0,)}
_WHOLE = ("useSpecularWorkflow", "opacityThreshold", "ior")
"""Inputs that are one number for a whole glTF material."""
_SLOTS = (
    ("diffuseColor", "opacity"),
    ("metallic", "roughness"),
    ("emissiveColor",),
    ("occlusion",),
    ("normal",),
    ("specularColor",),
    ("clearcoat",),
    ("clearcoatRoughness",),
)
"""Inputs grouped by the texture of a glTF material that holds them."""
_VALUES = tuple(name for name in DEFAULTS if name not in ("opacityThreshold", "normal"))


def compare_materials(
    checks: Checks, truth: TruthStage, file: GltfFile, rest: Scene
) -> tuple[list[UvUse], frozenset[str]]:
    """Compare every material that the stage binds to something it draws.

    Returns which UV set of the file stands for which primvar, by material, and the names of the
    materials that may read vertex colors.
    """
    uses: list[UvUse] = []
    colored: set[str] = set()
    outputs: dict[str, list[int]] = {}
    for index, material in enumerate(file.materials):
        outputs.setdefault(file.prim_of(material) or "", []).append(index)
    # Native instances share one material, under its path in any of them.
    by_name: dict[str, list[int]] = {}
    for kept, indices in outputs.items():
        by_name.setdefault(kept.rsplit("/", 1)[-1], []).extend(indices)
    used = {
        path
        for part in rest.corners.values()
        if part.materials is not None
        for index, path in enumerate(part.material_paths)
        if (part.materials == index).any()
    }
    used |= {surface.material for many in rest.surfaces.values() for surface in many}
    for path in sorted(used - {""}):
        shader = preview_shader(truth.stage.GetPrimAtPath(path))
        other = None
        if shader is None:
            # A surface of another kind must be declared to show something in its place.
            prim = truth.stage.GetPrimAtPath(path)
            if not is_gltf_surface(prim):
                text = "is not a UsdPreviewSurface"
                checks.add("materials", path, math.inf, text, excuses=OTHER_SURFACE)
            other = materialx_inputs(prim, truth.roots, truth.meters_per_unit)
        if shader is None and other is None:
            colored.add(path.rsplit("/", 1)[-1])
            for index in outputs.get(path, []):
                _compare_plain(checks, path, OutputMaterial(file, index))
            continue
        for prim, name in sorted(animated_inputs(truth.stage.GetPrimAtPath(path))):
            checks.add_lost(prim, FROZEN_INPUT, f"keys of '{name}'", name)
        found = outputs.get(path) or by_name.get(path.rsplit("/", 1)[-1], [])
        if not found:
            checks.add("materials", path, math.inf, "is not in the output")
        for index in found:
            read = other or _preview_inputs(shader, truth.roots)
            read = _seen_through(read, truth.stage.GetPrimAtPath(path))
            if read["diffuseColor"].reason or read["opacity"].reason:
                colored.add(path.rsplit("/", 1)[-1])
            one = _Comparison(checks, path, _without_lost(checks, read))
            output = OutputMaterial(file, index)
            one.compare(output)
            uses += one.uv_uses(output)
    return uses, frozenset(colored)


def _seen_through(read: dict[str, PreviewInput], material: Usd.Prim) -> dict[str, PreviewInput]:
    """The inputs, of clear glass where nothing of the diffuse part can be seen, as documented."""
    opacity, cutoff = read["opacity"].constant, read["opacityThreshold"].constant
    if opacity is None or float(opacity[0]) >= 1.0 / 255.0:
        return read
    modes = (prim.GetAttribute("inputs:opacityMode") for prim in Usd.PrimRange(material))
    if any(mode and mode.Get() == "presence" for mode in modes):
        return read
    if cutoff is None or float(cutoff[0]) != 0.0 or "transmission" in read:
        return read
    clear = PreviewInput(np.array([1.0 - max(float(opacity[0]), 0.0)]), None)
    one = {
        "diffuseColor": PreviewInput(np.ones(3), None),
        "opacity": PreviewInput(np.ones(1), None),
    }
    return {**read, **one, **_coated(read), _CLEAR: clear}


def _coated(read: dict[str, PreviewInput]) -> dict[str, PreviewInput]:
    """Roughness of clear glass of an index near 1.5, as the coat that reflects in its place."""
    own = {"specular": PreviewInput(np.ones(1), None)}
    if not all(_is_zero(read[name]) for name in ("metallic", "useSpecularWorkflow", "clearcoat")):
        return own
    ior = read["ior"].constant
    if ior is None or _is_zero(read["roughness"]):
        return own
    index = max(float(ior[0]), 1.0)
    head_on = ((index - 1.0) / (index + 1.0)) ** 2
    if not 0.0 < head_on < 0.044:
        return own
    return {
        "roughness": PreviewInput(np.zeros(1), None),
        "specular": PreviewInput(np.zeros(1), None),
        "clearcoat": PreviewInput(np.array([min(head_on / 0.04, 1.0)]), None),
        "clearcoatRoughness": read["roughness"],
    }


def _compare_plain(checks: Checks, path: str, found: OutputMaterial) -> None:
    """Compare an unknown surface with the dielectric in displayColor that replaces it."""
    checks.add("materials", path, 0.0)
    for text in non_default_values(found.material):
        checks.add("materials", path, math.inf, f"in displayColor: {text}")


def _preview_inputs(shader: object, roots: tuple[str, ...]) -> dict[str, PreviewInput]:
    names = (*DEFAULTS, "displacement", "useSpecularWorkflow")
    return {name: read_input(shader, name, roots) for name in names}  # type: ignore[arg-type]


def _without_lost(checks: Checks, inputs: dict[str, PreviewInput]) -> dict[str, PreviewInput]:
    """The inputs; a texture whose file the converter names as lost is replaced by its fallback."""
    result = {}
    for name, source in inputs.items():
        told = LOST_FILE if source.reason else UNREAD_FILE
        lost = source.fallback is not None and checks.excuse(source.prim, told)
        result[name] = source.without_file() if lost else source
    return result


def _kept_specular(specular: Array, diffuse: Array) -> Array:
    """Part of a specular color by which a file deviates least from its stage in even light."""
    if not ((specular.max() - specular) * diffuse > 0.05).any():
        return specular
    shares = np.linspace(0.0, 1.0, 2001)[:, None]
    shown = (1.0 - shares * specular.max()) * diffuse + shares * specular
    wanted = (1.0 - specular) * diffuse + specular
    deviations = ((shown - wanted) ** 2).sum(axis=1)
    return specular * shares[np.flatnonzero(deviations < deviations.min() + 1e-9)[-1]]


class _Comparison:
    """One material of the stage and the file's materials that stand for it."""

    def __init__(self, checks: Checks, path: str, inputs: dict[str, PreviewInput]) -> None:
        self.checks = checks
        self.path = path
        self.inputs = inputs
        self._drop_textures()

    def compare(self, found: OutputMaterial) -> None:
        """Compare all inputs, as values or as losses."""
        specular = self._is_specular()
        self._alpha_mode(found)
        for name in (*_VALUES, *LAYERS):
            source = self.inputs.get(name, _NOT_EVALUATED)
            if name in LAYERS and not self._has_layers():
                continue
            if name == "thickness" and _is_zero(self.inputs["transmission"]):
                continue
            if name == "specularColor" and self._has_layers():
                continue
            if name == "specularColor" and not specular:
                source = PreviewInput(np.full(3, 0.04), None)
            elif name == "specularColor" and source.constant is not None:
                diffuse = self.inputs["diffuseColor"].constant
                kept = _kept_specular(source.constant, np.ones(3) if diffuse is None else diffuse)
                source = PreviewInput(kept, None)
            if specular and name in ("metallic", "ior"):
                source = PreviewInput(np.array([0.0 if name == "metallic" else 1.5]), None)
            if name == "emissiveColor" and is_mesh_light(found.material):
                continue  # compared elsewhere, since it depends on the geometry
            if name == "opacity" and (found.material.alphaMode or "OPAQUE") == "OPAQUE":
                continue
            if name in _OF_COAT and _is_zero(self.inputs["clearcoat"]):
                continue
            if name == "occlusion" and source.constant is not None:
                source = PreviewInput(np.array([1.0]), None)
            self._channel(name, source, found)
        if _CLEAR in self.inputs:
            self._channel("transmission", self.inputs[_CLEAR], found)
            self._channel("specular", self.inputs["specular"], found)
        self._normal(found)
        self._losses()
        self._empty_slots(found)

    def _has_layers(self) -> bool:
        """Whether the surface may have layers beyond UsdPreviewSurface's."""
        return "transmission" in self.inputs

    def _drop_textures(self) -> None:
        """Set textured inputs that are one number in glTF to their default."""
        for name in _WHOLE:
            if self.inputs[name].texture is None or (name == "ior" and self._is_specular()):
                continue
            self.checks.add_lost(self.path, NO_TEXTURE, f"the texture of {name}", name)
            value = np.array(DEFAULTS.get(name, (0.0,)))
            self.inputs = {**self.inputs, name: PreviewInput(value, None)}

    def _is_specular(self) -> bool:
        return not _is_zero(self.inputs["useSpecularWorkflow"])

    def uv_uses(self, found: OutputMaterial) -> list[UvUse]:
        """UV set of each primvar; where several share one, the set of the first texture."""
        uses = []
        for name in DEFAULTS:
            texture, number = self.inputs[name].texture, found.texcoord(name)
            known = self.inputs[name].primvars
            if len(known) == 1 and number is not None:
                uses.append(UvUse(self.path, known[0], f"TEXCOORD_{number}"))
            if texture is None or not texture.primvar or number is None:
                continue
            if not self.checks.excuse(texture.prim, PACKED):
                uses.append(UvUse(self.path, texture.primvar, f"TEXCOORD_{number}"))
        return list(dict.fromkeys(uses))

    def _empty_slots(self, found: OutputMaterial) -> None:
        """Check that a slot without a textured input has no texture."""
        for names in _SLOTS:
            sources = [self.inputs[name] for name in names]
            read = any(_has_texture(source) or self._is_unfit(source) for source in sources)
            if self._has_layers() and names == ("specularColor",):
                read = _has_texture(self.inputs["specularTint"])
            if not read and found.has_image(names[0]):
                text = f"{names[0]} has a texture only in the output"
                self.checks.add("materials", self.path, math.inf, text)
        for text in unexpected_extensions(found.material, self._has_layers()):
            if _CLEAR in self.inputs and any(part in text for part in _CLEAR_PARTS):
                continue
            self.checks.add("materials", self.path, math.inf, text)

    def _is_unfit(self, source: PreviewInput) -> bool:
        """Whether a warning says that nodes before an input are not followed, or baked."""
        return any(self.checks.excuse(node, UNFIT_NODE) for node in source.nodes)

    def _losses(self) -> None:
        """Record constants that no glTF material holds, each with its own warning."""
        for name, warning in NO_PLACE.items():
            source = self.inputs[name]
            own = self.path.rpartition("/")[2]
            if name == "displacement" and self.checks.says(DISPLACED, own):
                continue  # the corners of the meshes are compared
            if source.constant is not None and not np.array_equal(source.constant, _NEUTRAL[name]):
                self.checks.add_lost(self.path, (warning,), f"{name} {source.constant.tolist()}")

    def _channel(self, name: str, expected: PreviewInput, found: OutputMaterial) -> None:
        if expected.reason or self._is_unfit(expected):
            return
        if expected.values is not None:
            self._at_random(name, expected, found)
            return
        if expected.texture is None:
            assert expected.constant is not None
            st = np.random.default_rng(7).random((_SAMPLES, 2))
            wanted = np.tile(expected.constant, (_SAMPLES, 1))
            worst = _difference(name, wanted, found.channel(name, st))
            spread = found.spread(name) if found.has_image(name) else 0.0
            self.checks.add("materials", self.path, max(worst, spread), name)
            return
        reads = self._reads(name, expected.texture, found)
        if not found.has_image(name):
            self._sampled(name, reads, found)
            return
        texels = found.image(name)
        same = texels is not None and texels.digest == expected.texture.texels.digest
        resized = bool(self.checks.excuse(expected.texture.prim, REWRITTEN))
        if texels is not None and texels.size != expected.texture.texels.size and not resized:
            self.checks.add("materials", self.path, math.inf, f"{name}: an image of another size")
        if found.wrap(name) not in [read.wrap for read in reads]:
            wrap = " and ".join(found.wrap(name))
            self.checks.add("materials", self.path, math.inf, f"{name}: goes on by {wrap}")
        # Two ways to enlarge an image may round to neighboring values.
        rounded = texels is not None and texels.size != expected.texture.texels.size
        self._sampled(name, reads, found, not same, 1 / 255 if rounded else 1e-9)

    def _at_random(self, name: str, expected: PreviewInput, found: OutputMaterial) -> None:
        """Compare a network of nodes at random coordinates."""
        assert expected.values is not None
        if any(self.checks.excuse(image, PACKED) for image in expected.images):
            return
        texels = found.image(name)
        if texels is not None and texels.size not in expected.sizes:
            resized = any(self.checks.excuse(image, REWRITTEN) for image in expected.images)
            worst = 0.0 if resized else math.inf
            self.checks.add("materials", self.path, worst, f"{name}: an image of another size")
            return
        st = np.random.default_rng(11).random((_MANY, 2)) * 3.0 - 1.0
        wanted = expected.values(st)
        reach = max(1.0, float(wanted.max())) if name == "emissiveColor" else 1.0
        shown = found.channel(name, st)
        self.checks.add("materials", self.path, _difference(name, wanted, shown, reach), name)

    def _sampled(
        self,
        name: str,
        reads: list[TextureRead],
        found: OutputMaterial,
        whole: bool = False,
        slack: float = 0.0,
    ) -> None:
        """Compare texels by any of the reads: few where the image is the stage's own, else all."""
        worst = math.inf
        for read in reads:
            # For emission above 1, texels hold shares of the strongest possible value.
            reach = read.strongest if name == "emissiveColor" else 1.0
            parts = (
                _difference(name, read.at(st), found.channel(name, st), reach)
                for st in read.centers(whole)
            )
            worst = min(worst, max(parts))
        self.checks.add("materials", self.path, worst, name, slack)

    def _reads(
        self, name: str, texture: TextureRead | None, found: OutputMaterial
    ) -> list[TextureRead]:
        """The texture as the file must hold it: resized and placed as a warning documents."""
        if texture is None:
            return []
        image = found.image(name)
        size = None if image is None else image.size
        rewritten = self.checks.excuse(texture.prim, REWRITTEN)
        if rewritten and size is not None and size != texture.texels.size:
            texture = texture.resized(size, name in ("diffuseColor", "emissiveColor"))
        if not self.checks.excuse(texture.prim, PACKED):
            return [texture]
        others = [source.texture for source in self.inputs.values() if source.texture is not None]
        return [
            dataclasses.replace(texture, transform=other.transform, wrap=other.wrap)
            for other in others
            if other.prim != texture.prim
        ]

    def _alpha_mode(self, found: OutputMaterial) -> None:
        opacity, threshold = self.inputs["opacity"], self.inputs["opacityThreshold"].constant
        if opacity.reason:
            return
        cutoff = 0.0 if threshold is None else float(threshold[0])
        mode = found.material.alphaMode or "OPAQUE"
        # No texel of an opaque surface is below a threshold, so both modes show it.
        wanted = ["MASK"] if cutoff > 0.0 else ["BLEND"]
        if _is_opaque(opacity):
            wanted = ["OPAQUE", "MASK"] if 0.0 < cutoff <= 1.0 else ["OPAQUE"]
        if mode not in wanted:
            text = f"alphaMode is {mode}, expected {wanted[0]}"
            self.checks.add("materials", self.path, math.inf, text)
        elif mode == "MASK":
            stored = found.material.alphaCutoff
            value = abs((0.5 if stored is None else stored) - cutoff)
            self.checks.add("materials", self.path, value, "alphaCutoff")

    def _normal(self, found: OutputMaterial) -> None:
        read = self.inputs["normal"].texture
        if self.inputs["normal"].values is not None:
            self._at_random("normal", self.inputs["normal"], found)
        if read is None:
            return
        if not found.has_image("normal"):
            self.checks.add("materials", self.path, math.inf, "the normal map is not in the output")
            return
        if read.assumed_space:
            read = dataclasses.replace(read, linearize=False)
        if np.allclose(read.scale[:3], 1) and np.allclose(read.bias[:3], 0):
            # Missing scale and bias are read as the values that turn texels into directions.
            named = self.checks.excuse(self.path, NORMAL_SCALE)
            if named:
                read = dataclasses.replace(read, scale=np.full(4, 2.0), bias=np.full(4, -1.0))
        size = found.image("normal")
        # With other scales, 8-bit texels may have been rounded or clamped.
        if np.allclose(read.scale[:3], 2) and np.allclose(read.bias[:3], -1) and size:
            value = max(
                float(np.abs(read.at(st) - found.channel("normal", st)).max())
                for st in read.centers(size.digest != read.texels.digest)
            )
            self.checks.add("materials", self.path, value, "normal")


def _difference(name: str, wanted: Array, found: Array, reach: float = 1.0) -> float:
    """Largest difference, relative where values are above 1, after the documented clamps.

    `reach` is the value that texels of 1 stand for.
    """
    if name == "emissiveColor":
        wanted = np.maximum(wanted, 0.0)
    elif name == "normal" or name in ("thickness", "attenuationDistance", "scatterAnisotropy"):
        pass
    elif name in ("clearcoatIor", "ior"):
        wanted = np.where(wanted == 0.0, 0.0, np.maximum(wanted, 1.0))
    else:
        wanted = np.clip(wanted, 0.0, 1.0)
    reach = max(1.0, reach)
    scale = max(reach, float(np.abs(wanted).max()))
    difference = np.abs(wanted - found) / scale
    if name in _ENCODED:  # 8 bits round the encoded value
        wanted, found = wanted / reach, found / reach
        inside = (np.abs(wanted - 0.5) <= 0.5) & (np.abs(found - 0.5) <= 0.5)
        coded = np.abs(linear_to_srgb(np.clip(wanted, 0, 1)) - linear_to_srgb(np.clip(found, 0, 1)))
        difference = np.where(inside, np.minimum(difference, coded), difference)
    return float(difference.max())


def _has_texture(source: PreviewInput) -> bool:
    return source.texture is not None or source.values is not None or bool(source.reason)


def _is_opaque(opacity: PreviewInput) -> bool:
    if opacity.values is not None:
        places = (np.indices((64, 64)).reshape(2, -1).T + 0.5) / 64
        return bool((opacity.values(places) >= 1.0).all())
    if opacity.texture is not None:
        read = opacity.texture
        values = read.texels.values[:, :, read.channels] * read.scale[read.channels]
        return bool((values + read.bias[read.channels] >= 1.0).all())
    return opacity.constant is not None and bool((opacity.constant >= 1.0).all())


def _is_zero(source: PreviewInput) -> bool:
    return source.constant is not None and bool(np.allclose(source.constant, 0.0))
