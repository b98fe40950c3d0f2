"""Facts about the stage that every part of a conversion needs: units, axis, time, ledger."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdShade

from .confinement import Files
from .ledger import Ledger
from .scene import Array
from .types import ConvertOptions

# Time codes beyond this are damage: as seconds they would exceed float32's precision.
MAX_CODE = 1e9


@dataclass
class Context:
    """An opened stage and the facts that its conversion depends on."""

    stage: Usd.Stage
    options: ConvertOptions
    ledger: Ledger
    allowed_roots: tuple[str, ...]
    """Real paths of the folders that layers and textures may come from."""
    files: Files
    """Files that the stage's layers name."""
    meters_per_unit: float = 0.01
    z_up: bool = False
    codes_per_second: float = 24.0
    """Time codes per second."""
    time: Usd.TimeCode = field(default_factory=Usd.TimeCode.EarliestTime)
    """Time at which everything that is not animated in the file is evaluated."""
    is_held: bool = False
    """Whether `time` is one of several at which a gprim is drawn, so that nothing is frozen."""
    time_origin: float = 0.0
    """The time code that becomes 0 seconds."""
    stated_codes: tuple[float | None, float | None] = (None, None)
    """First and last time code that the stage states, or that `--frames` keeps."""
    domes: list[Any] = field(default_factory=list)
    """Dome lights that were met, see `environment.Dome`."""
    visited: str = "/"
    """Path of the prim that is being converted."""
    boxes: UsdGeom.BBoxCache | None = None
    """Cache of prim bounds at `time`, made when the first transform needs it."""
    bound_collections: set[str] | None = None
    """Paths of the collections that bind materials, found when the first collection is met."""
    previewed: bool = False
    """Whether a binding for the purpose `preview` was met."""
    missing_ops: dict[str, list[str]] = field(default_factory=dict)
    """Ops that `xformOpOrder` names but the prim does not have, by the prim's source path."""
    textures_read: set[str] = field(default_factory=set)
    """Resolved paths of the images that were opened."""
    patterns: dict[str, bytes] = field(default_factory=dict)
    """PNG files of patterns, by names that stand for paths of textures."""

    def seconds(self, code: float) -> float:
        """Seconds in the file of a time code of the stage."""
        return (code - self.time_origin) / self.codes_per_second

    def codes_in_range(self, codes: list[float]) -> list[float]:
        """The time codes kept under `--frames`, with the range's ends when keys lie outside."""
        near = [code for code in codes if abs(code) <= MAX_CODE]
        if len(near) < len(codes):
            message = f"time samples beyond ±{MAX_CODE:g} were dropped"
            self.ledger.warn("time-sample-dropped", self.visited, message)
            codes = near
        frames = self.options.frames
        if frames is None or not codes:
            return codes
        first, last = frames
        kept = [code for code in codes if first <= code <= last]
        if codes[0] < first and (not kept or kept[0] > first):
            kept.insert(0, first)
        if codes[-1] > last and kept and kept[-1] < last:
            kept.append(last)
        return kept


# Beyond float32's range a value is as good as infinite.
FLOAT32_LIMIT = 3e38


def in_float32(values: Array) -> Array:
    """Mask of the values that are finite as float32 (the same shape, bool)."""
    return np.asarray(np.abs(values) < FLOAT32_LIMIT)  # NaN is not below the limit either


def authored(prim: Usd.Prim, name: str, time: Usd.TimeCode, fallback: Any) -> Any:
    """Value of attribute `name` at `time`, or `fallback` where there is none."""
    attribute = prim.GetAttribute(name)
    value = attribute.Get(time) if attribute else None
    return fallback if value is None or isinstance(value, Sdf.ValueBlock) else value


def type_name(prim: Usd.Prim) -> str:
    """The prim's type, or its fallback in `fallbackPrimTypes` where USD lacks it."""
    return str(prim.GetPrimTypeInfo().GetSchemaTypeName() or prim.GetTypeName())


def first_value(attribute: Usd.Attribute) -> Any:
    """The first time sample that is a value; None where there is none."""
    values = (attribute.Get(code) for code in attribute.GetTimeSamples())
    return next((value for value in values if value is not None), None)


def source_path(prim: Usd.Prim) -> str:
    """The prim's path, in the shared prototype where the prim is part of a native instance."""
    source = prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim
    return str(source.GetPath())


def producer(node: UsdShade.Shader, name: str) -> tuple[Usd.Attribute | None, bool]:
    """The attribute that gives an input's value, if any, and whether it is a node's output."""
    shader_input = node.GetInput(name)
    attributes = shader_input.GetValueProducingAttributes() if shader_input else []
    if not attributes:
        return None, False
    kind = UsdShade.Utils.GetType(attributes[0].GetName())
    return attributes[0], kind == UsdShade.AttributeType.Output
