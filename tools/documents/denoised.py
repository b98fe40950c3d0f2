"""Flicker and errors of denoised films, printed as a table like the table of docs/films.md.

Frames have 4 samples and are denoised alone and by windows. REFLET_OIDN names the folder of Open
Image Denoise.
"""

import pathlib
from dataclasses import dataclass

import numpy as np
import tomllib
from measuring import ROOT, render
from PIL import Image
from scipy.ndimage import maximum_filter, minimum_filter
from tables import table

from documents.document import DATA, Run

SIZE = (96, 54)
FRAMES = 10
SAMPLES = 4
REFERENCE_SAMPLES = 128
CLEAN_SAMPLES = 32
AT_REST, MOVING = "denoised-still", "denoised-moving"
WINDOWS = [0, 2, 3, 4]
SAME_DEPTH = 0.002  # relative difference of the depths of one place in two frames

Picture = np.ndarray


@dataclass
class View:
    """A perspective camera without roll: its position and target."""

    eye: Picture
    target: Picture
    fov_deg: float

    def axes(self) -> Picture:
        """Rows: right, up and forward, the former two half a picture's height long at 1 m."""
        forward = self.target - self.eye
        forward = forward / np.linalg.norm(forward)
        right = np.cross(forward, [0.0, 1.0, 0.0])
        right = right / np.linalg.norm(right)
        half = np.tan(np.radians(self.fov_deg) / 2)
        return np.stack([right * half, np.cross(right, forward) * half, forward])


@dataclass
class Frame:
    """Surfaces of the pixels of a frame: depths along the view, instances, and the camera."""

    depth: Picture
    instance: Picture
    view: View

    def positions(self) -> Picture:
        """World-space positions at the centers of all pixels."""
        height, width = self.depth.shape
        y, x = np.mgrid[0:height, 0:width] + 0.5
        across = np.stack([(2 * x - width) / height, 1 - 2 * y / height], axis=2)
        right, up, forward = self.view.axes()
        ray = across[..., :1] * right + across[..., 1:] * up + forward
        return self.view.eye + ray * self.depth[..., None]

    def places(self, positions: Picture) -> tuple[Picture, Picture, Picture]:
        """Column and row in this frame, 0 at the center of the first pixel, and depth."""
        height, width = self.depth.shape
        right, up, forward = self.view.axes()
        offset = positions - self.view.eye
        depth = offset @ forward
        x = offset @ right / (right @ right) / depth
        y = offset @ up / (up @ up) / depth
        return (x * height + width - 1) / 2, ((1 - y) * height - 1) / 2, depth

    def inside(self) -> Picture:
        """Pixels whose 3 x 3 pixels show one instance: no edge of a thing smoothed in them."""
        lowest, highest = (of(self.instance, 3) for of in (minimum_filter, maximum_filter))
        return lowest == highest


def moved(values: Picture, before: Frame, frame: Frame) -> tuple[Picture, Picture]:
    """Values of the frame before where the surfaces of a frame were, and where that is known.

    Surfaces rest in the world: a thing that moves by itself has another depth there, and is left
    out. A place between pixels takes the mean of four, all of which must show the surface.
    """
    height, width = frame.depth.shape
    with np.errstate(invalid="ignore"):
        x, y, depth = before.places(frame.positions())
        known = np.isfinite(x) & (x > -0.01) & (x < width - 0.99)
    known &= (y > -0.01) & (y < height - 0.99)
    x, y = (np.where(known, v, 0).clip(0) for v in (x, y))
    # A camera at rest shows the same pixels, whatever the last bits of their places.
    x, y = (np.where(abs(v - v.round()) < 0.01, v.round(), v) for v in (x, y))
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    own_y, own_x = np.mgrid[0:height, 0:width]
    rests = (x == own_x) & (y == own_y)  # edges that rest are the same edges
    known &= frame.inside() | rests
    total, nearness = np.zeros_like(values), np.zeros_like(depth)
    for right in (0, 1):
        for below in (0, 1):
            share = abs(1 - right - (x - left)) * abs(1 - below - (y - top))
            at = (np.minimum(top + below, height - 1), np.minimum(left + right, width - 1))
            same = (before.instance[at] == frame.instance) & (before.inside()[at] | rests)
            known &= same | (share == 0)
            total += share[..., None] * values[at]
            nearness += np.divide(share, before.depth[at])  # linear over the picture of a plane
    with np.errstate(invalid="ignore"):
        known &= abs(nearness * depth - 1) <= SAME_DEPTH
    return total, known


def error_change(
    pictures: list[Picture], references: list[list[Picture]], frames: list[Frame]
) -> float:
    """Root mean square change of a film's error from frame to frame, along the motion of surfaces.

    The part of an error that moves with a surface, such as a texture that was smoothed away, does
    not count; patches that stay behind or come and go do. The product of the errors against two
    references has the mean square as its mean, whatever the grain of the references is, as their
    grains are independent.
    """
    squares = []
    for i in range(1, len(frames)):
        changes = []
        for reference in references:
            then = pictures[i - 1] - reference[i - 1]
            then, known = moved(then, frames[i - 1], frames[i])
            changes.append((pictures[i] - reference[i] - then)[known])
        squares.append(changes[0] * changes[-1])
    return float(np.sqrt(max(np.concatenate(squares).mean(), 0)))


def at_rest(pictures: list[Picture], truth: list[Picture]) -> tuple[float, float]:
    """Change from frame to frame where many samples rest: mean, and root mean square."""
    changes = []
    for i in range(1, len(pictures)):
        rests = (truth[i] == truth[i - 1]).all(axis=2)
        changes.append(abs(pictures[i] - pictures[i - 1])[rests])
    change = np.concatenate(changes)
    return float(change.mean()), float(np.sqrt((change**2).mean()))


class Film:
    """A film's frames in a folder; missing frames are rendered."""

    def __init__(self, name: str, run: Run) -> None:
        self.scene = DATA / f"{name}.toml"
        self.folder = run.out / name
        self.program = run.program
        self.folder.mkdir(exist_ok=True)

    def render(self, name: str, further: list[str], size: tuple[int, int]) -> list[pathlib.Path]:
        film = ["--frames", "all", "--resume", "--assets", str(ROOT / "scenes"), *further]
        render(self.program, self.scene, self.folder / name, size, *film)
        return [self.folder / name.replace("#", str(i)) for i in range(FRAMES)]

    def pictures(self, name: str, samples: int, window: int | None) -> list[Picture]:
        arguments = ["--samples", str(samples)]
        if window is not None:
            arguments += ["--denoise", "--denoise-window", str(window)]
        return [levels(path) for path in self.render(f"{name}.#.png", arguments, SIZE)]

    def clean(self) -> list[list[Picture]]:
        """Two films of more samples, denoised alone, whose grain is independent.

        A pixel's random numbers follow from its place: the second is a pixel larger at each side.
        """
        inner = self.pictures("clean", CLEAN_SAMPLES, 0)
        size = (SIZE[0] + 2, SIZE[1] + 2)
        half = np.tan(np.radians(self.views()[0].fov_deg) / 2) * size[1] / SIZE[1]
        fov = f"camera.main.fov_deg={np.degrees(2 * np.arctan(half))}"
        denoised = ["--denoise", "--denoise-window", "0", "--set", fov]
        arguments = ["--samples", str(CLEAN_SAMPLES), *denoised]
        paths = self.render("clean-larger.#.png", arguments, size)
        return [inner, [levels(path)[1:-1, 1:-1] for path in paths]]

    def views(self) -> list[View]:
        """The camera of each frame: the living room's, moved along the film's two keys."""
        room = tomllib.loads((ROOT / "scenes" / "interior.toml").read_text())
        camera = room["camera"]["main"]
        motion = tomllib.loads(self.scene.read_text())["motion"].get("camera")
        ends = [key["value"] for key in motion["main"]["eye"]["keys"]] if motion else []
        first, last = ends or [camera["eye"], camera["eye"]]
        eyes = np.linspace(first, last, FRAMES)
        return [View(eye, np.array(camera["target"]), camera["fov_deg"]) for eye in eyes]

    def frames(self) -> list[Frame]:
        """Depths and instances of the frames, from pictures of one sample."""
        import OpenEXR

        plain = ["--samples", "1", "--method", "ssr", "--set", "reflection.diffuse_bounces=0"]
        paths = self.render("surfaces.#.exr", [*plain, "--aov", "depth,ids"], SIZE)
        frames = []
        for path, view in zip(paths, self.views(), strict=True):
            channels = OpenEXR.File(str(path), separate_channels=True).channels()
            depth, ids = (channels[name].pixels for name in ("depth.Z", "ids.instance"))
            frames.append(Frame(np.asarray(depth, dtype=np.float64), np.asarray(ids), view))
        return frames


def levels(path: pathlib.Path) -> Picture:
    """A picture in levels of 0 to 255."""
    return np.asarray(Image.open(path).convert("RGB"), dtype=np.float64)


def flips(pictures: list[Picture], truth: list[Picture]) -> Picture:
    """Mean FLIP of each frame."""
    import flip_evaluator

    found = []
    for pair in zip(truth, pictures, strict=True):
        units = [(picture / 255).astype(np.float32) for picture in pair]
        found.append(flip_evaluator.evaluate(*units, "LDR", applyMagma=False)[1])
    return np.array(found)


def measure(run: Run) -> None:
    """Prints a table with a line for each film and window."""
    lines = []
    for name in (AT_REST, MOVING):
        film = Film(name, run)
        truth = film.pictures("truth", REFERENCE_SAMPLES, None)
        alone = None
        for window in WINDOWS:
            pictures = film.pictures(f"window-{window}", SAMPLES, window)
            if name == AT_REST:
                mean, square = (f"{v:.3f}" for v in at_rest(pictures, truth))
            else:
                mean, square = "", f"{error_change(pictures, film.clean(), film.frames()):.3f}"
            scores = flips(pictures, truth)
            alone = scores if alone is None else alone
            worst = f"{(scores - alone).max():+.5f}"
            error = np.mean([abs(p - t).mean() for p, t in zip(pictures, truth, strict=True)])
            lines.append(
                [name, str(window), mean, square, f"{error:.3f}", f"{scores.mean():.5f}", worst]
            )
    head = ["film", "`--denoise-window`", "mean change", "root mean square change"]
    print(table([*head, "error", "FLIP", "FLIP, worst frame against alone"], lines))
