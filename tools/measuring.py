"""Functions that the measuring tools share: finding the program, rendering by it."""

import argparse
import os
import pathlib
import subprocess
import sys

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
    command: list[str | pathlib.Path] = [program, "render", scene, "-o", picture]
    command += ["--size", f"{size[0]}x{size[1]}", *options]
    subprocess.run(command, cwd=ROOT, check=True, stderr=subprocess.DEVNULL)
    return picture
