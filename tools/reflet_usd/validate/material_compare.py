"""Owns the comparison of material values: preview surfaces against the file's materials."""

from __future__ import annotations

import math

import numpy as np
from pxr import Usd

from .checks import Checks
from .facts import Array, Scene
from .gltf_file import GltfFile
from .gltf_material import OutputMaterial
from .usd_material import DEFAULTS, PreviewInput, preview_shader, read_input
from .uv_compare import UvUse

_SAMPLES = 16
_VALUES = tuple(name for name in DEFAULTS if name not in ("opacityThreshold", "normal"))


def compare_materials(checks: Checks, stage: Usd.Stage, file: GltfFile, rest: Scene) -> list[UvUse]:
    """Compare every material that the stage binds to something it draws.

    Returns which UV set of the file stands for which primvar, by material.
    """
    uses: list[UvUse] = []
    outputs: dict[str, list[int]] = {}
    for index, material in enumerate(file.materials):
        outputs.setdefault(file.prim_of(material) or "", []).append(index)
    # Native instances share one material, which keeps the path it has in one of them.
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
        shader = preview_shader(stage.GetPrimAtPath(path))
        if shader is None:
            # Another kind of surface: what the file shows in its place has to be declared.
            checks.add("materials", path, math.inf, "is not a UsdPreviewSurface")
            continue
        found = outputs.get(path) or by_name.get(path.rsplit("/", 1)[-1], [])
        if not found:
            checks.add("materials", path, math.inf, "is not in the output")
        for index in found:
            output = OutputMaterial(file, index)
            _compare_one(checks, path, shader, output)
            uses += _uv_uses(path, shader, output)
    return uses


def _compare_one(checks: Checks, path: str, shader: object, found: OutputMaterial) -> None:
    workflow = shader.GetInput("useSpecularWorkflow")  # type: ignore[attr-defined]
    specular = bool(workflow and workflow.Get())
    opacity = read_input(shader, "opacity")
    threshold = read_input(shader, "opacityThreshold").constant
    _compare_alpha_mode(checks, path, opacity, threshold, found)
    for name in _VALUES:
        # The two color models of the specular workflow have no common value to compare.
        if specular and name in ("diffuseColor", "metallic", "ior"):
            continue
        expected = opacity if name == "opacity" else read_input(shader, name)
        if name == "opacity" and (found.material.alphaMode or "OPAQUE") == "OPAQUE":
            continue
        if name == "clearcoatRoughness" and _is_constant(read_input(shader, "clearcoat"), 0.0):
            continue
        _compare_channel(checks, path, name, expected, found)
    _compare_normal(checks, path, read_input(shader, "normal"), found)


def _uv_uses(path: str, shader: object, found: OutputMaterial) -> list[UvUse]:
    uses = []
    for name in DEFAULTS:
        texture = read_input(shader, name).texture
        number = found.texcoord(name)
        if texture is not None and texture.primvar and number is not None:
            uses.append(UvUse(path, texture.primvar, f"TEXCOORD_{number}"))
    return list(dict.fromkeys(uses))


def _compare_channel(
    checks: Checks, path: str, name: str, expected: PreviewInput, found: OutputMaterial
) -> None:
    if expected.reason:
        return
    if expected.texture is not None:
        st = expected.texture.centers(_SAMPLES)
        wanted = expected.texture.at(st)
    else:
        assert expected.constant is not None
        st = np.random.default_rng(7).random((_SAMPLES, 2))
        wanted = np.tile(expected.constant, (_SAMPLES, 1))
    values = found.channel(name, st)
    if name not in ("emissiveColor", "ior"):
        wanted = np.clip(wanted, 0.0, 1.0)
    scale = max(1.0, float(np.abs(wanted).max()))
    checks.add("materials", path, _worst(wanted, values) / scale, name)


def _compare_alpha_mode(
    checks: Checks,
    path: str,
    opacity: PreviewInput,
    threshold: Array | None,
    found: OutputMaterial,
) -> None:
    if opacity.reason:
        return
    cutoff = 0.0 if threshold is None else float(threshold[0])
    mode = found.material.alphaMode or "OPAQUE"
    wanted = "BLEND"
    if _is_opaque(opacity):
        wanted = "OPAQUE"
    elif cutoff > 0:
        wanted = "MASK"
    if mode != wanted:
        checks.add("materials", path, math.inf, f"alphaMode is {mode}, expected {wanted}")
    elif mode == "MASK":
        stored = found.material.alphaCutoff
        value = abs((0.5 if stored is None else stored) - cutoff)
        checks.add("materials", path, value, "alphaCutoff")


def _compare_normal(
    checks: Checks, path: str, expected: PreviewInput, found: OutputMaterial
) -> None:
    if expected.texture is None:
        return
    if not found.has_texture("normal"):
        checks.add("materials", path, math.inf, "the normal map is not in the output")
        return
    # Maps authored without scale 2 and bias −1 hold no unit vectors to compare with.
    if np.allclose(expected.texture.scale[:3], 2) and np.allclose(expected.texture.bias[:3], -1):
        st = expected.texture.centers(_SAMPLES)
        value = _worst(expected.texture.at(st), found.channel("normal", st))
        checks.add("materials", path, value, "normal")


def _is_opaque(opacity: PreviewInput) -> bool:
    if opacity.texture is not None:
        read = opacity.texture
        values = read.texels.values[:, :, read.channels] * read.scale[read.channels]
        return bool((values + read.bias[read.channels] >= 1.0).all())
    return _is_constant(opacity, 1.0)


def _is_constant(source: PreviewInput, value: float) -> bool:
    return source.constant is not None and bool(np.allclose(source.constant, value))


def _worst(expected: Array, found: Array) -> float:
    return float(np.abs(expected - found).max())
