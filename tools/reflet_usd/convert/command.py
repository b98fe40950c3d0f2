"""The subcommand `reflet-usd convert`: runs the converter in its sandbox, prints the outcome."""

from __future__ import annotations

import argparse
import sys
from collections import Counter

from reflet_usd.convert import arguments
from reflet_usd.convert.types import ConvertError, count_of

SHOWN_WARNINGS = 20
MOST_SECONDS = 7 * 24 * 3600


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The converter's own arguments."""
    from reflet_usd.sandbox import Limits

    arguments.add_arguments(parser)
    for name, most, what in (
        ("--cpu-limit", Limits.cpu_s, "of processor time (over all threads)"),
        ("--time-limit", Limits.wall_s, "on the clock"),
    ):
        parser.add_argument(
            name,
            type=_seconds,
            default=int(most),
            metavar="SECONDS",
            help=f"stop the conversion after so much time {what} (default {most:g})",
        )


def _seconds(text: str) -> int:
    if not text.isascii() or not text.isdigit() or not 1 <= int(text) <= MOST_SECONDS:
        message = f"'{text}': expected whole seconds from 1 to {MOST_SECONDS}"
        raise argparse.ArgumentTypeError(message)
    return int(text)


def run(args: argparse.Namespace) -> int:
    """Convert one stage; 0 when the file was written, 1 with a named reason otherwise."""
    # Imported here: `sandbox` belongs to the validation half and needs no USD.
    from reflet_usd import sandbox

    limits = sandbox.Limits(cpu_s=args.cpu_limit, wall_s=float(args.time_limit))
    options = arguments.options_from(args)
    try:
        result = sandbox.run_convert(args.stage, args.output, options, limits=limits)
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
