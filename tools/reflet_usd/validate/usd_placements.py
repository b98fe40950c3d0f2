"""Owns the truth's placements: the prims that a stage draws, where, and how often."""

import dataclasses
from collections.abc import Iterator

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdLux

from .scene_data import Array
from .usd_primvars import first_moved, flattened

Tint = tuple[Array | None, ...]
_IDENTITY = Gf.Matrix4d(1.0)
_PLACING = ("positions", "orientations", "orientationsf", "scales", "protoIndices")


@dataclasses.dataclass
class Placement:
    """One drawn prim at one place."""

    prim: Usd.Prim
    key: str
    """Path under which the prim is compared: its own, or the outermost instancer's."""
    matrix: Gf.Matrix4d
    """Matrix from local space to the stage's world."""
    tint: Tint = (None, None)
    """Display color (3,) and opacity (1,) that its instance gives."""


class PlacementWalk:
    """Enumerates what a stage draws at one time, as usd-core evaluates it."""

    def __init__(self, stage: Usd.Stage, time: Usd.TimeCode, purposes: tuple[str, ...]) -> None:
        self.stage = stage
        self.time = time
        self.purposes = purposes
        self.xforms = UsdGeom.XformCache(time)
        self.instancers: list[str] = []
        """Paths of the outermost instancers, hidden or not."""
        self.outermost: dict[str, set[str]] = {}
        """Outermost instancers around an instancer that is in another's prototype, by its path."""
        self._open: set[str] = set()
        self.not_finite: set[str] = set()
        """Instancers with instances whose transforms are not finite."""
        self.cyclic: set[str] = set()
        """Instancers that are part of their own prototypes."""
        self.skipped: dict[str, str] = {}
        """Left out drawable prims by path, with the reason: `invisible`, or their purpose."""

    def placements(self) -> Iterator[Placement]:
        """Every drawn prim at each place: proxies of native instances, instances of instancers."""
        prims = iter(
            Usd.PrimRange(
                self.stage.GetPseudoRoot(),
                Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate),
            )
        )
        for prim in prims:
            if is_other_level(prim):
                prims.PruneChildren()
                continue
            if prim.IsA(UsdGeom.PointInstancer):
                prims.PruneChildren()
                path = str(prim.GetPath())
                # A prim that is hidden now also counts, for it may be shown at another time.
                self.instancers.append(path)
                self._note_nested(prim, path, {path})
                if self._drawn(prim):
                    world = self.xforms.GetLocalToWorldTransform(prim)
                    yield from self._instances(prim, path, world)
            elif self._is_relevant(prim) and self._drawn(prim):
                world = self.xforms.GetLocalToWorldTransform(prim)
                yield Placement(prim, str(prim.GetPath()), world)

    def _is_relevant(self, prim: Usd.Prim) -> bool:
        return prim.IsA(UsdGeom.Gprim) or prim.IsA(UsdGeom.Camera) or is_light(prim)

    def _drawn(self, prim: Usd.Prim) -> bool:
        """Whether visibility and purpose keep the prim; notes the reason where they do not."""
        imageable = UsdGeom.Imageable(prim)
        reason = None
        if not imageable:
            return True
        if imageable.ComputeVisibility(self.time) == UsdGeom.Tokens.invisible:
            reason = "invisible"
        elif not self._has_purpose(prim):
            reason = str(imageable.ComputePurpose())
        if reason:
            self.skipped[str(prim.GetPath())] = reason
        return reason is None

    def _has_purpose(self, prim: Usd.Prim) -> bool:
        """Whether the prim's purpose is kept; lights and cameras always are, as in Hydra."""
        if not (prim.IsA(UsdGeom.Gprim) or prim.IsA(UsdGeom.PointInstancer)):
            return True
        return UsdGeom.Imageable(prim).ComputePurpose() in self.purposes

    def _note_nested(self, instancer: Usd.Prim, key: str, seen: set[str]) -> None:
        """Note the instancers within the prototypes of an instancer, hidden or not."""
        predicate = Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsLoaded)
        for target in UsdGeom.PointInstancer(instancer).GetPrototypesRel().GetForwardedTargets():
            root = self.stage.GetPrimAtPath(target)
            for prim in Usd.PrimRange(root, predicate) if root else ():
                path = str(prim.GetPath())
                if path not in seen and prim.IsA(UsdGeom.PointInstancer):
                    seen.add(path)
                    self.outermost.setdefault(path, set()).add(key)
                    self._note_nested(prim, key, seen)

    def _instances(
        self, instancer: Usd.Prim, key: str, world: Gf.Matrix4d, outer: Tint = (None, None)
    ) -> Iterator[Placement]:
        own = str(instancer.GetPath())
        if own in self._open:
            self.cyclic.add(own)  # the inner one is left out, as documented
            return
        self._open.add(own)
        yield from self._placed(instancer, key, world, outer)
        self._open.discard(own)

    def _placed(
        self, instancer: Usd.Prim, key: str, world: Gf.Matrix4d, outer: Tint
    ) -> Iterator[Placement]:
        schema = UsdGeom.PointInstancer(instancer)
        targets = schema.GetPrototypesRel().GetForwardedTargets()
        indices = np.asarray(schema.GetProtoIndicesAttr().Get(self.time) or [], dtype=np.int64)
        time = self._instancer_time(schema)
        transforms = schema.ComputeInstanceTransformsAtTime(
            time,
            time,
            # One index without a prototype would leave nothing of all instances, so it is excluded.
            UsdGeom.PointInstancer.ExcludeProtoXform,
            UsdGeom.PointInstancer.IgnoreMask,
        )
        if len(transforms) != len(indices):
            return
        mask = schema.ComputeMaskAtTime(self.time)
        prototypes = {
            index: self.stage.GetPrimAtPath(target)
            for index, target in enumerate(targets)
            if index in indices
        }
        parts = {index: list(self._prototype_parts(p)) for index, p in prototypes.items()}
        own = {
            index: UsdGeom.Xformable(prim).GetLocalTransformation(time)
            for index, prim in prototypes.items()
            if UsdGeom.Xformable(prim)
        }
        tints = [
            by_instance(instancer, name, self.time, width, len(indices))
            for name, width in (("displayColor", 3), ("displayOpacity", 1))
        ]
        for number, (index, transform) in enumerate(zip(indices, transforms, strict=True)):
            if len(mask) and not mask[number]:
                continue
            if not 0 <= index < len(targets) or not _fits_float32(transform):
                self.not_finite.add(str(instancer.GetPath()))
                continue
            for prim, relative, reset in parts.get(int(index), ()):
                # A reset stack drops the prototype's transforms above, not the instance's (Hydra).
                root = _IDENTITY if reset else own.get(int(index), _IDENTITY)
                place = relative * root * transform * world
                pairs = zip(tints, outer, strict=True)
                tint = tuple(above if own is None else own[number] for own, above in pairs)
                if prim.IsA(UsdGeom.PointInstancer):
                    yield from self._instances(prim, key, place, tint)
                else:
                    yield Placement(prim, key, place, tint)

    def _instancer_time(self, schema: UsdGeom.PointInstancer) -> Usd.TimeCode:
        """A numeric time for the earliest: velocities would reach back to minus infinity."""
        if not self.time.IsEarliestTime():
            return self.time
        prim = schema.GetPrim()
        if moved := first_moved(prim, _PLACING):
            return moved
        samples = [prim.GetAttribute(name).GetTimeSamples() for name in _PLACING]
        first = min((codes[0] for codes in samples if codes), default=None)
        return Usd.TimeCode.Default() if first is None else Usd.TimeCode(first)

    def _prototype_parts(self, root: Usd.Prim) -> Iterator[tuple[Usd.Prim, Gf.Matrix4d, bool]]:
        """Drawn prims below a prototype, their transforms to its root, whether that is reset."""
        if not root:
            return
        # Prototypes are often overs or classes, so they need not be defined.
        predicate = Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsLoaded)
        prims = iter(Usd.PrimRange(root, predicate))
        for prim in prims:
            imageable = UsdGeom.Imageable(prim)
            if is_other_level(prim) or (imageable and self._is_invisible(imageable)):
                prims.PruneChildren()
                continue
            nested = prim.IsA(UsdGeom.PointInstancer)
            if nested:
                prims.PruneChildren()
            if (nested or self._is_relevant(prim)) and self._has_purpose(prim):
                yield prim, *self.xforms.ComputeRelativeTransform(prim, root)

    def _is_invisible(self, imageable: UsdGeom.Imageable) -> bool:
        value = imageable.GetVisibilityAttr().Get(self.time)
        return bool(value == UsdGeom.Tokens.invisible)


def is_other_level(prim: Usd.Prim) -> bool:
    """Whether the prim is a level of detail (UsdLod) that is not drawn."""
    root = prim.GetParent()
    if not root or not {"LODRootAPI"} & set(root.GetAppliedSchemas()):
        return False
    levels = [child for child in root.GetAllChildren() if UsdGeom.Imageable(child)]
    chosen, above = 0, root
    while above and not above.IsPseudoRoot():
        mode = above.GetAttribute("lod:override:mode")
        said = mode.Get(Usd.TimeCode.EarliestTime()) if mode else None
        if said in ("allLOD", "noLOD"):
            return said == "noLOD" and prim in levels
        if said == "indexedLOD":
            chosen = round(above.GetAttribute("lod:override:index").Get() or 0.0)
        if said in ("indexedLOD", "noOverride"):
            break
        above = above.GetParent()
    return prim in levels and levels[int(np.clip(chosen, 0, len(levels) - 1))] != prim


def by_instance(
    instancer: Usd.Prim, name: str, time: Usd.TimeCode, width: int, count: int
) -> Array | None:
    """A primvar's values (instances, width); None where it does not vary by instance."""
    primvar = UsdGeom.PrimvarsAPI(instancer).GetPrimvar(name)
    if not primvar or primvar.GetInterpolation() not in ("vertex", "varying", "faceVarying"):
        return None
    values = flattened(primvar, time, width)
    return values.reshape(len(values), -1) if len(values) >= count else None


def is_light(prim: Usd.Prim) -> bool:
    """Whether the prim is a light of UsdLux (any schema that includes LightAPI)."""
    return prim.HasAPI(UsdLux.LightAPI) or prim.IsA(UsdLux.BoundableLightBase)


def _fits_float32(matrix: Gf.Matrix4d) -> bool:
    values = np.abs(np.array(matrix))
    return bool((values <= float(np.finfo(np.float32).max)).all())
