"""Many instances of one prototype as EXT_mesh_gpu_instancing."""

import numpy as np

from .gltf_writer import GltfWriter
from .scene import Array, Node
from .xform import SHEAR_TOLERANCE, Trs

Transforms = tuple[Array, Array, Array]


def add_gpu_instances(
    writer: GltfWriter, parent: Node, prototype: Node, instances: Transforms
) -> bool:
    """Write each mesh of `prototype` once with all instance transforms below `parent`.

    False, with nothing written, where nodes are needed: animation, skins, lights, cameras,
    nested GPU instances, or a product of transforms that shears.
    """
    placed = _mesh_nodes(prototype)
    if placed is None:
        return False
    matrices = trs_matrices(*instances)
    parts = []
    for _, matrix in placed:
        if np.array_equal(matrix, np.eye(4)):
            parts.append(instances)
            continue
        product = decompose_many(matrices @ matrix)
        if product is None:
            return False
        parts.append(product)
    for (node, _), (translations, rotations, scales) in zip(placed, parts, strict=True):
        copy = parent.add(Node(node.name, node.prim, mesh=node.mesh, extras=dict(node.extras)))
        copy.instances = {
            "TRANSLATION": writer.add_accessor(translations.astype(np.float32)),
            "ROTATION": writer.add_accessor(rotations.astype(np.float32)),
            "SCALE": writer.add_accessor(scales.astype(np.float32)),
        }
    return True


def _mesh_nodes(prototype: Node) -> list[tuple[Node, Array]] | None:
    """The prototype's mesh nodes with their matrices, or None where it holds anything else."""
    found = []
    stack = [(prototype, np.eye(4))]
    while stack:
        node, above = stack.pop()
        special = (node.camera, node.light, node.skin, node.instances)
        if node.tracks or any(part is not None for part in special):
            return None
        matrix = above @ _local(node)
        if node.mesh is not None:
            found.append((node, matrix))
        stack.extend((child, matrix) for child in reversed(node.children))
    return found


def _local(node: Node) -> Array:
    translation = np.zeros(3) if node.translation is None else node.translation
    rotation = np.array([0.0, 0.0, 0.0, 1.0]) if node.rotation is None else node.rotation
    scale = np.ones(3) if node.scale is None else node.scale
    return Trs(translation, rotation, scale).matrix()


def trs_matrices(translations: Array, rotations: Array, scales: Array) -> Array:
    """Matrices (N, 4, 4) for column vectors; quaternions (x, y, z, w) are taken as they are."""
    x, y, z, w = rotations.T
    matrices = np.zeros((len(x), 4, 4))
    matrices[:, 0, 0], matrices[:, 0, 1] = 1 - 2 * (y * y + z * z), 2 * (x * y - z * w)
    matrices[:, 0, 2], matrices[:, 1, 0] = 2 * (x * z + y * w), 2 * (x * y + z * w)
    matrices[:, 1, 1], matrices[:, 1, 2] = 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)
    matrices[:, 2, 0], matrices[:, 2, 1] = 2 * (x * z - y * w), 2 * (y * z + x * w)
    matrices[:, 2, 2] = 1 - 2 * (x * x + y * y)
    matrices[:, :3, :3] *= scales[:, None, :]
    matrices[:, :3, 3] = translations
    matrices[:, 3, 3] = 1.0
    return matrices


def decompose_many(matrices: Array) -> Transforms | None:
    """Translations, quaternions and scales of (N, 4, 4) matrices; None where one shears."""
    linear = matrices[:, :3, :3]
    scales = np.linalg.norm(linear, axis=1)
    if (scales <= 0.0).any():
        return None
    axes = linear / scales[:, None, :]
    gram = np.einsum("nki,nkj->nij", axes, axes)
    if np.abs(gram - np.eye(3)).max() > SHEAR_TOLERANCE:
        return None
    mirrored = np.linalg.det(axes) < 0.0
    axes[mirrored, :, 0] *= -1.0
    scales[mirrored, 0] *= -1.0
    return matrices[:, :3, 3].copy(), quaternions(axes), scales


def quaternions(m: Array) -> Array:
    """Unit quaternions (x, y, z, w) of rotations (N, 3, 3), by Shepperd's method."""
    trace = np.trace(m, axis1=1, axis2=2)
    diagonal = np.stack([m[:, 0, 0], m[:, 1, 1], m[:, 2, 2], trace], axis=1)
    best = np.argmax(diagonal, axis=1)
    q = np.empty((len(m), 4))
    for choice in range(3):
        rows = best == choice
        i, j, k = choice, (choice + 1) % 3, (choice + 2) % 3
        r = m[rows]
        q[rows, i] = 1.0 - trace[rows] + 2.0 * r[:, i, i]
        q[rows, j] = r[:, j, i] + r[:, i, j]
        q[rows, k] = r[:, k, i] + r[:, i, k]
        q[rows, 3] = r[:, k, j] - r[:, j, k]
    rows = best == 3
    r = m[rows]
    q[rows, 0], q[rows, 1] = r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0]
    q[rows, 2], q[rows, 3] = r[:, 1, 0] - r[:, 0, 1], 1.0 + trace[rows]
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def unit_quaternions(value: object) -> Array:
    """A VtQuatArray as unit rows (x, y, z, w); rows without length become the identity."""
    rows = np.array(value, dtype=np.float64).reshape(-1, 4)
    lengths = np.linalg.norm(rows, axis=1, keepdims=True)
    usable = np.isfinite(lengths) & (lengths > 0.0)
    return np.where(usable, rows / np.where(usable, lengths, 1.0), (0.0, 0.0, 0.0, 1.0))
