"""Velocities, angular velocities and accelerations, as samples of the values that they move.

Values move from the sample before, and beyond the first and the last one, as
UsdGeomPointBased::ComputePointsAtTime and UsdGeomPointInstancer::ComputeInstanceTransformsAtTime
move them.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from pxr import Usd, Vt

from reflet_usd.stage_files import state_rates

from .context import Context, type_name
from .morph import MAX_POINT_KEYS
from .samples import with_jumps
from .scene import Array

_STEPS = 4
"""Fewest samples of each time code where values turn or accelerate."""
_MOST_STEPS = 64
_MOST_TURN_DEG = 90.0
"""Largest turn from sample to sample, well below half a turn, beyond which it would go back."""
_MOST_WAY = 100.0
"""Largest way of points, in sizes of their shape."""
_MOST = 1e9
"""Largest number of a value, in its own units."""
_OFF_UNIT = 1e-3
"""Largest deviation of a quaternion's length from 1: half floats have less."""
_MOST_KEYS = 6_000
_MOST_VALUES = 4_000_000
_LINEAR, _ANGULAR = ("velocities", "accelerations"), ("angularVelocities", "")
_MOVERS = {
    "points": _LINEAR,
    "positions": _LINEAR,
    "orientationsf": _ANGULAR,
    "orientations": _ANGULAR,
}
_TOGETHER = (*_MOVERS, "scales", "faceVertexCounts", "faceVertexIndices", "curveVertexCounts")
"""Attributes of which USD interpolates none where velocities move another."""


@dataclass
class _Moved:
    """Values (samples, items, components) that move by `rates` and `accelerations`, in seconds."""

    codes: list[float]
    values: Array
    rates: Array
    accelerations: Array | None
    codes_per_second: float

    @property
    def steps(self) -> int:
        """Samples of each time code; 0 where values move evenly."""
        if self.values.shape[2] == 4:
            fastest = float(np.linalg.norm(self.rates, axis=2).max()) / self.codes_per_second
            return max(_STEPS, math.ceil(fastest / _MOST_TURN_DEG))
        return 0 if self.accelerations is None else _STEPS

    def at(self, code: float) -> Array:
        """The values at a time code."""
        sample = max(int(np.searchsorted(self.codes, code, side="right")) - 1, 0)
        seconds = (code - self.codes[sample]) / self.codes_per_second
        values, rates = self.values[sample], self.rates[sample]
        if values.shape[1] == 4:
            return _turned(values, np.radians(rates * seconds))
        if self.accelerations is not None:
            rates = rates + 0.5 * seconds * self.accelerations[sample]
        return np.asarray(values + seconds * rates)

    def keys(self, start: float, end: float) -> list[float]:
        """Time codes between which interpolated values move alike, even shares from each sample.

        Empty where they are too many, or where the stage starts or ends between them.
        """
        beyond = (self.codes[0] - start, end - self.codes[-1])
        if self.steps > _MOST_STEPS or any(way * self.steps % 1.0 for way in beyond):
            return []
        found: list[float] = []
        for first, last in itertools.pairwise([start, *self.codes, end]):
            steps = math.ceil((last - first) * self.steps) if self.steps else int(first < last)
            count = len(found) + steps
            if count > _MOST_KEYS or count * self.values[0].size > _MOST_VALUES:
                return []
            step = 1.0 / self.steps if self.steps else last - first
            found += [first + step * index for index in range(steps)]
        return with_jumps(self.at, [*found, end])

    def deviation(self, keys: list[float]) -> float:
        """Largest distance from a way between two of the keys, as a share of the whole way."""
        if self.accelerations is None:
            return 0.0
        seconds = 1.0 / (_STEPS * self.codes_per_second)
        most = float(np.linalg.norm(self.accelerations, axis=2).max()) * seconds**2 / 8.0
        extent = np.ptp([self.at(code) for code in keys], axis=(0, 1))
        return most / max(float(extent.max()), most, 1e-30)


def sample_velocities(context: Context) -> None:
    """Write, in the session layer, samples of all that moves by velocities for over a time code.

    Prims in prototypes, which that layer does not reach, and shapes that are held from time code
    to time code are left to be interpolated.
    """
    stage = context.stage
    kinds = ("PointInstancer",) if context.options.subdiv_level else ("PointInstancer", "Mesh")
    prims = Usd.PrimRange(stage.GetPseudoRoot())
    moved = [prim for prim in prims if type_name(prim) in kinds and _has_rates(prim)]
    if not moved:
        return
    state_rates(stage)
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for prim in moved:
            _sample(context, prim)


def _has_rates(prim: Usd.Prim) -> bool:
    names = (_LINEAR[0], _ANGULAR[0])
    return any(prim.HasAttribute(n) and prim.GetAttribute(n).GetNumTimeSamples() for n in names)


def _sample(context: Context, prim: Usd.Prim) -> None:
    """Replace the velocities of a prim, unless USD interpolates or holds some of its values."""
    attributes = {name: prim.GetAttribute(name) for name in _TOGETHER if prim.HasAttribute(name)}
    if attributes.get("orientationsf") and attributes["orientationsf"].HasAuthoredValue():
        del attributes["orientations"]
    written: list[tuple[str, list[float], _Moved]] = []
    is_far = False
    for name, attribute in attributes.items():
        moved = _moved(context, prim, attribute) if name in _MOVERS else None
        if moved is None:
            if attribute.ValueMightBeTimeVarying():
                return
            continue
        codes = [*moved.codes, *(code for code in context.stated_codes if code is not None)]
        start, end = min(codes), max(codes)
        gaps = np.diff(moved.codes)
        is_far |= start < moved.codes[0] or moved.codes[-1] < end or bool((gaps > 1.0).any())
        keys = moved.keys(start, end)
        if not keys or (name == "points" and not _fits_targets(moved, keys)):
            return
        written.append((name, keys, moved))
    if not is_far:
        return
    for name, keys, moved in written:
        if name == "orientations":  # of half precision
            name = "orientationsf"
        kind = Vt.QuatfArray if name == "orientationsf" else Vt.Vec3fArray
        for code in keys:
            prim.GetAttribute(name).Set(kind.FromNumpy(moved.at(code).astype(np.float32)), code)
        if moved.accelerations is not None:
            deviation = moved.deviation(keys)
            message = f"accelerated {name} became {len(keys)} samples, at most"
            message += f" {deviation:.1e} of their extent away between them"
            context.ledger.warn("animation-resampled", prim, message, deviation)
    for name in (*_LINEAR, _ANGULAR[0]):
        if prim.HasAttribute(name):
            prim.GetAttribute(name).Block()


def _fits_targets(moved: _Moved, keys: list[float]) -> bool:
    """Whether points may become morph targets: not too many, nor too far for single precision."""
    way = max(float(np.abs(moved.at(code) - moved.values[0]).max()) for code in (keys[0], keys[-1]))
    return len(keys) <= MAX_POINT_KEYS and way <= _MOST_WAY * float(np.ptp(moved.values))


def _moved(context: Context, prim: Usd.Prim, attribute: Usd.Attribute) -> _Moved | None:
    """An attribute with the velocities that move it; None where their samples do not fit."""
    codes = list(attribute.GetTimeSamples())
    mover, accelerator = _MOVERS[attribute.GetName()]
    values, rates = _values(attribute, codes), _values(prim.GetAttribute(mover), codes)
    if not codes or values is None or rates is None or values.shape[:2] != rates.shape[:2]:
        return None
    if values.shape[2] == 4 and (np.abs(np.linalg.norm(values, axis=2) - 1.0) > _OFF_UNIT).any():
        return None
    further = prim.GetAttribute(accelerator) if accelerator else None
    accelerations = None
    if further and further.GetNumTimeSamples():
        accelerations = _values(further, codes)
        if accelerations is None or accelerations.shape != rates.shape:
            return None
    return _Moved(codes, values, rates, accelerations, context.codes_per_second)


def _values(attribute: Usd.Attribute, codes: list[float]) -> Array | None:
    """(samples, items, components) at these codes; None where the attribute has other samples."""
    if not attribute or list(attribute.GetTimeSamples()) != codes:
        return None
    values = [attribute.Get(code) for code in codes]
    kinds = (Vt.Vec3fArray, Vt.QuatfArray, Vt.QuathArray)
    if any(not isinstance(value, kinds) or len(value) != len(values[0]) for value in values):
        return None
    found = np.array(values, dtype=np.float64)
    return found if found.size and (np.abs(found) < _MOST).all() else None


def _turned(rotations: Array, turns: Array) -> Array:
    """Quaternions (items, 4), x y z w, turned further by rotation vectors (items, 3), radians."""
    angles = np.linalg.norm(turns, axis=1, keepdims=True)
    # sin(a / 2) / a, which is 1 / 2 without an angle.
    by = np.concatenate([turns * np.sinc(angles / (2.0 * np.pi)) / 2.0, np.cos(angles / 2.0)], 1)
    v, w, a, b = rotations[:, :3], rotations[:, 3:], by[:, :3], by[:, 3:]
    vectors = b * v + w * a + np.cross(a, v)
    return np.concatenate([vectors, b * w - (a * v).sum(axis=1, keepdims=True)], axis=1)
