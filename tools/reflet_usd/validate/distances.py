"""Owns the distances between point sets and between attributes at the same places."""

import math

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from .scene_data import Array

_DIRECTION = np.array([0.8147236863931789, 0.9057919370756192, 0.1269868162935061, 0.913375])


def one_way(points: Array, others: Array) -> float:
    """Largest distance from any of `points` to its nearest of `others`, meters."""
    if not len(points):
        return 0.0
    if not len(others):
        return math.inf
    return float(cKDTree(_distinct(others)).query(_distinct(points))[0].max())


def _distinct(points: Array) -> Array:
    """The points without exact repetitions: corners repeat each vertex about six times."""
    # Equal points have equal projections; different ones share one only where 53 bits agree by
    # accident, for the direction fits no lattice.
    _, first = np.unique(points @ _DIRECTION[: points.shape[1]], return_index=True)
    return points[first]


def set_distance(first: Array, second: Array) -> float:
    """Hausdorff distance of two point sets, meters."""
    return max(one_way(first, second), one_way(second, first))


def open_edges(points: Array, corners: Array) -> int:
    """Number of triangle edges (three corners each) that no other triangle has in reverse.

    `points` are the expected vertex positions, by which vertices are joined.
    """
    size = float(np.ptp(points, axis=0).max())
    tree = cKDTree(points)
    pairs = tree.query_pairs(1e-6 * size, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(points), len(points)))
    _, label = connected_components(links, directed=False)
    triangles = label[tree.query(corners)[1]].reshape(-1, 3).astype(np.int64)
    first, last = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    edges = np.minimum(first, last) * len(points) + np.maximum(first, last)
    _, which = np.unique(edges, return_inverse=True)
    balance = np.bincount(which.ravel(), weights=np.sign(last - first))
    return int(np.count_nonzero(balance))


def attribute_distance(
    expected: tuple[Array, Array],
    found: tuple[Array, Array],
    tolerance: float,
    step: float,
    both: bool,
) -> float:
    """Largest distance of an attribute at corners of the same place, searched in one joint space.

    Positions count in units of `tolerance`, attributes in units of `step`, so a corner is paired
    with the nearest attribute among the corners that share its place. Expected attributes that
    are not finite are undefined, and not compared; in the output they are infinitely far away.
    """
    defined = np.isfinite(expected[1]).all(axis=1)
    if not defined.all():
        expected, both = (expected[0][defined], expected[1][defined]), False
        drawn = np.isfinite(found[1]).all(axis=1)
        found = (found[0][drawn], found[1][drawn])
    if not len(expected[0]):
        return 0.0
    if not len(found[0]) or not np.isfinite(found[1]).all():
        return math.inf
    first = np.hstack([expected[0] / tolerance, expected[1] / step])
    second = np.hstack([found[0] / tolerance, found[1] / step])
    worst = 0.0
    pairs = [(first, second)] + ([(second, first)] if both else [])
    for points, others in pairs:
        near = cKDTree(others).query(points, p=np.inf)[1]
        difference = (points[:, 3:] - others[near][:, 3:]) * step
        worst = max(worst, float(np.linalg.norm(difference, axis=1).max(initial=0.0)))
    return worst
