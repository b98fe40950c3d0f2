"""Owns the command `reflet-usd inspect`: contents of a stage, and warnings of a conversion."""

from __future__ import annotations

import argparse
import collections
import dataclasses
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reflet_usd.convert.types import ConvertError, ConvertOptions
from reflet_usd.limit_arguments import add_limits, limits_from
from reflet_usd.standard_output import show

if TYPE_CHECKING:
    from reflet_usd.convert.context import Context

_TARGET = "reflet_usd.inspect:summarize"
_SHOWN = 20


@dataclasses.dataclass
class StageSummary:
    """Contents of one stage, as plain data."""

    up_axis: str
    meters_per_unit: float | None
    """Meters per unit; None where the stage does not author it (USD then means 0.01)."""
    codes_per_second: float
    start_code: float | None
    """First time code of the stage's authored range; None where there is none."""
    end_code: float | None
    default_prim: str
    types: dict[str, int]
    """Number of prims by type name, instance proxies included."""
    layers: list[str]
    """File names of the layers that compose the stage, the root first."""
    missing_layers: list[str]
    assets: list[str]
    """Other files the stage names (textures, environment maps), as authored."""
    variants: dict[str, dict[str, list[str]]]
    """Variant names by prim path and set; the selected one first."""
    instances: int
    """Number of native instances."""
    warnings: list[dict[str, str]]
    """Warnings of a conversion with default options."""
    refusal: str
    """Reason why a conversion would be refused; empty where it would not."""


def summarize(stage_path: Path, out: Path, options: dict[str, Any]) -> StageSummary:
    """Read `stage_path` in this process; `out` is where a trial conversion may write."""
    from pxr import Tf

    from reflet_usd.stage_files import error_text

    try:
        return _summary(stage_path, out, options)
    except (Tf.ErrorException, UnicodeDecodeError) as error:
        reason = error_text(error, stage_path)
        raise ConvertError("stage-damaged", reason, str(stage_path)) from None


def _summary(stage_path: Path, out: Path, options: dict[str, Any]) -> StageSummary:
    from pxr import Usd

    from reflet_usd.convert.ledger import Ledger
    from reflet_usd.convert.stage import open_context

    # Opened like for a conversion, which repairs stages that usd-core hangs on.
    context = open_context(stage_path, ConvertOptions(**options), Ledger())
    stage = context.stage
    layer = stage.GetRootLayer()
    # Files found by the confined search: USD's own search would block on pipes.
    files = context.files
    used = {item.identifier for item in stage.GetUsedLayers() if not item.anonymous}
    layers = [*files.layers, *sorted(used - set(files.layers))]
    types: collections.Counter[str] = collections.Counter()
    variants = {}
    instances = 0
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
        if prim.IsPseudoRoot():
            continue
        types[prim.GetTypeName() or "untyped"] += 1
        instances += prim.IsInstance()
        sets = prim.GetVariantSets()
        if sets.GetNames():
            variants[str(prim.GetPath())] = {name: _choices(sets, name) for name in sets.GetNames()}
    warnings, refusal = _trial(context, stage_path, out)
    units = layer.pseudoRoot.GetInfo("metersPerUnit")
    has_range = stage.HasAuthoredTimeCodeRange()
    return StageSummary(
        "Z" if context.z_up else "Y",
        float(units) if layer.pseudoRoot.HasInfo("metersPerUnit") else None,
        context.codes_per_second,
        float(stage.GetStartTimeCode()) if has_range else None,
        float(stage.GetEndTimeCode()) if has_range else None,
        str(layer.defaultPrim),
        dict(sorted(types.items())),
        [_file_name(item) for item in layers],
        sorted(map(_file_name, files.missing)),
        sorted(map(_file_name, files.assets)),
        variants,
        instances,
        warnings,
        refusal,
    )


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of `reflet-usd inspect`."""
    parser.add_argument("stage", type=Path, metavar="STAGE", help="a .usd, .usda, .usdc or .usdz")
    parser.add_argument("--json", action="store_true", help="print JSON instead of text")
    parser.add_argument(
        "--root",
        action="append",
        default=[],
        type=Path,
        metavar="FOLDER",
        help="a folder besides the stage's own from which layers and textures may be read",
    )
    add_limits(parser)


def run(args: argparse.Namespace) -> int:
    """Inspect in a confined child process, print, and return the exit code."""
    from reflet_usd.sandbox import run_confined

    options = dataclasses.asdict(ConvertOptions(extra_roots=tuple(args.root)))
    limits = limits_from(args)
    with run_confined(args.stage, options, target=_TARGET, limits=limits) as (summary, _):
        pass
    show(json.dumps(summary, indent=2) if args.json else _format(args.stage, summary))
    return 0


def _choices(sets: Any, name: str) -> list[str]:
    chosen = sets.GetVariantSelection(name)
    names = sets.GetVariantSet(name).GetVariantNames()
    return sorted(names, key=lambda item: (item != chosen, item))


def _file_name(identifier: str) -> str:
    """File name without the folder, so that the summary does not depend on where the stage lies."""
    outer, bracket, inner = identifier.partition("[")
    return Path(outer).name + bracket + inner


def _trial(context: Context, stage_path: Path, out: Path) -> tuple[list[dict[str, str]], str]:
    """Warnings of a conversion whose output is discarded, or the reason why it is refused."""
    from pxr import Tf

    from reflet_usd.convert.pipeline import convert_opened
    from reflet_usd.stage_files import error_text

    try:
        result = convert_opened(context, stage_path, out)
    except ConvertError as error:
        return [], str(error)
    except (Tf.ErrorException, UnicodeDecodeError) as error:
        reason = error_text(error, stage_path)
        return [], str(ConvertError("stage-damaged", reason, str(stage_path)))
    return [warning.to_json() for warning in result.warnings], ""


def _format(stage: Path, summary: dict[str, Any]) -> str:
    units = summary["meters_per_unit"]
    length = "not authored (0.01 m)" if units is None else f"{units:g} m"
    lines = [
        f"{stage}",
        f"up axis {summary['up_axis']}, unit {length}, default prim"
        f" {summary['default_prim'] or 'none'}",
        _format_time(summary),
        "prims: " + ", ".join(f"{n} {kind}" for kind, n in summary["types"].items()),
    ]
    if summary["instances"]:
        lines.append(f"native instances: {summary['instances']}")
    for title in ("layers", "missing_layers", "assets"):
        if summary[title]:
            lines.append(f"{title.replace('_', ' ')}: " + ", ".join(summary[title]))
    for path, sets in list(summary["variants"].items())[:_SHOWN]:
        for name, choices in sets.items():
            lines.append(f"variants: {path}{{{name}={choices[0]}}} of {', '.join(choices)}")
    for warning in summary["warnings"][:_SHOWN]:
        lines.append(f"warning: {warning['prim']}: {warning['message']} [{warning['name']}]")
    if len(summary["warnings"]) > _SHOWN:
        lines.append(f"and {len(summary['warnings']) - _SHOWN} more warnings (--json has all)")
    lines.append(f"refused: {summary['refusal']}" if summary["refusal"] else "can be converted")
    return "\n".join(lines)


def _format_time(summary: dict[str, Any]) -> str:
    rate = f"{summary['codes_per_second']:g} time codes per second"
    if summary["start_code"] is None:
        return f"time range not authored, {rate}"
    return f"time codes {summary['start_code']:g} to {summary['end_code']:g}, {rate}"
