"""Owns the truth about refined meshes: Catmull-Clark one element at a time, for checks only.

Written for being read beside the rules: Catmull and Clark 1978; boundaries as in UsdGeomMesh's
`interpolateBoundary`; semi-sharp creases as in DeRose, Kass and Truong 1998, with the blend
between rules that OpenSubdiv uses.
"""

import dataclasses
import itertools

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
    """The mesh after `level` steps; None where it is not a usable Catmull-Clark mesh.

    Only places, materials and orientation: primvars have their own rules and are left out.
    """
    mesh = UsdGeom.Mesh(prim)
    points = array_of(mesh.GetPointsAttr().Get(time), np.float64, 3)
    counts = array_of(mesh.GetFaceVertexCountsAttr().Get(time), np.int64)
    indices = array_of(mesh.GetFaceVertexIndicesAttr().Get(time), np.int64)
    if mesh.GetSubdivisionSchemeAttr().Get(time) != UsdGeom.Tokens.catmullClark:
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
        cage = refine(cage)
    drawn = [number for number, parent in enumerate(cage.parents) if parent not in hidden]
    quads = np.array([cage.faces[number] for number in drawn], dtype=np.int64).reshape(-1, 4)
    if mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded:
        quads = quads[:, ::-1]
    owners = np.array([cage.parents[number] for number in drawn], dtype=np.int64)
    return LocalMesh(
        cage.points[quads.reshape(-1)],
        np.full(len(quads), 4),
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


def _vertex_point(cage: Cage, around: _Neighbors, vertex: int, face_points: list[Array]) -> Array:
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
    face_points: list[Array],
) -> tuple[Array, str]:
    here = cage.points[vertex]
    sharp = [end for end, value in sharpness.items() if value > 0]
    if corner > 0 or len(sharp) > 2:
        return here, "corner"
    if len(sharp) == 2:
        return (cage.points[sharp[0]] + cage.points[sharp[1]] + 6 * here) / 8, "crease"
    valence = len(sharpness)
    faces = np.mean([face_points[face] for face in around.faces_of_vertex[vertex]], axis=0)
    ends = np.mean([cage.points[end] for end in sharpness], axis=0)
    return (faces + ends + (valence - 2) * here) / valence, "smooth"


def _key(a: int, b: int) -> Edge:
    return (a, b) if a < b else (b, a)


def _decayed(sharpness: float) -> float:
    return sharpness if sharpness >= INFINITE else max(sharpness - 1.0, 0.0)
