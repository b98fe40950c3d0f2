"""Opens a stage: confines its layers, applies variants, reads units, axis and time."""

import os
import re
from pathlib import Path

from pxr import Sdf, Tf, Usd, UsdGeom, UsdUtils

from reflet_usd.stage_files import (
    editable,
    error_text,
    is_positive,
    is_rate,
    stage_metadata,
    state_rates,
)
from reflet_usd.stand_in import stand_in

from .confinement import (
    Files,
    allowed_roots,
    check_used_layers,
    cut_foreign_layers,
    open_layer,
    warn_left_out,
    warn_missing_clips,
)
from .context import MAX_CODE, Context
from .ledger import Ledger
from .missing_xform_ops import skip_missing_ops
from .prim_count import check_prim_count
from .samples import first_code
from .types import ConvertError, ConvertOptions
from .velocities import sample_velocities

# UsdGeom's documented fallbacks.
FALLBACK_METERS_PER_UNIT = 0.01
FALLBACK_CODES_PER_SECOND = 24.0
# Range of meters per unit, picometers to billions of kilometers; outside, float32 is left.
LEAST_UNIT = 1e-12


def open_context(path: Path, options: ConvertOptions, ledger: Ledger) -> Context:
    """Open and compose `path`; raises `ConvertError` when that is impossible."""
    if not path.is_file():
        raise ConvertError("stage-missing", "no such file", str(path))
    delegate = UsdUtils.CoalescingDiagnosticDelegate()
    roots = allowed_roots(path, options.extra_roots)
    root_layer = _open_root_layer(path)
    # The layers stay referenced, so the stage composes the edited copies in memory.
    files = Files()
    layers, cut = cut_foreign_layers(root_layer, roots, files)
    _repair_time_rates(layers, ledger)
    try:
        stage = Usd.Stage.Open(root_layer, Usd.Stage.LoadAll)
    except Tf.ErrorException as error:
        raise ConvertError("stage-unreadable", error_text(error, path), str(path)) from None
    if stage is None:
        raise ConvertError("stage-unreadable", "USD cannot compose it", str(path))
    check_used_layers(stage, roots)
    del layers
    _select_variants(stage, options, str(path))
    check_prim_count(stage)
    warn_left_out(stage, cut, ledger)
    warn_missing_clips(stage, roots, ledger)
    _warn_composition(stage, delegate, ledger)
    context = Context(stage, options, ledger, roots, files)
    _read_units(context)
    _read_time(context)
    skip_missing_ops(context)
    sample_velocities(context)
    return context


def _open_root_layer(path: Path) -> Sdf.Layer:
    with path.open("rb") as file:
        if found := stand_in(file.read(64)):
            raise ConvertError("stage-unreadable", found, str(path))
    try:
        layer = open_layer(str(path))
    except Tf.ErrorException as error:
        raise ConvertError("stage-unreadable", error_text(error, path), str(path)) from None
    if layer is None:
        raise ConvertError("stage-unreadable", "not a USD layer that can be read", str(path))
    return layer


def _repair_time_rates(layers: list[Sdf.Layer], ledger: Ledger) -> None:
    """Set a usable timeCodesPerSecond in memory: USD divides by it when it combines layers."""
    for layer in layers:
        if not layer.pseudoRoot.HasInfo("timeCodesPerSecond"):
            continue
        rate = layer.pseudoRoot.GetInfo("timeCodesPerSecond")
        if is_rate(rate):
            continue
        name = os.path.basename(layer.identifier)
        message = f"timeCodesPerSecond of {name} is {rate!r}, taken as 24"
        ledger.warn("time-rate-invalid", "/", message)
        with editable(layer):
            layer.pseudoRoot.SetInfo("timeCodesPerSecond", FALLBACK_CODES_PER_SECOND)


def _select_variants(stage: Usd.Stage, options: ConvertOptions, path: str) -> None:
    """Apply the selections in the session layer, where they win over all authored ones."""
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for prim_path, set_name, variant in options.variants:
            prim = stage.GetPrimAtPath(prim_path) if Sdf.Path.IsValidPathString(prim_path) else None
            if not prim:
                raise ConvertError("variant-unknown", f"there is no prim {prim_path}", path)
            names = prim.GetVariantSets().GetNames()
            if set_name not in names:
                known = ", ".join(names) or "none"
                message = f"{prim_path} has no variant set '{set_name}', it has: {known}"
                raise ConvertError("variant-unknown", message, path)
            variant_set = prim.GetVariantSet(set_name)
            if variant not in variant_set.GetVariantNames():
                known = ", ".join(variant_set.GetVariantNames())
                message = f"{prim_path}{{{set_name}}} has no '{variant}', it has: {known}"
                raise ConvertError("variant-unknown", message, path)
            variant_set.SetVariantSelection(variant)


def _warn_composition(
    stage: Usd.Stage, delegate: UsdUtils.CoalescingDiagnosticDelegate, ledger: Ledger
) -> None:
    named = []
    for error in stage.GetCompositionErrors():
        text = _plain(str(error))
        named.append(text)
        missing = "Could not open asset" in text or "Unresolved" in text
        site = str(error.rootSite.path) if hasattr(error, "rootSite") else "/"
        ledger.warn("asset-unresolved" if missing else "composition-error", site or "/", text)
    for item in delegate.TakeUncoalescedDiagnostics():
        text = _plain(item.commentary)
        if "deprecated version" in text or "Could not open asset" in text:
            continue
        told = any(known in text or text in known for known in named)
        if "unresolved" not in text.lower() and "composition" not in text.lower() and not told:
            ledger.warn("usd-diagnostic", "/", text)


def _plain(text: str) -> str:
    """One line without text that differs from run to run: memory addresses and folder names."""
    words = re.sub(r"anon:0x[0-9a-fA-F]+:?", "anonymous ", " ".join(text.split()))
    words = re.sub(r"\s*[<‹(\[]?\b0x[0-9a-fA-F]+\b[>›)\]]?", "", words)
    parts = words.split("@")
    parts[1::2] = [_without_folder(part) for part in parts[1::2]]
    return "@".join(parts)


def _without_folder(asset: str) -> str:
    """File name of the asset; for a package also the path within it."""
    package, bracket, inner = asset.partition("[")
    return os.path.basename(package) + bracket + inner


def _read_units(context: Context) -> None:
    stage, ledger = context.stage, context.ledger
    units = stage_metadata(stage, "metersPerUnit")
    context.meters_per_unit = FALLBACK_METERS_PER_UNIT
    if units is None:
        ledger.warn("units-missing", "/", "metersPerUnit is not authored, taken as 0.01 (cm)")
    elif not is_positive(units):
        ledger.warn("units-invalid", "/", f"metersPerUnit is {units!r}, taken as 0.01 (cm)")
    elif not LEAST_UNIT <= units <= 1.0 / LEAST_UNIT:
        message = f"metersPerUnit is {units:g}, beyond all lengths of scenes, taken as 0.01 (cm)"
        ledger.warn("units-invalid", "/", message)
    else:
        context.meters_per_unit = float(units)
    axis = stage_metadata(stage, "upAxis")
    if axis is None:
        axis = UsdGeom.GetFallbackUpAxis()
    if axis not in ("Y", "Z"):
        ledger.warn("up-axis-invalid", "/", f"upAxis is {axis!r}, taken as Y")
    context.z_up = axis == "Z"


def _read_time(context: Context) -> None:
    stage = context.stage
    rate = stage_metadata(stage, "timeCodesPerSecond")
    if rate is None:
        rate = stage_metadata(stage, "framesPerSecond")
    if rate is None:
        rate = FALLBACK_CODES_PER_SECOND
    if not is_rate(rate):
        message = f"timeCodesPerSecond is {rate!r}, taken as 24"
        context.ledger.warn("time-rate-invalid", "/", message)
        rate = FALLBACK_CODES_PER_SECOND
    context.codes_per_second = float(rate)
    keyed = _keyed_attributes(stage)
    _drop_far_samples(context, keyed)
    if context.options.frames is not None:
        context.stated_codes = context.options.frames
        context.time_origin = context.options.frames[0]
        context.time = Usd.TimeCode(context.time_origin)
        return
    firsts = (first_code(attribute) for attribute in keyed)
    keys = [code for code in firsts if code is not None and abs(code) <= MAX_CODE]
    start, end = (_stated_code(stage, name) for name in ("startTimeCode", "endTimeCode"))
    context.stated_codes = (start, end)
    if start is not None and keys:
        keys.append(start)
    context.time_origin = min(keys, default=0.0)


def _stated_code(stage: Usd.Stage, name: str) -> float | None:
    code = stage_metadata(stage, name)
    return float(code) if code is not None and abs(code) <= MAX_CODE else None


def _drop_far_samples(context: Context, keyed: list[Usd.Attribute]) -> None:
    """Drop, in the session layer, time samples beyond `MAX_CODE`."""
    found = []
    for attribute in keyed:
        codes = attribute.GetTimeSamples()
        near = [code for code in codes if abs(code) <= MAX_CODE]
        if 0 < len(near) < len(codes) and not attribute.GetPrim().IsInPrototype():
            found.append((attribute, [(code, attribute.Get(code)) for code in near]))
    if not found:
        return
    stage = context.stage
    state_rates(stage)
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for attribute, keys in found:
            message = f"samples of '{attribute.GetName()}' beyond ±{MAX_CODE:g} were dropped"
            context.ledger.warn("time-sample-dropped", attribute.GetPrim(), message)
            for code, value in keys:
                attribute.Set(Sdf.ValueBlock() if value is None else value, code)


def _keyed_attributes(stage: Usd.Stage) -> list[Usd.Attribute]:
    """All attributes with time samples or a spline."""
    # Prototypes are walked instead of instances, since nesting can make any number of these.
    return [
        attribute
        for root in (stage.GetPseudoRoot(), *stage.GetPrototypes())
        for prim in Usd.PrimRange(root)
        for attribute in prim.GetAuthoredAttributes()
        if attribute.GetNumTimeSamples() or attribute.HasSpline()
    ]
