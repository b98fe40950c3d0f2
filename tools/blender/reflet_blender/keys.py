"""Owns tracks of scene text that are made of one value for each frame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .toml_text import Exact

Value = Sequence[float]
_TOLERANCE = 1e-6


def track(frames: Sequence[int], values: Sequence[Value], fps: float) -> dict[str, Any] | None:
    """Keys of linear interpolation that give `values` at `frames`; None where nothing changes."""
    if all(_near(value, values[0]) for value in values):
        return None
    keys = [
        {"at_s": Exact(frames[i] / fps), "value": values[i] if len(values[i]) > 1 else values[i][0]}
        for i in _needed(values)
    ]
    return {"keys": keys}


def steps(frames: Sequence[int], values: Sequence[bool], fps: float) -> dict[str, Any] | None:
    """Keys at which a truth value changes; None where it does not."""
    changes = [i for i in range(len(values)) if i == 0 or values[i] != values[i - 1]]
    if len(changes) == 1:
        return None
    return {"keys": [{"at_s": Exact(frames[i] / fps), "value": values[i]} for i in changes]}


def _near(a: Value, b: Value) -> bool:
    return all(abs(x - y) <= _TOLERANCE * max(1.0, abs(x)) for x, y in zip(a, b, strict=True))


def _needed(values: Sequence[Value]) -> list[int]:
    """Indices of the keys between which all other values are on straight lines."""
    kept = [0]
    last = len(values) - 1
    while kept[-1] < last:
        start = kept[-1]
        end = start + 1
        while end < last and _is_straight(values, start, end + 1):
            end += 1
        kept.append(end)
    return kept


def _is_straight(values: Sequence[Value], start: int, end: int) -> bool:
    for i in range(start + 1, end):
        share = (i - start) / (end - start)
        between = [a + (b - a) * share for a, b in zip(values[start], values[end], strict=True)]
        if not _near(values[i], between):
            return False
    return True
