"""Owns one validation run: the Khronos validator, then the stage and the file at all times."""

from __future__ import annotations

import dataclasses
import io
import itertools
import json
import math
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .checks import Check, Checks
from .compare import SceneComparer
from .gltf_file import GltfFile, OutputError
from .gltf_scene import OutputReader
from .khronos import KhronosReport, check_files
from .scene_data import Array, Scene, bounds_of
from .sidecar import read_sidecar

if TYPE_CHECKING:
    from .usd_skel import JointTruth
    from .usd_stage import TruthStage
    from .usd_truth import TruthReader

_GEOMETRY_TIMES = 5
_MATRIX_TIMES = 33
_JSON = 0x4E4F534A
"""Chunk type of a .glb's JSON."""


@dataclasses.dataclass
class Validation:
    """Findings of one validation run about one file."""

    out: Path
    stage: Path | None
    khronos: KhronosReport | None
    checks: list[Check]
    warnings: list[dict[str, str]]
    """The sidecar's warnings."""
    unreadable: str = ""
    """Why the file or its sidecar could not be read; empty when both could."""
    facts: dict[str, Any] = dataclasses.field(default_factory=dict)
    """Counts and the world box of the output, as the third-party reader sees them."""
    about_stage: dict[str, Any] = dataclasses.field(default_factory=dict)
    """Counts of the stage's content, as usd-core sees it."""
    roots: list[str] = dataclasses.field(default_factory=list)
    """Folders that the stage was read from, as the sidecar records them."""
    times: int = 0
    """Number of times, besides rest, at which the animation was compared."""

    @property
    def passed(self) -> bool:
        """Whether the file is valid, readable, and without undeclared deviations."""
        valid = self.khronos is None or self.khronos.errors == 0
        return valid and not self.unreadable and all(check.passed for check in self.checks)

    def to_json(self) -> dict[str, Any]:
        """Plain data for `--json` and for the corpus report."""
        return {
            "file": self.out.name,
            "passed": self.passed,
            "khronos": dataclasses.asdict(self.khronos) if self.khronos else None,
            "unreadable": self.unreadable,
            "facts": self.facts,
            "stage": self.about_stage,
            "roots": self.roots,
            "times": self.times,
            "checks": [check.to_json() for check in self.checks],
            "warnings": self.warnings,
        }


def validate_file(out: Path, stage: Path | None, khronos: bool = True) -> Validation:
    """Validate `out`, and compare it with `stage` where one is given.

    `khronos=False` leaves the Khronos validator out. Raises ValidatorMissingError where it cannot
    run and StageError where usd-core does not open the stage.
    """
    report = check_files([out])[0] if khronos else None
    sidecar, fault = read_sidecar(out)
    warnings = list(sidecar.get("warnings", []))
    validation = Validation(out, stage, report, [], warnings, unreadable=fault)
    if fault:
        return validation  # without a sidecar a loss cannot be told from a fault
    try:
        file = GltfFile(out)
        checks = Checks(warnings)
        if stage is not None:
            _compare(file, stage, sidecar, checks, validation)
        else:
            _summarize_output(OutputReader(file, ()), None, checks, validation)
        validation.checks = checks.results()
    except OutputError as error:
        validation.unreadable = str(error)
    return validation


def _summarize_output(
    reader: OutputReader, scene: Scene | None, checks: Checks, validation: Validation
) -> None:
    """Note the file's content at rest, and whether a second reader sees the same."""
    scene = scene or reader.scene(None)
    box = bounds_of(scene.corners)
    file = reader.file
    validation.facts = {
        "box": None if box is None else [*map(float, box[0]), *map(float, box[1])],
        "triangles": sum(part.triangles for part in scene.corners.values()),
        "materials": len(file.materials),
        "images": len(file.gltf.images or []),
        "cameras": sum(file.nodes[node].camera is not None for node in reader.poser.order),
        "lights": sum(
            "KHR_lights_punctual" in (file.nodes[node].extensions or {})
            for node in reader.poser.order
        ),
        "animated_nodes": len(reader.poser.animated_nodes()),
        "animated_rigs": reader.poser.animated_rigs(),
    }
    if "KHR_node_visibility" in (file.gltf.extensionsUsed or []):
        box = bounds_of(reader.scene(None, hidden=True).corners)  # trimesh ignores visibility
    if box is not None:
        _second_reader(file, box, checks)


def warnings_of(sidecar: dict[str, Any], name: str) -> list[dict[str, str]]:
    """Warnings of the sidecar of one name."""
    return [warning for warning in sidecar.get("warnings", []) if warning["name"] == name]


def _compare(
    file: GltfFile, stage: Path, sidecar: dict[str, Any], checks: Checks, validation: Validation
) -> None:
    """Compare at rest and over the animation."""
    # Imported here so that files can be validated alone without usd-core.
    from pxr import Usd

    from .document import compare_document
    from .material_compare import compare_materials
    from .mesh_light_compare import compare_mesh_lights
    from .unauthored_materials import compare_unauthored_materials
    from .usd_layers import compare_layers
    from .usd_ops import compare_ops, repair_ops
    from .usd_rules import apply_rules, frozen_sizes
    from .usd_skel import (
        JointTruth,
        bake,
        key_ends,
        keyed_skeletons,
        moving_points,
        skin_times,
        split_skeletons,
    )
    from .usd_stage import open_truth
    from .usd_truth import TruthReader
    from .uv_compare import compare_uv_uses

    settings = sidecar.get("info", {})
    truth = open_truth(stage, settings)
    missing_ops = repair_ops(truth.stage)
    validation.roots = list(truth.roots)
    compare_layers(checks, truth)
    frames = settings.get("frames")
    rest_time = Usd.TimeCode(frames[0]) if frames else Usd.TimeCode.EarliestTime()
    apply_rules(truth.stage, sidecar.get("warnings", ()), rest_time)
    split_skeletons(truth.stage)
    key_ends(truth.stage, frames or ())
    skin_codes = skin_times(truth.stage)
    joints = JointTruth(truth)
    validation.about_stage = {"keyed_skeletons": keyed_skeletons(truth.stage)}
    skinned = bake(truth.stage)
    cages = {warning["prim"] for warning in warnings_of(sidecar, "subdivision-cage")}
    reader = TruthReader(truth, frozenset(cages), skinned | moving_points(truth.stage))
    rest = reader.scene(rest_time)
    checks.made_of = rest.made_of
    output = OutputReader(file, reader.instancers)
    stored = output.scene(None)
    compare_ops(checks, missing_ops, stored.matrices)
    comparer = SceneComparer(checks, rest, skinned)
    comparer.geometry(rest, stored)
    comparer.other(rest, stored)
    comparer.matrices(rest, stored, "at rest")
    comparer.joints(joints.matrices(rest_time), output.joints(output.poser.pose(None)), "at rest")
    comparer.cameras(rest, stored, "at rest")
    comparer.lights(rest, stored, "at rest")
    uses, colored = compare_materials(checks, truth, file, rest)
    compare_unauthored_materials(checks, output, colored)
    compare_mesh_lights(checks, truth, output, rest)
    compare_document(checks, truth, output, rest_time, settings)
    compare_uv_uses(checks, rest, stored, uses, comparer.diagonal)
    _summarize_output(output, stored, checks, validation)
    frozen = frozen_sizes(sidecar.get("warnings", ()))
    validation.times = _compare_moving(
        comparer, reader, output, joints, skin_codes, frames, rest, frozen
    )


def _compare_moving(
    comparer: SceneComparer,
    reader: TruthReader,
    output: OutputReader,
    joints: JointTruth,
    skin_codes: list[float],
    frames: Any,
    rest: Scene,
    frozen: set[str],
) -> int:
    """Compare at keys and between them; returns the number of times."""
    from pxr import Usd

    from .usd_skel import baked_codes
    from .usd_stage import codes_between, codes_in_splines, keyed_only, sample_codes

    truth = reader.truth
    codes = sorted({*sample_codes(truth.stage), *skin_codes})
    between = _within(codes_between(truth.stage, codes, _GEOMETRY_TIMES), frames)
    codes = _within(_told_apart(codes, truth), frames)
    if len(codes) < 2 and not between:
        return 0
    keyed = keyed_only(truth.stage)
    for inner, outermost in reader.outermost.items():
        for key in outermost if inner in keyed.prims else ():
            own = keyed.prims[inner]
            keyed.prims[key] = keyed.prims.get(key, own) & own
    baked = baked_codes(truth.stage, comparer.skinned, skin_codes)
    for code in sorted({*_spread(codes, _GEOMETRY_TIMES), *between}):
        at = f"at time code {code:g}"
        seconds = (code - truth.time_origin) / truth.codes_per_second
        moved, shown = reader.scene(Usd.TimeCode(code)), output.scene(seconds)
        for key in _without_key(keyed.normals, code) & moved.corners.keys():
            moved.corners[key].normals = None
        drawn = moved.corners.keys() | moved.surfaces.keys()
        unsure = keyed.between(code, drawn) | _without_key(baked, code)
        comparer.geometry(moved, shown, unsure)
        comparer.cameras(moved, shown, at)
        comparer.hold_sizes(moved, rest, frozen)
        comparer.lights(moved, shown, at)
    halfway = [(a + b) / 2 for a, b in itertools.pairwise(codes)]
    curved = _spread(_within(codes_in_splines(truth.stage), frames), _MATRIX_TIMES)
    chosen = sorted({*_spread(sorted({*codes, *halfway}), _MATRIX_TIMES), *between, *curved})
    for code in chosen:
        seconds = (code - truth.time_origin) / truth.codes_per_second
        time, pose, at = Usd.TimeCode(code), output.poser.pose(seconds), f"at time code {code:g}"
        expected = reader.matrices(time)
        unsure = keyed.between(code, expected)
        placed = {prim: found for prim, found in expected.items() if prim not in unsure}
        comparer.matrices_of(placed, output.matrices(pose), at)
        comparer.joints(joints.matrices(time), output.joints(pose), at)
    return len(chosen)


def _without_key(keys: dict[str, set[float]], code: float) -> frozenset[str]:
    """Prims that have no key at `code`."""
    return frozenset(prim for prim, own in keys.items() if code not in own)


def _within(codes: list[float], frames: Any) -> list[float]:
    if not frames:
        return codes
    return [code for code in codes if frames[0] <= code <= frames[1]]


def _told_apart(codes: list[float], truth: TruthStage) -> list[float]:
    """Codes whose seconds differ from the next code's in single precision.

    Such a code is the side before a jump (value clips give one), where a file has a ramp of one
    rounding.
    """
    found = codes[-1:]
    for code in reversed(codes[:-1]):
        seconds = (found[-1] - truth.time_origin) / truth.codes_per_second
        step = 4.0 * float(np.spacing(np.float32(abs(seconds)))) * truth.codes_per_second
        if found[-1] - code > step:
            found.append(code)
    return found[::-1]


def _spread(codes: list[float], count: int) -> list[float]:
    """At most `count` of the codes, first and last among them, evenly by position."""
    if len(codes) <= count:
        return codes
    places = np.unique(np.linspace(0, len(codes) - 1, count).round().astype(int))
    return [codes[place] for place in places]


def _second_reader(file: GltfFile, box: tuple[Array, Array], checks: Checks) -> None:
    """Check that trimesh sees the same box, where it knows all extensions that the file uses."""

    used = set(file.gltf.extensionsUsed or [])
    morphs = any(primitive.targets for mesh in file.meshes for primitive in mesh.primitives)
    if "EXT_mesh_gpu_instancing" in used or file.gltf.skins or morphs:
        return
    try:
        seen = _without_cameras(file).bounds
    except Exception as error:  # any error of the foreign reader is its verdict
        checks.add("reader", "/", math.inf, f"trimesh: {type(error).__name__}: {error}")
        return
    if seen is None:
        checks.add("reader", "/", math.inf, "trimesh sees nothing")
        return
    size = float(np.linalg.norm(box[1] - box[0])) or 1.0
    reach = float(np.abs(np.array(box)).max())
    slack = 4 * float(np.finfo(np.float32).eps) * reach / size
    off = float(np.abs(np.array(seen) - np.array(box)).max())
    checks.add("reader", "/", off / size, "trimesh's box", slack)


def _without_cameras(file: GltfFile) -> Any:
    """trimesh's scene of the file; of a node with a camera trimesh would forget the transform."""
    import trimesh

    tree = {name: value for name, value in file.tree.items() if name != "cameras"}
    nodes = [{k: v for k, v in node.items() if k != "camera"} for node in tree.get("nodes", [])]
    if nodes:
        tree["nodes"] = nodes
    data = json.dumps(tree).encode()
    if file.path.suffix.lower() == ".glb":
        data += b" " * (-len(data) % 4)
        whole = file.path.read_bytes()
        rest = whole[20 + int.from_bytes(whole[12:16], "little") :]
        head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(data) + len(rest), len(data), _JSON)
        return trimesh.load_scene(io.BytesIO(head + data + rest), file_type="glb")
    resolver = trimesh.resolvers.FilePathResolver(str(file.path))
    return trimesh.load_scene(io.BytesIO(data), file_type="gltf", resolver=resolver)
