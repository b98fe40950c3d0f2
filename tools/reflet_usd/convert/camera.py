"""UsdGeomCamera to a glTF camera."""

import functools
import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from pxr import Usd

from .context import Context, authored
from .gltf_writer import GltfWriter
from .keyframes import EXACT_TOLERANCE
from .samples import is_jump, seconds_of, value_codes, with_jumps
from .scene import Array, Node

# Apertures and focal length are in tenths of a scene unit (UsdGeomCamera).
_TENTH = 0.1
# Lenses beyond this have no field of view or no width in single precision.
_MOST_RATIO = 1e6
# Shifts of the lens beyond this, in heights of the picture, are not read by Reflet.
_MOST_SHIFT = 10.0
# Maximum number of clip planes that Reflet reads.
_MOST_PLANES = 6
# Numbers beyond this are infinite in single precision.
_MOST_METERS = 3e38
# Inputs of which the fields of a glTF camera are made.
_LENS = {"clippingRange", "focalLength", "horizontalAperture", "verticalAperture"}
# Maximum number of halvings between two keys of an animated lens.
_DEPTH = 8


def add_camera(context: Context, writer: GltfWriter, prim: Usd.Prim, node: Node) -> None:
    """Give `node` the camera of `prim`; inputs that no pinhole has go to extras, with a warning."""
    lens = _lens_at(context, prim, context.time)
    if lens is None:
        width, height, focal = _sizes(prim, context.time)
        message = f"apertures {width} × {height} and focal length {focal} make no camera"
        context.ledger.warn("camera-invalid", prim, message)
        return
    kind = "orthographic" if "ymag" in lens else "perspective"
    extras: dict[str, Any] = {"prim": str(prim.GetPath())}
    shift = _shift(prim, context.time)
    if any(shift) and all(abs(part) <= _MOST_SHIFT for part in shift):
        extras["lens_shift"] = shift
    planes = _planes(context, prim)
    if planes:
        extras["clip_planes"] = planes
    entry = {"name": prim.GetName(), "type": kind, kind: lens, "extras": extras}
    _keep_lens(context, prim, node, "lens_shift" in extras)
    node.camera = writer.add("cameras", entry)
    _animate(context, prim, node, kind)


def _sizes(prim: Usd.Prim, time: Usd.TimeCode) -> tuple[float, float, float]:
    """Width and height of the aperture, and focal length."""
    fallbacks = {"horizontalAperture": 20.955, "verticalAperture": 15.2908, "focalLength": 50.0}
    width, height, focal = (float(authored(prim, k, time, v)) for k, v in fallbacks.items())
    return width, height, focal


def _shift(prim: Usd.Prim, time: Usd.TimeCode) -> list[float]:
    """Shift of the lens to the right and up, in heights of the picture."""
    offsets = (f"{axis}ApertureOffset" for axis in ("horizontal", "vertical"))
    height = _sizes(prim, time)[1]
    return [float(authored(prim, name, time, 0.0)) / height for name in offsets]


def _planes(context: Context, prim: Usd.Prim) -> list[list[float]]:
    """Planes behind which the camera sees nothing, in meters and the space of its node."""
    planes = [
        [float(a), float(b), float(c), float(d) * context.meters_per_unit]
        for a, b, c, d in authored(prim, "clippingPlanes", context.time, ())
    ]
    usable = [p for p in planes if any(p[:3]) and all(abs(v) < _MOST_METERS for v in p)]
    kept = usable[:_MOST_PLANES]
    if len(kept) < len(planes):
        message = f"{len(planes) - len(kept)} of {len(planes)} clipping planes are not carried: "
        message += f"no finite numbers, no direction, or beyond the first {_MOST_PLANES}"
        context.ledger.warn("lens-dropped", prim, message)
    return kept


def _lens_at(context: Context, prim: Usd.Prim, time: Usd.TimeCode) -> dict[str, float] | None:
    """The fields of a glTF camera; None where apertures and focal length make none."""
    width, height, focal = sizes = _sizes(prim, time)
    whole = all(math.isfinite(v) and v > 0.0 for v in sizes)
    if not whole or max(sizes) > _MOST_RATIO * min(sizes):
        return None
    is_flat = authored(prim, "projection", context.time, "perspective") == "orthographic"
    near, far = _clip_planes(context, prim, is_flat, time)
    if is_flat:
        scale = _TENTH * context.meters_per_unit / 2
        fields = {"xmag": width * scale, "ymag": height * scale}
    else:
        fields = {"aspectRatio": width / height, "yfov": 2.0 * math.atan(height / (2.0 * focal))}
    return {**fields, "zfar": far, "znear": near}


def _clip_planes(
    context: Context, prim: Usd.Prim, is_flat: bool, time: Usd.TimeCode
) -> tuple[float, float]:
    near, far = (float(v) for v in authored(prim, "clippingRange", time, (1.0, 1e6)))
    near, far = near * context.meters_per_unit, far * context.meters_per_unit
    is_usable = math.isfinite(near) and math.isfinite(far) and 0.0 <= near < far
    if is_usable and (near > 0.0 or is_flat):
        return near, far
    message = f"clipping range {near} to {far} m is not usable, taken as 0.01 to 10000 m"
    context.ledger.warn("camera-clip-invalid", prim, message)
    return 0.01, 10_000.0


def _keep_lens(context: Context, prim: Usd.Prim, node: Node, is_shifted: bool) -> None:
    neutral = {
        "fStop": 0.0,
        "horizontalApertureOffset": 0.0,
        "verticalApertureOffset": 0.0,
        "shutter:open": 0.0,
        "shutter:close": 0.0,
        "exposure": 0.0,
        "exposure:fStop": 1.0,
        "exposure:iso": 100.0,
        "exposure:responsivity": 1.0,
        "exposure:time": 1.0,
        "stereoRole": "mono",
    }
    lens: dict[str, Any] = {}
    for name, default in neutral.items():
        value = authored(prim, name, context.time, default)
        if value != default and not (is_shifted and name.endswith("ApertureOffset")):
            lens[name] = value
    if lens.get("fStop") and math.isfinite(lens["fStop"]):
        lens["focusDistance_m"] = (
            authored(prim, "focusDistance", context.time, 0.0) * context.meters_per_unit
        )
    finite = {k: v for k, v in lens.items() if not isinstance(v, float) or math.isfinite(v)}
    if finite:
        node.extras["lens"] = finite
        message = f"a glTF camera has no {', '.join(finite)}; kept in extras"
        context.ledger.warn("lens-dropped", prim, message)
    lost = [name for name in lens if name not in finite]
    if lost:
        message = f"{', '.join(lost)}: not finite, not carried"
        context.ledger.warn("lens-dropped", prim, message)


def _animate(context: Context, prim: Usd.Prim, node: Node, kind: str) -> None:
    """Let the camera's fields follow the animated lens; name the inputs that stay as they are."""
    attributes = [
        attribute
        for attribute in prim.GetAuthoredAttributes()
        if attribute.ValueMightBeTimeVarying()
        and not attribute.GetName().startswith(("xformOp", "visibility"))
    ]
    moved = [attribute for attribute in attributes if attribute.GetName() in _LENS]
    found = {code for attribute in moved for code in value_codes(attribute)}
    codes = context.codes_in_range(sorted(found))
    stays = {attribute.GetName() for attribute in attributes}
    if len(codes) > 1:

        @functools.cache
        def evaluate(code: float) -> Array:
            lens = _lens_at(context, prim, Usd.TimeCode(code))
            return np.array([math.nan] if lens is None else list(lens.values()))

        keys = codes[:1]
        for first, last in itertools.pairwise(with_jumps(evaluate, codes)):
            keys += _halved(evaluate, first, last, _DEPTH)
        if all(np.isfinite(evaluate(code)).all() for code in keys):
            stays -= _LENS
            values = np.stack([evaluate(code) for code in keys])
            names = _lens_at(context, prim, context.time) or {}
            for name, column in zip(names, values.T, strict=True):
                if np.ptp(column) > 0.0:
                    path = f"/cameras/{node.camera}/{kind}/{name}"
                    node.add_track(path, seconds_of(context, keys), column.reshape(-1, 1))
    context.ledger.warn_frozen("camera-animation-frozen", prim, stays)


def _halved(
    evaluate: Callable[[float], Array], first: float, last: float, depth: int
) -> list[float]:
    """Codes after `first` up to `last`, between which linear values are near enough."""
    middle = (first + last) / 2
    straight = (evaluate(first) + evaluate(last)) / 2
    is_near = np.abs(evaluate(middle) - straight) <= EXACT_TOLERANCE * np.abs(straight)
    if depth == 0 or is_jump(first, last) or is_near.all() or not np.isfinite(straight).all():
        return [last]
    halves = ((first, middle), (middle, last))
    return [code for half in halves for code in _halved(evaluate, *half, depth - 1)]
