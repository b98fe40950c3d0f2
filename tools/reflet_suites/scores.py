"""Scores by which pictures of suites are judged: distances, ranks and masks."""

from collections.abc import Mapping

import numpy as np
from PIL import Image
from scipy.ndimage import binary_dilation

Picture = np.ndarray
CELL = 4
NEIGHBORS = np.ones((3, 3), bool)


def on_white(picture: Image.Image, size: tuple[int, int]) -> Picture:
    """sRGB values from 0 to 1 over a white page, reduced to a size by means of pixels."""
    rgba = np.asarray(picture.convert("RGBA"), np.float64) / 255
    alpha = rgba[..., 3:]
    page = Image.fromarray(np.round(255 * (rgba[..., :3] * alpha + 1 - alpha)).astype(np.uint8))
    return np.asarray(page.resize(size, Image.Resampling.BOX), np.float64) / 255


def means(picture: Picture, cell: int = CELL) -> Picture:
    """Means over cells of `cell` × `cell` pixels; pixels past the last whole cell are left out."""
    rows, columns = picture.shape[0] // cell, picture.shape[1] // cell
    cut = picture[: rows * cell, : columns * cell]
    return cut.reshape(rows, cell, columns, cell, -1).mean(axis=(1, 3))


def distances(pictures: Mapping[str, Picture]) -> dict[str, float]:
    """Mean distance of each picture to the others: of two, the mean absolute difference."""
    if len({picture.shape for picture in pictures.values()}) != 1:
        sizes = ", ".join(f"{name} {p.shape[1]} × {p.shape[0]}" for name, p in pictures.items())
        raise ValueError(f"pictures have to have one size: {sizes}")
    found = {}
    for name, picture in pictures.items():
        others = [other for key, other in pictures.items() if key != name]
        found[name] = float(np.mean([abs(picture - other).mean() for other in others]))
    return found


def ranks(distance: Mapping[str, float]) -> dict[str, float]:
    """Ranks from 0, the nearest, to 1, the farthest; equal distances share their mean rank."""
    values = np.array(list(distance.values()))
    place = [(values < v).sum() + ((values == v).sum() - 1) / 2 for v in values]
    return dict(zip(distance, (float(p) / (len(values) - 1) for p in place), strict=True))


def overlap(a: Picture, b: Picture) -> float:
    """Intersection over union of two masks; 1 where both are empty.

    A pixel is in the intersection where one mask has it and the other it or a neighbor of it.
    """
    union = (a | b).sum()
    shared = (a & binary_dilation(b, NEIGHBORS)) | (b & binary_dilation(a, NEIGHBORS))
    return float(shared.sum() / union) if union else 1.0
