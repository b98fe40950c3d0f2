"""Owns exports of changed scenes and of bad input: files that change, losses, refusals."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest
import tomllib

ROOT = Path(__file__).resolve().parents[2]
BPY = Path(os.environ.get("REFLET_BPY", ROOT / ".venv-bpy" / "bin" / "python"))

pytestmark = pytest.mark.skipif(
    not BPY.exists(), reason="no Python with bpy; tools/setup.sh --blender installs it"
)

# Codes of losses by the input of blender_exports.py.
LOSSES = {
    **dict.fromkeys(["place not a number", "place too far", "light not a number"], "place-invalid"),
    "scale zero": "scale-zero",
    "power negative": "light-off",
    "lost image": "image-missing",
    "procedural": "procedural-dropped",
    "lost library": "library-missing",
}
WHOLE = ["scale negative", "odd names", "editing", "sheared"]
REFUSED = {
    "camera not a number": "at a finite place",
    "motion too far": "[motion.instance.Cube] cannot be written: ",
    "panorama": "perspective or orthographic",
    "no camera": "has no camera",
    "broken ledger": "export.json is not what an export writes",
    "own file": "was not written by an export",
    "no folder": "is a file; name a folder",
}


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """The folder of one session of Blender."""
    folder = tmp_path_factory.mktemp("exports")
    done = subprocess.run(
        [BPY, ROOT / "tests" / "tools" / "blender_exports.py", folder],
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr + done.stdout
    return folder


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


def test_a_sheared_thing_has_its_matrix(said, out):
    (placed,) = text(out, "sheared")["instance"]
    # Blender's x and y are x and -z here: a turn by 0.5 about the axis up, then stretched 3 times.
    assert placed["matrix"][0] == pytest.approx(0.87758, abs=1e-4)
    assert placed["matrix"][2] == pytest.approx(-3 * 0.47943, abs=1e-4)
    assert placed["matrix"][10] == pytest.approx(3 * 0.87758, abs=1e-4)
