"""Owns running the Khronos glTF validator (npm package `gltf-validator`) through node."""

import dataclasses
import json
import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

ENVIRONMENT = "REFLET_GLTF_VALIDATOR"
_PACKAGE = "gltf-validator"
_DRIVER = Path(__file__).resolve().parent.parent / "validate_gltf.js"
_TIMEOUT_S = 600


class ValidatorMissingError(Exception):
    """Node or the package is not installed; the message gives the command that installs it."""


@dataclasses.dataclass
class KhronosReport:
    """Validator report of one file."""

    errors: int
    warnings: int
    infos: int
    version: str
    messages: list[dict[str, Any]]
    crash: str = ""
    """Error of the validator itself; empty if it finished."""


def find_package() -> Path:
    """The validator's package folder; raises ValidatorMissingError.

    Searched: the folder in REFLET_GLTF_VALIDATOR (the package or a node_modules that holds it),
    `tools/node_modules`, then npm's global folder.
    """
    places = []
    if os.environ.get(ENVIRONMENT):
        chosen = Path(os.environ[ENVIRONMENT])
        places += [chosen, chosen / _PACKAGE, chosen / "node_modules" / _PACKAGE]
    else:
        places.append(_DRIVER.parent.parent / "node_modules" / _PACKAGE)
        places += [root / _PACKAGE for root in _global_roots()]
    for place in places:
        if (place / "package.json").is_file():
            return place.resolve()
    if os.environ.get(ENVIRONMENT):
        raise ValidatorMissingError(
            f"{ENVIRONMENT} is {os.environ[ENVIRONMENT]!r}, which holds no {_PACKAGE} package"
        )
    raise ValidatorMissingError(
        f"the npm package {_PACKAGE} is not installed; run tools/setup.sh,"
        f" or npm install --prefix tools {_PACKAGE}"
    )


def check_files(files: Sequence[Path]) -> list[KhronosReport]:
    """Validate several files in one node process; raises ValidatorMissingError."""
    node = shutil.which("node")
    if node is None:
        raise ValidatorMissingError(
            "node is not installed; the Khronos validator needs Node.js 18+"
        )
    command = [node, str(_DRIVER), str(find_package())]
    lines = "\n".join(str(Path(file).resolve()) for file in files) + "\n"
    done = subprocess.run(
        command, input=lines, capture_output=True, text=True, timeout=_TIMEOUT_S, check=False
    )
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    if len(answers) != len(files):
        raise ValidatorMissingError(
            f"the Khronos validator did not run: {done.stderr.strip()[-500:]}"
        )
    return [_report(answer) for answer in answers]


def _report(answer: dict[str, Any]) -> KhronosReport:
    if "failure" in answer:
        code = "VALIDATOR_CRASHED" if answer.get("crashed") else "UNREADABLE"
        message = {"severity": 0, "code": code, "message": answer["failure"]}
        return KhronosReport(
            1, 0, 0, "", [message], answer["failure"] if answer.get("crashed") else ""
        )
    return KhronosReport(
        answer["errors"],
        answer["warnings"],
        answer["infos"],
        answer["version"],
        answer["messages"],
    )


def _global_roots() -> list[Path]:
    """Folders in which npm keeps global packages, without starting npm (it takes a second)."""
    node = shutil.which("node")
    prefix = Path(node).resolve().parent.parent if node else Path("/usr")
    roots = [prefix / "lib" / "node_modules", Path("/usr/lib/node_modules")]
    roots.append(Path("/usr/local/lib/node_modules"))
    return list(dict.fromkeys(roots))
