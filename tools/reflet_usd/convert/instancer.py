"""PointInstancer: each visible instance as nodes that share meshes, or as GPU instances."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from .animation import set_visibility
from .context import Context, authored, in_float32, source_path, type_name
from .geometry import GeometryBuilder
from .gltf_writer import GltfWriter
from .instance_motion import InstanceMotion, warn_normalized
from .instancing import add_gpu_instances, decompose_many, trs_matrices, unit_quaternions
from .material import DISPLAY, Tint
from .primvars import read_primvar
from .raw_trs import RawTrs, Tracks
from .scene import Array, Node
from .types import ConvertError
from .xform import place

PrototypeNode = Callable[[Usd.Prim], Node]
# More instances of one prototype than this are written as EXT_mesh_gpu_instancing.
MAX_INSTANCE_NODES = 4096
# A shearing instance needs two nodes, which the extension has not; beyond this many, each is
# placed without its shear.
MAX_SHEARED_NODES = 20_000
MAX_NODES = 4_000_000
_FROZEN = ("protoIndices", "ids")
_GROUPS = ("", "Xform", "Scope")


@dataclass
class Instances:
    """The instances of one PointInstancer at one time, masked ones left out."""

    numbers: Array
    """(I,) index into the instancer's arrays."""
    prototypes: Array
    """(I,) index into its prototypes."""
    translations: Array
    quaternions: Array
    """Authored quaternions: half floats are rarely of length 1, and USD does not normalize."""
    scales: Array
    visible_times: Array
    """Seconds of the keys of `visible`, fewer than two where it does not change."""
    visible: Array
    """(keys, I) whether each instance is seen."""

    def changing(self, rows: Array) -> Array:
        """Mask of the given instances that appear or disappear over time."""
        return np.asarray((self.visible[:, rows] != self.visible[:1, rows]).any(axis=0))

    def transforms(self, rows: Array) -> tuple[Array, Array, Array]:
        """Translations, unit quaternions and scales of the given instances."""
        rotations = unit_quaternions(self.quaternions[rows])
        return self.translations[rows], rotations, self.scales[rows]

    def matrices(self, rows: Array) -> Array:
        """USD's own matrices of the given instances, for column vectors."""
        return trs_matrices(self.translations[rows], self.quaternions[rows], self.scales[rows])


class Instancers:
    """All point instancers of one conversion; prototypes are built once and cloned."""

    def __init__(
        self,
        context: Context,
        writer: GltfWriter,
        geometry: GeometryBuilder,
        prototype_node: PrototypeNode,
    ) -> None:
        self.context = context
        self.writer = writer
        self.geometry = geometry
        self._prototype_node = prototype_node
        self._prototypes: dict[str, Node] = {}
        self._open: set[str] = set()
        self._node_count = 0

    def fill(self, prim: Usd.Prim, node: Node) -> None:
        """Add the instances of `prim` below `node`, and account for the prim's children."""
        path = source_path(prim)
        if path in self._open:
            message = "the instancer is part of its own prototype; the inner one is left out"
            self.context.ledger.warn("instancer-cycle", prim, message)
            return
        self._open.add(path)
        try:
            self._fill(prim, node)
        finally:
            self._open.discard(path)

    def _fill(self, prim: Usd.Prim, node: Node) -> None:
        instancer = UsdGeom.PointInstancer(prim)
        targets = instancer.GetPrototypesRel().GetForwardedTargets()
        self.context.ledger.note_instancer(prim)
        self._account_children(prim, [str(path) for path in targets])
        instances = self._read(prim, len(targets))
        if instances is None:
            message = "the instancer that would draw it draws nothing"
            for target in targets:
                child = self.context.stage.GetPrimAtPath(target)
                if child and target.HasPrefix(prim.GetPath()):  # others are drawn in place
                    self.context.ledger.skip_subtree("prototype-unused", child, message)
            return
        self.context.ledger.carry(prim)
        tints = self._tints(prim, instances.numbers)
        self._warn_primvars(prim, () if tints is None else DISPLAY)
        motion = self._motion(prim, instances)
        for index, target in enumerate(targets):
            chosen = np.flatnonzero(instances.prototypes == index)
            prototype_prim = self.context.stage.GetPrimAtPath(target)
            if not prototype_prim:
                message = f"its prototype {target} does not exist"
                self.context.ledger.warn("instancer-invalid", prim, message)
                continue
            if len(chosen) == 0:
                message = "no visible instance uses this prototype"
                self.context.ledger.skip_subtree("prototype-unused", prototype_prim, message)
                continue
            prototype = self._prototype(prototype_prim)
            for tint, rows in _by_tint(tints, chosen):
                shown = prototype if tint is None else self.geometry.tint(prototype, tint)
                moves = motion is not None or instances.changing(rows).any()
                many = len(rows) > MAX_INSTANCE_NODES and not moves
                if not (
                    many and self._add_to_gpu(prim, node, (str(target), shown), instances, rows)
                ):
                    self._add_nodes(prim, node, shown, instances, rows, motion)

    def _prototype(self, prim: Usd.Prim) -> Node:
        path = str(prim.GetPath())
        if path not in self._prototypes:
            self._prototypes[path] = self._prototype_node(prim)
        return self._prototypes[path]

    def _add_to_gpu(
        self,
        prim: Usd.Prim,
        node: Node,
        named: tuple[str, Node],
        instances: Instances,
        chosen: Array,
    ) -> bool:
        path, prototype = named
        exact = decompose_many(instances.matrices(chosen))
        if exact is None and len(chosen) <= MAX_SHEARED_NODES:
            return False
        transforms = exact or instances.transforms(chosen)
        if not add_gpu_instances(self.writer, node, prototype, transforms):
            return False
        if exact is None:
            off = np.abs(instances.matrices(chosen) - trs_matrices(*transforms)).max()
            warn_normalized(self.context, prim, [path], float(off))
        return True

    def _add_nodes(
        self,
        prim: Usd.Prim,
        node: Node,
        prototype: Node,
        instances: Instances,
        chosen: Array,
        motion: InstanceMotion | None,
    ) -> None:
        size = len(prototype.walk())
        self._node_count += size * len(chosen)
        if self._node_count > MAX_NODES:
            message = f"point instancers need more than {MAX_NODES} nodes"
            raise ConvertError("instances-too-many", message, str(prim.GetPath()))
        matrices = instances.matrices(chosen)
        sheared = 0
        for matrix, row in zip(matrices, chosen, strict=True):
            instance = prototype.clone()
            number = int(instances.numbers[row])
            instance.name = f"{prototype.name}_{number}"
            instance.extras = {"instancer": str(prim.GetPath()), "instance": number}
            if instances.changing(np.array([row]))[0]:
                shown = instances.visible[:, row]
                set_visibility(instance, instances.visible_times, shown)
            outer = place(instance, matrix) if motion is None else motion.apply(instance, number)
            sheared += outer is not instance
            node.add(outer)
        if sheared:
            message = f"{sheared} instances shear (quaternions not of length 1), two nodes each"
            self.context.ledger.warn("shear-split", prim, message)

    def _read(self, prim: Usd.Prim, prototype_count: int) -> Instances | None:
        context = self.context
        prototypes = np.array(
            authored(prim, "protoIndices", context.time, []), dtype=np.int64
        ).reshape(-1)
        count = len(prototypes)
        parts = {
            path: _values(context, prim, path, context.time)
            for path in ("translation", "rotation", "scale")
        }
        if count == 0 or len(parts["translation"]) == 0:
            context.ledger.warn("instancer-empty", prim, "the instancer has no instances")
            return None
        for path, neutral in (("rotation", (0.0, 0.0, 0.0, 1.0)), ("scale", (1.0, 1.0, 1.0))):
            if len(parts[path]) == 0:
                parts[path] = np.tile(neutral, (count, 1))
        wrong = [path for path, values in parts.items() if len(values) != count]
        if wrong:
            message = f"{' and '.join(wrong)} values do not fit {count} protoIndices"
            context.ledger.warn("instancer-invalid", prim, message)
            return None
        usable = (prototypes >= 0) & (prototypes < prototype_count)
        for values in parts.values():
            usable &= in_float32(values).all(axis=1)
        if not usable.all():
            message = f"{int((~usable).sum())} instances name no prototype or are not finite"
            context.ledger.warn("instancer-invalid", prim, message)
        codes, masks = self._masks(prim, count)
        usable &= masks.any(axis=0)
        numbers = np.flatnonzero(usable)
        return Instances(
            numbers,
            prototypes[numbers],
            parts["translation"][numbers],
            parts["rotation"][numbers],
            parts["scale"][numbers],
            np.array([context.seconds(code) for code in codes]),
            masks[:, numbers],
        )

    def _motion(self, prim: Usd.Prim, instances: Instances) -> InstanceMotion | None:
        tracks = self._tracks(prim, instances)
        if not tracks:
            return None
        parts = {
            "translation": instances.translations,
            "rotation": instances.quaternions,
            "scale": instances.scales,
        }
        count = int(instances.numbers.max(initial=-1)) + 1
        everything = {}
        for path, rows in parts.items():
            everything[path] = np.zeros((count, rows.shape[1]))
            everything[path][instances.numbers] = rows
        return InstanceMotion(self.context, prim, RawTrs(tracks, everything))

    def _tracks(self, prim: Usd.Prim, instances: Instances) -> Tracks:
        """Key codes and values (keys, instances, components) by glTF path; empty where frozen."""
        context = self.context
        varying = [n for n in _FROZEN if prim.GetAttribute(n).ValueMightBeTimeVarying()]
        tracks: Tracks = {}
        count = int(instances.numbers.max(initial=-1)) + 1
        for path in ("translation", "rotation", "scale"):
            codes = sorted({c for name in _NAMES[path] for c in _samples(prim, name)})
            codes = context.codes_in_range(codes)
            if len(codes) < 2:
                continue
            keys = [_values(context, prim, path, Usd.TimeCode(code)) for code in codes]
            lengths = {len(values) for values in keys}
            if len(lengths) != 1 or min(lengths) < count:
                varying.append(path)
                continue
            stacked = np.array(keys)
            if not in_float32(stacked).all():
                varying.append(path)
                continue
            tracks[path] = (codes, stacked)
        context.ledger.warn_frozen("instancer-animation-frozen", prim, varying)
        return {} if set(varying) & set(_FROZEN) else tracks

    def _masks(self, prim: Usd.Prim, count: int) -> tuple[list[float], Array]:
        """Codes at which the mask changes, and (codes, count) whether an instance is seen then."""
        instancer, context = UsdGeom.PointInstancer(prim), self.context
        samples = {*_samples(prim, "invisibleIds"), *_samples(prim, "ids")}
        codes = context.codes_in_range(sorted(samples))
        times = [Usd.TimeCode(code) for code in codes] if len(codes) > 1 else [context.time]
        rows = []
        for time in times:
            mask = instancer.ComputeMaskAtTime(time)
            fits = mask is not None and len(mask) == count
            rows.append(np.array(mask, dtype=bool) if fits else np.ones(count, dtype=bool))
        return codes, np.array(rows)

    def _tints(self, prim: Usd.Prim, numbers: Array) -> Array | None:
        """(instances, 4) display color and opacity that vary by instance; NaN where not given."""
        tints = np.full((len(numbers), 4), np.nan)
        for name, columns in zip(DISPLAY, (slice(0, 3), slice(3, 4)), strict=True):
            primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar(name)
            if not primvar or primvar.GetInterpolation() not in _BY_INSTANCE:
                continue
            read = read_primvar(self.context, prim, primvar)
            values = np.zeros((0, 0)) if read is None else read.flat()
            if values.shape[1] != columns.stop - columns.start or len(values) <= numbers.max(
                initial=-1
            ):
                message = f"'{name}' has {len(values)} values, which do not fit the instances"
                self.context.ledger.warn("primvar-size-wrong", prim, message)
                continue
            tints[:, columns] = np.clip(values[numbers], 0.0, 1.0)
            if primvar.ValueMightBeTimeVarying():
                names = [str(primvar.GetName())]
                self.context.ledger.warn_frozen("primvar-animation-frozen", prim, names)
        if len(np.unique(tints, axis=0)) > MAX_INSTANCE_NODES:
            return None
        return tints

    def _warn_primvars(self, prim: Usd.Prim, carried: tuple[str, ...]) -> None:
        for primvar in UsdGeom.PrimvarsAPI(prim).GetPrimvarsWithValues():
            interpolation = primvar.GetInterpolation()
            if interpolation in _BY_INSTANCE and str(primvar.GetPrimvarName()) in carried:
                continue
            if interpolation != UsdGeom.Tokens.constant:
                message = f"primvar '{primvar.GetPrimvarName()}' varies by instance"
                self.context.ledger.warn("instance-primvar-dropped", prim, message)
        velocities = prim.GetAttribute("velocities")
        if velocities.HasAuthoredValue():
            message = "velocities are not carried, positions are interpolated"
            self.context.ledger.warn("velocities-dropped", prim, message)

    def _account_children(self, prim: Usd.Prim, targets: list[str]) -> None:
        """Account for groups between the instancer and its prototypes; their contents stand in."""
        predicate = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
        prims = Usd.PrimRange(prim, predicate)
        iterator = iter(prims)
        for child in iterator:
            if str(child.GetPath()) in targets:
                iterator.PruneChildren()
            elif child != prim and type_name(child) in _GROUPS:
                self.context.ledger.carry(child)


def _by_tint(tints: Array | None, chosen: Array) -> list[tuple[Tint | None, Array]]:
    """The chosen instances by their tints, in the order of each tint's first instance."""
    if tints is None or np.isnan(tints[chosen]).all():
        return [(None, chosen)]
    rows = np.where(np.isnan(tints[chosen]), -1.0, tints[chosen])
    values, firsts, which = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(firsts)
    return [
        (tuple(None if v < 0 else v for v in values[i].tolist()), chosen[which.reshape(-1) == i])
        for i in order
    ]


_BY_INSTANCE = ("varying", "vertex", "faceVarying")
_NAMES = {
    "translation": ("positions",),
    "rotation": ("orientationsf", "orientations"),
    "scale": ("scales",),
}


def _samples(prim: Usd.Prim, name: str) -> list[float]:
    attribute = prim.GetAttribute(name)
    return list(attribute.GetTimeSamples()) if attribute else []


def _values(context: Context, prim: Usd.Prim, path: str, time: Usd.TimeCode) -> Array:
    """Translations in meters, quaternions (x, y, z, w) as authored, or scales; may be empty."""
    for name in _NAMES[path]:
        value = authored(prim, name, time, None)
        if value is None or len(value) == 0:
            continue
        if path == "rotation":
            return np.array(value, dtype=np.float64).reshape(-1, 4)
        values = np.array(value, dtype=np.float64).reshape(-1, 3)
        return values * context.meters_per_unit if path == "translation" else values
    return np.zeros((0, 3))
