"""Where methods fail: scores of the failure modes by all methods (docs/stability.md)."""

import pathlib
import shutil
from collections.abc import Callable

from measuring import ROOT
from tables import Row, Rows, by, filled, number, read_rows, table

from documents.document import DATA, Document, Run, in_places

METHODS = "ssr,probe,ssr+probe,ssr+box,near-far,hybrid,rt"
# Bands of the 99th percentile of FLIP, as the program names them, with their marks.
MARKS = {"not seen": "🟩", "seen in a direct comparison": "🟨", "seen": "🟧", "wrong": "🟥"}
# Difference of two 99th percentiles of FLIP that counts.
AHEAD = 0.005
# Tables of scores against `rt` by their places in the page; a cell is empty where it has none.
SCORES = {
    "means": "{flip:.4f} / {ssim:.3f}",
    "wrong": "{false_accepts_permille:.2f}",
    "flicker": "{flicker:.1%}",
    "popping": "{popping:.1%}",
    "edges": "{edge_flip:.4f} / {inner_flip:.4f}",
    "thin": "{recall_1px_percent:.1f} / {recall_2px_percent:.1f} / {recall_4px_percent:.1f}",
    "seam": "{seam_step:+.2f}",
    "probe-seams": "{probe_seam_step:+.1f}",
    "streaks": "{error_length_px:.1f} px / {stripes:.2f}",
    "moved": "{source_changes_percent:.2f} / {met_changes_percent:.2f}",
}


def heading(mode: str) -> tuple[str, str]:
    """Title and description of a mode, from the first comment of its scene."""
    lines = []
    for line in (ROOT / "scenes" / "fail" / f"{mode}.toml").read_text().splitlines():
        if not line.startswith("#"):
            break
        lines.append(line[1:].strip())
    title, _, about = " ".join(lines).partition(": ")
    return title, about[:1].upper() + about[1:]


def banded(row: Row) -> str:
    return filled(row, f"{MARKS[row['band']]} {{flip_p99:.3f}}") if row["band"] else "not scored"


def scored(form: str) -> Callable[[Row], str]:
    """Cell of a score; empty where it has none of the score's numbers."""

    def cell(row: Row) -> str:
        text = filled(row, form)
        return "" if text == filled(dict.fromkeys(row, ""), form) else text.replace("%", "")

    return cell


class Scores:
    """Cells of all modes and methods."""

    def __init__(self, rows: Rows) -> None:
        self.cells = by(rows, "against", "mode", "method")
        self.modes = list(dict.fromkeys(row["mode"] for row in rows))
        self.methods = list(dict.fromkeys(row["method"] for row in rows))

    def table(self, show: Callable[[Row], str], against: str = "rt") -> str:
        """Table of modes × methods, without modes that have nothing to show."""
        lines = []
        for mode in self.modes:
            found = (self.cells.get((against, mode, method)) for method in self.methods)
            shown = [show(rows[0]) if rows else "" for rows in found]
            if any(shown):
                lines.append([heading(mode)[0], *shown])
        return table(["mode", *self.methods], lines, tight=True)

    def p99(self, mode: str, method: str) -> float | None:
        rows = self.cells.get(("rt", mode, method))
        return number(rows[0], "flip_p99") if rows else None

    def rivals(self) -> str:
        """Modes in which another method than Reflet's own comes closer to `rt`."""
        lines = []
        for method in self.methods:
            if method == "rt" or method.startswith("hybrid"):
                continue
            ahead = []
            for mode in self.modes:
                its, own = self.p99(mode, method), self.p99(mode, "hybrid")
                if its is not None and own is not None and its < own - AHEAD:
                    ahead.append(f"{heading(mode)[0]} ({its:.3f}, {own:.3f})")
            lines.append(f"- {method}: {', '.join(ahead) or 'none'}")
        return "\n".join(lines)

    def verdicts(self) -> str:
        """Each mode in words."""
        parts = []
        for mode in self.modes:
            title, about = heading(mode)
            found = (self.cells.get(("rt", mode, method)) for method in self.methods)
            said = (filled(rows[0], "\n- {method}: {verdict}") for rows in found if rows)
            parts.append(f"\n### {title}\n\n{about}\n{''.join(said)}")
        return "\n".join(parts)


def tables() -> dict[str, str]:
    return told(read_rows(DATA / "stability.csv"))


def told(rows: Rows) -> dict[str, str]:
    """Parts of the page by their places."""
    scores = Scores(rows)
    return {
        "rivals": scores.rivals(),
        "p99": scores.table(banded),
        "p99-truth": scores.table(banded, "truth"),
        **{name: scores.table(scored(form)) for name, form in SCORES.items()},
        "modes": scores.verdicts(),
    }


def measure(run: Run) -> None:
    run.bench("stability", "stability", "--methods", METHODS, "--resume")


def store(outs: list[pathlib.Path]) -> None:
    shutil.copyfile(outs[0] / "stability" / "stability.csv", DATA / "stability.csv")


DOCUMENT = Document("stability.md", in_places(tables), store, measure)
