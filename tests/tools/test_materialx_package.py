"""MaterialX documents within usdz packages, read like documents beside a stage."""

import zipfile
from pathlib import Path

import pytest
from material_stages import MESH, material, noise, save
from read_converted import Converted
from reflet_usd import materialx_document
from reflet_usd.validate.validation import validate_file
from texts import fill, text_of

pytest.importorskip("MaterialX", reason="the Python package MaterialX is not installed")

HEAD = '#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = "Y"\n)\n'
LOOKS = 'def Scope "Looks" (prepend references = @{document}@</MaterialX/Materials>) {{}}\n'
BOUND = fill(MESH, body="").replace("</Mat>", "</Looks/M>")
STAGE = HEAD + LOOKS.format(document="./looks/look.mtlx") + BOUND
DOCUMENT = text_of("materialx_package/document.mtlx")
GRAPH = text_of("materialx_package/graph.mtlx")


def files(folder: Path) -> dict[str, str | bytes]:
    """Files of a package: its stage, a document, the graph that it includes, and an image."""
    return {
        "stage.usda": STAGE,
        "looks/look.mtlx": DOCUMENT,
        "graphs/graph.mtlx": GRAPH,
        "textures/t.png": save(folder, "noise.png", noise("RGB", (16, 8))),
    }


def packed(path: Path, entries: dict[str, str | bytes], kind: int = zipfile.ZIP_STORED) -> Path:
    """A package of these files, of which all but the first are stored as `kind` says."""
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in entries.items():
            stored = kind if archive.filelist else zipfile.ZIP_STORED
            archive.writestr(name, text, stored)
    return path


def proven(stage: Path) -> Converted:
    """The converted stage, after the independent check of the file against it."""
    done = Converted(stage, stage.with_suffix(".glb"))
    assert validate_file(done.out, stage, khronos=False).passed
    return done


def test_a_packed_stage_becomes_what_the_unpacked_one_does(tmp_path: Path) -> None:
    entries = files(tmp_path)
    (tmp_path / "plain").mkdir()
    for name, text in entries.items():
        path = tmp_path / "plain" / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
    plain = proven(tmp_path / "plain" / "stage.usda")
    done = proven(packed(tmp_path / "a.usdz", entries))
    assert done.warnings() == plain.warnings() == {"material-approximated"}
    assert done.json["materials"] == plain.json["materials"]
    assert material(done)["pbrMetallicRoughness"]["roughnessFactor"] == pytest.approx(0.25)
    assert entries["textures/t.png"] in done.out.read_bytes()
    assert {Path(file).name for file in done.sidecar["files"]} == {"a.usdz"}
    other = entries | {"looks/look.mtlx": DOCUMENT.replace('value="0.25"', 'value="0.75"')}
    against = packed(tmp_path / "other.usdz", other)
    assert not validate_file(done.out, against, khronos=False).passed


def test_layers_and_packages_within_a_package_reach_their_documents(tmp_path: Path) -> None:
    inner = HEAD + 'def Xform "A" {\n' + LOOKS.format(document="../looks/look.mtlx")
    inner += BOUND.replace("</Looks/M>", "</A/Looks/M>") + "}\n"
    outer = HEAD + 'def Xform "B" (prepend references = @./sub/geo.usda@</A>) {}\n'
    entries = {"stage.usda": outer, "sub/geo.usda": inner} | files(tmp_path)
    entries["stage.usda"] = outer
    first = packed(tmp_path / "first.usdz", entries)
    assert "baseColorTexture" in material(proven(first))["pbrMetallicRoughness"]
    around = HEAD + 'def Xform "C" (prepend references = @./first.usdz@</B>) {}\n'
    nested = {"stage.usda": around, "first.usdz": first.read_bytes()}
    second = packed(tmp_path / "second.usdz", nested)
    first.unlink()
    assert "baseColorTexture" in material(proven(second))["pbrMetallicRoughness"]


def test_a_stage_reaches_a_document_of_a_package(tmp_path: Path) -> None:
    packed(tmp_path / "looks.usdz", files(tmp_path))
    stage = tmp_path / "stage.usda"
    stage.write_text(HEAD + LOOKS.format(document="./looks.usdz[looks/look.mtlx]") + BOUND)
    assert "baseColorTexture" in material(proven(stage))["pbrMetallicRoughness"]
    (tmp_path / "in").mkdir()
    inside = tmp_path / "in" / "stage.usda"
    inside.write_text(HEAD + LOOKS.format(document="../looks.usdz[looks/look.mtlx]") + BOUND)
    assert "asset-outside-roots" in proven(inside).warnings("/Looks")


INCLUDE = '<materialx version="1.38" xmlns:xi="http://www.w3.org/2001/XInclude">'
UNREAD = {
    "no XML": "\0\1\2 <<<",
    "includes itself": f'{INCLUDE}<xi:include href="look.mtlx" /></materialx>',
    "includes what is outside": f'{INCLUDE}<xi:include href="../../out.mtlx" /></materialx>',
    "includes an absolute path": f'{INCLUDE}<xi:include href="/dev/zero" /></materialx>',
}


@pytest.mark.parametrize("case", list(UNREAD))
def test_a_packed_document_that_cannot_be_read_is_named(tmp_path: Path, case: str) -> None:
    (tmp_path / "out.mtlx").write_text(DOCUMENT)
    entries = files(tmp_path) | {"looks/look.mtlx": UNREAD[case]}
    done = proven(packed(tmp_path / "a.usdz", entries))
    assert "materialx-unreadable" in done.warnings("/Looks")
    assert done.json["meshes"]


def test_packed_documents_have_the_limits_of_plain_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(materialx_document, "MOST_BYTES", 100)
    done = proven(packed(tmp_path / "a.usdz", files(tmp_path)))
    assert "materialx-too-large" in done.warnings("/Looks")


def test_a_compressed_document_is_named(tmp_path: Path) -> None:
    stage = packed(tmp_path / "a.usdz", files(tmp_path), zipfile.ZIP_DEFLATED)
    assert "materialx-unreadable" in proven(stage).warnings("/Looks")


def test_images_stay_in_their_package(tmp_path: Path) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    for place in ("../../", f"{tmp_path}/"):
        entries = files(tmp_path) | {"graphs/graph.mtlx": GRAPH.replace("../textures/", place)}
        done = proven(packed(tmp_path / "a.usdz", entries))
        assert "texture-missing" in done.warnings("/Looks/M/G/i")
        assert "images" not in done.json
