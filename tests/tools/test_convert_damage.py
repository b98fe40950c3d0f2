"""Owns the tests of invalid values and of files that are no stages: each fault has a name."""

import os
from pathlib import Path

import numpy as np
import pytest
from read_converted import Converted, convert_text, refused
from reflet_usd.convert.types import ConvertError
from reflet_usd.validate.scene_data import StageError
from reflet_usd.validate.validation import validate_file
from texts import text_of

CUBE = 'def Cube "C" {{\n{0}\n}}\n'


@pytest.mark.parametrize("kind", ["Sphere", "Cube", "Cone", "Plane"])
def test_left_handed_gprims_turn_inside_out(tmp_path: Path, kind: str) -> None:
    areas = []
    for side in ("right", "left"):
        text = f'def {kind} "G" {{\nuniform token orientation = "{side}Handed"\n}}\n'
        done = convert_text(tmp_path, text)
        assert done.warnings() == set()
        t = done.triangles(0)
        across = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
        normals = done.attribute(0, 0, "NORMAL").reshape(-1, 3, 3)
        assert (np.einsum("ij,ikj->ik", across, normals) > 0).all()
        areas.append(float((across * (t.mean(axis=1) + np.array([0, 0, 9]))).sum()))
    assert areas[0] == pytest.approx(-areas[1])
    assert abs(areas[0]) > 1


def test_a_fourth_column_is_divided_or_named(tmp_path: Path) -> None:
    for column, names in (("0", set()), (".5", {"transform-projective"})):
        rows = f"(1,0,0,{column}), (0,1,0,0), (0,0,1,0), (2,0,0,2)"
        order = 'uniform token[] xformOpOrder = ["xformOp:transform"]'
        op = f"matrix4d xformOp:transform = ({rows})\n{order}"
        done = convert_text(tmp_path, CUBE.format(op))
        assert done.warnings("/C") == names
        assert done.world()[done.node("/C")][0, 3] == pytest.approx(1.0)


MATERIAL = text_of("convert_damage/material.usda")  # with a place for an input


def test_user_properties_travel_and_velocities_are_named(tmp_path: Path) -> None:
    text = text_of("convert_damage/user_properties_travel_and_velocities_are_named.usda")
    done = convert_text(tmp_path, text.replace("VERY", ", 0" * 64))
    assert done.warnings("/M") == {"velocities-dropped", "attribute-dropped"}
    (message,) = [w.message for w in done.result.warnings if w.name == "attribute-dropped"]
    assert message == (
        "'maker:many', 'maker:nan' are not carried;"
        " 'maker:moving' is carried with the first value only"
    )
    extras = done.gltf.nodes[done.node("/M")].extras
    assert extras["userProperties"] == {"mass": 2.5, "maker:name": "us", "sheet": "a.txt"}
    assert extras["attributes"] == {
        "maker:size": 3.0,
        "maker:turn": [2.0, 3.0, 4.0, 1.0],
        "maker:when": 7.0,
        "maker:friend": ["/M"],
        "maker:moving": 1.0,
    }


def test_an_absurd_unit_is_named(tmp_path: Path) -> None:
    done = convert_text(
        tmp_path, '#usda 1.0\n(metersPerUnit = 1e30; upAxis = "Y")\n' + CUBE.format("")
    )
    assert done.warnings("/") == {"units-invalid"}
    assert done.triangles(0).max() == pytest.approx(0.01)


def test_composition_messages_are_the_same_each_time(tmp_path: Path) -> None:
    (tmp_path / "broken.usda").write_text("#usda 1.0\nthis is not usd\n", encoding="utf-8")
    cycle = 'def Xform "R" (references = </R>) {\n}\n'
    broken = 'def Xform "B" (references = @broken.usda@) {\n}\n'
    done = convert_text(tmp_path, cycle + broken)
    texts = [w["message"] for w in done.sidecar["warnings"] if "empty" not in w["name"]]
    assert len(texts) >= 2
    assert not any("0x" in text for text in texts)
    names = [w["name"] for w in done.sidecar["warnings"] if "broken.usda" in w["message"]]
    assert len(set(names)) == 1


@pytest.mark.parametrize("asset", ["/etc/passwd", "file:///etc/passwd", "/dev/zero"])
def test_absolute_paths_outside_are_named(tmp_path: Path, asset: str) -> None:
    done = convert_text(tmp_path, f'def Cube "C" (references = @{asset}@) {{\n}}\n')
    assert done.warnings() == {"asset-outside-roots"}


def test_a_pipe_is_not_opened(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.usda")
    os.mkfifo(tmp_path / "t.png")
    reference = 'def Cube "P" (references = @pipe.usda@) {\n}\n'
    read = "color3f inputs:diffuseColor.connect = </M/t.outputs:rgb>"
    done = convert_text(tmp_path, MATERIAL.replace("$surface", read) + reference)
    found = [w["message"] for w in done.sidecar["warnings"] if w["name"] == "asset-not-a-file"]
    assert len(found) == 2


def test_a_pipe_among_tiles_is_not_opened(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "t.1001.png")
    read = "color3f inputs:diffuseColor.connect = </M/t.outputs:rgb>"
    text = MATERIAL.replace("$surface", read).replace("@t.png@", "@t.<UDIM>.png@")
    done = convert_text(tmp_path, text)
    assert "asset-not-a-file" in done.warnings("/M/t")


def test_a_root_that_is_not_there_is_an_error(tmp_path: Path) -> None:
    with refused("root-missing"):
        convert_text(tmp_path, CUBE.format(""), extra_roots=(tmp_path / "nowhere",))


def test_a_damaged_time_code_is_named_with_its_prim(tmp_path: Path) -> None:
    text = text_of("convert_damage/a_damaged_time_code_is_named_with_its_prim.usda")
    done = convert_text(tmp_path, text)
    assert done.warnings("/X") == {"time-sample-dropped"}
    assert done.world()[done.node("/X")][0, 3] == pytest.approx(1.0)


@pytest.mark.parametrize("counts", ["5", "-5, 3", "2147483647, 3, -5", "0"])
def test_a_mesh_without_a_whole_face_keeps_its_children(tmp_path: Path, counts: str) -> None:
    text = text_of(
        "convert_damage/a_mesh_without_a_whole_face_keeps_its_children.usda", counts=counts
    )
    done = convert_text(tmp_path, text)
    assert done.warnings("/Parent") == {"mesh-empty", "topology-invalid"}
    assert done.gltf.nodes[done.node("/Parent/child")].mesh is not None


def test_a_value_of_the_wrong_type_costs_its_prim_alone(tmp_path: Path) -> None:
    text = 'def Mesh "M" {\n    string[] points = ["x"]\n    def Cube "child" {}\n}\n'
    done = convert_text(tmp_path, text)
    (found,) = [w for w in done.sidecar["warnings"] if w["prim"] == "/M"]
    assert found["name"] == "prim-damaged"
    assert "'points' holds a StringArray, expected a Vec3fArray" in found["message"]
    assert done.gltf.nodes[done.node("/M/child")].mesh is not None


def test_a_fault_of_the_converter_is_no_damage(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fault(*_: object) -> None:
        raise ValueError("zero-size array")

    monkeypatch.setattr("reflet_usd.convert.geometry.GeometryBuilder.build", fault)
    with pytest.raises(ValueError, match="zero-size"):
        convert_text(tmp_path, CUBE.format(""))


def test_prototypes_of_an_instancer_that_draws_nothing_are_named_so(tmp_path: Path) -> None:
    text = text_of("convert_damage/prototypes_of_an_instancer_that_draws_nothing_are_named_so.usda")
    done = convert_text(tmp_path, text)
    assert done.warnings("/P") == {"instancer-invalid"}
    assert done.warnings("/P/c") == {"prototype-unused"}


def nested_instances(levels: int) -> str:
    """A stage of nested instances: each level holds two instances of the level below."""
    text = 'def "L0" {\n    def Cube "c" {}\n}\n'
    for level in range(1, levels):
        one = f"(references = </L{level - 1}>\n instanceable = true) {{}}\n"
        text += f'def "L{level}" {{\ndef "a" {one}def "b" {one}}}\n'
    return text


def test_instances_are_counted_without_walking_them(tmp_path: Path) -> None:
    with refused("too-many-prims"):
        convert_text(tmp_path, nested_instances(100))


def test_the_count_of_prims_is_that_of_a_walk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = convert_text(tmp_path, nested_instances(6))
    prims = sum(sum(counts.values()) for counts in done.result.ledger.values())
    monkeypatch.setattr("reflet_usd.convert.prim_count.MAX_PRIMS", prims - 1)
    with pytest.raises(ConvertError, match=f"has {prims} prims"):
        convert_text(tmp_path, nested_instances(6))


def test_a_message_that_cuts_a_character_blames_no_encoding(tmp_path: Path) -> None:
    done = convert_text(tmp_path, 'def Cube "C" {\n}\n')
    with refused("stage-unreadable", "Ill-formed path expression </Wörld/E*>"):
        convert_text(tmp_path, text_of("convert_damage/pattern.usda"), name="pattern.usda")
    with pytest.raises(StageError, match="Ill-formed path expression </Wörld/E"):
        validate_file(done.out, tmp_path / "pattern.usda", khronos=False)
    (tmp_path / "latin.usda").write_bytes(b'#usda 1.0\ndef "W\xf6" {\n}\n')
    with pytest.raises(ConvertError, match="not UTF-8"):
        Converted(tmp_path / "latin.usda", tmp_path / "latin.glb")
