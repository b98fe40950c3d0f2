"""Owns the names of things and of files in a project: unique, and the same in each export."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable

_UNSAFE = re.compile(r"[^A-Za-z0-9_-]+")
# Names that Windows keeps for devices.
_DEVICES = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)\Z", re.IGNORECASE)
_MOST = 60


class Names:
    """Names of one kind, each given once; letters that differ in case alone count as the same."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def __contains__(self, name: str) -> bool:
        return name.casefold() in self._taken

    def take(self, names: Iterable[str]) -> None:
        """Give `names` away."""
        self._taken.update(name.casefold() for name in names)

    def unique(self, wanted: str) -> str:
        """`wanted`, or that with a number where it is taken."""
        name, count = wanted, 1
        while name in self:
            count += 1
            name = f"{wanted} ({count})"
        self._taken.add(name.casefold())
        return name


def file_stem(name: str) -> str:
    """A file name without suffix that every system takes; one that loses letters gets a hash."""
    stem = _UNSAFE.sub("-", name).strip("-")[:_MOST]
    if stem == name and stem and not _DEVICES.match(stem):
        return stem
    digest = hashlib.sha256(name.encode("utf-8", "surrogateescape")).hexdigest()[:8]
    return f"{stem}-{digest}" if stem else digest
