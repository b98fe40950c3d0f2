"""Conversions proved by the validator, and the validator's own reference values."""

from pathlib import Path

import numpy as np
import pygltflib as gl
import pytest
from PIL import Image
from reflet_usd.sandbox import run_convert
from reflet_usd.validate.usd_subdivide import Cage, refine
from reflet_usd.validate.validation import Validation, validate_file
from reflet_usd.validate.validation_table import format_validation
from texts import text_of


def failing(validation: Validation) -> set[str]:
    """Names of the checks that found a silent deviation."""
    return {check.name for check in validation.checks if not check.passed}


@pytest.mark.parametrize("name", ["gprims", "instances", "moving", "quads", "skin"])
def test_every_seed_survives_the_round_trip(
    tmp_path: Path, stages: Path, khronos: None, name: str
) -> None:
    out = tmp_path / f"{name}.glb"
    run_convert(stages / f"{name}.usda", out)
    validation = validate_file(out, stages / f"{name}.usda")
    assert validation.khronos is not None
    assert validation.khronos.errors == 0, validation.khronos.messages
    assert failing(validation) == set(), format_validation(validation)
    assert not any(check.declared for check in validation.checks if check.name != "bindings")


def test_the_reference_refinement_gives_the_known_places() -> None:
    cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    smooth = refine(Cage(cube, faces, list(range(6)), {}, {}, True))
    assert len(smooth.faces) == 24
    # Vertex (F + E + (n − 2)·P) / n = (1/3 + 1/3 + 1) / 3; edge (2 + 2·1/2) / 4; face 1.
    assert np.allclose(np.abs(smooth.points[:8]), 5 / 9)
    assert np.allclose(np.sort(np.abs(smooth.points[14:]), axis=1), [0, 0.75, 0.75])
    top = {(2, 3): 10.0, (3, 7): 10.0, (6, 7): 10.0, (2, 6): 10.0}
    creased = refine(Cage(cube, faces, list(range(6)), top, {}, True))
    assert np.allclose(creased.points[[2, 3, 6, 7], 1], 1)
    assert np.allclose(np.abs(creased.points[[2, 3, 6, 7]][:, [0, 2]]), 0.75)
    sheet = refine(Cage(cube[:4], [[0, 1, 3, 2]], [0], {}, {}, True))
    assert np.allclose(sheet.points[:4], cube[:4])
    rounded = refine(Cage(cube[:4], [[0, 1, 3, 2]], [0], {}, {}, False))
    assert np.allclose(np.abs(rounded.points[:4, 1:]), 0.75)


TEXTURED = text_of("round_trip/textured.usda")


def test_textures_are_compared_by_texels_and_uv_sets(tmp_path: Path) -> None:
    stage, out = tmp_path / "card.usda", tmp_path / "card.glb"
    stage.write_text(TEXTURED)
    pixels = np.arange(4 * 4 * 3, dtype=np.uint8).reshape(4, 4, 3) * 5
    Image.fromarray(pixels).save(tmp_path / "picture.png")
    run_convert(stage, out)
    validation = validate_file(out, stage, khronos=False)
    assert failing(validation) == set(), format_validation(validation)
    file = gl.GLTF2().load(str(out))
    texture = file.materials[0].pbrMetallicRoughness.baseColorTexture
    texture.texCoord = 1 - (texture.texCoord or 0)
    file.save(str(out))
    assert failing(validate_file(out, stage, khronos=False)) == {"uvs"}
    Image.fromarray(255 - pixels).save(tmp_path / "picture.png")
    assert "materials" in failing(validate_file(out, stage, khronos=False))
