"""Texture reads and constants packed into the channels that glTF materials expect."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from PIL import Image

from .context import Context
from .gltf_writer import GltfWriter
from .scene import Array
from .sources import TextureRead
from .texture import ImageFile, TextureLibrary, is_srgb, linear_to_srgb, srgb_to_linear

REPEAT, CLAMP_TO_EDGE, MIRRORED_REPEAT = 10497, 33071, 33648
_WRAPS = {"repeat": REPEAT, "clamp": CLAMP_TO_EDGE, "mirror": MIRRORED_REPEAT}
LINEAR, LINEAR_MIPMAP_LINEAR = 9729, 9987


@dataclass(frozen=True)
class Channel:
    """One channel of an output texture: `texel · scale + bias`, or a constant."""

    read: TextureRead | None = None
    index: int = 0
    scale: float = 1.0
    bias: float = 0.0
    constant: float = 1.0
    raw: bool = False
    """Read texels as raw data, ignoring the color space (normal maps)."""


class Packer:
    """Builds texture infos: copies files where it can, writes PNGs where it must."""

    def __init__(self, context: Context, writer: GltfWriter) -> None:
        self.context = context
        self.writer = writer
        self.library = TextureLibrary(context, writer)
        self._packed: dict[Any, tuple[int, int | None]] = {}
        """Images by their channels: as PNG, and with stated mip levels."""

    def texture(
        self, channels: list[Channel | None], srgb: bool, slots: dict[str, int]
    ) -> dict[str, Any]:
        """The texture info for channels R, G, B[, A]; None where a channel does not matter.

        `srgb` says how the slot decodes R, G and B. `slots` maps UV sets to TEXCOORD numbers.
        All reads must have been checked with `usable`.
        """
        reads = [channel.read for channel in channels if channel is not None and channel.read]
        first = reads[0]
        for read in reads[1:]:
            if (read.uv, read.wrap) != (first.uv, first.wrap):
                message = f"shares a packed texture with {first.prim} and uses its coordinates"
                self.context.ledger.warn("texture-packed-transform", read.prim, message)
        copied = self.copy_index(channels, srgb)
        source, leveled = self._write(channels, srgb) if copied is None else (copied, None)
        entry: dict[str, Any] = {"sampler": self._sampler(first), "source": source}
        if leveled is not None:
            entry["extensions"] = {"KHR_texture_basisu": {"source": leveled}}
        texture = self.writer.add_once("textures", entry)
        return self._info(texture, first, slots)

    def usable(self, read: TextureRead) -> bool:
        """Whether the file can be read; a warning gives the reason where not."""
        return self.library.image(read) is not None

    def copy_index(self, channels: list[Channel | None], srgb: bool) -> int | None:
        """Index of the image, when one file already holds every channel in its place; else None."""
        used = [(place, channel) for place, channel in enumerate(channels) if channel is not None]
        files = {channel.read.file for _, channel in used if channel.read is not None}
        if len(files) != 1 or any(channel.read is None for _, channel in used):
            return None
        file = self._file(used[0][1])
        if not file.copies:
            return None
        for place, channel in used:
            assert channel.read is not None
            same = place == channel.index or (file.is_gray and place < 3 and channel.index < 3)
            plain = channel.scale == 1.0 and channel.bias == 0.0
            if not same or not plain:
                return None
            if place < 3 and not channel.raw and is_srgb(channel.read, file) != srgb:
                return None
            if place == 3 and not file.has_alpha:
                return None
        if len(channels) == 4 and channels[3] is None and file.has_alpha:
            return None  # the file's alpha would show
        return self.library.add_copy(file)

    def _file(self, channel: Channel) -> ImageFile:
        assert channel.read is not None
        file = self.library.image(channel.read)
        assert file is not None
        return file

    def _write(self, channels: list[Channel | None], srgb: bool) -> tuple[int, int | None]:
        key = (tuple(channels), srgb)
        if key in self._packed:
            return self._packed[key]
        files = [self._file(c) if c is not None and c.read else None for c in channels]
        sizes = {file.size for file in files if file is not None}
        size = (max(s[0] for s in sizes), max(s[1] for s in sizes))
        name = "_".join(dict.fromkeys(file.name for file in files if file is not None))
        used = [file for file in files if file is not None]
        levels = used[0].levels if all(file is used[0] for file in used) else ()
        self._explain(channels, files, sizes, srgb, len(levels))
        pixels = self._pixels(channels, files, size, srgb)
        stated = [
            self._pixels(channels, [file and level for file in files], level.size, srgb)
            for level in levels
        ]
        leveled = self.library.add_levels([pixels, *stated], srgb, name) if stated else None
        self._packed[key] = self.library.add_pixels(pixels, name), leveled
        return self._packed[key]

    def _pixels(
        self,
        channels: list[Channel | None],
        files: list[ImageFile | None],
        size: tuple[int, int],
        srgb: bool,
    ) -> Array:
        planes = [
            self._plane(channel, file, size, srgb and place < 3)
            for place, (channel, file) in enumerate(zip(channels, files, strict=True))
        ]
        if len(channels) == 4 and channels[3] is None:
            planes.pop()
        return np.dstack(planes)

    def _plane(
        self, channel: Channel | None, file: ImageFile | None, size: tuple[int, int], encode: bool
    ) -> Array:
        """One channel as uint8 (height, width)."""
        if channel is None or channel.read is None or file is None:
            level = 1.0 if channel is None else channel.constant
            value = linear_to_srgb(np.array(level)) if encode else np.array(level)
            return np.full(size[::-1], np.uint8(np.round(np.clip(value, 0.0, 1.0) * 255.0)))
        decode = _is_decoded(channel, file)
        floats = file.floats
        table = np.arange(256) / 255.0 if floats is None else floats[..., channel.index]
        if decode != encode or channel.scale != 1.0 or channel.bias != 0.0:
            linear = srgb_to_linear(table) if decode else table
            value = np.clip(linear * channel.scale + channel.bias, 0.0, 1.0)
            table = linear_to_srgb(value) if encode else value
        lookup = np.round(np.clip(table, 0.0, 1.0) * 255.0).astype(np.uint8)
        plane = lookup if floats is not None else lookup[file.rgba()[..., channel.index]]
        if file.size != size:
            resized = Image.fromarray(plane).resize(size, Image.Resampling.BILINEAR)
            plane = np.asarray(resized)
        return plane

    def _explain(
        self,
        channels: list[Channel | None],
        files: list[ImageFile | None],
        sizes: set[tuple[int, int]],
        srgb: bool,
        levels: int,
    ) -> None:
        for place, (channel, file) in enumerate(zip(channels, files, strict=True)):
            if channel is None or channel.read is None or file is None:
                continue
            warn = self.context.ledger.warn
            if not file.copies or file.wide:
                message = f"a {file.format} image of mode {file.mode} became 8-bit PNG"
                if file.floats is not None and file.floats[..., channel.index].max() > 1.0:
                    message += "; values above 1 are lost"
                if levels:
                    message += f", and KTX2 with {levels} of its mip levels"
                if file.has_more or len(file.levels) > levels:
                    message += "; pictures after these are left out"
                warn("texture-converted", channel.read.prim, message)
            elif channel.scale != 1.0 or channel.bias != 0.0 or len(sizes) > 1:
                message = "its values were rewritten (scale, bias or size) with 8-bit rounding"
                warn("texture-repacked", channel.read.prim, message)
            elif _is_decoded(channel, file) != (srgb and place < 3):
                spaces = "linear to sRGB" if srgb and place < 3 else "sRGB to linear"
                message = f"its texels were recoded from {spaces} with 8-bit rounding"
                warn("texture-repacked", channel.read.prim, message)

    def _sampler(self, read: TextureRead) -> int:
        wraps = [_WRAPS.get(wrap, CLAMP_TO_EDGE) for wrap in read.wrap]
        sampler = {
            "magFilter": LINEAR,
            "minFilter": LINEAR_MIPMAP_LINEAR,
            "wrapS": wraps[0],
            "wrapT": wraps[1],
        }
        return self.writer.add_once("samplers", sampler)

    def _info(self, texture: int, read: TextureRead, slots: dict[str, int]) -> dict[str, Any]:
        info: dict[str, Any] = {"index": texture}
        slot = slots.get(read.uv.primvar, 0)
        if slot:
            info["texCoord"] = slot
        transform = texture_transform(read)
        if transform:
            self.writer.use_extension("KHR_texture_transform")
            info["extensions"] = {"KHR_texture_transform": transform}
        return info


def _is_decoded(channel: Channel, file: ImageFile) -> bool:
    """Whether USD decodes the channel's texels from sRGB."""
    assert channel.read is not None
    return channel.index < 3 and not channel.raw and is_srgb(channel.read, file)


def wraps_to_black(read: TextureRead) -> bool:
    """Whether the texture is black outside 0…1; a file's own wrap metadata is never there."""
    return any(wrap not in _WRAPS for wrap in read.wrap)


def texture_transform(read: TextureRead) -> dict[str, Any]:
    """KHR_texture_transform for UsdTransform2d: st' = R(θ)·(s·st) + t, with glTF's v = 1 − t.

    Written out for both conventions, the scale stays, the rotation keeps its sign in the sense of
    u' = c·sx·u + s·sy·v, v' = −s·sx·u + c·sy·v, and the offset takes up the flip of v.
    """
    uv = read.uv
    angle = math.radians(uv.rotation_deg)
    sine, cosine = math.sin(angle), math.cos(angle)
    scale_y = uv.scale[1]
    offset = (
        uv.translation[0] - scale_y * sine,
        1.0 - uv.translation[1] - scale_y * cosine,
    )
    transform: dict[str, Any] = {}
    if abs(offset[0]) > 1e-12 or abs(offset[1]) > 1e-12:
        transform["offset"] = list(offset)
    if angle != 0.0:
        transform["rotation"] = angle
    if uv.scale != (1.0, 1.0):
        transform["scale"] = list(uv.scale)
    return transform
