"""A polygon surface with value streams per corner, and its welding into glTF vertices."""

from dataclasses import dataclass, field

import numpy as np

from .scene import Array

_KEY_LIMIT = 2**62


@dataclass
class Stream:
    """Values, and for every corner of the surface the index of its value."""

    values: Array
    """(K, components)."""
    ids: Array
    """(C,) int64."""
    by_point: bool
    """Whether corners of one point always share a value: such a stream never splits vertices."""


@dataclass
class Surface:
    """Triangles over corners over points; everything a glTF primitive is made from."""

    points: Array
    """(N, 3) float64, meters."""
    corner_points: Array
    """(C,) the point of each corner."""
    triangles: Array
    """(T, 3) corner numbers, counterclockwise seen from outside."""
    triangle_faces: Array
    """(T,) the authored face of each triangle."""
    normals: Stream | None = None
    uvs: dict[str, Stream] = field(default_factory=dict)
    """Texture coordinates by primvar name, v pointing up as in USD."""
    color: Stream | None = None
    """Linear RGB or RGBA in 0…1."""
    custom: dict[str, Stream] = field(default_factory=dict)
    """Further float primvars, by glTF attribute name."""
    is_displaced: bool = False
    """Whether materials have moved the points along their normals."""


@dataclass
class Vertices:
    """Welded vertices of a set of triangles."""

    corners: Array
    """(V,) one corner for each vertex."""
    indices: Array
    """(3 T,) vertex numbers."""


def unique_rows(values: Array) -> Array:
    """Group number of each row; rows with equal bits share a group."""
    data = np.ascontiguousarray(values, dtype=np.float32) + np.float32(0.0)  # -0.0 becomes 0.0
    bits = data.view(np.uint32).astype(np.uint64)
    key = np.zeros(len(bits), dtype=np.uint64)
    for column in bits.T:  # multiply-xor mixing, splitmix64's constant
        key = (key ^ column) * np.uint64(0x9E3779B97F4A7C15)
        key ^= key >> np.uint64(29)
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    if not np.array_equal(data[first[inverse]], data, equal_nan=True):  # two rows, one hash
        _, inverse = np.unique(data, axis=0, return_inverse=True)
    return inverse.reshape(-1)


def weld(surface: Surface, triangles: Array, streams: list[Stream]) -> Vertices:
    """Vertices for `triangles`: corners join where the point and every stream's value agree."""
    corners = triangles.reshape(-1)
    key = surface.corner_points[corners].astype(np.int64)
    limit = len(surface.points)
    for stream in streams:
        if stream.by_point:
            continue
        ids = stream.ids[corners]
        span = len(stream.values)
        if span > len(corners):
            used, ids = np.unique(ids, return_inverse=True)
            span = len(used)
        if limit * span >= _KEY_LIMIT:
            used, key = np.unique(key, return_inverse=True)
            limit = len(used)
        key = key * span + ids
        limit *= span
    if limit <= 4 * len(corners) + 1024:
        return _weld_by_table(key, limit, corners)
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    return Vertices(corners[first], inverse.reshape(-1))


def _weld_by_table(key: Array, limit: int, corners: Array) -> Vertices:
    """Weld without sorting, through a table, for keys that are dense."""
    first = np.full(limit, -1, dtype=np.int64)
    first[key[::-1]] = np.arange(len(key))[::-1]
    used = np.flatnonzero(first >= 0)
    renumber = np.zeros(limit, dtype=np.int64)
    renumber[used] = np.arange(len(used))
    return Vertices(corners[first[used]], renumber[key])


def face_varying_stream(values: Array, ids: Array) -> Stream:
    """A stream that shares equal values, so that welding finds equal corners."""
    groups = unique_rows(values)
    count = int(groups.max()) + 1 if len(groups) else 0
    compact = np.empty((count, values.shape[1]), dtype=values.dtype)
    compact[groups] = values
    return Stream(compact, groups[ids], by_point=False)
