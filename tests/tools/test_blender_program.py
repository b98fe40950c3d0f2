"""Owns what the Blender add-on does without Blender: running the program, the list of losses.

`UPDATE_DOCS=1 .venv/bin/python -m pytest tests/tools/test_blender_program.py` writes the list of
docs/blender.md anew.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path
from types import ModuleType

import pytest
from tables import table, write_tables

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/blender.md"


def alone(name: str) -> ModuleType:
    """A module of the add-on, without its package, which needs Blender."""
    full_name = f"reflet_blender_{name}"
    path = ROOT / "tools/blender/reflet_blender" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(full_name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[full_name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def program() -> ModuleType:
    """Module that runs the program."""
    return alone("program")


def test_what_was_printed_is_returned(program: ModuleType) -> None:
    assert program.run([sys.executable, "-c", "print('done')"], lambda: False) == "done\n"


def test_a_failure_has_its_last_words(program: ModuleType) -> None:
    failing = [sys.executable, "-c", "import sys; print('scene.toml:3:1: error'); sys.exit(2)"]
    with pytest.raises(program.ProgramError, match=r"failed \(2\):\nscene.toml:3:1: error"):
        program.run(failing, lambda: False)


@pytest.mark.parametrize("manners", ["", "signal.signal(signal.SIGTERM, signal.SIG_IGN); "])
def test_a_stopped_program_is_gone(
    program: ModuleType, manners: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(program, "_PATIENCE_S", 0.2)
    began = tmp_path / "pid"
    # It never ends by itself, and writes its number in one step.
    endless = f"import os, signal, time; {manners}open('{began}.new', 'w').write(str(os.getpid()))"
    endless += f"; os.rename('{began}.new', '{began}')\nwhile True: time.sleep(60)"
    assert program.run([sys.executable, "-c", endless], began.exists) is None
    assert not Path(f"/proc/{began.read_text()}").exists()


def test_a_missing_program_says_where_it_is_named(program: ModuleType, tmp_path: Path) -> None:
    with pytest.raises(program.ProgramError, match="name it in the preferences"):
        program.find(str(tmp_path / "none"))
    (tmp_path / "text").write_text("no program", encoding="utf-8")
    with pytest.raises(program.ProgramError, match="cannot run"):
        program.run([str(tmp_path / "text")], lambda: False)


def test_the_page_lists_all_losses(tmp_path: Path) -> None:
    rows = [[f"`{code}`", meaning] for code, meaning in sorted(alone("report").LOSSES.items())]
    losses = {"losses": table(["code", "what it means"], rows)}
    if os.environ.get("UPDATE_DOCS"):
        write_tables(PAGE, losses)
    copy = tmp_path / "blender.md"
    copy.write_text(PAGE.read_text())
    write_tables(copy, losses)
    assert copy.read_text() == PAGE.read_text(), "UPDATE_DOCS=1 writes the list anew"
