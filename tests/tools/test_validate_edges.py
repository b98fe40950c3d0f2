"""The validator's edge cases: empty areas, NaN, deep trees, splines, and excuses by warnings."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from handwritten_gltf import HandFile
from material_stages import shaded, texture
from PIL import Image
from pxr import Sdf
from read_converted import Converted, convert_text
from reflet_usd.validate import validation as validation_module
from reflet_usd.validate.checks import Check, Checks
from reflet_usd.validate.validation import Validation, validate_file
from texts import fill, text_of

QUAD = text_of("validate_edges/quad.usda")


def check_of(validation: Validation, name: str) -> Check:
    """Result of one check."""
    return next(check for check in validation.checks if check.name == name)


def scaled(scale: str, body: str = QUAD) -> str:
    """Scene text of a quad below a transform that scales."""
    return text_of("validate_edges/scaled.usda", scale=scale, body=body)


# Stages that agree with their own files, by the least number of comparisons of a check.
AGREEING = {
    "a_huge_thin_triangle_may_be_drawn": {},
    "an_invalid_instancer_still_draws_its_good_instances": {"positions": 1, "inputs": 1},
    "animated_ids_hide_the_instances_that_they_name": {"matrices": 2},
    "curved_paths_stay_close_in_the_scenes_measure": {},
    "faces_that_repeat_a_point_keep_their_area": {"area": 2},
    "geometry_below_a_camera_is_where_the_second_reader_sees_it": {"reader": 1},
    "hidden_nodes_count_for_the_second_reader": {"reader": 1},
    "nan_in_the_stage_is_left_out_or_the_identity": {"positions": 2},
    "planes_of_negative_size_turn_over": {"area": 4},
}


@pytest.mark.parametrize("name", AGREEING)
def test_a_stage_agrees_with_its_file(tmp_path: Path, name: str) -> None:
    convert_text(tmp_path, text_of(f"validate_edges/{name}.usda")).agreeing(**AGREEING[name])


@pytest.mark.parametrize("scale", ["(0, 0, 0)", "(0, 1, 1)", "(1, 1, 0)", "(1e-20, 1e-20, 1e-20)"])
def test_flattened_surfaces_are_compared_by_corners(tmp_path: Path, scale: str) -> None:
    convert_text(tmp_path, scaled(scale)).agreeing(positions=2)


def test_normals_of_surfaces_that_are_not_flattened_still_count(tmp_path: Path) -> None:
    convert_text(tmp_path, scaled("(1, 1, 0.001)")).agreeing(normals=2)


def deep_file(folder: Path, depth: int) -> Path:
    """A file whose nodes nest `depth` levels deep."""
    file = HandFile()
    parent = file.node("/")
    for number in range(depth):
        parent = file.node(f"/{number}", parent)
    return file.write(folder / "deep.glb")


def test_a_crash_of_the_khronos_validator_is_named(
    tmp_path: Path, khronos: None, run_cli: Callable
) -> None:
    shown = run_cli(1, "validate", deep_file(tmp_path, 20_000)).err
    assert "[validator-crash]" in shown
    assert "dart.js" not in shown


def test_a_blunder_of_the_check_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run_cli: Callable
) -> None:
    def blunder(*_: object) -> None:
        raise ZeroDivisionError("float division by zero")

    out = deep_file(tmp_path, 1)
    monkeypatch.setattr(validation_module, "OutputReader", blunder)
    shown = run_cli(1, "validate", out, "--no-khronos").err
    assert "[validate-internal]" in shown
    assert "Traceback" not in shown


MOVING = text_of("validate_edges/moving.usda")


def still_file(folder: Path, body: str) -> Path:
    """The file of a stage that stands still, and a stage whose cube also holds `body`."""
    convert_text(folder, MOVING.replace("BODY", "double xformOp:translateX = 0"))
    (folder / "stage.usda").write_text(MOVING.replace("BODY", body))
    return folder / "out.glb"


@pytest.mark.parametrize(
    "body",
    [
        "double xformOp:translateX.timeSamples = { 0: 0, 10: 5, 20: 0 }",
        "double xformOp:translateX.spline = "
        "{ bezier, 0: 0; post linear, 9: 4; post linear, 20: 0 }",
        "double xformOp:translateX.spline = "
        "{ bezier, 0: 0; post curve (5, 2), 20: 0; pre (5, -2); post curve (5, 2) }",
    ],
    ids=["samples", "knots", "between the knots"],
)
def test_a_file_that_stands_still_fails_where_the_stage_moves(tmp_path: Path, body: str) -> None:
    validation = validate_file(still_file(tmp_path, body), tmp_path / "stage.usda", khronos=False)
    assert not check_of(validation, "positions").passed
    assert not check_of(validation, "matrices").passed
    assert validation.times >= 5


def test_moving_points_are_compared_between_their_keys(tmp_path: Path) -> None:
    frames = "0: [(0, 0, 0), (1, 0, 0), (0, 1, 0)], 20: [(0, 0, 0), (1, 0, 0), (0, 3, 0)]"
    text = text_of(
        "validate_edges/moving_points_are_compared_between_their_keys.usda", frames=frames
    )
    convert_text(tmp_path, text).agreeing(positions=7)
    changed = text.replace("(0, 3, 0)", "(0, 3.1, 0)")
    (tmp_path / "stage.usda").write_text(
        '#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = "Y"\n)\n' + changed
    )
    again = validate_file(tmp_path / "out.glb", tmp_path / "stage.usda", khronos=False)
    assert not check_of(again, "positions").passed


@pytest.mark.parametrize("held", ["stage.usda", "part.usda"])
def test_layers_that_usd_still_holds_are_read_anew(tmp_path: Path, held: str) -> None:
    part = tmp_path / "part.usda"
    part.write_text('#usda 1.0\n(\n    defaultPrim = "m"\n)\n' + f'def Mesh "m"\n{{{QUAD}}}\n')
    done = convert_text(tmp_path, 'def "a" (references = @part.usda@)\n{\n}\n')
    (tmp_path / "gone.usda").write_text("#usda 1.0\n")
    layers = [Sdf.Layer.FindOrOpen(str(tmp_path / name)) for name in (held, "gone.usda")]
    (tmp_path / "gone.usda").unlink()
    if held == "part.usda":
        part.write_text(part.read_text().replace("(1, 1, 0)", "(1, 3, 0)"))
    else:
        text = (tmp_path / held).read_text()
        (tmp_path / held).write_text(text + f'def Mesh "more"\n{{{QUAD}}}\n')
    assert all(layers)
    validation = done.validated()
    assert not validation.passed


def with_warning(folder: Path, text: str, name: str, prim: str, changed: str) -> Validation:
    """The file of `text` with one warning, compared with the stage `changed`."""
    done = convert_text(folder, text)
    Path(f"{done.out}.json").write_text(
        f'{{"warnings": [{{"name": "{name}", "prim": "{prim}", "message": ""}}]}}'
    )
    (folder / "stage.usda").write_text(changed)
    return done.validated()


def test_a_wrong_time_rate_excuses_no_motion(tmp_path: Path) -> None:
    text = MOVING.replace("BODY", "double xformOp:translateX.timeSamples = { 0: 0, 20: 5 }")
    changed = text.replace("20: 5", "20: 9")
    validation = with_warning(tmp_path, text, "time-rate-invalid", "/", changed)
    assert not check_of(validation, "positions").passed


def test_a_damaged_prim_excuses_all_below_it(tmp_path: Path) -> None:
    text = MOVING.replace("BODY", "double xformOp:translateX = 0")
    changed = text + 'def Xform "D"\n{\n    def Xform "E"\n    {\n        def Cube "c"\n'
    changed += "        {\n        }\n    }\n}\n"
    validation = with_warning(tmp_path, text, "prim-damaged", "/D", changed)
    assert check_of(validation, "carried").passed
    assert check_of(validation, "carried").declared >= 1
    validation = with_warning(tmp_path, text, "prim-damaged", "/Dx", changed)
    assert not check_of(validation, "carried").passed


POINT = "point3f[] points = [(0, 0, 0)]\nfloat[] widths = [0.1]\n"
LOST = [
    ("RectLight", "", "asset inputs:texture:file = @sky.png@", "light-texture-dropped"),
    ("SphereLight", "", "float inputs:specular = 0", "light-specular-dropped"),
    ("SphereLight", "", "float inputs:diffuse = 0.5", "light-specular-dropped"),
    ("DistantLight", "ShadowAPI", "bool inputs:shadow:enable = 0", "light-shadow-dropped"),
    ("CylinderLight", "", "bool treatAsLine = 1", "light-line-dropped"),
    ("SphereLight", "ShapingAPI", "float inputs:shaping:focus = 2", "light-shaping-dropped"),
    ("Points", "MeshLightAPI", POINT + "float inputs:intensity = 5", "mesh-light-dropped"),
    ("Camera", "", "float4[] clippingPlanes = [(0, 0, 0, 1)]", "lens-dropped"),
    ("Camera", "", "float exposure:iso = 400", "lens-dropped"),
    ("Camera", "", "float exposure:responsivity = 2", "lens-dropped"),
]


@pytest.mark.parametrize(("kind", "api", "body", "name"), LOST)
def test_inputs_that_gltf_lacks_are_named_and_else_silent(
    tmp_path: Path, kind: str, api: str, body: str, name: str
) -> None:
    schemas = f' (prepend apiSchemas = ["{api}"])' if api else ""
    done = convert_text(tmp_path, f'def {kind} "L"{schemas}\n{{\n{body}\n}}\n')
    assert name in done.warnings("/L")
    validation = done.agreeing()
    declared = [finding.declared for finding in check_of(validation, "inputs").findings]
    assert declared.count(name) == 1
    sidecar = Path(f"{done.out}.json")
    content = json.loads(sidecar.read_text())
    content["warnings"] = [entry for entry in content["warnings"] if entry["name"] != name]
    sidecar.write_text(json.dumps(content))
    silent = done.validated()
    assert not check_of(silent, "inputs").passed


def test_equal_factors_for_both_reflections_scale_the_light(tmp_path: Path) -> None:
    text = text_of("validate_edges/equal_factors_for_both_reflections_scale_the_light.usda")
    done = convert_text(tmp_path, text).proven()
    entry = done.json["extensions"]["KHR_lights_punctual"]["lights"][0]
    assert entry["intensity"] == pytest.approx(12.5)
    assert done.warnings("/L") == set()


def texture_of(name: str, varname: str) -> str:
    """Scene text of a texture and the primvar reader of its UV set."""
    return text_of("validate_edges/texture_of.usda", name=name, varname=varname)


TWO_UVS = text_of(
    "validate_edges/two_uvs.usda",
    texture_a=texture_of("a", "st"),
    texture_b=texture_of("b", "map2"),
    QUAD=QUAD,
)


def test_textures_of_two_uv_sets_in_one_read_the_first(tmp_path: Path) -> None:
    pixels = np.random.default_rng(5).integers(0, 255, (8, 8, 3), dtype=np.uint8)
    Image.fromarray(pixels).save(tmp_path / "rgb.png")
    done = convert_text(tmp_path, TWO_UVS)
    assert "texture-packed-transform" in done.warnings()
    done.agreeing()
    Path(f"{done.out}.json").write_text('{"warnings": []}')
    silent = done.validated()
    assert not check_of(silent, "uvs").passed


def test_normals_of_moving_points_count_at_their_keys_only(tmp_path: Path) -> None:
    """Normals between keys are not compared, also in native instances: glTF blends the normals."""
    frames = "0: [(0, 0, 0), (1, 0, 0), (0, 1, 0)], 20: [(0, 0, 0), (1, 0, 0), (0, 0, 5)]"
    text = text_of(
        "validate_edges/normals_of_moving_points_count_at_their_keys_only.usda", frames=frames
    )
    validation = convert_text(tmp_path, text).agreeing(normals=2)
    assert check_of(validation, "positions").compared > check_of(validation, "normals").compared


PROJECTIVE = text_of("validate_edges/projective.usda")


@pytest.mark.parametrize("kind", ["Cube", "Sphere"])
@pytest.mark.parametrize("column", ["0", "0.25"])
def test_points_are_divided_by_w(tmp_path: Path, kind: str, column: str) -> None:
    validation = convert_text(tmp_path, fill(PROJECTIVE, kind=kind, column=column)).agreeing()
    assert not any(check.declared for check in validation.checks)


def test_a_resampled_animation_excuses_what_it_states_and_no_more(tmp_path: Path) -> None:
    warning = {"name": "animation-resampled", "prim": "/C", "message": "", "deviation": 1e-4}
    for value, silent in ((3e-4, 0), (5e-4, 1)):
        checks = Checks([warning])
        checks.add("positions", "/C", value)
        checks.add("matrices", "/C/child", value)
        assert [checks.checks[name].silent for name in ("positions", "matrices")] == [silent] * 2
    checks.add("triangles", "/C", 1)
    assert checks.checks["triangles"].silent == 1


def test_a_skeletons_warning_excuses_no_mesh_that_it_moves() -> None:
    checks = Checks([{"name": "joint-rotation-normalized", "prim": "/Skel", "message": ""}])
    checks.add("skinning", "/Mesh", 1.0)
    checks.add("skinning", "/Skel", 1.0)
    assert (checks.checks["skinning"].silent, checks.checks["skinning"].declared) == (2, 0)


ORIENT = text_of("validate_edges/orient.usda")


@pytest.mark.parametrize("kind", ["quath", "quatf", "quatd"])
def test_orientations_of_any_length_turn_as_usd_turns_them(tmp_path: Path, kind: str) -> None:
    validation = convert_text(tmp_path, fill(ORIENT, kind=kind)).agreeing()
    assert check_of(validation, "matrices").declared == 0


@pytest.mark.parametrize("output", ["r", "g", "b", "a", "rgb"])
def test_every_output_of_a_texture_reaches_the_emission(tmp_path: Path, output: str) -> None:
    random = np.random.default_rng(4)
    pixels = random.integers(0, 255, (5, 7, 4), dtype=np.uint8)
    Image.fromarray(pixels).save(tmp_path / "t.png")
    scaled_texture = texture("T", "t.png", "float4 inputs:scale = (0.5, 0.25, 1, 0.75)")
    inputs = f"color3f inputs:emissiveColor.connect = </Mat/T.outputs:{output}>"
    validation = shaded(tmp_path, inputs, scaled_texture).agreeing(materials=1)
    assert "prim-damaged" not in {warning["name"] for warning in validation.warnings}


def test_weights_that_are_no_numbers_are_zero(tmp_path: Path, stages: Path) -> None:
    text = (stages / "skin.usda").read_text()
    assert "0: [0]," in text
    validation = convert_text(tmp_path, text.replace("0: [0],", "0: [nan],")).agreeing()
    assert check_of(validation, "skinning").declared == 0


def test_a_smaller_texture_is_compared_as_it_was_enlarged(tmp_path: Path) -> None:
    for name, size, seed in (("small", 8, 1), ("large", 16, 2)):
        pixels = np.random.default_rng(seed).integers(0, 255, (size, size, 3), dtype=np.uint8)
        Image.fromarray(pixels).save(tmp_path / f"{name}.png")
    inputs = "float inputs:roughness.connect = </Mat/A.outputs:g>\n"
    inputs += "float inputs:metallic.connect = </Mat/B.outputs:b>"
    done = shaded(tmp_path, inputs, texture("A", "small.png") + texture("B", "large.png"))
    assert "texture-repacked" in done.warnings("/Mat/A")
    done.agreeing()
    other = np.random.default_rng(9).integers(0, 255, (8, 8, 3), dtype=np.uint8)
    Image.fromarray(other).save(tmp_path / "small.png")
    assert not done.validated().passed


@pytest.mark.parametrize("allowed", [True, False])
def test_the_stage_is_read_from_the_folders_of_the_conversion(
    tmp_path: Path, allowed: bool
) -> None:
    (tmp_path / "far").mkdir()
    (tmp_path / "near").mkdir()
    layer = '#usda 1.0\n( defaultPrim = "P" )\ndef Cube "P"\n{\n}\n'
    (tmp_path / "far" / "part.usda").write_text(layer)
    text = 'def "X" (references = @../far/part.usda@)\n{\n}\ndef Cube "Unit"\n{\n}\n'
    roots = (tmp_path / "far",) if allowed else ()
    done = convert_text(tmp_path / "near", text, extra_roots=roots)
    validation = done.agreeing()
    assert check_of(validation, "positions").compared == 1 + allowed
    assert validation.roots == [str(tmp_path / "near"), *map(str, roots)]


def test_a_sphere_light_without_radius_shines_as_a_point(tmp_path: Path) -> None:
    body = "bool treatAsPoint = 1\nfloat inputs:radius = 0\nfloat inputs:intensity = 8\n"
    done = convert_text(tmp_path, f'def SphereLight "L"\n{{\n{body}}}\n').proven()
    stored = done.json["extensions"]["KHR_lights_punctual"]["lights"][0]
    assert stored["intensity"] == pytest.approx(2.0)


def test_curves_under_a_skeleton_are_carried_at_rest(tmp_path: Path, stages: Path) -> None:
    text = (stages / "skin.usda").read_text()
    curves = text_of("validate_edges/curves_under_a_skeleton_are_carried_at_rest.usda")
    place = text.index('    def Skeleton "')
    (tmp_path / "stage.usda").write_text(text[:place] + curves.lstrip("\n") + text[place:])
    done = Converted(tmp_path / "stage.usda", tmp_path / "out.glb")
    assert "skinning-invalid" in done.warnings("/Body/Hair")
    assert done.gltf.nodes[done.node("/Body/Hair")].mesh is not None
