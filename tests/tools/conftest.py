"""Owns the fixtures of the USD tools' tests: seed stages, corpus, validator, `full` marker."""

import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(HERE))
sys.path.insert(0, str(ROOT / "tools"))


def pytest_configure(config: pytest.Config) -> None:
    """Declare the markers of the slow set and of tests that run what Cargo builds."""
    config.addinivalue_line("markers", "full(why): not in the daily run, and why")
    config.addinivalue_line("markers", "program: runs the program or the library; set by itself")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option `--full`, which also runs the tests with the marker `full`."""
    parser.addoption("--full", action="store_true", help="run the slow set too")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Function]) -> None:
    """Mark tests that run what Cargo builds; skip the slow set unless it is asked for."""
    for item in items:
        if "package" in item.fixturenames or hasattr(item.module, "BINARY"):
            item.add_marker("program")
    if config.getoption("--full") or "full" in (config.getoption("-m") or ""):
        return
    for item in items:
        if (marker := item.get_closest_marker("full")) is not None:
            reason = f"{marker.args[0]}: `tools/check.sh --full` runs it"
            item.add_marker(pytest.mark.skip(reason=reason))


@pytest.fixture(scope="session")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the package `reflet` around the library that `cargo test` has built."""
    if sys.version_info < (3, 11):
        pytest.skip("the module of Python needs Python 3.11")
    pytest.importorskip("numpy", reason="pictures are arrays of NumPy")
    from program import BUILT

    library = BUILT / "deps" / "libreflet_python.so"
    if not library.is_file():
        pytest.fail(f"{library} is missing: cargo test --locked --workspace --no-run")
    folder = tmp_path_factory.mktemp("package")
    shutil.copytree(ROOT / "src/python/reflet", folder / "reflet")
    (folder / "reflet/_reflet.abi3.so").symlink_to(library)
    return folder


@pytest.fixture(scope="session")
def reflet(package: Path) -> ModuleType:
    """The module of Python."""
    sys.path.insert(0, str(package))
    try:
        import reflet
    finally:
        sys.path.remove(str(package))
    return reflet


@pytest.fixture
def stages() -> Path:
    """The folder of small stages in this repository."""
    return HERE / "stages"


@pytest.fixture
def run_cli(capsys: pytest.CaptureFixture[str]) -> Callable:
    """Run `reflet-usd` in this process with an exit code; returns its captured `out` and `err`."""
    from reflet_usd import cli

    def run(code: int, *words: object) -> Any:
        assert cli.main([str(word) for word in words]) == code
        return capsys.readouterr()

    return run


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
