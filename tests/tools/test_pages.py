"""Scenes and scripts of the pages are right as they stand, each block upon the earlier blocks."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from program import BINARY, ROOT
from texts import TEXTS

BLOCK = re.compile(r"^```(toml|rust|rhai)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(name: str) -> list[tuple[str, str]]:
    """Language and text of scenes and scripts of a page; the guide goes on from the README."""
    pages = [ROOT / "README.md"] * (name == "guide") + [ROOT / "docs" / f"{name}.md"]
    return [found for page in pages for found in BLOCK.findall(page.read_text(encoding="utf-8"))]


@pytest.mark.program
@pytest.mark.parametrize("page", ["guide", "scripting", "shapes"])
def test_blocks_of_a_page_are_right_as_they_stand(page: str, tmp_path: Path) -> None:
    lamp = (ROOT / "scenes/show").glob("lamp.*")
    for file in [*(TEXTS / "pages").iterdir(), ROOT / "scenes/hills.png", *lamp]:
        shutil.copy(file, tmp_path)
    shutil.copy(ROOT / "scenes/hills.png", tmp_path / "poster.png")
    own = tmp_path / f"{page}.toml"
    scene = own.read_text(encoding="utf-8") if own.exists() else "version = 1\n"
    for language, text in blocks(page):
        name = "my.toml"
        if language != "toml":
            named = re.match(r"// (\w+\.rhai)", text)
            (tmp_path / (named[1] if named else "script.rhai")).write_text(text, encoding="utf-8")
        elif not text.startswith("version") or scene == "version = 1\n":
            # Keys without a table stand above the first table.
            first = re.split(r"^(?=\[)", text, maxsplit=1, flags=re.MULTILINE)
            scene = f"version = 1\n{first[0]}{scene}\n{''.join(first[1:])}"
            scene = re.sub(r"\nversion = 1$", "", scene, flags=re.MULTILINE)
        else:
            name = "shot.toml"
        (tmp_path / name).write_text(text if name == "shot.toml" else scene, encoding="utf-8")
        script = re.match(r'script = "(.*)"', text)
        if script and not (tmp_path / script[1]).exists():
            continue  # the next block is the script
        check = [BINARY, "check", "--no-project", tmp_path / name]
        done = subprocess.run(check, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{text}\n{done.stderr}"
