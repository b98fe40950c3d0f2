"""Sources of a surface's inputs: constants, texture reads and primvars."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from pxr import Sdf, UsdShade


@dataclass(frozen=True)
class UvRead:
    """Source of a texture's coordinates: a UV set and UsdTransform2d's parameters."""

    primvar: str = "st"
    fallback: tuple[float, float] = (0.0, 0.0)
    scale: tuple[float, float] = (1.0, 1.0)
    rotation_deg: float = 0.0
    translation: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Part:
    """One number that a texture gives: value = texel · scale + bias."""

    channel: int
    scale: float = 1.0
    bias: float = 0.0
    fallback: float = 0.0
    """The value where the file cannot be read."""


@dataclass(frozen=True)
class TextureRead:
    """One use of a texture."""

    prim: str
    file: str
    """The resolved asset path; empty where it does not resolve."""
    authored_file: str
    parts: tuple[Part, ...]
    """The numbers that are read: one, or the components of a color or a vector."""
    uv: UvRead = field(default_factory=UvRead)
    wrap: tuple[str, str] = ("useMetadata", "useMetadata")
    color_space: str = "auto"
    tiles: tuple[tuple[int, int, str], ...] = ()
    """Column and row, from the lower left, and file of each tile of a UDIM texture."""

    @property
    def grid(self) -> tuple[int, int]:
        """Columns and rows of the tiles; as many of both where the coordinates are turned."""
        columns = max((column for column, _, _ in self.tiles), default=0) + 1
        rows = max((row for _, row, _ in self.tiles), default=0) + 1
        most = max(columns, rows)
        return (columns, rows) if self.uv.rotation_deg == 0.0 else (most, most)

    def tiled(self, tiles: tuple[tuple[int, int, str], ...]) -> TextureRead:
        """The same read of one image with all tiles, whose coordinates 0 to 1 span their grid."""
        read = replace(self, tiles=tiles, wrap=("clamp", "clamp"))
        (sx, sy), (tx, ty), (columns, rows) = self.uv.scale, self.uv.translation, read.grid
        scale, move = (sx / columns, sy / rows), (tx / columns, ty / rows)
        return replace(read, uv=replace(self.uv, scale=scale, translation=move))


@dataclass(frozen=True)
class PrimvarRead:
    """An input that reads a primvar of the gprim."""

    primvar: str
    fallback: tuple[float, ...] | None


@dataclass(frozen=True)
class Constant:
    """An input with one value."""

    value: tuple[float, ...]


Source = Constant | TextureRead | PrimvarRead


class UnfitError(Exception):
    """A node without a counterpart in glTF; the message is a sentence about it."""

    def __init__(self, node: UsdShade.Shader, message: str) -> None:
        super().__init__(message)
        self.node = node


def numbers(value: Any) -> tuple[float, ...] | None:
    """A number or short vector as floats; None for anything else or when not finite."""
    if value is None or isinstance(value, (str, Sdf.AssetPath)):
        return None
    try:
        array = np.atleast_1d(np.array(value, dtype=np.float64)).ravel()
    except (TypeError, ValueError):
        return None
    if not 1 <= array.size <= 4 or not np.isfinite(array).all():
        return None
    return tuple(float(number) for number in array)
