"""Owns the session of a real browser with the page of `reflet preview --serve`."""

import subprocess
from pathlib import Path

from program import BINARY
from session import session
from texts import text_of

SCENE = text_of("page/scene.toml")
SCRIPT = 'fn frame(ctx) { ctx.place("ball", [0.1 * ctx.frame, ctx.params.height, 0]); }\n'
STEPS = (
    "opened orbited scrubbed written selected changed dragged taken keyed downloaded shared "
    "broken mended refused"
)


def test_a_browser_opens_changes_and_mends_a_scene(tmp_path: Path) -> None:
    """A viewer orbits, scrubs, changes a parameter, selects, wipes, breaks and mends."""
    run = session("page_session.mjs")
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE, encoding="utf-8")
    (tmp_path / "move.rhai").write_text(SCRIPT, encoding="utf-8")
    command = [BINARY, "preview", scene, "--serve", "--size", "96x54"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as preview:
        try:
            assert preview.stdout is not None
            address = preview.stdout.readline().strip()
            done = run(address, scene)
        finally:
            preview.terminate()
        assert done.stdout.split() == STEPS.split(), done.stderr
    assert preview.returncode == 0
