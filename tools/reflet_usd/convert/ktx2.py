"""KTX 2.0 files of plain texels, for images whose levels are stated and not means."""

import struct
from collections.abc import Sequence

import numpy as np

from .scene import Array

_SRGB8, _UNORM8 = 43, 37
"""VkFormat of four channels, R, G, B and A, as sRGB and as they are."""


def ktx2(levels: Sequence[Array], srgb: bool) -> bytes:
    """A file of uint8 pixels (height, width, 3 or 4), each level half as large as the last."""
    height, width = levels[0].shape[:2]
    # Khronos Data Format 1.4, chapter 5: texels of 4 bytes, samples of 8 bits, the last is alpha.
    samples = [
        struct.pack("<HBB4BII", 8 * k, 7, k if k < 3 else 15 + 16 * srgb, 0, 0, 0, 0, 0, 255)
        for k in range(4)
    ]
    block = struct.pack(
        "<IHH8B8B", 0, 2, 24 + 64, 1, 1, 2 if srgb else 1, 0, 0, 0, 0, 0, 4, *7 * [0]
    )
    descriptor = struct.pack("<I", 4 + len(block) + 64) + block + b"".join(samples)
    start = 80 + 24 * len(levels) + len(descriptor)
    header = struct.pack(
        "<9I", _SRGB8 if srgb else _UNORM8, 1, width, height, 0, 0, 1, len(levels), 0
    )
    header += struct.pack("<4I2Q", start - len(descriptor), len(descriptor), 0, 0, 0, 0)
    entries, texels = [], []
    at = start
    # The smallest level stands first in the file (KTX 2.0, 3.9.7).
    for level in reversed(levels):
        opaque = np.full((*level.shape[:2], 1), 255, np.uint8)
        data = np.dstack([level, opaque])[..., :4].tobytes()
        entries.append(struct.pack("<3Q", at, len(data), len(data)))
        texels.append(data)
        at += len(data)
    return (
        b"\xabKTX 20\xbb\r\n\x1a\n"
        + header
        + b"".join(entries[::-1])
        + descriptor
        + b"".join(texels)
    )
