"""Owns the texts of tests: files of the folder `texts`, one folder for each file of tests."""

import re
from pathlib import Path

TEXTS = Path(__file__).resolve().parent / "texts"


def fill(text: str, /, **words: object) -> str:
    """The text with the value of each of `words` in place of `$word` or `${word}`."""
    return re.sub(r"\$\{(\w+)\}|\$(\w+)", lambda match: str(words[match[1] or match[2]]), text)


def text_of(name: str, /, **words: object) -> str:
    """The text of a file, filled where there are words for it."""
    text = (TEXTS / name).read_text(encoding="utf-8")
    return fill(text, **words) if words else text


def texts_of(folder: str) -> dict[str, str]:
    """Texts of the files of a folder, by their names with spaces."""
    files = sorted((TEXTS / folder).iterdir())
    return {file.stem.replace("_", " "): text_of(f"{folder}/{file.name}") for file in files}
