"""tools/specks.py: its rule for specks, and its table."""

import pathlib

import numpy as np
from specks import Found, found_table, scenes_of, specks

SIZE = (12, 16, 3)


def test_specks_count_inside_of_surfaces_and_not_at_edges() -> None:
    reference = np.full(SIZE, 120, dtype=np.uint8)
    reference[:, 10:] = 250
    picture = reference.copy()
    picture[3, 3] = 0
    picture[8, 4] = (120, 255, 120)
    picture[6, 10] = 0
    picture[5, 6] = 60
    assert specks(picture, reference) == Found(white=1, black=1)
    assert specks(reference, reference) == Found(white=0, black=0)


def test_the_table_lists_the_worst_first_and_counts_the_clean() -> None:
    counts = {
        "clean": [Found(0, 0), Found(0, 0)],
        "few": [Found(1, 0), Found(0, 0)],
        "many": [Found(2, 5), Found(0, 1)],
    }
    text = found_table(counts, [1, 8])
    assert text.startswith("1 of 3 scenes have none.")
    assert text.index("| many | 2 | 5 | 0 | 1 |") < text.index("| few | 1 | 0 | 0 | 0 |")


def test_folders_give_their_scenes_and_models(tmp_path: pathlib.Path) -> None:
    for name in ("b.toml", "c.txt", "model/a.glb", "model/a.bin"):
        file = tmp_path / name
        file.parent.mkdir(exist_ok=True)
        file.touch()
    assert scenes_of([tmp_path]) == [tmp_path / "b.toml", tmp_path / "model" / "a.glb"]
    assert scenes_of([tmp_path / "b.toml"]) == [tmp_path / "b.toml"]
