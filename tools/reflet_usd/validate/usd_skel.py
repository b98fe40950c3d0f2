"""Owns the truth about skinned prims: UsdSkel's own baking into points, in memory."""

from __future__ import annotations

from pxr import Gf, Usd, UsdSkel


def skin_times(stage: Usd.Stage) -> list[float]:
    """Time codes at which any skeleton animation of the stage has a sample."""
    codes: set[float] = set()
    for prim in _prims(stage):
        if prim.IsA(UsdSkel.Animation):
            for attribute in prim.GetAttributes():
                codes.update(attribute.GetTimeSamples())
    return sorted(codes)


def bake(stage: Usd.Stage) -> frozenset[str]:
    """Replace skinning and blend shapes by points at all times; returns the changed prims.

    Writes into the stage's session layer only. Native instances that hold skeletons are made
    ordinary prims first, because baking cannot edit what is shared; their paths stay.
    """
    roots = [prim for prim in _prims(stage) if prim.IsA(UsdSkel.Root)]
    if not roots:
        return frozenset()
    codes = skin_times(stage)
    interval = Gf.Interval(codes[0], codes[-1]) if codes else Gf.Interval.GetFullInterval()
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for path in [prim.GetPath() for prim in roots]:
            _split_instances(stage, path)
        skinned = _skinned_prims(stage)
        for prim in list(_prims(stage)):
            if prim.IsA(UsdSkel.Root) and not prim.IsInstanceProxy():
                UsdSkel.BakeSkinning(UsdSkel.Root(prim), interval)
    return skinned


def _split_instances(stage: Usd.Stage, path: object) -> None:
    prim = stage.GetPrimAtPath(path)
    while prim and prim.IsInstanceProxy():
        above = prim
        while above and not above.IsInstance():
            above = above.GetParent()
        if not above or above.IsInstanceProxy():
            outer = above.GetParent() if above else None
            while outer and not (outer.IsInstance() and not outer.IsInstanceProxy()):
                outer = outer.GetParent()
            above = outer
        if not above:
            return
        above.SetInstanceable(False)
        prim = stage.GetPrimAtPath(path)


def _skinned_prims(stage: Usd.Stage) -> frozenset[str]:
    cache = UsdSkel.Cache()
    found = set()
    for prim in _prims(stage):
        if prim.IsA(UsdSkel.Root):
            root = UsdSkel.Root(prim)
            cache.Populate(root, Usd.TraverseInstanceProxies())
            for binding in cache.ComputeSkelBindings(root, Usd.TraverseInstanceProxies()):
                for target in binding.GetSkinningTargets():
                    if target.HasJointInfluences() or target.HasBlendShapes():
                        found.add(str(target.GetPrim().GetPath()))
    return frozenset(found)


def _prims(stage: Usd.Stage) -> Usd.PrimRange:
    predicate = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
    return Usd.PrimRange(stage.GetPseudoRoot(), predicate)
