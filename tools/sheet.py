"""Puts pictures with their captions on one sheet.

.venv/bin/python tools/sheet.py OUT.png --columns 4 --width 320 "a caption=picture.png" ...
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

GAP = 6
TEXT_HEIGHT = 14


def shown(linear: np.ndarray) -> Image.Image:
    """A picture of linear radiance as sRGB (IEC 61966-2-1)."""
    c = np.clip(linear, 0, 1)
    srgb = np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)
    return Image.fromarray((255 * srgb + 0.5).astype(np.uint8))


def sheet(
    cells: Sequence[tuple[str, Path | Image.Image]],
    columns: int,
    width: int,
    *,
    crop: tuple[int, int, int, int] | None = None,
    gap: int = GAP,
    scaling: Image.Resampling = Image.Resampling.LANCZOS,
) -> Image.Image:
    """The pictures row by row, each `width` pixels wide; captions above where there are any.

    `crop` is the shown part of each picture: left, top, right and bottom in its pixels.
    """

    def scaled(picture: Path | Image.Image) -> Image.Image:
        opened = Image.open(picture) if isinstance(picture, Path) else picture
        part = opened.convert("RGB").crop(crop)
        return part.resize((width, round(part.height * width / part.width)), scaling)

    pictures = [scaled(picture) for _, picture in cells]
    height = max(picture.height for picture in pictures)
    rows = -(-len(cells) // columns)
    text_height = TEXT_HEIGHT if any(caption for caption, _ in cells) else 0
    step_x, step_y = width + gap, height + text_height + gap
    out = Image.new("RGB", (columns * step_x + gap, rows * step_y + gap), "white")
    draw = ImageDraw.Draw(out)
    font = ImageFont.load_default()
    for index, ((caption, _), picture) in enumerate(zip(cells, pictures, strict=True)):
        x, y = gap + index % columns * step_x, gap + index // columns * step_y
        draw.text((x, y), caption, fill="black", font=font)
        out.paste(picture, (x, y + text_height))
    return out


def main() -> None:
    parser = argparse.ArgumentParser(description="Puts pictures with captions on one sheet.")
    parser.add_argument("out", type=Path)
    parser.add_argument("--columns", type=int, default=4)
    parser.add_argument("--width", type=int, default=320, help="width of each picture, pixels")
    parser.add_argument(
        "--crop",
        type=int,
        nargs=4,
        metavar=("LEFT", "TOP", "RIGHT", "BOTTOM"),
        help="show this part of each picture, pixels",
    )
    parser.add_argument("cells", nargs="+", help="CAPTION=PICTURE")
    arguments = parser.parse_args()
    cells = []
    for cell in arguments.cells:
        caption, sign, path = cell.rpartition("=")
        if not sign:
            parser.error(f"{cell}: expected CAPTION=PICTURE")
        cells.append((caption, Path(path)))
    crop = tuple(arguments.crop) if arguments.crop else None
    sheet(cells, arguments.columns, arguments.width, crop=crop).save(arguments.out, optimize=True)


if __name__ == "__main__":
    main()
