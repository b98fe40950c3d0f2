"""Stages as artists' programs write them: nothing of them is lost silently or converted wrongly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from material_stages import noise, save
from read_converted import Converted, convert_text
from reflet_usd.validate.khronos import check_files
from reflet_usd.validate.validation import validate_file

GRID = """
    uniform token subdivisionScheme = "none"
    int[] faceVertexCounts = [4, 4, 4, 4]
    int[] faceVertexIndices = [0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6, 4, 5, 8, 7]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (1, 1, 0.5), (2, 1, 0),
        (0, 2, 0), (1, 2, 0), (2, 2, 0)]
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.5)] (
        interpolation = "faceVarying"
    )
    int[] primvars:st:indices = [0, 1, 2, 3, 0, 1, 4, 3, 3, 2, 1, 0, 0, 4, 2, 3]
"""


def material(name: str, inputs: str, nodes: str = "") -> str:
    """Scene text of a UsdPreviewSurface at the root."""
    return f"""
def Material "{name}"
{{
    token outputs:surface.connect = </{name}/S.outputs:surface>
    def Shader "S"
    {{
        uniform token info:id = "UsdPreviewSurface"
        {inputs}
        token outputs:surface
    }}
    {nodes}
}}
"""


RED = material("Red", "color3f inputs:diffuseColor = (1, 0, 0)")
BLUE = material("Blue", "color3f inputs:diffuseColor = (0, 0, 1)")


def proven(folder: Path, text: str) -> Converted:
    """Convert a stage and assert that the validator passes its file."""
    done = convert_text(folder, text)
    validation = validate_file(done.out, folder / "stage.usda", khronos=False)
    assert validation.passed, [check.to_json() for check in validation.checks if not check.passed]
    return done


def colors_of(done: Converted, prim: str) -> list[list[float]]:
    """Base colors of the prim's primitives."""
    mesh = done.gltf.meshes[done.gltf.nodes[done.node(prim)].mesh]
    found = [done.gltf.materials[primitive.material] for primitive in mesh.primitives]
    return [entry.pbrMetallicRoughness.baseColorFactor[:3] for entry in found]


def test_value_clips_jump_from_one_to_the_next(tmp_path: Path, khronos: None) -> None:
    for number, ends in enumerate(((0, 10), (10, -20))):
        (tmp_path / f"clip.{number}.usda").write_text(
            '#usda 1.0\nover "Model"\n{\n    double3 xformOp:translate.timeSamples = '
            f"{{ 1: ({ends[0]}, 0, 0), 13: ({ends[1]}, 5, 0) }}\n}}\n"
        )
    (tmp_path / "clip.manifest.usda").write_text(
        '#usda 1.0\nover "Model"\n{\n    double3 xformOp:translate\n}\n'
    )
    text = """
def Xform "World" (
    clips = {
        dictionary default = {
            asset[] assetPaths = [@./clip.0.usda@, @./clip.1.usda@]
            string primPath = "/Model"
            asset manifestAssetPath = @./clip.manifest.usda@
            double2[] active = [(1, 0), (13, 1)]
            double2[] times = [(1, 1), (13, 13), (13, 1), (25, 13)]
        }
    }
)
{
    double3 xformOp:translate
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Cube "C"
    {
    }
}
"""
    done = proven(tmp_path, text)
    assert check_files([done.out])[0].errors == 0
    for code, place in ((12.9999, (10, 5)), (13.0, (10, 0)), (19.0, (-5, 2.5))):
        world = done.world((code - 1) / 24)[done.node("/World")]
        assert world[:2, 3] == pytest.approx(place, abs=1e-3)


def test_keys_closer_than_single_precision(tmp_path: Path, khronos: None) -> None:
    keys = "0: 0, 1: 1, 1.00000001: 2, 1.00000002: 3, 2: 9"
    text = f"""
def Cube "C"
{{
    double xformOp:translateX.timeSamples = {{ {keys} }}
    uniform token[] xformOpOrder = ["xformOp:translateX"]
}}
"""
    done = convert_text(tmp_path, text)
    assert check_files([done.out])[0].errors == 0
    for code, place in ((0.5, 0.5), (1.001, 3.006), (2, 9)):
        assert done.world(code / 24)[done.node("/C")][0, 3] == pytest.approx(place, abs=1e-3)


def test_bindings_by_purpose(tmp_path: Path) -> None:
    text = f"""
def Xform "G" (
    prepend apiSchemas = ["MaterialBindingAPI"]
)
{{
    rel material:binding:full = </Red> (bindMaterialAs = "strongerThanDescendants")
    rel material:binding:preview = </Blue>
    rel material:binding:collection:preview:some = [</G.collection:some>, </Blue>]
    uniform token collection:some:expansionRule = "expandPrims"
    def Sphere "S" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {{
        rel material:binding = </Blue>
    }}
    def Mesh "M" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {{{GRID}
        rel material:binding = </Blue>
    }}
}}
{RED}{BLUE}
"""
    done = proven(tmp_path, text)
    assert colors_of(done, "/G/S") == colors_of(done, "/G/M") == [[1, 0, 0]]
    assert done.warnings("/G/S") == done.warnings("/G/M") == {"binding-purpose-dropped"}
    assert done.warnings("/G") == set()


def test_a_binding_for_previews_alone_counts(tmp_path: Path) -> None:
    text = f"""
def Xform "G" (
    prepend apiSchemas = ["MaterialBindingAPI", "CollectionAPI:some"]
)
{{
    rel material:binding:collection:preview:some = [</G.collection:some>, </Blue>]
    rel material:binding:odd = </Red>
    uniform token collection:some:expansionRule = "expandPrims"
    rel collection:some:includes = </G/S>
    def Sphere "S"
    {{
    }}
    def Mesh "M" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {{{GRID}
        rel material:binding:preview = </Blue>
    }}
}}
{BLUE}{RED}
"""
    done = proven(tmp_path, text)
    assert colors_of(done, "/G/S") == colors_of(done, "/G/M") == [[0, 0, 1]]
    assert done.warnings("/G") == {"binding-purpose-dropped"}
    assert done.warnings("/G/S") == done.warnings("/G/M") == set()


def test_a_face_in_several_subsets_is_the_first_ones(tmp_path: Path) -> None:
    text = f"""
def Mesh "M"
{{{GRID}
    uniform token subsetFamily:materialBind:familyType = "unrestricted"
    def GeomSubset "a" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {{
        uniform token familyName = "materialBind"
        int[] indices = [0, 1, 2]
        rel material:binding = </Red>
    }}
    def GeomSubset "b" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {{
        uniform token familyName = "materialBind"
        int[] indices = [2, 3, 3]
        rel material:binding = </Blue>
    }}
}}
{RED}{BLUE}
"""
    done = proven(tmp_path, text)
    assert colors_of(done, "/M") == [[1, 0, 0], [0, 0, 1]]
    parts = done.gltf.meshes[0].primitives
    assert [done.gltf.accessors[part.indices].count for part in parts] == [18, 6]
    assert done.warnings("/M/b") == {"subset-overlap"}


def test_one_subset_reads_a_uv_set_that_is_not_there(tmp_path: Path) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    nodes = """
    def Shader "T"
    {
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @t.png@
        float2 inputs:st.connect = </Map/R.outputs:result>
        token inputs:wrapS = "repeat"
        token inputs:wrapT = "repeat"
        float3 outputs:rgb
    }
    def Shader "R"
    {
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "map1"
        float2 outputs:result
    }
"""
    text = f"""
def Mesh "M" (
    prepend apiSchemas = ["MaterialBindingAPI"]
)
{{{GRID}
    rel material:binding = </Map>
    def GeomSubset "a" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {{
        uniform token familyName = "materialBind"
        int[] indices = [0, 3]
        rel material:binding = </Red>
    }}
}}
{RED}{material("Map", "color3f inputs:diffuseColor.connect = </Map/T.outputs:rgb>", nodes)}
"""
    assert "uv-missing" in proven(tmp_path, text).warnings("/M")


@pytest.mark.parametrize("kind", ["Points", "BasisCurves"])
def test_points_and_curves_that_move_stand_still_and_are_named(tmp_path: Path, kind: str) -> None:
    text = f"""
def {kind} "P"
{{
    uniform token type = "linear"
    int[] curveVertexCounts = [2]
    point3f[] points.timeSamples = {{ 1: [(0, 0, 0), (1, 1, 1)], 9: [(3, 0, 0), (1, 1, 1)] }}
    float[] widths.timeSamples = {{ 1: [1, 1], 9: [2, 2] }}
}}
"""
    done = proven(tmp_path, text)
    expected = {"geometry-animation-frozen", "points-animation-frozen", "width-dropped"}
    assert done.warnings("/P") == expected


def test_tiled_images_of_materialx(tmp_path: Path) -> None:
    save(tmp_path, "t.png", noise("RGB"))
    text = f"""
def Mesh "M" (
    prepend apiSchemas = ["MaterialBindingAPI"]
)
{{{GRID}
    rel material:binding = </Mat>
}}
def Material "Mat"
{{
    token outputs:mtlx:surface.connect = </Mat/S.outputs:out>
    def Shader "S"
    {{
        uniform token info:id = "ND_standard_surface_surfaceshader"
        color3f inputs:base_color.connect = </Mat/D.outputs:out>
        token outputs:out
    }}
    def Shader "D"
    {{
        uniform token info:id = "ND_tiledimage_color3"
        asset inputs:file = @t.png@ (colorSpace = "srgb_texture")
        float2 inputs:uvtiling = (3, 2)
        float2 inputs:uvoffset = (0.25, 0.1)
        color3f outputs:out
    }}
}}
"""
    done = proven(tmp_path, text)
    info = done.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
    assert info["extensions"]["KHR_texture_transform"]["scale"] == [3, 2]


def test_one_value_colors_a_whole_gprim(tmp_path: Path) -> None:
    text = "".join(
        f'def {kind} "{kind}{way}"\n{{\n    color3f[] primvars:displayColor = [(1, 0, 0)] '
        f'(interpolation = "{way}")\n}}\n'
        for kind in ("Sphere", "Plane", "Cylinder")
        for way in ("uniform", "vertex", "faceVarying")
    )
    done = proven(tmp_path, text)
    assert done.warnings() == set()
    found = {tuple(m.pbrMetallicRoughness.baseColorFactor) for m in done.gltf.materials}
    assert found == {(1, 0, 0, 1)}


def test_points_of_no_curve_are_not_in_the_file(tmp_path: Path) -> None:
    text = """
def BasisCurves "C"
{
    uniform token type = "linear"
    int[] curveVertexCounts = [2, 1]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (50, 50, 50)]
}
"""
    done = proven(tmp_path, text)
    part = done.json["meshes"][0]["primitives"][0]
    points = done.array(part["attributes"]["POSITION"])
    assert np.array_equal(points, [[0, 0, 0], [1, 0, 0]])


def test_cameras_and_lights_of_an_instancer_are_told_apart(tmp_path: Path, khronos: None) -> None:
    text = f"""
def PointInstancer "I"
{{
    rel prototypes = </I/P>
    int[] protoIndices = [0, 0, 0]
    point3f[] positions = [(0, 0, 0), (9, 0, 0), (0, 9, 0)]
    float3[] scales = [(1, 1, 1), (1, -1, 1), (2, 1, 0.5)]
    def Xform "P"
    {{
        double xformOp:rotateZ.timeSamples = {{ 0: 0, 24: 540 }}
        uniform token[] xformOpOrder = ["xformOp:rotateZ"]
        def Mesh "M"
        {{{GRID.replace("point3f[] points = [", "point3f[] points.timeSamples = { 0: [")[:-1]}
        }}
        def SphereLight "L"
        {{
        }}
        def Camera "C"
        {{
            token visibility.timeSamples = {{ 0: "inherited", 12: "invisible" }}
        }}
    }}
}}
"""
    first = text.split("point3f[] points.timeSamples = { 0: [")[1].split("]")[0]
    moved = first.replace("0.5)", "2.5)")
    text = text.replace(f"{first}]", f"{first}], 24: [{moved}] }}", 1)
    done = proven(tmp_path, text)
    assert check_files([done.out])[0].errors == 0
    assert done.warnings("/I/P/C") == set()
    for node in done.gltf.nodes:
        if node.extensions:
            node.translation = [1.0, 2.0, 3.0]
    done.gltf.save_binary(str(done.out))
    validation = validate_file(done.out, tmp_path / "stage.usda", khronos=False)
    assert not next(check for check in validation.checks if check.name == "lights").passed


@pytest.mark.parametrize("chosen", ["", "missing"])
def test_variants_that_nothing_selects_are_named(tmp_path: Path, chosen: str) -> None:
    text = f"""
def Xform "W" (
    variants = {{
        string v = "{chosen}"
    }}
    prepend variantSets = "v"
)
{{
    variantSet "v" = {{
        "a" {{
            def Cube "A"
            {{
            }}
        }}
    }}
}}
def Sphere "S"
{{
    color3f[] primvars:displayColor = [(2, -1, 0.5)]
}}
"""
    done = proven(tmp_path, text)
    assert done.warnings("/W") == {"variants-not-carried"}
    assert done.warnings("/S") == {"color-clamped"}
