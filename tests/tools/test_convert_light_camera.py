"""Owns the tests of lights and cameras: values by formula, units, what is lost."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest
from PIL import Image
from read_converted import Converted, convert_text
from reflet_usd.convert.environment import directions
from reflet_usd.exr_pixels import read_exr
from texts import text_of


def light(done: Converted, index: int = 0) -> dict[str, Any]:
    entry = done.json["extensions"]["KHR_lights_punctual"]["lights"][index]
    assert isinstance(entry, dict)
    return entry


def convert_light(folder: Path, kind: str, body: str, meters: float = 1.0) -> Converted:
    head = f'#usda 1.0\n(\n    metersPerUnit = {meters}\n    upAxis = "Y"\n)\n'
    return convert_text(folder, f'{head}def {kind} "L" {{\n{body}\n}}')


def test_distant_light_in_lux(tmp_path: Path) -> None:
    done = convert_light(
        tmp_path,
        "DistantLight",
        "float inputs:intensity = 3\nfloat inputs:exposure = 2\nfloat inputs:angle = 10",
    )
    assert light(done)["type"] == "directional"
    lux = 12 * math.pi * math.sin(math.radians(5)) ** 2
    assert light(done)["intensity"] == pytest.approx(lux)
    body = "float inputs:intensity = 3\nfloat inputs:angle = 10\nbool inputs:normalize = 1"
    assert light(convert_light(tmp_path, "DistantLight", body))["intensity"] == pytest.approx(3)


@pytest.mark.parametrize("meters", [1.0, 0.01])
@pytest.mark.parametrize("normalize", [0, 1])
def test_sphere_light_in_candela(tmp_path: Path, meters: float, normalize: int) -> None:
    body = (
        "float inputs:intensity = 100\nfloat inputs:radius = 3\n"
        f"bool inputs:normalize = {normalize}\n"
        'float3 xformOp:scale = (2, 2, 2)\nuniform token[] xformOpOrder = ["xformOp:scale"]'
    )
    done = convert_light(tmp_path, "SphereLight", body, meters)
    expected = 25.0 if normalize else 100 * math.pi * (3 * 2 * meters) ** 2
    assert light(done)["intensity"] == pytest.approx(expected)
    assert light(done)["type"] == "point"


def test_color_and_temperature_are_normalized_into_the_intensity(
    tmp_path: Path,
) -> None:
    body = "color3f inputs:color = (4, 2, 0)\nbool inputs:normalize = 1\nfloat inputs:intensity = 8"
    found = light(convert_light(tmp_path, "SphereLight", body))
    assert found["color"] == pytest.approx([1, 0.5, 0])
    assert found["intensity"] == pytest.approx(8)
    body = "bool inputs:enableColorTemperature = 1\nfloat inputs:colorTemperature = 2000"
    red, green, blue = light(convert_light(tmp_path, "SphereLight", body))["color"]
    assert red == 1.0
    assert red > green > blue


@pytest.mark.parametrize(
    ("angle", "kind", "warned"),
    [(30, "spot", False), (90, "spot", False), (120, "spot", True), (180, "point", False)],
)
def test_cones(tmp_path: Path, angle: int, kind: str, warned: bool) -> None:
    done = convert_text(tmp_path, text_of("convert_light_camera/cone.usda", angle=angle))
    assert light(done)["type"] == kind
    assert ("cone-clamped" in done.warnings("/L")) == warned
    if kind == "spot":
        spot = light(done)["spot"]
        assert spot["outerConeAngle"] == pytest.approx(math.radians(min(angle, 90)))
        assert spot["innerConeAngle"] == pytest.approx(spot["outerConeAngle"] / 2)


@pytest.mark.parametrize(
    ("kind", "body", "area", "solid_angle"),
    [
        (
            "RectLight",
            "float inputs:width = 2\nfloat inputs:height = 3",
            6.0,
            2 * math.pi / 3,
        ),
        ("DiskLight", "float inputs:radius = 2", 4 * math.pi, 2 * math.pi / 3),
        (
            "CylinderLight",
            "float inputs:radius = 0.5\nfloat inputs:length = 4",
            4 * math.pi,
            4 * math.pi,
        ),
    ],
)
def test_area_lights_keep_their_power(
    tmp_path: Path, kind: str, body: str, area: float, solid_angle: float
) -> None:
    done = convert_light(tmp_path, kind, f"float inputs:intensity = 5\n{body}")
    flux = math.pi * 5 * area
    assert light(done)["intensity"] * solid_angle == pytest.approx(flux)
    assert light(done)["extras"]["area_light"]["power_lm"] == pytest.approx(flux)
    assert "area-light-approximated" in done.warnings("/L")


SKY = "asset inputs:texture:file = @sky.{}@\n    float inputs:exposure = 1"
TURNED = "\n    float xformOp:rotateX = 40\n    double3 xformOp:rotateXYZ = (9, -30, 70)\n    "
TURNED += 'uniform token[] xformOpOrder = ["xformOp:rotateX", "xformOp:rotateXYZ"]'
# Kind, up axis, body, size of the texture, and the direction in the file of the texture's middle.
DOMES = {
    "as it is": ("DomeLight", "Y", SKY.format("exr"), (8, 16), (0, 0, 1)),
    "of a Z-up stage": ("DomeLight", "Z", SKY.format("hdr"), (8, 16), (0, 1, 0)),
    "with the stage's pole": ("DomeLight_1", "Z", SKY.format("png"), (8, 16), (0, 0, 1)),
    "with a pole": (
        "DomeLight_1",
        "Y",
        SKY.format("exr") + '\n token poleAxis = "Z"',
        (8, 16),
        (0, -1, 0),
    ),
    "turned": ("DomeLight", "Y", SKY.format("exr") + TURNED, (8, 16), None),
    "of one pixel": ("DomeLight", "Y", SKY.format("png"), (1, 1), None),
    "a cross": ("DomeLight", "Y", SKY.format("exr"), (16, 12), None),
}
DOMES |= {
    layout: (
        "DomeLight",
        "Y",
        f'{SKY.format("exr")}\n    token inputs:texture:format = "{layout}"',
        (17, 17),
        (0, 0, 1),
    )
    for layout in ("angular", "mirroredBall")
}


def write_sky(folder: Path, size: tuple[int, int]) -> None:
    """A texture of random colors in three formats; its middle is the brightest."""
    height, width = size
    sky = np.random.default_rng(2).random((height, width, 3)).astype(np.float32)
    sky[(height - 3) // 2 : height // 2 + 2, (width - 3) // 2 : width // 2 + 2] = 1.0
    Image.fromarray((sky * 255).astype(np.uint8)).save(folder / "sky.png")
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": 40 * sky}).write(str(folder / "sky.exr"))
    mantissa, exponent = np.frexp(40 * sky.max(axis=2))
    scale = (256 * mantissa / (40 * sky.max(axis=2)))[..., None]
    texels = np.concatenate([40 * sky * scale, exponent[..., None] + 128], axis=2).astype(np.uint8)
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
    rows = []
    for row in texels:  # half of a row as one run of bytes, the rest as they are
        rows.append(bytes([2, 2, 0, width]))
        rows += [bytes([width]) + channel.tobytes() for channel in row.T]
    (folder / "sky.hdr").write_bytes(head.encode() + b"".join(rows))


def panorama(done: Converted) -> Any:
    """Pixels of the file's environment."""
    view = done.gltf.bufferViews[done.json["scenes"][0]["extras"]["usd"]["environment"]]
    blob = done.gltf.binary_blob()
    return read_exr(blob[view.byteOffset : view.byteOffset + view.byteLength])


@pytest.mark.parametrize("name", DOMES)
def test_a_dome_gives_the_environment(tmp_path: Path, name: str) -> None:
    kind, up, body, size, middle = DOMES[name]
    write_sky(tmp_path, size)
    text = (
        f'#usda 1.0\n( metersPerUnit = 1\n upAxis = "{up}" )\ndef {kind} "L" {{\n    {body}\n}}\n'
    )
    done = convert_text(tmp_path, text + FEW).proven()
    assert done.warnings("/L") == set()
    if middle is not None:
        sky = panorama(done)
        rows, columns = np.nonzero(sky.min(axis=2) > 0.999 * sky.max())
        around = directions(np.arange(sky.shape[0]), sky.shape[1], sky.shape[0])[rows, columns]
        assert around.mean(axis=0) == pytest.approx(middle, abs=0.3)
    (tmp_path / "stage.usda").write_text(text.replace("exposure = 1", "exposure = 1.1") + FEW)
    assert not done.validated().passed


FEW = 'def Cube "Unit"\n{\n}\n'


def test_domes_add_up_and_lost_textures_are_black(tmp_path: Path) -> None:
    plain = "float inputs:intensity = 2\ncolor3f inputs:color = (1, 0.5, 0.25)"
    lost = f'def DomeLight "Lost" {{\n    {SKY.format("exr")}\n}}\n'
    done = convert_light(tmp_path, "DomeLight", plain + "\n}\n" + lost + 'def Scope "S" {').proven()
    assert panorama(done).reshape(-1, 3) == pytest.approx(np.tile([2, 1, 0.5], (2, 1)))
    assert done.warnings("/Lost") == {"texture-missing"}


CAMERA = text_of("convert_light_camera/camera.usda")


def test_perspective_camera(tmp_path: Path) -> None:
    done = convert_light(tmp_path, "Camera", CAMERA, 0.01)
    perspective = done.json["cameras"][0]["perspective"]
    assert perspective["yfov"] == pytest.approx(2 * math.atan(12 / 50))
    assert perspective["aspectRatio"] == pytest.approx(1.5)
    assert (perspective["znear"], perspective["zfar"]) == pytest.approx((0.02, 4.0))
    assert done.warnings("/L") == set()


def test_orthographic_camera(tmp_path: Path) -> None:
    body = CAMERA + '\n    token projection = "orthographic"'
    found = convert_light(tmp_path, "Camera", body, 0.01).json["cameras"][0]["orthographic"]
    # Apertures are tenths of a unit: 36 are 3.6 units, 0.036 m across.
    assert found["xmag"] == pytest.approx(0.018)
    assert found["ymag"] == pytest.approx(0.012)


def test_an_orthographic_camera_may_begin_at_its_eye(tmp_path: Path) -> None:
    body = 'float2 clippingRange = (0, 100)\n    token projection = "orthographic"'
    done = convert_light(tmp_path, "Camera", body).proven()
    assert done.json["cameras"][0]["orthographic"]["znear"] == 0
    assert done.warnings("/L") == set()
    done = convert_light(tmp_path, "Camera", "float2 clippingRange = (0, 100)")
    assert "camera-clip-invalid" in done.warnings("/L")


def test_lens_values_that_are_no_numbers_are_named(tmp_path: Path) -> None:
    body = "float fStop = nan\n    float exposure = inf\n    double shutter:open = 0.5"
    done = convert_light(tmp_path, "Camera", body).proven()
    assert done.json["nodes"][done.node("/L")]["extras"]["lens"] == {"shutter:open": 0.5}


def test_what_a_pinhole_lacks_is_named(tmp_path: Path) -> None:
    body = CAMERA + "\n    float fStop = 2.8\n    float horizontalApertureOffset = nan"
    body += "\n    float focusDistance = 500"
    done = convert_light(tmp_path, "Camera", body, 0.01)
    lens = done.json["nodes"][done.node("/L")]["extras"]["lens"]
    assert lens["fStop"] == pytest.approx(2.8)
    assert lens["focusDistance_m"] == pytest.approx(5)
    assert "lens-dropped" in done.warnings("/L")


def test_lenses_are_shifted_and_zoom_as_the_stage_says(tmp_path: Path) -> None:
    body = "float horizontalApertureOffset = 3\n    float verticalApertureOffset = -6"
    body += "\n    float focalLength.timeSamples = { 1: 20, 24: 100, 48: 50 }"
    body += "\n    float2 clippingRange.timeSamples = { 1: (1, 10), 24: (2, 10) }"
    body += "\n    float4[] clippingPlanes = [(1, 0.5, 0, 200)]"
    for kind in ("perspective", "orthographic"):
        text = f'{body}\n    float verticalAperture = 12\n    token projection = "{kind}"'
        done = convert_light(tmp_path, "Camera", text, 0.01).proven()
        extras = done.json["cameras"][0]["extras"]
        assert extras["lens_shift"] == [0.25, -0.5]
        assert extras["clip_planes"] == [[1, 0.5, 0, pytest.approx(2)]]
        moved = [
            channel["target"]["extensions"]["KHR_animation_pointer"]["pointer"]
            for channel in done.json["animations"][0]["channels"]
        ]
        zooms = ["/cameras/0/perspective/yfov"] if kind == "perspective" else []
        assert moved == [*zooms, f"/cameras/0/{kind}/znear"]
        assert done.warnings("/L") == set()


@pytest.mark.parametrize("value", ["nan", "inf", "1e-45", "3e38"])
@pytest.mark.parametrize("name", ["verticalAperture", "horizontalAperture", "focalLength"])
def test_lenses_beyond_all_numbers_make_no_camera(tmp_path: Path, name: str, value: str) -> None:
    done = convert_text(tmp_path, f'def Camera "C" {{\n    float {name} = {value}\n}}\n').proven()
    assert "camera-invalid" in done.warnings("/C")
    assert not done.gltf.cameras


@pytest.mark.parametrize("rate", ["nan", "inf", "1e-45", "1e300", "-1"])
def test_time_rates_beyond_all_clocks_are_taken_as_24(tmp_path: Path, rate: str) -> None:
    moves = "double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 12: (1, 0, 0) }"
    text = text_of(
        "convert_light_camera/time_rates_beyond_all_clocks_are_taken_as_24.usda",
        rate=rate,
        moves=moves,
    )
    done = convert_text(tmp_path, text)
    assert "time-rate-invalid" in done.warnings()
    times = done.array(done.gltf.animations[0].samplers[0].input)
    assert times.reshape(-1).tolist() == [0.0, 0.5]
