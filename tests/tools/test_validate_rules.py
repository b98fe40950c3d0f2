"""Damaged outputs where the truth follows a documented rule: the rule must not hide the damage."""

from pathlib import Path

import numpy as np
import pytest
from material_stages import MESH as BOUND
from material_stages import noise, save
from read_converted import convert_text
from reflet_usd.convert import instance_motion, instancer, joints
from tampering import (
    FACE,
    UNIT,
    Case,
    Output,
    animate,
    change,
    expect_case,
    expect_found,
    grow,
    hide_colors,
    light,
    look,
    lose,
    mesh,
    place,
    turn,
    zoom,
)
from test_convert_instances import MOVING_INSTANCER, POINTS, TURNED
from test_convert_skel import STAGE as SKELETON
from test_convert_skel import UNIT as QUARTER
from texts import fill, text_of

SKELETON = fill(SKELETON, meters=1)


def nudge(out: Output) -> None:
    """Damage: shift many instances a little, within four times what normalizing them changed."""
    for node in out.gltf.nodes:
        instancing = (node.extensions or {}).get("EXT_mesh_gpu_instancing")
        if instancing:
            moved = instancing["attributes"]["TRANSLATION"]
            out.rewrite(moved, lambda values: values + 0.01)


def drift(out: Output) -> None:
    """Damage: shift keys a little."""
    for sampler in out.gltf.animations[0].samplers:
        out.rewrite(sampler.output, lambda values: values + 0.01)


def weigh(out: Output) -> None:
    """Damage: exchange the weights of each vertex's joints."""
    (weights,) = out.attributes("WEIGHTS_0")
    out.rewrite(weights, lambda values: np.roll(values, 1, axis=1))


def bend(out: Output) -> None:
    """Damage: scale the morph targets."""
    for primitive in out.gltf.meshes[0].primitives:
        for target in primitive.targets:
            accessor = target["POSITION"] if isinstance(target, dict) else target.POSITION
            out.rewrite(accessor, lambda values: values * 1.5)


def shift_lens(out: Output) -> None:
    """Damage: shift the lens of the camera to the other side."""
    out.gltf.cameras[0].extras["lens_shift"][1] *= -1.0


def move_clip_plane(out: Output) -> None:
    """Damage: move the clip plane of the camera."""
    out.gltf.cameras[0].extras["clip_planes"][0][3] += 0.5


def invent_camera(out: Output) -> None:
    """Damage: give the node of an invalid camera another camera."""
    bad = next(n for n in out.gltf.nodes if (n.extras or {}).get("prim") == "/Bad")
    bad.camera = 0


INSTANCES = "def PointInstancer" + POINTS.split("def PointInstancer", 1)[1]
STRETCHED = INSTANCES.replace("(1,0,0,0)", "(0.6,0.6,0.1,0)")
CYCLE = text_of("validate_rules/cycle.usda", FACE=FACE)
DAMAGED = text_of("validate_rules/damaged.usda", FACE=FACE, good_mesh=mesh("Dx"))
FAR = mesh(
    "M",
    """
    double3 xformOp:translate.timeSamples = { -1e12: (5, 0, 0), 0: (0, 0, 0), 24: (1, 0, 0) }
    uniform token[] xformOpOrder = ["xformOp:translate"]
    """,
)
NO_LENS = text_of("validate_rules/no_lens.usda")
HERE = Path(__file__).parent
fade = change("COLOR_0", lambda values: values * 0.9)
MOVING_LENS = text_of("validate_rules/moving_lens.usda")
LINES = text_of("validate_rules/lines.usda")
CUBIC = text_of("validate_rules/cubic.usda")
PATCH = text_of("validate_rules/patch.usda")
TETRAHEDRON = text_of("validate_rules/tetrahedron.usda")
PORTAL = text_of("validate_rules/portal.usda", FACE=FACE)
SPHERE = text_of("validate_rules/sphere.usda")
SURFACES = {
    "standard_surface": text_of("validate_rules/standard_surface.usda"),
    "open_pbr_surface": text_of("validate_rules/open_pbr_surface.usda"),
    "gltf_pbr": text_of("validate_rules/gltf_pbr.usda"),
}


# glTF carries its own surface whole, without a warning.
APPROXIMATED = {name: "" if name == "gltf_pbr" else "material-approximated" for name in SURFACES}


def materialx(name: str) -> str:
    """Scene text of a quad with a MaterialX surface of that name."""
    kind = {"gltf_pbr": "ND_gltf_pbr_surfaceshader"}.get(name, f"ND_{name}_surfaceshader")
    return text_of(
        "validate_rules/materialx.usda",
        kind=kind,
        surface=SURFACES[name],
        bound=fill(BOUND, body=""),
    )


FROZEN_LENS = text_of("validate_rules/frozen_lens.usda")
FROZEN_LIGHT = text_of("validate_rules/frozen_light.usda")
FROZEN_INSTANCES = text_of("validate_rules/frozen_instances.usda", mesh_A=mesh("A"))
WEIGHTS = SKELETON.replace("[1,0, 0.5,0.5,", "[3,0, 0.5,0.5,")
DUAL = SKELETON.replace(
    'uniform token[] skel:joints = ["A/B/C", "A", "A/B"]',
    'uniform token[] skel:joints = ["A/B/C", "A", "A/B"]\n'
    'uniform token primvars:skel:skinningMethod = "dualQuaternion"',
)
BETWEEN = SKELETON.replace(
    "uniform int[] pointIndices = [2, 5]",
    "uniform int[] pointIndices = [2, 5]\n"
    "uniform vector3f[] inbetweens:half = [(0,9,0), (0,0,9)] (weight = 0.5)",
)
CASES: list[Case] = [
    ("a damaged prim and another", DAMAGED, "prim-damaged", lose("/Dx")),
    ("a damaged prim and its neighbor", DAMAGED + UNIT, "prim-damaged", grow),
    ("samples of no time", FAR + UNIT, "time-sample-dropped", animate),
    ("samples of no time and a lost prim", FAR + UNIT, "time-sample-dropped", lose("/M")),
    ("a cycle", CYCLE + UNIT, "instancer-cycle", place),
    ("a lost cycle", CYCLE + UNIT, "instancer-cycle", lose("/I")),
    ("a camera", NO_LENS + UNIT, "camera-invalid", lose("/C")),
    ("a camera's lens", NO_LENS + UNIT, "camera-invalid", zoom),
    ("a camera too many", NO_LENS + UNIT, "camera-invalid", invent_camera),
    ("a moving lens", MOVING_LENS + UNIT, "", animate),
    ("a shifted lens", MOVING_LENS + UNIT, "", shift_lens),
    ("a moved clip plane", MOVING_LENS + UNIT, "", move_clip_plane),
    *(
        (f"colors of {name}", (HERE / "stages" / f"{name}.usda").read_text(), "", fade)
        for name in ("widths", "levels")
    ),
    ("curves", LINES + UNIT, "curves-invalid", lose("/L")),
    ("places of curves", LINES, "curves-invalid", grow),
    ("patches", PATCH, "curves-approximated", grow),
    ("a patch's turn", PATCH, "curves-approximated", turn),
    ("tetrahedra", TETRAHEDRON, "tetrahedra-dropped", grow),
    ("tetrahedra's turn", TETRAHEDRON, "tetrahedra-dropped", turn),
    ("another light", PORTAL, "portal-light-ignored", light(intensity=9.0)),
    ("a lost light", PORTAL, "portal-light-ignored", lose("/S")),
    ("below a light", PORTAL, "portal-light-ignored", lose("/P/Below")),
    ("left-out colors", SPHERE, "primvar-interpolation-dropped", hide_colors),
    ("a sphere of such colors", SPHERE, "primvar-interpolation-dropped", grow),
    ("a frozen lens", FROZEN_LENS + UNIT, "camera-animation-frozen", zoom),
    ("a frozen light", FROZEN_LIGHT + UNIT, "light-animation-frozen", light(intensity=9.0)),
    ("frozen instances", FROZEN_INSTANCES, "instancer-animation-frozen", place),
    ("weights", WEIGHTS, "weights-normalized", weigh),
    ("joints", WEIGHTS, "weights-normalized", drift),
    ("dual quaternions", DUAL, "skinning-dq-as-linear", weigh),
    ("in-betweens", BETWEEN, "inbetween-dropped", bend),
    *(
        (f"{basis} {wrap}", CUBIC.replace("BASIS", basis).replace("WRAP", wrap), *rest)
        for basis in ("bezier", "bspline", "catmullRom")
        for wrap in ("nonperiodic", "periodic", "pinned")
        for rest in [("curves-approximated", change("POSITION", lambda values: values * 1.01))]
    ),
    *(
        (f"{name} {field}", materialx(name), APPROXIMATED[name], look(**{field: value}))
        for name in SURFACES
        for field, value in (
            ("baseColorFactor", [0.1, 0.2, 0.1, 0.5]),
            ("metallicFactor", 0.5),
            ("roughnessFactor", 0.6),
        )
    ),
]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case[0].replace(" ", "-"))
def test_a_rule_hides_no_damage(tmp_path: Path, case: Case) -> None:
    expect_case(tmp_path, case)


@pytest.mark.parametrize("name", list(SURFACES))
def test_emission_of_materialx_is_compared(tmp_path: Path, name: str) -> None:
    def darken(out: Output) -> None:
        assert max(out.gltf.materials[0].emissiveFactor) > 0.0
        out.gltf.materials[0].emissiveFactor = [0.0, 0.0, 0.0]

    save(tmp_path, "t.png", noise("RGB", (16, 16)))
    expect_found(convert_text(tmp_path, materialx(name)), darken)


def test_many_turned_instances_are_compared_with_normalized_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(instancer, "MAX_INSTANCE_NODES", 1)
    monkeypatch.setattr(instancer, "MAX_SHEARED_NODES", 1)
    done = convert_text(tmp_path, STRETCHED)
    assert "instance-rotation-normalized" in done.warnings("/I")
    expect_found(done, nudge)


@pytest.mark.parametrize(
    ("module", "stage", "kind", "prim"),
    [
        (instance_motion, fill(MOVING_INSTANCER, more=TURNED), "instance", "/I"),
        (joints, SKELETON.replace(QUARTER, "(0.7,0.5,0.3,0.2)"), "joint", "/Root/Skel"),
    ],
)
def test_turning_things_are_compared_with_normalized_ones(
    module, stage, kind, prim, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_MATRIX_KEYS", 1)
    done = convert_text(tmp_path, stage)
    assert f"{kind}-rotation-normalized" in done.warnings(prim)
    expect_found(done, drift)


def test_area_and_winding_of_skinned_meshes(tmp_path: Path) -> None:
    done = convert_text(tmp_path, SKELETON)
    expect_found(done, turn)
    validation = done.validated()
    checks = {check.name: check for check in validation.checks}
    assert checks["winding"].silent > 0
    assert checks["skinning"].passed
    assert checks["area"].passed
    assert checks["area"].compared == checks["skinning"].compared > 3
