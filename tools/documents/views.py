"""hybrid beside rt in named views at 1280 x 720 (docs/views.md).

Accuracy is measured on the reflections, against rt with bounces = "auto"; time is processor time of
the reflection passes on a software adapter, frames of both methods in turns. Errors and counts come
from the first OUT, times from each.
"""

import pathlib

import tomllib
from measuring import settings
from tables import Rows, by, count, fixed, median, read_rows, table, write_rows

from documents.document import (
    DATA,
    Document,
    Run,
    accepted_px,
    driver_of,
    in_places,
    samples,
    some_columns,
)

SIZE = "1280x720"
FRAMES = 5
DEFAULT, STRICTEST = 0.25, 0.0  # reflection.edge_px
COLUMNS = [
    *["view", "method", "edge_px", "repetition", "reflection_cpu_ms", "reflective_px"],
    *["screen_percent", "false_accepts", "mask_px", "mask_flip", "mask_flip_p99", "mask_ssim"],
    *["march_steps", "traversals", "visited_nodes", "tested_triangles", "driver"],
]

# Views by name: the scene, and overrides of its values.
VIEWS: dict[str, list[str]] = {
    view["name"]: [view["scene"], *settings(*view.get("set", []))]
    for view in tomllib.loads((DATA / "views.toml").read_text())["view"]
}


def measure(run: Run) -> None:
    values = ["--parameter", "edge_px", "--values", f"{STRICTEST},{DEFAULT}"]
    values += ["--methods", "hybrid,rt", "--frames", str(FRAMES), "--warm-up", "1"]
    for view, scene in VIEWS.items():
        if run.wants(view):
            options = [*scene, *run.models(), "--assets", "scenes", "--sizes", SIZE]
            run.bench(view, *options, *values, "--counters", "--resume")


def of(rows: Rows, view: str, method: str, edge_px: float | None = None) -> Rows:
    found = [r for r in rows if r["view"] == view and r["method"] == method]
    return [r for r in found if edge_px is None or float(r["edge_px"]) == edge_px]


def errors(rows: Rows) -> str:
    def line(view: str, edge_px: float) -> list[str]:
        row = of(rows, view, "hybrid", edge_px)[0]
        wrong = 1000 * float(row["false_accepts"] or 0) / max(accepted_px(row), 1.0)
        columns = (("flip", 4), ("flip_p99", 3), ("ssim", 4))
        scores = [fixed(row, f"mask_{column}", places) for column, places in columns]
        on_screen = f"{fixed(row, 'screen_percent', 0)} %"
        return [view, f"{edge_px:g}", *scores, f"{wrong:.1f}", on_screen]

    head = ["view", "`edge_px`", "FLIP", "p99", "SSIM", "wrong surfaces, ‰ of the hits"]
    lines = (line(view, edge_px) for view in VIEWS for edge_px in (DEFAULT, STRICTEST))
    return table([*head, "on screen"], lines)


def times(measured: list[Rows]) -> str:
    """Times on each driver: of rt, and of hybrid divided by rt's."""

    def cells(rows: Rows, view: str) -> list[str]:
        rt_ms = median(of(rows, view, "rt"), "reflection_cpu_ms")
        own = [of(rows, view, "hybrid", edge_px) for edge_px in (DEFAULT, STRICTEST)]
        ratios = [f"{median(rs, 'reflection_cpu_ms') / rt_ms:.2f}" for rs in own]
        return [f"{rt_ms:.0f}", *ratios]

    head = ["view"]
    for rows in measured:
        head += [f"{driver_of(rows[0])}: `rt`, ms", "`hybrid` ÷ `rt`", "`edge_px` 0"]
    lines = ([view, *(c for rows in measured for c in cells(rows, view))] for view in VIEWS)
    return table(head, lines)


def counts(rows: Rows) -> str:
    def line(view: str) -> list[str]:
        rt = of(rows, view, "rt")
        own = [of(rows, view, "hybrid", edge_px) for edge_px in (DEFAULT, STRICTEST)]
        nodes = [float(rs[0]["visited_nodes"]) for rs in (*own, rt)]
        share = [f"{n / nodes[2]:.2f}" for n in nodes[:2]]
        return [view, *share, count(float(own[0][0]["march_steps"])), count(nodes[2])]

    head = ["view", "nodes ÷ `rt`", "`edge_px` 0", "march steps", "nodes that `rt` visits"]
    return table(head, map(line, VIEWS))


def tables() -> dict[str, str]:
    measured = list(by(read_rows(DATA / "views.csv"), "driver").values())
    first = measured[0]
    return {"errors": errors(first), "times": times(measured), "counts": counts(first)}


def store(outs: list[pathlib.Path]) -> None:
    rows = [row | {"view": view} for out in outs for view in VIEWS for row in samples(out, view)]
    write_rows(DATA / "views.csv", some_columns(rows, COLUMNS))


DOCUMENT = Document("views.md", in_places(tables), store, measure)
