// Single-scattering variant: each facet reflects light once, as in glTF 2.0, appendix B; light that hits other
// facets is lost.

#import frame
#import lobe_albedo

const CONSERVES_ENERGY: bool = false;

// Factor on the specular lobe for the light that facets reflect more than once: 1.
fn compensation(s: Surface, view: vec3f) -> vec3f {
    return vec3f(1.0);
}

// Albedo of the specular lobe alone under uniform light.
fn lobe_reflectance(s: Surface, view: vec3f) -> vec3f {
    let cosine = saturate(dot(s.normal, view));
    let lobe = shown_lobe(s, view);
    if (is_transmissive(s)) { return transmissive_fresnel(s, cosine) * lobe.x; }
    return split_sum(f0(s), grazing_reflectance(s), lobe);
}

// Share of light that is left of a reflectance: equal for all colors where the reflection is tinted, like `fresnel_mix`
// of KHR_materials_specular.
fn left_of(s: Surface, reflectance: vec3f) -> vec3f {
    if (!HAS_TINTS) { return vec3f(1.0) - reflectance; }
    return vec3f(1.0 - max(reflectance.x, max(reflectance.y, reflectance.z)));
}

// Share of light that the specular lobe leaves to diffuse light, averaged over the hemisphere so that it does not
// depend on the view. The cosine-weighted mean of Schlick's curve is F0 + (F90 - F0) / 21.
fn unreflected(s: Surface, view: vec3f) -> f32 {
    let f = dielectric_reflectance(s);
    return 1.0 - (f.x + (f.y - f.x) / 21.0);
}

// Share of light that a clear coat does not let through: its reflectance if it were smooth.
fn coat_albedo(roughness: f32, cosine: f32) -> f32 {
    return COAT_REFLECTIVITY + (1.0 - COAT_REFLECTIVITY) * schlick_weight(cosine);
}
