"""The converter: one USD stage in, one glTF file and one JSON sidecar out."""

from pathlib import Path

from .types import ConvertError, ConvertOptions, ConvertResult, Warning

__all__ = ["ConvertError", "ConvertOptions", "ConvertResult", "Warning", "convert_stage"]


def convert_stage(stage_path: Path, out: Path, options: ConvertOptions) -> ConvertResult:
    """Convert `stage_path` (usda, usdc, usdz) to `out` (.glb or .gltf) in this process.

    Writes `out` and the sidecar `out + ".json"`; on any `ConvertError` neither exists anew.
    """
    # Imported here, because the child process sets its limits before USD is loaded.
    from .pipeline import run_pipeline

    return run_pipeline(Path(stage_path), Path(out), options)
