"""tools/gltf_corpus.py: which root files count, and the page about them."""

import json
import pathlib
import struct

import gltf_corpus
import pytest
import tomllib
from gltf_corpus import Looks, Root

PLACED = {
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
}


@pytest.mark.parametrize(
    ("root", "expected"),
    [
        (PLACED, True),
        (PLACED | {"scenes": []}, False),
        (PLACED | {"nodes": [{}]}, False),
        (PLACED | {"meshes": [{"primitives": [{"attributes": {"NORMAL": 0}}]}]}, False),
        ({}, False),
    ],
)
def test_a_root_has_a_mesh_where_a_node_places_one(
    tmp_path: pathlib.Path, root: dict[str, object], expected: bool
) -> None:
    text = json.dumps(root).encode()
    plain, binary = tmp_path / "m.gltf", tmp_path / "m.glb"
    plain.write_bytes(text)
    head = struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text), len(text), b"JSON")
    binary.write_bytes(head + text + b"a chunk that is no JSON")
    assert gltf_corpus.has_mesh(plain) == gltf_corpus.has_mesh(binary) == expected


def test_the_page_names_what_is_not_right() -> None:
    picture = pathlib.Path("x.png")
    roots = [
        Root("a/right.gltf", True, picture=picture),
        Root("a/wrong.gltf", True, picture=picture),
        Root("a/lost.gltf", True, refused="gltf-index"),
        Root("a/later.gltf", True, refused="gltf-version"),
        Root("b/empty.gltf", True, has_mesh=False, refused="nothing-to-show"),
        Root("b/odd.gltf", True, has_mesh=False, refused="gltf-json"),
        Root("b/broken.gltf", False, has_mesh=False, refused="gltf-json"),
    ]
    looks = Looks({"a/wrong.gltf": "too dark"}, {"a/later.gltf": "needs glTF 3"})
    text = gltf_corpus.table(roots, looks)
    assert "1 of 3 valid roots with something to show (33.3%)" in text
    assert "1 of 2 place no mesh" in text
    assert "a/later.gltf (needs glTF 3)" in text
    for line in (
        "| a/wrong.gltf | too dark |",
        "| a/lost.gltf | not shown: `gltf-index` |",
        "| all | 7 | 6 | 3 | 2 | 1 | 1 of 1 |",
    ):
        assert line in text


def test_what_no_longer_is_so_is_named_and_left_out(capsys: pytest.CaptureFixture[str]) -> None:
    listed = tomllib.loads(gltf_corpus.LOOKS.read_text(encoding="utf-8"))
    picture = pathlib.Path("x.png")
    roots = [Root(file, True, picture=picture) for file in (*listed["wrong"], *listed["refused"])]
    looks = gltf_corpus.read_looks(roots)
    assert (looks.wrong, looks.refused) == (listed["wrong"], {})
    said = capsys.readouterr().err
    assert all(file in said for file in listed["refused"])
