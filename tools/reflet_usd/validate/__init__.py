"""The command `reflet-usd validate`: is a glTF file valid, and does it show what the stage shows.

The output is re-read by pygltflib and trimesh, the stage is evaluated by usd-core; no code of
the converter takes part. Exit codes: 0 all right, 1 the check itself could not run (also where
usd-core does not open the stage), 2 wrong usage, 3 the file is invalid or deviates silently.
"""

from __future__ import annotations

import argparse
import json
import sys
import traceback
from pathlib import Path

EXIT_OK, EXIT_INTERNAL, EXIT_USAGE, EXIT_DEVIATES = 0, 1, 2, 3


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of `reflet-usd validate`."""
    parser.add_argument("out", type=Path, metavar="OUT", help="the .glb or .gltf file to check")
    parser.add_argument(
        "--against", type=Path, metavar="STAGE", help="the USD stage that it must show"
    )
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    parser.add_argument(
        "--no-khronos", action="store_true", help="compare only, without the Khronos validator"
    )


def run(args: argparse.Namespace) -> int:
    """Validate, print, and return the exit code."""
    for path in filter(None, (args.out, args.against)):
        if not path.is_file():
            print(f"{path}: no such file; name an existing one", file=sys.stderr)
            return EXIT_USAGE
    # Imported late: the readers and usd-core take long to load, and may be missing.
    try:
        from .facts import StageError
        from .khronos import ValidatorMissingError
        from .proof import prove
        from .table import format_proof
    except ModuleNotFoundError as error:
        print(
            f"the Python package {error.name!r} is missing; run tools/setup.sh,"
            " or pip install 'reflet-usd[validate]'",
            file=sys.stderr,
        )
        return EXIT_INTERNAL
    try:
        proof = prove(args.out, args.against, khronos=not args.no_khronos)
    except ValidatorMissingError as error:
        print(f"{error}\n(or compare only, with --no-khronos)", file=sys.stderr)
        return EXIT_INTERNAL
    except StageError as error:
        print(f"{error} [stage-unreadable]", file=sys.stderr)
        return EXIT_INTERNAL
    except Exception as error:  # a blunder of the check says nothing about the file
        frame = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{Path(frame.filename).name}:{frame.lineno}"
        reason = " ".join(str(error).split())[:300]
        print(
            f"{args.out}: the check could not run: {type(error).__name__} at {place}: {reason}"
            " [validate-internal]",
            file=sys.stderr,
        )
        return EXIT_INTERNAL
    if proof.khronos is not None and proof.khronos.crash:
        print(
            f"{args.out}: the Khronos validator ended with {proof.khronos.crash!r}; compare only,"
            " with --no-khronos [validator-crash]",
            file=sys.stderr,
        )
        return EXIT_INTERNAL
    print(json.dumps(proof.to_json(), indent=2) if args.json else format_proof(proof))
    return EXIT_OK if proof.passed else EXIT_DEVIATES
