"""Number of prims in a composed stage, instances multiplied, without walking the instances."""

import graphlib

from pxr import Usd

from .types import ConvertError

# Nested instances multiply: a few lines of text can stand for any number of prims.
MAX_PRIMS = 1_000_000


def check_prim_count(stage: Usd.Stage) -> None:
    """Raise `too-many-prims` where the stage has more than `MAX_PRIMS`, instances' prims too."""
    count = _count(stage)
    if count > MAX_PRIMS:
        shown = f"{count}" if count < 10**12 else f"about 1e{len(str(count)) - 1}"
        message = f"the composed stage has {shown} prims with its instances, more than {MAX_PRIMS}"
        raise ConvertError("too-many-prims", message, stage.GetRootLayer().identifier)


def _count(stage: Usd.Stage) -> int:
    """Number of prims below the root; every prototype is walked once, the inner ones first."""
    own: dict[str, int] = {}
    inner: dict[str, list[str]] = {}
    for root in (*stage.GetPrototypes(), stage.GetPseudoRoot()):
        path = str(root.GetPath())
        own[path], inner[path] = -1, []  # -1: instances stand for the root
        for prim in Usd.PrimRange(root):
            own[path] += 1
            if prim.IsInstance():
                inner[path].append(str(prim.GetPrototype().GetPath()))
    counts: dict[str, int] = {}
    for path in graphlib.TopologicalSorter(inner).static_order():
        counts[path] = own[path] + sum(counts[other] for other in inner[path])
    return counts["/"]
