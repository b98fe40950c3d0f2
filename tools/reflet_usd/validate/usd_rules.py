"""Owns the documented rules by which a file follows a stage that glTF cannot repeat.

Each rule is written into the session layer of the opened stage, in memory, so that usd-core
evaluates the value that the file must hold, and nothing has to be excused.
"""

import math
import re
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt

from .usd_skel import split_instances
from .usd_stage import MAX_CODE

_STAYS = re.compile(r"^animated (.+) stay at their first value")
_FROZEN = {
    "camera-animation-frozen",
    "geometry-animation-frozen",
    "instancer-animation-frozen",
    "light-animation-frozen",
    "points-animation-frozen",
    "primvar-animation-frozen",
}
_INSTANCER_PARTS = {
    "translation": ("positions",),
    "rotation": ("orientations", "orientationsf"),
    "scale": ("scales",),
}
_PLACING = ("positions", "orientations", "orientationsf", "scales", "protoIndices")
_VELOCITIES = ("velocities", "angularVelocities", "accelerations")
_NORMALIZED = "instance-rotation-normalized"
_SIZES = "world sizes"
_HELD = "geometry-animation-held"
_SHOWN = re.compile(r"^animated (.+) are shown at (\d+) time codes")
_FAR = 1e9
"""Weight that no animation reaches."""


def apply_rules(stage: Usd.Stage, warnings: Iterable[dict[str, Any]], rest: Usd.TimeCode) -> None:
    """Edit the stage to show what the file must show, by the rules that `warnings` name."""
    chosen = [w for w in warnings if w["name"] in NAMES]
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for warning in chosen:
            if Sdf.Path.IsValidPathString(warning["prim"]):
                split_instances(stage, warning["prim"])
        for warning in chosen:
            prim = _prim(stage, warning["prim"])
            if prim is None or prim.IsInstanceProxy() or prim.IsInPrototype():
                continue
            if warning["name"] == _HELD:
                _hold(stage, prim, warning.get("message", ""))
            elif warning["name"] in _FROZEN:
                _freeze(prim, warning.get("message", ""), rest)
            elif warning["name"] == _NORMALIZED:
                _normalize_instances(prim, warning.get("message", ""))
            else:
                _RULES[warning["name"]](prim)


def frozen_sizes(warnings: Iterable[dict[str, Any]]) -> set[str]:
    """Lights with a warning that they keep the power of their first world size."""
    return {
        warning["prim"]
        for warning in warnings
        if warning["name"] == "light-animation-frozen" and _SIZES in warning.get("message", "")
    }


def _prim(stage: Usd.Stage, path: str) -> Usd.Prim | None:
    prim = stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else None
    return prim if prim and path != "/" else None


def _freeze(prim: Usd.Prim, message: str, rest: Usd.TimeCode) -> None:
    """Freeze the attributes that the message names at their value at rest."""
    match = _STAYS.match(message)
    names = [name.strip() for name in match.group(1).split(",")] if match else []
    if any(name.startswith("points") for name in names):
        names = ["points", "normals", "primvars:normals"]
    if prim.IsA(UsdGeom.PointInstancer):
        parts = [part for name in names for part in _INSTANCER_PARTS.get(name, (name,))]
        # An instancer with a varying number of instances does not move at all.
        names = list(_PLACING) if set(parts) & {"protoIndices", "ids"} else parts
    for name in names:
        attribute = prim.GetAttribute(name)
        value = attribute.Get(rest) if attribute else None
        if value is None and name == "points":  # the stage begins without a value
            samples = (attribute.Get(code) for code in attribute.GetTimeSamples())
            value = next((sample for sample in samples if sample is not None), None)
        if value is not None:
            attribute.Set(value)


def _hold(stage: Usd.Stage, prim: Usd.Prim, message: str) -> None:
    """Hold the attributes that the message names at the time codes at which the file shows them."""
    match = _SHOWN.match(message)
    names = match.group(1).split(", ") if match else []
    varying = [prim.GetAttribute(name) for name in names if prim.HasAttribute(name)]
    codes = {code for attribute in varying for code in attribute.GetTimeSamples()}
    codes = {code for code in codes if abs(code) <= MAX_CODE}
    if not match or len(codes) < 2:
        return
    whole = {float(code) for code in range(math.ceil(min(codes)), math.floor(max(codes)) + 1)}
    # The file says how many there are, of the two ways that the manual gives.
    shown = sorted(codes if len(codes) == int(match.group(2)) else codes | whole)
    for attribute in varying:
        values = [attribute.Get(code) for code in shown]
        for index, value in enumerate(values):
            kept = Sdf.ValueBlock() if value is None else value
            attribute.Set(kept, shown[index])
            if index + 1 < len(shown):
                attribute.Set(kept, float(np.nextafter(shown[index + 1], -np.inf)))


def _times(source: Any) -> list[Usd.TimeCode]:
    """Times of the samples of an attribute or a transform, or the default time without any."""
    return [Usd.TimeCode(code) for code in source.GetTimeSamples()] or [Usd.TimeCode.Default()]


def _values(attribute: Usd.Attribute | None) -> list[tuple[Usd.TimeCode, Any]]:
    """An attribute's values by their times, all read before one is changed; none without it."""
    return [(time, attribute.Get(time)) for time in _times(attribute)] if attribute else []


def _forget_velocities(prim: Usd.Prim) -> None:
    """Remove velocities: the file interpolates points and instances between their keys."""
    for name in _VELOCITIES:
        if prim.HasAttribute(name):
            prim.GetAttribute(name).Block()


def _forget_inbetweens(prim: Usd.Prim) -> None:
    for inbetween in UsdSkel.BlendShape(prim).GetInbetweens():
        inbetween.SetWeight(_FAR)


def _skin_linearly(prim: Usd.Prim) -> None:
    UsdSkel.BindingAPI(prim).GetSkinningMethodAttr().Set(UsdSkel.Tokens.classicLinear)


def _normalize_weights(prim: Usd.Prim) -> None:
    """Normalize weights of existing joints to 1; a point without any follows the first joint."""
    api = UsdSkel.BindingAPI(prim)
    weights, indices = (
        UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(f"skel:joint{name}")
        for name in ("Weights", "Indices")
    )
    raw, numbers = weights.Get(), indices.Get()
    width = max(weights.GetElementSize(), 1)
    if raw is None or numbers is None or len(raw) != len(numbers) or len(raw) % width:
        return
    values: Any = np.array(raw, dtype=np.float64).reshape(-1, width)
    joints: Any = np.array(numbers, dtype=np.int64).reshape(-1, width)
    count = _joint_count(prim)
    outside = (joints < 0) | (joints >= count)
    values = np.where(np.isfinite(values) & (values > 0.0) & ~outside, values, 0.0)
    totals = values.sum(axis=1, keepdims=True)
    values = np.divide(values, totals, out=values, where=totals > 0.0)
    values[totals[:, 0] <= 0.0, 0] = 1.0
    joints = np.where(outside, 0, joints)
    constant = weights.GetInterpolation() == UsdGeom.Tokens.constant
    api.CreateJointWeightsPrimvar(constant, width).Set(
        Vt.FloatArray.FromNumpy(values.astype(np.float32).reshape(-1))
    )
    api.CreateJointIndicesPrimvar(constant, width).Set(
        Vt.IntArray.FromNumpy(joints.astype(np.int32).reshape(-1))
    )


def _joint_count(prim: Usd.Prim) -> int:
    own = UsdSkel.BindingAPI(prim).GetJointsAttr().Get()
    if own:
        return len(own)
    skeleton = UsdSkel.BindingAPI(prim).GetInheritedSkeleton()
    names = skeleton.GetJointsAttr().Get() if skeleton else None
    return len(names or ())


def _normalize_rotations(prim: Usd.Prim) -> None:
    """Normalize the quaternions of the skeleton's animation."""
    source = UsdSkel.BindingAPI(prim).GetInheritedAnimationSource()
    attribute: Any = UsdSkel.Animation(source).GetRotationsAttr() if source else None
    for time, value in _values(attribute):
        if value is not None:
            attribute.Set(Vt.QuatfArray([Gf.Quatf(q).GetNormalized() for q in value]), time)


def _stay_at_rest(prim: Usd.Prim) -> None:
    """Unbind curves and points from joints, which do not move them in the file."""
    indices = prim.GetAttribute("primvars:skel:jointIndices")
    if indices and not prim.IsA(UsdGeom.Mesh):
        indices.Block()


def _finite_weights(prim: Usd.Prim) -> None:
    """Set weights of blend shapes that are not finite to 0."""
    source = UsdSkel.BindingAPI(prim).GetInheritedAnimationSource()
    skeleton = UsdSkel.BindingAPI(prim).GetInheritedSkeleton()
    if not source and skeleton:
        source = UsdSkel.BindingAPI(skeleton.GetPrim()).GetAnimationSource()
    attribute: Any = UsdSkel.Animation(source).GetBlendShapeWeightsAttr() if source else None
    for time, value in _values(attribute):
        values = np.array(value or [], dtype=np.float32)
        usable = np.where(np.isfinite(values), values, np.float32(0.0))
        attribute.Set(Vt.FloatArray.FromNumpy(usable), time)


def _forget_far_samples(prim: Usd.Prim) -> None:
    """Remove time samples beyond the limit."""
    for attribute in prim.GetAuthoredAttributes():
        codes = attribute.GetTimeSamples()
        near = [(code, attribute.Get(code)) for code in codes if abs(code) <= MAX_CODE]
        if 0 < len(near) < len(codes):
            for code, value in near:
                attribute.Set(Sdf.ValueBlock() if value is None else value, code)


def _normalize_instances(prim: Usd.Prim, message: str) -> None:
    """Normalize the quaternions of instances of the prototypes that the warning names."""
    schema = UsdGeom.PointInstancer(prim)
    targets = [str(path) for path in schema.GetPrototypesRel().GetForwardedTargets()]
    named = [index for index, path in enumerate(targets) if f"'{path}'" in message]
    exact, half = schema.GetOrientationsfAttr(), schema.GetOrientationsAttr()
    source = exact if exact.Get(Usd.TimeCode.EarliestTime()) else half
    for time, value in _values(source):
        at = Usd.TimeCode.EarliestTime() if time.IsDefault() else time
        rows = np.array(value, dtype=np.float64).reshape(-1, 4)
        chosen = np.isin(np.array(schema.GetProtoIndicesAttr().Get(at)), named)
        lengths = np.linalg.norm(rows, axis=1, keepdims=True)
        unit = rows / np.where(lengths > 0.0, lengths, 1.0)
        if len(chosen) == len(rows):
            rows = np.where(chosen[:, None], unit, rows)
        exact.Set(Vt.QuatfArray([Gf.Quatf(r[3], *r[:3]) for r in rows.tolist()]), time)


def _without_perspective(prim: Usd.Prim) -> None:
    """The prim's own matrices without a fourth column, w divided out; else the identity."""
    xformable = UsdGeom.Xformable(prim)
    times = _times(xformable)
    matrices = [xformable.GetLocalTransformation(time) for time in times]
    reset = xformable.GetResetXformStack()
    op = xformable.MakeMatrixXform()
    xformable.SetXformOpOrder([op], reset)
    for time, matrix in zip(times, matrices, strict=True):
        op.Set(_affine(matrix), time)


def _affine(matrix: Gf.Matrix4d) -> Gf.Matrix4d:
    values = np.array(matrix, dtype=np.float64)
    w = float(values[3, 3])
    if np.isfinite(w) and w != 0.0:
        values[:, :3] /= w
    values[:, 3] = (0.0, 0.0, 0.0, 1.0)
    if not np.isfinite(values).all() or np.abs(values).max() >= 1e30:
        values = np.eye(4)
    return Gf.Matrix4d(values.tolist())


_RULES: dict[str, Callable[[Usd.Prim], None]] = {
    "inbetween-dropped": _forget_inbetweens,
    "joint-index-out-of-range": _normalize_weights,
    "joint-rotation-normalized": _normalize_rotations,
    "points-non-finite": _finite_weights,
    "skinning-invalid": _stay_at_rest,
    "skinning-dq-as-linear": _skin_linearly,
    "time-sample-dropped": _forget_far_samples,
    "transform-non-finite": _without_perspective,
    "transform-projective": _without_perspective,
    "velocities-dropped": _forget_velocities,
    "weights-normalized": _normalize_weights,
}
NAMES = frozenset({*_FROZEN, *_RULES, _NORMALIZED, _HELD})
"""All warnings that choose a rule."""
