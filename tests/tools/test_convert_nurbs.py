"""NURBS patches that move, and primvars of their control points."""

from pathlib import Path

import numpy as np
import pytest
from read_converted import convert_text
from texts import text_of

PATCH = text_of("convert_nurbs/patch.usda")
STILL = "[(0,0,0), (1,0,0), (2,0,0), (0,1,0), (1,1,0), (2,1,0)]"
RAISED = "[(0,0,0), (1,0,6), (2,0,0), (0,1,0), (1,1,6), (2,1,0)]"


def test_animated_control_points_move_the_surface(tmp_path: Path) -> None:
    points = f"point3f[] points.timeSamples = {{ 0: {STILL}, 24: {RAISED} }}"
    done = convert_text(tmp_path, PATCH.replace("POINTS", points))
    primitive = done.json["meshes"][0]["primitives"][0]
    offsets = done.array(primitive["targets"][0]["POSITION"])
    positions = done.array(primitive["attributes"]["POSITION"])
    # Expected from the rational Bézier curve of weights 1, 2, 1 at u = 1/2, where x is 1.
    middle = np.isclose(positions[:, 0], 1.0)
    assert middle.any()
    expected = 6 * 2 * 2 * 0.25 / (0.25 + 2 * 2 * 0.25 + 0.25)
    assert offsets[middle, 2] == pytest.approx(np.full(middle.sum(), expected))
    assert not offsets[:, :2].any()
    assert [channel["target"]["path"] for channel in done.json["animations"][0]["channels"]] == [
        "weights"
    ]
    assert done.warnings("/N") == {"curves-approximated"}


def test_values_of_control_points_reach_the_surface(tmp_path: Path) -> None:
    values = text_of("convert_nurbs/values_of_control_points_reach_the_surface.usda")
    text = PATCH.replace("POINTS", f"point3f[] points = {STILL}\n{values}")
    done = convert_text(tmp_path, text)
    attributes = done.json["meshes"][0]["primitives"][0]["attributes"]
    positions, colors, uvs = (
        done.array(attributes[name]) for name in ("POSITION", "COLOR_0", "TEXCOORD_0")
    )
    # Texture coordinates that equal x / 2 and y at the control points do so everywhere.
    assert uvs[:, 0] == pytest.approx(positions[:, 0] / 2, abs=1e-6)
    assert uvs[:, 1] == pytest.approx(1 - positions[:, 1], abs=1e-6)
    left = np.isclose(positions[:, 0], 0.0)
    assert np.allclose(colors[left][:, :3] / colors.max(), (1, 0, 0))
    assert "_HEAT" not in attributes and "_SIDE" not in attributes
    warnings = {"curves-approximated", "primvar-size-wrong", "primvar-interpolation-dropped"}
    assert warnings <= done.warnings("/N")
