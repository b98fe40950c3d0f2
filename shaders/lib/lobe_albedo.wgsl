// Albedo of rough lobes under uniform light, and the mean direction that it comes from: integrals by view angle and
// roughness, tabulated in src/render/lighting/lobe_table.rs.

#import lobe

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

// Albedo of anisotropic lobes, by view angle, roughness and anisotropy, tabulated in
// src/render/lighting/groove_table.rs: factors of cos 2nφ, where φ is the view's angle to the grooves.
@group(0) @binding(11) var<uniform> groove_table: array<vec4f, GROOVE_NODES>;

// Albedo of an anisotropic lobe relative to the isotropic lobe of its mean roughness.
fn groove_share(s: Surface, view: vec3f) -> f32 {
    if (!HAS_ANISOTROPY || s.anisotropy <= 0.0 || s.reflection == REFLECTION_MIRROR) { return 1.0; }
    let local = view * lobe_axes(s);
    let counts = vec3u(GROOVE_COSINES, GROOVE_STEPS, GROOVE_STEPS);
    let place = saturate(vec3f(sqrt(max(local.z, 0.0)), s.roughness, s.anisotropy)) * vec3f(counts - 1u);
    let low = min(vec3u(place), counts - 2u);
    let rest = place - vec3f(low);
    var node = vec4f(0.0);
    for (var corner = 0u; corner < 8u; corner++) {
        let step = vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
        let weights = select(1.0 - rest, rest, step == vec3u(1u));
        let at = low + step;
        node += groove_table[(at.z * counts.y + at.y) * counts.x + at.x] * (weights.x * weights.y * weights.z);
    }
    let c = (local.x * local.x - local.y * local.y) / max(dot(local.xy, local.xy), 1e-12);
    return dot(node, vec4f(1.0, c, 2.0 * c * c - 1.0, c * (4.0 * c * c - 3.0)));
}

// The table's values for the specular lobe of a surface.
fn shown_lobe(s: Surface, view: vec3f) -> vec4f {
    let lobe = lobe_at(shown_roughness(s), dot(s.normal, view));
    return vec4f(lobe.xy * groove_share(s, view), lobe.zw);
}

// Albedo under uniform light of a lobe with reflectance `f` at normal incidence, single scattering: the split sum of
// Karis 2013.
fn split_sum(f: vec3f, grazing: vec3f, lobe: vec4f) -> vec3f {
    return f * (lobe.x - lobe.y) + grazing * lobe.y;
}

// Albedo of a surface's specular lobe under uniform light.
fn specular_albedo(s: Surface, view: vec3f) -> vec3f {
    return lobe_reflectance(s, view) * base_share(s, view);
}
