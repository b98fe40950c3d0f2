"""Matrices to glTF nodes: translation, rotation, scale, and two nested nodes where they shear."""

from dataclasses import dataclass

import numpy as np
from pxr import Gf

from .scene import Array, Node, identity_or

# A matrix counts as free of shear when rebuilt from its parts within this share of its largest
# entry; parts come from float64 arithmetic, so this only has to absorb float32 authoring.
SHEAR_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Trs:
    """The parts of `M = T · R · S`; rotation is a unit quaternion (x, y, z, w)."""

    translation: Array
    rotation: Array
    scale: Array

    def matrix(self) -> Array:
        """The 4 × 4 matrix for column vectors."""
        matrix = np.eye(4)
        matrix[:3, :3] = rotation_matrix(self.rotation) * self.scale
        matrix[:3, 3] = self.translation
        return matrix


def column_matrix(matrix: Gf.Matrix4d, meters_per_unit: float) -> Array:
    """USD's row-vector matrix as one for column vectors, its translation in meters."""
    columns = np.array(matrix, dtype=np.float64).T
    columns[:3, 3] *= meters_per_unit
    return columns


def rotation_matrix(rotation: Array) -> Array:
    """The 3 × 3 rotation of a unit quaternion (x, y, z, w)."""
    x, y, z, w = (float(part) for part in rotation)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion(rotation: Array) -> Array:
    """The unit quaternion (x, y, z, w), w >= 0, of a 3 × 3 rotation (Shepperd's method)."""
    m = rotation
    trace = float(np.trace(m))
    candidates = np.array([m[0, 0], m[1, 1], m[2, 2], trace])
    best = int(np.argmax(candidates))
    if best == 3:
        q = np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1.0 + trace])
    else:
        i, j, k = best, (best + 1) % 3, (best + 2) % 3
        q = np.empty(4)
        q[i] = 1.0 - trace + 2.0 * m[i, i]
        q[j] = m[j, i] + m[i, j]
        q[k] = m[k, i] + m[i, k]
        q[3] = m[k, j] - m[j, k]
    q /= np.linalg.norm(q)
    return -q if q[3] < 0.0 else q


def decompose(matrix: Array) -> Trs | None:
    """The parts of an affine matrix for column vectors, or None where it shears.

    Diagonal matrices keep their signs; other mirrored ones get a negative scale on x. Columns of
    zero length keep scale 0.
    """
    linear = matrix[:3, :3]
    diagonal = np.diagonal(linear)
    turned = np.count_nonzero(diagonal < 0.0) == 2  # half a turn, no mirror
    if np.count_nonzero(linear) == np.count_nonzero(diagonal) and not turned:
        return Trs(matrix[:3, 3].copy(), np.array([0.0, 0.0, 0.0, 1.0]), diagonal.copy())
    lengths = np.linalg.norm(linear, axis=0)
    largest = float(lengths.max())
    if largest == 0.0:
        return Trs(matrix[:3, 3].copy(), np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3))
    axes = _complete_axes(linear, lengths, largest)
    gram = axes.T @ axes
    if np.abs(gram - np.eye(3)).max() > SHEAR_TOLERANCE:
        return None
    scale = np.where(lengths > largest * 1e-12, lengths, 0.0)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] = -axes[:, 0]
        scale[0] = -scale[0]
    rotation = quaternion(axes)
    return Trs(matrix[:3, 3].copy(), rotation, scale)


def _complete_axes(linear: Array, lengths: Array, largest: float) -> Array:
    """Unit columns of `linear`; columns of zero length become any orthogonal directions."""
    present = lengths > largest * 1e-12
    axes = np.zeros((3, 3))
    axes[:, present] = linear[:, present] / lengths[present]
    for column in np.flatnonzero(~present):
        others = axes[:, [c for c in range(3) if c != column]]
        cross = np.cross(others[:, 0], others[:, 1])
        if np.linalg.norm(cross) < 0.5:
            known = others[:, np.linalg.norm(others, axis=0) > 0.5][:, 0]
            helper = np.eye(3)[int(np.argmin(np.abs(known)))]
            cross = np.cross(known, helper)
        axes[:, column] = cross / np.linalg.norm(cross)
    if (~present).sum() >= 1 and np.linalg.det(axes) < 0.0:
        free = int(np.flatnonzero(~present)[0])
        axes[:, free] = -axes[:, free]
    return axes


def split_shear(matrix: Array) -> tuple[Trs, Trs]:
    """Two nested transforms with the product `matrix`: M = (T U Σ) · Vᵀ (singular values).

    https://en.wikipedia.org/wiki/Singular_value_decomposition: U and V are rotations once the
    signs of their determinants have moved into Σ.
    """
    u, sigma, vt = np.linalg.svd(matrix[:3, :3])
    if np.linalg.det(u) < 0.0:
        u[:, 2] = -u[:, 2]
        sigma[2] = -sigma[2]
    if np.linalg.det(vt) < 0.0:
        vt[2, :] = -vt[2, :]
        sigma[2] = -sigma[2]
    outer = Trs(matrix[:3, 3].copy(), quaternion(u), sigma)
    inner = Trs(np.zeros(3), quaternion(vt), np.ones(3))
    return outer, inner


def assign(node: Node, trs: Trs) -> None:
    """Give `node` the transform, leaving identities out."""
    node.translation = identity_or(trs.translation, (0.0, 0.0, 0.0))
    node.rotation = identity_or(trs.rotation, (0.0, 0.0, 0.0, 1.0))
    node.scale = identity_or(trs.scale, (1.0, 1.0, 1.0))


def place(node: Node, matrix: Array) -> Node:
    """Give `node` the matrix; returns the node that its parent adds (a helper under shear)."""
    trs = decompose(matrix)
    if trs is not None:
        assign(node, trs)
        return node
    outer, inner = split_shear(matrix)
    helper = Node(f"{node.name}_shear")
    assign(helper, outer)
    assign(node, inner)
    helper.add(node)
    return helper


def nearest_trs(matrix: Array) -> Trs:
    """The closest transform without shear: rotation from the polar decomposition."""
    exact = decompose(matrix)
    if exact is not None:
        return exact
    u, _, vt = np.linalg.svd(matrix[:3, :3])
    rotation = u @ vt
    if np.linalg.det(rotation) < 0.0:
        rotation = u @ np.diag([1.0, 1.0, -1.0]) @ vt
    scale = np.einsum("ij,ij->j", rotation, matrix[:3, :3])
    return Trs(matrix[:3, 3].copy(), quaternion(rotation), scale)


def align_hemispheres(rotations: Array) -> Array:
    """Flip signs so that neighbors interpolate the short way (q and -q are one rotation)."""
    dots = np.einsum("ij,ij->i", rotations[1:], rotations[:-1])
    signs = np.concatenate(([1.0], np.cumprod(np.where(dots < 0.0, -1.0, 1.0))))
    return rotations * signs[:, None]
