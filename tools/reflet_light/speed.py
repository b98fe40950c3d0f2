"""Processor time and error of Reflet, Mitsuba and Cycles on the same scenes, samples alike."""

import functools
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Mapping

import numpy as np
import tomllib
from measuring import ROOT, used
from tables import Rows, by, read_rows, write_rows

from .scenes import Scene

SIZE = (384, 256)
SAMPLES = 64
# Samples of each of two converged pictures, whose mean is the truth; as many at once as fit into
# memory.
TRUTH_SAMPLES = 512
MOST_SAMPLES = 256
# A measurement that takes less is made three times.
SHORT_S = 10.0
NAMES = ["metal-040", "metal-panels", "metal-rect", "clearcoat", "glass-rough"]
NAMES += ["light-rect", "room-4", "room-path"]
SAMPLERS = ["independent", "multijitter"]
# Scenes that Cycles has another model of, or samples with a bias: its error is its noise alone.
OWN_TRUTH = ["clearcoat", "glass-rough"]
RENDERERS = ["reflet", *SAMPLERS, "cycles"]
COLUMNS = ["scene", "driver", "samples"]
COLUMNS += [f"{name}_{number}" for name in RENDERERS for number in ("s", "rel_mse")]
COLUMNS += ["cycles_apart", "cycles_brightness"]
BPY = ROOT / ".venv-bpy" / "bin" / "python"
FROM_TEXT = ROOT / "tools" / "blender" / "from_text.py"

Picture = np.ndarray
Pair = tuple[Picture, Picture]
Load = Callable[[pathlib.Path], Picture]
RelMse = Callable[[Picture, Picture], float]
Environment = Mapping[str, str]


def median(measured: Callable[[], float]) -> float:
    """Median of three measurements, or the first one where it is long."""
    first = measured()
    return first if first > SHORT_S else statistics.median([first, measured(), measured()])


def drivers() -> list[Environment]:
    """Environments of the system's driver and of the newest one, where that can be had."""
    command: list[str | pathlib.Path] = ["bash", ROOT / "tools" / "driver.sh", "newest"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        print(f"NOT MEASURED: the newest driver: {run.stderr.strip()}", flush=True)
        return [{}]
    return [{}, dict(re.findall(r"^export (\w+)=(.*)$", run.stdout, re.MULTILINE))]


def reflet(
    path: pathlib.Path, samples: int, program: pathlib.Path, environment: Environment
) -> float:
    """Render a scene beside its file; returns seconds of processor time."""
    command: list[str | pathlib.Path] = [program, "render", path, "-o", path.with_suffix(".exr")]
    command += ["--size", f"{SIZE[0]}x{SIZE[1]}", "--samples", str(samples)]
    ran = used(command, environment=environment)
    if ran.code != 0:
        sys.exit(ran.said)
    return ran.processor_s


def reflet_s(path: pathlib.Path, program: pathlib.Path, environment: Environment) -> float:
    """Processor seconds of the samples alone, from the times of one and of all."""
    one_s = reflet(path, 1, program, environment)
    return (reflet(path, SAMPLES, program, environment) - one_s) * SAMPLES / (SAMPLES - 1)


def adapter(path: pathlib.Path, program: pathlib.Path, environment: Environment) -> str:
    """Name of the adapter that renders a scene, with its driver."""
    command: list[str | pathlib.Path] = [program, "render", path, "--size", "8x8", "-o"]
    command += [path.with_suffix(".png"), "--stats", "json"]
    held = {**os.environ, **environment}
    run = subprocess.run(command, check=True, capture_output=True, text=True, env=held)
    return str(json.loads(run.stdout)["adapter"])


def mitsuba(scene: Scene, out: pathlib.Path, sampler: str) -> tuple[float, Picture]:
    """Processor seconds once all is compiled, and the picture."""
    import mitsuba as mi

    made = loaded(scene.text, scene.depth, out, SIZE, sampler)
    found = mi.render(made, spp=SAMPLES, seed=0).numpy()

    def again() -> float:
        started = time.process_time()
        mi.render(made, spp=SAMPLES, seed=0).numpy()
        return time.process_time() - started

    return median(again), found


def loaded(text: str, depth: int, out: pathlib.Path, size: tuple[int, int], sampler: str) -> object:
    import mitsuba as mi

    from . import export  # this import needs a variant of Mitsuba, which the caller sets

    made = export.scene(tomllib.loads(text), out, size, depth)
    made["sensor"]["sampler"]["type"] = sampler
    return mi.load_dict(made)


def converged(
    scene: Scene, found: pathlib.Path, size: tuple[int, int], samples: int, sampler: str
) -> Pair:
    """Two pictures by Mitsuba that differ by their noise alone, kept in a file; their mean is the
    reference."""
    import mitsuba as mi

    if not found.exists():
        moments = scene.moments or (scene.text,)
        parts = max(samples // len(moments) // MOST_SAMPLES, 1)
        pair, seed = np.zeros((2, size[1], size[0], 3)), 0
        for text in moments:
            made = loaded(text, scene.depth, found.parent, size, sampler)
            for _ in range(parts):
                for half in pair:
                    seed += 1
                    spp = samples // len(moments) // parts
                    half += mi.render(made, spp=spp, seed=seed).numpy()
        np.save(found, pair / (len(moments) * parts))
    pair = np.load(found)
    return pair[0], pair[1]


def cycles(path: pathlib.Path, depth: int, load: Load) -> tuple[float, list[Picture]]:
    """Processor seconds of the samples alone, and three pictures that differ by their noise."""
    counts = [1, *3 * [1, SAMPLES]]  # the first one starts Cycles
    command: list[str | pathlib.Path] = [BPY, FROM_TEXT, path, f"{SIZE[0]}x{SIZE[1]}"]
    command += [str(depth - 2), *map(str, counts)]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    said = next(line for line in run.stdout.splitlines() if line.startswith("seconds "))
    took = [float(word) for word in said.split()[1:]]
    alone_s = statistics.median(np.subtract(took[2::2], took[1::2]))
    pictures = [load(path.with_suffix(f".cycles.{k}.exr")) for k in (2, 4, 6)]
    return alone_s * SAMPLES / (SAMPLES - 1), pictures


def error(found: Picture, pair: Pair, rel_mse: RelMse) -> float:
    """Error against the mean of a pair, less what is the noise of that mean."""
    return rel_mse(found, (pair[0] + pair[1]) / 2) - rel_mse(*pair) / 4


def measure(
    out: pathlib.Path,
    program: pathlib.Path,
    scenes: list[Scene],
    load: Load,
    rel_mse: RelMse,
) -> None:
    rows = read_rows(out / "speed.csv")
    known = {row["scene"] for row in rows}
    environments = drivers()
    if not BPY.exists():
        print("NOT MEASURED: Cycles, which tools/setup.sh --blender installs", flush=True)
    for scene in scenes:
        if scene.name not in NAMES or scene.name in known:
            continue
        kept = out / f"speed-{scene.name}.npy"
        pair = converged(scene, kept, SIZE, TRUTH_SAMPLES, SAMPLERS[1])
        path = out / f"speed-{scene.name}.toml"
        path.write_text(scene.text)
        theirs: list[float] = []
        for sampler in SAMPLERS:
            theirs_s, picture = mitsuba(scene, out, sampler)
            theirs += [theirs_s, error(picture, pair, rel_mse)]
        if BPY.exists():
            seconds, pictures = cycles(path, scene.depth, load)
            noise, mean = rel_mse(*pictures[:2]) / 2, np.mean(pictures, axis=0)
            is_own = scene.name in OWN_TRUTH
            theirs += [seconds, noise if is_own else error(pictures[0], pair, rel_mse)]
            theirs += [error(mean, pair, rel_mse) - noise / len(pictures)]
            theirs += [float(mean.mean() / np.mean(pair))]
        for environment in environments:
            head = [scene.name, adapter(path, program, environment), str(SAMPLES)]
            reflet(path, SAMPLES, program, environment)  # a first run, so that shaders are cached
            ours_s = median(functools.partial(reflet_s, path, program, environment))
            numbers = [ours_s, error(load(path.with_suffix(".exr")), pair, rel_mse), *theirs]
            cells = [*head, *(f"{n:.4g}" for n in numbers)]
            rows.append(dict(zip(COLUMNS, cells + [""] * (len(COLUMNS) - len(cells)), strict=True)))
            print(" ".join(rows[-1].values()), flush=True)
        write_rows(out / "speed.csv", rows)


def table_rows(
    rows: Rows, driver_of: Callable[[dict[str, str]], str]
) -> tuple[list[str], list[list[str]]]:
    """Head and rows of the page's table; ratios are of times to an error, to the better sampler."""
    others = {"÷ Mitsuba": SAMPLERS, "÷ Cycles": ["cycles"]}
    if not all(row["cycles_s"] for row in rows):
        del others["÷ Cycles"]
    head = ["scene"]
    for driver in dict.fromkeys(driver_of(row) for row in rows):
        head += [f"Reflet, {driver}", *others]
    head += [*(f"Mitsuba, {sampler}" for sampler in SAMPLERS), "Cycles"][: len(others) + 1]
    made = []
    for (name,), own in by(rows, "scene").items():
        cells = [f"`{name}`"]
        for row in own:
            cells.append(cell(row, RENDERERS[0]))
            for names in others.values():
                best = min(work(row, other) for other in names)
                cells.append(f"{work(row, RENDERERS[0]) / best:.1f}")
        cells += [cell(own[0], other) for names in others.values() for other in names]
        made.append(cells)
    return head, made


def cell(row: dict[str, str], renderer: str) -> str:
    return f"{float(row[renderer + '_s']):.1f} s, {float(row[renderer + '_rel_mse']):.1e}"


def work(row: dict[str, str], renderer: str) -> float:
    """Time to an error of 1, if errors fall as 1 / n."""
    return float(row[f"{renderer}_s"]) * float(row[f"{renderer}_rel_mse"])
