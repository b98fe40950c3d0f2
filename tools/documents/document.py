"""Pages of docs that are told from the tables in docs/data, and the runs that the tables are of."""

import dataclasses
import pathlib
import re
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence

from measuring import ROOT
from tables import Row, Rows, read_rows, with_tables

DOCS = ROOT / "docs"
DATA = DOCS / "data"
CHARTS = DOCS / "charts"
IMAGES = DOCS / "images"
METHODS = ["ssr", "hybrid", "rt"]


@dataclasses.dataclass(frozen=True)
class Run:
    """A folder for measurements, and the program, models and choice that they are made with."""

    out: pathlib.Path
    program: pathlib.Path
    assets: pathlib.Path | None = None
    only: str | None = None
    suite: pathlib.Path | None = None
    """Folder with clones of the suites of docs/suites.md."""

    def wants(self, name: str) -> bool:
        """Whether the part of this name is to be measured; says so."""
        if self.only and not re.fullmatch(self.only, name):
            return False
        print(f"== {name}", flush=True)
        return True

    def models(self) -> list[str | pathlib.Path]:
        """Options that name the folder of models; exits where none was given."""
        if self.assets is None:
            sys.exit("--assets must name the folder of the paper's models (docs/paper.md)")
        return ["--assets", self.assets]

    def bench(self, name: str, *options: str | pathlib.Path) -> None:
        """Measures what the folder of this name lacks, by `reflet bench`."""
        command: list[str | pathlib.Path] = [self.program, "bench", *options]
        subprocess.run([*command, "-o", self.out / folder_of(name)], cwd=ROOT, check=True)


@dataclasses.dataclass(frozen=True)
class Document:
    """A page of docs."""

    page: str
    tell: Callable[[str], str]
    """The page's text anew, from its text and the tables in docs/data."""
    store: Callable[[list[pathlib.Path]], None]
    """Takes tables, charts and pictures from the folders of runs."""
    measure: Callable[[Run], None] | None = None
    """Measures what a folder lacks."""
    pictures: Callable[[Run], None] | None = None
    """Renders the page's pictures."""


def in_places(tables: Callable[[], Mapping[str, str]]) -> Callable[[str], str]:
    """Tells a page by the tables that have places in its text."""
    return lambda text: with_tables(text, tables())


def folder_of(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def samples(out: pathlib.Path, name: str) -> Rows:
    """Samples of a run's part; exits where it was not measured."""
    path = out / folder_of(name) / "samples.csv"
    if not path.exists():
        sys.exit(f"{path} is missing; run with --measure first")
    return read_rows(path)


def some_columns(rows: Rows, columns: Sequence[str]) -> Rows:
    return [{column: row[column] for column in columns} for row in rows]


def driver_of(row: Row) -> str:
    """Name of a sample's driver, without its build."""
    found = re.search(r"Mesa [0-9.]+", row["driver"])
    return found[0] if found else row["driver"]


def accepted_px(row: Row) -> float:
    """Number of reflective pixels whose marched hit was taken."""
    return float(row["reflective_px"]) * float(row["screen_percent"]) / 100
