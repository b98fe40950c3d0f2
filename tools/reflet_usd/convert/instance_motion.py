"""Motion of each instance of a PointInstancer: exact keys, or USD's matrices where they stretch."""

from collections.abc import Iterable
from dataclasses import dataclass

from pxr import Usd, UsdGeom

from .animation import animate_matrix
from .context import Context
from .instancing import unit_quaternions
from .raw_trs import RawTrs
from .samples import seconds_of
from .scene import Array, Node
from .transform_tolerance import Reach, reach_of
from .xform import Trs, align_hemispheres, assign, place

# Matrices that normalization changes by no more than this are equal in single precision.
_NORMALIZED = 1e-6
# Maximum of keys times instances that are followed matrix by matrix; more would take minutes.
MAX_MATRIX_KEYS = 40_000


def warn_normalized(context: Context, prim: Usd.Prim, targets: Iterable[str], off: float) -> None:
    """Warn about prototypes whose instances' quaternions were normalized."""
    message = f"quaternions not of length 1 were normalized, matrices differ by {off:.1e}, "
    message += "for the instances of " + ", ".join(f"'{path}'" for path in targets)
    context.ledger.warn("instance-rotation-normalized", prim, message, off)


@dataclass
class InstanceMotion:
    """The tracks of one instancer, applied instance by instance."""

    context: Context
    prim: Usd.Prim
    raw: RawTrs

    def __post_init__(self) -> None:
        self._reach: Reach | None = None
        self._codes = self.raw.codes()
        off = self.raw.off_unit()
        self._stretched = off > _NORMALIZED
        if int(self._stretched.sum()) * len(self._codes) > MAX_MATRIX_KEYS:
            targets = UsdGeom.PointInstancer(self.prim).GetPrototypesRel().GetForwardedTargets()
            warn_normalized(self.context, self.prim, map(str, targets), float(off.max()))
            self._stretched[:] = False

    def apply(self, instance: Node, number: int) -> Node:
        """Place and animate `instance`, the `number`th of the instancer; returns the outer node."""
        if self._stretched[number]:
            return self._follow(instance, number)
        first = self._codes[0]
        translation, scale = (self.raw.at(p, number, first) for p in ("translation", "scale"))
        rotation = unit_quaternions(self.raw.at("rotation", number, first))[0]
        assign(instance, Trs(translation, rotation, scale))
        for path, (codes, values) in self.raw.tracks.items():
            keys = values[:, number]
            if path == "rotation":
                keys = align_hemispheres(unit_quaternions(keys))
            instance.add_track(path, seconds_of(self.context, codes), keys)
        return instance

    def _follow(self, instance: Node, number: int) -> Node:
        """Animate by keys on the whole matrix, or only the translation; returns the outer node."""
        tracks = self.raw.tracks
        if "rotation" in tracks or "scale" in tracks:
            if self._reach is None:
                above = UsdGeom.Imageable(self.prim).ComputeLocalToWorldTransform(self.context.time)
                self._reach = reach_of(self.context, self.prim, above, own=False)

            def evaluate(code: float) -> Array:
                return self.raw.matrix(number, code)

            return animate_matrix(
                self.context, self.prim, instance, evaluate, self._codes, self._reach
            )
        codes, values = tracks["translation"]
        still = self.raw.matrix(number, codes[0])
        still[:3, 3] = 0.0
        outer = place(instance, still)
        outer.translation = values[0, number]
        outer.add_track("translation", seconds_of(self.context, codes), values[:, number])
        return outer
