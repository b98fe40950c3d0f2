"""Owns the session of a real browser with the page that runs by itself (`tools/web.sh`)."""

import functools
import http.server
import subprocess
import threading
from pathlib import Path

import pytest
from program import BINARY, ROOT
from session import session

LACKS_A_TOOL = 3
MOST_FLIP = "0.003"
STEPS = (
    "told shown completed hinted saved changed played orbited dropped shared refused embedded "
    "quick lost lacking"
)


class Quiet(http.server.SimpleHTTPRequestHandler):
    """A server of files that logs nothing."""

    def log_message(self, *_: object) -> None:
        """Log nothing."""


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Address of the page, newly built."""
    folder = tmp_path_factory.mktemp("page")
    built = subprocess.run(
        [ROOT / "tools" / "web.sh", folder], capture_output=True, text=True, check=False
    )
    if built.returncode == LACKS_A_TOOL:
        pytest.skip(built.stderr.strip())
    assert built.returncode == 0, built.stderr
    handler = functools.partial(Quiet, directory=folder)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}/"


@pytest.mark.full("builds the renderer anew for WebAssembly, which takes minutes")
def test_a_browser_writes_a_scene_and_sees_it(address: str, tmp_path: Path) -> None:
    """A page tells mistakes at their lines, and shows what the program shows."""
    done = session("web_session.mjs")(address, tmp_path)
    assert done.stdout.split() == STEPS.split(), done.stderr
    native = tmp_path / "native.png"
    scene = ROOT / "scenes" / "mirrors.toml"
    command = [BINARY, "render", scene, "--size", "160x90", "--output", native]
    subprocess.run(command, check=True, capture_output=True)
    compare = [BINARY, "compare", tmp_path / "mirrors.png", native, "--max-flip", MOST_FLIP]
    compared = subprocess.run(compare, capture_output=True, text=True, check=False)
    assert compared.returncode == 0, compared.stdout
