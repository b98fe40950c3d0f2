"""Tells unreadable values from faults of the converter: only unreadable values excuse a prim."""

from collections.abc import Iterator

from pxr import Sdf, Tf, Usd

# Exceptions raised by reading or using a value of the wrong type.
DAMAGE = (ValueError, TypeError, IndexError, OverflowError, UnicodeDecodeError, Tf.ErrorException)
_MOST_PRIMS = 10_000


def reason_of_damage(prim: Usd.Prim, error: Exception) -> str:
    """Message about the value that damages `prim`; raises `error` if all values can be read."""
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
    """Reason why the attribute's value does not have its type; empty where it does."""
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
    """The prim, its ancestors, its descendants, and the targets of all these."""
    stage, above = prim.GetStage(), prim.GetParent()
    waiting = [prim, *Usd.PrimRange(prim, Usd.TraverseInstanceProxies())]
    while above:
        waiting.append(above)
        above = above.GetParent()
    seen: set[str] = set()
    for other in waiting:  # the list grows during the loop
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
