#!/usr/bin/env python3
"""Compare two builds of Reflet, pixel by pixel or by the time they take.

Renders every shipped scene, and 8 frames of every film, with both programs: the tone-mapped
picture as PNG, and linear color with all AOVs as EXR. Decoded pixels and the EXR's layout must be
the same; other metadata, such as the fingerprint of a film's frame, may differ.

    tools/compare_builds.py OLD NEW [--assets DIR] [--cache DIR]

With --pairs both programs instead render scenes in turns, and the ratio of their processor times is
printed: for a picture with one sub-frame, which is mostly reading and compiling, and for every
further sub-frame.

    tools/compare_builds.py OLD NEW --pairs 200 [--assets DIR] [--set KEY=VALUE] SCENE...

Exit code: 0 equal, 1 different, 2 usage or a render that failed.
"""

import argparse
import concurrent.futures
import hashlib
import json
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import OpenEXR
from measuring import ROOT, settings, used
from PIL import Image

SIZE = "160x90"
FILM_FRAMES = 8
# Number of further sub-frames over which the cost of one is averaged.
MORE_SUB_FRAMES = 32
# EXR header attributes that say how the pixel data is laid out.
EXR_LAYOUT = ("compression", "dataWindow", "displayWindow", "lineOrder")


class CompareError(Exception):
    """A file that cannot be read, or a program that failed."""


@dataclass(frozen=True)
class Work:
    """One scene and the numbers of its frames to render; no numbers for a still scene."""

    scene: Path
    frames: tuple[int, ...]

    def names(self, ending: str) -> list[str]:
        """Names of the files that rendering the scene writes."""
        stem = self.scene.stem
        return [f"{stem}.{n:04}.{ending}" for n in self.frames] or [f"{stem}.{ending}"]


def exr_content(path: Path) -> list[dict[str, str | bytes]]:
    """Layout, and pixels by channel, of each part of an EXR file."""
    try:
        parts = OpenEXR.File(str(path), separate_channels=True).parts
    except (RuntimeError, TypeError, ValueError) as error:
        raise CompareError(f"{path} is not an EXR file: {error}") from None
    return [
        {name: str(part.header.get(name)) for name in EXR_LAYOUT}
        | {f"{name} {of.pixels.dtype}": of.pixels.tobytes() for name, of in part.channels.items()}
        for part in parts
    ]


def same_file(old: Path, new: Path) -> bool:
    """Whether two pictures of the same kind have the same pixels."""
    if old.suffix == ".exr":
        return exr_content(old) == exr_content(new)
    with Image.open(old) as a, Image.open(new) as b:
        return (a.mode, a.size, a.tobytes()) == (b.mode, b.size, b.tobytes())


def run(command: list[str | Path]) -> str:
    """Standard output of a command; raises CompareError where it fails."""
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    if ran.returncode != 0:
        raise CompareError(f"{' '.join(map(str, command))} failed:\n{ran.stderr.strip()}")
    return ran.stdout


def shipped(program: Path, assets: list[str | Path]) -> list[Work]:
    """All scenes of the checkout; scenes of `scenes/paper` only where asset folders are given."""
    folders = ["scenes", "scripts", *(["scenes/paper"] if assets else [])]
    found = []
    for path in sorted(path for folder in folders for path in (ROOT / folder).glob("*.toml")):
        timeline = json.loads(run([program, "info", path, "--json", *assets])).get("timeline")
        frames: tuple[int, ...] = ()
        if timeline is not None:
            start, end = timeline["start"], timeline["end"]
            last = FILM_FRAMES - 1
            frames = tuple(start + (end - start) * i // last for i in range(FILM_FRAMES))
        found.append(Work(path, frames))
    return found


def aov_names(program: Path) -> str:
    """Names of all AOVs of a program, taken from its error message about a wrong one."""
    asked: list[str | Path] = [program, "render", "--aov", "?", "-o", "none.exr"]
    answer = subprocess.run(asked, capture_output=True, text=True, check=False)
    _, found, names = answer.stderr.partition("choose from ")
    if not found:
        raise CompareError(f"{program} does not list its AOVs: {answer.stderr.strip()}")
    return names.strip().replace(" ", "")


def render(program: Path, work: Work, out: Path, assets: list[str | Path]) -> None:
    """Render one scene's pictures into `out`."""
    frames = sorted(set(work.frames))
    some: list[str | Path] = ["--frames", ",".join(map(str, frames))] if frames else []
    number = ".####" if frames else ""
    aovs: list[str | Path] = ["--aov", aov_names(program)]
    for ending in ("png", "exr"):
        name = out / f"{work.scene.stem}{number}.{ending}"
        output: list[str | Path] = ["-o", name, "--size", SIZE]
        planes = aovs if ending == "exr" else []
        run([program, "render", work.scene, *output, *planes, *some, *assets])


def rendered(program: Path, works: list[Work], out: Path, assets: list[str | Path]) -> Path:
    """The folder of a program's pictures; pictures that it already holds are not rendered again."""
    out.mkdir(parents=True, exist_ok=True)
    missing = [
        work
        for work in works
        if not all((out / name).exists() for e in ("png", "exr") for name in work.names(e))
    ]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for done in [pool.submit(render, program, work, out, assets) for work in missing]:
            done.result()
    return out


def folder_of(program: Path, place: Path) -> Path:
    """Folder of a program's pictures, named by a hash of the program."""
    return place / hashlib.sha256(program.read_bytes()).hexdigest()[:16]


def compare(old: Path, new: Path, works: list[Work]) -> tuple[int, list[str]]:
    """Number of pictures, and the names of differing pictures."""
    names = [name for work in works for e in ("png", "exr") for name in work.names(e)]
    return len(names), [name for name in names if not same_file(old / name, new / name)]


def processor_s(program: Path, scene: Path, sub_frames: int, options: list[str | Path]) -> float:
    """Processor time in seconds, over all threads, of rendering a picture."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "picture.png"
        size: list[str | Path] = ["--size", SIZE, "--samples", str(sub_frames)]
        command = [program, "render", scene, "-o", out, *size, *options]
        ran = used(command)
    if ran.code != 0:
        raise CompareError(f"{' '.join(map(str, command))} failed:\n{ran.said.strip()}")
    return ran.processor_s


def interval(values: list[float]) -> tuple[float, float, float]:
    """Median and its 95 % confidence bounds (order statistics of the binomial)."""
    ordered = sorted(values)
    reach = 0.98 * len(ordered) ** 0.5
    middle = (len(ordered) - 1) / 2
    low, high = max(round(middle - reach), 0), min(round(middle + reach), len(ordered) - 1)
    return statistics.median(ordered), ordered[low], ordered[high]


def tell_ratio(programs: list[Path], scene: Path, pairs: int, options: list[str | Path]) -> None:
    """Print the ratio of the second program's time to the first one's."""
    counts = (1, 1 + MORE_SUB_FRAMES)
    ratios: dict[str, list[float]] = {"first": [], "further": []}
    for pair in range(pairs):
        # The programs also take turns at going first.
        order = programs if pair % 2 == 0 else programs[::-1]
        took = {p: [processor_s(p, scene, count, options) for count in counts] for p in order}
        old, new = (took[program] for program in programs)
        ratios["first"].append(new[0] / old[0])
        ratios["further"].append((new[1] - new[0]) / (old[1] - old[0]))
    for name, values in ratios.items():
        median, low, high = interval(values)
        found = f"{median:.3f} of the time ({low:.3f} to {high:.3f})"
        print(f"{scene.name}: {name} sub-frames take {found}, {pairs} pairs", flush=True)


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("old", type=Path, help="reflet program of the old build")
    parser.add_argument("new", type=Path, help="reflet program of the new build")
    parser.add_argument("--assets", type=Path, help="models of scenes/paper, else left out")
    parser.add_argument("--cache", type=Path, help="keep the pictures of each program here")
    parser.add_argument("--pairs", type=int, help="number of turns in which to compare time")
    parser.add_argument("--set", action="append", default=[], help="with --pairs: an override")
    parser.add_argument("scene", type=Path, nargs="*", help="with --pairs: scene files")
    args = parser.parse_intermixed_args()
    if (args.pairs is not None) != bool(args.scene) or args.pairs == 0:
        parser.error("--pairs needs a number above 0 and scenes; without it there are none to name")
    assets: list[str | Path] = ["--assets", args.assets] if args.assets else []
    try:
        programs = [program.resolve(strict=True) for program in (args.old, args.new)]
        options = [*assets, *settings(*args.set)]
        for scene in args.scene:
            tell_ratio(programs, scene, args.pairs, options)
        if args.pairs:
            return 0
        with tempfile.TemporaryDirectory() as scratch:
            place = args.cache or Path(scratch)
            works = shipped(programs[1], assets)
            folders = [rendered(p, works, folder_of(p, place), assets) for p in programs]
            count, different = compare(folders[0], folders[1], works)
    except (CompareError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    for name in different:
        print(f"differs: {name}")
    print(f"{count} pictures of {len(works)} scenes compared, {len(different)} differ")
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
