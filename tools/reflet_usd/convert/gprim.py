"""Tessellates sphere, cylinder, cone, capsule, plane and cube, vertices on the exact bounds."""

import math
from dataclasses import dataclass, replace

import numpy as np
from pxr import Usd

from .context import Context, authored, in_float32, type_name
from .normals import unit_rows
from .polygons import Polygons
from .primvars import Topology
from .scene import Array
from .surface import Stream, Surface

SEGMENTS = 32  # around the axis; with a multiple of 4, vertices lie on the bounds
RINGS = 16  # from pole to pole; even, so that one is the equator
GPRIM_TYPES = ("Cube", "Sphere", "Cylinder", "Cylinder_1", "Cone", "Capsule", "Capsule_1", "Plane")


@dataclass
class _Quads:
    """Quads and triangles (fourth corner -1) with a normal per corner."""

    points: list[Array]
    faces: list[Array]
    normals: list[Array]
    count: int = 0

    def append(self, points: Array, faces: Array, normals: Array) -> None:
        self.points.append(points)
        self.normals.append(normals)
        self.faces.append(np.where(faces >= 0, faces + self.count, -1))
        self.count += len(points)


# Points and faces of the cube that USD's imaging draws; its primvars refer to them.
_CUBE_POINTS = np.array(
    [
        (1, 1, 1),
        (-1, 1, 1),
        (-1, -1, 1),
        (1, -1, 1),
        (-1, -1, -1),
        (-1, 1, -1),
        (1, 1, -1),
        (1, -1, -1),
    ],
    dtype=np.float64,
)
_CUBE_CORNERS = (0, 1, 2, 3, 4, 5, 6, 7, 0, 6, 5, 1, 4, 7, 3, 2, 0, 3, 7, 6, 4, 2, 1, 5)


def cube_polygons(context: Context, prim: Usd.Prim) -> Polygons | None:
    """A Cube as six quads; None where its size is not finite."""
    size = float(authored(prim, "size", context.time, 2.0)) * context.meters_per_unit
    _warn_size(context, prim, "size", size)
    if not in_float32(np.array(size)):
        context.ledger.warn("points-non-finite", prim, "the Cube has a size that is not finite")
        return None
    corners = np.array(_CUBE_CORNERS, dtype=np.int64)
    drawn, left_handed = np.ones(6, dtype=bool), _left_handed(context, prim)
    return Polygons(_CUBE_POINTS * (size / 2), np.full(6, 4), corners, drawn, left_handed, "none")


def _left_handed(context: Context, prim: Usd.Prim) -> bool:
    return str(authored(prim, "orientation", context.time, "")) == "leftHanded"


def _warn_size(context: Context, prim: Usd.Prim, name: str, size: float) -> None:
    """Warn about a size that leaves no shape, or turns it inside out."""
    if size < 0.0 or (size == 0.0 and name not in ("radiusTop", "radiusBottom")):
        message = f"its {name} is {'0' if size == 0.0 else 'negative'}, carried as it is"
        context.ledger.warn("gprim-invalid", prim, message)


def tessellate(context: Context, prim: Usd.Prim) -> tuple[Surface, Topology] | None:
    """The gprim's surface in meters and the counts of its primvars; None where it has no size."""

    def size(name: str, fallback: float) -> float:
        length = float(authored(prim, name, context.time, fallback)) * context.meters_per_unit
        _warn_size(context, prim, name, length)
        return length

    shape = _Quads([], [], [])
    kind = type_name(prim)
    axis = str(authored(prim, "axis", context.time, "Z"))
    if axis not in ("X", "Y", "Z"):
        context.ledger.warn("gprim-invalid", prim, f"its axis is '{axis}', taken as Z")
    if kind == "Sphere":
        _add_lathe(shape, *_arc(size("radius", 1.0), 0.0, -math.pi / 2, math.pi / 2, RINGS))
    elif kind == "Plane":
        # width runs along X, or Z for axis X; length along Y, or Z for axis Y (UsdGeomPlane)
        _add_plane(shape, size("width", 2.0), size("length", 2.0), axis)
    elif kind in ("Capsule", "Capsule_1"):
        radii = _end_radii(size, 0.5, kind == "Capsule_1")
        _add_capsule(shape, size("height", 1.0), *radii)
    else:
        radii = (size("radius", 1.0), 0.0)
        if kind != "Cone":
            radii = _end_radii(size, 1.0, kind == "Cylinder_1")
        _add_frustum(shape, size("height", 2.0), *radii)
    points, normals = np.concatenate(shape.points), np.concatenate(shape.normals)
    if not in_float32(points).all():
        context.ledger.warn("points-non-finite", prim, f"the {kind} has a size that is not finite")
        return None
    if kind not in ("Sphere", "Plane"):
        points, normals = _along_axis(points, axis), _along_axis(normals, axis)
    if not _left_handed(context, prim):
        return _surface(points, np.concatenate(shape.faces), normals)
    surface, topology = _surface(points, np.concatenate(shape.faces), -normals)
    surface.triangles = surface.triangles[:, [0, 2, 1]]
    return surface, topology


def _end_radii(size: object, fallback: float, two: bool) -> tuple[float, float]:
    read = size
    if two:
        return read("radiusBottom", fallback), read("radiusTop", fallback)  # type: ignore[operator]
    radius = read("radius", fallback)  # type: ignore[operator]
    return radius, radius


def _along_axis(vectors: Array, axis: str) -> Array:
    """Turn a shape built along Z to its axis, by cyclic exchange of axes, which keeps winding."""
    if axis == "X":
        return vectors[:, [2, 0, 1]]
    if axis == "Y":
        return vectors[:, [1, 2, 0]]
    return vectors


def _add_plane(shape: _Quads, width: float, length: float, axis: str) -> None:
    first, second = {"X": (2, 1), "Y": (0, 2)}.get(axis, (0, 1))
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (width / 2, length / 2)
    points = np.zeros((4, 3))
    points[:, first], points[:, second] = corners.T
    normal = np.zeros(3)
    normal["XYZ".index(axis) if axis in ("X", "Y", "Z") else 2] = 1.0
    if axis == "Y" or axis == "X":  # on these axes the second side comes before the first
        points = points[::-1].copy()
    # One negative side reverses the face, as a negative size turns a cube inside out.
    normal *= math.copysign(1.0, width) * math.copysign(1.0, length)
    shape.append(points, np.array([[0, 1, 2, 3]]), np.tile(normal, (4, 1)))


def _arc(
    radius: float, center: float, first: float, last: float, steps: int
) -> tuple[Array, Array, Array, Array]:
    """Profile radii, heights and their normals from latitude `first` to `last`."""
    angles = np.linspace(first, last, steps + 1)
    cosine, sine = np.cos(angles), np.sin(angles)
    # Exact at the poles and the equator, so bounds are exact and poles close.
    cosine[np.abs(cosine) < 1e-12] = 0.0
    sine[np.abs(sine) < 1e-12] = 0.0
    return radius * cosine, center + radius * sine, cosine, sine


def _circle() -> Array:
    angles = np.arange(SEGMENTS) * (2.0 * math.pi / SEGMENTS)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    circle[np.abs(circle) < 1e-12] = 0.0
    return circle


def _add_lathe(
    shape: _Quads, radii: Array, heights: Array, normal_out: Array, normal_up: Array
) -> None:
    """Turn a profile (bottom to top) around Z; rings of radius 0 give triangles."""
    circle, rings = _circle(), len(radii)
    points = np.empty((rings, SEGMENTS, 3))
    points[..., :2] = radii[:, None, None] * circle
    points[..., 2] = heights[:, None]
    normals = np.empty_like(points)
    normals[..., :2] = normal_out[:, None, None] * circle
    normals[..., 2] = normal_up[:, None]
    index = np.arange(rings * SEGMENTS).reshape(rings, SEGMENTS)
    right = np.roll(index, -1, axis=1)
    faces = np.stack([index[:-1], right[:-1], right[1:], index[1:]], axis=2)
    faces[radii[1:] == 0.0, :, 3] = -1
    bottom = radii[:-1] == 0.0
    faces[bottom] = np.stack(
        [index[:-1], right[1:], index[1:], np.full_like(index[1:], -1)], axis=2
    )[bottom]
    shape.append(points.reshape(-1, 3), faces.reshape(-1, 4), unit_rows(normals.reshape(-1, 3)))


def _add_disk(shape: _Quads, radius: float, height: float, up: float) -> None:
    if radius <= 0.0:
        return
    rim = np.column_stack([radius * _circle(), np.full(SEGMENTS, height)])
    points = np.vstack([rim, [[0.0, 0.0, height]]])
    index = np.arange(SEGMENTS)
    after = (index + 1) % SEGMENTS
    pair = (index, after) if up > 0.0 else (after, index)
    faces = np.stack([np.full(SEGMENTS, SEGMENTS), *pair, np.full(SEGMENTS, -1)], axis=1)
    shape.append(points, faces, np.tile((0.0, 0.0, up), (len(points), 1)))


def _add_frustum(shape: _Quads, height: float, bottom: float, top: float) -> None:
    slope = np.array([height, bottom - top])
    slope = slope / (np.linalg.norm(slope) or 1.0)
    radii, heights = np.array([bottom, top]), np.array([-height / 2, height / 2])
    _add_lathe(shape, radii, heights, np.full(2, slope[0]), np.full(2, slope[1]))
    _add_disk(shape, bottom, -height / 2, -1.0)
    _add_disk(shape, top, height / 2, 1.0)


def _add_capsule(shape: _Quads, height: float, bottom: float, top: float) -> None:
    half = RINGS // 2
    lower = _arc(bottom, -height / 2, -math.pi / 2, 0.0, half)
    upper = _arc(top, height / 2, 0.0, math.pi / 2, half)
    _add_lathe(shape, *(np.concatenate(pair) for pair in zip(lower, upper, strict=True)))


def _surface(points: Array, faces: Array, normals: Array) -> tuple[Surface, Topology]:
    quad = faces[:, 3] >= 0
    first = faces[:, [0, 1, 2]]
    triangles = np.concatenate([first, faces[quad][:, [0, 2, 3]]])
    face_of = np.concatenate([np.arange(len(faces)), np.flatnonzero(quad)])
    order = np.argsort(face_of, kind="stable")
    triangles, face_of = triangles[order], face_of[order]
    # Every tessellated point is its own corner: normals are already split where they differ.
    corners = np.arange(len(points))
    surface = Surface(points, corners, triangles, face_of, Stream(normals, corners, by_point=True))
    topology = Topology(len(points), len(faces), corners, np.zeros(len(points), np.int64))
    return surface, replace(topology, dropped=("uniform", "vertex", "varying", "faceVarying"))
