"""Translations, quaternions and scales of many instances or joints, as USD makes matrices of them.

USD does not normalize the quaternions of instances and joints, so one that is not of length 1
also stretches: with `|q|² = 1 + e` the plane that it turns is scaled by about `1 - e (1 - cos θ)`.
Half floats are rarely of length 1. A glTF rotation always is.
"""

from dataclasses import dataclass

import numpy as np

from .instancing import trs_matrices, unit_quaternions
from .scene import Array

Tracks = dict[str, tuple[list[float], Array]]
"""Key codes and values (keys, items, components) by path, as authored, lengths in meters."""
Parts = dict[str, Array]
"""Values (items, components) by path, which hold where there is no track."""
_PATHS = ("translation", "rotation", "scale")


@dataclass
class RawTrs:
    """Transforms of items (instances or joints) at any time code, from `tracks` and `parts`."""

    tracks: Tracks
    parts: Parts

    def codes(self) -> list[float]:
        """The codes of all keys, in order."""
        return sorted({code for codes, _ in self.tracks.values() for code in codes})

    def matrix(self, number: int, code: float) -> Array:
        """USD's matrix of one item, for column vectors."""
        rows = [self.at(path, number, code)[None] for path in _PATHS]
        return np.asarray(trs_matrices(*rows)[0])

    def at(self, path: str, number: int, code: float) -> Array:
        """Value as USD interpolates it, linearly or spherically, but in double precision."""
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

    def off_unit(self) -> Array:
        """Largest deviation of a unit quaternion's matrix from USD's, over the keys of an item."""
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
    """USD's GfSlerp, which does not normalize."""
    cosine = float(a @ b)
    if cosine < 0.0:
        b, cosine = -b, -cosine
    if 1.0 - cosine <= 1e-5:
        return np.asarray(a + (b - a) * share)
    angle = np.arccos(cosine)
    parts = np.sin((1.0 - share) * angle) * a + np.sin(share * angle) * b
    return np.asarray(parts / np.sin(angle))
