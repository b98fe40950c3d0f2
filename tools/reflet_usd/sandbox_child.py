"""Owns the process that converts one untrusted stage: confine itself, convert, report as JSON.

Run by path (`python -I sandbox_child.py`) with one JSON job on standard input; see
`sandbox.run_convert`, which is its only caller. Standard library only until confined.
"""

import dataclasses
import errno
import importlib
import json
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

# Folders and files that the interpreter, the dynamic loader and the USD libraries read.
_SYSTEM_ROOTS = ("/usr", "/lib", "/lib64", "/etc/ld.so.cache", "/etc/localtime", "/dev/urandom")
_DEVICES = ("/dev/null", "/dev/zero")


def main() -> int:
    """Read the job, confine this process, run the target, write `result.json`."""
    job = json.load(sys.stdin)
    staging = Path(job["staging"])
    sys.path[:0] = [entry for entry in job["sys_path"] if entry not in sys.path]
    notices = _confine(job, staging)
    outcome = _outcome(job)
    outcome["notices"] = notices
    text = json.dumps(outcome, default=str)
    (staging / "result.json").write_text(text, encoding="utf-8")
    return 0


def _confine(job: dict[str, Any], staging: Path) -> list[str]:
    """Apply every limit; returns descriptions of failures."""
    # Imported here, because the package is found through the job's sys_path.
    isolation = importlib.import_module("reflet_usd.process_isolation")
    isolation.die_with_parent()
    notices = []
    reason = isolation.drop_network()
    if reason and isolation.network_reachable():
        notices.append(f"the network stays reachable during conversion ({reason})")
    python = [sys.prefix, sys.base_prefix, *filter(None, sys.path), *_SYSTEM_ROOTS]
    reads = [Path(root) for root in [*job["read_roots"], *python]]
    reason = isolation.confine_files(reads, [staging, *map(Path, _DEVICES)])
    if reason:
        notices.append(f"other folders stay readable during conversion ({reason})")
    limits = job["limits"]
    isolation.apply_limits(limits["memory_bytes"], limits["cpu_s"], limits["output_bytes"])
    return notices


def _outcome(job: dict[str, Any]) -> dict[str, Any]:
    try:
        result = _target(job["target"])(
            Path(job["stage"]), Path(job["out"]), _options(job["options_type"], job["options"])
        )
        return {"result": dataclasses.asdict(result)}
    except MemoryError:
        return _error("memory-limit", "", job)  # the parent tells the limit
    except RecursionError:
        return _error("too-deep", "the stage nests deeper than the converter follows", job)
    except ModuleNotFoundError as error:
        if (error.name or "").startswith("reflet_usd"):
            return _internal(error, job)
        message = f"the Python package {error.name!r} is missing; run tools/setup.sh"
        return _error("package-missing", message, job)
    except ImportError as error:
        if "failed to map segment" in str(error):  # the loader's words where addresses run out
            return _error("memory-limit", "", job)
        return _internal(error, job)
    except OSError as error:
        if error.errno == errno.EFBIG:
            return _error("output-limit", "", job)
        return _internal(error, job)
    except Exception as error:  # the process boundary: everything becomes a named error
        # Told by attributes, not class: a target of another package may have its own errors.
        named: Any = error
        if all(hasattr(error, name) for name in ("name", "message", "path")):
            return _error(named.name, named.message, {"stage": named.path or job["stage"]})
        return _internal(error, job)


def _internal(error: Exception, job: dict[str, Any]) -> dict[str, Any]:
    frames = traceback.extract_tb(error.__traceback__)
    place = f"{Path(frames[-1].filename).name}:{frames[-1].lineno}" if frames else "?"
    outcome = _error("converter-internal", f"{type(error).__name__} at {place}: {error}", job)
    outcome["traceback"] = traceback.format_exc()
    return outcome


def _error(name: str, message: str, job: dict[str, Any]) -> dict[str, Any]:
    return {"error": {"name": name, "message": message, "path": str(job["stage"])}}


def _target(reference: str) -> Callable[..., Any]:
    module, _, attribute = reference.partition(":")
    return getattr(importlib.import_module(module), attribute)


def _options(reference: str | None, values: dict[str, Any]) -> Any:
    return _target(reference)(**values) if reference else values


if __name__ == "__main__":
    sys.exit(main())
