"""Owns the session of a real browser with the page of `reflet preview --serve`."""

import shutil
import subprocess
from pathlib import Path

import pytest
from program import BINARY, ROOT
from texts import text_of

PLAYWRIGHT = ROOT / "tools" / "node_modules" / "playwright-core" / "index.mjs"
SCENE = text_of("page/scene.toml")
SCRIPT = 'fn frame(ctx) { ctx.place("ball", [0.1 * ctx.frame, ctx.params.height, 0]); }\n'
STEPS = [
    "opened",
    "orbited",
    "scrubbed",
    "written",
    "selected",
    "changed",
    "dragged",
    "taken",
    "keyed",
    "downloaded",
    "shared",
    "broken",
    "mended",
    "refused",
]


def test_a_browser_opens_changes_and_mends_a_scene(tmp_path: Path) -> None:
    """A viewer orbits, scrubs, changes a parameter, selects, wipes, breaks and mends."""
    browser, node = shutil.which("chromium"), shutil.which("node")
    if browser is None or node is None or not PLAYWRIGHT.is_file():
        pytest.skip("Chromium, Node.js or playwright-core is not installed")
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE, encoding="utf-8")
    (tmp_path / "move.rhai").write_text(SCRIPT, encoding="utf-8")
    command = [BINARY, "preview", scene, "--serve", "--size", "96x54"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as preview:
        try:
            assert preview.stdout is not None
            address = preview.stdout.readline().strip()
            session = ROOT / "tests" / "tools" / "page_session.mjs"
            done = subprocess.run(
                [node, session, browser, address, scene, PLAYWRIGHT],
                capture_output=True,
                text=True,
                check=False,
            )
        finally:
            preview.terminate()
        assert done.stdout.split() == STEPS, done.stderr
    assert preview.returncode == 0
