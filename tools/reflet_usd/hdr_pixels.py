"""Reads Radiance HDR textures, which Pillow cannot; converter and validator share this reader."""

import re

import numpy as np
from numpy.typing import NDArray

from .exr_pixels import MAGIC, MOST_PIXELS, read_exr

_MAGIC = b"#?"
"""First bytes of Radiance HDR files."""


def read_floats(data: bytes) -> NDArray[np.float32] | None:
    """Linear values (height, width, 1 to 4) of a file that holds floats; None of other files.

    Raises ValueError for files that cannot be read.
    """
    if data.startswith(MAGIC):
        return read_exr(data)
    return read_hdr(data) if data.startswith(_MAGIC) else None


def read_hdr(data: bytes) -> NDArray[np.float32]:
    """Linear values (height, width, 3); raises ValueError for files that cannot be read."""
    head, _, rest = data.partition(b"\n\n")
    line, _, body = rest.partition(b"\n")
    size = re.fullmatch(rb"-Y (\d+) \+X (\d+)", line.strip())
    if b"FORMAT=32-bit_rle_rgbe" not in head or not size:
        raise ValueError("it is no Radiance HDR of RGBE whose first pixel is at the top left")
    height, width = int(size[1]), int(size[2])
    if width * height > MOST_PIXELS:
        raise ValueError(f"{width} x {height} pixels, at most {MOST_PIXELS} are read")
    values = np.zeros((height, 4, width), np.uint8)
    at = 0
    try:
        for row in values:
            if body[at : at + 4] == bytes([2, 2, width >> 8 & 255, width & 255]):
                at += 4
                for channel in row:
                    at = _run_lengths(body, at, channel)
            else:  # not compressed
                row[:] = np.frombuffer(body, np.uint8, 4 * width, at).reshape(width, 4).T
                at += 4 * width
    except IndexError:
        raise ValueError("it ends before its last pixel") from None
    exponent = np.ldexp(np.float32(1.0), values[:, 3].astype(np.int32) - 136)
    scale = np.where(values[:, 3] > 0, exponent, np.float32(0.0))
    return np.moveaxis(values[:, :3] * scale[:, None], 1, 2).astype(np.float32)


def _run_lengths(body: bytes, at: int, channel: NDArray[np.uint8]) -> int:
    """Fill one channel of a row; returns the place behind it."""
    filled = 0
    while filled < len(channel):
        count = body[at]
        if count > 128:
            channel[filled : filled + count - 128] = body[at + 1]
            filled, at = filled + count - 128, at + 2
        else:
            run = body[at + 1 : at + 1 + count]
            channel[filled : filled + count] = np.frombuffer(run, np.uint8)[: len(channel) - filled]
            filled, at = filled + max(count, 1), at + 1 + count
    return at
