"""Owns the change from Blender's axes (Z up) to Reflet's (Y up), and the parts of a matrix."""

from __future__ import annotations

import dataclasses
import math

from mathutils import Matrix, Quaternion, Vector

from .toml_text import LARGEST

# X stays, Z becomes Y, and Y becomes -Z, as in Blender's export of glTF.
_TURN = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))
_BACK = _TURN.transposed()
_SMALLEST_SCALE = 1e-9


def vector(of_blender: Vector) -> Vector:
    """A point or direction of Blender in Reflet's axes."""
    return Vector((of_blender.x, of_blender.z, -of_blender.y))


def matrix(of_blender: Matrix) -> Matrix:
    """A placement of Blender in Reflet's axes, for models that were turned alike."""
    return _TURN @ of_blender @ _BACK


@dataclasses.dataclass(frozen=True)
class Parts:
    """A placement without shear: scaled, then turned, then moved."""

    translation: Vector
    rotation: Quaternion
    scale: Vector


def parts(placement: Matrix) -> Parts | None:
    """The parts of `placement`, or None where it is sheared."""
    translation, rotation, scale = placement.decompose()
    made = Matrix.LocRotScale(translation, rotation, scale)
    size = max(abs(x) for x in scale)
    for made_row, row in zip(made, placement, strict=True):
        for column in range(3):
            if abs(made_row[column] - row[column]) > 1e-5 * size:
                return None
    return Parts(translation, rotation, scale)


def is_sound(placement: Matrix) -> bool:
    """Whether scene text can say the numbers of `placement`: finite, and not too large."""
    return all(math.isfinite(value) and abs(value) <= LARGEST for row in placement for value in row)


def is_flat(placement: Matrix) -> bool:
    """Whether `placement` has no volume, so that no scene text can say it."""
    return min(column.length for column in placement.to_3x3().col) < _SMALLEST_SCALE
