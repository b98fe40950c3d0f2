"""Primvars that share a name, have long elements, or belong to prims without faces."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from read_converted import Converted, convert_text
from tampering import FACE, UNIT, Output, expect_found, expect_required, mesh
from test_validate_strict import attributes, expect_tree_found, node
from texts import text_of

SHARED = text_of("primvars/shared.usda")
PAIR = text_of("primvars/pair.usda")
LAYERS = text_of("primvars/layers.usda")
CLOUD = text_of("primvars/cloud.usda")
CURVE = text_of("primvars/curve.usda")
CUBIC = text_of("primvars/cubic.usda")


def values(done: Converted, name: str) -> list[Any]:
    """Values of an attribute of the first mesh."""
    found = done.json["meshes"][0]["primitives"][0]["attributes"]
    listed: list[Any] = np.squeeze(done.array(found[name])).tolist()
    return listed


def expect_needed(done: Converted, name: str) -> None:
    """Assert that the validator misses an attribute of the first mesh that the file loses."""
    del done.json["meshes"][0]["primitives"][0]["attributes"][name]
    expect_tree_found(done, done.json)


def test_names_that_would_be_one_are_numbered(tmp_path: Path) -> None:
    done = convert_text(tmp_path, mesh("M", SHARED)).proven()
    assert values(done, "_A_B") == [1, 2, 3, 4]
    assert values(done, "_A_B_2") == [5, 6, 7, 8]
    assert values(done, "_GR__E") == [1, 2, 3, 5]
    assert values(done, "_GR__E_2") == [5, 6, 7, 9]
    told = {"_A_B": "a:b", "_A_B_2": "a_b", "_GR__E": "größe", "_GR__E_2": "grüße"}
    assert done.json["meshes"][0]["extras"]["primvarOf"] == told
    done.json["meshes"][0]["extras"]["primvarOf"]["_A_B"] = "a_b"
    expect_tree_found(done, done.json)


def test_normals_with_long_elements_are_named(tmp_path: Path) -> None:
    values = ", ".join(["(1, 0, 0)"] * 8)
    body = f"normal3f[] primvars:normals = [{values}] (\n"
    body += 'interpolation = "vertex"\nelementSize = 2\n)\n'
    done = convert_text(tmp_path, mesh("M", body))
    told = [w for w in done.sidecar["warnings"] if w["name"] == "primvar-size-wrong"]
    assert [(w["prim"], "'normals'" in w["message"]) for w in told] == [("/M", True)]


@pytest.mark.parametrize("name", ["_A_B", "_A_B_2"])
def test_each_of_them_has_to_be_there(tmp_path: Path, name: str) -> None:
    done = convert_text(tmp_path, mesh("M", SHARED))
    expect_needed(done, name)


def test_elements_of_two_are_vectors(tmp_path: Path) -> None:
    done = convert_text(tmp_path, mesh("M", PAIR))
    assert values(done, "_PAIR") == [[1, 2], [3, 4], [5, 6], [7, 8]]
    expect_found(done, lambda out: out.rewrite(out.attributes("_PAIR")[0], lambda v: v[:, ::-1]))


def test_elements_of_more_than_four_are_named(tmp_path: Path) -> None:
    long = PAIR.replace("= 2\n", "= 5\n").replace("7, 8]", "7, 8" + ", 9" * 12 + "]")
    done = convert_text(tmp_path, mesh("M", long))
    expect_required(done, "primvar-dropped", "/M", "pair")


def test_a_third_coordinate_travels(tmp_path: Path) -> None:
    done = convert_text(tmp_path, mesh("M", LAYERS)).proven()
    assert values(done, "TEXCOORD_0") == [[0, 1], [1, 1], [1, 0], [0, 0]]
    assert values(done, "_ST") == [[0, 0, 5], [1, 0, 6], [1, 1, 7], [0, 1, 8]]
    expect_needed(done, "_ST")


@pytest.mark.parametrize(
    "body",
    [
        'float[] primvars:x = [1, 2, 3, 4, 5] (interpolation = "vertex")',
        'float[] primvars:x = [1, 2, 3] (interpolation = "vertex")',
        "texCoord2f[] primvars:x = [(0, 0), (1, 0), (1, 1), (0, 1), (3, 3)] (VERTEX)",
        'string[] primvars:x = ["a", "b", "c", "d"] (interpolation = "vertex")',
    ],
)
def test_values_without_a_place_are_named(tmp_path: Path, body: str) -> None:
    done = convert_text(
        tmp_path, mesh("M", body.replace("VERTEX", 'interpolation = "vertex"') + "\n")
    )
    kind = "primvar-dropped" if body.startswith("string") else "primvar-size-wrong"
    expect_required(done, kind, "/M", "x")


def test_colors_and_normals_that_are_too_many_are_named(tmp_path: Path) -> None:
    colors = ", ".join(["(1, 0, 0)"] * 5)
    body = f'color3f[] primvars:displayColor = [{colors}] (interpolation = "vertex")\n'
    body += f'normal3f[] primvars:normals = [{colors}] (interpolation = "vertex")\n'
    done = convert_text(tmp_path, mesh("M", body))
    expect_required(done, "primvar-size-wrong", "/M", "displayColor", "normals")


def test_points_keep_their_primvars(tmp_path: Path) -> None:
    done = convert_text(tmp_path, CLOUD.replace("BODY", "")).proven()
    assert values(done, "_HEAT") == [1, 2, 3]
    assert values(done, "TEXCOORD_0") == [[0, 1], [1, 1], [1, 0.75]]
    assert done.gltf.nodes[done.node("/P")].extras["primvars"] == {"all": 3}
    swap = done.json["meshes"][0]["primitives"][0]["attributes"]
    swap["_HEAT"] = swap.pop("TEXCOORD_0")
    expect_tree_found(done, done.json)


@pytest.mark.parametrize(
    ("body", "warning"),
    [
        ("normal3f[] normals = [(0, 0, 1), (0, 0, 1), (0, 0, 1)]", "normals-dropped"),
        ("int64[] ids = [1, 2, 3]", "ids-dropped"),
        ('string[] primvars:x = ["a", "b", "c"] (interpolation = "vertex")', "primvar-dropped"),
        ('float[] primvars:x = [1, 2] (interpolation = "vertex")', "primvar-size-wrong"),
    ],
)
def test_what_points_cannot_hold_is_named(tmp_path: Path, body: str, warning: str) -> None:
    expect_required(convert_text(tmp_path, CLOUD.replace("BODY", body)), warning, "/P")


def test_curves_keep_their_primvars(tmp_path: Path) -> None:
    done = convert_text(tmp_path, CURVE.replace("BODY", ""))
    assert values(done, "_HEAT") == [1, 2, 3, 4, 5]
    assert values(done, "_EACH") == [7, 7, 7, 9, 9]
    expect_found(done, lambda out: out.rewrite(out.attributes("_EACH")[0], lambda v: v + 1))


def test_values_of_control_points_follow_the_curve(tmp_path: Path) -> None:
    done = convert_text(tmp_path, CUBIC)
    assert np.array(values(done, "_HEAT")) == pytest.approx(
        np.concatenate([np.linspace(1, 4, 9), np.linspace(5, 8, 9)])
    )
    expect_needed(done, "_EACH")


def test_widths_are_drawn(tmp_path: Path, stages: Path) -> None:
    def widen(out: Output) -> None:
        out.gltf.meshes[0].primitives[1].extras["width_m"] *= 1.2

    done = convert_text(tmp_path, (stages / "widths.usda").read_text())
    drawn = [
        [round(part["extras"]["width_m"], 4) for part in mesh["primitives"]]
        for mesh in done.json["meshes"][:3]
    ]
    assert drawn == [[0.1, 0.2], [0.15], [0.05, 0.2]]
    assert done.warnings() == {"curves-approximated"}
    expect_found(done, widen)


LOOSE = text_of("primvars/loose.usda")


def test_primvars_of_what_draws_nothing_travel(tmp_path: Path) -> None:
    done = convert_text(tmp_path, LOOSE + UNIT).proven()
    kept = [done.gltf.nodes[done.node(prim)].extras["primvars"] for prim in ("/W", "/W/C", "/W/L")]
    assert kept == [
        {"lonely": 5, "displayColor": [[1, 0, 0]]},
        {"grain": 2},
        {"kind": "warm"},
    ]
    node(done.json, "C")["extras"].pop("primvars")
    expect_tree_found(done, done.json)


def test_constants_of_gprims_have_to_be_right(tmp_path: Path) -> None:
    done = convert_text(tmp_path, mesh("M", "float primvars:age = 7\n")).proven()
    node(done.json, "M")["extras"]["primvars"]["age"] = 8
    expect_tree_found(done, done.json)


@pytest.mark.parametrize(
    ("text", "prim"),
    [
        ('def Xform "W" {\nfloat[] primvars:x = [1, 2] (interpolation = "vertex")\n}\n', "/W"),
        ('def Material "W" {\nfloat primvars:x = 1\n}\n', "/W"),
        ('def Xform "W" {\nfloat[] primvars:x = [' + "1, " * 65 + "1]\n}\n", "/W"),
    ],
)
def test_loose_primvars_without_a_place_are_named(tmp_path: Path, text: str, prim: str) -> None:
    expect_required(convert_text(tmp_path, text + UNIT), "primvar-dropped", prim, "x")


def test_animated_loose_primvars_are_named(tmp_path: Path) -> None:
    text = 'def Camera "C" {\nfloat primvars:x.timeSamples = { 0: 1, 9: 2 }\n}\n'
    done = convert_text(tmp_path, text + UNIT).proven()
    assert "primvar-animation-frozen" in done.warnings("/C")
    assert "_X" not in attributes(done.json, "Unit")


@pytest.mark.parametrize("moving", ["", "moving"])
def test_animated_normals_are_named(tmp_path: Path, moving: str) -> None:
    keys = ", ".join(["(0, 0, 1)"] * 4), ", ".join(["(0, 1, 0)"] * 4)
    body = f"normal3f[] normals.timeSamples = {{ 0: [{keys[0]}], 9: [{keys[1]}] }}\n"
    text = mesh("M", body)
    if moving:
        line = next(line for line in FACE.splitlines() if "points" in line)
        first = line.partition("=")[2]
        last = first.replace("(1, 1, 0)", "(1, 2, 0)")
        text = text.replace(line, f"point3f[] points.timeSamples = {{ 0: {first}, 9: {last} }}")
    done = convert_text(tmp_path, text)
    assert done.gltf.animations and done.validated().passed
    assert f"geometry-animation-{'frozen' if moving else 'held'}" in done.warnings("/M")
