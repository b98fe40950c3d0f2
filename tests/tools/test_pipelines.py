"""Stages as artists' programs write them: nothing of them is lost silently or converted wrongly."""

from pathlib import Path

import numpy as np
import pytest
from material_stages import noise, save
from read_converted import Converted, convert_text
from reflet_usd.validate.khronos import check_files
from texts import text_of

GRID = text_of("pipelines/grid.usda")


def material(name: str, inputs: str, nodes: str = "") -> str:
    """Scene text of a UsdPreviewSurface at the root."""
    return text_of("pipelines/material.usda", name=name, inputs=inputs, nodes=nodes)


RED = material("Red", "color3f inputs:diffuseColor = (1, 0, 0)")
BLUE = material("Blue", "color3f inputs:diffuseColor = (0, 0, 1)")


def colors_of(done: Converted, prim: str) -> list[list[float]]:
    """Base colors of the prim's primitives."""
    mesh = done.gltf.meshes[done.gltf.nodes[done.node(prim)].mesh]
    found = [done.gltf.materials[primitive.material] for primitive in mesh.primitives]
    return [entry.pbrMetallicRoughness.baseColorFactor[:3] for entry in found]


def test_value_clips_jump_from_one_to_the_next(tmp_path: Path, khronos: None) -> None:
    for number, ends in enumerate(((0, 10), (10, -20))):
        (tmp_path / f"clip.{number}.usda").write_text(
            '#usda 1.0\nover "Model"\n{\n    double3 xformOp:translate.timeSamples = '
            f"{{ 1: ({ends[0]}, 0, 0), 13: ({ends[1]}, 5, 0) }}\n}}\n"
        )
    (tmp_path / "clip.manifest.usda").write_text(
        '#usda 1.0\nover "Model"\n{\n    double3 xformOp:translate\n}\n'
    )
    text = text_of("pipelines/value_clips_jump_from_one_to_the_next.usda")
    done = convert_text(tmp_path, text).proven()
    assert check_files([done.out])[0].errors == 0
    for code, place in ((12.9999, (10, 5)), (13.0, (10, 0)), (19.0, (-5, 2.5))):
        world = done.world((code - 1) / 24)[done.node("/World")]
        assert world[:2, 3] == pytest.approx(place, abs=1e-3)


def test_keys_closer_than_single_precision(tmp_path: Path, khronos: None) -> None:
    done = convert_text(tmp_path, text_of("pipelines/keys_closer_than_single_precision.usda"))
    assert check_files([done.out])[0].errors == 0
    for code, place in ((0.5, 0.5), (1.001, 3.006), (2, 9)):
        assert done.world(code / 24)[done.node("/C")][0, 3] == pytest.approx(place, abs=1e-3)


def test_bindings_by_purpose(tmp_path: Path) -> None:
    text = text_of("pipelines/bindings_by_purpose.usda", GRID=GRID, RED=RED, BLUE=BLUE)
    done = convert_text(tmp_path, text).proven()
    assert colors_of(done, "/G/S") == colors_of(done, "/G/M") == [[1, 0, 0]]
    assert done.warnings("/G/S") == done.warnings("/G/M") == {"binding-purpose-dropped"}
    assert done.warnings("/G") == set()


def test_a_binding_for_previews_alone_counts(tmp_path: Path) -> None:
    text = text_of(
        "pipelines/a_binding_for_previews_alone_counts.usda", GRID=GRID, BLUE=BLUE, RED=RED
    )
    done = convert_text(tmp_path, text).proven()
    assert colors_of(done, "/G/S") == colors_of(done, "/G/M") == [[0, 0, 1]]
    assert done.warnings("/G") == {"binding-purpose-dropped"}
    assert done.warnings("/G/S") == done.warnings("/G/M") == set()


def test_a_face_in_several_subsets_is_the_first_ones(tmp_path: Path) -> None:
    text = text_of(
        "pipelines/a_face_in_several_subsets_is_the_first_ones.usda", GRID=GRID, RED=RED, BLUE=BLUE
    )
    done = convert_text(tmp_path, text).proven()
    assert colors_of(done, "/M") == [[1, 0, 0], [0, 0, 1]]
    parts = done.gltf.meshes[0].primitives
    assert [done.gltf.accessors[part.indices].count for part in parts] == [18, 6]
    assert done.warnings("/M/b") == {"subset-overlap"}


def test_one_subset_reads_a_uv_set_that_is_not_there(tmp_path: Path) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    nodes = text_of("pipelines/one_subset_reads_a_uv_set_that_is_not_there.usda")
    text = text_of(
        "pipelines/one_subset_reads_a_uv_set_that_is_not_there_text.usda",
        GRID=GRID,
        RED=RED,
        map_material=material(
            "Map", "color3f inputs:diffuseColor.connect = </Map/T.outputs:rgb>", nodes
        ),
    )
    assert "uv-missing" in convert_text(tmp_path, text).proven().warnings("/M")


def test_tiled_images_of_materialx(tmp_path: Path) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    text = text_of("pipelines/tiled_images_of_materialx.usda", GRID=GRID)
    done = convert_text(tmp_path, text).proven()
    info = done.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
    assert info["extensions"]["KHR_texture_transform"]["scale"] == [3, 2]


def test_one_value_colors_a_whole_gprim(tmp_path: Path) -> None:
    text = "".join(
        f'def {kind} "{kind}{way}"\n{{\n    color3f[] primvars:displayColor = [(1, 0, 0)] '
        f'(interpolation = "{way}")\n}}\n'
        for kind in ("Sphere", "Plane", "Cylinder")
        for way in ("uniform", "vertex", "faceVarying")
    )
    done = convert_text(tmp_path, text).proven()
    assert done.warnings() == set()
    found = {tuple(m.pbrMetallicRoughness.baseColorFactor) for m in done.gltf.materials}
    assert found == {(1, 0, 0, 1)}


def test_points_of_no_curve_are_not_in_the_file(tmp_path: Path) -> None:
    text = text_of("pipelines/points_of_no_curve_are_not_in_the_file.usda")
    done = convert_text(tmp_path, text).proven()
    part = done.json["meshes"][0]["primitives"][0]
    points = done.array(part["attributes"]["POSITION"])
    assert np.array_equal(points, [[0, 0, 0], [1, 0, 0]])


def test_cameras_and_lights_of_an_instancer_are_told_apart(tmp_path: Path, khronos: None) -> None:
    text = text_of(
        "pipelines/cameras_and_lights_of_an_instancer_are_told_apart.usda",
        moving_grid=GRID.replace("point3f[] points = [", "point3f[] points.timeSamples = { 0: [")[
            :-1
        ],
    )
    first = text.split("point3f[] points.timeSamples = { 0: [")[1].split("]")[0]
    moved = first.replace("0.5)", "2.5)")
    text = text.replace(f"{first}]", f"{first}], 24: [{moved}] }}", 1)
    done = convert_text(tmp_path, text).proven()
    assert check_files([done.out])[0].errors == 0
    assert done.warnings("/I/P/C") == set()
    for node in done.gltf.nodes:
        if node.extensions:
            node.translation = [1.0, 2.0, 3.0]
    done.gltf.save_binary(str(done.out))
    validation = done.validated()
    assert not next(check for check in validation.checks if check.name == "lights").passed


@pytest.mark.parametrize("chosen", ["", "missing"])
def test_variants_that_nothing_selects_are_named(tmp_path: Path, chosen: str) -> None:
    text = text_of("pipelines/variants_that_nothing_selects_are_named.usda", chosen=chosen)
    done = convert_text(tmp_path, text).proven()
    assert done.warnings("/W") == {"variants-not-carried"}
    assert done.warnings("/S") == {"color-clamped"}
