"""Owns the Markdown of the corpus report: summary beside the rivals, then one line per stage."""

import collections
from typing import Any

from reflet_usd.corpus_scores import (
    KEYED_SKELETONS,
    Score,
    failed_score,
    score_output,
    summary_rows,
)
from reflet_usd.report_row import Row

_DISTANCES = ("positions", "surfaces", "skinning")
_OURS = "reflet-usd"


def format_markdown(rows: list[Row], peers: dict[str, dict[str, Score]], version: str) -> str:
    """The whole report as Markdown; the same rows give the same text."""
    parts = [_summary(rows, peers, version), _strict(rows), _losses(rows), _files(rows)]
    return "\n\n".join(parts) + "\n"


def _summary(rows: list[Row], peers: dict[str, dict[str, Score]], version: str) -> str:
    like = next(iter(peers.values()), {})
    ours = {}
    for row in rows:
        keyed = row.validation.get("stage", {}).get("keyed_skeletons", 0)
        row.root.features[KEYED_SKELETONS] = keyed
        example = like.get(row.root.file)
        if row.converted:
            facts = row.validation.get("facts", {})
            ours[row.root.file] = score_output(row.root, facts, row.validator_errors, example)
        else:
            ours[row.root.file] = failed_score(row.root, example)
    columns = {f"{_OURS} {version}": ours, **peers}
    lines = [
        [title, *(cells[name] for name in columns)]
        for title, cells in summary_rows([row.root for row in rows], columns)
        if any(not cell.endswith("/0") for cell in cells.values())  # else no stage has it
    ]
    return _table(["measure", *columns], lines)


def _table(head: list[str], lines: list[list[str]]) -> str:
    rule = "|---" * len(head) + "|"
    first, *rest = (f"| {' | '.join(line)} |" for line in (head, *lines))
    return "\n".join([first, rule, *rest])


def _strict(rows: list[Row]) -> str:
    """Table of our own, stricter measures: every check of `validate`, and undeclared losses."""
    done = [row for row in rows if row.converted]
    checked = [row for row in done if row.validation]
    exact = [row for row in checked if row.validation["passed"]]
    lossy = [row for row in done if row.warnings]
    silent = [row for row in checked if _silent(row)]
    worst = max((_deviation(row) for row in checked), default=0.0)
    refused = [row for row in rows if not row.converted and row.root.opens is not False]
    lines = [
        ["converted", f"{len(done)} of {len(rows)}"],
        ["equal to the stage in every check, or the loss declared", f"{len(exact)}"],
        ["with a silent deviation", f"{len(silent)}"],
        ["that could not be checked", f"{len(done) - len(checked)}"],
        ["with declared losses (named warnings)", f"{len(lossy)}"],
        ["that open but were refused", f"{len(refused)}"],
        ["worst corner deviation, of the diagonal", f"{worst:.2g}"],
    ]
    return _table(["every check of `validate`", "stages"], lines)


def _losses(rows: list[Row]) -> str:
    counts: collections.Counter[str] = collections.Counter()
    for row in rows:
        counts.update({warning["name"] for warning in row.warnings})
    order = sorted(counts.items(), key=lambda item: (-item[1], item[0]))
    return _table(["declared loss", "stages"], [[f"`{name}`", f"{n}"] for name, n in order])


def _files(rows: list[Row]) -> str:
    head = ["stage", "converted", "validator errors", "worst corner", "silent", "warnings"]
    return _table(head, [_cells(row) for row in rows])


def _cells(row: Row) -> list[str]:
    if not row.converted:
        expected = " (broken on purpose)" if row.root.opens is False else ""
        return [row.root.file, f"no: `{row.reason}`{expected}", "", "", "", ""]
    if not row.validation:
        return [row.root.file, "yes", "", f"`{row.reason}`", "", _warnings(row)]
    errors = "" if row.validator_errors is None else str(row.validator_errors)
    silent = ", ".join(_silent(row))
    return [row.root.file, "yes", errors, f"{_deviation(row):.1e}", silent, _warnings(row)]


def _warnings(row: Row) -> str:
    counts = collections.Counter(warning["name"] for warning in row.warnings)
    shown = [f"{name} ×{n}" if n > 1 else name for name, n in sorted(counts.items())]
    return ", ".join(shown)


def _silent(row: Row) -> list[str]:
    """Names of the checks with an undeclared deviation."""
    return [check["check"] for check in _checks(row) if not check["passed"]]


def _deviation(row: Row) -> float:
    """Worst corner distance over all drawn prims and times, as a share of the diagonal."""
    values = [check["worst"] for check in _checks(row) if check["check"] in _DISTANCES]
    return max((float("inf") if value == "infinite" else value for value in values), default=0.0)


def _checks(row: Row) -> list[dict[str, Any]]:
    return row.validation.get("checks", [])
