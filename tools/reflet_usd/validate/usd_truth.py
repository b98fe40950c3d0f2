"""Owns the truth: the facts of a stage that are compared, evaluated by usd-core."""

import dataclasses
import math

import numpy as np
from pxr import Usd, UsdGeom, UsdShade

from .faces import measure
from .scene_data import Array, Corners, Indices, Scene, stacked, transform_points
from .usd_camera import read_camera
from .usd_curves import DIAMETER, SHOWN, read_patch, read_points
from .usd_gprim import read_grid, read_polyhedron, read_surface
from .usd_light import (
    OF_GEOMETRY,
    Source,
    geometry_lights,
    lost_of_dome,
    read_mesh_light,
    read_source,
    unusual_inputs,
)
from .usd_material import bound_material
from .usd_mesh import LocalMesh, read_mesh
from .usd_placements import Placement, PlacementWalk, is_light
from .usd_primvars import NO_COLOR, array_of
from .usd_stage import TruthStage
from .usd_subdivide import read_refined
from .usd_tessellation import read_tessellated

_MAX_LATHES = 64
"""Maximum number of curved gprims of one instancer that are compared corner by corner."""


class TruthReader:
    """Evaluates one stage at any time; meshes are read once per time and prototype prim."""

    def __init__(
        self,
        truth: TruthStage,
        cages: frozenset[str] = frozenset(),
        deformed: frozenset[str] = frozenset(),
    ) -> None:
        self.truth = truth
        self.deformed = deformed
        """Skinned and morphed prims, whose points move within them."""
        self.cages = cages
        """Subdivision meshes that are never refined."""
        self._named_lights = geometry_lights(truth.stage)
        self.instancers: list[str] = []
        self.outermost: dict[str, set[str]] = {}
        """Outermost instancers of the scene that was read last, see `PlacementWalk`."""
        self.skipped: dict[str, str] = {}

    def scene(self, time: Usd.TimeCode) -> Scene:
        """Facts about everything that the stage draws at `time`."""
        walk = PlacementWalk(self.truth.stage, time, self.truth.purposes)
        scene = Scene()
        pieces: dict[str, list[tuple[LocalMesh, Array]]] = {}
        lathes: dict[str, list[tuple[LocalMesh, Array]]] = {}
        clouds: dict[str, list[tuple[Array, dict[str, Array]]]] = {}
        meshes: dict[str, LocalMesh | None] = {}
        sources: dict[str, Source | None] = {}
        geometry = {str(light.GetPath()) for light in self._named_lights.values()}
        for place in walk.placements():
            prim = place.prim
            matrix = self.truth.world(place.matrix)
            if place.key != str(prim.GetPath()):
                scene.made_of.setdefault(place.key, set()).add(str(prim.GetPath()))
            if prim.IsA(UsdGeom.Camera):
                camera = read_camera(prim, time, self.truth, place.matrix)
                if camera is None:
                    scene.lost[str(prim.GetPath())] = [("camera-invalid", "apertures and focus")]
                else:
                    scene.cameras.setdefault(place.key, []).append(camera)
                continue
            if prim.IsA(UsdGeom.Gprim):
                _read_shining(scene, prim, time, self._named_lights)
            elif str(prim.GetPath()) in geometry:
                scene.inputs[str(prim.GetPath())] = unusual_inputs(prim, time, OF_GEOMETRY)
                continue
            elif is_light(prim):
                path = str(prim.GetPath())
                if path not in sources:
                    sources[path] = read_source(prim, time, self.truth)
                source = sources[path]
                if source is not None:
                    light = source.placed(self.truth, place.matrix)
                    scene.lights.setdefault(place.key, []).append(light)
                else:
                    inputs = lost_of_dome(prim, time)
                    scene.inputs[str(prim.GetPath())] = inputs or []
                    if inputs is None:
                        scene.other[place.key] = prim.GetTypeName()
                continue
            if (surface := read_surface(prim, time, matrix)) is not None:
                scene.surfaces.setdefault(place.key, []).append(surface)
                if (lathe := read_tessellated(prim, time, surface)) is not None:
                    lathes.setdefault(place.key, []).append((in_tint(lathe, place), matrix))
            elif (drawn := read_points(prim, time)) is not None:
                scene.lost[str(prim.GetPath())] = drawn.lost
                if len(drawn.points):
                    scene.misfits[str(prim.GetPath())] = drawn.misfits(prim, time)
                    placed = transform_points(drawn.points, matrix)
                    values = drawn.values(prim, time)
                    colors = tinted(drawn.colors(prim, time), len(placed), place)
                    plain = np.tile((NO_COLOR,) * 3 + (1.0,), (len(placed), 1))
                    values[SHOWN] = plain if colors is None else colors
                    if DIAMETER in values:
                        values[DIAMETER] = values[DIAMETER] * self.truth.meters_per_unit
                    clouds.setdefault(place.key, []).append((placed, values))
            elif prim.IsA(UsdGeom.NurbsPatch):
                grid, scene.lost[str(prim.GetPath())] = read_patch(prim, time)
                if grid is not None:
                    patch = in_tint(read_grid(prim, time, grid), place)
                    pieces.setdefault(place.key, []).append((patch, matrix))
            else:
                mesh = self._mesh(prim, time, meshes)
                if mesh is not None and len(mesh.counts):
                    pieces.setdefault(place.key, []).append((in_tint(mesh, place), matrix))
                    scene.misfits[str(prim.GetPath())] = mesh.misfits
                elif (mesh is not None and mesh.optional_triangles) or _is_pointless(prim, time):
                    scene.optional.add(place.key)
                elif not prim.IsA(UsdGeom.Mesh):
                    scene.other[place.key] = prim.GetTypeName()
        _add_tessellated(scene, pieces, lathes)
        for key, parts in pieces.items():
            scene.corners[key] = place_meshes(parts, key in self.deformed)
        for key, many in clouds.items():
            empty = Corners(np.zeros((0, 3)), np.zeros((0, 3)))
            cloud = scene.corners.setdefault(key, empty)
            cloud.points = np.vstack([points for points, _ in many])
            cloud.point_values |= stacked([values for _, values in many])
        self.instancers, self.skipped = walk.instancers, walk.skipped
        self.outermost = walk.outermost
        for path in walk.not_finite:
            lost = ("instancer-invalid", "instances that are not finite or name no prototype")
            scene.lost.setdefault(path, []).append(lost)
        for path in walk.cyclic:
            lost = ("instancer-cycle", "it is part of its own prototype")
            scene.lost.setdefault(path, []).append(lost)
        scene.matrices = self.matrices(time)
        return scene

    def _mesh(
        self, prim: Usd.Prim, time: Usd.TimeCode, cache: dict[str, LocalMesh | None]
    ) -> LocalMesh | None:
        path = str(prim.GetPath())
        if path not in cache:
            if prim.IsA(UsdGeom.Mesh):
                materials = face_materials(prim, time)
                refined = None
                if self.truth.subdiv_level > 0 and path not in self.cages:
                    refined = read_refined(prim, time, self.truth.subdiv_level, materials)
                cache[path] = refined or read_mesh(prim, time, materials)
            else:
                cache[path] = read_polyhedron(prim, time)
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


def in_tint(mesh: LocalMesh, place: Placement) -> LocalMesh:
    """The mesh in the display color and opacity of its instance, where it has none of its own."""
    return dataclasses.replace(mesh, colors=tinted(mesh.colors, len(mesh.positions), place))


def tinted(colors: Array | None, count: int, place: Placement) -> Array | None:
    """Colors (n, 4), from the instance of a prim where it has none of its own."""
    api = UsdGeom.PrimvarsAPI(place.prim)
    names = ("displayColor", "displayOpacity")
    found = [api.FindPrimvarWithInheritance(name) for name in names]
    own = [bool(primvar and primvar.HasValue()) for primvar in found]
    if not any(part is not None and not has for part, has in zip(place.tint, own, strict=True)):
        return colors
    colors = np.tile((NO_COLOR,) * 3 + (1.0,), (count, 1)) if colors is None else colors.copy()
    for part, has, columns in zip(place.tint, own, (slice(0, 3), slice(3, 4)), strict=True):
        if part is not None and not has:
            colors[:, columns] = np.clip(part, 0.0, 1.0)
    return colors


def _read_shining(
    scene: Scene, prim: Usd.Prim, time: Usd.TimeCode, named: dict[str, Usd.Prim]
) -> None:
    """Light that a gprim sends: its own, or from a GeometryLight that names it."""
    path = str(prim.GetPath())
    light = prim if is_light(prim) else named.get(path)
    if light is None:
        return
    if light == prim:
        scene.inputs[path] = unusual_inputs(prim, time, OF_GEOMETRY)
    if prim.IsA(UsdGeom.Points) or prim.IsA(UsdGeom.Curves) or prim.IsA("Volume"):
        scene.dark_lights.add(path)
    else:
        scene.mesh_lights[path] = read_mesh_light(light, time, light == prim)


def _add_tessellated(
    scene: Scene,
    pieces: dict[str, list[tuple[LocalMesh, Array]]],
    lathes: dict[str, list[tuple[LocalMesh, Array]]],
) -> None:
    """Add curved gprims as meshes, where all of a key have a tessellation and are not too many."""
    for key, placed in lathes.items():
        if len(placed) == len(scene.surfaces[key]) <= _MAX_LATHES:
            scene.turned.add(key)
            if key not in pieces:
                scene.closed.add(key)
            pieces.setdefault(key, []).extend(placed)


def _is_pointless(prim: Usd.Prim, time: Usd.TimeCode) -> bool:
    """Whether curves or a patch have no points, or a TetMesh no boundary."""
    if prim.IsA(UsdGeom.TetMesh):
        tets = UsdGeom.TetMesh(prim)
        faces = tets.GetSurfaceFaceVertexIndicesAttr().Get(time)
        return not faces and not UsdGeom.TetMesh.ComputeSurfaceFaces(tets, time)
    return bool(prim.IsA(UsdGeom.PointBased)) and not UsdGeom.PointBased(prim).GetPointsAttr().Get(
        time
    )


def place_meshes(placed: list[tuple[LocalMesh, Array]], deformed: bool = False) -> Corners:
    """World-space corners of several placed meshes that share one comparison key."""
    worlds = [transform_points(mesh.positions, matrix) for mesh, matrix in placed]
    optional = [transform_points(mesh.optional_positions, matrix) for mesh, matrix in placed]
    everything = np.vstack(worlds)
    result = Corners(everything, np.vstack(optional))
    center = result.center = everything.mean(axis=0)
    area, volume = np.zeros(2), np.zeros(2)
    normals, known = [], True
    for (mesh, matrix), world in zip(placed, worlds, strict=True):
        with np.errstate(invalid="ignore"):
            sign = math.copysign(1.0, float(np.linalg.det(matrix[:3, :3])))
        faces = measure(world, mesh.counts, center, deformed)
        result.triangles += int((mesh.counts - 2).sum())
        result.optional_triangles += mesh.optional_triangles
        if len(mesh.optional_counts):
            _add_optional(result, mesh, matrix, sign)
        area += faces.area_range
        result.vector_area = result.vector_area + sign * faces.vector_area
        ends = sign * np.array(faces.volume_range)
        volume += np.sort(ends)
        if mesh.normals is not None:
            normals.append(_transform_normals(mesh.normals, matrix))
        elif mesh.flat_shaded and _is_singular(matrix):
            normals.append(np.full((len(mesh.positions), 3), np.nan))
        elif mesh.flat_shaded and faces.flat.all():
            length = np.linalg.norm(faces.normals, axis=1, keepdims=True)
            defined = np.where(length > 0.0, faces.normals, np.nan)
            normals.append(sign * np.repeat(defined, mesh.counts, axis=0))
        else:
            known = False
    result.area_range = (float(area[0]), float(area[1]))
    result.volume_range = (float(volume[0]), float(volume[1]))
    result.normals = np.vstack(normals) if known else None
    _merge_attributes(result, [mesh for mesh, _ in placed])
    return result


def _add_optional(result: Corners, mesh: LocalMesh, matrix: Array, sign: float) -> None:
    corners = transform_points(mesh.optional_positions, matrix)
    faces = measure(corners, mesh.optional_counts, result.center)
    area, vector, volume = result.optional_measures
    result.optional_measures = (
        area + faces.area_range[1],
        vector + sign * faces.vector_area,
        volume + sign * faces.volume_range[0],
    )


def _merge_attributes(result: Corners, meshes: list[LocalMesh]) -> None:
    result.uvs = stacked([mesh.uvs for mesh in meshes])
    result.customs = stacked([mesh.customs for mesh in meshes])
    names = {name for mesh in meshes for name in mesh.undefined_colors}
    result.undefined_colors = tuple(sorted(names))
    colors = [mesh.colors for mesh in meshes if mesh.colors is not None]
    if len(colors) == len(meshes):
        result.colors = np.vstack(colors)
    labels: list[Indices] = []
    for mesh in meshes:
        places = [_place_of(path, result.material_paths) for path in mesh.material_paths]
        # The last entry is for index −1, no material.
        face_label = np.array([*places, -1])[mesh.materials]
        labels.append(np.repeat(face_label, mesh.counts))
    result.materials = np.concatenate(labels)
    result.double_sided = meshes[0].double_sided
    if any(mesh.double_sided != result.double_sided for mesh in meshes):
        result.double_sided = None


def _place_of(path: str, paths: list[str]) -> int:
    """Index of `path` in `paths`, to which a new path is added."""
    if path not in paths:
        paths.append(path)
    return paths.index(path)


def _transform_normals(normals: Array, matrix: Array) -> Array:
    """World-space unit normals; NaN where the matrix is singular."""
    linear = matrix[:3, :3]
    if _is_singular(matrix):
        return np.full_like(normals, np.nan)
    turned = normals @ np.linalg.inv(linear).T
    length = np.linalg.norm(turned, axis=1, keepdims=True)
    return turned / np.where(length > 0, length, 1.0)


def _is_singular(matrix: Array) -> bool:
    """Whether the matrix flattens space, or is not finite."""
    linear = matrix[:3, :3]
    if not np.isfinite(linear).all():
        return True
    reach = np.linalg.norm(linear, axis=1)
    smallest = float(np.linalg.svd(linear, compute_uv=False)[-1])
    return smallest <= 1e-9 * float(reach.max())


def face_materials(prim: Usd.Prim, time: Usd.TimeCode) -> tuple[Indices, list[str]]:
    """Material index of each face and the materials' paths, subsets included."""
    counts = UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().Get(time) or []
    result = np.full(len(counts), -1, dtype=np.int64)
    paths: list[str] = []

    def label(target: Usd.Prim) -> int:
        path = bound_material(target)
        return _place_of(path, paths) if path else -1

    result[:] = label(prim)
    # A face in several subsets belongs to the first one.
    for subset in reversed(UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets()):
        faces = array_of(subset.GetIndicesAttr().Get(time), np.int64)
        index = label(subset.GetPrim())
        result[faces[(faces >= 0) & (faces < len(result))]] = index
    return result, paths
