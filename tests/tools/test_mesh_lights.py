"""Owns the tests of geometry that is a light: emission of its materials, and portal warnings."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from read_converted import Converted, convert_text
from tampering import FACE, UNIT, UVS, Output, expect_found, expect_required, mesh
from texts import text_of

LEVELS = text_of("mesh_lights/levels.usda")
NITS = [12.0, 6.0, 0.0]
LAMP = mesh("L", LEVELS, "MeshLightAPI")
NAMED = text_of("mesh_lights/named.usda", LEVELS=LEVELS, mesh=mesh("L"))


def material(emission: str, binding: str = "") -> str:
    """A lamp bound to a preview surface of this emission, and the same surface without light."""
    return text_of(
        "mesh_lights/material.usda",
        emission=emission,
        FACE=FACE,
        UVS=UVS,
        LEVELS=LEVELS,
        binding=binding,
    )


def look_of(done: Converted, prim: str) -> dict[str, Any]:
    """The material of the prim's first primitive."""
    entry = done.json["nodes"][done.node(prim)]
    primitive = done.json["meshes"][entry["mesh"]]["primitives"][0]
    found: dict[str, Any] = done.json["materials"][primitive["material"]]
    return found


def nits(look: dict[str, Any]) -> list[float]:
    """Emission of a material in nits, without its texture."""
    strength = look.get("extensions", {}).get("KHR_materials_emissive_strength", {})
    factor = np.array(look.get("emissiveFactor", (0.0, 0.0, 0.0)))
    return list(factor * strength.get("emissiveStrength", 1.0))


@pytest.mark.parametrize("stage", [LAMP, NAMED])
def test_a_mesh_sends_its_light(tmp_path: Path, stage: str) -> None:
    done = convert_text(tmp_path, stage + UNIT).proven()
    look = look_of(done, "/L")
    assert nits(look) == pytest.approx(NITS)
    assert look["extras"]["mesh_light"] == {"nits": NITS}
    assert not done.warnings() & {"mesh-light-dropped", "light-dropped"}
    others = [m for m in done.json["materials"] if m is not look]
    assert others and all("mesh_light" not in (m.get("extras") or {}) for m in others)


@pytest.mark.parametrize(
    ("emission", "binding", "expected"),
    [
        ("", "", NITS),
        ("color3f inputs:emissiveColor = (0.5, 2, 1)", "", [6.0, 12.0, 0.0]),
        (
            "color3f inputs:emissiveColor = (0.5, 2, 1)",
            'uniform token light:materialSyncMode = "independent"',
            NITS,
        ),
        ("color3f inputs:emissiveColor.connect = </Looks/M/T.outputs:rgb>", "", NITS),
    ],
)
def test_the_emission_of_a_material_tints_the_light(
    tmp_path: Path, emission: str, binding: str, expected: list[float]
) -> None:
    texels = np.random.default_rng(3).integers(0, 255, (8, 8, 3), dtype=np.uint8)
    Image.fromarray(texels).save(tmp_path / "glow.png")
    done = convert_text(tmp_path, material(emission, binding)).proven()
    lit, plain = look_of(done, "/L"), look_of(done, "/Plain")
    assert nits(lit) == pytest.approx(expected)
    assert ("emissiveTexture" in lit) == ("connect" in emission)
    assert "mesh_light" not in plain["extras"]


def scale_emission(out: Output) -> None:
    """Damage: change the emission of all materials."""
    for entry in out.gltf.materials:
        entry.emissiveFactor = [0.3, 0.3, 0.3]


def unmark(out: Output) -> None:
    """Damage: no material is marked as a light."""
    for entry in out.gltf.materials:
        entry.extras.pop("mesh_light", None)


def mark_wrongly(out: Output) -> None:
    """Damage: the mark of a light is no JSON object."""
    for entry in out.gltf.materials:
        if "mesh_light" in (entry.extras or {}):
            entry.extras["mesh_light"] = True


def mark(out: Output) -> None:
    """Damage: all materials are marked as lights."""
    for entry in out.gltf.materials:
        entry.extras = {**(entry.extras or {}), "mesh_light": {"nits": NITS}}


@pytest.mark.parametrize("stage", [LAMP + UNIT, NAMED + UNIT, material("")])
@pytest.mark.parametrize("damage", [scale_emission, unmark, mark_wrongly, mark])
def test_validation_finds_another_light(tmp_path: Path, stage: str, damage: Any) -> None:
    expect_found(convert_text(tmp_path, stage), damage)


def test_instances_of_a_lamp_share_its_light(tmp_path: Path) -> None:
    text = text_of("mesh_lights/instances_of_a_lamp_share_its_light.usda", LAMP=LAMP)
    done = convert_text(tmp_path, text).proven()
    assert nits(look_of(done, "/A/L")) == pytest.approx(NITS)
    assert nits(look_of(done, "/B/L")) == pytest.approx(NITS)
    assert "mesh-light-dropped" not in done.warnings()


def test_a_light_of_no_strength_is_none(tmp_path: Path) -> None:
    stage = mesh("L", "float inputs:intensity = 0\n", "MeshLightAPI")
    done = convert_text(tmp_path, stage + UNIT).proven()
    assert nits(look_of(done, "/L")) == [0.0, 0.0, 0.0]
    assert "mesh_light" not in (look_of(done, "/L").get("extras") or {})


@pytest.mark.parametrize("geometry", ["", "rel geometry = </S>", "rel geometry = </Nowhere>"])
def test_a_geometry_light_of_nothing_is_lost(tmp_path: Path, geometry: str) -> None:
    text = text_of("mesh_lights/a_geometry_light_of_nothing_is_lost.usda", geometry=geometry)
    done = convert_text(tmp_path, text + UNIT).proven()
    assert done.warnings("/G") == {"light-dropped"}


def test_animated_emission_is_named(tmp_path: Path) -> None:
    stage = mesh("L", "float inputs:intensity.timeSamples = { 0: 1, 9: 2 }\n", "MeshLightAPI")
    done = convert_text(tmp_path, stage + UNIT)
    assert "light-animation-frozen" in done.warnings("/L")
    assert nits(look_of(done, "/L")) == [1.0, 1.0, 1.0]


def test_a_portal_is_ignored_and_not_lost(tmp_path: Path) -> None:
    text = text_of("mesh_lights/a_portal_is_ignored_and_not_lost.usda")
    done = convert_text(tmp_path, text + UNIT)
    assert done.warnings("/P") == {"portal-light-ignored"}
    assert "KHR_lights_punctual" not in (done.gltf.extensionsUsed or [])
    expect_required(done, "portal-light-ignored", "/P")
