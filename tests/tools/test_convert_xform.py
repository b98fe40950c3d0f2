"""Owns the tests of transforms: units, axis, op stacks, shear, keys, against USD's values."""

from pathlib import Path

import numpy as np
import pytest
from convert_world_matrices import check_world
from read_converted import convert_text
from reflet_usd.convert.xform import decompose, nearest_trs, split_shear
from tampering import FACE, UNIT, expect_required
from texts import fill, text_of

STACK = text_of("convert_xform/stack.usda")


@pytest.mark.parametrize("axis", ["Y", "Z"])
@pytest.mark.parametrize("meters", [0.01, 1.0, 0.3048])
def test_static_stacks_agree_with_usd(tmp_path: Path, axis: str, meters: float) -> None:
    done = convert_text(tmp_path, fill(STACK, axis=axis, meters=meters))
    for prim in ("/A/B", "/A/C"):
        check_world(done, prim, [None])
    size = done.triangles(0).reshape(-1, 3).max()
    assert size == pytest.approx(meters, rel=1e-6)


@pytest.mark.parametrize("order", ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"])
def test_every_euler_order_animated_is_exact(tmp_path: Path, order: str) -> None:
    done = convert_text(tmp_path, text_of("convert_xform/euler_order.usda", order=order))
    assert "animation-resampled" not in done.warnings()
    check_world(done, "/C", [0, 1.7, 5, 9.9, 10, 13.3, 20])


@pytest.mark.parametrize(
    ("ops", "names"),
    [
        ("float xformOp:rotateY.timeSamples = { 1: 0, 48: 720 }", ["xformOp:rotateY"]),
        (
            "quatf xformOp:orient.timeSamples = { 1: (1,0,0,0), 25: (0.5,0.5,0.5,0.5) }",
            ["xformOp:orient"],
        ),
        (
            "double3 xformOp:translate.timeSamples = { 1: (0,0,0), 9: (9,0,0), 48: (0,4,0) }\n"
            "float3 xformOp:scale.timeSamples = { 1: (1,1,1), 48: (3,1,-2) }",
            ["xformOp:translate", "xformOp:scale"],
        ),
        (
            "double3 xformOp:translate:p = (5, 0, 0)\n"
            "float xformOp:rotateZ.timeSamples = { 1: 0, 24: 90, 48: 100 }",
            ["xformOp:translate:p", "xformOp:rotateZ", "!invert!xformOp:translate:p"],
        ),
        (
            "float3 xformOp:scale = (1, 4, 1)\n"
            "float xformOp:rotateX.timeSamples = { 1: 0, 48: 170 }",
            ["xformOp:scale", "xformOp:rotateX"],
        ),
        *(
            (
                f"float xformOp:rotateY.timeSamples = {{ 1: 0, 48: 300 }}\n{op}",
                ["xformOp:rotateY", f"!invert!xformOp:{inverted}"],
            )
            for inverted, op in {
                "translate": "double3 xformOp:translate.timeSamples = { 1: (0,0,0), 48: (0,4,3) }",
                "rotateX": "float xformOp:rotateX.timeSamples = { 1: 0, 48: 170 }",
                "rotateXYZ": "float3 xformOp:rotateXYZ.timeSamples = { 1: (9,0,5), 48: (60,9,80) }",
            }.items()
        ),
    ],
)
def test_keys_are_kept_and_exact_between_them(tmp_path: Path, ops: str, names: list[str]) -> None:
    order = ", ".join(f'"{name}"' for name in names)
    text = f'def Cube "C" {{\n{ops}\nuniform token[] xformOpOrder = [{order}]\n}}'
    done = convert_text(tmp_path, text)
    assert "animation-resampled" not in done.warnings()
    check_world(done, "/C", [1, 1.5, 8, 12.25, 24, 30, 47, 48])


def test_an_animated_matrix_is_sampled_and_said(tmp_path: Path) -> None:
    text = text_of("convert_xform/an_animated_matrix_is_sampled_and_said.usda")
    done = convert_text(tmp_path, text)
    assert "animation-resampled" in done.warnings("/C")
    check_world(done, "/C", [0, 10])


def test_shear_is_two_nodes_and_exact(tmp_path: Path) -> None:
    text = text_of("convert_xform/shear_is_two_nodes_and_exact.usda")
    done = convert_text(tmp_path, text)
    assert "shear-split" in done.warnings("/C")
    check_world(done, "/C", [None])


def test_random_matrices_are_rebuilt() -> None:
    random = np.random.default_rng(11)
    for _ in range(200):
        matrix = np.eye(4)
        matrix[:3] = random.normal(size=(3, 4))
        outer, inner = split_shear(matrix)
        assert outer.matrix() @ inner.matrix() == pytest.approx(matrix, abs=1e-12)
        rotation = np.linalg.qr(random.normal(size=(3, 3)))[0]
        scale = random.normal(size=3) * (random.random(3) > 0.2)
        matrix[:3, :3] = rotation * scale
        parts = decompose(matrix)
        assert parts is not None
        assert parts.matrix() == pytest.approx(matrix, abs=1e-9)
        assert nearest_trs(matrix).matrix() == pytest.approx(matrix, abs=1e-9)


def test_frames_cut_the_keys(tmp_path: Path) -> None:
    text = text_of("convert_xform/frames_cut_the_keys.usda")
    done = convert_text(tmp_path, text, frames=(12.0, 36.0))
    times = done.array(done.gltf.animations[0].samplers[0].input)[:, 0]
    assert times == pytest.approx([0, 0.5, 1.0])
    for seconds, x in ((0.0, 12.0), (0.5, 24.0), (1.0, 12.0)):
        assert done.world(seconds)[done.node("/C")][0, 3] == pytest.approx(x)


def test_animated_visibility_travels(tmp_path: Path) -> None:
    text = text_of("convert_xform/animated_visibility_travels.usda")
    done = convert_text(tmp_path, text)
    assert "KHR_node_visibility" in done.json["extensionsUsed"]
    target = done.json["animations"][0]["channels"][0]["target"]
    pointer = target["extensions"]["KHR_animation_pointer"]["pointer"]
    assert pointer == f"/nodes/{done.node('/C')}/extensions/KHR_node_visibility/visible"
    sampler = done.json["animations"][0]["samplers"][0]
    assert done.array(sampler["output"])[:, 0].tolist() == [1, 0]
    assert sampler["interpolation"] == "STEP"


@pytest.mark.parametrize(
    ("diagonal", "scale"),
    [
        ((2, 3, 4), (2, 3, 4)),
        ((2, -3, 4), (2, -3, 4)),
        ((-2, -3, 4), (2, 3, 4)),
        ((-1, -1, -1), (-1, -1, -1)),
        ((0, 0, 5), (0, 0, 5)),
    ],
)
def test_half_turns_are_rotations_and_mirrors_are_scales(
    diagonal: tuple[float, ...], scale: tuple[float, ...]
) -> None:
    matrix = np.diag([*diagonal, 1.0])
    parts = decompose(matrix)
    assert parts is not None
    assert parts.scale == pytest.approx(scale)
    assert parts.matrix() == pytest.approx(matrix)


BAD_OPS = text_of("convert_xform/bad_ops.usda")


@pytest.mark.parametrize(
    "token", ["xformOp:nope", "xformOp:translate:missing", "!invert!xformOp:scale", "translate", ""]
)
def test_ops_that_are_not_there_are_named(tmp_path: Path, token: str) -> None:
    text = fill(BAD_OPS, name="X", token=token, face=FACE)
    done = convert_text(tmp_path, text + fill(BAD_OPS, name="Y", token=token, face=FACE))
    for prim in ("/X", "/Y"):
        expect_required(done, "xform-op-invalid", prim)
    assert "prim-damaged" not in done.warnings()
    assert done.world(0.5)[done.node("/X/C")][0, 3] == pytest.approx(1.5)


def test_an_op_of_no_known_kind_is_damage(tmp_path: Path) -> None:
    text = fill(BAD_OPS, name="X", token="xformOp:nope", face=FACE)
    text = text.replace(
        "float xformOp:rotateX", "float xformOp:nope = 1\n    float xformOp:rotateX"
    )
    done = convert_text(tmp_path, text + UNIT).proven()
    assert "prim-damaged" in done.warnings("/X")


def test_an_instance_with_such_an_op_is_named(tmp_path: Path) -> None:
    part = fill(BAD_OPS, name="X", token="xformOp:nope", face=FACE)
    text = f'def Xform "P"\n{{\n{part}}}\n'
    text += 'def "I" (\n    instanceable = true\n    references = </P>\n)\n{\n}\n'
    done = convert_text(tmp_path, text).proven()
    assert "xform-op-invalid" in done.warnings("/I/X")
