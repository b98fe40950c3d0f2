"""Owns the reading of OpenEXR files that the program writes, channel by channel.

Blender reads the colors of such a file into a render layer, but no other channels, and not each
build of it has OpenEXR's or OpenImageIO's Python package. So this reads what `reflet render`
writes: one part of scanlines, plain or ZIP, with channels of 16 and 32 bits, not subsampled.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np

_MAGIC = b"\x76\x2f\x31\x01"
# Bits of the version field for tiles, deep data and several parts.
_OTHER_FORMS = 0x200 | 0x800 | 0x1000
_TYPES = (np.dtype("<u4"), np.dtype("<f2"), np.dtype("<f4"))
# Scanlines in a block by compression: none, ZIPS, ZIP.
_BLOCKS = {0: 1, 2: 1, 3: 16}
_MOST_PIXELS = 1 << 28


class ExrError(Exception):
    """Why a file is none that the program writes."""


def read(path: Path) -> dict[str, np.ndarray]:
    """The channels of a file by name, each an array of height × width, from the top."""
    data = path.read_bytes()
    try:
        return _channels(data)
    except (struct.error, ValueError, IndexError, KeyError, zlib.error) as error:
        raise ExrError(f"{path.name} is no OpenEXR file of Reflet's: {error}") from error


def _channels(data: bytes) -> dict[str, np.ndarray]:
    if data[:4] != _MAGIC or struct.unpack_from("<I", data, 4)[0] & _OTHER_FORMS:
        raise ValueError("it begins otherwise")
    header, at = _header(data)
    listed = _listed(header["channels"])
    lines_per_block = _BLOCKS[header["compression"][0]]
    left, top, right, bottom = struct.unpack("<4i", header["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    if min(width, height) < 1 or width * height > _MOST_PIXELS:
        raise ValueError(f"{width} x {height} pixels")
    row_bytes = sum(kind.itemsize for _, kind in listed) * width
    out = {name: np.empty((height, width), kind) for name, kind in listed}
    blocks = -(-height // lines_per_block)
    for offset in struct.unpack_from(f"<{blocks}Q", data, at):
        first, size = struct.unpack_from("<ii", data, offset)
        lines = min(lines_per_block, top + height - first)
        block = _unpacked(data[offset + 8 : offset + 8 + size], row_bytes * lines)
        place = 0
        for y in range(first - top, first - top + lines):
            for name, kind in listed:
                out[name][y] = np.frombuffer(block, kind, width, place)
                place += kind.itemsize * width
    return out


def _header(data: bytes) -> tuple[dict[str, bytes], int]:
    at, out = 8, {}
    while data[at] != 0:
        name, at = _text(data, at)
        _, at = _text(data, at)
        size = struct.unpack_from("<i", data, at)[0]
        if size < 0:
            raise ValueError("an attribute of a negative size")
        out[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return out, at + 1


def _text(data: bytes, at: int) -> tuple[str, int]:
    end = data.index(0, at)
    return data[at:end].decode("utf-8"), end + 1


def _listed(data: bytes) -> list[tuple[str, np.dtype]]:
    at, out = 0, []
    while data[at] != 0:
        name, at = _text(data, at)
        kind, _, step_x, step_y = struct.unpack_from("<iIii", data, at)
        if (step_x, step_y) != (1, 1):
            raise ValueError(f"{name} is subsampled")
        out.append((name, _TYPES[kind]))
        at += 16
    return out


def _unpacked(block: bytes, size: int) -> bytes:
    """A block's bytes: OpenEXR's ZIP halves are interleaved, and each byte is a difference."""
    if len(block) == size:
        return block
    raw = zlib.decompressobj().decompress(block, size)
    if len(raw) != size:
        raise ValueError("a block is too short")
    steps = np.frombuffer(raw, np.uint8).astype(np.uint64)
    steps[1:] += 128
    flat = np.cumsum(steps).astype(np.uint8)
    out = np.empty(size, np.uint8)
    half = (size + 1) // 2
    out[0::2], out[1::2] = flat[:half], flat[half:]
    return out.tobytes()
