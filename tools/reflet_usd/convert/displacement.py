"""Displacement of meshes: points that move along their normals by lengths of their materials."""

import math

import numpy as np
from pxr import Usd, UsdShade

from .channel_packing import Packer
from .mesh import computed_normals, drawn_faces
from .normals import unit_rows
from .polygons import Polygons
from .scene import Array
from .sources import Constant, Source, TextureRead
from .surface import Surface
from .texture import between, is_srgb, srgb_to_linear

_MOST_SIZES = 1000.0
"""Longest displacement, in sizes of the mesh."""


def may_displace(material: Usd.Prim | None) -> bool:
    """Whether a material has a displacement, if only of 0."""
    return material is not None and bool(UsdShade.Material(material).ComputeDisplacementSource()[0])


def is_displacing(source: Source | None) -> bool:
    """Whether a material's displacement may move anything."""
    return isinstance(source, TextureRead) or (
        isinstance(source, Constant) and source.value[0] != 0.0
    )


def displace(
    packer: Packer,
    surface: Surface,
    polygons: Polygons,
    parts: list[tuple[Source | None, Array]],
    stretch: Array,
) -> float:
    """Move the points of `surface` and make its normals anew; returns the longest way.

    Each part is the displacement of a material, in meters of the stage, and the triangles (n, 3)
    that show the material. `stretch` is (M Mᵀ)⁻¹ of the matrix M (3, 3) that places rows. A point
    that several parts share moves by their mean. Nothing moves where a way is too long, which is
    infinite then.
    """
    amounts = np.zeros(len(surface.corner_points))
    for source, triangles in parts:
        corners = triangles.reshape(-1)
        if isinstance(source, TextureRead) and packer.usable(source):
            amounts[corners] = _sampled(packer, source, surface, corners)
        elif isinstance(source, TextureRead):
            amounts[corners] = source.parts[0].fallback
        elif isinstance(source, Constant):
            amounts[corners] = source.value[0]
    corners = np.concatenate([triangles.reshape(-1) for _, triangles in parts])
    points, count = surface.corner_points[corners], len(surface.points)
    uses = np.maximum(np.bincount(points, minlength=count), 1)
    amount = np.bincount(points, weights=amounts[corners], minlength=count) / uses
    assert surface.normals is not None
    normals = surface.normals.values[surface.normals.ids[corners]]
    sums = [np.bincount(points, weights=axis, minlength=count) for axis in normals.T]
    mean = unit_rows(np.stack(sums, axis=1))
    # The placed normal is n (Mᵀ)⁻¹ / |n (Mᵀ)⁻¹|, and M⁻¹ takes a way along it back.
    ways = mean @ stretch
    ways *= (amount / np.sqrt(np.einsum("ij,ij->i", ways, mean)))[:, None]
    longest = float(np.linalg.norm(ways, axis=1).max(initial=0.0))
    size = float(np.linalg.norm(np.ptp(surface.points, axis=0)))
    if not longest <= _MOST_SIZES * size:
        return math.inf
    if longest > 0.0:
        surface.points = surface.points + ways
        surface.normals = computed_normals(polygons, surface.points, drawn_faces(polygons))
    return float(np.abs(amount).max(initial=0.0))


def _sampled(packer: Packer, read: TextureRead, surface: Surface, corners: Array) -> Array:
    """Values of a texture at corners, between the centers of the nearest texels."""
    file = packer.library.image(read)
    assert file is not None
    part, uv = read.parts[0], read.uv
    stream = surface.uvs.get(uv.primvar)
    st = np.tile(uv.fallback, (len(corners), 1))
    if stream is not None:
        st = stream.values[stream.ids[corners]]
    angle = math.radians(uv.rotation_deg)
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    st = st * uv.scale @ turn + uv.translation
    values = file.floats if file.floats is not None else file.rgba() / 255.0
    texels = values[::-1, :, part.channel]  # the first row is the lowest
    if is_srgb(read, file) and part.channel < 3:
        texels = srgb_to_linear(texels)
    found = between(texels[..., None], (st[:, 0], st[:, 1]), read.wrap)[:, 0]
    return np.asarray(found * part.scale + part.bias)
