"""Owns the writing of TOML: quoted texts, numbers, and tables line by line."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Mapping
from typing import Any

from .folder import ExportError

# Numbers of scene text are within it.
LARGEST = 1e12
_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")


class Exact(float):
    """A number that is written with all of its digits, as times of frames must be."""


def quoted(text: str) -> str:
    """`text` as a basic string, whatever it holds; what is not UTF-8 becomes a question mark."""
    valid = text.encode("utf-8", "replace").decode("utf-8")
    # JSON's escapes are TOML's too; only DEL must be escaped there and is not in JSON.
    return json.dumps(valid, ensure_ascii=False).replace("\x7f", "\\u007f")


def key(name: str) -> str:
    """`name` as one part of a key: bare where TOML allows it."""
    return name if _BARE.match(name) else quoted(name)


def number(value: float) -> str:
    """`value`, with the seven digits of single precision where it is not exact; never `-0`."""
    if not math.isfinite(value) or abs(value) > LARGEST:
        raise ValueError(f"{value} is no number of scene text")
    if isinstance(value, (int, Exact)):
        return repr(value)
    text = format(value, ".7g")
    return "0" if text == "-0" else text


def value(what: Any) -> str:
    """A text, number, truth value, list, or mapping (as an inline table)."""
    if isinstance(what, bool):
        return "true" if what else "false"
    if isinstance(what, str):
        return quoted(what)
    if isinstance(what, (int, float)):
        return number(what)
    if isinstance(what, Mapping):
        return "{ " + ", ".join(f"{key(k)} = {value(v)}" for k, v in what.items()) + " }"
    if isinstance(what, Iterable):
        return "[" + ", ".join(value(part) for part in what) + "]"
    raise TypeError(f"{type(what).__name__} cannot be written as TOML")


def table(header: str, entries: Mapping[str, Any]) -> str:
    """A table under `header`, which includes its brackets; entries of None are left out."""
    try:
        lines = [f"{key(k)} = {value(v)}" for k, v in entries.items() if v is not None]
    except ValueError as error:
        raise ExportError(f"{header} cannot be written: {error}") from error
    return "\n".join([header, *lines]) + "\n"
