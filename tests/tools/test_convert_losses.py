"""Owns the tests that metadata, schemas and links are kept in extras or named by warnings."""

from pathlib import Path

import numpy as np
from material_stages import noise, save, shaded, texture
from read_converted import Converted, convert_text
from texts import text_of


def messages(done: Converted, name: str) -> dict[str, str]:
    """Message of each warning of that name, by prim."""
    found = [w for w in done.sidecar["warnings"] if w["name"] == name]
    assert len({w["prim"] for w in found}) == len(found), "once for each prim"
    return {w["prim"]: w["message"] for w in found}


def test_applied_schemas_are_named_once_for_each_prim(tmp_path: Path) -> None:
    text = text_of("convert_losses/applied_schemas_are_named_once_for_each_prim.usda")
    done = convert_text(tmp_path, text)
    found = messages(done, "schema-ignored")
    assert set(found) == {"/C"}
    names = ["PhysicsRigidBodyAPI", "PhysicsMassAPI", "CoordSysAPI:c", "MotionAPI"]
    for name in (*names, "VisibilityAPI", "UnheardOfAPI"):
        assert f"'{name}'" in found["/C"]
    assert "MaterialBindingAPI" not in found["/C"]


def test_metadata_is_kept_in_extras(tmp_path: Path) -> None:
    text = text_of("convert_losses/metadata_is_kept_in_extras.usda")
    done = convert_text(tmp_path, text)
    assert done.warnings() == set()
    extras = done.json["nodes"][done.node("/A")]["extras"]
    assert extras["metadata"] == {
        "kind": "component",
        "displayName": "Die Säule",
        "assetInfo": {"identifier": "a.usd", "name": "a"},
        "customData": {
            "count": 3,
            "on": True,
            "tags": ["x", "y"],
            "place": np.eye(4).tolist(),
        },
    }
    assert "metadata" not in done.json["nodes"][done.node("/A/C")]["extras"]
    assert done.json["scenes"][0]["extras"]["metadata"] == {
        "documentation": "the whole",
        "customLayerData": {"camera": {"at": [1, 2, 3]}, "tool": "hand"},
    }


def test_metadata_without_a_place_is_named_once(tmp_path: Path) -> None:
    many = ", ".join("0" for _ in range(2000))
    deep = "dictionary d = { " * 12 + "int leaf = 1" + " }" * 12
    text = text_of(
        "convert_losses/metadata_without_a_place_is_named_once.usda", many=many, deep=deep
    )
    done = convert_text(tmp_path, text)
    found = messages(done, "metadata-dropped")
    assert set(found) == {"/C", "/M"}
    for name in ("customData:bad", "customData:many", "customData:d:d:d:d:d:d:d:d"):
        assert f"'{name}" in found["/C"]
    assert "good" not in found["/C"]
    assert "'kind', 'customData' are not carried" in found["/M"]
    kept = done.json["nodes"][done.node("/C")]["extras"]["metadata"]["customData"]
    assert kept["good"] == 1
    assert "bad" not in kept and "many" not in kept


def test_volumes_say_what_is_lost(tmp_path: Path) -> None:
    done = convert_text(tmp_path, text_of("convert_losses/volume.usda"))
    assert "('density' @./smoke.vdb@, 'heat')" in messages(done, "Volume-dropped")["/V"]
    assert "of a volume" in messages(done, "OpenVDBAsset-dropped")["/V/Smoke"]
    assert "1 Volume" in messages(done, "stage-empty")["/"]


def test_recoded_texels_are_named(tmp_path: Path) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    for slot, space, named in (
        ("roughness", "sRGB", "sRGB to linear"),
        ("roughness", "raw", None),
        ("emissiveColor", "raw", "linear to sRGB"),
        ("emissiveColor", "sRGB", None),
    ):
        output, kind = ("rgb", "color3f") if slot == "emissiveColor" else ("b", "float")
        inputs = f"{kind} inputs:{slot}.connect = </Mat/T.outputs:{output}>"
        nodes = texture("T", "t.png", f'token inputs:sourceColorSpace = "{space}"')
        found = messages(shaded(tmp_path, inputs, nodes), "texture-repacked")
        assert set(found) == (set() if named is None else {"/Mat/T"})
        assert named is None or named in found["/Mat/T"]


def test_collections_that_nothing_reads_are_kept_or_named(tmp_path: Path) -> None:
    many = ", ".join(f"</W/C{number}>" for number in range(65))
    text = text_of(
        "convert_losses/collections_that_nothing_reads_are_kept_or_named.usda", many=many
    )
    done = convert_text(tmp_path, text)
    extras = done.gltf.nodes[done.node("/W")].extras
    assert extras["collections"] == {
        "pattern": {"membershipExpression": "/W//C*"},
        "render:all": {
            "excludes": ["/W/L"],
            "expansionRule": "expandPrims",
            "includes": ["/W/C", "/W/L"],
        },
    }
    own = {"own": {"includes": ["/W/C"]}}
    assert done.gltf.nodes[done.node("/W/L")].extras["collections"] == own
    named = {
        entry["prim"]: entry["message"]
        for entry in done.sidecar["warnings"]
        if entry["name"] == "attribute-dropped"
    }
    assert named == {
        "/W": "'collection:many' is not carried",
        "/M": "'collection:none' is not carried",
    }
    assert done.warnings("/W/L") == {"light-linking-dropped"}
