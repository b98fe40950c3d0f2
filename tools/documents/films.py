"""Flicker and time of films, frame after frame (docs/films.md).

Each film is rendered at 320 x 180 by ssr, hybrid and rt, without light reuse, so that methods
differ in their reflections alone; its reference is rt with bounces = "auto". Beside them, errors of
a fence over numbers of samples, against a larger picture.
"""

import math
import pathlib
import shutil
import statistics

import numpy as np
from measuring import ROOT, render, settings
from PIL import Image
from tables import Rows, by, mean, median, read_rows, table, values, write_rows

from documents import denoised
from documents.document import (
    CHARTS,
    DATA,
    METHODS,
    Document,
    Run,
    folder_of,
    in_places,
    samples,
    some_columns,
)
from documents.paper import WALK

PAPER_WALK = "paper's walk"
# Films by name, with the measured frames: three stretches of the paper's walk, all of the others.
FILMS: dict[str, list[str]] = {
    PAPER_WALK: [*WALK, "--timeline", "0-23,463-486,700-723"],
    **{
        name: [
            *[f"scripts/{name}.toml", "--timeline", "all", "--methods", ",".join(METHODS)],
            *["--parameter", "reuse_light", "--values", "0"],
        ]
        for name in ["walk", "gears", "bounce", "polish", "lamp", "path"]
    },
}
FENCE = ROOT / "scenes" / "fail" / "18-fence.toml"
FENCE_SIZE = (128, 72)
SAMPLES = [1, 2, 4, 8, 16, 32, 64, 128, 256]
# Truth pixels across one pixel of a picture, so 1024 truth samples for each of its pixels.
TRUTH_PX = 32
COLUMNS = [
    *["film", "frame", "since_frame", "method", "mask_px", "mask_flip", "mask_flip_p99"],
    *["mask_temporal_difference", "mask_temporal_change", "reflection_cpu_ms", "passes_cpu_ms"],
]


def measure(run: Run) -> None:
    for film, arguments in FILMS.items():
        if run.wants(film):
            once = ["--sizes", "320x180", "--frames", "1", "--warm-up", "1", "--resume"]
            run.bench(film, *arguments, *run.models(), *once)
    if run.wants("fence"):
        fence(run.out / "fence", run.program)
    if run.wants("denoised"):
        denoised.measure(run)


def linear(path: pathlib.Path) -> np.ndarray:
    """A picture without tone map as light, by the transfer function of sRGB (IEC 61966-2-1)."""
    code = np.asarray(Image.open(path).convert("RGB"), dtype=np.float64) / 255
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


def fence(out: pathlib.Path, program: pathlib.Path) -> None:
    """Measure the fence's reflection over sample counts, against a larger picture of rt."""
    out.mkdir(exist_ok=True)

    def picture(name: str, size: tuple[int, int], method: str, count: int) -> pathlib.Path:
        options = ["--frames", "0", "--method", method, "--samples", str(count)]
        options += settings("image.tone_map=none")
        options += ["--aov", "reflectance"] if size == FENCE_SIZE else []
        return render(program, FENCE, out / f"{name}.png", size, *options)

    width, height = FENCE_SIZE
    large = picture("truth", (width * TRUTH_PX, height * TRUTH_PX), "rt", 1)
    truth = linear(large).reshape(height, TRUTH_PX, width, TRUTH_PX, 3).mean(axis=(1, 3))
    rows = []
    for method in ("hybrid", "rt"):
        for count in SAMPLES:
            path = picture(f"{method}-{count}", FENCE_SIZE, method, count)
            mask = np.asarray(Image.open(path.with_suffix(".reflectance.png")).convert("L")) > 0
            error = (linear(path) - truth)[mask]
            rms = f"{math.sqrt(float((error**2).mean())):.5f}"
            rows.append({"method": method, "samples": str(count), "rms": rms})
            print(*rows[-1].values(), flush=True)
    write_rows(out / "fence.csv", rows)


def samples_table(rows: Rows) -> str:
    def line(method: str, of: Rows) -> list[str]:
        rms = values(of, "rms")
        variance = [2 * math.log(value) for value in rms]
        slope = statistics.linear_regression([math.log(n) for n in SAMPLES], variance).slope
        return [f"`{method}`", *(f"{value:.4f}" for value in rms), f"{slope:.2f}"]

    head = ["method", *map(str, SAMPLES), "exponent of the variance"]
    return table(head, (line(method, of) for (method,), of in by(rows, "method").items()))


def line(film: str, method: str, rows: Rows) -> list[str]:
    # Rows with a change since the frame before, inside the reflections of both frames.
    pairs = [
        r
        for r in rows
        if r["since_frame"] == str(int(r["frame"]) - 1) and r["mask_temporal_change"]
    ]
    difference, change = (
        sum(values(pairs, f"mask_temporal_{of}")) for of in ("difference", "change")
    )
    worst = max(pairs, key=lambda r: float(r["mask_temporal_difference"]))
    levels = float(worst["mask_temporal_difference"])
    return [
        film if method == METHODS[0] else "",
        f"`{method}`",
        str(len(pairs)),
        f"{100 * difference / change:.1f}",
        f"{levels:.2f} at {worst['frame']}" if levels > 0 else "0",
        f"{mean(rows, 'mask_flip'):.4f}",
        f"{max(values(rows, 'mask_flip_p99')):.3f}",
        f"{median(rows, 'reflection_cpu_ms'):.1f}",
        f"{median(rows, 'passes_cpu_ms'):.0f}",
    ]


def films_table(rows: Rows) -> str:
    head = ["film", "method", "pairs", "flicker, %", "worst, of 255", "FLIP", "worst p99"]
    head += ["reflections, ms", "frame, ms"]
    of = by(rows, "film", "method")
    return table(head, (line(film, m, of[film, m]) for film in FILMS for m in METHODS))


def tables() -> dict[str, str]:
    films, fences = (read_rows(DATA / f"{name}.csv") for name in ("films", "fence"))
    return {"films": films_table(films), "samples": samples_table(fences)}


def store(outs: list[pathlib.Path]) -> None:
    for out in outs:
        rows = [row | {"film": film} for film in FILMS for row in samples(out, film)]
        write_rows(DATA / "films.csv", some_columns(rows, COLUMNS))
        flicker = out / folder_of(PAPER_WALK) / "line-chart-1-flicker.svg"
        shutil.copyfile(flicker, CHARTS / "paper-walk-flicker.svg")
        if (out / "fence" / "fence.csv").exists():
            shutil.copyfile(out / "fence" / "fence.csv", DATA / "fence.csv")


DOCUMENT = Document("films.md", in_places(tables), store, measure)
