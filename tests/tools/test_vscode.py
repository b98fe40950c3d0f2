"""Owns the session of the real VS Code, in a browser, with the extension's built file."""

import json
import os
import re
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from program import BINARY, ROOT
from session import session
from texts import text_of

EXTENSION = ROOT / "tools" / "vscode"
CODE = ROOT / "target" / "tools" / "vscode"
SCENE = text_of("vscode/scene.toml")
BASE = text_of("vscode/base.toml")
STEPS = "opened marked explained mended completed renamed pictured rerendered"


def code_server(home: Path) -> list[str | Path]:
    """Command of code-server with folders of its own; skips the test where a part is missing."""
    if not (EXTENSION / "node_modules" / "esbuild").is_dir():
        pytest.skip("the extension's packages are not installed: cd tools/vscode && npm ci")
    if not (CODE / "node").exists():
        pytest.skip("code-server is not installed: tools/setup.sh --vscode")
    entry = CODE / "node_modules" / "code-server" / "out" / "node" / "entry.js"
    folders = ["--user-data-dir", home / "data", "--extensions-dir", home / "extensions"]
    return [CODE / "node", entry, "--config", home / "config.yaml", *folders]


@pytest.fixture
def short_folder() -> Iterator[Path]:
    """A folder whose path leaves room for Chromium's socket in it, of 108 bytes in all."""
    with tempfile.TemporaryDirectory(prefix="reflet-") as folder:
        yield Path(folder)


@pytest.mark.full("needs VS Code for a browser, 800 MB")
def test_vs_code_marks_mends_completes_renames_and_shows_a_scene(
    tmp_path: Path, short_folder: Path
) -> None:
    """The extension is installed from its file into a new VS Code and works on a project."""
    home, project = tmp_path / "home", tmp_path / "project"
    command = code_server(home)
    settings = {
        "reflet.path": str(BINARY),
        "reflet.pictureArguments": ["--size", "96x54"],
        "workbench.startupEditor": "none",
        "workbench.secondarySideBar.defaultVisibility": "hidden",
        "chat.disableAIFeatures": True,
    }
    for kind in ["Machine", "User"]:
        (home / "data" / kind).mkdir(parents=True)
        (home / "data" / kind / "settings.json").write_text(json.dumps(settings), encoding="utf-8")
    project.mkdir()
    for name, text in {"reflet.toml": "", "scene.toml": SCENE, "base.toml": BASE}.items():
        (project / name).write_text(text, encoding="utf-8")
    package = ["npm", "run", "--silent", "package", "--", "--out", tmp_path / "reflet.vsix"]
    subprocess.run(package, cwd=EXTENSION, check=True)
    # Folders of the user are neither read nor written, and no shop of extensions is asked.
    own = dict.fromkeys(["HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_RUNTIME_DIR"], str(home))
    environment = {**os.environ, **own, "TMPDIR": str(short_folder), "EXTENSIONS_GALLERY": "{}"}
    run = session("vscode_session.mjs", CODE / "node", environment)
    install = [*command, "--install-extension", tmp_path / "reflet.vsix"]
    subprocess.run(install, env=environment, check=True)
    serve = [*command, "--auth", "none", "--bind-addr", "127.0.0.1:0", "--disable-telemetry"]
    serve += ["--disable-update-check", "--disable-workspace-trust", "--disable-proxy"]
    said = (tmp_path / "code-server.log").open("w", encoding="utf-8")
    with (
        said,
        subprocess.Popen(
            serve, env=environment, stdout=subprocess.PIPE, stderr=said, text=True
        ) as served,
    ):
        try:
            assert served.stdout is not None
            address = next(filter(None, (re.search(r"http://\S+", line) for line in served.stdout)))
            done = run(address[0], project)
        finally:
            served.terminate()
        assert done.stdout.split() == STEPS.split(), done.stderr
    # Programs and folders of panes end with VS Code, whose process of extensions ends a bit later.
    until = time.monotonic() + 60
    while list(home.glob("reflet-*")):
        assert time.monotonic() < until, "a pane outlives VS Code"
        time.sleep(0.1)
