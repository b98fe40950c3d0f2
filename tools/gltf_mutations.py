"""Owns how glTF files are broken: bytes, lengths, JSON, streams, numbers, claims, graphs."""

import base64
import dataclasses
import json
import random
import re
import struct
import urllib.parse
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import gltf_mutant_decoders

KINDS = {
    "bytes": "some bytes of the file",
    "length": "its length, or that of a chunk",
    "number": "numbers of the JSON",
    "value": "values of the JSON, lost or of another type",
    "stream": "bytes of compressed geometry and images, or of other buffers",
    "claim": "counts and lengths of up to 4 GiB",
    "graph": "circles of nodes, joints and targets of animations",
    "floats": "NaN, infinite and huge numbers in buffers",
    "targets": "100,000 morph targets",
    "decoder": "small files that would become large while they are decoded",
    "panorama": "headers, sizes and blocks of panoramas",
}
DECODER_EVERY = 20
"""Share of the broken files that are made anew for a decoder."""
PARTS = {
    "materials": (
        r"/materials/\d+/(name|alphaMode|alphaCutoff|doubleSided|emissiveFactor"
        r"|(pbrMetallicRoughness|extensions/KHR_materials_\w+)(/\w+Factor)?)",
        ("textures",),
    ),
    "uses of textures": (
        r"/materials/\d+(/pbrMetallicRoughness|/extensions/KHR_materials_\w+)?/\w+Texture"
        r"(/(index|texCoord|extensions/KHR_texture_transform(/(offset|rotation|scale))?))?",
        ("textures",),
    ),
    "textures": (
        r"/textures/\d+(/(source|sampler|extensions/\w+(/source)?))?",
        ("textures",),
    ),
    "images": (r"/images/\d+(/(uri|bufferView|name))?", ("textures",)),
    "samplers": (r"/samplers/\d+(/(wrapS|wrapT|magFilter))?", ("textures",)),
    "cameras": (
        r"/cameras/\d+(/(name|(perspective|orthographic)(/(yfov|ymag|znear))?))?",
        ("cameras",),
    ),
    "lights": (
        r"/extensions/KHR_lights_punctual/lights"
        r"(/\d+(/(type|color|intensity|range|spot(/\w+ConeAngle)?))?)?",
        ("lights",),
    ),
    "lights and cameras of nodes": (
        r"/nodes/\d+/(camera|extensions/KHR_lights_punctual(/light)?)",
        ("lights", "cameras"),
    ),
    "names": (r"/(nodes|meshes)/\d+/name", ()),
    "attributes": (
        r"/meshes/\d+/primitives/\d+/attributes/(NORMAL|TANGENT|TEXCOORD_\d|COLOR_0)",
        (),
    ),
    "accessors of attributes": (
        r"/accessors/\d+/(count|byteOffset|bufferView|componentType|type|normalized)",
        (),
    ),
    "attributes of morph targets": (
        r"/meshes/\d+/primitives/\d+/targets/\d+/(NORMAL|TANGENT|TEXCOORD_\d|COLOR_0)",
        (),
    ),
    "materials of meshes": (
        r"/meshes/\d+/primitives/\d+/(material|extensions/KHR_materials_variants"
        r"(/mappings(/\d+(/(material|variants))?)?)?)",
        ("materials", "textures"),
    ),
    "variants": (
        r"/extensions/KHR_materials_variants(/variants(/\d+(/name)?)?)?",
        ("variants",),
    ),
    "animations": (r"/animations/\d+(/(channels|samplers))?", ("animations",)),
    "channels": (
        r"/animations/0/(channels/\d+(/(sampler|target(/(node|path))?))?"
        r"|samplers/\d+(/(input|output|interpolation))?)",
        ("animations",),
    ),
    "whole lists": (
        r"/(materials|textures|images|samplers|cameras|animations|extensions)",
        ("materials", "textures", "cameras", "lights", "animations", "variants"),
    ),
    "scenes and nodes": (
        r"/scene|/scenes/\d+(/nodes(/\d+)?)?"
        r"|/nodes/\d+(/(mesh|skin|matrix|translation|rotation|scale|(children|weights)(/\d+)?"
        r"|extensions/EXT_mesh_gpu_instancing(/attributes(/\w+)?)?))?",
        None,
    ),
    "meshes": (
        r"/meshes/\d+(/primitives(/\d+(/(mode|indices|attributes(/(POSITION|(JOINTS|WEIGHTS)_0))?"
        r"|targets(/\d+(/POSITION)?)?|extensions/\w+_(draco|meshopt)_\w+(/\w+)?))?)?)?",
        None,
    ),
    "skins": (r"/skins/\d+(/(joints(/\d+)?|inverseBindMatrices))?", None),
    "buffers": (
        r"/(accessors|bufferViews|buffers)/\d+(/(count|byteOffset|byteLength|byteStride|buffer"
        r"|bufferView|componentType|type|uri|sparse(/\w+)?))?",
        None,
    ),
    "lists of geometry": (r"/(nodes|meshes|skins|accessors|bufferViews|buffers|scenes)", None),
}
"""Kinds of parts, by patterns of their JSON pointers. A file shows everything else without them,
but for the counts; without counts (geometry, skins, transforms) it may also be refused by name."""
_USER = re.compile(
    r"/meshes/\d+/primitives/\d+/(indices|(attributes|targets/\d+)/\w+)|/nodes/.*/attributes/\w+"
    r"|/skins/\d+/inverseBindMatrices|/animations/\d+/samplers/\d+/(input|output)"
)
"""References to accessors."""
Pointer = tuple[Any, Any]
"""A container of the JSON, and a key or index in it."""
_SPECIAL = (0, 1, -1, 2, 3, 7, 255, 256, 5120, 5121, 5123, 5125, 5126, 65535, 65536, 1 << 24)
_LARGE = (2**31 - 1, 2**31, 2**32 - 4, 2**32 - 1, 2**32, 2**40, 2**63, 2**64 - 1)
_ODD = (0.5, -0.0, 1e-38, 1e38, 3.5e38, 1e300, -1e300, float("nan"), float("inf"))
_TYPES: tuple[Any, ...] = (None, True, "", "../x", "data:,", [], [[]], {}, 1.5, -1, "NaN")
_COUNTS = ("count", "byteLength", "byteOffset", "byteStride", "width", "height")
_COMPRESSION = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression")
_PACKED_IMAGES = ("EXT_texture_webp", "KHR_texture_basisu")


@dataclasses.dataclass
class Model:
    """A glTF file in its parts."""

    file: Path
    data: bytes
    """Bytes of the whole file."""
    root: dict[str, Any] | None
    """JSON of the file; None where it cannot be read."""
    binary: bytes | None
    """The binary chunk of a `.glb`."""
    beside: dict[str, bytes]
    """External files that the model names, by decoded URI."""

    @property
    def name(self) -> str:
        return self.file.name

    @property
    def is_compressed(self) -> bool:
        """Whether the model holds geometry or images compressed by an extension."""
        used = self.root.get("extensionsUsed", []) if self.root else []
        return any(name in used for name in (*_COMPRESSION, *_PACKED_IMAGES))

    def assemble(self, root: dict[str, Any], binary: bytes | None) -> bytes:
        """The file with another JSON and binary chunk."""
        if not is_glb(self.data):
            return json.dumps(root).encode()
        return gltf_mutant_decoders.glb(root, binary)


def is_glb(data: bytes) -> bool:
    return data[:4] == b"glTF" and len(data) >= 20


def read_model(file: Path) -> Model:
    """Read a root file and the files that it names."""
    data = file.read_bytes()
    text, binary = data, None
    if is_glb(data):
        length = struct.unpack("<I", data[12:16])[0]
        text = data[20 : 20 + length]
        rest = data[20 + length :]
        if rest[4:8] == b"BIN\0":
            binary = rest[8 : 8 + struct.unpack("<I", rest[:4])[0]]
    try:
        root = json.loads(text)
    except ValueError:
        root = None
    if not isinstance(root, dict):
        root = None
    beside = {}
    for uri in _uris(root):
        name = urllib.parse.unquote(uri)
        path = file.parent / name
        if not name.startswith("data:") and ".." not in Path(name).parts and path.is_file():
            beside[name] = path.read_bytes()
    return Model(file, data, root, binary, beside)


def mutate(
    models: list[Model], number: int, chance: random.Random
) -> tuple[str, Model, dict[str, bytes]]:
    """Break a model, each third time a compressed one; returns damage, model and files by name."""
    if not models:
        sky = Model(Path("sky.exr"), gltf_mutant_decoders.panorama(chance), None, None, {})
        return "panorama", sky, {sky.name: sky.data}
    packed = [model for model in models if model.is_compressed]
    model = models[number % len(models)]
    if number % 3 == 0 and packed:
        model = chance.choice(packed)
    if number % DECODER_EVERY == DECODER_EVERY - 1:
        return "decoder", model, {model.name: gltf_mutant_decoders.model(chance)}
    kinds = ["bytes", "length"]
    if model.root is not None:
        kinds += ["number", "value", "claim", "graph", "floats", "targets"]
        kinds += ["stream"] * (4 if model.is_compressed else 1)
    kind = chance.choice(kinds)
    files = model.beside | {model.name: model.data}
    if kind in ("bytes", "length"):
        change = _change_bytes if kind == "bytes" else _change_length
        files[model.name] = change(model.data, chance)
        return kind, model, files
    root = json.loads(json.dumps(model.root))
    if kind in ("stream", "floats"):
        buffers = _Buffers(model, root)
        (_change_stream if kind == "stream" else _change_floats)(root, buffers, chance)
        files |= buffers.beside
        files[model.name] = model.assemble(root, buffers.binary)
        return kind, model, files
    _JSON_CHANGES[kind](root, chance)
    files[model.name] = model.assemble(root, model.binary)
    return kind, model, files


def parts_of(root: Any, kind: str) -> list[tuple[str, Any, Any]]:
    """Pointers of the parts of a kind of `PARTS`, each with its container and key."""
    pattern = re.compile(PARTS[kind][0])
    places = [place for place in _pointers(root) if pattern.fullmatch(place[0])]
    if kind != "accessors of attributes":
        return places
    looks = re.compile(PARTS["attributes"][0])
    used = [
        (place[0], place[1][place[2]]) for place in _pointers(root) if _USER.fullmatch(place[0])
    ]
    own = {index for pointer, index in used if looks.fullmatch(pointer)}
    own -= {i for pointer, i in used if type(i) is int and not looks.fullmatch(pointer)}
    return [place for place in places if int(place[0].split("/")[2]) in own]


def break_part(model: Model, kind: str, chance: random.Random) -> tuple[str, dict[str, bytes]]:
    """Give a part of a kind a value of another type, or an index of nothing.

    Returns its JSON pointer and value, and the files by name.
    """
    root = json.loads(json.dumps(model.root))
    pointer, of, key = chance.choice(parts_of(root, kind))
    # An empty list is an object without keys.
    same = {int: (int, float), float: (int, float), dict: (dict, list)}
    others: list[Any] = ["lost", [], {}, 99_999]
    wrong = [v for v in others if type(v) not in same.get(type(of[key]), (type(of[key]),))]
    if type(of[key]) is int:
        wrong += [-1, 10**9 if kind == "accessors of attributes" else -7]
    of[key] = chance.choice(wrong)
    said = f"{pointer} = {json.dumps(of[key])}"
    return said, model.beside | {model.name: model.assemble(root, model.binary)}


def _pointers(value: Any) -> Iterator[tuple[str, Any, Any]]:
    """JSON pointers of all values, without recursion: files may nest deeply."""
    waiting = [("", value)]
    while waiting:
        pointer, of = waiting.pop()
        keys: Any = of.keys() if isinstance(of, dict) else range(len(of))
        for key in keys:
            yield f"{pointer}/{key}", of, key
            if isinstance(of[key], (dict, list)):
                waiting.append((f"{pointer}/{key}", of[key]))


def _change_bytes(data: bytes, chance: random.Random) -> bytes:
    out = bytearray(data)
    for _ in range(chance.choice((1, 2, 4, 16))):
        if out:
            out[chance.randrange(len(out))] = chance.randrange(256)
    return bytes(out)


def _change_length(data: bytes, chance: random.Random) -> bytes:
    how = chance.randrange(4)
    if how == 0 and len(data) > 1:
        return data[: chance.randrange(len(data))]
    if how == 1:
        return data + chance.randbytes(chance.choice((1, 3, 4, 1000)))
    if how == 2 and len(data) > 1:
        first, last = sorted(chance.randrange(len(data)) for _ in range(2))
        return data[:first] + data[last:]
    place = chance.choice((8, 12))  # length of the file, or of its first chunk
    if not is_glb(data):
        return data + data
    length = chance.choice((0, 1, 2**31, 2**32 - 1, len(data) + 1, len(data) - 1))
    return data[:place] + struct.pack("<I", length) + data[place + 4 :]


def _places(value: Any) -> Iterator[Pointer]:
    """Containers and keys of every value of the JSON."""
    return ((of, key) for _, of, key in _pointers(value))


def _change_numbers(root: dict[str, Any], chance: random.Random) -> None:
    def is_number(value: Any) -> bool:
        return isinstance(value, (int, float)) and not isinstance(value, bool)

    places = [(of, key) for of, key in _places(root) if is_number(of[key])]
    for of, key in chance.sample(places, min(len(places), chance.choice((1, 1, 2, 4)))):
        near = (of[key] + 1, of[key] - 1, -of[key], of[key] * 2)
        of[key] = chance.choice((*near, *_SPECIAL, *_LARGE, *_ODD))


def _change_values(root: dict[str, Any], chance: random.Random) -> None:
    for _ in range(chance.choice((1, 1, 2))):
        places = list(_places(root))
        if not places:
            return
        of, key = chance.choice(places)
        how = chance.randrange(3)
        if how == 0:
            del of[key]
        elif how == 1:
            of[key] = chance.choice(_TYPES)
        else:
            other, other_key = chance.choice(places)
            of[key] = json.loads(json.dumps(other[other_key]))


def _change_claims(root: dict[str, Any], chance: random.Random) -> None:
    places = [(of, key) for of, key in _places(root) if key in _COUNTS]
    for of, key in chance.sample(places, min(len(places), chance.choice((1, 2, 8)))):
        of[key] = chance.choice((*_LARGE, 2**24, 2**28, 2**30))
    if root.get("accessors") and chance.random() < 0.5:
        # An accessor without a buffer view is all zeros, as many as its count says.
        accessor = chance.choice(_objects(root["accessors"]) or [{}])
        accessor.pop("bufferView", None)
        accessor["count"] = chance.choice((2**20, 2**24, 2**28, 2**32 - 1))


def _change_graph(root: dict[str, Any], chance: random.Random) -> None:
    nodes = _objects(root.get("nodes"))
    count = max(len(nodes), 1)

    def some() -> list[int]:
        return [chance.randrange(count) for _ in range(chance.choice((1, 2, 5)))]

    for _ in range(chance.choice((1, 2, 4))):
        node = chance.choice(nodes) if nodes else {}
        how = chance.randrange(6)
        if how == 0:
            node["children"] = some()
        elif how == 1:
            node["skin"] = chance.choice((0, 1, 99))
        elif how == 2 and root.get("skins"):
            skin = chance.choice(_objects(root["skins"]) or [{}])
            skin["joints"] = chance.choice((some(), [], [0] * 300, [count]))
        elif how == 3:
            root["skins"] = [{"joints": some()}, {"joints": [0], "skeleton": count}]
            node["skin"] = chance.randrange(2)
        elif how == 4 and root.get("animations"):
            for channel in _channels(root):
                if chance.random() < 0.5 and isinstance(channel.get("target"), dict):
                    channel["target"] = {
                        "node": chance.randrange(count + 1),
                        "path": chance.choice(("weights", "rotation", "scale", "translation")),
                    }
        else:
            root["scenes"] = [{"nodes": some()}]


def _change_targets(root: dict[str, Any], chance: random.Random) -> None:
    for mesh in _objects(root.get("meshes")):
        for primitive in _objects(mesh.get("primitives")):
            attributes = primitive.get("attributes")
            if isinstance(attributes, dict) and "POSITION" in attributes:
                target = {"POSITION": attributes["POSITION"]}
                primitive["targets"] = [target] * 100_000
        if chance.random() < 0.5:
            mesh["weights"] = [chance.choice((0, 0.5, 1e38))] * 100_000
        if chance.random() < 0.5:
            return


_JSON_CHANGES: dict[str, Callable[[dict[str, Any], random.Random], None]] = {
    "number": _change_numbers,
    "value": _change_values,
    "claim": _change_claims,
    "graph": _change_graph,
    "targets": _change_targets,
}


def _objects(value: Any) -> list[dict[str, Any]]:
    return [item for item in value if isinstance(item, dict)] if isinstance(value, list) else []


def _channels(root: dict[str, Any]) -> Iterator[dict[str, Any]]:
    for animation in _objects(root.get("animations")):
        yield from _objects(animation.get("channels"))


def _uris(root: dict[str, Any] | None) -> Iterator[str]:
    for item in _objects((root or {}).get("buffers")) + _objects((root or {}).get("images")):
        if isinstance(item.get("uri"), str):
            yield item["uri"]


class _Buffers:
    """Bytes of a model's buffers and image files, which can be changed in place."""

    def __init__(self, model: Model, root: dict[str, Any]) -> None:
        self.binary = model.binary
        self.beside: dict[str, bytes] = {}
        self._model = model
        self._items = _objects(root.get("buffers"))
        views = root.get("bufferViews")
        self.views = views if isinstance(views, list) else []
        self.images = [i for i in _objects(root.get("images")) if "uri" in i]

    def read(self, item: dict[str, Any]) -> bytearray:
        """Bytes of a buffer or an image; empty where they are missing."""
        uri = item.get("uri")
        if uri is None:
            return bytearray(self.binary or b"")
        name = urllib.parse.unquote(str(uri))
        if name.startswith("data:"):
            head, _, body = str(uri).partition(",")
            try:
                return bytearray(base64.b64decode(body) if "base64" in head else body.encode())
            except ValueError:
                return bytearray()
        return bytearray(self.beside.get(name, self._model.beside.get(name, b"")))

    def write(self, item: dict[str, Any], data: bytearray) -> None:
        uri = item.get("uri")
        if uri is None:
            self.binary = bytes(data)
        elif str(uri).startswith("data:"):
            head = str(uri).partition(";")[0]
            item["uri"] = f"{head};base64,{base64.b64encode(data).decode()}"
        else:
            self.beside[urllib.parse.unquote(str(uri))] = bytes(data)

    def view(self, of: Any) -> tuple[dict[str, Any], int, int] | None:
        """Buffer, start and end of a JSON object with `buffer`, `byteOffset` and `byteLength`."""
        if not isinstance(of, dict) or not isinstance(of.get("buffer"), int):
            return None
        start, length = of.get("byteOffset", 0), of.get("byteLength", 0)
        if not (0 <= of["buffer"] < len(self._items)) or not isinstance(start, int):
            return None
        if not isinstance(length, int):
            return None
        return self._items[of["buffer"]], start, start + length

    def numbered(self, index: Any) -> tuple[dict[str, Any], int, int] | None:
        """Buffer, start and end of the buffer view of an index, where there is one."""
        there = isinstance(index, int) and 0 <= index < len(self.views)
        return self.view(self.views[index]) if there else None


def _streams(root: dict[str, Any], buffers: _Buffers) -> list[tuple[dict[str, Any], int, int]]:
    """Byte ranges of compressed data (geometry, images), else of all buffer views."""
    ranges: list[tuple[dict[str, Any], int, int] | None] = []
    ranges += [(image, 0, len(buffers.read(image))) for image in buffers.images]
    for of, key in _places(root):
        if key in _COMPRESSION and isinstance(of[key], dict):
            ranges.append(buffers.numbered(of[key].get("bufferView")) or buffers.view(of[key]))
    ranges += [buffers.numbered(i.get("bufferView")) for i in _objects(root.get("images"))]
    if not any(ranges):
        ranges = [buffers.view(view) for view in buffers.views]
    return [of for of in ranges if of is not None]


def _change_stream(root: dict[str, Any], buffers: _Buffers, chance: random.Random) -> None:
    ranges = _streams(root, buffers)
    if not ranges:
        return
    item, start, end = chance.choice(ranges)
    data = buffers.read(item)
    end = min(end, len(data))
    if start >= end:
        return
    for _ in range(chance.choice((1, 1, 4, 32))):
        # Headers of compressed streams hold counts.
        last = min(end, start + 64) if chance.random() < 0.5 else end
        at = chance.randrange(start, last)
        if chance.random() < 0.3 and at + 4 <= end:
            value = chance.choice((0, 1, 2**31, 2**32 - 1, 2**24))
            data[at : at + 4] = struct.pack(chance.choice("<>") + "I", value)
        else:
            data[at] = chance.randrange(256)
    buffers.write(item, data)


def _change_floats(root: dict[str, Any], buffers: _Buffers, chance: random.Random) -> None:
    floats = [a for a in _objects(root.get("accessors")) if a.get("componentType") == 5126]
    for accessor in chance.sample(floats, min(len(floats), 3)):
        found = buffers.numbered(accessor.get("bufferView"))
        if found is None:
            continue
        item, start, end = found
        data = buffers.read(item)
        for _ in range(chance.choice((1, 4))):
            room = (min(end, len(data)) - start) // 4
            if room < 1:
                break
            at = start + 4 * chance.randrange(room)
            value = chance.choice((float("nan"), float("inf"), -float("inf"), 3e38, -3e38, 1e-40))
            data[at : at + 4] = struct.pack("<f", value)
        buffers.write(item, data)
