"""The inspection of stages: their content, and the messages of a conversion."""

import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest
from texts import text_of


@pytest.fixture
def inspect(run_cli: Callable) -> Callable:
    """The JSON of one inspection."""
    return lambda *words: json.loads(run_cli(0, "inspect", *words, "--json").out)


def test_a_stage_is_summed_up(stages: Path, inspect: Callable) -> None:
    summary = inspect(stages / "moving.usda")
    assert summary["up_axis"] == "Y"
    assert summary["meters_per_unit"] == 0.01
    assert (summary["start_code"], summary["end_code"]) == (1, 25)
    wanted = {"Camera": 1, "DistantLight": 1, "Mesh": 1, "SphereLight": 1, "Xform": 1}
    assert summary["types"] == wanted
    assert summary["layers"] == ["moving.usda"]
    assert summary["refusal"] == ""


def test_what_would_be_lost_is_named(stages: Path, inspect: Callable) -> None:
    summary = inspect(stages / "gprims.usda")
    named = {(warning["prim"], warning["name"]) for warning in summary["warnings"]}
    assert ("/Set/Guide", "purpose-skipped") in named
    assert ("/Set/Hidden", "invisible-skipped") in named
    assert inspect(stages / "instances.usda")["instances"] == 2


def test_layers_assets_and_variants(tmp_path: Path, inspect: Callable) -> None:
    (tmp_path / "part.usda").write_text('#usda 1.0\n(defaultPrim="P")\ndef Cube "P" {}\n')
    (tmp_path / "stage.usda").write_text(text_of("inspect/layers_assets_and_variants.usda"))
    summary = inspect(tmp_path / "stage.usda")
    assert summary["layers"] == ["stage.usda", "part.usda"]
    assert "gone.usda" in summary["missing_layers"]
    assert summary["variants"] == {"/A": {"color": ["red", "blue"]}}
    assert summary["meters_per_unit"] is None
    assert str(tmp_path) not in json.dumps(summary["layers"] + summary["missing_layers"])


def test_text_and_refusals(stages: Path, tmp_path: Path, run_cli: Callable) -> None:
    text = run_cli(0, "inspect", stages / "quads.usda").out
    assert "up axis Z, unit 0.01 m, default prim World" in text
    assert text.rstrip().endswith("can be converted")
    broken = tmp_path / "broken.usda"
    broken.write_text("#usda 1.0\ndef {")
    assert "stage-unreadable" in run_cli(1, "inspect", broken).err


def test_inspect_waits_for_no_pipe(tmp_path: Path, inspect: Callable) -> None:
    os.mkfifo(tmp_path / "pipe.usda")
    text = '#usda 1.0\ndef Cube "C" {}\ndef "R" (references = @pipe.usda@</X>) {}\n'
    (tmp_path / "stage.usda").write_text(text)
    summary = inspect(tmp_path / "stage.usda", "--time-limit", "60")
    assert summary["missing_layers"] == ["pipe.usda"]
    assert ("/R", "asset-not-a-file") in {(w["prim"], w["name"]) for w in summary["warnings"]}
