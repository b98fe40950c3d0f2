"""The notebooks of `docs/examples` run from top to bottom, and their own checks hold."""

import os
import shutil
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "docs/examples").glob("*.ipynb"))

pytestmark = pytest.mark.full("renders films and series for minutes")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run(
    path: Path, package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("matplotlib")
    shutil.copy(ROOT / "scenes/mirrors.toml", tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(package), prepend=os.pathsep)
    notebook = nbformat.read(path, as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "stored without outputs"
    client = nbclient.NotebookClient(
        notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": tmp_path}}
    )
    client.execute()
    kept = os.environ.get("REFLET_NOTEBOOKS")
    if kept:
        # To look at: the notebook with its outputs, and the files that it wrote.
        shutil.copytree(tmp_path, Path(kept) / path.stem, dirs_exist_ok=True)
        nbformat.write(notebook, Path(kept) / path.stem / path.name)
