"""Keys between which glTF stays close to a transform that USD evaluates at any time."""

import functools
import itertools
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from .samples import before, is_jump
from .scene import Array
from .shear import follow
from .transform_tolerance import Reach
from .xform import Trs, decompose, nearest_trs

# Matrices between keys may deviate by this share of their largest entries and still be exact.
EXACT_TOLERANCE = 2e-6
# Rounding of three entries adds up in a corner's position, which should stay within 1e-5.
SAMPLED_TOLERANCE = 5e-6
EXACT_DEPTH = 3
SAMPLED_DEPTH = 12
# If halving a step does not shrink the deviation to this share, more keys do not help.
USEFUL_SHRINKAGE = 0.7
MAX_SAMPLES = 6_000
# Share of a step at which the pose just after its start is read, to choose directions.
_AHEAD = 1e-3
_PROBES = (0.25, 0.5, 0.75)
# Cache size in matrices, some 300 bytes each.
_REMEMBERED = 1 << 16

Evaluate = Callable[[float], Array]
Pose = tuple[Trs, ...]
"""Parts of one node, or of two nested nodes, the outer one first."""


class Fit(Protocol):
    """A way to write a matrix as a pose."""

    unjudged_depth: int
    """Minimum number of halvings before a step is tested."""
    follows_paths: bool
    """Whether the pose is the whole matrix, so that shorter steps always help."""

    def start(self, first: float, last: float, previous: Pose | None) -> Pose | None:
        """The pose at `first`, from which the step to `last` begins; None where there is none."""

    def at(self, code: float, previous: Pose) -> Pose | None:
        """The pose at `code`, close to the previous key's."""


@dataclass
class OneNode:
    """Pose of one node: translation, rotation, scale; with `nearest` also where it shears."""

    evaluate: Evaluate
    nearest: bool = False
    unjudged_depth: int = 4
    follows_paths: bool = True

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
    """Pose of two nested nodes for any affine matrix; singular vectors may turn in a short step."""

    evaluate: Evaluate
    unjudged_depth: int = 9
    follows_paths: bool = False

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
        """Add a step's first key; other parts of the same matrix make a jump that does not show."""
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


def remembered(evaluate: Evaluate) -> Evaluate:
    """`evaluate` with a cache, since USD is slow and halved steps ask for the same codes again."""

    @functools.lru_cache(maxsize=_REMEMBERED)
    def once(code: float) -> Array:
        matrix = evaluate(code)
        matrix.setflags(write=False)  # many keys share the array
        return matrix

    return once


def exact_keys(evaluate: Evaluate, codes: list[float], fit: Fit, reach: Reach) -> Keys | None:
    """Keys between which glTF stays within float32's reach of USD, or None."""
    return _Refiner(evaluate, fit, reach, EXACT_TOLERANCE, EXACT_DEPTH, strict=True).run(codes)


def sampled_keys(evaluate: Evaluate, codes: list[float], reach: Reach) -> Keys:
    """Keys halved until close enough: one node, or two where one cannot follow."""

    def refined(fit: Fit) -> Keys:
        keys = _Refiner(evaluate, fit, reach, SAMPLED_TOLERANCE, SAMPLED_DEPTH).run(codes)
        assert keys is not None  # only strict refinement returns None
        return keys

    # Where the keys themselves shear, one node is tried only if two cannot follow either.
    two = refined(TwoNodes(evaluate)) if _sheared(evaluate, codes) else None
    if two is not None and two.deviation <= SAMPLED_TOLERANCE:
        return two
    one = refined(OneNode(evaluate, nearest=True))
    if one.deviation <= SAMPLED_TOLERANCE or not _sheared(evaluate, one.codes):
        return one
    two = two or refined(TwoNodes(evaluate))
    return two if two.deviation < USEFUL_SHRINKAGE * one.deviation else one


def _sheared(evaluate: Evaluate, codes: list[float]) -> bool:
    """Whether some matrix shears: only then two nodes follow better than one."""
    matrices = (evaluate(code) for code in codes)
    return any(_is_part((nearest_trs(matrix),), matrix) for matrix in matrices)


def _is_part(pose: Pose, matrix: Array) -> bool:
    """Whether the pose leaves out a shear of the matrix."""
    linear = matrix[:3, :3]
    shown = functools.reduce(np.matmul, (node.matrix()[:3, :3] for node in pose))
    size = max(float(np.abs(linear).max()), 1e-30)
    return bool(np.abs(shown - linear).max() > SAMPLED_TOLERANCE * size)


@dataclass
class _Refiner:
    """Halves the steps between codes until glTF stays within `tolerance` of `evaluate`."""

    evaluate: Evaluate
    fit: Fit
    shows: Reach
    tolerance: float
    depth: int
    strict: bool = False
    """Give up where `depth` halvings are too few, instead of keeping the deviation."""
    reach: float = 1.0
    """Maximum distance of the origin from 0: the scale of its tolerance."""
    keys: Keys = field(default_factory=lambda: Keys([], []))

    def run(self, codes: list[float]) -> Keys | None:
        """The keys over all codes; None where a strict or shear-free fit fails."""
        places = [np.abs(self.evaluate(code)[:3, 3]).max() for code in codes]
        self.reach = max(float(max(places)), 1e-30)
        for first, last in itertools.pairwise(codes):
            if is_jump(first, last):
                continue
            if not self._begin(first, last) or not self._step(first, last):
                return None
        # One more key may follow a jump.
        if self.keys.codes[-1] != codes[-1] and not self._begin(codes[-1], codes[-1]):
            return None
        return self.keys

    def _begin(self, first: float, last: float) -> bool:
        known = self.keys.poses[-1] if self.keys.poses else None
        pose = self.fit.start(first, last, known)
        if pose is not None:
            self.keys.begin(first, pose)
        return pose is not None

    def _step(self, first: float, last: float) -> bool:
        """Add keys up to `last`; False where none are good enough."""
        stack = [(first, last, 0)]
        while stack:
            a, b, level = stack.pop()
            known = self.keys.poses[-1]
            pose = self.fit.at(b, known)
            if pose is None:
                return False
            error = self._deviation(a, b, known, pose)
            full = level >= self.depth or len(self.keys.codes) + len(stack) > MAX_SAMPLES
            close = error <= self.tolerance
            if not close and full and self.strict:
                return False
            if close or full or not self._halving_helps(a, b, level, error):
                self.keys.deviation = max(self.keys.deviation, error)
                self.keys.add(b, pose)
            else:
                middle = (a + b) / 2
                stack += [(middle, b, level + 1), (a, middle, level + 1)]
        return True

    def _halving_helps(self, a: float, b: float, level: int, error: float) -> bool:
        if level < self.fit.unjudged_depth:
            return True
        known, half = self.keys.poses[-1], (a + b) / 2
        middle = self.fit.at(half, known)
        whole = middle is not None and not _is_part(middle, self.evaluate(half))
        if whole and self.fit.follows_paths:
            return True
        last = None if middle is None else self.fit.at(b, middle)
        if middle is None or last is None:
            return False
        halves = max(
            self._deviation(a, half, known, middle), self._deviation(half, b, middle, last)
        )
        return halves < USEFUL_SHRINKAGE * error

    def _deviation(self, a: float, b: float, first: Pose, last: Pose) -> float:
        """The worst deviation between two keys, as a share of the matrix's and scene's size."""
        worst = 0.0
        for share in _PROBES:
            shown = np.eye(4)
            for one, other in zip(first, last, strict=True):
                shown = shown @ _interpolate(one, other, share).matrix()
            matrix = self.evaluate(a + (b - a) * share)
            difference = np.abs(shown - matrix)
            size = max(float(np.abs(matrix[:3, :3]).max()), 1e-30)
            linear, place = float(difference[:3, :3].max()), float(difference[:3, 3].max())
            shown_off = self.shows.corner(linear, place)
            worst = max(worst, linear / size, place / self.reach, shown_off)
        return worst


def _interpolate(first: Trs, last: Trs, share: float) -> Trs:
    """Pose that glTF shows between two keys: linear, and spherical linear for the rotation."""
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
