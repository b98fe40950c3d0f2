"""The inspection of stages: their content, and the messages of a conversion."""

import json
import os
from pathlib import Path

import pytest
from reflet_usd import cli
from texts import text_of


def inspect(stage: Path, capsys: pytest.CaptureFixture[str]) -> dict:
    """The JSON of one inspection."""
    assert cli.main(["inspect", str(stage), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_stage_is_summed_up(stages: Path, capsys: pytest.CaptureFixture[str]) -> None:
    summary = inspect(stages / "moving.usda", capsys)
    assert summary["up_axis"] == "Y"
    assert summary["meters_per_unit"] == 0.01
    assert (summary["start_code"], summary["end_code"]) == (1, 25)
    wanted = {"Camera": 1, "DistantLight": 1, "Mesh": 1, "SphereLight": 1, "Xform": 1}
    assert summary["types"] == wanted
    assert summary["layers"] == ["moving.usda"]
    assert summary["refusal"] == ""


def test_what_would_be_lost_is_named(stages: Path, capsys: pytest.CaptureFixture[str]) -> None:
    summary = inspect(stages / "gprims.usda", capsys)
    named = {(warning["prim"], warning["name"]) for warning in summary["warnings"]}
    assert ("/Set/Guide", "purpose-skipped") in named
    assert ("/Set/Hidden", "invisible-skipped") in named
    assert inspect(stages / "instances.usda", capsys)["instances"] == 2


def test_layers_assets_and_variants(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "part.usda").write_text('#usda 1.0\n(defaultPrim="P")\ndef Cube "P" {}\n')
    (tmp_path / "stage.usda").write_text(text_of("inspect/layers_assets_and_variants.usda"))
    summary = inspect(tmp_path / "stage.usda", capsys)
    assert summary["layers"] == ["stage.usda", "part.usda"]
    assert "gone.usda" in summary["missing_layers"]
    assert summary["variants"] == {"/A": {"color": ["red", "blue"]}}
    assert summary["meters_per_unit"] is None
    assert str(tmp_path) not in json.dumps(summary["layers"] + summary["missing_layers"])


def test_text_and_refusals(
    stages: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["inspect", str(stages / "quads.usda")]) == 0
    text = capsys.readouterr().out
    assert "up axis Z, unit 0.01 m, default prim World" in text
    assert text.rstrip().endswith("can be converted")
    broken = tmp_path / "broken.usda"
    broken.write_text("#usda 1.0\ndef {")
    assert cli.main(["inspect", str(broken)]) == 1
    assert "stage-unreadable" in capsys.readouterr().err


def test_inspect_waits_for_no_pipe(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    os.mkfifo(tmp_path / "pipe.usda")
    text = '#usda 1.0\ndef Cube "C" {}\ndef "R" (references = @pipe.usda@</X>) {}\n'
    (tmp_path / "stage.usda").write_text(text)
    words = ["inspect", str(tmp_path / "stage.usda"), "--json", "--time-limit", "60"]
    assert cli.main(words) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["missing_layers"] == ["pipe.usda"]
    assert ("/R", "asset-not-a-file") in {(w["prim"], w["name"]) for w in summary["warnings"]}
