"""tools/fuzz_seeds.py: the seed files of the glTF fuzzer."""

import base64
import json
import pathlib
import re
import struct

import fuzz_seeds
import pytest
import tomllib
from gltf_mutations import Model, read_model

GLTF = pathlib.Path(__file__).resolve().parents[1] / "gltf"
MESHOPT = "EXT_meshopt_compression"


def read_seed(folder: pathlib.Path, seed: bytes) -> Model:
    file = folder / "seed.glb"
    file.write_bytes(seed)
    return read_model(file)


def test_files_beside_come_into_one_file(tmp_path: pathlib.Path) -> None:
    inline = base64.b64encode(b"inline").decode()
    root = {
        "asset": {"version": "2.0"},
        "buffers": [
            {"uri": "a%20b.bin", "byteLength": 5},
            {"byteLength": 64, "extensions": {MESHOPT: {"fallback": True}}},
            {"uri": f"data:application/octet-stream;base64,{inline}", "byteLength": 6},
        ],
        "bufferViews": [
            {
                "buffer": 1,
                "byteLength": 64,
                "extensions": {MESHOPT: {"buffer": 0, "byteOffset": 1, "byteLength": 4}},
            },
            {"buffer": 2, "byteOffset": 2, "byteLength": 4},
        ],
        "images": [{"uri": "x.webp"}],
    }
    (tmp_path / "a b.bin").write_bytes(b"bytes")
    (tmp_path / "x.webp").write_bytes(b"webp")
    (tmp_path / "x.gltf").write_text(json.dumps(root))
    seeds = fuzz_seeds.seeds_of(tmp_path / "x.gltf")
    assert len(seeds) == 2, "by both names of meshopt"
    assert b"KHR_meshopt" in seeds[1]
    made = read_seed(tmp_path, seeds[0])
    assert made.root is not None
    assert made.binary is not None
    binary = made.binary

    def held(part: dict[str, int]) -> bytes:
        assert part["buffer"] == 0
        return binary[part["byteOffset"] :][: part["byteLength"]]

    fallback, view, image = made.root["bufferViews"]
    assert held(fallback["extensions"][MESHOPT]) == b"ytes"
    assert held(view) == b"line"
    assert made.root["images"] == [{"mimeType": "image/webp", "bufferView": 2}]
    assert held(image) == b"webp"
    assert "fallback" in made.root["buffers"][fallback["buffer"]]["extensions"][MESHOPT]


def test_broken_files_stay_as_they_are_and_reports_are_none(
    tmp_path: pathlib.Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "broken.gltf").write_text('{"buffers": 7}')
    (folder / "broken.gltf.report.json").write_text("{}")
    (folder / "misses.gltf").write_text('{"buffers": [{"uri": "none.bin", "byteLength": 1}]}')
    (folder / "large.glb").write_bytes(b"glTF" + bytes(fuzz_seeds.MOST_BYTES))
    out = tmp_path / "out"
    monkeypatch.setattr("sys.argv", ["fuzz_seeds.py", str(out), str(folder), str(GLTF)])
    fuzz_seeds.main()
    seeds = [file.read_bytes() for file in out.iterdir()]
    assert b'{"buffers": 7}' in seeds
    assert not any(b"none.bin" in seed or seed == b"{}" for seed in seeds)
    ktx2 = sum(b"KHR_texture_basisu" in seed for seed in seeds)
    assert ktx2 == len(list(GLTF.glob("*.ktx2"))), "each on a triangle"
    assert max(map(len, seeds)) <= fuzz_seeds.MOST_BYTES
    said = capsys.readouterr().out
    assert f"{ktx2} with KHR_texture_basisu" in said
    assert "0 with EXT_meshopt_compression: its decoder is not reached" in said


def test_an_image_lies_in_a_binary_chunk_of_its_size() -> None:
    seed = fuzz_seeds.on_triangle(b"abc", "EXT_texture_webp", "image/webp")
    length, text = struct.unpack("<I", seed[8:12])[0], struct.unpack("<I", seed[12:16])[0]
    assert length == len(seed)
    root = json.loads(seed[20 : 20 + text])
    view = root["bufferViews"][root["images"][0]["bufferView"]]
    assert seed[28 + text :][view["byteOffset"] :][: view["byteLength"]] == b"abc"


def test_scenes_have_many_parts_of_each_kind(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", ["fuzz_seeds.py", str(tmp_path), "--scenes"])
    fuzz_seeds.main()
    texts = [path.read_text(encoding="utf-8") for path in tmp_path.iterdir()]
    assert len(texts) > 90
    for part in fuzz_seeds.PARTS:
        last = re.split("[#@]", part.strip("\n\r").splitlines()[-1])[0]
        assert any(text.count(last) >= 30 for text in texts), part
    files = [file for text in texts for file in text.split(fuzz_seeds.FILE)]
    assert sum("1.toml" in file for file in files) >= 10, "scenes that are placed place others"
    for file in files:
        if "y0" not in file:  # a carriage return alone is no TOML
            assert tomllib.loads(file.lstrip("\ufeff"))["version"] == 1
