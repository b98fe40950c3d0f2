"""Owns the command `reflet-usd report`: convert and check a whole folder of stages, as a table."""

import argparse
import concurrent.futures
import dataclasses
import json
import os
import re
import sys
import tempfile
import time
from pathlib import Path

from reflet_usd import __version__
from reflet_usd.child_processes import Children
from reflet_usd.convert.types import ConvertError, ConvertOptions
from reflet_usd.corpus_scores import Root, read_peers, read_roots
from reflet_usd.report_row import Row
from reflet_usd.report_table import format_markdown
from reflet_usd.sandbox import Limits, run_convert
from reflet_usd.standard_output import show
from reflet_usd.validate.confined import validate_confined
from reflet_usd.validate.khronos import ValidatorMissingError, check_files, find_package


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of `reflet-usd report`."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="a folder of USD stages")
    parser.add_argument("-o", "--output", type=Path, metavar="MD", help="write the table here")
    parser.add_argument("--json", type=Path, metavar="JSON", help="write every detail here")
    parser.add_argument(
        "--only", default="", type=_pattern, metavar="REGEX", help="only stages that match"
    )
    parser.add_argument(
        "--alone", action="store_true", help="of each stage its own folder alone, not all of DIR"
    )
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep the outputs here")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="stages at a time")
    parser.add_argument(
        "--wall-s",
        type=float,
        default=120.0,
        help="time limit of one conversion, and of its check, seconds",
    )


def _pattern(text: str) -> str:
    try:
        re.compile(text)
    except re.error as error:
        raise argparse.ArgumentTypeError(f"{text!r} is no regular expression: {error}") from None
    return text


def run(args: argparse.Namespace) -> int:
    """Run over the folder and print; 0 when every row passed, 3 when some did not."""
    if not args.folder.is_dir():
        print(f"{args.folder}: no such folder; name one with USD stages", file=sys.stderr)
        return 2
    found = read_roots(args.folder)
    roots = [root for root in found if re.search(args.only, root.file)]
    if not roots:
        what = f"no stage matches {args.only!r}" if found else "the folder holds no USD stage"
        print(f"{args.folder}: {what}", file=sys.stderr)
        return 2
    for place in filter(None, (args.output, args.json)):
        reason = _unwritable(place)
        if reason:
            print(f"{place}: {reason}", file=sys.stderr)
            return 2
    try:
        find_package()
    except ValidatorMissingError as error:
        print(error, file=sys.stderr)
        return 1
    peers = read_peers(args.folder)
    with tempfile.TemporaryDirectory(prefix="reflet-report-") as scratch:
        place = args.keep or Path(scratch)
        place.mkdir(parents=True, exist_ok=True)
        # Stages of a corpus share layers and textures across their folders.
        options = ConvertOptions(extra_roots=() if args.alone else (args.folder,))
        limits = Limits(wall_s=args.wall_s)
        rows = convert_all(args.folder, roots, place, args.jobs, limits, options)
    text = format_markdown(rows, peers, __version__)
    if args.output:
        _write(args.output, text)
    else:
        show(text)
    if args.json:
        details = json.dumps([row.to_json() for row in rows], indent=1)
        _write(args.json, details)
    passed = sum(row.passed for row in rows)
    print(f"{passed} of {len(rows)} stages as they should be", file=sys.stderr)
    return 0 if passed == len(rows) else 3


def _unwritable(place: Path) -> str:
    """Reason why no file can be written there; empty where it can. Asked before the long work."""
    if not place.absolute().parent.is_dir():
        return f"{place.parent} is not a folder; make it first"
    if place.is_dir():
        return "is a folder; name a file"
    if not os.access(place if place.exists() else place.absolute().parent, os.W_OK):
        return "cannot be written"
    return ""


def _write(place: Path, text: str) -> None:
    """Write the whole file or leave nothing of it."""
    with tempfile.NamedTemporaryFile(
        "w", encoding="utf-8", dir=place.absolute().parent, prefix=".reflet-usd-", delete=False
    ) as staged:
        try:
            staged.write(text)
            staged.flush()
            os.chmod(staged.name, 0o644)
            os.replace(staged.name, place)
        except BaseException:
            os.unlink(staged.name)
            raise


def convert_all(
    folder: Path,
    roots: list[Root],
    place: Path,
    jobs: int,
    limits: Limits,
    options: ConvertOptions,
) -> list[Row]:
    """Convert and check every root, `jobs` at a time, each in its own processes."""
    children = Children()
    with concurrent.futures.ThreadPoolExecutor(max(jobs, 1)) as pool:
        fixed = (limits, options, children)
        work = [pool.submit(_one, folder, root, place, *fixed) for root in roots]
        rows = []
        try:
            for number, item in enumerate(work, 1):
                rows.append(item.result())
                if sys.stderr.isatty():
                    print(f"\r{number}/{len(work)}", end="", file=sys.stderr, flush=True)
        except BaseException:  # on a signal, child processes are ended, so that threads end
            pool.shutdown(wait=False, cancel_futures=True)
            children.stop()
            raise
    _run_khronos([row for row in rows if row.validation], place)
    return rows


def _run_khronos(rows: list[Row], place: Path) -> None:
    """Add the Khronos validator's reports, all from one node process."""
    for row, report in zip(rows, check_files([_out(row.root, place) for row in rows]), strict=True):
        row.validation["khronos"] = dataclasses.asdict(report)
        row.validation["passed"] = row.validation["passed"] and report.errors == 0


def _out(root: Root, place: Path) -> Path:
    return place / (re.sub(r"[^A-Za-z0-9.]+", "_", root.file) + ".glb")


def _one(
    folder: Path,
    root: Root,
    place: Path,
    limits: Limits,
    options: ConvertOptions,
    children: Children,
) -> Row:
    stage = folder / root.file
    out = _out(root, place)
    start = time.monotonic()
    try:
        result = run_convert(stage, out, options, limits=limits, children=children)
    except ConvertError as error:
        row = Row(root, False, error.name, _without(str(error), folder))
        row.convert_s = time.monotonic() - start
        return row
    row = Row(root, True, convert_s=time.monotonic() - start)
    row.warnings = [warning.to_json() for warning in result.warnings]
    try:  # in its own process: usd-core may end the process that reads
        row.validation = validate_confined(
            out, stage, None, limits=limits, children=children
        ).validation
    except ConvertError as error:
        row.reason, row.message = error.name, _without(str(error), folder)
    return row


def _without(text: str, folder: Path) -> str:
    """The message without the corpus folder, so that two runs print the same."""
    return text.replace(str(folder.resolve()) + os.sep, "").replace(str(folder) + os.sep, "")
