"""The command line's limits: signals, outputs that cannot be written, folders without stages."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from reflet_usd import child_processes, cli

ROOT = Path(__file__).resolve().parent.parent.parent
CUBE = '#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = "Y"\n)\ndef Cube "C"\n{\n}\n'


def slow_stage(folder: Path) -> Path:
    """A stage whose conversion takes long."""
    stage = folder / "slow.usda"
    cube = 'def Cube "c" {\n}\n'
    prims = "".join(f'def Xform "x{number}" {{\n{cube}}}\n' for number in range(20_000))
    stage.write_text(f"#usda 1.0\n{prims}")
    return stage


def children(pid: int) -> list[int]:
    """Process ids of the running children of `pid`."""
    found = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True)
    return [int(word) for word in found.stdout.split()]


def runs(pid: int) -> bool:
    """Whether the process exists and is not a zombie."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"


def signaled(words: list[str], out: Path, number: signal.Signals) -> tuple[int, str]:
    """Exit code and messages of a command, signaled once its child writes into `out`."""
    process = subprocess.Popen(
        [sys.executable, "-m", "reflet_usd", *words],
        env={**os.environ, "PYTHONPATH": str(ROOT / "tools")},
        stderr=subprocess.PIPE,
        text=True,
    )
    deadline = time.monotonic() + 60
    while not (list(out.glob(".reflet-usd-*/log.txt")) and children(process.pid)):
        assert time.monotonic() < deadline and process.poll() is None
        time.sleep(0.02)
    child = children(process.pid)[0]
    process.send_signal(number)
    _, shown = process.communicate(timeout=60)
    assert not runs(child)
    return process.returncode, shown


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="looks into /proc")
@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_a_signal_ends_the_child_and_leaves_nothing(
    tmp_path: Path, number: signal.Signals, code: int
) -> None:
    stage, out = slow_stage(tmp_path), tmp_path / "out"
    out.mkdir()
    words = ["convert", str(stage), "-o", str(out / "a.glb")]
    found, shown = signaled(words, out, number)
    assert found == code
    assert list(out.iterdir()) == []
    assert number.name in shown
    assert "Traceback" not in shown


class InterruptedLock:
    """The lock of `Popen.wait` at whose taking a signal handler raises, so that it stays held."""

    def __init__(self) -> None:
        self.lock = threading.Lock()

    def acquire(self, blocking: bool = True) -> bool:
        """Take the lock; raises SystemExit as soon as it is held."""
        if self.lock.acquire(blocking):
            raise SystemExit
        return False

    def __enter__(self) -> None:
        self.acquire()

    def __exit__(self, *_: object) -> None:
        self.lock.release()


def test_a_child_is_ended_after_a_signal_within_its_wait() -> None:
    child = subprocess.Popen(
        [sys.executable, "-c", "import time; time.sleep(600)"], start_new_session=True
    )
    child._waitpid_lock = InterruptedLock()  # type: ignore[attr-defined]
    with pytest.raises(SystemExit):
        child.wait(timeout=10)
    ending = threading.Thread(target=child_processes.end, args=[child], daemon=True)
    ending.start()
    ending.join(60)
    assert not ending.is_alive()
    assert not Path(f"/proc/{child.pid}").exists()


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="looks into /proc")
def test_a_signal_ends_the_stages_that_report_has_begun(tmp_path: Path, khronos: None) -> None:
    folder, kept, table = tmp_path / "corpus", tmp_path / "kept", tmp_path / "table.md"
    folder.mkdir()
    slow_stage(folder)
    words = ["report", str(folder), "-o", str(table), "--keep", str(kept)]
    code, shown = signaled(words, kept, signal.SIGTERM)
    assert code == 143
    assert list(kept.iterdir()) == []  # else a conversion did not stop
    assert not table.exists()
    assert "Traceback" not in shown


def test_the_handlers_of_the_caller_come_back(tmp_path: Path) -> None:
    before = signal.getsignal(signal.SIGTERM), signal.getsignal(signal.SIGINT)
    cli.main(["report", str(tmp_path)])
    assert (signal.getsignal(signal.SIGTERM), signal.getsignal(signal.SIGINT)) == before


@pytest.mark.parametrize("place", ["/proc/x.glb", "folder.glb"])
def test_an_output_that_cannot_be_written_is_named(
    tmp_path: Path, run_cli: Callable, place: str
) -> None:
    (tmp_path / "folder.glb").mkdir()
    stage = tmp_path / "stage.usda"
    stage.write_text(CUBE)
    assert "[output-unwritable]" in run_cli(1, "convert", stage, "-o", tmp_path / place).err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder.glb", "stage.usda"]


@pytest.mark.parametrize("option", ["-o", "--json"])
def test_report_looks_at_its_outputs_first(tmp_path: Path, run_cli: Callable, option: str) -> None:
    (tmp_path / "stage.usda").write_text(CUBE)
    for place, advice in ((tmp_path / "none" / "x.md", "make it first"), (tmp_path, "name a file")):
        assert advice in run_cli(2, "report", tmp_path, option, place).err


def test_report_says_what_a_folder_lacks(
    tmp_path: Path, run_cli: Callable, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "holds no USD stage" in run_cli(2, "report", tmp_path).err
    (tmp_path / "stage.usda").write_text(CUBE)
    assert "no stage matches 'nothing'" in run_cli(2, "report", tmp_path, "--only", "nothing").err
    with pytest.raises(SystemExit):
        cli.main(["report", str(tmp_path), "--only", "("])
    assert "no regular expression" in capsys.readouterr().err


def test_report_leaves_out_what_it_cannot_measure(
    tmp_path: Path, khronos: None, run_cli: Callable
) -> None:
    (tmp_path / "stage.usda").write_text(CUBE)
    shown = run_cli(0, "report", tmp_path).out
    assert "| converted, of those that open | 1/1 |" in shown
    assert "0/0" not in shown


def test_the_limits_of_convert_are_options(tmp_path: Path, run_cli: Callable) -> None:
    stage, out = slow_stage(tmp_path), tmp_path / "out.glb"
    said = run_cli(1, "convert", stage, "-o", out, "--cpu-limit", "1").err
    assert "more than 1 s of processor time" in said and "--cpu-limit" in said
    assert not out.exists()
    for wrong in ("0", "-1", "1.5", "²", "9999999999"):
        with pytest.raises(SystemExit) as caught:
            cli.main(["convert", str(stage), "-o", str(out), "--cpu-limit", wrong])
        assert caught.value.code == 2
