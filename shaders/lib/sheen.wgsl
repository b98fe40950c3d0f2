// Sheen of fibers over a surface, after KHR_materials_sheen: the distribution and the fitted masking of Estevez &
// Kulla 2017, "Production Friendly Microfacet Sheen BRDF". Light samples and scattered rays of the diffuse part
// serve the sheen too, since its lobe is as wide.

#import lobe_albedo

// Table like lobe_table, for a sheen of color 1, tabulated in src/render/lighting/sheen_table.rs; y: factor on the
// formula, below 1 where it would reflect more light than arrives.
@group(0) @binding(10) var<uniform> sheen_table: array<vec4f, LOBE_NODES>;

fn has_sheen(s: Surface) -> bool {
    return HAS_SHEEN && any(s.sheen_color > vec3f(0.0));
}

fn sheen_lobe(s: Surface, cosine: f32) -> vec4f {
    let place = lobe_place(s.sheen_roughness, cosine);
    let low = mix(sheen_table[place.at], sheen_table[place.at + 1u], place.along);
    let high = mix(sheen_table[place.at + LOBE_COSINES], sheen_table[place.at + LOBE_COSINES + 1u], place.along);
    return max(mix(low, high, place.across), vec4f(1e-6, vec3f(-1.0)));
}

// Share of light that a sheen leaves to the layers below. It depends on the view alone, which the extension allows:
// then sheen and base add up exactly under uniform light.
fn base_share(s: Surface, view: vec3f) -> f32 {
    if (!has_sheen(s)) { return 1.0; }
    let strongest = max(s.sheen_color.x, max(s.sheen_color.y, s.sheen_color.z));
    return max(1.0 - strongest * sheen_lobe(s, dot(s.normal, view)).x, 0.0);
}

// Fit of Smith's integral (Estevez & Kulla 2017, section 3).
fn sheen_fit(x: f32, alpha: f32) -> f32 {
    let t = (1.0 - alpha) * (1.0 - alpha);
    let a = mix(21.5473, 25.3245, t);
    let b = mix(3.82987, 3.32435, t);
    let c = mix(0.19823, 0.16801, t);
    let d = mix(-1.97760, -1.27393, t);
    let e = mix(-4.32054, -4.85967, t);
    return a / (1.0 + b * pow(max(x, 1e-6), c)) + d * x + e;
}

fn sheen_lambda(cosine: f32, alpha: f32) -> f32 {
    if (cosine < 0.5) { return exp(sheen_fit(cosine, alpha)); }
    return exp(2.0 * sheen_fit(0.5, alpha) - sheen_fit(1.0 - cosine, alpha));
}

// Contribution of a sheen to the albedo for this pair of directions: its BRDF times pi.
fn sheen(s: Surface, view: vec3f, to_light: vec3f) -> vec3f {
    if (!has_sheen(s)) { return vec3f(0.0); }
    let alpha = max(s.sheen_roughness * s.sheen_roughness, LEAST_SHEEN_ALPHA);
    let nv = clamp(dot(s.normal, view), 1e-3, 1.0);
    let nl = clamp(dot(s.normal, to_light), 1e-3, 1.0);
    let nh = saturate(dot(s.normal, normalize(view + to_light)));
    let density = (2.0 + 1.0 / alpha) * pow(max(1.0 - nh * nh, 1e-7), 0.5 / alpha) / 2.0;
    let kept = sheen_lobe(s, nv).y;
    let masked = 1.0 + sheen_lambda(nv, alpha) + sheen_lambda(nl, alpha);
    return s.sheen_color * (kept * density / (masked * 4.0 * nv * nl));
}

fn sheen_albedo(s: Surface, view: vec3f) -> vec3f {
    if (!has_sheen(s)) { return vec3f(0.0); }
    return s.sheen_color * sheen_lobe(s, dot(s.normal, view)).x;
}
