#!/usr/bin/env python3
"""Measures flicker and time of films, frame after frame, and writes docs/films.md.

    tools/films.py measure --assets DIR OUT [--reflet PROGRAM]    # films that OUT lacks
    tools/films.py samples OUT [--reflet PROGRAM]                 # errors of a fence over samples
    tools/films.py page OUT                                       # tables, chart and docs/data

Each film is rendered at 320 x 180 by ssr, hybrid and rt, without light reuse, so that methods
differ in their reflections alone; its reference is rt with bounces = "auto".
"""

import argparse
import csv
import math
import pathlib
import re
import statistics
import subprocess
import sys

import numpy as np
from measuring import add_program, program_of, table, write_rows, write_tables
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "films.md"
DATA = ROOT / "docs" / "data" / "films.csv"
SAMPLES_DATA = ROOT / "docs" / "data" / "fence.csv"
CHART = ROOT / "docs" / "charts" / "paper-walk-flicker.svg"
METHODS = ["ssr", "hybrid", "rt"]
PAPER_WALK = "paper's walk"
NO_REUSE = ["--parameter", "reuse_light", "--values", "0"]
# Films by name, with the measured frames: three stretches of the paper's walk, all of the others.
FILMS: dict[str, list[str]] = {
    PAPER_WALK: ["paper", "scenario2", "--timeline", "0-23,463-486,700-723"],
    **{
        name: [f"scripts/{name}.toml", "--timeline", "all", *NO_REUSE]
        for name in ["walk", "gears", "bounce", "polish", "lamp", "path"]
    },
}  # fmt: skip
FENCE = ROOT / "scenes" / "fail" / "18-fence.toml"
FENCE_SIZE = (128, 72)
SAMPLES = [1, 2, 4, 8, 16, 32, 64, 128, 256]
# Truth pixels across one pixel of a picture, so 1024 truth samples for each of its pixels.
TRUTH_PX = 32
COLUMNS = [
    *["film", "frame", "since_frame", "method", "mask_px", "mask_flip", "mask_flip_p99"],
    *["mask_temporal_difference", "mask_temporal_change", "reflection_cpu_ms", "passes_cpu_ms"],
]

Row = dict[str, str]
Rows = list[Row]


def folder_of(film: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", film.lower()).strip("-")


def measure(out: pathlib.Path, assets: pathlib.Path, program: pathlib.Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    for film, arguments in FILMS.items():
        print(f"== {film}", flush=True)
        command: list[str | pathlib.Path] = [program, "bench", *arguments, "--assets", assets]
        command += ["--sizes", "320x180", "--frames", "1", "--warm-up", "1"]
        if film != PAPER_WALK:
            command += ["--methods", ",".join(METHODS)]
        subprocess.run([*command, "--resume", "-o", out / folder_of(film)], cwd=ROOT, check=True)


def linear(path: pathlib.Path) -> np.ndarray:
    """A picture without tone map as light, by the transfer function of sRGB (IEC 61966-2-1)."""
    code = np.asarray(Image.open(path).convert("RGB"), dtype=np.float64) / 255
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


def samples(out: pathlib.Path, program: pathlib.Path) -> None:
    """Measure the fence's reflection over sample counts, against a larger picture of rt."""
    out.mkdir(parents=True, exist_ok=True)

    def render(name: str, size: tuple[int, int], method: str, count: int) -> pathlib.Path:
        path = out / f"{name}.png"
        command: list[str | pathlib.Path] = [program, "render", FENCE, "-o", path, "--frames", "0"]
        command += ["--size", f"{size[0]}x{size[1]}", "--method", method, "--samples", str(count)]
        command += ["--set", "image.tone_map=none"]
        command += ["--aov", "reflectance"] if size == FENCE_SIZE else []
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        return path

    width, height = FENCE_SIZE
    large = render("truth", (width * TRUTH_PX, height * TRUTH_PX), "rt", 1)
    truth = linear(large).reshape(height, TRUTH_PX, width, TRUTH_PX, 3).mean(axis=(1, 3))
    rows = []
    for method in ("hybrid", "rt"):
        for count in SAMPLES:
            path = render(f"{method}-{count}", FENCE_SIZE, method, count)
            mask = np.asarray(Image.open(path.with_suffix(".reflectance.png")).convert("L")) > 0
            error = (linear(path) - truth)[mask]
            rms = f"{math.sqrt(float((error**2).mean())):.5f}"
            rows.append({"method": method, "samples": str(count), "rms": rms})
            print(*rows[-1].values(), flush=True)
    write_rows(SAMPLES_DATA, rows)


def samples_table() -> str:
    with SAMPLES_DATA.open(newline="") as file:
        rows = list(csv.DictReader(file))
    head = ["method", *map(str, SAMPLES), "exponent of the variance"]
    lines = [head, ["---"] * len(head)]
    for method in ("hybrid", "rt"):
        rms = [float(r["rms"]) for r in rows if r["method"] == method]
        variance = [2 * math.log(value) for value in rms]
        slope = statistics.linear_regression([math.log(n) for n in SAMPLES], variance).slope
        lines.append([f"`{method}`", *(f"{value:.4f}" for value in rms), f"{slope:.2f}"])
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def read(out: pathlib.Path) -> Rows:
    rows: Rows = []
    for film in FILMS:
        path = out / folder_of(film) / "samples.csv"
        if not path.exists():
            sys.exit(f"{path} is missing; run `measure` first")
        with path.open(newline="") as file:
            rows += [row | {"film": film} for row in csv.DictReader(file)]
    return [{column: row[column] for column in COLUMNS} for row in rows]


def consecutive(rows: Rows) -> Rows:
    """Rows with a change since the frame before, inside the reflections of both frames."""
    return [
        r
        for r in rows
        if r["since_frame"] == str(int(r["frame"]) - 1) and r["mask_temporal_change"]
    ]


def change_off_reference(rows: Rows) -> float:
    """Flicker: share of the reference's change that a method's change differs from it by, %."""
    difference, change = (
        sum(float(r[f"mask_temporal_{of}"]) for r in rows) for of in ("difference", "change")
    )
    return 100 * difference / change


def line(film: str, method: str, rows: Rows) -> list[str]:
    pairs = consecutive(rows)
    scored = [r for r in rows if r["mask_flip"]]
    worst = max(pairs, key=lambda r: float(r["mask_temporal_difference"]))
    levels = float(worst["mask_temporal_difference"])
    return [
        film if method == METHODS[0] else "",
        f"`{method}`",
        str(len(pairs)),
        f"{change_off_reference(pairs):.1f}",
        f"{levels:.2f} at {worst['frame']}" if levels > 0 else "0",
        f"{statistics.mean(float(r['mask_flip']) for r in scored):.4f}",
        f"{max(float(r['mask_flip_p99']) for r in scored):.3f}",
        f"{statistics.median(float(r['reflection_cpu_ms']) for r in rows):.1f}",
        f"{statistics.median(float(r['passes_cpu_ms']) for r in rows):.0f}",
    ]


def films_table(rows: Rows) -> str:
    head = ["film", "method", "pairs", "flicker, %", "worst, of 255", "FLIP", "worst p99"]
    head += ["reflections, ms", "frame, ms"]
    lines = []
    for film in FILMS:
        for method in METHODS:
            own = [r for r in rows if r["film"] == film and r["method"] == method]
            lines.append(line(film, method, own))
    return table(head, lines)


def page(out: pathlib.Path) -> None:
    rows = read(out)
    write_tables(PAGE, {"films": films_table(rows), "samples": samples_table()})
    CHART.write_bytes((out / folder_of(PAPER_WALK) / "line-chart-1-flicker.svg").read_bytes())
    write_rows(DATA, rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    commands = parser.add_subparsers(required=True, dest="command")
    measuring = commands.add_parser("measure", help="measure what OUT lacks")
    measuring.add_argument("--assets", type=pathlib.Path, required=True)
    sampling = commands.add_parser("samples", help="measure what samples do for a fence")
    for command in (measuring, sampling):
        add_program(command)
    writing = commands.add_parser("page", help="write docs/films.md")
    for command in (measuring, sampling, writing):
        command.add_argument("out", type=pathlib.Path, metavar="OUT")
    arguments = parser.parse_args()
    if arguments.command == "measure":
        measure(arguments.out.resolve(), arguments.assets.resolve(), program_of(arguments.reflet))
    elif arguments.command == "samples":
        samples(arguments.out.resolve(), program_of(arguments.reflet))
    else:
        page(arguments.out)


if __name__ == "__main__":
    main()
