"""Options for the limits that commands put on the process that reads a stage."""

import argparse

from reflet_usd.sandbox import Limits

MOST_SECONDS = 7 * 24 * 3600


def add_limits(parser: argparse.ArgumentParser) -> None:
    """Declare `--cpu-limit` and `--time-limit`."""
    for name, most, what in (
        ("--cpu-limit", Limits.cpu_s, "of processor time (over all threads)"),
        ("--time-limit", Limits.wall_s, "on the clock"),
    ):
        parser.add_argument(
            name,
            type=_seconds,
            default=int(most),
            metavar="SECONDS",
            help=f"stop reading the stage after so much time {what} (default {most:g})",
        )


def limits_from(args: argparse.Namespace) -> Limits:
    """Limits that parsed arguments stand for."""
    return Limits(cpu_s=args.cpu_limit, wall_s=float(args.time_limit))


def _seconds(text: str) -> int:
    if not text.isascii() or not text.isdigit() or not 1 <= int(text) <= MOST_SECONDS:
        message = f"'{text}': expected whole seconds from 1 to {MOST_SECONDS}"
        raise argparse.ArgumentTypeError(message)
    return int(text)
