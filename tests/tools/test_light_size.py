"""Owns the tests of lights under scaling transforms: their power, by place and over time."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from read_converted import Converted, convert_text
from reflet_usd.validate.compare_cameras_lights import nearby
from reflet_usd.validate.light_area import surface_area
from reflet_usd.validate.scene_data import Light
from scipy import special
from tampering import Output, expect_found, expect_required, light
from texts import text_of

LIGHT = text_of("light_size/light.usda")
UNIT_RECT = "float inputs:width = 1\nfloat inputs:height = 1"
WIDE_RECT = "float inputs:width = 2\nfloat inputs:height = 1"
ROD = "float inputs:radius = 0.1\nfloat inputs:length = 2"
BALL = "float inputs:radius = 1"


def entries(done: Converted) -> list[dict]:
    """Entries of the file's lights."""
    found = done.json["extensions"]["KHR_lights_punctual"]["lights"]
    assert isinstance(found, list)
    return found


def scaled(x: float, y: float, z: float) -> tuple[str, str, str]:
    """Rows of a matrix that scales along the axes."""
    return f"{x}, 0, 0", f"0, {y}, 0", f"0, 0, {z}"


def spheroid(a: float, b: float, c: float) -> float:
    """Surface area of an ellipsoid."""
    return 4 * math.pi * special.elliprg((a * b) ** 2, (a * c) ** 2, (b * c) ** 2)


CASES = [
    ("RectLight", UNIT_RECT, scaled(4, 1, 1), 4.0),
    ("RectLight", UNIT_RECT, scaled(1, 1, 10), 1.0),
    ("RectLight", WIDE_RECT, scaled(1, 1, 0), 2.0),
    ("RectLight", UNIT_RECT, ("2, 0, 0", "3, 2, 0", "0, 0, 1"), 4.0),
    ("DiskLight", BALL, scaled(3, 2, 7), 6 * math.pi),
    ("CylinderLight", ROD, scaled(10, 1, 1), 4 * math.pi),
    ("CylinderLight", ROD, scaled(1, 1, 3), 0.2 * 4 * 3 * special.ellipe(1 - 1 / 9)),
    ("SphereLight", BALL, scaled(2, 2, 2), 16 * math.pi),
    ("SphereLight", BALL, scaled(3, 2, 1), spheroid(3, 2, 1)),
    ("SphereLight", BALL, scaled(0, 2, 1), 4 * math.pi),
]


@pytest.mark.parametrize(("kind", "body", "rows", "area"), CASES)
def test_power_follows_the_area_in_the_world(
    tmp_path: Path, kind: str, body: str, rows: tuple[str, str, str], area: float
) -> None:
    done = convert_text(tmp_path, LIGHT.format(*rows, kind=kind, body=body))
    steradians = 2 * math.pi / 3 if kind in ("RectLight", "DiskLight") else 4 * math.pi
    (entry,) = entries(done)
    assert entry["intensity"] == pytest.approx(100 * math.pi * area / steradians, rel=1e-6)
    named = kind != "SphereLight" or rows != scaled(2, 2, 2)
    assert ("area-light-approximated" in done.warnings("/L")) == named
    if named:
        expect_required(done, "area-light-approximated", "/L")
    expect_found(done, light(intensity=entry["intensity"] * 1.001))


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (("1, 0, 0", "0, 1, 0", "0, 1, 1"), "it shines up to 45.0° off its surface's normal"),
        (scaled(1, 1, 0), "the world flattens the axis that it shines along"),
        (scaled(1, 2, -3), "lm"),
    ],
)
def test_what_shear_does_to_the_direction_is_told(
    tmp_path: Path, rows: tuple[str, str, str], words: str
) -> None:
    done = convert_text(tmp_path, LIGHT.format(*rows, kind="RectLight", body=UNIT_RECT))
    (message,) = [
        w["message"] for w in done.sidecar["warnings"] if w["name"] == "area-light-approximated"
    ]
    assert message.endswith(words)


def test_turning_a_light_leaves_its_area() -> None:
    rows = [[0.6, 0.8, 0.0], [-2.4, 1.8, 0.0], [0.0, 0.0, 2.0]]
    assert surface_area("sphere", (1, 1), np.array(rows)) == (pytest.approx(spheroid(3, 2, 1)))


INSTANCES = text_of("light_size/instances.usda")


def test_each_instance_has_the_power_of_its_size(tmp_path: Path) -> None:
    def share(out: Output) -> None:
        for node in out.gltf.nodes:
            if "KHR_lights_punctual" in (node.extensions or {}):
                node.extensions["KHR_lights_punctual"]["light"] = 0

    done = convert_text(tmp_path, INSTANCES)
    areas = (1.0, 9.0, spheroid(4, 1, 1) / (4 * math.pi))
    levels = [entry["intensity"] for entry in entries(done)]
    assert levels == pytest.approx([math.pi * 0.01 * area for area in areas])
    assert "area-light-approximated" in done.warnings("/I/A")
    expect_found(done, share)


MOVING = text_of("light_size/moving.usda")


def test_sizes_that_move_stay_at_their_first_value(tmp_path: Path) -> None:
    done = convert_text(tmp_path, MOVING.replace("BODY", ""))
    assert entries(done)[0]["intensity"] == pytest.approx(math.pi * 0.01)
    expect_required(done, "light-animation-frozen", "/X/L")
    expect_found(done, light(intensity=math.pi * 0.25))


def test_instances_that_grow_are_told(tmp_path: Path) -> None:
    scales = "float3[] scales = [(1, 1, 1), (3, 3, 3), (1, 1, 1), (1, 1, 4)]"
    later = "24: [(2, 2, 2), (3, 3, 3), (1, 1, 1), (1, 1, 1)]"
    keys = scales.replace(" = ", ".timeSamples = { 0: ") + f", {later} }}"
    done = convert_text(tmp_path, INSTANCES.replace(scales, keys)).proven()
    assert "light-animation-frozen" in done.warnings("/I/A")


@pytest.mark.parametrize("body", ["bool inputs:normalize = 1", "float inputs:radius = 0"])
def test_lights_whose_power_needs_no_size_are_not_frozen(tmp_path: Path, body: str) -> None:
    text = MOVING.replace("BODY", body)
    if "radius" in body:
        text = text.replace("float inputs:radius = 0.1\n", "")
    done = convert_text(tmp_path, text).proven()
    assert "light-animation-frozen" not in done.warnings()


def test_of_many_lights_only_those_nearby_are_compared(tmp_path: Path) -> None:
    def swap(out: Output) -> None:
        lit = [n for n in out.gltf.nodes if "KHR_lights_punctual" in (n.extensions or {})]
        first, second = (lit[i].extensions["KHR_lights_punctual"] for i in (0, 39))
        first["light"], second["light"] = second["light"], first["light"]

    places = ", ".join(f"({x}, 0, 0)" for x in range(40))
    scales = ", ".join(f"({x}, {x}, {x})" for x in range(1, 41))
    text = re.sub(r"positions = .*", f"positions = [{places}]", INSTANCES)
    text = re.sub(r"scales = .*", f"scales = [{scales}]", text)
    text = re.sub(r"protoIndices = .*", f"protoIndices = {[0] * 40}", text)
    done = convert_text(tmp_path, text)
    assert len(entries(done)) == 40
    expect_found(done, swap)
    matrices = [np.eye(4) for _ in range(200)]
    for place, matrix in enumerate(matrices):
        matrix[3, :3] = place // 2, 0, 0
    lights = [Light("point", np.ones(3), matrix) for matrix in matrices]
    near = [sorted(found) for found in nearby(lights, lights)]
    assert near == [[place - place % 2, place - place % 2 + 1] for place in range(200)]
