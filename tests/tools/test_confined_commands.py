"""Commands on stages that block, lie or never end, and on outputs that cannot be written."""

import dataclasses
import io
import json
import os
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from read_converted import refused
from reflet_usd import cli
from reflet_usd.convert.types import ConvertError
from reflet_usd.sandbox import Limits, run_convert
from reflet_usd.usdz_check import check_package
from reflet_usd.validate import confined
from texts import text_of

ROOT = Path(__file__).resolve().parent.parent.parent
HEAD = '#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = "Y"\n'
CUBE = HEAD + ')\ndef Cube "C" {}\n'


def command(*words: str) -> list[str]:
    """Command line of a `reflet-usd` subcommand."""
    return [sys.executable, "-m", "reflet_usd", *words]


def run(*words: str, stdout: object = subprocess.PIPE) -> subprocess.CompletedProcess[str]:
    """Run `reflet-usd` in a process of its own."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "tools")}
    return subprocess.run(
        command(*words), env=environment, stdout=stdout, stderr=subprocess.PIPE, text=True
    )


def package(path: Path, *entries: tuple[str, str]) -> Path:
    """A usdz of stored text files."""
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in entries:
            archive.writestr(name, text)
    return path


def cube(folder: Path) -> tuple[Path, Path]:
    """A stage of one cube and its converted file."""
    stage, out = folder / "cube.usda", folder / "cube.glb"
    stage.write_text(CUBE)
    run_convert(stage, out)
    return stage, out


def test_validate_waits_for_no_pipe(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.usda")
    stage, out = tmp_path / "stage.usda", tmp_path / "out.glb"
    stage.write_text(HEAD + '    subLayers = [@pipe.usda@]\n)\ndef Cube "C" {}\n')
    run_convert(stage, out)
    assert cli.main(["validate", str(out), "--against", str(stage), "--no-khronos"]) == 0


def test_validate_and_inspect_have_limits_of_convert(tmp_path: Path, run_cli: Callable) -> None:
    _, out = cube(tmp_path)
    bad = package(tmp_path / "bad.usdz", ("a.usda", CUBE), ("../../b.usda", CUBE))
    use = tmp_path / "use.usda"
    use.write_text(HEAD + ')\ndef "X" (references = @bad.usdz@</C>) {}\n')
    many = tmp_path / "many.usda"
    many.write_text(HEAD + ")\n" + "".join(f'def Cube "c{i}" {{}}\n' for i in range(100_000)))
    for stage, cpu_s, name in (
        (bad, "600", "usdz-path"),
        (use, "600", "usdz-path"),
        (many, "2", "cpu-limit"),
    ):
        options = ["--against", stage, "--no-khronos", "--cpu-limit", cpu_s]
        assert f"[{name}]" in run_cli(1, "validate", out, *options).err
    assert "[cpu-limit]" in run_cli(1, "inspect", many, "--cpu-limit", "1").err


def test_referenced_packages_are_checked(tmp_path: Path) -> None:
    package(tmp_path / "bad.usdz", ("a.usda", CUBE), ("../../b.usda", CUBE))
    stage = tmp_path / "stage.usda"
    stage.write_text(HEAD + ')\ndef "X" (references = @bad.usdz@</C>) {}\n')
    with refused("usdz-path") as caught:
        run_convert(stage, tmp_path / "a.glb")
    assert caught.value.path.endswith("bad.usdz")


def test_headers_that_disagree_with_the_directory_are_refused(tmp_path: Path) -> None:
    path = package(tmp_path / "a.usdz", ("a.usda", CUBE), ("a.png", "x"))
    check_package(path)
    good = path.read_bytes()
    name, second = good.index(b"a.png"), good.index(b"PK\3\4", 4)
    renamed = good[:name] + b"../xx" + good[name + 5 :]
    grown = good[: second + 22] + b"\xf0\xff\xff\x7f" + good[second + 26 :]
    for bad in (renamed, grown):
        path.write_bytes(bad)
        with refused("usdz-broken"):
            check_package(path)


def test_a_file_that_the_directory_hides_is_refused(tmp_path: Path) -> None:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("a.usda", CUBE)
        archive.writestr("b.usda", CUBE)
        archive.filelist.pop()  # the zip directory is written when the archive closes
    path = tmp_path / "a.usdz"
    path.write_bytes(stream.getvalue())
    with pytest.raises(ConvertError, match="does not list"):
        check_package(path)


@pytest.mark.parametrize("arc", ["references", "payload", "sublayer", "nested"])
def test_a_layer_outside_that_a_package_names_is_left_out(tmp_path: Path, arc: str) -> None:
    (tmp_path / "in").mkdir()
    outside = tmp_path / "out.usda"
    outside.write_text(CUBE.replace('"C"', '"Out"'))
    below = f"subLayers = [@{outside}@]\n" if arc == "sublayer" else ""
    text = HEAD + below + CUBE.removeprefix(HEAD)
    named = {"references": outside, "payload": outside, "nested": "inner.usda"}
    if arc in named:
        kind = "payload" if arc == "payload" else "references"
        text += f'def "R" ({kind} = @{named[arc]}@</Out>) {{}}\n'
    inner = f'#usda 1.0\ndef "Out" (references = @{outside}@</Out>) {{}}\n'
    files = [("a.usda", text)] + ([("inner.usda", inner)] if arc == "nested" else [])
    done = run_convert(package(tmp_path / "in" / "a.usdz", *files), tmp_path / "a.glb")
    assert "asset-outside-roots" in {w.name for w in done.warnings}
    # The cube of the package itself is shown.
    content = (tmp_path / "a.glb").read_bytes()
    assert b"/C" in content
    assert cli.main(["inspect", str(tmp_path / "in" / "a.usdz")]) == 0


def test_value_clips_outside_that_a_package_names_are_refused(
    tmp_path: Path, run_cli: Callable
) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "out.usda").write_text(CUBE)
    clips = f'asset[] assetPaths = [@{tmp_path}/out.usda@]\nstring primPath = "/C"\n'
    text = CUBE + f'def "R" (clips = {{\ndictionary default = {{\n{clips}}}\n}}) {{}}\n'
    stage = package(tmp_path / "in" / "a.usdz", ("a.usda", text))
    for words in (["convert", stage, "-o", tmp_path / "a.glb"], ["inspect", stage]):
        assert "[asset-outside-roots]" in run_cli(1, *words).err


def test_assets_of_packages_keep_their_names(tmp_path: Path) -> None:
    text = CUBE + 'def "R" (references = @../x.usda@</C>) {}\n'
    done = run_convert(package(tmp_path / "a.usdz", ("a.usda", text)), tmp_path / "a.glb")
    (message,) = [w.message for w in done.warnings if w.name == "asset-unresolved"]
    assert "@a.usdz[../x.usda]@" in message


MESH = text_of("confined_commands/mesh.usda")


def test_a_part_of_the_output_that_cannot_be_written_leaves_all_as_it_was(tmp_path: Path) -> None:
    stage = tmp_path / "stage.usda"
    stage.write_text(CUBE + MESH)
    (tmp_path / "q.gltf.json").mkdir()
    (tmp_path / "q.bin").write_text("mine")
    with refused("output-unwritable", "q.gltf.json is a folder"):
        run_convert(stage, tmp_path / "q.gltf")
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "q.bin",
        "q.gltf.json",
        "stage.usda",
    ]
    assert (tmp_path / "q.bin").read_text() == "mine"


def test_a_move_that_fails_is_undone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stage, out = tmp_path / "stage.usda", tmp_path / "q.gltf"
    stage.write_text(CUBE + MESH)
    (tmp_path / "q.bin").write_text("mine")
    replace = os.replace

    def fail(source: Path, place: Path) -> None:
        if Path(place) == out:
            raise OSError(28, "No space left on device")
        replace(source, place)

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(ConvertError, match="No space left"):
        run_convert(stage, out)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["q.bin", "stage.usda"]
    assert (tmp_path / "q.bin").read_text() == "mine"


def test_a_link_is_replaced_and_what_it_names_stays(tmp_path: Path) -> None:
    stage, out = tmp_path / "stage.usda", tmp_path / "a.glb"
    stage.write_text(CUBE)
    (tmp_path / "mine.txt").write_text("mine")
    out.symlink_to(tmp_path / "mine.txt")
    run_convert(stage, out)
    assert not out.is_symlink()
    assert (tmp_path / "mine.txt").read_text() == "mine"


def test_odd_names_and_ranges_are_named(tmp_path: Path, run_cli: Callable) -> None:
    stage = tmp_path / "stage.usda"
    stage.write_text(CUBE)
    odd = Path(os.fsdecode(os.fsencode(tmp_path) + b"/a\xff.usda"))
    odd.write_text(CUBE)
    out, root = str(tmp_path / "a.glb"), os.fsdecode(b"/tmp/\xff")
    for words, name in (
        ([str(stage), "-o", str(tmp_path / ("x" * 300 + ".glb"))], "output-unwritable"),
        ([str(stage), "-o", str(tmp_path / ("x" * 300) / "a.glb")], "output-unwritable"),
        ([str(odd), "-o", out], "name-not-utf8"),
        ([str(stage), "-o", str(odd.with_suffix(".glb"))], "name-not-utf8"),
        ([str(stage), "-o", out, "--root", root], "name-not-utf8"),
    ):
        assert f"[{name}]" in run_cli(1, "convert", *words).err
    for frames in ("1:1e400", "nan", "-inf:1", "0:1e10"):
        with pytest.raises(SystemExit) as caught:
            cli.main(["convert", str(stage), "-o", out, "--frames", frames])
        assert caught.value.code == 2
    assert not Path(out).exists()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_standard_output_is_named(tmp_path: Path) -> None:
    stage, out = cube(tmp_path)
    out.unlink()
    with open("/dev/full", "w") as full:
        shown = run("inspect", str(stage), stdout=full)
        written = run("convert", str(stage), "-o", str(out), stdout=full)
    assert shown.returncode == written.returncode == 1
    assert "standard output cannot be written" in shown.stderr
    assert "cube.glb is written, but standard output" in written.stderr
    assert "Traceback" not in shown.stderr + written.stderr
    assert out.exists()


def test_a_reader_that_leaves_early_is_no_error(tmp_path: Path) -> None:
    _, out = cube(tmp_path)
    read, write = os.pipe()
    os.close(read)
    done = run("validate", str(out), "--json", "--no-khronos", stdout=write)
    os.close(write)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="looks into /proc")
def test_what_a_killed_run_left_is_swept(tmp_path: Path) -> None:
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    left = tmp_path / f".reflet-usd-{ended.pid}-abc"
    live = tmp_path / f".reflet-usd-{os.getpid()}-abc"
    for folder in (left, live):
        (folder / "out").mkdir(parents=True)
    cube(tmp_path)
    assert not left.exists()
    assert live.exists()


def test_a_fault_of_a_command_has_a_name(
    run_cli: Callable, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def fault(*_: object) -> None:
        raise RuntimeError("odd")

    monkeypatch.setattr("reflet_usd.report.read_roots", fault)
    assert "odd [converter-internal]" in run_cli(1, "report", tmp_path).err


def test_the_wall_time_of_report_covers_the_check(
    tmp_path: Path, khronos: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "in").mkdir()
    cube(tmp_path / "in")
    run_confined = confined.run_confined

    def check_without_end(*args: Any, limits: Limits, **options: Any) -> Any:
        assert limits.wall_s == 600.0
        options["target"] = "sandbox_targets:sleep"
        return run_confined(*args, limits=dataclasses.replace(limits, wall_s=1.0), **options)

    # Only the check's time limit is shortened: a conversion may take longer on a busy machine.
    monkeypatch.setattr(confined, "run_confined", check_without_end)
    details = tmp_path / "details.json"
    words = ["report", str(tmp_path / "in"), "--wall-s", "600", "--json", str(details)]
    assert cli.main(words) == 3
    (row,) = json.loads(details.read_text())
    assert (row["converted"], row["passed"], row["reason"]) == (True, False, "time-limit")


def test_validate_ends_where_layers_outside_are_named(tmp_path: Path) -> None:
    inside, outside = tmp_path / "in", tmp_path / "out"
    inside.mkdir()
    outside.mkdir()
    (outside / "part.usda").write_text(CUBE)
    (inside / "link.usda").symlink_to(outside / "part.usda")
    arcs = ("../out/part.usda", f"{outside}/part.usda", "link.usda")
    stage, out = inside / "stage.usda", tmp_path / "out.glb"
    parts = (f'def "R{i}" (references = @{arc}@</C>) {{}}\n' for i, arc in enumerate(arcs))
    stage.write_text(CUBE + "".join(parts))
    run_convert(stage, out)
    options = ["--against", str(stage), "--no-khronos", "--cpu-limit", "20"]
    assert cli.main(["validate", str(out), *options]) == 0
