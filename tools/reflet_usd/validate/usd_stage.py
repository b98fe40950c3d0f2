"""Owns opening the truth's stage: variants, units, up axis, time, all through usd-core."""

import contextlib
import dataclasses
import itertools
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Ar, Gf, Sdf, Tf, Usd, UsdGeom

from reflet_usd.materialx_document import Document, DocumentError, is_document, read_document, refer
from reflet_usd.stage_files import (
    error_text,
    is_positive,
    is_rate,
    is_within,
    outer_file,
    stage_metadata,
    state_rates,
    turn_separators,
)

from .scene_data import Array, StageError

_SPLINE_PROBES = (0.17, 0.39, 0.68, 0.91)
_HALF_TYPES = ("half", "half3", "quath")
MAX_CODE = 1e9
"""Samples beyond this are declared as dropped."""
_Z_UP_TO_Y_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""Row-vector rotation: Z becomes Y, Y becomes −Z."""


@dataclasses.dataclass
class TruthStage:
    """An opened stage, with the values that express it in glTF's world."""

    stage: Usd.Stage
    purposes: tuple[str, ...]
    meters_per_unit: float
    z_up: bool
    codes_per_second: float
    time_origin: float
    """Time code of second 0 in glTF."""
    subdiv_level: int
    """Number of Catmull-Clark steps of the output's subdivision meshes."""
    roots: tuple[str, ...]
    """The folders that layers and textures may come from."""
    documents: list[Document]
    """MaterialX documents, whose layers live as long as this."""

    def world(self, matrix: Gf.Matrix4d) -> Array:
        """A USD local-to-world matrix as one to glTF's world in meters, scale included."""
        result = _without_w(matrix)
        result[:, :3] *= self.meters_per_unit
        if self.z_up:
            result[:, :3] = result[:, :3] @ _Z_UP_TO_Y_UP
        return result

    def node_world(self, matrix: Gf.Matrix4d) -> Array:
        """World matrix where lengths are already meters: only the translation is scaled."""
        result = _without_w(matrix)
        result[3, :3] *= self.meters_per_unit
        if self.z_up:
            result[:, :3] = result[:, :3] @ _Z_UP_TO_Y_UP
        return result


def _without_w(matrix: Gf.Matrix4d) -> Array:
    """The matrix with a constant w divided out; one with perspective stays as it is."""
    result = np.array(matrix, dtype=np.float64)
    w = float(result[3, 3])
    if not result[:3, 3].any() and w not in (0.0, 1.0):
        result /= w
    return result


def open_truth(path: Path, settings: dict[str, Any]) -> TruthStage:
    """Open `path` with the purposes and variants of a sidecar's settings; raises StageError."""
    try:
        _forget_old_layers()
        layer = Sdf.Layer.FindOrOpen(str(path))
        if layer is not None:
            _repair_time_rate(layer)
        stage = Usd.Stage.Open(str(path), Usd.Stage.LoadAll)
    except Tf.ErrorException as error:
        reason = error_text(error, path)
        raise StageError(f"usd-core does not open {path}: {reason}") from None
    if stage is None:
        raise StageError(f"usd-core does not open {path}")
    roots = tuple(
        os.path.realpath(root) for root in (path.resolve().parent, *(settings.get("roots") or ()))
    )
    _confine(stage, roots)
    for layer in _layers_of(stage):
        turn_separators(layer)
    documents = _stand_in_documents(stage, roots)
    _confine(stage, roots)
    state_rates(stage)  # for the times that baking writes
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for prim_path, set_name, variant in settings.get("variants") or ():
            stage.GetPrimAtPath(prim_path).GetVariantSet(set_name).SetVariantSelection(variant)
    _confine(stage, roots)  # again, for the layers of variants
    units = stage_metadata(stage, "metersPerUnit")
    rate = stage_metadata(stage, "timeCodesPerSecond")
    rate = rate if rate is not None else stage_metadata(stage, "framesPerSecond")
    axis = stage_metadata(stage, "upAxis") or UsdGeom.GetFallbackUpAxis()
    return TruthStage(
        stage,
        tuple(settings.get("purpose") or ("default", "render")),
        float(units) if is_positive(units) else 0.01,
        axis == "Z",
        float(rate) if is_rate(rate) else 24.0,
        float(settings.get("timeOrigin") or 0.0),
        int(settings.get("subdivLevel") or 0),
        roots,
        documents,
    )


def _forget_old_layers() -> None:
    """Reload layers that this process has cached from earlier stages.

    USD frees a stage's layers on another thread some time after the stage is gone; until then it
    hands out layers with their old content, or with edits in memory.
    """
    for layer in Sdf.Layer.GetLoadedLayers():
        outer = outer_file(layer.realPath) if layer else ""
        if layer and not layer.anonymous and os.path.isfile(outer):
            with contextlib.suppress(Tf.ErrorException):  # opening the broken layer reports it
                layer.Reload(force=True)


def _confine(stage: Usd.Stage, roots: tuple[str, ...]) -> None:
    """Mute all layers outside the folders: the converter was not allowed to read them."""
    tried: set[str] = set()
    while True:
        # A layer that was muted before the stage was opened still counts as used, without content.
        layers = [
            layer for layer in stage.GetUsedLayers() if layer.realPath and not layer.IsMuted()
        ]
        # Muting one layer releases the layers that only it brought.
        outside = {layer.identifier for layer in layers if not is_within(layer.realPath, roots)}
        if not outside:
            return
        if outside <= tried:
            raise StageError(f"usd-core reads @{min(outside)}@, which is outside the folders")
        tried |= outside
        for identifier in outside:
            stage.MuteLayer(identifier)


def sample_codes(stage: Usd.Stage) -> list[float]:
    """Time codes at which anything placed in space has a sample or a spline knot."""
    codes: set[float] = set()
    for attribute in _placed_attributes(stage):
        codes.update(attribute.GetTimeSamples())
        if attribute.HasSpline():
            codes.update(attribute.GetSpline().GetKnots().keys())
    return sorted(code for code in codes if abs(code) <= MAX_CODE)


def stated_codes(stage: Usd.Stage) -> tuple[float | None, float | None]:
    """Start and end time code that the stage states; None where missing or out of range."""
    stated = (stage_metadata(stage, name) for name in ("startTimeCode", "endTimeCode"))
    start, end = (
        float(code) if isinstance(code, (int, float)) and abs(code) <= MAX_CODE else None
        for code in stated
    )
    return start, end


def codes_between(stage: Usd.Stage, codes: list[float], count: int) -> list[float]:
    """`count` codes spread evenly over the stage's stated range, or else over the range of `codes`.

    Empty where no value may vary over time: that asks USD itself, which also knows of splines and
    of value clips.
    """
    if not any(_may_vary(attribute) for attribute in _placed_attributes(stage)):
        return []
    start, end = stated_codes(stage)
    low = min(codes, default=0.0) if start is None else start
    high = max(codes, default=0.0) if end is None else end
    return np.linspace(low, high, count + 2)[1:-1].tolist() if low < high else []


def may_move(stage: Usd.Stage) -> bool:
    """Whether any value of the stage may vary over time."""
    roots = (stage.GetPseudoRoot(), *stage.GetPrototypes())
    prims = (prim for root in roots for prim in Usd.PrimRange(root))
    return any(_may_vary(a) for prim in prims for a in prim.GetAuthoredAttributes())


def _may_vary(attribute: Usd.Attribute) -> bool:
    """Whether a value may vary over time, or moves others by a single sample."""
    moves = attribute.GetName() in ("velocities", "angularVelocities")
    return bool(attribute.ValueMightBeTimeVarying() or (moves and attribute.GetNumTimeSamples()))


def codes_in_splines(stage: Usd.Stage) -> list[float]:
    """Codes within the segments of every spline, unevenly placed: curves may meet a line halfway.

    Of splines with too many segments to look at all, evenly chosen ones count.
    """
    codes: set[float] = set()
    for attribute in _placed_attributes(stage):
        if attribute.HasSpline():
            spline = attribute.GetSpline()
            knots = [float(code) for code in spline.GetKnotsWithInnerLoopsBaked()]
            for first, last in itertools.pairwise(sorted(knots)):
                codes.update(first + (last - first) * share for share in _SPLINE_PROBES)
    return sorted(code for code in codes if abs(code) <= MAX_CODE)


@dataclasses.dataclass
class KeyedOnly:
    """Prims whose values are exact only at their own keys: time codes by prim path."""

    prims: dict[str, set[float]]
    """Instancers with moving orientations, which USD interpolates in half precision."""
    normals: dict[str, set[float]]
    """Meshes whose normals follow their points: glTF blends the normals themselves."""
    subtrees: dict[str, set[float]]
    """Prims with half-precision xformOps; all that is below them moves along."""

    def between(self, code: float, keys: Iterable[str]) -> frozenset[str]:
        """Prims of `keys` that are between keys at `code`."""
        moving = [path for path, own in self.subtrees.items() if code not in own]
        found = {prim for prim, own in self.prims.items() if code not in own}
        for key in keys if moving else ():
            if any(key == path or key.startswith(path + "/") for path in moving):
                found.add(key)
        return frozenset(found)


def keyed_only(stage: Usd.Stage) -> KeyedOnly:
    """Prims that must not be compared between their keys."""
    result = KeyedOnly({}, {}, {})
    moving = {
        "orientations": result.prims,
        "points": result.normals,
        "normals": result.normals,
        "primvars:normals": result.normals,
    }
    everything = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), everything):
        for name, found in moving.items():
            attribute = prim.GetAttribute(name)
            moves = name == "points" and has_samples(prim, "velocities")
            if attribute and (moves or attribute.ValueMightBeTimeVarying()):
                path = str(prim.GetPath())
                found.setdefault(path, set()).update(attribute.GetTimeSamples())
        for op in UsdGeom.Xformable(prim).GetOrderedXformOps() if _is_placed(prim) else ():
            if str(op.GetTypeName()) in _HALF_TYPES and op.MightBeTimeVarying():
                own = result.subtrees.setdefault(str(prim.GetPath()), set())
                own.update(op.GetTimeSamples())
    return result


def has_samples(prim: Usd.Prim, *names: str) -> bool:
    """Whether some attribute of these names has time samples."""
    attributes = (prim.GetAttribute(name) for name in names)
    return any(attribute and attribute.GetNumTimeSamples() for attribute in attributes)


def _is_placed(prim: Usd.Prim) -> bool:
    return bool(prim.IsA(UsdGeom.Xformable))


def _placed_attributes(stage: Usd.Stage) -> Iterator[Usd.Attribute]:
    # Prototypes are walked instead of instances, since nesting can make any number of these.
    for root in (stage.GetPseudoRoot(), *stage.GetPrototypes()):
        for prim in Usd.PrimRange(root):
            if prim.IsA(UsdGeom.Imageable):
                yield from prim.GetAuthoredAttributes()


def _repair_time_rate(layer: Sdf.Layer) -> None:
    """Give a layer with invalid rates USD's default, in memory: usd-core hangs on 0."""
    for name in ("timeCodesPerSecond", "framesPerSecond"):
        root = layer.pseudoRoot
        if root.HasInfo(name) and not is_rate(root.GetInfo(name)):
            layer.pseudoRoot.ClearInfo(name)


def _layers_of(stage: Usd.Stage) -> Iterator[Sdf.Layer]:
    """Layers of the stage, also new layers that changes of the others bring."""
    done: set[str] = set()
    while layers := [layer for layer in stage.GetUsedLayers() if layer.identifier not in done]:
        done.update(layer.identifier for layer in layers)
        yield from (layer for layer in layers if not layer.anonymous)


def _stand_in_documents(stage: Usd.Stage, roots: tuple[str, ...]) -> list[Document]:
    """Replace MaterialX documents by layers, in memory; unreadable documents stay lost."""
    documents: dict[str, Document] = {}
    for layer in _layers_of(stage):
        for asset in layer.GetCompositionAssetDependencies():
            path = str(Ar.GetResolver().Resolve(layer.ComputeAbsolutePath(asset)))
            if not is_document(asset) or not path or not is_within(path, roots):
                continue
            try:
                if path not in documents:
                    documents[path] = read_document(path, roots)
            except DocumentError:
                continue
            refer(layer, asset, documents[path].layer.identifier)
    return list(documents.values())
