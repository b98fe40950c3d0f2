"""tools/reflet_suites: scores of made-up pictures, and folders of suites without their files."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from reflet_suites import fidelity, imaging, scores

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
