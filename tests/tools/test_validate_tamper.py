"""Damaged outputs with a correct sidecar: a warning excuses only its own deviation."""

from pathlib import Path

import pytest
from material_stages import stage as material_stage
from material_stages import texture
from tampering import (
    FACE,
    NORMALS,
    UNIT,
    UVS,
    Case,
    animate,
    change,
    clip,
    expect_case,
    grow,
    hide_colors,
    light,
    look,
    lose,
    mesh,
    move_uvs,
    place,
    turn_normals,
    zoom,
)
from texts import text_of

SUBSET = 'def GeomSubset "S" {\nuniform token familyName = "mine"\nint[] indices = [0]\n}\n'
EMPTY = 'def Mesh "E" { }\n'
EDGE = FACE.replace("[4]", "[4, 2]").replace("3]", "3, 0, 1]")
STRING = 'string[] primvars:note = ["a", "b", "c", "d"] (interpolation = "vertex")\n'
SPEED = "vector3f[] velocities = [(0, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0, 0)]\n"
SHEARED = text_of("validate_tamper/sheared.usda")
PERSPECTIVE = text_of("validate_tamper/perspective.usda")

INSTANCER = text_of("validate_tamper/instancer.usda").replace("FACE", FACE)
LENS = 'def Camera "C"\n{\nfloat fStop = 2.8\nfloat focusDistance = 5\n}\n'
BAD_CLIP = 'def Camera "C"\n{\nfloat2 clippingRange = (5, 1)\n}\n'
GLASS = "color3f inputs:diffuseColor = (0.5, 0.2, 0.1)\nfloat inputs:opacity = 0.5\n"
BUMPS = material_stage(
    "float inputs:displacement.connect = </Mat/T.outputs:r>", texture("T", "t.png")
)
BRIGHT = "color3f inputs:diffuseColor = (2, 0.2, 0.1)\n"
CUBE = text_of("validate_tamper/cube.usda")
OTHER = text_of("validate_tamper/other.usda")
UNBOUND = material_stage("color3f inputs:diffuseColor = (0.2, 0.2, 0.1)")
NO_UVS = material_stage(
    "color3f inputs:diffuseColor.connect = </Mat/T.outputs:rgb>", texture("T", "t.png")
).replace("primvars:st =", "primvars:other =")
GONE = material_stage(
    "color3f inputs:diffuseColor.connect = </Mat/T.outputs:rgb>",
    texture("T", "none.png", "float4 inputs:fallback = (0.1, 0.7, 0.2, 1)"),
)
PACKED = material_stage(
    "float inputs:roughness.connect = </Mat/R.outputs:r>\n"
    "float inputs:metallic.connect = </Mat/T.outputs:r>",
    texture("R", "small.png") + texture("T", "t.png"),
)
UNKNOWN_BASIS = text_of("validate_tamper/unknown_basis.usda")
CASES: list[Case] = [
    ("a subset below", mesh("M", SUBSET) + UNIT, "subset-dropped", lose("/M")),
    ("an empty child", mesh("M", EMPTY) + UNIT, "mesh-empty", lose("/")),
    ("an edge", f'def Mesh "M" {{{EDGE}}}\n', "face-degenerate", grow),
    ("a string", mesh("M", STRING + UVS), "primvar-dropped", move_uvs),
    ("a string on normals", mesh("M", STRING + NORMALS), "primvar-dropped", turn_normals),
    ("velocities", mesh("M", SPEED), "velocities-dropped", grow),
    (
        "velocities of an instancer",
        INSTANCER.replace("BODY", SPEED.replace(", (0, 0, 0), (0, 0, 0)]", "]")),
        "velocities-dropped",
        place,
    ),
    ("perspective", mesh("M", PERSPECTIVE) + UNIT, "transform-projective", place),
    ("resampling", mesh("M", SHEARED) + UNIT, "animation-resampled", animate),
    ("opacity", material_stage(GLASS), "opacity-approximated", look(roughnessFactor=1.0)),
    (
        "opacity and alpha",
        material_stage(GLASS),
        "opacity-approximated",
        look(baseColorFactor=[0.5, 0.2, 0.1, 0.9]),
    ),
    (
        "a clamp",
        material_stage(BRIGHT),
        "material-value-clamped",
        look(baseColorFactor=[0.5, 0.2, 0.1, 1.0]),
    ),
    ("a displacement", BUMPS, "displacement-sampled", grow),
    ("a bumped set", BUMPS, "displacement-sampled", change("TEXCOORD_0", lambda v: v + 0.3)),
    ("a lost texture", GONE, "texture-missing", look(baseColorFactor=[1.0, 1.0, 1.0, 1.0])),
    ("a missing set", NO_UVS, "uv-missing", change("TEXCOORD_1", lambda v: v + 0.3)),
    (
        "a missing set on normals",
        NO_UVS.replace("rel material", NORMALS + "rel material"),
        "uv-missing",
        turn_normals,
    ),
    ("a resized texture", PACKED, "texture-repacked", look(roughnessFactor=0.5)),
    (
        "colors of faces",
        CUBE + mesh("M", "color3f[] primvars:displayColor = [(1, 0, 0)]\n"),
        "primvar-order-assumed",
        hide_colors,
    ),
    (
        "another shader",
        OTHER + mesh("N", "rel material:binding = </Odd>\n", "MaterialBindingAPI") + UNBOUND,
        "material-unsupported",
        look(metallicFactor=0.9, roughnessFactor=0.1),
    ),
    (
        "an area",
        'def RectLight "L" { }\n' + UNIT,
        "area-light-approximated",
        light(intensity=99999.0),
    ),
    (
        "the color of an area",
        'def DiskLight "L" { }\n' + UNIT,
        "area-light-approximated",
        light(color=[0, 1, 0]),
    ),
    (
        "the power of a cylinder",
        'def CylinderLight "L" { }\n' + UNIT,
        "area-light-approximated",
        light(intensity=0.01),
    ),
    (
        "negative light",
        'def SphereLight "L"\n{\nfloat inputs:intensity = -3\n}\n' + UNIT,
        "light-invalid",
        light(intensity=3.0),
    ),
    ("a lens", LENS + UNIT, "lens-dropped", zoom),
    ("a lens elsewhere", LENS + UNIT, "lens-dropped", place),
    ("a clipping range", BAD_CLIP + UNIT, "camera-clip-invalid", clip),
    ("a volume", 'def Volume "V" { }\n' + UNIT, "Volume-dropped", lose("/Unit")),
    ("a volume above", f'def Volume "V" {{\n{UNIT}}}\n', "Volume-dropped", lose("/V/Unit")),
    (
        "curves",
        f'def BasisCurves "N" {{ {UNKNOWN_BASIS} }}\n' + UNIT,
        "curves-dropped",
        lose("/Unit"),
    ),
]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case[0].replace(" ", "-"))
def test_a_warning_excuses_nothing_but_what_it_names(tmp_path: Path, case: Case) -> None:
    expect_case(tmp_path, case)
