"""Makes eleven small scenes in Blender, to be rendered by Cycles and, exported, by Reflet.

Runs in Blender's Python (the package `bpy`):

    .venv-bpy/bin/python tools/blender/scenes.py OUT [NAME ...] [--size 192x108] [--samples 256]

writes OUT/NAME/project and, by Cycles, OUT/NAME/cycles.exr.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).resolve().parent))

from reflet_blender.export import Options, export_project

Color = Sequence[float]


def principled(name: str, color: Color = (0.8, 0.8, 0.8), **inputs: object) -> bpy.types.Material:
    """A Principled material; further inputs by their names with `_` for spaces."""
    return plain(name, "ShaderNodeBsdfPrincipled", color, **inputs)


def plain(name: str, kind: str, color: Color, **inputs: object) -> bpy.types.Material:
    """A material of one node, such as `ShaderNodeBsdfDiffuse`, whose first input is its color."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    shader, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    shader.inputs[0].default_value = (*color, 1)
    for key, value in inputs.items():
        shader.inputs[key.replace("_", " ")].default_value = value
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def add(thing: bpy.types.Object) -> bpy.types.Object:
    """Link a new object into the scene."""
    bpy.context.scene.collection.objects.link(thing)
    return thing


def ball(name: str, at: Color, radius: float, material: bpy.types.Material) -> bpy.types.Object:
    """A smooth ball."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=96, ring_count=48, radius=radius, location=at)
    bpy.ops.object.shade_smooth()
    return _named(name, material)


def box(name: str, at: Color, size: Color, material: bpy.types.Material) -> bpy.types.Object:
    """A box of edge lengths `size`."""
    bpy.ops.mesh.primitive_cube_add(size=1, location=at)
    bpy.context.object.scale = size
    return _named(name, material)


def floor(material: bpy.types.Material, size: float = 12) -> bpy.types.Object:
    """A square in the plane z = 0."""
    bpy.ops.mesh.primitive_plane_add(size=size)
    return _named("floor", material)


def _named(name: str, material: bpy.types.Material) -> bpy.types.Object:
    thing = bpy.context.object
    thing.name = thing.data.name = name
    thing.data.materials.append(material)
    return thing


def camera(eye: Color, target: Color, fov_deg: float = 40) -> bpy.types.Object:
    """The active camera, which looks at `target`; the field of view is vertical."""
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.angle = "VERTICAL", math.radians(fov_deg)
    thing = add(bpy.data.objects.new("camera", data))
    thing.location = eye
    thing.rotation_euler = (Vector(target) - Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.camera = thing
    return thing


def light(kind: str, at: Color, target: Color, energy: float, **values: object) -> bpy.types.Object:
    """A light at `at` that shines towards `target`."""
    data = bpy.data.lights.new(kind.lower(), kind)
    data.energy = energy
    for key, value in values.items():
        setattr(data, key, value)
    thing = add(bpy.data.objects.new(kind.lower(), data))
    thing.location = at
    thing.rotation_euler = (Vector(target) - Vector(at)).to_track_quat("-Z", "Y").to_euler()
    return thing


def sky(color: Color, strength: float = 1) -> None:
    """A world of one color."""
    background = _world().nodes["Background"]
    background.inputs["Color"].default_value = (*color, 1)
    background.inputs["Strength"].default_value = strength


def panorama(image: bpy.types.Image, turn_deg: float, strength: float = 1) -> None:
    """A world of an image in longitude and latitude; lookups are turned about Z."""
    tree = _world()
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    mapping = tree.nodes.new("ShaderNodeMapping")
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    texture.image = image
    mapping.inputs["Rotation"].default_value = (0, 0, math.radians(turn_deg))
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    tree.nodes["Background"].inputs["Strength"].default_value = strength


def _world() -> bpy.types.NodeTree:
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    bpy.context.scene.world = world
    return world.node_tree


def spheres() -> None:
    """Matte, plastic, chrome and rough gold under a plain sky and a point light."""
    sky((0.3, 0.4, 0.6))
    floor(principled("ground", (0.4, 0.4, 0.4), Roughness=0.6))
    looks = {
        "matte": principled("matte", (0.7, 0.2, 0.1), Roughness=1.0),
        "plastic": principled("plastic", (0.1, 0.4, 0.15), Roughness=0.2),
        "chrome": principled("chrome", (0.9, 0.9, 0.9), Metallic=1.0, Roughness=0.02),
        "gold": principled("gold", (1.0, 0.71, 0.29), Metallic=1.0, Roughness=0.35),
    }
    for i, (name, look) in enumerate(looks.items()):
        ball(name, (1.1 * i - 1.65, 0, 0.5), 0.5, look)
    light("POINT", (1, -2, 3.5), (0, 0, 0), 200, shadow_soft_size=0.2)
    camera((0, -6, 2.2), (0, 0, 0.45), 30)


def glass() -> None:
    """Solid glass, colored glass and a pane before stripes."""
    sky((0.7, 0.75, 0.8))
    floor(principled("ground", (0.6, 0.55, 0.5), Roughness=0.8))
    for i in range(7):
        hue = (0.7, 0.15, 0.1) if i % 2 else (0.1, 0.25, 0.6)
        stripe = plain(f"stripe {i}", "ShaderNodeBsdfDiffuse", hue)
        box(f"stripe {i}", (0.9 * i - 2.7, 2, 1), (0.45, 0.1, 2), stripe)
    clear = principled("clear", (1, 1, 1), Transmission_Weight=1.0, Roughness=0.0, IOR=1.5)
    ball("clear ball", (-0.8, 0, 0.6), 0.6, clear)
    green = plain("green", "ShaderNodeBsdfGlass", (0.5, 0.9, 0.6), IOR=1.33, Roughness=0.0)
    ball("green ball", (0.7, -0.2, 0.5), 0.5, green)
    light("SUN", (3, -3, 5), (0, 0, 0), 2, angle=0.1)
    camera((0, -6, 1.6), (0, 0, 0.6), 30)


def area_light() -> None:
    """A room's corner under a rectangle and a disk."""
    sky((0, 0, 0))
    white = plain("white", "ShaderNodeBsdfDiffuse", (0.75, 0.75, 0.75))
    floor(white)
    box("wall", (0, 3, 2), (12, 0.1, 4), plain("wall", "ShaderNodeBsdfDiffuse", (0.3, 0.5, 0.7)))
    box("box", (-0.8, 0, 0.6), (0.8, 0.8, 1.2), white)
    ball("ball", (0.9, -0.2, 0.5), 0.5, principled("satin", (0.6, 0.3, 0.1), Roughness=0.3))
    light("AREA", (-2, -1, 3), (0, 0, 0.5), 150, shape="RECTANGLE", size=1.0, size_y=2.0)
    light("AREA", (2.5, -1, 2), (0, 0.5, 0.5), 40, shape="DISK", size=0.8, color=(1, 0.6, 0.3))
    camera((0, -6.5, 2.5), (0, 0, 0.7), 35)


def sun() -> None:
    """A sun low over boxes, with a sky."""
    sky((0.35, 0.5, 0.9), 0.6)
    floor(principled("sand", (0.6, 0.5, 0.35), Roughness=0.9), 30)
    for i in range(5):
        look = principled(f"stone {i}", (0.3 + 0.1 * i, 0.4, 0.5 - 0.08 * i), Roughness=0.7)
        box(
            f"stone {i}",
            (1.2 * i - 2.4, 0.4 * (i % 2), 0.4 + 0.2 * i),
            (0.7, 0.7, 0.8 + 0.4 * i),
            look,
        )
    light("SUN", (-4, -3, 3), (0, 0, 0), 3, angle=math.radians(2), color=(1, 0.85, 0.6))
    camera((0, -9, 3), (0, 0, 0.8), 32)


def spot() -> None:
    """Two spots, one with a soft edge and a temperature."""
    sky((0.01, 0.01, 0.015))
    floor(plain("ground", "ShaderNodeBsdfDiffuse", (0.6, 0.6, 0.6)))
    ball("ball", (0, 0, 0.5), 0.5, principled("red", (0.7, 0.1, 0.1), Roughness=0.4))
    box("post", (1.2, 0.6, 0.7), (0.2, 0.2, 1.4), principled("post", (0.5, 0.5, 0.5)))
    warm = {"use_temperature": True, "temperature": 3200}
    soft = {"spot_size": math.radians(50), "spot_blend": 0.6, "shadow_soft_size": 0.05}
    light("SPOT", (-2, -2, 3), (0, 0, 0.3), 300, **soft, **warm)
    hard = {"spot_size": math.radians(30), "spot_blend": 0.0, "shadow_soft_size": 0.02}
    light("SPOT", (3, -1, 3), (0.8, 0.4, 0), 200, color=(0.4, 0.6, 1), **hard)
    camera((0, -6, 2.6), (0, 0, 0.5), 35)


def world() -> None:
    """A panorama, turned, with a bright window, as the only light."""
    image = bpy.data.images.new("panorama", 256, 128, float_buffer=True)
    up, across = np.mgrid[0:128, 0:256]
    pixels = np.ones((128, 256, 4), np.float32)
    pixels[..., :3] = np.where((up > 64)[..., None], (0.25, 0.4, 0.7), (0.25, 0.2, 0.15))
    pixels[(up > 80) & (up < 104) & (across > 150) & (across < 180), :3] = (25, 22, 16)
    pixels[(up > 60) & (up < 90) & (across > 30) & (across < 50), :3] = (1, 5, 8)
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    panorama(image, 40, 1.2)
    floor(principled("ground", (0.5, 0.5, 0.5), Roughness=0.7))
    ball(
        "mirror", (-0.7, 0, 0.6), 0.6, principled("mirror", (1, 1, 1), Metallic=1.0, Roughness=0.0)
    )
    ball("clay", (0.7, 0, 0.5), 0.5, principled("clay", (0.6, 0.45, 0.35), Roughness=0.9))
    camera((0, -5, 1.8), (0, 0, 0.5), 35)


def textured() -> None:
    """Color, roughness and normals from images, and an emissive panel."""
    sky((0.1, 0.1, 0.12))
    up, across = np.mgrid[0:128, 0:128]
    tiles = (up // 16 + across // 16) % 2
    color = np.where(tiles[..., None] > 0, (0.8, 0.7, 0.5), (0.15, 0.2, 0.3))
    rough = np.where(tiles > 0, 0.15, 0.6)
    slope = 0.35 * np.sin(up * math.pi / 8)
    bumps = np.stack([np.full(slope.shape, 0.5), 0.5 + slope / 2, np.full(slope.shape, 1.0)], -1)
    material = principled("tiles")
    tree, shader = material.node_tree, material.node_tree.nodes["Principled BSDF"]

    def image(name: str, values: np.ndarray, is_data: bool) -> bpy.types.Node:
        made = bpy.data.images.new(name, 128, 128)
        if is_data:
            made.colorspace_settings.name = "Non-Color"
        pixels = np.ones((128, 128, 4), np.float32)
        pixels[..., :3] = values
        made.pixels.foreach_set(pixels.ravel())
        made.pack()
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = made
        return node

    tree.links.new(image("color", color, False).outputs[0], shader.inputs["Base Color"])
    split = tree.nodes.new("ShaderNodeSeparateColor")
    # Packed as in glTF: roughness in green, metalness in blue.
    packed = np.stack([np.zeros_like(rough), rough, np.zeros_like(rough)], -1)
    tree.links.new(image("rough", packed, True).outputs[0], split.inputs[0])
    tree.links.new(split.outputs["Green"], shader.inputs["Roughness"])
    normal = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(image("bumps", bumps, True).outputs[0], normal.inputs["Color"])
    tree.links.new(normal.outputs[0], shader.inputs["Normal"])
    floor(material, 5)
    glow = principled("glow", (0, 0, 0), Emission_Color=(1, 0.8, 0.5, 1), Emission_Strength=12.0)
    box("panel", (0, 2, 1.5), (2, 0.05, 0.6), glow)
    ball("ball", (0, 0, 0.5), 0.5, principled("white", (0.8, 0.8, 0.8), Roughness=0.4))
    light("POINT", (-2, -2, 3), (0, 0, 0), 80, shadow_soft_size=0.3)
    camera((0, -5, 2.2), (0, 0, 0.5), 38)


def animated() -> None:
    """A ball that moves by keys, one that a constraint turns around, an arm that a bone bends."""
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 24
    sky((0.5, 0.55, 0.6))
    floor(principled("ground", (0.4, 0.4, 0.4), Roughness=0.8))
    mover = ball("mover", (-2, 0, 0.4), 0.4, principled("red", (0.7, 0.1, 0.1), Roughness=0.5))
    mover.keyframe_insert("location", frame=1)
    mover.location = (2, 0, 1.4)
    mover.keyframe_insert("location", frame=24)
    hub = add(bpy.data.objects.new("hub", None))
    hub.keyframe_insert("rotation_euler", frame=1)
    hub.rotation_euler = (0, 0, math.radians(200))
    hub.keyframe_insert("rotation_euler", frame=24)
    moon = box("moon", (1.2, 0, 0.3), (0.5, 0.3, 0.6), principled("blue", (0.1, 0.2, 0.7)))
    moon.parent = hub
    _arm()
    light("SUN", (2, -3, 4), (0, 0, 0), 3, angle=0.05)
    camera((0, -7, 3), (0, 0, 0.7), 36)
    scene.frame_set(12)


def _arm() -> None:
    """A tapered column, skinned to two bones of which the upper one bends."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=24, radius=0.15, depth=1.6, location=(0, 1.4, 0.8))
    arm = _named("arm", principled("arm", (0.2, 0.6, 0.3), Roughness=0.6))
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=7)
    bpy.ops.object.mode_set(mode="OBJECT")
    data = bpy.data.armatures.new("bones")
    bones = add(bpy.data.objects.new("bones", data))
    bones.location = (0, 1.4, 0)
    bpy.context.view_layer.objects.active = bones
    bpy.ops.object.mode_set(mode="EDIT")
    lower, upper = data.edit_bones.new("lower"), data.edit_bones.new("upper")
    lower.head, lower.tail = (0, 0, 0), (0, 0, 0.8)
    upper.head, upper.tail, upper.parent = (0, 0, 0.8), (0, 0, 1.6), lower
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, sign in (("lower", -1), ("upper", 1)):
        group = arm.vertex_groups.new(name=name)
        for vertex in arm.data.vertices:
            group.add([vertex.index], min(max(0.5 + sign * vertex.co.z * 2, 0), 1), "REPLACE")
    arm.modifiers.new("bones", "ARMATURE").object = bones
    pose = bones.pose.bones["upper"]
    pose.rotation_mode = "XYZ"
    pose.keyframe_insert("rotation_euler", frame=1)
    pose.rotation_euler = (math.radians(70), 0, 0)
    pose.keyframe_insert("rotation_euler", frame=24)


def instances() -> None:
    """A collection that empties place, turned and stretched, and 144 pebbles of a particle grid."""
    sky((0.6, 0.65, 0.7))
    floor(principled("ground", (0.35, 0.4, 0.3), Roughness=0.9))
    trees = bpy.data.collections.new("tree")
    bpy.ops.mesh.primitive_cone_add(radius1=0.35, depth=1.0, location=(0, 0, 0.9))
    crown = _named("crown", principled("leaves", (0.1, 0.35, 0.1), Roughness=0.8))
    stem = box("stem", (0, 0, 0.25), (0.12, 0.12, 0.5), principled("bark", (0.25, 0.15, 0.08)))
    for thing in (crown, stem):
        bpy.context.scene.collection.objects.unlink(thing)
        trees.objects.link(thing)
    for i in range(5):
        place = add(bpy.data.objects.new(f"tree {i}", None))
        place.instance_type, place.instance_collection = "COLLECTION", trees
        place.location = (1.1 * i - 2.2, 0.5 * (i % 2), 0)
        place.rotation_euler = (0, 0.1 * i, i)
        place.scale = (1, 1, 0.7 + 0.25 * i)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=11, y_subdivisions=11, size=5)
    grid = _named("field", principled("field", (0.35, 0.4, 0.3), Roughness=0.9))
    grid.location.z = 0.02
    pebble = ball("pebble", (0, 0, 0), 0.06, principled("pebble", (0.6, 0.6, 0.65), Roughness=0.3))
    pebble.parent = grid
    grid.instance_type = "VERTS"
    grid.show_instancer_for_render = False
    light("SUN", (2, -3, 4), (0, 0, 0), 3, angle=0.05)
    camera((0, -7, 3), (0, 0, 0.6), 36)


def wax() -> None:
    """Wax, skin, and jade of which half is matte, below a rectangle and before a bright lamp."""
    sky((0.05, 0.06, 0.08))
    floor(plain("ground", "ShaderNodeBsdfDiffuse", (0.5, 0.45, 0.4)))
    depth = {"Subsurface_Weight": 1.0, "Subsurface_Scale": 1.0, "Roughness": 0.4}
    candle = principled("wax", (0.9, 0.7, 0.4), Subsurface_Radius=(1.5, 0.8, 0.3), **depth)
    ball("wax ball", (-1.2, 0, 0.55), 0.55, candle)
    skin = principled("skin", (0.8, 0.5, 0.4), Subsurface_Radius=(0.4, 0.15, 0.08), **depth)
    skin.node_tree.nodes["Principled BSDF"].subsurface_method = "RANDOM_WALK_SKIN"
    box("skin box", (0, 0, 0.5), (0.8, 0.8, 1), skin)
    half = {**depth, "Subsurface_Weight": 0.5, "Subsurface_Anisotropy": 0.5}
    jade = principled("jade", (0.3, 0.7, 0.4), Subsurface_Radius=(1, 2, 1), **half)
    ball("jade ball", (1.2, 0, 0.55), 0.55, jade)
    light("AREA", (-2, -2, 3), (0, 0, 0.5), 120, shape="RECTANGLE", size=1.5, size_y=1.0)
    light("AREA", (1, 2.5, 1.5), (0, 0, 0.5), 200, shape="DISK", size=0.6, color=(1, 0.8, 0.6))
    camera((0, -6, 2), (0, 0, 0.5), 28)


def mirror_hall() -> None:
    """Two mirrors that face each other, with a ball and a lamp between them."""
    sky((0.02, 0.02, 0.03))
    floor(principled("ground", (0.5, 0.35, 0.2), Roughness=0.25))
    mirror = principled("mirror", (0.9, 0.92, 0.9), Metallic=1.0, Roughness=0.0)
    box("left", (-1.6, 0, 1.5), (0.1, 8, 3), mirror)
    box("right", (1.6, 0, 1.5), (0.1, 8, 3), mirror)
    box("back", (0, 3, 1.5), (3.2, 0.1, 3), principled("back", (0.3, 0.3, 0.5), Roughness=0.6))
    ball("ball", (0.3, 0.3, 0.5), 0.5, principled("red", (0.7, 0.1, 0.1), Roughness=0.3))
    light("AREA", (0, 0.5, 2.9), (0, 0.5, 0), 120, shape="RECTANGLE", size=2.4, size_y=4.0)
    camera((-0.9, -2.8, 1.7), (0.7, 1.2, 0.8), 62)


SCENES: dict[str, Callable[[], None]] = {
    made.__name__: made
    for made in (
        *(spheres, glass, area_light, sun, spot),
        *(world, textured, animated, instances, mirror_hall, wax),
    )
}


def empty() -> bpy.types.Scene:
    """The scene of an empty file, which Cycles can render."""
    import addon_utils  # a module that can be found once `bpy` is imported

    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon_utils.enable("cycles")
    return bpy.context.scene


def render_cycles(scene: bpy.types.Scene, path: Path, samples: int, bounces: int = 32) -> None:
    """Render linear radiance by Cycles, on the processor and without a denoiser."""
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    cycles.device, cycles.samples, cycles.use_denoising = "CPU", samples, False
    cycles.use_adaptive_sampling = False
    # A pixel is a mean over its square, as Reflet's is.
    cycles.pixel_filter_type = "BOX"
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = bounces
    cycles.transmission_bounces = cycles.transparent_max_bounces = bounces
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.image_settings.color_mode = "RGB"
    render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def main() -> None:
    """Make the scenes that the arguments name, or all."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(SCENES))
    parser.add_argument("--size", default="192x108", help="width and height, pixels")
    parser.add_argument("--samples", type=int, default=256, help="of Cycles, for each pixel")
    parser.add_argument("--no-cycles", action="store_true", help="only export")
    args = parser.parse_args()
    width, height = (int(part) for part in args.size.split("x"))
    for name in args.names or SCENES:
        if name not in SCENES:
            parser.error(f"{name} is none of {', '.join(SCENES)}")
        scene = empty()
        SCENES[name]()
        scene.render.resolution_x, scene.render.resolution_y = width, height
        scene.view_settings.view_transform = "Standard"
        place = args.out / name
        report = export_project(scene, place / "project", Options(method="path"))
        for loss in report.losses:
            print(f"{name}: {loss.code}: {loss.subject}: {loss.text}")
        if not args.no_cycles:
            render_cycles(scene, place / "cycles.exr", args.samples)


if __name__ == "__main__":
    main()
