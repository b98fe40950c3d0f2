"""The node tree between USD and glTF: plain nodes that can be cloned for instances."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


@dataclass(frozen=True)
class Track:
    """One animated property of one node: keys in seconds, and one value row per key."""

    path: str
    """`translation`, `rotation`, `scale`, `weights`, a JSON pointer, or its part after the node."""
    times: Array
    """float64 seconds, strictly increasing, at least 0."""
    values: Array
    """(keys, components), in the file's units; of a spline (keys, 3, components): the slope that
    leads to the key, the value, the slope that leads on, slopes for each second."""
    step: bool = False
    """Hold each value until the next key instead of interpolating."""
    spline: bool = False
    """Whether the values are cubic between keys."""

    def keys(self) -> Array:
        """(keys, components): the values at the keys."""
        return self.values[:, 1] if self.spline else self.values


@dataclass(eq=False)
class Skin:
    """A glTF skin: joint nodes and, for each, the matrix from mesh space to joint space."""

    name: str
    joints: list[Node]
    inverse_bind: Array
    """(joints, 4, 4), column vectors: the translation is in the last column."""
    skeleton: Node | None = None


@dataclass(eq=False)
class Node:
    """A glTF node before it is written. Rotation is (x, y, z, w); None for identity."""

    name: str
    prim: str = ""
    translation: Array | None = None
    rotation: Array | None = None
    scale: Array | None = None
    mesh: int | None = None
    camera: int | None = None
    light: int | None = None
    skin: Skin | None = None
    weights: list[float] | None = None
    instances: dict[str, int] | None = None
    """Accessors of EXT_mesh_gpu_instancing."""
    tracks: list[Track] = field(default_factory=list)
    children: list[Node] = field(default_factory=list)
    extras: dict[str, Any] = field(default_factory=dict)

    def add(self, child: Node) -> Node:
        """Append `child` and return it."""
        self.children.append(child)
        return child

    def add_track(
        self, path: str, times: Array, values: Array, step: bool = False, spline: bool = False
    ) -> None:
        """Animate `path`; of keys whose times meet as float32 two stay, as neighbors.

        They are the two sides of a jump: the last key keeps its time, the first one moves back.
        Keys in between, and keys before 0 seconds, are left out.
        """
        times = np.maximum.accumulate(times)
        rounded = times.astype(np.float32)
        first = np.append(True, np.diff(rounded) > 0.0)
        last = np.append(np.diff(rounded) > 0.0, True)
        before = np.nextafter(rounded, np.float32(-np.inf))
        moved = first & ~last
        free = np.append(True, before[1:] > rounded[:-1]) & (before >= 0.0)
        keep = last | (moved & free)
        chosen = np.where(moved, before, rounded).astype(np.float64)
        chosen = np.where(last & first, times, chosen)
        self.tracks.append(Track(path, chosen[keep], values[keep], step, spline))

    def walk(self) -> list[Node]:
        """This node and all below it, parents first, without recursion."""
        found: list[Node] = []
        stack = [self]
        while stack:
            node = stack.pop()
            found.append(node)
            stack.extend(reversed(node.children))
        return found

    def clone(self) -> Node:
        """A deep copy that shares meshes and key arrays; skins follow their copied joints."""
        originals = self.walk()
        copies = {id(node): _shallow_copy(node) for node in originals}
        for node in originals:
            copy = copies[id(node)]
            copy.children = [copies[id(child)] for child in node.children]
        skins: dict[int, Skin] = {}
        for node in originals:
            if node.skin is None:
                continue
            if id(node.skin) not in skins:
                skins[id(node.skin)] = _skin_copy(node.skin, copies)
            copies[id(node)].skin = skins[id(node.skin)]
        return copies[id(self)]


def _shallow_copy(node: Node) -> Node:
    copy = Node(node.name, node.prim, node.translation, node.rotation, node.scale)
    copy.mesh, copy.camera, copy.light = node.mesh, node.camera, node.light
    copy.weights, copy.instances = node.weights, node.instances
    copy.tracks, copy.extras = list(node.tracks), dict(node.extras)
    return copy


def _skin_copy(skin: Skin, copies: dict[int, Node]) -> Skin:
    joints = [copies.get(id(joint), joint) for joint in skin.joints]
    root = None if skin.skeleton is None else copies.get(id(skin.skeleton), skin.skeleton)
    return Skin(skin.name, joints, skin.inverse_bind, root)


def identity_or(values: Array, identity: tuple[float, ...]) -> Array | None:
    """None where `values` is exactly the identity, which glTF leaves out."""
    array = np.asarray(values, dtype=np.float64)
    return None if tuple(array.tolist()) == identity else array
