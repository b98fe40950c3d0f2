"""OpenUSD's imaging tests with cameras of their own: Reflet's pictures beside Storm's baselines.

The suite's folder holds a clone of OpenUSD. Its list of tests names stage, camera, times, level of
subdivision and background; each test is rendered from its stage alone, with Reflet's own light.
"""

import dataclasses
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from measuring import used
from PIL import Image
from tables import Row, write_rows

from reflet_suites.scores import Picture, on_white, overlap

FOLDER = "OpenUSD/pxr/usdImaging/usdImagingGL"
LIST = f"{FOLDER}/CMakeLists.txt"
SIZE = (320, 240)
SAMPLES = 8
CLEAR = (1.0, 0.5, 0.1, 1.0)
"""Background of the test program."""
OTHERWISE = {"-renderer", "-pixelAspectRatio", "-presentComposite"}
"""Options by which the test program draws otherwise than a stage says."""
RIGHT = 0.9
LEAST_CLEARED = 0.02


@dataclasses.dataclass(frozen=True)
class Test:
    """One picture of a test that OpenUSD runs."""

    name: str
    stage: str
    camera: str
    time: float | None
    subdivisions: int
    clear: tuple[float, ...]
    nodes: str
    """Folder of the test's own MaterialX nodes, beside its stage."""
    baseline: str
    """Name of Storm's picture."""


def options(command: str) -> dict[str, list[str]]:
    """Values of each option of a command, by its name."""
    found = re.findall(r"(?<= )(-[a-zA-Z]\w*)((?: +(?!-[a-zA-Z])\S+)*)", command)
    return {name: values.split() for name, values in found}


def tests(text: str) -> Iterator[Test]:
    """Tests of Storm in a list of tests (CMake), each of their pictures once.

    Tests that are left out of the list, of other renderers and channels, of times between frames,
    and of windows and layers of pictures, which are features of the test program, are not among
    them.
    """
    seen = set()
    for block in re.findall(r"^[ \t]*pxr_register_test\((.*?)^[ \t]*\)", text, re.M | re.S):
        command = re.search(r'COMMAND\s+"([^"]*)"', block)
        folder = re.search(r"TESTENV\s+(\w+)", block)
        if not command or not folder or "_SceneIndex" in folder[1]:
            continue
        given = options(command[1])
        windows = given.get("-dataWindow") != given.get("-displayWindow")
        if windows or OTHERWISE & given.keys() or "-camera" not in given:
            continue
        if given.get("-rendererAov", ["color"]) != ["color"]:
            continue
        nodes = re.search(r"PXR_MTLX_PLUGIN_SEARCH_PATHS=(\S+)", block)
        for time in dict.fromkeys(given.get("-times", [None])):
            if time is not None and not float(time).is_integer():
                continue
            stage = f"{folder[1]}/{given['-stage'][0]}"
            stem = given["-write"][0].removesuffix(".png")
            level = round(10 * (float(given.get("-complexity", ["1"])[0]) - 1))
            color = tuple(float(word) for word in given.get("-clear", [])) or CLEAR
            mark = "" if time is None else f"_{float(time):03.0f}"
            camera, moment = given["-camera"][0], None if time is None else float(time)
            baseline = f"{folder[1]}/baseline/{stem}{mark}.png"
            own = nodes[1] if nodes else "."
            found = Test(block.split()[0], stage, camera, moment, level, color, own, baseline)
            if (stage, camera, baseline) not in seen:
                seen.add((stage, camera, baseline))
                yield found


def covered(picture: Picture, clear: tuple[float, ...]) -> Picture:
    """Pixels that differ from the background: the color that the program clears a picture with.

    Where a dome light stands before it, the background is what lies within the colors of the
    picture's edges, give or take eight of 255 steps.
    """
    cleared = (abs(picture - np.array(clear[:3])) < 2.5 / 255).all(axis=2)
    if cleared.mean() > LEAST_CLEARED:
        return ~cleared
    edges = np.concatenate([picture[0], picture[-1], picture[:, 0], picture[:, -1]])
    low, high = edges.min(axis=0) - 8 / 255, edges.max(axis=0) + 8 / 255
    return ((picture < low) | (picture > high)).any(axis=2)


def draw(program: Path, suite: Path, out: Path, test: Test) -> tuple[Path | None, str]:
    """Reflet's picture of a test, or none and the name of the error."""
    picture = out / f"{Path(test.baseline).stem}.png"
    stage = suite / FOLDER / "testenv" / test.stage
    command: list[str | Path] = [program, "render", stage, "-o", picture, "--no-project"]
    command += ["--camera", f"model/{test.camera.rsplit('/', 1)[1]}"]
    command += ["--size", f"{SIZE[0]}x{SIZE[1]}", "--samples", str(SAMPLES)]
    command += ["--set", "image.alpha=true", "--assets", stage.parent / test.nodes]
    if test.subdivisions:
        command += ["--set", f"model.model.usd={{subdiv={test.subdivisions}}}"]
    frames = [] if test.time is None else ["--frames", f"{test.time:g}"]
    if not picture.exists():
        ran = used([*command, *frames], limit_s=300)
        if ran.code == 2 and "no [timeline]" in ran.said:  # nothing of the stage moves
            ran = used(command, limit_s=300)
        if ran.code != 0:
            found = re.search(r"error\[([a-z-]+)\]", ran.said)
            return None, found[1] if found else f"exit code {ran.code}"
    return picture, ""


def judge(ours: Image.Image, theirs: Image.Image, clear: tuple[float, ...]) -> Row:
    """Overlap of the masks of drawn pixels, and their mean values."""
    storm, reflet = (on_white(picture, ours.size) for picture in (theirs, ours))
    masks = [covered(storm, clear), np.asarray(ours.convert("RGBA"))[..., 3] >= 128]
    pairs = zip((storm, reflet), masks, strict=True)
    shades = [picture[mask].mean() if mask.any() else 0.0 for picture, mask in pairs]
    score = overlap(masks[0], masks[1])
    return {
        "overlap": f"{score:.3f}",
        "storm": f"{shades[0]:.3f}",
        "reflet": f"{shades[1]:.3f}",
        "right": str(int(score >= RIGHT)),
    }


def measure(program: Path, suite: Path, out: Path) -> None:
    """Writes imaging.csv: a row for each picture of a test."""
    out.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = []
    listed = (suite / LIST).read_text(encoding="utf-8")
    none = {"overlap": "", "storm": "", "reflet": "", "right": "0"}
    for test in tests(listed):
        time = "" if test.time is None else f"{test.time:g}"
        row = {"test": test.name, "time": time, **none, "refused": ""}
        baseline = suite / FOLDER / "testenv" / test.baseline
        if not baseline.is_file():
            print(f"{test.name} {time}: not compared: {baseline} is not there", flush=True)
            continue
        picture, row["refused"] = draw(program, suite, out, test)
        if picture:
            row |= judge(Image.open(picture), Image.open(baseline), test.clear)
        print(" ".join(row.values()), flush=True)
        rows.append(row)
        write_rows(out / "imaging.csv", rows)
