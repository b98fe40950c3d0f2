// Energy-conserving variant: the specular lobe is scaled up by the light that single scattering between facets
// loses.

#import lobe_albedo

// Factor on the specular lobe for the light that facets reflect more than once (Turquin 2019, "Practical
// Multiple Scattering Compensation for Microfacet Models", eq. 16).
fn compensation(s: Surface, view: vec3f) -> vec3f {
    if (is_transmissive(s)) { return vec3f(1.0); }
    let lobe = lobe_at(shown_roughness(s), dot(s.normal, view));
    return vec3f(1.0) + f0(s) * (1.0 / max(lobe.x, 1e-3) - 1.0);
}

// Share of light that the specular lobe leaves to diffuse light, towards this view.
fn unreflected(s: Surface, view: vec3f) -> f32 {
    let lobe = lobe_at(shown_roughness(s), dot(s.normal, view));
    let f = dielectric_reflectance(s);
    return max(1.0 - split_sum(vec3f(f.x), f.y, lobe).x * (1.0 + f.x * (1.0 / max(lobe.x, 1e-3) - 1.0)), 0.0);
}
