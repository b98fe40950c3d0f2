"""Owns the session of a real browser with the page that runs by itself (`tools/web.sh`)."""

import functools
import hashlib
import http.server
import json
import subprocess
import threading
import zipfile
from pathlib import Path

import pytest
from program import BINARY, ROOT
from session import session
from tables import read_rows

LACKS_A_TOOL = 3
MOST_FLIP = "0.003"
STEPS = (
    "told shown completed hinted saved changed played chosen orbited edited dragged dropped packed "
    "shared refused embedded measured quick lost lacking"
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


def pack(path: Path, name: str, content: bytes, length: int) -> None:
    """Write a pack of a scene and a file that is listed with this length."""
    files = {"scene.toml": b"version = 1\n", name: content}
    listed = [
        {"path": name, "bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}
        for name, content in files.items()
    ]
    listed[1]["bytes"] = length
    manifest = {"pack": 1, "scene": "scene.toml", "lenient": False, "files": listed}
    texts = dict.fromkeys(["reflet", "built_from"], "")
    lists: dict[str, list[str]] = {"assets": [], "set": [], "variant": []}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("pack.json", json.dumps(manifest | texts | lists))
        for name, content in files.items():
            file.writestr(name, content)


@pytest.mark.full("builds the renderer anew for WebAssembly, which takes minutes")
def test_a_browser_writes_a_scene_and_sees_it(address: str, tmp_path: Path) -> None:
    """A page tells mistakes at their lines, shows and saves as the program does, reads packs."""
    pack(tmp_path / "bad-climbing.zip", "../b", b"", 0)
    pack(tmp_path / "bad-large.zip", "b", b"", 600 << 20)
    pack(tmp_path / "bad-bomb.zip", "b", bytes(64 << 20), 10)
    done = session("web_session.mjs")(address, tmp_path)
    assert done.stdout.split() == STEPS.split(), done.stderr
    scene = ROOT / "scenes" / "mirrors.toml"
    for ending, more in {"png": [], "exr": ["--aov", "depth,ids"]}.items():
        saved, native = tmp_path / f"mirrors.{ending}", tmp_path / f"native.{ending}"
        command = [BINARY, "render", scene, "--size", "160x90", "--output", native, *more]
        subprocess.run(command, check=True, capture_output=True)
        compare = [BINARY, "compare", saved, native, "--max-flip", MOST_FLIP]
        compared = subprocess.run(compare, capture_output=True, text=True, check=False)
        assert compared.returncode == 0, compared.stdout
    for channel in (b"R\0", b"depth.Z\0", b"ids.instance\0"):
        assert channel in saved.read_bytes()
    frames = zipfile.ZipFile(tmp_path / "film.zip").namelist()
    kinds = ("depth.png", "png")
    assert frames == [f"mirrors.000{frame}.{kind}" for frame in (1, 2) for kind in kinds]
    bench = [BINARY, "bench", "-o"]
    again = [*bench, tmp_path / "report", "--samples", tmp_path / "samples.csv"]
    rails = [ROOT / "scenes/fail/03-rails.toml", "--sizes", "320x180", "--frames", "1"]
    own = [*bench, tmp_path / "own", *rails, "--parameter", "edge_px", "--values", "0.25"]
    for run in (again, [*own, "--methods", "hybrid,rt", "--counters"]):
        subprocess.run(run, check=True, capture_output=True)
    tables = (read_rows(tmp_path / name) for name in ("samples.csv", "own/samples.csv"))
    page, program = ({row["method"]: row for row in table} for table in tables)
    for method, counted in {"rt": "visited_nodes", "hybrid": "march_steps"}.items():
        assert page[method]["content"] == program[method]["content"]
        near = pytest.approx(float(program[method][counted]), rel=0.01)
        assert float(page[method][counted]) == near
    unpack = [BINARY, "unpack", tmp_path / "pack.zip", "--output", tmp_path / "unpacked"]
    subprocess.run(unpack, check=True, capture_output=True)
    names = {path.name for path in (tmp_path / "unpacked").rglob("*.*")}
    assert names >= {"mirrors.toml", "dot.png"}
