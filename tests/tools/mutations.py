"""Owns broken and hostile stages, made from the small seeds with fixed random numbers."""

import dataclasses
import io
import random
import re
import struct
import zipfile
from collections.abc import Iterator
from pathlib import Path

import hostile_materialx
from PIL import Image
from texts import texts_of

SECRET = "SecretOfAnotherFolder"
_NUMBERS = ("nan", "inf", "-inf", "-1", "0", "1e308", "-1e38", "2147483647", "4294967296", "99999")
_HEADER = b'#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = "Y"\n)\n'
_NUMBER = re.compile(rb"(?<![\w.])-?\d+(?:\.\d+)?(?![\w.])")


@dataclasses.dataclass
class Mutant:
    """One hostile stage: file name, bytes, and the files that lie beside it."""

    name: str
    suffix: str
    data: bytes
    beside: dict[str, bytes] = dataclasses.field(default_factory=dict)

    @property
    def title(self) -> str:
        """Name of the mutant, unique among all of them."""
        return self.name + self.suffix


def all_mutants(seeds: Path) -> list[Mutant]:
    """Every mutant, in a fixed order, from the seeds' text and binary forms."""
    texts = {path.stem: path.read_bytes() for path in sorted(seeds.glob("*.usda"))}
    # Stored as files, because usd-core writes the same layer in other bytes each time.
    crates = {path.stem: path.read_bytes() for path in sorted(seeds.glob("crates/*.usdc"))}
    packages = {name: _as_package(name, data) for name, data in crates.items()}
    chance = random.Random(20240229)
    mutants = list(_written_by_hand(texts["quads"]))
    forms = ((".usda", texts, 6), (".usdc", crates, 6), (".usdz", packages, 3))
    for suffix, seeds_of, count in forms:
        for name, data in seeds_of.items():
            for number in range(count):
                mutants.append(Mutant(f"flip-{name}-{number}", suffix, _flip_bytes(data, chance)))
            for number in range(max(count // 2, 2)):
                cut = chance.randrange(1, len(data))
                mutants.append(Mutant(f"cut-{name}-{number}", suffix, data[:cut]))
            mutants.append(Mutant(f"splice-{name}", suffix, _splice(data, chance)))
    for name, data in texts.items():
        for number in range(8):
            changed = _change_numbers(data, chance)
            mutants.append(Mutant(f"numbers-{name}-{number}", ".usda", changed))
        for number in range(3):
            mutants.append(Mutant(f"lines-{name}-{number}", ".usda", _shuffle_lines(data, chance)))
    for name, data in crates.items():
        for number in range(4):
            changed = _absurd_words(data, chance)
            mutants.append(Mutant(f"words-{name}-{number}", ".usdc", changed))
    for number, (name, data) in enumerate(hostile_materialx.documents()):
        beside = {"look.mtlx": data, "t.png": _PIXEL}
        mutants.append(Mutant(f"mtlx-{name}", ".usda", hostile_materialx.STAGE, beside))
        if number % 3 == 0:
            package = _packed({"stage.usda": hostile_materialx.STAGE} | beside)
            mutants.append(Mutant(f"mtlx-{name}", ".usdz", package))
    return mutants


def _packed(entries: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, data in entries.items():
            archive.writestr(zipfile.ZipInfo(name), data)
    return stream.getvalue()


def _image() -> bytes:
    stream = io.BytesIO()
    Image.new("RGB", (4, 4), (200, 100, 50)).save(stream, "PNG")
    return stream.getvalue()


_PIXEL = _image()


def _flip_bytes(data: bytes, chance: random.Random) -> bytes:
    result = bytearray(data)
    for _ in range(chance.choice((1, 3, 16))):
        result[chance.randrange(len(result))] ^= 1 << chance.randrange(8)
    return bytes(result)


def _splice(data: bytes, chance: random.Random) -> bytes:
    first, second = sorted(chance.randrange(len(data)) for _ in range(2))
    return data[:second] + data[first:]


def _change_numbers(data: bytes, chance: random.Random) -> bytes:
    places = list(_NUMBER.finditer(data, data.index(b"\n") + 1))
    chosen = {place.start() for place in chance.sample(places, min(4, len(places)))}

    def replace(match: re.Match[bytes]) -> bytes:
        wanted = match.start() in chosen
        return chance.choice(_NUMBERS).encode() if wanted else match.group()

    return _NUMBER.sub(replace, data)


def _shuffle_lines(data: bytes, chance: random.Random) -> bytes:
    lines = data.split(b"\n")
    for _ in range(3):
        index = chance.randrange(1, len(lines))
        lines.insert(chance.randrange(1, len(lines)), lines.pop(index))
    return b"\n".join(lines)


def _absurd_words(data: bytes, chance: random.Random) -> bytes:
    """Crate files whose counts and offsets are replaced by enormous ones."""
    result = bytearray(data)
    for _ in range(3):
        place = chance.randrange(8, len(result) - 8) & ~7
        value = chance.choice((0xFFFFFFFFFFFFFFFF, 1 << 62, 1 << 40, 0x7FFFFFFF, 0))
        result[place : place + 8] = struct.pack("<Q", value)
    return bytes(result)


def _as_package(name: str, crate: bytes) -> bytes:
    """A usdz package whose root layer is the crate, aligned to 64 bytes as the format asks."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        entry = zipfile.ZipInfo(f"{name}.usdc")
        padding = -(30 + len(entry.filename)) % 64
        padding += 64 if padding < 4 else 0
        entry.extra = struct.pack("<HH", 0x1986, padding - 4) + bytes(padding - 4)
        archive.writestr(entry, crate)
    return stream.getvalue()


def hand_written_bodies() -> dict[str, bytes]:
    """Layers that parse, each with one invalid value."""
    # The usda format wants a line of its own for each closing brace.
    bodies = {name: body.replace("}", "\n}\n") for name, body in _BODIES.items()}
    return {name: _HEADER + body.encode() for name, body in bodies.items()}


def _written_by_hand(quads: bytes) -> Iterator[Mutant]:
    """Hand-written faults that random damage does not reach."""
    for name, body in hand_written_bodies().items():
        yield Mutant(name, ".usda", body)
    for name, metadata in _METADATA.items():
        yield Mutant(name, ".usda", f'#usda 1.0\n(\n{metadata}\n)\ndef Cube "C" {{}}\n'.encode())
    for name, old, new in _REPLACED:
        assert old in quads, name
        yield Mutant(name, ".usda", quads.replace(old, new, 1))
    yield Mutant("empty", ".usda", b"")
    yield Mutant("empty-crate", ".usdc", b"")
    yield Mutant("only-magic", ".usdc", b"PXR-USDC")
    yield Mutant("text-named-crate", ".usdc", quads)
    yield Mutant("zeros", ".usdc", b"PXR-USDC" + bytes(4096))
    yield Mutant("not-utf8", ".usda", _HEADER + b'def Cube "\xff\xfe" {}\n')
    yield Mutant("zero-byte", ".usda", _HEADER + b'def Cube "A\0B" {}\n')
    yield Mutant("two-layers", ".usda", _HEADER + b'def "A" (references = @b.usda@) {}\n', _PAIR)
    yield Mutant("bomb", ".usdz", _bomb())
    yield Mutant("escape", ".usdz", _escaping_package(quads))
    yield Mutant("empty-package", ".usdz", b"PK\5\6" + bytes(18))
    deep = b"".join(b'def Xform "a" {\n' for _ in range(3000)) + b"}\n" * 3000
    yield Mutant("deep", ".usda", _HEADER + deep)
    wide = b"".join(b'def Xform "a%d" {}\n' % index for index in range(20000))
    yield Mutant("wide", ".usda", _HEADER + wide)
    yield Mutant("brackets", ".usda", _HEADER + b'def "A" { int[] x = ' + b"[" * 50000)


def _bomb() -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(zipfile.ZipInfo("a.usda"), bytes(64 << 20), zipfile.ZIP_DEFLATED)
    return stream.getvalue()


def _escaping_package(quads: bytes) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr(zipfile.ZipInfo("../../planted.usda"), quads)
    return stream.getvalue()


_PAIR = {"b.usda": b'#usda 1.0\n(defaultPrim="B")\ndef "B" (references = @stage.usda@</A>) {}\n'}
_BODIES: dict[str, str] = {
    **texts_of("mutations/bodies"),
    "instancer-bomb": "".join(
        f'def PointInstancer "P{n}" {{ rel prototypes = </P{n + 1}>\n'
        f"int[] protoIndices = [{', '.join('0' * 40)}]\n"
        f"point3f[] positions = [{', '.join('(0,0,1)' for _ in range(40))}] }}\n"
        for n in range(6)
    )
    + 'def Cube "P6" {}',
    "instance-bomb": 'class "C0" { def Cube "X" {} }\n'
    + "".join(
        f'class "C{n}" {{ '
        + " ".join(
            f'def "I{k}" (instanceable = true\ninherits = </C{n - 1}>) {{}}' for k in range(9)
        )
        + " }\n"
        for n in range(1, 8)
    )
    + 'def "R" (inherits = </C7>) {}',
}
_METADATA: dict[str, str] = {
    "sublayer-self": "subLayers = [@stage.usda@]",
    "sublayer-escaping": "subLayers = [@../secret.usda@]",
    "units-nan": "metersPerUnit = nan",
    "units-negative": "metersPerUnit = -1",
    "axis-odd": 'upAxis = "Q"',
    "rate-zero": "timeCodesPerSecond = 0",
    "rate-negative": "timeCodesPerSecond = -24",
    "range-odd": "startTimeCode = inf\n    endTimeCode = -inf",
    "offset-zero": "subLayers = [@gone.usda@ (offset = nan; scale = 0)]",
}
_REPLACED: list[tuple[str, bytes, bytes]] = [
    ("counts-shorter", b"[4, 4, 4, 4, 4, 4]", b"[4, 4]"),
    ("subset-wild", b"int[] indices = [0, 1]", b"int[] indices = [-1, 99, 0, 0]"),
    ("binding-self", b"binding = </Looks/Red>", b"binding = </World/Box>"),
    ("name-huge", b'"Arrow"', b'"' + b"A" * 100_000 + b'"'),
    ("points-string", b"point3f[] points = [(0, 0, 0)", b'string points = "x" #'),
]
