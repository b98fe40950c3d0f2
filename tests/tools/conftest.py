"""Owns the fixtures of the USD tools' tests: seed stages, corpus, validator, `full` marker."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(HERE))
sys.path.insert(0, str(ROOT / "tools"))


def pytest_configure(config: pytest.Config) -> None:
    """Declare the marker of the slow set."""
    config.addinivalue_line("markers", "full: all of the slow set; left out unless asked for")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option `--full`, which also runs the tests with the marker `full`."""
    parser.addoption("--full", action="store_true", help="run the slow set too")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Skip the slow set unless `--full` or `-m full` asks for it."""
    if config.getoption("--full") or "full" in (config.getoption("-m") or ""):
        return
    skip = pytest.mark.skip(reason="slow: run with --full")
    for item in items:
        if "full" in item.keywords:
            item.add_marker(skip)


@pytest.fixture
def stages() -> Path:
    """The folder of small stages in this repository."""
    return HERE / "stages"


@pytest.fixture(scope="session")
def corpus() -> Path:
    """The USD corpus: REFLET_CORPUS, else ../shared/corpus beside the checkout."""
    places = [os.environ.get("REFLET_CORPUS"), str(ROOT.parent / "shared" / "corpus")]
    for place in filter(None, places):
        folder = Path(place)
        for candidate in (folder / "usd", folder):
            if (candidate / "INDEX.tsv").is_file():
                return candidate
    pytest.skip("the USD corpus is not here; name its folder in REFLET_CORPUS")


@pytest.fixture(scope="session")
def khronos() -> None:
    """Skip the test where the Khronos validator cannot run."""
    from reflet_usd.validate.khronos import ValidatorMissingError, find_package

    try:
        find_package()
    except ValidatorMissingError as error:
        pytest.skip(str(error))
