"""Owns the check that the manual names every warning and error of the USD tools."""

import ast
import functools
import re
from pathlib import Path

from reflet_usd.validate import allowed_deviations, usd_rules

ROOT = Path(__file__).resolve().parent.parent.parent
SOURCES = sorted((ROOT / "tools" / "reflet_usd").rglob("*.py"))
# Strings that have the shape of a warning's name but name something else.
OTHERS = {"gltf-validator", "reflet-usd", "usd-core", "utf-8"}
# Warnings named by prim type: the manual's table has `<type>-dropped`.
BY_TYPE = {"Volume-dropped"}


@functools.cache
def names_in(path: Path) -> set[str]:
    """Strings that have the shape of a warning's name, and words in brackets at a message's end."""
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
    assert names >= {"usdz-ratio", "too-deep", "time-limit", "validator-crash", "memory-limit"}
    manual = (ROOT / "docs" / "usd.md").read_text(encoding="utf-8")
    assert sorted(name for name in names if f"`{name}`" not in manual) == []


def test_the_manual_invents_no_name() -> None:
    manual = (ROOT / "docs" / "usd.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"`([a-z]+(?:-[a-z]+)+)`", manual)) - OTHERS
    names = set().union(*map(names_in, SOURCES))
    assert sorted(listed - names) == []


VALIDATOR = ROOT / "tools" / "reflet_usd" / "validate"
# Modules of the validator that name warnings for inputs without a place in glTF.
LOSSES = ("usd_camera.py", "usd_curves.py", "usd_light.py", "usd_ops.py", "usd_truth.py")


def rows_of(table: str) -> list[set[str]]:
    """The names in backquotes of each row of one of the manual's tables, by its heading."""
    manual = (ROOT / "docs" / "usd.md").read_text(encoding="utf-8")
    body = manual.split(f"| {table} | warning |\n|---|---|\n")[1].split("\n\n")[0]
    return [set(re.findall(r"`([A-Za-z<>]+(?:-[a-z*]+)+)`", row)) for row in body.splitlines()]


def test_the_manual_lists_every_excuse_and_no_other() -> None:
    *rows, losses = rows_of("deviation")
    found = {
        *allowed_deviations.PLACED,
        *allowed_deviations.DISPLACED,
        *allowed_deviations.UV_SET,
        *allowed_deviations.UV_CONSTANT,
        *allowed_deviations.UNORDERED_COLORS,
    }
    found |= {
        *allowed_deviations.OTHER_SURFACE,
        *allowed_deviations.LEFT_OUT,
        *allowed_deviations.TRANSLUCENT,
        *allowed_deviations.UNLIT,
        *allowed_deviations.EXTRAS,
    }
    for kind in ("Mesh", "DomeLight", "PortalLight", "PluginLight", "NurbsCurves"):
        found |= {name.replace(kind, "<type>") for name in allowed_deviations.absent(kind)}
    assert set().union(*rows) == found
    cannot = {
        *allowed_deviations.NO_PLACE.values(),
        *allowed_deviations.MESH_LIGHT,
        *allowed_deviations.FROZEN_INPUT,
        *allowed_deviations.NO_TEXTURE,
        *allowed_deviations.NOT_READ,
    } - BY_TYPE
    assert losses == cannot.union(*(names_in(VALIDATOR / name) for name in LOSSES))


def test_the_manual_lists_every_rule_that_a_warning_chooses() -> None:
    textures = {
        *allowed_deviations.PACKED,
        *allowed_deviations.REWRITTEN,
        *allowed_deviations.LOST_FILE,
        *allowed_deviations.NORMAL_SCALE,
    }
    listed = set().union(*rows_of("rule"))
    assert listed == usd_rules.NAMES | textures | {"subdivision-cage"}


def test_no_other_part_of_the_validator_asks_for_a_warning() -> None:
    converter = (path for path in SOURCES if path.parent.name == "convert")
    warnings = set().union(*map(names_in, converter))
    told = {path.name: names_in(path) & warnings for path in VALIDATOR.glob("*.py")}
    homes = {
        "allowed_deviations.py",
        "usd_rules.py",
        *LOSSES,
        "__init__.py",
        "confined.py",
    }  # these two name errors
    assert {name: found for name, found in told.items() if found and name not in homes} == {
        "validation.py": {"subdivision-cage"}
    }
