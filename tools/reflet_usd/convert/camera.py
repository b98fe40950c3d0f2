"""UsdGeomCamera to a glTF camera."""

import math
from typing import Any

from pxr import Usd, UsdGeom

from .context import Context, authored
from .gltf_writer import GltfWriter
from .scene import Node

# Apertures and focal length are in tenths of a scene unit (UsdGeomCamera).
_TENTH = 0.1
# Lenses beyond this have no field of view or no width in single precision.
_MOST_RATIO = 1e6


def add_camera(context: Context, writer: GltfWriter, prim: Usd.Prim, node: Node) -> None:
    """Give `node` the camera of `prim`; inputs that no pinhole has go to extras, with a warning."""

    def read(name: str, fallback: float) -> float:
        return float(authored(prim, name, context.time, fallback))

    width, height = read("horizontalAperture", 20.955), read("verticalAperture", 15.2908)
    focal = read("focalLength", 50.0)
    sizes = (width, height, focal)
    whole = all(math.isfinite(v) and v > 0.0 for v in sizes)
    if not whole or max(sizes) > _MOST_RATIO * min(sizes):
        message = f"apertures {width} × {height} and focal length {focal} make no camera"
        context.ledger.warn("camera-invalid", prim, message)
        return
    is_flat = authored(prim, "projection", context.time, "perspective") == "orthographic"
    near, far = _clip_planes(context, prim, is_flat)
    entry: dict[str, Any] = {"name": prim.GetName(), "extras": {"prim": str(prim.GetPath())}}
    if is_flat:
        scale = _TENTH * context.meters_per_unit / 2
        entry["type"] = "orthographic"
        entry["orthographic"] = {
            "xmag": width * scale,
            "ymag": height * scale,
            "zfar": far,
            "znear": near,
        }
    else:
        entry["type"] = "perspective"
        entry["perspective"] = {
            "aspectRatio": width / height,
            "yfov": 2.0 * math.atan(height / (2.0 * focal)),
            "zfar": far,
            "znear": near,
        }
    _keep_lens(context, prim, node)
    node.camera = writer.add("cameras", entry)
    _warn_animated(context, prim)


def _clip_planes(context: Context, prim: Usd.Prim, is_flat: bool) -> tuple[float, float]:
    near, far = (float(v) for v in authored(prim, "clippingRange", context.time, (1.0, 1e6)))
    near, far = near * context.meters_per_unit, far * context.meters_per_unit
    is_usable = math.isfinite(near) and math.isfinite(far) and 0.0 <= near < far
    if is_usable and (near > 0.0 or is_flat):
        return near, far
    message = f"clipping range {near} to {far} m is not usable, taken as 0.01 to 10000 m"
    context.ledger.warn("camera-clip-invalid", prim, message)
    return 0.01, 10_000.0


def _keep_lens(context: Context, prim: Usd.Prim, node: Node) -> None:
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
        if value != default:
            lens[name] = value
    planes = [
        [float(part) for part in p] for p in authored(prim, "clippingPlanes", context.time, ())
    ]
    if planes:
        lens["clippingPlanes"] = [p for p in planes if all(map(math.isfinite, p))]
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


def _warn_animated(context: Context, prim: Usd.Prim) -> None:
    names = [
        attribute.GetName()
        for attribute in UsdGeom.Camera(prim).GetPrim().GetAuthoredAttributes()
        if attribute.ValueMightBeTimeVarying()
        and not attribute.GetName().startswith(("xformOp", "visibility"))
    ]
    if names:
        message = f"animated {', '.join(sorted(names))} stay at their first value"
        context.ledger.warn("camera-animation-frozen", prim, message)
