"""Owns the glTF document: accessors, images, nodes and animations to deterministic bytes."""

import errno
import hashlib
import json
import math
import os
import struct
from pathlib import Path
from typing import Any

import numpy as np

from .scene import Array, Node, Skin, Track
from .types import ConvertError

GENERATOR = "reflet-usd"
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
POINTS, LINES, LINE_STRIP, TRIANGLES = 0, 1, 3, 4
# Keyed by the dtype's character: its name takes longer to compute than all else of a small array.
_COMPONENT_TYPES = {"f": 5126, "I": 5125, "H": 5123, "B": 5121}
_SHAPES = {(): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}
_MAX_GLB_BYTES = 2**32 - 1
_JSON_CHUNK, _BIN_CHUNK = 0x4E4F534A, 0x004E4942


class GltfWriter:
    """Collects the parts of one glTF file; equal data is stored once."""

    def __init__(self) -> None:
        self.lists: dict[str, list[Any]] = {}
        self._chunks: list[bytes] = []
        self._size = 0
        self._known: dict[tuple[str, bytes], int] = {}
        self._extensions: set[str] = set()
        self._required: set[str] = set()

    def use_extension(self, name: str, required: bool = False) -> None:
        """List `name` in `extensionsUsed`, and in `extensionsRequired` where asked."""
        self._extensions.add(name)
        if required:
            self._required.add(name)

    def add(self, kind: str, entry: dict[str, Any]) -> int:
        """Append to a top-level list and return the index."""
        entries = self.lists.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def add_once(self, kind: str, entry: dict[str, Any]) -> int:
        """Append to a list as `add` does, or return the index of an equal earlier entry."""
        key = (kind, json.dumps(entry, sort_keys=True).encode())
        if key not in self._known:
            self._known[key] = self.add(kind, entry)
        return self._known[key]

    def add_floats(self, values: Array, bounds: bool = False) -> int:
        """Store an attribute of vertices, (V,) or (V, N), and return its accessor."""
        shaped = values[:, 0] if values.shape[1:] == (1,) else values
        return self.add_accessor(shaped.astype(np.float32), ARRAY_BUFFER, bounds)

    def add_accessor(
        self,
        array: Array,
        target: int | None = None,
        bounds: bool = False,
    ) -> int:
        """Store an array (elements first) and return its accessor.

        `bounds` writes `min` and `max`. MAT4 rows must already be the file's columns.
        """
        array = np.ascontiguousarray(array)
        data = array.tobytes()
        # Key times have bounds; an accessor that shares their bytes must not share their entry.
        tag = f"accessor {array.dtype.char} {array.shape} {target} {bounds}"
        key = (tag, hashlib.sha256(data).digest())
        if key in self._known:
            return self._known[key]
        entry: dict[str, Any] = {
            "bufferView": self.add_view(data, target, _stride(array, target)),
            "componentType": _COMPONENT_TYPES[array.dtype.char],
            "count": int(array.shape[0]),
            "type": _SHAPES[array.shape[1:]],
        }
        if bounds:
            entry.update(_bounds(array))
        self._known[key] = self.add("accessors", entry)
        return self._known[key]

    def add_image(self, data: bytes, mime_type: str, name: str) -> int:
        """Store an encoded image (PNG or JPEG) once and return its index."""
        key = ("image", hashlib.sha256(data).digest())
        if key not in self._known:
            entry = {"bufferView": self.add_view(data), "mimeType": mime_type, "name": name}
            self._known[key] = self.add("images", entry)
        return self._known[key]

    def add_view(self, data: bytes, target: int | None = None, stride: int | None = None) -> int:
        """Store bytes and return their buffer view."""
        padding = -self._size % 4
        if padding:
            self._chunks.append(b"\0" * padding)
            self._size += padding
        view: dict[str, Any] = {"buffer": 0, "byteLength": len(data), "byteOffset": self._size}
        if stride is not None:
            view["byteStride"] = stride
        if target is not None:
            view["target"] = target
        self._chunks.append(data)
        self._size += len(data)
        return self.add("bufferViews", view)

    def add_nodes(self, roots: list[Node], extras: dict[str, Any]) -> None:
        """Add the node trees, their skins and one animation, and the scene that shows them."""
        order = [node for root in roots for node in root.walk()]
        indices = {id(node): index for index, node in enumerate(order)}
        skins: dict[int, int] = {}
        for node in order:
            if node.skin is not None and id(node.skin) not in skins:
                skins[id(node.skin)] = self._add_skin(node.skin, indices)
        for node in order:
            skin = None if node.skin is None else skins[id(node.skin)]
            self.add("nodes", _node_entry(node, indices, skin, self))
        self._add_animation(order)
        scene = {"nodes": [indices[id(root)] for root in roots], "extras": extras}
        self.add("scenes", scene)

    def _add_skin(self, skin: Skin, indices: dict[int, int]) -> int:
        columns = np.swapaxes(skin.inverse_bind, 1, 2).astype(np.float32)
        # The last row of an affine matrix is exactly 0 0 0 1; rounding must not disturb it.
        columns[:, :, 3] = (0.0, 0.0, 0.0, 1.0)
        entry: dict[str, Any] = {
            "inverseBindMatrices": self.add_accessor(columns),
            "joints": [indices[id(joint)] for joint in skin.joints],
            "name": skin.name,
        }
        if skin.skeleton is not None:
            entry["skeleton"] = indices[id(skin.skeleton)]
        return self.add("skins", entry)

    def _add_animation(self, order: list[Node]) -> None:
        samplers: list[dict[str, Any]] = []
        channels: list[dict[str, Any]] = []
        known: dict[str, int] = {}
        pointed: set[str] = set()
        for index, node in enumerate(order):
            for track in node.tracks:
                sampler = self._sampler(track)
                key = json.dumps(sampler, sort_keys=True)
                if key not in known:
                    known[key] = len(samplers)
                    samplers.append(sampler)
                target = _target(track, index)
                if "extensions" in target:
                    self.use_extension("KHR_animation_pointer")
                if track.path.startswith("/"):
                    if track.path in pointed:
                        continue  # a copy of a node shares its camera
                    pointed.add(track.path)
                channels.append({"sampler": known[key], "target": target})
        if channels:
            self.add("animations", {"channels": channels, "name": "stage", "samplers": samplers})

    def _sampler(self, track: Track) -> dict[str, Any]:
        values = track.values
        array = values if values.dtype == np.uint8 else values.astype(np.float32)
        if track.path == "weights" or array.shape[1:] == (1,):
            array = array.reshape(-1)
        if track.spline:
            array = array.reshape(-1, array.shape[-1])
        interpolation = "CUBICSPLINE" if track.spline else "STEP" if track.step else "LINEAR"
        return {
            "input": self.add_accessor(track.times.astype(np.float32), bounds=True),
            "interpolation": interpolation,
            "output": self.add_accessor(array),
        }

    def document(self, buffer_uri: str | None) -> dict[str, Any]:
        """The JSON part; `buffer_uri` names the buffer's file unless it is a GLB's own chunk."""
        asset = {"generator": GENERATOR, "version": "2.0"}
        document: dict[str, Any] = {"asset": asset, "scene": 0}
        if self._extensions:
            document["extensionsUsed"] = sorted(self._extensions)
        if self._required:
            document["extensionsRequired"] = sorted(self._required)
        if self._size:
            buffer: dict[str, Any] = {"byteLength": self._size}
            if buffer_uri is not None:
                buffer["uri"] = buffer_uri
            document["buffers"] = [buffer]
        lights = self.lists.get("lights")
        if lights:
            document["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
        document.update({k: v for k, v in self.lists.items() if v and k != "lights"})
        return document

    def write(self, out: Path, sidecar: dict[str, Any]) -> None:
        """Write `out` and `out + ".json"`; files appear under their names only when complete."""
        if out.suffix.lower() == ".glb":
            files = [(out, self._glb_chunks())]
        else:
            buffer_path = out.with_suffix(".bin")
            text = _json_bytes(self.document(_uri(buffer_path.name)))
            files = [(out, [text])]
            if self._size:
                files.insert(0, (buffer_path, self._chunks))
        account = json.dumps(sidecar, indent=1, sort_keys=True, ensure_ascii=False, allow_nan=False)
        files.insert(0, (out.with_name(out.name + ".json"), [(account + "\n").encode()]))
        _write_together(files)

    def _glb_chunks(self) -> list[bytes]:
        text = _json_bytes(self.document(None))
        text += b" " * (-len(text) % 4)
        padding = -self._size % 4
        binary = self._size + padding
        total = 12 + 8 + len(text) + (8 + binary if self._size else 0)
        if total > _MAX_GLB_BYTES:
            message = f"{total} bytes do not fit into a .glb (4 GiB); write a .gltf instead"
            raise ConvertError("output-too-large", message)
        chunks = [struct.pack("<4sII", b"glTF", 2, total)]
        chunks += [struct.pack("<II", len(text), _JSON_CHUNK), text]
        if self._size:
            chunks.append(struct.pack("<II", binary, _BIN_CHUNK))
            chunks += [*self._chunks, b"\0" * padding]
        return chunks


def _stride(array: Array, target: int | None) -> int | None:
    """Stride of vertex attributes; elements that are not multiples of 4 bytes never occur here."""
    row = array.dtype.itemsize * math.prod(array.shape[1:])
    return row if target == ARRAY_BUFFER else None


def _bounds(array: Array) -> dict[str, list[float]]:
    low, high = array.min(axis=0), array.max(axis=0)
    return {"max": np.atleast_1d(high).tolist(), "min": np.atleast_1d(low).tolist()}


def _target(track: Track, node: int) -> dict[str, Any]:
    if track.path in ("translation", "rotation", "scale", "weights"):
        return {"node": node, "path": track.path}
    pointer = track.path if track.path.startswith("/") else f"/nodes/{node}/{track.path}"
    return {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}


def _node_entry(
    node: Node, indices: dict[int, int], skin: int | None, writer: GltfWriter
) -> dict[str, Any]:
    entry: dict[str, Any] = {"name": node.name} if node.name else {}
    for key in ("translation", "rotation", "scale"):
        value = getattr(node, key)
        if value is not None:
            entry[key] = [float(number) for number in value]
    for key in ("mesh", "camera", "weights"):
        if getattr(node, key) is not None:
            entry[key] = getattr(node, key)
    if skin is not None:
        entry["skin"] = skin
    if node.children:
        entry["children"] = [indices[id(child)] for child in node.children]
    extensions: dict[str, Any] = {}
    if node.light is not None:
        writer.use_extension("KHR_lights_punctual")
        extensions["KHR_lights_punctual"] = {"light": node.light}
    if node.instances is not None:
        writer.use_extension("EXT_mesh_gpu_instancing", required=True)
        extensions["EXT_mesh_gpu_instancing"] = {"attributes": node.instances}
    if any(track.path.startswith("extensions/KHR_node_visibility") for track in node.tracks):
        writer.use_extension("KHR_node_visibility")
        extensions["KHR_node_visibility"] = {"visible": bool(node.extras.get("visible", True))}
    if extensions:
        entry["extensions"] = extensions
    extras = {**({"prim": node.prim} if node.prim else {}), **node.extras}
    if extras:
        entry["extras"] = extras
    return entry


def _uri(name: str) -> str:
    from urllib.parse import quote

    return quote(name)


def _json_bytes(document: dict[str, Any]) -> bytes:
    return json.dumps(document, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()


def _write_together(files: list[tuple[Path, list[bytes]]]) -> None:
    """Write all under temporary names, then rename, so that a failure leaves nothing behind."""
    pairs = [(path.with_name(f".{path.name}.{os.getpid()}.tmp"), path) for path, _ in files]
    try:
        for (temporary, _), (_, chunks) in zip(pairs, files, strict=True):
            with open(temporary, "wb") as stream:
                stream.writelines(chunks)
        for temporary, path in pairs:
            os.replace(temporary, path)
    except OSError as error:
        if error.errno == errno.EFBIG:  # the limit on files, which the caller names
            raise
        raise ConvertError("output-unwritable", str(error.strerror), str(pairs[-1][1])) from None
    finally:
        for temporary, _ in pairs:
            temporary.unlink(missing_ok=True)
