"""hybrid beside rt on a GPU, in the views of docs/views.md at several sizes (docs/gpu.md).

Times are the least of all frames, since a GPU that waits lowers its clock; ratios are medians of
pairs of frames, of both methods in turns.
"""

import pathlib
import statistics

from tables import Row, Rows, by, count, read_rows, table, write_rows

from documents import views
from documents.document import DATA, Document, Run, folder_of, in_places, samples

SIZES = ("1280 × 720", "1920 × 1080", "3840 × 2160")
# Cards and sizes of the table of times; the table of passes is of the last.
CASES = (("H100", SIZES[0]), ("H100", SIZES[1]), ("H200", SIZES[1]))
PASSES = ("primary", "ssr", "trace")
COLUMNS = [
    *["view", "size", "method", "edge_px", "reflection_ms", "ratio"],
    *(f"pass_{name}_ms" for name in PASSES),
    *["trace_traversals", "trace_visited_nodes", "march_steps", "mask_flip", "adapter", "driver"],
]


def part(view: str, size: str) -> str:
    return f"{view} {size.replace(' × ', 'x')}"


def measure(run: Run) -> None:
    """Times both methods in each view at each size, after frames in which the clock may rise."""
    values = ["--parameter", "edge_px", "--values", f"{views.STRICTEST},{views.DEFAULT}"]
    values += ["--methods", "hybrid,rt", "--frames", "20", "--warm-up", "20", "--counters"]
    for size in SIZES:
        for view, scene in views.VIEWS.items():
            if run.wants(part(view, size)):
                options = [*scene, *run.models(), "--assets", "scenes", "--resume"]
                options += ["--sizes", size.replace(" × ", "x")]
                run.bench(part(view, size), *options, *values)


def settings_of(rows: Rows) -> Rows:
    """One row for each method and value, from the rows of its frames."""
    rows = [row for row in rows if row["status"] == "ok"]
    rt = {r["repetition"]: float(r["reflection_ms"]) for r in rows if r["method"] == "rt"}

    def of(frames: Rows) -> Row:
        ratios = [float(row["reflection_ms"]) / rt[row["repetition"]] for row in frames]
        timed = [column for column in COLUMNS if column.endswith("_ms")]
        least = {name: f"{min(float(row.get(name) or 0) for row in frames):.4f}" for name in timed}
        return frames[0] | least | {"ratio": f"{statistics.median(ratios):.3f}"}

    kinds = by(rows, "method").values()
    return [of(frames) for kind in kinds for frames in by(kind, "edge_px").values()]


def tables() -> dict[str, str]:
    rows = read_rows(DATA / "gpu.csv")

    def found(
        view: str, case: tuple[str, str], method: str, edge_px: float = views.DEFAULT
    ) -> Row | None:
        card, size = case
        of_case = [row for row in rows if row["size"] == size and card in row["adapter"]]
        of = views.of(of_case, view, method, edge_px)
        return of[0] if of else None

    def times(view: str) -> list[str]:
        cells = [view]
        for case in CASES:
            rt = found(view, case, "rt")
            own = [found(view, case, "hybrid", e) for e in (views.DEFAULT, views.STRICTEST)]
            cells.append(f"{float(rt['reflection_ms']):.2f}" if rt else "–")
            cells += [f"{float(row['ratio']):.2f}" if row else "–" for row in own]
        return cells

    def passes(view: str) -> list[str]:
        rt, own = (found(view, CASES[-1], method) for method in ("rt", "hybrid"))
        assert rt and own
        rays, nodes = (float(rt[f"trace_{name}"]) for name in ("traversals", "visited_nodes"))
        ms = [float(row[f"pass_{name}_ms"]) for row, name in (
            (rt, "trace"), (own, "trace"), (own, "ssr"), (rt, "primary"),
        )]  # fmt: skip
        ms[1] += float(own.get("pass_hits_ms", 0))  # before hits were shaded in `trace`
        traced = [count(rays), f"{nodes / rays:.1f}", count(float(own["trace_traversals"]))]
        return [view, *traced, *(f"{each:.2f}" for each in ms)]

    heads = {
        "times": ["view", *(
            cell for case in CASES
            for cell in (f"{', '.join(case)}: `rt`, ms", "`hybrid` ÷ `rt`", "`edge_px` 0")
        )],
        "passes": [
            "view", "rays of `rt`", "nodes a ray", "rays of `hybrid`", "`rt`: trace, ms",
            "`hybrid`: trace and hits", "march", "primary rays",
        ],
    }  # fmt: skip
    lines = {"times": times, "passes": passes}
    return {name: table(head, map(lines[name], views.VIEWS)) for name, head in heads.items()}


def store(outs: list[pathlib.Path]) -> None:
    rows: Rows = []
    for out in outs:
        for size in SIZES:
            for view in views.VIEWS:
                if (out / folder_of(part(view, size))).exists():
                    measured = settings_of(samples(out, part(view, size)))
                    rows += [row | {"view": view, "size": size} for row in measured]
    write_rows(DATA / "gpu.csv", [{c: row.get(c, "") for c in COLUMNS} for row in rows])


DOCUMENT = Document("gpu.md", in_places(tables), store, measure)
