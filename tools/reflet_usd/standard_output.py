"""Owns what commands print as their result: where standard output fails, that is a named error."""

from __future__ import annotations

import os
import sys

from reflet_usd.convert.types import ConvertError


def show(text: str, done: str = "") -> None:
    """Print a command's result.

    A reader that has closed its end has seen enough. Any other failure raises ConvertError
    `output-unwritable`, which says first what was `done` all the same.
    """
    try:
        print(text, flush=True)
    except BrokenPipeError:
        _silence()
    except OSError as error:
        _silence()
        message = f"{done}standard output cannot be written: {error.strerror}"
        raise ConvertError("output-unwritable", message) from error


def _silence() -> None:
    """Send what is still buffered nowhere, else the interpreter fails on it when it ends."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)
