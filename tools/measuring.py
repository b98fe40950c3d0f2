"""Functions that the measuring tools share: finding the program, running it, what that uses."""

import argparse
import dataclasses
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Mapping, Sequence

ROOT = pathlib.Path(__file__).resolve().parents[1]


def add_program(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--reflet",
        type=pathlib.Path,
        metavar="PROGRAM",
        help="run this program, instead of building what ships",
    )


def program_of(given: pathlib.Path | None) -> pathlib.Path:
    """The program of `--reflet`, else this checkout's, built now; exits where there is none."""
    if given is not None:
        if not given.is_file():
            sys.exit(f"--reflet: there is no program {given}")
        return given.resolve()
    built = subprocess.run(["cargo", "build", "--release", "--locked"], cwd=ROOT, check=False)
    if built.returncode != 0:
        sys.exit("the program does not build; see above")
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", "target"))
    return ROOT / target / "release" / "reflet"


def settings(*assignments: str) -> list[str]:
    """Options that assign values of a scene, each `KEY=VALUE`."""
    return [word for assignment in assignments for word in ("--set", assignment)]


def render(
    program: pathlib.Path,
    scene: pathlib.Path,
    picture: pathlib.Path,
    size: tuple[int, int],
    *options: str | pathlib.Path,
) -> pathlib.Path:
    """Renders a scene at a size in pixels; returns the picture's path."""
    shape = ["--size", f"{size[0]}x{size[1]}"]
    ran = used([program, "render", scene, "-o", picture, *shape, *options])
    if ran.code != 0:
        sys.exit(f"{scene} cannot be rendered:\n{ran.said}")
    return picture


@dataclasses.dataclass(frozen=True)
class Used:
    """Exit status of a command, its standard error, and its use of resources."""

    code: int
    said: str
    wall_s: float
    processor_s: float
    """Over all threads."""
    memory_mib: float
    """Most at a time."""


def used(
    command: Sequence[str | pathlib.Path],
    limit_s: float = 3600,
    environment: Mapping[str, str] | None = None,
) -> Used:
    """Runs a command with further variables, and ends it by SIGXCPU after so many seconds."""
    held = {**os.environ, **(environment or {})}
    started = time.monotonic()
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors, env=held)
        timer = threading.Timer(limit_s, lambda: os.kill(process.pid, signal.SIGXCPU))
        timer.daemon = True
        timer.start()
        _, status, usage = os.wait4(process.pid, 0)
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        said = errors.read().decode(errors="replace")
    took = usage.ru_utime + usage.ru_stime
    wall = time.monotonic() - started
    return Used(process.returncode, said, wall, took, usage.ru_maxrss / 1024)
