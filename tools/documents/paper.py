"""The experiments of docs/paper.md, measured on our scenes: tables, charts and sheets.

Tables are computed here from the samples of each run, not by the report. Each OUT is measured on
one driver: all tables are of the first, but the table of drivers has a part of each. The text
around them is written by hand: check it against new numbers.
"""

import pathlib
import re
import shutil
import statistics
import tempfile
from collections.abc import Callable

from measuring import ROOT, render, settings
from PIL import Image, ImageChops
from sheet import sheet
from tables import (
    Row,
    Rows,
    by,
    count,
    digits,
    filled,
    fixed,
    mean,
    median,
    number,
    read_rows,
    table,
    table_of,
    values,
    write_rows,
)

from documents.document import (
    CHARTS,
    DATA,
    IMAGES,
    METHODS,
    Document,
    Run,
    driver_of,
    in_places,
    samples,
)

SCENES = "scenes/paper"
# The paper's three, as a multiple of U.
THRESHOLDS = ["0.005", "0.025", "0.065"]
# And 24 in equal steps of their logarithm, in three digits.
SWEPT = sorted([*(f"{0.0005 * 1000 ** (i / 23):.3g}" for i in range(24)), *THRESHOLDS], key=float)
SURFACES = {"60 / 30": "ground", "61 / 29": "ground with normal map", "45 / 55": "sphere"}
SURFACES |= {"49 / 51": "sphere with normal map", "44 / 56": "bunny"}


def scenario3_scene(name: str) -> str:
    """Scene of a reflective surface."""
    return f"{SCENES}/scenario3{'' if name == 'ground' else '_' + name.replace(' ', '_')}.toml"


SMALL = ["--sizes", "320x180"]
# The scene's own settings by each method.
STILL = ["--parameter", "scale", "--values", "1"]
WALK = [f"{SCENES}/walk.toml", *STILL]
ONCE = ["--frames", "1", "--warm-up", "1"]
RUNS = {
    "scenario1": [f"{SCENES}/scenario1.toml", *STILL, "--split-trace", *SMALL, "--frames", "20"],
    "fig1": [
        *[f"{SCENES}/sponza.toml", "--parameter", "threshold_u", "--values", ",".join(SWEPT)],
        *[*SMALL, "--frames", "3", "--warm-up", "1"],
    ],
    "sizes": [
        *[*WALK, "--sizes", "640x480,1280x720,1920x1080", "--timeline", "0-949:475", *ONCE],
    ],
    "walk": [*WALK, *SMALL, "--timeline", "0-949:38", *ONCE],
    "scenario3": [
        *[*map(scenario3_scene, SURFACES.values()), "--parameter", "ray_length_u"],
        *["--values", "4,16", *SMALL, "--frames", "7"],
    ],
    "atrium": ["--sizes", "640x360"],
}
# Run whose table has a row for each system and frame in place of samples.
SYSTEMS = ["comparators", WALK[0], "--size", "320x180", "--timeline", "0-949:38"]
# Charts of the page: the run, and the chart's file name in the run's folder.
PICTURES = {
    "fig1-flip-over-t.svg": ("fig1", "line-chart-1-parameter.svg"),
    "walk-ssim.svg": ("walk", "line-chart-1-ssim.svg"),
    "walk-ms.svg": ("walk", "line-chart-1-ms.svg"),
    "walk-systems-ms.svg": ("systems", "walk-ms.svg"),
    "walk-systems-flip.svg": ("systems", "walk-flip.svg"),
    "atrium-flip.svg": ("atrium", "chart-1-flip.svg"),
}


def measure(run: Run) -> None:
    for name, arguments in RUNS.items():
        if run.wants(name):
            models = [] if name == "atrium" else run.models()
            run.bench(name, *arguments, "--resume", *models)
    if not (run.out / "systems" / "frames.csv").exists() and run.wants("systems"):
        run.bench("systems", *SYSTEMS, *run.models())


def picture(run: Run, folder: str, scene: str, size: tuple[int, int], *options: str) -> Image.Image:
    """Renders a scene of the paper; by `--aov source`, where its reflections come from."""
    out = pathlib.Path(folder) / "picture.png"
    render(run.program, ROOT / scene, out, size, *options, *run.models())
    shown = Image.open(out.with_suffix(".source.png") if "source" in options else out)
    return shown.convert("RGB")


def pictures(run: Run) -> None:
    with tempfile.TemporaryDirectory() as folder:
        fig1_sheet(run, folder)
        scenario3_sheet(run, folder)


def fig1_sheet(run: Run, folder: str) -> None:
    """The floor of Fig. 1's scene, where stripes and prolonged reflections show."""
    shots = [("rt", "", "")]
    shots += [("ssr", t, "") for t in THRESHOLDS]
    shots += [("hybrid", t, aov) for aov in ("", "source") for t in ("", "0.025")]
    cells = []
    for method, t, aov in shots:
        rule = ["reflection.accept=threshold", f"reflection.threshold_u={t}"] if t else []
        options = ["--method", method, *settings(*rule), *(["--aov", aov] if aov else [])]
        shown = picture(run, folder, f"{SCENES}/sponza.toml", (1280, 720), *options)
        rule_name = f", T = {t} U" if t else ", verified"
        what = "rt" if method == "rt" else method + rule_name
        cells.append((f"{what}{', sources' if aov else ''}", shown))
    floor = (320, 390, 860, 720)
    sheet(cells, 4, 480, crop=floor).save(IMAGES / "paper-fig1.png", optimize=True)


def scenario3_sheet(run: Run, folder: str) -> None:
    """The plane and the sphere: picture, sources, and differences from the picture of rt."""
    cells = []
    for name in ("ground", "sphere"):

        def shown(method: str, *options: str, scene: str = scenario3_scene(name)) -> Image.Image:
            return picture(run, folder, scene, (320, 180), "--method", method, *options)

        rt = shown("rt", *settings('reflection.bounces="auto"'))
        cells += [("rt", rt), ("hybrid, sources", shown("hybrid", "--aov", "source"))]
        for method, gain in (("hybrid", 4), ("ssr", 2)):
            difference = ImageChops.difference(shown(method), rt)
            label = f"{method}, difference x{gain}"
            cells.append((label, difference.point([min(255, v * gain) for v in range(256)] * 3)))
    sheet(cells, 4, 320).save(IMAGES / "paper-scenario3.png", optimize=True)


def of_reflections(rows: Rows) -> Rows:
    """Rows with passes in processor time, where known, since other programs do not lengthen it,
    and without the work of primary rays, which all methods share."""

    def alone(row: Row) -> Row:
        times = {f"{of}_ms": row.get(f"{of}_cpu_ms") for of in ("passes", "reflection")}
        work = {
            column: str(float(row[column]) - float(row[f"primary_{column}"]))
            for column in ("traversals", "visited_nodes", "tested_triangles")
            if row[column] and row.get(f"primary_{column}")
        }
        return row | {column: ms for column, ms in times.items() if ms} | work

    return [alone(row) for row in rows]


def frame_ms(rows: Rows) -> dict[str, float]:
    """Frame time by method: its reflection passes plus the median of the passes that all share."""
    common = [float(r["passes_ms"]) - float(r["reflection_ms"]) for r in rows]
    shared = statistics.median(common)
    return {m: shared + median(rs, "reflection_ms") for (m,), rs in by(rows, "method").items()}


def scenario1_times(rows: Rows) -> str:
    def line(name: str, ms: dict[str, float]) -> list[str]:
        ssr, hybrid, rt = (ms[m] for m in METHODS)
        ratios = [hybrid / rt, ssr / rt, hybrid / ssr]
        return [name, *map(digits, [ssr, hybrid, rt]), *(f"{r:.2f}" for r in ratios)]

    own = {m: median(rs, "reflection_ms") for (m,), rs in by(rows, "method").items()}
    head = ["", "SSR", "hybrid", "RT", "hybrid / RT", "SSR / RT", "hybrid / SSR"]
    paper = ["paper, ms a frame", "6.1", "16.9", "21.2", "0.80", "0.29", "2.77"]
    ours = line("ours, ms a frame", frame_ms(rows))
    return table(head, [paper, ours, line("ours, reflection passes only, ms", own)])


def scenario1_passes(rows: Rows) -> str:
    columns = [c for c in rows[0] if re.fullmatch(r"pass_\w+_ms", c)]
    recorded = [c for c in columns if any(number(r, c) for r in rows)]
    names = [c.removeprefix("pass_").removesuffix("_ms") for c in recorded]
    split = names.index("trace")
    early, late = names[:split], names[split + 1 :]

    def line(method: str, rs: Rows) -> list[str]:
        both = [(t, float(r["pass_trace_ms"])) for r in rs if (t := number(r, "traverse_ms"))]
        traversal = statistics.median(t for t, _ in both) if both else 0.0
        shading = statistics.median(all_ms - t for t, all_ms in both) if both else 0.0
        apart = "–" if shading < 0 else digits(shading)
        passes = [[digits(median(rs, f"pass_{p}_ms")) for p in part] for part in (early, late)]
        held = f"{float(rs[0]['bytes']) / 2**20:.0f}"
        return [f"`{method}`", *passes[0], digits(traversal), apart, *passes[1], held]

    head = ["", *early, "trace: traversal", "trace: shading", *late, "memory, MiB"]
    groups = by(rows, "method")
    return table(head, [line(m, groups[(m,)]) for m in METHODS])


SCENARIO1_WORK = {
    "": "`{method}`",
    "march steps": "{march_steps:,.0f}",
    "traversals": "{traversals:,.0f}",
    "nodes visited": "{visited_nodes:,.0f}",
    "triangles tested": "{tested_triangles:,.0f}",
}
SCENARIO1_ERRORS = {
    "": "`{method}`",
    "SSIM, frame": "{ssim:.4f}",
    "SSIM, in reflections": "{mask_ssim:.4f}",
    "FLIP, in reflections": "{mask_flip:.4f}",
    "false accepts": "{false_accepts:.0f}",
    "false rejects": "{false_rejects:.0f}",
}


def scenario1(columns: dict[str, str]) -> Callable[[Rows], str]:
    """Table of the first sample of each method."""
    return lambda rows: table_of((by(rows, "method")[(m,)][0] for m in METHODS), columns)


def fig1(rows: Rows) -> str:
    of = {(r["method"], float(r["value"] or 0)): r for r in rows}
    head = ["T, U", "screen %", "`ssr` FLIP", "`ssr` SSIM", "`hybrid` FLIP", "`hybrid` SSIM"]
    head += ["false accepts", "false rejects by T", "of refused by T", "nodes that `hybrid` visits"]

    def line(t: float) -> list[str]:
        ssr, hybrid = of["ssr", t], of["hybrid", t]
        errors = "{mask_flip:.3f}|{mask_ssim:.3f}"
        own = errors + "|{false_accepts:.0f}|{false_reject_hidden_px:.0f}|{cause_hidden_px:.0f}"
        cells = filled(ssr, "{screen_percent:.1f}|" + errors).split("|")
        return [f"{t:g}", *cells, *filled(hybrid, own + "|{visited_nodes:,.0f}").split("|")]

    return table(head, map(line, [0.0005, 0.005, 0.025, 0.065, 0.5]))


def sizes(rows: Rows) -> str:
    head = ["", "reflection ms of both frames: `ssr`, `hybrid`, `rt`", "hybrid / RT"]
    head += ["nodes visited, hybrid / RT", "SSIM of the frame: `ssr`, `hybrid`"]
    head += ["in reflections: `ssr`, `hybrid`"]

    def line(size: tuple[str, ...], rs: Rows) -> list[str]:
        of = by(rs, "method")
        total = {m: sum(values(of[(m,)], "reflection_ms")) for m in METHODS}
        nodes = {m: sum(values(of[(m,)], "visited_nodes")) for m in METHODS}

        def ssim(column: str) -> str:
            return ", ".join(f"{mean(of[(m,)], column):.3f}" for m in METHODS[:2])

        ms = ", ".join(f"{total[m]:.0f}" for m in METHODS)
        ratios = [f"{of_both['hybrid'] / of_both['rt']:.2f}" for of_both in (total, nodes)]
        return [" × ".join(size), ms, *ratios, ssim("ssim"), ssim("mask_ssim")]

    return table(head, [line(size, rs) for size, rs in by(rows, "width", "height").items()])


def walk(rows: Rows) -> str:
    of = by(rows, "method")
    each: dict[str, Rows] = {m: sorted(of[(m,)], key=lambda r: int(r["frame"])) for m in METHODS}
    judged = len(values(each["ssr"], "mask_ssim"))
    reflection = {m: values(each[m], "reflection_ms") for m in METHODS}
    wall = {m: mean(each[m], "frame_ms") for m in METHODS}
    pairs = zip(reflection["hybrid"], reflection["rt"], strict=True)
    ratio = statistics.median(a / b for a, b in pairs)
    nodes = {m: sum(values(each[m], "visited_nodes")) for m in METHODS}

    def row(name: str, show: Callable[[str], str], last: str = "") -> list[str]:
        return [name, *(show(m) for m in METHODS), last]

    def flicker(m: str) -> str:
        parts = [sum(values(each[m], f"temporal_{c}")) for c in ("difference", "change")]
        return f"{100 * parts[0] / parts[1]:.1f} %"

    lines = [
        row("SSIM of the frame, mean", lambda m: f"{mean(each[m], 'ssim'):.4f}"),
        row("SSIM of the frame, least", lambda m: f"{min(values(each[m], 'ssim')):.4f}"),
        row(
            f"SSIM in reflections, mean of the {judged} frames that have enough",
            lambda m: f"{mean(each[m], 'mask_ssim'):.3f}",
        ),
        row("temporal error", flicker),
        row("wall ms, mean", lambda m: f"{wall[m]:.0f}", f"{wall['hybrid'] / wall['rt']:.2f}"),
        row(
            "reflection ms, median",
            lambda m: digits(statistics.median(reflection[m])),
            f"{ratio:.2f} (median of ratios)",
        ),
        row(
            "tree nodes visited, sum",
            lambda m: count(nodes[m]),
            f"{nodes['hybrid'] / nodes['rt']:.2f}",
        ),
        row("march steps, sum", lambda m: count(sum(values(each[m], "march_steps")))),
    ]
    head = [f"over {len(each['rt'])} frames", *(f"`{m}`" for m in METHODS), "hybrid / RT"]
    return table(head, lines)


def walk_systems(rows: Rows, walked: Rows) -> str:
    """Medians and extremes over the frames of each system; errors of frames that are scored."""
    head = ["system", "median ms", "largest", "made anew, ms"]
    scored = {r["frame"] for r in walked if r["mask_flip"]}
    head += [f"mean FLIP, {len(scored)} frames", "largest", "wrong, %"]

    def line(system: str, rs: Rows) -> list[str]:
        judged = [r for r in rs if r["frame"] in scored]
        ms, flip = values(rs, "ms"), values(judged, "flip")
        anew = median(rs, "update_ms")
        times = [digits(statistics.median(ms)), digits(max(ms)), digits(anew) if anew else "–"]
        wrong = mean(judged, "wrong_percent")
        errors = [f"{mean(judged, 'flip'):.4f}", f"{max(flip):.4f}", f"{wrong:.1f}"]
        return [f"`{system}`" if system in METHODS else system, *times, *errors]

    return table(head, [line(system, rs) for (system,), rs in by(rows, "system").items()])


def surface(row: Row) -> str:
    """Name of the reflective surface in a row's scene."""
    scene = row["scene"].replace("_", " ")
    return max((s for s in SURFACES.values() if s in scene), key=len, default="ground")


def scenario3_shares(rows: Rows) -> str:
    columns = ["screen_percent", "traced_percent", "none_percent"]
    of: dict[tuple[str, float], Row] = {
        (surface(r), float(r["ray_length_u"])): r for r in rows if r["method"] == "hybrid"
    }

    def parts(row: Row) -> str:
        return " / ".join(fixed(row, c, 1) for c in columns)

    head = ["surface", "paper, screen / traced"]
    head += [f"length {length}: screen / traced / none" for length in (4, 16)]
    lines = [
        [name, paper, parts(of[name, 4.0]), parts(of[name, 16.0])]
        for paper, name in SURFACES.items()
    ]
    return table(head, lines)


def scenario3_errors(rows: Rows) -> str:
    head = ["surface", "`ssr` SSIM, frame", "in reflections", "`hybrid` SSIM, frame"]
    head += ["in reflections", "reflection ms: `ssr`", "`hybrid`", "`rt`", "hybrid / RT"]
    head += ["march steps", "nodes that `rt` visits", "spared by `hybrid`"]
    far = [r for r in rows if float(r["ray_length_u"]) == 16]

    def line(name: str) -> list[str]:
        of = by([r for r in far if surface(r) == name], "method")
        ssr, hybrid, rt = (of[(m,)] for m in METHODS)
        ssim = [fixed(rs[0], c, 3) for rs in (ssr, hybrid) for c in ("ssim", "mask_ssim")]
        ms = [median(rs, "reflection_ms") for rs in (ssr, hybrid, rt)]
        nodes = [float(rs[0]["visited_nodes"]) for rs in (hybrid, rt)]
        spared = f"{100 * (1 - nodes[0] / nodes[1]):.0f} %"
        work = [count(float(hybrid[0]["march_steps"])), count(nodes[1]), spared]
        return [name, *ssim, *map(digits, ms), f"{ms[1] / ms[2]:.2f}", *work]

    return table(head, map(line, SURFACES.values()))


def atrium(rows: Rows) -> str:
    common = [float(r["passes_ms"]) - float(r["reflection_ms"]) for r in rows]
    of = by(rows, "method", "parameter", "value")
    head = ["", "FLIP in reflections", "ms a frame", "march steps", "nodes visited"]
    chosen = [("ssr", "steps", 16.0), ("ssr", "steps", 64.0)]
    chosen += [("hybrid", "threshold_u", value) for value in (0.001, 0.025, 0.2)]
    chosen += [("hybrid", "edge_px", value) for value in (0.0, 0.25, 1.0)]
    chosen += [("rt", "bounces", 2.0), ("rt", "bounces", 3.0)]
    names = {"threshold_u": "T"}

    def line(method: str, parameter: str, value: float) -> list[str]:
        key = next(k for k in of if k[:2] == (method, parameter) and float(k[2]) == value)
        rs = of[key]
        unit = " U" if key[1] == "threshold_u" else ""
        ms = statistics.median(common) + median(rs, "reflection_ms")
        work = [count(float(rs[0][c])) for c in ("march_steps", "visited_nodes")]
        wrong = [rs[0][c] and count(float(rs[0][c])) for c in ("false_accepts", "false_rejects")]
        label = f"`{method}`, {names.get(key[1], key[1])} = {value:g}{unit}"
        flip = fixed(rs[0], "mask_flip", 4)
        return [label, flip, digits(ms), *work, *(w or "–" for w in wrong)]

    lines = [line(*c) for c in chosen]
    return table([*head, "false accepts", "false rejects"], lines)


def measured(runs: dict[str, Rows]) -> str:
    def line(name: str, rows: Rows) -> list[str]:
        once = {r["repetition"] for r in rows}
        seen = by(rows, "frame")
        frames = f"{len(once)} each of {len(seen)}" if len(seen) > 1 else str(len(once))
        arguments = " ".join(["reflet bench", *RUNS[name]])
        assets = "" if name == "atrium" else " --assets DIR"
        commits = ", ".join(sorted({r["commit"] for r in rows}))
        return [f"`{arguments}{assets}`", commits, frames]

    return table(["command", "commit", "frames a setting"], [line(n, r) for n, r in runs.items()])


def driver_rows(runs: dict[str, Rows]) -> Rows:
    """Times of rt, and of hybrid over it, in each scene on the driver of these runs."""
    scenes = {"Scenario 1, 320 × 180": runs["scenario1"], "walk, 320 × 180": runs["walk"]}
    for (width, height), rows in by(runs["sizes"], "width", "height").items():
        scenes[f"walk, {width} × {height}"] = rows
    far = [r for r in runs["scenario3"] if float(r["ray_length_u"]) == 16]
    for name in SURFACES.values():
        scenes[f"Scenario 3, {name}, 320 × 180"] = [r for r in far if surface(r) == name]
    driver = driver_of(runs["scenario1"][0])

    def row(scene: str, rows: Rows) -> Row:
        rt, hybrid = (median(by(rows, "method")[(m,)], "reflection_ms") for m in ("rt", "hybrid"))
        times = {"rt_ms": digits(rt), "hybrid_over_rt": f"{hybrid / rt:.2f}"}
        return {"driver": driver, "scene": scene} | times

    return [row(scene, rows) for scene, rows in scenes.items()]


def drivers(rows: Rows) -> str:
    names = list(dict.fromkeys(row["driver"] for row in rows))
    head = ["", *(cell for name in names for cell in (f"{name}: `rt`, ms", "hybrid / RT"))]
    lines = by(rows, "scene").items()
    cells = ([s, *(c for r in rs for c in (r["rt_ms"], r["hybrid_over_rt"]))] for (s,), rs in lines)
    return table(head, cells)


TABLES: dict[str, tuple[str, Callable[[Rows], str]]] = {
    "scenario1-times": ("scenario1", scenario1_times),
    "scenario1-passes": ("scenario1", scenario1_passes),
    "scenario1-work": ("scenario1", scenario1(SCENARIO1_WORK)),
    "scenario1-errors": ("scenario1", scenario1(SCENARIO1_ERRORS)),
    "fig1": ("fig1", fig1),
    "sizes": ("sizes", sizes),
    "walk": ("walk", walk),
    "scenario3-shares": ("scenario3", scenario3_shares),
    "scenario3-errors": ("scenario3", scenario3_errors),
    "atrium": ("atrium", atrium),
}


def tables() -> dict[str, str]:
    runs = {name: of_reflections(read_rows(DATA / f"{name}.csv")) for name in RUNS}
    return {
        **{name: make(runs[run]) for name, (run, make) in TABLES.items()},
        "measured": measured(runs),
        "walk-systems": walk_systems(read_rows(DATA / "walk-systems.csv"), runs["walk"]),
        "drivers": drivers(read_rows(DATA / "drivers.csv")),
    }


def store(outs: list[pathlib.Path]) -> None:
    out = outs[0]
    for name in RUNS:
        shutil.copyfile(out / name / "samples.csv", DATA / f"{name}.csv")
    shutil.copyfile(out / "systems" / "frames.csv", DATA / "walk-systems.csv")
    read = ({name: of_reflections(samples(out, name)) for name in RUNS} for out in outs)
    write_rows(DATA / "drivers.csv", [row for runs in read for row in driver_rows(runs)])
    for name, (run, drawn) in PICTURES.items():
        shutil.copyfile(out / run / drawn, CHARTS / name)


DOCUMENT = Document("paper.md", in_places(tables), store, measure, pictures)
