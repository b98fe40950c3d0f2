"""Damaged sidecars are named and fail, and brackets in a path are no package."""

from pathlib import Path

import pytest
from material_stages import noise, save, texture
from material_stages import stage as material_stage
from read_converted import convert_text
from reflet_usd.validate.validation_table import format_validation
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
def test_a_damaged_sidecar_is_named(tmp_path: Path, text: str) -> None:
    done = convert_text(tmp_path, UNIT)
    Path(f"{done.out}.json").write_text(text, encoding="utf-8")
    validation = done.validated()
    assert not validation.passed
    assert "is damaged" in format_validation(validation)


def test_brackets_in_a_folder_are_no_package(tmp_path: Path) -> None:
    folder = tmp_path / "odd #[0] [x]"
    folder.mkdir()
    save(folder, "t.png", noise("RGB", (16, 16)))
    convert_text(folder, TEXTURED).proven()
