"""The Khronos formulas as Mitsuba BSDFs, written from the specification and not from our shaders.

glTF 2.0 appendix B and KHR_materials_clearcoat, _transmission, _specular and _sheen, with the
choices that docs/light.md states: the height-correlated Smith term, a diffuse albedo that does not
depend on the view, and a sheen that dims the layer below by the view direction alone.
"""

from typing import Any

import drjit as dr
import mitsuba as mi

COAT_F0 = 0.04
SMOOTHEST_ALPHA = 2e-3
LEAST_COSINE = 1e-3


def schlick(f0: Any, f90: Any, cosine: Any) -> Any:
    return f0 + (f90 - f0) * (1 - dr.clip(cosine, 0, 1)) ** 5


def correlated_ggx(alpha: float, wi: Any, wo: Any, m: Any) -> Any:
    """D × G2 / (4 cos cos) × cos of `wo`; Heitz 2014, eq. 99."""
    a2 = alpha * alpha
    ni, no, nm = wi.z, wo.z, dr.clip(m.z, 0, 1)
    d = a2 / (dr.pi * (nm * nm * (a2 - 1) + 1) ** 2)
    root_i, root_o = dr.sqrt(a2 + (1 - a2) * ni * ni), dr.sqrt(a2 + (1 - a2) * no * no)
    return d * 0.5 / dr.maximum(no * root_i + ni * root_o, 1e-9) * no


class Layer:
    """One GGX lobe with its sampling."""

    def __init__(self, roughness: float) -> None:
        self.alpha = max(roughness**2, SMOOTHEST_ALPHA)
        self.facets = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.alpha, True)

    def value(self, wi: Any, wo: Any, m: Any) -> Any:
        return correlated_ggx(self.alpha, wi, wo, m)

    def sample(self, wi: Any, square: Any) -> Any:
        return mi.reflect(wi, self.facets.sample(wi, square)[0])

    def pdf(self, wi: Any, m: Any) -> Any:
        return self.facets.pdf(wi, m) / dr.maximum(4 * dr.dot(wi, m), 1e-9)


def charlie(roughness: float, wi: Any, wo: Any, m: Any) -> Any:
    """Distribution and visibility of KHR_materials_sheen, times the cosine of `wo`."""
    alpha = roughness**2
    t = (1 - alpha) ** 2
    a, b, c, d, e = (
        smooth + (rough - smooth) * t
        for smooth, rough in (
            (21.5473, 25.3245),
            (3.82987, 3.32435),
            (0.19823, 0.16801),
            (-1.97760, -1.27393),
            (-4.32054, -4.85967),
        )
    )

    def fit(x: Any) -> Any:
        return a / (1 + b * dr.power(dr.maximum(x, 1e-6), c)) + d * x + e

    def masked(cosine: Any) -> Any:
        far = dr.exp(2 * fit(mi.Float(0.5)) - fit(1 - cosine))
        return dr.select(cosine < 0.5, dr.exp(fit(cosine)), far)

    sine2 = dr.maximum(1 - m.z * m.z, 1e-7)
    distribution = (2 + 1 / alpha) * dr.power(sine2, 0.5 / alpha) / (2 * dr.pi)
    ni, no = dr.maximum(wi.z, 1e-4), dr.maximum(wo.z, 1e-4)
    return distribution / ((1 + masked(ni) + masked(no)) * 4 * ni)


class Sheen:
    """The sheen lobe of a roughness, and its directional albedo."""

    NODES = 64

    def __init__(self, color: list[float], roughness: float) -> None:
        self.color = color
        self.roughness = roughness
        steps, turns = 256, 64
        lane = dr.arange(mi.UInt32, self.NODES * steps * turns)
        node, step, turn = lane // (steps * turns), lane // turns % steps, lane % turns
        cosine = dr.maximum(mi.Float(node) / (self.NODES - 1), LEAST_COSINE)
        view = mi.Vector3f(dr.sqrt(1 - cosine * cosine), 0, cosine)
        # Steps are denser towards the horizon; turns cover half the circle, the rest is symmetric.
        u = (mi.Float(step) + 0.5) / steps
        up = u * u
        flat = dr.sqrt(1 - up * up)
        phi = dr.pi * (mi.Float(turn) + 0.5) / turns
        light = mi.Vector3f(flat * dr.cos(phi), flat * dr.sin(phi), up)
        value = charlie(roughness, view, light, dr.normalize(view + light)) * 4 * dr.pi * u
        self.albedo = mi.Float(value.numpy().reshape(self.NODES, -1).mean(axis=1))

    def below(self, wi: Any) -> Any:
        """Share of the light that the layer below the sheen keeps."""
        place = dr.clip(wi.z, 0, 1) * (self.NODES - 1)
        index = mi.UInt32(dr.minimum(place, self.NODES - 2))
        low = dr.gather(mi.Float, self.albedo, index)
        high = dr.gather(mi.Float, self.albedo, index + 1)
        return 1 - max(self.color) * dr.lerp(low, high, place - mi.Float(index))


class Khronos(mi.BSDF):
    """A metal, a dielectric or a mix of them, perhaps under a sheen or a clear coat."""

    def __init__(self, props: mi.Properties) -> None:
        mi.BSDF.__init__(self, props)
        color = [props.get(c, 1.0) for c in ("red", "green", "blue")]
        self.color = [float(c) for c in color]
        self.metallic = float(props.get("metallic", 0.0))
        self.f0 = float(props.get("reflectivity", 0.04))
        self.strength = float(props.get("specular", 1.0))
        self.tint = [float(props.get(f"specular_{c}", 1.0)) for c in ("red", "green", "blue")]
        sheen = [float(props.get(f"sheen_{c}", 0.0)) for c in ("red", "green", "blue")]
        self.sheen = Sheen(sheen, float(props.get("sheen_roughness", 0.0))) if any(sheen) else None
        self.coat = float(props.get("clearcoat", 0.0))
        self.layers = [Layer(float(props.get("roughness", 1.0)))]
        if self.coat > 0:
            self.layers.append(Layer(float(props.get("clearcoat_roughness", 0.0))))
        flags = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.GlossyReflection
        self.m_components = [flags | mi.BSDFFlags.FrontSide]
        self.m_flags = self.m_components[0]

    def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        wi = si.wi
        m = dr.normalize(wi + wo)
        cosine = dr.dot(wi, m)
        color = mi.Color3f(self.color)
        # Below 2 % the lobe is occluded: Lagarde & de Rousiers 2014, 3.2.
        f90 = dr.clip(50 * dr.mean(dr.lerp(mi.Color3f(self.f0), color, self.metallic)), 0, 1)
        f90 *= self.strength + (1 - self.strength) * self.metallic
        dielectric = [min(self.f0 * tint, 1.0) * self.strength for tint in self.tint]
        f0 = dr.lerp(mi.Color3f(dielectric), color, self.metallic)
        dielectric_f90 = min(50 * self.f0, 1.0) * self.strength
        lost = max(dielectric) + (dielectric_f90 - max(dielectric)) / 21
        diffuse = color * ((1 - self.metallic) * (1 - lost)) * (dr.inv_pi * wo.z)
        value = diffuse + schlick(f0, f90, cosine) * self.layers[0].value(wi, wo, m)
        if self.sheen:
            fibers = charlie(self.sheen.roughness, wi, wo, m)
            value = value * self.sheen.below(wi) + mi.Color3f(self.sheen.color) * fibers
        if self.coat > 0:
            value *= 1 - self.coat * schlick(COAT_F0, 1.0, wi.z)
            value += self.coat * schlick(COAT_F0, 1.0, cosine) * self.layers[1].value(wi, wo, m)
        return dr.select(active & (wi.z > 0) & (wo.z > 0), value, 0)

    def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        m = dr.normalize(si.wi + wo)
        total = mi.warp.square_to_cosine_hemisphere_pdf(wo)
        for layer in self.layers:
            total += layer.pdf(si.wi, m)
        return dr.select(active & (si.wi.z > 0) & (wo.z > 0), total / (1 + len(self.layers)), 0)

    def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
        kind = sample1 * (1 + len(self.layers))
        wo = mi.warp.square_to_cosine_hemisphere(sample2)
        for index, layer in enumerate(self.layers):
            chosen = (kind >= 1 + index) & (kind < 2 + index)
            wo = dr.select(chosen, layer.sample(si.wi, sample2), wo)
        sample = mi.BSDFSample3f()
        sample.wo = wo
        sample.pdf = self.pdf(ctx, si, wo, active)
        sample.eta = 1.0
        sample.sampled_type = +mi.BSDFFlags.GlossyReflection
        sample.sampled_component = 0
        value = self.eval(ctx, si, wo, active)
        usable = active & (sample.pdf > 0)
        return sample, dr.select(usable, value / dr.maximum(sample.pdf, 1e-20), 0)

    def to_string(self) -> str:
        return "Khronos[]"


class ThinPane(mi.BSDF):
    """A thin smooth pane: one Fresnel reflection, the rest goes straight through, tinted."""

    def __init__(self, props: mi.Properties) -> None:
        mi.BSDF.__init__(self, props)
        self.color = [float(props.get(c, 1.0)) for c in ("red", "green", "blue")]
        self.ior = float(props.get("ior", 1.5))
        self.m_components = [
            mi.BSDFFlags.DeltaReflection | mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide,
            mi.BSDFFlags.Null | mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide,
        ]
        self.m_flags = self.m_components[0] | self.m_components[1]

    def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
        reflected, _, _, _ = mi.fresnel(dr.abs(si.wi.z), self.ior)
        is_mirrored = sample1 < reflected
        sample = mi.BSDFSample3f()
        sample.wo = dr.select(is_mirrored, mi.reflect(si.wi), -si.wi)
        sample.pdf = dr.select(is_mirrored, reflected, 1 - reflected)
        sample.eta = 1.0
        sample.sampled_type = dr.select(
            is_mirrored, mi.UInt32(+mi.BSDFFlags.DeltaReflection), mi.UInt32(+mi.BSDFFlags.Null)
        )
        sample.sampled_component = dr.select(is_mirrored, mi.UInt32(0), mi.UInt32(1))
        weight = dr.select(is_mirrored, mi.Color3f(1), mi.Color3f(self.color))
        return sample, dr.select(active, weight, 0)

    def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        return mi.Color3f(0)

    def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        return mi.Float(0)

    def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        return mi.Color3f(0), mi.Float(0)

    def to_string(self) -> str:
        return "ThinPane[]"


def register() -> None:
    """Register both BSDFs with `mi.load_dict`; call it after choosing the variant."""
    mi.register_bsdf("khronos", Khronos)
    mi.register_bsdf("thin_pane", ThinPane)
