"""Owns the exceptions of Reflet, all of them `reflet.Error`, and the messages about a scene."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Diagnostic:
    """One message about a scene: its place, what is wrong and was expected, and what to do."""

    severity: str
    """`"error"` or `"warning"`."""
    name: str
    """Kind of the message, such as `unknown-key`; stable."""
    message: str
    """The mistake, in one sentence."""
    help: str | None = None
    """Advice, such as `did you mean "eye"?`."""
    file: Path | None = None
    """File that the message is about."""
    line: int | None = None
    """Line in the file, from 1; none for files without lines, such as models."""
    column: int | None = None
    """Character in the line, from 1."""


class Error(Exception):
    """Any error of Reflet; errors of the disk are `OSError`."""


class SceneError(Error):
    """Mistakes in a scene, its script or its files. `str` shows all with their lines.

    `file`, `line`, `column`, `message` and `help` belong to the first error.
    """

    def __init__(self, text: str, diagnostics: list[Diagnostic] | None = None) -> None:
        super().__init__(text, diagnostics or [])
        self.diagnostics: list[Diagnostic] = diagnostics or []
        """All errors, among the warnings before them."""
        errors = [message for message in self.diagnostics if message.severity == "error"]
        first = (errors or self.diagnostics or [Diagnostic("error", "", text)])[0]
        self.file: Path | None = first.file
        self.line: int | None = first.line
        self.column: int | None = first.column
        self.message: str = first.message
        self.help: str | None = first.help

    def __str__(self) -> str:
        return str(self.args[0])


class ArgumentError(Error, ValueError):
    """A value that a call cannot take: a shape, a range, a path that cannot be written."""


class UnknownNameError(Error, LookupError):
    """A camera, model, AOV or method that does not exist; the message lists the existing names."""

    def __str__(self) -> str:
        return str(self.args[0])


class FrameError(Error, IndexError):
    """A frame outside of the timeline, or a list of frames that cannot be read."""


class ClosedError(Error, ValueError):
    """A session that was closed."""


class ForkError(Error):
    """A process that was forked from one that used Reflet."""


class DeviceError(Error):
    """A lost device, exhausted memory, a limit of the adapter, or a shader that does not build."""


class NoAdapterError(DeviceError):
    """No usable graphics adapter; the message says what to install or to choose."""


class SceneWarning(UserWarning):
    """A scene that is rendered, but not all of it as it is written."""
