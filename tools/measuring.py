"""Functions that the measuring tools share: finding the program, writing tables."""

import argparse
import csv
import os
import pathlib
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence

ROOT = pathlib.Path(__file__).resolve().parents[1]


def add_program(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--reflet",
        type=pathlib.Path,
        metavar="PROGRAM",
        help="run this program, instead of building what ships",
    )


def program_of(given: pathlib.Path | None) -> pathlib.Path:
    """The program of `--reflet`, else this checkout's, built now; exits where there is none."""
    if given is not None:
        if not given.is_file():
            sys.exit(f"--reflet: there is no program {given}")
        return given.resolve()
    built = subprocess.run(["cargo", "build", "--release", "--locked"], cwd=ROOT, check=False)
    if built.returncode != 0:
        sys.exit("the program does not build; see above")
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", "target"))
    return ROOT / target / "release" / "reflet"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown, without a final newline."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines).replace("|  |", "| |")


def write_tables(page: pathlib.Path, tables: Mapping[str, str]) -> None:
    """Writes tables between `<!-- table: NAME -->` and `<!-- end -->` of a page."""
    text = page.read_text()
    for name, content in tables.items():
        before, after = f"<!-- table: {name} -->\n", "\n<!-- end -->"
        pattern = f"{re.escape(before)}.*?{re.escape(after)}"
        parts = re.split(pattern, text, flags=re.DOTALL)
        if len(parts) != 2:
            sys.exit(f"{page} has {len(parts) - 1} places for the table {name!r}")
        text = (before + content + after).join(parts)
    page.write_text(text)


def write_rows(path: pathlib.Path, rows: Sequence[Mapping[str, object]]) -> None:
    """Writes rows of the same columns as CSV."""
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def read_rows(path: pathlib.Path) -> list[dict[str, str]]:
    """Rows of a CSV file; empty where there is no file."""
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return list(csv.DictReader(file))
