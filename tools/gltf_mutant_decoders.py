"""Makes small files whose decoders would take much memory, one of each known kind.

`tools/gltf_mutants.py` reads them as broken files, and the fuzzers of `tools/fuzz.sh` begin with
them, so that each kind stays closed.
"""

import json
import random
import struct
import zlib
from collections.abc import Callable, Sequence
from typing import Any

LARGE_PX = (2048, 8192, 16384, 65535)


def glb(
    root: dict[str, Any], binary: bytes | None, separators: tuple[str, str] | None = None
) -> bytes:
    """A `.glb` of a JSON chunk, with these separators, and perhaps a binary chunk."""
    chunks = b""
    text = json.dumps(root, separators=separators).encode()
    for kind, data, pad in ((b"JSON", text, b" "), (b"BIN\0", binary, b"\0")):
        if data is not None:
            data += pad * (-len(data) % 4)
            chunks += struct.pack("<I4s", len(data), kind) + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


class Buffer:
    """Views and accessors of a glTF file, whose one buffer grows."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def view(self, raw: bytes, **more: Any) -> int:
        self.data += b"\0" * (-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw)}
        self.views.append(view | more)
        self.data += raw
        return len(self.views) - 1

    def accessor(self, view: int, kind: str, component: int, count: int, **more: Any) -> int:
        entry = {"bufferView": view, "componentType": component, "type": kind, "count": count}
        self.accessors.append(entry | more)
        return len(self.accessors) - 1

    def floats(self, kind: str, count: int, numbers: Sequence[float], **more: Any) -> int:
        """Add an accessor of floats."""
        raw = struct.pack(f"<{len(numbers)}f", *numbers)
        return self.accessor(self.view(raw), kind, 5126, count, **more)

    def glb(self, root: dict[str, Any], separators: tuple[str, str] | None = None) -> bytes:
        """A `.glb` of the buffer and a JSON, which may leave out a first node of a first mesh."""
        self.data += b"\0" * (-len(self.data) % 4)
        first = {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}]}
        lists = {"accessors": self.accessors, "bufferViews": self.views}
        lists["buffers"] = [{"byteLength": len(self.data)}]
        return glb(root | (first | root | lists), bytes(self.data), separators)


def on_triangle(image: bytes, extension: str | None, mime: str, copies: int = 1) -> bytes:
    """A `.glb` of a triangle with the image as its base color, perhaps as several images."""
    out = Buffer()
    bounds = {"min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 0.0]}
    corners = out.floats("VEC3", 3, (0, 0, 0, 1, 0, 0, 0, 1, 0), **bounds)
    attributes = {"POSITION": corners, "TEXCOORD_0": out.floats("VEC2", 3, (0, 0, 1, 0, 0, 1))}
    view = out.view(image)

    def texture(source: int) -> dict[str, Any]:
        return {"extensions": {extension: {"source": source}}} if extension else {"source": source}

    root: dict[str, Any] = {
        "meshes": [
            {"primitives": [{"attributes": attributes, "material": i} for i in range(copies)]}
        ],
        "materials": [
            {"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}} for i in range(copies)
        ],
        "textures": [texture(i) for i in range(copies)],
        "images": [{"bufferView": view, "mimeType": mime} for _ in range(copies)],
    }
    if extension:
        root |= {"extensionsUsed": [extension], "extensionsRequired": [extension]}
    return out.glb(root)


def _segment(marker: int, body: bytes) -> bytes:
    return struct.pack(">BBH", 0xFF, marker, len(body) + 2) + body


def _frame(marker: int, side: int, factors: int = 0x11, count: int = 3) -> bytes:
    parts = (bytes((i, factors if i == 1 else 0x11, 0)) for i in range(1, count + 1))
    return _segment(marker, struct.pack(">BHHB", 8, side, side, count) + b"".join(parts))


def _exif(chance: random.Random) -> bytes:
    """Exif data of an orientation, which may not exist."""
    entry = struct.pack(">HHIHH", 0x0112, 3, 1, chance.choice((*range(1, 9), 0, 99)), 0)
    return b"MM\0*\0\0\0\x08" + struct.pack(">H", chance.choice((1, 1, 65535))) + entry + bytes(4)


def jpeg(chance: random.Random) -> bytes:
    """A JPEG whose frame header is large: baseline or progressive, after decoys, or cut off."""
    side, marker = chance.choice(LARGE_PX), chance.choice((0xC0, 0xC1, 0xC2))
    decoys = chance.sample((0xC3, 0xC5, 0xC8, 0xC9, 0xCB, 0xCD, 0xCF), chance.randrange(3))
    codes = b"\1" + bytes(15) + b"\0"
    count = chance.choice((1, 3, 3, 4))
    scanned = 1 if chance.random() < 0.5 else count
    scan = bytes((scanned,)) + b"".join(bytes((i + 1, 0)) for i in range(scanned))
    tags = _segment(0xE1, b"Exif\0\0" + _exif(chance)) if chance.random() < 0.3 else b""
    tags += chance.choice((b"", _segment(0xEE, b"Adobe\0\x64\0\0\0\0" + chance.randbytes(1))))
    end = 0 if marker == 0xC2 else 63
    data = bytes(chance.choice((0, 100, 1 << 12, 1 << 15, 1 << 18)))
    end_of_image = chance.choice((b"\xff\xd9", b""))
    return (
        b"\xff\xd8"
        + tags
        + b"".join(_frame(decoy, 8) for decoy in decoys)
        + _segment(0xDB, b"\0" + b"\1" * 64)
        + _frame(marker, side, chance.choice((0x11, 0x22, 0x44, 0x41, 0x14)), count)
        + _segment(0xC4, b"\x00" + codes)
        + _segment(0xC4, b"\x10" + codes)
        + _segment(0xDA, scan + bytes((0, end, 0)))
        + data
        + end_of_image
    )


def png(chance: random.Random) -> bytes:
    """A PNG of up to 16 bits a channel, whole or cut off, perhaps with a large color profile."""
    width, height = chance.choice(LARGE_PX), chance.choice((1, 1024, *LARGE_PX))
    color, channels = chance.choice(((0, 1), (2, 3), (3, 1), (4, 2), (6, 4)))
    depth = chance.choice({0: (1, 2, 4, 8, 16), 3: (1, 2, 4, 8)}.get(color, (8, 16)))
    row = 1 + -(-width * channels * depth // 8)
    rows = min(height, (16 << 20) // row) if chance.random() < 0.5 else 1

    def chunk(kind: bytes, body: bytes) -> bytes:
        data = kind + body
        return struct.pack(">I", len(body)) + data + struct.pack(">I", zlib.crc32(data))

    head = struct.pack(">IIBBBBB", width, height, depth, color, 0, 0, chance.randrange(2))
    profile = chance.choice((b"", chunk(b"gAMA", struct.pack(">I", chance.choice((0, 1, 2**31))))))
    profile += chance.choice((b"", chunk(b"cICP", chance.randbytes(4))))
    profile += chance.choice((b"", chunk(b"cHRM", chance.randbytes(32))))
    frames = chunk(b"acTL", struct.pack(">II", chance.choice((1, 1 << 30)), 0))
    profile += chance.choice((b"", b"", frames))
    profile += chunk(b"PLTE", chance.randbytes(3 * chance.choice((1, 256)))) if color == 3 else b""
    alpha = chunk(b"tRNS", chance.randbytes(chance.choice((2, 6, 256))))
    profile += chance.choice((b"", b"", alpha))
    profile += chance.choice((b"", b"", chunk(b"eXIf", _exif(chance))))
    if chance.random() < 0.3:
        profile += chunk(b"iCCP", b"p\0\0" + zlib.compress(bytes(32 << 20), 9))
    chunks = chunk(b"IHDR", head) + profile + chunk(b"IDAT", zlib.compress(bytes(row * rows), 9))
    return b"\x89PNG\r\n\x1a\n" + chunks + chunk(b"IEND", b"")


def webp(chance: random.Random) -> bytes:
    """A WebP whose frame is larger than its canvas, or a lossless one without data."""
    side = chance.choice((16, 2048, 16383))
    frame = b"\x10\2\0\x9d\1\x2a" + struct.pack("<HH", side, side) + bytes(64)

    def chunk(kind: bytes, body: bytes) -> bytes:
        return kind + struct.pack("<I", len(body)) + body + b"\0" * (len(body) % 2)

    if chance.random() < 0.5:
        flags = chance.choice((0, 0x10, 0x02, 0x3A))  # alpha, animation, both with metadata
        canvas = chunk(b"VP8X", bytes((flags, 0, 0, 0)) + bytes(6))
        canvas += chunk(b"ANIM", bytes(6)) if flags & 2 else b""
        canvas += chunk(b"ALPH", chance.randbytes(9)) if flags & 16 else b""
        canvas += chunk(b"EXIF", _exif(chance)) if flags & 8 else b""
        canvas += chunk(b"VP8 ", frame)
    else:
        bits = (side - 1) | (side - 1) << 14
        data = chance.choice((bytes(64), chance.randbytes(4096)))
        canvas = chunk(b"VP8L", b"\x2f" + struct.pack("<I", bits) + data)
    return chunk(b"RIFF", b"WEBP" + canvas)


def ktx2(chance: random.Random) -> bytes:
    """A KTX2 picture of random blocks, perhaps inflated, or larger or shorter than it says."""
    formats = {37: (1, 4), 97: (1, 8), 131: (4, 8), 143: (4, 16), 145: (4, 16), 149: (4, 8)}
    formats |= {151: (4, 16), 153: (4, 8), 157: (4, 16), 165: (6, 16), 183: (12, 16)}
    formats |= {1000066000: (4, 16), 1000066004: (6, 16)}
    kind = chance.choice(sorted(formats))
    edge, size = formats[kind]
    side = chance.choice((1, 4, 16, 64))
    level = chance.randbytes((-(-side // edge)) ** 2 * size)
    scheme = chance.choice((0, 0, 3, 3, 1, 2)) if kind < 157 else 0  # BasisLZ, Zstandard, zlib
    stored = zlib.compress(level, 9) if scheme == 3 else level
    stated = chance.choice((len(level), len(level), 16 << 20, 2**63))
    stated_side = chance.choice((side, side, side, *LARGE_PX))
    descriptor = b""
    if kind >= 157:
        descriptor = struct.pack("<IIHH", 44, 0, 2, 40)
        model = 167 if kind == 1000066000 else 162
        descriptor += bytes((model, 1, 1, 0, edge - 1, edge - 1, 0, 0, 16)) + bytes(7)
        descriptor += struct.pack("<HBB3I", 0, 127, 0, 0, 0, 2**32 - 1)
    values = b""
    orientation = chance.choice((b"rd", b"ru", b"ld", b"lu"))
    swizzle = chance.choice((b"rgba", b"bgra", b"rrr1", b"0gr1"))
    for key, value in ((b"KTXorientation", orientation), (b"KTXswizzle", swizzle)):
        pair = key + b"\0" + chance.choice((value, value[:1], b"", b"\xff" * 9)) + b"\0"
        values += struct.pack("<I", chance.choice((len(pair), len(pair), 2**32 - 1)))
        values += pair + b"\0" * (-len(pair) % 4)
    start = 104 + len(descriptor) + len(values)
    head = b"\xabKTX 20\xbb\r\n\x1a\n"
    shape = chance.choice(((stated_side, 0, 0, 1), (0, 0, 6, 1), (1, 9, 1, 0), (0, 0, 1, 1)))
    shape = chance.choice(((stated_side, 0, 0, 1), (stated_side, 0, 0, 1), shape))
    head += struct.pack("<9I", kind, 1, stated_side, *shape, 1, scheme)
    end = 104 + len(descriptor)
    head += struct.pack("<4I", 104, len(descriptor), end, len(values))
    head += struct.pack("<5Q", 0, 0, start, len(stored), stated)
    whole = head + descriptor + values + stored
    return whole[: chance.choice((len(whole), len(whole), chance.randrange(len(whole))))]


def draco(chance: random.Random) -> bytes:
    """A model whose Draco stream says that it holds more vertices than its accessors."""
    points = bytearray()
    left = chance.choice((4, 1000, 200_000_000, 2**32 - 1))
    while left >= 0x80:
        points.append(left & 0x7F | 0x80)
        left >>= 7
    points.append(left)
    kind = chance.choice((2, 9))  # 8-bit integers, or floats
    stream = b"DRACO\2\2\1\0\0\0\0" + bytes(points)
    stream += b"\1\0\0\0\0\1\0\0\0\2\0\0\0\1\1\0" + bytes((kind,)) + b"\3\0\0\0\1"
    stream += b"\xfe\1\1\1\1\1\x40\1"
    name = "KHR_draco_mesh_compression"
    compressed = {"bufferView": 0, "attributes": {"POSITION": 0}}
    primitive = {"attributes": {"POSITION": 0}, "indices": 1, "extensions": {name: compressed}}
    out = Buffer()
    out.view(stream)
    out.accessors += [
        {"componentType": 5126, "count": 3, "type": "VEC3"},
        {"componentType": 5125, "count": 3, "type": "SCALAR"},
    ]
    meshes = [{"primitives": [primitive] * chance.choice((1, 1, 100))}]
    return out.glb({"extensionsUsed": [name], "extensionsRequired": [name], "meshes": meshes})


def far(chance: random.Random) -> bytes:
    """Triangles with huge coordinates, at rest, in a morph target, or by their node."""
    count = chance.choice((3, 6, 300))
    values = [chance.uniform(-1, 1) for _ in range(3 * count)]
    where = chance.randrange(4)
    huge = chance.choice((1e16, 3e38, -3e38))
    offsets = [0.0] * len(values)
    if where == 0:
        values[chance.randrange(len(values))] = huge
    elif where == 1:
        offsets[chance.randrange(len(values))] = huge
    node: dict[str, Any] = {"mesh": 0}
    if where == 2:
        node["translation"] = [0, huge, 0]
    elif where == 3:
        node["scale"] = [huge, huge, huge]
    out = Buffer()
    primitive: dict[str, Any] = {"attributes": {"POSITION": out.floats("VEC3", count, values)}}
    primitive["targets"] = [{"POSITION": out.floats("VEC3", count, offsets)}]
    sampler = {"input": out.floats("SCALAR", 2, (0, 1)), "output": out.floats("SCALAR", 2, (0, 1))}
    channel = {"sampler": 0, "target": {"node": 0, "path": "weights"}}
    meshes = [{"weights": [0], "primitives": [primitive]}]
    animations = [{"channels": [channel], "samplers": [sampler]}]
    return out.glb({"nodes": [node], "meshes": meshes, "animations": animations})


def objects(chance: random.Random) -> bytes:
    """Lists of empty objects, which take a hundred times as much memory as text."""
    root: dict[str, Any] = {"asset": {"version": "2.0"}}
    count = chance.choice((1000, 100_000, 3_000_000))
    root[chance.choice(("nodes", "materials", "accessors", "animations"))] = [{}] * count
    return json.dumps(root, separators=(",", ":")).encode()


def panorama(chance: random.Random) -> bytes:
    """A panorama of either format, of which each part is odd in one of twenty."""
    return chance.choice((exr, exr, hdr))(chance)


def _odd(chance: random.Random, good: Any, *odd: Any) -> Any:
    return chance.choice(odd) if chance.random() < 0.05 else good


def exr(chance: random.Random) -> bytes:
    """An OpenEXR panorama of many channels, of odd headers, or of blocks that claim to be large."""
    width, height = _odd(chance, 64, *LARGE_PX), 32
    # None, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
    kinds = tuple(enumerate((1, 1, 1, 16, 32, 16, 32, 32, 32, 256)))
    packing, lines = chance.choice((*kinds, *(kinds[n] for n in (0, 0, 0, 2, 3, 3, 3, 3))))
    deep = packing in (0, 2) and chance.random() < 0.2
    layers = (b"r g b", b"a.R a.G a.B", b"View.Combined.R View.Combined.G View.Combined.B")
    good = chance.choice((b"R G B", b"A R G B Z", b"Y", b"Y RY BY", *layers))
    shown = _odd(chance, good, b"G", b"", b"R R G B", b"\xff", b"R." * 200).split()
    names = sorted((*shown, *(b"x%d" % i for i in range(_odd(chance, 0, 3, 2000, 20_000)))))
    step = _odd(chance, 2, 1, 0, 3, -1)
    steps = [step if name in (b"RY", b"BY") else 1 for name in names]
    kind, size = _odd(chance, (2, 4), (1, 2), (0, 4), (9, 4))  # float, half, unsigned
    described = (struct.pack("<iIii", kind, 0, step, step) for step in steps)
    channels = b"".join(n + b"\0" + d for n, d in zip(names, described, strict=True)) + b"\0"
    left, top = _odd(chance, chance.choice(((0, 0), (-5, 7))), (2**31 - 9, 0))
    box = struct.pack("<4i", left, top, min(left + width, 2**31) - 1, top + height - 1)
    box = _odd(chance, box, struct.pack("<4i", width - 1, height - 1, 0, 0), box[:9])
    window = struct.pack("<4i", *sorted(chance.randrange(-99, 99) for _ in range(4)))
    window = _odd(chance, chance.choice((box, window)), window[::-1], bytes(16))

    lost = chance.choice((b"channels", b"compression", b"dataWindow", b"displayWindow", b"type"))
    lost, longer = _odd(chance, (b"", 0), (lost, 0), (b"", 1), (b"", 2**31 - 99), (b"", -99))

    def attribute(name: bytes, kind: bytes, value: bytes) -> bytes:
        stated = struct.pack("<i", len(value) + longer)
        return b"" if name == lost else name + b"\0" + kind + b"\0" + stated + value

    form = _odd(chance, 0, 1 << 9, 1 << 12, 1 << 30)  # tiles, or several parts
    head = b"\x76\x2f\x31\x01" + struct.pack("<I", _odd(chance, 2, 1, 99) | deep << 11 | form)
    head += attribute(b"channels", b"chlist", channels)
    head += attribute(b"compression", b"compression", bytes((packing,)))
    head += attribute(b"dataWindow", b"box2i", box) + attribute(b"displayWindow", b"box2i", window)
    head += attribute(b"lineOrder", b"lineOrder", _odd(chance, b"\0", b"\1", b"\2", b"\7"))
    aspect = _odd(chance, 1, 2, 0, -1, float("nan"))
    head += attribute(b"pixelAspectRatio", b"float", struct.pack("<f", aspect))
    head += attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0))
    head += attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1))
    named = b"deepscanline" if deep else _odd(chance, b"scanlineimage", b"x", b"tiledimage")
    head += attribute(b"type", b"string", named)
    head += attribute(b"version", b"int", struct.pack("<i", 1))
    if chance.random() < 0.3:
        colors = chance.choice(([0.3] * 8, [1, 0, 0, 1, 0, 0, 1 / 3, 1 / 3], [3e38, -1] * 4))
        head += attribute(b"chromaticities", b"chromaticities", struct.pack("<8f", *colors))
    head += _odd(chance, b"", attribute(b"envmap", b"envmap", b"\1")) + b"\0"
    if deep:
        count = chance.choice((0, 1, 1000, 2**31, 2**32 - 1))
        ends = b"".join(struct.pack("<I", min(i * count, 2**32 - 1)) for i in range(width))
        samples = bytes(min(1 << 16, size * len(names) * width * count))
        unpacked = chance.choice((len(samples), size * len(names) * (width - 1) * count, 1 << 40))
        if packing == 2:
            ends, samples = zlib.compress(ends, 9), zlib.compress(samples, 9)
        # The second half of each block's head stands where flat blocks have a length.
        data = struct.pack("<QQQ", len(ends), len(samples), unpacked) + ends + samples
    elif packing in (8, 9):
        sizes = [chance.choice((0, 64, 1 << 24, 1 << 40, 2**63 - 1)) for _ in range(11)]
        data = struct.pack("<11Q", 1, *sizes[1:]) + bytes(64)
    else:
        value = struct.pack("<f", chance.choice((0, 0, 1, -1e-7, float("inf"), float("nan"))))
        texels = sum(-(-width // max(s, 1)) * -(-lines // max(s, 1)) for s in steps)
        data = value * (min(16 << 20, size * texels) // 4)
        data = data[: 1 << 22] if packing == 0 else zlib.compress(data, 9)
    blocks = -(-height // lines)
    length = b"" if deep else struct.pack("<i", len(data))
    step = 4 + len(length) + len(data)
    table = b"".join(struct.pack("<Q", len(head) + 8 * blocks + i * step) for i in range(blocks))
    body = b"".join(struct.pack("<i", top + i * lines) + length + data for i in range(blocks))
    return head + table + body


def hdr(chance: random.Random) -> bytes:
    """A Radiance panorama of odd headers and orders of pixels, packed or not."""
    lines = [
        b"#?" + _odd(chance, chance.choice((b"RADIANCE", b"RGBE", b"AUTOPANO")), b"", b" RGBE")
    ]
    numbers: tuple[bytes, ...] = (b"1", b"0", b"-1", b"1e38", b"nan", b"2 3 4", b"1 0 -1", b"x")
    numbers += (b".708 .292 .17 .797 .131 .046 .3127 .329", b".3 .3 .3 .3 .3 .3 .3 .3")
    keys = (b"EXPOSURE", b"COLORCORR", b"GAMMA", b"PRIMARIES", b"PIXASPECT")
    for key in chance.sample(keys, chance.randrange(len(keys))):
        lines += [key + b"= " + chance.choice(numbers)] * chance.choice((1, 1, 300))
    lines.append(b"FORMAT=32-bit_rle_" + _odd(chance, chance.choice((b"rgbe", b"xyze")), b"none"))
    sides = _odd(chance, [32, 64], [32768, 2], [-1, 64], [0, 64], [64, 2**31])
    signs = [chance.choice((b"-Y", b"+Y")), chance.choice((b"+X", b"-X"))]
    axes = _odd(chance, chance.choice((signs, signs[::-1])), signs[:1] * 2)
    size = b" ".join(a + b" %d" % side for a, side in zip(axes, sides, strict=True))
    row = b"\2\2\0\x40" + b"\xc0\1" * 4
    good = chance.choice((chance.randbytes(4 * 64 * 32), row * 32))
    pixels = _odd(chance, good, bytes(99), good[:-5], row * 31 + b"\2\2\x40\0", row * 99)
    return b"\n".join((*lines, b"", size, pixels))


def cube(chance: random.Random) -> bytes:
    """A triangle below a cube map whose faces are such images, or whose numbers are wrong."""
    make, mime = chance.choice(((jpeg, "image/jpeg"), (png, "image/png"), (ktx2, "image/ktx2")))
    data = on_triangle(make(chance), None, mime, chance.choice((1, 8)))
    length = struct.unpack_from("<I", data, 12)[0]
    root: dict[str, Any] = json.loads(data[20 : 20 + length])
    last = len(root["images"]) - 1
    faces = [chance.choice((0, last)) for _ in range(chance.choice((6, 6, 6, 0, 5, 7)))]
    if chance.random() < 0.2:
        faces[-1:] = [chance.choice((last + 1, 1 << 40))]
    light: dict[str, Any] = {
        "specularImages": [faces] * chance.choice((1, 1, 0, 1000)),
        "specularImageSize": chance.choice(LARGE_PX),
    }
    if chance.random() < 0.3:
        light["intensity"] = chance.choice((0, -1, 3e38))
        light["rotation"] = chance.choice(([0, 0, 0, 0], [1, 1, 0, 0], [3e38, 0, 0, 3e38], [1, 2]))
    name = "EXT_lights_image_based"
    root["extensions"] = {name: {"lights": [light]}}
    root["scenes"][0]["extensions"] = {name: {"light": chance.choice((0, 0, 0, 1))}}
    root["extensionsUsed"] = [name]
    return glb(root, data[28 + length :])


MODELS: dict[str, Callable[[random.Random], bytes]] = {
    "jpeg": lambda chance: on_triangle(jpeg(chance), None, "image/jpeg", chance.choice((1, 2, 8))),
    "png": lambda chance: on_triangle(png(chance), None, "image/png", chance.choice((1, 2, 8))),
    "webp": lambda chance: on_triangle(webp(chance), "EXT_texture_webp", "image/webp"),
    "ktx2": lambda chance: on_triangle(ktx2(chance), None, "image/ktx2", chance.choice((1, 8))),
    "cube": cube,
    "draco": draco,
    "far": far,
    "objects": objects,
}
"""Makers of glTF files, by kind."""


def model(chance: random.Random) -> bytes:
    """A glTF file of a random kind."""
    return MODELS[chance.choice(sorted(MODELS))](chance)
