"""One conversion end to end: open, traverse, collect losses, write."""

import os
import shlex
from collections import Counter
from pathlib import Path
from typing import Any

from pxr import Tf, Usd

from reflet_usd.stage_files import error_text, outer_file

from .context import Context
from .environment import add_environment
from .gltf_writer import GltfWriter
from .ledger import Ledger
from .metadata import stage_metadata_extras
from .stage import open_context
from .traverse import Traversal
from .types import ConvertError, ConvertOptions, ConvertResult, warning_count

# Types of prims that only group others.
_GROUPS = ("", "Scope", "Xform")
_MOST_KINDS = 8


def run_pipeline(stage_path: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    """Convert `stage_path` to `out` and its sidecar; see `convert_stage`."""
    if out.suffix.lower() not in (".glb", ".gltf"):
        raise ConvertError("output-suffix", "expected a name that ends in .glb or .gltf", str(out))
    try:
        return convert_opened(open_context(stage_path, options, Ledger()), stage_path, out)
    except (Tf.ErrorException, UnicodeDecodeError) as error:
        raise ConvertError(
            "stage-damaged", error_text(error, stage_path), str(stage_path)
        ) from None


def convert_opened(context: Context, stage_path: Path, out: Path) -> ConvertResult:
    """Convert the opened stage of `context` to `out` and its sidecar; see `convert_stage`."""
    ledger = context.ledger
    writer = GltfWriter()
    roots = Traversal(context, writer).stage_roots()
    extras = _scene_extras(context)
    environment = add_environment(context, writer)
    if environment is not None:
        extras["usd"]["environment"] = environment
    writer.add_nodes(roots, {**extras, **stage_metadata_extras(context)})
    if not writer.lists.get("meshes"):
        _refuse_empty(context, stage_path)
        ledger.warn("stage-empty", "/", _empty_message(context.stage))
    counts = ledger.close(_prims(context.stage))
    files = _files_read(context)
    result = ConvertResult(
        ledger.warnings(), counts, _info(context, writer), files, sorted(context.files.absent)
    )
    if context.options.strict and result.warnings:
        first = result.warnings[0]
        message = (
            f"{warning_count(len(result.warnings))} under --strict, the first one:"
            f" {first.prim}: {first.message} [{first.name}]"
        )
        raise ConvertError("strict", message, str(stage_path))
    writer.write(out, result.to_json())
    return result


def _refuse_empty(context: Context, stage_path: Path) -> None:
    """Raise `asset-outside-roots` where the file is empty because layers were left out."""
    if context.files.outside:
        root = os.path.commonpath(sorted(context.files.outside))
        message = "nothing is left to draw, its layers are outside the allowed folders;"
        message += f" allow them with --root {shlex.quote(root)}"
        raise ConvertError("asset-outside-roots", message, str(stage_path))


def _empty_message(stage: Usd.Stage) -> str:
    """Message about a stage without meshes, with the types and numbers of its prims."""
    kinds = Counter(kind for _, kind in _prims(stage) if kind not in _GROUPS)
    if not kinds:
        return "the stage has no prims that could be drawn"
    has = ", ".join(f"{count} {kind}" for kind, count in kinds.most_common(_MOST_KINDS))
    more = len(kinds) - _MOST_KINDS
    rest = f" and prims of {more} other types" if more > 0 else ""
    return f"the stage has nothing that is drawn; it has {has}{rest}"


def _files_read(context: Context) -> list[str]:
    """Paths of all files that were read; files in a usdz package count as the package."""
    layers = [layer.realPath for layer in context.stage.GetUsedLayers()]
    documents = [path for found in context.files.documents.values() for path in found.files]
    paths = [path for path in (*layers, *documents, *context.textures_read) if path]
    return sorted({os.path.abspath(outer_file(path)) for path in paths})


def _prims(stage: Usd.Stage) -> list[tuple[str, str]]:
    predicate = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
    prims = Usd.PrimRange.Stage(stage, predicate)
    return [(str(prim.GetPath()), str(prim.GetTypeName())) for prim in prims]


def _scene_extras(context: Context) -> dict[str, Any]:
    """Scene extras that relate the file to the stage: units, time and axis."""
    return {
        "usd": {
            "metersPerUnit": context.meters_per_unit,
            "timeCodesPerSecond": context.codes_per_second,
            "timeOrigin": context.time_origin,
            "startTimeCode": context.stated_codes[0],
            "endTimeCode": context.stated_codes[1],
            "upAxis": "Z" if context.z_up else "Y",
        }
    }


def _info(context: Context, writer: GltfWriter) -> dict[str, Any]:
    counted = ("meshes", "materials", "images", "nodes", "cameras", "lights", "skins", "animations")
    info: dict[str, Any] = {name: len(writer.lists.get(name, [])) for name in counted}
    info.update(_scene_extras(context)["usd"])
    options = context.options
    info["frames"] = None if options.frames is None else list(options.frames)
    info["purpose"] = list(options.purpose)
    info["roots"] = [os.path.realpath(root) for root in options.extra_roots]
    info["subdivLevel"] = options.subdiv_level
    info["variants"] = [list(choice) for choice in options.variants]
    return info
