"""Pages of failure modes and of other systems: facts that the stored tables do not show."""

import csv
import re

import pytest
from documents import comparators, document, stability
from PIL import Image
from tables import Row


def columns(name: str) -> list[str]:
    with (document.DATA / name).open() as file:
        return next(csv.reader(file))


def cell(method: str, **scores: object) -> Row:
    empty = dict.fromkeys(columns("stability.csv"), "")
    found = empty | {"mode": "03-rails", "method": method, "against": "rt", "status": "ok"}
    return found | {name: str(value) for name, value in scores.items()}


def test_a_cell_without_scores_is_named_and_scores_that_none_has_have_no_table() -> None:
    rows = [
        cell("ssr", flip_p99=0.31, band="seen", verdict="seen (p99 0.310)"),
        cell("near-far", status="frame 0: 12 px", verdict="not scored: frame 0: 12 px"),
        cell("hybrid", flip_p99=0.32, band="seen", recall_2px_percent=50),
    ]
    told = stability.told(rows)
    assert told["rivals"] == "- ssr: 3 thin rails (0.310, 0.320)\n- near-far: none"
    assert told["p99"].endswith("\n| 3 thin rails | 🟧 0.310 | not scored | 🟧 0.320 |")
    assert told["thin"].endswith("\n| 3 thin rails |  |  | – / 50.0 / – |")
    assert "\n- near-far: not scored: frame 0: 12 px\n" in told["modes"]
    assert "3 thin rails" not in told["flicker"]


def system(scene: str, name: str, ms: float, flip: object, **more: object) -> Row:
    side = {"hybrid": "own", "rt": "own", "rt by query": "variant"}.get(name, "rival")
    row = dict.fromkeys(columns("systems.csv"), "0")
    row |= {"scene": scene, "system": name, "side": side, "ms": str(ms), "flip": str(flip)}
    row |= {"frames": "1", "scored_frames": "1", "scored_px": "500", "status": "ok", "ssim": ""}
    return row | {column: str(value) for column, value in more.items()}


def test_each_rival_has_one_line_over_all_scenes() -> None:
    wall = [system("wall", name, ms, "") for name, ms in (("ssr", 1), ("hybrid", 2), ("rt", 1))]
    rows = [
        system("hall", "ssr", 1, 0.3),
        system("hall", "rt by query", 0.1, 0),
        system("hall", "hybrid", 4, 0.02),
        system("hall", "rt", 2, 0),
        system("yard", "ssr", 1, 0.1),
        system("yard", "near-far", 5, 0.01),
        system("yard", "hybrid", 3, 0.03),
        system("yard", "rt", 4, 0, visited_nodes=5),
        system("yard", "rt, skip 1 px", 3, 0, visited_nodes=5, side="variant"),
        *wall,
    ]
    text = comparators.rivals(rows)
    assert [line for line in text.splitlines() if line.startswith("-")] == [
        "- ssr: less time than `rt` and `hybrid` in 2 of 3: 0.42 of the faster one's in the "
        "median, 0.33 at best (yard), with a mean FLIP of 0.2000 in the median of these, where "
        "that one has 0.0150.",
        "- near-far: a smaller mean FLIP than `hybrid` in 1 of 1: 0.0100 against 0.0300 at best "
        "(yard).",
    ]
    assert "differ by up to 33 %" in text
    assert comparators.rivals(wall).startswith("Nothing")


def test_systems_that_were_refused_stand_below_the_table_by_their_reason() -> None:
    why = "The hall has no door"
    rows = [system("hall", name, 0, "", status=why) for name in ("ssr", "near-far")]
    text = comparators.section("hall", [*rows, system("hall", "rt", 1, 0, front=1)])
    assert text.endswith(f" ● |\n\nNot measured: ssr; near-far. {why}.\n")
    assert "| ssr |" not in text


@pytest.mark.parametrize(
    ("scored", "words", "has_errors"),
    [
        (3, "500 reflective pixels scored,", True),
        (2, "2 of them scored with 500 reflective pixels or more, the others without", True),
        (0, "without errors, as they have fewer than 100 reflective pixels,", False),
    ],
)
def test_films_have_curves_and_say_how_many_frames_are_scored(
    scored: int, words: str, has_errors: bool
) -> None:
    film = {"frames": 3, "scored_frames": scored, "update_ms": 7, "popping": 0.5}
    row = system("a/film.toml", "near-far", 2, 0 if has_errors else "", **film)
    text = comparators.section("a/film.toml", [row])
    assert f"3 frames of 0 × 0 pixels, {words}" in text
    assert "(charts/comparators-film-ms.svg)" in text
    assert ("(charts/comparators-film-flip.svg)" in text) == has_errors
    assert f"| near-far | 2.00 | {'0.0000' if has_errors else '–'} |" in text
    assert "| 50 | – | – | 0.0 | – | – | 7.0 |" in text


def test_each_picture_of_a_failure_is_of_a_shipped_scene_that_the_page_names() -> None:
    shown = re.findall(
        r"comparators-fails-(\d)\.png\).*`(.*?)` \|$", comparators.PAGE.read_text(), re.M
    )
    assert shown == [(str(n), scene) for n, (scene, *_) in enumerate(comparators.FAILURES, 1)]
    assert all((document.ROOT / scene).is_file() for _, scene in shown)


def test_the_shown_part_holds_what_differs_most() -> None:
    plain = Image.new("RGB", (320, 180), "gray")
    wrong = plain.copy()
    wrong.putpixel((10, 10), (0, 0, 0))
    wrong.paste((255, 0, 0), (250, 100, 254, 104))
    left, top, right, bottom = comparators.worst(wrong, plain)
    assert left <= 250 < 254 <= right and top <= 100 < 104 <= bottom
