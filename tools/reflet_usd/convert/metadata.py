"""Metadata, API schemas and draw mode of prims, which do not draw."""

from typing import Any

from pxr import Kind, Sdf, Usd, UsdGeom

from .context import Context
from .extras import listed, plain_value, quoted
from .scene import Node

# Metadata fields that people and pipelines write; USD itself uses the others.
KEPT = ("kind", "displayName", "documentation", "comment", "assetInfo", "customData")
KEPT_OF_STAGE = ("documentation", "comment", "customLayerData")
# Schemas that the converter reads, or without properties of their own that would be lost.
# The loss of a schema by a part of its name; the last stands for all others.
_LOSSES = {
    "Physics": "it takes part in no simulation, and is drawn where it is authored",
    "Render": "settings of a renderer are given to reflet in a scene",
    "Audio": "its sound is not heard",
    "ParticleField": "particle fields other than Gaussian splats are not drawn",
    "Volume": "volumes are not drawn",
    "Field": "volumes are not drawn",
    "Motion": "motion blur follows reflet's own shutter",
    "CoordSys": "shaders are not given its coordinate system",
    "LOD": "the finest level of detail is drawn at any distance",
    "Accessibility": "its description is not read out",
    "": "what it says has no effect on the picture",
}
_KNOWN_SCHEMAS = frozenset(
    {
        "ClipsAPI",
        "CollectionAPI",
        "ConnectableAPI",
        "GeomModelAPI",
        "LODOverrideAPI",
        "LODRootAPI",
        "LightAPI",
        "MaterialBindingAPI",
        "MeshLightAPI",
        "ModelAPI",
        "NodeDefAPI",
        "PrimvarsAPI",
        "ShadowAPI",
        "ShapingAPI",
        "SkelBindingAPI",
        "VolumeLightAPI",
        "XformCommonAPI",
    }
)
_MAX_DEPTH = 8
_MAX_VALUES = 1024
"""Maximum number of numbers and strings in the extras of one prim."""


def keep_metadata(context: Context, prim: Usd.Prim, node: Node | None) -> None:
    """Keep the prim's metadata in the node's extras; one warning names the rest."""
    told = prim.GetAllAuthoredMetadata()
    found = {name: told[name] for name in KEPT if name in told}
    if not found:
        return
    kept, dropped = ({}, list(found)) if node is None else _plain(found)
    if kept and node is not None:
        node.extras["metadata"] = kept
    _warn(context, prim, dropped)


def stage_metadata_extras(context: Context) -> dict[str, Any]:
    """Root layer metadata for the scene's extras; one warning names the rest."""
    told = context.stage.GetPseudoRoot().GetAllAuthoredMetadata()
    kept, dropped = _plain({name: told[name] for name in KEPT_OF_STAGE if name in told})
    _warn(context, "/", dropped)
    return {"metadata": kept} if kept else {}


def warn_schemas(context: Context, prim: Usd.Prim) -> None:
    """Warn about the API schemas and the draw mode of a prim that the file does not follow."""
    applied = [str(name) for name in prim.GetPrimTypeInfo().GetAppliedAPISchemas()]
    lost = [name for name in applied if name.partition(":")[0] not in _KNOWN_SCHEMAS]
    if lost:
        what = sorted({what_is_lost(name) for name in lost})
        message = f"glTF has no place for the applied {quoted(lost)}; {' and '.join(what)}"
        context.ledger.warn("schema-ignored", prim, message)
    if prim.IsModel():
        _warn_draw_mode(context, prim)


def what_is_lost(schema: str) -> str:
    """A part of a sentence about schemas of this family that are not carried."""
    families = (name for name in _LOSSES if name in schema)
    return _LOSSES[next(families, "")]


def _warn_draw_mode(context: Context, prim: Usd.Prim) -> None:
    """Warn about a draw mode; it applies to components and models that ask (UsdGeomModelAPI)."""
    model = UsdGeom.ModelAPI(prim)
    attribute = model.GetModelApplyDrawModeAttr()
    asked = attribute.Get() if attribute else None
    if asked is None or not attribute.HasAuthoredValue():
        asked = Kind.Registry.IsA(Usd.ModelAPI(prim).GetKind(), Kind.Tokens.component)
    mode = str(model.ComputeModelDrawMode()) if asked else ""
    if mode not in ("", UsdGeom.Tokens.default_, UsdGeom.Tokens.inherited):
        message = f"glTF has no draw mode '{mode}', the geometry itself is carried"
        context.ledger.warn("draw-mode-dropped", prim, message)


def _plain(values: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """The part of `values` that JSON can hold, and the names of the rest."""
    dropped: list[str] = []
    room = [_MAX_VALUES]
    return _plain_dictionary(values, "", dropped, room, _MAX_DEPTH), dropped


def _plain_dictionary(
    values: dict[str, Any], above: str, dropped: list[str], room: list[int], depth: int
) -> dict[str, Any]:
    kept = {}
    for key, value in sorted(values.items()):
        name = f"{above}{key}"
        if isinstance(value, dict) and depth > 0:
            kept[key] = _plain_dictionary(value, f"{name}:", dropped, room, depth - 1)
            continue
        plain = None if isinstance(value, dict) else _plain_value(value)
        room[0] -= len(plain) if isinstance(plain, list) else 1
        if plain is None or room[0] < 0:
            dropped.append(name)
        else:
            kept[key] = plain
    return kept


def _plain_value(value: Any) -> Any:
    if isinstance(value, (Sdf.AssetPathArray, list, tuple)):
        entries = [_plain_value(entry) for entry in list(value)[: _MAX_VALUES + 1]]
        return None if None in entries else entries
    if isinstance(value, Sdf.Path):
        return str(value)
    return plain_value(value)


def _warn(context: Context, prim: object, dropped: list[str]) -> None:
    if dropped:
        message = f"the metadata {listed(dropped)} not carried"
        context.ledger.warn("metadata-dropped", prim, message)
