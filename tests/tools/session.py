"""Sessions of real browsers, scripts of Node.js."""

import os
import shutil
import subprocess
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest
from program import ROOT

PLAYWRIGHT = ROOT / "tools" / "node_modules" / "playwright-core" / "index.mjs"
Run = Callable[[str, Path], subprocess.CompletedProcess[str]]


def session(script: str, node: str | Path = "node", env: Mapping[str, str] = os.environ) -> Run:
    """A session of an address with a file or folder; skips the test where a program is missing."""
    browser = shutil.which("chromium")
    if browser is None or shutil.which(node) is None or not PLAYWRIGHT.is_file():
        pytest.skip("Chromium, Node.js or playwright-core is not installed")
    path = ROOT / "tests" / "tools" / script

    def run(address: str, place: Path) -> subprocess.CompletedProcess[str]:
        command = [node, path, browser, address, place, PLAYWRIGHT]
        return subprocess.run(command, env=env, capture_output=True, text=True, check=False)

    return run
