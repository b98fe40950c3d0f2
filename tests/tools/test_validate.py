"""The validator on hand-written files: right ones pass, each kind of fault is named."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib as gl
import pytest
from handwritten_gltf import HandFile, HandMesh
from reflet_usd.validate.validation import Validation, validate_file
from texts import text_of

STAGE = text_of("validate/stage.usda")
SHEET = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]], dtype=float)
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3], [1, 4, 2]])
UP = [-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]  # −90° about X: Z up becomes Y up


def sphere(radius: float, around: int = 32, steps: int = 16) -> tuple[np.ndarray, np.ndarray]:
    """A latitude-longitude sphere with its poles and equator on the axes."""
    rings = np.linspace(0, math.pi, steps + 1)
    turns = np.linspace(0, 2 * math.pi, around + 1)
    points = [
        (math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a))
        for a in rings
        for b in turns
    ]
    faces = []
    for ring in range(steps):
        for q in range(ring * (around + 1), ring * (around + 1) + around):
            if ring < steps - 1:
                faces.append((q, q + around + 1, q + around + 2))
            if ring > 0:
                faces.append((q, q + around + 2, q + 1))
    return np.array(points) * radius, np.array(faces)


def build(change: Callable[[HandFile], None] | None = None) -> HandFile:
    """Write the right file for STAGE, changed by `change`."""
    file = HandFile()
    look = file.material(
        "/Look",
        doubleSided=True,
        pbrMetallicRoughness=gl.PbrMetallicRoughness(
            baseColorFactor=[0.2, 0.4, 0.6, 1.0], metallicFactor=0.0, roughnessFactor=0.75
        ),
    )
    root = file.node("/", rotation=UP)
    world = file.node("/World", root, translation=[1, 0, 0])
    uvs = np.column_stack([SHEET[:, 0], 1 - SHEET[:, 1]])
    normals = np.tile([0, 0, 1], (5, 1))
    sheet = file.mesh(HandMesh(SHEET, TRIANGLES, normals, uvs, look))
    file.node("/World/Sheet", world, mesh=sheet)
    file.gltf.cameras = [
        gl.Camera(
            type="perspective",
            perspective=gl.Perspective(
                yfov=2 * math.atan(10 / 100), aspectRatio=2.0, znear=0.1, zfar=10.0
            ),
        )
    ]
    file.node("/World/Eye", world, camera=0)
    points, faces = sphere(0.1)
    normals = points / 0.1
    plain = file.material(
        "",
        doubleSided=True,
        pbrMetallicRoughness=gl.PbrMetallicRoughness(metallicFactor=0.0, roughnessFactor=0.5),
    )
    file.node("/Ball", root, mesh=file.mesh(HandMesh(points, faces, normals, None, plain)))
    file.gltf.extensionsUsed = ["KHR_lights_punctual"]
    candela = 100 * math.pi * 0.5**2
    file.gltf.extensions = {
        "KHR_lights_punctual": {"lights": [{"type": "point", "intensity": candela}]}
    }
    file.node("/Bulb", root, extensions={"KHR_lights_punctual": {"light": 0}})
    times = file.accessor([[0.0], [1.0]], "SCALAR", np.float32)
    moves = file.accessor([[1, 0, 0], [2, 0, 0]], "VEC3", np.float32)
    file.gltf.animations = [
        gl.Animation(
            samplers=[gl.AnimationSampler(input=times, output=moves)],
            channels=[
                gl.AnimationChannel(
                    sampler=0, target=gl.AnimationChannelTarget(node=world, path="translation")
                )
            ],
        )
    ]
    if change:
        change(file)
    return file


def validation_of(
    folder: Path, change: Callable[[HandFile], None] | None = None, warnings: list | None = None
) -> Validation:
    """Write STAGE and its file, changed, and compare them."""
    stage = folder / "stage.usda"
    stage.write_text(STAGE, encoding="utf-8")
    out = build(change).write(folder / "out.glb")
    (folder / "out.glb.json").write_text(json.dumps({"warnings": warnings or []}))
    return validate_file(out, stage, khronos=False)


def failing(validation: Validation) -> set[str]:
    """Names of the checks that found a silent deviation."""
    return {check.name for check in validation.checks if not check.passed}


def node(file: HandFile, prim: str) -> gl.Node:
    """The node that stands for `prim`."""
    return next(node for node in file.gltf.nodes if node.extras["prim"] == prim)


def test_a_right_file_passes_every_check(tmp_path: Path) -> None:
    validation = validation_of(tmp_path)
    assert failing(validation) == set(), [check.to_json() for check in validation.checks]
    done = {check.name for check in validation.checks}
    wanted = {"positions", "surfaces", "normals", "uvs", "bindings", "materials", "sides"}
    assert done >= wanted | {"cameras", "lights", "matrices", "triangles", "area", "winding"}
    assert validation.times > 2


def test_the_khronos_validator_agrees(tmp_path: Path, khronos: None) -> None:
    out = build().write(tmp_path / "out.glb")
    validation = validate_file(out, None)
    assert validation.khronos is not None
    assert validation.khronos.errors == 0, validation.khronos.messages


def move_vertex(file: HandFile) -> None:
    file.data[0:4] = np.float32(0.001).tobytes()


def flip_winding(file: HandFile) -> None:
    flipped = np.ascontiguousarray(TRIANGLES[:, ::-1], dtype=np.uint32).tobytes()
    start = file.data.index(TRIANGLES.astype(np.uint32).tobytes())
    file.data[start : start + len(flipped)] = flipped


def drop_triangle(file: HandFile) -> None:
    file.gltf.accessors[file.gltf.meshes[0].primitives[0].indices].count = 6


def keep_v(file: HandFile) -> None:
    file.gltf.meshes[0].primitives[0].attributes.TEXCOORD_0 = file.accessor(
        SHEET[:, :2], "VEC2", np.float32
    )


def tilt_normals(file: HandFile) -> None:
    tilted = np.tile([0, math.sin(0.02), math.cos(0.02)], (5, 1))
    file.gltf.meshes[0].primitives[0].attributes.NORMAL = file.accessor(tilted, "VEC3", np.float32)


def put(path: str, value: Any) -> Callable[[HandFile], None]:
    """Fault: another value at a place in the file; `/Ball` begins at the prim's node."""

    def fault(file: HandFile) -> None:
        *above, last = path.split(".")
        place: Any = file.gltf
        for name in above:
            if name.startswith("/"):
                place = node(file, name)
            else:
                place = place[int(name)] if name.isdigit() else getattr(place, name)
        setattr(place, last, value)

    fault.__name__ = path
    return fault


lose_sheet = put("/World/Sheet.mesh", None)


def add_ghost(file: HandFile) -> None:
    file.node("/Ghost", 0, mesh=0)


def widen_camera(file: HandFile) -> None:
    file.gltf.cameras[0].perspective.yfov *= 1.001


def dim_light(file: HandFile) -> None:
    file.gltf.extensions["KHR_lights_punctual"]["lights"][0]["intensity"] *= 0.5


FAULTS = [
    (move_vertex, "positions"),
    (flip_winding, "winding"),
    (drop_triangle, "triangles"),
    (drop_triangle, "area"),
    (keep_v, "uvs"),
    (tilt_normals, "normals"),
    (put("/Ball.scale", [1.01, 1.01, 1.01]), "surfaces"),
    (lose_sheet, "carried"),
    (put("/Ball.extensions", {"KHR_node_visibility": {"visible": False}}), "carried"),
    (add_ghost, "unexpected"),
    (widen_camera, "cameras"),
    (dim_light, "lights"),
    (put("materials.0.pbrMetallicRoughness.baseColorFactor", [0.2, 0.4, 0.7, 1.0]), "materials"),
    (put("materials.0.alphaMode", "BLEND"), "materials"),
    (put("materials.0.doubleSided", False), "sides"),
    (put("meshes.0.primitives.0.material", None), "bindings"),
    (put("animations.0.samplers.0.interpolation", "STEP"), "matrices"),
    (put("animations", []), "positions"),
    (put("/.rotation", None), "bounds"),
]


@pytest.mark.parametrize(("fault", "check"), FAULTS, ids=lambda x: getattr(x, "__name__", x))
def test_each_fault_is_found_by_its_check(
    tmp_path: Path, fault: Callable[[HandFile], None], check: str
) -> None:
    assert check in failing(validation_of(tmp_path, fault))


def test_a_declared_loss_is_counted_but_does_not_fail(tmp_path: Path) -> None:
    warning = {"name": "prim-damaged", "prim": "/World/Sheet", "message": "too odd"}
    validation = validation_of(tmp_path, lose_sheet, [warning])
    carried = next(check for check in validation.checks if check.name == "carried")
    assert carried.passed
    assert carried.declared >= 1


def test_a_warning_elsewhere_excuses_nothing(tmp_path: Path) -> None:
    warnings = [
        {"name": "prim-damaged", "prim": "/Ball", "message": ""},
        {"name": "prim-damaged", "prim": "/World/Sheet/Below", "message": ""},
        {"name": "mesh-empty", "prim": "/World/Sheet", "message": ""},
        {"name": "schema-ignored", "prim": "/", "message": ""},
        {"name": "uv-missing", "prim": "/World/Sheet", "message": ""},
    ]
    assert "carried" in failing(validation_of(tmp_path, lose_sheet, warnings))


def test_command_prints_json_and_exit_codes(tmp_path: Path, run_cli: Callable) -> None:
    validation_of(tmp_path)
    out, stage, broken = (tmp_path / name for name in ("out.glb", "stage.usda", "broken.usda"))
    command = ["validate", out, "--no-khronos", "--against"]
    assert json.loads(run_cli(0, *command, stage, "--json").out)["passed"] is True
    build(move_vertex).write(out)
    assert "FAILED" in run_cli(3, *command, stage).out
    run_cli(2, "validate", tmp_path / "none.glb")
    broken.write_text("#usda 1.0\ndef Cube {")
    assert "[stage-unreadable]" in run_cli(1, *command, broken).err
    out.write_bytes(b"glTF\2\0\0\0\xff\xff\xff\x7f")
    run_cli(3, *command, stage)


def test_missing_validator_tells_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run_cli: Callable
) -> None:
    monkeypatch.setenv("REFLET_GLTF_VALIDATOR", str(tmp_path))
    out = build().write(tmp_path / "out.glb")
    assert "gltf-validator" in run_cli(1, "validate", out).err
