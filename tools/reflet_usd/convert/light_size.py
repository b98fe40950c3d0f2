"""Power of lights that depends on their size in the world, for each instance.

An area light sends Φ = π·L·A, A the area of its transformed surface. A sphere that the world
stretches is an ellipsoid: by Cauchy's theorem its mean projected area is a quarter of its surface.
"""

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Usd

from .context import Context, in_float32
from .gltf_writer import GltfWriter
from .scene import Array, Node, Track
from .xform import Trs

_SAME = 1e-6
"""Sizes and powers whose ratio differs from 1 by less than this are equal."""
_NOTHING = 1e-12
_FLAT = ("rectangle", "disk")
_STRAIGHT = 0.05
_MAX_TIMES = 65
_MAX_SHOWN = 3
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(64)


@dataclass(frozen=True)
class Emitter:
    """A light whose power depends on its size."""

    prim: Usd.Prim
    gain: float
    """Brightest part of the light's color, a factor of the intensity."""
    shape: str
    """sphere, rectangle, disk or cylinder."""
    sizes: tuple[float, float]
    """Meters before the world scale: radius twice; width and height; length and radius."""
    power_per_area: float
    """π·L in lm/m², or lm where `normalize` makes the power independent of the size."""
    normalize: bool
    solid_angle: float
    """Solid angle over which the power is spread, in steradians."""


@dataclass
class _Use:
    node: Node
    area: float
    even: bool
    """Whether the world stretches the light equally along all its axes."""
    tilt: float
    """Degrees between glTF's light axis and a flat surface's normal; NaN without a flat surface."""


def size_lights(
    context: Context, writer: GltfWriter, roots: Sequence[Node], emitters: dict[int, Emitter]
) -> None:
    """Give each node's light the power of its world size; equal powers share an entry."""
    if not emitters:
        return
    parents = {id(child): node for root in roots for node in root.walk() for child in node.children}
    uses: dict[int, list[_Use]] = {index: [] for index in emitters}
    for node in (node for root in roots for node in root.walk()):
        if node.light not in emitters:
            continue
        emitter = emitters[node.light]
        chain = [node]
        while id(chain[-1]) in parents:
            chain.append(parents[id(chain[-1])])
        use = _measure(emitter, node, _linear(chain, lambda _: None))
        uses[node.light].append(use)
        if not emitter.normalize and _grows(emitter, chain, use.area):
            message = "animated world sizes stay at their first value"
            context.ledger.warn("light-animation-frozen", emitter.prim, message)
    for index, found in uses.items():
        if found:  # else the light's node was left out
            _write(context, writer, index, emitters[index], found)


def _measure(emitter: Emitter, node: Node, linear: Array) -> _Use:
    stretch = np.linalg.svd(linear, compute_uv=False) if np.isfinite(linear).all() else np.ones(3)
    even = bool(stretch[0] - stretch[2] <= _SAME * stretch[0])
    area = world_area(emitter.shape, emitter.sizes, linear)
    return _Use(node, area, even, _tilt(linear) if emitter.shape in _FLAT else 0.0)


def _tilt(linear: Array) -> float:
    x, y, axis = linear.T
    normal = np.cross(x, y)
    reach = float(np.linalg.norm(normal) * np.linalg.norm(axis))
    if not reach > 0.0:
        return math.nan if float(np.linalg.norm(normal)) > 0.0 else 0.0
    return math.degrees(math.acos(min(abs(float(normal @ axis)) / reach, 1.0)))


def _write(
    context: Context, writer: GltfWriter, first: int, emitter: Emitter, uses: list[_Use]
) -> None:
    """Write one entry for each distinct power, and warn about the shape that is lost."""
    entries: dict[float, int] = {}
    extras = writer.lists["lights"][first]["extras"]
    faded = False
    for use in uses:
        power = emitter.power_per_area * (1.0 if emitter.normalize else use.area)
        candela = power / emitter.solid_angle
        bright = emitter.gain * candela
        if not in_float32(np.array(bright)):
            faded, bright = True, 0.0
        key = float(f"{bright:.7g}")
        if key not in entries:
            entry = {**writer.lists["lights"][first], "intensity": bright}
            if emitter.shape != "sphere" or not use.even:
                shape = "ellipsoid" if emitter.shape == "sphere" else emitter.shape
                area = {"shape": shape, "area_m2": use.area, "power_lm": power}
                entry["extras"] = {**extras, "area_light": area}
            entries[key] = writer.add("lights", entry) if entries else first
            writer.lists["lights"][entries[key]] = entry
        use.node.light = entries[key]
    if faded:
        message = "its intensity is not finite, taken as 0"
        context.ledger.warn("light-invalid", emitter.prim, message)
    _warn_shape(context, emitter, uses)


def _warn_shape(context: Context, emitter: Emitter, uses: list[_Use]) -> None:
    shape = emitter.shape
    if shape == "sphere":
        if all(use.even for use in uses) or emitter.sizes[0] == 0.0:
            return
        shape, uses = "ellipsoid", [use for use in uses if not use.even]
    areas = sorted({float(f"{use.area:.3g}") for use in uses})
    if len(areas) <= _MAX_SHOWN:
        size = ", ".join(f"{area:.3g}" for area in areas)
    else:
        size = f"{areas[0]:.3g} to {areas[-1]:.3g}"
    message = f"its {size} m² {shape} became a point of equal power"
    if len(areas) == 1:
        power = emitter.power_per_area * (1.0 if emitter.normalize else uses[0].area)
        message += f", {power:.6g} lm"
    tilts = [use.tilt for use in uses]
    if any(math.isnan(tilt) for tilt in tilts):
        message += "; the world flattens the axis that it shines along"
    elif max(tilts) > _STRAIGHT:
        message += f"; it shines up to {max(tilts):.1f}° off its surface's normal"
    context.ledger.warn("area-light-approximated", emitter.prim, message)


def world_area(shape: str, sizes: tuple[float, float], linear: Array) -> float:
    """Area in m² of a light's surface under the matrix `linear`, for column vectors.

    Rectangles and disks emit from one side, which alone counts; a cylinder has no caps.
    """
    x, y, z = linear.T
    with np.errstate(all="ignore"):
        if shape == "rectangle":
            area = sizes[0] * sizes[1] * np.linalg.norm(np.cross(x, y))
        elif shape == "disk":
            area = math.pi * sizes[0] * sizes[1] * np.linalg.norm(np.cross(x, y))
        elif shape == "cylinder":  # along x; around it an ellipse of the areas that x sweeps
            swept = np.stack([np.cross(x, y), np.cross(x, z)])
            area = sizes[0] * sizes[1] * _perimeter(*_singular(swept))
        else:
            area = sizes[0] ** 2 * _ellipsoid(*_singular(linear))
    nothing = _NOTHING * float(np.square(linear).max())  # areas below this are rounding errors of 0
    return float(area) if not area <= nothing * sizes[0] * sizes[1] else 0.0


def _singular(matrix: Array) -> tuple[float, ...]:
    if not np.isfinite(matrix).all():
        return (math.nan,) * min(matrix.shape)
    return tuple(float(value) for value in np.linalg.svd(matrix, compute_uv=False))


def _perimeter(a: float, b: float) -> float:
    """Perimeter of an ellipse with half axes a ≥ b, by the arithmetic-geometric mean (exact)."""
    if not (math.isfinite(a) and a > 0.0):
        return a * 0.0
    ratio = b / a
    if ratio < 1e-12:
        return 4.0 * a
    mean, root, weight, lost = 1.0, ratio, 0.5, 1.0 - ratio**2
    total = 0.5 * lost
    while mean - root > 1e-15:
        half = 0.5 * (mean - root)
        mean, root = 0.5 * (mean + root), math.sqrt(mean * root)
        weight *= 2.0
        total += weight * half**2
    return a * 2.0 * math.pi / mean * (1.0 - total)


def _ellipsoid(a: float, b: float, c: float) -> float:
    """Area of an ellipsoid with half axes a ≥ b ≥ c, summed from the perimeters at each height."""
    if not math.isfinite(a) or a <= 0.0:
        return a * 0.0
    heights = 0.5 * (_NODES + 1.0)
    rim = 1.0 - heights**2
    long = np.sqrt(rim * (a * c) ** 2 + (a * b * heights) ** 2)
    short = np.sqrt(rim * (b * c) ** 2 + (a * b * heights) ** 2)
    rings = [_perimeter(p, q) for p, q in zip(long.tolist(), short.tolist(), strict=True)]
    return float(_WEIGHTS @ np.array(rings))


def _grows(emitter: Emitter, chain: list[Node], first: float) -> bool:
    """Whether the light's area changes while the nodes above it turn and stretch."""
    tracks = [t for node in chain for t in node.tracks if t.path in ("rotation", "scale")]
    if not tracks:
        return False
    keys = np.unique(np.concatenate([track.times for track in tracks]))
    times = np.unique(np.concatenate([keys, 0.5 * (keys[1:] + keys[:-1])]))
    places = np.unique(np.linspace(0, len(times) - 1, min(len(times), _MAX_TIMES)).astype(int))
    for seconds in times[places].tolist():
        linear = _linear(chain, functools.partial(_value, seconds=seconds))
        area = world_area(emitter.shape, emitter.sizes, linear)
        if abs(area - first) > _SAME * max(area, first):
            return True
    return False


def _linear(chain: list[Node], value: Callable[[Track], Array | None]) -> Array:
    """Linear part of a node's world matrix; `chain` leads from the node to its root."""
    result = np.eye(3)
    for node in reversed(chain):
        parts: dict[str, Array | None] = {"rotation": node.rotation, "scale": node.scale}
        for track in node.tracks:
            moved = value(track) if track.path in parts else None
            if moved is not None:
                parts[track.path] = moved
        turn, scale = parts["rotation"], parts["scale"]
        turn = np.array([0.0, 0.0, 0.0, 1.0]) if turn is None else turn
        scale = np.ones(3) if scale is None else scale
        result = result @ Trs(np.zeros(3), turn, scale).matrix()[:3, :3]
    return result


def _value(track: Track, seconds: float) -> Array:
    """Value of the track at `seconds`; quaternions are blended and normalized."""
    after = int(np.searchsorted(track.times, seconds, side="right"))
    if after == 0 or after == len(track.times) or track.step:
        row: Array = track.keys()[max(after - 1, 0)]
        return row
    first, last = track.keys()[after - 1], track.keys()[after]
    share = (seconds - track.times[after - 1]) / (track.times[after] - track.times[after - 1])
    mixed = first + (last - first) * share
    length = float(np.linalg.norm(mixed))
    return mixed / length if track.path == "rotation" and length > 0.0 else mixed
