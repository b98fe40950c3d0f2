"""How one instance of a PointInstancer moves: exact keys, or USD's own matrices where they stretch.

USD turns orientations into matrices without normalizing them, and half floats are rarely of
length 1, so an instance that turns also stretches a little. A glTF rotation does not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Usd

from reflet_usd.convert.animation import animate_matrix
from reflet_usd.convert.context import Context
from reflet_usd.convert.instancing import trs_matrices, unit_quaternions
from reflet_usd.convert.scene import Array, Node
from reflet_usd.convert.xform import Trs, align_hemispheres, assign, place

# Matrices that normalization changes by no more than this are equal in single precision.
_NORMALIZED = 1e-6
# Keys times instances that are followed matrix by matrix; more would take minutes.
MAX_MATRIX_KEYS = 40_000

Tracks = dict[str, tuple[list[float], Array]]
"""By path the key codes and (keys, instances, components), as authored, lengths in meters."""
Parts = dict[str, Array]
"""By path (instances, components): what holds where there is no track."""


@dataclass
class InstanceMotion:
    """The tracks of one instancer, applied instance by instance."""

    context: Context
    prim: Usd.Prim
    tracks: Tracks
    parts: Parts

    def __post_init__(self) -> None:
        self._stretch = self._off_unit()
        self._stretched = self._stretch > _NORMALIZED
        self._codes = sorted({code for codes, _ in self.tracks.values() for code in codes})
        count = int(self._stretched.sum())
        if count * len(self._codes) > MAX_MATRIX_KEYS:
            off = float(self._stretch.max())
            message = f"quaternions not of length 1 were normalized, matrices differ by {off:.1e}"
            self.context.ledger.warn("instance-rotation-normalized", self.prim, message, off)
            self._stretched[:] = False

    def apply(self, instance: Node, number: int) -> Node:
        """Place and animate `instance`, the `number`th of the instancer; returns the outer node."""
        if self._stretched[number]:
            return self._follow(instance, number)
        start = {path: self._at(path, number, self._codes[0]) for path in self.parts}
        rotation = unit_quaternions(start["rotation"])[0]
        assign(instance, Trs(start["translation"], rotation, start["scale"]))
        for path, (codes, values) in self.tracks.items():
            keys = values[:, number]
            if path == "rotation":
                keys = align_hemispheres(unit_quaternions(keys))
            times = np.array([self.context.seconds(code) for code in codes])
            instance.add_track(path, times, keys)
        return instance

    def _follow(self, instance: Node, number: int) -> Node:
        """One or two nodes below a third that travels, or keys on the whole matrix."""

        def matrix(code: float) -> Array:
            rows = [self._at(p, number, code)[None] for p in ("translation", "rotation", "scale")]
            return np.asarray(trs_matrices(*rows)[0])

        if "rotation" in self.tracks or "scale" in self.tracks:
            return animate_matrix(self.context, self.prim, instance, matrix, self._codes)
        codes, values = self.tracks["translation"]
        still = matrix(codes[0])
        still[:3, 3] = 0.0
        outer = place(instance, still)
        outer.translation = values[0, number]
        times = np.array([self.context.seconds(code) for code in codes])
        outer.add_track("translation", times, values[:, number])
        return outer

    def _at(self, path: str, number: int, code: float) -> Array:
        """The value as USD interpolates it: linear, quaternions spherically and unnormalized."""
        if path not in self.tracks:
            return np.asarray(self.parts[path][number])
        codes, values = self.tracks[path]
        last = min(max(int(np.searchsorted(codes, code, side="right")), 1), len(codes) - 1)
        first = last - 1
        share = min(max((code - codes[first]) / (codes[last] - codes[first]), 0.0), 1.0)
        a, b = values[first, number], values[last, number]
        if path != "rotation":
            return np.asarray(a + (b - a) * share)
        return _slerp(a, b, share)

    def _off_unit(self) -> Array:
        """How far a unit quaternion's matrix is from USD's, at worst over each instance's keys."""
        rotations = self.parts["rotation"][None]
        if "rotation" in self.tracks:
            rotations = self.tracks["rotation"][1]
        found = np.zeros(rotations.shape[1])
        for rows in rotations:
            places, ones = np.zeros((len(rows), 3)), np.ones((len(rows), 3))
            unit = trs_matrices(places, unit_quaternions(rows), ones)
            off = np.abs(trs_matrices(places, rows, ones) - unit)
            found = np.maximum(found, off.max(axis=(1, 2)))
        return found


def _slerp(a: Array, b: Array, share: float) -> Array:
    """USD's GfSlerp, which takes lengths as they are."""
    cosine = float(a @ b)
    if cosine < 0.0:
        b, cosine = -b, -cosine
    if 1.0 - cosine <= 1e-5:
        return np.asarray(a + (b - a) * share)
    angle = np.arccos(cosine)
    parts = np.sin((1.0 - share) * angle) * a + np.sin(share * angle) * b
    return np.asarray(parts / np.sin(angle))
