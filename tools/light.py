#!/usr/bin/env python3
"""Compares light and materials with Mitsuba 3 and with closed forms, and writes docs/light.md.

    tools/light.py measure OUT [--reflet PROGRAM] [--only NAME]    # scenes that OUT lacks
    tools/light.py page OUT                       # the page's tables and pictures, and docs/data

Mitsuba is no part of the project's environment: `python3 -m venv DIR && DIR/bin/pip install
mitsuba numpy pillow`, then run this file by DIR/bin/python. It needs LLVM 17 or newer as a shared
library (`DRJIT_LIBLLVM_PATH` says where, if it is not found). Pictures are 96 x 64, in linear
light. The text around the tables is written by hand: check it against new numbers.
"""

import argparse
import pathlib
import re
import subprocess
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
from measuring import add_program, program_of, read_rows, table, write_rows, write_tables
from reflet_light import speed
from reflet_light.scenes import ROUGHNESSES, Scene, all_scenes, panorama

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "light.md"
DATA = ROOT / "docs" / "data" / "light.csv"
SPEED_DATA = ROOT / "docs" / "data" / "light-speed.csv"
IMAGES = ROOT / "docs" / "images"
SIZE = (96, 64)
THEIR_SAMPLES = 4096
TRIMMED = 0.01  # share of the pixels that are left out, those that differ most: tessellated edges
# Scenes whose convergence is measured, and the numbers of sub-frames.
CONVERGING = ["metal-040", "light-rect", "glass-rough"]
COUNTS = [1, 4, 16, 64, 256]

Row = dict[str, str]
Picture = np.ndarray


def rel_mse(a: Picture, b: Picture) -> float:
    """Mean of (a − b)² / (b² + 0.01) over channels and all but the worst pixels."""
    error = ((a - b) ** 2 / (b**2 + 0.01)).mean(axis=2).ravel()
    return float(np.sort(error)[: round(len(error) * (1 - TRIMMED))].mean())


def write_scene(out: pathlib.Path, scene: Scene) -> pathlib.Path:
    path = out / f"{scene.name}.toml"
    path.write_text(scene.text)
    return path


def ours(out: pathlib.Path, scene: Scene, samples: int, program: pathlib.Path) -> Picture:
    picture = out / f"{scene.name}.{samples}.exr"
    if not picture.exists():
        text = write_scene(out, scene)
        size = f"{SIZE[0]}x{SIZE[1]}"
        command: list[str | pathlib.Path] = [program, "render", text, "--size", size]
        command += ["--samples", str(samples)]
        subprocess.run([*command, "-o", picture], check=True, stderr=subprocess.DEVNULL)
    return load(picture)


def load(path: pathlib.Path) -> Picture:
    import mitsuba as mi

    bitmap = mi.Bitmap(str(path))
    return np.array(bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32))


def theirs(out: pathlib.Path, scene: Scene) -> tuple[Picture, Picture]:
    """Two pictures by Mitsuba that differ by their noise alone; their mean is the reference."""
    import mitsuba as mi
    import tomllib
    from reflet_light import export

    found = out / f"{scene.name}.npy"
    if not found.exists():
        moments = scene.moments or (scene.text,)
        pair = np.zeros((2, SIZE[1], SIZE[0], 3))
        for index, text in enumerate(moments):
            made = mi.load_dict(export.scene(tomllib.loads(text), out, SIZE, scene.depth))
            for half in range(2):
                samples = THEIR_SAMPLES // 2 // len(moments)
                pair[half] += mi.render(made, spp=samples, seed=2 * index + half + 1).numpy()
        np.save(found, pair / len(moments))
    pair = np.load(found)
    return pair[0], pair[1]


def measure(out: pathlib.Path, program: pathlib.Path, only: str | None) -> None:
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    from reflet_light import bsdf

    bsdf.register()
    out.mkdir(parents=True, exist_ok=True)
    mi.Bitmap(panorama()).write(str(out / "sky.exr"))
    rows = {(row["scene"], row["samples"]): row for row in read_rows(out / "light.csv")}
    for scene in all_scenes():
        if only and not re.fullmatch(only, scene.name):
            continue
        counts = [*(COUNTS if scene.name in CONVERGING else []), scene.samples]
        for samples in counts:
            if (scene.name, str(samples)) in rows:
                continue
            row = compare(out, scene, samples, program)
            rows[scene.name, str(samples)] = row
            print(" ".join(row.values()), flush=True)
            write_rows(out / "light.csv", list(rows.values()))
    if not only or only == "speed":
        speed.measure(out, program, all_scenes(), load, rel_mse)


def compare(out: pathlib.Path, scene: Scene, samples: int, program: pathlib.Path) -> Row:
    a, b = theirs(out, scene)
    truth = (a + b) / 2
    found = ours(out, scene, samples, program)
    numbers = {
        "rel_mse": rel_mse(found, truth),
        "noise": rel_mse(a, b) / 4,  # variance of the mean of both
        "brightness": float(found.mean() / truth.mean()),
    }
    head = {"scene": scene.name, "samples": str(samples)}
    return head | {name: f"{value:.6g}" for name, value in numbers.items()}


def scenes_table(rows: list[Row]) -> str:
    found = {(row["scene"], row["samples"]): row for row in rows}
    lines = []
    for scene in all_scenes():
        row = found.get((scene.name, str(scene.samples)))
        if row:
            numbers = [f"{float(row['rel_mse']):.1e}", f"{float(row['noise']):.0e}"]
            bright = f"{100 * (float(row['brightness']) - 1):+.2f} %"
            lines.append([f"`{scene.name}`", scene.shows, row["samples"], *numbers, bright])
    head = ["scene", "shows", "sub-frames", "relMSE", "of Mitsuba's noise", "mean brightness"]
    return table(head, lines)


def slope(points: Sequence[tuple[float, float]]) -> float:
    """Slope of the least-squares line through the logarithms of points."""
    x, y = (np.log([p[i] for p in points]) for i in (0, 1))
    return float(np.polyfit(x, y, 1)[0])


def convergence_table(rows: list[Row]) -> str:
    lines = []
    for name in CONVERGING:
        of = {int(r["samples"]): float(r["rel_mse"]) for r in rows if r["scene"] == name}
        points = [(n, of[n]) for n in COUNTS if n in of]
        if len(points) == len(COUNTS):
            cells = [f"{error:.1e}" for _, error in points]
            lines.append([f"`{name}`", *cells, f"{slope(points):.2f}"])
    return table(["scene", *map(str, COUNTS), "exponent"], lines)


def display(linear: Picture) -> Picture:
    c = np.clip(linear, 0, 1)
    srgb = np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)
    return (255 * srgb + 0.5).astype(np.uint8)


def sheet(out: pathlib.Path, names: Sequence[str], path: pathlib.Path) -> None:
    """Sheet of Reflet's pictures above Mitsuba's, one column for each scene."""
    from PIL import Image

    scenes = {scene.name: scene for scene in all_scenes()}
    columns = []
    for name in names:
        mine = load(out / f"{name}.{scenes[name].samples}.exr")
        columns.append(np.concatenate([mine, np.load(out / f"{name}.npy").mean(axis=0)]))
    picture = Image.fromarray(display(np.concatenate(columns, axis=1)))
    picture.resize((picture.width * 2, picture.height * 2), Image.Resampling.NEAREST).save(path)


def page(out: pathlib.Path) -> None:
    rows = read_rows(out / "light.csv")
    if not rows:
        sys.exit(f"{out} holds no measurements; run `measure` first")
    tables = {
        "scenes": scenes_table(rows),
        "convergence": convergence_table(rows),
        "speed": table(speed.HEAD, speed.lines(out)),
    }
    write_tables(PAGE, tables)
    write_rows(DATA, rows)
    write_rows(SPEED_DATA, read_rows(out / "speed.csv"))
    pictures(out)


def pictures(out: pathlib.Path) -> None:
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    for kind in ("metal", "dielectric"):
        names = [f"{kind}-{round(100 * r):03}" for r in ROUGHNESSES]
        sheet(out, names, IMAGES / f"light-{kind}.png")
    glass = ["glass", "glass-rough", "glass-thin", "clearcoat", "clearcoat-rough", "metal-panels"]
    cloth = ["sheen", "sheen-sharp", "specular-color", "specular-half"]
    sheet(out, glass, IMAGES / "light-glass.png")
    sheet(out, cloth, IMAGES / "light-cloth.png")
    sheet(out, ["depth-of-field", "motion-blur"], IMAGES / "light-lens.png")
    lights = [f"light-{n}" for n in ("point", "sphere", "spot", "sun", "rect", "disk")]
    sheet(out, lights, IMAGES / "light-kinds.png")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    commands = parser.add_subparsers(required=True, dest="command")
    measuring = commands.add_parser("measure", help="measure what OUT lacks")
    add_program(measuring)
    measuring.add_argument("--only", metavar="NAME", help="a scene, or a pattern of names")
    writing = commands.add_parser("page", help="write the tables of docs/light.md")
    for command in (measuring, writing):
        command.add_argument("out", type=pathlib.Path, metavar="OUT")
    arguments: Any = parser.parse_args()
    if arguments.command == "measure":
        measure(arguments.out.resolve(), program_of(arguments.reflet), arguments.only)
    else:
        page(arguments.out.resolve())


if __name__ == "__main__":
    main()
