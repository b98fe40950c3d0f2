"""Owns sampling of texture images: decoding with Pillow and OpenEXR, wrap modes, sRGB."""

import dataclasses
import hashlib
import io
from collections.abc import Callable

import numpy as np
from PIL import Image

from reflet_usd.hdr_pixels import read_floats

from .scene_data import Array

# Only these formats: Pillow hands some others, such as EPS, to programs of the system.
FORMATS = ("PNG", "JPEG", "BMP", "GIF", "TGA", "TIFF", "WEBP")


@dataclasses.dataclass
class Texels:
    """A decoded image."""

    values: Array
    """(height, width, 4) in 0..1 as stored; gray images repeat their value in r, g, b."""
    channels: int
    eight_bit: bool
    digest: bytes = b""
    """Digest of the encoded file: equal ones hold equal texels."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height."""
        return self.values.shape[1], self.values.shape[0]


def decode(data: bytes, clip: bool = True) -> Texels | None:
    """The image in `data`; None where it cannot be read. Floats are clipped to glTF's range."""
    try:
        floats = read_floats(data)
        if floats is not None:
            highest = 1.0 if clip else np.inf
            texels = _filled(np.clip(floats.astype(np.float64), 0.0, highest), eight_bit=False)
            return dataclasses.replace(texels, digest=hashlib.sha256(data).digest())
        with Image.open(io.BytesIO(data), formats=FORMATS) as image:
            image.load()
            return dataclasses.replace(_texels(image), digest=hashlib.sha256(data).digest())
    except Exception:  # Pillow raises many kinds of errors for broken files
        return None


def _texels(image: Image.Image) -> Texels:
    deep = image.mode.startswith("I") or image.mode == "F"
    if deep:
        values = np.asarray(image, dtype=np.float64)
        key = values != image.info.get("transparency", -1)
        values = values / 65535.0 if image.mode != "F" else values
        values = values if key.all() else np.dstack([values, key])
    else:
        if image.mode in ("P", "PA", "1", "CMYK", "YCbCr", "HSV", "LAB"):
            alpha = image.mode == "PA" or "transparency" in image.info
            image = image.convert("RGBA" if alpha else "RGB")
        elif "transparency" in image.info:  # one transparent color of a PNG, by its tRNS chunk
            image = image.convert("LA" if image.mode == "L" else "RGBA")
        values = np.asarray(image, dtype=np.float64) / 255.0
    return _filled(values if values.ndim == 3 else values[:, :, None], eight_bit=not deep)


def _filled(values: Array, eight_bit: bool) -> Texels:
    """Texels of gray, gray and alpha, RGB or RGBA values."""
    channels = values.shape[2]
    full = np.ones((*values.shape[:2], 4))
    full[:, :, :3] = values[:, :, :1] if channels < 3 else values[:, :, :3]
    if channels in (2, 4):
        full[:, :, 3] = values[:, :, -1]
    return Texels(full, channels, eight_bit)


def srgb_to_linear(values: Array) -> Array:
    """Decode the sRGB transfer function (IEC 61966-2-1)."""
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def linear_to_srgb(values: Array) -> Array:
    """Encode with the sRGB transfer function (IEC 61966-2-1)."""
    high = 1.055 * np.maximum(values, 0.0031308) ** (1 / 2.4) - 0.055
    return np.where(values <= 0.0031308, values * 12.92, high)


def enlarged(values: Array, size: tuple[int, int]) -> Array:
    """Texels (height, width, n) at a larger `size`, between the centers of the nearest texels."""
    for axis, count in ((0, size[1]), (1, size[0])):
        have = values.shape[axis]
        place = np.clip((np.arange(count) + 0.5) * have / count - 0.5, 0.0, have - 1.0)
        low = np.floor(place).astype(np.int64)
        share = (place - low).reshape((-1, 1, 1) if axis == 0 else (1, -1, 1))
        high = np.minimum(low + 1, have - 1)
        first, second = (np.take(values, rows, axis=axis) for rows in (low, high))
        values = first * (1.0 - share) + second * share
    return values


_WRAPS: dict[str, Callable[[Array], Array]] = {
    "repeat": lambda x: x - np.floor(x),
    "mirror": lambda x: 1.0 - np.abs((x % 2.0) - 1.0),
    "clamp": lambda x: np.clip(x, 0.0, 1.0),
}


def sample(texels: Texels, uv: Array, wrap: tuple[str, str], linearize: bool) -> Array:
    """Nearest texels (n, 4) at coordinates (n, 2) whose v points down from the top row."""
    width, height = texels.size
    u, v = _WRAPS[wrap[0]](uv[:, 0]), _WRAPS[wrap[1]](uv[:, 1])
    column = np.clip((u * width).astype(np.int64), 0, width - 1)
    row = np.clip((v * height).astype(np.int64), 0, height - 1)
    values = texels.values[row, column].copy()
    if linearize:
        values[:, :3] = srgb_to_linear(values[:, :3])
    return values
