"""A surface's triangles to one glTF primitive: vertices, attributes, indices."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .gltf_writer import ELEMENT_ARRAY_BUFFER, GltfWriter
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
        "POSITION": writer.add_floats(surface.points[points], bounds=True)
    }

    def pick(stream: Stream) -> Array:
        return stream.values[stream.ids[vertices.corners]]

    if surface.normals is not None:
        attributes["NORMAL"] = writer.add_floats(pick(surface.normals))
    for slot, name in enumerate(uv_order):
        if name in surface.uvs:
            uv = pick(surface.uvs[name])
        else:
            uv = np.tile(uv_constant[name], (len(points), 1))
        flipped = np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])
        attributes[f"TEXCOORD_{slot}"] = writer.add_floats(flipped)
    if color is not None:
        attributes["COLOR_0"] = writer.add_floats(pick(color))
    for name, stream in surface.custom.items():
        attributes[name] = writer.add_floats(pick(stream))
    entry = {"attributes": attributes, "indices": _index_accessor(writer, vertices.indices)}
    return PrimitiveParts(entry, vertices, points)


def _index_accessor(writer: GltfWriter, indices: Array) -> int:
    # 65535 is the restart value of 16-bit indices, which glTF forbids.
    small = len(indices) == 0 or int(indices.max()) < 65535
    dtype = np.uint16 if small else np.uint32
    return writer.add_accessor(indices.astype(dtype), ELEMENT_ARRAY_BUFFER)
