"""Owns the check of the environment: the file's panorama against the stage's dome lights."""

import math
from collections.abc import Callable

import numpy as np
from pxr import Usd, UsdGeom, UsdLux
from scipy.ndimage import map_coordinates

from .checks import Checks
from .gltf_scene import OutputReader
from .images import decode, srgb_to_linear
from .scene_data import Array
from .usd_light import read_radiance
from .usd_material import load_texture
from .usd_stage import TruthStage

_SAMPLES = 1024
_WIDEST = 4096
"""Width to which `convert` reduces; textures that are wider are not compared."""
_HALF_FLOAT = 2.0**-11


def compare_environment(
    checks: Checks, truth: TruthStage, output: OutputReader, rest: Usd.TimeCode
) -> None:
    """Compare the panorama at pixels spread over it with the sum of the domes there."""
    domes = list(_domes(truth, rest))
    extras = (output.file.tree.get("scenes") or [{}])[0].get("extras") or {}
    view = (extras.get("usd") or {}).get("environment")
    if view is None or not domes:
        checks.add("lights", "/", int(view is not None or bool(domes)), "only one has domes")
        return
    image = decode(output.file.view_bytes(view), clip=False)
    if image is None:
        checks.add("lights", "/", 1, "its panorama cannot be read")
        return
    width, height = image.size
    random = np.random.default_rng(1)
    column, row = (random.integers(0, size, _SAMPLES) for size in (width, height))
    longitude = math.pi - (column + 0.5) / width * 2.0 * math.pi
    latitude = math.pi / 2.0 - (row + 0.5) / height * math.pi
    around = np.stack(
        [
            np.cos(latitude) * np.sin(longitude),
            np.sin(latitude),
            np.cos(latitude) * np.cos(longitude),
        ],
        axis=1,
    )
    parts = [part for part in (dome(around) for dome in domes) if part is not None]
    if len(parts) < len(domes):
        return
    expected, found = np.sum(parts, axis=0), image.values[row, column, :3]
    level = max(float(np.abs(expected).max()), 1e-30)
    worst = np.abs(expected - found) / (np.abs(expected) + 1e-3 * level)
    checks.add("lights", "/", max(float(worst.max()) - _HALF_FLOAT, 0.0), "its panorama")


Sky = Callable[[Array], Array | None]


def _domes(truth: TruthStage, rest: Usd.TimeCode) -> list[Sky]:
    return [
        _dome(truth, prim, rest)
        for prim in Usd.PrimRange(truth.stage.GetPseudoRoot(), Usd.TraverseInstanceProxies())
        if prim.GetPrimTypeInfo().GetSchemaTypeName() in ("DomeLight", "DomeLight_1")
        and UsdGeom.Imageable(prim).ComputeVisibility(rest) != UsdGeom.Tokens.invisible
    ]


def _dome(truth: TruthStage, prim: Usd.Prim, rest: Usd.TimeCode) -> Sky:
    """Radiance of a dome by directions (n, 3) of the file."""
    level = read_radiance(prim, rest)
    asset = UsdLux.DomeLight(prim).GetTextureFileAttr().Get(rest)
    if not (asset and asset.path):
        return lambda around: np.broadcast_to(level, around.shape)
    texels = load_texture(asset.resolvedPath, truth.roots, clip=False)
    if texels is None:
        return lambda around: np.zeros(around.shape)
    values = texels.values[..., :3]
    if texels.eight_bit and texels.channels > 2:
        values = srgb_to_linear(values)
    layout = str(prim.GetAttribute("inputs:texture:format").Get(rest))
    tall = values.shape[0] * 3 == values.shape[1] * 4
    axis = prim.GetAttribute("poleAxis").Get(rest) if prim.HasAttribute("poleAxis") else "Y"
    is_z = axis == "Z" or (axis == "scene" and truth.z_up)
    world = truth.node_world(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(rest))[:3, :3]
    inverse = np.linalg.inv(world)

    def radiance(around: Array) -> Array | None:
        if values.shape[1] > _WIDEST:
            return None
        x, y, z = (around @ inverse).T
        if is_z:  # the pole is at +Z, the middle of the texture at -Y
            y, z = z, -y
        length = np.sqrt(x * x + y * y + z * z)
        x, y, z = x / length, y / length, z / length
        if layout == "latlong" or (layout == "automatic" and not tall):
            s, t = 0.5 - np.arctan2(x, z) / math.tau, 0.5 - np.arcsin(y) / math.pi
        elif layout == "angular" or layout == "mirroredBall":
            turn, angle = np.arctan2(y, -x), np.arccos(z)
            radius = angle / math.pi if layout == "angular" else np.sin(angle / 2.0)
            s, t = (1.0 + radius * np.cos(turn)) / 2.0, (1.0 - radius * np.sin(turn)) / 2.0
        else:
            s, t = _in_cross(x, y, z)
        rows, columns = values.shape[:2]
        wrapped = np.concatenate([values[:, -1:], values, values[:, :1]], axis=1)
        flat = layout in ("angular", "mirroredBall") or tall
        source = np.pad(values, ((0, 0), (1, 1), (0, 0)), mode="edge") if flat else wrapped
        place = np.array([t * rows - 0.5, s * columns + 0.5])
        bands = [map_coordinates(source[..., i], place, order=1, mode="nearest") for i in range(3)]
        return np.stack(bands, axis=1) * level

    return radiance


def _in_cross(x: Array, y: Array, z: Array) -> tuple[Array, Array]:
    """Places in a vertical cross, whose middle is +Z, with +X left of it."""
    s, t = np.empty_like(x), np.empty_like(x)
    for index, (a, b, c) in enumerate(np.stack([x, y, z], axis=1)):
        if abs(c) >= max(abs(a), abs(b)):
            turn = 1.0 if c > 0 else -1.0
            spot = (1.5 - 0.5 * a / abs(c), (1.5 if c > 0 else 3.5) - turn * 0.5 * b / abs(c))
        elif abs(b) >= abs(a):
            turn = 1.0 if b > 0 else -1.0
            spot = (1.5 - 0.5 * a / abs(b), (0.5 if b > 0 else 2.5) + turn * 0.5 * c / abs(b))
        else:
            turn = 1.0 if a > 0 else -1.0
            spot = ((0.5 if a > 0 else 2.5) + turn * 0.5 * c / abs(a), 1.5 - 0.5 * b / abs(a))
        s[index], t[index] = spot[0] / 3.0, spot[1] / 4.0
    return s, t
