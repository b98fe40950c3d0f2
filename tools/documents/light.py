"""Light and materials beside Mitsuba 3 and closed forms (docs/light.md).

Mitsuba is no part of the project's environment: `python3 -m venv DIR && DIR/bin/pip install
mitsuba numpy pillow OpenEXR`, then run tools/tell.py by DIR/bin/python to measure. It needs LLVM 17
or newer as a shared library: the compiler of Rust has one, which is taken unless
`DRJIT_LIBLLVM_PATH` names another. Pictures are 96 x 64, in linear light. Times, all that
`--only speed` measures, are of the system's driver, of the newest one, and of Cycles where
`tools/setup.sh --blender` has installed it. The text around the tables is written by hand: check it
against new numbers.
"""

import os
import pathlib
import shutil
import subprocess
import sys
from collections.abc import Sequence

import numpy as np
from measuring import render
from PIL import Image
from reflet_light import speed
from reflet_light.scenes import ROUGHNESSES, Scene, all_scenes, panorama
from reflet_usd.exr_pixels import read_exr
from sheet import sheet, shown
from tables import Row, Rows, read_rows, table, write_rows

from documents.document import DATA, IMAGES, Document, Run, driver_of, in_places

SIZE = (96, 64)
THEIR_SAMPLES = 4096
TRIMMED = 0.01  # share of the pixels, the most different ones, that are left out: tessellated edges
# Scenes whose convergence is measured, and the numbers of sub-frames.
CONVERGING = ["metal-040", "light-rect", "glass-rough"]
COUNTS = [1, 4, 16, 64, 256]

Picture = np.ndarray


def rel_mse(a: Picture, b: Picture) -> float:
    """Mean of (a − b)² / (b² + 0.01) over channels and all but the worst pixels."""
    error = ((a - b) ** 2 / (b**2 + 0.01)).mean(axis=2).ravel()
    return float(np.sort(error)[: round(len(error) * (1 - TRIMMED))].mean())


def load(path: pathlib.Path) -> Picture:
    """Linear RGB of a picture."""
    return read_exr(path.read_bytes())[..., :3]


def ours(out: pathlib.Path, scene: Scene, samples: int, program: pathlib.Path) -> Picture:
    picture = out / f"{scene.name}.{samples}.exr"
    if not picture.exists():
        text = out / f"{scene.name}.toml"
        text.write_text(scene.text)
        render(program, text, picture, SIZE, "--samples", str(samples))
    return load(picture)


def theirs(out: pathlib.Path, scene: Scene) -> speed.Pair:
    """Two pictures by Mitsuba that differ by their noise alone; their mean is the reference."""
    kept = out / f"{scene.name}.npy"
    return speed.converged(scene, kept, SIZE, THEIR_SAMPLES // 2, speed.SAMPLERS[0])


def find_llvm() -> None:
    """Point Mitsuba to the LLVM of Rust's compiler: the system's, its choice, may be too old."""
    rustc = ["rustc", "--print", "sysroot"]
    sysroot = subprocess.run(rustc, capture_output=True, text=True, check=True).stdout.strip()
    for library in pathlib.Path(sysroot, "lib").glob("libLLVM.so.*"):
        os.environ.setdefault("DRJIT_LIBLLVM_PATH", str(library))


def measure(run: Run) -> None:
    find_llvm()
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    from reflet_light import bsdf

    bsdf.register()
    out = run.out
    mi.Bitmap(panorama()).write(str(out / "sky.exr"))
    rows = {(row["scene"], row["samples"]): row for row in read_rows(out / "light.csv")}
    for scene in all_scenes():
        if not run.wants(scene.name):
            continue
        for samples in [*(COUNTS if scene.name in CONVERGING else []), scene.samples]:
            if (scene.name, str(samples)) not in rows:
                row = compare(out, scene, samples, run.program)
                rows[scene.name, str(samples)] = row
                print(" ".join(row.values()), flush=True)
                write_rows(out / "light.csv", list(rows.values()))
    if run.wants("speed"):
        speed.measure(out, run.program, all_scenes(), load, rel_mse)


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


def scenes_table(rows: Rows) -> str:
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


def convergence_table(rows: Rows) -> str:
    lines = []
    for name in CONVERGING:
        of = {int(r["samples"]): float(r["rel_mse"]) for r in rows if r["scene"] == name}
        points = [(n, of[n]) for n in COUNTS if n in of]
        if len(points) == len(COUNTS):
            cells = [f"{error:.1e}" for _, error in points]
            lines.append([f"`{name}`", *cells, f"{slope(points):.2f}"])
    return table(["scene", *map(str, COUNTS), "exponent"], lines)


def tables() -> dict[str, str]:
    rows = read_rows(DATA / "light.csv")
    return {
        "scenes": scenes_table(rows),
        "convergence": convergence_table(rows),
        "speed": table(*speed.table_rows(read_rows(DATA / "light-speed.csv"), driver_of)),
    }


# Scenes of each sheet of the page.
SHEETS = {
    **{
        kind: [f"{kind}-{round(100 * r):03}" for r in ROUGHNESSES]
        for kind in ("metal", "dielectric")
    },
    "glass": [
        *["glass", "glass-rough", "glass-thin", "clearcoat", "clearcoat-rough", "metal-panels"]
    ],
    "cloth": ["sheen", "sheen-sharp", "specular-color", "specular-half"],
    "lens": ["depth-of-field", "motion-blur"],
    "kinds": [f"light-{n}" for n in ("point", "sphere", "spot", "sun", "rect", "disk")],
}


def store(outs: list[pathlib.Path]) -> None:
    out = outs[0]
    speeds = [row for each in outs for row in read_rows(each / "speed.csv")]
    if speeds:
        write_rows(DATA / "light-speed.csv", speeds)
    elif not read_rows(out / "light.csv"):
        sys.exit(f"{out} holds no measurements; run with --measure first")
    if not read_rows(out / "light.csv"):
        return
    shutil.copyfile(out / "light.csv", DATA / "light.csv")
    samples = {scene.name: scene.samples for scene in all_scenes()}
    for sheet_name, names in SHEETS.items():
        # Reflet's pictures above Mitsuba's, one column for each scene.
        linear = [load(out / f"{name}.{samples[name]}.exr") for name in names]
        linear += [np.load(out / f"{name}.npy").mean(axis=0) for name in names]
        cells = [("", shown(picture)) for picture in linear]
        made = sheet(cells, len(names), 2 * SIZE[0], gap=0, scaling=Image.Resampling.NEAREST)
        made.save(IMAGES / f"light-{sheet_name}.png")


DOCUMENT = Document("light.md", in_places(tables), store, measure)
