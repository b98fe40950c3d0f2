"""Owns the tests of moving transforms without plain keys: splines, shear, blocked samples."""

from pathlib import Path

import numpy as np
import pytest
from convert_world_matrices import check_world
from pxr import Usd
from read_converted import Converted, convert_text
from texts import text_of

needs_splines = pytest.mark.skipif(
    not hasattr(Usd.Attribute, "HasSpline"), reason="this usd-core has no splines"
)
JUMPS = [1, 4, 7.99, 8, 8.01, 12, 15.9, 16, 19.9, 20, 30]
BETWEEN = [1, 1.7, 3, 5.5, 8, 8.4, 10.5, 13.1, 16, 19.9, 20]


def moving(folder: Path, op: str, value: str) -> Converted:
    """A cube with one animated op."""
    return convert_text(folder, text_of("convert_motion/one_op.usda", value=value, op=op))


@needs_splines
@pytest.mark.parametrize(
    ("knots", "codes", "warnings"),
    [
        ("1: 0; post linear, 20: 90; post linear", [-5, *BETWEEN, 25], []),
        ("1: 0; post curve (5, 40), 20: 90; pre (5, -30); post held", BETWEEN, ["resampled"]),
        ("1: 0; post held, 8: 30 & 50; post linear, 16: 80; post held, 20: 10", JUMPS, []),
        ("pre: linear, post: linear, 1: 0; post linear, 20: 90; post linear", BETWEEN, ["clamped"]),
    ],
    ids=["linear", "curved", "held or of two values", "extrapolated"],
)
def test_splines_are_their_knots_sampled_or_named(
    tmp_path: Path, knots: str, codes: list[float], warnings: list[str]
) -> None:
    done = moving(tmp_path, "rotateZ", f"double xformOp:rotateZ.spline = {{ {knots}, }}")
    assert [name.split("-")[-1] for name in done.warnings()] == warnings
    check_world(done, "/C", codes)
    if codes[0] < 0:
        assert done.world(9.5 / 24)[done.node("/C")][:2, 0] == pytest.approx([0.5**0.5] * 2)


def matrices(*rows: str) -> str:
    """A prim whose matrix has keys at 1, 10 and 20."""
    keys = ", ".join(f"{code}: ({row})" for code, row in zip((1, 10, 20), rows, strict=False))
    return f"matrix4d xformOp:transform.timeSamples = {{ {keys} }}"


def test_matrices_that_turn_and_grow_have_few_cubic_keys(tmp_path: Path) -> None:
    rows = []
    for code in range(1, 61):
        angle, size = 0.1 * code, 1.0 + 0.3 * np.sin(0.2 * code)
        c, s = size * np.cos(angle), size * np.sin(angle)
        axes = f"({c:.9f},{s:.9f},0,0), ({-s:.9f},{c:.9f},0,0), (0,0,{size:.9f},0)"
        rows.append(f"{code}: ({axes}, ({c:.6f},2,{s:.6f},1))")
    samples = f"matrix4d xformOp:transform.timeSamples = {{ {', '.join(rows)} }}"
    done = moving(tmp_path, "transform", samples)
    assert done.warnings() == {"animation-resampled"}
    samplers = done.gltf.animations[0].samplers
    assert {sampler.interpolation for sampler in samplers} == {"CUBICSPLINE"}
    # Linear keys within the same tolerance would be 1,100.
    assert {done.gltf.accessors[sampler.input].count for sampler in samplers} == {60}
    check_world(done, "/C", [1, 1.2, 1.5, 7.7, 30.31, 59.9, 60])


IDENTITY = "(1,0,0,0), (0,1,0,0), (0,0,1,0), (0,0,0,1)"
SHEAR = "(1,.8,0,0), (.3,1,0,0), (0,0,1,0), (0,4,0,1)"
TURNED = "(0.7071,2.121,0,0), (-0.7071,2.121,0,0), (0,0,1,0), (0,0,0,1)"
MIRROR = "(1,.8,0,0), (.3,-1,.2,0), (0,.4,1,0), (3,4,0,1)"
FLAT = "(1,.5,0,0), (.3,1,0,0), (0,0,0,0), (3,4,0,1)"


@pytest.mark.parametrize(
    "keys",
    [(IDENTITY, SHEAR), (IDENTITY, SHEAR, TURNED), (SHEAR, MIRROR, IDENTITY), (SHEAR, FLAT)],
)
def test_moving_shear_is_two_nodes(tmp_path: Path, keys: tuple[str, ...]) -> None:
    done = moving(tmp_path, "transform", matrices(*keys))
    assert {"shear-split", "animation-resampled"} <= done.warnings("/C")
    check_world(done, "/C", [code + share for code in range(1, 20) for share in (0, 0.37, 0.5)])


def test_a_turning_matrix_before_another_keeps_a_cubic_key_for_each_of_its_own(
    tmp_path: Path,
) -> None:
    """Between its keys it shrinks, and so the product shears, which one node cannot follow."""
    rows = []
    for code in range(1, 31):
        c, s = np.cos(0.1 * code), np.sin(0.1 * code)
        rows.append(
            f"{code}: (({c:.9f},0,{-s:.9f},0), (0,1,0,0), ({s:.9f},0,{c:.9f},0), (0,2,0,1))"
        )
    text = text_of("convert_motion/turn_and_tilt.usda", samples=", ".join(rows))
    done = convert_text(tmp_path, text)
    assert done.warnings() == {"animation-resampled"}
    samplers = done.gltf.animations[0].samplers
    # Two nested nodes for the whole matrix would have more than 500.
    assert {done.gltf.accessors[sampler.input].count for sampler in samplers} == {30, 2}
    check_world(done, "/C", [1, 1.2, 1.5, 7.7, 20.31, 29.9, 30])


def test_random_shears_stay_close(tmp_path: Path) -> None:
    random = np.random.default_rng(7)
    rows = []
    for _ in range(3):
        m = np.vstack([random.normal(size=(3, 3)), random.normal(size=3) * 5])
        columns = zip(m, "0001", strict=True)
        rows.append(", ".join(f"({a:.5f},{b:.5f},{c:.5f},{w})" for (a, b, c), w in columns))
    done = moving(tmp_path, "transform", matrices(*rows))
    check_world(done, "/C", list(np.linspace(1, 20, 77)))


def test_a_constant_shear_that_travels_is_exact(tmp_path: Path) -> None:
    row = "(1,.5,0,0), (0,1,0,0), (0,0,1,0), ({x},0,0,1)"
    done = moving(tmp_path, "transform", matrices(row.format(x=0), row.format(x=5)))
    assert done.warnings("/C") == {"shear-split"}
    assert len(done.gltf.animations[0].channels) == 1
    check_world(done, "/C", [1, 5.5, 10])


def test_a_blocked_sample_is_the_identity_until_the_next(tmp_path: Path) -> None:
    value = "double3 xformOp:translate.timeSamples = { 1: (0,0,1), 8: None, 12: (0,0,2) }"
    done = moving(tmp_path, "translate", value)
    assert done.warnings() == set()
    check_world(done, "/C", [1, 4, 7.99, 8, 8.01, 10, 11.99, 12, 15])


def test_blocked_points_and_visibility_keep_the_prim(tmp_path: Path) -> None:
    text = text_of("convert_motion/blocked_points_and_visibility_keep_the_prim.usda")
    done = convert_text(tmp_path, text)
    assert done.warnings() == {"points-animation-frozen"}
    assert len(done.triangles(0)) == 1
    outputs = [done.array(s.output)[:, 0].tolist() for s in done.gltf.animations[0].samplers]
    assert outputs == [[0, 1]]


def test_velocities_move_points_and_instances_between_far_samples(tmp_path: Path) -> None:
    done = convert_text(tmp_path, text_of("convert_motion/velocities.usda")).proven()
    assert done.warnings() == {"animation-resampled"}
    part = done.gltf.meshes[0].primitives[0]
    targets = [done.array(target["POSITION"])[2] for target in part.targets]
    for code, place in ((0, (-2, 1, 2)), (4, (2, 1, 2)), (5.99, (4, 1, 7.96)), (6, (0, 1, 3))):
        weights = done.animated(done.node("/M"), code / 24)["weights"]
        moved = done.attribute(0, 0, "POSITION")[2] + weights @ targets
        assert moved == pytest.approx(place, abs=0.02)
    turned, flipped = (
        next(i for i, node in enumerate(done.gltf.nodes) if node.name == f"P_{number}")
        for number in (0, 1)
    )
    assert done.world(7 / 24)[turned][:3, 3] == pytest.approx((1, 5, 0), abs=1e-6)
    assert done.world(3 / 24)[turned][:2, 0] == pytest.approx((0, 1), abs=1e-6)
    assert done.world(6 / 24)[flipped][:3, 0] == pytest.approx((-1, 0, 0), abs=1e-6)


@pytest.mark.parametrize(
    "changes",
    [
        {"6:": "3:", "startTimeCode = 0": "startTimeCode = 2", "Code = 8": "Code = 3"},
        {"2: [(24": "1: [(24"},
    ],
    ids=["close", "at other times"],
)
def test_velocities_that_samples_do_not_need_are_named(
    tmp_path: Path, changes: dict[str, str]
) -> None:
    text = text_of("convert_motion/velocities.usda")
    for old, new in changes.items():
        text = text.replace(old, new)
    done = convert_text(tmp_path, text).proven()
    assert done.warnings("/M") == {"velocities-dropped"}
