"""Owns the check of a file against an untrusted stage, in the sandbox's child with its limits."""

import dataclasses
import os
from pathlib import Path
from typing import Any

from reflet_usd.child_processes import Children
from reflet_usd.convert.types import ConvertError
from reflet_usd.sandbox import Limits, run_confined
from reflet_usd.usdz_check import check_referenced

from .khronos import KhronosReport

_TARGET = "reflet_usd.validate.confined:validate_here"


@dataclasses.dataclass
class Verdict:
    """Result of one check, as plain data."""

    validation: dict[str, Any]
    """Data from `Validation.to_json`."""
    text: str
    """Table for people."""


def validate_confined(
    out: Path,
    stage: Path,
    khronos: KhronosReport | None,
    *,
    limits: Limits | None = None,
    children: Children | None = None,
) -> Verdict:
    """Compare `out` with `stage` in a confined child process; `khronos` joins the verdict.

    The child may read the folders of both and the folders that the sidecar records. Raises
    ConvertError like `sandbox.run_confined`, and with `stage-unreadable` or `validate-internal`.
    """
    from .sidecar import read_sidecar

    out = out.resolve()
    sidecar, _ = read_sidecar(out)
    recorded = sidecar.get("info", {}).get("roots") or ()
    roots = [root for root in recorded if os.path.isdir(root)]
    options = {
        "file": str(out),
        "khronos": None if khronos is None else dataclasses.asdict(khronos),
        "roots": roots,
        "extra_roots": [str(out.parent), *roots],
    }
    try:
        with run_confined(stage, options, target=_TARGET, limits=limits, children=children) as (
            result,
            _,
        ):
            return Verdict(**result)
    except ConvertError as error:
        if error.name != "converter-internal":
            raise
        message = f"the check could not run: {error.message}"
        raise ConvertError("validate-internal", message, str(out)) from error


def validate_here(stage: Path, _out: Path, options: dict[str, Any]) -> Verdict:
    """Compare in this process."""
    from .scene_data import StageError
    from .validation import validate_file
    from .validation_table import format_validation

    _guard_layers(stage, options["roots"])
    try:
        validation = validate_file(Path(options["file"]), stage, khronos=False)
    except StageError as error:
        raise ConvertError("stage-unreadable", str(error)) from None
    if options["khronos"] is not None:
        validation.khronos = KhronosReport(**options["khronos"])
    return Verdict(validation.to_json(), format_validation(validation))


def _guard_layers(stage: Path, roots: list[str]) -> None:
    """Mute layers that are no plain files, on which USD would block, and check packages first."""
    from pxr import Ar, Sdf, Tf

    from reflet_usd.stage_files import is_plain_file, is_within, outer_file

    folders = tuple(os.path.realpath(root) for root in (str(stage.parent), *roots))
    waiting = [str(stage)]
    for identifier in waiting:  # the list grows during the loop
        try:
            layer = Sdf.Layer.FindOrOpen(identifier)
        except Tf.ErrorException:
            continue  # composing the stage reports it
        for asset in layer.GetCompositionAssetDependencies() if layer else ():
            found = layer.ComputeAbsolutePath(asset)
            resolved = Ar.GetResolver().Resolve(found).GetPathString()
            if not resolved or found in waiting:
                continue
            outer = outer_file(resolved)
            if not is_within(outer, folders) or not is_plain_file(outer):
                Sdf.Layer.AddToMutedLayers(found)
                continue
            check_referenced(outer)
            waiting.append(found)
