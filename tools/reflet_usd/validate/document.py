"""Owns the checks of the whole file: its only animation, its nodes' prims, its lights' range."""

import math
from collections import Counter
from collections.abc import Iterator
from typing import Any

from pxr import Sdf, Usd, UsdGeom

from .allowed_deviations import LEFT_OUT
from .checks import Checks
from .extras_check import compare_extras, is_same
from .gltf_pose import POINTERS
from .gltf_scene import OutputReader
from .primvar_extras_check import PLACELESS, compare_primvar_extras
from .usd_environment import compare_environment
from .usd_stage import TruthStage, may_move, stated_codes


def compare_document(
    checks: Checks,
    truth: TruthStage,
    output: OutputReader,
    rest: Usd.TimeCode,
    settings: dict[str, Any],
) -> None:
    """Compare facts that belong to no single prim; `settings` are the sidecar's."""
    for text in _animation_faults(output, may_move(truth.stage)):
        checks.add("animation", "/", 1, text)
    checks.add("animation", "/", 0)
    for light in output.file.extensions.get("KHR_lights_punctual", {}).get("lights", ()):
        if "range" in light:
            checks.add("lights", "/", math.inf, f"a range of {light['range']} m, USD has none")
    _compare_nodes(checks, truth.stage, output)
    compare_extras(checks, truth.stage, output, rest)
    compare_primvar_extras(checks, truth.stage, output, rest)
    _compare_extras(checks, truth, output, rest, settings)
    compare_environment(checks, truth, output, rest)


def _animation_faults(output: OutputReader, moves: bool) -> Iterator[str]:
    """Faults by which viewers show other motion than the channels that are compared."""
    animations = output.file.tree.get("animations", [])
    if len(animations) > 1:
        yield f"{len(animations)} animations, expected one"
    if animations and not moves:
        yield "an animation of a stage that does not move"
    targets: Counter[tuple[Any, ...]] = Counter()
    for channel in (channel for animation in animations for channel in animation["channels"]):
        target = channel["target"]
        pointer = target.get("extensions", {}).get("KHR_animation_pointer", {}).get("pointer")
        targets[target.get("node"), target.get("path"), pointer] += 1
        if pointer is not None and not POINTERS.fullmatch(pointer):
            yield f"animates {pointer}"
    for (node, path, pointer), count in targets.items():
        if count > 1:
            yield f"{count} channels for {pointer or f'{path} of node {node}'}"


def _compare_nodes(checks: Checks, stage: Usd.Stage, output: OutputReader) -> None:
    """Check that every placed prim has a node, and every prim named by a node is in the stage."""
    named = {output.file.prim_of(output.file.nodes[node]) or "/" for node in output.poser.order}
    for path in sorted(named):
        valid = Sdf.Path.IsValidPathString(path)
        if not valid or not stage.GetPrimAtPath(path):
            checks.add("unexpected", path, 1, "a node for a prim that is not in the stage")
    prims = iter(Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()))
    for prim in prims:
        path = str(prim.GetPath())
        if path == "/":
            continue
        if any(checks.excuse(path, (name,)) for name in LEFT_OUT):
            prims.PruneChildren()
        elif prim.GetTypeName() not in PLACELESS and prim.IsA(UsdGeom.Xformable):
            text = "its node is not in the output"
            checks.add("carried", path, int(path not in named), text, excuses=())
        if prim.IsA(UsdGeom.PointInstancer):
            prims.PruneChildren()


def _compare_extras(
    checks: Checks,
    truth: TruthStage,
    output: OutputReader,
    rest: Usd.TimeCode,
    settings: dict[str, Any],
) -> None:
    """Compare the facts about the stage in the scene's extras; files by others may have none."""
    tree = output.file.tree
    scenes = tree.get("scenes") or [{}]
    told = (scenes[tree.get("scene", 0)].get("extras") or {}).get("usd")
    if not isinstance(told, dict):
        checks.add("extras", "/", int("timeOrigin" in settings), "the scene's are not there")
        return
    start, end = settings.get("frames") or stated_codes(truth.stage)
    expected: dict[str, Any] = {
        "metersPerUnit": truth.meters_per_unit,
        "timeCodesPerSecond": truth.codes_per_second,
        "timeOrigin": truth.time_origin,
        "startTimeCode": start,
        "endTimeCode": end,
        "upAxis": "Z" if truth.z_up else "Y",
    }
    for name in sorted(expected.keys() | told.keys() - {"environment"}):
        same = is_same(expected.get(name), told.get(name))
        text = f"{name} is {told.get(name)}, expected {expected.get(name)}"
        checks.add("extras", "/", int(not same), text)
