"""Owns the truth: a stage evaluated by usd-core and reduced to the facts that are compared."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom, UsdShade

from .faces import measure
from .facts import Array, Corners, Indices, Scene, Surface, transform_points
from .usd_camera import read_camera
from .usd_light import read_light
from .usd_mesh import LocalMesh, array_of, read_mesh
from .usd_stage import TruthStage
from .usd_walk import StageWalk, is_light

_AXES = {"X": 0, "Y": 1, "Z": 2}
_CUBE_FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


class TruthReader:
    """Evaluates one stage at any time; meshes are read once per time and prototype prim."""

    def __init__(self, truth: TruthStage) -> None:
        self.truth = truth
        self.instancers: list[str] = []
        self.skipped: dict[str, str] = {}

    def scene(self, time: Usd.TimeCode) -> Scene:
        """Everything the stage draws at `time`."""
        walk = StageWalk(self.truth.stage, time, self.truth.purposes)
        scene = Scene()
        pieces: dict[str, list[tuple[LocalMesh, Array]]] = {}
        clouds: dict[str, list[Array]] = {}
        meshes: dict[str, LocalMesh | None] = {}
        for place in walk.placements():
            prim = place.prim
            matrix = self.truth.world(place.matrix)
            if prim.IsA(UsdGeom.Camera):
                scene.cameras[place.key] = read_camera(prim, time, self.truth, place.matrix)
            elif is_light(prim):
                light = read_light(prim, time, self.truth, place.matrix)
                if light:
                    scene.lights[place.key] = light
                else:
                    scene.other[place.key] = prim.GetTypeName()
            elif (surface := _surface(prim, time, matrix)) is not None:
                scene.surfaces.setdefault(place.key, []).append(surface)
            elif (points := _loose_points(prim, time)) is not None:
                clouds.setdefault(place.key, []).append(transform_points(points, matrix))
            else:
                mesh = self._mesh(prim, time, meshes)
                if mesh is not None and len(mesh.counts):
                    pieces.setdefault(place.key, []).append((mesh, matrix))
                elif not prim.IsA(UsdGeom.Mesh):
                    scene.other[place.key] = prim.GetTypeName()
        for key, placed in pieces.items():
            scene.corners[key] = place_meshes(placed)
        for key, parts in clouds.items():
            empty = Corners(np.zeros((0, 3)), np.zeros((0, 3)))
            scene.corners.setdefault(key, empty).points = np.vstack(parts)
        self.instancers, self.skipped = walk.instancers, walk.skipped
        scene.matrices = self.matrices(time)
        return scene

    def _mesh(
        self, prim: Usd.Prim, time: Usd.TimeCode, cache: dict[str, LocalMesh | None]
    ) -> LocalMesh | None:
        path = str(prim.GetPath())
        if path not in cache:
            if prim.IsA(UsdGeom.Mesh):
                cache[path] = read_mesh(prim, time, face_materials(prim, time))
            else:
                cache[path] = _polyhedron(prim, time)
        return cache[path]

    def matrices(self, time: Usd.TimeCode) -> dict[str, list[Array]]:
        """World matrices of all transformable prims outside instancers, by prim path."""
        predicate = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
        prims = iter(Usd.PrimRange(self.truth.stage.GetPseudoRoot(), predicate))
        xforms = UsdGeom.XformCache(time)
        result = {}
        for prim in prims:
            if prim.IsA(UsdGeom.PointInstancer):
                prims.PruneChildren()
            if prim.IsA(UsdGeom.Xformable):
                world = xforms.GetLocalToWorldTransform(prim)
                result[str(prim.GetPath())] = [self.truth.node_world(world)]
        return result


def place_meshes(placed: list[tuple[LocalMesh, Array]]) -> Corners:
    """World-space corners of several placed meshes that share one comparison key."""
    worlds = [transform_points(mesh.positions, matrix) for mesh, matrix in placed]
    optional = [transform_points(mesh.optional_positions, matrix) for mesh, matrix in placed]
    everything = np.vstack(worlds)
    result = Corners(everything, np.vstack(optional))
    center = everything.mean(axis=0)
    area, volume = np.zeros(2), np.zeros(2)
    normals, known = [], True
    for (mesh, matrix), world in zip(placed, worlds, strict=True):
        sign = math.copysign(1.0, float(np.linalg.det(matrix[:3, :3])))
        faces = measure(world, mesh.counts, center)
        result.triangles += int((mesh.counts - 2).sum())
        result.optional_triangles += mesh.optional_triangles
        area += faces.area_range
        result.vector_area = result.vector_area + sign * faces.vector_area
        ends = sign * np.array(faces.volume_range)
        volume += np.sort(ends)
        if mesh.normals is not None:
            normals.append(_transform_normals(mesh.normals, matrix))
        elif mesh.flat_shaded and faces.flat.all():
            normals.append(sign * np.repeat(faces.normals, mesh.counts, axis=0))
        else:
            known = False
    result.area_range = (float(area[0]), float(area[1]))
    result.volume_range = (float(volume[0]), float(volume[1]))
    result.normals = np.vstack(normals) if known else None
    _merge_attributes(result, [mesh for mesh, _ in placed])
    return result


def _merge_attributes(result: Corners, meshes: list[LocalMesh]) -> None:
    shared = set.intersection(*(set(mesh.uvs) for mesh in meshes))
    result.uvs = {name: np.vstack([mesh.uvs[name] for mesh in meshes]) for name in sorted(shared)}
    colors = [mesh.colors for mesh in meshes]
    if all(color is not None for color in colors):
        result.colors = np.vstack(colors)
    labels: list[Indices] = []
    for mesh in meshes:
        offset = len(result.material_paths)
        face_label = np.where(mesh.materials >= 0, mesh.materials + offset, -1)
        labels.append(np.repeat(face_label, mesh.counts))
        result.material_paths += mesh.material_paths
    result.materials = np.concatenate(labels)
    result.double_sided = meshes[0].double_sided
    if any(mesh.double_sided != result.double_sided for mesh in meshes):
        result.double_sided = None


def _transform_normals(normals: Array, matrix: Array) -> Array:
    linear = matrix[:3, :3]
    if abs(np.linalg.det(linear)) < 1e-30:
        return normals
    turned = normals @ np.linalg.inv(linear).T
    length = np.linalg.norm(turned, axis=1, keepdims=True)
    return turned / np.where(length > 0, length, 1.0)


def face_materials(prim: Usd.Prim, time: Usd.TimeCode) -> tuple[Indices, list[str]]:
    """Material index of each face and the materials' paths, subsets included."""
    counts = UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().Get(time) or []
    result = np.full(len(counts), -1, dtype=np.int64)
    paths: list[str] = []

    def label(target: Usd.Prim) -> int:
        material = UsdShade.MaterialBindingAPI(target).ComputeBoundMaterial()[0]
        if not material:
            return -1
        path = str(material.GetPath())
        if path not in paths:
            paths.append(path)
        return paths.index(path)

    result[:] = label(prim)
    for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
        faces = array_of(subset.GetIndicesAttr().Get(time), np.int64)
        index = label(subset.GetPrim())
        result[faces[(faces >= 0) & (faces < len(result))]] = index
    return result, paths


def _surface(prim: Usd.Prim, time: Usd.TimeCode, matrix: Array) -> Surface | None:
    """The curved gprims; None for everything else."""

    def number(name: str, fallback: float) -> float:
        value = prim.GetAttribute(name).Get(time) if prim.HasAttribute(name) else None
        return fallback if value is None else float(value)

    kind = prim.GetTypeName()
    axis = _AXES.get(str(prim.GetAttribute("axis").Get() or "Z"), 2) if kind != "Sphere" else 2
    if kind == "Sphere":
        radius = number("radius", 1.0)
        return Surface("sphere", (radius, radius), 0.0, 2, matrix)
    if kind in ("Cylinder", "Capsule"):
        radius = number("radius", 1.0 if kind == "Cylinder" else 0.5)
        height = number("height", 2.0 if kind == "Cylinder" else 1.0)
        return Surface(kind.lower(), (radius, radius), height, axis, matrix)
    if kind == "Cone":
        return Surface("cone", (number("radius", 1.0), 0.0), number("height", 2.0), axis, matrix)
    if kind in ("Cylinder_1", "Capsule_1"):
        both = (number("radiusBottom", 1.0), number("radiusTop", 1.0))
        return Surface(kind[:-2].lower(), both, number("height", 2.0), axis, matrix)
    return None


def _loose_points(prim: Usd.Prim, time: Usd.TimeCode) -> Array | None:
    """Positions of point clouds and linear curves; None for everything else."""
    linear = prim.IsA(UsdGeom.BasisCurves) and (
        UsdGeom.BasisCurves(prim).GetTypeAttr().Get(time) == UsdGeom.Tokens.linear
    )
    if not (prim.IsA(UsdGeom.Points) or linear):
        return None
    points = array_of(UsdGeom.PointBased(prim).GetPointsAttr().Get(time), np.float64, 3)
    return points[np.isfinite(points).all(axis=1)]


def _polyhedron(prim: Usd.Prim, time: Usd.TimeCode) -> LocalMesh | None:
    """Cubes and planes, whose corners are exact."""
    if prim.IsA(UsdGeom.Cube):
        half = float(prim.GetAttribute("size").Get(time) or 0.0) / 2
        points = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
        faces = np.array(_CUBE_FACES)
    elif prim.IsA(UsdGeom.Plane):
        width = float(prim.GetAttribute("width").Get(time) or 0.0) / 2
        length = float(prim.GetAttribute("length").Get(time) or 0.0) / 2
        axis = _AXES[str(prim.GetAttribute("axis").Get(time) or "Z")]
        # Width runs along X (along Z for axis X); length along Y (along Z for axis Y).
        along = {0: (2, 1), 1: (0, 2), 2: (0, 1)}[axis]
        points = np.zeros((4, 3))
        points[:, along[0]] = np.array([-1, 1, 1, -1]) * width
        points[:, along[1]] = np.array([-1, -1, 1, 1]) * length
        faces = np.array([[0, 1, 2, 3]] if axis == 2 else [[0, 3, 2, 1]])
    else:
        return None
    return _flat_mesh(prim, time, points[faces].reshape(-1, 3).astype(np.float64), len(faces))


def _flat_mesh(prim: Usd.Prim, time: Usd.TimeCode, corners: Array, faces: int) -> LocalMesh:
    binding: Any = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
    paths = [str(binding.GetPath())] if binding else []
    color = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("displayColor")
    rgb = array_of(color.Get(time), np.float64, 3) if color else np.zeros((0, 3))
    colors = np.hstack([rgb, np.ones((1, 1))]).repeat(len(corners), 0) if len(rgb) == 1 else None
    return LocalMesh(
        corners,
        np.full(faces, 4),
        np.zeros((0, 3)),
        0,
        None,
        {},
        colors,
        np.full(faces, 0 if paths else -1),
        paths,
        True,
        bool(UsdGeom.Gprim(prim).GetDoubleSidedAttr().Get(time)),
    )
