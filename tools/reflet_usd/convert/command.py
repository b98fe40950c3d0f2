"""The subcommand `reflet-usd convert`: runs the converter in its sandbox, prints the outcome."""

import argparse
import sys
from collections import Counter

from reflet_usd.limit_arguments import add_limits, limits_from
from reflet_usd.standard_output import show

from . import arguments
from .types import warning_count

SHOWN_WARNINGS = 20


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The converter's own arguments."""
    arguments.add_arguments(parser)
    add_limits(parser)


def run(args: argparse.Namespace) -> int:
    """Convert one stage; 0 when the file was written, 1 with a named reason otherwise."""
    # Imported here: `sandbox` belongs to the validation half and needs no USD.
    from reflet_usd import sandbox

    options = arguments.options_from(args)
    result = sandbox.run_convert(args.stage, args.output, options, limits=limits_from(args))
    for warning in result.warnings[:SHOWN_WARNINGS]:
        print(f"warning: {warning.prim}: {warning.message} [{warning.name}]", file=sys.stderr)
    hidden = Counter(warning.name for warning in result.warnings[SHOWN_WARNINGS:])
    if hidden:
        counts = ", ".join(f"{count} {name}" for name, count in sorted(hidden.items()))
        print(f"warning: and {counts}; all are in {args.output}.json", file=sys.stderr)
    show(
        f"{args.stage} -> {args.output} ({warning_count(len(result.warnings))})",
        done=f"{args.output} is written, but ",
    )
    return 0
