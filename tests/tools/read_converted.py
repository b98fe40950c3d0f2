"""Owns reading converted files in tests, through pygltflib and numpy only."""

import itertools
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib as gl
import pytest
from reflet_usd.convert import ConvertError, ConvertOptions, ConvertResult, convert_stage
from reflet_usd.validate.validation import Validation, validate_file
from reflet_usd.validate.validation_table import format_validation

_TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COUNTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Converted:
    """A stage that was converted in this process, and its file read back."""

    def __init__(self, stage: Path, out: Path, **options: Any) -> None:
        self.result: ConvertResult = convert_stage(stage, out, ConvertOptions(**options))
        self.stage, self.out = stage, out
        self.gltf = gl.GLTF2().load(str(out))
        self.json = json.loads(self.gltf.to_json())
        self.sidecar = json.loads(Path(f"{out}.json").read_text(encoding="utf-8"))

    def validated(self) -> Validation:
        """The comparison with the stage as it is now, in this process: starting one takes 2 s."""
        return validate_file(self.out, self.stage, khronos=False)

    def agreeing(self, **least: int) -> Validation:
        """The comparison, which has to pass, with at least so many comparisons of each check."""
        validation = self.validated()
        assert validation.passed, format_validation(validation)
        compared = {check.name: check.compared for check in validation.checks}
        assert {name: min(count, compared[name]) for name, count in least.items()} == least
        return validation

    def proven(self) -> "Converted":
        """The converted stage, after asserting that its file agrees with it."""
        self.agreeing()
        return self

    def warnings(self, prim: str | None = None) -> set[str]:
        """Names of the sidecar's warnings, of one prim or of all."""
        found = self.sidecar["warnings"]
        return {entry["name"] for entry in found if prim in (None, entry["prim"])}

    def array(self, accessor: int) -> np.ndarray:
        """An accessor's elements, (count, components)."""
        entry = self.gltf.accessors[accessor]
        view = self.gltf.bufferViews[entry.bufferView]
        blob = self.gltf.binary_blob()
        count = _COUNTS[entry.type]
        start = (view.byteOffset or 0) + (entry.byteOffset or 0)
        dtype = np.dtype(_TYPES[entry.componentType])
        data = np.frombuffer(blob, dtype, entry.count * count, start)
        return data.reshape(entry.count, count)

    def node(self, prim: str) -> int:
        """The node that stands for a prim."""
        hits = [i for i, n in enumerate(self.gltf.nodes) if (n.extras or {}).get("prim") == prim]
        assert hits, f"no node for {prim}"
        return hits[0]

    def world(self, seconds: float | None = None) -> list[np.ndarray]:
        """The world matrix of every node, animated to `seconds` where given."""
        locals_ = [self.local(index, seconds) for index in range(len(self.gltf.nodes))]
        world: list[Any] = [None] * len(locals_)
        stack = [(root, np.eye(4)) for root in self.gltf.scenes[0].nodes]
        while stack:
            index, above = stack.pop()
            world[index] = above @ locals_[index]
            stack.extend((child, world[index]) for child in self.gltf.nodes[index].children or [])
        return world

    def local(self, index: int, seconds: float | None) -> np.ndarray:
        """A node's matrix from its TRS."""
        node = self.gltf.nodes[index]
        parts = {
            "translation": np.array(node.translation or (0, 0, 0), dtype=float),
            "rotation": np.array(node.rotation or (0, 0, 0, 1), dtype=float),
            "scale": np.array(node.scale or (1, 1, 1), dtype=float),
        }
        if seconds is not None:
            parts.update(self.animated(index, seconds))
        x, y, z, w = parts["rotation"]
        rotation = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )
        matrix = np.eye(4)
        matrix[:3, :3] = rotation * parts["scale"]
        matrix[:3, 3] = parts["translation"]
        return matrix

    def animated(self, index: int, seconds: float) -> dict[str, np.ndarray]:
        """The animated properties of a node at a time, by glTF's interpolation rules."""
        found: dict[str, np.ndarray] = {}
        for animation in self.gltf.animations or []:
            for channel in animation.channels:
                if channel.target.node != index:
                    continue
                sampler = animation.samplers[channel.sampler]
                times = self.array(sampler.input)[:, 0].astype(float)
                values = self.array(sampler.output).astype(float)
                rotation = channel.target.path == "rotation"
                if sampler.interpolation == "CUBICSPLINE":
                    values = values.reshape(len(times), 3, -1)
                    found[channel.target.path] = hermite(times, values, seconds, rotation)
                    continue
                values = values.reshape(len(times), -1)
                step = sampler.interpolation == "STEP"
                found[channel.target.path] = interpolated(times, values, seconds, rotation, step)
        return found

    def triangles(self, mesh: int) -> np.ndarray:
        """Positions (T, 3, 3) of a mesh's triangles, all primitives."""
        parts = []
        for primitive in self.gltf.meshes[mesh].primitives:
            points = self.array(primitive.attributes.POSITION).astype(float)
            parts.append(points[self.array(primitive.indices)[:, 0]].reshape(-1, 3, 3))
        return np.concatenate(parts)

    def attribute(self, mesh: int, primitive: int, name: str) -> np.ndarray:
        """One vertex attribute, one row for each corner of each triangle."""
        entry = self.json["meshes"][mesh]["primitives"][primitive]
        indices = self.array(entry["indices"])[:, 0]
        return self.array(entry["attributes"][name])[indices].astype(float)


def hermite(times: np.ndarray, values: np.ndarray, seconds: float, rotation: bool) -> np.ndarray:
    """glTF's CUBICSPLINE (appendix C.5): slope in, value and slope out of each key."""
    right = int(np.searchsorted(times, seconds, side="right"))
    if right in (0, len(times)):
        return values[max(right - 1, 0), 1]
    first, last, span = values[right - 1], values[right], times[right] - times[right - 1]
    # Bernstein's form of the same cubic.
    points = [first[1], first[1] + first[2] * span / 3, last[1] - last[0] * span / 3, last[1]]
    u = (seconds - times[right - 1]) / span
    while len(points) > 1:
        points = [a + (b - a) * u for a, b in itertools.pairwise(points)]
    return points[0] / np.linalg.norm(points[0]) if rotation else points[0]


def interpolated(
    times: np.ndarray, values: np.ndarray, seconds: float, rotation: bool, step: bool
) -> np.ndarray:
    """glTF's LINEAR (spherical for rotations) and STEP."""
    if seconds <= times[0]:
        return values[0]
    if seconds >= times[-1]:
        return values[-1]
    last = int(np.searchsorted(times, seconds, side="right"))
    if step:
        return values[last - 1]
    a, b = values[last - 1], values[last]
    share = (seconds - times[last - 1]) / (times[last] - times[last - 1])
    if not rotation:
        return a + (b - a) * share
    dot = float(a @ b)
    if dot < 0:
        b, dot = -b, -dot
    angle = np.arccos(min(dot, 1.0))
    if angle < 1e-6:
        mixed = a + (b - a) * share
    else:
        mixed = (np.sin((1 - share) * angle) * a + np.sin(share * angle) * b) / np.sin(angle)
    return mixed / np.linalg.norm(mixed)


def refused(name: str, says: str = "") -> Any:
    """Expect a `ConvertError` of that name, whose path or message says so."""
    return pytest.raises(ConvertError, match=rf"(?s){re.escape(says)}.*\[{name}\]$")


def convert_text(folder: Path, text: str, name: str = "stage.usda", **options: Any) -> Converted:
    """Write a usda and convert it; `#usda` and metadata in meters with Y up are added."""
    if not text.lstrip().startswith("#usda"):
        head = '#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = "Y"\n)\n'
        text = head + text
    stage = folder / name
    stage.write_text(text, encoding="utf-8")
    return Converted(stage, folder / "out.glb", **options)
