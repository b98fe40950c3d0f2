"""Owns exports of changed scenes and of bad input: files that change, losses, refusals."""

from __future__ import annotations

import json
import subprocess

import blender
import pytest
import tomllib
from program import BINARY

pytestmark = blender.needed

# Codes of losses by the input of blender_exports.py.
LOSSES = {
    **dict.fromkeys(["place not a number", "place too far", "light not a number"], "place-invalid"),
    "scale zero": "scale-zero",
    "power negative": "light-off",
    "lost image": "image-missing",
    "procedural": "procedural-dropped",
    "lost library": "library-missing",
    "hair": "hair-dropped",
    "holdout": "layer-dropped",
    "mirroring": "mirror-motion-frozen",
}
WHOLE = ["scale negative", "odd names", "editing", "sheared", "growing", "wide open"]
REFUSED = {
    "camera not a number": "at a finite place",
    "motion too far": "[motion.instance.Cube] cannot be written: ",
    "no view": "the view of the camera 'Camera' ends where it begins",
    "panorama": "perspective or orthographic",
    "no camera": "has no camera",
    "broken ledger": "export.json is not what an export writes",
    "own file": "was not written by an export",
    "no folder": "is a file; name a folder",
}


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """The folder of one session of Blender."""
    return blender.run("blender_exports.py", tmp_path_factory.mktemp("exports"))


@pytest.fixture
def said(out):
    """Findings of the session."""
    return json.loads((out / "said.json").read_text(encoding="utf-8"))


def text(out, name):
    """The exported scene."""
    return tomllib.loads((out / name / "blender.toml").read_text(encoding="utf-8"))


def test_a_second_export_writes_only_what_changed(said):
    def files(step):
        return said["changes"][step]["written"], said["changes"][step]["removed"]

    assert {"models/Cube.glb", "models/ball.glb", "scene.toml"} <= set(files("first")[0])
    assert files("again") == ([], [])
    assert files("moved") == (["blender.toml"], [])
    assert files("reshaped") == (["models/ball.glb"], [])
    assert files("deleted") == (["blender.toml", "report.json", "report.txt"], ["models/Cube.glb"])
    assert said["changes"]["layer is kept"]


def test_an_export_goes_on_where_one_was_refused(said):
    assert "blender.toml was not written by an export" in said["stopped"]["refused"]
    assert said["stopped"]["mine"] == "mine"
    assert {"blender.toml", "models/Cube.glb"} <= set(said["stopped"]["written"])


def test_every_bad_input_has_its_expectation(said):
    assert set(said["bad"]) == {*LOSSES, *WHOLE, *REFUSED}


@pytest.mark.parametrize("name", LOSSES)
def test_what_cannot_be_carried_is_named(said, name):
    assert said["bad"][name] == [LOSSES[name]]


@pytest.mark.parametrize("name", WHOLE)
def test_what_can_be_carried_is_no_loss(said, name):
    assert said["bad"][name] == []


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_exported_is_refused(said, name):
    assert REFUSED[name] in said["bad"][name]


def test_files_of_the_user_stay(said, out):
    assert (out / "own file" / "models" / "Cube.glb").read_text(encoding="utf-8") == "mine"
    assert (out / "no folder").read_text(encoding="utf-8") == "mine"
    assert not (out / "no camera").exists()


def test_names_stay_in_the_folder_and_in_the_text(said, out):
    exported = text(out, "odd names")
    assert exported["instance"][0]["name"] == '../x\n"y"\x7f'
    (model,) = exported["model"].values()
    place = (out / "odd names" / model["file"]).resolve()
    assert place.is_file() and place.parent == (out / "odd names" / "models").resolve()


def test_text_curve_surface_metaball_and_mesh_are_one_instance_each(said, out):
    names = [thing["name"] for thing in text(out, "kinds")["instance"]]
    assert sorted(names) == ["Ball", "Curve", "Empty", "Mesh", "Surface", "Text"]
    held = tomllib.loads((out / "kinds" / "collection-held.toml").read_text(encoding="utf-8"))
    assert [thing["name"] for thing in held["instance"]] == ["Placed"]


def test_a_sheared_thing_has_its_matrix(said, out):
    (placed,) = text(out, "sheared")["instance"]
    # Blender's x and y are x and -z here: a turn by 0.5 about the axis up, then stretched 3 times.
    assert placed["matrix"][0] == pytest.approx(0.87758, abs=1e-4)
    assert placed["matrix"][2] == pytest.approx(-3 * 0.47943, abs=1e-4)
    assert placed["matrix"][10] == pytest.approx(3 * 0.87758, abs=1e-4)


def test_a_thing_that_grows_from_nothing_is_hidden_until_then(said, out):
    shown = text(out, "growing")["motion"]["instance"]["Cube"]["shown"]["keys"]
    assert [key["value"] for key in shown] == [False, True, False, True]
    for name in ("growing", "mirroring"):
        assert ": ok" in checked(out / name / "scene.toml")


def seen_by_the_program(scene):
    """Counts by `info` of a scene that the program reads, and all that it says."""
    done = subprocess.run(
        [BINARY, "info", "--json", scene], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    return {key: found[key] for key in ("instances", "lights", "meshes", "triangles_placed")}, found


def test_collections_are_placed_scenes_which_show_the_same(said, out):
    assert said["collections"]["losses"] == []
    whole, inner = text(out, "placed"), "collection-the-inner-f36e4118.toml"
    placed = [thing["model"] for thing in whole["instance"] if isinstance(thing["model"], dict)]
    assert placed == [{"scene": "collection-outer.toml"}] * 3
    outer = tomllib.loads((out / "placed" / "collection-outer.toml").read_text(encoding="utf-8"))
    assert [thing["model"] for thing in outer["instance"]] == [{"scene": inner}] * 2 + ["Cube.001"]
    (counts, scene), (one_by_one, flat) = (
        seen_by_the_program(out / name / "scene.toml") for name in ("placed", "flat")
    )
    # A box of its own; three balls, six boxes, six lamps.
    assert counts == one_by_one and (counts["instances"], sum(counts["lights"])) == (10, 6)
    for low_or_high in (0, 1):
        there, expected = scene["bounds_m"][low_or_high], flat["bounds_m"][low_or_high]
        assert there == pytest.approx(expected, abs=1e-5)


def test_names_in_placed_scenes_are_no_names_around_them(said, out):
    names = [thing["name"] for thing in text(out, "placed")["instance"]]
    assert names == ["Empty (2)", "Empty.001", "Empty.002", "Empty.Cube.001"]


def test_a_layer_changes_a_thing_of_a_placed_scene(said, out):
    layer = out / "placed" / "mine.toml"
    change = '[[instance]]\nname = "Empty.001.nest.001.box"\ntranslation = [0, 0, 70]\n'
    layer.write_text(f'version = 1\nbase = "scene.toml"\n{change}', encoding="utf-8")
    _, found = seen_by_the_program(layer)
    assert found["instances"] == 10 and found["bounds_m"][1][2] > 60


def test_placed_scenes_move_and_go(said, out):
    assert said["collections"]["keyed"] == []
    motion = text(out, "keyed")["motion"]["group"]
    assert [motion["Empty (2)"]["translation"]["keys"][i]["value"] for i in (0, -1)] == [
        [0, 0, 0],
        [-1, 0, 0],
    ]
    assert [key["value"] for key in motion["Empty.001"]["shown"]["keys"]] == [True, False]
    inner = out / "keyed" / "collection-the-inner-f36e4118.toml"
    lamp = tomllib.loads(inner.read_text(encoding="utf-8"))["motion"]["light"]["point"]
    assert lamp["position"]["keys"][-1]["value"] == [0, 2, -0.5]
    assert [key["value"] > 0 for key in lamp["intensity_cd"]["keys"]] == [True, True, False, False]
    outer = (out / "keyed" / "collection-outer.toml").read_text(encoding="utf-8")
    assert 'name = "nest"' in outer and "visible" not in outer
    assert ": ok" in checked(out / "keyed" / "scene.toml")


def checked(scene):
    """Words of `check` about a sound scene."""
    done = subprocess.run([BINARY, "check", scene], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_mesh_that_deforms_does_so_in_each_placed_scene(said, out):
    assert said["collections"]["waving"] == []
    held = tomllib.loads((out / "waving" / "collection-waving.toml").read_text(encoding="utf-8"))
    assert held["model"]["flag"]["animation"] == {"name": "*", "repeat": "once"}
    # The origin of the collection is at 1, 0, 0, as the mesh is.
    assert held["instance"] == [{"name": "flag", "model": "flag", "translation": [-1, 0, 0]}]


def test_linked_and_overridden_collections_are_placed(said, out):
    assert said["collections"]["linked"] == []
    placed = {thing["name"]: thing["model"]["scene"] for thing in text(out, "linked")["instance"]}
    heights = {}
    for name, file in placed.items():
        held = tomllib.loads((out / "linked" / file).read_text(encoding="utf-8"))
        ball = next(thing for thing in held["instance"] if thing["model"] == "Cube.001")
        heights[name] = ball["translation"][1]
    assert heights == {"linked": 0.25, "overridden": 1.25}
    assert seen_by_the_program(out / "linked" / "scene.toml")[0]["instances"] == 6


def test_an_export_of_collections_writes_only_what_changed(said):
    steps = {
        name: (step["written"], step["removed"])
        for name, step in said["collections"]["steps"].items()
    }
    inner = "collection-the-inner-f36e4118.toml"
    assert inner in steps["first"][0] and steps["again"] == ([], [])
    assert steps["empty moved"] == (["blender.toml"], [])
    assert steps["box moved"] == ([inner], [])
    written, removed = steps["nests deleted"]
    assert "collection-outer.toml" in written and removed == [inner, "models/box.glb"]


def test_what_no_placed_scene_can_hold_is_named(said):
    flat = said["collections"]["flat"]
    scaled = "it is scaled, and an area light in it with it"
    assert flat["area"] == ["1", f"Empty.001: {scaled}", f"Empty.002: {scaled}"]
    assert flat["instancer"][0] == "0" and "Cube.001 places instances" in flat["instancer"][1]
    assert flat["multiplied"] == ["2", "Empty: Empty.Cube.001 places Empty"]
    assert flat["too_many"] == ["3", 'the "inner": it is placed too often for a scene, 998 times']
