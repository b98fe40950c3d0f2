"""Owns the check that the feature table names every warning and error of the converter."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
SOURCES = sorted((ROOT / "tools" / "reflet_usd" / "convert").glob("*.py"))


def test_every_name_is_in_the_feature_table() -> None:
    code = "".join(path.read_text(encoding="utf-8") for path in SOURCES)
    calls = r'(?:warn|skip_subtree|_warn|ConvertError)\(\s*"([a-z][a-z0-9-]+)"'
    names = set(re.findall(calls, code))
    assert len(names) > 80
    table = (ROOT / "docs" / "usd.md").read_text(encoding="utf-8")
    assert sorted(name for name in names if f"`{name}`" not in table) == []
