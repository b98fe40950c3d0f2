"""Owns the truth about the size of lights: areas of transformed surfaces, summed numerically."""

import functools
import math

import numpy as np

from .scene_data import Array

_AROUND = np.arange(4096) * (2.0 * math.pi / 4096)
_PLACES, _SHARES = (
    0.5 * (part + shift)
    for part, shift in zip(np.polynomial.legendre.leggauss(96), (1.0, 0.0), strict=True)
)
"""Quadrature nodes between 0 and 1, and their weights."""
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
    # Turning the whole surface keeps its area, so the axes' images are seen from themselves.
    seen = np.linalg.qr((matrix / reach).T)[1].T
    seen = seen * np.where(np.diag(seen) < 0.0, -1.0, 1.0)
    area = _unit_area(shape, tuple(float(value) for value in np.round(seen, 12).ravel()))
    return (area if area > _NOTHING else 0.0) * reach**2 * sizes[0] * sizes[1]


def is_even(matrix: Array) -> bool:
    """Whether the matrix scales all directions equally, to 1e-4."""
    if not np.isfinite(matrix).all():
        return True
    gram = matrix @ matrix.T
    size = float(np.trace(gram)) / 3.0
    return bool(np.abs(gram - size * np.eye(3)).max() <= 1e-4 * size)


@functools.lru_cache(maxsize=65536)
def _unit_area(shape: str, rows: tuple[float, ...]) -> float:
    """Area of a surface of sizes 1; `rows` are the images of its axes."""
    images = np.array(rows).reshape(3, 3)
    if shape == "rectangle":
        return float(np.linalg.norm(np.cross(images[0], images[1])))
    if shape == "disk":
        spokes = np.outer(np.cos(_AROUND), images[0]) + np.outer(np.sin(_AROUND), images[1])
        # Fan of triangles; each is too small by the ratio of the sine to its angle.
        fan = np.linalg.norm(np.cross(spokes, np.roll(spokes, -1, axis=0)), axis=1).sum() / 2
        step = float(_AROUND[1])
        return float(fan) * step / math.sin(step)
    if shape == "cylinder":
        rim = np.outer(-np.sin(_AROUND), images[1]) + np.outer(np.cos(_AROUND), images[2])
        strips = np.linalg.norm(np.cross(rim, images[0]), axis=1)
        return float(strips.mean()) * 2.0 * math.pi
    return _spheroid(np.linalg.svd(images, compute_uv=False)[::-1])


def _spheroid(lengths: Array) -> float:
    """Area of an ellipsoid: eight times an octant, by height and angle; shortest axis first."""
    short, middle, long = lengths
    height = _PLACES[:, None]
    angle = _PLACES[None, :] * (math.pi / 2)
    ring = np.sqrt(1.0 - height**2)
    # Tangents along a meridian and a parallel; ring · d(ring) = −height · d(height).
    up = np.stack(
        np.broadcast_arrays(
            -height * np.cos(angle) * long, -height * np.sin(angle) * middle, ring * short
        ),
        axis=-1,
    )
    along = np.stack(
        np.broadcast_arrays(-np.sin(angle) * long, np.cos(angle) * middle, 0.0 * angle * height),
        axis=-1,
    )
    pieces = np.linalg.norm(np.cross(up, along), axis=-1)
    return float(_SHARES @ pieces @ _SHARES) * 8.0 * math.pi / 2
