"""The page of rules of acceptance: how the threshold T is chosen, and the confidence intervals."""

import pathlib

import pytest
from documents import acceptance


def score(flip: float, nodes: float) -> acceptance.Score:
    return acceptance.Score(flip * 1000, flip, flip, 1.0 - flip, nodes, 1.0)


def scene(*, verified: float, small: tuple[float, float], large: tuple[float, float]) -> dict:
    """Scores of one scene at T = .01 and T = .1; the verified rule visits 100 BVH nodes."""
    return {
        ("verified", 0.25): score(verified, 100.0),
        ("verified", 0.0): score(verified, 110.0),
        ("threshold", 0.01): score(*small),
        ("threshold", 0.1): score(*large),
    }


@pytest.mark.parametrize(
    ("small_nodes", "large_nodes", "threshold"),
    [(120.0, 90.0, 0.1), (99.0, 90.0, 0.01), (140.0, 120.0, 0.1)],
    ids=["that costs no more", "best of them", "cheapest"],
)
def test_the_best_threshold_that_costs_no_more_is_taken_else_the_cheapest(
    small_nodes: float, large_nodes: float, threshold: float
) -> None:
    of = {"a": scene(verified=0.01, small=(0.001, small_nodes), large=(0.02, large_nodes))}
    assert acceptance.best_threshold(of, ["a"], lambda s: s.flip) == ("threshold", threshold)


def test_a_scene_does_not_choose_its_own_threshold() -> None:
    likes_small = scene(verified=0.01, small=(0.001, 90.0), large=(0.5, 90.0))
    likes_large = scene(verified=0.01, small=(0.9, 90.0), large=(0.001, 90.0))
    of = {"small": likes_small, "large": likes_large}
    chosen = acceptance.left_out(of, lambda s: s.flip)
    assert chosen == {"small": ("threshold", 0.1), "large": ("threshold", 0.01)}


def test_the_interval_is_that_of_the_mean() -> None:
    low, high = acceptance.interval([1.0, 2.0, 3.0, 4.0] * 10)
    # The standard error is sqrt(1.25 / 40) = .177; the interval is ± 1.96 of these.
    assert low == pytest.approx(2.5 - 0.346, abs=0.03)
    assert high == pytest.approx(2.5 + 0.346, abs=0.03)
    assert acceptance.interval([0.5] * 5) == (0.5, 0.5)


def row(**changes: object) -> dict[str, str]:
    cells = dict.fromkeys(acceptance.COLUMNS, "1")
    cells |= {"scene": "s", "accept": "verified", "edge_px": "0.25"}
    cells |= {"reflective_px": "1000", "screen_percent": "50", "false_accepts": "2"}
    return cells | {column: str(value) for column, value in changes.items()}


def test_wrong_hits_are_those_of_all_pictures_over_all_accepted_hits() -> None:
    rows = [row(), row(reflective_px=3000, false_accepts=8, mask_flip=0.5)]
    of = acceptance.scores(rows)["s"]["verified", 0.25]
    assert of.wrong_permille == pytest.approx(1000 * 10 / 2000)
    assert of.flip == pytest.approx(0.75)
    assert of.nodes == 2.0


def test_pictures_without_enough_reflections_are_left_out() -> None:
    assert acceptance.scores([row(mask_flip="", mask_ssim="")]) == {}


def test_a_swaying_camera_moves_by_a_share_of_its_distance() -> None:
    still = {"camera": {"main": {"eye": [0.0, 0.0, 10.0], "target": [0.0, 0.0, 0.0]}}}
    words = acceptance.sway(still)
    motion = "{ oscillate = { amplitude = [1.0, 0.4, 1.0], period_s = 7 } }"
    assert f"motion.camera.main.eye={motion}" in words


def test_the_page_needs_samples(tmp_path: pathlib.Path) -> None:
    with pytest.raises(SystemExit, match="run with --measure first"):
        acceptance.store([tmp_path])
