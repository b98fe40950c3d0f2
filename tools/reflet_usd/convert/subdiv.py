"""Catmull-Clark refinement: boundaries, creases, corners and faceVarying rules, whole arrays.

Rules: Catmull and Clark 1978; semi-sharp creases from DeRose, Kass and Truong 1998; the names
of the boundary and faceVarying options are UsdGeomMesh's.
"""

from dataclasses import dataclass, field

import numpy as np

from .scene import Array

INFINITE = 1e9
_FACE_SHARE = 0.25
_TRIANGLE_SHARE = 0.47
"""Share of each of the two faces beside an edge in its point; OpenSubdiv's rule for triangles."""


@dataclass
class Cage:
    """Faces over vertices with sharpness, before one refinement."""

    counts: Array
    """(F,) corners of each face."""
    corners: Array
    """(C,) the vertex of each corner."""
    vertex_count: int
    crease_keys: Array = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """Sorted keys of the crease edges (see `edge_keys`, with base `vertex_count`)."""
    crease_values: Array = field(default_factory=lambda: np.zeros(0))
    corner_sharpness: Array | None = None
    """(V,), 0 where smooth."""
    pin_corners: bool = True
    """Whether boundary vertices of a single face stay where they are."""
    pin_boundary: bool = False
    """Whether all boundary vertices stay where they are (faceVarying `boundaries`)."""
    pinned: Array | None = None
    """(V,) pinned vertices, which keep their positions."""
    smooth_triangles: bool = False
    """Whether triangles weigh more (triangleSubdivisionRule `smooth`); their children are quads."""


def edge_keys(a: Array, b: Array, base: int) -> Array:
    """One number for each undirected edge."""
    return np.minimum(a, b).astype(np.int64) * base + np.maximum(a, b)


class Step:
    """One refinement: maps values at a cage's vertices to values at its children's."""

    def __init__(self, cage: Cage) -> None:
        self.cage = cage
        counts, corners, base = cage.counts, cage.corners, cage.vertex_count
        self.starts = np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.int64)
        self.corner_faces = np.repeat(np.arange(len(counts)), counts)
        following = np.arange(1, len(corners) + 1)
        following[self.starts + counts - 1] = self.starts
        self.previous = np.empty_like(following)
        self.previous[following] = np.arange(len(corners))
        keys = edge_keys(corners, corners[following], base)
        unique, self.corner_edges = np.unique(keys, return_inverse=True)
        self.corner_edges = self.corner_edges.reshape(-1)
        self.edges = np.stack([unique // base, unique % base], axis=1)
        self.edge_faces = np.bincount(self.corner_edges, minlength=len(unique))
        self.sharpness = self._edge_sharpness(unique)
        self._classify_vertices()

    def _edge_sharpness(self, keys: Array) -> Array:
        sharpness = np.zeros(len(keys))
        creases = self.cage.crease_keys
        if len(creases):
            places = np.clip(np.searchsorted(creases, keys), 0, len(creases) - 1)
            hit = creases[places] == keys
            sharpness[hit] = self.cage.crease_values[places[hit]]
        sharpness[self.edge_faces != 2] = INFINITE  # boundary or non-manifold
        return sharpness

    def _classify_vertices(self) -> None:
        count = self.cage.vertex_count
        sharp = self.sharpness > 0.0
        ends = self.edges[sharp]
        self.sharp_ends = ends
        self.sharp_count = np.bincount(ends.reshape(-1), minlength=count)
        weights = np.repeat(np.minimum(self.sharpness[sharp], INFINITE), 2)
        total = np.bincount(ends.reshape(-1), weights=weights, minlength=count)
        self.vertex_sharpness = total / np.maximum(self.sharp_count, 1)
        self.vertex_faces = np.bincount(self.cage.corners, minlength=count)
        self.vertex_edges = np.bincount(self.edges.reshape(-1), minlength=count)
        boundary = np.zeros(count, dtype=bool)
        boundary[self.edges[self.edge_faces != 2].reshape(-1)] = True
        pinned = np.zeros(count) if self.cage.pinned is None else self.cage.pinned * INFINITE
        if self.cage.pin_corners:
            pinned[boundary & (self.vertex_faces == 1)] = INFINITE
        if self.cage.pin_boundary:
            pinned[boundary] = INFINITE
        if self.cage.corner_sharpness is not None:
            pinned = np.maximum(pinned, self.cage.corner_sharpness)
        self.corner_weight = np.minimum(pinned, 1.0)

    def smooth(self, values: Array) -> Array:
        """Catmull-Clark values (V + E + F, k) of vertex values (V, k)."""
        faces = self._face_points(values)
        middles = values[self.edges].mean(axis=1)
        around = _gather(self.corner_edges, faces[self.corner_faces], len(self.edges))
        share = self._face_shares()[:, None]
        soft = middles * (1.0 - 2.0 * share) + around * share
        weight = np.minimum(self.sharpness, 1.0)[:, None]
        edge_points = np.where(weight >= 1.0, middles, soft + (middles - soft) * weight)
        return np.concatenate([self._vertex_points(values, faces, middles), edge_points, faces])

    def _face_shares(self) -> Array:
        """(E,) the weight of each of the two faces beside an edge."""
        if not self.cage.smooth_triangles:
            return np.full(len(self.edges), _FACE_SHARE)
        shares = np.where(self.cage.counts == 3, _TRIANGLE_SHARE, _FACE_SHARE)
        weights = shares[self.corner_faces]
        sums = np.bincount(self.corner_edges, weights=weights, minlength=len(self.edges))
        return np.asarray(sums / 2.0)

    def linear(self, values: Array) -> Array:
        """Bilinear values (V + E + F, k), for `varying` and faceVarying `all`."""
        middles = values[self.edges].mean(axis=1)
        return np.concatenate([values, middles, self._face_points(values)])

    def _face_points(self, values: Array) -> Array:
        sums = np.add.reduceat(values[self.cage.corners], self.starts, axis=0)
        return sums / self.cage.counts[:, None]

    def _vertex_points(self, values: Array, faces: Array, middles: Array) -> Array:
        count = self.cage.vertex_count
        valence = np.maximum(self.vertex_faces, 1)[:, None]
        edge_count = np.maximum(self.vertex_edges, 1)[:, None]
        q = _gather(self.cage.corners, faces[self.corner_faces], count) / valence
        r = _gather(self.edges.reshape(-1), np.repeat(middles, 2, axis=0), count) / edge_count
        soft = (q + 2.0 * r + (edge_count - 3.0) * values) / edge_count
        neighbors = values[self.sharp_ends[:, ::-1].reshape(-1)]
        along = _gather(self.sharp_ends.reshape(-1), neighbors, count)
        crease = values * 0.75 + along / 8.0
        weight = np.minimum(self.vertex_sharpness, 1.0)[:, None]
        kind = self.sharp_count[:, None]
        result = np.where(kind == 2, soft + (crease - soft) * weight, soft)
        result = np.where(kind > 2, soft + (values - soft) * weight, result)
        result = result + (values - result) * self.corner_weight[:, None]
        unused = self.vertex_faces == 0
        result[unused] = values[unused]
        return result

    def child(self) -> Cage:
        """The refined cage: one quad per corner, in the order of the corners."""
        vertices, edges = self.cage.vertex_count, len(self.edges)
        own = self.cage.corners
        after = vertices + self.corner_edges
        center = vertices + edges + self.corner_faces
        before = vertices + self.corner_edges[self.previous]
        corners = np.stack([own, after, center, before], axis=1).reshape(-1)
        count = vertices + edges + len(self.cage.counts)
        # A crease of sharpness s gives two of s - 1; boundary edges are found by their faces.
        left = (self.sharpness > 1.0) & (self.edge_faces == 2)
        middle = vertices + np.flatnonzero(left)
        keys = np.concatenate([edge_keys(self.edges[left, side], middle, count) for side in (0, 1)])
        values = np.tile(self.sharpness[left] - 1.0, 2)
        order = np.argsort(keys)
        child = Cage(np.full(len(own), 4), corners, count, keys[order], values[order])
        child.pin_corners, child.pin_boundary = self.cage.pin_corners, self.cage.pin_boundary
        if self.cage.corner_sharpness is not None:
            kept = np.maximum(self.cage.corner_sharpness - 1.0, 0.0)
            child.corner_sharpness = np.concatenate([kept, np.zeros(count - vertices)])
        if self.cage.pinned is not None:
            child.pinned = np.concatenate([self.cage.pinned, np.zeros(count - vertices, bool)])
        return child


def _gather(targets: Array, values: Array, count: int) -> Array:
    """Sum rows of `values` by target number."""
    return np.stack(
        [np.bincount(targets, weights=column, minlength=count) for column in values.T], axis=1
    )


def refine_steps(cage: Cage, level: int) -> list[Step]:
    """`level` successive refinements."""
    steps = []
    for _ in range(level):
        steps.append(Step(cage))
        cage = steps[-1].child()
    return steps
