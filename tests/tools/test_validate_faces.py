"""The measures of faces, which must not depend on how a face is cut into triangles."""

import numpy as np
import pytest
from reflet_usd.validate.distances import one_way, set_distance
from reflet_usd.validate.faces import measure

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
DART = np.array([[0, 0, 0], [2, 1, 0], [0, 2, 0], [0.5, 1, 0]], dtype=float)
BOW_TIE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 1, 0]], dtype=float)
BENT = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 1], [0, 1, 0]], dtype=float)


@pytest.mark.parametrize(
    ("corners", "low", "high"),
    [
        (SQUARE, 1.0, 1.0),
        (DART, 1.5, 1.5),
        (BOW_TIE, 1.5, 1.5),
        (BENT, 0.5 + np.sqrt(3) / 2, np.sqrt(2)),
    ],
    ids=["square", "dart", "bow tie", "bent"],
)
def test_area_of_quads(corners: np.ndarray, low: float, high: float) -> None:
    found = measure(corners, np.array([4]), np.zeros(3)).area_range
    assert found[0] <= found[1]
    assert found[0] == pytest.approx(low, rel=1e-6)
    assert found[1] == pytest.approx(high, rel=1e-6)


CROSSED = np.array([[0, 0, 0], [4, 4, 0], [3, 1, 0], [1, 4, 0], [0, 4, 0]], dtype=float)
NOTCHED = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [2, 1, 0], [0, 4, 0]], dtype=float)


def test_area_of_larger_faces() -> None:
    five = np.array([5, 5])
    low, high = measure(np.vstack([NOTCHED, NOTCHED]), five, np.zeros(3)).area_range
    assert low == high == pytest.approx(20.0)
    low, high = measure(CROSSED, five[:1], np.zeros(3)).area_range
    assert low == pytest.approx(3.5)
    assert high > 11.5


def test_what_bends_into_a_dart_may_be_cut_either_way() -> None:
    assert measure(SQUARE, np.array([4]), np.zeros(3), deformed=True).area_range == (1.0, 1.0)
    low, high = measure(DART, np.array([4]), np.zeros(3), deformed=True).area_range
    assert low == pytest.approx(1.5)
    assert high == pytest.approx(2.5)


def test_winding_turns_area_vector_and_volume() -> None:
    there = measure(SQUARE, np.array([4]), np.array([0.5, 0.5, -3.0]))
    back = measure(SQUARE[::-1], np.array([4]), np.array([0.5, 0.5, -3.0]))
    assert np.allclose(there.vector_area, [0, 0, 1])
    assert np.allclose(back.vector_area, [0, 0, -1])
    assert there.volume_range[0] == pytest.approx(1.0)
    assert back.volume_range[0] == pytest.approx(-1.0)


def test_set_distance_looks_both_ways() -> None:
    more = np.vstack([SQUARE, [[5.0, 0, 0]], SQUARE])
    assert one_way(SQUARE, more) == 0
    assert one_way(more, SQUARE) == 4
    assert set_distance(SQUARE, more) == 4
    colors = np.array([[1.0, 0, 0, 1]])
    assert set_distance(colors, np.array([[1.0, 0, 0, 0.5]])) == 0.5
