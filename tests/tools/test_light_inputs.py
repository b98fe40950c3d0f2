"""Owns the tests of lights' inputs beyond emission: each one is carried or named by a warning."""

from pathlib import Path

import pytest
from read_converted import convert_text
from tampering import FACE, UNIT, Output, expect_found, expect_required
from texts import fill, text_of

SHADED = text_of("light_inputs/shaded.usda")
DOME = text_of("light_inputs/dome.usda")
GLOWING = text_of("light_inputs/glowing.usda", FACE=FACE, line="$line")
INPUTS = [
    (SHADED, "color3f inputs:shadow:color = (1, 0, 0)", "light-input-dropped"),
    (SHADED, "float inputs:shadow:distance = 3", "light-input-dropped"),
    (SHADED, "float inputs:shadow:falloff = 2", "light-input-dropped"),
    (SHADED, "color3f inputs:shaping:focusTint = (1, 0, 0)", "light-input-dropped"),
    (SHADED, "asset inputs:shaping:ies:file = @a.ies@", "light-linking-dropped"),
    (
        SHADED.replace("Sphere", "Disk"),
        "float inputs:shaping:cone:angle = 9",
        "light-shaping-dropped",
    ),
    (DOME, "float guideRadius = 5", "light-input-dropped"),
    (DOME, "rel portals = </Unit>", "light-input-dropped"),
    (GLOWING, "bool inputs:normalize = 1", "light-input-dropped"),
    (GLOWING, 'uniform token light:materialSyncMode = "independent"', "light-input-dropped"),
]


@pytest.mark.parametrize(("stage", "line", "warning"), INPUTS)
def test_inputs_without_a_counterpart_are_named(
    tmp_path: Path, stage: str, line: str, warning: str
) -> None:
    expect_required(convert_text(tmp_path, fill(stage, line=line) + UNIT), warning, "/L")


def test_the_warning_has_to_name_the_input(tmp_path: Path) -> None:
    lines = "float inputs:shadow:distance = 3\n    float inputs:shadow:falloff = 2"
    done = convert_text(tmp_path, fill(SHADED, line=lines) + UNIT).proven()
    sidecar = Path(f"{done.out}.json")
    text = sidecar.read_text(encoding="utf-8")
    sidecar.write_text(text.replace("'inputs:shadow:falloff'", "'inputs:shadow:distance'"))
    assert not done.validated().passed


@pytest.mark.parametrize("line", ["float inputs:shadow:distance = -1", "float guideRadius"])
def test_inputs_at_their_fallback_say_nothing(tmp_path: Path, line: str) -> None:
    stage = DOME if "guide" in line else SHADED
    done = convert_text(tmp_path, fill(stage, line=line) + UNIT).proven()
    assert "light-input-dropped" not in done.warnings()


FOREIGN = [
    ('def SphereLight "P"', "int inputs:karma:light:samples", 7),
    ('def SphereLight "P"', "custom float light:whatever", 3.0),
    ('def Xform "P"', "custom string material:foo", "x"),
    ('def Xform "P"', "custom float skel:foo", 1.0),
    ('def Xform "P"', "custom float info:foo", 1.0),
    ('def Xform "P"', "custom float outputs:foo", 1.0),
    ('def Scope "P"', "custom float xformOp:foo", 1.0),
]


@pytest.mark.parametrize(("prim", "name", "value"), FOREIGN)
def test_names_in_a_schemas_namespace_are_kept(
    tmp_path: Path, prim: str, name: str, value: object
) -> None:
    def forget_words(out: Output) -> None:
        for node in out.gltf.nodes:
            (node.extras or {}).pop("attributes", None)

    text = f'"{value}"' if isinstance(value, str) else value
    done = convert_text(tmp_path, f"{prim}\n{{\n    {name} = {text}\n}}\n{UNIT}")
    extras = done.json["nodes"][done.node("/P")]["extras"]
    assert extras["attributes"] == {name.rsplit(" ", 1)[1]: value}
    expect_found(done, forget_words)


def test_the_softness_of_a_cone_is_compared(tmp_path: Path) -> None:
    def sharpen(out: Output) -> None:
        (entry,) = out.gltf.extensions["KHR_lights_punctual"]["lights"]
        entry["spot"]["innerConeAngle"] = 0.01

    lines = "float inputs:shaping:cone:angle = 40\n    float inputs:shaping:cone:softness = 0.5"
    expect_found(convert_text(tmp_path, fill(SHADED, line=lines)), sharpen)
