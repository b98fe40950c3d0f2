"""Keeps composition and textures inside the stage's folder and the explicitly allowed roots."""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Sequence
from pathlib import Path

from pxr import Ar, Sdf, Tf, Usd, UsdUtils

from reflet_usd.convert.ledger import Ledger
from reflet_usd.convert.types import ConvertError
from reflet_usd.usdz_check import check_referenced

MAX_LAYERS = 20_000
# Named with their shader by the texture reader, which falls back to the node's value.
_IMAGES = ("png", "jpg", "jpeg", "tga", "bmp", "tif", "tiff", "exr", "hdr", "gif", "webp")


def allowed_roots(stage_path: Path, extra_roots: Sequence[Path]) -> tuple[str, ...]:
    """Real paths of the stage's folder and of every extra root."""
    for root in extra_roots:
        if not root.is_dir():
            raise ConvertError("root-missing", "--root names no folder", str(root))
    return tuple(os.path.realpath(root) for root in (stage_path.resolve().parent, *extra_roots))


def is_allowed(resolved: str, roots: tuple[str, ...]) -> bool:
    """Whether the file behind a resolved asset path (a package's outer file) is inside a root."""
    outer = Ar.SplitPackageRelativePathOuter(resolved)[0] if resolved else resolved
    real = os.path.realpath(outer)
    return any(real == root or real.startswith(root.rstrip(os.sep) + os.sep) for root in roots)


def open_layer(identifier: str) -> Sdf.Layer | None:
    """The layer as it is on disk now, also where this process read it before."""
    known = Sdf.Layer.Find(identifier)
    if known is not None:
        known.Reload(force=True)
        return known
    return Sdf.Layer.FindOrOpen(identifier)


def cut_foreign_layers(
    root_layer: Sdf.Layer, roots: tuple[str, ...], ledger: Ledger, absent: set[str]
) -> list[Sdf.Layer]:
    """Remove, in memory, every reference to a layer outside `roots`, before USD opens it.

    Returns all layers that were read; the caller keeps them alive while it composes the stage.
    Files that the layers name and that are not there go to `absent`.
    """
    layers = [root_layer]
    seen = {root_layer.identifier}
    for layer in layers:  # grows while it is walked
        for identifier in _kept_dependencies(layer, roots, ledger, absent):
            if identifier in seen or len(layers) > MAX_LAYERS:
                continue
            seen.add(identifier)
            try:
                opened = open_layer(identifier)
            except Tf.ErrorException:
                continue  # composition names it as unresolved
            if opened is not None:
                layers.append(opened)
    return layers


def _kept_dependencies(
    layer: Sdf.Layer, roots: tuple[str, ...], ledger: Ledger, absent: set[str]
) -> list[str]:
    kept = []
    refused: list[ConvertError] = []

    def judge(asset_path: str) -> str:
        if (
            refused or "`" in asset_path
        ):  # an expression; `check_used_layers` judges what it becomes
            return asset_path
        if _is_outside(asset_path, roots):
            message = f"@{asset_path}@ is outside the allowed folders; allow it with --root"
            return leave_out("asset-outside-roots", message, asset_path)
        identifier = layer.ComputeAbsolutePath(asset_path)
        resolved = Ar.GetResolver().Resolve(identifier).GetPathString()
        if resolved and not is_plain_file(resolved):
            message = f"@{asset_path}@ is a pipe, device or folder, it is not opened"
            return leave_out("asset-not-a-file", message, asset_path)
        if resolved and is_allowed(resolved, roots):
            try:
                check_referenced(Ar.SplitPackageRelativePathOuter(resolved)[0])
            except ConvertError as error:
                refused.append(error)
                return asset_path
        if not resolved:
            absent.update(_absent_file(layer, identifier, roots))
        if not _names_a_layer(identifier):
            return asset_path
        if resolved and not is_allowed(resolved, roots):
            message = (
                f"the layer @{asset_path}@ is outside the allowed folders; allow it with --root"
            )
            return leave_out("asset-outside-roots", message, asset_path)
        if resolved:
            kept.append(identifier)
        return asset_path

    def leave_out(name: str, message: str, asset_path: str) -> str:
        if (
            not Ar.IsPackageRelativePath(layer.identifier)
            and layer.GetFileFormat().formatId != "usdz"
        ):
            ledger.warn(name, "/", message)
            return ""
        refused.append(ConvertError(name, message, layer.identifier))  # USD edits no package
        return asset_path

    was_editable = layer.permissionToEdit
    layer.SetPermissionToEdit(True)
    UsdUtils.ModifyAssetPaths(layer, judge)
    layer.SetPermissionToEdit(was_editable)
    if refused:
        raise refused[0]
    return kept


def _is_outside(asset_path: str, roots: tuple[str, ...]) -> bool:
    """Whether an asset is named by an absolute path or file URL outside; textures come later."""
    path = re.sub(r"^file:(//)?", "", asset_path)
    if not os.path.isabs(path) or Sdf.FileFormat.GetFileExtension(path).lower() in _IMAGES:
        return False
    return not is_allowed(path, roots)


def is_plain_file(resolved: str) -> bool:
    """Whether a resolved asset path (a package's outer file) can be opened without waiting."""
    outer = Ar.SplitPackageRelativePathOuter(resolved)[0]
    try:
        return stat.S_ISREG(os.stat(outer).st_mode)
    except OSError:
        return True  # nothing that could block; whoever opens it says why it cannot


def _absent_file(layer: Sdf.Layer, identifier: str, roots: tuple[str, ...]) -> list[str]:
    """Where an asset would lie that does not resolve, if that is one plain and allowed file."""
    if not layer.realPath or any(sign in identifier + layer.realPath for sign in "<[\0"):
        return []  # one of many tiles, or inside a package, which is a file that is there
    path = os.path.join(os.path.dirname(layer.realPath), identifier)
    return [os.path.abspath(path)] if is_allowed(path, roots) else []


def _names_a_layer(identifier: str) -> bool:
    extension = Sdf.FileFormat.GetFileExtension(identifier)
    return bool(extension) and Sdf.FileFormat.FindByExtension(extension) is not None


def check_used_layers(stage: Usd.Stage, roots: tuple[str, ...]) -> None:
    """The last guard: no layer of the composed stage may come from elsewhere."""
    for layer in stage.GetUsedLayers():
        if not layer.anonymous and layer.realPath and not is_allowed(layer.realPath, roots):
            message = f"@{layer.identifier}@ is outside the allowed folders; allow it with --root"
            raise ConvertError("asset-outside-roots", message, stage.GetRootLayer().identifier)
        check_referenced(Ar.SplitPackageRelativePathOuter(layer.realPath)[0])  # expressions' too
