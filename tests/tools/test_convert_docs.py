"""Owns the check that the manual names every warning and error of the USD tools."""

from __future__ import annotations

import ast
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
SOURCES = sorted((ROOT / "tools" / "reflet_usd").rglob("*.py"))
# Strings of the same shape that name something else.
OTHERS = {"gltf-validator", "reflet-usd", "utf-8"}
# Names by prim type: the manual's table has `<type>-dropped`.
BY_TYPE = {"Volume-dropped"}


def names_in(path: Path) -> set[str]:
    """All strings that have the shape of a name, and those in brackets at the end of a message."""
    found = set()
    for item in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(item, ast.Constant) and isinstance(item.value, str):
            found |= set(re.findall(r"\[([a-z]+(?:-[a-z]+)+)\]$", item.value))
            if re.fullmatch(r"[A-Za-z]+(-[a-z0-9]+)+", item.value):
                found.add(item.value)
    return found - OTHERS - BY_TYPE


def test_every_name_is_in_the_manual() -> None:
    names = set().union(*map(names_in, SOURCES))
    assert len(names) > 120
    assert names >= {"usdz-ratio", "too-deep", "validate-time", "validator-crash", "memory-limit"}
    manual = (ROOT / "docs" / "usd.md").read_text(encoding="utf-8")
    assert sorted(name for name in names if f"`{name}`" not in manual) == []


def test_the_manual_invents_no_name() -> None:
    manual = (ROOT / "docs" / "usd.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"`([a-z]+(?:-[a-z]+)+)`", manual)) - OTHERS
    names = set().union(*map(names_in, SOURCES))
    assert sorted(listed - names) == []
