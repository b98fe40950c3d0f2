"""`reflet-usd --version` tells converters apart by their code, as the cache of Reflet needs."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import reflet_usd


def version(tools: Path) -> str:
    """Version of the package in the folder `tools`."""
    command = [sys.executable, "-m", "reflet_usd", "--version"]
    environment = {**os.environ, "PYTHONPATH": str(tools)}
    return subprocess.run(
        command, env=environment, cwd=tools, capture_output=True, text=True, check=True
    ).stdout


def test_another_code_is_another_version(tmp_path: Path) -> None:
    package = tmp_path / "reflet_usd"
    shutil.copytree(Path(reflet_usd.__file__).parent, package)
    first = version(tmp_path)
    assert re.search(r"^reflet-usd \S+ \(code [0-9a-f]{16}, usd-core ", first), first
    assert version(tmp_path) == first
    module = package / "convert" / "mesh.py"
    module.write_text(module.read_text(encoding="utf-8") + "# edited\n", encoding="utf-8")
    assert version(tmp_path) != first
