"""Owns the tests of skeletons and blend shapes: skinned points against USD's own skinning."""

from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom, UsdSkel
from read_converted import Converted, convert_text, interpolated
from reflet_usd.convert import joints as joints_module
from texts import fill, text_of

STAGE = text_of("convert_skel/stage.usda")


def skinned(done: Converted, seconds: float) -> np.ndarray:
    """The world positions of the mesh's vertices by glTF's skinning rules."""
    index = next(i for i, n in enumerate(done.gltf.nodes) if n.skin is not None)
    node = done.gltf.nodes[index]
    skin = done.gltf.skins[node.skin]
    world = done.world(seconds)
    binds = done.array(skin.inverseBindMatrices).reshape(-1, 4, 4).transpose(0, 2, 1)
    joints = np.array([world[j] @ b for j, b in zip(skin.joints, binds, strict=True)])
    primitive = done.json["meshes"][node.mesh]["primitives"][0]
    attributes = primitive["attributes"]
    points = done.array(attributes["POSITION"]).astype(float)
    targets = primitive.get("targets", [])
    weights = done.animated(index, seconds).get("weights", np.zeros(len(targets)))
    for weight, target in zip(weights, targets, strict=True):
        points = points + weight * done.array(target["POSITION"])
    influences = done.array(attributes["WEIGHTS_0"]).astype(float)
    matrices = np.einsum("vk,vkij->vij", influences, joints[done.array(attributes["JOINTS_0"])])
    return np.einsum("vij,vj->vi", matrices, np.c_[points, np.ones(len(points))])[:, :3]


def usd_skinned(path: Path, code: float, meters: float) -> np.ndarray:
    """The world positions of the mesh's points by UsdSkelBakeSkinning."""
    stage = Usd.Stage.Open(str(path))
    assert UsdSkel.BakeSkinning(stage.Traverse())
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/Root/M"))
    points = np.array(mesh.GetPointsAttr().Get(code))
    matrix = np.array(mesh.ComputeLocalToWorldTransform(code))
    return (np.c_[points, np.ones(len(points))] @ matrix)[:, :3] * meters


@pytest.mark.parametrize("meters", [1.0, 0.01])
def test_skin_and_shapes_move_like_usd(tmp_path: Path, meters: float) -> None:
    done = convert_text(tmp_path, fill(STAGE, meters=meters))
    for code in (0, 12, 24):  # baking keeps authored times only
        wanted = usd_skinned(tmp_path / "stage.usda", code, meters)
        found = skinned(done, code / 24)
        for points, others in ((wanted, found), (found, wanted)):
            far = np.linalg.norm(points[:, None] - others[None], axis=2).min(axis=1)
            assert far.max() < 1e-5 * meters * 5, f"at {code}"
    assert done.json["meshes"][0]["extras"]["targetNames"] == ["up"]


UNIT = "(0.70710678,0.70710678,0,0)"


@pytest.mark.parametrize("turn", [UNIT, "(0.7071,0.7071,0,0)", "(0.7,0.5,0.3,0.2)"])
def test_joints_move_like_usd_between_the_keys(tmp_path: Path, turn: str) -> None:
    done = convert_text(tmp_path, fill(STAGE, meters=1).replace(UNIT, turn))
    stage = Usd.Stage.Open(str(tmp_path / "stage.usda"))
    root = UsdSkel.Root(stage.GetPrimAtPath("/Root"))
    cache = UsdSkel.Cache()
    cache.Populate(root, Usd.PrimDefaultPredicate)
    query = cache.GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath("/Root/Skel")))
    for code in (0, 3, 7.5, 12, 20, 24):
        world = done.world(code / 24)
        wanted = query.ComputeJointWorldTransforms(UsdGeom.XformCache(code))
        for joint, matrix in zip(done.gltf.skins[0].joints, wanted, strict=True):
            assert world[joint] == pytest.approx(np.array(matrix).T, abs=3e-5), f"at {code}"


def test_too_many_stretching_joints_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(joints_module, "MAX_MATRIX_KEYS", 1)
    done = convert_text(tmp_path, fill(STAGE, meters=1).replace(UNIT, "(0.7,0.5,0.3,0.2)"))
    assert done.warnings("/Root/Skel") == {"joint-rotation-normalized"}


def test_a_sheared_rest_pose_is_exact(tmp_path: Path) -> None:
    animation = "rel skel:animationSource = </Root/Skel/Anim>"
    rest = "((0,1,0,0),(-1,0,0,0),(0,0,1,0),(0,2,0,1))]"
    text = fill(STAGE, meters=1).replace(animation, "")
    assert text.count(rest) == 1
    text = text.replace(rest, rest.replace("(0,0,1,0)", "(0.3,0,1,0)"))
    done = convert_text(tmp_path, text)
    assert "shear-split" in done.warnings("/Root/Skel")
    found, wanted = skinned(done, 0.0), usd_skinned(tmp_path / "stage.usda", 0, 1.0)
    far = np.linalg.norm(wanted[:, None] - found[None], axis=2).min(axis=1)
    assert far.max() < 1e-5


def test_an_animation_that_usd_ignores_is_named(tmp_path: Path) -> None:
    text = fill(STAGE, meters=1).replace("half3[] scales = [(1,1,1), (1,1.5,1)]", "")
    done = convert_text(tmp_path, text)
    assert "skeleton-animation-dropped" in done.warnings("/Root/Skel/Anim")
    for code in (0, 12, 24):
        found = skinned(done, code / 24)
        wanted = usd_skinned(tmp_path / "stage.usda", code, 1.0)
        far = np.linalg.norm(wanted[:, None] - found[None], axis=2).min(axis=1)
        assert far.max() < 1e-5


def test_keys_of_joints_stay_where_they_were(tmp_path: Path) -> None:
    done = convert_text(tmp_path, fill(STAGE, meters=1))
    times = {
        channel.target.path: done.array(done.gltf.animations[0].samplers[channel.sampler].input)
        for channel in done.gltf.animations[0].channels
    }
    assert times["translation"][:, 0].tolist() == [0, 1]
    assert times["rotation"][:, 0].tolist() == [0, 0.5]
    assert times["weights"][:, 0].tolist() == [0, 1]


def test_everything_of_a_skeleton_is_accounted_for(tmp_path: Path) -> None:
    done = convert_text(tmp_path, fill(STAGE, meters=1))
    assert all(row["warned"] == 0 for row in done.result.ledger.values()), done.result.warnings
    assert set(done.result.ledger) == {
        "BlendShape",
        "Mesh",
        "SkelAnimation",
        "SkelRoot",
        "Skeleton",
    }


FLAT = "((0,0,0,0),(0,1,0,0),(0,0,1,0),(0,2,0,1))"
HUGE = "((1e200,0,0,0),(0,1e-100,0,0),(0,0,1e-100,0),(0,2,0,1))"
DAMAGE = [
    ("[1,1, 1,2,", "[1,1, 9,2,", "joint-index-out-of-range"),
    ('["A/B/C", "A", "A/B"]', '["A/B/C", "Z", "A/B"]', "joint-index-out-of-range"),
    ("pointIndices = [2, 5]", "pointIndices = [2, 50]", "blend-shape-invalid"),
    ("[1,0, 0.5,0.5,", "[3,0, 0.5,0.5,", "weights-normalized"),
    ("[1,0, 0.5,0.5,", "[0.9999,0, 0.5,0.5,", "weights-normalized"),
    (
        "blendShapeTargets = </Root/M/Up>",
        "blendShapeTargets = </None>",
        "blend-shape-invalid",
    ),
    ('"A/B", "A/B/C"]', '"A/B", "A/B/C", "D"]', "skeleton-invalid"),
    ("((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,2,0,1))", FLAT, "skeleton-invalid"),
    ("((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,2,0,1))", HUGE, "skeleton-invalid"),
]


@pytest.mark.parametrize(("old", "new", "warning"), DAMAGE)
def test_damage_is_named(tmp_path: Path, old: str, new: str, warning: str) -> None:
    text = fill(STAGE, meters=1)
    assert old in text
    done = convert_text(tmp_path, text.replace(old, new, 1))
    assert warning in done.warnings()
    assert done.json["meshes"]


def test_animated_points_become_targets(tmp_path: Path) -> None:
    text = text_of("convert_skel/animated_points_become_targets.usda")
    done = convert_text(tmp_path, text)
    index = done.node("/M")
    primitive = done.json["meshes"][0]["primitives"][0]
    rest = done.array(primitive["attributes"]["POSITION"]).astype(float)
    stage = Usd.Stage.Open(str(tmp_path / "stage.usda"))
    attribute = stage.GetPrimAtPath("/M").GetAttribute("points")
    for code in (0, 5, 12, 18, 24):
        weights = done.animated(index, code / 24)["weights"]
        points = rest + sum(
            w * done.array(t["POSITION"])
            for w, t in zip(weights, primitive["targets"], strict=True)
        )
        wanted = np.array(attribute.Get(code))
        assert np.sort(points, axis=0) == pytest.approx(np.sort(wanted, axis=0), abs=1e-6)


def test_interpolation_used_by_these_tests() -> None:
    times = np.array([0.0, 1.0])
    turn = np.array([[0, 0, 0, 1.0], [0, 0, 1.0, 0]])
    middle = interpolated(times, turn, 0.5, True, False)
    assert middle == pytest.approx([0, 0, np.sqrt(0.5), np.sqrt(0.5)])


def test_skinned_prototypes_are_cloned_with_their_joints(tmp_path: Path) -> None:
    text = fill(STAGE, meters=1) + text_of(
        "convert_skel/skinned_prototypes_are_cloned_with_their_joints.usda"
    )
    done = convert_text(tmp_path, text)
    skins = done.gltf.skins
    assert len(skins) == 3
    joints = [joint for skin in skins for joint in skin.joints]
    assert len(set(joints)) == len(joints)
    world = done.world(0.0)
    roots = [world[skin.joints[0]][0, 3] for skin in skins]
    # The stage's own root and each instance stand at x = 3 plus the instance's place.
    assert sorted(roots) == pytest.approx([3, 3, 103])


def test_native_instances_of_a_skeleton(tmp_path: Path) -> None:
    text = fill(STAGE, meters=1).replace('def SkelRoot "Root"', 'class SkelRoot "Root"', 1)
    text += text_of("convert_skel/native_instances_of_a_skeleton.usda")
    done = convert_text(tmp_path, text)
    world = done.world(0.0)
    assert sorted(world[skin.joints[0]][0, 3] for skin in done.gltf.skins) == pytest.approx([3, 7])
    assert done.result.ledger["BlendShape"]["warned"] == 0


CHARACTER = text_of("convert_skel/character.usda")


def test_a_crowd_of_instanced_mirrored_and_delayed_characters(tmp_path: Path) -> None:
    (tmp_path / "character.usda").write_text(CHARACTER)
    order = 'uniform token[] xformOpOrder = ["xformOp:scale"]'
    mirrored = f"float3 xformOp:scale = (1, 2, -1)\n{order}"
    still = 'over "S"\n{\nrel skel:animationSource = None\n}'
    text = "".join(
        f'def "{name}" (\n{instance}\nreferences = @character.usda@ {shift}\n)\n{{\n{body}\n}}\n'
        for name, instance, shift, body in (
            ("Plain", "", "", ""),
            ("Shared", "instanceable = true", "", ""),
            ("Mirrored", "", "", mirrored),
            ("Delayed", "instanceable = true", "(offset = 6; scale = 0.5)", mirrored),
            ("Still", "", "", still),
        )
    )
    done = convert_text(tmp_path, text)
    assert done.warnings() == {"animation-unused"}
    assert done.warnings("/Still/A") == {"animation-unused"}
    done.agreeing(skinning=21, joints=21, area=21, winding=21)


@pytest.mark.parametrize("frames", [None, (5.5, 20.0)])
@pytest.mark.parametrize("scales", ["[(1, 1, 1)]", "{ 0: [(1, 1, 1)], 24: [(3, 1, 1)] }"])
def test_characters_agree_between_the_ends_of_a_range(
    tmp_path: Path, scales: str, frames: tuple[float, float] | None
) -> None:
    name = "scales.timeSamples" if "{" in scales else "scales"
    text = CHARACTER.replace("scales = [(1, 1, 1)]", f"{name} = {scales}")
    convert_text(tmp_path, text, frames=frames).proven()
