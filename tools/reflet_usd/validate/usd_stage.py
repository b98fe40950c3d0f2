"""Owns how the truth's stage is opened: variants, units, up axis, time, all through usd-core."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdGeom

from .facts import Array, StageError

_Z_UP_TO_Y_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""Row-vector rotation: Z becomes Y, Y becomes −Z."""


@dataclasses.dataclass
class TruthStage:
    """An opened stage with what is needed to express it in glTF's world."""

    stage: Usd.Stage
    purposes: tuple[str, ...]
    meters_per_unit: float
    z_up: bool
    codes_per_second: float
    time_origin: float
    """The time code that glTF's second 0 stands for."""
    subdiv_level: int
    """How many Catmull-Clark steps the output's subdivision meshes went through."""

    def world(self, matrix: Gf.Matrix4d) -> Array:
        """A USD local-to-world matrix as one to glTF's world in meters, scale included."""
        result = np.array(matrix, dtype=np.float64) * 1.0
        result[:, :3] *= self.meters_per_unit
        if self.z_up:
            result[:, :3] = result[:, :3] @ _Z_UP_TO_Y_UP
        return result

    def node_world(self, matrix: Gf.Matrix4d) -> Array:
        """The same where lengths are already meters: only the translation is scaled."""
        result = np.array(matrix, dtype=np.float64) * 1.0
        result[3, :3] *= self.meters_per_unit
        if self.z_up:
            result[:, :3] = result[:, :3] @ _Z_UP_TO_Y_UP
        return result

    def code_of(self, seconds: float) -> float:
        """The time code that is shown at `seconds` of the output."""
        return self.time_origin + seconds * self.codes_per_second


def open_truth(path: Path, settings: dict[str, Any]) -> TruthStage:
    """Open `path` with the purposes and variants of a sidecar's settings; raises StageError."""
    try:
        layer = Sdf.Layer.FindOrOpen(str(path))
        if layer is not None:
            _repair_time_rate(layer)
        stage = Usd.Stage.Open(str(path), Usd.Stage.LoadAll)
    except Tf.ErrorException as error:
        reason = str(error).strip().splitlines()[-1:]
        raise StageError(f"usd-core does not open {path}: {' '.join(reason)}") from None
    if stage is None:
        raise StageError(f"usd-core does not open {path}")
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for prim_path, set_name, variant in settings.get("variants") or ():
            stage.GetPrimAtPath(prim_path).GetVariantSet(set_name).SetVariantSelection(variant)
    units = _root_metadata(stage, "metersPerUnit")
    rate = _root_metadata(stage, "timeCodesPerSecond")
    rate = rate if rate is not None else _root_metadata(stage, "framesPerSecond")
    axis = _root_metadata(stage, "upAxis") or UsdGeom.GetFallbackUpAxis()
    return TruthStage(
        stage,
        tuple(settings.get("purpose") or ("default", "render")),
        float(units) if _is_positive(units) else 0.01,
        axis == "Z",
        float(rate) if _is_positive(rate) else 24.0,
        float(settings.get("timeOrigin") or 0.0),
        int(settings.get("subdivLevel") or 0),
    )


def sample_codes(prims: Iterable[Usd.Prim]) -> list[float]:
    """All time codes at which a transform or visibility of the given prims has a sample."""
    codes: set[float] = set()
    for prim in prims:
        imageable = UsdGeom.Imageable(prim)
        if not imageable:
            continue
        xformable = UsdGeom.Xformable(prim)
        if xformable:
            codes.update(xformable.GetTimeSamples())
        codes.update(imageable.GetVisibilityAttr().GetTimeSamples())
    return sorted(code for code in codes if math.isfinite(code))


def _repair_time_rate(layer: Sdf.Layer) -> None:
    """Give a layer whose rates are no rates USD's default, in memory: usd-core hangs on 0."""
    for name in ("timeCodesPerSecond", "framesPerSecond"):
        root = layer.pseudoRoot
        if root.HasInfo(name) and not _is_positive(root.GetInfo(name)):
            layer.pseudoRoot.ClearInfo(name)


def _root_metadata(stage: Usd.Stage, name: str) -> Any:
    # Typed getters throw where a float was authored for a double, so the raw field is read.
    for layer in (stage.GetSessionLayer(), stage.GetRootLayer()):
        if layer is not None and layer.pseudoRoot.HasInfo(name):
            return layer.pseudoRoot.GetInfo(name)
    return None


def _is_positive(value: Any) -> bool:
    return isinstance(value, (int, float)) and math.isfinite(value) and value > 0
