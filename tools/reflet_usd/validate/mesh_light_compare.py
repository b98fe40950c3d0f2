"""Owns the check of the light that geometry sends: the emission of its materials."""

import math
from typing import Any

import numpy as np

from .checks import Checks
from .gltf_material import OutputMaterial, is_mesh_light
from .gltf_scene import OutputReader
from .scene_data import Array, MeshLight, Scene
from .usd_material import PreviewInput, preview_shader, read_input
from .usd_materialx import materialx_inputs
from .usd_stage import TruthStage


def compare_mesh_lights(
    checks: Checks, truth: TruthStage, output: OutputReader, rest: Scene
) -> None:
    """Check that materials of geometry lights send the stage's light, and no other ones do."""
    for mesh, key in output.drawn_meshes():
        # The key of an instancer stands for all that it draws.
        drawn = {key, *rest.made_of.get(key, ())}
        lights = [rest.mesh_lights[path] for path in sorted(drawn & rest.mesh_lights.keys())]
        lights = [light for light in lights if light.nits.any()]
        every = bool(lights) and len(lights) == len(rest.made_of.get(key, (key,)))
        for primitive in output.file.meshes[mesh].primitives:
            _compare_primitive(checks, truth, output, primitive, (key, lights, every))


def _compare_primitive(
    checks: Checks,
    truth: TruthStage,
    output: OutputReader,
    primitive: Any,
    expected: tuple[str, list[MeshLight], bool],
) -> None:
    key, lights, every = expected
    if primitive.material is None:
        return
    material = output.file.materials[primitive.material]
    if not is_mesh_light(material):
        if every:
            checks.add("materials", key, math.inf, "a material of geometry that lights does not")
        return
    if not lights:
        checks.add("materials", key, math.inf, "geometry lights only in the output")
        return
    found = OutputMaterial(output.file, primitive.material)
    own = _own_emission(truth, output.file.prim_of(material) or "")
    values = [_distance(light, own, found) for light in lights]
    checks.add("materials", key, min(values), "emission of the geometry")


def _own_emission(truth: TruthStage, path: str) -> PreviewInput | None:
    """Emission of the material itself; None where it has none."""
    prim = truth.stage.GetPrimAtPath(path) if path else None
    if not prim:
        return None
    shader = preview_shader(prim)
    if shader is not None:
        return read_input(shader, "emissiveColor", truth.roots)
    inputs = materialx_inputs(prim, truth.roots)
    return inputs["emissiveColor"] if inputs else None


def _distance(light: MeshLight, own: PreviewInput | None, found: OutputMaterial) -> float:
    """Largest difference as a share of the strongest emission."""
    if own is not None and own.reason:
        own = own.without_file() if own.fallback is not None else None
    if own is not None and own.values is not None and light.tinted:
        st = np.random.default_rng(7).random((16, 2))
        return _relative(light.nits * np.maximum(own.values(st), 0.0), found, st)
    read = own.texture if own is not None and light.tinted else None
    if read is None:
        factor = np.ones(3)
        if light.tinted and own is not None and own.constant is not None and own.constant.any():
            factor = np.maximum(own.constant, 0.0)
        st = np.random.default_rng(7).random((16, 2))
        return _relative(np.tile(light.nits * factor, (16, 1)), found, st)
    return max(
        _relative(light.nits * np.maximum(read.at(st), 0.0), found, st)
        for st in read.centers(whole=False)
    )


def _relative(wanted: Array, found: OutputMaterial, st: Array) -> float:
    scale = max(float(np.abs(wanted).max()), 1e-30)
    return float(np.abs(wanted - found.channel("emissiveColor", st)).max()) / scale
