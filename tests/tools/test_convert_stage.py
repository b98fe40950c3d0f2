"""Owns the tests of whole conversions: composition, selection, confinement, ledger, exact bytes."""

import json
from pathlib import Path

import numpy as np
import pytest
from read_converted import Converted, convert_text, refused
from reflet_usd.convert import ConvertOptions, convert_stage
from tampering import expect_required
from texts import text_of

LFS = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12\n"
HERE = Path(__file__).resolve().parent
SMALL = sorted((HERE / "usd").glob("*.usda")) + sorted((HERE / "stages").glob("*.usda"))


@pytest.mark.parametrize("stage", SMALL, ids=lambda path: path.stem)
def test_two_runs_give_the_same_bytes(stage: Path, tmp_path: Path) -> None:
    outs = [tmp_path / "a.glb", tmp_path / "b.glb"]
    for out in outs:
        convert_stage(stage, out, ConvertOptions())
    assert outs[0].read_bytes() == outs[1].read_bytes()
    texts = [Path(f"{out}.json").read_text() for out in outs]
    assert texts[0] == texts[1]


@pytest.mark.parametrize("stage", SMALL, ids=lambda path: path.stem)
def test_every_prim_is_carried_or_warned_about(stage: Path, tmp_path: Path) -> None:
    from pxr import Usd

    done = Converted(stage, tmp_path / "out.glb")
    opened = Usd.Stage.Open(str(stage))
    predicate = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
    prims = list(Usd.PrimRange.Stage(opened, predicate))
    counted = sum(row["carried"] + row["warned"] for row in done.result.ledger.values())
    assert counted == len(prims)


def test_gltf_with_a_buffer_beside_it(tmp_path: Path) -> None:
    stage = tmp_path / "s.usda"
    stage.write_text('#usda 1.0\ndef Cube "Würfel" {\n}\n', encoding="utf-8")
    out = tmp_path / "out file.gltf"
    convert_stage(stage, out, ConvertOptions())
    document = json.loads(out.read_text(encoding="utf-8"))
    assert document["buffers"][0]["uri"] == "out%20file.bin"
    size = (tmp_path / "out file.bin").stat().st_size
    assert size == document["buffers"][0]["byteLength"]
    assert document["nodes"][1]["name"] == "Würfel"
    assert document["nodes"][1]["extras"]["prim"] == "/Würfel"
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        "out file.bin",
        "out file.gltf",
        "out file.gltf.json",
        "s.usda",
    ]


@pytest.mark.parametrize(
    "text",
    [b"#usda 1.0\ndef Cube {", b"not usd", b"", b'#usda 1.0\ndef Cube "a\xff\xfe" {\n}\n', LFS],
)
def test_unreadable_stages_are_named_and_leave_nothing(tmp_path: Path, text: bytes) -> None:
    stage = tmp_path / "bad.usda"
    stage.write_bytes(text)
    with refused("stage-unreadable") as caught:
        convert_stage(stage, tmp_path / "out.glb", ConvertOptions())
    assert ("git lfs pull" in str(caught.value)) == (text == LFS)
    assert [p.name for p in tmp_path.iterdir()] == ["bad.usda"]
    if text == LFS:  # as a layer too
        done = convert_text(tmp_path, "#usda 1.0\n(subLayers = [@bad.usda@])\n")
        assert any("git lfs pull" in found["message"] for found in done.sidecar["warnings"])


def test_a_missing_stage_and_a_wrong_suffix(tmp_path: Path) -> None:
    for out, name in (("out.glb", "stage-missing"), ("out.obj", "output-suffix")):
        with refused(name):
            convert_stage(tmp_path / "no.usda", tmp_path / out, ConvertOptions())


def test_strict_refuses_warnings_and_writes_nothing(tmp_path: Path) -> None:
    with refused("strict", "units-missing"):
        convert_text(tmp_path, '#usda 1.0\ndef Cube "C" {\n}\n', strict=True)
    assert not (tmp_path / "out.glb").exists()
    convert_text(tmp_path, 'def Cube "C" {\n}\n', strict=True)


def folders(tmp_path: Path) -> Path:
    inside, outside = tmp_path / "in", tmp_path / "out"
    inside.mkdir()
    outside.mkdir()
    (outside / "part.usda").write_text(
        '#usda 1.0\n(\n defaultPrim = "P"\n)\ndef Sphere "P" {\n}\n', encoding="utf-8"
    )
    return inside


@pytest.mark.parametrize("absolute", [False, True])
@pytest.mark.parametrize("arc", ["references", "payload", "sublayer"])
def test_layers_outside_the_folder_are_left_out(tmp_path: Path, arc: str, absolute: bool) -> None:
    inside = folders(tmp_path)
    path = str(tmp_path / "out" / "part.usda") if absolute else "../out/part.usda"
    if arc == "sublayer":
        text = f'#usda 1.0\n(\n subLayers = [@{path}@]\n)\ndef Cube "C" {{\n}}\n'
        prim = "/P"
    else:
        text = f'#usda 1.0\ndef "X" (\n prepend {arc} = @{path}@\n) {{\n}}\ndef Cube "C" {{\n}}\n'
        prim = "/X"
    done = convert_text(inside, text)
    assert len(done.gltf.meshes) == 1
    expect_required(done, "asset-outside-roots", "/" if arc == "sublayer" else "/X")
    allowed = convert_text(inside, text, extra_roots=(tmp_path / "out",))
    assert "asset-outside-roots" not in allowed.warnings()
    assert allowed.gltf.nodes[allowed.node(prim)].mesh is not None


def test_a_link_does_not_lead_out(tmp_path: Path) -> None:
    inside = folders(tmp_path)
    (inside / "link.usda").symlink_to(tmp_path / "out" / "part.usda")
    text = '#usda 1.0\ndef "X" (\n prepend references = @link.usda@\n) {\n}\n'
    drawn = convert_text(inside, f'{text}def Cube "C" {{\n}}\n')
    assert "asset-outside-roots" in drawn.warnings()
    (message,) = [w.message for w in drawn.result.warnings if w.name == "asset-outside-roots"]
    assert message.endswith(f"allow it with --root {tmp_path / 'out'}")


@pytest.mark.parametrize("absolute", [False, True])
def test_an_empty_result_is_no_success_where_its_layers_are_outside(
    tmp_path: Path, absolute: bool
) -> None:
    inside = folders(tmp_path)
    path = str(tmp_path / "out" / "part.usda") if absolute else "../out/part.usda"
    text = f'#usda 1.0\ndef "X" (\n prepend references = @{path}@\n) {{\n}}\n'
    with refused("asset-outside-roots", f"--root {tmp_path / 'out'}"):
        convert_text(inside, text)
    assert not (inside / "out.glb").exists()
    assert convert_text(inside, text, extra_roots=(tmp_path / "out",)).json["meshes"]


def test_what_a_referenced_layer_must_not_read_is_named_where_it_is_used(tmp_path: Path) -> None:
    inside = folders(tmp_path)
    (inside / "middle.usda").write_text(
        '#usda 1.0\ndef "M" {\n def "N" (\n  variants = { string v = "a" }\n'
        '  variantSets = "v"\n ) {\n'
        '  variantSet "v" = { "a" (payload = @../out/part.usda@) {} }\n }\n}\n'
    )
    text = 'def "A" (references = @middle.usda@</M>) {\n}\ndef Cube "C" {\n}\n'
    expect_required(convert_text(inside, text), "asset-outside-roots", "/A/N")


def test_missing_and_cyclic_layers_are_named(tmp_path: Path) -> None:
    text = '#usda 1.0\ndef Cube "C" (\n prepend references = @gone.usda@\n) {\n}\n'
    assert "asset-unresolved" in convert_text(tmp_path, text).warnings()
    text = '#usda 1.0\n(\n defaultPrim = "C"\n)\n'
    text += 'def Cube "C" (\n prepend references = @./stage.usda@\n) {\n}\n'
    done = convert_text(tmp_path, text)
    assert {"composition-error", "asset-unresolved"} & done.warnings()
    assert done.json["meshes"]


VARIANTS = text_of("convert_stage/variants.usda")


def test_variants(tmp_path: Path) -> None:
    small = convert_text(tmp_path, VARIANTS)
    big = convert_text(tmp_path, VARIANTS, variants=(("/X", "shape", "ball"),))
    assert len(small.triangles(0)) == 12 < len(big.triangles(0))
    assert "variants-not-carried" in small.warnings("/X")
    for choice in (
        ("/Y", "shape", "ball"),
        ("/X", "size", "ball"),
        ("/X", "shape", "cone"),
    ):
        with refused("variant-unknown"):
            convert_text(tmp_path, VARIANTS, variants=(choice,))


PURPOSES = text_of("convert_stage/purposes.usda")


def test_purpose_and_visibility(tmp_path: Path) -> None:
    done = convert_text(tmp_path, PURPOSES)
    drawn = {n.extras["prim"] for n in done.gltf.nodes if n.mesh is not None}
    assert drawn == {"/X/B"}
    assert "purpose-skipped" in done.warnings("/X/A")
    assert "invisible-skipped" in done.warnings("/Hidden")
    assert done.result.ledger["Cube"] == {"carried": 1, "warned": 3}
    done = convert_text(tmp_path, PURPOSES, purpose=("proxy",))
    assert {n.extras["prim"] for n in done.gltf.nodes if n.mesh is not None} == {"/X/A"}


@pytest.mark.parametrize(
    ("metadata", "warning", "meters"),
    [
        ("", "units-missing", 0.01),
        ("metersPerUnit = 0", "units-invalid", 0.01),
        ("metersPerUnit = -1", "units-invalid", 0.01),
        ('metersPerUnit = 1\nupAxis = "X"', "up-axis-invalid", 1.0),
        ("metersPerUnit = 1\ntimeCodesPerSecond = 0", "time-rate-invalid", 1.0),
        ("metersPerUnit = 1\ntimeCodesPerSecond = -5", "time-rate-invalid", 1.0),
    ],
)
def test_odd_metadata(tmp_path: Path, metadata: str, warning: str, meters: float) -> None:
    text = f'#usda 1.0\n(\n{metadata}\n)\ndef Cube "C" {{\n'
    text += "double3 xformOp:translate.timeSamples = { 0: (0,0,0), 24: (1,0,0) }\n"
    text += 'uniform token[] xformOpOrder = ["xformOp:translate"]\n}\n'
    done = convert_text(tmp_path, text)
    assert warning in done.warnings("/")
    assert done.triangles(0).max() == pytest.approx(meters)
    assert done.world(1.0)[done.node("/C")][0, 3] == pytest.approx(meters)


def nested(depth: int, inner: str) -> str:
    inner = inner.replace("PLACE", "".join(f"/x{i}" for i in range(depth)))
    groups = "".join(f'def Xform "x{i}" {{\n' for i in range(depth))
    return groups + inner + "}\n" * depth


def test_256_levels_are_written(tmp_path: Path) -> None:
    done = convert_text(tmp_path, nested(254, 'def Cube "c" {\n}\n'))
    assert len(done.gltf.nodes) == 256


SHEARED = text_of("convert_stage/sheared.usda")
CHAIN = text_of("convert_stage/chain.usda")
SCATTERED = text_of("convert_stage/scattered.usda")


@pytest.mark.parametrize(
    ("depth", "inner"),
    [(255, 'def Cube "c" {\n}\n'), (254, SHEARED), (252, CHAIN), (253, SCATTERED)],
)
def test_deeper_nesting_is_refused(tmp_path: Path, depth: int, inner: str) -> None:
    convert_text(tmp_path, nested(depth - 1, inner))
    (tmp_path / "out.glb").unlink()
    with refused("too-deep") as caught:
        convert_text(tmp_path, nested(depth, inner))
    assert caught.value.path.startswith("/x0/x1/")
    assert not (tmp_path / "out.glb").exists()


@pytest.mark.parametrize("stage", SMALL, ids=lambda path: path.stem)
def test_every_small_stage_agrees_with_usd(stage: Path, tmp_path: Path) -> None:
    from reflet_usd.validate.validation import validate_file

    out = tmp_path / "out.glb"
    convert_stage(stage, out, ConvertOptions())
    validation = validate_file(out, stage, khronos=False)
    failed = [(c.check, c.prim, c.worst) for c in validation.checks if not c.passed]
    assert validation.passed, failed


def test_fallback_types_stand_in_for_unknown_ones(tmp_path: Path) -> None:
    head = text_of("convert_stage/fallback_types_stand_in_for_unknown_ones.usda")
    ball = 'def FancyBall "B" {\n    double radius = 3\n}\n'
    done = convert_text(tmp_path, head + ball).proven()
    assert done.warnings() == set()
    points = done.triangles(done.gltf.nodes[done.node("/B")].mesh).reshape(-1, 3)
    assert np.linalg.norm(points, axis=1) == pytest.approx(np.full(len(points), 3.0))
    alone = convert_text(tmp_path, ball)
    assert "schema-ignored" in alone.warnings("/B")


def test_value_clips_that_are_not_there_are_named(tmp_path: Path) -> None:
    clip = '#usda 1.0\nover "X" {\n  double3 xformOp:translate.timeSamples = { 0: (1, 0, 0) }\n}\n'
    (tmp_path / "clip.usda").write_text(clip, encoding="utf-8")
    text = text_of("convert_stage/value_clips_that_are_not_there_are_named.usda")
    done = convert_text(tmp_path, text)
    assert "clips-missing" in done.warnings("/X")
    (message,) = [w["message"] for w in done.sidecar["warnings"] if w["name"] == "clips-missing"]
    assert "1 of 2 layers" in message and "@./gone.usda@" in message
    (tmp_path / "gone.usda").write_text(clip, encoding="utf-8")
    assert "clips-missing" not in convert_text(tmp_path, text).warnings()


def test_templates_of_value_clips_are_looked_for(tmp_path: Path) -> None:
    text = text_of("convert_stage/templates_of_value_clips_are_looked_for.usda")
    assert "clips-missing" in convert_text(tmp_path, text).warnings("/X")
    gone = text.replace("./clip.#", "./no/folder/clip.#")
    assert "clips-missing" in convert_text(tmp_path, gone).warnings("/X")
    (tmp_path / "clip.1.usda").write_text('#usda 1.0\nover "X" {\n}\n', encoding="utf-8")
    assert "clips-missing" not in convert_text(tmp_path, text).warnings()


@pytest.mark.parametrize(
    "prim",
    [
        'def Points "P" {\n    float[] widths = [1, 1, 1]\n POINTS }',
        'def Mesh "P" {\n int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n'
        " POINTS }",
        'def BasisCurves "P" {\n uniform token type = "linear"\n int[] curveVertexCounts = [3]\n'
        " POINTS }",
    ],
)
def test_points_that_begin_without_a_value_are_drawn(tmp_path: Path, prim: str) -> None:
    points = (
        "point3f[] points.timeSamples = { 0: None, 1: None,"
        " 5: [(0,0,0), (1,0,0), (0,1,0)], 10: [(0,0,0), (1,0,0), (0,2,0)] }\n"
    )
    done = convert_text(tmp_path, prim.replace("POINTS", points)).proven()
    mesh = done.json["meshes"][0]
    positions = done.array(mesh["primitives"][0]["attributes"]["POSITION"])
    assert sorted(map(tuple, positions)) == [(0, 0, 0), (0, 1, 0), (1, 0, 0)]
    assert "mesh-empty" not in done.warnings()


def test_backslashes_separate_folders(tmp_path: Path) -> None:
    part = '#usda 1.0\n(\n defaultPrim = "P"\n)\ndef Sphere "P" {\n}\n'
    (tmp_path / "parts" / "deep").mkdir(parents=True)
    (tmp_path / "parts" / "deep" / "a.usda").write_text(part, encoding="utf-8")
    (tmp_path / "odd\\name.usda").write_text(part, encoding="utf-8")
    text = text_of("convert_stage/backslashes_separate_folders.usda")
    done = convert_text(tmp_path, text).proven()
    for prim in ("/X", "/Y"):
        assert done.gltf.nodes[done.node(prim)].mesh is not None
    assert done.warnings("/Z") == {"asset-unresolved"}
