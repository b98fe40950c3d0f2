"""Processor time and error of Reflet and Mitsuba on the same scenes with as many samples."""

import pathlib
import sys
import time
from collections.abc import Callable

import numpy as np
import tomllib
from measuring import used
from tables import Rows, read_rows, write_rows

from .scenes import Scene

SIZE = (384, 256)
SAMPLES = 64
TRUTH_SAMPLES = 2048
NAMES = ["metal-040", "light-rect", "metal-panels", "clearcoat", "glass-rough"]
COLUMNS = ["scene", "samples", "reflet_s", "reflet_rel_mse", "mitsuba_s", "mitsuba_rel_mse"]
HEAD = ["scene", "Reflet", "relMSE", "Mitsuba", "relMSE", "time to equal error"]

Picture = np.ndarray


def reflet(path: pathlib.Path, samples: int, program: pathlib.Path) -> float:
    """Render a scene beside its file; returns seconds of processor time."""
    command: list[str | pathlib.Path] = [program, "render", path, "-o", path.with_suffix(".exr")]
    ran = used([*command, "--size", f"{SIZE[0]}x{SIZE[1]}", "--samples", str(samples)])
    if ran.code != 0:
        sys.exit(ran.said)
    return ran.processor_s


def mitsuba(scene: Scene, out: pathlib.Path) -> tuple[float, Picture, Picture]:
    """Processor seconds once all is compiled, the picture, and a converged picture."""
    import mitsuba as mi

    from . import export  # this import needs a variant of Mitsuba, which the caller sets

    made = mi.load_dict(export.scene(tomllib.loads(scene.text), out, SIZE, scene.depth))
    mi.render(made, spp=SAMPLES, seed=1).numpy()
    started = time.process_time()
    found = mi.render(made, spp=SAMPLES, seed=2).numpy()
    seconds = time.process_time() - started
    parts = TRUTH_SAMPLES // 256
    truth = sum(mi.render(made, spp=256, seed=3 + k).numpy().astype(float) for k in range(parts))
    return seconds, found, truth / parts


def measure(
    out: pathlib.Path,
    program: pathlib.Path,
    scenes: list[Scene],
    load: Callable[[pathlib.Path], Picture],
    rel_mse: Callable[[Picture, Picture], float],
) -> None:
    rows = read_rows(out / "speed.csv")
    known = {row["scene"] for row in rows}
    for scene in scenes:
        if scene.name not in NAMES or scene.name in known:
            continue
        theirs_s, theirs, truth = mitsuba(scene, out)
        path = out / f"speed-{scene.name}.toml"
        path.write_text(scene.text)
        reflet(path, SAMPLES, program)  # a first run, so that the driver caches compiled shaders
        first_s = reflet(path, 1, program)
        ours_s = (reflet(path, SAMPLES, program) - first_s) * SAMPLES / (SAMPLES - 1)
        ours = load(path.with_suffix(".exr"))
        numbers = [ours_s, rel_mse(ours, truth), theirs_s, rel_mse(theirs, truth)]
        cells = [scene.name, str(SAMPLES), *(f"{n:.4g}" for n in numbers)]
        rows.append(dict(zip(COLUMNS, cells, strict=True)))
        print(" ".join(cells), flush=True)
        write_rows(out / "speed.csv", rows)


def lines(rows: Rows) -> list[list[str]]:
    """Rows of the page's table, with the ratio of Reflet's time to Mitsuba's at the same error."""
    made = []
    for row in rows:
        ours_s, ours, theirs_s, theirs = (float(row[name]) for name in COLUMNS[2:])
        ratio = ours_s * ours / (theirs_s * theirs)
        times = [f"{ours_s:.1f} s", f"{ours:.1e}", f"{theirs_s:.1f} s", f"{theirs:.1e}"]
        made.append([f"`{row['scene']}`", *times, f"{ratio:.1f}"])
    return made
