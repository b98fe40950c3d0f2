"""Polygons to triangles: fans where convex, ear clipping where not; whole arrays of equal faces."""

import numpy as np

from .normals import cross_rows
from .scene import Array

# Beyond this many corners the all-pairs test of `_clip_batch` costs more than one face at a time.
_BATCH_CORNERS = 24
_BATCH_ELEMENTS = 4_000_000


def triangulate(points: Array, corner_points: Array, counts: Array) -> tuple[Array, Array]:
    """Triangles as corner numbers (T, 3) and the face of each triangle (T,).

    `points` is (N, 3), `corner_points` (C,) names the point of each corner, `counts` (F,) the
    corners of each face, all at least 3. Every face gives exactly `count - 2` triangles that
    keep its winding; they come in the order of the faces.
    """
    if (counts == 3).all():
        return np.arange(len(corner_points)).reshape(-1, 3), np.arange(len(counts))
    if (counts == counts[0]).all():
        size = int(counts[0])
        corners = np.arange(len(corner_points)).reshape(-1, size)
        local = _triangulate_equal(points, corner_points, corners)
        faces = np.repeat(np.arange(len(counts)), size - 2)
        return (local + corners[:, :1, None]).reshape(-1, 3), faces
    starts = np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.int64)
    triangle_count = int((counts - 2).sum())
    triangles = np.empty((triangle_count, 3), dtype=np.int64)
    firsts = np.concatenate(([0], np.cumsum(counts - 2)[:-1])).astype(np.int64)
    for size in np.unique(counts):
        faces = np.flatnonzero(counts == size)
        corners = starts[faces, None] + np.arange(size)
        local = _triangulate_equal(points, corner_points, corners)
        rows = firsts[faces, None] + np.arange(size - 2)
        triangles[rows] = np.take_along_axis(corners, local.reshape(len(faces), -1), 1).reshape(
            len(faces), size - 2, 3
        )
    return triangles, np.repeat(np.arange(len(counts)), counts - 2)


def _triangulate_equal(points: Array, corner_points: Array, corners: Array) -> Array:
    """Local triangles (F, n - 2, 3) of faces that all have n corners."""
    face_count, size = corners.shape
    fan = np.stack(
        [np.zeros(size - 2, dtype=np.int64), np.arange(1, size - 1), np.arange(2, size)], axis=1
    )
    local = np.broadcast_to(fan, (face_count, size - 2, 3)).copy()
    if size == 3:
        return local
    if size == 4:
        local[_needs_other_diagonal(points[corner_points[corners]])] = [[1, 2, 3], [1, 3, 0]]
        return local
    chunk = max(1, _BATCH_ELEMENTS // (size * size))
    for begin in range(0, face_count, chunk):
        part = slice(begin, begin + chunk)
        flat = _project(points[corner_points[corners[part]]])
        concave = np.flatnonzero(~_is_convex(flat))
        if size <= _BATCH_CORNERS:
            local[begin + concave] = _clip_batch(flat[concave])
        else:
            for face in concave:
                local[begin + face] = _clip_one(flat[face])
    return local


def _needs_other_diagonal(quads: Array) -> Array:
    """Mask of quads (F, 4, 3) that turn right at corner 1 or 3: the diagonal 0-2 is outside.

    Judged in the quad's own plane: a bent quad may fold over a diagonal and still be convex.
    """
    sides = quads[:, [1, 2, 3, 0]] - quads
    bends = cross_rows(sides[:, [3, 0, 1, 2]].reshape(-1, 3), sides.reshape(-1, 3))
    turns = np.einsum("fnk,fk->fn", bends.reshape(quads.shape), _normals(quads))
    if (turns >= 0.0).all():
        return np.zeros(len(quads), dtype=bool)
    worst = np.argmin(turns, axis=1)
    return (turns.min(axis=1) < -1e-12 * np.abs(turns).max(axis=1)) & (worst % 2 == 1)


def _project(polygons: Array) -> Array:
    """Polygons (F, n, 3) in their own planes (F, n, 2), counterclockwise seen along the normal."""
    offset = polygons - polygons[:, :1]
    normal = _normals(polygons)
    helper = np.zeros_like(normal)
    helper[np.arange(len(normal)), np.argmin(np.abs(normal), axis=1)] = 1.0
    u = cross_rows(helper, normal)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    v = cross_rows(normal, u)
    return np.stack([np.einsum("fnk,fk->fn", offset, axis) for axis in (u, v)], axis=2)


def _normals(polygons: Array) -> Array:
    """Unit normals of polygons (F, n, 3) by Newell's method; +Z where they have no area."""
    offset = polygons - polygons[:, :1]
    here, there = offset[:, :-1].reshape(-1, 3), offset[:, 1:].reshape(-1, 3)
    size = polygons.shape[1] - 1
    normal = cross_rows(here, there).reshape(-1, size, 3).sum(axis=1)
    length = np.sqrt(np.square(normal).sum(axis=1, keepdims=True))
    return np.where(length > 0.0, normal / np.where(length > 0.0, length, 1.0), (0.0, 0.0, 1.0))


def _cross2(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _turns(flat: Array) -> Array:
    """Twice the signed area of each corner's triangle (previous, corner, next)."""
    before, after = np.roll(flat, 1, axis=1), np.roll(flat, -1, axis=1)
    return _cross2(flat - before, after - flat)


def _is_convex(flat: Array) -> Array:
    """Whether no corner turns right and the outline winds once (a star turns left too)."""
    turns = _turns(flat)
    edges = np.roll(flat, -1, axis=1) - flat
    extent = np.square(edges).sum(axis=2).max(axis=1, keepdims=True)
    left = (turns >= -1e-12 * extent).all(axis=1)
    angles = np.arctan2(edges[..., 1], edges[..., 0])
    bends = np.diff(angles, axis=1, append=angles[:, :1])
    bends = np.mod(bends + np.pi, 2.0 * np.pi) - np.pi
    return left & (np.abs(bends.sum(axis=1)) < 3.0 * np.pi)


def _clip_batch(flat: Array) -> Array:
    """Ear clipping of many polygons (F, n, 2) at once: n - 3 rounds, one ear per face each."""
    face_count, size = flat.shape[:2]
    result = np.empty((face_count, size - 2, 3), dtype=np.int64)
    left = np.broadcast_to(np.arange(size), (face_count, size)).copy()
    rows = np.arange(face_count)
    for step in range(size - 3):
        ear = _best_ears(np.take_along_axis(flat, left[:, :, None], 1))
        count = left.shape[1]
        picks = np.stack([(ear - 1) % count, ear, (ear + 1) % count], axis=1)
        result[:, step] = np.take_along_axis(left, picks, 1)
        keep = np.ones(left.shape, dtype=bool)
        keep[rows, ear] = False
        left = left[keep].reshape(face_count, count - 1)
    result[:, size - 3] = left
    return result


def _best_ears(flat: Array) -> Array:
    """For each polygon the ear with the best shape; the least bad corner where no ear is clean."""
    before, after = np.roll(flat, 1, axis=1), np.roll(flat, -1, axis=1)
    turns = _cross2(flat - before, after - flat)
    size = flat.shape[1]
    inside = np.ones((flat.shape[0], size, size), dtype=bool)
    for a, b in ((before, flat), (flat, after), (after, before)):
        edge = (b - a)[:, :, None]
        inside &= _cross2(edge, flat[:, None] - a[:, :, None]) >= 0.0
    index = np.arange(size)
    for offset in (-1, 0, 1):
        inside[:, index, (index + offset) % size] = False
    # A point that coincides with a corner of the ear (a bridge to a hole) does not block it.
    for corner in (before, flat, after):
        inside &= (flat[:, None] != corner[:, :, None]).any(axis=3)
    blocked = inside.any(axis=2)
    lengths = [
        np.square(b - a).sum(axis=2) for a, b in ((before, flat), (flat, after), (after, before))
    ]
    shape = turns / np.maximum(sum(lengths), 1e-300)
    score = np.where(blocked, shape - 10.0, shape)
    return np.argmax(np.where(turns > 0.0, score, score - 20.0), axis=1)


def _clip_one(flat: Array) -> Array:
    """Ear clipping of one large polygon (n, 2): only an ear's neighbors are tested again."""
    size = len(flat)
    following = np.roll(np.arange(size), -1)
    preceding = np.roll(np.arange(size), 1)
    # Only corners that turn right can lie inside an ear, and cutting ears makes no new ones.
    blocking = _turns(flat[None])[0] <= 0.0
    blockers = np.flatnonzero(blocking)
    scores = np.array(
        [_ear_score(flat, blockers, preceding[i], i, following[i]) for i in range(size)]
    )
    result = np.empty((size - 2, 3), dtype=np.int64)
    for step in range(size - 2):
        ear = int(np.argmax(scores))
        a, b = int(preceding[ear]), int(following[ear])
        result[step] = (a, ear, b)
        scores[ear] = -np.inf
        following[a], preceding[b] = b, a
        if blocking[ear]:
            blocking[ear] = False
            blockers = np.flatnonzero(blocking)
        for corner in (a, b):
            scores[corner] = _ear_score(
                flat, blockers, preceding[corner], corner, following[corner]
            )
    return result


def _ear_score(flat: Array, blockers: Array, a: int, b: int, c: int) -> float:
    pa, pb, pc = flat[a], flat[b], flat[c]
    turn = float(_cross2(pb - pa, pc - pb))
    size = float(np.square(pb - pa).sum() + np.square(pc - pb).sum() + np.square(pa - pc).sum())
    score = turn / max(size, 1e-300)
    if turn <= 0.0:
        return score - 20.0
    points = flat[blockers]
    inside = (blockers != a) & (blockers != b) & (blockers != c)
    for p, q in ((pa, pb), (pb, pc), (pc, pa)):
        inside &= _cross2(q - p, points - p) >= 0.0
        inside &= (points != p).any(axis=1)
    return score - 10.0 if inside.any() else score
