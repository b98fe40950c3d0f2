"""Normals of polygons and of smooth surfaces, from points alone."""

from __future__ import annotations

import numpy as np

from reflet_usd.convert.scene import Array


def face_area_vectors(points: Array, corner_points: Array, counts: Array) -> Array:
    """Per face the normal times twice the area (Newell's method), (F, 3)."""
    starts = np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.int64)
    ends = starts + counts - 1
    following = np.arange(1, len(corner_points) + 1)
    following[ends] = starts
    corner_face = np.repeat(np.arange(len(counts)), counts)
    # Relative to the face's first point: differences of large coordinates stay exact.
    here = points[corner_points] - points[corner_points[starts]][corner_face]
    there = here[following]
    return np.add.reduceat(np.cross(here, there), starts, axis=0)


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
