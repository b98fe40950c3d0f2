"""Owns the tests of mesh conversion: triangulation, primvars, subsets, damage."""

from pathlib import Path

import numpy as np
import pytest
from read_converted import Converted, convert_text
from reflet_usd.convert.surface import unique_rows
from reflet_usd.convert.triangulate import triangulate
from texts import text_of


def mesh(body: str, faces: str, points: str, name: str = "M") -> str:
    counts, indices = faces.split("/")
    return text_of(
        "convert_mesh/mesh.usda",
        name=name,
        counts=counts,
        indices=indices,
        points=points,
        body=body,
    )


SQUARE = "(0,0,0), (1,0,0), (1,1,0), (0,1,0)"


def area(triangles: np.ndarray) -> float:
    crossed = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return float(np.linalg.norm(crossed, axis=1).sum() / 2)


def star(corners: int, inner: float) -> np.ndarray:
    angles = np.arange(corners) * 2 * np.pi / corners
    radii = np.where(np.arange(corners) % 2, inner, 1.0)
    return np.stack([radii * np.cos(angles), radii * np.sin(angles), 0 * angles], axis=1)


def shoelace(outline: np.ndarray) -> float:
    x, y = outline[:, 0], outline[:, 1]
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)


@pytest.mark.parametrize("corners", [4, 6, 8, 10, 24, 26, 60, 200])
@pytest.mark.parametrize("flip", [False, True])
def test_concave_outlines_are_covered_exactly_once(corners: int, flip: bool) -> None:
    # Polygons of four corners: an arrowhead; of more: a star.
    outline = (
        star(corners, 0.3)
        if corners > 4
        else np.array([[0, 0, 0], [2, 1, 0], [0, 2, 0], [0.5, 1, 0]], dtype=float)
    )
    if flip:
        outline = outline[::-1]
    # Polygons turned out of the axes' planes, and moved far from the origin.
    turn = np.linalg.qr(np.array([[1, 2, 3], [0, 1, 4], [5, 6, 0.5]]))[0]
    turn *= np.sign(np.linalg.det(turn))
    points = outline @ turn.T + 100.0
    triangles, faces = triangulate(points, np.arange(len(points)), np.array([len(points)]))
    assert len(triangles) == len(points) - 2
    assert set(faces) == {0}
    signed = [shoelace(outline[t]) for t in triangles]
    expected = shoelace(outline)
    assert min(np.array(signed) * np.sign(expected)) >= -1e-12, "a triangle is turned around"
    assert sum(signed) == pytest.approx(expected)


def test_random_simple_polygons_keep_their_area() -> None:
    random = np.random.default_rng(7)
    for corners in range(5, 40):
        angles = np.sort(random.random(corners)) * 2 * np.pi
        if np.diff(angles, append=angles[0] + 2 * np.pi).max() > np.pi:
            continue  # the origin is outside, so the outline may cross itself
        radii = random.uniform(0.05, 1.0, corners)
        outline = np.stack([radii * np.cos(angles), radii * np.sin(angles), 0 * angles], 1)
        triangles, _ = triangulate(outline, np.arange(corners), np.array([corners]))
        signed = np.array([shoelace(outline[t]) for t in triangles])
        assert signed.min() > -1e-12
        assert signed.sum() == pytest.approx(shoelace(outline))


def test_mixed_faces_keep_order_and_winding() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0.5, 0]], dtype=float)
    corners = np.array([0, 1, 2, 3, 1, 4, 2, 0, 1, 4, 2, 3])
    triangles, faces = triangulate(points, corners, np.array([4, 3, 5]))
    assert faces.tolist() == [0, 0, 1, 2, 2, 2]
    for face, row in zip(faces, triangles, strict=True):
        first = (0, 4, 7)[face]
        assert ((row >= first) & (row < (4, 7, 12)[face])).all()
        assert shoelace(points[corners[row]]) > 0


def test_faces_of_a_mesh_reach_the_file(tmp_path: Path) -> None:
    done = convert_text(tmp_path, mesh("", "4/0,1,2,3", SQUARE))
    triangles = done.triangles(0)
    assert len(triangles) == 2
    assert area(triangles) == pytest.approx(1.0)
    assert done.attribute(0, 0, "NORMAL") == pytest.approx(np.tile([0, 0, 1], (6, 1)))


def test_left_handed_turns_faces_but_not_authored_normals(tmp_path: Path) -> None:
    body = 'uniform token orientation = "leftHanded"'
    done = convert_text(tmp_path, mesh(body, "4/0,1,2,3", SQUARE))
    t = done.triangles(0)
    assert np.cross(t[0, 1] - t[0, 0], t[0, 2] - t[0, 0])[2] < 0
    assert done.attribute(0, 0, "NORMAL")[:, 2] == pytest.approx(-1)
    body += "\nnormal3f[] normals = [(0,0,-2), (0,0,-2), (0,0,-2), (0,0,-2)]"
    done = convert_text(tmp_path, mesh(body, "4/0,1,2,3", SQUARE))
    assert done.attribute(0, 0, "NORMAL")[:, 2] == pytest.approx(-1)


def test_holes_are_left_out_and_the_rest_stays(tmp_path: Path) -> None:
    points = SQUARE + ", (2,0,0), (2,1,0)"
    done = convert_text(tmp_path, mesh("int[] holeIndices = [0]", "4,4/0,1,2,3,1,4,5,2", points))
    triangles = done.triangles(0)
    assert len(triangles) == 2
    assert triangles[..., 0].min() == 1.0


@pytest.mark.parametrize(
    ("interpolation", "values", "indices"),
    [
        ("constant", "(0.25, 0.75)", ""),
        ("vertex", "(0,0), (1,0), (1,1), (0,1)", ""),
        ("varying", "(0,0), (1,0), (1,1), (0,1)", ""),
        ("faceVarying", "(0,0), (1,0), (1,1), (0,1)", ""),
        ("faceVarying", "(1,1), (0,0), (1,0)", "1,2,0,1"),
        ("vertex", "(1,1), (0,0), (1,0)", "1,2,0,1"),
        ("uniform", "(0.5,0.125)", ""),
    ],
)
def test_uv_sets_of_every_interpolation(
    tmp_path: Path, interpolation: str, values: str, indices: str
) -> None:
    body = f'texCoord2f[] primvars:st = [{values}] (interpolation = "{interpolation}")'
    if indices:
        body += f"\nint[] primvars:st:indices = [{indices}]"
    done = convert_text(tmp_path, mesh(body, "4/0,1,2,3", SQUARE))
    table = np.array(eval(f"[{values}]"), dtype=float)
    order = np.array(eval(f"[{indices}]"), dtype=int) if indices else np.arange(4)
    corner_values = np.repeat(table, 4, axis=0) if len(table) == 1 else table[order]
    uv, position = done.attribute(0, 0, "TEXCOORD_0"), done.attribute(0, 0, "POSITION")
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    for row, place in zip(uv, position, strict=True):
        corner = int(np.abs(square - place).sum(axis=1).argmin())
        expected = corner_values[corner]
        assert row == pytest.approx([expected[0], 1 - expected[1]])


def test_equal_corners_are_welded_and_seams_are_not(tmp_path: Path) -> None:
    points = SQUARE + ", (2,0,0), (2,1,0)"
    seam = "(0,0), (1,0), (1,1), (0,1), (5,5), (6,5), (6,6), (1,1)"
    body = f'texCoord2f[] primvars:st = [{seam}] (interpolation = "faceVarying")'
    body += '\nnormal3f[] normals = [(0,0,1)] (interpolation = "constant")'
    done = convert_text(tmp_path, mesh(body, "4,4/0,1,2,3,1,4,5,2", points))
    accessor = done.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]
    # Six vertices; (1, 0) has two UVs, (1, 1) has the same UV on both faces.
    assert done.gltf.accessors[accessor].count == 7


def test_unique_rows_joins_equal_bits_only() -> None:
    random = np.random.default_rng(3)
    table = random.normal(size=(500, 3)).astype(np.float32)
    pick = random.integers(0, 500, 20_000)
    groups = unique_rows(table[pick])
    assert len(np.unique(groups)) == len(np.unique(pick))
    for group in np.unique(groups)[:50]:
        assert len(np.unique(pick[groups == group])) == 1
    assert unique_rows(np.array([[0.0, 1.0], [-0.0, 1.0]])).tolist() == [0, 0]


def test_smooth_normals_of_a_cage_are_unit_and_shared(tmp_path: Path) -> None:
    cube = text_of("convert_mesh/smooth_normals_of_a_cage_are_unit_and_shared.usda")
    done = convert_text(tmp_path, cube)
    normal, position = done.attribute(0, 0, "NORMAL"), done.attribute(0, 0, "POSITION")
    assert normal == pytest.approx(position / np.sqrt(3), abs=1e-6)
    assert "subdivision-cage" in done.warnings("/M")


SUBSETS = text_of("convert_mesh/subsets.usda")


def test_subsets_become_primitives_and_the_rest_keeps_its_look(tmp_path: Path) -> None:
    done = convert_text(tmp_path, SUBSETS)
    primitives = done.json["meshes"][0]["primitives"]
    assert [p.get("extras", {}).get("prim") for p in primitives] == ["/M/A", None]
    materials = [done.json["materials"][p["material"]] for p in primitives]
    assert materials[0]["name"] == "Red"
    assert materials[1]["pbrMetallicRoughness"]["baseColorFactor"] == [0, 0, 1, 1]
    counts = [done.gltf.accessors[p["indices"]].count for p in primitives]
    assert counts == [3, 6]
    assert "index-out-of-range" in done.warnings("/M/A")
    assert "subset-overlap" in done.warnings("/M/B")


@pytest.mark.parametrize(
    ("faces", "points", "warning", "triangle_count"),
    [
        ("4,4/0,1,2,3,0,1,2,9", SQUARE, "index-out-of-range", 2),
        ("4,3/0,1,2,3,0,-1,2", SQUARE, "index-out-of-range", 2),
        (
            "4,4/0,1,2,3,1,4,5,2",
            SQUARE + ", (nan,0,0), (2,1,0)",
            "points-non-finite",
            2,
        ),
        ("4,3/0,1,2,3,1,4,2", SQUARE + ", (inf,0,0)", "points-non-finite", 2),
        ("4,-4/0,1,2,3", SQUARE, "topology-invalid", 2),
        ("4,2000000000/0,1,2,3", SQUARE, "topology-invalid", 2),
        ("4,2/0,1,2,3,0,1", SQUARE, "face-degenerate", 2),
        ("4/0,1,2,3,0,1", SQUARE, "topology-invalid", 2),
    ],
)
def test_damage_is_named_and_the_good_faces_stay(
    tmp_path: Path, faces: str, points: str, warning: str, triangle_count: int
) -> None:
    done = convert_text(tmp_path, mesh("", faces, points))
    assert warning in done.warnings("/M")
    assert len(done.triangles(0)) == triangle_count


def test_a_mesh_without_good_faces_is_no_mesh(tmp_path: Path) -> None:
    done = convert_text(tmp_path, mesh("", "3/0,1,9", SQUARE))
    assert not done.json.get("meshes")
    assert {"mesh-empty", "index-out-of-range"} <= done.warnings("/M")
    assert "stage-empty" in done.warnings("/")


def test_primvars_of_the_wrong_size_are_named(tmp_path: Path) -> None:
    body = 'texCoord2f[] primvars:st = [(0,0)] (interpolation = "vertex")\n'
    body += 'float[] primvars:heat = [1, 2, 3, 4] (interpolation = "vertex")\n'
    body += 'int[] primvars:count = [1, 2, 3, 4] (interpolation = "vertex")'
    done = convert_text(tmp_path, mesh(body, "4/0,1,2,3", SQUARE))
    assert {"primvar-size-wrong", "primvar-dropped"} <= done.warnings("/M")
    assert "TEXCOORD_0" not in done.json["meshes"][0]["primitives"][0]["attributes"]
    assert sorted(set(done.attribute(0, 0, "_HEAT")[:, 0])) == [1, 2, 3, 4]


def test_display_color_and_opacity_per_vertex(tmp_path: Path) -> None:
    body = "color3f[] primvars:displayColor = [(1,0,0), (0,1,0), (0,0,1), (2,0,0)] "
    body += '(interpolation = "vertex")\n'
    body += 'float[] primvars:displayOpacity = [1, 1, 0.5, 1] (interpolation = "vertex")'
    done: Converted = convert_text(tmp_path, mesh(body, "4/0,1,2,3", SQUARE))
    color, position = done.attribute(0, 0, "COLOR_0"), done.attribute(0, 0, "POSITION")
    assert color.shape[1] == 4
    third = np.all(position == (1, 1, 0), axis=1)
    assert color[third] == pytest.approx(np.tile([0, 0, 1, 0.5], (third.sum(), 1)))
    assert color.max() <= 1.0
    assert "color-clamped" in done.warnings("/M")
    assert done.json["materials"][0]["alphaMode"] == "BLEND"


@pytest.mark.parametrize("count", [1500, pytest.param(4000, marks=pytest.mark.full("seconds"))])
def test_a_huge_outline_takes_seconds_not_minutes(count: int) -> None:
    outline = star(count, 0.5)
    triangles, _ = triangulate(outline, np.arange(count), np.array([count]))
    signed = np.array([shoelace(outline[t]) for t in triangles])
    assert signed.min() > -1e-12
    assert signed.sum() == pytest.approx(shoelace(outline))


def test_values_beyond_float32_are_named(tmp_path: Path) -> None:
    body = 'double[] primvars:heat = [1, 1e300, 3, 4] (interpolation = "vertex")'
    done = convert_text(tmp_path, mesh(body, "4/0,1,2,3", SQUARE))
    assert "primvar-non-finite" in done.warnings("/M")
    assert np.isfinite(done.attribute(0, 0, "_HEAT")).all()


def test_a_bent_convex_quad_keeps_its_first_diagonal() -> None:
    bent = np.array([[0, 0, 0], [1, 0, 3], [1, 1, 0], [0, 1, 3]], dtype=float)
    triangles, _ = triangulate(bent, np.arange(4), np.array([4]))
    assert triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
