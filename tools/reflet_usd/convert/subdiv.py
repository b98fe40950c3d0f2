"""Catmull-Clark and Loop refinement: boundaries, creases, corners, faceVarying rules, in arrays.

Rules: Catmull and Clark 1978; Loop 1987; semi-sharp creases from DeRose, Kass and Truong 1998;
the names of the boundary and faceVarying options are UsdGeomMesh's.
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
    is_loop: bool = False
    """Whether the faces are triangles that Loop's scheme refines to four triangles each."""


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
        self.corner_sharpness = np.minimum(pinned, INFINITE)

    def smooth(self, values: Array) -> Array:
        """Values (V + E, k) by Loop, or (V + E + F, k) by Catmull and Clark, of vertices (V, k)."""
        if self.cage.is_loop:
            return self._smooth_loop(values)
        faces = self._face_points(values)
        middles = values[self.edges].mean(axis=1)
        around = _gather(self.corner_edges, faces[self.corner_faces], len(self.edges))
        share = self._face_shares()[:, None]
        soft = middles * (1.0 - 2.0 * share) + around * share
        weight = np.minimum(self.sharpness, 1.0)[:, None]
        edge_points = np.where(weight >= 1.0, middles, soft + (middles - soft) * weight)
        return np.concatenate([self._vertex_points(values, faces, middles), edge_points, faces])

    def _smooth_loop(self, values: Array) -> Array:
        middles = values[self.edges].mean(axis=1)
        across = values[self.cage.corners[self.previous]]
        soft = 0.75 * middles + _gather(self.corner_edges, across, len(self.edges)) / 8.0
        weight = np.minimum(self.sharpness, 1.0)[:, None]
        edge_points = np.where(weight >= 1.0, middles, soft + (middles - soft) * weight)
        count = np.maximum(self.vertex_edges, 1)[:, None]
        share = (0.625 - (0.375 + np.cos(2.0 * np.pi / count) / 4.0) ** 2) / count
        near = _gather(self.edges.reshape(-1), values[self.edges[:, ::-1].reshape(-1)], len(values))
        own = values * (1.0 - count * share) + near * share
        return np.concatenate([self._sharpened(values, own), edge_points])

    @property
    def child_faces(self) -> Array:
        """The face that each child is a part of."""
        if not self.cage.is_loop:
            return self.corner_faces
        return np.concatenate([self.corner_faces, np.arange(len(self.cage.counts))])

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
        faces = values[:0] if self.cage.is_loop else self._face_points(values)
        return np.concatenate([values, middles, faces])

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
        return self._sharpened(values, soft)

    def _sharpened(self, values: Array, soft: Array) -> Array:
        """Vertex points by the rules of this step and the next, between which sharpness fades."""
        fading, corner = (_fading(part) for part in (self.sharpness, self.corner_sharpness))
        ends, count = self.edges.reshape(-1), self.cage.vertex_count
        total = np.bincount(ends, np.repeat(fading, 2), count) + corner
        number = np.bincount(ends, np.repeat(fading > 0.0, 2), count) + (corner > 0.0)
        weight = np.where(number > 0, total / np.maximum(number, 1), 1.0)[:, None]
        first = self._by_rule(values, soft, self.sharpness, self.corner_sharpness)
        later = self._by_rule(
            values, soft, _decayed(self.sharpness), _decayed(self.corner_sharpness)
        )
        result = first * weight + later * (1.0 - weight)
        unused = self.vertex_faces == 0
        result[unused] = values[unused]
        return result

    def _by_rule(self, values: Array, soft: Array, sharpness: Array, corner: Array) -> Array:
        """Vertex points: smooth, on a crease where two edges are sharp, at a corner of more."""
        ends = self.edges[sharpness > 0.0]
        count = np.bincount(ends.reshape(-1), minlength=self.cage.vertex_count)[:, None]
        neighbors = values[ends[:, ::-1].reshape(-1)]
        along = _gather(ends.reshape(-1), neighbors, self.cage.vertex_count)
        result = np.where(count == 2, values * 0.75 + along / 8.0, soft)
        return np.where((count > 2) | (corner > 0.0)[:, None], values, result)

    def child(self) -> Cage:
        """The refined cage: one quad per corner, in the order of the corners.

        By Loop's scheme one triangle per corner, and then one in the middle of each face.
        """
        vertices, edges = self.cage.vertex_count, len(self.edges)
        own = self.cage.corners
        after = vertices + self.corner_edges
        center = vertices + edges + self.corner_faces
        before = vertices + self.corner_edges[self.previous]
        corners = np.stack([own, after, center, before], axis=1).reshape(-1)
        count = vertices + edges + len(self.cage.counts)
        if self.cage.is_loop:
            corners = np.append(np.stack([own, after, before], axis=1).reshape(-1), after)
            count = vertices + edges
        size = 3 if self.cage.is_loop else 4
        # A crease of sharpness s gives two of s - 1; boundary edges are found by their faces.
        left = (self.sharpness > 1.0) & (self.edge_faces == 2)
        middle = vertices + np.flatnonzero(left)
        keys = np.concatenate([edge_keys(self.edges[left, side], middle, count) for side in (0, 1)])
        values = np.tile(self.sharpness[left] - 1.0, 2)
        order = np.argsort(keys)
        child = Cage(
            np.full(len(corners) // size, size), corners, count, keys[order], values[order]
        )
        child.is_loop = self.cage.is_loop
        child.pin_corners, child.pin_boundary = self.cage.pin_corners, self.cage.pin_boundary
        if self.cage.corner_sharpness is not None:
            kept = np.maximum(self.cage.corner_sharpness - 1.0, 0.0)
            child.corner_sharpness = np.concatenate([kept, np.zeros(count - vertices)])
        if self.cage.pinned is not None:
            child.pinned = np.concatenate([self.cage.pinned, np.zeros(count - vertices, bool)])
        return child


def _decayed(sharpness: Array) -> Array:
    """Sharpness at the next step."""
    return np.where(sharpness >= INFINITE, sharpness, np.maximum(sharpness - 1.0, 0.0))


def _fading(sharpness: Array) -> Array:
    """Sharpness below 1, which ends at this step; else 0."""
    return np.where(sharpness < 1.0, sharpness, 0.0)


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
