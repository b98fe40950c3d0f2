"""Owns the conversion of untrusted stages: a confined child process, and names for its failures.

The child (`sandbox_child.py`) writes into a staging folder beside the output; only a finished,
reported result is moved to its place, so a crash or a limit never leaves a partial output.
"""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import resource
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from . import convert
from .atomic_output import move_output, tree_bytes
from .child_processes import Children, end
from .process_isolation import inherited
from .usdz_check import check_referenced

_CONVERT_TARGET = "reflet_usd.convert:convert_stage"
_CONVERT_OPTIONS = "reflet_usd.convert:ConvertOptions"
_POLL_S = 0.05
_STAGING = ".reflet-usd-"
_MOST_NAME_BYTES = 220
"""Maximum length of the output's name: the system's 255, less the endings of files beside it."""
_LOG_TAIL_CHARS = 2000
_KINDS = {
    stat.S_IFDIR: "is a folder",
    stat.S_IFIFO: "is a named pipe (FIFO)",
    stat.S_IFSOCK: "is a socket",
    stat.S_IFCHR: "is a device",
    stat.S_IFBLK: "is a device",
}
_OUT_OF_MEMORY = ("bad_alloc", "MemoryError", "Cannot allocate memory", "failed to map segment")
# The USD libraries, numpy and the interpreter map so much before a stage is read.
_LEAST_MEMORY_BYTES = 9 << 27
# Field of `Limits` and the shell's command, by the name of the error.
_ULIMITS = {
    "memory-limit": ("memory_bytes", "ulimit -v"),
    "cpu-limit": ("cpu_s", "ulimit -t"),
    "output-limit": ("output_bytes", "ulimit -f"),
}
_USD_SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")


@dataclasses.dataclass(frozen=True)
class Limits:
    """Limits of the child process of one conversion."""

    memory_bytes: int = 6 << 30
    """Maximum address space."""
    cpu_s: int = 300
    """Maximum processor time over all threads."""
    wall_s: float = 600.0
    """Maximum wall-clock time."""
    output_bytes: int = 4 << 30
    """Maximum size of all written files together, and of each one."""
    inherited: tuple[str, ...] = ()
    """Names of the limits above that come from the calling process (`ulimit`)."""

    def with_inherited(self) -> Limits:
        """These limits, each lowered to the limit that this process has inherited."""
        kinds = {
            "memory_bytes": resource.RLIMIT_AS,
            "cpu_s": resource.RLIMIT_CPU,
            "output_bytes": resource.RLIMIT_FSIZE,
        }
        lower = {name: inherited(kind, getattr(self, name)) for name, kind in kinds.items()}
        names = tuple(name for name in kinds if lower[name] < getattr(self, name))
        return dataclasses.replace(self, **lower, inherited=names)


def run_convert(
    stage: Path,
    out: Path,
    options: Any = None,
    *,
    limits: Limits | None = None,
    target: str = _CONVERT_TARGET,
    children: Children | None = None,
) -> convert.ConvertResult:
    """Convert `stage` to `out` in a confined child process; moves the files only on success.

    `options` is a ConvertOptions; its `extra_roots` are folders besides the stage's own that
    may be read. `target` names the function the child calls ("module:function"); `children`
    registers the child while it runs, so that a signal can end it.
    Raises ConvertError with a name for each way to fail: `stage-missing`, `usdz-*`,
    `memory-limit`, `cpu-limit`, `time-limit`, `output-limit`, `usd-crash`,
    `converter-internal`, and whatever the converter itself names.
    """
    options = options if options is not None else convert.ConvertOptions()
    out = _checked_output(Path(out))
    confined = run_confined(
        stage, options, target=target, out=out, limits=limits, children=children
    )
    with confined as (result, produced):
        move_output(produced, out, Path(stage), (limits or Limits()).output_bytes)
        return convert.ConvertResult(**result)


@contextlib.contextmanager
def run_confined(
    stage: Path,
    options: Any,
    *,
    target: str,
    out: Path | None = None,
    limits: Limits | None = None,
    children: Children | None = None,
) -> Iterator[tuple[dict[str, Any], Path]]:
    """Call `target(stage, out, options)` in a confined child; yields what it returned, and where.

    The result comes as the dictionary of the dataclass that the target returned; the folder with
    the files it wrote (made beside `out`, by default in the system's temporary one) is removed
    when the block ends. `options` is a ConvertOptions or a dictionary. Raises as `run_convert`.
    """
    limits = (limits or Limits()).with_inherited()
    stage = _checked_stage(Path(stage))
    if "memory_bytes" in limits.inherited and limits.memory_bytes < _LEAST_MEMORY_BYTES:
        needs = f"USD needs {_LEAST_MEMORY_BYTES} bytes of addresses to start, not"
        needs += f" {limits.memory_bytes}{_who_raises('memory-limit', limits)}"
        raise convert.ConvertError("memory-limit", needs, str(stage))
    out = out or Path(tempfile.gettempdir(), "out.glb")
    staging = _make_staging(out.parent)
    try:
        (staging / "out").mkdir()
        job = _job(stage, staging / "out" / out.name, options, staging, limits, target)
        exit_code, stopped_by = _run_child(job, staging, limits, children or Children())
        outcome = _read_outcome(staging, exit_code, stopped_by, stage, limits)
        result = _result(outcome, limits)
        for notice in outcome.get("notices", []):
            print(f"note: {notice}", file=sys.stderr)
        yield result, staging / "out"
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def _make_staging(folder: Path) -> Path:
    _sweep(folder)
    try:
        return Path(tempfile.mkdtemp(prefix=f"{_STAGING}{os.getpid()}-", dir=folder))
    except OSError as error:
        message = f"no file can be made in {folder}: {error.strerror}"
        raise convert.ConvertError("output-unwritable", message, str(folder)) from error


def _sweep(folder: Path) -> None:
    """Remove the staging folders of killed runs; only Linux tells which runs are still alive."""
    if not Path("/proc/self").exists():
        return
    for left in folder.glob(f"{_STAGING}*"):
        owner = left.name[len(_STAGING) :].partition("-")[0]
        if owner.isdigit() and not Path("/proc", owner).exists() and not left.is_symlink():
            shutil.rmtree(left, ignore_errors=True)


def _checked_output(out: Path) -> Path:
    name_bytes = len(os.fsencode(out.name))
    if name_bytes > _MOST_NAME_BYTES:
        message = f"its name has {name_bytes} bytes; use at most {_MOST_NAME_BYTES}"
        raise convert.ConvertError("output-unwritable", message, str(out))
    _check_utf8(out)
    try:
        os.stat(out.absolute().parent)
    except FileNotFoundError:
        pass  # the caller reports it
    except OSError as error:
        message = f"it cannot be written: {error.strerror}"
        raise convert.ConvertError("output-unwritable", message, str(out)) from error
    if not out.parent.is_dir():
        raise convert.ConvertError(
            "output-folder-missing", f"{out.parent} is not a folder; make it first", str(out)
        )
    if out.suffix.lower() not in (".glb", ".gltf"):
        raise convert.ConvertError(
            "output-suffix", f"{out.name}: expected a name that ends in .glb or .gltf", str(out)
        )
    if out.is_dir():
        message = f"{out} is a folder; name a file, or remove it"
        raise convert.ConvertError("output-unwritable", message, str(out))
    return out.absolute()


def _check_utf8(path: Path) -> None:
    """Raise an error where the path is not UTF-8, in which USD and glTF name files."""
    try:
        str(path.absolute()).encode()
    except UnicodeEncodeError as error:
        message = "its path is not UTF-8; rename the file or its folder"
        raise convert.ConvertError("name-not-utf8", message, str(path)) from error


def _checked_stage(stage: Path) -> Path:
    _check_utf8(stage)
    what = _other_than_file(stage)
    if what is not None:
        raise convert.ConvertError("stage-missing", f"{what}; name a USD file", str(stage))
    if stage.suffix.lower() not in _USD_SUFFIXES:
        expected = ", ".join(_USD_SUFFIXES)
        raise convert.ConvertError("stage-suffix", f"expected one of {expected}", str(stage))
    stage = stage.resolve()
    check_referenced(str(stage))
    return stage


def _other_than_file(path: Path) -> str | None:
    """Phrase for the kind of `path` where it is no plain file; else None."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        return "is a link to nothing" if path.is_symlink() else "does not exist"
    except OSError as error:
        return f"cannot be looked at ({error.strerror})"
    return None if stat.S_ISREG(mode) else _KINDS.get(stat.S_IFMT(mode), "is no plain file")


def _job(
    stage: Path, out: Path, options: Any, staging: Path, limits: Limits, target: str
) -> dict[str, Any]:
    values = dict(options) if isinstance(options, dict) else dataclasses.asdict(options)
    for root in values.get("extra_roots") or ():
        _check_utf8(Path(root))
    extra_roots = [str(Path(root).resolve()) for root in values.get("extra_roots") or ()]
    if extra_roots:
        values["extra_roots"] = extra_roots  # absolute, since the child runs in another folder
    return {
        "stage": str(stage),
        "out": str(out),
        "staging": str(staging),
        "target": target,
        "options": values,
        "options_type": None if isinstance(options, dict) else _CONVERT_OPTIONS,
        "read_roots": [str(stage.parent), *extra_roots],
        "sys_path": [str(Path(__file__).resolve().parent.parent), *filter(None, sys.path)],
        "limits": dataclasses.asdict(limits),
    }


def _run_child(
    job: dict[str, Any], staging: Path, limits: Limits, children: Children
) -> tuple[int, str | None]:
    """Run the child to its end; returns its exit code and the limit that stopped it, if any."""
    command = [sys.executable, "-I", str(Path(__file__).with_name("sandbox_child.py"))]
    with (
        (staging / "log.txt").open("wb") as log,
        children.started(
            command,
            stdin=subprocess.PIPE,
            stdout=_progress_stream(),
            stderr=log,
            cwd=staging,
            env=_environment(staging),
        ) as child,
    ):
        assert child.stdin is not None
        try:
            child.stdin.write(json.dumps(job, default=str).encode())
            child.stdin.close()
        except BrokenPipeError:
            pass  # the child ended early; its exit code and log tell why
        return _watch(child, staging, limits)


def _watch(child: subprocess.Popen[bytes], staging: Path, limits: Limits) -> tuple[int, str | None]:
    deadline = time.monotonic() + limits.wall_s
    while True:
        try:
            return child.wait(_POLL_S), None
        except subprocess.TimeoutExpired:
            pass
        if time.monotonic() > deadline:
            end(child)
            return -signal.SIGKILL, "time-limit"
        if tree_bytes(staging) > limits.output_bytes:
            end(child)
            return -signal.SIGKILL, "output-limit"


def _environment(staging: Path) -> dict[str, str]:
    """A small, fixed environment: no variable of the caller's steers USD's plugins or resolvers."""
    return {
        "PATH": os.defpath,
        "LANG": "C.UTF-8",
        "TMPDIR": str(staging),
        "HOME": str(staging),
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "1",
        "PXR_WORK_THREAD_LIMIT": "1",
        "PYTHONHASHSEED": "0",
    }


def _progress_stream() -> int | None:
    """Terminal for the progress lines on the child's standard output, where there is one."""
    try:
        return sys.stderr.fileno()
    except (OSError, ValueError, AttributeError):
        return subprocess.DEVNULL


def _read_outcome(
    staging: Path, exit_code: int, stopped_by: str | None, stage: Path, limits: Limits
) -> dict[str, Any]:
    log = _log_tail(staging)
    if stopped_by is None and exit_code == 0:
        try:
            return json.loads((staging / "result.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            pass
    name, message = _failure(exit_code, stopped_by, log, stage, limits)
    if name == "usd-crash" and log:
        message += f"\nits last words:\n{log}"
    raise convert.ConvertError(name, message, str(stage))


def _failure(
    exit_code: int, stopped_by: str | None, log: str, stage: Path, limits: Limits
) -> tuple[str, str]:
    """Name and message of the failure of a child that ended without a report."""
    if stopped_by == "time-limit":
        longer = "`--time-limit SECONDS` gives it longer (for `report`: `--wall-s`)"
        return "time-limit", f"not done within {limits.wall_s:g} s; {longer}"
    if stopped_by == "output-limit" or exit_code == -signal.SIGXFSZ:
        return "output-limit", _limit_message("output-limit", limits)
    # At an inherited limit of 1 s no second is left for the signal that tells why.
    ended = (-signal.SIGXCPU, -signal.SIGKILL) if limits.cpu_s == 1 else (-signal.SIGXCPU,)
    if exit_code in ended:
        return "cpu-limit", _limit_message("cpu-limit", limits)
    if any(word in log for word in _OUT_OF_MEMORY):
        return "memory-limit", _limit_message("memory-limit", limits)
    if exit_code < 0:
        try:
            signal_name = signal.Signals(-exit_code).name
        except ValueError:
            signal_name = f"signal {-exit_code}"
        raised = _who_raises("memory-limit", limits)
        memory = f"; or it ran out of its memory limit of {limits.memory_bytes} bytes{raised}"
        may_be_memory = memory if raised else ""
        return (
            "usd-crash",
            f"the USD library ended with {signal_name} while it read this stage;"
            f" open it with usdchecker, or export it again{may_be_memory}",
        )
    return "converter-internal", f"the conversion ended with {exit_code}\n{log}"


def _limit_message(name: str, limits: Limits) -> str:
    """Message about a limit that was reached, and how to raise it."""
    if name == "output-limit":
        message = f"the output grew past {limits.output_bytes} bytes"
    elif name == "cpu-limit":
        message = f"used more than {limits.cpu_s} s of processor time"
        if "cpu_s" not in limits.inherited:
            message += "; `--cpu-limit SECONDS` gives it longer"
    else:
        message = f"needs more than the memory limit of {limits.memory_bytes} bytes"
    return message + _who_raises(name, limits)


def _who_raises(name: str, limits: Limits) -> str:
    """Part of a message about an inherited limit that tells how to raise it; else empty."""
    field, command = _ULIMITS[name]
    if field not in limits.inherited:
        return ""
    return f", which this program was started with; raise it by `{command}`"


def _result(outcome: dict[str, Any], limits: Limits) -> dict[str, Any]:
    error = outcome.get("error")
    if error:
        cause = RuntimeError(outcome["traceback"]) if "traceback" in outcome else None
        name = error["name"]
        message = _limit_message(name, limits) if name in _ULIMITS else error["message"]
        raise convert.ConvertError(name, message, error["path"]) from cause
    return outcome["result"]


def _log_tail(staging: Path) -> str:
    try:
        data = (staging / "log.txt").read_bytes()[-_LOG_TAIL_CHARS:]
    except OSError:
        return ""
    return data.decode("utf-8", "replace").strip()
