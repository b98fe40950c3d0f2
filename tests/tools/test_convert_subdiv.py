"""Owns the tests of Catmull-Clark refinement: known positions, boundaries, creases, UV rules."""

from pathlib import Path

import numpy as np
import pytest
from read_converted import Converted, convert_text
from reflet_usd.convert.normals import smooth_groups
from reflet_usd.convert.subdiv import INFINITE, Cage, Step, edge_keys
from texts import fill, text_of

CUBE_FACES = np.array(
    [0, 1, 3, 2, 2, 3, 5, 4, 4, 5, 7, 6, 6, 7, 1, 0, 1, 7, 5, 3, 6, 0, 2, 4],
    dtype=np.int64,
)
AROUND = ((-1, 1), (1, 1), (1, -1), (-1, -1))
CUBE_POINTS = np.array([[x, y, z] for y, z in AROUND for x in (-1, 1)], dtype=float)


def cube_cage() -> Cage:
    return Cage(np.full(6, 4), CUBE_FACES, 8)


def test_a_cube_after_one_step() -> None:
    step = Step(cube_cage())
    values = step.smooth(CUBE_POINTS)
    # Catmull and Clark: a valence-3 corner moves to (Q + 2R + 0·S) / 3 = 5/9 of the way.
    assert values[:8] == pytest.approx(CUBE_POINTS * 5 / 9)
    edges, faces = values[8:20], values[20:]
    assert np.sort(np.abs(edges), axis=1) == pytest.approx(np.tile([0, 0.75, 0.75], (12, 1)))
    assert np.sort(np.abs(faces), axis=1) == pytest.approx(np.tile([0, 0, 1], (6, 1)))
    child = step.child()
    assert len(child.counts) == 24
    assert child.vertex_count == 26
    # Each child quad keeps its parent's winding: outward.
    quads = values[child.corners.reshape(-1, 4)]
    normal = np.cross(quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0])
    assert (np.einsum("ij,ij->i", normal, quads.mean(axis=1)) > 0).all()


def creased_cube(sharpness: float) -> np.ndarray:
    """Points of a cube whose edges are creased, refined three times."""
    cage = cube_cage()
    edges = Step(cage).edges
    cage.crease_keys = np.sort(edge_keys(edges[:, 0], edges[:, 1], 8))
    cage.crease_values = np.full(12, sharpness)
    values = CUBE_POINTS
    for _ in range(3):
        step = Step(cage)
        values = step.smooth(values)
        cage = step.child()
    return values


def test_fully_creased_cube_stays_a_cube() -> None:
    values = creased_cube(INFINITE)
    assert np.abs(values).max(axis=1) == pytest.approx(np.ones(len(values)))
    assert np.abs(values).max(axis=0) == pytest.approx(np.ones(3))


def test_semi_sharp_lies_between_smooth_and_sharp() -> None:
    sizes = [np.linalg.norm(creased_cube(s)[0]) for s in (0.0, 0.5, 1.0, 1.5, 2.5, INFINITE)]
    assert sizes == sorted(sizes)
    assert len(set(sizes)) == len(sizes)


def grid(size: int) -> tuple[Cage, np.ndarray]:
    index = np.arange((size + 1) ** 2).reshape(size + 1, size + 1)
    quads = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1)
    x, y = np.meshgrid(np.arange(size + 1.0), np.arange(size + 1.0))
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    return Cage(np.full(size * size, 4), quads.reshape(-1), len(points)), points


@pytest.mark.parametrize(("pin", "corner"), [(True, 0.0), (False, 0.125 * 2)])
def test_boundary_rules(pin: bool, corner: float) -> None:
    cage, points = grid(3)
    cage.pin_corners = pin
    step = Step(cage)
    values = step.smooth(points)
    # edgeAndCorner keeps the corner; edgeOnly moves it along the boundary spline, 1/8 + 1/8.
    assert values[0, 0] == pytest.approx(corner if pin else 0.125)
    assert values[0, 2] == 0.0
    # A boundary vertex inside a straight edge stays; interior vertices of a grid do too.
    assert values[1, 1] == pytest.approx(0.0)
    assert values[5] == pytest.approx(points[5])


STAGE = text_of("convert_subdiv/stage.usda")


def convert(tmp_path: Path, level: int, **values: str) -> Converted:
    filled = {"scheme": "catmullClark", "rule": "cornersPlus1", "holes": "", **values}
    return convert_text(tmp_path, fill(STAGE, **filled), subdiv_level=level)


@pytest.mark.parametrize("level", [1, 2, 3])
def test_level_counts_and_primvars(tmp_path: Path, level: int) -> None:
    done = convert(tmp_path, level)
    triangles = done.triangles(0)
    assert len(triangles) == 2 * 4**level * 2
    position, uv = done.attribute(0, 0, "POSITION"), done.attribute(0, 0, "TEXCOORD_0")
    assert uv[:, 1] == pytest.approx(1 - position[:, 1], abs=1e-6), "v follows y on this strip"
    assert done.attribute(0, 0, "_HEAT").max() == pytest.approx(2.0)
    colors = done.attribute(0, 0, "COLOR_0")
    left = colors[:, 0] == 1
    assert left.sum() == len(colors) // 2
    assert position[left][:, 0].max() == pytest.approx(1.0, abs=1e-6)
    assert "subdivision-cage" not in done.warnings()


def test_face_varying_all_is_bilinear(tmp_path: Path) -> None:
    done = convert(tmp_path, 2, rule="all")
    uv = done.attribute(0, 0, "TEXCOORD_0")
    quarters = uv * 4
    assert quarters == pytest.approx(np.round(quarters), abs=1e-5)


def test_holes_stay_holes(tmp_path: Path) -> None:
    done = convert(tmp_path, 2, holes="1")
    assert len(done.triangles(0)) == 32
    assert done.triangles(0)[..., 0].max() <= 1.0 + 1e-6


def test_other_schemes_are_named(tmp_path: Path) -> None:
    assert "subdivision-cage" in convert(tmp_path, 2, scheme="loop").warnings("/M")
    assert "subdivision-cage" not in convert(tmp_path, 2, scheme="none").warnings()
    assert "subdivision-cage" in convert(tmp_path, 0).warnings("/M")


# A triangle beside a triangle, and a square beside both.
TRIANGLES = text_of("convert_subdiv/triangles.usda")


def test_smooth_triangles_weigh_more(tmp_path: Path) -> None:
    done = convert_text(tmp_path, TRIANGLES, subdiv_level=1)
    points = done.triangles(0).reshape(-1, 3)
    faces = {"first": np.array([0, 2, -2]) / 3, "second": np.array([2, 2, 0]) / 3}
    between = 0.03 * np.array([1.0, 2.0, -1.0]) + 0.47 * (faces["first"] + faces["second"])
    beside = 0.14 * np.array([0.0, 0.0, -2.0]) + 0.36 * (faces["first"] + np.zeros(3))
    for expected in (between, beside):
        assert np.linalg.norm(points - expected, axis=1).min() < 1e-6
    assert convert_text(tmp_path, TRIANGLES, subdiv_level=2).validated().passed


@pytest.mark.parametrize("rule", ["smooth", "catmullClark"])
def test_the_rule_for_triangles_has_to_be_followed(tmp_path: Path, rule: str) -> None:
    text = TRIANGLES.replace("smooth", rule)
    done = convert_text(tmp_path, text, subdiv_level=1).proven()
    other = {"smooth": "catmullClark", "catmullClark": "smooth"}[rule]
    stage = tmp_path / "stage.usda"
    stage.write_text(stage.read_text(encoding="utf-8").replace(rule, other), encoding="utf-8")
    assert not done.validated().passed


@pytest.mark.parametrize("level", [0, 1, 2])
def test_loop_refines_triangles(tmp_path: Path, level: int) -> None:
    text = text_of("convert_subdiv/loop.usda")
    done = convert_text(tmp_path, text, subdiv_level=level).proven()
    assert ("subdivision-cage" in done.warnings("/Shell")) == (level == 0)
    assert "subdivision-cage" in done.warnings("/Mixed")
    assert len(done.triangles(0)) == 8 * 4**level
    if level == 1:  # an octahedron's corner: (1 - 4 w) of itself and w of each neighbor
        share = (5 / 8 - (3 / 8) ** 2) / 4
        tops = done.triangles(0).reshape(-1, 3)[:, 1]
        assert tops.max() == pytest.approx(1 - 4 * share)


CUBE = text_of("convert_subdiv/cube.usda")


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("scheme", ["catmullClark", "loop"])
def test_normals_are_not_shared_over_creases(tmp_path: Path, scheme: str, level: int) -> None:
    def upright(sharpness: float) -> tuple[int, int]:
        """Number of normals along z and across z at the vertices of the creased face."""
        text = fill(CUBE, scheme=scheme, sharpness=sharpness)
        done = convert_text(tmp_path, text, subdiv_level=level)
        position, normal = (done.attribute(0, 0, name) for name in ("POSITION", "NORMAL"))
        up = np.abs(normal[position[:, 2] == 1.0][:, 2])
        return int((up > 0.999).sum()), int((up < 0.1).sum())

    along, across = upright(10.0)
    assert along >= 4 and across >= 4
    along, across = upright(2.0)
    assert across == 0, "a semi-sharp crease is rounded"


def test_creases_split_only_what_they_part() -> None:
    # Two quads share a sharp edge; a third quad lies beside the first.
    corners = np.array([0, 1, 2, 3, 1, 4, 5, 2, 3, 2, 6, 7])
    counts = np.array([4, 4, 4])
    sharp = edge_keys(np.array([1]), np.array([2]), 8)
    groups = smooth_groups(corners, counts, 8, sharp)
    parts = [len(np.unique(groups[corners == point])) for point in range(8)]
    assert parts == [1, 2, 2, 1, 1, 1, 1, 1]
    # Around point 2 the first and the third quad are joined over the edge that they share.
    assert groups[2] == groups[9] != groups[7]
