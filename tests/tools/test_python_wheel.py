"""The wheel of the package `reflet` installs in an empty environment, where a program runs."""

import os
import shutil
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest
import reflet_usd
from texts import text_of

ROOT = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.full("builds the optimized wheel for minutes")

#: A program that uses most of the package.
PROGRAM = text_of("python_wheel/program.txt")
SCENE = text_of("python_wheel/scene.toml")
SCRIPT = "fn frame(ctx) { ctx.place(`ball`, [0.02 * ctx.frame, ctx.params.height, 0.0]); }\n"


def run(*words: object, **options: object) -> str:
    """Run a command, and return its output."""
    command = [str(word) for word in words]
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def build(folder: Path) -> None:
    """Make the wheels of both packages; not optimized, as the packing is tested."""
    manifest = ["--manifest-path", ROOT / "src/python/Cargo.toml", "--locked"]
    maturin = Path(sys.executable).with_name("maturin")
    # Other tests read the library of the common folder meanwhile.
    environment = {**os.environ, "CARGO_TARGET_DIR": str(ROOT / "target/wheel")}
    run(maturin, "build", *manifest, "--profile", "dev", "--out", folder, env=environment)
    # setuptools builds inside of the folder.
    tools = folder.with_name("tools")
    shutil.copytree(ROOT / "tools/reflet_usd", tools / "reflet_usd")
    shutil.copy(ROOT / "tools/pyproject.toml", tools)
    run(sys.executable, "-m", "pip", "wheel", "--no-deps", "--wheel-dir", folder, tools)


def check_files(wheel: Path) -> None:
    """Check that the wheel is one for all versions of Python, and has every file."""
    assert "-cp311-abi3-" in wheel.name
    names = zipfile.ZipFile(wheel).namelist()
    package = [name for name in names if name.startswith("reflet/")]
    sources = {path.name for path in (ROOT / "src/python/reflet").glob("*.py*")}
    sources |= {"py.typed", "_reflet.abi3.so"}
    assert {Path(name).name for name in package} == sources
    licenses = {Path(name).name for name in names if "LICENSE" in name}
    assert licenses == {"LICENSE-MIT", "LICENSE-APACHE"}, names


def test_it_runs_in_an_empty_environment(tmp_path: Path) -> None:
    wheels = tmp_path / "wheels"
    build(wheels)
    [wheel] = wheels.glob("reflet-*.whl")
    check_files(wheel)
    venv.create(tmp_path / "venv", with_pip=True)
    python = tmp_path / "venv/bin/python"
    pip = [python, "-m", "pip", "--disable-pip-version-check"]
    run(*pip, "install", "--quiet", "--find-links", wheels, "reflet")
    work = tmp_path / "work"
    (work / "lib").mkdir(parents=True)
    (work / "program.py").write_text(PROGRAM)
    (work / "scene.toml").write_text(SCENE)
    (work / "move.rhai").write_text(SCRIPT)
    assert run(python, "program.py", cwd=work).split() == ["True", "4"]
    # The converter of USD comes with the extra, whose other packages are not fetched here.
    planned = run(*pip, "install", "--dry-run", "--find-links", wheels, "reflet[usd]")
    assert f"reflet-usd-{reflet_usd.__version__}" in planned, planned
    run(*pip, "install", "--quiet", "--no-deps", "--no-index", "--find-links", wheels, "reflet-usd")
    named = (
        "import os, reflet; reflet.open(size=(8, 8), samples=1); print(os.environ['REFLET_USD'])"
    )
    environment = {name: value for name, value in os.environ.items() if name != "REFLET_USD"}
    found = run(python, "-c", named, cwd=work, env=environment).strip()
    assert Path(found).samefile(tmp_path / "venv/bin/reflet-usd")
