"""The sandbox: every way a conversion can end badly has its name and leaves no output behind."""

import io
import os
import resource
import struct
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from read_converted import refused
from reflet_usd.convert.types import ConvertError, ConvertOptions
from reflet_usd.sandbox import Limits, run_convert
from reflet_usd.usdz_check import PackageLimits, check_package

# Each target meets one limit only, the others are out of its reach: on a busy machine everything,
# such as the first touch of 1 GiB of pages, takes longer than alone.
SMALL = Limits(memory_bytes=1 << 30, cpu_s=600, wall_s=600.0, output_bytes=1 << 20)
SHORT_CPU = Limits(cpu_s=2, wall_s=600.0)
SHORT_WALL = Limits(cpu_s=600, wall_s=1.0)
USDA = b'#usda 1.0\ndef Xform "A" {}\n'
needs_linux = pytest.mark.skipif(sys.platform != "linux", reason="confinement needs Linux")


def run(folder: Path, target: str, limits: Limits = SMALL, options: object = None) -> object:
    """Convert a small stage with `target` of sandbox_targets; outputs go to folder/out."""
    (folder / "in").mkdir(exist_ok=True)
    (folder / "out").mkdir(exist_ok=True)
    stage = folder / "in" / "stage.usda"
    stage.write_bytes(USDA)
    return run_convert(
        stage,
        folder / "out" / "a.glb",
        options,
        limits=limits,
        target=f"sandbox_targets:{target}",
    )


def failure(folder: Path, target: str, limits: Limits = SMALL) -> ConvertError:
    """The error of a conversion that has to fail, after checking that no output is left."""
    with pytest.raises(ConvertError) as caught:
        run(folder, target, limits)
    assert list((folder / "out").iterdir()) == []
    assert [path.name for path in (folder / "in").iterdir()] == ["stage.usda"]
    return caught.value


def test_a_good_conversion_moves_its_files(tmp_path: Path) -> None:
    result = run(tmp_path, "write_small")
    assert result.ledger == {"Mesh": {"carried": 1, "warned": 0}}
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["a.glb", "a.glb.json"]
    assert (tmp_path / "out" / "a.glb").read_bytes() == USDA


@pytest.mark.parametrize(
    ("target", "name"),
    [
        ("eat_memory", "memory-limit"),
        ("fail_to_allocate", "memory-limit"),
        ("crash", "usd-crash"),
        ("write_one_large", "output-limit"),
        ("write_many", "output-limit"),
        ("write_nothing", "converter-internal"),
        ("write_link", "converter-internal"),
        ("blunder", "converter-internal"),
        ("refuse", "stage-odd"),
    ],
)
def test_each_bad_end_is_named_and_leaves_nothing(tmp_path: Path, target: str, name: str) -> None:
    assert failure(tmp_path, target).name == name


@pytest.mark.parametrize(
    ("target", "limits", "name", "option"),
    [
        ("spin", SHORT_CPU, "cpu-limit", "--cpu-limit"),
        ("sleep", SHORT_WALL, "time-limit", "--time-limit"),
    ],
)
def test_a_time_limit_says_which_option_moves_it(
    tmp_path: Path, target: str, limits: Limits, name: str, option: str
) -> None:
    error = failure(tmp_path, target, limits)
    assert error.name == name
    assert option in error.message


def limited(
    folder: Path, target: str, kind: int, soft: int, hard: int
) -> subprocess.CompletedProcess[str]:
    """Convert a small stage in a program that was started with a limit, as batch systems do."""
    program = f"""
import sys, resource
resource.setrlimit({kind}, ({soft}, {hard}))
sys.path[:0] = {sys.path!r}
from pathlib import Path
from reflet_usd.sandbox import run_convert
from reflet_usd.convert.types import ConvertError
try:
    run_convert(Path("stage.usda"), Path("a.glb"), target={target!r})
except ConvertError as error:
    sys.exit(f"{{error.name}}: {{error.message}}")
"""
    (folder / "stage.usda").write_bytes(USDA)
    command = [sys.executable, "-c", program]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@needs_linux
@pytest.mark.parametrize("soft_only", [False, True])
@pytest.mark.parametrize(
    ("kind", "limit"),
    [(resource.RLIMIT_CPU, 60), (resource.RLIMIT_AS, 2 << 30), (resource.RLIMIT_FSIZE, 1 << 20)],
)
def test_lower_inherited_limits_do_not_hinder(
    tmp_path: Path, kind: int, limit: int, soft_only: bool
) -> None:
    hard = resource.getrlimit(kind)[1] if soft_only else limit
    done = limited(tmp_path, "reflet_usd.convert:convert_stage", kind, limit, hard)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "a.glb").exists()


@needs_linux
@pytest.mark.parametrize(
    ("target", "kind", "limit", "name", "option"),
    [
        ("spin", resource.RLIMIT_CPU, 2, "cpu-limit", "ulimit -t"),
        ("spin", resource.RLIMIT_CPU, 1, "cpu-limit", "ulimit -t"),
        ("eat_memory", resource.RLIMIT_AS, 9 << 27, "memory-limit", "ulimit -v"),
        ("write_small", resource.RLIMIT_AS, 1 << 29, "memory-limit", "ulimit -v"),
        ("write_one_large", resource.RLIMIT_FSIZE, 1 << 20, "output-limit", "ulimit -f"),
    ],
)
def test_an_inherited_limit_that_is_reached_is_named_with_what_raises_it(
    tmp_path: Path, target: str, kind: int, limit: int, name: str, option: str
) -> None:
    done = limited(tmp_path, f"sandbox_targets:{target}", kind, limit, limit)
    assert done.stderr.startswith(f"{name}: ")
    assert option in done.stderr
    assert not (tmp_path / "a.glb").exists()


def test_a_stage_that_is_no_file_is_called_what_it_is(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.usda")
    (tmp_path / "link.usda").symlink_to(tmp_path / "nowhere.usda")
    (tmp_path / "folder.usda").mkdir()
    for name, what in (
        ("pipe", "is a named pipe"),
        ("link", "is a link to nothing"),
        ("folder", "is a folder"),
        ("none", "does not exist"),
    ):
        with refused("stage-missing", what):
            run_convert(tmp_path / f"{name}.usda", tmp_path / "a.glb")


def test_an_earlier_output_survives_a_failure(tmp_path: Path) -> None:
    run(tmp_path, "write_small")
    with pytest.raises(ConvertError):
        run(tmp_path, "crash")
    assert (tmp_path / "out" / "a.glb").read_bytes() == USDA


def test_crash_says_what_to_do(tmp_path: Path) -> None:
    error = failure(tmp_path, "crash")
    assert "SIGSEGV" in error.message
    assert error.path.endswith("stage.usda")


@needs_linux
def test_other_folders_cannot_be_read_or_written(tmp_path: Path) -> None:
    (tmp_path / "secret.txt").write_text("the secret")
    error = failure(tmp_path, "read_outside")
    assert "the secret" not in error.message
    assert "PermissionError" in error.message
    assert "PermissionError" in failure(tmp_path, "write_outside").message


@needs_linux
def test_an_extra_root_can_be_read(tmp_path: Path) -> None:
    extra = tmp_path / "textures"
    extra.mkdir()
    (extra / "texture.txt").write_text("wood")
    run(tmp_path, "read_extra_root", options=ConvertOptions(extra_roots=(extra,)))
    assert (tmp_path / "out" / "a.glb").read_text() == "wood"


@needs_linux
def test_the_network_is_not_reachable(tmp_path: Path) -> None:
    message = failure(tmp_path, "connect").message
    assert "PermissionError" in message or "Network is unreachable" in message


@pytest.mark.parametrize(
    ("stage", "out", "name"),
    [
        ("none.usda", "a.glb", "stage-missing"),
        (".", "a.glb", "stage-missing"),
        ("a.txt", "a.glb", "stage-suffix"),
        ("a.usda", "a.obj", "output-suffix"),
        ("a.usda", "none/a.glb", "output-folder-missing"),
    ],
)
def test_wrong_names_are_refused_first(tmp_path: Path, stage: str, out: str, name: str) -> None:
    (tmp_path / "a.txt").write_text("x")
    (tmp_path / "a.usda").write_bytes(USDA)
    with refused(name):
        run_convert(tmp_path / stage, tmp_path / out)


def package(entries: list[tuple[str, bytes]], compression: int = zipfile.ZIP_STORED) -> bytes:
    """A zip archive of the entries."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", compression) as archive:
        for name, data in entries:
            archive.writestr(name, data)
    return stream.getvalue()


def overlapping() -> bytes:
    """A zip archive with two directory entries that share one body, as in zip bombs."""
    data = package([("a.usda", bytes(4096)), ("b.bin", bytes(4096))])
    first = data.index(b"PK\1\2")
    second = data.index(b"PK\1\2", first + 4)
    patched = bytearray(data)
    patched[second + 42 : second + 46] = struct.pack("<I", 0)
    body_end = data.index(b"PK\3\4", 4)
    return bytes(patched[:body_end]) + shrunk_directory(bytes(patched), first, body_end)


def shrunk_directory(data: bytes, start: int, new_start: int) -> bytes:
    """The central directory from `start`, with its own offset set to `new_start`."""
    tail = bytearray(data[start:])
    end = tail.rindex(b"PK\5\6")
    tail[end + 16 : end + 20] = struct.pack("<I", new_start)
    return bytes(tail)


NESTED = package([("a.usda", USDA)])
for _ in range(6):
    NESTED = package([("a.usda", USDA), ("b.usdz", NESTED)])

BAD_PACKAGES = [
    (b"", "usdz-broken"),
    (b"PK\3\4" + bytes(100), "usdz-broken"),
    (package([]), "usdz-empty"),
    (package([("a.png", b"x")]), "usdz-root"),
    (package([("a.usda", USDA)], zipfile.ZIP_DEFLATED), "usdz-compressed"),
    (package([("../../a.usda", USDA)]), "usdz-path"),
    (package([("/etc/a.usda", USDA)]), "usdz-path"),
    (package([("a.usda", USDA), ("x\\..\\..\\b.png", b"")]), "usdz-path"),
    (package([("a.usda", USDA), ("C:/b.png", b"")]), "usdz-path"),
    (
        package([("a.usda", USDA), ("bomb.png", bytes(1 << 20))], zipfile.ZIP_DEFLATED),
        "usdz-ratio",
    ),
    (package([("a.usda", USDA)] + [(f"{i}.png", b"") for i in range(5000)]), "usdz-entries"),
    (NESTED, "usdz-nested"),
    (overlapping(), "usdz-overlap"),
]


@pytest.mark.parametrize(
    ("data", "name"), BAD_PACKAGES, ids=lambda x: x if isinstance(x, str) else ""
)
def test_bad_packages_are_refused_before_usd_sees_them(
    tmp_path: Path, data: bytes, name: str
) -> None:
    stage = tmp_path / "a.usdz"
    stage.write_bytes(data)
    with refused(name):
        run_convert(stage, tmp_path / "a.glb")
    assert [path.name for path in tmp_path.iterdir()] == ["a.usdz"]


def test_total_size_of_a_package_is_limited(tmp_path: Path) -> None:
    stage = tmp_path / "a.usdz"
    stage.write_bytes(package([("a.usda", USDA), ("b.png", bytes(1000))]))
    check_package(stage)
    with refused("usdz-size"):
        check_package(stage, PackageLimits(unpacked_bytes=1000))


def test_every_package_of_the_corpus_that_usd_opens_passes(corpus: Path) -> None:
    refused = []
    for stage in corpus.rglob("*.usdz"):
        try:
            check_package(stage)
        except ConvertError as error:
            refused.append(f"{stage.name}: {error.name}")
    # The first file of this package is an Alembic cache, which usd-core does not open either.
    assert refused == ["alembic.usdz: usdz-root"]
