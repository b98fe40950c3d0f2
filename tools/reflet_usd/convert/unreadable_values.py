"""Tells values that cannot be read from faults of the converter: only the first excuse a prim."""

from __future__ import annotations

from collections.abc import Iterator

from pxr import Sdf, Tf, Usd

# What reading or using a value of the wrong type raises.
DAMAGE = (ValueError, TypeError, IndexError, OverflowError, UnicodeDecodeError, Tf.ErrorException)
_MOST_PRIMS = 10_000


def reason_of_damage(prim: Usd.Prim, error: Exception) -> str:
    """Which value of `prim`, or of what it reads, cannot be read; raises `error` if all can."""
    if isinstance(error, (Tf.ErrorException, UnicodeDecodeError)):
        return "USD cannot read the file's bytes"
    for other in _read_by(prim):
        for attribute in other.GetAuthoredAttributes():
            reason = _reason(attribute)
            if reason:
                place = "" if other == prim else f" of {other.GetPath()}"
                return f"'{attribute.GetName()}'{place} {reason}"
    raise error


def _reason(attribute: Usd.Attribute) -> str:
    """Why the attribute's value is none of its type; empty where it is one."""
    try:
        value = attribute.Get(Usd.TimeCode.EarliestTime())
        declared = attribute.GetTypeName().type.pythonClass
    except DAMAGE:
        return "cannot be read"
    if value is None or isinstance(value, Sdf.ValueBlock):
        return ""
    spec = attribute.GetPrim().GetPrimDefinition().GetSchemaAttributeSpec(attribute.GetName())
    if spec:
        declared = spec.typeName.type.pythonClass
    if declared is None or isinstance(value, declared):
        return ""
    return f"holds a {type(value).__name__}, expected a {declared.__name__}"


def _read_by(prim: Usd.Prim) -> Iterator[Usd.Prim]:
    """The prim, what inherits to it, what is below it, and what any of these point to."""
    stage, above = prim.GetStage(), prim.GetParent()
    waiting = [prim, *Usd.PrimRange(prim, Usd.TraverseInstanceProxies())]
    while above:
        waiting.append(above)
        above = above.GetParent()
    seen: set[str] = set()
    for other in waiting:  # grows while it is walked
        path = str(other.GetPath())
        if path in seen or len(seen) > _MOST_PRIMS:
            continue
        seen.add(path)
        yield other
        targets = [t for relation in other.GetRelationships() for t in relation.GetTargets()]
        for attribute in other.GetAuthoredAttributes():
            targets.extend(attribute.GetConnections())
        found = (stage.GetPrimAtPath(target.GetPrimPath()) for target in targets)
        waiting.extend(each for each in found if each)
