"""Owns the truth about layers that must not be read although a stage names them."""

from pxr import Ar, Sdf, Usd

from reflet_usd.stage_files import is_plain_file, is_within

from .allowed_deviations import NOT_READ
from .checks import Checks
from .usd_stage import TruthStage


def compare_layers(checks: Checks, truth: TruthStage) -> None:
    """Check that a warning names every prim with a file outside the folders, or a pipe."""
    refused = {
        (layer.identifier, asset)
        for layer in truth.stage.GetUsedLayers()
        for asset in layer.GetCompositionAssetDependencies()
        if _is_refused(layer, asset, truth.roots)
    }
    if not refused:
        return
    for layer in truth.stage.GetUsedLayers():
        for asset in layer.subLayerPaths:
            if (layer.identifier, asset) in refused:
                checks.add_lost("/", NOT_READ, f"the sublayer @{asset}@ is not read")
    everything = Usd.TraverseInstanceProxies(Usd.PrimAllPrimsPredicate)
    for prim in Usd.PrimRange(truth.stage.GetPseudoRoot(), everything):
        for spec in prim.GetPrimStack():
            for arcs in (spec.referenceList, spec.payloadList):
                for arc in arcs.GetAddedOrExplicitItems():
                    if (spec.layer.identifier, arc.assetPath) in refused:
                        text = f"the layer @{arc.assetPath}@ is not read"
                        checks.add_lost(str(prim.GetPath()), NOT_READ, text)


def _is_refused(layer: Sdf.Layer, asset: str, roots: tuple[str, ...]) -> bool:
    resolved = Ar.GetResolver().Resolve(layer.ComputeAbsolutePath(asset)).GetPathString()
    if not resolved:
        return False  # it does not exist, which composition reports
    return not is_within(resolved, roots) or not is_plain_file(resolved)
