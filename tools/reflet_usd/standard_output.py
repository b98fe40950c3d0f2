"""Owns printing a command's result: where standard output fails, that is a named error."""

import os
import sys

from reflet_usd.convert.types import ConvertError


def show(text: str, done: str = "") -> None:
    """Print a command's result.

    A closed pipe is no failure. Any other failure raises ConvertError `output-unwritable`, whose
    message begins with `done`, the work that was finished nevertheless.
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
    """Discard what is still buffered, else the interpreter fails on it at exit."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)
