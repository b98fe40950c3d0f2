// Energy of lobes. Where it is conserved, the specular lobe is scaled up by the light that single scattering between
// facets loses, and all that a lobe does not reflect reaches the layers below it; else each facet reflects light once,
// as in glTF 2.0, appendix B, and light that hits other facets is lost.

#import frame
#import lobe_albedo

override CONSERVES_ENERGY: bool = true;

// Light that the facets of a lobe block, relative to the light that they reflect.
fn lost(lobe: vec4f) -> f32 {
    return 1.0 / max(lobe.x, 1e-3) - 1.0;
}

// Factor on the specular lobe, `shown_lobe`, for the light that facets reflect more than once (Turquin 2019, "Practical
// Multiple Scattering Compensation for Microfacet Models", eq. 16): metal and dielectric each by its own reflectance.
fn compensation(s: Surface, lobe: vec4f) -> vec3f {
    if (!CONSERVES_ENERGY || mirrors_inside(s)) { return vec3f(1.0); }
    let dielectric = dielectric_f0(s);
    let again = mix(dielectric * dielectric, s.base_color * s.base_color, s.metallic) / max(f0(s), vec3f(1e-6));
    return vec3f(1.0) + again * lost(lobe);
}

// Albedo of the specular lobe alone under uniform light. The split sum has Schlick's Fresnel term, where the exact one
// counts: the smoother it is, the more the ratio of both towards the view holds for the lobe.
fn lobe_reflectance(s: Surface, view: vec3f) -> vec3f {
    let lobe = shown_lobe(s, view);
    if (!CONSERVES_ENERGY && is_exact(s)) { return exact_fresnel(s, saturate(dot(s.normal, view))) * lobe.x; }
    // The facet at which Schlick's power has its mean over the lobe stands for all facets.
    let dip = edge_dip(s, 1.0 - pow(lobe.y / max(lobe.x, 1e-3), 0.2)) * lobe.x;
    let rough = max(split_sum(f0(s), grazing_reflectance(s), lobe) - dip, vec3f(0.0)) * compensation(s, lobe);
    if (!is_exact(s)) { return rough; }
    let cosine = dot(s.normal, view);
    let exact = exact_fresnel(s, cosine) / max(schlick_fresnel(s, cosine), vec3f(1e-6));
    return rough * mix(exact, vec3f(1.0), shown_roughness(s));
}

// Share of light that is left of a reflectance: in each color below a film; a tint leaves all colors what it leaves of
// the strongest, like `fresnel_mix` of KHR_materials_specular.
fn left_of(s: Surface, reflectance: vec3f) -> vec3f {
    var left = vec3f(1.0) - reflectance;
    let is_by_color = CONSERVES_ENERGY && s.has_film;
    if (HAS_TINTS && !is_by_color) { left = vec3f(1.0 - max(reflectance.x, max(reflectance.y, reflectance.z))); }
    return select(left, max(left, vec3f(0.0)), CONSERVES_ENERGY);
}

// Share of light that the specular lobe leaves to diffuse light, towards this view. Where energy is lost, it is
// averaged over the hemisphere so that it does not depend on the view: the cosine-weighted mean of Schlick's curve is
// F0 + (F90 - F0) / 21.
fn unreflected(s: Surface, view: vec3f) -> vec3f {
    if (!CONSERVES_ENERGY) {
        let f = dielectric_reflectance(s);
        return vec3f(1.0 - (f.x + (f.y - f.x) / 21.0));
    }
    var dielectric = s;
    dielectric.metallic = 0.0;
    return left_of(s, lobe_reflectance(dielectric, view));
}

// Share of light that a clear coat does not let through: where energy is lost, its reflectance if it were smooth.
fn coat_albedo(s: Surface, roughness: f32, cosine: f32) -> f32 {
    let grazing = f90(vec3f(s.coat_reflectivity));
    if (!CONSERVES_ENERGY) { return mix(s.coat_reflectivity, grazing, schlick_weight(cosine)); }
    let lobe = lobe_at(roughness, cosine);
    return split_sum(vec3f(s.coat_reflectivity), vec3f(grazing), lobe).x * (1.0 + s.coat_reflectivity * lost(lobe));
}
