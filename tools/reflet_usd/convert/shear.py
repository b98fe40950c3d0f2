"""Matrices that shear while they move: two nested nodes whose parts follow from key to key.

M = (T U Σ) · Vᵀ as for matrices at rest. The singular value decomposition is chosen like an
analytic one (Bunse-Gerstner et al., Numer. Math. 60, 1991): the order, signs and, where singular
values are equal, the directions of the vectors follow the key before.
"""

import itertools

import numpy as np

from .scene import Array
from .xform import Trs, quaternion, rotation_matrix, split_shear

# Singular values closer than this share of the largest are equal: directions between them are free.
EQUAL = 1e-9


def follow(matrix: Array, reference: tuple[Trs, Trs] | None) -> tuple[Trs, Trs]:
    """The two parts of `matrix` that are closest to the parts of `reference`."""
    if reference is None:
        return split_shear(matrix)
    outer, inner = reference
    linear, known = matrix[:3, :3], (outer.matrix() @ inner.matrix())[:3, :3]
    if np.abs(linear - known).max() <= 1e-12 * np.abs(linear).max():
        return Trs(matrix[:3, 3].copy(), outer.rotation, outer.scale), inner
    u, sigma, v = _aligned(
        linear, rotation_matrix(outer.rotation), rotation_matrix(inner.rotation).T
    )
    return (
        Trs(matrix[:3, 3].copy(), quaternion(u), sigma),
        Trs(np.zeros(3), quaternion(v.T), np.ones(3)),
    )


def _aligned(linear: Array, near_u: Array, near_v: Array) -> tuple[Array, Array, Array]:
    """U, Σ (with signs) and V of a 3 × 3 matrix, U and V rotations close to the given ones."""
    u, sigma, vt = np.linalg.svd(linear)
    v = vt.T
    group = np.concatenate(([0], np.cumsum(-np.diff(sigma) > EQUAL * sigma[0])))
    # Overlap of each wanted direction (rows) with the space of each direction's group (columns).
    same = (group[:, None] == group[None, :]).astype(float)
    likeness = ((near_v.T @ v) ** 2 + (near_u.T @ u) ** 2) @ same
    order = max(
        (list(order) for order in itertools.permutations(range(3))),
        key=lambda order: sum(likeness[row, column] for row, column in enumerate(order)),
    )
    u, sigma, v, group = u[:, order], sigma[order], v[:, order], group[order]
    for label in set(group.tolist()):
        members = np.flatnonzero(group == label)
        if len(members) == 1:
            continue
        turn = _nearest_turn(v[:, members], near_v[:, members])
        v[:, members] = v[:, members] @ turn
        if sigma[members].max() <= EQUAL * sigma.max():
            turn = _nearest_turn(u[:, members], near_u[:, members])
        u[:, members] = u[:, members] @ turn
    for vectors, near in ((u, near_u), (v, near_v)):
        agreement = np.einsum("ij,ij->j", vectors, near)
        signs = np.where(agreement < 0.0, -1.0, 1.0)
        if np.linalg.det(vectors * signs) < 0.0:
            signs[int(np.argmin(np.abs(agreement)))] *= -1.0
        vectors *= signs
        sigma = sigma * signs
    return u, sigma, v


def _nearest_turn(vectors: Array, wanted: Array) -> Array:
    """Orthogonal matrix that turns `vectors` closest to `wanted` (Procrustes)."""
    left, _, right = np.linalg.svd(vectors.T @ wanted)
    return np.asarray(left @ right)
