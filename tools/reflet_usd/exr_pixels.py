"""Reads the pixels of OpenEXR textures, which Pillow cannot, by OpenEXR's own library.

Converter and validator share this reader, as they share usd-core.
"""

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

MOST_PIXELS = 2**26
"""Maximum number of pixels; a pixel of four 32-bit channels takes 16 bytes."""
_MOST_CHANNELS = 16
MAGIC = b"\x76\x2f\x31\x01"
"""First bytes of OpenEXR files."""


def read_exr(data: bytes) -> NDArray[np.float32]:
    """Linear values (height, width, 1 to 4) of the first part: gray, gray and alpha, RGB or RGBA.

    Values that are not finite are 0. Raises ValueError for files that cannot be read.
    """
    import OpenEXR

    def opened(header_only: bool) -> Any:
        try:
            file = OpenEXR.File(io.BytesIO(data), True, header_only, 0)
            return file.header() if header_only else file.channels()
        except (RuntimeError, TypeError, ValueError) as error:
            raise ValueError(" ".join(str(error).split())[:200]) from None

    header = opened(True)
    low, high = header["dataWindow"]
    width, height = (int(high[axis]) - int(low[axis]) + 1 for axis in (0, 1))
    names = [channel.name for channel in header["channels"]]
    if width * height > MOST_PIXELS or len(names) > _MOST_CHANNELS:
        shape = f"{width} x {height} pixels of {len(names)} channels"
        raise ValueError(f"{shape}, at most {MOST_PIXELS} of {_MOST_CHANNELS} are read")
    color = ["R", "G", "B"] if {"R", "G", "B"} <= set(names) else []
    gray = next((name for name in ("Y", "V", "R", *names) if name in names and name != "A"), None)
    shown = color or ([gray] if gray else [])
    chosen = shown + (["A"] if shown and "A" in names else [])
    channels = opened(False)
    planes = [channels[name].pixels for name in chosen]
    if not chosen or any(plane.shape != (height, width) for plane in planes):
        raise ValueError("it has no channels of full resolution for color or gray")
    values = np.dstack(planes).astype(np.float32)
    return np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0)
