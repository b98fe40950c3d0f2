"""Owns the tests of animated visibility above nodes that move to another parent."""

import re
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom
from read_converted import Converted, convert_text
from test_convert_skel import STAGE
from texts import fill, text_of

CODES = (0, 2, 3, 4.5, 6, 7, 9, 10, 12)


def shown(done: Converted, prim: str, seconds: float) -> bool:
    """Whether a prim's node and all its ancestors are visible, by glTF's rules."""
    parents = {c: i for i, n in enumerate(done.gltf.nodes) for c in n.children or []}
    keys = {}
    for animation in done.json.get("animations", []):
        for channel in animation["channels"]:
            pointer = channel["target"].get("extensions", {}).get("KHR_animation_pointer")
            if pointer is not None:
                found = re.fullmatch(
                    r"/nodes/(\d+)/extensions/KHR_node_visibility/visible", pointer["pointer"]
                )
                assert found
                sampler = animation["samplers"][channel["sampler"]]
                assert sampler["interpolation"] == "STEP"
                times, values = (done.array(sampler[n])[:, 0] for n in ("input", "output"))
                keys[int(found[1])] = (times, values)
    index: int | None = done.node(prim)
    while index is not None:
        if index in keys:
            times, values = keys[index]
            if not values[max(int(np.searchsorted(times, seconds + 1e-6, "right")) - 1, 0)]:
                return False
        index = parents.get(index)
    return True


def check(done: Converted, *prims: str) -> None:
    """Assert that each prim is visible when USD says so, and not at all times."""
    stage = Usd.Stage.Open(str(done.out.with_name("stage.usda")))
    for prim in prims:
        imageable = UsdGeom.Imageable(stage.GetPrimAtPath(prim))
        expected = [imageable.ComputeVisibility(code) != "invisible" for code in CODES]
        assert [shown(done, prim, code / 24) for code in CODES] == expected
        assert set(expected) == {True, False}


@pytest.mark.parametrize("shear", ["", ', "xformOp:transform"'])
def test_a_reset_stack_keeps_the_visibility_above(tmp_path: Path, shear: str) -> None:
    text = text_of("convert_visibility/a_reset_stack_keeps_the_visibility_above.usda", shear=shear)
    done = convert_text(tmp_path, text)
    below = [f"/A/B/{name}" for name in ("Plain", "R", "R/Child", "Away", "Away/Further")]
    check(done, *below)


def test_a_skinned_mesh_keeps_the_visibility_above(tmp_path: Path) -> None:
    text = fill(STAGE, meters=1).replace(
        'def SkelRoot "Root"', 'def Xform "A" {\nHIDING\ndef SkelRoot "Root"', 1
    )
    hiding = 'token visibility.timeSamples = { 0: "inherited", 6: "invisible", 9: "inherited" }'
    text = text.replace("/Root", "/A/Root").replace("HIDING", hiding) + "}\n"
    done = convert_text(tmp_path, text)
    assert done.gltf.nodes[done.node("/A/Root/M")].skin is not None
    check(done, "/A/Root/M")


PURPOSES = text_of("convert_visibility/purposes.usda")
DEVICES = text_of("convert_visibility/devices.usda")


@pytest.mark.parametrize("kept", [("default", "render"), ("guide",), ("proxy",)])
def test_lights_and_cameras_stay_whatever_their_purpose(
    tmp_path: Path, kept: tuple[str, ...]
) -> None:
    done = convert_text(tmp_path, fill(PURPOSES, body=DEVICES), purpose=kept).proven()
    for path in ("/X", "/I/A/G") if "default" in kept else ("/X",):  # else no instancer
        assert done.gltf.nodes[done.node(f"{path}/C")].camera is not None
        assert done.gltf.nodes[done.node(f"{path}/L")].extensions
