"""Owns the tests of material values and of the shading networks that drive them."""

from pathlib import Path

import numpy as np
import pytest
from material_stages import material, noise, save, shaded, stage, texture
from read_converted import Converted, convert_text
from test_validate_strict import expect_tree_found
from texts import text_of


def test_constants(tmp_path: Path) -> None:
    done = shaded(
        tmp_path,
        "color3f inputs:diffuseColor = (0.1, 0.2, 0.3)\nfloat inputs:metallic = 0.4\n"
        "float inputs:roughness = 0.6\ncolor3f inputs:emissiveColor = (4, 2, 0)\n"
        "float inputs:ior = 1.33\nfloat inputs:clearcoat = 0.7\n"
        "float inputs:clearcoatRoughness = 0.2\nfloat inputs:opacity = 0.5",
        body="uniform bool doubleSided = 0",
    )
    found = material(done)
    pbr = found["pbrMetallicRoughness"]
    assert pbr["baseColorFactor"] == pytest.approx([0.1, 0.2, 0.3, 0.5])
    assert (pbr["metallicFactor"], pbr["roughnessFactor"]) == pytest.approx((0.4, 0.6))
    extensions = found["extensions"]
    strength = extensions["KHR_materials_emissive_strength"]["emissiveStrength"]
    assert np.array(found["emissiveFactor"]) * strength == pytest.approx([4, 2, 0])
    assert extensions["KHR_materials_ior"]["ior"] == pytest.approx(1.33)
    coat = extensions["KHR_materials_clearcoat"]
    assert coat["clearcoatFactor"] == pytest.approx(0.7)
    assert coat["clearcoatRoughnessFactor"] == pytest.approx(0.2)
    assert found["alphaMode"] == "BLEND"
    assert found["doubleSided"] is True


def test_fallbacks_are_those_of_the_preview_surface(tmp_path: Path) -> None:
    pbr = material(shaded(tmp_path, ""))["pbrMetallicRoughness"]
    assert pbr["baseColorFactor"] == pytest.approx([0.18, 0.18, 0.18, 1])
    assert (pbr["metallicFactor"], pbr["roughnessFactor"]) == (0.0, 0.5)


# In even light of 1 the stage's (1, 0, 1) is (1 - s, 0, s) in the file: nearest by s = 1/2.
SPECULAR = [((0.9, 0.5, 0.02), (0.18,) * 3, 1.0), ((0, 0, 1), (1, 0, 0), 0.5)]
SPECULAR += [((0.5, 0.25, 0), (1, 0.5, 0), 1.0)]  # of one hue: any share deviates alike


@pytest.mark.parametrize(("specular", "diffuse", "kept"), SPECULAR)
def test_specular_workflow_keeps_the_reflectance_beside_a_diffuse_color(
    tmp_path: Path, specular: tuple[float, ...], diffuse: tuple[float, ...], kept: float
) -> None:
    colors = f"color3f inputs:specularColor = {specular}\ncolor3f inputs:diffuseColor = {diffuse}"
    done = shaded(tmp_path, f"int inputs:useSpecularWorkflow = 1\n{colors}").proven()
    found = material(done)
    factor = found["extensions"]["KHR_materials_specular"]["specularColorFactor"]
    # KHR_materials_specular: F0 = ((ior - 1) / (ior + 1))^2 * specularColor, ior 1.5.
    f0 = np.array(factor) * ((1.5 - 1) / (1.5 + 1)) ** 2
    assert f0 == pytest.approx(kept * np.array(specular))
    assert found["pbrMetallicRoughness"]["metallicFactor"] == 0.0


GLASS = [(1.5, 0, 1.0), (1.3, 0, 0.425), (2, 0, None), (-1, 0, None), (1.5, 1, None)]


@pytest.mark.parametrize(("ior", "metallic", "coat"), GLASS)
def test_rough_glass_is_clear_below_its_highlight(
    tmp_path: Path, ior: float, metallic: float, coat: float | None
) -> None:
    numbers = {"opacity": 0, "roughness": 0.3, "ior": ior, "metallic": metallic}
    text = "".join(f"float inputs:{name} = {number}\n" for name, number in numbers.items())
    found = material(shaded(tmp_path, text))
    assert found["extensions"]["KHR_materials_transmission"] == {"transmissionFactor": 1.0}
    layer = found["extensions"].get("KHR_materials_clearcoat")
    roughness = found["pbrMetallicRoughness"]["roughnessFactor"]
    if coat is None:
        assert (layer, roughness) == (None, pytest.approx(0.3))
        return
    # A coat reflects 4 % head on.
    assert layer["clearcoatFactor"] == pytest.approx(coat, abs=1e-3)
    assert layer["clearcoatRoughnessFactor"] == pytest.approx(0.3)
    assert found["extensions"]["KHR_materials_specular"]["specularFactor"] == 0.0
    assert roughness == 0.0


def displaced(tmp_path: Path, displacement: str) -> Converted:
    """A square of four times its depth, with the corners at the texels of an image of 2 x 2."""
    save(tmp_path, "d.png", np.array([[10, 20], [40, 80]], dtype=np.uint8))
    body = "float4 inputs:scale = (2, 1, 1, 1)\nfloat4 inputs:bias = (-0.1, 0, 0, 0)"
    scaled = 'double3 xformOp:scale = (2, 2, 4)\nuniform token[] xformOpOrder = ["xformOp:scale"]'
    text = stage(f"float inputs:displacement{displacement}", texture("T", "d.png", body), scaled)
    centers = "[(.25, .25), (.75, .25), (.75, .75), (.25, .75)]"
    text = text.replace("[(0,0), (1,0), (1,1), (0,1)]", centers)
    return convert_text(tmp_path, text)


@pytest.mark.parametrize("source", [" = 0.3", ".connect = </Mat/T.outputs:r>"])
def test_meshes_are_displaced_by_units_of_the_stage(tmp_path: Path, source: str) -> None:
    done = displaced(tmp_path, source).proven()
    found = np.unique(done.attribute(0, 0, "POSITION"), axis=0)
    unit = found[:, 0].max()
    texels = np.array([[40, 10], [80, 20]]).reshape(-1) / 255 * 2 - 0.1  # by x, then by y
    expected = texels if "connect" in source else np.full(4, 0.3)
    assert found[:, 2] / unit == pytest.approx(expected / 4, abs=1e-6)
    assert done.warnings("/M") == {"displacement-sampled"}
    assert not done.warnings("/Mat")


def test_displacement_moves_the_points_of_the_refined_mesh(tmp_path: Path) -> None:
    text = stage("float inputs:displacement = 0.3").replace('"none"', '"catmullClark"')
    done = convert_text(tmp_path, text, subdiv_level=2).proven()
    found = np.unique(done.attribute(0, 0, "POSITION"), axis=0)
    assert len(found) == 25
    assert found[:, 2] == pytest.approx(0.3 * found[:, 0].max())


def test_displacement_that_nothing_connects_is_named(tmp_path: Path) -> None:
    line = "token outputs:displacement.connect = </Mat/S.outputs:displacement>\n"
    done = convert_text(tmp_path, stage("float inputs:displacement = 0.3").replace(line, ""))
    assert np.all(done.attribute(0, 0, "POSITION")[:, 2] == 0.0)
    assert done.warnings("/Mat") == {"displacement-dropped"}


def test_second_uv_set_gets_its_own_slot(tmp_path: Path) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    save(tmp_path, "u.png", noise("RGB", seed=9))
    reader = text_of("convert_material/second_uv_set_gets_its_own_slot.usda")
    done = shaded(
        tmp_path,
        "color3f inputs:diffuseColor.connect = </Mat/T.outputs:rgb>\n"
        "color3f inputs:emissiveColor.connect = </Mat/U.outputs:rgb>",
        reader + texture("T", "t.png") + texture("U", "u.png", st="/Mat/Other.outputs:result"),
        'texCoord2f[] primvars:second = [(5,5), (6,5), (6,6), (5,6)] (interpolation="vertex")',
    )
    found = material(done)
    slots = {
        "st": found["pbrMetallicRoughness"]["baseColorTexture"].get("texCoord", 0),
        "second": found["emissiveTexture"].get("texCoord", 0),
    }
    assert sorted(slots.values()) == [0, 1]
    assert done.attribute(0, 0, f"TEXCOORD_{slots['second']}")[:, 0].min() == 5
    assert done.attribute(0, 0, f"TEXCOORD_{slots['st']}")[:, 0].max() == 1


def test_display_color_through_a_primvar_reader(tmp_path: Path) -> None:
    reader = text_of("convert_material/display_color_through_a_primvar_reader.usda")
    body = "color3f[] primvars:paint = [(1,0,0), (0,1,0), (0,0,1), (0,0,0)] "
    body += '(interpolation = "vertex")'
    done = shaded(
        tmp_path, "color3f inputs:diffuseColor.connect = </Mat/C.outputs:result>", reader, body
    )
    assert done.attribute(0, 0, "COLOR_0").sum(axis=0)[:3].min() > 0
    assert material(done)["pbrMetallicRoughness"]["baseColorFactor"] == [1, 1, 1, 1]


def test_display_color_does_not_tint_a_bound_material(tmp_path: Path) -> None:
    body = "color3f[] primvars:displayColor = [(1,0,0), (0,1,0), (0,0,1), (0,0,0)] "
    body += '(interpolation = "vertex")'
    done = shaded(tmp_path, "color3f inputs:diffuseColor = (1, 1, 1)", "", body)
    assert "COLOR_0" not in done.json["meshes"][0]["primitives"][0]["attributes"]


@pytest.mark.parametrize(("name", "told"), [("PxrDisney", "'PxrDisney'"), ("", "no name")])
def test_unknown_shaders_are_told_and_colors_shown(tmp_path: Path, name: str, told: str) -> None:
    text = stage("").replace('"UsdPreviewSurface"', f'"{name}"')
    body = "color3f[] primvars:displayColor = [(0.5, 0.25, 0)]"
    text = text.replace("rel material:binding", body + "\n    rel material:binding")
    done = convert_text(tmp_path, text)
    assert "material-unsupported" in done.warnings("/Mat")
    assert told in str(done.sidecar)
    assert material(done)["pbrMetallicRoughness"]["baseColorFactor"] == [0.5, 0.25, 0, 1]


@pytest.mark.parametrize("output", ["rgb", "r"])
@pytest.mark.parametrize("bias", ["(0.5, 0, 0, 0)", "(0, 0, 0, 0)", "(-1, -0.5, 2, 0)"])
def test_textured_emission_above_one_keeps_its_strength(
    tmp_path: Path, output: str, bias: str
) -> None:
    save(tmp_path, "t.png", noise("RGB", (32, 32)))
    node = texture(
        "T", "t.png", f"float4 inputs:scale = (3, 7, 100, 1)\nfloat4 inputs:bias = {bias}"
    )
    inputs = f"color3f inputs:emissiveColor.connect = </Mat/T.outputs:{output}>"
    done = shaded(tmp_path, inputs, node).proven()
    look = material(done)
    strength = look["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
    first, last = float(bias[1:].split(",")[0]), float(bias.split(",")[2])
    assert strength == pytest.approx(100 + last if output == "rgb" else 3 + first)
    look["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength * 0.98
    expect_tree_found(done, done.json)
