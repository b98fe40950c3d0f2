"""Rows of CSV tables, their statistics, and tables in Markdown."""

import collections
import csv
import pathlib
import re
import statistics
import sys
from collections.abc import Iterable, Mapping, Sequence

Row = dict[str, str]
Rows = list[Row]


def read_rows(path: pathlib.Path) -> Rows:
    """Rows of a CSV file; empty where there is no file."""
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def write_rows(path: pathlib.Path, rows: Sequence[Mapping[str, object]]) -> None:
    """Writes rows of the same columns as CSV."""
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def by(rows: Iterable[Row], *columns: str) -> dict[tuple[str, ...], Rows]:
    """Rows in groups that have the same cells in these columns."""
    groups: dict[tuple[str, ...], Rows] = collections.defaultdict(list)
    for row in rows:
        groups[tuple(row[column] for column in columns)].append(row)
    return groups


def number(row: Row, column: str) -> float | None:
    """Number in a cell; none in an empty one."""
    return float(row[column]) if row[column] else None


def values(rows: Iterable[Row], column: str) -> list[float]:
    """Numbers of a column, without its empty cells."""
    return [value for row in rows if (value := number(row, column)) is not None]


def median(rows: Iterable[Row], column: str) -> float:
    return statistics.median(values(rows, column))


def mean(rows: Iterable[Row], column: str) -> float:
    """Mean of a column without its empty cells; 0 where all are empty."""
    return statistics.fmean(values(rows, column) or [0.0])


def digits(value: float) -> str:
    """Three significant digits."""
    if value == 0:
        return "0"
    if abs(value) < 1e-3:
        return f"{value:.1e}".replace("e-0", "e-")
    whole = len(str(int(abs(value)))) if abs(value) >= 1 else 0
    return f"{value:.{max(0, 3 - whole)}f}"


def fixed(row: Row, column: str, places: int) -> str:
    """Number in a cell with so many decimal places; a dash for none."""
    value = number(row, column)
    return "–" if value is None else f"{value:.{places}f}"


class _Cell(str):
    """Cell that is formatted as its number, where it has a format; a dash where it is empty."""

    def __format__(self, form: str) -> str:
        if not form:
            return str(self)
        return format(float(self), form) if self else "–"


def filled(row: Row, form: str) -> str:
    """Text with cells of a row, such as `{ms:.2f} by {system}`; dashes for empty ones."""
    return form.format_map({column: _Cell(cell) for column, cell in row.items()})


def count(value: float) -> str:
    """A whole number, with commas between thousands."""
    return f"{round(value):,}"


def table(head: Sequence[str], rows: Iterable[Sequence[str]], *, tight: bool = False) -> str:
    """A table in Markdown, without a final newline; `tight` has no blanks in its rule."""
    lines = [head, ["---"] * len(head), *rows]
    text = "\n".join(f"| {' | '.join(line)} |" for line in lines)
    if tight:
        return text.replace(" --- ", "---")
    return text.replace("|  |", "| |")


def table_of(rows: Iterable[Row], columns: Mapping[str, str], *, tight: bool = False) -> str:
    """A table in Markdown with a line for each row: columns by their heads, filled with cells."""
    lines = ([filled(row, form) for form in columns.values()] for row in rows)
    return table(list(columns), lines, tight=tight)


def with_tables(text: str, tables: Mapping[str, str]) -> str:
    """Text with these tables between its `<!-- table: NAME -->` and `<!-- end -->`."""
    for name, content in tables.items():
        before, after = f"<!-- table: {name} -->\n", "\n<!-- end -->"
        parts = re.split(f"{re.escape(before)}.*?{re.escape(after)}", text, flags=re.DOTALL)
        if len(parts) != 2:
            sys.exit(f"there are {len(parts) - 1} places for the table {name!r}")
        text = (before + content + after).join(parts)
    return text


def write_tables(page: pathlib.Path, tables: Mapping[str, str]) -> None:
    """Writes tables into their places in a page."""
    page.write_text(with_tables(page.read_text(), tables))
