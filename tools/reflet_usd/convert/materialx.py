"""MaterialX surfaces (standard surface, OpenPBR, glTF PBR) as inputs of a glTF material.

The counterparts follow MaterialX's own translations (libraries/bxdf/translation), where there is
one. Texture reads stay texture reads where one factor or mix remains in front of them.
"""

import math
from collections.abc import Callable

from pxr import Usd, UsdShade

from .network import NetworkReader
from .source_arithmetic import Numbers, affine, mixed, product, widened
from .sources import Constant, Source, UnfitError, numbers

_BLACK, _WHITE, _GRAY = (0.0,) * 3, (1.0,) * 3, (0.8,) * 3
_GLTF = "ND_gltf_pbr_surfaceshader"
# Abbe number at which glTF's dispersion is 1 (KHR_materials_dispersion).
_ABBE_OF_ONE = 20.0
# Inputs that glTF lacks, and the values at which nothing is lost.
_NEUTRAL: dict[str, Numbers] = {
    "coat_affect_color": (0.0,),
    "coat_affect_roughness": (0.0,),
    "coat_anisotropy": (0.0,),
    "coat_roughness_anisotropy": (0.0,),
    "transmission_extra_roughness": (0.0,),
    "transmission_scatter": _BLACK,
}


class _Surface:
    """Inputs of one surface node, and its losses."""

    def __init__(self, reader: NetworkReader, shader: UsdShade.Shader) -> None:
        self.reader = reader
        self.shader = shader
        self.read: set[str] = set()
        self.lost: list[str] = []
        self.absent_layers: list[str] = []
        """Prefixes of inputs that change nothing, as the weight of their layer is 0."""

    def get(self, name: str, default: Numbers) -> Source:
        """Value of an input, as wide as `default`."""
        self.read.add(name)
        source = self.reader.source(self.shader, name)
        return Constant(default) if source is None else widened(source, len(default))

    def authored(self, name: str) -> Source | None:
        """Value of an input; None where it has none."""
        self.read.add(name)
        return self.reader.source(self.shader, name)

    def number(self, name: str, default: float) -> float:
        """Value of an input that glTF has no texture for; a texture is named and left out."""
        source = self.get(name, (default,))
        if isinstance(source, Constant):
            return source.value[0]
        message = f"glTF has no texture for '{name}', taken as {default:g}"
        self.reader.context.ledger.warn("material-texture-dropped", self.reader.material, message)
        return default

    def clamped(self, name: str, value: float, least: float) -> float:
        """Value of an input within `least`…1, with a warning where it lies outside."""
        within = min(max(value, least), 1.0)
        if within != value:
            message = f"'{name}' {value:g} is outside {least:g}…1, clamped"
            self.reader.context.ledger.warn("material-value-clamped", self.reader.material, message)
        return within

    def weight(self, name: str, layer: str) -> Source:
        """Weight of a layer whose other inputs begin with `layer`."""
        source = self.get(name, (0.0,))
        if source == Constant((0.0,)):
            self.absent_layers.append(layer)
        return source

    def times(self, name: str, color: Source, weight: Source) -> Source:
        """The product; `color` alone, with a warning, where both are textures."""
        return self._joint(name, color, lambda: product(self.shader, color, widened(weight, 3)))

    def mix(self, name: str, ground: Source, figure: Source, share: Source) -> Source:
        """The mix; `ground` alone, with a warning, where it is none of one texture."""
        share = widened(share, 3)
        return self._joint(name, ground, lambda: mixed(self.shader, ground, figure, share))

    def _joint(self, name: str, alone: Source, function: Callable[[], Source]) -> Source:
        try:
            return function()
        except UnfitError as error:
            self.reader.warn_unfit(name, error)
            return alone

    def losses(self) -> list[str]:
        """Names of the inputs whose values are lost."""
        lost = set(self.lost)
        for entry in self.shader.GetInputs():
            name = str(entry.GetBaseName())
            if name in self.read or not entry.GetValueProducingAttributes():
                continue
            if any(name.startswith(layer) for layer in self.absent_layers):
                continue
            value = numbers(self.reader.value(self.shader, name, None))
            if value is None or value != _NEUTRAL.get(name):
                lost.add(name)
        return sorted(lost)


def approximate(
    reader: NetworkReader, prim: Usd.Prim, shader: UsdShade.Shader, kind: str
) -> dict[str, Source]:
    """Inputs of the glTF material; what it cannot express gives one warning."""
    surface = _Surface(reader, shader)
    inputs = MATERIALX_SURFACES[kind](surface)
    lost = surface.losses()
    if lost or kind != _GLTF:
        without = f"; without {', '.join(lost)}" if lost else ""
        message = f"{kind} is approximated by glTF's material{without}"
        reader.context.ledger.warn("material-approximated", prim, message)
    return inputs


def _standard_surface(surface: _Surface) -> dict[str, Source]:
    inputs: dict[str, Source] = {
        "metallic": surface.get("metalness", (0.0,)),
        "ior": surface.get("specular_IOR", (1.5,)),
        "clearcoat": surface.weight("coat", "coat_"),
        "clearcoatRoughness": surface.get("coat_roughness", (0.1,)),
        "opacity": surface.get("opacity", (1.0,)),
        "specular": surface.get("specular", (1.0,)),
        "specularTint": surface.get("specular_color", _WHITE),
        "sheenRoughness": _root(surface, "sheen_roughness", 0.3),
        "diffuseRoughness": Constant((surface.number("diffuse_roughness", 0.0),)),
        "clearcoatIor": Constant((surface.number("coat_IOR", 1.5),)),
        **_normals(surface, "normal", "coat_normal"),
    }
    base = surface.times(
        "base_color", surface.get("base_color", _GRAY), surface.get("base", (1.0,))
    )
    thin = surface.number("thin_walled", 0.0) != 0.0
    _artistic_metal(inputs, base)
    base = _scattering(surface, inputs, base, is_open=False, thin=thin)
    base = _transmitting(surface, inputs, base, "transmission", thin)
    _set_under_coat(surface, inputs, base)
    abbe = surface.number("transmission_dispersion", 0.0)
    inputs["dispersion"] = Constant((_ABBE_OF_ONE / abbe if abbe > 0.0 else 0.0,))
    sheen = surface.weight("sheen", "sheen_")
    inputs["sheenColor"] = surface.times("sheen", surface.get("sheen_color", _WHITE), sheen)
    emission = surface.get("emission", (0.0,))
    color = surface.get("emission_color", _WHITE)
    inputs["emissiveColor"] = surface.times("emission_color", color, emission)
    film = surface.number("thin_film_thickness", 0.0)
    _film(inputs, float(film > 0.0), film, surface.number("thin_film_IOR", 1.5))
    turn = -2.0 * math.pi * surface.number("specular_rotation", 0.0)
    _grooves(surface, inputs, 0.2, "specular_anisotropy", turn)
    return inputs


def _open_pbr(surface: _Surface) -> dict[str, Source]:
    inputs: dict[str, Source] = {
        "metallic": surface.get("base_metalness", (0.0,)),
        "ior": surface.get("specular_ior", (1.5,)),
        "clearcoat": surface.weight("coat_weight", "coat_"),
        "clearcoatRoughness": surface.get("coat_roughness", (0.0,)),
        "opacity": surface.get("geometry_opacity", (1.0,)),
        "specular": surface.get("specular_weight", (1.0,)),
        "specularTint": surface.get("specular_color", _WHITE),
        "edgeTint": Constant((1.0,)),
        "sheenRoughness": surface.get("fuzz_roughness", (0.5,)),
        "diffuseRoughness": Constant((surface.number("base_diffuse_roughness", 0.0),)),
        "clearcoatIor": Constant((surface.number("coat_ior", 1.6),)),
        **_normals(surface, "geometry_normal", "geometry_coat_normal"),
    }
    if inputs["metallic"] != Constant((0.0,)) and inputs["specular"] != Constant((1.0,)):
        surface.lost.append("specular_weight of metal")
    weight = surface.get("base_weight", (1.0,))
    base = surface.times("base_color", surface.get("base_color", _GRAY), weight)
    thin = surface.number("geometry_thin_walled", 0.0) != 0.0
    base = _scattering(surface, inputs, base, is_open=True, thin=thin)
    base = _transmitting(surface, inputs, base, "transmission_weight", thin)
    _set_under_coat(surface, inputs, base)
    share = surface.number("transmission_dispersion_scale", 0.0)
    abbe = surface.number("transmission_dispersion_abbe_number", 20.0)
    inputs["dispersion"] = Constant((share * _ABBE_OF_ONE / abbe if abbe > 0.0 else 0.0,))
    fuzz = surface.weight("fuzz_weight", "fuzz_")
    inputs["sheenColor"] = surface.times("fuzz_color", surface.get("fuzz_color", _WHITE), fuzz)
    nits = surface.get("emission_luminance", (0.0,))
    color = surface.get("emission_color", _WHITE)
    inputs["emissiveColor"] = surface.times("emission_color", color, nits)
    weight_of_film = surface.number("thin_film_weight", 0.0)
    nanometers = 1000.0 * surface.number("thin_film_thickness", 0.5)
    _film(inputs, weight_of_film, nanometers, surface.number("thin_film_ior", 1.4))
    _grooves(surface, inputs, 0.3, "specular_roughness_anisotropy", 0.0)
    return inputs


def _gltf_pbr(surface: _Surface) -> dict[str, Source]:
    same: dict[str, tuple[str, Numbers]] = {
        "diffuseColor": ("base_color", _WHITE),
        "metallic": ("metallic", (1.0,)),
        "roughness": ("roughness", (1.0,)),
        "occlusion": ("occlusion", (1.0,)),
        "ior": ("ior", (1.5,)),
        "transmission": ("transmission", (0.0,)),
        "specular": ("specular", (1.0,)),
        "specularTint": ("specular_color", _WHITE),
        "sheenColor": ("sheen_color", _BLACK),
        "sheenRoughness": ("sheen_roughness", (0.0,)),
        "clearcoat": ("clearcoat", (0.0,)),
        "clearcoatRoughness": ("clearcoat_roughness", (0.0,)),
        "attenuationColor": ("attenuation_color", _WHITE),
        "iridescence": ("iridescence", (0.0,)),
    }
    inputs = {name: surface.get(*other) for name, other in same.items()}
    inputs.update(_normals(surface, "normal", "clearcoat_normal"))
    meters = surface.reader.context.meters_per_unit
    for name, other in (
        ("thickness", "thickness"),
        ("attenuationDistance", "attenuation_distance"),
    ):
        inputs[name] = affine(surface.shader, surface.get(other, (0.0,)), (meters,), (0.0,))
    numbers_of = {
        "anisotropy": ("anisotropy_strength", 0.0),
        "anisotropyRotation": ("anisotropy_rotation", 0.0),
        "dispersion": ("dispersion", 0.0),
        "iridescenceIor": ("iridescence_ior", 1.3),
        "iridescenceThickness": ("iridescence_thickness", 100.0),
    }
    for name, number in numbers_of.items():
        inputs[name] = Constant((surface.number(*number),))
    emissive, strength = surface.get("emissive", _BLACK), surface.get("emissive_strength", (1.0,))
    inputs["emissiveColor"] = surface.times("emissive", emissive, strength)
    alpha, cutoff = surface.get("alpha", (1.0,)), surface.number("alpha_cutoff", 0.5)
    mode = int(surface.number("alpha_mode", 0.0))
    if mode:  # 0 is opaque, 1 a mask, 2 blended
        inputs["opacity"] = alpha
    if mode == 1:
        inputs["opacityThreshold"] = Constant((cutoff,))
    return inputs


MATERIALX_SURFACES: dict[str, Callable[[_Surface], dict[str, Source]]] = {
    "ND_standard_surface_surfaceshader": _standard_surface,
    "ND_open_pbr_surface_surfaceshader": _open_pbr,
    _GLTF: _gltf_pbr,
}


def _normals(surface: _Surface, normal: str, coat_normal: str) -> dict[str, Source]:
    found = {"normal": surface.authored(normal), "coatNormal": surface.authored(coat_normal)}
    return {name: source for name, source in found.items() if source is not None}


def _artistic_metal(inputs: dict[str, Source], base: Source) -> None:
    """Tint edges as `artistic_ior` does in MaterialX's graph of standard surface, for a constant.

    Gulbrandsen 2014, "Artist Friendly Metallic Fresnel": an index from the color and the color of
    edges. Its reflectance at 82° by Fresnel's equations, over Schlick's share there, is the tint.
    """
    metal, weight, tint = (inputs[name] for name in ("metallic", "specular", "specularTint"))
    constants = [one.value for one in (base, weight, tint) if isinstance(one, Constant)]
    if metal != Constant((1.0,)) or len(constants) < 3:
        return
    (share,), edges = constants[1], []
    for color, edge in zip(constants[0], constants[2], strict=True):
        r, g = min(max(color, 0.0), 0.99), min(max(edge * share, 0.0), 1.0)
        n = g * (1 - r) / (1 + r) + (1 - g) * (1 + math.sqrt(r)) / (1 - math.sqrt(r))
        k2 = max(r * (n + 1) ** 2 - (n - 1) ** 2, 0.0) / (1 - r)
        index = complex(n, math.sqrt(k2)) ** 2
        bent, cosine = (index - 48 / 49) ** 0.5, 1 / 7
        waves = (
            (cosine - bent) / (cosine + bent),
            (index * cosine - bent) / (index * cosine + bent),
        )
        schlick = r + (1 - r) * (6 / 7) ** 5
        edges.append(min(sum(abs(wave) ** 2 for wave in waves) / 2 / schlick, 1.0))
    inputs["specular"], inputs["specularTint"] = Constant((1.0,)), Constant(tuple(edges))
    inputs["edgeTint"] = Constant((1.0,))


def _scattering(
    surface: _Surface, inputs: dict[str, Source], base: Source, *, is_open: bool, thin: bool
) -> Source:
    """Base color with the subsurface color, at its weight, of OpenPBR or standard surface.

    Thin walls scatter a share of the light that reaches this color to their other side, which is
    diffuse transmission: all of it in MaterialX's graph of standard surface, by the anisotropy in
    OpenPBR (version 1.1, "Thin-walled case"). Light enters a solid by diffuse transmission, and is
    scattered within.
    """
    weight_name = "subsurface_weight" if is_open else "subsurface"
    weight = surface.weight(weight_name, "subsurface_")
    color = surface.get("subsurface_color", _GRAY if is_open else _WHITE)
    if thin and isinstance(weight, Constant) and weight.value[0] != 0.0:
        surface.absent_layers += ["subsurface_radius", "subsurface_scale"]
        share, forward = surface.clamped(weight_name, weight.value[0], 0.0), 1.0
        if is_open:
            name = "subsurface_scatter_anisotropy"
            forward = 0.5 + 0.5 * surface.clamped(name, surface.number(name, 0.0), -1.0)
        through = forward * share
        inputs["diffuseTransmission"] = Constant((through,))
        inputs["diffuseTransmissionColor"] = color
        weight = Constant(((share - through) / max(1.0 - through, 1e-6),))
    elif isinstance(weight, Constant) and isinstance(color, Constant) and weight.value[0] != 0.0:
        radii = _radii(surface, is_open)
        passes = surface.get("transmission_weight" if is_open else "transmission", (0.0,))
        tinted = _under_coat(surface, inputs, color)
        is_seen = isinstance(tinted, Constant) and max(tinted.value) > 0.0
        if radii is not None and passes == Constant((0.0,)) and is_seen:
            share = surface.clamped(weight_name, weight.value[0], 0.0)
            inputs["diffuseTransmission"] = Constant((share,))
            inputs["multiscatterColor"] = tinted
            name = "subsurface_scatter_anisotropy" if is_open else "subsurface_anisotropy"
            turn = surface.clamped(name, surface.number(name, 0.0), -1.0)
            inputs["scatterAnisotropy"] = Constant((turn,))
            longest = max(radii)
            inputs["attenuationDistance"] = Constant((longest,))
            dark = tuple(math.exp(-longest / max(radius, longest * 1e-6)) for radius in radii)
            inputs["attenuationColor"] = Constant(dark)
            return base
    if weight != Constant((0.0,)):
        surface.lost.append(weight_name)
    return surface.mix("subsurface_color", base, color, weight)


def _radii(surface: _Surface, is_open: bool) -> tuple[float, ...] | None:
    """Mean free path of each color below a surface, meters; None where it varies, or is 0."""
    if is_open:
        scales = surface.get("subsurface_radius_scale", (1.0, 0.5, 0.25))
        length = surface.get("subsurface_radius", (1.0,))
    else:
        scales = surface.get("subsurface_radius", _WHITE)
        length = surface.get("subsurface_scale", (1.0,))
    if not isinstance(scales, Constant) or not isinstance(length, Constant):
        return None
    meters = surface.reader.context.meters_per_unit
    radii = tuple(max(scale * length.value[0] * meters, 0.0) for scale in scales.value)
    return radii if max(radii) > 0.0 else None


def _transmitting(
    surface: _Surface, inputs: dict[str, Source], base: Source, weight_name: str, thin: bool
) -> Source:
    """Set transmission and volume; returns the base color, which tints what glTF transmits."""
    weight = surface.weight(weight_name, "transmission_")
    color = surface.get("transmission_color", _WHITE)
    depth = surface.number("transmission_depth", 0.0)
    meters = surface.reader.context.meters_per_unit
    inputs["transmission"] = weight
    inputs["thickness"] = Constant((0.0 if thin else meters,))
    if depth > 0.0 and not thin and "multiscatterColor" not in inputs:
        inputs["attenuationColor"] = color
        inputs["attenuationDistance"] = Constant((depth * meters,))
        color = Constant(_WHITE)
    return surface.mix("transmission_color", base, color, weight)


def _under_coat(surface: _Surface, inputs: dict[str, Source], shown: Source) -> Source:
    """A color of diffuse light as the tinted coat shows it."""
    color = surface.get("coat_color", _WHITE)
    tint = surface.mix("coat_color", Constant(_WHITE), color, inputs["clearcoat"])
    return surface.times("coat_color", shown, tint)


def _set_under_coat(surface: _Surface, inputs: dict[str, Source], base: Source) -> None:
    """Set the colors of diffuse light as the tinted coat shows them."""
    inputs["diffuseColor"] = base
    for name in ("diffuseColor", "diffuseTransmissionColor"):
        if name in inputs:
            inputs[name] = _under_coat(surface, inputs, inputs[name])


def _root(surface: _Surface, name: str, default: float) -> Source:
    """Square root of a number, which glTF squares; a texture stays as it is."""
    source = surface.get(name, (default,))
    if isinstance(source, Constant):
        return Constant((math.sqrt(max(source.value[0], 0.0)),))
    surface.lost.append(name)
    return source


def _film(inputs: dict[str, Source], weight: float, nanometers: float, ior: float) -> None:
    inputs["iridescence"] = Constant((weight,))
    inputs["iridescenceThickness"] = Constant((nanometers,))
    inputs["iridescenceIor"] = Constant((ior,))


def _grooves(
    surface: _Surface, inputs: dict[str, Source], default: float, name: str, turn: float
) -> None:
    """Set roughness and anisotropy: MaterialX stretches the lobe both ways, glTF one way."""
    roughness = surface.get("specular_roughness", (default,))
    anisotropy = min(max(surface.number(name, 0.0), 0.0), 0.999)
    inputs["roughness"] = roughness
    if anisotropy == 0.0:
        return
    if not isinstance(roughness, Constant):
        surface.lost.append(name)
        return
    alpha, aspect = min(max(roughness.value[0], 0.0), 1.0) ** 2, math.sqrt(1.0 - anisotropy)
    along, across = min(alpha / aspect, 1.0), alpha * aspect
    inputs["roughness"] = Constant((math.sqrt(across),))
    strength = math.sqrt((along - across) / (1.0 - across)) if across < 1.0 else 0.0
    inputs["anisotropy"] = Constant((strength,))
    inputs["anisotropyRotation"] = Constant((turn,))
