"""Other ways of finding reflections beside Reflet's own (docs/comparators.md)."""

import os
import pathlib
import re
import shutil
import statistics
import sys
import tempfile
from collections.abc import Iterable

import numpy as np
from measuring import ROOT, render, settings
from numpy.lib.stride_tricks import sliding_window_view
from PIL import Image
from sheet import sheet
from tables import Row, Rows, by, filled, number, read_rows, table, table_of, values, write_rows

from documents.document import CHARTS, DATA, DOCS, Document, Run, in_places, samples

PAGE = DOCS / "comparators.md"
# Least difference of two mean FLIPs that their digits in a sentence show.
LEAST_DIFFERENCE = 1e-4
# Systems that do the same work where nothing is skipped.
EQUAL_WORK = [("rt", "rt, skip 1 px"), ("hybrid", "hybrid, skip 1 px")]
# Scenes whose seams between probes are measured: a floor of several objects, and one that moves.
SEAMS: dict[str, list[str]] = {
    "scenes/fail/30-probe-seams.toml": [],
    "scenes/fail/29-probe-borders.toml": ["--timeline", "all"],
}


# Failures that authors name, in the order of the page's pictures: a scene made to provoke each, its
# frame, and settings of the system.
FAILURES: list[tuple[str, int | None, list[str]]] = [
    ("scenes/fail/01-off-screen.toml", 0, ["reflection.method=ssr"]),
    ("scenes/fail/02-hidden.toml", 0, ["reflection.method=ssr", "reflection.layers=2"]),
    (
        "scenes/fail/29-probe-borders.toml",
        12,
        ["reflection.method=probe", "probes.lookup=box", "probes.nearest=1"],
    ),
    (
        "scenes/mirrors.toml",
        None,
        ['reflection.method="ssr+probe"', "probes.lookup=distance", "probes.nearest=2"],
    ),
    ("scenes/fail/03-rails.toml", None, ["reflection.method=rt", "reflection.rate=4"]),
    ("scenes/grains.toml", None, ["reflection.method=rt", "reflection.skip_px=1"]),
]
# Size of the shown part of a failure, pixels.
PART = (120, 80)


def systems(rows: Rows) -> dict[str, dict[str, Row]]:
    """Measured systems of each scene by their names, and scenes in the order of the table."""
    scenes: dict[str, dict[str, Row]] = {row["scene"]: {} for row in rows}
    for row in rows:
        if row["status"] == "ok":
            scenes[row["scene"]][row["system"]] = row
    return scenes


def noise(scenes: Iterable[dict[str, Row]]) -> str:
    """Sentence about the largest difference between the times of two systems that do the same
    work, as a share of the shorter one."""
    pairs = ((of[a], of[b]) for of in scenes for a, b in EQUAL_WORK if a in of and b in of)
    work = ("visited_nodes", "march_steps")
    times = (
        sorted((float(a["ms"]), float(b["ms"])))
        for a, b in pairs
        if all(a[c] == b[c] for c in work)
    )
    most = max((high / low for low, high in times if low > 0), default=None)
    return (
        ""
        if most is None
        else " Times of equal work (`rt` and `hybrid` where `skip_px` leaves the same nodes and "
        f"steps) differ by up to {100 * (most - 1):.0f} %."
    )


def rival_line(name: str, scenes: dict[str, dict[str, Row]]) -> str:
    """Line about a rival that does something better than Reflet's own systems in some scene."""
    measured = {scene: of for scene, of in scenes.items() if name in of}
    faster: list[tuple[float, str, float | None, float | None]] = []
    flips: list[tuple[float, float, str]] = []
    for scene, of in measured.items():
        rival = of[name]
        choices = [row for row in of.values() if row["side"] == "own"]
        best = min(choices, key=lambda row: float(row["ms"]), default=None)
        if best and float(rival["ms"]) < float(best["ms"]):
            share = float(rival["ms"]) / float(best["ms"])
            faster.append((share, scene, number(rival, "flip"), number(best, "flip")))
        if "hybrid" in of and rival["flip"] and of["hybrid"]["flip"]:
            flips.append((float(rival["flip"]), float(of["hybrid"]["flip"]), scene))
    parts = []
    if faster:
        least, scene, *_ = min(faster)
        share = statistics.median(of[0] for of in faster)
        part = (
            f"less time than `rt` and `hybrid` in {len(faster)} of {len(measured)}: {share:.2f} of "
            f"the faster one's in the median, {least:.2f} at best ({scene})"
        )
        both = [(its, own) for *_, its, own in faster if its is not None and own is not None]
        if both:
            its, own = (statistics.median(of) for of in zip(*both, strict=True))
            part += (
                f", with a mean FLIP of {its:.4f} in the median of these, where that one has "
                f"{own:.4f}"
            )
        parts.append(part)
    exacter = [(its, own, scene) for its, own, scene in flips if own - its >= LEAST_DIFFERENCE]
    if exacter:
        its, own, scene = max(exacter, key=lambda of: of[1] - of[0])
        parts.append(
            f"a smaller mean FLIP than `hybrid` in {len(exacter)} of {len(flips)}: {its:.4f} "
            f"against {own:.4f} at best ({scene})"
        )
    return f"- {name}: {'; '.join(parts)}.\n" if parts else ""


def rivals(rows: Rows) -> str:
    """Lines about rivals that do something better; variants of Reflet's own rays are no rivals."""
    scenes = systems(rows)
    names = dict.fromkeys(row["system"] for row in rows if row["side"] == "rival")
    lines = "".join(rival_line(name, scenes) for name in names)
    if not lines:
        return (
            "Nothing in these scenes: no rival takes less time than both `hybrid` and `rt`, or "
            "errs less.\n"
        )
    return (
        "In how many scenes each system takes less time than `rt` and `hybrid`, or errs less than "
        "`hybrid`, and where it does best. Each scene's own figures are below."
        f"{noise(scenes.values())}\n\n{lines}"
    )


def best(rows: Rows) -> str:
    columns = {"method": "{system}", "time over `rt`": "{time_over_rt:.2f}", "FLIP": "{flip:.4f}"}
    return table_of(rows, columns, tight=True)


def seams(rows: Rows) -> str:
    def line(steps: Rows) -> list[str]:
        first = filled(steps[0], '{scene}|`"{select}"`').split("|")
        return [*first, *(filled(row, "{step:+.1f}") for row in steps)]

    head = ["scene", "`select`", *(f"K = {n}" for n in dict.fromkeys(r["nearest"] for r in rows))]
    return table(head, map(line, by(rows, "scene", "select").values()), tight=True)


def chart(scene: str, ending: str = "") -> str:
    """Name of a chart of a scene."""
    return f"comparators-{pathlib.Path(scene).stem}{ending}.svg"


# Columns of a scene's table: their heads, and their cells.
COLUMNS = {
    "system": "{system}",
    "ms": "{ms:.2f}",
    "FLIP": "{flip:.4f}",
    "p99": "{flip_p99:.3f}",
    "SSIM": "{ssim:.4f}",
    "wrong instance, %": "{wrong_percent:.1f}",
    "popping, %": "{popping:.0f}",
    "tree nodes": "{visited_nodes:,.0f}",
    "march steps": "{march_steps:,.0f}",
    "MiB": "{bytes:.1f}",
    "of maps or structures": "{prepared_bytes:.1f}",
    "made in, ms": "{prepare_ms:.1f}",
    "made anew in, ms": "{update_ms:.1f}",
    "front": "{front}",
}
OF_FILMS = ["popping, %", "made anew in, ms"]


def shown(row: Row) -> Row:
    """A row as its line shows it: a dash where a system does or holds nothing."""
    shown = row | {"front": "●" if row["front"] == "1" else ""}
    for column in ("visited_nodes", "march_steps", "prepared_bytes", "prepare_ms", "update_ms"):
        shown[column] = row[column] if float(row[column]) > 0 else ""
    for column in ("bytes", "prepared_bytes"):
        shown[column] = shown[column] and str(float(shown[column]) / 2**20)
    if row["popping"]:
        shown["popping"] = str(100 * float(row["popping"]))
    return shown


def section(scene: str, rows: Rows) -> str:
    """Section of a scene: its charts and its table."""
    of = rows[0]
    is_film = int(of["frames"]) > 1
    frames = f"{of['frames']} frames" if is_film else "one picture"
    few = "fewer than 100 reflective pixels"
    scored = f"{of['scored_px']} reflective pixels"
    if of["scored_frames"] == "0":
        scored = f"without errors, as they have {few}"
    elif of["scored_frames"] == of["frames"]:
        scored += " scored"
    else:
        scored = (
            f"{of['scored_frames']} of them scored with {scored} or more, the others without "
            f"errors, as they have {few}"
        )
    out = (
        f"\n## {scene}\n\n{frames} of {of['width']} × {of['height']} pixels, {scored}, "
        f"{of['probes']} probe{'' if of['probes'] == '1' else 's'}.\n\n"
        "![Time against error of each system; a ring marks the front]"
        f"(charts/{chart(scene)})\n\n"
    )
    if is_film:
        out += (
            "![Time of the passes that find reflections over the frames, with maps and structures "
            f"made anew](charts/{chart(scene, '-ms')})\n\n"
        )
        if of["scored_frames"] != "0":
            out += f"![Mean FLIP over the frames](charts/{chart(scene, '-flip')})\n\n"
    columns = {h: form for h, form in COLUMNS.items() if is_film or h not in OF_FILMS}
    measured = (shown(row) for row in rows if row["status"] == "ok")
    out += f"{table_of(measured, columns, tight=True)}\n"
    refused = by((row for row in rows if row["status"] != "ok"), "status")
    for (why,), left_out in refused.items():
        names = "; ".join(row["system"] for row in left_out)
        out += f"\nNot measured: {names}. {why}.\n"
    return out


def tables() -> dict[str, str]:
    """Parts of the page by their places."""
    rows, best_rows, seam_rows = (
        read_rows(DATA / f"{name}.csv") for name in ("systems", "systems-best", "systems-seams")
    )
    scenes = (section(scene, of) for (scene,), of in by(rows, "scene").items())
    return {
        "rivals": rivals(rows),
        "best": best(best_rows),
        "seams": seams(seam_rows),
        "scenes": "".join(scenes).rstrip("\n"),
    }


def measure(run: Run) -> None:
    # The page says by which command it is made.
    command = re.search(r"^LP_NUM_THREADS=(\d+) reflet bench (.*) -o OUT$", PAGE.read_text(), re.M)
    if command is None:
        sys.exit(f"{PAGE} does not say how the systems are measured")
    os.environ["LP_NUM_THREADS"] = command[1]
    if run.wants("systems"):
        options = command[2].replace(" --assets DIR", "").split()
        run.bench("systems", *options, *run.models())
    if not run.wants("seams"):
        return
    rows: Rows = []
    for scene, frames in SEAMS.items():
        for select in ("pixel", "instance"):
            name = f"seams {pathlib.Path(scene).stem} {select}"
            once = ["--frames", "1", "--warm-up", "1", *frames, "--resume"]
            probe = ["--methods", "probe", *settings(f"probes.select={select}")]
            run.bench(name, scene, *probe, "--sizes", "192x108", *once)
            for (nearest,), found in by(samples(run.out, name), "value").items():
                steps = values(found, "probe_seam_step")
                step = str(statistics.fmean(steps)) if steps else ""
                rows.append({"scene": scene, "select": select, "nearest": nearest, "step": step})
    write_rows(run.out / "seams.csv", rows)


def store(outs: list[pathlib.Path]) -> None:
    out = outs[0] / "systems"
    shutil.copyfile(out / "systems.csv", DATA / "systems.csv")
    shutil.copyfile(out / "best.csv", DATA / "systems-best.csv")
    shutil.copyfile(outs[0] / "seams.csv", DATA / "systems-seams.csv")
    for path in out.glob("*.svg"):
        shutil.copyfile(path, CHARTS / f"comparators-{path.name}")


def worst(a: Image.Image, b: Image.Image) -> tuple[int, int, int, int]:
    """The part in which two pictures differ most: left, top, right and bottom."""
    levels = (np.asarray(picture.convert("RGB"), dtype=int) for picture in (a, b))
    difference = abs(np.subtract(*levels)).sum(axis=2)
    width, height = PART
    inside = sliding_window_view(difference, (height, width)).sum(axis=(2, 3))
    top, left = np.unravel_index(inside.argmax(), inside.shape)
    return int(left), int(top), int(left) + width, int(top) + height


def pictures(run: Run) -> None:
    """Render each failure beside `rt`, where they differ most."""
    with tempfile.TemporaryDirectory() as folder:
        for index, (scene, frame, system) in enumerate(FAILURES, 1):
            shown = []
            for name, reflection in (("system", system), ("rt", ["reflection.method=rt"])):
                path = pathlib.Path(folder) / f"{index}-{name}.png"
                options = settings("reflection.filter=false", *reflection)
                options += [] if frame is None else ["--frames", str(frame)]
                shown.append(
                    Image.open(render(run.program, ROOT / scene, path, (320, 180), *options))
                )
            part = [("", picture.crop(worst(*shown))) for picture in shown]
            pair = sheet(part, 2, 2 * PART[0], gap=4, scaling=Image.Resampling.NEAREST)
            pair.save(CHARTS / f"comparators-fails-{index}.png", optimize=True)


DOCUMENT = Document("comparators.md", in_places(tables), store, measure, pictures)
