"""Geometry that changes as morph targets cannot: a mesh for each time code, shown in turn."""

import math
from collections.abc import Callable

import numpy as np
from pxr import Usd, UsdGeom

from .animation import set_visibility
from .context import Context
from .extras import is_custom
from .geometry import STILL, BuiltMesh, is_surface
from .scene import Node

MOST_FRAMES = 1000
MOST_WHOLE_CODES = 240
"""Maximum number of whole time codes at which values are shown that USD interpolates."""
MOST_POINTS = 20_000_000
_TOPOLOGY = ("faceVertexCounts", "faceVertexIndices", "holeIndices")


def held_codes(context: Context, prim: Usd.Prim) -> list[float]:
    """Time codes at which a gprim gets a mesh of its own; none where one mesh is enough.

    The codes of its samples, and whole codes between them where USD interpolates.
    """
    varying = _varying(prim)
    names = {attribute.GetName() for attribute in varying}
    if not names or (is_surface(prim) and _morphs(context, prim, names)):
        return []
    samples = sorted({code for attribute in varying for code in attribute.GetTimeSamples()})
    codes = context.codes_in_range(samples)
    if len(codes) < 2:
        return []
    whole = range(math.ceil(codes[0]), math.floor(codes[-1]) + 1)
    if len(whole) <= MOST_WHOLE_CODES and any(_interpolates(context, one) for one in varying):
        codes = sorted({*codes, *map(float, whole)})
    points = UsdGeom.PointBased(prim).GetPointsAttr() if prim.IsA(UsdGeom.PointBased) else None
    size = max((len(points.Get(code) or ()) for code in codes), default=0) if points else 0
    fits = len(codes) <= MOST_FRAMES and len(codes) * size <= MOST_POINTS
    seconds = np.array([context.seconds(code) for code in codes], dtype=np.float32)
    if not fits or (np.diff(seconds) <= 0.0).any():
        return []
    message = f"animated {', '.join(sorted(names))} are shown at {len(codes)} time codes"
    context.ledger.warn("geometry-animation-held", prim, f"{message}, held until the next")
    return codes


def draw_held(
    context: Context,
    node: Node,
    codes: list[float],
    build: Callable[[], BuiltMesh | None],
) -> bool:
    """Add a node for each time code, with the mesh of that time; False where nothing is drawn."""
    rest, context.is_held = context.time, True
    seconds = [context.seconds(code) for code in codes]
    drawn = False
    for index, code in enumerate(codes):
        context.time = Usd.TimeCode(code)
        built = build()
        if built is None:
            continue
        child = node.add(Node(f"{node.name} at {code:g}", mesh=built.index))
        if not drawn:
            node.extras.update(built.extras)
        drawn = True
        times = sorted({seconds[0], *seconds[index : index + 2]})
        shown = np.array([time == seconds[index] for time in times])
        set_visibility(child, np.array(times), shown)
    context.time, context.is_held = rest, False
    return drawn


def _varying(prim: Usd.Prim) -> list[Usd.Attribute]:
    """The gprim's own animated attributes that decide what it looks like."""
    return [
        attribute
        for attribute in prim.GetAuthoredAttributes()
        if attribute.ValueMightBeTimeVarying()
        and not attribute.GetName().startswith((*STILL, "inputs:", "light:"))
        and not is_custom(prim, attribute.GetName())
    ]


def _morphs(context: Context, prim: Usd.Prim, names: set[str]) -> bool:
    """Whether morph targets move the points: their number and the faces stay."""
    if "points" not in names or names & {*_TOPOLOGY} or context.options.subdiv_level > 0:
        return False
    attribute = prim.GetAttribute("points")
    values = (attribute.Get(code) for code in attribute.GetTimeSamples())
    return len({len(value) for value in values if value}) <= 1


def _interpolates(context: Context, attribute: Usd.Attribute) -> bool:
    """Whether USD gives values of its own between the first two samples."""
    if context.stage.GetInterpolationType() != Usd.InterpolationTypeLinear:
        return False
    codes = attribute.GetTimeSamples()
    if len(codes) < 2:
        return False
    first, last = (np.array(attribute.Get(code)) for code in codes[:2])
    return first.dtype.kind == "f" and first.shape == last.shape
