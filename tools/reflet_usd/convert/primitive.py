"""A surface's triangles to one glTF primitive: vertices, attributes, indices."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .gltf_writer import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, GltfWriter
from .scene import Array
from .surface import Stream, Surface, Vertices, weld


@dataclass
class PrimitiveParts:
    """A primitive under construction, and the surface points of its vertices."""

    entry: dict[str, Any]
    vertices: Vertices
    points: Array
    """(V,) the surface point of each vertex."""


def build_primitive(
    writer: GltfWriter,
    surface: Surface,
    triangles: Array,
    uv_order: list[str],
    uv_constant: dict[str, tuple[float, float]],
    color: Stream | None,
) -> PrimitiveParts:
    """A primitive of `triangles` (T, 3 corners) without material.

    `uv_order` names the UV set of each TEXCOORD; sets in `uv_constant` have one value throughout.
    """
    streams = [surface.uvs[name] for name in uv_order if name in surface.uvs]
    streams += list(surface.custom.values())
    streams += [stream for stream in (surface.normals, color) if stream is not None]
    vertices = weld(surface, triangles, streams)
    points = surface.corner_points[vertices.corners]
    attributes: dict[str, int] = {
        "POSITION": _vertex_accessor(writer, surface.points[points], bounds=True)
    }

    def pick(stream: Stream) -> Array:
        return stream.values[stream.ids[vertices.corners]]

    if surface.normals is not None:
        attributes["NORMAL"] = _vertex_accessor(writer, pick(surface.normals))
    for slot, name in enumerate(uv_order):
        if name in surface.uvs:
            uv = pick(surface.uvs[name])
        else:
            uv = np.tile(uv_constant[name], (len(points), 1))
        flipped = np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])
        attributes[f"TEXCOORD_{slot}"] = _vertex_accessor(writer, flipped)
    if color is not None:
        attributes["COLOR_0"] = _vertex_accessor(writer, pick(color))
    for name, stream in surface.custom.items():
        values = pick(stream)
        shaped = values[:, 0] if values.shape[1] == 1 else values
        attributes[name] = _vertex_accessor(writer, shaped)
    entry = {"attributes": attributes, "indices": _index_accessor(writer, vertices.indices)}
    return PrimitiveParts(entry, vertices, points)


def _vertex_accessor(writer: GltfWriter, values: Array, bounds: bool = False) -> int:
    return writer.add_accessor(values.astype(np.float32), ARRAY_BUFFER, bounds)


def _index_accessor(writer: GltfWriter, indices: Array) -> int:
    # 65535 is the restart value of 16-bit indices, which glTF forbids.
    small = len(indices) == 0 or int(indices.max()) < 65535
    dtype = np.uint16 if small else np.uint32
    return writer.add_accessor(indices.astype(dtype), ELEMENT_ARRAY_BUFFER)
