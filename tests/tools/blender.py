"""Owns sessions of Blender as a module, which run scripts of this folder."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from program import BINARY, ROOT

BPY = Path(os.environ.get("REFLET_BPY", ROOT / ".venv-bpy" / "bin" / "python"))

needed = pytest.mark.skipif(
    not BPY.exists(),
    reason="needs Blender as a module, 400 MB: `tools/check.sh --full` installs it",
)


def run(script: str, folder: Path) -> Path:
    """Run a session, which finds the program; returns the folder of its files."""
    path = f"{BINARY.parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        [BPY, ROOT / "tests" / "tools" / script, folder],
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr + done.stdout
    return folder
