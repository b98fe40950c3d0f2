// Albedo of rough lobes under uniform light, and the mean direction that it comes from: integrals by view angle and
// roughness, tabulated in src/render/lighting/lobe_table.rs.

#import grooves

// x: albedo of a reflectance of 1; y: its part that is weighted by (1 - V·H)^5; zw: mean direction, along the normal
// and away from the view.
@group(0) @binding(9) var<uniform> lobe_table: array<vec4f, LOBE_NODES>;

// Index of a table node, and the fractions towards the next ones.
struct LobePlace {
    at: u32,
    along: f32, // fraction along the cosines
    across: f32, // fraction along the roughnesses
}

fn lobe_place(roughness: f32, cosine: f32) -> LobePlace {
    let place = sqrt(saturate(cosine)) * f32(LOBE_COSINES - 1u);
    let row = saturate(roughness) * f32(LOBE_ROUGHNESSES - 1u);
    let i = min(u32(place), LOBE_COSINES - 2u);
    let at = min(u32(row), LOBE_ROUGHNESSES - 2u) * LOBE_COSINES + i;
    return LobePlace(at, place - f32(i), row - floor(min(row, f32(LOBE_ROUGHNESSES - 2u))));
}

fn lobe_at(roughness: f32, cosine: f32) -> vec4f {
    let place = lobe_place(roughness, cosine);
    let low = mix(lobe_table[place.at], lobe_table[place.at + 1u], place.along);
    let high = mix(lobe_table[place.at + LOBE_COSINES], lobe_table[place.at + LOBE_COSINES + 1u], place.along);
    return mix(low, high, place.across);
}

// Roughness of the isotropic lobe that loses about as much light between facets.
fn mean_roughness(s: Surface) -> f32 {
    if (!HAS_ANISOTROPY || s.anisotropy <= 0.0) { return s.roughness; }
    let alphas = ggx_alphas(s);
    return sqrt(sqrt(0.5 * dot(alphas, alphas)));
}

// Roughness of the specular lobe; 0 for mirrors.
fn shown_roughness(s: Surface) -> f32 {
    return select(mean_roughness(s), 0.0, s.reflection == REFLECTION_MIRROR);
}

// The table's values for the specular lobe of a surface.
fn shown_lobe(s: Surface, view: vec3f) -> vec4f {
    let lobe = lobe_at(shown_roughness(s), dot(s.normal, view));
    return vec4f(lobe.xy * groove_share(s, view), lobe.zw);
}

// Albedo under uniform light of a lobe with reflectance `f` at normal incidence, single scattering: the split sum of
// Karis 2013.
fn split_sum(f: vec3f, grazing: f32, lobe: vec4f) -> vec3f {
    return f * (lobe.x - lobe.y) + vec3f(grazing * lobe.y);
}

// Albedo of a surface's specular lobe under uniform light.
fn specular_albedo(s: Surface, view: vec3f) -> vec3f {
    return lobe_reflectance(s, view) * base_share(s, view);
}
