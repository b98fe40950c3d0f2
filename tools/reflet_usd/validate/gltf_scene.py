"""Owns the output's facts: corners, cameras and lights of a glTF file at a time."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Any

import numpy as np

from .faces import measure
from .gltf_file import GltfFile
from .gltf_pose import Pose, Poser, compose
from .scene_data import Array, Camera, Corners, Indices, Light, Scene, stacked, transform_points

_MOST_ROUNDED = 0.06
"""Maximum relative difference of a line from the width it is drawn with: half a step of 64."""
_INSTANCING = "EXT_mesh_gpu_instancing"
_LIGHTS = "KHR_lights_punctual"


class OutputReader:
    """Evaluates one glTF file at any time, keyed by the prim paths in its extras."""

    def __init__(self, file: GltfFile, instancers: Collection[str]) -> None:
        self.file = file
        self.poser = Poser(file)
        self.instancers = frozenset(instancers)
        self.prims: dict[int, str] = {}
        self.keys: dict[int, str] = {}
        for node in self.poser.order:
            parent = self.poser.parents.get(node)
            prim = file.prim_of(file.nodes[node])
            inherited = self.prims.get(parent, "") if parent is not None else ""
            self.prims[node] = prim or inherited
            above = self.keys.get(parent, "") if parent is not None else ""
            inside = above if above in self.instancers else None
            self.keys[node] = inside or self.prims[node]

    def scene(self, seconds: float | None, hidden: bool = False) -> Scene:
        """Facts about everything that the file shows at `seconds` (None: as stored, no animation).

        `hidden` includes nodes that KHR_node_visibility hides.
        """
        pose, pointed = self.poser.pose(seconds), self.poser.pointed(seconds)
        scene = Scene(matrices=self.matrices(pose))
        pieces: dict[str, list[_Piece]] = {}
        for index in self.poser.order:
            if index in pose.hidden and not hidden:
                continue
            node, key, world = self.file.nodes[index], self.keys[index], pose.worlds[index]
            if node.camera is not None:
                scene.cameras.setdefault(key, []).append(self._camera(node.camera, world, pointed))
            light = (node.extensions or {}).get(_LIGHTS)
            if light is not None:
                scene.lights.setdefault(key, []).append(self._light(light["light"], world))
            if node.mesh is not None:
                pieces.setdefault(key, []).extend(self._pieces(index, pose))
        for key, parts in pieces.items():
            scene.corners[key] = self._merge(parts)
        return scene

    def drawn_meshes(self) -> list[tuple[int, str]]:
        """Meshes of the scene, once for each key that draws them, and these keys."""
        pairs = ((self.file.nodes[node].mesh, self.keys[node]) for node in self.poser.order)
        return list(dict.fromkeys((mesh, key) for mesh, key in pairs if mesh is not None))

    def matrices(self, pose: Pose) -> dict[str, list[Array]]:
        """World matrices of the nodes that keep a prim path, by that path."""
        result: dict[str, list[Array]] = {}
        for index in self.poser.order:
            if self.file.prim_of(self.file.nodes[index]):
                result.setdefault(self.prims[index], []).append(pose.worlds[index])
        return result

    def joints(self, pose: Pose) -> dict[str, dict[str, list[Array]]]:
        """World matrices of the joints, by the prim they are below and their name."""
        result: dict[str, dict[str, list[Array]]] = {}
        for index in self.poser.order:
            extras = getattr(self.file.nodes[index], "extras", None) or {}
            if "joint" in extras:
                found = result.setdefault(self.prims[index], {})
                found.setdefault(str(extras["joint"]), []).append(pose.worlds[index])
        return result

    def _pieces(self, index: int, pose: Pose) -> list[_Piece]:
        node = self.file.nodes[index]
        mesh = self.file.meshes[node.mesh]
        weights = pose.weights.get(index)
        if weights is None:
            weights = np.array(self.file.node_weights(index), dtype=np.float64)
        joints = self._joint_matrices(node, pose) if node.skin is not None else None
        places = self._places(node, pose.worlds[index])
        pieces = []
        for primitive in mesh.primitives:
            local = _Local(self.file, primitive, weights, joints)
            for place in [np.eye(4)] if joints is not None else places:
                pieces.append(_Piece(local, place))
        return pieces

    def _joint_matrices(self, node: Any, pose: Pose) -> Array:
        skin = self.file.gltf.skins[node.skin]
        worlds = np.stack([pose.worlds.get(joint, np.eye(4)) for joint in skin.joints])
        if skin.inverseBindMatrices is None:
            return worlds
        inverse = self.file.accessor(skin.inverseBindMatrices).reshape(-1, 4, 4)
        return inverse[: len(worlds)] @ worlds

    def _places(self, node: Any, world: Array) -> list[Array]:
        instancing = (node.extensions or {}).get(_INSTANCING)
        if instancing is None:
            return [world]
        attributes = {k: self.file.accessor(v) for k, v in instancing["attributes"].items()}
        count = max(len(values) for values in attributes.values())
        moves = attributes.get("TRANSLATION", np.zeros((count, 3)))
        turns = attributes.get("ROTATION", np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)))
        scales = attributes.get("SCALE", np.ones((count, 3)))
        return [compose(m, t, s) @ world for m, t, s in zip(moves, turns, scales, strict=True)]

    def _merge(self, parts: list[_Piece]) -> Corners:
        solid = [part for part in parts if part.local.triangles is not None]
        loose = [part for part in parts if part.local.triangles is None]
        worlds = [transform_points(part.local.positions, part.place) for part in solid]
        result = Corners(
            np.vstack(worlds) if worlds else np.zeros((0, 3)),
            np.zeros((0, 3)),
        )
        if loose:
            result.points = np.vstack([transform_points(p.local.points, p.place) for p in loose])
            many = [{**p.local.uvs, **p.local.customs, "COLOR_0": p.local.colors} for p in loose]
            result.point_values = stacked(many)
        if not solid:
            return result
        center = result.positions.mean(axis=0) if len(result.positions) else np.zeros(3)
        result.center = center
        area, volume = 0.0, 0.0
        for part, world in zip(solid, worlds, strict=True):
            sign = math.copysign(1.0, float(np.linalg.det(part.place[:3, :3])))
            faces = measure(world, np.full(len(world) // 3, 3), center)
            result.triangles += len(world) // 3
            area += faces.area_range[0]
            result.vector_area = result.vector_area + sign * faces.vector_area
            volume += sign * faces.volume_range[0]
        result.area_range, result.volume_range = (area, area), (volume, volume)
        self._merge_attributes(result, solid)
        return result

    def _merge_attributes(self, result: Corners, solid: list[_Piece]) -> None:
        if all(part.local.normals is not None for part in solid):
            result.normals = np.vstack([part.world_normals() for part in solid])
        result.uvs = stacked([part.local.uvs for part in solid])
        result.customs = stacked([part.local.customs for part in solid])
        result.colors = np.vstack([part.local.colors for part in solid])
        labels: list[Indices] = []
        sides = set()
        for part in solid:
            material = part.local.material
            path = self.file.prim_of(self.file.materials[material]) if material is not None else ""
            if path and path not in result.material_paths:
                result.material_paths.append(path)
            label = result.material_paths.index(path) if path else -1
            labels.append(np.full(len(part.local.positions), label))
            stored = self.file.materials[material] if material is not None else None
            sides.add(bool(stored.doubleSided) if stored else False)
            result.is_lamp |= stored is not None and "mesh_light" in (stored.extras or {})
        result.materials = np.concatenate(labels)
        result.double_sided = sides.pop() if len(sides) == 1 else None

    def _camera(self, index: int, world: Array, pointed: dict[str, float]) -> Camera:
        camera = self.file.tree["cameras"][index]
        kind = camera["type"]
        lens = {k: pointed.get(f"/cameras/{index}/{kind}/{k}", v) for k, v in camera[kind].items()}
        far = lens.get("zfar", math.inf)
        extras = camera.get("extras") or {}
        x, y = extras.get("lens_shift", (0.0, 0.0))
        kept = (lens["znear"], far, (x, y), extras.get("clip_planes", []))
        if kind == "orthographic":
            high = lens["ymag"]
            return Camera(world, None, lens["xmag"] / high, high, *kept)
        return Camera(world, lens["yfov"], lens.get("aspectRatio", 0.0), None, *kept)

    def _light(self, index: int, world: Array) -> Light:
        light = self.file.extensions[_LIGHTS]["lights"][index]
        color = np.array(light.get("color", (1.0, 1.0, 1.0)), dtype=np.float64)
        result = Light(light["type"], color * light.get("intensity", 1.0), world)
        if light["type"] == "spot":
            result.outer_cone = light.get("spot", {}).get("outerConeAngle", math.pi / 4)
            result.inner_cone = light.get("spot", {}).get("innerConeAngle", 0.0)
        return result


class _Local:
    """One primitive's corners in its node's space, morphed and skinned."""

    def __init__(
        self, file: GltfFile, primitive: Any, weights: Array, joints: Array | None
    ) -> None:
        attributes = {k: v for k, v in vars(primitive.attributes).items() if v is not None}
        positions = self._morphed(file, primitive, attributes, "POSITION", weights)
        normals = self._morphed(file, primitive, attributes, "NORMAL", weights)
        if joints is not None:
            positions, normals = _skinned(file, attributes, positions, normals, joints)
        count = len(positions)
        indices = np.arange(count)
        if primitive.indices is not None:
            indices = file.accessor(primitive.indices).astype(np.int64)
        self.material: int | None = primitive.material
        self.triangles = _triangles(4 if primitive.mode is None else primitive.mode, indices)
        self.points = positions[indices] if self.triangles is None else np.zeros((0, 3))
        corners = self.triangles if self.triangles is not None else indices
        self.positions = positions[corners]
        self.normals = normals[corners] if normals is not None else None
        self.uvs: dict[str, Array] = {}
        self.customs: dict[str, Array] = {}
        for name, accessor in attributes.items():
            if name.startswith("TEXCOORD_"):
                uv = file.accessor(accessor)[corners].astype(np.float64)
                # glTF's v points down, USD's up.
                self.uvs[name] = np.column_stack([uv[:, 0], 1.0 - uv[:, 1]])
            elif name.startswith("_"):
                values = file.accessor(accessor)[corners].astype(np.float64)
                self.customs[name] = values.reshape(len(values), -1)
        width = (getattr(primitive, "extras", None) or {}).get("width_m")
        authored = self.customs.get("_DIAMETER_M")
        if authored is not None:
            step = 1 if primitive.mode == 0 else 2
            means = authored.reshape(-1, step).mean(axis=1)
            lowest = max(float(means.max(initial=0.0)) * 1e-3, 1e-30)
            drawn = -1.0 if width is None else max(width, lowest)
            off = np.abs(np.maximum(means, lowest) / drawn - 1.0).max(initial=0.0)
            if off > _MOST_ROUNDED:  # drawn otherwise than said
                self.customs["_DIAMETER_M"] = np.full(authored.shape, np.inf)
        self.colors = self._colors(file, attributes, count)[corners]

    def _morphed(
        self, file: GltfFile, primitive: Any, attributes: dict[str, int], name: str, weights: Array
    ) -> Any:
        if name not in attributes:
            return None
        values = file.accessor(attributes[name]).astype(np.float64)
        for weight, target in zip(weights, primitive.targets or [], strict=False):
            accessor = target.get(name) if isinstance(target, dict) else getattr(target, name, None)
            if weight and accessor is not None:
                values = values + weight * file.accessor(accessor)
        return values

    def _colors(self, file: GltfFile, attributes: dict[str, int], count: int) -> Array:
        """COLOR_0 times the material's base color factor."""
        result = np.ones((count, 4))
        if "COLOR_0" in attributes:
            stored = file.accessor(attributes["COLOR_0"])
            result[:, : stored.shape[1]] = stored
        if self.material is not None:
            pbr = file.materials[self.material].pbrMetallicRoughness
            if pbr is not None and pbr.baseColorFactor is not None:
                result = result * np.array(pbr.baseColorFactor)
        return result


class _Piece:
    """A primitive at one place in the world."""

    def __init__(self, local: _Local, place: Array) -> None:
        self.local = local
        self.place = place

    def world_normals(self) -> Array:
        linear = self.place[:3, :3]
        normals = self.local.normals
        assert normals is not None
        if abs(np.linalg.det(linear)) > 1e-30:
            normals = normals @ np.linalg.inv(linear).T
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        return normals / np.where(length > 0, length, 1.0)


def _triangles(mode: int, indices: Indices) -> Indices | None:
    """Corner indices of all triangles; None for points and lines."""
    if mode == 4:
        return indices[: len(indices) // 3 * 3]
    if mode == 5:
        order = np.stack([indices[:-2], indices[1:-1], indices[2:]], axis=1)
        order[1::2] = order[1::2][:, [1, 0, 2]]
        return order.reshape(-1)
    if mode == 6:
        first = np.full(len(indices) - 2, indices[0])
        return np.stack([first, indices[1:-1], indices[2:]], axis=1).reshape(-1)
    return None


def _skinned(
    file: GltfFile, attributes: dict[str, int], positions: Array, normals: Any, joints: Array
) -> tuple[Array, Any]:
    """Linear blend skinning over every set of JOINTS_n and WEIGHTS_n."""
    blended = np.zeros((len(positions), 4, 4))
    for name, accessor in attributes.items():
        if name.startswith("JOINTS_"):
            which = file.accessor(accessor).astype(np.int64)
            weight = file.accessor(attributes["WEIGHTS_" + name[7:]])
            for slot in range(4):
                blended += weight[:, slot, None, None] * joints[which[:, slot]]
    moved = np.einsum("ni,nij->nj", positions, blended[:, :3, :3]) + blended[:, 3, :3]
    if normals is not None:
        turned = np.einsum("ni,nij->nj", normals, blended[:, :3, :3])
        length = np.linalg.norm(turned, axis=1, keepdims=True)
        normals = turned / np.where(length > 0, length, 1.0)
    return moved, normals
