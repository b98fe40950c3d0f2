"""Owns the program `reflet`: where it is, and running it so that it can be stopped."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

_POLL_S = 0.1
# How long a program that was asked to end may take, before it is killed.
_PATIENCE_S = 5.0


class ProgramError(Exception):
    """Why the program could not run or its message, in a sentence for its user."""


def find(named: str) -> str:
    """The path of the program: `named`, or `reflet` on the PATH where that is empty."""
    path = shutil.which(named or "reflet")
    if path is None:
        where = f"{named} is no program" if named else "there is no program reflet on the PATH"
        raise ProgramError(f"{where}; name it in the preferences of the add-on Reflet")
    return path


def run(command: Sequence[str], is_stopped: Callable[[], bool]) -> str | None:
    """Run a program to its end and return what it printed; None where it was stopped."""
    with tempfile.TemporaryFile() as said:
        try:
            process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=said, stderr=subprocess.STDOUT
            )
        except OSError as error:
            raise ProgramError(f"cannot run {command[0]}: {error.strerror}") from error
        try:
            while process.poll() is None:
                if is_stopped():
                    return None
                time.sleep(_POLL_S)
        finally:
            _end(process)
        said.seek(0)
        text = said.read().decode("utf-8", "replace")
    if process.returncode != 0:
        # The last lines matter: messages come before the exit.
        tail = "\n".join(text.strip().splitlines()[-12:])
        raise ProgramError(f"{Path(command[0]).name} failed ({process.returncode}):\n{tail}")
    return text


def _end(process: subprocess.Popen[bytes]) -> None:
    if process.poll() is not None:
        return
    process.terminate()
    try:
        process.wait(_PATIENCE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
