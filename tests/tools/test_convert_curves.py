"""Owns the tests of points, curves, patches and tetrahedra."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from read_converted import Converted, convert_text


def lines(done: Converted) -> np.ndarray:
    """The segments (L, 2, 3) of the first mesh."""
    primitive = done.json["meshes"][0]["primitives"][0]
    assert primitive["mode"] == 1
    points = done.array(primitive["attributes"]["POSITION"]).astype(float)
    return points[done.array(primitive["indices"])[:, 0]].reshape(-1, 2, 3)


def test_points_with_colors(tmp_path: Path) -> None:
    text = """
def Points "P" {
    point3f[] points = [(0,0,0), (1,2,3), (nan,0,0)]
    float[] widths = [1, 2, 3]
    color3f[] primvars:displayColor = [(1,0,0), (0,1,0), (0,0,1)] (interpolation = "vertex")
}
"""
    done = convert_text(tmp_path, text)
    primitive = done.json["meshes"][0]["primitives"][0]
    assert primitive["mode"] == 0
    assert done.array(primitive["attributes"]["POSITION"]).tolist() == [
        [0, 0, 0],
        [1, 2, 3],
    ]
    assert done.array(primitive["attributes"]["COLOR_0"]).tolist() == [
        [1, 0, 0],
        [0, 1, 0],
    ]
    assert {"width-dropped", "points-non-finite"} <= done.warnings("/P")


def curve(body: str, counts: str = "4") -> str:
    return f"""
def BasisCurves "C" {{
    int[] curveVertexCounts = [{counts}]
    point3f[] points = [(0,0,0), (1,3,0), (2,-3,0), (3,0,0)]
    {body}
}}
"""


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
    text = """
def BasisCurves "C" {
    uniform token basis = "bezier"
    int[] curveVertexCounts = [4, 4]
    point3f[] points = [(0,0,0), (1,0,0), (2,0,0), (3,0,0), (0,1,0), (1,1,0), (2,1,0), (3,1,0)]
    color3f[] primvars:displayColor = [(1,0,0), (0,0,1)] (interpolation = "uniform")
}
"""
    done = convert_text(tmp_path, text)
    attributes = done.json["meshes"][0]["primitives"][0]["attributes"]
    colors, positions = (done.array(attributes[n]) for n in ("COLOR_0", "POSITION"))
    assert (colors[positions[:, 1] == 0] == (1, 0, 0)).all()
    assert (colors[positions[:, 1] == 1] == (0, 0, 1)).all()


@pytest.mark.parametrize("counts", ["9", "-4", ""])
def test_counts_that_do_not_fit_are_named(tmp_path: Path, counts: str) -> None:
    done = convert_text(tmp_path, curve("", counts))
    assert "curves-invalid" in done.warnings("/C")
    assert not done.json.get("meshes")


def test_a_nurbs_patch_is_a_quarter_cylinder(tmp_path: Path) -> None:
    weight = np.sqrt(0.5)
    text = f"""
def NurbsPatch "N" {{
    int uVertexCount = 3
    int vVertexCount = 2
    int uOrder = 3
    int vOrder = 2
    double[] uKnots = [0, 0, 0, 1, 1, 1]
    double[] vKnots = [0, 0, 1, 1]
    point3f[] points = [(1,0,0), (1,1,0), (0,1,0), (1,0,2), (1,1,2), (0,1,2)]
    double[] pointWeights = [1, {weight}, 1, 1, {weight}, 1]
}}
"""
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
    text = """
def TetMesh "T" {
    point3f[] points = [(0,0,0), (1,0,0), (0,1,0), (0,0,1)]
    int4[] tetVertexIndices = [(0, 1, 2, 3)]
}
"""
    done = convert_text(tmp_path, text)
    triangles = done.triangles(0)
    signed = np.einsum("ti,ti->t", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2]))
    assert signed.sum() / 6 == pytest.approx(1 / 6)
    assert "tetrahedra-dropped" in done.warnings("/T")
