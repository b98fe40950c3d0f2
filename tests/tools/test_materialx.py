"""MaterialX documents beside a stage: node graphs of textures, and unreadable parts."""

import math
import os
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from material_stages import MESH, material, noise, pixels, save
from read_converted import Converted, convert_text
from reflet_usd import materialx_document
from tampering import expect_found, look
from texts import fill, text_of, texts_of

pytest.importorskip("MaterialX", reason="the Python package MaterialX is not installed")

STAGE = """
def Scope "Looks" (prepend references = @./look.mtlx@</MaterialX/Materials>) {{}}
{mesh}
"""
BOUND = STAGE.format(mesh=fill(MESH, body="").replace("</Mat>", "</Looks/M>"))
IMAGE = """<image name="{name}" type="{kind}">
    <input name="file" type="filename" value="{file}" colorspace="{space}" /></image>"""


def document(surface: str, nodes: str = "", head: str = "") -> str:
    """A document with the material M."""
    return text_of("materialx/document.mtlx", head=head, nodes=nodes, surface=surface)


def surface(kind: str = "standard_surface", **inputs: str) -> str:
    """A surface node; values are "type value", or "type @node" for the output of the graph."""
    text = f'<{kind} name="S" type="surfaceshader">'
    for name, stated in inputs.items():
        of_type, value = stated.split(" ", 1)
        how = f'nodegraph="G" output="{value[1:]}"' if value[0] == "@" else f'value="{value}"'
        text += f'<input name="{name}" type="{of_type}" {how} />'
    return f"{text}</{kind}>"


def image(name: str, kind: str = "color3", file: str = "t.png", space: str = "srgb_texture") -> str:
    return IMAGE.format(name=name, kind=kind, file=file, space=space)


def output(kind: str, node: str, end: str = "") -> str:
    named = f'output="{end}"' if end else ""
    return f'<output name="o" type="{kind}" nodename="{node}" {named} />'


def convert(folder: Path, text: str) -> Converted:
    (folder / "look.mtlx").write_text(text)
    return convert_text(folder, BOUND)


def proven(folder: Path, text: str) -> dict[str, Any]:
    """The glTF material, after the independent check of the file against the stage."""
    if not (folder / "t.png").exists():
        save(folder, "t.png", noise("RGBA", (16, 8)))
    done = convert(folder, text)
    assert "material-unsupported" not in done.warnings()
    expect_found(done, look(baseColorFactor=[0.03, 0.9, 0.5, 0.7]))
    return material(done)


def test_images_and_constants_of_a_document(tmp_path: Path) -> None:
    nodes = text_of("materialx/images_and_constants.mtlx")
    (tmp_path / "tex").mkdir()
    jpeg = save(tmp_path / "tex", "c.jpg", noise("RGB", (16, 16)))
    save(tmp_path / "tex", "r.png", noise("L", (16, 16), 1))
    save(tmp_path / "tex", "n.png", noise("RGB", (16, 16), 2))
    look_of = surface(
        base_color="color3 @c", specular_roughness="float @r_out", normal="vector3 @n_out"
    )
    done = convert(tmp_path, document(look_of, nodes, 'fileprefix="tex/"')).proven()
    assert done.warnings() == {"material-approximated"}
    entry = material(done)
    assert entry["normalTexture"]["scale"] == 0.5
    assert entry["pbrMetallicRoughness"]["metallicFactor"] == 0.0
    assert jpeg in done.out.read_bytes()
    assert {Path(file).name for file in done.sidecar["files"]} >= {"look.mtlx", "c.jpg"}


COLOR = '<input name="in{n}" type="color3" {value} />'
GRAPHS = texts_of("materialx/graphs")


@pytest.mark.parametrize("graph", list(GRAPHS))
def test_arithmetic_of_one_texture_is_carried(tmp_path: Path, graph: str) -> None:
    text = document(
        surface(base_color="color3 @o"), image("i") + GRAPHS[graph] + output("color3", "x")
    )
    entry = proven(tmp_path, text)
    assert "baseColorTexture" in entry["pbrMetallicRoughness"]


def test_modulo_takes_whole_parts_away(tmp_path: Path) -> None:
    number = '<input name="in1" type="color3" value="-0.25, 0.25, 1.5" />'
    nodes = f'<modulo name="x" type="color3">{number}</modulo>' + output("color3", "x")
    done = convert(tmp_path, document(surface(base_color="color3 @o"), nodes))
    color = material(done)["pbrMetallicRoughness"]["baseColorFactor"]
    assert color[:3] == pytest.approx([0.75, 0.25, 0.5])


PLACES = {
    "place2d": text_of("materialx/place2d.mtlx"),
    "chain": text_of("materialx/chain.mtlx"),
}


@pytest.mark.parametrize("place", list(PLACES))
def test_coordinates_become_a_texture_transform(tmp_path: Path, place: str) -> None:
    nodes = (
        '<geompropvalue name="u" type="vector2"><input name="geomprop" type="string" value="st" />'
        f"</geompropvalue>{PLACES[place]}"
        + image("i").replace(
            "</image>", '<input name="texcoord" type="vector2" nodename="p" /></image>'
        )
        + output("color3", "i")
    )
    entry = proven(tmp_path, document(surface(base_color="color3 @o"), nodes))
    info = entry["pbrMetallicRoughness"]["baseColorTexture"]
    assert {"scale", "rotation", "offset"} == set(info["extensions"]["KHR_texture_transform"])


def test_a_gltf_image_is_placed_as_gltf_places_it(tmp_path: Path) -> None:
    nodes = text_of("materialx/a_gltf_image_is_placed_as_gltf_places_it.mtlx")
    look_of = surface("gltf_pbr", base_color="color3 @o", metallic="float 0")
    text = document(look_of, nodes + output("color3", "i", "outcolor"))
    entry = proven(tmp_path, text)
    found = entry["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"]
    assert found["offset"] == pytest.approx([0.25, 0.5])
    assert found["scale"] == pytest.approx([2, 3])
    assert abs(found["rotation"]) == pytest.approx(np.radians(20))
    assert entry["pbrMetallicRoughness"]["baseColorFactor"] == pytest.approx([0.5, 1, 1, 1])


def test_layers_of_a_standard_surface(tmp_path: Path) -> None:
    look_of = surface(
        base_color="color3 1, 0.5, 0.25",
        base="float 0.5",
        coat="float 0.5",
        coat_color="color3 0.5, 1, 1",
        coat_IOR="float 2",
        diffuse_roughness="float 0.5",
        specular="float 0.4",
        specular_color="color3 1, 0.5, 0.5",
        transmission="float 0.75",
        transmission_color="color3 0.2, 0.4, 0.8",
        transmission_depth="float 3",
        sheen="float 0.5",
        sheen_color="color3 1, 1, 0",
        thin_film_thickness="float 400",
        specular_anisotropy="float 0.5",
    )
    extensions = proven(tmp_path, document(look_of))["extensions"]
    assert extensions["KHR_materials_volume"] == {
        "thicknessFactor": 1.0,
        "attenuationColor": pytest.approx([0.2, 0.4, 0.8]),
        "attenuationDistance": pytest.approx(3.0),
    }
    assert extensions["KHR_materials_transmission"] == {"transmissionFactor": 0.75}
    assert extensions["KHR_materials_diffuse_roughness"] == {"diffuseRoughnessFactor": 0.5}
    within = extensions["KHR_materials_clearcoat"]["extensions"]
    assert within == {"KHR_materials_clearcoat_ior": {"clearcoatIor": 2.0}}
    assert extensions["KHR_materials_sheen"]["sheenColorFactor"] == [0.5, 0.5, 0.0]
    assert extensions["KHR_materials_iridescence"]["iridescenceThicknessMaximum"] == 400.0
    assert 0.0 < extensions["KHR_materials_anisotropy"]["anisotropyStrength"] < 1.0


@pytest.mark.parametrize(
    ("kind", "inputs", "tint"),
    [
        ("open_pbr_surface", {"specular_color": "color3 0.5, 0.75, 1"}, [0.5, 0.75, 1.0]),
        ("open_pbr_surface", {}, None),
        # Titanium, 2.7 + 3.4i: the edge is (nmax - n) / (nmax - nmin) of 7.214 and 0.272.
        ("standard_surface", {"base": "float 0.5723", "specular": "float 0.65"}, [0.776] * 3),
    ],
)
def test_metals_are_tinted_at_their_edges(
    tmp_path: Path, kind: str, inputs: dict[str, str], tint: list[float] | None
) -> None:
    metal = "base_metalness" if kind == "open_pbr_surface" else "metalness"
    white = {metal: "float 1", "base_color": "color3 1, 1, 1"}
    entry = proven(tmp_path, document(surface(kind, **white, **inputs)))
    lobe = entry.get("extensions", {}).get("KHR_materials_specular")
    assert (lobe and lobe["specularColorFactor"]) == (tint and pytest.approx(tint, abs=2e-3))
    edges = {"EXT_materials_specular_edge_color": {"specularEdgeColorEnabled": True}}
    assert (lobe and lobe["extensions"]) == (tint and edges)


@pytest.mark.parametrize(("metalness", "is_named"), [("0", False), ("0.5", True)])
def test_a_dim_metal_of_openpbr_is_named(tmp_path: Path, metalness: str, is_named: bool) -> None:
    dim = {"base_metalness": f"float {metalness}", "specular_weight": "float 0.5"}
    done = convert(tmp_path, document(surface("open_pbr_surface", **dim)))
    [said] = done.sidecar["warnings"]
    assert ("specular_weight of metal" in said["message"]) == is_named


OPEN_WALL = {"subsurface_weight": "float 0.6", "geometry_thin_walled": "boolean true"}
WALL = {"subsurface": "float 0.6", "thin_walled": "boolean true", "coat": "float 1"}


@pytest.mark.parametrize(
    ("inputs", "through", "base", "is_clamped"),
    [
        (OPEN_WALL, 0.3, 0.8 - 0.6 * 3 / 7, False),
        (OPEN_WALL | {"subsurface_scatter_anisotropy": "float -1"}, 0.0, 0.44, False),
        (OPEN_WALL | {"subsurface_scatter_anisotropy": "float 3"}, 0.6, 0.8, True),
        (OPEN_WALL | {"subsurface_weight": "float 2"}, 0.5, 0.2, True),
        (WALL | {"coat_color": "color3 0.5, 0.5, 0.5"}, 0.6, 0.4, False),
    ],
)
def test_thin_walls_pass_diffuse_light(
    tmp_path: Path, inputs: dict[str, str], through: float, base: float, is_clamped: bool
) -> None:
    kind = "standard_surface" if "coat" in inputs else "open_pbr_surface"
    colors = {"base_color": "color3 0.8, 0.8, 0.8", "subsurface_color": "color3 0.2, 0.2, 0.2"}
    done = convert(tmp_path, document(surface(kind, **colors, **inputs))).proven()
    assert ("material-value-clamped" in done.warnings()) == is_clamped
    entry = material(done)
    name, color = "diffuseTransmission", 0.1 if "coat" in inputs else 0.2
    fields = {f"{name}Factor": through, f"{name}ColorFactor": pytest.approx([color] * 3)}
    found = entry.get("extensions", {}).get("KHR_materials_diffuse_transmission")
    assert found == (pytest.approx(fields) if through else None)
    assert entry["pbrMetallicRoughness"]["baseColorFactor"] == pytest.approx([base] * 3 + [1])


WAX = {"subsurface_weight": "float 0.75", "subsurface_radius": "float 0.5"}
SKIN = {"subsurface": "float 0.75", "subsurface_radius": "color3 1, 0.5, 0.25", "coat": "float 1"}


@pytest.mark.parametrize(
    ("inputs", "color"),
    [
        (WAX | {"subsurface_scatter_anisotropy": "float 0.25"}, [0.8, 0.5, 0.25]),
        (SKIN | {"subsurface_scale": "float 0.5", "subsurface_anisotropy": "float 0.25"}, None),
        (WAX | {"subsurface_radius": "float 0"}, []),
        (WAX | {"transmission_weight": "float 0.5"}, []),
    ],
)
def test_solids_scatter_light_within(
    tmp_path: Path, inputs: dict[str, str], color: list[float] | None
) -> None:
    kind = "standard_surface" if "coat" in inputs else "open_pbr_surface"
    colors = {"subsurface_color": "color3 0.8, 0.5, 0.25", "coat_color": "color3 0.5, 0.5, 0.5"}
    done = convert(tmp_path, document(surface(kind, **colors, **inputs))).proven()
    found = material(done).get("extensions", {})
    if color == []:
        assert "KHR_materials_volume_scatter" not in found
        return
    assert found["KHR_materials_volume_scatter"] == {
        "multiscatterColor": pytest.approx(color or [0.4, 0.25, 0.125]),
        "scatterAnisotropy": 0.25,
    }
    assert found["KHR_materials_volume"] == {
        "thicknessFactor": 1.0,
        "attenuationColor": pytest.approx([math.exp(-1.0), math.exp(-2.0), math.exp(-4.0)]),
        "attenuationDistance": pytest.approx(0.5),
    }
    assert found["KHR_materials_diffuse_transmission"]["diffuseTransmissionFactor"] == 0.75


def test_layers_of_gltf_pbr_are_carried_without_a_word(tmp_path: Path) -> None:
    inputs = {
        "transmission": "float 0.5",
        "thickness": "float 0.25",
        "attenuation_distance": "float 2",
        "attenuation_color": "color3 0.5, 1, 0.5",
        "sheen_color": "color3 0.5, 0, 0",
        "sheen_roughness": "float 0.3",
        "iridescence": "float 0.5",
        "alpha": "float 0.4",
        "alpha_mode": "integer 1",
        "alpha_cutoff": "float 0.3",
    }
    done = convert(tmp_path, document(surface("gltf_pbr", **inputs))).proven()
    assert done.warnings() == set()
    entry = material(done)
    assert (entry["alphaMode"], entry["alphaCutoff"]) == ("MASK", pytest.approx(0.3))
    assert entry["extensions"]["KHR_materials_volume"]["attenuationDistance"] == 2.0


def test_a_lost_or_an_invented_layer_is_found(tmp_path: Path) -> None:
    look_of = document(surface(transmission="float 1"))

    def opaque(out: Any) -> None:
        del out.gltf.materials[0].extensions["KHR_materials_transmission"]

    expect_found(convert(tmp_path, look_of), opaque)

    def translucent(out: Any) -> None:
        fields = {"diffuseTransmissionFactor": 0.9}
        out.gltf.materials[0].extensions["KHR_materials_diffuse_transmission"] = fields

    expect_found(convert(tmp_path, look_of), translucent)


UNFIT = texts_of("materialx/unfit") | {
    "deep": "".join(
        f'<invert name="{"x" if n == 0 else f"x{n}"}" type="color3">'
        f'<input name="in" type="color3" nodename="x{n + 1}" /></invert>'
        for n in range(500)
    )
}


@pytest.mark.parametrize("graph", list(UNFIT))
def test_a_node_without_counterpart_is_named_with_its_material(tmp_path: Path, graph: str) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    save(tmp_path, "u.png", noise("RGB", seed=1))
    nodes = image("i") + image("j", file="u.png") + UNFIT[graph] + output("color3", "x")
    done = convert(tmp_path, document(surface(base_color="color3 @o"), nodes)).proven()
    told = [w for w in done.sidecar["warnings"] if w["name"] == "material-unsupported"]
    assert told and all(w["prim"].startswith("/Looks/M/G/") for w in told)


def test_values_beyond_single_precision_are_left_out(tmp_path: Path) -> None:
    nodes = text_of("materialx/beyond_single_precision.mtlx")
    save(tmp_path, "t.png", noise("RGB"))
    look_of = surface(base_color="color3 @o", emission="float 1", emission_color="color3 @e")
    done = convert(tmp_path, document(look_of, nodes))
    assert {"uv-transform-dropped", "material-unsupported"} <= done.warnings()


def test_a_graph_of_shared_nodes_is_walked_once(tmp_path: Path) -> None:
    """Each of 50 nodes reads its predecessor twice: 2⁵⁰ ways lead to the image."""
    nodes = image("x0") + "".join(
        f'<mix name="x{n + 1}" type="color3"><input name="fg" type="color3" nodename="x{n}" />'
        f'<input name="bg" type="color3" nodename="x{n}" />'
        '<input name="mix" type="float" value="0.5" /></mix>'
        for n in range(50)
    )
    save(tmp_path, "t.png", noise("RGB"))
    done = convert(
        tmp_path, document(surface(base_color="color3 @o"), nodes + output("color3", "x50"))
    )
    assert "baseColorTexture" in material(done)["pbrMetallicRoughness"]


INCLUDE = (
    '<?xml version="1.0"?><materialx version="1.38" xmlns:xi="http://www.w3.org/2001/XInclude">'
)
BROKEN = {
    "no XML": ("\0\1\2 <<<", "materialx-unreadable"),
    "empty": ("", "materialx-unreadable"),
    "includes itself": (
        f'{INCLUDE}<xi:include href="look.mtlx" /></materialx>',
        "materialx-unreadable",
    ),
    "includes another's": (
        f'{INCLUDE}<xi:include href="../secret.mtlx" /></materialx>',
        "asset-outside-roots",
    ),
    "includes nothing": (
        f'{INCLUDE}<xi:include href="gone.mtlx" /></materialx>',
        "materialx-unreadable",
    ),
    "no MaterialX": ("<html><body/></html>", "materialx-unreadable"),
}


@pytest.mark.parametrize("case", list(BROKEN))
def test_a_document_that_cannot_be_read_is_named(tmp_path: Path, case: str) -> None:
    text, name = BROKEN[case]
    (tmp_path / "secret.mtlx").write_text(document(surface()))
    folder = tmp_path / "in"
    folder.mkdir()
    done = convert(folder, text)
    assert name in done.warnings("/Looks")
    assert done.json["meshes"]


def test_large_documents_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(materialx_document, "MOST_BYTES", 100)
    assert "materialx-too-large" in convert(tmp_path, document(surface())).warnings("/Looks")
    monkeypatch.setattr(materialx_document, "MOST_BYTES", 1 << 20)
    monkeypatch.setattr(materialx_document, "MOST_NODES", 3)
    nodes = "".join(image(f"i{n}") for n in range(9)) + output("color3", "i0")
    # Only nodes that materials read count.
    text = document(surface(base_color="color3 @o"), nodes)
    assert "materialx-too-large" not in convert(tmp_path, text).warnings()
    monkeypatch.setattr(materialx_document, "MOST_NODES", 1)
    assert "materialx-too-large" in convert(tmp_path, text).warnings("/Looks")


def test_files_outside_the_folder_stay_closed(tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    save(tmp_path, "t.png", noise("RGB"))
    nodes = image("i", file="../t.png") + output("color3", "i")
    done = convert(folder, document(surface(base_color="color3 @o"), nodes))
    assert "asset-outside-roots" in done.warnings("/Looks/M/G/i")
    assert "images" not in done.json
    (tmp_path / "look.mtlx").write_text(document(surface()))
    done = convert_text(folder, BOUND.replace("./look.mtlx", "../look.mtlx"))
    assert "asset-outside-roots" in done.warnings("/Looks")


def test_a_pipe_is_not_opened(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "look.mtlx")
    done = convert_text(tmp_path, BOUND)
    assert "asset-not-a-file" in done.warnings("/Looks")


def test_without_the_library_a_warning_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "MaterialX", None)
    done = convert(tmp_path, document(surface()))
    assert done.warnings("/Looks") == {"materialx-missing"}
    assert "pip install MaterialX" in str(done.sidecar["warnings"])
    assert done.json["meshes"]


def test_nodes_that_a_document_defines_are_followed(tmp_path: Path) -> None:
    nodes = '<half name="h" type="color3"><input name="in" type="color3" value="0.2, 0.4, 0.6" />'
    nodes += "</half>" + output("color3", "h")
    text = text_of("materialx/own.mtlx") + surface(base="float 1", base_color="color3 @o")
    spaced = re.sub(r"<(nodedef|nodegraph) ", r'<\1 namespace="N" ', text)
    for defined, used in ((text, nodes), (spaced, nodes.replace("<half ", '<half namespace="N" '))):
        look = proven(tmp_path, document(defined, used))["pbrMetallicRoughness"]
        assert look["baseColorFactor"][:3] == pytest.approx([0.1, 0.2, 0.3])


def test_patterns_of_coordinates_become_images(tmp_path: Path) -> None:
    nodes = text_of("materialx/checks.mtlx") + output("color3", "c")
    done = convert(
        tmp_path, document(surface(base="float 1", base_color="color3 @o"), nodes)
    ).proven()
    assert "pattern-baked" in done.warnings("/Looks/M/G/c")
    texels = pixels(done, material(done)["pbrMetallicRoughness"]["baseColorTexture"])[..., :3]
    side = len(texels)
    for column, row in ((0, 0), (1, 0), (0, 1), (3, 1)):  # from the lower left
        across, down = int((column + 0.5) / 4 * side), side - 1 - int((row + 0.5) / 2 * side)
        red = 255 * ((column + row) % 2)
        assert texels[down, across].tolist() == [red, 188, 255 - red]


def test_documents_of_named_folders_define_nodes(tmp_path: Path) -> None:
    (tmp_path / "nodes").mkdir()
    plugin = document(text_of("materialx/own.mtlx") + surface())
    (tmp_path / "nodes" / "own.mtlx").write_text(plugin)
    (tmp_path / "nodes" / "broken.mtlx").write_text("<nodedef")
    os.mkfifo(tmp_path / "nodes" / "pipe.mtlx")
    nodes = '<half name="h" type="color3"><input name="in" type="color3" value="0.2, 0.4, 0.6" />'
    nodes += "</half>" + output("color3", "h")
    text = document(surface(base="float 1", base_color="color3 @o"), nodes)
    (tmp_path / "look.mtlx").write_text(text)
    done = convert_text(tmp_path, BOUND, extra_roots=(str(tmp_path / "nodes"),)).proven()
    assert "material-unsupported" not in done.warnings()
    found = material(done)["pbrMetallicRoughness"]["baseColorFactor"][:3]
    assert found == pytest.approx([0.1, 0.2, 0.3])
    without = convert_text(tmp_path, BOUND)
    assert "material-unsupported" in without.warnings()
