"""The JSON Schema of `reflet schema`, judged by the validator of the package jsonschema.

It must refuse what the reader refuses and take what it takes, as far as a schema can tell.
"""

import copy
import datetime
import json
import math
import re
import subprocess

import pytest
from program import BINARY, ROOT

jsonschema = pytest.importorskip("jsonschema")
# Scene text is TOML 1.1, which the standard library's tomllib does not read.
tomli = pytest.importorskip("tomli")


# Bad scenes whose mistakes depend on other values, or whose values have no JSON form.
BEYOND_SCHEMA = {
    "empty-box",
    "missing-corner",
    "bad-matrix",
    "bad-set",
    "dangling-name",
    "duplicate-name",
    "empty-timeline",
    "key-order",
    "key-range",
    "no-handles",
    "no-keys",
    "script-file",
    "singular",
    "too-many-probes",
    "wrong-motion",
    "wrong-shadow",
    "wrong-source",
    "zero-direction",
}


@pytest.fixture(scope="module")
def schema():
    if not BINARY.is_file():
        pytest.skip(f"{BINARY} is missing: cargo build, or set REFLET")
    return json.loads(subprocess.run([BINARY, "schema"], capture_output=True, check=True).stdout)


@pytest.fixture(scope="module")
def validator(schema):
    return jsonschema.Draft202012Validator(schema)


def is_json(value):
    if isinstance(value, dict):
        return all(is_json(inner) for inner in value.values())
    if isinstance(value, list):
        return all(is_json(inner) for inner in value)
    if isinstance(value, float):
        return math.isfinite(value)
    return not isinstance(value, datetime.date | datetime.time)


def scene_of(path):
    """The scene as JSON; None for text that is no TOML, or has no JSON form (nan, dates)."""
    try:
        scene = tomli.loads(path.read_bytes().decode().replace("\r\n", "\n"))
    except (tomli.TOMLDecodeError, UnicodeDecodeError, RecursionError):
        return None
    return scene if is_json(scene) else None


def test_the_schema_is_one(schema):
    jsonschema.Draft202012Validator.check_schema(schema)


def test_the_schema_refuses_what_the_reader_refuses(validator):
    compared = 0
    for path in sorted((ROOT / "tests" / "bad_scenes").glob("*.toml")):
        scene = scene_of(path)
        if scene is None or path.read_bytes().startswith(b"# --set "):
            continue  # the overrides of `--set` are not in the text
        messages = path.with_suffix(".txt").read_text(encoding="utf-8")
        names = set(re.findall(r"^error\[([a-z-]+)\]", messages, re.MULTILINE))
        if names == {"missing-key"}:
            continue  # the key could stand in a base scene
        is_within = bool(names - BEYOND_SCHEMA)
        assert validator.is_valid(scene) != is_within, f"{path.name}: {names}"
        compared += 1
    assert compared >= 70, compared


def test_the_schema_takes_every_scene_of_the_project(validator):
    found = [*ROOT.glob("scenes/**/*.toml"), *ROOT.glob("scripts/*.toml")]
    paths = [path for path in found if path.name != "reflet.toml"]
    assert len(paths) >= 12
    for path in paths:
        errors = list(validator.iter_errors(scene_of(path)))
        assert not errors, f"{path}: {errors[0].message}"


EXAMPLE = ROOT / "src" / "scene" / "manual" / "example.toml"


@pytest.mark.parametrize(
    ("path", "value", "taken"),
    [
        (["version"], 2, False),
        (["camera", "main", "fov"], 60, False),
        (["camera", "main", "fov_deg"], 171, False),
        (["camera", "main", "eye"], [0, 1], False),
        (["camera", "main", "near_m"], 0, False),
        (["light", "lamp", "intensity_lux"], 1, False),
        (["light", "sun", "direction"], None, False),
        (["light", "lamp", "kind"], "lamp", False),
        (["model", "hall", "shape"], {"kind": "box"}, False),
        (["instance", 0, "matrix"], [1], False),
        (["environment", "color"], [0, 0, 0], False),
        (["reflection", "bounces"], 2.5, False),
        (["reflection", "bounces"], 2.0, True),
        (["instance", 0, "scale"], 2, True),
        (["instance", 0, "scale"], [2, 1, 1], True),
    ],
)
def test_one_change_of_the_example(validator, path, value, taken):
    scene = scene_of(EXAMPLE)
    assert validator.is_valid(scene)
    changed = copy.deepcopy(scene)
    table = changed
    for key in path[:-1]:
        table = table[key]
    table[path[-1]] = value
    assert validator.is_valid(changed) == taken


def defaults(schema):
    """Every part of the schema that has a default."""
    if isinstance(schema, dict):
        if "default" in schema:
            yield schema
        inner = schema.values()
    else:
        inner = schema if isinstance(schema, list) else []
    for part in inner:
        yield from defaults(part)


def test_defaults_are_values_that_the_schema_takes(schema):
    found = list(defaults(schema))
    assert len(found) >= 30
    for part in found:
        # References of the schema start from its root.
        own = {**part, "$defs": schema["$defs"]}
        jsonschema.Draft202012Validator(own).validate(part["default"])
