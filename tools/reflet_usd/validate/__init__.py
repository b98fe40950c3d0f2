"""The command `reflet-usd validate`: is a glTF file valid, and does it show what the stage shows?

The output is re-read by pygltflib and trimesh, the stage is evaluated by usd-core; no code of
the converter takes part; the stage is read in the sandbox's child process. Exit codes: 0 all
right, 1 the check itself could not run (also where usd-core does not open the stage), 2 wrong
usage, 3 the file is invalid or deviates silently.
"""

import argparse
import json
import sys
import traceback
from pathlib import Path

from reflet_usd.convert.types import ConvertError
from reflet_usd.limit_arguments import add_limits, limits_from
from reflet_usd.standard_output import show

EXIT_OK, EXIT_USAGE, EXIT_DEVIATES = 0, 2, 3


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
    add_limits(parser)


def run(args: argparse.Namespace) -> int:
    """Validate, print, and return the exit code."""
    for path in filter(None, (args.out, args.against)):
        if not path.is_file():
            print(f"{path}: no such file; name an existing one", file=sys.stderr)
            return EXIT_USAGE
    # Imported late: the readers take long to load, and may not be installed.
    try:
        return _run(args)
    except ModuleNotFoundError as error:
        message = f"the Python package {error.name!r} is missing; run tools/setup.sh"
        raise ConvertError(
            "package-missing", f"{message}, or pip install 'reflet-usd[validate]'"
        ) from error
    except ConvertError:
        raise
    except Exception as error:  # an error of the check itself says nothing about the file
        frame = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{Path(frame.filename).name}:{frame.lineno}"
        reason = " ".join(str(error).split())[:300]
        message = f"the check could not run: {type(error).__name__} at {place}: {reason}"
        raise ConvertError("validate-internal", message, str(args.out)) from error


def _run(args: argparse.Namespace) -> int:
    from .khronos import ValidatorMissingError, check_files
    from .validation import validate_file
    from .validation_table import format_validation

    try:
        report = None if args.no_khronos else check_files([args.out])[0]
    except ValidatorMissingError as error:
        message = f"{error}\n(or compare only, with --no-khronos)"
        raise ConvertError("validator-missing", message) from error
    if report is not None and report.crash:
        message = f"the Khronos validator ended with {report.crash!r}; compare only,"
        raise ConvertError("validator-crash", f"{message} with --no-khronos", str(args.out))
    if args.against is None:
        validation = validate_file(args.out, None, khronos=False)
        validation.khronos = report
        verdict, text = validation.to_json(), format_validation(validation)
    else:
        from .confined import validate_confined

        found = validate_confined(args.out, args.against, report, limits=limits_from(args))
        verdict, text = found.validation, found.text
    show(json.dumps(verdict, indent=2) if args.json else text)
    return EXIT_OK if verdict["passed"] else EXIT_DEVIATES
