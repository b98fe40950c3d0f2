"""Cubic keys that follow a matrix between its samples: few where linear ones are thousands."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .context import Context
from .instancing import trs_matrices
from .samples import is_jump, seconds_of
from .scene import Array, Node
from .transform_tolerance import Reach
from .xform import Trs, assign, nearest_trs

TOLERANCE = 5e-6
"""Maximum deviation of a shown matrix, as a share of the matrix's or the scene's size."""
MAX_DEPTH = 5
# Places in a step where the deviation is measured, and the distance over which slopes are.
_PROBES = np.array([0.15, 0.35, 0.5, 0.65, 0.85])
_SLOPE = 1e-3
# Parts that change by less than this, in value and per second, count as constant.
_STILL = 1e-12
_PARTS = {"translation": slice(0, 3), "rotation": slice(3, 7), "scale": slice(7, 10)}


@dataclass
class SplineKeys:
    """Keys of all ten parts: time codes, and for each the slope in, the value and the slope out."""

    codes: list[float] = field(default_factory=list)
    values: list[Array] = field(default_factory=list)
    """(3, 10): slope in, value, slope out; slopes for each time code."""
    deviation: float = 0.0

    def begin(self, code: float, value: Array) -> None:
        """Add a step's first key, unless it is the last key of the step before."""
        if not self.codes or self.codes[-1] != code:
            self.codes.append(code)
            self.values.append(np.array([np.zeros(10), value, np.zeros(10)]))

    def add(self, code: float, value: Array, out: Array, into: Array) -> None:
        """Add the next key, with the slopes at both ends of the step to it."""
        self.values[-1][2] = out
        self.codes.append(code)
        self.values.append(np.array([into, value, np.zeros(10)]))


def set_spline_tracks(context: Context, node: Node, keys: SplineKeys) -> Node:
    """Animate the node by cubic keys; returns the node."""
    values = np.array(keys.values)
    # From slopes per time code to slopes per second.
    values[:, ::2] /= context.seconds(1.0) - context.seconds(0.0)
    parts = {path: values[:, :, columns] for path, columns in _PARTS.items()}
    assign(node, Trs(*(part[0, 1] for part in parts.values())))
    times = seconds_of(context, keys.codes)
    for path, track in parts.items():
        if np.abs(track - np.array([[0.0], [1.0], [0.0]]) * track[0, 1]).max() > _STILL:
            node.add_track(path, times, track, spline=True)
    return node


def spline_keys(
    evaluate: Callable[[float], Array], codes: list[float], reach: Reach
) -> SplineKeys | None:
    """Keys that stay within the tolerance; None where the matrix shears, or turns too fast."""
    size = max(float(np.abs(evaluate(code)[:3, 3]).max()) for code in codes)
    follower = _Follower(evaluate, reach, max(size, 1e-30))
    keys = SplineKeys()
    for first, last in itertools.pairwise(codes):
        if not is_jump(first, last) and not follower.step(keys, first, last):
            return None
    return keys if keys.codes and keys.codes[-1] == codes[-1] else None


@dataclass
class _Follower:
    evaluate: Callable[[float], Array]
    reach: Reach
    size: float
    """Maximum distance of the origin from 0."""

    def step(self, keys: SplineKeys, first: float, last: float) -> bool:
        """Add the keys from one code to the next; False where halving does not help."""
        known = keys.values[-1][1] if keys.codes else None
        keys.begin(first, self._parts(first, known))
        stack = [(first, last, 0)]
        while stack:
            a, b, depth = stack.pop()
            start = keys.values[-1][1]
            span = (b - a) * _SLOPE
            ahead = [self._parts(a + span * k, start) for k in (1, 2)]
            end = self._parts(b, self._parts((a + b) / 2, start))
            behind = [self._parts(b - span * k, end) for k in (1, 2)]
            # Differences of second order on one side: slopes may break at samples.
            out = (4.0 * ahead[0] - ahead[1] - 3.0 * start) / (2.0 * span)
            into = (3.0 * end - 4.0 * behind[0] + behind[1]) / (2.0 * span)
            deviation = self._deviation(a, b, np.array([start, out, end, into]))
            if deviation <= TOLERANCE:
                keys.add(b, end, out, into)
                keys.deviation = max(keys.deviation, deviation)
            elif depth == MAX_DEPTH:
                return False
            else:
                middle = (a + b) / 2
                stack += [(middle, b, depth + 1), (a, middle, depth + 1)]
        return True

    def _parts(self, code: float, near: Array | None) -> Array:
        """Translation, rotation and scale; the rotation's sign is the one nearer to `near`."""
        trs = nearest_trs(self.evaluate(code))
        parts = np.concatenate((trs.translation, trs.rotation, trs.scale))
        if near is not None and parts[3:7] @ near[3:7] < 0.0:
            parts[3:7] = -parts[3:7]
        return parts

    def _deviation(self, a: float, b: float, ends: Array) -> float:
        """The worst deviation at the probes and at the end, as a share of the size."""
        start, out, end, into = ends
        t = np.append(_PROBES, 1.0)[:, None]
        shown = (
            (2 * t**3 - 3 * t**2 + 1) * start
            + (b - a) * (t**3 - 2 * t**2 + t) * out
            + (3 * t**2 - 2 * t**3) * end
            + (b - a) * (t**3 - t**2) * into
        )
        wanted = np.array([self.evaluate(a + (b - a) * float(share)) for share in t[:, 0]])
        rotations = shown[:, 3:7] / np.linalg.norm(shown[:, 3:7], axis=1, keepdims=True)
        apart = np.abs(trs_matrices(shown[:, :3], rotations, shown[:, 7:]) - wanted)
        linear, place = apart[:, :3, :3].max(axis=(1, 2)), apart[:, :3, 3].max(axis=1)
        sizes = np.maximum(np.abs(wanted[:, :3, :3]).max(axis=(1, 2)), 1e-30)
        worst = max(float((linear / sizes).max()), float(place.max()) / self.size)
        pairs = zip(linear.tolist(), place.tolist(), strict=True)
        return max(worst, *(self.reach.corner(off, away) for off, away in pairs))
