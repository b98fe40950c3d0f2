"""Puts pictures with their captions on one sheet.

.venv/bin/python tools/sheet.py OUT.png --columns 4 --width 320 "a caption=picture.png" ...
"""

from __future__ import annotations

import argparse
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

GAP = 6
TEXT_HEIGHT = 14


def sheet(
    cells: list[tuple[str, Path]],
    columns: int,
    width: int,
    crop: tuple[int, int, int, int] | None = None,
) -> Image.Image:
    """The pictures row by row, each `width` pixels wide; captions above where there are any.

    `crop` is the shown part of each picture: left, top, right and bottom in its pixels.
    """
    pictures = [_scaled(path, width, crop) for _, path in cells]
    height = max(picture.height for picture in pictures)
    rows = -(-len(cells) // columns)
    text_height = TEXT_HEIGHT if any(caption for caption, _ in cells) else 0
    step_x, step_y = width + GAP, height + text_height + GAP
    out = Image.new("RGB", (columns * step_x + GAP, rows * step_y + GAP), "white")
    draw = ImageDraw.Draw(out)
    font = ImageFont.load_default()
    for index, ((caption, _), picture) in enumerate(zip(cells, pictures, strict=True)):
        x, y = GAP + index % columns * step_x, GAP + index // columns * step_y
        draw.text((x, y), caption, fill="black", font=font)
        out.paste(picture, (x, y + text_height))
    return out


def _scaled(path: Path, width: int, crop: tuple[int, int, int, int] | None) -> Image.Image:
    picture = Image.open(path).convert("RGB").crop(crop)
    height = round(picture.height * width / picture.width)
    return picture.resize((width, height), Image.Resampling.LANCZOS)


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
    sheet(cells, arguments.columns, arguments.width, crop).save(arguments.out, optimize=True)


if __name__ == "__main__":
    main()
