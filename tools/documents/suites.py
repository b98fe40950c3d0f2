"""Suites of others, whose folders are given: Reflet's pictures beside theirs (docs/suites.md).

--suite names a folder with clones of the suites' repositories, by their names. A measurement takes
two cores without a GPU forty minutes for `fidelity` and up to ten for each of the others. The part
`mitsuba` needs the Python package of that name.
"""

import shutil
import statistics
import sys
from collections import Counter, defaultdict
from pathlib import Path

from reflet_suites import fidelity, imaging, materialx, mitsuba
from tables import Rows, by, read_rows, table, table_of, values

from documents.document import DATA, Document, Run, in_places

PARTS = {
    "fidelity": (fidelity.measure, (fidelity.CONFIG,)),
    "imaging": (imaging.measure, (imaging.LIST,)),
    "mitsuba": (mitsuba.measure, (mitsuba.FOLDER,)),
    "materialx": (materialx.measure, materialx.FOLDERS),
}
"""Measurements, each with files or folders that it reads, any of which has to be there."""


def measure(run: Run) -> None:
    if run.suite is None or not run.suite.is_dir():
        sys.exit(f"--suite must name a folder with clones of the suites; there is no {run.suite}")
    for name, (part, places) in PARTS.items():
        if not run.wants(name):
            continue
        if not any((run.suite / place).exists() for place in places):
            lacks = f"{run.suite} lacks {' and '.join(places)}"
            sys.exit(f"{lacks}; clone the repository there, or name --only others")
        part(run.program, run.suite, run.out / name)


def store(outs: list[Path]) -> None:
    for name in PARTS:
        for out in outs:
            if (out / name / f"{name}.csv").exists():
                shutil.copyfile(out / name / f"{name}.csv", DATA / f"suite-{name}.csv")


def places(rows: Rows) -> str:
    """Mean ranks of each renderer, the nearest by pixels first."""
    lines = []
    for (name,), of in by(rows, "renderer").items():
        shares = [statistics.fmean(values(of, f"{kind} rank")) for kind in fidelity.DISTANCES]
        shown = f"**{name}**" if name == fidelity.OURS else name
        lines.append([shown, str(len(of)), *(f"{share:.2f}" for share in shares)])
    lines.sort(key=lambda line: line[2])
    head = ["renderer", "scenarios", "mean rank by pixels", "by means of 4 × 4"]
    return table([*head, "by pixels with the set's curve", "by means of 4 × 4 with it"], lines)


def farthest(rows: Rows) -> str:
    """Scenarios in which Reflet's picture with the set's curve is the farthest from the others."""
    own = [row for row in rows if row["renderer"] == fidelity.OURS]
    own.sort(key=lambda row: -float(row["aces means"]))
    lines = []
    for row in own[:15]:
        others = [
            float(other["aces brightness"])
            for other in rows
            if other["scenario"] == row["scenario"] and other["renderer"] in fidelity.PATH_TRACERS
        ]
        brighter = float(row["aces brightness"]) - statistics.median(others)
        ranks = [f"{float(row[f'aces {kind} rank']):.2f}" for kind in ("pixels", "means")]
        distance = f"{float(row['aces means']):.3f}"
        name = row["scenario"].removeprefix("khronos-")
        lines.append([name, distance, *ranks, f"{brighter:+.3f}"])
    head = ["scenario", "distance by means", "rank by pixels", "by means", "brighter by"]
    return table(head, lines)


def tests(rows: Rows) -> str:
    """Tests of OpenUSD, wrong ones first."""
    lines = []
    for (name,), of in by(rows, "test").items():
        right = sum(row["right"] == "1" for row in of)
        found = [
            f"{min(values(of, kind)):.2f}"
            for kind in ("overlap", "storm", "reflet")
            if values(of, kind)
        ]
        refused = ", ".join(sorted({f"`{row['refused']}`" for row in of if row["refused"]}))
        cells = [*found, refused] if found else ["–", "–", "–", refused]
        lines.append(
            (
                right == len(of),
                [name.removeprefix("testUsdImagingGL"), f"{right} of {len(of)}", *cells],
            )
        )
    head = ["test", "right pictures", "least overlap", "mean of Storm", "of Reflet", "refused"]
    return table(head, [line for _, line in sorted(lines, key=lambda pair: pair[0])])


def scenes(rows: Rows) -> str:
    """Scenes of Mitsuba that are compared, wrong ones first."""
    compared = sorted((row for row in rows if row["passed"]), key=lambda row: float(row["passed"]))
    columns = {
        "scene": "{scene}",
        "values that pass": "{passed:.2%}",
        "samples": "{samples}",
        "mean of Mitsuba": "{mitsuba:.4f}",
        "mean of Reflet": "{reflet:.4f}",
    }
    return table_of(compared, columns)


def others(rows: Rows) -> str:
    """Scenes of Mitsuba that are not compared, by their plugins."""
    grouped = by((row for row in rows if row["others"]), "others").items()
    lines = [[what, ", ".join(row["scene"] for row in of)] for (what,), of in grouped]
    return table(["without an exact counterpart", "scenes"], sorted(lines))


def documents(rows: Rows) -> str:
    """MaterialX documents by their folders."""
    lines = []
    grouped: dict[str, Rows] = defaultdict(list)
    for row in rows:
        grouped[f"{row['repository']} {row['document'].rpartition('/')[0]}".strip()].append(row)
    for name, of in grouped.items():
        refused = Counter(f"`{row['refused']}`" for row in of if row["refused"])
        whole = sum(not row["refused"] and row["losses"] in ("", materialx.MODEL) for row in of)
        counts = [len(of), sum(map(int, values(of, "materials"))), len(of) - refused.total(), whole]
        said = ", ".join(f"{error}: {number}" for error, number in refused.items())
        lines.append([name, *map(str, counts), said])
    head = ["documents", "number", "materials", "converted", "with all inputs", "refused"]
    return table(head, lines)


def losses(rows: Rows) -> str:
    """Losses of documents, the most frequent first."""
    having: dict[str, list[str]] = defaultdict(list)
    for row in rows:
        for loss in filter(None, row["losses"].split("; ")):
            having[loss].append(row["document"].rpartition("/")[2].removesuffix(".mtlx"))
    lines = []
    for loss, of in sorted(having.items(), key=lambda pair: (-len(pair[1]), pair[0])):
        name, _, detail = loss.rstrip(")").partition(" (")
        lines.append([f"`{name}`", detail, str(len(of)), ", ".join(of) if len(of) < 6 else "…"])
    return table(["warning", "input, node or file", "documents", "namely"], lines)


def tables() -> dict[str, str]:
    ranked = fidelity.rank_rows(DATA / "suite-fidelity.csv")
    mitsubas = read_rows(DATA / "suite-mitsuba.csv")
    materials = read_rows(DATA / "suite-materialx.csv")
    return {
        "places": places(ranked),
        "farthest": farthest(ranked),
        "tests": tests(read_rows(DATA / "suite-imaging.csv")),
        "scenes": scenes(mitsubas),
        "others": others(mitsubas),
        "documents": documents(materials),
        "losses": losses(materials),
    }


DOCUMENT = Document("suites.md", in_places(tables), store, measure)
