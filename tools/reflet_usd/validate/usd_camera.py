"""Owns the truth about cameras: usd-core's own lens evaluation in glTF's terms."""

from __future__ import annotations

import math

from pxr import Gf, Usd, UsdGeom

from .facts import Camera
from .usd_stage import TruthStage


def read_camera(
    prim: Usd.Prim, time: Usd.TimeCode, truth: TruthStage, world: Gf.Matrix4d
) -> Camera:
    """The camera at `time`; `world` is its local-to-world matrix in the stage."""
    lens = UsdGeom.Camera(prim).GetCamera(time)
    # usd-core returns the clipping range in the stage's units, as it does lengths of apertures
    # in tenths of them (GfCamera::APERTURE_UNIT).
    near, far = lens.clippingRange.min, lens.clippingRange.max
    orthographic = lens.projection == Gf.Camera.Orthographic
    yfov = math.radians(lens.GetFieldOfView(Gf.Camera.FOVVertical))
    half_height = 0.5 * lens.verticalAperture * Gf.Camera.APERTURE_UNIT * truth.meters_per_unit
    return Camera(
        truth.node_world(world),
        None if orthographic else yfov,
        lens.aspectRatio,
        half_height if orthographic else None,
        near * truth.meters_per_unit,
        far * truth.meters_per_unit,
    )
