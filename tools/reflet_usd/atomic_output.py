"""Owns moving a finished conversion to its place: all of its files or none."""

import contextlib
import os
from pathlib import Path

from .convert.types import ConvertError


def move_output(produced: Path, out: Path, stage: Path, most_bytes: int) -> None:
    """Move what a confined child wrote in `produced` to its place, the main file last.

    Raises ConvertError with `output-limit`, `output-unwritable` or `converter-internal`.
    """
    if tree_bytes(produced) > most_bytes:
        message = f"the output grew past {most_bytes} bytes"
        raise ConvertError("output-limit", message, str(stage))
    files = [path for path in sorted(produced.rglob("*")) if not path.is_dir()]
    if produced / out.name not in files or any(path.is_symlink() for path in files):
        raise ConvertError("converter-internal", f"the conversion wrote no {out.name}", str(stage))
    files.sort(key=lambda path: path == produced / out.name)
    places = [(path, out.parent / path.relative_to(produced)) for path in files]
    for _, place in places:
        if place.is_dir():
            message = f"{place} is a folder; remove it, or name another output"
            raise ConvertError("output-unwritable", message, str(stage))
    _replace_all(places, produced.parent / "before", stage)


def _replace_all(places: list[tuple[Path, Path]], before: Path, stage: Path) -> None:
    """Move all files to their places or none: replaced files wait in `before` until then."""
    before.mkdir()
    kept: list[tuple[Path, Path]] = []
    moved: list[Path] = []
    place = before
    try:
        for number, (path, place) in enumerate(places):
            place.parent.mkdir(parents=True, exist_ok=True)
            if os.path.lexists(place):
                os.replace(place, before / str(number))
                kept.append((before / str(number), place))
            os.replace(path, place)
            moved.append(place)
    except BaseException as error:  # a signal too
        for path in moved:
            path.unlink()
        for path, former in kept:
            os.replace(path, former)
        if not isinstance(error, OSError):
            raise
        message = f"{place} cannot be written: {error.strerror}"
        raise ConvertError("output-unwritable", message, str(stage)) from error


def tree_bytes(folder: Path) -> int:
    """Total bytes of all files below a folder."""
    total = 0
    for root, _, names in os.walk(folder):
        for name in names:
            # A file may be removed while its folder is listed.
            with contextlib.suppress(OSError):
                total += os.lstat(os.path.join(root, name)).st_size
    return total
