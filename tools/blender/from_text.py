"""Renders a scene text by Cycles: the subset that docs/light.md compares.

Runs in Blender's Python (the package `bpy`):

    .venv-bpy/bin/python tools/blender/from_text.py SCENE.toml 384x256 BOUNCES SAMPLES...

writes SCENE.cycles.N.exr for each number of samples, the N-th with seed N, and a line with the
seconds of processor time of each. The first one includes the start of Cycles.
"""

import math
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import bpy
import tomllib

import scenes

Table = dict[str, Any]


def upright(v: Sequence[float]) -> tuple[float, float, float]:
    """A vector with Z up, from one with Y up."""
    return v[0], -v[2], v[1]


def surface(name: str, text: Table) -> bpy.types.Material:
    """Material by single scattering on facets, as in glTF."""
    color, roughness = text.get("base_color", (1, 1, 1)), text.get("roughness", 1.0)
    metallic = text.get("metallic", 0)
    if any(text.get("emission", ())):
        strength = text.get("emission_strength", 1.0)
        return scenes.plain(name, "ShaderNodeEmission", text["emission"], Strength=strength)
    if text.get("reflectivity") == 0 and metallic == 0:
        return scenes.plain(name, "ShaderNodeBsdfDiffuse", color)
    if text.get("transmission") == 1:
        ior = text["ior"]
        made = scenes.plain(name, "ShaderNodeBsdfGlass", color, Roughness=roughness, IOR=ior)
    else:
        coat = {"Coat_Weight": text.get("clearcoat", 0), "Coat_Roughness": 0}
        made = scenes.principled(name, color, Metallic=metallic, Roughness=roughness, **coat)
    for node in made.node_tree.nodes:
        if hasattr(node, "distribution"):
            node.distribution = "GGX"
    return made


def thing(name: str, shape: Table, place: Table, look: bpy.types.Material) -> None:
    size = shape.get("size", (1, 1, 1))
    if shape["kind"] == "sphere":
        made = scenes.ball(name, (0, 0, 0), shape["radius"], look)
    elif shape["kind"] == "box":
        made = scenes.box(name, (0, 0, 0), (size[0], size[2], size[1]), look)
    else:
        made = scenes.floor(look, size[0])
    made.location = upright(place.get("translation", (0, 0, 0)))
    made.rotation_mode = "XZY"
    made.rotation_euler = upright([math.radians(a) for a in place.get("rotation_deg", (0, 0, 0))])


def make(text: Table, folder: Path) -> None:
    """Make the whole scene; files are searched in `folder`."""
    view, world = text["camera"]["main"], text["environment"]
    scenes.camera(upright(view["eye"]), upright(view["target"]), view["fov_deg"])
    if "file" in world:
        # A panorama's middle is +X in Blender and +Z in Reflet.
        scenes.panorama(bpy.data.images.load(str(folder / world["file"])), 90)
    else:
        scenes.sky(world["color"])
    for lamp in text.get("light", {}).values():
        width, height = lamp["size"]
        shape = {"shape": "RECTANGLE", "size": width, "size_y": height}
        places = upright(lamp["position"]), upright(lamp["target"])
        scenes.light("AREA", *places, math.pi * lamp["intensity_cd"], **shape)
    looks = {name: surface(name, each) for name, each in text["material"].items()}
    for place in text["instance"]:
        model = text["model"][place["model"]]
        thing(place["model"], model["shape"], place, looks[model["material"]])


def main() -> None:
    path, size, bounces, *counts = sys.argv[1:]
    scene = scenes.empty()
    make(tomllib.loads(Path(path).read_text()), Path(path).parent)
    scene.render.resolution_x, scene.render.resolution_y = map(int, size.split("x"))
    took = []
    for seed, samples in enumerate(counts):
        started = time.process_time()
        scene.cycles.seed = seed
        picture = Path(path).with_suffix(f".cycles.{seed}.exr")
        scenes.render_cycles(scene, picture, int(samples), int(bounces))
        took.append(time.process_time() - started)
    print("seconds", *took)


if __name__ == "__main__":
    main()
