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
COMMANDS = {"README": 9, "docs/guide": 26, "docs/query": 5, "docs/project": 3, "docs/python": 2}

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


def small(line: str) -> str:
    """A command of a page with a small picture; questions are about pixels of a size."""
    words = shlex.split(re.sub(r"\s#\s.*", "", line))
    if words[1] == "query":
        return shlex.join(words)
    for option, value in {"--size": "64x36", "--samples": "2"}.items():
        if option in words and words[words.index(option) + 1][0].isdigit():
            words[words.index(option) + 1] = value
        elif words[1] in ("render", "sheet", "thumbs") and option not in words:
            words += [option, value]
    return shlex.join(words)


def commands(page: Path) -> list[str]:
    """Lines of the shell blocks of a page, and its commands above pictures. Previews end after a
    while; tests/window and test_page.py use them."""
    found = re.findall(
        r"^(?:```sh\n(.*?)^```|\| `(reflet [^`]+)`[^\n]*)$",
        page.read_text(encoding="utf-8"),
        re.MULTILINE | re.DOTALL,
    )
    lines = "\n".join(map("".join, found)).replace("\\\n", " ").splitlines()
    lines = [line for line in lines if re.match(r"(?!\s*#)\s*\S", line)]
    lines = [small(line) if line.startswith("reflet ") else line for line in lines]
    shown = 'xvfb-run -a timeout 10 {} || [ "$?" = 124 ]'
    return [shown.format(line) if "reflet preview" in line else line for line in lines]


# Substitutes for programs of the pages: installations that are not optimized and go into folders,
# openjd from PyPI, and each task of an array as a cluster would run it.
PROGRAMS = {
    "cargo": f'cd {ROOT} && export CARGO_TARGET_DIR={ROOT}/target/pages PATH="${{PATH#*:}}" && '
    'exec cargo "$@" --debug --root "$HERE/cargo"',
    "pip": f"ln -sfn {ROOT}/src src && cp -rn {ROOT}/tools . && python3 -m venv own && "
    f'export CARGO_TARGET_DIR={ROOT}/target/wheel MATURIN_PEP517_ARGS="--profile dev" '
    'PATH="${PATH#*:}" && own/bin/pip -q "$@" && own/bin/python -c "import reflet; reflet.open()"',
    "openjd": 'python3 -m venv jobs && jobs/bin/pip -q install openjd-cli && jobs/bin/openjd "$@"',
    "sbatch": 'for SLURM_ARRAY_TASK_ID in $(seq $(sed -nE "s/.*--array=([0-9]+)-([0-9]+).*'
    '/\\1 \\2/p" "$1")); do export SLURM_ARRAY_TASK_ID; bash "$1"; done',
}


@pytest.mark.full("a minute of small pictures, installations, 500 MB from PyPI")
@pytest.mark.program
@pytest.mark.parametrize("page", COMMANDS)
def test_commands_of_a_page_run_one_after_another(page: str, tmp_path: Path) -> None:
    """The shell blocks of a page as one script, in a folder with the files that they name."""
    for folder in ("scenes", "scripts"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    scene = blocks("guide")[0][1] + (TEXTS / "pages/recorded.toml").read_text(encoding="utf-8")
    scene = scene.replace("version = 1\n", "version = 1\nimage.size = [64, 36]\n", 1)
    for name in ("my.toml", "a.toml", "b.toml"):
        (tmp_path / name).write_text(scene, encoding="utf-8")
    longer = scene.replace("end = 71", "end = 470")
    (tmp_path / "my-film.toml").write_text(longer, encoding="utf-8")
    shutil.copy(TEXTS / "pages/shot.toml", tmp_path)
    for folder in ("models", "library", "bin"):
        (tmp_path / folder).mkdir()
    for name in ("chair.glb", "model.glb", "models/chair.glb"):
        shutil.copy(TEXTS / "pages/fox.glb", tmp_path / name)
    (tmp_path / "bin/reflet").symlink_to(BINARY)
    for name, text in PROGRAMS.items():
        (tmp_path / "bin" / name).write_text(f"#!/bin/bash\nset -e\n{text}\n", encoding="utf-8")
        (tmp_path / "bin" / name).chmod(0o755)
    libraries = (ROOT / ".venv").glob("lib/python3*/site-packages/pyoidn/oidn/lib")
    environment = {"REFLET_OIDN": str(next(libraries, ""))} | os.environ
    environment |= {"PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}", "HERE": str(tmp_path)}
    lines = commands(ROOT / f"{page}.md")
    assert len(lines) >= COMMANDS[page]
    new = [] if page in ("docs/project", "docs/python") else ["reflet new show"]
    (tmp_path / "page.sh").write_text("\n".join(["set -eux", *new, *lines]), encoding="utf-8")
    run = ["bash", "page.sh"]
    done = subprocess.run(
        run, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
