// Albedo of anisotropic lobes, by view angle, roughness and anisotropy, tabulated in
// src/render/lighting/groove_table.rs.

#import lobe

// Factors of cos 2nφ, where φ is the view's angle to the grooves.
@group(0) @binding(11) var<uniform> groove_table: array<vec4f, GROOVE_NODES>;

// Albedo of a lobe relative to the isotropic lobe of its mean roughness.
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
