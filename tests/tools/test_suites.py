"""tools/reflet_suites: scores of made-up pictures, and folders of suites without their files."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from program import BINARY
from reflet_suites import fidelity, imaging, materialx, mitsuba, scores
from texts import text_of

GRAY, BLACK = np.full((8, 8, 3), 0.5), np.zeros((8, 8, 3))
CLEAR = (1.0, 0.5, 0.1)


def test_the_nearest_has_rank_0_and_means_over_cells_hide_what_is_finer() -> None:
    stripes = np.where(np.arange(8)[:, None, None] % 2, BLACK, BLACK + 1)
    pictures = {"gray": GRAY, "stripes": stripes, "white": BLACK + 1, "black": BLACK}
    fine = scores.distances(pictures)
    assert list(scores.ranks(fine).values()) == pytest.approx([1 / 6, 1 / 6, 5 / 6, 5 / 6])
    coarse = scores.distances({name: scores.means(picture) for name, picture in pictures.items()})
    assert (fine["gray"], coarse["gray"]) == pytest.approx((1 / 2, 1 / 3))
    with pytest.raises(ValueError, match="gray 8 × 8, other 4 × 8"):
        scores.distances({"gray": GRAY, "other": GRAY[:, :4]})


def test_masks_are_what_differs_from_the_background_and_overlap_within_a_pixel() -> None:
    picture = np.full((4, 4, 3), CLEAR)
    picture[:, :1] = 0
    column = imaging.covered(picture, CLEAR)
    assert column.sum() == 4
    assert scores.overlap(column, np.ones((4, 4), bool)) == 0.5
    assert imaging.covered(np.pad(GRAY, ((2, 2), (2, 2), (0, 0))), CLEAR).sum() == 64


def test_what_a_scenario_lacks_is_named(tmp_path: Path) -> None:
    view = fidelity.scenario({"name": "khronos-Fox", "model": "../../../Models/Fox.glb"})
    assert (view.eye, view.toward) == (pytest.approx((0, 0, 1)), pytest.approx((0, 0, 0)))
    with pytest.raises(fidelity.LackError, match=r"lacks Models/Fox\.gltf, environments/light"):
        fidelity.draw(Path("reflet"), tmp_path, tmp_path, view, 256, "aces")
    seen = scores.on_white(Image.new("RGBA", (4, 4), (0, 0, 0, 51)), (2, 2))
    assert seen == pytest.approx(np.full((2, 2, 3), 0.8))


def test_mitsubas_z_test_has_its_numbers_by_hand() -> None:
    mean = np.zeros((1, 2, 3))
    # The correction of 1 % for 2 pixels is .5013 %, where |z| is 2.806.
    reference = np.array([[[2.7, 2.9, 0.0], [0.0027, 0.0029, -2.9]]])
    variance = np.array([[[100.0, 100.0, 100.0], [0.0, 0.0, 100.0]]])
    assert mitsuba.z_test(mean, reference, variance, 100) == 3 / 6


def test_a_film_of_mitsuba_weighs_samples_by_its_gaussian() -> None:
    fine = np.zeros((35, 35, 1))
    fine[17, 17] = 1  # the middle of the middle pixel
    coarse = mitsuba.gaussian(fine)[:, :, 0]
    assert coarse[3, 4] / coarse[3, 3] == pytest.approx(
        (np.exp(-2) - np.exp(-8)) / (1 - np.exp(-8))
    )
    assert mitsuba.gaussian(np.ones((10, 15, 3))) == pytest.approx(np.ones((2, 3, 3)))


def test_a_scene_of_mitsuba_is_translated_or_its_plugin_named(tmp_path: Path) -> None:
    pytest.importorskip("mitsuba", reason="the independent renderer is not installed")
    scene = text_of("suites/mitsuba.xml")
    path = tmp_path / "test_path.xml"
    path.write_text(scene.replace("SURFACE", "diffuse"), encoding="utf-8")
    found = mitsuba.Translation(path, tmp_path)
    assert (found.others, found.size, found.filter) == ([], (8, 4), "box")
    assert found.scene["material"]["m0"]["base_color"] == pytest.approx([0.1, 0.2, 0.3])
    assert found.scene["camera"]["main"]["orthographic_height_m"] == 1
    assert found.scene["instance"][0]["matrix"][0] == 2  # the radius
    assert found.scene["light"]["l0"]["color"] == [1, 2, 3]
    assert found.scene["reflection"]["diffuse_bounces"] == 1
    (tmp_path / "scene.toml").write_text(found.text(), encoding="utf-8")
    subprocess.run([BINARY, "check", tmp_path / "scene.toml"], check=True)
    metal = scene.replace(
        'rgb name="reflectance" value=".1 .2 .3"', 'string name="material" value="Cr"'
    )
    path.write_text(metal.replace("SURFACE", "conductor"), encoding="utf-8")
    tint = mitsuba.Translation(path, tmp_path).scene["material"]["m0"]["specular_color"]
    assert tint == pytest.approx([0.697, 0.757, 0.85], abs=1e-3)
    turned = scene.replace("/></film>", "/></film><boolean name='flip' value='true'/>")
    path.write_text(turned.replace("SURFACE", "plastic"), encoding="utf-8")
    named = ["`orthographic` with `flip`", "`plastic`"]
    assert mitsuba.Translation(path, tmp_path).others == named


def test_losses_of_materialx_documents_are_named(tmp_path: Path) -> None:
    pytest.importorskip("MaterialX", reason="the reader of documents is not installed")
    document = tmp_path / "paint.mtlx"
    surface = '<{kind} name="s" type="surfaceshader"/>\n'
    material = '<surfacematerial name="m" type="material"><input name="surfaceshader" '
    material += 'type="surfaceshader" nodename="s"/></surfacematerial>'
    for kind, losses in {
        "gltf_pbr": "",
        "disney_principled": "material-unsupported (ND_disney_principled); shader-unused",
    }.items():
        text = surface.format(kind=kind) + material
        document.write_text(f'<materialx version="1.39">\n{text}\n</materialx>', encoding="utf-8")
        out = tmp_path / kind
        out.mkdir()
        row = materialx.convert(document, tmp_path, out)
        assert row == {"materials": "1", "refused": "", "losses": losses}
    document.write_text("<materialx", encoding="utf-8")
    assert materialx.convert(document, tmp_path, out)["refused"] == "materialx-unreadable"
