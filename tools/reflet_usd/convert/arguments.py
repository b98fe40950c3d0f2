"""The arguments of `convert`, and the `ConvertOptions` that they stand for."""

import argparse
import re
from pathlib import Path

from .types import DEFAULT_PURPOSES, MOST_STEPS, ConvertOptions

PURPOSES = ("default", "render", "proxy", "guide")
_MOST_CODE = 1e9  # equals `MAX_CODE` of context.py, whose import would load USD
_VARIANT = re.compile(r"^(?P<prim>/[^{}]*)\{(?P<set>[^={}]+)=(?P<value>[^{}]*)\}$")


def _frames(text: str) -> tuple[float, float]:
    first, _, last = text.partition(":")
    try:
        frames = (float(first), float(last or first))
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"'{text}' is not a frame range, write FIRST:LAST, for example 1:48"
        ) from None
    if not all(abs(code) <= _MOST_CODE for code in frames):
        raise argparse.ArgumentTypeError(f"'{text}': time codes go from -1e9 to 1e9")
    if not frames[0] <= frames[1]:
        raise argparse.ArgumentTypeError(f"'{text}' ends before it begins")
    return frames


def _purposes(text: str) -> tuple[str, ...]:
    names = tuple(name.strip() for name in text.split(",") if name.strip())
    unknown = [name for name in names if name not in PURPOSES]
    if unknown or not names:
        raise argparse.ArgumentTypeError(f"'{text}': expected a list out of {', '.join(PURPOSES)}")
    return names


def _variant(text: str) -> tuple[str, str, str]:
    match = _VARIANT.match(text)
    if match is None:
        raise argparse.ArgumentTypeError(f"'{text}' is not of the form /prim{{set=variant}}")
    return match["prim"], match["set"], match["value"]


def _level(text: str) -> int:
    if not text.isdigit() or int(text) > MOST_STEPS:
        raise argparse.ArgumentTypeError(f"'{text}': expected a level from 0 to {MOST_STEPS}")
    return int(text)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that decide the output's content."""
    parser.add_argument("stage", type=Path, help="a .usda, .usdc, .usd or .usdz file")
    parser.add_argument("-o", "--output", type=Path, required=True, help="a .glb or .gltf file")
    parser.add_argument(
        "--frames", type=_frames, metavar="FIRST:LAST", help="keep only these time codes"
    )
    parser.add_argument(
        "--purpose",
        type=_purposes,
        default=DEFAULT_PURPOSES,
        metavar="LIST",
        help="purposes to keep, comma separated (default: default,render)",
    )
    parser.add_argument(
        "--variant",
        type=_variant,
        action="append",
        default=[],
        metavar="/PRIM{SET=VALUE}",
        help="choose a variant; may be given several times",
    )
    parser.add_argument("--strict", action="store_true", help="any warning is an error")
    parser.add_argument(
        "--root",
        type=Path,
        action="append",
        default=[],
        metavar="FOLDER",
        help="allow layers and textures from this folder too",
    )
    parser.add_argument(
        "--subdiv",
        type=_level,
        default=0,
        metavar="LEVEL",
        help="Catmull-Clark steps for subdivision meshes (default 0: the cage)",
    )


def options_from(args: argparse.Namespace) -> ConvertOptions:
    """The options that parsed arguments stand for."""
    return ConvertOptions(
        frames=args.frames,
        purpose=tuple(args.purpose),
        variants=tuple(args.variant),
        strict=args.strict,
        extra_roots=tuple(args.root),
        subdiv_level=args.subdiv,
    )
