"""Hostile stages: the parent survives every one, and each ends as a file or as a named error."""

import concurrent.futures
import os
from pathlib import Path

import pytest
from mutations import SECRET, Mutant, all_mutants, hand_written_bodies
from pxr import Sdf, Tf
from reflet_usd.convert.types import ConvertError
from reflet_usd.sandbox import Limits, run_convert
from reflet_usd.validate.khronos import check_files

LIMITS = Limits(memory_bytes=3 << 30, cpu_s=10, wall_s=30.0, output_bytes=64 << 20)
QUICK = 50
"""The quick run takes every QUICK-th mutant."""


def convert(mutant: Mutant, folder: Path) -> tuple[str, Path | None]:
    """Outcome of one mutant: `converted` or the error's name, and the path of its output."""
    place = folder / mutant.title / "in"
    place.mkdir(parents=True)
    (folder / mutant.title / "secret.usda").write_text(
        f'#usda 1.0\n(defaultPrim = "{SECRET}")\n'
        f'def Cube "{SECRET}" {{ def Cube "{SECRET}" {{}} }}\n'
    )
    for name, data in mutant.beside.items():
        (place / name).write_bytes(data)
    stage = place / f"stage{mutant.suffix}"
    stage.write_bytes(mutant.data)
    results = folder / mutant.title / "out"
    results.mkdir()
    out = results / "out.glb"
    try:
        run_convert(stage, out, limits=LIMITS)
    except ConvertError as error:
        assert list(results.iterdir()) == [], f"{mutant.title}: a partial output"
        assert error.message, mutant.title
        return error.name, None
    assert sorted(path.name for path in results.iterdir()) == ["out.glb", "out.glb.json"]
    for path in results.iterdir():
        assert SECRET.encode() not in path.read_bytes(), f"{mutant.title}: read outside its folder"
    return "converted", out


def check_all(mutants: list[Mutant], folder: Path) -> None:
    """Convert all of them, then validate the outputs with the Khronos validator."""
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        ends = list(pool.map(lambda mutant: convert(mutant, folder), mutants))
    survived = dict(zip([mutant.title for mutant in mutants], ends, strict=True))
    assert len(survived) == len(mutants)
    internal = [name for name, (end, _) in survived.items() if end == "converter-internal"]
    assert internal == []
    outputs = {name: out for name, (_, out) in survived.items() if out is not None}
    reports = check_files(list(outputs.values()))
    invalid = {
        name: report.messages[:1]
        for name, report in zip(outputs, reports, strict=True)
        if report.errors
    }
    assert invalid == {}


@pytest.fixture(scope="module")
def mutants() -> list[Mutant]:
    """All hostile stages."""
    return all_mutants(Path(__file__).resolve().parent / "stages")


def test_there_are_at_least_200_and_they_never_change(mutants: list[Mutant], stages: Path) -> None:
    assert len(mutants) >= 200
    titles = [mutant.title for mutant in mutants]
    assert len(set(titles)) == len(titles)
    assert mutants == all_mutants(stages)


def test_what_is_written_by_hand_reaches_the_converter(tmp_path: Path) -> None:
    unread = []
    for name, body in hand_written_bodies().items():
        path = tmp_path / f"{name}.usda"
        path.write_bytes(body)
        try:
            Sdf.Layer.FindOrOpen(str(path))
        except Tf.ErrorException:
            unread.append(name)
    assert unread == []


def test_a_part_of_the_hostile_stages(mutants: list[Mutant], tmp_path: Path, khronos: None) -> None:
    check_all(mutants[::QUICK], tmp_path)


@pytest.mark.full("converts each hostile stage, of which a part is converted daily")
def test_all_hostile_stages(mutants: list[Mutant], tmp_path: Path, khronos: None) -> None:
    check_all(mutants, tmp_path)
