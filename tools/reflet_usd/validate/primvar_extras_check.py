"""Owns the check of primvars that are no vertex attributes: kept in extras, or named as lost."""

from typing import Any

from pxr import Sdf, Usd, UsdGeom

from .allowed_deviations import LEFT_OUT, UV_SET
from .checks import Checks
from .extras_check import compare_kept, plain
from .gltf_scene import OutputReader
from .usd_primvars import HANDLED, carried

PLACELESS = ("Material", "Shader", "NodeGraph", "GeomSubset", "SkelAnimation", "BlendShape")
_SKELETAL = "skel:"


def compare_primvar_extras(
    checks: Checks, stage: Usd.Stage, output: OutputReader, rest: Usd.TimeCode
) -> None:
    """Compare the primvars in nodes' extras; warnings must name all of prims without a node."""
    nodes, meshes = output.file.tree.get("nodes", []), output.file.tree.get("meshes", [])
    seen: set[tuple[str, int | None, str]] = set()
    for index in output.poser.order:
        extras = nodes[index].get("extras") or {}
        path, mesh = str(extras.get("prim")), nodes[index].get("mesh")
        kept = extras.get("primvars") or {}
        entry = (path, mesh, repr(kept))
        if entry in seen or not Sdf.Path.IsValidPathString(path) or path == "/":
            continue
        seen.add(entry)
        prim = stage.GetPrimAtPath(path)
        if not prim or (prim.IsA(UsdGeom.Gprim) and mesh is None):
            continue
        expected = _of_gprim(prim, rest) if prim.IsA(UsdGeom.Gprim) else _own(prim, rest)
        compare_kept(checks, path, expected, kept, "the primvar ", UV_SET)
        if mesh is not None:
            _compare_names(checks, prim, meshes[mesh])
    _compare_placeless(checks, stage, rest)


def _of_gprim(prim: Usd.Prim, rest: Usd.TimeCode) -> dict[str, Any]:
    """Primvars that reach a gprim and are no attributes; None where not plain or not one value."""
    attributes = {entry.name for entry in carried(prim)}
    found = UsdGeom.PrimvarsAPI(prim).FindPrimvarsWithInheritance()
    return {
        name: _value(primvar, rest)
        for primvar in found
        if (name := str(primvar.GetPrimvarName())) not in {*HANDLED, *attributes}
        and not name.startswith(_SKELETAL)
        and primvar.HasValue()
    }


def _own(prim: Usd.Prim, rest: Usd.TimeCode) -> dict[str, Any]:
    """Primvars of a prim that draws nothing; warnings name varying primvars of an instancer."""
    instancer = prim.IsA(UsdGeom.PointInstancer)
    return {
        name: _value(primvar, rest)
        for primvar in UsdGeom.PrimvarsAPI(prim).GetPrimvarsWithValues()
        if not (name := str(primvar.GetPrimvarName())).startswith(_SKELETAL)
        and not (instancer and primvar.GetInterpolation() != UsdGeom.Tokens.constant)
    }


def _value(primvar: UsdGeom.Primvar, rest: Usd.TimeCode) -> Any:
    constant = primvar.GetInterpolation() == UsdGeom.Tokens.constant
    return plain(primvar.ComputeFlattened(rest)) if constant else None


def _compare_names(checks: Checks, prim: Usd.Prim, mesh: dict[str, Any]) -> None:
    """Check that a mesh names the primvar of each attribute that is not simply named after it."""
    there = {name for primitive in mesh["primitives"] for name in primitive["attributes"]}
    expected = {
        entry.attribute: entry.name
        for entry in carried(prim)
        if entry.attribute in there and entry.attribute != f"_{entry.name.upper()}"
    }
    kept = (mesh.get("extras") or {}).get("primvarOf") or {}
    text = f"primvarOf is {kept}, expected {expected}"
    checks.add("extras", str(prim.GetPath()), int(kept != expected), text)


def _compare_placeless(checks: Checks, stage: Usd.Stage, rest: Usd.TimeCode) -> None:
    """Check that warnings name all primvars of prims without a node, which keep none."""
    prims = iter(Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()))
    for prim in prims:
        path = str(prim.GetPath())
        left_out = any(checks.excuse(path, (name,)) for name in LEFT_OUT)
        if left_out or prim.IsA(UsdGeom.PointInstancer):
            prims.PruneChildren()
        elif prim.GetTypeName() in PLACELESS:
            compare_kept(checks, path, _own(prim, rest), {}, "the primvar ", UV_SET)
