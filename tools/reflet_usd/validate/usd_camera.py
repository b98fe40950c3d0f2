"""Owns the truth about cameras: usd-core's own lens evaluation in glTF's terms."""

import math

from pxr import Gf, Usd, UsdGeom

from .scene_data import Camera, Lost
from .usd_stage import TruthStage

_FALLBACK_RANGE_M = (0.01, 10_000.0)
"""Schema fallback in meters; marks clipping ranges that glTF cameras cannot express."""
_MOST_SHIFT = 10.0
"""Maximum shift of the lens that Reflet reads, in heights of the picture."""
_MOST_PLANES = 6
"""Maximum number of clip planes that Reflet reads."""
_NOT_IN_GLTF = (
    "exposure",
    "exposure:fStop",
    "exposure:iso",
    "exposure:responsivity",
    "exposure:time",
    "fStop",
    "shutter:close",
    "shutter:open",
    "stereoRole",
)


def read_camera(
    prim: Usd.Prim, time: Usd.TimeCode, truth: TruthStage, world: Gf.Matrix4d
) -> Camera | None:
    """Camera at `time`, None where its lens is invalid; `world` is its local-to-world matrix."""
    lens = UsdGeom.Camera(prim).GetCamera(time)
    sizes = lens.horizontalAperture, lens.verticalAperture, lens.focalLength
    if not all(0.0 < size < math.inf for size in sizes) or max(sizes) > 1e6 * min(sizes):
        return None
    # usd-core returns the clipping range in the stage's units, as it does lengths of apertures
    # in tenths of them (GfCamera::APERTURE_UNIT).
    near, far = (
        end * truth.meters_per_unit for end in (lens.clippingRange.min, lens.clippingRange.max)
    )
    orthographic = lens.projection == Gf.Camera.Orthographic
    is_finite = math.isfinite(near) and math.isfinite(far)
    if not (is_finite and 0.0 <= near < far and (near > 0.0 or orthographic)):
        near, far = _FALLBACK_RANGE_M
    yfov = math.radians(lens.GetFieldOfView(Gf.Camera.FOVVertical))
    # Offsets move the window of the frustum in units of the aperture (GfCamera::GetFrustum).
    shift = (
        lens.horizontalApertureOffset / lens.verticalAperture,
        lens.verticalApertureOffset / lens.verticalAperture,
    )
    lost = _lost_inputs(prim, time)
    if not all(abs(part) <= _MOST_SHIFT for part in shift):
        lost.append(("lens-dropped", "ApertureOffset"))
        shift = (0.0, 0.0)
    # Planes are in the space of the camera (GfCamera::GetClippingPlanes), lengths in stage units.
    planes = [[*p[:3], p[3] * truth.meters_per_unit] for p in lens.clippingPlanes]
    usable = [p for p in planes if any(p[:3]) and all(abs(v) < 3e38 for v in p)][:_MOST_PLANES]
    if len(usable) < len(planes):
        lost.append(("lens-dropped", "clippingPlanes"))
    half_height = 0.5 * lens.verticalAperture * Gf.Camera.APERTURE_UNIT * truth.meters_per_unit
    return Camera(
        truth.node_world(world),
        None if orthographic else yfov,
        lens.aspectRatio,
        half_height if orthographic else None,
        near,
        far,
        shift,
        usable,
        lost,
    )


def _lost_inputs(prim: Usd.Prim, time: Usd.TimeCode) -> Lost:
    """Inputs that differ from the schema's fallback and have no field in a glTF camera."""
    lost: Lost = []
    definition = Usd.SchemaRegistry().FindConcretePrimDefinition("Camera")
    for name in _NOT_IN_GLTF:
        fallback = definition.GetAttributeFallbackValue(name)
        value = prim.GetAttribute(name).Get(time)
        if value is not None and value != fallback:
            lost.append(("lens-dropped", name))
    return lost
