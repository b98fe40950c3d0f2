"""The comparison of two builds: which differences of two EXR files count."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest
from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))

import compare_builds


def write(path: Path, level: float, channel: str = "R", comment: str = "") -> Path:
    """An EXR file of a row of pixels, the last of this level."""
    pixels = np.array([[1, 1, level]], np.float16)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "comments": comment}
    OpenEXR.File(header, {channel: pixels}).write(str(path))
    return path


@pytest.mark.parametrize(
    ("other", "same"),
    [
        ({"level": 1, "comment": "another fingerprint"}, True),
        ({"level": 0.5}, False),
        ({"level": 1, "channel": "G"}, False),
    ],
)
def test_only_layout_and_pixels_of_exr_files_count(
    tmp_path: Path, other: dict[str, Any], same: bool
) -> None:
    one, two = write(tmp_path / "one.exr", 1), write(tmp_path / "two.exr", **other)
    assert compare_builds.same_file(one, two) is same


def test_one_pixel_of_a_png_counts(tmp_path: Path) -> None:
    for name, level in (("a", 10), ("b", 10), ("c", 11)):
        Image.new("RGB", (2, 2), (level, 0, 0)).save(tmp_path / f"{name}.png")
    assert compare_builds.same_file(tmp_path / "a.png", tmp_path / "b.png")
    assert not compare_builds.same_file(tmp_path / "a.png", tmp_path / "c.png")


def test_another_file_is_no_exr(tmp_path: Path) -> None:
    path = tmp_path / "a.exr"
    path.write_bytes(b"text")
    with pytest.raises(compare_builds.CompareError):
        compare_builds.same_file(path, path)


def test_the_median_lies_between_its_bounds() -> None:
    # 95 % interval of the median of 200 values: from the 87th to the 114th.
    values = [float(v) for v in range(200)]
    assert compare_builds.interval(values[::-1]) == (99.5, 86.0, 113.0)
    assert compare_builds.interval([3.0, 1.0]) == (2.0, 1.0, 3.0)


def test_a_program_that_fails_has_no_time(tmp_path: Path) -> None:
    program = tmp_path / "program"
    program.write_text("#!/bin/sh\necho no such scene >&2\nexit 3\n")
    program.chmod(0o755)
    with pytest.raises(compare_builds.CompareError, match="no such scene"):
        compare_builds.processor_s(program, tmp_path / "a.toml", 1, [])
    program.write_text("#!/bin/sh\nexit 0\n")
    assert compare_builds.processor_s(program, tmp_path / "a.toml", 1, []) >= 0
