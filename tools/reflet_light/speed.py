"""Processor time and error of Reflet and Mitsuba on the same scenes with as many samples."""

import json
import pathlib
import subprocess
import sys
import time
from collections.abc import Callable

import numpy as np
import tomllib
from measuring import used
from tables import Rows, by, read_rows, write_rows

from .scenes import Scene

SIZE = (384, 256)
SAMPLES = 64
TRUTH_SAMPLES = 2048
NAMES = ["metal-040", "metal-panels", "metal-rect", "clearcoat", "glass-rough"]
NAMES += ["light-rect", "room-4", "room-path"]
SAMPLERS = ["independent", "multijitter"]
THEIRS = [f"{sampler}_{number}" for sampler in SAMPLERS for number in ("s", "rel_mse")]
COLUMNS = ["scene", "driver", "samples", "reflet_s", "reflet_rel_mse", *THEIRS]

Picture = np.ndarray


def reflet(path: pathlib.Path, samples: int, program: pathlib.Path) -> float:
    """Render a scene beside its file; returns seconds of processor time."""
    command: list[str | pathlib.Path] = [program, "render", path, "-o", path.with_suffix(".exr")]
    ran = used([*command, "--size", f"{SIZE[0]}x{SIZE[1]}", "--samples", str(samples)])
    if ran.code != 0:
        sys.exit(ran.said)
    return ran.processor_s


def adapter(path: pathlib.Path, program: pathlib.Path) -> str:
    """Name of the adapter that renders a scene, with its driver."""
    command: list[str | pathlib.Path] = [program, "render", path, "--size", "8x8", "-o"]
    command += [path.with_suffix(".png"), "--stats", "json"]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    return str(json.loads(run.stdout)["adapter"])


def mitsuba(scene: Scene, out: pathlib.Path, sampler: str) -> tuple[float, Picture]:
    """Processor seconds once all is compiled, and the picture."""
    import mitsuba as mi

    made = loaded(scene, out, sampler)
    mi.render(made, spp=SAMPLES, seed=1).numpy()
    started = time.process_time()
    found = mi.render(made, spp=SAMPLES, seed=2).numpy()
    return time.process_time() - started, found


def loaded(scene: Scene, out: pathlib.Path, sampler: str) -> object:
    import mitsuba as mi

    from . import export  # this import needs a variant of Mitsuba, which the caller sets

    made = export.scene(tomllib.loads(scene.text), out, SIZE, scene.depth)
    made["sensor"]["sampler"]["type"] = sampler
    return mi.load_dict(made)


def truth(scene: Scene, out: pathlib.Path) -> Picture:
    """A converged picture."""
    import mitsuba as mi

    made, parts = loaded(scene, out, SAMPLERS[0]), TRUTH_SAMPLES // 256
    return (
        sum(mi.render(made, spp=256, seed=3 + k).numpy().astype(float) for k in range(parts))
        / parts
    )


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
        converged = truth(scene, out)
        path = out / f"speed-{scene.name}.toml"
        path.write_text(scene.text)
        reflet(path, SAMPLES, program)  # a first run, so that the driver caches compiled shaders
        first_s = reflet(path, 1, program)
        ours_s = (reflet(path, SAMPLES, program) - first_s) * SAMPLES / (SAMPLES - 1)
        numbers = [ours_s, rel_mse(load(path.with_suffix(".exr")), converged)]
        for sampler in SAMPLERS:
            theirs_s, theirs = mitsuba(scene, out, sampler)
            numbers += [theirs_s, rel_mse(theirs, converged)]
        head = [scene.name, adapter(path, program), str(SAMPLES)]
        rows.append(dict(zip(COLUMNS, [*head, *(f"{n:.4g}" for n in numbers)], strict=True)))
        print(" ".join(rows[-1].values()), flush=True)
        write_rows(out / "speed.csv", rows)


def table_rows(
    rows: Rows, driver_of: Callable[[dict[str, str]], str]
) -> tuple[list[str], list[list[str]]]:
    """Head and rows of the page's table; ratios are of times to an error, to the better sampler."""
    head = ["scene"]
    for driver in dict.fromkeys(driver_of(row) for row in rows):
        head += [f"Reflet, {driver}", "relMSE", "÷ Mitsuba"]
    head += [word for sampler in SAMPLERS for word in (f"Mitsuba, {sampler}", "relMSE")]
    made = []
    for (name,), own in by(rows, "scene").items():
        cells = [f"`{name}`"]
        for row in own:
            numbers = [float(row[column]) for column in COLUMNS[3:]]
            work = [s * error for s, error in zip(numbers[::2], numbers[1::2], strict=True)]
            cells += [f"{numbers[0]:.1f} s", f"{numbers[1]:.1e}", f"{work[0] / min(work[1:]):.1f}"]
        first = [float(own[0][column]) for column in THEIRS]
        for seconds, error in zip(first[::2], first[1::2], strict=True):
            cells += [f"{seconds:.1f} s", f"{error:.1e}"]
        made.append(cells)
    return head, made
