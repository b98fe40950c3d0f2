"""Owns the truth about MaterialX surfaces: the rules by which a file approximates them.

Every channel is evaluated as a function of texture coordinates; the documentation of each surface
gives the rules.
"""

import dataclasses
from collections.abc import Callable

import numpy as np
from pxr import Usd, UsdShade

from .scene_data import Array
from .usd_material import DEFAULTS, PreviewInput, surface_shader
from .usd_node_values import NodeValues, UnknownError

GLTF_SURFACE = "ND_gltf_pbr_surfaceshader"
_WHITE, _GRAY, _BLACK = (1.0,) * 3, (0.8,) * 3, (0.0,) * 3
_FEW = 4
Function = Callable[[Array], Array]


@dataclasses.dataclass
class Names:
    """Names of a surface's inputs, and the definition's defaults that differ among surfaces."""

    metal: str
    roughness: tuple[str, float]
    ior: str
    coat: tuple[str, str, float]
    opacity: str
    specular: str
    normal: str
    base: tuple[str, str]
    under: tuple[str, tuple[float, ...]]
    through: str
    thin: str
    fuzz: tuple[str, str, str]
    glow: tuple[str, str]
    grooves: str


_LAYERED = {
    "ND_standard_surface_surfaceshader": Names(
        "metalness",
        ("specular_roughness", 0.2),
        "specular_IOR",
        ("coat", "coat_roughness", 0.1),
        "opacity",
        "specular",
        "normal",
        ("base_color", "base"),
        ("subsurface", _WHITE),
        "transmission",
        "thin_walled",
        ("sheen", "sheen_color", "sheen_roughness"),
        ("emission_color", "emission"),
        "specular_anisotropy",
    ),
    "ND_open_pbr_surface_surfaceshader": Names(
        "base_metalness",
        ("specular_roughness", 0.3),
        "specular_ior",
        ("coat_weight", "coat_roughness", 0.0),
        "geometry_opacity",
        "specular_weight",
        "geometry_normal",
        ("base_color", "base_weight"),
        ("subsurface_weight", _GRAY),
        "transmission_weight",
        "geometry_thin_walled",
        ("fuzz_weight", "fuzz_color", "fuzz_roughness"),
        ("emission_color", "emission_luminance"),
        "specular_roughness_anisotropy",
    ),
}
_MORE = (
    "alpha",
    "alpha_cutoff",
    "base_color",
    "clearcoat",
    "clearcoat_roughness",
    "emissive",
    "emissive_strength",
    "ior",
    "metallic",
    "normal",
    "occlusion",
    "roughness",
)


def is_gltf_surface(material: Usd.Prim) -> bool:
    """Whether the material's surface is MaterialX's glTF PBR, which a file can carry whole."""
    shader = surface_shader(material)
    return shader is not None and str(shader.GetIdAttr().Get()) == GLTF_SURFACE


def surface_inputs(identifier: str) -> set[str]:
    """Inputs of a MaterialX surface, from which the file's approximated values follow."""
    if identifier == GLTF_SURFACE:
        return set(_MORE)
    names = _LAYERED.get(identifier)
    if names is None:
        return set()
    found = [names.metal, names.ior, names.opacity, names.specular, names.normal, names.through]
    found += [*names.base, *names.glow, *names.coat[:2], names.roughness[0], names.under[0]]
    return {*found, "coat_color", "subsurface_color", "transmission_color", "transmission_depth"}


def materialx_inputs(
    material: Usd.Prim, roots: tuple[str, ...] | None, meters: float = 0.01
) -> dict[str, PreviewInput] | None:
    """Channels of a surface that the documentation says is approximated; None for others.

    Names beyond UsdPreviewSurface's come from `OutputMaterial`.
    """
    shader = surface_shader(material)
    kind = str(shader.GetIdAttr().Get()) if shader else ""
    if shader is None or (kind != GLTF_SURFACE and kind not in _LAYERED):
        return None
    result = {name: PreviewInput(np.array(value), None) for name, value in DEFAULTS.items()}
    result.update(
        {n: PreviewInput(np.zeros(1), None) for n in ("displacement", "useSpecularWorkflow")}
    )
    rules = _Rules(NodeValues(roots), shader, meters)
    functions = rules.gltf() if kind == GLTF_SURFACE else rules.layered(_LAYERED[kind])
    for name, function in functions.items():
        result[name] = _channel(rules.nodes, str(shader.GetPath()), function)
    return result


def _channel(nodes: NodeValues, shader: str, function: Function) -> PreviewInput:
    nodes.images.clear()
    nodes.sizes.clear()
    nodes.nodes.clear()
    nodes.primvars.clear()
    try:
        with np.errstate(all="ignore"):  # values that are no numbers have to be declared
            few = function(np.random.default_rng(3).random((_FEW, 2)))
    except UnknownError as error:
        image = min(nodes.images, default="")
        return PreviewInput(None, None, str(error), None, image)
    if not nodes.images:
        return PreviewInput(few[0], None, nodes=tuple(sorted(nodes.nodes)))
    found = PreviewInput(None, None, nodes=(shader, *sorted(nodes.nodes)))
    found.values, found.primvars = function, tuple(sorted(nodes.primvars))
    found.images, found.sizes = tuple(sorted(nodes.images)), tuple(sorted(nodes.sizes))
    return found


@dataclasses.dataclass
class _Rules:
    nodes: NodeValues
    shader: UsdShade.Shader
    meters: float

    def of(self, name: str, *default: float) -> Function:
        """An input as a function of texture coordinates."""
        return lambda st: self.nodes.value(self.shader, name, default, st)

    def number(self, name: str, default: float) -> float:
        """An input that is one number for a whole glTF material; its default for a texture."""
        nothing = np.zeros((1, 2))
        known = len(self.nodes.images)
        try:
            value = float(self.of(name, default)(nothing)[0, 0])
        except UnknownError:
            return default
        return default if len(self.nodes.images) > known else value

    def layered(self, names: Names) -> dict[str, Function]:
        """Channels of standard surface and OpenPBR."""
        base, weight = self.of(names.base[0], *_GRAY), self.of(names.base[1], 1.0)
        under = self.of(names.under[0], 0.0)
        scattered = self.of("subsurface_color", *names.under[1])
        through = self.of(names.through, 0.0)
        tint = self.of("transmission_color", *_WHITE)
        depth = self.number("transmission_depth", 0.0)
        thin = self.number(names.thin, 0.0) != 0.0
        coat, coat_tint = self.of(names.coat[0], 0.0), self.of("coat_color", *_WHITE)
        glow, nits = self.of(names.glow[0], *_WHITE), self.of(names.glow[1], 0.0)
        fuzz, fuzz_color = self.of(names.fuzz[0], 0.0), self.of(names.fuzz[1], *_WHITE)
        absorbs = depth > 0.0 and not thin

        def color(st: Array) -> Array:
            shown = _mix(base(st) * weight(st), scattered(st), under(st))
            shown = _mix(shown, np.ones(3) if absorbs else tint(st), through(st))
            return shown * _mix(np.ones(3), coat_tint(st), coat(st))

        aspect = np.sqrt(1.0 - min(max(self.number(names.grooves, 0.0), 0.0), 0.999))
        rough = self.of(names.roughness[0], names.roughness[1])
        functions = {
            "diffuseColor": color,
            "metallic": self.of(names.metal, 0.0),
            "roughness": lambda st: rough(st) * np.sqrt(aspect),
            "ior": self.of(names.ior, 1.5),
            "opacity": self.of(names.opacity, 1.0),
            "normal": self.of(names.normal, 0.0, 0.0, 1.0),
            "clearcoat": coat,
            "clearcoatRoughness": self.of(names.coat[1], names.coat[2]),
            "emissiveColor": lambda st: glow(st) * nits(st),
            "specular": self.of(names.specular, 1.0),
            "specularTint": self.of("specular_color", *_WHITE),
            "sheenColor": lambda st: fuzz_color(st) * fuzz(st),
            "transmission": through,
            "thickness": lambda st: np.full((len(st), 1), 0.0 if thin else self.meters),
        }
        if absorbs:
            functions["attenuationColor"] = tint
            functions["attenuationDistance"] = lambda st: np.full((len(st), 1), depth * self.meters)
        return functions

    def gltf(self) -> dict[str, Function]:
        """Channels of glTF PBR, whose inputs are glTF's own."""
        emissive, strength = self.of("emissive", *_BLACK), self.of("emissive_strength", 1.0)
        thickness = self.of("thickness", 0.0)
        functions = {
            "diffuseColor": self.of("base_color", *_WHITE),
            "metallic": self.of("metallic", 1.0),
            "roughness": self.of("roughness", 1.0),
            "occlusion": self.of("occlusion", 1.0),
            "normal": self.of("normal", 0.0, 0.0, 1.0),
            "ior": self.of("ior", 1.5),
            "clearcoat": self.of("clearcoat", 0.0),
            "clearcoatRoughness": self.of("clearcoat_roughness", 0.0),
            "emissiveColor": lambda st: emissive(st) * strength(st),
            "specular": self.of("specular", 1.0),
            "specularTint": self.of("specular_color", *_WHITE),
            "sheenColor": self.of("sheen_color", *_BLACK),
            "transmission": self.of("transmission", 0.0),
            "thickness": lambda st: thickness(st) * self.meters,
        }
        mode = int(self.number("alpha_mode", 0.0))
        if mode:
            functions["opacity"] = self.of("alpha", 1.0)
        if mode == 1:
            cutoff = self.number("alpha_cutoff", 0.5)
            functions["opacityThreshold"] = lambda st: np.full((len(st), 1), cutoff)
        return functions


def _mix(ground: Array, figure: Array, share: Array) -> Array:
    return ground * (1.0 - share) + figure * share
