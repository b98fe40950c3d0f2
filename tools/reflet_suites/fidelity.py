"""Khronos' glTF-Render-Fidelity: Reflet's pictures of its scenarios among nine renderers'.

The suite's folder holds clones of glTF-Render-Fidelity, whose thumbnails are the pictures, and of
glTF-Render-Fidelity-Generator with its submodule glTF-Sample-Assets, whose test/config.json has
the cameras. Reflet's scene is the model, that camera and that panorama; all else is default.
"""

import concurrent.futures
import dataclasses
import json
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from measuring import used
from PIL import Image
from tables import Row, by, read_rows, write_rows

from reflet_suites.scores import distances, means, on_white, ranks

GENERATOR = "glTF-Render-Fidelity-Generator"
CONFIG = f"{GENERATOR}/test/config.json"
PICTURES = "glTF-Render-Fidelity/public/thumbnails/goldens"
WIDTH = 256
SAMPLES = 16
ROOM = "environments/lightroom_14b.hdr"
OURS, REFERENCE = "reflet", "blender-cycles"
LOOKS = {"default": {}, "aces": {"tone_map": '"aces"', "exposure_ev": math.log2(1 / 0.6)}}
"""Reflet's looks, by keys of `[image]`: its default, and the curve and exposure of the set."""
DISTANCES = [f"{look} {kind}" for look in LOOKS for kind in ("pixels", "means")]
"""Columns of fidelity.csv."""
PATH_TRACERS = ("blender-cycles", "vray", "stellar", "dspbr-pt", "three-gpu-pathtracer")


class LackError(Exception):
    """A thing that a scenario needs and the suite's folder lacks, in words."""


@dataclasses.dataclass(frozen=True)
class Scenario:
    """A view of a model in a panorama's light."""

    name: str
    model: str
    panorama: str
    background: bool
    """Whether the panorama is seen; else the picture is transparent there."""
    eye: tuple[float, float, float]
    toward: tuple[float, float, float]
    fov_deg: float

    def text(self) -> str:
        """Scene text, whose paths are relative to the generator's folder."""
        view = f"eye = {list(self.eye)}, target = {list(self.toward)}, fov_deg = {self.fov_deg:g}"
        # Panoramas of the suite have +X in their middle, where Reflet has +Z.
        return f"""version = 1
camera.main = {{ {view} }}
environment = {{ file = "{self.panorama}", rotation_deg = 90 }}
image.alpha = {str(not self.background).lower()}
model.m = {{ file = {json.dumps(self.model, ensure_ascii=False)} }}

[[instance]]
model = "m"
"""


def scenario(entry: Mapping[str, Any]) -> Scenario:
    """A scenario of test/config.json with the suite's defaults."""
    orbit = {"theta": 0, "phi": 90, "radius": 1} | entry.get("orbit", {})
    target = {"x": 0, "y": 0, "z": 0} | entry.get("target", {})
    theta, phi = math.radians(orbit["theta"]), math.radians(orbit["phi"])
    back = (math.sin(phi) * math.sin(theta), math.cos(phi), math.sin(phi) * math.cos(theta))
    eye = [target[axis] + orbit["radius"] * b for axis, b in zip("xyz", back, strict=True)]
    return Scenario(
        entry["name"],
        entry["model"].replace("../", ""),
        entry.get("lighting", ROOM).replace("../", ""),
        entry.get("renderSkybox", False),
        (eye[0], eye[1], eye[2]),
        # One unit along the view: a camera may stand at the target itself.
        (eye[0] - back[0], eye[1] - back[1], eye[2] - back[2]),
        entry.get("verticalFoV", 45),
    )


def scenarios(suite: Path) -> list[Scenario]:
    """Scenarios that the suite has pictures of."""
    entries = json.loads((suite / CONFIG).read_text(encoding="utf-8"))["scenarios"]
    return [scenario(entry) for entry in entries if (suite / PICTURES / entry["name"]).is_dir()]


def goldens(suite: Path, name: str) -> dict[str, Image.Image]:
    """The suite's pictures of a scenario, by renderer."""
    paths = sorted((suite / PICTURES / name).glob("*-golden.thumb.webp"))
    return {path.name.split("-golden")[0]: Image.open(path) for path in paths}


def lacking(root: Path, model: str) -> list[str]:
    """Files of a model that are not there."""
    if not (root / model).is_file():
        return [model]
    if not model.endswith(".gltf"):
        return []
    text = json.loads((root / model).read_text(encoding="utf-8"))
    parts = text.get("buffers", []) + text.get("images", [])
    uris = [part["uri"] for part in parts if not part.get("uri", "data:").startswith("data:")]
    return [uri for uri in uris if not ((root / model).parent / uri.replace("%20", " ")).is_file()]


def standing_in(root: Path, model: str) -> str:
    """A model's file, or the same model in several files where the binary one is not there."""
    several = model.replace("glTF-Binary", "glTF").replace(".glb", ".gltf")
    return model if (root / model).is_file() else several


def draw(program: Path, suite: Path, out: Path, view: Scenario, height: int, look: str) -> Path:
    """Reflet's picture of a scenario in a look; raises LackError where there is none."""
    root = suite / GENERATOR
    view = dataclasses.replace(view, model=standing_in(root, view.model))
    missing = lacking(root, view.model)
    if not (root / view.panorama).is_file():
        missing.append(view.panorama)
    if missing:
        raise LackError(f"{root} lacks {', '.join(missing)}")
    picture = out / look / f"{view.name}.png"
    if not picture.exists():
        picture.parent.mkdir(parents=True, exist_ok=True)
        scene = out / f"{view.name}.toml"
        scene.write_text(view.text(), encoding="utf-8")
        keys = [f"--set=image.{key}={value}" for key, value in LOOKS[look].items()]
        size = ["--size", f"{WIDTH}x{height}", "--samples", str(SAMPLES), "--denoise"]
        ran = used([program, "render", scene, "-o", picture, "--assets", root, *size, *keys])
        if ran.code != 0:
            raise LackError(f"Reflet renders no picture:\n{ran.said}")
    return picture


def compare(
    scenario: str, pictures: Mapping[str, Image.Image], drawn: Mapping[str, Path]
) -> list[Row]:
    """Distances of each renderer's picture of a scenario, at Reflet's size, for each look of it."""
    rows = {name: {"scenario": scenario, "renderer": name} for name in [*pictures, OURS]}
    for look, path in drawn.items():
        own = Image.open(path)
        shown = {name: on_white(picture, own.size) for name, picture in pictures.items()}
        shown[OURS] = on_white(own, own.size)
        fine = distances(shown)
        coarse = distances({name: means(picture) for name, picture in shown.items()})
        for name, picture in shown.items():
            rows[name][f"{look} pixels"] = f"{fine[name]:.5f}"
            rows[name][f"{look} means"] = f"{coarse[name]:.5f}"
            rows[name][f"{look} brightness"] = f"{picture.mean():.4f}"
    return list(rows.values())


def measure(program: Path, suite: Path, out: Path) -> None:
    """Writes fidelity.csv: distances of each renderer's picture to the others, by scenario."""
    out.mkdir(parents=True, exist_ok=True)

    def work(view: Scenario) -> list[Row]:
        pictures = goldens(suite, view.name)
        shape = pictures.get(REFERENCE, next(iter(pictures.values()))).size
        for name in [name for name, p in pictures.items() if abs(p.height - shape[1]) > 1]:
            print(f"{view.name}: {name}'s picture has another size, and is left out", flush=True)
            del pictures[name]
        height = round(WIDTH * shape[1] / shape[0])
        try:
            drawn = {look: draw(program, suite, out, view, height, look) for look in LOOKS}
        except LackError as lack:
            print(f"{view.name}: not compared: {lack}", flush=True)
            return []
        rows = compare(view.name, pictures, drawn)
        print(f"{view.name}: {rows[-1]}", flush=True)
        return rows

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(work, scenarios(suite)))
    write_rows(out / "fidelity.csv", [row for rows in found for row in rows])


def rank_rows(path: Path) -> list[Row]:
    """Rows of fidelity.csv with the ranks of their distances."""
    rows = read_rows(path)
    for of in by(rows, "scenario").values():
        for column in DISTANCES:
            found = ranks({row["renderer"]: float(row[column]) for row in of})
            for row in of:
                row[f"{column} rank"] = str(found[row["renderer"]])
    return rows
