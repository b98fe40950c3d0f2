"""Owns the tests of native instances and point instancers: placed, shared, masked, cyclic."""

from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom
from read_converted import Converted, convert_text
from reflet_usd.convert import instance_motion as motion_module
from reflet_usd.convert import instancer as instancer_module
from tampering import Output, expect_found
from texts import fill, text_of

QUAD = text_of("convert_instances/quad.usda")

NATIVE = text_of("convert_instances/native.usda", QUAD=QUAD)


def test_native_instances_share_meshes_unless_they_look_different(
    tmp_path: Path,
) -> None:
    done = convert_text(tmp_path, NATIVE)
    meshes = [done.gltf.nodes[done.node(f"/{name}/Q")].mesh for name in "ABC"]
    assert meshes[0] == meshes[2] != meshes[1]
    world = done.world()
    assert world[done.node("/A/Q")][:3, 3] == pytest.approx([1, 2, 6])
    assert world[done.node("/C/Q")][:3, 3] == pytest.approx([0, 0, 3])
    colors = [
        done.json["materials"][done.json["meshes"][m]["primitives"][0]["material"]] for m in meshes
    ]
    assert colors[1]["pbrMetallicRoughness"]["baseColorFactor"] == [1, 0, 0, 1]
    assert colors[0]["pbrMetallicRoughness"]["baseColorFactor"] != [1, 0, 0, 1]


POINTS = text_of("convert_instances/points.usda", QUAD=QUAD)


def test_an_instance_without_prototype_is_named(tmp_path: Path) -> None:
    done = convert_text(tmp_path, POINTS).proven()
    assert "instancer-invalid" in done.warnings("/I")
    instances = [n for n in done.gltf.nodes if (n.extras or {}).get("instancer") == "/I"]
    assert len(instances) == 3
    assert len(done.gltf.meshes) == 2


def test_many_instances_go_to_the_gpu_extension(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(instancer_module, "MAX_INSTANCE_NODES", 1)
    done = convert_text(tmp_path, POINTS).proven()
    nodes = [n for n in done.json["nodes"] if "EXT_mesh_gpu_instancing" in n.get("extensions", {})]
    assert len(nodes) == 1  # the ball has only one instance
    assert "EXT_mesh_gpu_instancing" in done.json["extensionsRequired"]


def test_nested_instancers(tmp_path: Path) -> None:
    text = text_of("convert_instances/nested_instancers.usda")
    done = convert_text(tmp_path, text)
    world = done.world()
    places = {
        tuple(np.round(world[i][:3, 3], 6))
        for i, node in enumerate(done.gltf.nodes)
        if node.mesh is not None
    }
    assert places == {(x, y, 0.0) for x in (0.0, 10.0) for y in (1.0, 2.0, 3.0)}
    assert len(done.gltf.meshes) == 1
    assert all(row["warned"] == 0 for row in done.result.ledger.values())


def test_nested_instancers_come_and_go(tmp_path: Path) -> None:
    """An outer instancer that is hidden at rest still draws only its own instances later."""
    text = text_of("convert_instances/nested_instancers_come_and_go.usda")
    assert convert_text(tmp_path, text).validated().passed


def test_animated_instances_keep_their_keys(tmp_path: Path) -> None:
    text = text_of("convert_instances/animated_instances_keep_their_keys.usda")
    done = convert_text(tmp_path, text)
    world = done.world(0.5)
    heights = sorted(
        world[i][1, 3] for i, node in enumerate(done.gltf.nodes) if node.mesh is not None
    )
    assert heights == pytest.approx([2, 4])


MOVING_INSTANCER = text_of("convert_instances/moving_instancer.usda")


def test_instances_that_come_and_go_keep_moving(tmp_path: Path) -> None:
    more = "int64[] invisibleIds.timeSamples = { 1: [20], 5: [20, 30], 9: [] }"
    done = convert_text(tmp_path, fill(MOVING_INSTANCER, more=more))
    assert done.warnings() == set()
    nodes = {(n.extras or {}).get("instance"): i for i, n in enumerate(done.gltf.nodes)}
    assert done.world(5 / 24)[nodes[0]][:3, 3] == pytest.approx([0, 2.5, 0])
    shown = {}
    for channel in done.json["animations"][0]["channels"]:
        pointer = channel["target"].get("extensions", {}).get("KHR_animation_pointer")
        if pointer:
            sampler = done.json["animations"][0]["samplers"][channel["sampler"]]
            keys = done.array(sampler["output"])[:, 0].tolist()
            shown[int(pointer["pointer"].split("/")[2])] = keys
            assert sampler["interpolation"] == "STEP"
    assert shown == {nodes[1]: [0, 0, 1], nodes[2]: [1, 0, 1]}


TURNED = "quath[] orientations = [(1,0,0,0), (0.6, 0.6, 0.1, 0), (1,0,0,0)]"
TURNING = """quath[] orientations.timeSamples = {
        1: [(1,0,0,0), (0.6, 0.6, 0.1, 0), (1,0,0,0)],
        11: [(1,0,0,0), (0.7, 0.6, 0.3, 0), (0.5,0,0.8,0)] }"""


@pytest.mark.parametrize(("more", "codes"), [(TURNED, (1, 6, 11)), (TURNING, (1, 11))])
def test_moving_instances_follow_quaternions_of_any_length(
    tmp_path: Path, more: str, codes: tuple[float, ...]
) -> None:
    done = convert_text(tmp_path, fill(MOVING_INSTANCER, more=more))
    assert "instance-rotation-normalized" not in done.warnings()
    stage = Usd.Stage.Open(str(tmp_path / "stage.usda"))
    instancer = UsdGeom.PointInstancer(stage.GetPrimAtPath("/I"))
    for code in codes:
        world = done.world((code - 1) / 24)
        found = [world[i] for i, n in enumerate(done.gltf.nodes) if n.mesh is not None]
        for matrix in instancer.ComputeInstanceTransformsAtTime(code, code):
            wanted = np.array(matrix).T
            assert min(np.abs(wanted - other).max() for other in found) < 2e-6


def test_too_many_turning_instances_state_the_deviation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(motion_module, "MAX_MATRIX_KEYS", 1)
    done = convert_text(tmp_path, fill(MOVING_INSTANCER, more=TURNED))
    (warning,) = done.result.warnings
    assert warning.name == "instance-rotation-normalized"
    q = np.array([0.6, 0.6, 0.1])
    assert warning.deviation == pytest.approx(abs(1 - q @ q) * 2 * 0.37 / 0.73, rel=0.1)


def test_many_sheared_instances_stay_exact(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(instancer_module, "MAX_INSTANCE_NODES", 1)
    text = POINTS.replace("(1,0,0,0)", "(0.6,0.6,0.1,0)")
    assert "EXT_mesh_gpu_instancing" not in convert_text(tmp_path, text).json.get(
        "extensionsUsed", []
    )
    monkeypatch.setattr(instancer_module, "MAX_SHEARED_NODES", 1)
    done = convert_text(tmp_path, text)
    assert "EXT_mesh_gpu_instancing" in done.json["extensionsUsed"]
    assert "instance-rotation-normalized" in done.warnings("/I")


def places(done: Converted) -> list[tuple[float, ...]]:
    """Sorted places of all meshes."""
    world = done.world()
    drawn = [i for i, node in enumerate(done.gltf.nodes) if node.mesh is not None]
    return sorted(tuple(np.round(world[i][:3, 3], 5)) for i in drawn)


def test_a_reset_stack_in_a_prototype_is_placed_from_the_instance_and_named(tmp_path: Path) -> None:
    reset = 'uniform token[] xformOpOrder = ["!resetXformStack!", "xformOp:translate"]'
    text = text_of(
        "convert_instances/a_reset_stack_in_a_prototype_is_placed_from_the_instance_and_named.usda",
        reset=reset,
    )
    done = convert_text(tmp_path, text).proven()
    assert places(done) == [(101, 0, 7), (102, 0, 7), (103, 0, 9)]
    # UsdGeom applies the ops of a prototype's own root even where they reset the stack.
    assert done.warnings() == {"reset-in-prototype"}
    assert done.warnings("/I/P/C") == {"reset-in-prototype"}


RESET = """
        double3 xformOp:translate = (0, 0, 7)
        uniform token[] xformOpOrder = ["!resetXformStack!", "xformOp:translate"]
"""


@pytest.mark.parametrize("kind", ["a native instance", "an instancer"])
def test_a_reset_stack_deeper_in_a_prototype(tmp_path: Path, kind: str) -> None:
    cube = f'def Cube "C"\n{{{RESET}}}\n'
    inner = 'def "N" (\ninstanceable = true\ninherits = </K>\n)\n{\n}\n'
    if kind == "an instancer":
        cube = 'def Cube "C"\n{\n}\n'
        inner = text_of("convert_instances/instancer_with_a_reset.usda", reset=RESET)
    text = text_of(
        "convert_instances/a_reset_stack_deeper_in_a_prototype.usda", inner=inner, cube=cube
    )
    done = convert_text(tmp_path, text).proven()
    assert places(done) == [(101, 0, 7), (102, 0, 7)]
    assert "reset-in-prototype" in done.warnings()


def test_a_reset_stack_in_a_native_instance_is_placed_in_the_world(tmp_path: Path) -> None:
    text = text_of(
        "convert_instances/a_reset_stack_in_a_native_instance_is_placed_in_the_world.usda",
        RESET=RESET,
    )
    done = convert_text(tmp_path, text).proven()
    assert places(done) == [(0, 0, 7), (0, 0, 7), (0, 10, 0), (0, 20, 0)]
    assert done.warnings() == set()


INSTANCES_OF_TWO = text_of("convert_instances/instances_of_two.usda")


def test_what_is_below_an_instancer_and_no_prototype_is_told_so(tmp_path: Path) -> None:
    done = convert_text(tmp_path, INSTANCES_OF_TWO)
    (entry,) = [w for w in done.sidecar["warnings"] if w["prim"] == "/I/Idle"]
    assert entry["name"] == "prototype-unused"
    assert "no prototype" in entry["message"]
    assert not done.warnings("/I/Used")


def test_colors_of_no_instance_are_left_out(tmp_path: Path, stages: Path) -> None:
    text = (stages / "tinted.usda").read_text().replace("[0, 1, 2, 0, 1, 2]", "[9, 9, 9, 9, 9, 9]")
    assert convert_text(tmp_path, text).validated().passed


def test_instances_show_their_own_colors(tmp_path: Path, stages: Path) -> None:
    def dye(out: Output) -> None:
        for look in out.gltf.materials:
            factor = look.pbrMetallicRoughness.baseColorFactor
            factor[:3] = factor[1], factor[2], factor[0]

    done = convert_text(tmp_path, (stages / "tinted.usda").read_text())
    shown = {}
    for node in done.json["nodes"]:
        for child in node.get("children", []) if "instance" in node.get("extras", {}) else []:
            mesh = done.json["nodes"][child].get("mesh")
            if mesh is not None:
                look = done.json["meshes"][mesh]["primitives"][0]["material"]
                pbr = done.json["materials"][look]["pbrMetallicRoughness"]
                prim = done.json["nodes"][child]["extras"]["prim"].rsplit("/")[-1]
                shown.setdefault(prim, []).append(np.round(pbr["baseColorFactor"], 4).tolist())
    assert shown == {
        "Plain": [[0.1, 0.2, 0.3, 1], [0.2, 0.9, 0.1, 0.5]],
        "Red": [[1, 0, 0, 1], [1, 0, 0, 0.25]],
        "Ball": [[1, 1, 0, 1]] * 2,
        "Dots": [[0, 1, 1, 1]] * 2,
        "Bound": [[0.1, 0.2, 0.3, 1], [0.2, 0.9, 0.1, 1]],
    }
    expect_found(done, dye)
