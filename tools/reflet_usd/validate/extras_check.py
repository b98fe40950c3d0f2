"""Owns the check of properties outside all schemas, which nodes keep in their extras."""

import math
import re
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, UsdSkel

from .allowed_deviations import EXTRAS
from .checks import Checks
from .gltf_scene import OutputReader

# Properties that other modules compare: on any prim, and on prims of one type.
_ELSEWHERE = re.compile(
    r"collection:|extent$|extentsHint$|primvars:|material:binding(:|$)"
    r"|skel:(animationSource|blendShapeTargets|blendShapes|joints|skeleton)$"
)
_OF_KINDS = {
    "inputs:": (UsdShade.Shader, UsdShade.NodeGraph),
    "outputs:": (UsdShade.Shader, UsdShade.NodeGraph),
    "info:": (UsdShade.Shader, UsdShade.NodeGraph),
    "inbetweens:": (UsdSkel.BlendShape,),
    "xformOp:": (UsdGeom.Xformable,),
}
_USER = "userProperties"
_MAX_VALUES = 64
_NAMED = 8
"""Maximum number of names that a warning lists; of more it gives the count."""


def compare_extras(
    checks: Checks, stage: Usd.Stage, output: OutputReader, rest: Usd.TimeCode
) -> None:
    """Check that the node of a prim has exactly the prim's custom properties."""
    nodes = output.file.tree.get("nodes", [])
    for index in output.poser.order:
        extras = nodes[index].get("extras") or {}
        path = extras.get("prim")
        if not isinstance(path, str) or path == "/" or not Sdf.Path.IsValidPathString(path):
            continue
        prim = stage.GetPrimAtPath(path)
        if prim:
            _compare_properties(checks, prim, extras, rest)
            _compare_collections(checks, prim, extras.get("collections") or {}, rest)


def _compare_properties(
    checks: Checks, prim: Usd.Prim, extras: dict[str, Any], rest: Usd.TimeCode
) -> None:
    path = str(prim.GetPath())
    kept = {**(extras.get("attributes") or {})}
    kept |= {f"{_USER}:{name}": value for name, value in (extras.get(_USER) or {}).items()}
    expected = _own_properties(prim, rest)
    for name in [name for name, value in expected.items() if value is None]:
        del expected[name]
        kept.pop(name, None)
    compare_kept(checks, path, expected, kept, "", EXTRAS)


def compare_kept(
    checks: Checks,
    path: str,
    expected: dict[str, Any],
    kept: dict[str, Any],
    what: str,
    warnings: tuple[str, ...],
) -> None:
    """Compare values that the file keeps by name; one of `warnings` must name missing ones."""
    for name in sorted(kept.keys() - expected.keys()):
        checks.add("extras", path, 1, f"{what}'{name}' is only in the output")
    missing = sorted(expected.keys() - kept.keys())
    for name in missing:
        told = checks.excuse(path, warnings, named=name if len(missing) <= _NAMED else "")
        text = f"{what}'{name}' is not in the output"
        checks.add("extras", path, 1, text, excuses=(told,) if told else ())
    for name in sorted(expected.keys() & kept.keys()):
        same = is_same(expected[name], kept[name])
        text = f"{what}'{name}' is {kept[name]}, expected {expected[name]}"
        checks.add("extras", path, int(not same), text)


def _compare_collections(
    checks: Checks, prim: Usd.Prim, kept: dict[str, Any], rest: Usd.TimeCode
) -> None:
    """Check that collections in the file equal the stage's."""
    for name, parts in kept.items():
        for part, value in parts.items():
            item = prim.GetProperty(f"collection:{name}:{part}")
            expected = _value(item, rest) if item else None
            if item and expected is None:
                continue
            text = f"collection '{name}', {part}: {value}, expected {expected}"
            checks.add("extras", str(prim.GetPath()), int(not is_same(expected, value)), text)


def _own_properties(prim: Usd.Prim, rest: Usd.TimeCode) -> dict[str, Any]:
    """Authored properties that no schema knows; None for values that are not plain or too long."""
    known = prim.GetPrimDefinition().GetSpecType
    result = {}
    for name in map(str, prim.GetAuthoredPropertyNames()):
        if known(name) != Sdf.SpecTypeUnknown or _ELSEWHERE.match(name):
            continue
        kinds = next((k for start, k in _OF_KINDS.items() if name.startswith(start)), ())
        if any(prim.IsA(kind) for kind in kinds):
            continue
        item = prim.GetProperty(name)
        if isinstance(item, Usd.Relationship) or item.HasAuthoredValue():
            result[name] = _value(item, rest)
    return result


def _value(item: Usd.Property, rest: Usd.TimeCode) -> Any:
    if isinstance(item, Usd.Relationship):
        targets = [str(target) for target in item.GetTargets()]
        return targets if len(targets) <= _MAX_VALUES else None
    return plain(item.Get(rest))


def plain(value: Any) -> Any:
    """A value as JSON has it; None where it is not plain or too long."""
    if isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Sdf.TimeCode):
        return float(value.GetValue())
    if isinstance(value, Sdf.AssetPath):
        return value.path
    if isinstance(value, Sdf.PathExpression):
        return value.GetText()
    if isinstance(value, (Gf.Quath, Gf.Quatf, Gf.Quatd)):
        value = (*value.GetImaginary(), value.GetReal())
    try:
        array = np.array(value)
    except (TypeError, ValueError):
        return None
    plain = array.dtype.kind in "biufUS" and array.size <= _MAX_VALUES
    if not plain or (array.dtype.kind == "f" and not np.isfinite(array).all()):
        return None
    return array.tolist()


def is_same(expected: Any, found: Any) -> bool:
    """Whether two JSON values are equal, numbers to single precision."""
    if isinstance(expected, list) and isinstance(found, list):
        pairs = zip(expected, found, strict=False)
        return len(expected) == len(found) and all(is_same(a, b) for a, b in pairs)
    numbers = isinstance(expected, float) and isinstance(found, (int, float))
    if numbers and not isinstance(found, bool):
        return math.isclose(expected, found, rel_tol=1e-6, abs_tol=1e-12)
    return type(expected) is type(found) and bool(expected == found)
