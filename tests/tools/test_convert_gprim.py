"""Owns the tests of gprims: closed, outward, on the exact bounds, along their axis."""

from pathlib import Path

import numpy as np
import pytest
from read_converted import Converted, convert_text

VOLUMES = {
    "Cube": ("double size = 3", 27.0),
    "Sphere": ("double radius = 1.5", 4 / 3 * np.pi * 1.5**3),
    "Cylinder": ("double radius = 0.5\ndouble height = 3", np.pi * 0.25 * 3),
    "Cone": ("double radius = 0.5\ndouble height = 3", np.pi * 0.25),
    "Capsule": (
        "double radius = 0.5\ndouble height = 3",
        np.pi * 0.25 * 3 + 4 / 3 * np.pi / 8,
    ),
    "Cylinder_1": (
        "double radiusBottom = 1\ndouble radiusTop = 0.5\ndouble height = 3",
        np.pi * (1 + 0.5 + 0.25),
    ),
}


def extent(done: Converted) -> np.ndarray:
    points = done.triangles(0).reshape(-1, 3)
    return points.max(axis=0) - points.min(axis=0)


@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
@pytest.mark.parametrize("kind", list(VOLUMES))
def test_closed_outward_and_nearly_the_exact_volume(tmp_path: Path, kind: str, axis: str) -> None:
    body, volume = VOLUMES[kind]
    done = convert_text(tmp_path, f'def {kind} "G" {{\n{body}\nuniform token axis = "{axis}"\n}}')
    triangles = done.triangles(0)
    signed = np.einsum("ti,ti->t", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2]))
    # Chords lie inside the curve: the volume is a little less than the exact one, never more.
    assert 0.97 * volume < signed.sum() / 6 <= volume * (1 + 1e-6)
    face = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals = done.attribute(0, 0, "NORMAL").reshape(-1, 3, 3)
    assert (np.einsum("ti,tki->tk", face, normals) > 0).all(), "a normal points inward"


@pytest.mark.parametrize(("axis", "index"), [("X", 0), ("Y", 1), ("Z", 2)])
def test_bounds_are_exact_along_the_axis(tmp_path: Path, axis: str, index: int) -> None:
    body = f'double radius = 0.5\ndouble height = 3\nuniform token axis = "{axis}"'
    for kind, length in (("Cylinder", 3.0), ("Cone", 3.0), ("Capsule", 4.0)):
        done = convert_text(tmp_path, f'def {kind} "G" {{\n{body}\n}}')
        expected = np.ones(3)
        expected[index] = length
        assert extent(done) == pytest.approx(expected, abs=1e-6)


def test_a_cone_points_up_its_axis(tmp_path: Path) -> None:
    done = convert_text(tmp_path, 'def Cone "G" {\n uniform token axis = "Y"\n}')
    points = done.triangles(0).reshape(-1, 3)
    top = points[points[:, 1] > 0.999]
    assert np.abs(top[:, [0, 2]]).max() < 1e-6


@pytest.mark.parametrize(
    ("axis", "size", "normal"),
    [
        ("X", (0, 3, 2), (1, 0, 0)),
        ("Y", (2, 0, 3), (0, 1, 0)),
        ("Z", (2, 3, 0), (0, 0, 1)),
    ],
)
def test_plane_width_and_length(
    tmp_path: Path, axis: str, size: tuple[float, ...], normal: tuple[float, ...]
) -> None:
    body = f'double width = 2\ndouble length = 3\nuniform token axis = "{axis}"'
    done = convert_text(tmp_path, f'def Plane "G" {{\n{body}\n}}')
    assert extent(done) == pytest.approx(size)
    t = done.triangles(0)
    face = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    assert face / np.linalg.norm(face, axis=1, keepdims=True) == pytest.approx(
        np.tile(normal, (2, 1))
    )
