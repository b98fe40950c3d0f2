"""Owns the poses of a glTF file's nodes: animation sampling and world matrices."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

import numpy as np

from .gltf_file import GltfFile
from .scene_data import Array

POINTERS = re.compile(
    r"/nodes/\d+/extensions/KHR_node_visibility/visible"
    r"|/cameras/\d+/(perspective/(aspectRatio|yfov|zfar|znear)|orthographic/([xy]mag|zfar|znear))"
)
"""JSON pointers that a converted file may animate."""
_VISIBILITY = "/nodes/{}/extensions/KHR_node_visibility/visible"


class Poser:
    """Evaluates a file's node tree; matrices act on row vectors."""

    def __init__(self, file: GltfFile) -> None:
        self.file = file
        scene = file.gltf.scenes[file.gltf.scene or 0] if file.gltf.scenes else None
        self.roots: list[int] = list(scene.nodes or []) if scene else []
        self.parents: dict[int, int] = {}
        self.order: list[int] = []
        """Nodes of the scene, parents first."""
        stack = list(reversed(self.roots))
        while stack:
            node = stack.pop()
            self.order.append(node)
            for child in file.nodes[node].children or []:
                self.parents[child] = node
                stack.append(child)

    def animated_nodes(self) -> set[int]:
        """Nodes that any channel moves or morphs."""
        animations = self.file.gltf.animations or []
        return {c.target.node for a in animations for c in a.channels if c.target.node is not None}

    def animated_rigs(self) -> int:
        """Number of channels that move a joint or the weights of a mesh."""
        joints = {joint for skin in self.file.gltf.skins or [] for joint in skin.joints}
        targets = [c.target for a in self.file.gltf.animations or [] for c in a.channels]
        return sum(target.path == "weights" or target.node in joints for target in targets)

    def pose(self, seconds: float | None) -> Pose:
        """Pose of all nodes at `seconds`, or as stored in the file for None."""
        values: dict[tuple[int, str], Array] = {}
        if seconds is not None:
            seconds = float(np.float32(seconds))  # rounded like stored keys, so that steps match
            for animation in self.file.gltf.animations or []:
                for channel in animation.channels:
                    if channel.target.node is not None:
                        sampler = animation.samplers[channel.sampler]
                        key = (channel.target.node, channel.target.path)
                        values[key] = self._sample(sampler, channel.target.path, seconds)
        worlds: dict[int, Array] = {}
        hidden = self._hidden(seconds)
        moved = {node for node, _ in values}
        for node in self.order:
            local = self._local(node, values, node in moved)
            parent = self.parents.get(node)
            worlds[node] = local if parent is None else local @ worlds[parent]
            if parent in hidden:
                hidden.add(node)
        weights = {node: value for (node, path), value in values.items() if path == "weights"}
        return Pose(worlds, weights, frozenset(hidden))

    def pointed(self, seconds: float | None) -> dict[str, float]:
        """Numbers that KHR_animation_pointer sets, by JSON pointer; none as stored in the file."""
        values: dict[str, float] = {}
        for animation in [] if seconds is None else self.file.gltf.animations or []:
            for channel in animation.channels:
                extensions = channel.target.extensions or {}
                pointer = extensions.get("KHR_animation_pointer", {}).get("pointer")
                if pointer is not None:
                    sampler = animation.samplers[channel.sampler]
                    at = float(np.float32(seconds))
                    values[pointer] = float(self._sample(sampler, "pointer", at)[0])
        return values

    def _hidden(self, seconds: float | None) -> set[int]:
        """Nodes that KHR_node_visibility hides directly, animated through KHR_animation_pointer."""
        pointed = self.pointed(seconds)
        hidden = set()
        for number, node in enumerate(self.file.tree.get("nodes", [])):
            state = node.get("extensions", {}).get("KHR_node_visibility", {})
            if not pointed.get(_VISIBILITY.format(number), state.get("visible", True)):
                hidden.add(number)
        return hidden

    def _local(self, index: int, values: dict[tuple[int, str], Array], moved: bool) -> Array:
        node = self.file.nodes[index]
        if node.matrix and not moved:
            return np.array(node.matrix, dtype=np.float64).reshape(4, 4)
        return compose(
            values.get((index, "translation"), np.array(node.translation or (0.0, 0.0, 0.0))),
            values.get((index, "rotation"), np.array(node.rotation or (0.0, 0.0, 0.0, 1.0))),
            values.get((index, "scale"), np.array(node.scale or (1.0, 1.0, 1.0))),
        )

    def _sample(self, sampler: Any, path: str, seconds: float) -> Array:
        """One channel at one time (glTF 2.0, appendix C)."""
        times = self.file.accessor(sampler.input)
        values = self.file.accessor(sampler.output)
        kind = sampler.interpolation or "LINEAR"
        per_key = len(values) // len(times)
        values = values.reshape(len(times), per_key, -1)
        if kind == "CUBICSPLINE":
            return _cubic(times, values, path, seconds)
        right = int(np.searchsorted(times, seconds, side="right"))
        if right == 0 or right == len(times) or kind == "STEP":
            return _squeeze(values[max(right - 1, 0)], path)
        span = times[right] - times[right - 1]
        factor = (seconds - times[right - 1]) / span
        first, second = values[right - 1], values[right]
        if path == "rotation":
            return slerp(first[0], second[0], factor)
        return _squeeze(first + (second - first) * factor, path)


@dataclasses.dataclass
class Pose:
    """World matrices and morph weights of all nodes at one time, and the hidden nodes."""

    worlds: dict[int, Array]
    weights: dict[int, Array]
    hidden: frozenset[int]


def compose(translation: Array, rotation: Array, scale: Array) -> Array:
    """Row-vector matrix of translation, unit quaternion (x, y, z, w) and scale."""
    x, y, z, w = rotation / max(float(np.linalg.norm(rotation)), 1e-300)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
            [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
            [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    result = np.eye(4)
    result[:3, :3] = np.asarray(scale)[:, None] * turn
    result[3, :3] = translation
    return result


def slerp(first: Array, second: Array, factor: float) -> Array:
    """Spherical interpolation along the shorter arc, as glTF asks for."""
    cosine = float(first @ second)
    if cosine < 0:
        second, cosine = -second, -cosine
    if cosine > 1 - 1e-12:
        return first + (second - first) * factor
    angle = np.arccos(min(cosine, 1.0))
    ends = np.sin((1 - factor) * angle) * first + np.sin(factor * angle) * second
    return ends / np.sin(angle)


def _cubic(times: Array, values: Array, path: str, seconds: float) -> Array:
    values = values.reshape(len(times), 3, -1) if path != "weights" else values
    third = values.shape[1] // 3
    tangents_in, points, tangents_out = (values[:, i * third : (i + 1) * third] for i in range(3))
    right = int(np.searchsorted(times, seconds, side="right"))
    if right == 0 or right == len(times):
        return _squeeze(points[max(right - 1, 0)], path)
    span = times[right] - times[right - 1]
    t = (seconds - times[right - 1]) / span
    result = (
        (2 * t**3 - 3 * t**2 + 1) * points[right - 1]
        + span * (t**3 - 2 * t**2 + t) * tangents_out[right - 1]
        + (3 * t**2 - 2 * t**3) * points[right]
        + span * (t**3 - t**2) * tangents_in[right]
    )
    return _squeeze(result, path)


def _squeeze(value: Array, path: str) -> Array:
    return value.reshape(-1) if path == "weights" else value[0]
