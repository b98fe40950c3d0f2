"""Types and documentation of the compiled module."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from os import PathLike
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, Self, TypeAlias, TypedDict, Unpack, final

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray
from typing_extensions import disjoint_base

from reflet.errors import Diagnostic

_Path: TypeAlias = str | PathLike[str]
_Aov: TypeAlias = Literal[
    "depth",
    "normal",
    "base_color",
    "material",
    "emission",
    "radiance",
    "specular",
    "reflection",
    "reflectance",
    "source",
    "cause",
    "hit_distance",
    "hit_ids",
    "ids",
]
_Integers: TypeAlias = Sequence[int] | NDArray[np.integer[Any]]
_Method: TypeAlias = Literal[
    "ssr", "rt", "hybrid", "probe", "ssr+probe", "ssr+box", "near-far", "path", "auto"
]

__all__ = [
    "AOVS",
    "CAUSES",
    "SOURCES",
    "Comparison",
    "Frames",
    "Picture",
    "Scores",
    "Session",
    "__version__",
    "compare",
    "open",
]
__version__: str
AOVS: list[str]
"""Names of all AOVs."""
CAUSES: list[str]
"""Names of the numbers of the AOV `cause`: why the reflection of a pixel came from its source."""
SOURCES: list[str]
"""Names of the numbers of the AOV `source`: where the reflection of a pixel came from."""

class _View(TypedDict, total=False):
    """Choices of a picture, in place of the scene's, for this picture alone."""

    aovs: _Aov | Sequence[_Aov] | Sequence[str]
    """AOVs to render too."""
    camera: str
    """Camera; without a name the camera of the scene's cuts, else `main`, else the first."""
    size: _Integers
    """Width and height, pixels, each 1 to 16384."""
    samples: int
    """Sub-frames averaged, 1 to 4096."""
    method: _Method
    """How reflections are found."""
    crop: _Integers
    """Left and top edge, width and height of the part to render, pixels."""
    denoise: bool
    """Whether noise is removed by Intel Open Image Denoise, where it is installed."""
    audit: bool
    """Whether screen hits are checked by rays (`Picture.wrong_hits`); also times the passes."""
    timed: bool
    """Whether each pass is timed and waited for (`Picture.stats["passes_ms"]`)."""

def open(
    scene: _Path | Mapping[str, Any] | None = None,
    *,
    text: str | None = None,
    folder: _Path | None = None,
    assets: Sequence[_Path] | None = None,
    set: Mapping[str, Any] | None = None,
    variant: str | Sequence[str] | None = None,
    project: bool | _Path | None = None,
    lenient: bool = False,
    strict: bool = False,
    camera: str | None = None,
    size: _Integers | None = None,
    samples: int | None = None,
    method: _Method | None = None,
    adapter: str | None = None,
    shaders: _Path | None = None,
) -> Session:
    """Open a scene at its first frame, on a graphics adapter.

    `scene` is a scene file, a model (`.gltf`, `.glb`; USD with `reflet[usd]`), which gets daylight
    and a camera, or a dict with the keys of scene text. `text` is scene text, in place of the file
    at `scene` if that is given too. Without both it is the built-in scene.

    `folder` is where files that a dict or a text names are searched from; without it the current
    one. `assets` are folders to search after the scene's own. `set` has values to change by their
    path, such as `{"image.samples": 16, "params.height": 2.0}`, and `variant` the names of variants
    to lay over it. `project` is False for a scene of no project, or the path of one, in place of
    the `reflet.toml` that is found in its folder or above. `lenient` loads glTF files without
    references to nodes and meshes that they lack, and `strict` refuses models with wrong parts that
    are else left out with a warning; not both.

    `camera`, `size` (pixels), `samples` and `method` hold for all pictures. `adapter` is a part of
    an adapter's name, and `shaders` a folder of shaders in place of the built-in ones.

    Warnings about the scene are given as `reflet.SceneWarning`. Ctrl-C is answered when the scene
    is open.

    Raises `SceneError` for mistakes, with file, line and column; `UnknownNameError` for a camera
    that the scene lacks; `NoAdapterError`; `DeviceError`; `ForkError` in a process that was forked
    from one that used Reflet.
    """

@final
class Session:
    """An open scene with its device, closed by `with`. Calls of several threads take turns."""

    def render(
        self,
        frame: int | None = None,
        *,
        progress: Callable[[int, int | None], object] | None = None,
        **view: Unpack[_View],
    ) -> Picture:
        """Render a frame, or the shown one, which is the first at the beginning.

        Other threads run meanwhile. `progress` is called with the number of finished sub-frames and
        of all, or None where `samples = { error = ... }` decides that. Ctrl-C, and an exception of
        `progress`, end the picture between two of its sub-frames; the session stays usable.

        `view` replaces settings of the scene for this picture alone: `aovs` to add, `camera`,
        `size` and `samples`, the `method` that finds reflections, `crop` (left and top edge, width
        and height, pixels), `denoise` (each frame alone, by Open Image Denoise), `audit` (checks
        screen hits by rays, for `Picture.wrong_hits`), `timed` (`Picture.stats["passes_ms"]`).

        Raises `FrameError` outside of the timeline, `SceneError` where a script fails at the frame,
        `UnknownNameError`, `ArgumentError`, `DeviceError`.
        """

    def frames(
        self,
        frames: str | Iterable[int] | None = None,
        *,
        progress: Callable[[int, int | None], object] | None = None,
        **view: Unpack[_View],
    ) -> Frames:
        """Frames of the timeline, each rendered when it is asked for; without a list all of them.

        `frames` is such as `"0-47"`, `"1-20:2"`, `"1,3,5-9"` or `range(0, 48)`. They
        save the same files as `reflet render --frames`, which goes on after them with `--resume`.
        `view` is as for `render`.

        Raises `FrameError` in a scene without a timeline, and for frames outside of it.
        """

    def set(self, path: str | Mapping[str, Any], value: object = None) -> None:
        """Change a value, `set("params.height", 2.0)`, or several, `set({"image.samples": 4})`.

        The text and the script are read again, models and images only where the changed scene needs
        others. The frame stays if the changed timeline has it. After an error the session is
        unchanged.
        """

    def query(
        self,
        frame: int | None = None,
        *,
        camera: str | None = None,
        at: Sequence[tuple[int, int]] | None = None,
        of: Sequence[str] | None = None,
        parts: bool = False,
    ) -> dict[str, Any]:
        """Ask what a picture of a frame, or of the shown one, will show, without rendering it.

        The answer has the keys of `reflet query --json`: shares, boxes and distances of things,
        lights, bounds, and the surfaces of the pixels `at=[(x, y)]`. `of` names the things to ask
        about in place of all, and `parts` lists copies and parts of files alone. `view_from_world`
        and `clip_from_view` are the matrices of the camera, row by row. Vertices that `mesh` gave
        are not seen.

        Raises `FrameError`, `UnknownNameError`, `ArgumentError` for pixels outside of the picture.
        """

    def mesh(self, model: str, *, positions: ArrayLike, normals: ArrayLike | None = None) -> None:
        """Give other vertices to a mesh, in all of its instances and all frames from now on.

        `positions` has the shape (N, 3), meters in the space of the model, one row for each vertex
        of its shape, in their order; `normals`, of the same shape, point out of the surface, of any
        length. Without them it is smooth over the triangles that share a vertex. The shape must be
        of `kind = "mesh"` with `dynamic = true`.

        Raises `ArgumentError` for another shape or type, and for numbers that are not finite;
        `UnknownNameError`.
        """

    def close(self) -> None:
        """Free the device. Everything but `close`, `closed`, `name` and `adapter` then raises
        `ClosedError`; pictures stay.
        """

    def __enter__(self) -> Self: ...
    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
        /,
    ) -> None: ...
    @property
    def closed(self) -> bool:
        """Whether the session is closed."""

    @property
    def name(self) -> str:
        """Name of the scene in messages."""

    @property
    def adapter(self) -> str:
        """Adapter, driver and API."""

    @property
    def frame(self) -> int:
        """Number of the shown frame; 0 in a scene without a timeline."""

    @property
    def timeline(self) -> tuple[int, int, float] | None:
        """First and last frame, and frames in a second; None without a timeline."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the scene's pictures, pixels."""

    @property
    def cameras(self) -> list[str]:
        """Names of the cameras."""

    @property
    def instances(self) -> list[str]:
        """Names of the instances in the AOVs `ids` and `hit_ids`, by number; 4294967295 is none."""

    @property
    def parameters(self) -> dict[str, bool | int | float | str | list[float]]:
        """Values of `[params]`."""

    @property
    def warnings(self) -> list[Diagnostic]:
        """Warnings about the scene's text, script and files."""

    @property
    def log(self) -> list[str]:
        """Lines that scripts printed in `setup`, then in the shown frame."""

@final
class Frames(Iterator[Picture]):
    """Frames of a timeline, rendered one by one."""

    def __iter__(self) -> Self: ...
    def __next__(self) -> Picture: ...
    def __len__(self) -> int:
        """Return len(self)."""

@final
class Picture:
    """A finished picture with its AOVs, `picture["depth"]`. It shows itself in notebooks.

    The arrays are the picture's own memory: values written to them are saved. They give themselves
    to other libraries by DLPack without a copy; the picture itself stands for `display` there, and
    in `numpy.asarray` and `PIL.Image.fromarray`.

    | AOV | shape, type | meaning |
    |---|---|---|
    | `depth` | (H, W) float32 | meters along the view direction; infinite without a surface |
    | `normal` | (H, W, 3) float32 | shading normal in the world's space; 0 without a surface |
    | `base_color`, `emission` | (H, W, 3) float32 | linear RGB |
    | `material` | (H, W, 3) float32 | roughness, metallic, reflectivity |
    | `radiance`, `specular` | (H, W, 3) float32 | linear RGB of all views, of this view |
    | `reflection` | (H, W, 3) float32 | linear RGB along the mirror ray |
    | `reflectance` | (H, W) float32 | Fresnel-weighted reflectance, 0 to 1 |
    | `source`, `cause` | (H, W) uint32 | where the reflection came from, and why |
    | `hit_distance` | (H, W) float32 | meters along the mirror ray; infinite without a hit |
    | `ids`, `hit_ids` | (H, W, 2) uint32 | instance and triangle of the pixel, of its mirror ray |
    """

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""

    @property
    def frame(self) -> int:
        """Number of the frame; 0 in a scene without a timeline."""

    @property
    def radiance(self) -> NDArray[np.float32]:
        """Linear RGB before exposure, premultiplied, and alpha: float32, (H, W, 4)."""

    @property
    def display(self) -> NDArray[np.uint8]:
        """sRGB, not premultiplied, and alpha: uint8, (H, W, 4)."""

    @property
    def alpha(self) -> bool:
        """Whether alpha says where the scene covers the picture; else it is 1 everywhere."""

    @property
    def stats(self) -> dict[str, Any]:
        """Statistics of the frame, with the keys of `reflet render --stats json`."""

    @property
    def wrong_hits(self) -> float | None:
        """Share of wrong hits among the audited screen hits, 0 to 1; None without hits.

        It needs `audit=True`. `stats["audit"]` has the counts and the 95 % confidence interval.
        """

    @property
    def log(self) -> list[str]:
        """Lines that scripts printed for the frame."""

    def save(self, path: _Path) -> list[Path]:
        """Write the picture as `reflet render -o PATH` does, byte by byte, and return the files.

        `.png` has the display color, and AOVs beside it as `NAME.depth.png`; `.exr` has radiance
        and AOVs, linear, in one file. `####` in the name is the number of the frame. Files are
        replaced whole or not at all.

        Raises `ArgumentError` for a path that cannot be written or that the scene reads, `OSError`
        for a full disk.
        """

    def keys(self) -> list[str]:
        """Names of the AOVs."""

    def __getitem__(self, name: str, /) -> NDArray[Any]: ...
    def __contains__(self, name: str, /) -> bool: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def tobytes(self) -> bytes:
        """Bytes of `display`."""

    def _repr_png_(self) -> bytes: ...
    def __array__(
        self, dtype: DTypeLike | None = None, copy: bool | None = None
    ) -> NDArray[Any]: ...
    @property
    def __array_interface__(self) -> dict[str, Any]: ...
    def __dlpack__(self, **options: Any) -> Any: ...
    def __dlpack_device__(self) -> tuple[int, int]: ...

@disjoint_base
class Scores:
    """Metrics of the pixels of a region, as `reflet compare` prints them."""

    @property
    def area_px(self) -> int:
        """Number of pixels."""

    @property
    def flip(self) -> float:
        """Mean FLIP, the difference that an observer sees: 0 (equal) to 1."""

    @property
    def flip_p95(self) -> float:
        """FLIP that 95 % of the pixels do not exceed."""

    @property
    def flip_p99(self) -> float:
        """FLIP that 99 % of the pixels do not exceed."""

    @property
    def ssim(self) -> float | None:
        """Structural similarity, 1 for equal pictures; None below 11 x 11 pixels."""

    @property
    def psnr_db(self) -> float:
        """Peak signal-to-noise ratio of the display values, dB; infinite for equal ones."""

    @property
    def rel_mse(self) -> float:
        """Relative mean squared error in linear light."""

    @property
    def max_difference(self) -> float:
        """Largest difference of a channel, code values from 0 to 255."""

    @property
    def specks(self) -> float:
        """Share of pixels that stand out in this picture but not in the reference, 0 to 1."""

@final
class Comparison(Scores):
    """Metrics of a whole picture against a reference; `str` is the table of `reflet compare`."""

    @property
    def identical(self) -> bool:
        """Whether all pixels are equal."""

    @property
    def mask(self) -> Scores | None:
        """Metrics inside the mask; None without one, and where it has fewer than 100 pixels."""

    @property
    def flip_map(self) -> NDArray[np.float32]:
        """FLIP of each pixel: float32, (H, W), 0 to 1."""

    @property
    def notes(self) -> list[str]:
        """Sentences about how the pictures were read."""

def compare(
    test: Picture | _Path | NDArray[Any],
    reference: Picture | _Path | NDArray[Any],
    *,
    mask: _Path | NDArray[Any] | None = None,
) -> Comparison:
    """Judge a picture against a reference of the same size, as `reflet compare` does.

    Both are pictures, of which the display color is compared, PNG or OpenEXR files, or arrays of
    the shape (H, W, 3 or 4): uint8 is sRGB, float is linear. `mask` has Fresnel-weighted
    reflectance, such as `picture["reflectance"]`: pixels over 1/255, less 5 at every edge, are
    scored apart.

    Raises `ArgumentError` for sizes that differ, other shapes and types, and numbers that are not
    finite; `SceneError` for files that hold no picture.
    """
