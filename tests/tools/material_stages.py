"""Owns the small stages and image readers that the material tests share."""

import io
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from read_converted import Converted, convert_text
from texts import fill, text_of

MESH = text_of("material_stages/mesh.usda")


def stage(inputs: str, nodes: str = "", body: str = "") -> str:
    return text_of(
        "material_stages/stage.usda", inputs=inputs, nodes=nodes, mesh=fill(MESH, body=body)
    )


def texture(name: str, file: str, body: str = "", st: str = "/Mat/St.outputs:result") -> str:
    return text_of("material_stages/texture.usda", name=name, file=file, st=st, body=body)


def shaded(folder: Path, inputs: str, nodes: str = "", body: str = "", **options: Any) -> Converted:
    """A converted mesh whose material has these inputs and nodes."""
    return convert_text(folder, stage(inputs, nodes, body), **options)


def save(folder: Path, name: str, pixels: np.ndarray, **options: Any) -> bytes:
    Image.fromarray(pixels).save(folder / name, **options)
    return (folder / name).read_bytes()


def noise(mode: str, size: tuple[int, int] = (8, 4), seed: int = 0) -> np.ndarray:
    random = np.random.default_rng(seed)
    channels = {"L": (), "RGB": (3,), "RGBA": (4,)}[mode]
    return random.integers(0, 256, (size[1], size[0], *channels), dtype=np.uint8)


def material(done: Converted) -> dict[str, Any]:
    entry = done.json["materials"][done.json["meshes"][0]["primitives"][0]["material"]]
    assert isinstance(entry, dict)
    return entry


def image(done: Converted, info: dict[str, Any]) -> bytes:
    source = done.gltf.textures[info["index"]].source
    view = done.gltf.bufferViews[done.gltf.images[source].bufferView]
    return bytes(done.gltf.binary_blob()[view.byteOffset : view.byteOffset + view.byteLength])


def pixels(done: Converted, info: dict[str, Any]) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(image(done, info))).convert("RGBA")).astype(float)
