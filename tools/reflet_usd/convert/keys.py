"""Keys between which glTF stays close to a transform that USD evaluates at any time."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from reflet_usd.convert.samples import before, is_jump
from reflet_usd.convert.scene import Array
from reflet_usd.convert.shear import follow
from reflet_usd.convert.xform import Trs, decompose, nearest_trs

# Between keys a matrix may deviate by this share of its largest entries and still be exact.
EXACT_TOLERANCE = 2e-6
# Three entries add up in a corner's place, which should stay within 1e-5.
SAMPLED_TOLERANCE = 5e-6
EXACT_DEPTH = 3
SAMPLED_DEPTH = 12
# Halving a step must shrink the deviation to this share, else more keys do not help.
USEFUL_SHRINKAGE = 0.7
MAX_SAMPLES = 20_000
# Where in a step the parts of the next instant are looked up.
_AHEAD = 1e-3
_PROBES = (0.25, 0.5, 0.75)

Evaluate = Callable[[float], Array]
Pose = tuple[Trs, ...]
"""One node's parts, or those of two nested nodes, the outer one first."""


class Fit(Protocol):
    """How a matrix becomes a pose."""

    unjudged_depth: int
    """Steps halved less often than this are always halved again: too long to judge by."""

    def start(self, first: float, last: float, previous: Pose | None) -> Pose | None:
        """The pose at `first`, from which the step to `last` begins; None where there is none."""

    def at(self, code: float, previous: Pose) -> Pose | None:
        """The pose at `code`, close to the previous key's."""


@dataclass
class OneNode:
    """Translation, rotation and scale; with `nearest` also where the matrix shears."""

    evaluate: Evaluate
    nearest: bool = False
    unjudged_depth: int = 4

    def start(self, first: float, last: float, previous: Pose | None) -> Pose | None:
        """See `Fit`."""
        del last, previous
        return self._pose(first)

    def at(self, code: float, previous: Pose) -> Pose | None:
        """See `Fit`."""
        del previous
        return self._pose(code)

    def _pose(self, code: float) -> Pose | None:
        matrix = self.evaluate(code)
        trs = nearest_trs(matrix) if self.nearest else decompose(matrix)
        return None if trs is None else (trs,)


@dataclass
class TwoNodes:
    """Any affine matrix as two nested nodes; singular vectors may turn within a short step."""

    evaluate: Evaluate
    unjudged_depth: int = 9

    def start(self, first: float, last: float, previous: Pose | None) -> Pose | None:
        """See `Fit`; equal singular values take the directions that they part in."""
        known = None if previous is None else (previous[0], previous[1])
        ahead = follow(self.evaluate(first + (last - first) * _AHEAD), known)
        return follow(self.evaluate(first), ahead)

    def at(self, code: float, previous: Pose) -> Pose | None:
        """See `Fit`."""
        return follow(self.evaluate(code), (previous[0], previous[1]))


@dataclass
class Keys:
    """Codes, one pose each, and the worst deviation between them as a share of the size."""

    codes: list[float]
    poses: list[Pose]
    deviation: float = 0.0

    def add(self, code: float, pose: Pose) -> None:
        """Append a key."""
        self.codes.append(code)
        self.poses.append(pose)

    def begin(self, code: float, pose: Pose) -> None:
        """A step's first key; other parts of the same matrix make a jump that does not show."""
        if self.codes and self.codes[-1] == code:
            if _same(self.poses[-1], pose):
                return
            self.codes[-1] = before(code)
        self.add(code, pose)


def _same(first: Pose, last: Pose) -> bool:
    return all(
        np.abs(a.rotation - b.rotation).max() < 1e-9 and np.abs(a.scale - b.scale).max() < 1e-9
        for a, b in zip(first, last, strict=True)
    )


def exact_keys(evaluate: Evaluate, codes: list[float], fit: Fit) -> Keys | None:
    """Keys between which glTF stays within float32's reach of USD, or None."""
    return _refine(evaluate, codes, fit, EXACT_TOLERANCE, EXACT_DEPTH, strict=True)


def sampled_keys(evaluate: Evaluate, codes: list[float]) -> Keys:
    """Keys halved until close enough: one node, or two where one cannot follow."""
    tolerance, depth = SAMPLED_TOLERANCE, SAMPLED_DEPTH
    one = _refine(evaluate, codes, OneNode(evaluate, nearest=True), tolerance, depth)
    if one is not None and one.deviation <= tolerance:
        return one
    two = _refine(evaluate, codes, TwoNodes(evaluate), tolerance, depth)
    assert one is not None and two is not None  # only strict refinement gives up
    return two if two.deviation < USEFUL_SHRINKAGE * one.deviation else one


def _refine(
    evaluate: Evaluate,
    codes: list[float],
    fit: Fit,
    tolerance: float,
    depth: int,
    strict: bool = False,
) -> Keys | None:
    reach = max(max(float(np.abs(evaluate(code)[:3, 3]).max()) for code in codes), 1e-30)
    keys = Keys([], [])
    for first, last in itertools.pairwise(codes):
        if is_jump(first, last):
            continue
        pose = fit.start(first, last, keys.poses[-1] if keys.poses else None)
        if pose is None:
            return None
        keys.begin(first, pose)
        if not _refine_step(evaluate, keys, (first, last), fit, reach, tolerance, depth, strict):
            return None
    if keys.codes[-1] != codes[-1]:  # a jump to one last key
        pose = fit.start(codes[-1], codes[-1], keys.poses[-1])
        if pose is None:
            return None
        keys.add(codes[-1], pose)
    return keys


def _refine_step(
    evaluate: Evaluate,
    keys: Keys,
    step: tuple[float, float],
    fit: Fit,
    reach: float,
    tolerance: float,
    depth: int,
    strict: bool,
) -> bool:
    """Add keys up to the step's end; False where `strict` and too few would do."""
    stack = [(*step, 0)]
    while stack:
        a, b, level = stack.pop()
        pose = fit.at(b, keys.poses[-1])
        full = level >= depth or len(keys.codes) + len(stack) > MAX_SAMPLES
        if pose is None:
            return False
        error = _worst(evaluate, a, b, keys.poses[-1], pose, reach)
        if error <= tolerance:
            keys.deviation = max(keys.deviation, error)
            keys.add(b, pose)
        elif strict and full:
            return False
        elif full or not _halving_helps(evaluate, fit, a, b, level, keys.poses[-1], error, reach):
            keys.deviation = max(keys.deviation, error)
            keys.add(b, pose)
        else:
            middle = (a + b) / 2
            stack += [(middle, b, level + 1), (a, middle, level + 1)]
    return True


def _halving_helps(
    evaluate: Evaluate,
    fit: Fit,
    a: float,
    b: float,
    level: int,
    pose: Pose,
    error: float,
    reach: float,
) -> bool:
    if level < fit.unjudged_depth:
        return True
    middle = fit.at((a + b) / 2, pose)
    last = None if middle is None else fit.at(b, middle)
    if middle is None or last is None:
        return False
    halves = max(
        _worst(evaluate, a, (a + b) / 2, pose, middle, reach),
        _worst(evaluate, (a + b) / 2, b, middle, last, reach),
    )
    return halves < USEFUL_SHRINKAGE * error


def _worst(evaluate: Evaluate, a: float, b: float, first: Pose, last: Pose, reach: float) -> float:
    worst = 0.0
    for share in _PROBES:
        shown = np.eye(4)
        for one, other in zip(first, last, strict=True):
            shown = shown @ _interpolate(one, other, share).matrix()
        matrix = evaluate(a + (b - a) * share)
        difference = np.abs(shown - matrix)
        size = max(float(np.abs(matrix[:3, :3]).max()), 1e-30)
        linear, place = float(difference[:3, :3].max()), float(difference[:3, 3].max())
        worst = max(worst, linear / size, place / reach)
    return worst


def _interpolate(first: Trs, last: Trs, share: float) -> Trs:
    """What glTF shows between two keys: linear, and spherical linear for the rotation."""
    a, b = first.rotation, last.rotation
    dot = float(a @ b)
    if dot < 0.0:
        b, dot = -b, -dot
    angle = np.arccos(min(dot, 1.0))
    if angle < 1e-9:
        rotation = a + (b - a) * share
    else:
        rotation = (np.sin((1 - share) * angle) * a + np.sin(share * angle) * b) / np.sin(angle)
    rotation = rotation / np.linalg.norm(rotation)
    return Trs(
        first.translation + (last.translation - first.translation) * share,
        rotation,
        first.scale + (last.scale - first.scale) * share,
    )
