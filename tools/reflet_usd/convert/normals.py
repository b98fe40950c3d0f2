"""Normals of polygons and of smooth surfaces, from points alone."""

import numpy as np

from .scene import Array
from .subdiv import edge_keys


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
    """`np.cross` of (N, 3) rows, without its overhead on few rows."""
    x, y, z = a.T
    u, v, w = b.T
    result = np.empty((len(a), 3))
    result[:, 0], result[:, 1], result[:, 2] = y * w - z * v, z * u - x * w, x * v - y * u
    return result


def smooth_normals(groups: Array, counts: Array, areas: Array, group_count: int) -> Array:
    """Unit normals (N, 3) per group of corners: the sum of their faces' area vectors."""
    corner_face = np.repeat(np.arange(len(counts)), counts)
    total = np.stack(
        [
            np.bincount(groups, weights=areas[corner_face, axis], minlength=group_count)
            for axis in range(3)
        ],
        axis=1,
    )
    return unit_rows(total)


def smooth_groups(corners: Array, counts: Array, point_count: int, sharp_edges: Array) -> Array:
    """For each corner the group that shares a normal: all corners of a point, but at the ends of
    sharp edges only corners that faces join around the point without crossing such an edge.

    `sharp_edges` are sorted keys of `edge_keys`.
    """
    if not len(sharp_edges):
        return np.unique(corners, return_inverse=True)[1].reshape(-1)
    from scipy.sparse import coo_array  # takes long, and few meshes have creases
    from scipy.sparse.csgraph import connected_components

    starts = np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.int64)
    following = np.arange(1, len(corners) + 1)
    following[starts + counts - 1] = starts
    here, there = corners, corners[following]
    keys = edge_keys(here, there, point_count)
    is_sharp = np.isin(keys, sharp_edges)
    at_crease = np.zeros(point_count, dtype=bool)
    at_crease[here[is_sharp]] = True
    at_crease[there[is_sharp]] = True
    # Edge ends: the corners on both sides of each edge, one after the other.
    order = np.argsort(keys, kind="stable")
    pairs = (keys[order][1:] == keys[order][:-1]) & ~is_sharp[order][1:]
    first, second = order[:-1][pairs], order[1:][pairs]
    is_low = here < there
    ends = [
        np.where(is_low, np.arange(len(corners)), following),
        np.where(is_low, following, np.arange(len(corners))),
    ]
    joined = [np.concatenate([end[sides] for end in ends]) for sides in (first, second)]
    shape = (len(corners), len(corners))
    links = coo_array((np.ones(len(joined[0])), joined), shape=shape)
    labels = connected_components(links, directed=False)[1]
    groups = np.where(at_crease[corners], point_count + labels, corners)
    return np.unique(groups, return_inverse=True)[1].reshape(-1)


def unit_rows(vectors: Array) -> Array:
    """Rows as unit vectors; rows without a direction become +Y."""
    vectors = np.asarray(vectors, dtype=np.float64)
    largest = np.abs(vectors).max(axis=1, keepdims=True, initial=0.0)
    usable = np.isfinite(largest) & (largest > 0.0)
    scaled = np.where(usable, vectors / np.where(usable, largest, 1.0), (0.0, 1.0, 0.0))
    return scaled / np.linalg.norm(scaled, axis=1, keepdims=True)
