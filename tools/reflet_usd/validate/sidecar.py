"""Owns reading the converter's sidecar beside an output, and checking its form."""

import json
import math
from pathlib import Path
from typing import Any

_NUMBERS = ("timeOrigin", "subdivLevel")
_TEXTS = ("purpose", "roots")


def read_sidecar(out: Path) -> tuple[dict[str, Any], str]:
    """JSON beside the output, empty for files by others; and its fault, if any."""
    place = Path(f"{out}.json")
    if not place.exists():
        return {}, ""
    try:
        content = json.loads(place.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        reason = f"it cannot be read ({' '.join(str(error).split())})"
    else:
        reason = _fault(content)
        if not reason:
            return content, ""
    return {}, f"the sidecar {place.name} is damaged: {reason}; convert the stage again"


def _fault(content: Any) -> str:
    """Part of the sidecar that does not have the converter's form; empty where all has it."""
    if not isinstance(content, dict):
        return "it is no JSON object"
    warnings = content.get("warnings", [])
    if not isinstance(warnings, list) or not all(map(_is_warning, warnings)):
        return "'warnings' must list objects with the texts 'name', 'prim' and 'message'"
    info = content.get("info", {})
    if not isinstance(info, dict):
        return "'info' is no JSON object"
    frames = info.get("frames")
    if frames is not None and not (_is_list(frames, (int, float)) and len(frames) == 2):
        return "'info.frames' must be two time codes or null"
    for name in _NUMBERS:
        if info.get(name) is not None and not _is_number(info[name]):
            return f"'info.{name}' must be a number"
    for name in _TEXTS:
        if info.get(name) is not None and not _is_list(info[name], (str,)):
            return f"'info.{name}' must list texts"
    variants = info.get("variants") or []
    choices = variants if isinstance(variants, list) else [variants]
    if not all(_is_list(choice, (str,)) and len(choice) == 3 for choice in choices):
        return "'info.variants' must list prim, set and variant"
    return ""


def _is_warning(entry: Any) -> bool:
    if not isinstance(entry, dict):
        return False
    texts = all(isinstance(entry.get(name, ""), str) for name in ("name", "prim", "message"))
    deviation = entry.get("deviation")
    known = "name" in entry and "prim" in entry
    return texts and known and (deviation is None or _is_number(deviation))


def _is_number(value: Any) -> bool:
    plain = isinstance(value, (int, float)) and not isinstance(value, bool)
    return plain and math.isfinite(value)


def _is_list(value: Any, kinds: tuple[type, ...]) -> bool:
    fits = isinstance(value, list) and all(isinstance(entry, kinds) for entry in value)
    return fits and all(_is_number(entry) or isinstance(entry, str) for entry in value)
