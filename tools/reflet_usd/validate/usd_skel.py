"""Owns the truth about skinned prims: UsdSkel's own baking into points, in memory."""

from collections.abc import Iterable

from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel

from .scene_data import Array
from .usd_stage import TruthStage


def skin_times(stage: Usd.Stage) -> list[float]:
    """Time codes at which any skeleton animation of the stage has a sample."""
    codes: set[float] = set()
    for prim in _prims(stage):
        if prim.IsA(UsdSkel.Animation):
            for attribute in prim.GetAttributes():
                codes.update(attribute.GetTimeSamples())
    return sorted(codes)


class JointTruth:
    """World matrices of joints by UsdSkel's own evaluation, at any time, keys or not.

    Must be made before `bake`, which removes the bindings.
    """

    def __init__(self, truth: TruthStage) -> None:
        self._truth = truth
        self._cache = UsdSkel.Cache()
        self._queries: dict[str, UsdSkel.SkeletonQuery] = {}
        self._scale_keys: dict[str, list[float]] = {}
        prims = iter(_prims(truth.stage))
        for prim in prims:
            if prim.IsA(UsdGeom.PointInstancer):
                prims.PruneChildren()
            elif prim.IsA(UsdSkel.Root):
                self._cache.Populate(UsdSkel.Root(prim), Usd.TraverseInstanceProxies())
            elif prim.IsA(UsdSkel.Skeleton):
                query = self._cache.GetSkelQuery(UsdSkel.Skeleton(prim))
                if query and len(query.GetJointOrder()):
                    self._queries[str(prim.GetPath())] = query
                    self._scale_keys[str(prim.GetPath())] = _scale_keys(query)

    def matrices(self, time: Usd.TimeCode) -> dict[str, dict[str, Array]]:
        """World matrices by skeleton and joint; skeletons that USD cannot pose are left out.

        Skeletons with moving scales are left out between the keys of these scales: USD rounds
        interpolated scales to half floats.
        """
        xforms = UsdGeom.XformCache(time)
        result: dict[str, dict[str, Array]] = {}
        for path, query in self._queries.items():
            keys = self._scale_keys[path]
            inside = keys and not time.IsEarliestTime() and keys[0] < time.GetValue() < keys[-1]
            if inside and time.GetValue() not in keys:
                continue
            world = xforms.GetLocalToWorldTransform(self._truth.stage.GetPrimAtPath(path))
            names = [str(name) for name in query.GetJointOrder()]
            poses = query.ComputeJointSkelTransforms(time)
            result[path] = {
                name: self._truth.node_world(pose * world)
                for name, pose in zip(names, poses, strict=False)
            }
        return result


def _scale_keys(query: UsdSkel.SkeletonQuery) -> list[float]:
    animation = query.GetAnimQuery()
    if not animation:
        return []
    attribute = UsdSkel.Animation(animation.GetPrim()).GetScalesAttr()
    codes = list(attribute.GetTimeSamples())
    still = all(attribute.Get(code) == attribute.Get(codes[0]) for code in codes)
    return [] if still else codes


def keyed_skeletons(stage: Usd.Stage) -> int:
    """Number of SkelAnimation prims with two time samples or more of any attribute."""
    return sum(
        any(attribute.GetNumTimeSamples() > 1 for attribute in prim.GetAttributes())
        for prim in _prims(stage)
        if prim.IsA(UsdSkel.Animation)
    )


def moving_points(stage: Usd.Stage) -> frozenset[str]:
    """Prims whose own points have values over time."""
    return frozenset(
        str(prim.GetPath())
        for prim in _prims(stage)
        if prim.IsA(UsdGeom.PointBased)
        and UsdGeom.PointBased(prim).GetPointsAttr().ValueMightBeTimeVarying()
    )


def bake(stage: Usd.Stage) -> frozenset[str]:
    """Replace skinning and blend shapes by points at all times.

    Returns the changed prims.

    Writes into the stage's session layer only.
    """
    if not any(prim.IsA(UsdSkel.Root) for prim in _prims(stage)):
        return frozenset()
    codes = skin_times(stage)
    interval = Gf.Interval(codes[0], codes[-1]) if codes else Gf.Interval.GetFullInterval()
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        skinned = _skinned_prims(stage)
        for prim in list(_prims(stage)):
            if prim.IsA(UsdSkel.Root) and not prim.IsInstanceProxy():
                UsdSkel.BakeSkinning(UsdSkel.Root(prim), interval)
    return skinned


def split_instances(stage: Usd.Stage, path: object) -> None:
    """Turn the native instances around a prim into ordinary prims, in the edit target."""
    prim = stage.GetPrimAtPath(path)
    while prim and prim.IsInstanceProxy():
        above = map(stage.GetPrimAtPath, prim.GetPath().GetPrefixes())
        next(each for each in above if each.IsInstance()).SetInstanceable(False)
        prim = stage.GetPrimAtPath(path)


def key_ends(stage: Usd.Stage, frames: Iterable[float]) -> None:
    """Add keys to skeleton animations at the ends of a range, as the converter does, in memory."""
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for prim in [prim for prim in _prims(stage) if prim.IsA(UsdSkel.Animation)]:
            for attribute in () if prim.IsInstanceProxy() else prim.GetAttributes():
                codes = attribute.GetTimeSamples()
                ends = [code for code in frames if len(codes) > 1 and codes[0] < code < codes[-1]]
                keys = [(code, attribute.Get(code)) for code in sorted({*codes, *ends})]
                for code, value in keys if ends else ():
                    attribute.Set(Sdf.ValueBlock() if value is None else value, code)


def split_skeletons(stage: Usd.Stage) -> None:
    """Turn native instances that hold skeletons into ordinary prims, in the session layer.

    Baking cannot edit shared prototypes. The prim paths stay the same.
    """
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for path in [prim.GetPath() for prim in _prims(stage) if prim.IsA(UsdSkel.Root)]:
            split_instances(stage, path)
            _split_below(stage, path)


def baked_codes(
    stage: Usd.Stage, skinned: Iterable[str], keys: Iterable[float]
) -> dict[str, set[float]]:
    """The codes at which baked prims are exact: codes of their points, else of their matrices.

    Only the animations' own `keys` count: between them USD rounds scales to half floats.
    """
    authored = set(keys)
    found: dict[str, set[float]] = {}
    for path in skinned:
        points = UsdGeom.PointBased(stage.GetPrimAtPath(path))
        for codes in (points.GetPointsAttr().GetTimeSamples(), points.GetTimeSamples()):
            if len(codes) > 1:
                found.setdefault(path, authored & set(codes))
    return found


def _split_below(stage: Usd.Stage, path: object) -> None:
    """Turn the prim and all native instances below it into ordinary prims, in the edit target."""
    while True:
        prims = Usd.PrimRange(stage.GetPrimAtPath(path), Usd.PrimDefaultPredicate)
        found = [prim for prim in prims if prim.IsInstance()]
        for prim in found:
            prim.SetInstanceable(False)
        if not found:
            return


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
