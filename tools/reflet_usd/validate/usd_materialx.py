"""Owns the truth about MaterialX surfaces: the rules by which a file approximates them.

Every channel is evaluated as a function of texture coordinates; the documentation of each surface
gives the rules.
"""

import math
from collections.abc import Callable

import numpy as np
from pxr import Usd, UsdShade

from .scene_data import Array
from .usd_material import DEFAULTS, PreviewInput, surface_shader
from .usd_node_values import NodeValues, UnknownError

GLTF_SURFACE = "ND_gltf_pbr_surfaceshader"
_WHITE, _GRAY, _BLACK = (1.0,) * 3, (0.8,) * 3, (0.0,) * 3
_FEW = 4
_SOMEWHERE = np.random.default_rng(0).random((16, 2))
"""Texture coordinates at which an input that is one number has one value."""
Function = Callable[[Array], Array]


_STANDARD = "ND_standard_surface_surfaceshader"
_OPEN_PBR = "ND_open_pbr_surface_surfaceshader"
_OPEN_NAMES = {
    "base": "base_weight",
    "coat": "coat_weight",
    "emission": "emission_luminance",
    "metalness": "base_metalness",
    "normal": "geometry_normal",
    "opacity": "geometry_opacity",
    "sheen": "fuzz_weight",
    "sheen_color": "fuzz_color",
    "specular": "specular_weight",
    "specular_IOR": "specular_ior",
    "specular_anisotropy": "specular_roughness_anisotropy",
    "subsurface": "subsurface_weight",
    "thin_walled": "geometry_thin_walled",
    "transmission": "transmission_weight",
}
"""OpenPBR's names of standard surface's inputs, where they differ."""


def is_gltf_surface(material: Usd.Prim) -> bool:
    """Whether the material's surface is MaterialX's glTF PBR, which a file can carry whole."""
    shader = surface_shader(material)
    return shader is not None and str(shader.GetIdAttr().Get()) == GLTF_SURFACE


def surface_inputs(shader: UsdShade.Shader) -> set[str]:
    """Inputs of a MaterialX surface, from which the file's values follow; none of others."""
    rules = _Rules(NodeValues(roots=()), shader, 1.0)
    rules.channels()
    return rules.read


def materialx_inputs(
    material: Usd.Prim, roots: tuple[str, ...], meters: float = 0.01
) -> dict[str, PreviewInput] | None:
    """Channels of a surface that the documentation says is approximated; None for others.

    Names beyond UsdPreviewSurface's come from `OutputMaterial`.
    """
    shader = surface_shader(material)
    if shader is None:
        return None
    rules = _Rules(NodeValues(roots), shader, meters)
    functions = rules.channels()
    if not functions:
        return None
    result = {name: PreviewInput(np.array(value), None) for name, value in DEFAULTS.items()}
    result.update(
        {n: PreviewInput(np.zeros(1), None) for n in ("displacement", "useSpecularWorkflow")}
    )
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


class _Rules:
    """Channels of one surface as functions of texture coordinates."""

    def __init__(self, nodes: NodeValues, shader: UsdShade.Shader, meters: float) -> None:
        self.nodes = nodes
        self.shader = shader
        self.meters = meters
        self.kind = str(shader.GetIdAttr().Get())
        self.read: set[str] = set()
        """Inputs that the channels follow from."""

    def channels(self) -> dict[str, Function]:
        """All channels; none of a surface that is not MaterialX's."""
        if self.kind == GLTF_SURFACE:
            return self._gltf()
        return self._layered() if self.kind in (_STANDARD, _OPEN_PBR) else {}

    def of(self, name: str, *default: float) -> Function:
        """An input, by standard surface's name, as a function of texture coordinates."""
        if self.kind == _OPEN_PBR:
            name = _OPEN_NAMES.get(name, name)
        self.read.add(name)
        return lambda st: self.nodes.value(self.shader, name, default, st)

    def fixed(self, name: str, *default: float) -> Array | None:
        """An input that has one value for a whole material; None where it varies."""
        known, self.nodes.images = self.nodes.images, set()
        try:
            values = self.of(name, *default)(_SOMEWHERE)
            same = np.tile(values[0], (len(values), 1))
            varies = bool(self.nodes.images) or not np.array_equal(values, same, equal_nan=True)
        except (UnknownError, ValueError):
            varies = True
        self.nodes.images |= known
        return None if varies else values[0]

    def number(self, name: str, default: float) -> float:
        """An input that is one number for a whole glTF material; its default where it varies."""
        value = self.fixed(name, default)
        return default if value is None else float(value[0])

    def _layered(self) -> dict[str, Function]:
        """Channels of standard surface and OpenPBR."""
        is_open = self.kind == _OPEN_PBR
        base, weight = self.of("base_color", *_GRAY), self.of("base", 1.0)
        under = self.of("subsurface", 0.0)
        scattered = self.of("subsurface_color", *(_GRAY if is_open else _WHITE))
        through = self.of("transmission", 0.0)
        tint = self.of("transmission_color", *_WHITE)
        depth = self.number("transmission_depth", 0.0)
        thin = self.number("thin_walled", 0.0) != 0.0
        coat, coat_tint = self.of("coat", 0.0), self.of("coat_color", *_WHITE)
        glow, nits = self.of("emission_color", *_WHITE), self.of("emission", 0.0)
        fuzz, fuzz_color = self.of("sheen", 0.0), self.of("sheen_color", *_WHITE)
        absorbs = depth > 0.0 and not thin

        # Thin walls whose weight is a number pass a share of the light from their other side.
        share = self.number("subsurface", math.nan)
        forward = self.number("subsurface_scatter_anisotropy", 0.0) if is_open else 1.0
        passed = 0.0
        if thin and share != 0.0 and not math.isnan(share):
            share = min(max(share, 0.0), 1.0)
            passed = share * (1.0 + min(max(forward, -1.0), 1.0)) / 2.0
            under = _constant((share - passed) / max(1.0 - passed, 1e-6))

        # Solids whose weight, color and radius are one value each scatter light within.
        walk: dict[str, Function] = {}
        if not thin and share != 0.0 and not math.isnan(share):
            walk = self._walk(is_open)
        if walk:
            passed, under = min(max(share, 0.0), 1.0), _constant(0.0)

        def below_coat(shown: Array, st: Array) -> Array:
            return shown * _mix(np.ones(3), coat_tint(st), coat(st))

        def color(st: Array) -> Array:
            shown = _mix(base(st) * weight(st), scattered(st), under(st))
            return below_coat(_mix(shown, np.ones(3) if absorbs else tint(st), through(st)), st)

        rough_base = self.number("base_diffuse_roughness" if is_open else "diffuse_roughness", 0.0)
        coat_ior = self.number("coat_ior" if is_open else "coat_IOR", 1.6 if is_open else 1.5)
        aspect = np.sqrt(1.0 - min(max(self.number("specular_anisotropy", 0.0), 0.0), 0.999))
        rough = self.of("specular_roughness", 0.3 if is_open else 0.2)
        functions = {
            "diffuseColor": color,
            "metallic": self.of("metalness", 0.0),
            "roughness": lambda st: rough(st) * np.sqrt(aspect),
            "ior": self.of("specular_IOR", 1.5),
            "opacity": self.of("opacity", 1.0),
            "normal": self.of("normal", 0.0, 0.0, 1.0),
            "clearcoat": coat,
            "clearcoatRoughness": self.of("coat_roughness", 0.0 if is_open else 0.1),
            "clearcoatIor": _constant(coat_ior),
            "diffuseRoughness": _constant(rough_base),
            "emissiveColor": lambda st: glow(st) * nits(st),
            **self._tinted_edges(is_open),
            "sheenColor": lambda st: fuzz_color(st) * fuzz(st),
            "transmission": through,
            "thickness": _constant(0.0 if thin else self.meters),
        }
        functions["diffuseTransmission"] = _constant(passed)
        if walk:
            functions |= walk
            functions["multiscatterColor"] = lambda st: below_coat(scattered(st), st)
        elif passed > 0.0:
            functions["diffuseTransmissionColor"] = lambda st: below_coat(scattered(st), st)
        if absorbs and not walk:
            functions["attenuationColor"] = tint
            functions["attenuationDistance"] = _constant(depth * self.meters)
        return functions

    def _tinted_edges(self, is_open: bool) -> dict[str, Function]:
        """Channels of the specular strength and color, and whether they tint edges."""
        strength, color = self.fixed("specular", 1.0), self.fixed("specular_color", *_WHITE)
        found = {
            "specular": self.of("specular", 1.0),
            "specularTint": self.of("specular_color", *_WHITE),
            "edgeTint": _constant(float(is_open)),
        }
        if is_open:
            is_plain = strength is not None and strength[0] >= 1.0
            if is_plain and color is not None and (color == 1.0).all():
                found["edgeTint"] = _constant(0.0)
            return found
        base, weight = self.fixed("base_color", *_GRAY), self.fixed("base", 1.0)
        if self.number("metalness", 0.0) != 1.0:
            return found
        if strength is None or color is None or base is None or weight is None:
            return found
        r, g = np.clip(base * weight, 0.0, 0.99), np.clip(strength * color, 0.0, 1.0)
        n = g * (1 - r) / (1 + r) + (1 - g) * (1 + np.sqrt(r)) / (1 - np.sqrt(r))
        k = np.sqrt(np.maximum(r * (n + 1) ** 2 - (n - 1) ** 2, 0) / (1 - r))
        # Fresnel's equations for conductors without complex numbers (Born & Wolf, 14.2), at 1/7.
        cosine, sine2, turned = 1 / 7, 48 / 49, 48 / 7
        root = np.hypot(n**2 - k**2 - sine2, 2 * n * k)
        a = np.sqrt(np.maximum(root + n**2 - k**2 - sine2, 0) / 2)
        across, level, slope = root + cosine**2, root + turned**2, 2 * a * turned
        s_wave = (across - 2 * a * cosine) / (across + 2 * a * cosine)
        share = s_wave * (1 + (level - slope) / (level + slope)) / 2
        edges = np.minimum(share / (r + (1 - r) * (1 - cosine) ** 5), 1.0)
        found["specularTint"] = lambda st: np.tile(edges, (len(st), 1))
        found["edgeTint"] = _constant(float((edges != 1.0).any()))
        return {**found, "specular": _constant(1.0)}

    def _walk(self, is_open: bool) -> dict[str, Function]:
        """Channels of the inside of a solid that scatters light; none of another."""
        color = self.fixed("subsurface_color", *(_GRAY if is_open else _WHITE))
        through = self.fixed("transmission", 0.0)
        if is_open:
            radius = self.fixed("subsurface_radius", 1.0)
            scales = self.fixed("subsurface_radius_scale", 1.0, 0.5, 0.25)
        else:
            radius = self.fixed("subsurface_scale", 1.0)
            scales = self.fixed("subsurface_radius", *_WHITE)
        tint, coat = self.fixed("coat_color", *_WHITE), self.fixed("coat", 0.0)
        if color is None or tint is None or coat is None:
            return {}
        if _mix(color, color * tint, coat).max() <= 0.0:
            return {}
        if through is None or through[0] != 0.0:
            return {}
        if radius is None or scales is None or (radius * scales).max() <= 0.0:
            return {}
        paths = np.maximum(radius * scales, (radius * scales).max() * 1e-6) * self.meters
        name = "subsurface_scatter_anisotropy" if is_open else "subsurface_anisotropy"
        turn = min(max(self.number(name, 0.0), -1.0), 1.0)
        return {
            "attenuationColor": lambda st: np.tile(np.exp(-paths.max() / paths), (len(st), 1)),
            "attenuationDistance": _constant(paths.max()),
            "scatterAnisotropy": _constant(turn),
        }

    def _gltf(self) -> dict[str, Function]:
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
            "diffuseTransmission": _constant(0.0),
            "transmission": self.of("transmission", 0.0),
            "thickness": lambda st: thickness(st) * self.meters,
        }
        mode = int(self.number("alpha_mode", 0.0))
        if mode:
            functions["opacity"] = self.of("alpha", 1.0)
        if mode == 1:
            cutoff = self.number("alpha_cutoff", 0.5)
            functions["opacityThreshold"] = _constant(cutoff)
        return functions


def _constant(value: float) -> Function:
    return lambda st: np.full((len(st), 1), value)


def _mix(ground: Array, figure: Array, share: Array) -> Array:
    return ground * (1.0 - share) + figure * share
