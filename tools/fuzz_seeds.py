"""Gathers the glTF files that tools/fuzz.sh begins with, and says how many hold each codec.

python3 tools/fuzz_seeds.py OUT FOLDER...
python3 tools/fuzz_seeds.py OUT --panoramas
python3 tools/fuzz_seeds.py OUT --scenes

Takes every `.glb` and `.gltf` in the folders of at most 64 KiB together with the files it names.
Models with external files are packed into a `.glb`, since the fuzzer reads one file; WebP and KTX2
images are put on a triangle. Models with meshopt are written once under each extension name. Added
are small files whose decoders would take much memory; with `--panoramas` only files of panoramas,
which are not part of glTF, and with `--scenes` only scene texts with many things of a kind.
"""

import base64
import hashlib
import os
import random
import sys
import urllib.parse
from pathlib import Path
from typing import Any

import gltf_mutant_decoders
from gltf_mutant_decoders import glb, on_triangle
from gltf_mutations import Model, read_model

MOST_BYTES = 64 * 1024
CODECS = (
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_texture_basisu",
    "EXT_texture_webp",
    "KHR_mesh_quantization",
)
IMAGES = {
    ".webp": ("EXT_texture_webp", "image/webp"),
    ".ktx2": ("KHR_texture_basisu", "image/ktx2"),
}


def bytes_of(uri: str, model: Model) -> bytes | None:
    """Bytes that a URI holds or names; None where that file is missing."""
    if uri.startswith("data:"):
        return base64.b64decode(uri.partition(",")[2])
    return model.beside.get(urllib.parse.unquote(uri))


def pack(model: Model) -> bytes | None:
    """The model as one file; None where a file that it names is missing."""
    root = model.root
    if root is None:
        return model.data
    buffers, images = root.get("buffers", []), root.get("images", [])
    named = [item["uri"] for item in (*buffers, *images) if "uri" in item]
    if all(uri.startswith("data:") for uri in named):
        return model.data
    data = {uri: bytes_of(uri, model) for uri in named}
    if None in data.values():
        return None
    binary = bytearray(model.binary or b"")

    def append(uri: str) -> int:
        binary.extend(b"\0" * (-len(binary) % 4))
        binary.extend(data[uri] or b"")
        return len(binary) - len(data[uri] or b"")

    # Buffers with data become one; meshopt fallback buffers without data stay.
    moved: dict[int, tuple[int, int]] = {}
    kept: list[dict[str, Any]] = [{}]
    for index, buffer in enumerate(buffers):
        if "uri" in buffer:
            moved[index] = 0, append(buffer["uri"])
        elif index == 0 and model.binary is not None:
            moved[index] = 0, 0
        else:
            moved[index] = len(kept), 0
            kept.append(buffer)
    views = root.get("bufferViews", [])
    for view in views:
        for part in (view, *view.get("extensions", {}).values()):
            part["buffer"], start = moved.get(part.get("buffer", 0), (0, 0))
            part["byteOffset"] = part.get("byteOffset", 0) + start
    for image in images:
        if "uri" in image:
            uri = image.pop("uri")
            start = append(uri)
            kind = "png" if (data[uri] or b"").startswith(b"\x89PNG") else "jpeg"
            image.setdefault("mimeType", IMAGES.get(Path(uri).suffix, ("", f"image/{kind}"))[1])
            image["bufferView"] = len(views)
            views.append({"buffer": 0, "byteOffset": start, "byteLength": len(data[uri] or b"")})
    kept[0] = {"byteLength": len(binary)}
    return glb(root | {"buffers": kept, "bufferViews": views}, bytes(binary))


def seeds_of(file: Path) -> list[bytes]:
    if file.stat().st_size > MOST_BYTES:
        return []
    if file.suffix in IMAGES:
        return [on_triangle(file.read_bytes(), *IMAGES[file.suffix])]
    try:
        packed = pack(read_model(file))
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        packed = file.read_bytes()  # broken JSON; the file is a seed as it is
    seeds = [packed] if packed is not None else []
    # Both extension names have the same length, so chunk lengths stay right.
    names = (b"EXT_meshopt_compression", b"KHR_meshopt_compression")
    return seeds + [seed.replace(*names) for seed in seeds if names[0] in seed]


SCENE = """version = 1
camera.main.eye = [0, 0, 9]
timeline.end = 3
[model.ball]
shape = { kind = "box" }
[[instance]]
model = "ball"
name = "b"
"""
MOVES = "keys = [{ at_s = 0, value = [0, 0, 1] }, { at_s = 1, value = [0, 1, 0] }]"
# Parts that scenes have many of; `#` is the number of a part, `@` its predecessor's.
PARTS = (
    "[params]\np# = 1\n",
    "[variant.v#.image]\nexposure_ev = 1\n",
    "[[variant.v.instance]]\nname = 'i#'\nmodel = 'ball'\n",
    "[variant.r#]\nremove = ['instance.b', 'instance.#']\n",
    "[[instance]]\nmodel = 'ball'\nrepeat = { count = [#, 9, 9], step = [0, 0, 0] }\n",
    "[[instance]]\nmodel = 'ball'\ndynamic = true\n"
    "repeat = { count = [#, 99, 99], step = [1, 0, 0] }\n",
    "[model.m#]\nshape = { kind = 'box' }\n[[instance]]\nmodel = 'm#'\n",
    f"[[instance]]\nname = 'j#'\nmodel = 'ball'\n[motion.instance.j#.translation]\n{MOVES}\n",
    "[camera.c#]\nparent = 'b'\n[motion.camera.c#.target]\nfollow = { instance = 'b' }\n",
    "[material.e#]\nextends = 'e@'\nbase_color_texture = 'a#'\n",
    "[group.g#]\nparent = 'g@'\n",
    "[[instance]]\nname = 'n#'\nmodel = { scene = '0.toml', params = { p0 = # } }\n",
    "x# = [{}, { a.b.c = 1 }, []]\n",
    "y# = 1\r",
)


BALL = "version = 1\n[model.ball]\nshape = { kind = 'box' }\n"
PLACED = "[[instance]]\nname = 'o#'\nmodel = { scene = '1.toml' }\n"
FILE = "\n#file\n"
"""Line before each file of a seed that the scene places (fuzz/targets/scene.rs)."""


def scene(rng: random.Random) -> bytes:
    """A scene with many parts of one to three kinds, and the scenes that it places."""
    start = "\ufeff" if rng.random() < 0.1 else ""
    text = start + parted(SCENE, rng, rng.sample(PARTS, rng.randint(1, 3)))
    if "0.toml" in text:
        rest = [part for part in PARTS[1:] if "0.toml" not in part]
        text += FILE + parted(BALL, rng, [PARTS[0], rng.choice(rest), PLACED], 10)
        again = [PLACED.replace("1.toml", rng.choice("01") + ".toml")] if rng.random() < 0.2 else []
        text += FILE + parted(BALL, rng, [rng.choice(rest), *again], 10)
    return text.encode()


def parted(text: str, rng: random.Random, parts: list[str], most: int = 300) -> str:
    """The text with up to `most` of each of these parts; tables are opened once for all their keys.

    Few in placed files, whose parts multiply: a valid seed must not take as long as a fault.
    """
    for part in parts:
        head, _, keys = part.partition("\n")
        once = "#" not in head and head != "[[instance]]" and not head.startswith("[[")
        text += head + "\n" if once else ""
        body = keys if once else part
        for number in range(min(rng.choice((1, 3, 30, 300)), most)):
            text += body.replace("#", str(number)).replace("@", str(max(number - 1, 0)))
    return text


def write(out: Path, seeds: set[bytes]) -> None:
    for seed in seeds:
        (out / hashlib.sha256(seed).hexdigest()[:16]).write_bytes(seed)
    print(f"{len(seeds)} seeds")


def main() -> None:
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    out, folders = Path(sys.argv[1]), sys.argv[2:]
    out.mkdir(parents=True, exist_ok=True)
    if folders == ["--panoramas"]:
        write(out, {gltf_mutant_decoders.panorama(random.Random(n)) for n in range(200)})
        return
    if folders == ["--scenes"]:
        write(out, {scene(random.Random(number)) for number in range(100)})
        return
    seeds = {gltf_mutant_decoders.model(random.Random(number)) for number in range(100)}
    seeds = {seed for seed in seeds if len(seed) <= MOST_BYTES}
    for folder in folders:
        walked = (Path(at, name) for at, _, names in os.walk(folder) for name in names)
        for file in walked:
            if file.suffix in (".glb", ".gltf", *IMAGES):
                seeds |= {seed for seed in seeds_of(file) if len(seed) <= MOST_BYTES}
    write(out, seeds)
    for codec in CODECS:
        count = sum(codec.encode() in seed for seed in seeds)
        print(f"  {count} with {codec}" + ("" if count else ": its decoder is not reached"))


if __name__ == "__main__":
    main()
