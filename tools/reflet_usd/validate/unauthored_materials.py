"""Owns the check of materials and extensions in the file beyond the stage's own."""

import math
import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from .allowed_deviations import TRANSLUCENT, UNLIT
from .checks import Checks
from .gltf_material import is_mesh_light
from .gltf_scene import OutputReader

_FIELDS: dict[str, tuple[str, ...]] = {
    "KHR_materials_clearcoat": (
        "clearcoatFactor",
        "clearcoatRoughnessFactor",
        "clearcoatTexture",
        "clearcoatRoughnessTexture",
    ),
    "KHR_materials_emissive_strength": ("emissiveStrength",),
    "KHR_materials_ior": ("ior",),
    "KHR_materials_specular": ("specularColorFactor", "specularColorTexture"),
}
"""Fields that a UsdPreviewSurface gives, all of which are compared."""
_TEXTURES = (
    "baseColorTexture",
    "metallicRoughnessTexture",
    "emissiveTexture",
    "normalTexture",
    "occlusionTexture",
)
_PLAIN = {"metallicFactor": (0.0, 1.0), "roughnessFactor": (0.5, 1.0)}
"""Values of surfaces in displayColor, and glTF's meaning of missing ones."""
_ATTRIBUTES = re.compile(r"POSITION|NORMAL|TEXCOORD_\d+|COLOR_0|JOINTS_\d+|WEIGHTS_\d+|_.*")


_LAYERS = re.compile(
    "KHR_materials_(specular|sheen|transmission|volume|volume_scatter|dispersion|iridescence|anisotropy|clearcoat"
    "|diffuse_roughness|diffuse_transmission)"
)
"""Extensions that hold the layers of MaterialX's surfaces."""


def unexpected_extensions(material: Any, has_layers: bool) -> Iterator[str]:
    """Extensions that no UsdPreviewSurface gives a material, unless its surface `has_layers`."""
    for name, fields in (material.extensions or {}).items():
        if has_layers and _LAYERS.fullmatch(name):
            continue
        known = _FIELDS.get(name)
        if known is None:
            yield f"{name} is only in the output"
        else:
            yield from (f"{name}: {f} is only in the output" for f in fields if f not in known)


def compare_unauthored_materials(
    checks: Checks, output: OutputReader, colored: frozenset[str]
) -> None:
    """Check that every primitive has a material, in displayColor or of a prim, and its attributes.

    `colored` are the names of the materials that may read vertex colors.
    """
    for mesh, key in output.drawn_meshes():
        for primitive in output.file.meshes[mesh].primitives:
            _compare_primitive(checks, output, primitive, key, colored)


def _compare_primitive(
    checks: Checks, output: OutputReader, primitive: Any, key: str, colored: frozenset[str]
) -> None:
    attributes = {name: at for name, at in vars(primitive.attributes).items() if at is not None}
    for name in attributes:
        if not _ATTRIBUTES.fullmatch(name):
            checks.add("materials", key, math.inf, f"{name} is only in the output")
    if primitive.material is None:
        checks.add("materials", key, math.inf, "no material in the output")
        return
    material = output.file.materials[primitive.material]
    path = output.file.prim_of(material)
    if not path:
        for text in non_default_values(material):
            if text.endswith("KHR_materials_unlit") and checks.excuse(key, UNLIT):
                continue  # they hold the light that they show
            checks.add("materials", key, math.inf, f"in displayColor: {text}")
    elif path.rsplit("/", 1)[-1] not in colored:
        if "COLOR_0" in attributes:
            checks.add("materials", key, math.inf, f"{path} reads no vertex colors")
        return
    if not path:
        _compare_alpha(checks, output, primitive, material, key)


def non_default_values(material: Any) -> Iterator[str]:
    """Descriptions of all values by which a material is not a plain dielectric."""
    pbr = material.pbrMetallicRoughness
    for name, (value, neutral) in _PLAIN.items():
        stated = getattr(pbr, name) if pbr else None
        if abs((neutral if stated is None else stated) - value) > 1e-6:
            yield f"{name} is not {value:g}"
    for name in _TEXTURES:
        if getattr(material, name, None) is not None or (pbr and getattr(pbr, name, None)):
            yield f"has a {name}"
    # Emission of mesh lights is compared elsewhere.
    shining = is_mesh_light(material)
    if any(material.emissiveFactor or ()) and not shining:
        yield "shines"
    names = set(material.extensions or {})
    if shining:
        names.discard("KHR_materials_emissive_strength")
    yield from (f"has {name}" for name in sorted(names))


def _compare_alpha(
    checks: Checks, output: OutputReader, primitive: Any, material: Any, key: str
) -> None:
    """Check that a material blends only where some of it is translucent."""
    pbr = material.pbrMetallicRoughness
    alpha = np.array((pbr and pbr.baseColorFactor) or (1.0,) * 4)[3]
    if primitive.attributes.COLOR_0 is not None:
        colors = output.file.accessor(primitive.attributes.COLOR_0)
        alpha = alpha * colors[:, 3].min() if colors.shape[1] == 4 and len(colors) else alpha
    mode = material.alphaMode or "OPAQUE"
    wanted = "BLEND" if alpha < 1.0 else "OPAQUE"
    if mode == wanted or (mode == "BLEND" and checks.excuse(key, TRANSLUCENT)):
        return
    checks.add("materials", key, math.inf, f"in displayColor: {mode}, expected {wanted}")
