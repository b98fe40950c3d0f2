"""Mitsuba's own test scenes: Reflet's pictures beside Mitsuba's references, by Mitsuba's z-test.

The suite's folder holds a clone of mitsuba-data. Mitsuba reads each scene, and what it has read
(meshes, transforms, colors, panoramas) becomes scene text and glTF. A scene with a plugin that
scene text has no exact counterpart for is not compared, and the plugin is named.
"""

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from measuring import used
from reflet_usd.exr_pixels import read_exr
from scipy.optimize import brentq
from scipy.special import erfc
from tables import Row, write_rows

FOLDER = "mitsuba-data/tests/scenes"
LIST = f"{FOLDER}/bsdf_spheres/test_textured_diffuse_path.xml"
"""A scene of the suite, by which its folder is known."""
BUDGET = 2_000_000
"""Samples of a picture, whatever its size: `sample_budget` of Mitsuba's test_renders.py."""
SIGNIFICANCE = 0.01
RIGHT = 0.9975
FLOOR = 1e-4
FINER = 4
"""Pixels per pixel and axis where a film weighs samples by a Gaussian."""
DENSER = 7
"""Texels per texel and axis of a panorama, so that Reflet's are like Mitsuba's between rows."""
MESHES = ("obj", "ply", "serialized", "cube")
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

    def children(self, node: Any) -> Iterator[tuple[str, Any]]:
        """Nodes that a node refers to, with the names of its properties."""
        for name, value in node.props.items():
            if isinstance(value, self.mi.Properties.ResolvedReference):
                yield name, self.state.nodes[value.index()]

    def of(self, node: Any, kind: Any) -> list[Any]:
        """Children of a kind of object."""
        return [child for _, child in self.children(node) if child.type == kind]

    def made(self, node: Any, **further: Any) -> Any:
        """Parameters of a node's object, which is made without its children."""
        plain = dict(further)
        for name, value in node.props.items():
            if not isinstance(value, self.mi.Properties.ResolvedReference):
                is_transform = name.startswith("to_")
                plain[name] = self.mi.ScalarTransform4f(value.matrix) if is_transform else value
        if "filename" in plain:
            plain["filename"] = self.file(node)
        return self.mi.traverse(self.mi.load_dict({"type": node.props.plugin_name(), **plain}))

    def file(self, node: Any) -> str:
        return str(self.mi.file_resolver().resolve(node.props["filename"]))

    def place(self, node: Any) -> np.ndarray:
        """Matrix, 4 × 4, of `to_world`."""
        given = node.props.get("to_world", None)
        return np.eye(4) if given is None else np.array(given.matrix, float)

    def color(self, node: Any, name: str, default: float) -> list[float]:
        """Linear color of a property that is no texture; not bounded by 1."""
        found = node.props.get_emissive_texture(name, default)
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


def matte(nodes: Nodes, bsdf: Any, mesh: Table) -> Table:
    """Keys of a diffuse BSDF's material; a texture is added to it, and an attribute to the mesh."""
    keys: Table = {"reflectivity": 0}
    texture = dict(nodes.children(bsdf)).get("reflectance")
    if texture is None:
        return keys | {"base_color": nodes.color(bsdf, "reflectance", 0.5)}
    if texture.props.plugin_name() == "mesh_attribute":
        mesh["colors"] = corners(mesh, texture.props["name"], 3)
        return keys
    mesh["texture"] = image(nodes, texture)
    return keys


def image(nodes: Nodes, texture: Any) -> Table:
    """Pixels (sRGB, 8 bits), transform and sampler of a texture."""
    of, mi = texture.props, nodes.mi
    if of.plugin_name() == "checkerboard":
        dark, light = (nodes.color(texture, f"color{i}", (0.4, 0.2)[i]) for i in (0, 1))
        bitmap = mi.Bitmap(np.array([[dark, light], [light, dark]], np.float32))
        wrap, smooth = "repeat", "nearest"
    elif of.plugin_name() == "bitmap" and not of.get("raw", False):
        bitmap = mi.Bitmap(nodes.file(texture))
        wrap, smooth = of.get("wrap_mode", "repeat"), of.get("filter_type", "bilinear")
    else:
        raise OtherError(f"`{of.plugin_name()}`")
    bitmap = bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, True)
    turn = np.array(nodes.made(texture)["to_uv"].matrix)
    sampler = {"wrapS": WRAPS[wrap], "wrapT": WRAPS[wrap]}
    sampler |= {"magFilter": FILTERS[smooth], "minFilter": FILTERS[smooth]}
    return {"bitmap": bitmap, "turn": turn, "sampler": sampler}


def material(nodes: Nodes, shape: Any, mesh: Table) -> Table:
    """Keys of a shape's material."""
    bsdf = next(iter(nodes.of(shape, nodes.kind.BSDF)), None)
    kind = bsdf.props.plugin_name() if bsdf else "diffuse"
    if bsdf is None:
        return {"reflectivity": 0, "base_color": [0.5, 0.5, 0.5]}
    if kind == "diffuse":
        return matte(nodes, bsdf, mesh)
    inner = nodes.of(bsdf, nodes.kind.BSDF)
    weight = dict(nodes.children(bsdf)).get("weight")
    is_matte = all(child.props.plugin_name() == "diffuse" for child in inner)
    if kind == "blendbsdf" and is_matte and weight.props.plugin_name() == "mesh_attribute":
        low, high = (np.array(nodes.color(child, "reflectance", 0.5)) for child in inner)
        mesh["colors"] = low + (high - low) * corners(mesh, weight.props["name"], 1)
        return {"reflectivity": 0}
    if kind == "dielectric":
        return glass(nodes, shape, bsdf)
    facets = bsdf.props.get("distribution", "beckmann") if kind.startswith("rough") else ""
    raise OtherError(f"`{kind}`" + (f" ({facets})" if facets else ""))


def glass(nodes: Nodes, shape: Any, bsdf: Any) -> Table:
    """Keys of a solid that refracts, and scatters where it has a homogeneous medium."""
    keys = {"transmission": 1, "roughness": 0, "thickness_m": 1, "ior": nodes.made(bsdf)["eta"]}
    medium = dict(nodes.children(shape)).get("interior")
    if medium is None:
        return keys
    if medium.props.plugin_name() != "homogeneous":
        raise OtherError(f"`{medium.props.plugin_name()}`")
    extinction = np.array(nodes.color(medium, "sigma_t", 1)) * medium.props.get("scale", 1.0)
    keys |= {"attenuation_distance_m": 1, "attenuation_color": np.exp(-extinction).tolist()}
    return keys | {"scattering_color": [*map(thick_color, nodes.color(medium, "albedo", 0.75))]}


def thick_color(albedo: float) -> float:
    """Color of a thick solid whose medium has a single-scattering albedo.

    Kulla and Conty's fit, "Revisiting Physically Based Shading at Imageworks", 2017, gives the
    albedo of a color, which scene text asks for.
    """

    def excess(color: float) -> float:
        root = math.sqrt(9.59217 + 41.6808 * color + 17.7126 * color**2)
        return 1 - (4.09712 + 4.20863 * color - root) ** 2 - albedo

    return brentq(excess, 0, 1)


class Translation:
    """A scene as scene text, with the files that it names in a folder."""

    def __init__(self, path: Path, folder: Path) -> None:
        self.nodes, self.folder = Nodes(path), folder
        self.scene: Table = {"version": 1, "material": {}, "model": {}, "light": {}, "instance": []}
        self.others: list[str] = []
        """Plugins that scene text has no exact counterpart for."""
        self.filter, self.size = "", (0, 0)
        self.is_matte = True
        kind = self.nodes.kind
        # The integrator is last: its bounds depend on the materials.
        for wanted, translate in (
            (kind.Sensor, self.sensor),
            (kind.Emitter, self.emitter),
            (kind.Shape, self.shape),
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
        depth = 2 if kind == "direct" else node.props.get("max_depth", -1)
        bounds: Table = {"method": "path"}
        if self.is_matte and 2 <= depth <= 10:
            bounds = {"method": "rt", "diffuse_bounces": depth - 2}
        bounds |= {"roughness_cutoff": 1, "glint_limit": 0, "filter": False, "reuse_light": False}
        self.scene["reflection"] = bounds | {"unit_m": 1, "ray_length_u": 1e6}

    def sensor(self, node: Any) -> None:
        nodes, kind = self.nodes, node.props.plugin_name()
        film = nodes.of(node, nodes.kind.Film)[0]
        weights = nodes.of(film, nodes.kind.ReconstructionFilter)
        self.filter = weights[0].props.plugin_name() if weights else "gaussian"
        width, height = self.size = (film.props["width"], film.props["height"])
        place = nodes.place(node)
        eye, ahead, up = (place[:3, column] for column in (3, 2, 1))
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
        place, lights = nodes.place(node), self.scene["light"]
        light = {"kind": kind, "shadow": "ray"}
        if kind == "constant":
            color = nodes.color(node, "radiance", 1)
            self.scene["environment"] = {"color": color, "shadow": "ray"}
        elif kind == "envmap" and "to_world" not in of:
            panorama(nodes, node, self.folder / "panorama.exr")
            self.scene["environment"] = {"file": "panorama.exr", "intensity": of.get("scale", 1.0)}
        elif kind == "point":
            color = nodes.color(node, "intensity", 1)
            at = {"position": of.get("position", place[:3, 3])}
            lights[f"l{len(lights)}"] = light | at | {"intensity_cd": 1, "color": color}
        elif kind == "directional" and "direction" in of:
            color = nodes.color(node, "irradiance", 1)
            to = {"direction": of["direction"]}
            lights[f"l{len(lights)}"] = light | to | {"intensity_lux": 1, "color": color}
        else:
            raise OtherError(("textured " if [*nodes.children(node)] else "") + f"`{kind}`")

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
            if kind == "sphere" or [*nodes.children(emitter)]:
                raise OtherError("textured `area`")
            keys |= {"emission": nodes.color(emitter, "radiance", 1), "light": True}
        is_matte = "transmission" not in keys
        self.is_matte &= is_matte
        if kind != "sphere":
            write_mesh(self.folder, name, mesh, is_matte)
            self.scene["model"][name] = {"file": f"{name}.gltf", "material": {"front": keys}}
        elif mesh:
            raise OtherError("textured `sphere`")
        else:
            ball = {"kind": "sphere", "radius": node.props.get("radius", 1.0)}
            self.scene["material"][name] = keys
            self.scene["model"][name] = {"shape": ball, "material": name}
            moved = np.eye(4)
            moved[:3, 3] = node.props.get("center", [0, 0, 0])
            place = place @ nodes.place(node) @ moved
        self.scene["instance"].append({"model": name, "matrix": place.T.ravel()})


def toml(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{key} = {toml(of)}' for key, of in value.items())} }}"
    if isinstance(value, (bool, str)):
        return json.dumps(value)
    if isinstance(value, (int, float)):
        return repr(float(value)) if isinstance(value, float) else str(value)
    return f"[{', '.join(toml(of if isinstance(of, dict) else float(of)) for of in value)}]"


def write_mesh(folder: Path, name: str, mesh: Table, is_matte: bool) -> None:
    """Writes a mesh as glTF, with a black back where it is matte: Mitsuba's have one bright side.

    Its material is `front`, whose values the scene overrides.
    """
    values = {"POSITION": corners(mesh, "vertex_positions", 3)}
    if mesh.get("vertex_normals", np.zeros(0)).size:
        values["NORMAL"] = corners(mesh, "vertex_normals", 3)
    front: Table = {"name": "front", "doubleSided": not is_matte, "pbrMetallicRoughness": {"metallicFactor": 0}}
    black = {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}
    nothing = {"KHR_materials_specular": {"specularFactor": 0}}
    back = {"name": "back", "pbrMetallicRoughness": black, "extensions": nothing}
    file: Table = {"asset": {"version": "2.0"}, "materials": [front, back]}
    if "colors" in mesh:
        values["COLOR_0"] = mesh["colors"]
    if "texture" in mesh:
        texture = mesh["texture"]
        texture["bitmap"].write(str(folder / f"{name}.png"))
        turn = texture["turn"]
        values["TEXCOORD_0"] = corners(mesh, "vertex_texcoords", 2) @ turn[:2, :2].T + turn[:2, 2]
        front["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        file |= {"images": [{"uri": f"{name}.png"}], "samplers": [texture["sampler"]]}
        file["textures"] = [{"source": 0, "sampler": 0}]
    count = len(values["POSITION"])
    turned = np.arange(count).reshape(-1, 3)[:, ::-1].ravel()
    parts = [np.asarray(of, np.float32) for of in values.values()] + [turned.astype(np.uint32)]
    starts = np.cumsum([0, *(part.nbytes for part in parts)])
    types = {2: "VEC2", 3: "VEC3"}
    file["bufferViews"] = [
        {"buffer": 0, "byteOffset": int(start), "byteLength": part.nbytes}
        for start, part in zip(starts, parts, strict=False)
    ]
    file["accessors"] = [
        {"bufferView": i, "componentType": 5126, "count": count, "type": types[part.shape[1]]}
        for i, part in enumerate(parts[:-1])
    ]
    file["accessors"][0] |= {"min": parts[0].min(axis=0).tolist()}
    file["accessors"][0] |= {"max": parts[0].max(axis=0).tolist()}
    last = len(parts) - 1
    file["accessors"].append(
        {"bufferView": last, "componentType": 5125, "count": count, "type": "SCALAR"}
    )
    attributes = {semantic: i for i, semantic in enumerate(values)}
    sides: list[Table] = [{"attributes": attributes, "material": 0}]
    if is_matte:
        sides.append({"attributes": attributes, "material": 1, "indices": last})
    file |= {"meshes": [{"primitives": sides}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]}
    file |= {"scene": 0, "extensionsUsed": list(nothing)}
    file["buffers"] = [{"uri": f"{name}.bin", "byteLength": int(starts[-1])}]
    (folder / f"{name}.bin").write_bytes(b"".join(part.tobytes() for part in parts))
    (folder / f"{name}.gltf").write_text(json.dumps(file), encoding="utf-8")


def panorama(nodes: Nodes, node: Any, path: Path) -> None:
    """Writes a panorama as Mitsuba reads it: its outermost rows lie on the poles themselves.

    Each texel becomes `DENSER`² texels; an odd number keeps the centers of columns.
    """
    form, half = nodes.mi.Bitmap.PixelFormat.RGB, nodes.mi.Struct.Type.Float16
    bitmap = nodes.mi.Bitmap(nodes.file(node)).convert(form, half, False)
    texels = np.array(bitmap, np.float32)
    height, width = texels.shape[:2]
    rows = (np.arange(DENSER * height) + 0.5) / (DENSER * height) * (height - 1)
    columns = (np.arange(DENSER * width) + 0.5) / DENSER - 0.5
    for axis, places in enumerate((rows, columns)):
        low = np.floor(places).astype(int)
        share = np.expand_dims(places - low, (1 - axis, 2))
        first, second = (texels.take(low + i, axis, mode=("clip", "wrap")[axis]) for i in (0, 1))
        texels = first + (second - first) * share
    nodes.mi.Bitmap(texels.astype(np.float16)).write(str(path))


def gaussian(fine: Picture) -> Picture:
    """Pixels of a film that weighs samples by Mitsuba's Gaussian, from `FINER`² as many pixels.

    Its standard deviation is .5 pixels, its radius 2, where it ends at 0 (gaussian.cpp).
    """
    reach = 2 * FINER
    places = (np.arange(-reach, reach + FINER) + 0.5) / FINER - 0.5
    weights = np.maximum(np.exp(-2 * places**2) - math.exp(-8), 0)
    for _ in range(2):
        count = fine.shape[0] // FINER
        padded = np.pad(fine, ((reach, reach), (0, 0), (0, 0)))
        inside = np.pad(np.ones(len(fine)), reach)
        spans = [slice(i * FINER, i * FINER + len(weights)) for i in range(count)]
        sums = [np.tensordot(weights, padded[s], 1) / (weights @ inside[s]) for s in spans]
        fine = np.stack(sums).swapaxes(0, 1)
    return fine


def draw(program: Path, folder: Path, scene: Translation) -> tuple[Picture, int]:
    """Reflet's picture in linear light, and the number of samples of its pixels."""
    width, height = scene.size
    samples = BUDGET // (width * height)
    finer = 1 if scene.filter == "box" else FINER
    each = max(samples // finer**2, 1)
    text, picture = folder / "scene.toml", folder / "picture.exr"
    text.write_text(scene.text(), encoding="utf-8")
    if not picture.exists():
        size = f"{width * finer}x{height * finer}"
        command = [program, "render", text, "-o", picture, "--size", size, "--no-project"]
        ran = used([*command, "--samples", str(each), "--set", 'image.radiance="full"'])
        if ran.code != 0:
            raise OtherError(ran.said)
    fine = read_exr(picture.read_bytes())[..., :3].astype(float)
    return (gaussian(fine) if finer > 1 else fine), each * finer**2


def compare(program: Path, path: Path, folder: Path) -> Row:
    """A scene's row: the share of values that pass, and the mean values of both pictures."""
    row = {"scene": f"{path.parent.name}/{path.stem}", "passed": "", "samples": ""}
    row |= {"mitsuba": "", "reflet": "", "others": ""}
    folder.mkdir(parents=True, exist_ok=True)
    scene = Translation(path, folder)
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
    rows: list[Row] = []
    for path in sorted((suite / FOLDER).glob("*/*.xml")):
        rows.append(compare(program, path, out / path.parent.name / path.stem))
        print(" ".join(rows[-1].values()), flush=True)
        write_rows(out / "mitsuba.csv", rows)
