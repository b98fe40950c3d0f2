"""Damaged outputs of stages without warnings: surplus content of a file is found."""

import json
from pathlib import Path
from typing import Any

import pytest
from material_stages import noise, save, texture
from material_stages import stage as material_stage
from read_converted import Converted, convert_text
from tampering import FACE, UNIT
from texts import text_of

KHR = "KHR_materials_"
SETS = text_of("validate_strict/sets.usda")
STAGE = (
    text_of("validate_strict/stage.usda", FACE=FACE)
    + UNIT
    + material_stage(
        "color3f inputs:diffuseColor.connect = </Mat/T.outputs:rgb>", texture("T", "t.png"), SETS
    )
)
Tree = dict[str, Any]


def look(tree: Tree, named: str) -> Tree:
    """The material of that name."""
    return next(entry for entry in tree["materials"] if entry["name"] == named)


def attributes(tree: Tree, named: str) -> Tree:
    """The attributes of the mesh of that name."""
    mesh = next(entry for entry in tree["meshes"] if entry["name"] == named)
    found: Tree = mesh["primitives"][0]["attributes"]
    return found


def node(tree: Tree, named: str) -> Tree:
    """The node of that name."""
    return next(entry for entry in tree["nodes"] if entry["name"] == named)


def extend(tree: Tree, named: str, extension: str, **values: Any) -> None:
    """Damage: give a material one more extension."""
    look(tree, named).setdefault("extensions", {})[KHR + extension] = values
    tree.setdefault("extensionsUsed", []).append(KHR + extension)


def point(tree: Tree, pointer: str) -> None:
    """Damage: let the animation also move what `pointer` names."""
    extension = {"KHR_animation_pointer": {"pointer": pointer}}
    channel = {"sampler": 0, "target": {"path": "pointer", "extensions": extension}}
    tree["animations"][0]["channels"].append(channel)


def swap(values: Tree, first: str, second: str) -> None:
    """Damage: exchange two attributes."""
    values[first], values[second] = values[second], values[first]


def lose_locator(tree: Tree) -> None:
    """Damage: remove a node that draws nothing, and its animation."""
    del tree["animations"]
    gone = tree["nodes"].index(node(tree, "Locator"))
    for entry in tree["nodes"]:
        if gone in entry.get("children", []):
            entry["children"].remove(gone)


def told(tree: Tree) -> Tree:
    """The facts about the stage in the scene's extras."""
    found: Tree = tree["scenes"][0]["extras"]["usd"]
    return found


def plain(**values: Any) -> Any:
    """Damage: change fields of the displayColor material."""
    return lambda t: look(t, "displayColor").update(values)


DAMAGES = {
    "unlit": lambda t: extend(t, "Mat", "unlit"),
    "transmission": lambda t: extend(t, "Mat", "transmission", transmissionFactor=1),
    "specular": lambda t: extend(t, "Mat", "specular", specularFactor=0),
    "specular color": lambda t: extend(t, "Mat", "specular", specularColorFactor=[0, 0, 0]),
    "coat normal": lambda t: extend(
        t, "Mat", "clearcoat", clearcoatFactor=0, clearcoatNormalTexture={"index": 0}
    ),
    "plain ior": lambda t: extend(t, "displayColor", "ior", ior=2),
    "plain coat": lambda t: extend(t, "displayColor", "clearcoat", clearcoatFactor=1),
    "plain shine": plain(emissiveFactor=[1, 1, 1]),
    "plain mask": plain(alphaMode="MASK", alphaCutoff=2.0),
    "plain blend": plain(alphaMode="BLEND"),
    "plain metal": lambda t: look(t, "displayColor")["pbrMetallicRoughness"].update(
        metallicFactor=1.0
    ),
    "normal map": lambda t: look(t, "Mat").update(normalTexture={"index": 0}),
    "occlusion": lambda t: look(t, "Mat").update(occlusionTexture={"index": 0}),
    "emission": lambda t: look(t, "Mat").update(emissiveTexture={"index": 0}),
    "vertex colors": lambda t: attributes(t, "M").update(COLOR_0=attributes(t, "M")["NORMAL"]),
    "no material": lambda t: t["meshes"][0]["primitives"][0].pop("material"),
    "wrap": lambda t: t["samplers"][0].update(wrapS=33648),
    "locator": lose_locator,
    "unknown prim": lambda t: node(t, "Locator")["extras"].update(prim="/World/Nope"),
    "pointer": lambda t: point(t, "/materials/0/emissiveFactor"),
    "twice": lambda t: t["animations"][0]["channels"].append(t["animations"][0]["channels"][0]),
    "two animations": lambda t: t["animations"].append(t["animations"][0]),
    "range": lambda t: t["extensions"]["KHR_lights_punctual"]["lights"][0].update(range=0.1),
    "set gone": lambda t: attributes(t, "M").pop("TEXCOORD_1"),
    "set copied": lambda t: attributes(t, "Plain").update(
        TEXCOORD_1=attributes(t, "Plain")["TEXCOORD_0"]
    ),
    "sets swapped": lambda t: swap(attributes(t, "Plain"), "TEXCOORD_0", "TEXCOORD_1"),
    "primvar gone": lambda t: attributes(t, "M").pop("_HEAT"),
    "origin": lambda t: told(t).update(timeOrigin=5.0),
    "rate": lambda t: told(t).update(timeCodesPerSecond=5.0),
    "sky": lambda t: told(t).update(domeRadiance=[5.0, 5.0, 5.0]),
    "no extras": lambda t: t["scenes"][0].pop("extras"),
    "words gone": lambda t: node(t, "Locator")["extras"].pop("userProperties"),
    "words changed": lambda t: node(t, "Locator")["extras"]["attributes"].update(mine=4),
    "words added": lambda t: node(t, "Locator")["extras"]["attributes"].update(more=4),
    "collection": lambda t: node(t, "Locator")["extras"].update(
        collections={"all": {"includes": ["/World"]}}
    ),
}


def expect_tree_found(done: Converted, tree: Tree) -> None:
    """Write the file with another JSON tree, and assert that the validator finds the damage."""
    data = done.out.read_bytes()
    rest = data[20 + int.from_bytes(data[12:16], "little") :]
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    sizes = [2, 20 + len(text) + len(rest), len(text)]
    head = b"glTF" + b"".join(size.to_bytes(4, "little") for size in sizes) + b"JSON"
    done.out.write_bytes(head + text + rest)
    assert not done.validated().passed


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> tuple[Converted, bytes]:
    """The stage's file, and its bytes."""
    folder = tmp_path_factory.mktemp("strict")
    save(folder, "t.png", noise("RGB", (64, 64)))
    done = convert_text(folder, STAGE).proven()
    return done, done.out.read_bytes()


@pytest.mark.parametrize("name", DAMAGES)
def test_what_the_stage_does_not_say_is_found(good: tuple[Converted, bytes], name: str) -> None:
    done, data = good
    done.out.write_bytes(data)
    tree = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
    DAMAGES[name](tree)
    expect_tree_found(done, tree)


def test_every_texel_counts(tmp_path: Path) -> None:
    picture = noise("RGB", (64, 64))
    save(tmp_path, "t.png", picture)
    done = convert_text(tmp_path, STAGE)
    picture = picture.copy()
    picture[7, 40] ^= 128
    save(tmp_path, "t.png", picture)
    assert not done.validated().passed


def test_what_a_factor_of_zero_hides_may_differ(tmp_path: Path) -> None:
    save(tmp_path, "t.png", noise("RGB", (16, 16)))
    raw = texture("T", "t.png", 'token inputs:sourceColorSpace = "raw"')
    convert_text(
        tmp_path, material_stage("float inputs:roughness.connect = </Mat/T.outputs:g>", raw)
    ).proven()
