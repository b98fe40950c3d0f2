"""Keeps composition and textures inside the stage's folder and the explicitly allowed roots."""

import os
import re
import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pxr import Ar, Sdf, Tf, Usd, UsdShade, UsdUtils

from reflet_usd.materialx_document import Document, DocumentError, is_document, read_document, refer
from reflet_usd.stage_files import (
    is_packaged,
    is_plain_file,
    is_within,
    outer_file,
    rename,
    turn_separators,
)
from reflet_usd.stand_in import stand_in
from reflet_usd.usdz_check import check_referenced

from .ledger import Ledger
from .types import ConvertError

MAX_LAYERS = 20_000
_DICTIONARIES = ("assetInfo", "clips", "customData")
# Image files, which the texture reader names with their shader; the node's fallback value counts.
_IMAGES = ("png", "jpg", "jpeg", "tga", "bmp", "tif", "tiff", "exr", "hdr", "gif", "webp")


def allowed_roots(stage_path: Path, extra_roots: Sequence[Path]) -> tuple[str, ...]:
    """Real paths of the stage's folder and of every extra root."""
    for root in extra_roots:
        if not root.is_dir():
            raise ConvertError("root-missing", "--root names no folder", str(root))
    return tuple(os.path.realpath(root) for root in (stage_path.resolve().parent, *extra_roots))


def _folder(resolved: str) -> str:
    """The real folder of a resolved asset path (a package's outer file)."""
    return os.path.dirname(os.path.realpath(outer_file(resolved)))


def outside_message(asset: str, resolved: str) -> str:
    """Message about a file outside the allowed folders, with the option that allows it."""
    root = shlex.quote(_folder(resolved))
    return f"{asset} is outside the allowed folders; allow it with --root {root}"


def open_layer(identifier: str) -> Sdf.Layer | None:
    """The layer as it is on disk now, also where this process read it before."""
    known = Sdf.Layer.Find(identifier)
    if known is not None:
        known.Reload(force=True)
        return known
    return Sdf.Layer.FindOrOpen(identifier)


@dataclass
class Files:
    """Files that the layers of a stage name, whether or not they exist."""

    layers: list[str] = field(default_factory=list)
    """Identifiers of the layers that were read, the root first."""
    assets: set[str] = field(default_factory=set)
    """Other files that exist."""
    missing: set[str] = field(default_factory=set)
    """Asset paths that do not resolve, or were left out."""
    outside: set[str] = field(default_factory=set)
    """Folders with layers that the stage names, outside the allowed folders."""
    absent: set[str] = field(default_factory=set)
    """Paths of missing files, where an asset path stands for one plain and allowed file."""
    documents: dict[str, Document] = field(default_factory=dict)
    """MaterialX documents by path, with the layers that stand for them."""


@dataclass
class LeftOut:
    """An asset that a layer names and that must not be opened."""

    name: str
    """Name of the warning."""
    message: str
    layer: Sdf.Layer
    places: list[Sdf.Path]
    """The prims of the layer that name it."""


def cut_foreign_layers(
    root_layer: Sdf.Layer, roots: tuple[str, ...], files: Files
) -> tuple[list[Sdf.Layer], list[LeftOut]]:
    """Remove, in memory, every reference to a layer outside `roots`, before USD opens it.

    Returns all layers that were read, which the caller keeps alive while it composes the stage, and
    the removed ones.
    """
    layers = [root_layer]
    cut: list[LeftOut] = []
    seen = {root_layer.identifier}
    for layer in layers:  # the list grows during the loop
        files.layers.append(layer.identifier)
        turn_separators(layer)
        for identifier in _kept_dependencies(layer, roots, files, cut):
            if identifier in seen or len(layers) > MAX_LAYERS:
                continue
            seen.add(identifier)
            try:
                opened = open_layer(identifier)
            except Tf.ErrorException:
                continue  # composition names it as unresolved
            if opened is not None:
                layers.append(opened)
    return layers, cut


def _kept_dependencies(
    layer: Sdf.Layer, roots: tuple[str, ...], files: Files, cut: list[LeftOut]
) -> list[str]:
    kept: list[str] = []
    refused: dict[str, tuple[str, str]] = {}
    stand_ins: dict[str, str] = {}
    documents: set[str] = set()

    def judge(asset_path: str) -> str:
        if "`" not in asset_path:  # an expression; `check_used_layers` judges what it becomes
            fault = _fault(layer, asset_path, roots, files, kept)
            if fault is not None:
                refused[asset_path] = fault
            elif is_document(asset_path):
                documents.add(asset_path)
        return asset_path

    UsdUtils.ModifyAssetPaths(layer, judge)  # it swallows what its callback raises
    lost = {}
    for asset_path in sorted(documents):
        fault = _stand_in(layer, asset_path, roots, files, stand_ins)
        if fault is not None:
            lost[asset_path], stand_ins[asset_path] = fault, ""
    for asset_path, (name, message) in (refused | lost).items():
        files.missing.add(asset_path)
        cut.append(LeftOut(name, message, layer, _places(layer, asset_path)))
    if is_packaged(layer):
        _cut_in_package(layer, refused)
    elif refused:
        rename(layer, dict.fromkeys(refused, ""))
    for asset_path, identifier in stand_ins.items():
        refer(layer, asset_path, identifier)
    return kept


def _cut_in_package(layer: Sdf.Layer, refused: dict[str, tuple[str, str]]) -> None:
    """Remove the arcs to refused layers from a layer in a package, or raise ConvertError.

    UsdUtils changes no asset path there. Textures stay named, and are judged when they are read;
    value clips stay too, which USD would open.
    """
    for asset_path, fault in refused.items():
        refer(layer, asset_path, "")
        if _names_a_layer(asset_path) and _places(layer, asset_path):
            raise ConvertError(*fault, layer.identifier)


def _stand_in(
    layer: Sdf.Layer,
    asset_path: str,
    roots: tuple[str, ...],
    files: Files,
    stand_ins: dict[str, str],
) -> tuple[str, str] | None:
    """Read a MaterialX document as a layer; name and message of the reason where it is not."""
    path = Ar.GetResolver().Resolve(layer.ComputeAbsolutePath(asset_path)).GetPathString()
    if not path:
        return None  # composition names it as unresolved
    try:
        if path not in files.documents:
            files.documents[path] = read_document(path, roots)
    except DocumentError as error:
        return error.name, f"the MaterialX document @{asset_path}@ is not read: {error}"
    document = files.documents[path]
    named = [file for file in document.images if not Ar.IsPackageRelativePath(file)]
    files.absent.update(
        file for file in named if is_within(file, roots) and not os.path.exists(file)
    )
    stand_ins[asset_path] = document.layer.identifier
    return None


def _fault(
    layer: Sdf.Layer, asset_path: str, roots: tuple[str, ...], files: Files, kept: list[str]
) -> tuple[str, str] | None:
    """Name and message of the reason not to open the asset; else None, and `files` lists it."""
    if _is_outside(asset_path, roots):
        path = re.sub(r"^file:(//)?", "", asset_path)
        if _names_a_layer(path) and os.path.isfile(path):
            files.outside.add(_folder(path))
        return "asset-outside-roots", outside_message(f"@{asset_path}@", path)
    identifier = layer.ComputeAbsolutePath(asset_path)
    resolved = Ar.GetResolver().Resolve(identifier).GetPathString()
    if not resolved:
        tiles = [path for path, _ in UsdShade.UdimUtils.ResolveUdimTilePaths(asset_path, layer)]
        files.assets.update(tiles)
        files.missing.update(() if tiles else (identifier,))
        files.absent.update(_absent_file(layer, identifier, roots))
        return None
    if not is_plain_file(resolved):
        return "asset-not-a-file", f"@{asset_path}@ is a pipe, device or folder, it is not opened"
    is_layer, allowed = _names_a_layer(identifier), is_within(resolved, roots)
    if is_document(identifier) and not allowed:
        return "asset-outside-roots", outside_message(f"@{asset_path}@", resolved)
    if is_layer and not allowed:
        files.outside.add(_folder(resolved))
        return "asset-outside-roots", outside_message(f"the layer @{asset_path}@", resolved)
    if allowed:
        check_referenced(outer_file(resolved))
    if is_layer:
        with open(outer_file(resolved), "rb") as file:
            if found := stand_in(file.read(64)):
                return "asset-unresolved", f"@{asset_path}@ is {found}"
        kept.append(identifier)
    else:
        files.assets.add(identifier)
    return None


def _places(layer: Sdf.Layer, asset_path: str) -> list[Sdf.Path]:
    """The prims of the layer with a field that names the asset."""
    found: set[Sdf.Path] = set()

    def look(path: Sdf.Path) -> None:
        variant = path.IsPrimVariantSelectionPath()  # a variant's own spec has no fields
        spec = layer.GetPrimAtPath(path) if variant else layer.GetObjectAtPath(path)
        if asset_path in _named_by(spec):
            found.add(path.GetPrimPath().StripAllVariantSelections())

    layer.Traverse(Sdf.Path.absoluteRootPath, look)
    return sorted(found)


def _named_by(spec: Sdf.Spec) -> set[str]:
    """Asset paths in the arcs, asset values and dictionaries of a spec."""
    named: set[str] = set()
    if isinstance(spec, Sdf.PrimSpec):
        for arcs in (spec.referenceList, spec.payloadList):
            named.update(item.assetPath for item in arcs.GetAddedOrExplicitItems())
        values = [spec.GetInfo(name) for name in _DICTIONARIES if spec.HasInfo(name)]
    elif isinstance(spec, Sdf.AttributeSpec) and "asset" in str(spec.typeName):
        values = [spec.GetInfo(name) for name in ("default", "timeSamples") if spec.HasInfo(name)]
    else:
        return named
    while values:
        value = values.pop()
        if isinstance(value, Sdf.AssetPath):
            named.add(value.path)
        elif isinstance(value, dict):
            values.extend(value.values())
        elif isinstance(value, Sdf.AssetPathArray):
            values.extend(value)
    return named


def warn_left_out(stage: Usd.Stage, cut: list[LeftOut], ledger: Ledger) -> None:
    """Name each asset that was left out, at the prims of the stage that it would have fed."""
    wanted: dict[tuple[str, Sdf.Path], list[LeftOut]] = {}
    for item in cut:
        for place in item.places:
            wanted.setdefault((item.layer.identifier, place), []).append(item)
    told: set[int] = set()
    everything = Usd.TraverseInstanceProxies(Usd.PrimAllPrimsPredicate)
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), everything) if wanted else ():
        for spec in prim.GetPrimStack():
            place = spec.path.StripAllVariantSelections()
            for item in wanted.get((spec.layer.identifier, place), ()):
                ledger.warn(item.name, prim, item.message)
                told.add(id(item))
    for item in cut:
        if id(item) not in told:  # sublayers, and prims that nothing on the stage uses
            ledger.warn(item.name, "/", item.message)


def warn_missing_clips(stage: Usd.Stage, roots: tuple[str, ...], ledger: Ledger) -> None:
    """Name the value clips that cannot be read: USD drops their animation silently."""
    for prim in stage.TraverseAll():
        if not prim.HasAuthoredMetadata("clips"):
            continue
        for name, clip_set in sorted(prim.GetMetadata("clips").items()):
            if not isinstance(clip_set, dict):
                continue
            try:
                paths = Usd.ClipsAPI(prim).ComputeClipAssetPaths(name)
            except Tf.ErrorException:  # templates without a manifest, and incomplete clip sets
                paths = []
            if not paths and not _template_matches(prim, name):
                message = f"the value clips '{name}' name no layer that is there"
                ledger.warn("clips-missing", prim, f"{message}, their animation is lost")
            lost = [path.path for path in paths if not _is_readable(path, roots)]
            if lost:
                message = f"{len(lost)} of {len(paths)} layers of the value clips '{name}'"
                message += f" cannot be read, their animation is lost; the first is @{lost[0]}@"
                ledger.warn("clips-missing", prim, message)


def _template_matches(prim: Usd.Prim, name: str) -> bool:
    """Whether a clip set's template, such as clip.##.usda, matches some existing file."""
    for spec in prim.GetPrimStack():
        clip_set = spec.GetInfo("clips").get(name, {}) if spec.HasInfo("clips") else {}
        template = clip_set.get("templateAssetPath") if isinstance(clip_set, dict) else None
        path = template.path if isinstance(template, Sdf.AssetPath) else str(template or "")
        folder, file = os.path.split(spec.layer.ComputeAbsolutePath(path) if path else "")
        pattern = re.compile(re.sub(r"#+", r"-?\\d+", re.escape(file).replace(r"\#", "#")))
        try:
            entries = os.listdir(folder) if "#" in file else []
        except OSError:  # the folder is missing, or outside the roots
            entries = []
        if any(pattern.fullmatch(entry) for entry in entries):
            return True
    return False


def _is_readable(asset: Sdf.AssetPath, roots: tuple[str, ...]) -> bool:
    if not asset.resolvedPath or not is_within(asset.resolvedPath, roots):
        return False
    try:
        return open_layer(asset.resolvedPath) is not None
    except Tf.ErrorException:
        return False


def _is_outside(asset_path: str, roots: tuple[str, ...]) -> bool:
    """Whether an absolute path or file URL names an asset outside; textures are judged later."""
    path = re.sub(r"^file:(//)?", "", asset_path)
    if not os.path.isabs(path) or Sdf.FileFormat.GetFileExtension(path).lower() in _IMAGES:
        return False
    return not is_within(path, roots)


def _absent_file(layer: Sdf.Layer, identifier: str, roots: tuple[str, ...]) -> list[str]:
    """Path of the allowed file that a missing asset names; empty where it is not just one."""
    if not layer.realPath or any(sign in identifier + layer.realPath for sign in "<[\0"):
        return []  # one of many tiles, or inside an existing package
    path = os.path.join(os.path.dirname(layer.realPath), identifier)
    return [os.path.abspath(path)] if is_within(path, roots) else []


def _names_a_layer(identifier: str) -> bool:
    extension = Sdf.FileFormat.GetFileExtension(identifier)
    return bool(extension) and Sdf.FileFormat.FindByExtension(extension) is not None


def check_used_layers(stage: Usd.Stage, roots: tuple[str, ...]) -> None:
    """The last guard: no layer of the composed stage may come from elsewhere."""
    for layer in stage.GetUsedLayers():
        if not layer.anonymous and layer.realPath and not is_within(layer.realPath, roots):
            message = outside_message(f"@{layer.identifier}@", layer.realPath)
            raise ConvertError("asset-outside-roots", message, stage.GetRootLayer().identifier)
        check_referenced(outer_file(layer.realPath))  # also in expressions
