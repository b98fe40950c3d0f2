"""Owns the measures of polygon soups that do not depend on how a face is triangulated."""

import dataclasses

import numpy as np

from .scene_data import Array, Indices

_FLAT = 1e-5
"""A face is flat when no corner leaves its plane by more than this part of its size."""
_CROSSING = 1e-4
"""A quad's better diagonal gives this much more area than its vector area where sides cross."""
_BENT_SLACK = 1.5
"""Factor by which a bent face of more than four corners may exceed the area of its fan."""

_PAIRS = 1_000_000
"""Maximum number of pairs of sides that are tested at once."""


@dataclasses.dataclass
class FaceMeasures:
    """Measures over all faces of one soup, summed."""

    area_range: tuple[float, float]
    vector_area: Array
    volume_range: tuple[float, float]
    normals: Array
    """(faces, 3) unit normals; zero where a face has no area."""
    flat: np.ndarray
    """(faces,) whether the face is flat."""


def measure(
    positions: Array, counts: Indices, center: Array, deformed: bool = False
) -> FaceMeasures:
    """Measure faces of `counts` corners each, whose corners lie one after another.

    `deformed` faces were cut into triangles when their corners were elsewhere.
    """
    if not len(counts):
        zero = np.zeros(3)
        return FaceMeasures((0.0, 0.0), zero, (0.0, 0.0), np.zeros((0, 3)), np.zeros(0, bool))
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    face = np.repeat(np.arange(len(counts)), counts)
    local = np.arange(len(positions)) - starts[face]
    first = positions[starts][face]
    following = positions[starts[face] + (local + 1) % counts[face]]
    fan = 0.5 * np.cross(positions - first, following - first)
    vector = np.add.reduceat(fan, starts, axis=0)
    length = np.linalg.norm(vector, axis=1)
    normals = np.divide(
        vector, length[:, None], out=np.zeros_like(vector), where=length[:, None] > 0
    )
    size = np.sqrt(np.maximum.reduceat(((positions - first) ** 2).sum(axis=1), starts))
    height = np.maximum.reduceat(np.abs(((positions - first) * normals[face]).sum(axis=1)), starts)
    flat = height <= _FLAT * size
    fan_area = np.add.reduceat(np.linalg.norm(fan, axis=1), starts)
    lower = length.copy()
    # Deformed faces fold where they became concave; faces whose sides cross fold in any cutting.
    convex = _convex(positions, starts, counts, normals)
    sure = flat & (convex if deformed else True)
    sure[_crossing(positions, starts, counts, normals, ~convex & flat & (counts > 4))] = False
    upper = np.where(sure, length, np.maximum(fan_area, length) * _BENT_SLACK)
    quads = np.flatnonzero(counts == 4)
    both = _quad_areas(positions[starts[quads][:, None] + np.arange(4)])
    # A flat quad has the area of its better diagonal; where its sides cross, both diagonals fold.
    best = both.min(axis=1)
    simple = sure[quads] & (best <= length[quads] * (1 + _CROSSING))
    lower[quads] = best
    upper[quads] = np.where(simple, best, both.max(axis=1))
    volumes = np.einsum("ij,ij->i", positions[starts] - center, vector) / 3.0
    slack = np.where(flat, 0.0, height * upper)
    return FaceMeasures(
        (float(lower.sum()), float(upper.sum())),
        vector.sum(axis=0),
        (float((volumes - slack).sum()), float((volumes + slack).sum())),
        normals,
        flat,
    )


def _convex(positions: Array, starts: Indices, counts: Indices, normals: Array) -> np.ndarray:
    """(faces,) whether no corner turns against its face's normal."""
    face = np.repeat(np.arange(len(counts)), counts)
    local = np.arange(len(positions)) - starts[face]
    after = positions[starts[face] + (local + 1) % counts[face]]
    before = positions[starts[face] + (local - 1) % counts[face]]
    turns = (np.cross(positions - before, after - positions) * normals[face]).sum(axis=1)
    return np.asarray(np.minimum.reduceat(turns, starts) >= 0.0)


def _crossing(
    positions: Array, starts: Indices, counts: Indices, normals: Array, asked: np.ndarray
) -> Indices:
    """Numbers of those flat faces among `asked` whose sides cross."""
    found = [np.zeros(0, np.int64)]
    for size in np.unique(counts[asked]):
        faces = np.flatnonzero(asked & (counts == size))
        for chunk in np.array_split(faces, 1 + len(faces) * int(size) ** 2 // _PAIRS):
            corners = positions[starts[chunk][:, None] + np.arange(size)]
            along = corners[:, 1] - corners[:, 0]
            axes = np.stack([along, np.cross(normals[chunk], along)], axis=2)
            flat = (corners - corners[:, :1]) @ axes
            found.append(chunk[_crosses(flat)])
    return np.concatenate(found)


def _crosses(corners: Array) -> np.ndarray:
    """(n,) whether two sides that do not meet cross, of (n, k, 2) polygons."""
    ends = np.roll(corners, -1, axis=1)
    side = ends - corners

    def turn(points: Array) -> Array:
        """Side of each line (second index) on which each point (third index) lies."""
        away = points[:, None] - corners[:, :, None]
        return side[:, :, None, 0] * away[..., 1] - side[:, :, None, 1] * away[..., 0]

    parted = turn(corners) * turn(ends) < 0.0
    return np.asarray((parted & parted.transpose(0, 2, 1)).any(axis=(1, 2)))


def _quad_areas(corners: Array) -> Array:
    """(n, 2) areas of quads (n, 4, 3) cut along either diagonal."""
    a, b, c, d = (corners[:, index] for index in range(4))

    def area(p: Array, q: Array, r: Array) -> Array:
        return 0.5 * np.linalg.norm(np.cross(q - p, r - p), axis=1)

    return np.column_stack([area(a, b, c) + area(a, c, d), area(b, c, d) + area(b, d, a)])
