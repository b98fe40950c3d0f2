"""Owns the tests of stages in `texts/named.toml`, whose losses have to be named."""

from pathlib import Path
from typing import Any

import pytest
import tomllib
from read_converted import convert_text
from texts import text_of

CASES = tomllib.loads(text_of("named.toml"))["case"]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_a_loss_is_named(tmp_path: Path, case: dict[str, Any]) -> None:
    done = convert_text(tmp_path, case["stage"])
    for prim, names in case.get("warns", {}).items():
        assert set(names) <= done.warnings(prim)
    for prim, names in case.get("exactly", {}).items():
        assert done.warnings(prim) == set(names)
    assert not done.warnings() & set(case.get("never", ()))
    for name, part in case.get("says", {}).items():
        (message,) = [w["message"] for w in done.sidecar["warnings"] if w["name"] == name]
        assert part in message
    if "draws" in case:
        fine = "/Fine" in case["stage"] or 'Cube "Fine"' in case["stage"]
        drawn = done.gltf.nodes[done.node("/Fine")].mesh is not None if fine else done.gltf.meshes
        assert bool(drawn) == case["draws"]
    assert not case.get("proven") or done.validated().passed
