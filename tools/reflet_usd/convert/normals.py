"""Normals of polygons and of smooth surfaces, from points alone."""

from __future__ import annotations

import numpy as np

from reflet_usd.convert.scene import Array


def face_area_vectors(points: Array, corner_points: Array, counts: Array) -> Array:
    """Per face the normal times twice the area (Newell's method), (F, 3)."""
    if (counts == 3).all():
        a, b, c = (points[corner_points[corner::3]] for corner in range(3))
        return cross_rows(b - a, c - a)
    starts = np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.int64)
    ends = starts + counts - 1
    following = np.arange(1, len(corner_points) + 1)
    following[ends] = starts
    corner_face = np.repeat(np.arange(len(counts)), counts)
    # Relative to the face's first point: differences of large coordinates stay exact.
    here = points[corner_points] - points[corner_points[starts]][corner_face]
    there = here[following]
    return np.add.reduceat(cross_rows(here, there), starts, axis=0)


def cross_rows(a: Array, b: Array) -> Array:
    """`np.cross` of (N, 3) rows, without what it costs on a few of them."""
    x, y, z = a.T
    u, v, w = b.T
    result = np.empty((len(a), 3))
    result[:, 0], result[:, 1], result[:, 2] = y * w - z * v, z * u - x * w, x * v - y * u
    return result


def smooth_normals(points: Array, corner_points: Array, counts: Array, areas: Array) -> Array:
    """Per point the sum of its faces' area vectors, as unit vectors, (N, 3)."""
    corner_face = np.repeat(np.arange(len(counts)), counts)
    total = np.stack(
        [
            np.bincount(corner_points, weights=areas[corner_face, axis], minlength=len(points))
            for axis in range(3)
        ],
        axis=1,
    )
    return unit_rows(total)


def unit_rows(vectors: Array) -> Array:
    """Rows as unit vectors; rows without a direction become +Y."""
    vectors = np.asarray(vectors, dtype=np.float64)
    largest = np.abs(vectors).max(axis=1, keepdims=True, initial=0.0)
    usable = np.isfinite(largest) & (largest > 0.0)
    scaled = np.where(usable, vectors / np.where(usable, largest, 1.0), (0.0, 1.0, 0.0))
    return scaled / np.linalg.norm(scaled, axis=1, keepdims=True)
