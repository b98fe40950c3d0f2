#!/usr/bin/env python3
"""Renders eleven scenes of Blender by Cycles and, exported, by Reflet, and compares the pictures.

    .venv/bin/python tools/blender_compare.py OUT [NAME ...] [--page]

With --page it writes the table and the sheet of docs/blender.md. Cycles and the export run in
.venv-bpy, which tools/setup.sh makes. Both renderers trace paths of the same length; FLIP is
measured by `reflet compare`, of linear radiance shown as sRGB.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from measuring import add_program, program_of
from reflet_usd.exr_pixels import read_exr
from sheet import sheet, shown
from tables import table, write_tables

ROOT = Path(__file__).resolve().parents[1]
SCENES = ROOT / "tools" / "blender" / "scenes.py"
PAGE = ROOT / "docs" / "blender.md"
SHEET = ROOT / "docs" / "images" / "blender.png"
# Frames that are compared, of scenes with any: the current frames that scenes.py leaves.
FRAMES = {"animated": 12}


def radiance(path: Path) -> np.ndarray:
    """Linear RGB of an EXR file."""
    return read_exr(path.read_bytes())[..., :3]


def compare(reflet: Path, place: Path, samples: int) -> dict[str, float]:
    """Render one exported scene, and compare it with Cycles's picture."""
    ours, cycles = place / "reflet.exr", place / "cycles.exr"
    command: list[str | Path] = [reflet, "render", place / "project" / "scene.toml", "-o", ours]
    command += ["--samples", str(samples), "--set", "image.radiance=full"]
    if place.name in FRAMES:
        command += ["--frames", str(FRAMES[place.name])]
    subprocess.run(command, check=True)
    judged = subprocess.run(
        [reflet, "compare", ours, cycles, "--json", "--flip-map", place / "flip.png"],
        check=True,
        capture_output=True,
        text=True,
    )
    said = json.loads(judged.stdout)
    a, b = radiance(ours), radiance(cycles)
    for path, linear in ((ours, a), (cycles, b)):
        shown(linear).save(path.with_suffix(".png"))
    return {"flip": said["frame"]["flip_mean"], "brightness": float(a.mean() / b.mean())}


def main() -> None:
    """Render, compare and, with --page, write the page's table and sheet."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--size", default="192x108")
    parser.add_argument("--samples", type=int, default=512, help="of both, for each pixel")
    parser.add_argument("--keep", action="store_true", help="take what OUT has of Blender")
    parser.add_argument("--page", action="store_true", help="write docs/blender.md's table")
    parser.add_argument("--bpy", type=Path, default=ROOT / ".venv-bpy" / "bin" / "python")
    add_program(parser)
    args = parser.parse_args()
    reflet = program_of(args.reflet)
    if not args.bpy.exists():
        sys.exit(f"{args.bpy} is not there; run tools/setup.sh, or name a Python that has bpy")
    made = [args.bpy, SCENES, args.out, *args.names, "--size", args.size]
    if not args.keep:
        subprocess.run([*made, "--samples", str(args.samples)], check=True)
    names = args.names or [path.name for path in args.out.iterdir() if path.is_dir()]
    rows, cells = [], []
    for name in sorted(names):
        place = args.out / name
        row = compare(reflet, place, args.samples)
        rows.append([name, f"{row['flip']:.3f}", f"{(row['brightness'] - 1) * 100:+.1f} %"])
        print(*rows[-1], flush=True)
        cells += [(f"{name}: Reflet", place / "reflet.png"), ("Cycles", place / "cycles.png")]
        cells.append((f"FLIP {row['flip']:.3f}", place / "flip.png"))
    width = int(args.size.split("x")[0])
    made_sheet = sheet(cells, 6, width)
    made_sheet.save(args.out / "sheet.png")
    if args.page:
        made_sheet.save(SHEET, optimize=True)
        write_tables(PAGE, {"cycles": table(["scene", "FLIP", "brightness"], rows)})


if __name__ == "__main__":
    main()
