"""Damaged curved gprims: every triangle, normal and side counts."""

from pathlib import Path

import numpy as np
import pytest
from read_converted import convert_text
from reflet_usd.validate.validation import validate_file
from tampering import Damage, Output, change, expect_found, triangles, turn
from texts import text_of

BODY = text_of("validate_gprims/body.usda")
SHAPES = {
    "Sphere": "double radius = 0.7",
    "Cylinder": 'double height = 3\nuniform token axis = "X"',
    "Cylinder_1": "double radiusTop = 0.2\ndouble radiusBottom = 0.9",
    "Cone": 'uniform token axis = "Y"\nuniform bool doubleSided = 1',
    "Capsule": 'uniform token orientation = "leftHanded"',
    "Capsule_1": "double radiusTop = 0.2\ndouble radiusBottom = 0.9",
}
INSTANCER = text_of("validate_gprims/instancer.usda")


def stage(kind: str) -> str:
    """Scene text of one gprim of the kind, mirrored and stretched."""
    return f'def {kind} "G"\n{{\n{SHAPES[kind]}\n{BODY}\n}}\n'


def flip_one(old: np.ndarray) -> np.ndarray:
    """Damage: flip one triangle."""
    old[5] = old[5][::-1]
    return old


def repeat_one(old: np.ndarray) -> np.ndarray:
    """Damage: repeat one triangle in place of its neighbor."""
    old[20] = old[22]
    return old


def swap_pairs(old: np.ndarray) -> np.ndarray:
    """Damage: repeat two triangles in place of two opposite ones, so that no sum changes."""
    half = len(old) // 2
    old[half // 2], old[half // 2 + half] = old[half // 2 + 2], old[half // 2 + half + 2]
    return old


def scatter(old: np.ndarray) -> np.ndarray:
    """Damage: shuffle the corners."""
    return np.random.default_rng(0).permutation(old.ravel()).reshape(-1, 3)


def forget_normals(out: Output) -> None:
    """Damage: remove the normals of all meshes."""
    for mesh in out.gltf.meshes:
        for primitive in mesh.primitives:
            primitive.attributes.NORMAL = None


def other_sides(out: Output) -> None:
    """Damage: toggle the sidedness of all materials."""
    for material in out.gltf.materials:
        material.doubleSided = not material.doubleSided


def random_normals(old: np.ndarray) -> np.ndarray:
    """Damage: replace the normals by random unit vectors."""
    found = np.random.default_rng(0).normal(size=old.shape)
    return found / np.linalg.norm(found, axis=1)[:, None]


DAMAGES: dict[str, Damage] = {
    "turned over": turn,
    "flipped": triangles(flip_one),
    "repeated": triangles(repeat_one),
    "swapped": triangles(swap_pairs),
    "scattered": triangles(scatter),
    "holes": triangles(lambda old: old[:-1]),
    "negated": change("NORMAL", lambda values: -values),
    "random": change("NORMAL", random_normals),
    "no normals": forget_normals,
    "sides": other_sides,
}


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=[n.replace(" ", "-") for n in DAMAGES])
@pytest.mark.parametrize("kind", SHAPES)
def test_a_damaged_gprim_is_found(tmp_path: Path, kind: str, damage: Damage) -> None:
    expect_found(convert_text(tmp_path, stage(kind)), damage)


@pytest.mark.parametrize("damage", [turn, triangles(flip_one), DAMAGES["negated"]])
def test_a_damaged_gprim_of_an_instancer_is_found(tmp_path: Path, damage: Damage) -> None:
    expect_found(convert_text(tmp_path, INSTANCER), damage)


def test_another_orientation_of_the_stage_is_found(tmp_path: Path) -> None:
    done = convert_text(tmp_path, stage("Cone"))
    place = tmp_path / "stage.usda"
    turned = '"G"\n{\nuniform token orientation = "leftHanded"'
    place.write_text(place.read_text().replace('"G"\n{', turned))
    validation = validate_file(done.out, place, khronos=False)
    assert {check.name for check in validation.checks if not check.passed} == {"winding", "normals"}


def test_a_negative_size_is_still_on_its_surface(tmp_path: Path) -> None:
    convert_text(tmp_path, 'def Sphere "G"\n{\ndouble radius = -1\n}\n').proven()


def test_a_flattened_sphere_passes(tmp_path: Path) -> None:
    body = 'float3 xformOp:scale = (1, 1, 0)\nuniform token[] xformOpOrder = ["xformOp:scale"]'
    convert_text(tmp_path, f'def Sphere "G"\n{{\n{body}\n}}\n').proven()
