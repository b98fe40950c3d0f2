"""Owns the tests of points, curves, patches and tetrahedra."""

from pathlib import Path

import numpy as np
import pytest
from read_converted import Converted, convert_text
from texts import text_of


def lines(done: Converted) -> np.ndarray:
    """The segments (L, 2, 3) of the first mesh."""
    primitive = done.json["meshes"][0]["primitives"][0]
    assert primitive["mode"] == 1
    points = done.array(primitive["attributes"]["POSITION"]).astype(float)
    return points[done.array(primitive["indices"])[:, 0]].reshape(-1, 2, 3)


def test_points_with_colors(tmp_path: Path) -> None:
    text = text_of("convert_curves/points_with_colors.usda")
    done = convert_text(tmp_path, text)
    drawn = done.json["meshes"][0]["primitives"]
    assert [primitive["mode"] for primitive in drawn] == [0, 0]
    for name, expected in (
        ("POSITION", [[0, 0, 0], [1, 2, 3]]),
        ("COLOR_0", [[1, 0, 0], [0, 1, 0]]),
    ):
        found = [done.array(primitive["attributes"][name]) for primitive in drawn]
        assert np.concatenate(found).tolist() == expected
    assert "points-non-finite" in done.warnings("/P")


def curve(body: str, counts: str = "4") -> str:
    return text_of("convert_curves/curve.usda", counts=counts, body=body)


def test_linear_curves_keep_their_points(tmp_path: Path) -> None:
    done = convert_text(tmp_path, curve('uniform token type = "linear"', "2, 2"))
    assert lines(done).tolist() == [[[0, 0, 0], [1, 3, 0]], [[2, -3, 0], [3, 0, 0]]]
    closed = 'uniform token type = "linear"\nuniform token wrap = "periodic"'
    assert len(lines(convert_text(tmp_path, curve(closed)))) == 4


@pytest.mark.parametrize("basis", ["bezier", "bspline", "catmullRom"])
def test_cubic_curves_lie_on_the_curve(tmp_path: Path, basis: str) -> None:
    done = convert_text(tmp_path, curve(f'uniform token basis = "{basis}"'))
    points = np.array([[0, 0, 0], [1, 3, 0], [2, -3, 0], [3, 0, 0]], dtype=float)

    def exact(t: float) -> np.ndarray:
        s = 1 - t
        if basis == "bezier":
            weights = [s**3, 3 * s * s * t, 3 * s * t * t, t**3]
        elif basis == "bspline":
            weights = [
                s**3 / 6,
                (3 * t**3 - 6 * t**2 + 4) / 6,
                (-3 * t**3 + 3 * t**2 + 3 * t + 1) / 6,
                t**3 / 6,
            ]
        else:
            weights = [
                (-(t**3) + 2 * t**2 - t) / 2,
                (3 * t**3 - 5 * t**2 + 2) / 2,
                (-3 * t**3 + 4 * t**2 + t) / 2,
                (t**3 - t**2) / 2,
            ]
        return np.array(weights) @ points

    segments = lines(done)
    assert len(segments) == 8
    for step, segment in enumerate(segments):
        assert segment[0] == pytest.approx(exact(step / 8), abs=1e-6)
        assert segment[1] == pytest.approx(exact((step + 1) / 8), abs=1e-6)
    assert "curves-approximated" in done.warnings("/C")


def test_colors_per_curve(tmp_path: Path) -> None:
    text = text_of("convert_curves/colors_per_curve.usda")
    done = convert_text(tmp_path, text)
    attributes = done.json["meshes"][0]["primitives"][0]["attributes"]
    colors, positions = (done.array(attributes[n]) for n in ("COLOR_0", "POSITION"))
    assert (colors[positions[:, 1] == 0] == (1, 0, 0)).all()
    assert (colors[positions[:, 1] == 1] == (0, 0, 1)).all()


def test_a_nurbs_patch_is_a_quarter_cylinder(tmp_path: Path) -> None:
    weight = np.sqrt(0.5)
    text = text_of("convert_curves/a_nurbs_patch_is_a_quarter_cylinder.usda", weight=weight)
    done = convert_text(tmp_path, text)
    triangles = done.triangles(0)
    points = triangles.reshape(-1, 3)
    assert np.hypot(points[:, 0], points[:, 1]) == pytest.approx(np.ones(len(points)), abs=1e-6)
    assert np.ptp(points[:, 2]) == pytest.approx(2.0)
    crossed = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(crossed, axis=1).sum() / 2
    assert area == pytest.approx(np.pi, rel=0.01)
    assert "curves-approximated" in done.warnings("/N")
    broken = convert_text(tmp_path, text.replace("[0, 0, 1, 1]", "[0, 0, 1]"))
    assert "curves-invalid" in broken.warnings("/N")


def test_tetrahedra_show_their_boundary(tmp_path: Path) -> None:
    text = text_of("convert_curves/tetrahedra_show_their_boundary.usda")
    done = convert_text(tmp_path, text)
    triangles = done.triangles(0)
    signed = np.einsum("ti,ti->t", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2]))
    assert signed.sum() / 6 == pytest.approx(1 / 6)
    assert "tetrahedra-dropped" in done.warnings("/T")


def nurbs(order: str, counts: str, knots: str, points: str, more: str = "") -> str:
    return text_of(
        "convert_curves/nurbs.usda",
        counts=counts,
        order=order,
        knots=knots,
        points=points,
        more=more,
    )


def test_weights_make_a_circle_of_a_nurbs_curve(tmp_path: Path) -> None:
    half = 0.5**0.5
    corners = (
        "(1,0,0), (1,1,0), (0,1,0), (-1,1,0), (-1,0,0), (-1,-1,0), (0,-1,0), (1,-1,0), (1,0,0)"
    )
    weights = ", ".join([f"1, {half}"] * 4 + ["1"])
    text = nurbs(
        "3", "9", "0,0,0, 1,1, 2,2, 3,3, 4,4,4", corners, f"double[] pointWeights = [{weights}]"
    )
    done = convert_text(tmp_path, text).proven()
    assert done.warnings("/N") == {"curves-approximated"}
    segments = lines(done)
    assert len(segments) == 4 * 8
    assert np.linalg.norm(segments, axis=2) == pytest.approx(1.0, abs=1e-6)
    # The lines go once around, in order.
    assert segments[1:, 0] == pytest.approx(segments[:-1, 1])
    assert segments[0, 0] == pytest.approx(segments[-1, 1], abs=1e-6)


def test_nurbs_curves_have_their_own_orders_and_ranges(tmp_path: Path) -> None:
    points = "(0,0,0), (1,2,0), (2,0,0), (3,2,0), (5,0,0), (6,0,1), (7,1,0)"
    text = nurbs(
        "4, 2",
        "4, 3",
        "0,0,0,0,1,1,1,1, 0,0,1,2,2",
        points,
        "double2[] ranges = [(0.25, 0.75), (0, 2)]\n    color3f[] primvars:displayColor = "
        '[(1,0,0), (0,1,0)] (interpolation = "uniform")',
    )
    done = convert_text(tmp_path, text).proven()
    segments = lines(done)
    assert len(segments) == 8 + 16
    # A cubic between a quarter and three quarters of its parameter.
    assert segments[0, 0] == pytest.approx([0.75, 0.875, 0.0])
    assert segments[8, 0] == pytest.approx([5.0, 0.0, 0.0])
    assert segments[-1, 1] == pytest.approx([7.0, 1.0, 0.0])


def test_a_good_nurbs_curve_beside_a_bad_one_is_drawn(tmp_path: Path) -> None:
    points = "(0,0,0), (1,2,0), (2,0,0), (3,2,0), (0,0,1), (1,1,1)"
    knots = "0,0,0,0,1,1,1,1, 0,0,1,1"
    done = convert_text(tmp_path, nurbs("4, 2", "4, 2", knots, points)).proven()
    assert done.warnings("/N") == {"curves-approximated"}
    knots = "3,2,1,0,1,1,1,1, 0,0,1,1"
    done = convert_text(tmp_path, nurbs("4, 2", "4, 2", knots, points)).proven()
    assert done.warnings("/N") == {"curves-approximated", "curves-invalid"}
    assert lines(done)[-1, 1] == pytest.approx([1.0, 1.0, 1.0])


def test_long_nurbs_curves_take_work_in_proportion(tmp_path: Path) -> None:
    """A table of all basis functions at all samples would take 50 GB."""
    count = 28_000
    knots = ",".join(map(str, range(count + 4)))
    points = ",".join(f"({n},{n % 2},0)" for n in range(count))
    done = convert_text(tmp_path, nurbs("4", str(count), knots, points))
    assert len(lines(done)) == (count - 3) * 8
