"""Mitsuba's own test scenes: Reflet's pictures beside Mitsuba's references, by Mitsuba's z-test.

The suite's folder holds a clone of mitsuba-data. Mitsuba reads each scene, and the meshes,
transforms, colors and panoramas that it has read become scene text and glTF. A scene with a plugin
that scene text has no exact counterpart for is not compared, and the plugin is named.
"""

import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from measuring import render
from reflet_usd.convert.gltf_writer import GltfWriter
from reflet_usd.convert.scene import Node
from reflet_usd.exr_pixels import read_exr
from scipy.ndimage import convolve1d, map_coordinates
from scipy.special import erfc
from tables import Row, write_rows

FOLDER = "mitsuba-data/tests/scenes"
BUDGET = 2_000_000
"""Samples of a picture, whatever its size: `sample_budget` of Mitsuba's test_renders.py."""
SIGNIFICANCE = 0.01
FLOOR = 1e-4
FINER = 5
"""Odd number of pixels per pixel and axis where a film weighs samples by a Gaussian."""
DENSER = 7
"""Texels per texel and axis of a panorama, so that Reflet's are like Mitsuba's between rows."""
MOST_BOUNCES = 8
"""Most `diffuse_bounces` of scene text."""
DEEP = 16
"""Least `max_depth` that compares with paths without end."""
MESHES = ("obj", "ply", "serialized", "cube")
KNOWN = {
    "moment": "",
    "direct": "",
    "path": "max_depth rr_depth",
    "volpath": "max_depth rr_depth",
    "volpathmis": "max_depth rr_depth",
    "perspective": "to_world near_clip far_clip fov fov_axis",
    "orthographic": "to_world near_clip far_clip",
    "hdrfilm": "width height pixel_format component_format",
    "box": "",
    "gaussian": "",
    "constant": "radiance",
    "envmap": "filename scale",
    "point": "position to_world intensity",
    "directional": "direction irradiance",
    "area": "radiance",
    "rectangle": "to_world",
    "sphere": "to_world center radius",
    "cube": "to_world",
    "obj": "filename to_world",
    "ply": "filename to_world",
    "serialized": "filename to_world shape_index",
    "diffuse": "reflectance",
    "blendbsdf": "",
    "dielectric": "int_ior ext_ior",
    "conductor": "eta k material",
    "mesh_attribute": "name",
    "checkerboard": "color0 color1 to_uv",
    "bitmap": "filename raw wrap_mode filter_type to_uv format",
    "homogeneous": "sigma_t albedo scale",
    "isotropic": "",
}
"""Plugins that are translated, with the properties that the translation knows or may leave out."""
WRAPS = {"repeat": 10497, "mirror": 33648, "clamp": 33071}
FILTERS = {"nearest": 9728, "bilinear": 9729}
Picture = np.ndarray
Table = dict[str, Any]


class OtherError(Exception):
    """A plugin of Mitsuba, or a choice of it, that scene text has no exact counterpart for."""


def z_test(mean: Picture, reference: Picture, variance: Picture, samples: int) -> float:
    """Share of values whose two-sided p-value is above the significance after Šidák's correction.

    `z_test` and `test_render` of Mitsuba 3, src/render/tests/test_renders.py: pictures in XYZ,
    the variance of a sample at least `FLOOR`, z = |mean − reference| √(samples / variance), a
    hypothesis for each pixel.
    """
    z = abs(mean - reference) * np.sqrt(samples / np.maximum(variance, FLOOR))
    alpha = 1 - (1 - SIGNIFICANCE) ** (1 / (mean.shape[0] * mean.shape[1]))
    return float((erfc(z / math.sqrt(2)) > alpha).mean())


class Nodes:
    """A scene as Mitsuba parses it, with its includes and references."""

    def __init__(self, path: Path) -> None:
        import mitsuba as mi

        mi.set_variant("scalar_rgb")
        self.mi, self.kind = mi, mi.ObjectType
        # Each scene adds folders to the resolver that it is given.
        mi.set_file_resolver(mi.FileResolver(mi.file_resolver()))
        mi.file_resolver().prepend(str(path.parent))
        config = mi.parser.ParserConfig(mi.variant())
        config.merge_meshes = config.merge_equivalent = False
        integrator = path.stem.rsplit("_", 1)[1]
        self.state = mi.parser.parse_file(config, str(path), integrator=integrator)
        mi.parser.transform_all(config, self.state)

    def children(self, node: Any) -> dict[str, Any]:
        """Nodes that a node refers to, by the names of its properties."""
        found = {name: of for name, of in node.props.items() if self.is_node(of)}
        return {name: self.state.nodes[of.index()] for name, of in found.items()}

    def of(self, node: Any, kind: Any) -> list[Any]:
        """Children of a kind of object."""
        return [child for child in self.children(node).values() if child.type == kind]

    def made(self, node: Any, **further: Any) -> Any:
        """Parameters of a node's object, which is made without the node's children."""
        return self.mi.traverse(self.object(node, **further))

    def object(self, node: Any, **further: Any) -> Any:
        """A node's object, made without the node's children."""
        plain = {"type": node.props.plugin_name(), **further}
        for name, value in node.props.items():
            if not self.is_node(value):
                is_transform = name.startswith("to_")
                plain[name] = self.mi.ScalarTransform4f(value.matrix) if is_transform else value
        if "filename" in plain:
            plain["filename"] = self.file(node)
        return self.mi.load_dict(plain)

    def file(self, node: Any) -> str:
        return str(self.mi.file_resolver().resolve(node.props["filename"]))

    def place(self, node: Any) -> np.ndarray:
        """Matrix, 4 × 4, of `to_world`."""
        given = node.props.get("to_world", None)
        return np.eye(4) if given is None else np.array(given.matrix, float)

    def unknown(self) -> list[str]:
        """Properties of translated plugins that the translation does not know."""
        found = []
        for node in self.state.nodes:
            plugin = node.props.plugin_name()
            known = KNOWN.get(plugin, "").split()
            named = {name for name, value in node.props.items() if not self.is_node(value)}
            extra = sorted(named - set(known)) if plugin in KNOWN else []
            found += [f"`{plugin}` with `{name}`" for name in extra]
        return found

    def is_node(self, value: Any) -> bool:
        return isinstance(value, self.mi.Properties.ResolvedReference)

    def color(self, node: Any, name: str, default: float) -> list[float]:
        """Linear color of a property that is no texture; not bounded by 1."""
        props, is_light = node.props, node.type == self.kind.Emitter
        read = props.get_emissive_texture if is_light else props.get_unbounded_texture
        found = read(name, default)
        return [float(value) for value in found.eval(self.mi.SurfaceInteraction3f())]


def mesh_of(nodes: Nodes, shape: Any) -> Table:
    """Triangles of a shape: faces, and values of each vertex or face by the names of Mitsuba."""
    kind = shape.props.plugin_name()
    if kind == "rectangle":
        flat = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
        place = nodes.place(shape)
        points = flat @ place[:3, :3].T + place[:3, 3]
        coordinates = (flat[:, :2] + 1) / 2
        faces = np.array([[0, 1, 2], [0, 2, 3]])
        return {"faces": faces, "vertex_positions": points, "vertex_texcoords": coordinates}
    if kind not in MESHES:
        raise OtherError(f"`{kind}`")
    found = nodes.made(shape)
    mesh = {name: np.array(value, float) for name, value in found if name.count("_") == 1}
    return mesh | {"faces": np.array(found["faces"]).reshape(-1, 3)}


def corners(mesh: Table, name: str, width: int) -> np.ndarray:
    """Values at each corner of each face."""
    found = mesh[name].reshape(-1, width)
    return found.repeat(3, axis=0) if name.startswith("face") else found[mesh["faces"].ravel()]


def material(nodes: Nodes, shape: Any, mesh: Table) -> Table:
    """Keys of a shape's material; its texture or its colors of vertices are added to the mesh."""
    matte: Table = {"reflectivity": 0, "metallic": 0}
    surfaces = nodes.of(shape, nodes.kind.BSDF)
    if not surfaces:
        return matte | {"base_color": [0.5, 0.5, 0.5]}
    bsdf = surfaces[0]
    kind, parts = bsdf.props.plugin_name(), nodes.children(bsdf)
    kinds = sorted(part.props.plugin_name() for part in parts.values())
    if kinds and not mesh and kind in ("diffuse", "blendbsdf"):
        raise OtherError(f"textured `{shape.props.plugin_name()}`")
    if kind == "diffuse" and kinds == ["mesh_attribute"]:
        mesh["colors"] = corners(mesh, parts["reflectance"].props["name"], 3)
    elif kind == "diffuse" and kinds:
        mesh["texture"] = image(nodes, parts["reflectance"])
    elif kind == "diffuse":
        matte["base_color"] = nodes.color(bsdf, "reflectance", 0.5)
    elif kind == "blendbsdf" and kinds == ["diffuse", "diffuse", "mesh_attribute"]:
        weight = corners(mesh, parts.pop("weight").props["name"], 1)
        low, high = (np.array(nodes.color(part, "reflectance", 0.5)) for part in parts.values())
        mesh["colors"] = low + (high - low) * weight
    elif kind == "dielectric":
        return glass(nodes, shape, bsdf)
    elif kind == "conductor" and not kinds:
        return metal(nodes, bsdf)
    else:
        facets = bsdf.props.get("distribution", "beckmann") if kind.startswith("rough") else ""
        raise OtherError(f"`{kind}`" + (f" ({facets})" if facets else ""))
    return matte


def image(nodes: Nodes, texture: Any) -> Table:
    """Pixels (sRGB, 8 bits), transform and sampler of a texture."""
    of, mi = texture.props, nodes.mi
    if of.plugin_name() == "checkerboard":
        first, second = (nodes.color(texture, f"color{i}", (0.4, 0.2)[i]) for i in (0, 1))
        bitmap = mi.Bitmap(np.array([[first, second], [second, first]], np.float32))
        wrap, smooth = "repeat", "nearest"
    elif of.plugin_name() == "bitmap" and not of.get("raw", False):
        bitmap = mi.Bitmap(nodes.file(texture))
        wrap, smooth = of.get("wrap_mode", "repeat"), of.get("filter_type", "bilinear")
    else:
        raise OtherError(f"`{of.plugin_name()}`")
    bitmap = bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, True)
    sampler = {"wrapS": WRAPS[wrap], "wrapT": WRAPS[wrap]}
    sampler |= {"magFilter": FILTERS[smooth], "minFilter": FILTERS[smooth]}
    turn = np.array(nodes.made(texture)["to_uv"].matrix)
    return {"bitmap": bitmap, "sampler": sampler, "turn": turn}


def metal(nodes: Nodes, bsdf: Any) -> Table:
    """Keys of a smooth metal: its reflectance head on, and at 82° over Schlick's share there."""
    mi, surface = nodes.mi, nodes.object(bsdf)
    shares = []
    for cosine in (1, 1 / 7):
        hit = mi.SurfaceInteraction3f()
        hit.wi = [math.sqrt(1 - cosine**2), 0, cosine]
        shares.append(np.array(surface.sample(mi.BSDFContext(), hit, 0.5, [0.5, 0.5])[1], float))
    color = shares[0]
    tint = shares[1] / (color + (1 - color) * (6 / 7) ** 5)
    keys: Table = {"metallic": 1, "roughness": 0, "base_color": color, "edge_tint": True}
    return keys | {"specular_color": tint}


def glass(nodes: Nodes, shape: Any, bsdf: Any) -> Table:
    """Keys of a solid that refracts, and scatters where it has a homogeneous medium."""
    keys: Table = {"metallic": 0, "transmission": 1, "roughness": 0, "thickness_m": 1}
    keys["ior"] = nodes.made(bsdf)["eta"]
    medium = nodes.children(shape).get("interior")
    if medium is None:
        return keys
    phases = [child.props.plugin_name() for child in nodes.children(medium).values()]
    for other in {medium.props.plugin_name(), *phases} - {"homogeneous", "isotropic"}:
        raise OtherError(f"`{other}`")
    extinction = np.array(nodes.color(medium, "sigma_t", 1)) * medium.props.get("scale", 1.0)
    keys |= {"attenuation_distance_m": 1, "attenuation_color": np.exp(-extinction)}
    # Scene text asks for the color of a thick solid. Kulla and Conty's fit, "Revisiting Physically
    # Based Shading at Imageworks", 2017, has the albedo of a color; this is its inverse.
    root = 4.09712 - np.sqrt(1 - np.array(nodes.color(medium, "albedo", 0.75)))
    color = (9.59217 - root**2) / (8.41726 * root - 41.6808)
    return keys | {"scattering_color": np.clip(color, 0, 1)}


class Translation:
    """A scene as scene text, with the files that it names in a folder."""

    def __init__(self, path: Path, folder: Path) -> None:
        self.nodes, self.folder = Nodes(path), folder
        self.scene: Table = {"version": 1, "image": {"radiance": "full"}, "instance": []}
        self.scene |= {"material": {}, "model": {}, "light": {}}
        self.others = self.nodes.unknown()
        """Plugins that scene text has no exact counterpart for."""
        self.filter, self.size = "", (0, 0)
        self.kinds: set[str] = set()
        """Kinds of surfaces: matte, metal and glass."""
        kind = self.nodes.kind
        # The integrator is last: its bounds depend on the materials.
        for wanted, translate in (
            (kind.Sensor, self.sensor),
            (kind.Shape, self.shape),
            (kind.Emitter, self.emitter),
            (kind.Integrator, self.integrator),
        ):
            for child in self.nodes.of(self.nodes.state.root, wanted):
                try:
                    translate(child)
                except OtherError as other:
                    self.others.append(str(other))

    def text(self) -> str:
        return "\n".join(f"{key} = {toml(value)}" for key, value in self.scene.items()) + "\n"

    def integrator(self, node: Any) -> None:
        """Bounds of paths that equal the integrator's `max_depth`."""
        kind = node.props.plugin_name()
        if kind == "moment":
            self.integrator(self.nodes.of(node, self.nodes.kind.Integrator)[0])
            return
        if kind not in ("direct", "path", "volpath", "volpathmis"):
            raise OtherError(f"`{kind}`")
        depth = 2 if kind == "direct" else node.props.get("max_depth", -1)
        bounds: Table = {"method": "path"}
        if 0 <= depth < DEEP:
            name = "bounces" if self.kinds == {"metal"} else "diffuse_bounces"
            further = depth - 1 if name == "bounces" else depth - 2
            bounds = {"method": "rt", name: further}
            if len(self.kinds) > 1 or "glass" in self.kinds or not 0 <= further <= MOST_BOUNCES:
                raise OtherError(f"`max_depth` {depth}")
        bounds |= {"roughness_cutoff": 1, "glint_limit": 0, "filter": False, "reuse_light": False}
        self.scene["reflection"] = bounds | {"unit_m": 1, "ray_length_u": 1e6}

    def sensor(self, node: Any) -> None:
        nodes, kind = self.nodes, node.props.plugin_name()
        film = nodes.of(node, nodes.kind.Film)[0]
        weights = nodes.of(film, nodes.kind.ReconstructionFilter)
        self.filter = weights[0].props.plugin_name() if weights else "gaussian"
        if self.filter not in ("box", "gaussian"):
            raise OtherError(f"`{self.filter}`")
        width, height = self.size = (film.props["width"], film.props["height"])
        place = nodes.place(node)
        eye, ahead, up = (place[:3, column] for column in (3, 2, 1))
        lengths = np.linalg.norm(place[:3, :2], axis=0)
        if np.linalg.det(place[:3, :3]) < 0 or not math.isclose(*lengths, rel_tol=1e-4):
            raise OtherError(f"`{kind}`, mirrored or stretched")
        view: Table = {"eye": eye, "target": eye + ahead, "up": up}
        view["near_m"] = node.props.get("near_clip", 0.01)
        if kind == "perspective":
            shape = {"type": "hdrfilm", "width": width, "height": height}
            half = math.radians(nodes.made(node, film=shape)["x_fov"]) / 2
            view["fov_deg"] = 2 * math.degrees(math.atan(math.tan(half) * height / width))
        elif kind == "orthographic":
            view["orthographic_height_m"] = 2 * np.linalg.norm(up) * height / width
        else:
            raise OtherError(f"`{kind}`")
        self.scene["camera"] = {"main": view}

    def emitter(self, node: Any) -> None:
        nodes, kind, of = self.nodes, node.props.plugin_name(), node.props
        light: Table = {"kind": kind, "shadow": "ray"}
        if kind == "constant":
            color = nodes.color(node, "radiance", 1)
            self.scene["environment"] = {"color": color, "shadow": "ray"}
            return
        if kind == "envmap" and "to_world" not in of:
            if not self.others:
                panorama(nodes, node, self.folder / "panorama.exr")
            self.scene["environment"] = {"file": "panorama.exr", "intensity": of.get("scale", 1.0)}
            return
        if kind == "point":
            light |= {"position": nodes.made(node)["position"], "intensity_cd": 1}
            light["color"] = nodes.color(node, "intensity", 1)
        elif kind == "directional" and "direction" in of:
            light |= {"direction": of["direction"], "intensity_lux": 1}
            light["color"] = nodes.color(node, "irradiance", 1)
        else:
            raise OtherError(("textured " if nodes.children(node) else "") + f"`{kind}`")
        self.scene["light"][f"l{len(self.scene['light'])}"] = light

    def shape(self, node: Any, place: np.ndarray | None = None) -> None:
        """A shape, or the shapes of a group, placed by a matrix, 4 × 4."""
        nodes, kind = self.nodes, node.props.plugin_name()
        place = np.eye(4) if place is None else place
        if kind == "instance":
            for child in nodes.of(nodes.of(node, nodes.kind.Shape)[0], nodes.kind.Shape):
                self.shape(child, nodes.place(node))
        if kind in ("instance", "shapegroup"):
            return
        name = f"m{len(self.scene['model'])}"
        mesh = {} if kind == "sphere" else mesh_of(nodes, node)
        keys = material(nodes, node, mesh)
        for emitter in nodes.of(node, nodes.kind.Emitter):
            if kind == "sphere" or nodes.children(emitter):
                raise OtherError("`area` of `sphere`" if kind == "sphere" else "textured `area`")
            keys |= {"emission": nodes.color(emitter, "radiance", 1), "light": True}
        surface = "glass" if "transmission" in keys else "metal" if keys["metallic"] else "matte"
        self.kinds.add(surface)
        is_matte = surface == "matte"
        if kind != "sphere":
            write_mesh(self.folder / f"{name}.glb", mesh, is_matte)
            self.scene["model"][name] = {"file": f"{name}.glb", "material": {"front": keys}}
        else:
            ball = {"kind": "sphere", "radius": 1}
            self.scene["model"][name] = {"shape": ball, "material": name}
            self.scene["material"][name] = keys
            place = place @ np.array(nodes.made(node)["to_world"].matrix)
        self.scene["instance"].append({"model": name, "matrix": place.T.ravel()})


def toml(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{key} = {toml(of)}' for key, of in value.items())} }}"
    if isinstance(value, (bool, str, int, float)):
        return json.dumps(value)
    return f"[{', '.join(toml(of if isinstance(of, dict) else float(of)) for of in value)}]"


def write_mesh(path: Path, mesh: Table, is_matte: bool) -> None:
    """Writes a mesh as glTF, whose material `front` the scene overrides.

    Where it is matte it has black backs: a `diffuse` surface of Mitsuba has one bright side.
    """
    file = GltfWriter()
    front: Table = {"name": "front", "doubleSided": not is_matte}
    values = {"POSITION": corners(mesh, "vertex_positions", 3)}
    if mesh.get("vertex_normals", np.zeros(0)).size:
        values["NORMAL"] = corners(mesh, "vertex_normals", 3)
    if "colors" in mesh:
        values["COLOR_0"] = mesh["colors"]
    if "texture" in mesh:
        picture, turn = path.with_suffix(".png"), mesh["texture"]["turn"]
        mesh["texture"]["bitmap"].write(str(picture))
        values["TEXCOORD_0"] = corners(mesh, "vertex_texcoords", 2) @ turn[:2, :2].T + turn[:2, 2]
        source = file.add_image(picture.read_bytes(), "image/png", picture.name)
        sampler = file.add("samplers", mesh["texture"]["sampler"])
        index = file.add("textures", {"source": source, "sampler": sampler})
        front["pbrMetallicRoughness"] = {"baseColorTexture": {"index": index}}
    attributes = {name: file.add_floats(of, name == "POSITION") for name, of in values.items()}
    sides: list[Table] = [{"attributes": attributes, "material": file.add("materials", front)}]
    if is_matte:
        black = {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 1}
        index = file.add("materials", {"name": "back", "pbrMetallicRoughness": black})
        turned = np.arange(mesh["faces"].size, dtype=np.uint32).reshape(-1, 3)[:, ::-1].ravel()
        back = {"material": index, "indices": file.add_accessor(turned)}
        sides.append({"attributes": attributes, **back})
    file.add_nodes([Node("mesh", mesh=file.add("meshes", {"primitives": sides}))], {})
    file.write(path, {})


def panorama(nodes: Nodes, node: Any, path: Path) -> None:
    """Writes a panorama as Mitsuba reads it: its outermost rows lie on the poles themselves.

    Each texel becomes `DENSER`² texels; an odd number keeps the centers of columns.
    """
    form, half = nodes.mi.Bitmap.PixelFormat.RGB, nodes.mi.Struct.Type.Float16
    bitmap = nodes.mi.Bitmap(nodes.file(node)).convert(form, half, False)
    texels = np.pad(np.array(bitmap, np.float32), ((0, 0), (1, 1), (0, 0)), "wrap")
    height, width = bitmap.height(), bitmap.width()
    rows = (np.arange(DENSER * height) + 0.5) / (DENSER * height) * (height - 1)
    columns = (np.arange(DENSER * width) + 0.5) / DENSER + 0.5
    places = np.meshgrid(rows, columns, indexing="ij")
    dense = [map_coordinates(channel, places, order=1) for channel in texels.transpose(2, 0, 1)]
    nodes.mi.Bitmap(np.stack(dense, axis=2).astype(np.float16)).write(str(path))


def gaussian(fine: Picture) -> Picture:
    """Pixels of a film that weighs samples by Mitsuba's Gaussian, from `FINER`² as many pixels.

    Its standard deviation is .5 pixels, its radius 2, where it ends at 0 (gaussian.cpp).
    """
    places = np.arange(-2 * FINER, 2 * FINER + 1) / FINER
    weights = np.exp(-2 * places**2) - math.exp(-8)
    kept = np.ones(fine.shape)
    for axis in (0, 1):
        fine, kept = (convolve1d(of, weights, axis, mode="constant") for of in (fine, kept))
    return (fine / kept)[FINER // 2 :: FINER, FINER // 2 :: FINER]


def draw(program: Path, folder: Path, scene: Translation) -> tuple[Picture, int]:
    """Reflet's picture in linear light, and the number of samples of its pixels."""
    width, height = scene.size
    finer = 1 if scene.filter == "box" else FINER
    samples = max(BUDGET // (width * height * finer**2), 1)
    text, picture = folder / "scene.toml", folder / "picture.exr"
    is_drawn = picture.exists() and text.read_text(encoding="utf-8") == scene.text()
    text.write_text(scene.text(), encoding="utf-8")
    if not is_drawn:
        count = ["--samples", str(samples), "--no-project"]
        render(program, text, picture, (width * finer, height * finer), *count)
    fine = read_exr(picture.read_bytes())[..., :3].astype(float)
    return (fine if finer == 1 else gaussian(fine)), samples * finer**2


def compare(program: Path, path: Path, folder: Path) -> Row:
    """A scene's row: the share of values that pass, and the mean values of both pictures."""
    row = {"scene": f"{path.parent.name}/{path.stem}", "passed": "", "samples": ""}
    row |= {"mitsuba": "", "reflet": "", "others": ""}
    folder.mkdir(parents=True, exist_ok=True)
    try:
        scene = Translation(path, folder)
    except RuntimeError as error:
        sys.exit(f"Mitsuba cannot read {path}: {error}")
    if scene.others:
        return row | {"others": ", ".join(sorted(set(scene.others)))}
    picture, samples = draw(program, folder, scene)
    mi = scene.nodes.mi

    def xyz(values: Picture) -> Picture:
        bitmap = mi.Bitmap(values.astype(np.float32))
        return np.array(bitmap.convert(mi.Bitmap.PixelFormat.XYZ, mi.Struct.Type.Float32, False))

    stem = path.stem.rsplit("_", 1)[0]
    stored = [path.parent / "refs" / f"{stem}_ref_rgb{mark}.exr" for mark in ("", "_var")]
    mean, variance = (np.array(mi.Bitmap(str(file)), float)[..., :3] for file in stored)
    passed = z_test(xyz(picture), xyz(mean), xyz(variance), samples)
    row |= {"passed": f"{passed:.5f}", "samples": str(samples)}
    return row | {"mitsuba": f"{mean.mean():.5f}", "reflet": f"{picture.mean():.5f}"}


def measure(program: Path, suite: Path, out: Path) -> None:
    """Writes mitsuba.csv: a row for each scene that Mitsuba's tests render."""
    try:
        import mitsuba  # noqa: F401
    except ImportError:
        sys.exit("the Python package mitsuba is not installed; `pip install mitsuba`")
    rows: list[Row] = []
    for path in sorted((suite / FOLDER).glob("*/*.xml")):
        rows.append(compare(program, path, out / path.parent.name / path.stem))
        print(" ".join(rows[-1].values()), flush=True)
        write_rows(out / "mitsuba.csv", rows)
