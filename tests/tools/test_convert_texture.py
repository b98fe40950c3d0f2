"""Owns the tests of textures: copied, packed, recoded, transformed, lost."""

import math
import random
import struct
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest
from material_stages import image, material, noise, pixels, save, shaded, stage, texture
from PIL import Image
from read_converted import convert_text
from tampering import Output, expect_found, expect_required
from test_validate_strict import expect_tree_found
from texts import text_of

COLOR = "color3f inputs:diffuseColor.connect = </Mat/T.outputs:rgb>"


@pytest.mark.parametrize(("name", "options"), [("a.png", {}), ("a.jpg", {"quality": 90})])
def test_a_color_map_is_copied_byte_for_byte(
    tmp_path: Path, name: str, options: dict[str, Any]
) -> None:
    data = save(tmp_path, name, noise("RGB"), **options)
    body = "float4 inputs:scale = (0.5, 0.25, 1, 1)"
    done = shaded(tmp_path, COLOR, texture("T", name, body))
    pbr = material(done)["pbrMetallicRoughness"]
    assert image(done, pbr["baseColorTexture"]) == data
    assert pbr["baseColorFactor"] == [0.5, 0.25, 1, 1]
    sampler = done.gltf.samplers[done.gltf.textures[0].sampler]
    assert (sampler.wrapS, sampler.wrapT) == (10497, 10497)


def test_separate_maps_are_packed_losslessly(tmp_path: Path) -> None:
    rough, metal = noise("L", seed=1), noise("L", seed=2)
    occlusion = noise("L", seed=3)
    for name, data in (("r.png", rough), ("m.png", metal), ("o.png", occlusion)):
        save(tmp_path, name, data)
    done = shaded(
        tmp_path,
        "float inputs:roughness.connect = </Mat/R.outputs:r>\n"
        "float inputs:metallic.connect = </Mat/Me.outputs:r>\n"
        "float inputs:occlusion.connect = </Mat/O.outputs:r>",
        texture("R", "r.png") + texture("Me", "m.png") + texture("O", "o.png"),
    )
    found = material(done)
    packed = pixels(done, found["pbrMetallicRoughness"]["metallicRoughnessTexture"])
    assert np.array_equal(packed[..., 1], rough)
    assert np.array_equal(packed[..., 2], metal)
    assert np.array_equal(pixels(done, found["occlusionTexture"])[..., 0], occlusion)


def test_a_packed_map_in_gltf_order_is_copied(tmp_path: Path) -> None:
    data = save(tmp_path, "orm.png", noise("RGB"))
    space = 'token inputs:sourceColorSpace = "raw"'
    done = shaded(
        tmp_path,
        "float inputs:occlusion.connect = </Mat/T.outputs:r>\n"
        "float inputs:roughness.connect = </Mat/T.outputs:g>\n"
        "float inputs:metallic.connect = </Mat/T.outputs:b>",
        texture("T", "orm.png", space),
    )
    found = material(done)
    assert image(done, found["pbrMetallicRoughness"]["metallicRoughnessTexture"]) == data
    assert len(done.gltf.images) == 1


@pytest.mark.parametrize("space", ["auto", "sRGB", "raw"])
def test_color_spaces_of_scalar_maps(tmp_path: Path, space: str) -> None:
    data = noise("RGB")
    save(tmp_path, "t.png", data)
    done = shaded(
        tmp_path,
        "float inputs:roughness.connect = </Mat/T.outputs:b>",
        texture("T", "t.png", f'token inputs:sourceColorSpace = "{space}"'),
    )
    info = material(done)["pbrMetallicRoughness"]["metallicRoughnessTexture"]
    encoded = data[..., 2] / 255
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    expected = encoded if space == "raw" else linear
    assert pixels(done, info)[..., 1] / 255 == pytest.approx(expected, abs=0.51 / 255)


def test_scale_and_bias_beyond_a_factor_are_written_into_texels(tmp_path: Path) -> None:
    data = noise("L")
    save(tmp_path, "t.png", data)
    body = "float4 inputs:scale = (2, 1, 1, 1)\nfloat4 inputs:bias = (-0.5, 0, 0, 0)"
    done = shaded(
        tmp_path, "float inputs:roughness.connect = </Mat/T.outputs:r>", texture("T", "t.png", body)
    )
    info = material(done)["pbrMetallicRoughness"]["metallicRoughnessTexture"]
    expected = np.clip(data / 255 * 2 - 0.5, 0, 1)
    assert pixels(done, info)[..., 1] / 255 == pytest.approx(expected, abs=0.51 / 255)
    assert "texture-repacked" in done.warnings("/Mat/T")


@pytest.mark.parametrize("threshold", [0.0, 0.4])
def test_opacity_from_another_map(tmp_path: Path, threshold: float) -> None:
    color, alpha = noise("RGB", seed=4), noise("L", seed=5)
    save(tmp_path, "c.png", color)
    save(tmp_path, "o.png", alpha)
    done = shaded(
        tmp_path,
        "color3f inputs:diffuseColor.connect = </Mat/C.outputs:rgb>\n"
        "float inputs:opacity.connect = </Mat/O.outputs:r>\n"
        f"float inputs:opacityThreshold = {threshold}",
        texture("C", "c.png") + texture("O", "o.png"),
    )
    found = material(done)
    packed = pixels(done, found["pbrMetallicRoughness"]["baseColorTexture"])
    assert np.array_equal(packed[..., :3], color)
    assert np.array_equal(packed[..., 3], alpha)
    assert found["alphaMode"] == ("MASK" if threshold else "BLEND")
    assert found.get("alphaCutoff", 0.0) == pytest.approx(threshold)
    assert ("opacity-approximated" in done.warnings()) == (threshold == 0.0)


def test_an_opaque_alpha_channel_stays_opaque(tmp_path: Path) -> None:
    color = noise("RGBA")
    color[..., 3] = 255
    data = save(tmp_path, "c.png", color)
    done = shaded(
        tmp_path,
        "color3f inputs:diffuseColor.connect = </Mat/C.outputs:rgb>\n"
        "float inputs:opacity.connect = </Mat/C.outputs:a>",
        texture("C", "c.png"),
    )
    found = material(done)
    assert found.get("alphaMode", "OPAQUE") == "OPAQUE"
    assert image(done, found["pbrMetallicRoughness"]["baseColorTexture"]) == data


@pytest.mark.parametrize(
    ("scale", "bias", "copied", "strength"),
    [
        ((2, 2, 2, 1), (-1, -1, -1, 0), True, 1.0),
        ((1, 1, 2, 1), (-0.5, -0.5, -1, 0), True, 0.5),
        ((2, -2, 2, 1), (-1, 1, -1, 0), False, 1.0),
    ],
)
def test_normal_maps(
    tmp_path: Path, scale: tuple, bias: tuple, copied: bool, strength: float
) -> None:
    data = noise("RGB")
    raw = save(tmp_path, "n.png", data)
    body = f"float4 inputs:scale = {scale}\nfloat4 inputs:bias = {bias}\n"
    body += 'token inputs:sourceColorSpace = "raw"'
    done = shaded(
        tmp_path,
        "normal3f inputs:normal.connect = </Mat/N.outputs:rgb>",
        texture("N", "n.png", body),
    )
    info = material(done)["normalTexture"]
    assert (image(done, info) == raw) == copied
    wanted = data / 255 * np.array(scale[:3]) + np.array(bias[:3])
    found = pixels(done, info)[..., :3] / 255 * 2 - 1
    found[..., :2] *= info.get("scale", 1.0)
    assert info.get("scale", 1.0) == strength
    assert found == pytest.approx(wanted, abs=1.01 / 255)


def test_texture_transform_for_any_parameters(tmp_path: Path) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    random = np.random.default_rng(5)
    for _ in range(6):
        scale, move = (
            random.uniform(-3, 3, 2).tolist(),
            random.uniform(-2, 2, 2).tolist(),
        )
        degrees = float(random.uniform(-360, 360))
        node = text_of(
            "convert_texture/texture_transform_for_any_parameters.usda",
            scale_0=scale[0],
            scale_1=scale[1],
            degrees=degrees,
            move_0=move[0],
            move_1=move[1],
        )
        done = shaded(tmp_path, COLOR, node + texture("T", "t.png", st="/Mat/X.outputs:result"))
        info = material(done)["pbrMetallicRoughness"]["baseColorTexture"]
        transform = info["extensions"]["KHR_texture_transform"]
        st = random.uniform(-2, 2, (20, 2))
        # UsdTransform2d: scale, then rotate counterclockwise, then translate.
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        wanted = (st * scale) @ np.array([[c, s], [-s, c]]) + move
        # KHR_texture_transform as engines implement it (glTF issue 1563), on uv = (s, 1 - t).
        uv = np.stack([st[:, 0], 1 - st[:, 1]], 1) * transform.get("scale", (1, 1))
        r = transform.get("rotation", 0.0)
        u = math.cos(r) * uv[:, 0] + math.sin(r) * uv[:, 1]
        v = -math.sin(r) * uv[:, 0] + math.cos(r) * uv[:, 1]
        found = np.stack([u, v], 1) + transform.get("offset", (0, 0))
        assert np.stack([found[:, 0], 1 - found[:, 1]], 1) == pytest.approx(wanted, abs=1e-5)


@pytest.mark.parametrize(
    ("wrap", "end", "mode", "warned"),
    [
        ("clamp", 2, 33071, False),
        ("mirror", 2, 33648, False),
        ("black", 2, 33071, True),
        ("black", 1, 33071, False),  # nothing is read outside of the texture
    ],
)
def test_wrap_modes(tmp_path: Path, wrap: str, end: int, mode: int, warned: bool) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    text = stage(COLOR, texture("T", "t.png").replace('"repeat"', f'"{wrap}"'))
    corners = "[(0,0), ({0},0), ({0},{0}), (0,{0})]"
    assert corners.format(1) in text
    done = convert_text(tmp_path, text.replace(corners.format(1), corners.format(end)))
    assert done.gltf.samplers[0].wrapS == mode
    assert ("wrap-black-clamped" in done.warnings()) == warned


@pytest.mark.parametrize(
    ("content", "warning"),
    [
        (None, "texture-missing"),
        (b"not an image", "texture-unreadable"),
        (b"cut", "texture-unreadable"),
    ],
)
def test_lost_textures_leave_their_fallback(
    tmp_path: Path, content: bytes | None, warning: str
) -> None:
    if content == b"cut":
        content = save(tmp_path, "t.png", noise("RGB", (64, 64)))[:-2000]
    if content is not None:
        (tmp_path / "t.png").write_bytes(content)
    node = texture("T", "t.png", "float4 inputs:fallback = (0.25, 0.5, 0.75, 1)")
    done = shaded(tmp_path, COLOR, node)
    assert warning in done.warnings("/Mat/T")
    pbr = material(done)["pbrMetallicRoughness"]
    assert pbr["baseColorFactor"] == pytest.approx([0.25, 0.5, 0.75, 1])
    assert not done.gltf.images


def test_other_image_formats_become_png(tmp_path: Path) -> None:
    data = noise("RGB")
    half = Image.fromarray(data[::2, ::2])
    more = [half, Image.new("RGB", (3, 3))]
    for name, pages, end in [
        ("t.tga", {}, "PNG"),
        ("t.tiff", {}, "PNG"),
        ("t.tiff", {"save_all": True, "append_images": more[1:]}, "PNG; pictures after these"),
        ("t.tiff", {"save_all": True, "append_images": [half], "tiffinfo": {254: 2}}, "PNG; p"),
        ("t.tiff", {"save_all": True, "append_images": more}, "PNG, and KTX2 with 1 of its mip"),
    ]:
        Image.fromarray(data).save(tmp_path / name, **pages)
        done = shaded(tmp_path, COLOR, texture("T", name))
        info = material(done)["pbrMetallicRoughness"]["baseColorTexture"]
        assert np.array_equal(pixels(done, info)[..., :3], data)
        assert "texture-converted" in done.warnings("/Mat/T")
        said = [w["message"] for w in done.sidecar["warnings"] if w["name"] == "texture-converted"]
        assert end in said[0] and ("after these" in said[0]) == bool(pages)
        if "KTX2" in end:
            extension = done.gltf.textures[0].extensions["KHR_texture_basisu"]
            view = done.gltf.bufferViews[done.gltf.images[extension["source"]].bufferView]
            file = done.gltf.binary_blob()[view.byteOffset :][: view.byteLength]
            levels = file[-4 * data[..., 0].size * 5 // 4 :]  # the smallest stands first
            assert levels == b"".join(
                half.convert("RGBA").tobytes() for half in (half, Image.fromarray(data))
            )


@pytest.mark.parametrize("workflow", [0, 1])
@pytest.mark.parametrize("name", ["ior", "opacityThreshold", "useSpecularWorkflow"])
def test_textures_of_single_numbers_are_named(tmp_path: Path, name: str, workflow: int) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    inputs = f"float inputs:{name}.connect = </Mat/T.outputs:r>\nfloat inputs:metallic = 0.25\n"
    if name != "useSpecularWorkflow":
        inputs += f"int inputs:useSpecularWorkflow = {workflow}\n"
    done = shaded(tmp_path, inputs, texture("T", "t.png"))
    if (name, workflow) == ("ior", 1):  # the specular workflow has no ior
        assert done.validated().passed
    else:
        expect_required(done, "material-texture-dropped", "/Mat", name)


def keyed(folder: Path, mode: str) -> None:
    """A PNG of which one color is transparent by a tRNS chunk."""
    picture = Image.fromarray(noise("RGB", (8, 8)))
    if mode == "I;16":
        picture = Image.fromarray(np.arange(64, dtype=np.uint16).reshape(8, 8) * 500)
        key: Any = 1000
    else:
        picture = picture.convert(mode)
        key = picture.getpixel((3, 2))
    picture.save(folder / "t.png", transparency=key)


@pytest.mark.parametrize("mode", ["RGB", "L", "I;16"])
def test_a_color_that_is_transparent_stays_so(tmp_path: Path, mode: str) -> None:
    keyed(tmp_path, mode)
    inputs = f"{COLOR}\nfloat inputs:opacity.connect = </Mat/T.outputs:a>"
    done = shaded(tmp_path, inputs, texture("T", "t.png")).proven()
    look = material(done)
    assert look["alphaMode"] == "BLEND"
    alpha = pixels(done, look["pbrMetallicRoughness"]["baseColorTexture"])[..., 3]
    assert (alpha == 0).sum() >= 1
    assert (alpha == 255).sum() >= 32
    del look["alphaMode"]
    expect_tree_found(done, done.json)


def test_a_transparent_color_that_nothing_reads_does_not_show(tmp_path: Path) -> None:
    keyed(tmp_path, "RGB")
    done = shaded(tmp_path, f"{COLOR}\nfloat inputs:opacity = 0.5", texture("T", "t.png")).proven()
    info = material(done)["pbrMetallicRoughness"]["baseColorTexture"]
    assert (pixels(done, info)[..., 3] == 255).all()


def test_formats_that_need_other_programs_are_not_opened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from PIL import EpsImagePlugin

    def start(*_: Any, **__: Any) -> None:
        raise AssertionError("Ghostscript was started")

    monkeypatch.setattr(EpsImagePlugin, "Ghostscript", start)
    eps = "%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 8 8\n%%EndComments\nshowpage\n%%EOF\n"
    (tmp_path / "a.png").write_text(eps, encoding="ascii")
    done = shaded(tmp_path, COLOR, texture("T", "a.png", ""))
    assert "texture-unreadable" in done.warnings()
    assert not done.gltf.images


@pytest.mark.parametrize(("channels", "peak"), [("RGB", 1.0), ("RGBA", 4.0), ("Y", 1.0)])
def test_openexr_is_linear_and_becomes_png(tmp_path: Path, channels: str, peak: float) -> None:
    import OpenEXR

    random = np.random.default_rng(7)
    values = (random.random((4, 8, len(channels))) * peak).astype(np.float16)
    values[0, 0, 0] = np.nan
    planes = {name: np.ascontiguousarray(values[..., i]) for i, name in enumerate(channels)}
    file = OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION}, planes)
    file.write(str(tmp_path / "t.exr"))
    done = shaded(
        tmp_path,
        f"{COLOR}\nfloat inputs:roughness.connect = </Mat/T.outputs:r>",
        texture("T", "t.exr"),
    ).proven()
    pbr = material(done)["pbrMetallicRoughness"]
    linear = np.clip(np.nan_to_num(values.astype(np.float64)), 0.0, 1.0)
    low = linear * 12.92
    srgb = np.where(linear <= 0.0031308, low, 1.055 * linear ** (1 / 2.4) - 0.055)
    shown = pixels(done, pbr["baseColorTexture"])[..., :3] / 255
    assert shown == pytest.approx(np.broadcast_to(srgb[..., :3], shown.shape), abs=0.51 / 255)
    rough = pixels(done, pbr["metallicRoughnessTexture"])[..., 1] / 255
    assert rough == pytest.approx(linear[..., 0], abs=0.51 / 255)
    assert "texture-converted" in done.warnings("/Mat/T")


@pytest.mark.parametrize("damage", ["cut", "large", "noise"])
def test_broken_openexr_is_named(tmp_path: Path, damage: str) -> None:
    from gltf_mutant_decoders import exr

    data = exr(random.Random(3))
    broken = {
        "cut": data[:300],
        "large": data.replace(
            struct.pack("<4i", 0, 0, 63, 31), struct.pack("<4i", 0, 0, 65535, 65535)
        ),
        "noise": data[:4] + bytes(range(256)) * 4,
    }
    (tmp_path / "t.exr").write_bytes(broken[damage])
    inputs = "float inputs:roughness.connect = </Mat/T.outputs:r>"
    done = shaded(tmp_path, inputs, texture("T", "t.exr"))
    assert "texture-unreadable" in done.warnings("/Mat/T")


@pytest.mark.parametrize("turn", [0, 30])
@pytest.mark.parametrize("format", ["png", "exr"])
def test_udim_tiles_are_one_image(tmp_path: Path, turn: float, format: str) -> None:
    def swap(_: Output) -> None:
        first, other = (tmp_path / f"t.{number}.{format}" for number in (1001, 1012))
        first.rename(tmp_path / "t")
        other.rename(first)
        (tmp_path / "t").rename(other)

    random = np.random.default_rng(4)
    for number in (1001, 1002, 1012):
        texels = random.random((4, 4, 3)).astype(np.float32)
        if format == "png":
            Image.fromarray((255 * texels).astype(np.uint8)).save(tmp_path / f"t.{number}.png")
        else:
            header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
            OpenEXR.File(header, {"RGB": texels}).write(str(tmp_path / f"t.{number}.exr"))
    text = text_of("convert_texture/udim.usda", turn=turn, format=format)
    done = convert_text(tmp_path, text)
    assert done.warnings() <= {"texture-converted"}
    assert len(done.json["images"]) == 1
    expect_found(done, swap)
