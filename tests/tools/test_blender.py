"""Owns the round trip of the Blender add-on: known light, second exports, the render engine."""

from __future__ import annotations

import json
import subprocess

import blender
import numpy as np
import pytest
import tomllib
from program import BINARY
from reflet_usd.exr_pixels import read_exr

pytestmark = blender.needed


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """The folder of one session of Blender."""
    return blender.run("blender_session.py", tmp_path_factory.mktemp("blender"))


def said(out):
    """Losses and refusals by the names of the scenes."""
    return json.loads((out / "said.json").read_text(encoding="utf-8"))


def run(*words):
    """Run the program."""
    done = subprocess.run([BINARY, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def middle(path):
    """Linear RGB of the middle of a picture."""
    pixels = read_exr(path.read_bytes())[..., :3]
    height, width = pixels.shape[:2]
    return pixels[height // 2, width // 2]


@pytest.mark.parametrize("name", ["sun", "point"])
def test_light_has_its_closed_form(out, name):
    assert said(out)[name] == []
    run("render", out / name / "scene.toml", "-o", out / f"{name}.exr", "--samples", "1")
    np.testing.assert_allclose(middle(out / f"{name}.exr"), 0.8, rtol=2e-3)


def test_the_engine_shows_what_the_program_renders(out):
    np.testing.assert_allclose(middle(out / "engine.exr"), 0.8, rtol=2e-3)


def test_the_engine_gives_tiles_of_a_region_with_their_passes(out):
    import OpenEXR

    file = OpenEXR.File(str(out / "passes.exr"))
    planes = {
        name.removeprefix("ViewLayer."): channel.pixels
        for part in file.parts
        for name, channel in part.channels.items()
    }
    # 0.25 to 0.875 and, from below, 0.125 to 1 of 32 x 18 pixels; tiles of 10 fit neither side.
    inside = np.zeros((18, 32), dtype=bool)
    inside[:16, 8:28] = True
    np.testing.assert_array_equal(planes["Combined"][..., 3], inside)
    np.testing.assert_array_equal(planes["Depth.Z"] < 10, inside)
    normals = np.stack([planes[f"Normal.{axis}"] for axis in "XYZ"], axis=-1)
    # A slope of 30 degrees that glows, and the floor 6 m below the camera.
    for row, column, depth, normal, color, emission in [
        (6, 15, 5.855, (0.5, 0, 0.866), 0, (0.5, 1, 1.5)),
        (8, 24, 6, (0, 0, 1), 0.8, (0, 0, 0)),
    ]:
        assert planes["Depth.Z"][row, column] == pytest.approx(depth, abs=0.02)
        np.testing.assert_allclose(normals[row, column], normal, atol=2e-3)
        np.testing.assert_allclose(planes["Diffuse Color"][row, column], color, atol=2e-3)
        np.testing.assert_allclose(planes["Emission"][row, column], emission, atol=2e-3)


def test_odd_names_and_scales_are_carried(out):
    scene = out / "odd" / "scene.toml"
    assert ": ok" in run("check", scene)
    text = tomllib.loads((out / "odd" / "blender.toml").read_text(encoding="utf-8"))
    assert {'a "b" \\ c', "floor", "twin"} == {thing["name"] for thing in text["instance"]}
    info = json.loads(run("info", "--json", scene))
    # The copy shares the mesh.
    assert (info["instances"], info["meshes"]) == (3, 2)


def test_mean_free_paths_below_a_surface_are_those_of_cycles(out):
    scene = out / "wax" / "scene.toml"
    assert said(out)["wax"] == [] and ": ok" in run("check", scene)
    text = tomllib.loads((out / "wax" / "blender.toml").read_text(encoding="utf-8"))
    # Radius over 4 pi, times 1 - anisotropy; of skin, what `bssrdf_setup_radius` computes.
    for model, name, paths_m, color in [
        ("wax ball", "wax", (0.11937, 0.06366, 0.02387), (0.883, 0.664, 0.358)),
        ("jade ball", "jade", (0.03979, 0.07958, 0.03979), (0.265, 0.664, 0.358)),
        ("skin box", "skin", (0.02864, 0.03873, 0.02913), (0.788, 0.480, 0.382)),
    ]:
        look = text["model"][model]["material"][name]
        found_m = -look["attenuation_distance_m"] / np.log(look["attenuation_color"])
        np.testing.assert_allclose(found_m, paths_m, rtol=1e-3)
        # A random walk on the processor from directions refracted at an index of 1.5 returns this.
        np.testing.assert_allclose(look["scattering_color"], color, rtol=0.02)


def test_a_second_export_writes_nothing_new_and_leaves_layers(out):
    assert said(out)["again"] == []


def test_a_scene_without_a_camera_is_refused(out):
    assert said(out)["blind"].startswith("the scene 'Scene' has no camera")
    assert not (out / "blind" / "scene.toml").exists()
