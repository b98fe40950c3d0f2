"""Owns the truth about refined meshes: Catmull-Clark and Loop one element at a time, for checks.

Written for being read beside the rules: Catmull and Clark 1978; Loop 1987; boundaries as in
UsdGeomMesh's `interpolateBoundary`; semi-sharp creases as in DeRose, Kass and Truong 1998, with
the blend between rules that OpenSubdiv uses.
"""

import dataclasses
import itertools
import math

import numpy as np
from pxr import Usd, UsdGeom

from .scene_data import Array, Indices
from .usd_mesh import LocalMesh
from .usd_primvars import array_of

INFINITE = 10.0
"""Sharpness from which a crease stays sharp at every level, as in OpenSubdiv."""
Edge = tuple[int, int]


@dataclasses.dataclass
class Cage:
    """A polygon mesh with sharpness."""

    points: Array
    faces: list[list[int]]
    parents: list[int]
    """Authored face of each face."""
    edge_sharpness: dict[Edge, float]
    corner_sharpness: dict[int, float]
    pin_corners: bool
    """Whether boundary vertices of one face stay (edgeAndCorner)."""
    softer: bool = False
    """Whether triangles follow the rule `smooth` of triangleSubdivisionRule."""


def read_refined(
    prim: Usd.Prim, time: Usd.TimeCode, level: int, materials: tuple[Indices, list[str]]
) -> LocalMesh | None:
    """The mesh after `level` steps; None where the scheme cannot refine it.

    Only places, materials and orientation: primvars have their own rules and are left out.
    """
    mesh = UsdGeom.Mesh(prim)
    points = array_of(mesh.GetPointsAttr().Get(time), np.float64, 3)
    counts = array_of(mesh.GetFaceVertexCountsAttr().Get(time), np.int64)
    indices = array_of(mesh.GetFaceVertexIndicesAttr().Get(time), np.int64)
    scheme = mesh.GetSubdivisionSchemeAttr().Get(time)
    if scheme not in (UsdGeom.Tokens.catmullClark, UsdGeom.Tokens.loop):
        return None
    loop = scheme == UsdGeom.Tokens.loop
    if loop and (counts != 3).any():
        return None
    if not len(counts) or counts.min() < 3 or counts.sum() != len(indices):
        return None
    boundary = mesh.GetInterpolateBoundaryAttr().Get(time)
    ends = np.cumsum(counts)
    faces = [indices[end - count : end].tolist() for count, end in zip(counts, ends, strict=True)]
    softer = mesh.GetTriangleSubdivisionRuleAttr().Get(time) == UsdGeom.Tokens.smooth
    parents, pinned = list(range(len(faces))), boundary == "edgeAndCorner"
    cage = Cage(points, faces, parents, {}, {}, pinned, softer)
    _read_sharpness(mesh, time, cage)
    hidden = set(array_of(mesh.GetHoleIndicesAttr().Get(time), np.int64).tolist())
    if boundary == UsdGeom.Tokens.none:
        around = _Neighbors(cage)
        rim = {v for edge, near in around.faces_of_edge.items() if len(near) != 2 for v in edge}
        hidden |= {number for number, face in enumerate(faces) if rim & set(face)}
    for _ in range(level):
        cage = refine_triangles(cage) if loop else refine(cage)
    drawn = [number for number, parent in enumerate(cage.parents) if parent not in hidden]
    size = 3 if loop else 4
    quads = np.array([cage.faces[number] for number in drawn], dtype=np.int64).reshape(-1, size)
    if mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded:
        quads = quads[:, ::-1]
    owners = np.array([cage.parents[number] for number in drawn], dtype=np.int64)
    return LocalMesh(
        cage.points[quads.reshape(-1)],
        np.full(len(quads), size),
        materials[0][owners],
        materials[1],
        bool(mesh.GetDoubleSidedAttr().Get(time)),
    )


def refine(cage: Cage) -> Cage:
    """One step of Catmull-Clark refinement."""
    around = _Neighbors(cage)
    face_points = [cage.points[face].mean(axis=0) for face in cage.faces]
    edges = sorted(around.faces_of_edge)
    edge_points = [_edge_point(cage, around, edge, face_points) for edge in edges]
    count = len(cage.points)
    vertex_points = [_vertex_point(cage, around, vertex, face_points) for vertex in range(count)]
    face_base = count
    edge_base = {edge: count + len(cage.faces) + place for place, edge in enumerate(edges)}
    faces, parents = [], []
    for index, face in enumerate(cage.faces):
        for place, vertex in enumerate(face):
            after, before = face[(place + 1) % len(face)], face[place - 1]
            ahead, behind = edge_base[_key(vertex, after)], edge_base[_key(before, vertex)]
            faces.append([vertex, ahead, face_base + index, behind])
            parents.append(cage.parents[index])
    sharp: dict[Edge, float] = {}
    for (a, b), sharpness in cage.edge_sharpness.items():
        lower = _decayed(sharpness)
        if lower > 0 and (a, b) in edge_base:
            sharp[_key(a, edge_base[(a, b)])] = sharp[_key(b, edge_base[(a, b)])] = lower
    corners = {v: _decayed(s) for v, s in cage.corner_sharpness.items() if _decayed(s) > 0}
    points = np.array([*vertex_points, *face_points, *edge_points])
    return Cage(points, faces, parents, sharp, corners, cage.pin_corners)


def refine_triangles(cage: Cage) -> Cage:
    """One step of Loop's refinement: three triangles at the corners, one in the middle."""
    around = _Neighbors(cage)
    edges = sorted(around.faces_of_edge)
    middle = {edge: len(cage.points) + place for place, edge in enumerate(edges)}
    points = [_vertex_point(cage, around, vertex, None) for vertex in range(len(cage.points))]
    for a, b in edges:
        halved = (cage.points[a] + cage.points[b]) / 2
        sharpness = around.sharpness(cage, (a, b))
        soft = halved
        if sharpness < 1:
            across = [
                v for f in around.faces_of_edge[a, b] for v in cage.faces[f] if v not in (a, b)
            ]
            soft = (3 * (cage.points[a] + cage.points[b]) + sum(cage.points[v] for v in across)) / 8
        points.append(soft * (1 - min(sharpness, 1)) + halved * min(sharpness, 1))
    faces, parents = [], []
    for index, (a, b, c) in enumerate(cage.faces):
        ab, bc, ca = middle[_key(a, b)], middle[_key(b, c)], middle[_key(c, a)]
        faces += [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        parents += [cage.parents[index]] * 4
    sharp = {}
    for (a, b), sharpness in cage.edge_sharpness.items():
        if _decayed(sharpness) > 0 and (a, b) in middle:
            sharp[_key(a, middle[a, b])] = sharp[_key(b, middle[a, b])] = _decayed(sharpness)
    corners = {v: _decayed(s) for v, s in cage.corner_sharpness.items() if _decayed(s) > 0}
    return Cage(np.array(points), faces, parents, sharp, corners, cage.pin_corners)


def _read_sharpness(mesh: UsdGeom.Mesh, time: Usd.TimeCode, cage: Cage) -> None:
    """Read creases: chains of vertices with one sharpness, or with one for each edge."""
    chains = array_of(mesh.GetCreaseIndicesAttr().Get(time), np.int64).tolist()
    lengths = array_of(mesh.GetCreaseLengthsAttr().Get(time), np.int64).tolist()
    values = array_of(mesh.GetCreaseSharpnessesAttr().Get(time), np.float64).tolist()
    per_edge = len(values) != len(lengths)
    start = used = 0
    for number, length in enumerate(lengths):
        chain = chains[start : start + length]
        for place, (a, b) in enumerate(itertools.pairwise(chain)):
            value = values[used + place] if per_edge else values[number]
            cage.edge_sharpness[_key(a, b)] = value
        start, used = start + length, used + length - 1
    corners = array_of(mesh.GetCornerIndicesAttr().Get(time), np.int64).tolist()
    sharp = array_of(mesh.GetCornerSharpnessesAttr().Get(time), np.float64).tolist()
    cage.corner_sharpness.update(zip(corners, sharp, strict=False))


class _Neighbors:
    """Adjacency of vertices, edges and faces."""

    def __init__(self, cage: Cage) -> None:
        self.faces_of_edge: dict[Edge, list[int]] = {}
        self.faces_of_vertex: dict[int, list[int]] = {}
        self.ends_of_vertex: dict[int, set[int]] = {}
        for index, face in enumerate(cage.faces):
            for place, vertex in enumerate(face):
                other = face[(place + 1) % len(face)]
                self.faces_of_edge.setdefault(_key(vertex, other), []).append(index)
                self.faces_of_vertex.setdefault(vertex, []).append(index)
                self.ends_of_vertex.setdefault(vertex, set()).add(other)
                self.ends_of_vertex.setdefault(other, set()).add(vertex)

    def sharpness(self, cage: Cage, edge: Edge) -> float:
        """Authored sharpness; boundaries and edges of more than two faces are infinitely sharp."""
        if len(self.faces_of_edge[edge]) != 2:
            return INFINITE
        return cage.edge_sharpness.get(edge, 0.0)


def _edge_point(cage: Cage, around: _Neighbors, edge: Edge, face_points: list[Array]) -> Array:
    ends = cage.points[edge[0]], cage.points[edge[1]]
    middle = (ends[0] + ends[1]) / 2
    sharpness = around.sharpness(cage, edge)
    if sharpness >= 1:
        return middle
    pair = around.faces_of_edge[edge]
    # The weights of Sdc::Scheme<SCHEME_CATMARK>::assignSmoothMaskForEdge in OpenSubdiv.
    each = [0.47 if cage.softer and len(cage.faces[face]) == 3 else 0.25 for face in pair]
    of_face = sum(each) / 2
    of_end = (1 - 2 * of_face) / 2
    smooth = of_face * (face_points[pair[0]] + face_points[pair[1]]) + of_end * (ends[0] + ends[1])
    return smooth * (1 - sharpness) + middle * sharpness


def _vertex_point(
    cage: Cage, around: _Neighbors, vertex: int, face_points: list[Array] | None
) -> Array:
    here = cage.points[vertex]
    if vertex not in around.faces_of_vertex:
        return here
    ends = sorted(around.ends_of_vertex[vertex])
    sharpness = {end: around.sharpness(cage, _key(vertex, end)) for end in ends}
    corner = cage.corner_sharpness.get(vertex, 0.0)
    if cage.pin_corners and len(around.faces_of_vertex[vertex]) == 1:
        corner = INFINITE
    later = {end: _decayed(value) for end, value in sharpness.items()}
    first, first_rule = _by_rule(cage, around, vertex, sharpness, corner, face_points)
    second, second_rule = _by_rule(cage, around, vertex, later, _decayed(corner), face_points)
    if first_rule == second_rule:
        return first
    fading = [value for value in [*sharpness.values(), corner] if 0 < value < 1]
    weight = sum(fading) / len(fading) if fading else 1.0
    return first * weight + second * (1 - weight)


def _by_rule(
    cage: Cage,
    around: _Neighbors,
    vertex: int,
    sharpness: dict[int, float],
    corner: float,
    face_points: list[Array] | None,
) -> tuple[Array, str]:
    here = cage.points[vertex]
    sharp = [end for end, value in sharpness.items() if value > 0]
    if corner > 0 or len(sharp) > 2:
        return here, "corner"
    if len(sharp) == 2:
        return (cage.points[sharp[0]] + cage.points[sharp[1]] + 6 * here) / 8, "crease"
    valence = len(sharpness)
    if face_points is None:  # Loop's
        share = (5 / 8 - (3 / 8 + math.cos(2 * math.pi / valence) / 4) ** 2) / valence
        near = sum(cage.points[end] for end in sharpness)
        return (1 - valence * share) * here + share * near, "smooth"
    faces = np.mean([face_points[face] for face in around.faces_of_vertex[vertex]], axis=0)
    ends = np.mean([cage.points[end] for end in sharpness], axis=0)
    return (faces + ends + (valence - 2) * here) / valence, "smooth"


def _key(a: int, b: int) -> Edge:
    return (a, b) if a < b else (b, a)


def _decayed(sharpness: float) -> float:
    return sharpness if sharpness >= INFINITE else max(sharpness - 1.0, 0.0)
