"""The subcommand `reflet-usd convert`: runs the converter in its sandbox, prints the outcome."""

from __future__ import annotations

import argparse
import sys
from collections import Counter

from reflet_usd.convert import arguments
from reflet_usd.convert.types import ConvertError, count_of

SHOWN_WARNINGS = 20


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The converter's own arguments."""
    arguments.add_arguments(parser)


def run(args: argparse.Namespace) -> int:
    """Convert one stage; 0 when the file was written, 1 with a named reason otherwise."""
    # Imported here: `sandbox` belongs to the validation half and needs no USD.
    from reflet_usd import sandbox

    try:
        result = sandbox.run_convert(args.stage, args.output, arguments.options_from(args))
    except ConvertError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    for warning in result.warnings[:SHOWN_WARNINGS]:
        print(f"warning: {warning.prim}: {warning.message} [{warning.name}]", file=sys.stderr)
    hidden = Counter(warning.name for warning in result.warnings[SHOWN_WARNINGS:])
    if hidden:
        counts = ", ".join(f"{count} {name}" for name, count in sorted(hidden.items()))
        print(f"warning: and {counts}; all are in {args.output}.json", file=sys.stderr)
    print(f"{args.stage} -> {args.output} ({count_of(len(result.warnings), 'warning')})")
    return 0
