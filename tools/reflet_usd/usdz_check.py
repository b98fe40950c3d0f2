"""Owns the checks of a .usdz package that run before USD opens it.

A usdz package is a zip archive of stored (never compressed) files whose first entry is the
root layer (https://openusd.org/release/spec_usdz.html). USD cannot read packages that break
these rules; packages that abuse the zip format are refused here with a named error.
"""

import dataclasses
import io
import re
import struct
import zipfile
from pathlib import Path
from typing import BinaryIO

from reflet_usd.convert.types import ConvertError
from reflet_usd.stand_in import stand_in

# A local file header: signature, flags, method, two sizes, lengths of name and extra field.
_HEADER = struct.Struct("<4s2xHH8xIIHH")
_SIGNATURE = b"PK\3\4"
LAYER_SUFFIXES = (".usd", ".usda", ".usdc")


@dataclasses.dataclass(frozen=True)
class PackageLimits:
    """Limits of a package's content, counted over nested packages too."""

    entries: int = 4096
    unpacked_bytes: int = 4 << 30
    ratio: float = 20.0
    """Unpacked size over stored size of one entry; 1 for the stored entries that usdz asks for."""
    depth: int = 4
    """Maximum depth of packages nested in one another."""


def check_package(path: Path, limits: PackageLimits | None = None) -> None:
    """Raise a ConvertError where the package at `path` is broken or abuses the zip format."""
    try:
        with path.open("rb") as stream:
            _check_stream(stream, path.name, path.stat().st_size, limits or PackageLimits(), 1)
    except ConvertError as error:
        raise ConvertError(error.name, error.message, str(path)) from error
    except OSError as error:
        raise ConvertError("usdz-broken", f"cannot be read: {error.strerror}", str(path)) from error


def check_referenced(path: str) -> None:
    """Check a package that a stage names, as `check_package` does; other files pass."""
    if path.lower().endswith(".usdz"):
        check_package(Path(path))


def _check_stream(
    stream: BinaryIO, label: str, size: int, limits: PackageLimits, depth: int
) -> None:
    if depth > limits.depth:
        raise ConvertError("usdz-nested", f"{label}: packages nest deeper than {limits.depth}")
    try:
        archive = zipfile.ZipFile(stream)
    except (zipfile.BadZipFile, ValueError, OverflowError, NotImplementedError) as error:
        stream.seek(0)
        found = (
            stand_in(stream.read(64)) or f"not a readable zip archive ({error}); export it again"
        )
        raise ConvertError("usdz-broken", f"{label} is {found}") from error
    with archive:
        entries = archive.infolist()
        _check_counts(entries, label, size, limits)
        for entry in entries:
            _check_entry(entry, label, limits)
        _check_root(entries, label)
        _check_headers(stream, entries, label)
        for entry in entries:
            # USD maps nested packages from the file, so it never unpacks a compressed one.
            stored = entry.compress_type == zipfile.ZIP_STORED
            if stored and entry.filename.lower().endswith(".usdz"):
                inner = _read_entry(archive, entry, label)
                where = f"{label}[{entry.filename}]"
                _check_stream(io.BytesIO(inner), where, len(inner), limits, depth + 1)


def _check_counts(
    entries: list[zipfile.ZipInfo], label: str, size: int, limits: PackageLimits
) -> None:
    if not entries:
        raise ConvertError("usdz-empty", f"{label} holds no file; the first must be a USD layer")
    if len(entries) > limits.entries:
        raise ConvertError(
            "usdz-entries", f"{label} holds {len(entries)} files, more than {limits.entries}"
        )
    unpacked = sum(entry.file_size for entry in entries)
    if unpacked > limits.unpacked_bytes:
        raise ConvertError(
            "usdz-size", f"{label} unpacks to {unpacked} bytes, more than {limits.unpacked_bytes}"
        )
    stored = sum(entry.compress_size for entry in entries)
    if stored > size:
        raise ConvertError(
            "usdz-overlap", f"{label}: its entries claim {stored} bytes in a file of {size}"
        )


def _check_entry(entry: zipfile.ZipInfo, label: str, limits: PackageLimits) -> None:
    name = entry.filename
    where = f"{label}[{name!r}]"
    parts = re.split(r"[/\\]", name)
    if name.startswith(("/", "\\")) or ".." in parts or re.match(r"^[A-Za-z]:", name):
        raise ConvertError("usdz-path", f"{where}: the entry's path leaves the package")
    if "\0" in name or "\0" in getattr(entry, "orig_filename", ""):
        raise ConvertError("usdz-path", f"{where}: the entry's path holds a zero byte")
    if entry.flag_bits & 0x1:
        raise ConvertError("usdz-encrypted", f"{where} is encrypted; usdz knows no encryption")
    if entry.file_size > limits.ratio * max(entry.compress_size, 1):
        raise ConvertError(
            "usdz-ratio",
            f"{where} unpacks {entry.compress_size} bytes to {entry.file_size}"
            f" (more than {limits.ratio:g} times)",
        )


def _check_headers(stream: BinaryIO, entries: list[zipfile.ZipInfo], label: str) -> None:
    """Compare the header before each file, which USD reads, with the zip directory."""
    listed = {entry.header_offset for entry in entries}
    for entry in entries:
        where = f"{label}[{entry.filename!r}]"
        stream.seek(entry.header_offset)
        header = stream.read(_HEADER.size)
        if len(header) < _HEADER.size or header[:4] != _SIGNATURE:
            raise ConvertError("usdz-broken", f"{where}: there is no file where it should be")
        _, flags, method, packed, size, name_size, extra_size = _HEADER.unpack(header)
        name = stream.read(name_size).decode("utf-8" if flags & 0x800 else "cp437", "replace")
        sizes = (entry.compress_size, entry.file_size)
        streamed = bool(flags & 0x8)  # sizes follow the data, and USD takes them as 0
        if (
            name != entry.orig_filename
            or method != entry.compress_type
            or not (streamed or (packed, size) == sizes)
        ):
            message = f"{where}: the file's own header says otherwise ({name!r}, {size} bytes)"
            raise ConvertError("usdz-broken", f"{message} than the directory")
        end = entry.header_offset + _HEADER.size + name_size + extra_size + entry.compress_size
        stream.seek(end)
        if stream.read(4) == _SIGNATURE and end not in listed:
            message = f"{where}: a file follows that the directory does not list"
            raise ConvertError("usdz-broken", message)


def _check_root(entries: list[zipfile.ZipInfo], label: str) -> None:
    first = entries[0].filename
    if not first.lower().endswith((*LAYER_SUFFIXES, ".usdz")):
        raise ConvertError(
            "usdz-root", f"{label}: its first file is {first!r}, expected a .usd, .usda or .usdc"
        )
    if entries[0].compress_type != zipfile.ZIP_STORED:
        raise ConvertError(
            "usdz-compressed",
            f"{label}[{first!r}] is compressed; usdz stores its files as they are:"
            " pack it with usdzip",
        )


def _read_entry(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, label: str) -> bytes:
    try:
        return archive.read(entry)
    except (zipfile.BadZipFile, EOFError, OSError, ValueError, NotImplementedError) as error:
        raise ConvertError("usdz-broken", f"{label}[{entry.filename!r}]: {error}") from error
