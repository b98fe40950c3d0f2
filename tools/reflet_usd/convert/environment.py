"""Dome lights to one panorama of all their radiance, in OpenEXR's latitude-longitude layout."""

import io
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from .context import Context, type_name
from .gltf_writer import GltfWriter
from .light_losses import light_value
from .scene import Array
from .sources import TextureRead
from .texture import ImageFile, TextureLibrary, between, is_srgb, srgb_to_linear

MOST_ACROSS = 4096
"""Pixels across of the widest panorama; larger ones are averaged."""
_MOST_HALF = 65504.0
_ROWS = 64
"""Rows of a panorama that are made at once, for little memory."""


@dataclass
class Dome:
    """A dome light: its radiance, and its directions."""

    radiance: Array
    """Radiance (3,) in nits, a factor on the pixels."""
    pixels: Array | None
    """Linear pixels (height, width, 3); None for one radiance in all directions."""
    layout: str
    from_file: Array
    """Matrix (3, 3) from directions of the file to directions of the texture, seen from within."""

    @property
    def width(self) -> int:
        """Pixels across of a panorama as fine as the texture."""
        if self.pixels is None:
            return 2
        scale = {"latlong": 1.0, "cubeMapVerticalCross": 4.0 / 3.0}.get(self.layout, 2.0)
        return math.ceil(self.pixels.shape[1] * scale)


def read_dome(context: Context, textures: TextureLibrary, prim: Usd.Prim, radiance: Array) -> None:
    """Note a dome light for the panorama; one whose texture is lost is black, as in Hydra."""
    asset = light_value(context, prim, "texture:file", None)
    pixels, layout = None, str(light_value(context, prim, "texture:format", "automatic"))
    if isinstance(asset, Sdf.AssetPath) and asset.path:
        read = TextureRead(str(prim.GetPath()), asset.resolvedPath, asset.path, ())
        file = textures.image(read, "it gives no light")
        pixels = np.zeros((1, 2, 3)) if file is None else _linear(read, file)
        if layout == "automatic":
            is_cross = pixels.shape[0] * 3 == pixels.shape[1] * 4
            layout = "cubeMapVerticalCross" if is_cross else "latlong"
    matrix = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(context.time)
    world = np.array(matrix)[:3, :3].T  # of column vectors
    if context.z_up:
        world = _Z_UP_TO_Y_UP @ world
    pole = prim.GetAttribute("poleAxis").Get(context.time) if type_name(prim) != "DomeLight" else ""
    if pole == "Z" or (pole == "scene" and context.z_up):
        world = world @ _Z_UP_TO_Y_UP.T
    if abs(np.linalg.det(world)) < 1e-30:
        context.ledger.warn("light-invalid", prim, "its transform flattens it, it is not turned")
        world = np.eye(3)
    if UsdGeom.Xformable(prim).TransformMightBeTimeVarying():
        message = "its rotation stays at the first value"
        context.ledger.warn("light-animation-frozen", prim, message)
    context.domes.append(Dome(radiance, pixels, layout, np.linalg.inv(world)))


def add_environment(context: Context, writer: GltfWriter) -> int | None:
    """Buffer view of the panorama, in OpenEXR; None where the stage has no dome light."""
    domes: list[Dome] = context.domes
    if not domes:
        return None
    import OpenEXR

    width = max(min(max(dome.width for dome in domes), MOST_ACROSS) // 2 * 2, 2)
    height = width // 2
    sky = np.zeros((height, width, 3), np.float32)
    for first in range(0, height, _ROWS):
        rows = np.arange(first, min(first + _ROWS, height))
        around = directions(rows, width, height)
        sky[rows] = sum(_radiance(dome, around) for dome in domes)
    sky = np.minimum(sky, np.finfo(np.float32).max)
    kind = np.float16 if float(sky.max()) <= _MOST_HALF else np.float32
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    stream = io.BytesIO()
    OpenEXR.File(header, {"RGB": sky.astype(kind)}).write(stream)
    return writer.add_view(stream.getvalue())


_Z_UP_TO_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


def directions(rows: Array, width: int, height: int) -> Array:
    """Directions (rows, width, 3) of a panorama's pixels: +Z in the middle, +X left of it."""
    longitude = (0.5 - (np.arange(width) + 0.5) / width) * 2.0 * math.pi
    colatitude = ((rows + 0.5) / height * math.pi)[:, None]
    across = np.sin(colatitude)
    y = np.broadcast_to(np.cos(colatitude), (len(rows), width))
    return np.stack([across * np.sin(longitude), y, across * np.cos(longitude)], axis=-1)


def _linear(read: TextureRead, file: ImageFile) -> Array:
    """Linear color of a texture, at most as large as a panorama may be."""
    if file.floats is not None:
        pixels = np.maximum(file.floats[..., :3], 0.0)
    else:
        pixels = file.rgba()[..., :3] / np.float32(255.0)
        pixels = srgb_to_linear(pixels) if is_srgb(read, file) else pixels
    times = math.ceil(pixels.shape[1] / MOST_ACROSS)
    if times > 1:
        pad = [(0, -size % times) for size in pixels.shape[:2]]
        pixels = np.pad(pixels, [*pad, (0, 0)], mode="edge")
        rows, columns = (size // times for size in pixels.shape[:2])
        pixels = pixels.reshape(rows, times, columns, times, 3).mean(axis=(1, 3))
    return pixels


def _radiance(dome: Dome, around: Array) -> Array:
    """Radiance of a dome in directions (rows, columns, 3)."""
    if dome.pixels is None:
        return np.broadcast_to(dome.radiance, around.shape)
    inside = around @ dome.from_file.T
    inside /= np.linalg.norm(inside, axis=-1, keepdims=True)
    # Axes of the texture, seen from within: to the right, up, and towards its middle.
    place = _PLACES.get(dome.layout, _latlong)(-inside[..., 0], inside[..., 1], inside[..., 2])
    wraps = ("repeat" if dome.layout == "latlong" else "clamp", "clamp")
    return between(dome.pixels, place, wraps) * dome.radiance


def _latlong(right: Array, up: Array, ahead: Array) -> tuple[Array, Array]:
    x = np.arctan2(right, ahead) / (2.0 * math.pi) + 0.5
    return x, np.arccos(np.clip(up, -1.0, 1.0)) / math.pi


def _disk(radius: Callable[[Array], Array]) -> Callable[[Array, Array, Array], tuple[Array, Array]]:
    """Places of a round image whose radius, 0 to 1, depends on the angle from its middle."""

    def places(right: Array, up: Array, ahead: Array) -> tuple[Array, Array]:
        across = np.hypot(right, up)
        scale = 0.5 * radius(np.arccos(np.clip(ahead, -1.0, 1.0))) / np.maximum(across, 1e-12)
        return 0.5 + right * scale, 0.5 - up * scale

    return places


def _cross(right: Array, up: Array, ahead: Array) -> tuple[Array, Array]:
    """Places in a vertical cross: up, then left, ahead and right, then down, then behind."""
    sizes = np.abs(np.stack([right, up, ahead]))
    axis = sizes.argmax(axis=0)
    most = sizes.max(axis=0)
    column, row, x, y = (np.empty_like(most) for _ in range(4))
    for which, positive, spot, s, t in (
        (0, True, (2, 1), -ahead, -up),
        (0, False, (0, 1), ahead, -up),
        (1, True, (1, 0), right, ahead),
        (1, False, (1, 2), right, -ahead),
        (2, True, (1, 1), right, -up),
        (2, False, (1, 3), right, up),
    ):
        here = (axis == which) & ((np.stack([right, up, ahead])[which] >= 0.0) == positive)
        column[here], row[here] = spot
        x[here], y[here] = (s / most)[here], (t / most)[here]
    return (column + (x + 1.0) / 2.0) / 3.0, (row + (y + 1.0) / 2.0) / 4.0


# The layouts of `inputs:texture:format`: Debevec's angular map and mirrored ball.
_PLACES = {
    "angular": _disk(lambda angle: angle / math.pi),
    "mirroredBall": _disk(lambda angle: np.sin(angle / 2.0)),
    "cubeMapVerticalCross": _cross,
}
