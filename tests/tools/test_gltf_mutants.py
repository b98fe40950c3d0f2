"""tools/gltf_mutants.py: kinds of damage, how answers are judged, and a few broken files."""

import pathlib
import random
import shutil
import signal

import gltf_mutants
import pytest
from gltf_mutations import KINDS, Model, mutate, read_model
from program import BINARY, ROOT

COUNT = 40


@pytest.fixture
def models() -> list[Model]:
    return [read_model(ROOT / "scripts" / "walker.glb")]


def test_all_kinds_are_made_and_repeat_by_their_number(models: list[Model]) -> None:
    kinds = set()
    for number, of in ((n, of) for n in range(COUNT) for of in (models, [])):
        made = [mutate(of, number, random.Random(f"1 {number}")) for _ in range(2)]
        assert made[0] == made[1]
        kinds.add(made[0][0])
    assert kinds == set(KINDS)


def test_an_unchanged_file_is_put_together_as_it_was(models: list[Model]) -> None:
    [model] = models
    assert model.root is not None
    folder = pathlib.Path(model.file).parent
    again = model.assemble(model.root, model.binary)
    assert not model.beside and folder.is_dir()
    assert again[:4] == b"glTF" and len(again) % 4 == 0
    length = int.from_bytes(again[12:16], "little")
    assert again[20 + length + 8 :][: len(model.binary or b"")] == model.binary


@pytest.mark.parametrize(
    ("script", "what"),
    [
        ("exit 0", "fine"),
        ("echo 'error[gltf-json]: no' >&2; exit 1", "refused"),
        ("echo no >&2; exit 1", "unnamed"),
        ("echo \"thread 'main' panicked at src\" >&2; exit 101", "panic"),
        ("echo 'error[internal]: a fault' >&2; exit 1", "panic"),
        ("echo 'memory allocation of 9 bytes failed' >&2; kill -ABRT $$", "memory"),
        ("kill -ABRT $$", "abort"),
        ("kill -SEGV $$", "abort"),
        ("kill -XCPU $$", "time"),
    ],
)
def test_answers_are_judged(script: str, what: str) -> None:
    assert gltf_mutants.run(["sh", "-c", script], 4096).what == what


def test_too_much_memory_is_an_answer_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gltf_mutants, "MEMORY_MIB", 1)
    assert gltf_mutants.run(["sh", "-c", "exit 0"], 4096).what == "memory"
    assert gltf_mutants.judge(-signal.SIGKILL, "").what == "time"


def test_a_few_broken_files_are_answered(models: list[Model], tmp_path: pathlib.Path) -> None:
    if not BINARY.is_file() or shutil.which("sh") is None:
        pytest.skip(f"{BINARY} is not built")
    for made_of in (models, []):  # without models, panoramas with odd headers
        ends = [
            gltf_mutants.one(number, 1, made_of, str(BINARY), tmp_path, render=False).end
            for number in range(COUNT)
        ]
        assert set(ends) == {"refused", "shown"}, ends
    assert list(tmp_path.iterdir()) == []


def test_one_wrong_part_takes_nothing_else(models: list[Model]) -> None:
    if not BINARY.is_file():
        pytest.skip(f"{BINARY} is not built")
    [model] = models
    whole = gltf_mutants.facts(str(BINARY), model.file)
    for kind in ("materials", "names", "attributes", "accessors of attributes", "channels"):
        assert gltf_mutants.part(str(BINARY), whole, kind, model, random.Random(1)) == "", kind
    less = gltf_mutants.Facts({"lights": []}, "")
    said = gltf_mutants.part(str(BINARY), less, "names", model, random.Random(1))
    assert said.startswith("lost more")
