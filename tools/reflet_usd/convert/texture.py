"""Texture files: found, confined, checked; copied as they are or rewritten where necessary."""

import io
import os
from dataclasses import dataclass, replace

import numpy as np
from PIL import Image
from PIL.TiffImagePlugin import TiffImageFile

from reflet_usd.hdr_pixels import read_floats
from reflet_usd.stage_files import is_plain_file, is_within, read_asset
from reflet_usd.stand_in import stand_in

from .confinement import outside_message
from .context import Context
from .gltf_writer import GltfWriter
from .ktx2 import ktx2
from .scene import Array
from .sources import TextureRead

MAX_PIXELS = 2**28
PNG_COMPRESSION = 3
MOST_LEVELED = 2**22
"""Pixels of the largest image whose mip levels are carried, as texels that are not compressed."""
MOST_ACROSS = 8192
"""Pixels across and down of the largest image of UDIM tiles."""
# Only these formats: Pillow hands some others, such as EPS, to programs of the system.
_FORMATS = ("PNG", "JPEG", "BMP", "GIF", "TGA", "TIFF", "WEBP")
_MIME_TYPES = {"PNG": "image/png", "JPEG": "image/jpeg"}
_COPIED_MODES = ("L", "LA", "RGB", "RGBA", "P", "1", "I;16", "I")


@dataclass
class ImageFile:
    """A texture file that could be decoded."""

    name: str
    data: bytes
    format: str
    mode: str
    size: tuple[int, int]
    wide: bool
    """Whether channels have more than 8 bits."""
    has_key: bool = False
    """Whether one color is transparent (a PNG's tRNS chunk)."""
    floats: Array | None = None
    """Linear values (height, width, 4) of an OpenEXR or Radiance HDR file."""
    has_more: bool = False
    """Whether other pictures follow the first, or its levels, in a TIFF."""
    levels: tuple["ImageFile", ...] = ()
    """Mip levels that a TIFF states, each half as large as the last."""

    @property
    def is_gray(self) -> bool:
        """Whether there is one color channel, so that red, green and blue are equal."""
        return self.mode in ("L", "LA", "1", "I;16", "I", "F")

    @property
    def has_alpha(self) -> bool:
        """Whether there is alpha (a palette may have a transparent entry)."""
        return self.mode in ("LA", "RGBA", "PA", "P") or self.has_key

    @property
    def copies(self) -> bool:
        """Whether glTF takes the file as it is."""
        return self.format in _MIME_TYPES and self.mode in _COPIED_MODES

    def lowest(self, channel: int) -> float:
        """Least value of a channel."""
        if self.floats is not None:
            return float(self.floats[..., channel].min())
        return float(self.rgba()[..., channel].min()) / 255.0

    def rgba(self) -> Array:
        """Pixels (height, width, 4) as uint8 of a file without floats."""
        with Image.open(io.BytesIO(self.data), formats=_FORMATS) as image:
            if self.wide:
                gray = np.asarray(image, dtype=np.float64)
                peak = 65535.0 if gray.max() > 255.0 else 255.0
                narrow = np.round(gray / peak * 255.0).astype(np.uint8)
                opaque = gray != image.info.get("transparency", -1)
                return np.dstack([narrow, narrow, narrow, opaque.astype(np.uint8) * 255])
            return np.asarray(image.convert("RGBA"))


class TextureLibrary:
    """All images of one conversion, each read once."""

    def __init__(self, context: Context, writer: GltfWriter) -> None:
        self.context = context
        self.writer = writer
        self._files: dict[str, ImageFile | None] = {}
        Image.MAX_IMAGE_PIXELS = MAX_PIXELS

    def image(self, read: TextureRead, without: str = "its fallback is used") -> ImageFile | None:
        """The decoded file, or None with a warning, which says what is shown `without` it."""
        key = read.file or f"unresolved {read.authored_file}"
        if key not in self._files:
            self._files[key] = self._open(read, without)
        elif self._files[key] is None:
            self._open(read, without)  # every use of a lost texture gets a warning
        return self._files[key]

    def _open(self, read: TextureRead, without: str) -> ImageFile | None:
        if read.tiles:
            return self._open_tiles(read, without)
        if read.file in self.context.patterns:
            return _decode(read, self.context.patterns[read.file])
        warn = self.context.ledger.warn
        shown = os.path.basename(read.authored_file)
        if not read.authored_file:
            warn("texture-missing", read.prim, f"no texture file is named; {without}")
            return None
        if not read.file:
            warn("texture-missing", read.prim, f"@{shown}@ does not exist; {without}")
            return None
        if not is_within(read.file, self.context.allowed_roots):
            message = outside_message(f"@{shown}@", read.file)
            warn("asset-outside-roots", read.prim, message)
            return None
        if not is_plain_file(read.file):
            message = f"@{shown}@ is a pipe, device or folder, it is not opened"
            warn("asset-not-a-file", read.prim, message)
            return None
        self.context.textures_read.add(read.file)
        try:
            return _decode(read, read_asset(read.file))
        except Image.DecompressionBombError:
            warn("texture-too-large", read.prim, f"@{shown}@ has more than {MAX_PIXELS} pixels")
        except (OSError, ValueError, SyntaxError, EOFError) as error:
            warn("texture-unreadable", read.prim, f"@{shown}@: {_reason(error)}")
        return None

    def _open_tiles(self, read: TextureRead, without: str) -> ImageFile | None:
        """One image of all tiles of a UDIM texture, of the largest tile's size each."""
        opened = [
            (column, row, self._open(replace(read, tiles=(), file=path), without))
            for column, row, path in read.tiles
        ]
        files = [(column, row, file) for column, row, file in opened if file is not None]
        if not files:
            return None
        columns, rows = read.grid
        wanted = [max(file.size[axis] for _, _, file in files) for axis in (0, 1)]
        side = [
            max(1, min(size, MOST_ACROSS // count))
            for size, count in zip(wanted, (columns, rows), strict=True)
        ]
        if side != wanted:
            message = f"its tiles were reduced to {side[0]} x {side[1]} pixels"
            self.context.ledger.warn("texture-repacked", read.prim, message)
        whole = np.zeros((rows * side[1], columns * side[0], 4))
        fallback = [part.fallback for part in read.parts][:3]
        whole[..., : len(fallback)], whole[..., 3] = np.clip(fallback, 0.0, 1.0), 1.0
        for column, row, file in files:
            pixels = file.rgba() / 255.0 if file.floats is None else file.floats
            for axis, count in enumerate(side[::-1]):  # a smaller tile is repeated
                places = (np.arange(count) + 0.5) / count * pixels.shape[axis]
                pixels = np.take(pixels, places.astype(np.int64), axis=axis)
            top, left = (rows - 1 - row) * side[1], column * side[0]
            whole[top : top + side[1], left : left + side[0]] = pixels
        images = [file for _, _, file in files]
        mode = "RGBA" if any(file.has_alpha for file in images) else "RGB"
        mode = "L" if mode == "RGB" and all(file.is_gray for file in images) else mode
        name, size = images[0].name, (whole.shape[1], whole.shape[0])
        if any(file.wide for file in images):
            return ImageFile(name, b"", "floats", mode, size, wide=True, floats=whole)
        stream = io.BytesIO()
        image = Image.fromarray(np.round(whole * 255.0).astype(np.uint8), "RGBA").convert(mode)
        image.save(stream, "PNG", compress_level=PNG_COMPRESSION)
        return ImageFile(name, stream.getvalue(), "PNG", mode, size, wide=False)

    def add_copy(self, file: ImageFile) -> int:
        """The file as a glTF image, its bytes unchanged."""
        return self.writer.add_image(file.data, _MIME_TYPES[file.format], file.name)

    def add_levels(self, levels: list[Array], srgb: bool, name: str) -> int:
        """uint8 pixels of an image and of its mip levels as a KTX 2.0 image."""
        self.writer.use_extension("KHR_texture_basisu")
        return self.writer.add_image(ktx2(levels, srgb), "image/ktx2", name)

    def add_pixels(self, pixels: Array, name: str) -> int:
        """uint8 pixels (height, width, 3 or 4) as a PNG image."""
        stream = io.BytesIO()
        mode = "RGB" if pixels.shape[2] == 3 else "RGBA"
        image = Image.fromarray(np.ascontiguousarray(pixels), mode)
        image.save(stream, "PNG", compress_level=PNG_COMPRESSION)
        return self.writer.add_image(stream.getvalue(), "image/png", name)


def _decode(read: TextureRead, data: bytes) -> ImageFile:
    # The resolved path of a packaged file ends in "package.usdz[name]".
    stem = os.path.splitext(os.path.basename(read.file.rstrip("]").split("[")[-1]))[0]
    if found := stand_in(data[:64]):
        raise ValueError(found)
    floats = read_floats(data)
    if floats is not None:
        return _of_floats(stem, floats)
    with Image.open(io.BytesIO(data), formats=_FORMATS) as image:
        image.load()
        wide = image.mode in ("I", "I;16", "I;16B", "F")
        kind, key = image.format or "", "transparency" in image.info
        file = ImageFile(stem, data, kind, image.mode, image.size, wide, key)
        if isinstance(image, TiffImageFile):
            file.levels, file.has_more = _stated_levels(image, stem)
        return file


def _stated_levels(image: TiffImageFile, stem: str) -> tuple[tuple[ImageFile, ...], bool]:
    """The pictures after the first as PNG, each half as large as the last, and if others follow."""
    levels: list[ImageFile] = []
    first, mode = image.size, image.mode
    small = first[0] * first[1] <= MOST_LEVELED
    # Pages of a document say so, or have numbers, unless they are reduced (TIFF 6.0).
    while image.tag_v2.next and small and mode in ("L", "LA", "RGB", "RGBA"):
        k = len(levels) + 1
        size = (max(1, first[0] >> k), max(1, first[1] >> k))
        stream = io.BytesIO()
        try:
            image.seek(k)
            kind = image.tag_v2.get(254, 0)
            is_page = not kind & 1 and (kind & 2 or 297 in image.tag_v2)
            if is_page or (image.mode, image.size) != (mode, size) or k >= max(first).bit_length():
                return tuple(levels), True
            image.save(stream, "PNG", compress_level=PNG_COMPRESSION)
        except Exception:  # Pillow raises many kinds for a broken page
            return tuple(levels), True
        levels.append(ImageFile(stem, stream.getvalue(), "PNG", mode, size, wide=False))
    return tuple(levels), bool(image.tag_v2.next)


def _of_floats(stem: str, values: Array) -> ImageFile:
    height, width, count = values.shape
    floats = np.ones((height, width, 4), values.dtype)
    floats[..., :3] = values[..., :3] if count > 2 else values[..., :1]
    if count in (2, 4):
        floats[..., 3] = values[..., -1]
    mode = ("L", "LA", "RGB", "RGBA")[count - 1]
    return ImageFile(stem, b"", "floats", mode, (width, height), wide=True, floats=floats)


def _reason(error: Exception) -> str:
    """Pillow's message without memory addresses, which differ from run to run."""
    text = str(error) or type(error).__name__
    return "not an image that can be read" if "0x" in text else text


def is_srgb(read: TextureRead, file: ImageFile) -> bool:
    """Whether texels are sRGB-encoded; `auto` means 8-bit files with three channels or more."""
    if read.color_space in ("sRGB", "raw"):
        return read.color_space == "sRGB"
    return not file.wide and not file.is_gray


def srgb_to_linear(encoded: Array) -> Array:
    """Decode the sRGB transfer function (IEC 61966-2-1), values 0…1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def linear_to_srgb(linear: Array) -> Array:
    """Encode with the sRGB transfer function (IEC 61966-2-1), values 0…1."""
    positive = np.maximum(linear, 0.0)
    return np.where(
        positive <= 0.0031308, positive * 12.92, 1.055 * positive ** (1.0 / 2.4) - 0.055
    )


def between(texels: Array, places: tuple[Array, Array], wraps: tuple[str, str]) -> Array:
    """Texels (height, width, n) at places across and along the rows, between the four nearest.

    A place is 0 where the first texel begins, and 1 where the last one ends.
    """
    (left, right, across), (low, high, up) = (
        _neighbors(place, size, wrap)
        for place, size, wrap in zip(places, texels.shape[1::-1], wraps, strict=True)
    )
    first = texels[low, left] * (1.0 - across) + texels[low, right] * across
    last = texels[high, left] * (1.0 - across) + texels[high, right] * across
    return np.asarray(first * (1.0 - up) + last * up)


def _neighbors(place: Array, size: int, wrap: str) -> tuple[Array, Array, Array]:
    """Texels before and after places along an axis, and the share of the texel after."""
    place = np.nan_to_num(place) * size - 0.5
    first = np.floor(place)
    pair = [_wrapped(first.astype(np.int64) + step, size, wrap) for step in (0, 1)]
    return pair[0], pair[1], (place - first)[..., None]


def _wrapped(texel: Array, size: int, wrap: str) -> Array:
    if wrap == "repeat":
        return texel % size
    if wrap == "mirror":
        return np.minimum(texel % (2 * size), 2 * size - 1 - texel % (2 * size))
    return np.clip(texel, 0, size - 1)
