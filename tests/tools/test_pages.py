"""Scenes and scripts of the pages are right as they stand, each block upon the earlier blocks."""

import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest
from program import BINARY, ROOT
from texts import TEXTS

# Least numbers of blocks and commands: a changed pattern drops none unseen.
BLOCKS = {"guide": 9, "scripting": 1, "shapes": 10}
COMMANDS = {"README": 3, "docs/guide": 20, "docs/query": 5, "docs/project": 2}

BLOCK = re.compile(r"^```(toml|rust|rhai)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(name: str) -> list[tuple[str, str]]:
    """Language and text of scenes and scripts of a page; the guide goes on from the README."""
    pages = [ROOT / "README.md"] * (name == "guide") + [ROOT / "docs" / f"{name}.md"]
    return [found for page in pages for found in BLOCK.findall(page.read_text(encoding="utf-8"))]


@pytest.mark.program
@pytest.mark.parametrize("page", BLOCKS)
def test_blocks_of_a_page_are_right_as_they_stand(page: str, tmp_path: Path) -> None:
    lamp = (ROOT / "scenes/show").glob("lamp.*")
    for file in [*(TEXTS / "pages").iterdir(), ROOT / "scenes/hills.png", *lamp]:
        shutil.copy(file, tmp_path)
    shutil.copy(ROOT / "scenes/hills.png", tmp_path / "poster.png")
    own = tmp_path / f"{page}.toml"
    scene = own.read_text(encoding="utf-8") if own.exists() else "version = 1\n"
    assert len(blocks(page)) >= BLOCKS[page]
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


def commands(page: Path) -> list[list[str]]:
    """Commands of a page but for previews, with small pictures."""
    found = re.findall(
        r"^```sh\n(.*?)^```$", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
    )
    lines = "".join(found).replace("\\\n", " ").splitlines()
    lines = [re.sub(r"\s#\s.*", "", line) for line in lines if line.startswith("reflet ")]
    words = [shlex.split(line) for line in lines]
    small = {"--size": "64x36", "--samples": "2"}
    for command in words:
        for option, value in small.items():
            if option in command and command[command.index(option) + 1][0].isdigit():
                command[command.index(option) + 1] = value
            elif command[1] in ("render", "sheet", "thumbs") and option not in command:
                command += [option, value]
    return [command[1:] for command in words if command[1] != "preview"]


@pytest.mark.full("a minute of small pictures")
@pytest.mark.program
@pytest.mark.parametrize("page", COMMANDS)
def test_commands_of_a_page_run_one_after_another(page: str, tmp_path: Path) -> None:
    """The commands of a page alone, in a folder with the files that they name."""
    for folder in ("scenes", "scripts"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    scene = blocks("guide")[0][1] + (TEXTS / "pages/recorded.toml").read_text(encoding="utf-8")
    for name in ("my.toml", "a.toml", "b.toml"):
        (tmp_path / name).write_text(scene, encoding="utf-8")
    longer = scene.replace("end = 71", "end = 470")
    (tmp_path / "my-film.toml").write_text(longer, encoding="utf-8")
    shutil.copy(TEXTS / "pages/shot.toml", tmp_path)
    for folder in ("models", "library"):
        (tmp_path / folder).mkdir()
    for name in ("chair.glb", "model.glb", "models/chair.glb"):
        shutil.copy(TEXTS / "pages/fox.glb", tmp_path / name)
    libraries = (ROOT / ".venv").glob("lib/python3*/site-packages/pyoidn/oidn/lib")
    environment = {"REFLET_OIDN": str(next(libraries, ""))} | os.environ
    assert len(commands(ROOT / f"{page}.md")) >= COMMANDS[page]
    new = [] if page == "docs/project" else [["new", "show"]]
    for command in new + commands(ROOT / f"{page}.md"):
        run = [BINARY, *command]
        done = subprocess.run(
            run, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, f"{shlex.join(command)}\n{done.stderr}"
