"""Primvars to streams: interpolation, indices, sizes and finite values checked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from .context import Context, in_float32
from .scene import Array
from .surface import Stream, face_varying_stream


@dataclass(frozen=True)
class Primvar:
    """A primvar's values, already looked up at one time; indices not yet applied."""

    name: str
    interpolation: str
    values: Array
    """(K, components) float64."""
    indices: Array | None

    def flat(self) -> Array:
        """The values with the indices applied."""
        return self.values if self.indices is None else self.values[self.indices]


@dataclass(frozen=True)
class Topology:
    """Numbers of points, faces and corners as authored, to which interpolations refer."""

    point_count: int
    face_count: int
    corner_points: Array
    corner_faces: Array
    refine: Callable[[Primvar], Primvar] | None = None
    """For refined meshes: carries a primvar of the authored mesh over to the refined one."""
    assumed_order: bool = False
    """Whether points and faces are numbered as in Hydra (cubes): UsdGeom does not number them."""
    dropped: tuple[str, ...] = ()
    """Interpolations without a meaning on the converted gprim (curved gprims, cubics)."""
    varying_count: int | None = None
    """Number of varying values, where it differs from the number of points."""
    authored: Topology | None = None
    """For refined meshes: the counts that authored primvars have."""


def read_primvar(context: Context, prim: Usd.Prim, primvar: UsdGeom.Primvar) -> Primvar | None:
    """The primvar's values, or None (with a warning) where they cannot be used."""
    name = primvar.GetPrimvarName()
    value = primvar.Get(context.time)
    if value is None:
        return None
    values = np.atleast_1d(np.array(value, dtype=np.float64))
    if primvar.GetTypeName().isArray:
        size = max(1, primvar.GetElementSize())
        if len(values) % size:
            message = f"primvar '{name}' has {len(values)} values, which elements of {size} do not"
            context.ledger.warn("primvar-size-wrong", prim, f"{message} divide; it was left out")
            return None
        values = values.reshape(len(values) // size, -1) if len(values) else values.reshape(0, 1)
    else:
        values = values.reshape(1, -1)
    indices = None
    if primvar.IsIndexed():
        indices = np.array(primvar.GetIndices(context.time), dtype=np.int64)
        if len(indices) and (indices.min() < 0 or indices.max() >= len(values)):
            message = f"primvar '{name}' has indices outside its {len(values)} values"
            context.ledger.warn("primvar-index-out-of-range", prim, message)
            return None
    usable = in_float32(values)
    if not usable.all():
        message = f"primvar '{name}' has values that are not finite, taken as 0"
        context.ledger.warn("primvar-non-finite", prim, message)
        values = np.where(usable, values, 0.0)
    return Primvar(name, primvar.GetInterpolation(), values, indices)


def to_stream(
    context: Context, prim: Usd.Prim, primvar: Primvar, topology: Topology
) -> Stream | None:
    """The primvar over the corners of a surface, or None with `primvar-size-wrong`."""
    interpolation = primvar.interpolation
    count = len(primvar.values if primvar.indices is None else primvar.indices)
    if interpolation in topology.dropped and count == 1:
        interpolation = "constant"  # with several parts too, all have this value
    if interpolation in topology.dropped:
        message = f"primvar '{primvar.name}' ({interpolation}) has no place on the tessellation"
        context.ledger.warn("primvar-interpolation-dropped", prim, message)
        return None
    if topology.assumed_order and interpolation != "constant":
        message = f"'{primvar.name}' ({interpolation}) is laid over the cube's faces as in Hydra"
        context.ledger.warn("primvar-order-assumed", prim, message)
    counted = topology.authored or topology
    needed = {
        "constant": 1,
        "uniform": counted.face_count,
        "vertex": counted.point_count,
        "varying": counted.varying_count or counted.point_count,
        "faceVarying": len(counted.corner_points),
    }.get(interpolation)
    if needed is None or count < needed:
        message = (
            f"primvar '{primvar.name}' ({interpolation}) has {count} values,"
            f" {needed} are needed; it was left out"
        )
        context.ledger.warn("primvar-size-wrong", prim, message)
        return None
    if count > needed:
        message = f"primvar '{primvar.name}' ({interpolation}) has {count} values,"
        message += f" {needed} are needed; those beyond were left out"
        context.ledger.warn("primvar-size-wrong", prim, message)
    if topology.refine is not None:
        primvar = topology.refine(primvar)
    corners = len(topology.corner_points)
    if interpolation == "constant":
        ids = np.zeros(corners, dtype=np.int64)
    elif interpolation == "uniform":
        ids = topology.corner_faces
    elif interpolation == "faceVarying":
        ids = np.arange(corners)
    else:
        ids = topology.corner_points
    if primvar.indices is not None:
        ids = primvar.indices[ids]
    if interpolation in ("uniform", "faceVarying"):
        return face_varying_stream(primvar.values, ids)
    return Stream(primvar.values, ids, by_point=True)
