"""Owns the files of a project: writes only what changed, removes only what it wrote itself."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from pathlib import Path

from .report import Report

# Files that earlier exports wrote, with the SHA-256 of their content.
LEDGER = "export.json"


class ExportError(Exception):
    """Why a scene cannot be exported, in a sentence for its maker."""


class Folder:
    """A project's folder during one export."""

    def __init__(self, root: Path, report: Report) -> None:
        self.root = root
        self._report = report
        self._files: dict[str, str] = {}
        if root.exists() and not root.is_dir():
            raise ExportError(f"{root} is a file; name a folder")
        try:
            root.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise ExportError(f"cannot make the folder {root}: {error.strerror}") from error
        self._before = self._read_ledger()

    def _read_ledger(self) -> dict[str, str]:
        place = self.root / LEDGER
        if not place.exists():
            return {}
        try:
            files = json.loads(place.read_text(encoding="utf-8"))["files"]
            return {str(name): str(digest) for name, digest in files.items()}
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
            raise ExportError(
                f"{place} is not what an export writes; remove it, or export to another folder"
            ) from error

    def put(self, name: str, content: bytes) -> None:
        """Write a file of the export; one that already has this content is not touched."""
        place = self.root / name
        digest = hashlib.sha256(content).hexdigest()
        if _holds(place, content):
            self._files[name] = digest
            self._report.kept.append(name)
            return
        if place.exists() and name not in self._before:
            raise ExportError(f"{place} was not written by an export; move it or rename it")
        self._write(place, content)
        self._files[name] = digest
        self._report.written.append(name)

    def offer(self, name: str, content: bytes) -> None:
        """Write a file that belongs to its reader from then on: only where there is none."""
        place = self.root / name
        if not place.exists():
            self._write(place, content)
            self._report.written.append(name)

    def finish(self) -> None:
        """Remove files of earlier exports that this one has no more, and write the ledger."""
        for name, digest in self._before.items():
            place = self.root / name
            inside = place.resolve().is_relative_to(self.root.resolve())
            if name in self._files or not inside or not place.is_file():
                continue
            # A file that someone has changed since is theirs.
            if hashlib.sha256(place.read_bytes()).hexdigest() == digest:
                place.unlink()
                self._report.removed.append(name)
        self._write_ledger(self._files)

    def stop(self) -> None:
        """Note the files of an export that ends early, so that the next one knows them."""
        if self._files:
            self._write_ledger({**self._before, **self._files})

    def _write_ledger(self, files: dict[str, str]) -> None:
        ledger = {"files": dict(sorted(files.items()))}
        content = (json.dumps(ledger, indent=1) + "\n").encode()
        if not _holds(self.root / LEDGER, content):
            self._write(self.root / LEDGER, content)

    def _write(self, place: Path, content: bytes) -> None:
        """Write all or nothing: a reader never sees a part of a file."""
        try:
            place.parent.mkdir(parents=True, exist_ok=True)
            handle, name = tempfile.mkstemp(dir=place.parent, prefix=".reflet-", suffix=".tmp")
            try:
                with os.fdopen(handle, "wb") as file:
                    file.write(content)
                os.chmod(name, 0o644)
                os.replace(name, place)
            except BaseException:
                Path(name).unlink(missing_ok=True)
                raise
        except OSError as error:
            raise ExportError(f"cannot write {place}: {error.strerror}") from error


def _holds(place: Path, content: bytes) -> bool:
    try:
        return place.stat().st_size == len(content) and place.read_bytes() == content
    except OSError:
        return False
