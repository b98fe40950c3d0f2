"""Animated materials: a warning names each input that stays at its first value, and is required."""

from pathlib import Path

import pytest
from material_stages import noise, save, shaded, stage, texture
from read_converted import convert_text
from tampering import expect_required
from texts import text_of

DIFFUSE = "color3f inputs:diffuseColor.connect = </Mat/T.outputs:rgb>"
PLACED = text_of("animated_materials/placed.usda")
TURNED = "float inputs:rotation.timeSamples = { 0: 0, 10: 90 }"
FILES = "asset inputs:file.timeSamples = { 0: @./t.png@, 10: @./u.png@ }"
INPUTS = {
    "file": FILES,
    "scale": "float4 inputs:scale.timeSamples = { 0: (1, 1, 1, 1), 10: (0.5, 1, 1, 1) }",
    "bias": "float4 inputs:bias.timeSamples = { 0: (0, 0, 0, 0), 10: (0.5, 0, 0, 0) }",
    "wrapS": 'token inputs:wrapS.timeSamples = { 0: "repeat", 10: "clamp" }',
    "fallback": "float4 inputs:fallback.timeSamples = { 0: (0, 0, 0, 1), 10: (1, 1, 1, 1) }",
}


@pytest.mark.parametrize("name", INPUTS)
def test_an_animated_texture_is_named(tmp_path: Path, name: str) -> None:
    for file in ("t.png", "u.png"):
        save(tmp_path, file, noise("RGB"))
    plain = texture("T", "t.png").replace("asset inputs:file = @./t.png@", "")
    plain = plain.replace('token inputs:wrapS = "repeat"', "")
    body = INPUTS[name] if name == "file" else INPUTS[name] + "\nasset inputs:file = @./t.png@"
    if name != "wrapS":
        body += '\ntoken inputs:wrapS = "repeat"'
    node = plain.replace("float3 outputs:rgb", f"{body}\nfloat3 outputs:rgb")
    done = shaded(tmp_path, DIFFUSE, node)
    expect_required(done, "material-animation-frozen", "/Mat/T", f"inputs:{name}")


def test_an_animated_transform_is_named(tmp_path: Path) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    nodes = PLACED.replace("BODY", TURNED) + texture("T", "t.png", st="/Mat/X.outputs:result")
    done = shaded(tmp_path, DIFFUSE, nodes)
    expect_required(done, "material-animation-frozen", "/Mat/X", "inputs:rotation")


def test_an_animated_set_is_named(tmp_path: Path) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    other = (
        'texCoord2f[] primvars:other = [(0, 0), (2, 0), (1, 5), (0, 1)] (interpolation = "vertex")'
    )
    text = stage(DIFFUSE, texture("T", "t.png"), other)
    moving = 'string inputs:varname.timeSamples = { 0: "st", 10: "other" }'
    done = convert_text(tmp_path, text.replace('string inputs:varname = "st"', moving))
    expect_required(done, "material-animation-frozen", "/Mat/St", "inputs:varname")


def test_an_animated_color_is_named(tmp_path: Path) -> None:
    done = shaded(
        tmp_path, "color3f inputs:diffuseColor.timeSamples = { 0: (1, 0, 0), 10: (0, 1, 0) }"
    )
    expect_required(done, "material-animation-frozen", "/Mat/S", "inputs:diffuseColor")


def test_every_instance_of_an_animated_look_is_named(tmp_path: Path) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    moving = "float4 inputs:scale.timeSamples = { 0: (1, 1, 1, 1), 10: (0.5, 1, 1, 1) }"
    inner = stage(DIFFUSE, texture("T", "t.png", moving)).replace("</Mat", "</P/Mat")
    body = f'def Xform "P" {{\n{inner}\n}}\n'
    body += "".join(
        f'def Xform "{name}" (instanceable = true\nreferences = </P>) {{ }}\n' for name in "AB"
    )
    done = convert_text(tmp_path, body)
    for prim in ("/A/Mat/T", "/B/Mat/T"):
        expect_required(done, "material-animation-frozen", prim, "inputs:scale")


def test_strict_refuses_animated_looks(tmp_path: Path) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    nodes = PLACED.replace("BODY", TURNED) + texture("T", "t.png", st="/Mat/X.outputs:result")
    with pytest.raises(Exception, match="material-animation-frozen"):
        shaded(tmp_path, DIFFUSE, nodes, strict=True)
