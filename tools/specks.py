#!/usr/bin/env python3
"""Counts black and white specks in pictures of few samples, and puts the pictures on sheets.

    tools/specks.py OUT SCENES... [--reflet PROGRAM] [--samples 1 8] [--reference 64]

A scene is a scene text or a glTF file, or a folder: its scene texts and glTF files. OUT gets the
pictures of each scene, sheets of them side by side, and table.md, which lists the scenes with
specks, the worst first.
"""

import argparse
import dataclasses
import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
from measuring import add_program, program_of, settings
from PIL import Image
from scipy.ndimage import maximum_filter, median_filter, minimum_filter
from sheet import sheet
from tables import table

ENDINGS = {".toml", ".glb", ".gltf"}
SCENES_PER_SHEET = 14
AROUND: dict[str, Any] = {"size": (5, 5, 1), "mode": "nearest"}
SPECK = 0.3 * 255  # as in src/metric/specks.rs


@dataclasses.dataclass
class Found:
    """Pixels of one picture of few samples that are wrong, where the reference is smooth."""

    white: int
    black: int


def scenes_of(paths: list[Path]) -> list[Path]:
    """Scene texts and glTF files, also from folders."""
    scenes: list[Path] = []
    for path in paths:
        inside = sorted(path.rglob("*")) if path.is_dir() else [path]
        scenes += [file for file in inside if file.suffix in ENDINGS]
    return scenes


def specks(picture: np.ndarray, reference: np.ndarray) -> Found:
    """Specks of `reflet compare` inside of surfaces; at edges one sample cannot show the mean.

    A channel differs by more than SPECK from its median over 5 x 5 pixels, which differ by less in
    the reference.
    """
    shown, truth = picture.astype(int), reference.astype(int)
    smooth = (maximum_filter(truth, **AROUND) - minimum_filter(truth, **AROUND)).max(2) <= SPECK
    off = shown - median_filter(shown, **AROUND)
    white = smooth & (off.max(axis=2) > SPECK)
    return Found(int(white.sum()), int((smooth & ~white & (off.min(axis=2) < -SPECK)).sum()))


def levels(path: Path) -> np.ndarray:
    return np.asarray(Image.open(path).convert("RGB"))


class Pictures:
    """Pictures of scenes in a folder; missing pictures are rendered."""

    def __init__(self, out: Path, program: Path, size: str, further: list[str]) -> None:
        self.out = out
        self.program = program
        self.size = size
        self.further = further

    def picture(self, scene: Path, samples: int) -> Path | None:
        """The picture of a scene with so many samples; none where it cannot be rendered."""
        name = re.sub(r"[^A-Za-z0-9]+", "_", scene.stem)
        path = self.out / "cells" / f"{name}.{samples}.png"
        if not path.exists():
            options = ["--size", self.size, "--samples", str(samples), *self.further]
            command: list[str | Path] = [self.program, "render", scene, "-o", path, *options]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                print(f"{scene}: {done.stderr.strip().splitlines()[0]}", flush=True)
                return None
        return path


def found_table(counts: dict[str, list[Found]], samples: list[int]) -> str:
    """Markdown table of the scenes with specks, the worst first."""
    head = ["scene"]
    for count in samples:
        head += [f"white, {count} samples", f"black, {count} samples"]
    wrong = {name: all_of for name, all_of in counts.items() if any(sum_of(f) for f in all_of)}
    worst = sorted(wrong.items(), key=lambda item: (-sum(map(sum_of, item[1])), item[0]))
    lines = []
    for name, all_of in worst:
        lines.append([name, *(str(n) for f in all_of for n in (f.white, f.black))])
    clean = f"{len(counts) - len(wrong)} of {len(counts)} scenes have none."
    return f"{clean}\n\n{table(head, lines)}" if lines else clean


def sum_of(found: Found) -> int:
    return found.white + found.black


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("out", type=Path, help="folder for pictures, sheets and table.md")
    parser.add_argument("scenes", type=Path, nargs="+", help="scene texts, glTF files, folders")
    add_program(parser)
    parser.add_argument("--samples", type=int, nargs="+", default=[1, 8])
    parser.add_argument("--reference", type=int, default=64, help="samples of the reference")
    parser.add_argument("--size", default="160x120")
    parser.add_argument("--set", action="append", default=[], help="as for reflet render")
    arguments = parser.parse_args()
    (arguments.out / "cells").mkdir(parents=True, exist_ok=True)
    further = settings(*arguments.set)
    pictures = Pictures(arguments.out, program_of(arguments.reflet), arguments.size, further)

    counts: dict[str, list[Found]] = {}
    cells: list[tuple[str, Path]] = []
    for scene in scenes_of(arguments.scenes):
        *few, reference = (
            pictures.picture(scene, n) for n in [*arguments.samples, arguments.reference]
        )
        shown = [path for path in few if path is not None]
        if reference is None or len(shown) < len(few):
            continue
        found = [specks(levels(path), levels(reference)) for path in shown]
        counts[scene.stem] = found
        print(scene.stem, *(f"{f.white}/{f.black}" for f in found), flush=True)
        cells += [
            (f"{scene.stem} {f.white}/{f.black}", p) for f, p in zip(found, shown, strict=True)
        ]
        cells.append(("", reference))
    text = found_table(counts, arguments.samples)
    (arguments.out / "table.md").write_text(text + "\n", encoding="utf-8")
    columns = len(arguments.samples) + 1
    width = int(arguments.size.split("x")[0])
    step = SCENES_PER_SHEET * columns
    for number, first in enumerate(range(0, len(cells), step), 1):
        part = sheet(cells[first : first + step], 2 * columns, width)
        part.save(arguments.out / f"sheet-{number:02}.png")
    print(text)


if __name__ == "__main__":
    main()
