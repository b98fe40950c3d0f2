"""Owns the truth about the size of lights: areas of transformed surfaces, by SciPy's integrals."""

import math

import numpy as np
from scipy.special import ellipe, elliprg

from .scene_data import Array

_NOTHING = 1e-12
"""Values below this share of the longest axis's square are rounding errors of 0."""


def surface_area(shape: str, sizes: tuple[float, float], matrix: Array) -> float:
    """Square meters of a light's surface; the rows of `matrix` are the images of its axes.

    `sizes` are width and height of a rectangle, the radius twice of a disk and a sphere, length and
    radius of a cylinder along x.
    """
    if not np.isfinite(matrix).all():
        return math.inf
    reach = float(np.abs(matrix).max())
    if reach == 0.0:
        return 0.0
    area = _unit_area(shape, matrix / reach)
    return (area if area > _NOTHING else 0.0) * reach**2 * sizes[0] * sizes[1]


def is_even(matrix: Array) -> bool:
    """Whether the matrix scales all directions equally, to 1e-4."""
    if not np.isfinite(matrix).all():
        return True
    gram = matrix @ matrix.T
    size = float(np.trace(gram)) / 3.0
    return bool(np.abs(gram - size * np.eye(3)).max() <= 1e-4 * size)


def _unit_area(shape: str, images: Array) -> float:
    """Area of a surface of sizes 1; `images` are the images of its axes."""
    x, y, z = images
    if shape in ("rectangle", "disk"):
        return float(np.linalg.norm(np.cross(x, y))) * (math.pi if shape == "disk" else 1.0)
    if shape == "cylinder":
        # Strips along x, whose widths go around an ellipse.
        long, short = np.linalg.svd([np.cross(x, y), np.cross(x, z)], compute_uv=False)
        return 4.0 * float(long * ellipe(1.0 - (short / long) ** 2)) if long > 0.0 else 0.0
    # An ellipsoid, by Carlson's symmetric integral (https://dlmf.nist.gov/19.33).
    first, second, third = np.linalg.svd(images, compute_uv=False) ** 2
    return 4.0 * math.pi * float(elliprg(first * second, first * third, second * third))
