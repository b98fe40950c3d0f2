"""Owns reading a glTF file through pygltflib: its tree and its accessors as numpy arrays."""

import base64
import functools
import json
import urllib.parse
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib

_COMPONENTS: dict[int, type] = {
    5120: np.int8,
    5121: np.uint8,
    5122: np.int16,
    5123: np.uint16,
    5125: np.uint32,
    5126: np.float32,
}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


class OutputError(Exception):
    """A glTF file that the third-party reader cannot read."""


class GltfFile:
    """One glTF or GLB file with its buffers, as pygltflib reads it."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            loaded = pygltflib.GLTF2().load(str(path))
        except Exception as error:  # the reader has many errors for a broken file
            raise OutputError(f"pygltflib does not read {path}: {error}") from error
        if loaded is None:
            raise OutputError(f"pygltflib does not read {path}")
        self.gltf: pygltflib.GLTF2 = loaded
        # Plain lists and dictionaries: a tree of thousands of nodes is walked often.
        self.nodes = list(loaded.nodes or [])
        self.meshes = list(loaded.meshes or [])
        self.materials = list(loaded.materials or [])

    def node_weights(self, index: int) -> list[float]:
        """Default morph weights of node `index`, which pygltflib does not keep, else its mesh's."""
        own = self.tree["nodes"][index].get("weights")
        return own or self.meshes[self.nodes[index].mesh].weights or []

    @functools.cached_property
    def tree(self) -> dict[str, Any]:
        """The file's JSON as it stands, for fields that pygltflib does not keep."""
        data = self.path.read_bytes()
        if data[:4] == b"glTF":
            length = int.from_bytes(data[12:16], "little")
            data = data[20 : 20 + length]
        return json.loads(data)

    @property
    def extensions(self) -> dict[str, Any]:
        """Extensions of the document itself."""
        return dict(self.gltf.extensions or {})

    @functools.cache  # noqa: B019 - lives exactly as long as the file
    def accessor(self, index: int) -> np.ndarray:
        """Accessor `index` as (count,) or (count, width), float64 where it holds fractions."""
        accessor = self.gltf.accessors[index]
        width = _WIDTHS[accessor.type]
        dtype = np.dtype(_COMPONENTS[accessor.componentType])
        if accessor.bufferView is None:
            values = np.zeros((accessor.count, width), dtype)
        else:
            values = self._strided(
                accessor.bufferView, accessor.byteOffset or 0, accessor.count, width, dtype
            )
        if accessor.sparse:
            values = self._with_sparse(accessor.sparse, values.copy(), width, dtype)
        if dtype.kind == "f":
            values = values.astype(np.float64)
        elif accessor.normalized:
            values = np.maximum(values / float(np.iinfo(np.dtype(dtype).name).max), -1.0)
        return values[:, 0] if width == 1 else values

    def _with_sparse(
        self, sparse: Any, values: np.ndarray, width: int, dtype: np.dtype
    ) -> np.ndarray:
        where = self._strided(
            sparse.indices.bufferView,
            sparse.indices.byteOffset or 0,
            sparse.count,
            1,
            np.dtype(_COMPONENTS[sparse.indices.componentType]),
        )[:, 0]
        values[where.astype(np.int64)] = self._strided(
            sparse.values.bufferView, sparse.values.byteOffset or 0, sparse.count, width, dtype
        )
        return values

    def _strided(
        self, view_index: int, offset: int, count: int, width: int, dtype: np.dtype
    ) -> np.ndarray:
        view = self.gltf.bufferViews[view_index]
        data = self.buffer(view.buffer)
        start = (view.byteOffset or 0) + offset
        element = width * dtype.itemsize
        stride = view.byteStride or element
        if count and start + stride * (count - 1) + element > len(data):
            raise OutputError(f"{self.path}: buffer view {view_index} ends before its accessor")
        flat = np.frombuffer(data, np.uint8)
        rows = np.lib.stride_tricks.as_strided(flat[start:], (count, element), (stride, 1))
        return np.ascontiguousarray(rows).view(dtype.newbyteorder("<")).reshape(count, width)

    @functools.cache  # noqa: B019
    def buffer(self, index: int) -> bytes:
        """The bytes of buffer `index`, wherever they are stored."""
        uri = self.gltf.buffers[index].uri
        if not uri:
            return self.gltf.binary_blob() or b""
        return self.resource(uri)

    def resource(self, uri: str) -> bytes:
        """The bytes behind a URI of the file: a data URI or a file beside it."""
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        place = self.path.parent / urllib.parse.unquote(uri)
        try:
            return place.read_bytes()
        except OSError as error:
            raise OutputError(f"{self.path}: {uri} cannot be read: {error}") from error

    def image_bytes(self, index: int) -> bytes:
        """The encoded bytes of image `index`."""
        image = self.gltf.images[index]
        if image.uri:
            return self.resource(image.uri)
        return self.view_bytes(image.bufferView)

    def view_bytes(self, index: int) -> bytes:
        """The bytes of buffer view `index`."""
        view = self.gltf.bufferViews[index]
        start = view.byteOffset or 0
        return self.buffer(view.buffer)[start : start + view.byteLength]

    def prim_of(self, item: Any) -> str | None:
        """Prim path that a node, material or camera keeps in its extras."""
        extras = getattr(item, "extras", None) or {}
        prim = extras.get("prim") if isinstance(extras, dict) else None
        return prim if isinstance(prim, str) else None
