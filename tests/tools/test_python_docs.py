"""The types of the module of Python repeat its documentation, which stands in `src/python/*.rs`.

`UPDATE_DOCS=1 .venv/bin/python -m pytest tests/tools/test_python_docs.py` writes it anew.
"""

import ast
import inspect
import os
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

TYPES = Path(__file__).resolve().parents[2] / "src/python/reflet/_reflet.pyi"

Documented = ast.FunctionDef | ast.ClassDef


def documented(tree: ast.Module) -> Iterator[tuple[str, Documented]]:
    """Functions, classes and their methods with docstrings, by their path in the module."""
    for node in tree.body:
        if isinstance(node, Documented) and not node.name.startswith("_"):
            yield node.name, node
            for inner in node.body:
                if isinstance(inner, ast.FunctionDef) and ast.get_docstring(inner):
                    yield f"{node.name}.{inner.name}", inner


def docstring_lines(text: str, indent: str) -> list[str]:
    """A docstring as it stands in the file."""
    lines = [indent + line if line else "" for line in f'"""{text}'.splitlines()]
    if len(lines) == 1:
        return [lines[0] + '"""']
    return [*lines, f'{indent}"""']


def choices(name: str) -> list[str]:
    """Texts of a `Literal` of the types."""
    for node in ast.parse(TYPES.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.AnnAssign) and ast.unparse(node.target) == name:
            return list(ast.literal_eval(node.value.slice))
    raise AssertionError(name)


def test_types_list_the_choices_of_the_module(reflet: ModuleType) -> None:
    assert choices("_Aov") == reflet.AOVS
    with pytest.raises(reflet.SceneError) as caught:
        reflet.open(method="?")
    said = str(caught.value).split(", not ")[0]
    assert set(choices("_Method")) == set(re.findall(r'"([a-z+-]+)"', said))


def test_types_repeat_the_documentation(reflet: ModuleType) -> None:
    from reflet import _reflet

    text = TYPES.read_text(encoding="utf-8")
    lines = text.splitlines()
    found = list(documented(ast.parse(text)))
    assert len(found) > 40
    # From the end, so that earlier places stay.
    for path, node in reversed(found):
        value = _reflet
        for name in path.split("."):
            value = getattr(value, name)
        own = node.body[0]
        indent = " " * own.col_offset
        lines[own.lineno - 1 : own.end_lineno] = docstring_lines(inspect.getdoc(value), indent)
    new = "\n".join(lines) + "\n"
    if os.environ.get("UPDATE_DOCS"):
        TYPES.write_text(new, encoding="utf-8")
    assert new == text or os.environ.get("UPDATE_DOCS"), (
        "stale: UPDATE_DOCS=1 (see the file's head)"
    )
    assert reflet.open is _reflet.open
