"""Damaged sidecars are named and fail, and brackets in a path are no package."""

from __future__ import annotations

from pathlib import Path

import pytest
from convert_materials import noise, save, texture
from convert_materials import stage as material_stage
from convert_reading import convert_text
from reflet_usd import cli
from tampering import UNIT

TEXTURED = material_stage(
    "color3f inputs:diffuseColor.connect = </Mat/T.outputs:rgb>", texture("T", "t.png")
)


@pytest.mark.parametrize(
    "text",
    [
        "[",
        "[]",
        '{"warnings": [1]}',
        '{"warnings": [{"name": 1, "prim": "/"}]}',
        '{"warnings": [{"name": "a", "prim": "/", "deviation": "b"}]}',
        '{"info": []}',
        '{"info": {"frames": "x"}}',
        '{"info": {"frames": [1]}}',
        '{"info": {"frames": [NaN, 1]}}',
        '{"info": {"timeOrigin": "x"}}',
        '{"info": {"roots": [1]}}',
        '{"info": {"variants": [["/A"]]}}',
    ],
)
def test_a_damaged_sidecar_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str
) -> None:
    done = convert_text(tmp_path, UNIT)
    Path(f"{done.out}.json").write_text(text, encoding="utf-8")
    command = ["validate", str(done.out), "--against", str(tmp_path / "stage.usda")]
    assert cli.main([*command, "--no-khronos"]) == 3
    assert "is damaged" in capsys.readouterr().out


def test_brackets_in_a_folder_are_no_package(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "odd #[0] [x]"
    folder.mkdir()
    save(folder, "t.png", noise("RGB", (16, 16)))
    done = convert_text(folder, TEXTURED)
    command = ["validate", str(done.out), "--against", str(folder / "stage.usda")]
    assert cli.main([*command, "--no-khronos"]) == 0, capsys.readouterr().out
