"""Owns how a stage's files are opened: which may be, their bytes, and metadata that USD misreads.

The converter and the check of its files read by the same rules; only values are found twice.
"""

import contextlib
import math
import os
import re
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pxr import Ar, Sdf, Usd, UsdShade, UsdUtils

# Range of time codes per second; outside, keys of a clip leave single precision as seconds.
_LEAST_RATE, _MOST_RATE = 1e-6, 1e9


def outer_file(resolved: str) -> str:
    """The file behind a resolved asset path: of an asset in a package, the package."""
    return str(Ar.SplitPackageRelativePathOuter(resolved)[0]) if resolved else resolved


def is_within(resolved: str, roots: tuple[str, ...]) -> bool:
    """Whether the file behind a resolved asset path is inside one of the folders."""
    real = os.path.realpath(outer_file(resolved))
    return any(real == root or real.startswith(root.rstrip(os.sep) + os.sep) for root in roots)


def is_plain_file(resolved: str) -> bool:
    """Whether a resolved asset path (a package's outer file) can be opened without waiting."""
    try:
        return stat.S_ISREG(os.stat(outer_file(resolved)).st_mode)
    except OSError:
        return True  # no file that could block; opening it names the fault


def read_asset(resolved: str) -> bytes:
    """The bytes behind a resolved asset path; none where they cannot be read."""
    asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(resolved))
    return bytes((asset.GetBuffer() if asset else None) or b"")  # empty files have no buffer


@contextlib.contextmanager
def editable(layer: Sdf.Layer) -> Iterator[None]:
    """Allow edits of the layer in memory, also where it is read-only."""
    was_editable = layer.permissionToEdit
    layer.SetPermissionToEdit(True)
    yield
    layer.SetPermissionToEdit(was_editable)


def turn_separators(layer: Sdf.Layer) -> None:
    """Replace Windows path separators by slashes, in memory, where that names a file."""

    def resolves(path: str) -> bool:
        if UsdShade.UdimUtils.IsUdimIdentifier(path):
            return bool(UsdShade.UdimUtils.ResolveUdimTilePaths(path, layer))
        return bool(Ar.GetResolver().Resolve(layer.ComputeAbsolutePath(path)))

    turned: dict[str, str] = {}

    def look(path: str) -> str:
        slashes = path.replace("\\", "/")
        if slashes != path and "`" not in path and not resolves(path) and resolves(slashes):
            turned[path] = slashes
        return path

    UsdUtils.ModifyAssetPaths(layer, look)
    if turned and not is_packaged(layer):
        rename(layer, turned)


def is_packaged(layer: Sdf.Layer) -> bool:
    """Whether the layer is a package, or in one."""
    packaged = Ar.IsPackageRelativePath(layer.identifier)
    return packaged or layer.GetFileFormat().formatId == "usdz"


def rename(layer: Sdf.Layer, names: dict[str, str]) -> None:
    """Replace asset paths of the layer in memory."""
    with editable(layer):
        UsdUtils.ModifyAssetPaths(layer, lambda path: names.get(path, path))


def stage_metadata(stage: Usd.Stage, name: str) -> Any:
    """Raw root or session metadata: typed getters throw where a float stands for a double."""
    for layer in (stage.GetSessionLayer(), stage.GetRootLayer()):
        if layer is not None and layer.pseudoRoot.HasInfo(name):
            return layer.pseudoRoot.GetInfo(name)
    return None


def state_rates(stage: Usd.Stage) -> None:
    """State the stage's rates in its session layer: by others, USD scales codes written there."""
    for name in ("timeCodesPerSecond", "framesPerSecond"):
        rate = stage_metadata(stage, name)
        if rate is not None:
            stage.GetSessionLayer().pseudoRoot.SetInfo(name, rate)


def is_positive(value: Any) -> bool:
    """Whether a value is a finite number above 0."""
    try:
        return math.isfinite(value) and value > 0.0
    except TypeError:
        return False


def is_rate(value: Any) -> bool:
    """Whether a rate is in the documented range of time codes per second."""
    return is_positive(value) and _LEAST_RATE <= value <= _MOST_RATE


def error_text(error: Exception, path: Path) -> str:
    """The first reason in USD's error, without source positions in its library."""
    if isinstance(error, UnicodeDecodeError):
        return "it holds text that is not UTF-8"
    try:
        text = " ".join(str(error).split())
    except UnicodeDecodeError as cut:  # USD quotes bytes, or parts of characters
        if not _is_utf8(path):
            return "it is not UTF-8 text"
        text = " ".join(cut.object.decode("utf-8", "replace").split())
    found = re.search(r"Error in '.*?' at line \d+ in file \S+ : '(.*?)'(?: Error in '|$)", text)
    reason = found.group(1) if found else text or "USD gives no reason"
    reason = re.sub(r"pxrInternal\w*::|\S*pegtl::\S*", "", reason).replace(str(path), path.name)
    reason = re.sub(r"parse error matching .*? at '", "cannot parse '", reason)
    return reason.strip()[:400]


def _is_utf8(path: Path) -> bool:
    try:
        path.read_bytes().decode("utf-8")
    except (OSError, UnicodeDecodeError):
        return False
    return True
