"""The corpus report: all converters are scored alike, and the table can be reproduced."""

import json
import shutil
from pathlib import Path

import pytest
from reflet_usd import cli
from reflet_usd.convert import ConvertOptions, convert_stage
from reflet_usd.corpus_scores import Root, Score, read_peers, read_roots, score_output, summary_rows
from reflet_usd.report_row import Row
from reflet_usd.report_table import format_markdown
from reflet_usd.validate.validation import validate_file
from texts import text_of

INDEX_HEAD = (
    "file\topens\tupAxis\tmetersPerUnit\tbox in metres, Y up, earliest time\tfeatures (count)"
)
PEERS_HEAD = (
    "file\tpeer\tconverted\tvalidator errors\tworld box (ok, units, axis, bad, none, -)"
    "\tmaterials got/expected\timages\tcameras got/expected\tlights got/expected (no dome)"
    "\tanimated nodes/expected stages"
)


@pytest.fixture
def folder(tmp_path: Path, stages: Path) -> Path:
    """A corpus of two seeds and one broken stage, with one rival."""
    place = tmp_path / "corpus"
    place.mkdir()
    for name in ("gprims.usda", "moving.usda"):
        shutil.copy(stages / name, place / name)
    (place / "broken.usda").write_text("#usda 1.0\ndef Cube {")
    (place / "INDEX.tsv").write_text(
        f"{INDEX_HEAD}\n"
        "gprims.usda\t1\tY\t1\t-6.5;-1.5;-4;6.5;5.5;6\tCube=2 Sphere=2\n"
        "moving.usda\t1\tY\t0.01\t0;0;0;0.04;0.01;0\tMesh=1 Camera=1 light=2 xformAnim=1\n"
        "broken.usda\t0\t\t\t\t\n"
    )
    (place / "PEERS.tsv").write_text(
        f"{PEERS_HEAD}\n"
        "gprims.usda\tRival 1.0\t1\t2\tunits\t0/0\t0\t0/0\t0/0\t0/0\n"
        "moving.usda\tRival 1.0\t1\t0\tok\t0/0\t0\t0/1\t1/2\t1/1\n"
        "broken.usda\tRival 1.0\t0\t\t-\t\t0\t\t\t\n"
    )
    return place


def rows_by_title(folder: Path) -> dict[str, str]:
    """The rival's cells by the title of the measure."""
    peers = read_peers(folder)
    return {title: cells["Rival 1.0"] for title, cells in summary_rows(read_roots(folder), peers)}


def test_a_rival_is_scored_from_its_rows(folder: Path) -> None:
    rows = rows_by_title(folder)
    assert rows["converted, of those that open"] == "2/2"
    assert rows["Khronos validator: 0 errors"] == "1/2"
    assert rows["broken files refused"] == "1/1"
    assert rows["world box right (meters, Y up; no skeletons)"] == "1/2"
    assert rows["cameras, all"] == "0/1"
    assert rows["lights, all but dome"] == "0/1"
    assert rows["transform animation present"] == "1/1"
    assert rows["box, validator, and all counts right"] == "0/2"


@pytest.mark.parametrize(
    ("box", "features", "state"),
    [
        ([0, 0, 0, 10, 10, 10], {}, "ok"),
        ([0, 0, 0.01, 10, 10, 10], {}, "ok"),
        ([0, 0, 0.1, 10, 10, 10], {}, "bad"),
        ([0, 0, 0.1, 10, 10, 10], {"Sphere": 1}, "ok"),
        ([0, 0, 1, 10, 10, 10], {"Sphere": 1}, "bad"),
        (None, {}, "none"),
    ],
)
def test_our_box_is_judged_by_the_rivals_tolerance(
    box: list[float] | None, features: dict[str, int], state: str
) -> None:
    root = Root("a.usda", True, [0, 0, 0, 10, 10, 10], features)
    assert score_output(root, {"box": box}, 0, None).box == state


def test_what_is_expected_of_us_is_what_is_expected_of_rivals() -> None:
    like = Score(True, 0, "ok", (1, 3), 0, (0, 2), (0, 0), (0, 1))
    facts = {"materials": 2, "cameras": 2, "animated_nodes": 5}
    score = score_output(Root("a", True, None, {}), facts, 0, like)
    assert (score.materials, score.cameras, score.animated) == ((2, 3), (2, 2), (5, 1))


def test_skeletons_count_where_they_have_keys(tmp_path: Path, stages: Path) -> None:
    rows = []
    still = 'def SkelAnimation "A" {\n    float3[] translations = [(0, 0, 0)]\n}\n'
    (tmp_path / "still.usda").write_text(f"#usda 1.0\n{still}")
    for stage in (stages / "skin.usda", tmp_path / "still.usda"):
        convert_stage(stage, tmp_path / "out.glb", ConvertOptions())
        validation = validate_file(tmp_path / "out.glb", stage, khronos=False)
        rows.append(Row(Root(stage.name, True, None, {}), True, validation=validation.to_json()))
    like = Score(True, 0, "-", (0, 0), 0, (0, 0), (0, 0), (0, 0))
    peers = {"Rival": {row.root.file: like for row in rows}}
    line = "| joints or weights animated, of those with keys | 1/1 | at most 0/1 |"
    assert line in format_markdown(rows, peers, "0")


def test_without_an_index_every_stage_is_a_root(tmp_path: Path, stages: Path) -> None:
    names = [root.file for root in read_roots(stages)]
    assert names == sorted(str(path.relative_to(stages)) for path in stages.rglob("*.usd?"))
    assert read_peers(stages) == {}


def test_wrong_folders_are_usage_errors(tmp_path: Path) -> None:
    assert cli.main(["report", str(tmp_path / "none")]) == 2
    assert cli.main(["report", str(tmp_path)]) == 2


def test_the_table_is_right_and_repeatable(folder: Path, tmp_path: Path, khronos: None) -> None:
    texts = []
    for run in ("one", "two"):
        table, details = tmp_path / f"{run}.md", tmp_path / f"{run}.json"
        code = cli.main(["report", str(folder), "-o", str(table), "--json", str(details)])
        assert code == 0, table.read_text()
        texts.append(table.read_text())
    assert texts[0] == texts[1]
    assert str(tmp_path) not in texts[0]
    assert "| broken files refused | 1/1 | 1/1 |" in texts[0]
    assert "| cameras, all | 1/1 | 0/1 |" in texts[0]
    assert "| lights, all but dome | 1/1 | 0/1 |" in texts[0]
    assert "no: `stage-unreadable` (broken on purpose)" in texts[0]
    rows = {row["file"]: row for row in json.loads(details.read_text())}
    assert rows["moving.usda"]["passed"]
    assert rows["moving.usda"]["proof"]["khronos"]["errors"] == 0


def test_a_stage_alone_is_refused_what_lies_beside_its_folder(
    tmp_path: Path, stages: Path, khronos: None
) -> None:
    """With `--alone`, layers beside the stage's folder are refused, as by `convert`."""
    folder = tmp_path / "corpus"
    (folder / "shot").mkdir(parents=True)
    shutil.copy(stages / "gprims.usda", folder / "gprims.usda")
    reference = '#usda 1.0\ndef Xform "A" (references = @../gprims.usda@</Set>) {}\n'
    (folder / "shot" / "shot.usda").write_text(reference)
    found = []
    for more in ([], ["--alone"]):
        details = tmp_path / "details.json"
        command = ["report", str(folder), "--only", "shot", *more, "--json", str(details)]
        cli.main([*command, "-o", str(tmp_path / "table.md")])
        [row] = json.loads(details.read_text())
        found.append((row["converted"], row["reason"]))
    assert found == [(True, ""), (False, "asset-outside-roots")]


LOSSES = text_of("report/losses.usda")


def test_silent_losses_of_lights_cameras_and_materials_count(tmp_path: Path) -> None:
    """Undeclared losses count: files with and without warnings, and with another material."""
    rows = []
    for name in ("told", "silent", "painted"):
        stage, out = tmp_path / f"{name}.usda", tmp_path / f"{name}.glb"
        stage.write_text(LOSSES)
        convert_stage(stage, out, ConvertOptions())
        sidecar = tmp_path / f"{name}.glb.json"
        content = json.loads(sidecar.read_text())
        warnings = content["warnings"]
        if name == "silent":
            sidecar.write_text(json.dumps({**content, "warnings": []}))
        elif name == "painted":
            stage.write_text(LOSSES.replace("(1, 0, 0)", "(0, 0, 1)"))
        validation = validate_file(out, stage, khronos=False).to_json()
        root = Root(f"{name}.usda", True, None, {})
        rows.append(Row(root, True, validation=validation, warnings=warnings))
    text = format_markdown(rows, {}, "test")
    assert "| with a silent deviation | 2 |" in text
    assert "| with declared losses (named warnings) | 3 |" in text
    cells = {
        line.split("|")[1].strip(): line.split("|")[5].strip()
        for line in text.splitlines()
        if line.startswith(("| told", "| silent.", "| painted"))
    }
    assert cells == {"told.usda": "", "silent.usda": "inputs", "painted.usda": "materials"}


SAMPLE = "simple-skin-test|pi_nested|UsdTransform2dTest|UnitsMilli|AnimatedCube|no-primname"


def test_a_sample_of_the_corpus(corpus: Path, tmp_path: Path, khronos: None) -> None:
    details = tmp_path / "report.json"
    table = tmp_path / "report.md"
    options = ["--only", SAMPLE, "-o", str(table), "--json", str(details)]
    assert cli.main(["report", str(corpus), *options]) == 0, table.read_text()
    assert len(json.loads(details.read_text())) >= 5


@pytest.mark.full("converts the whole corpus, of which a sample is converted daily")
def test_the_whole_corpus(corpus: Path, tmp_path: Path, khronos: None) -> None:
    details = tmp_path / "report.json"
    cli.main(["report", str(corpus), "-o", str(tmp_path / "report.md"), "--json", str(details)])
    rows = json.loads(details.read_text())
    wrong = [row["file"] for row in rows if not row["passed"]]
    assert wrong == []
    invalid = [row["file"] for row in rows if row["proof"] and row["proof"]["khronos"]["errors"]]
    assert invalid == []
