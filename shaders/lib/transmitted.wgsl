// Light that passes through a surface.

#import dispersion
#import lobe

// Share of light that a facet of a transmissive surface lets pass.
fn passing_share(s: Surface, cosine: f32) -> vec3f {
    return left_of(s, exact_fresnel(s, cosine));
}

// Share of the light that arrives along a ray that a facet passes on. Where energy is conserved that is all light that
// the traced reflection, or its replacement, does not return: light that other facets block is transmitted in the end.
fn passed_share(s: Surface, facet: vec3f, direction: vec3f) -> vec3f {
    let view = -direction;
    if (!CONSERVES_ENERGY) { return passing_share(s, dot(facet, view)); }
    let base = below_coat(s);
    if (!is_reflector(base)) { return left_of(base, lobe_reflectance(base, view)); }
    if (!is_rough_reflector(base)) { return passing_share(base, dot(s.normal, view)); }
    let back = fresnel(base, dot(facet, view)) * compensation(base, view);
    return left_of(base, back * seen_facets(base, view, reflect(direction, facet)));
}

// Direction in which a facet passes on a ray; of length 0 where it mirrors all of it.
fn passed_direction(s: Surface, facet: vec3f, direction: vec3f) -> vec3f {
    var out: vec3f;
    if (s.is_solid) {
        out = refract(direction, facet, select(1.0 / s.ior, s.ior, s.is_inside));
    } else {
        // The lobe of the reflection, mirrored to the other side.
        out = reflect(direction, facet);
        out -= 2.0 * dot(out, s.normal) * s.normal;
    }
    if (CONSERVES_ENERGY) { out -= max(2.0 * dot(out, s.normal), 0.0) * s.normal; }
    return out;
}

// Share of the light that a facet passes on in a direction which leaves the surface on the other side.
fn through_share(s: Surface, out: vec3f) -> f32 {
    let below = -dot(out, s.normal);
    if (below <= 0.0 || dot(out, s.geometric_normal) >= 0.0) { return 0.0; }
    if (CONSERVES_ENERGY) { return 1.0; }
    return 2.0 * below / (below + masked(s, out, below));
}

// The facet that passes light on where the surface is rough, and the share of it that leaves the surface; see
// FACET_TRIES.
fn passing_facet(s: Surface, direction: vec3f) -> ChosenFacet {
    // The facet that the reflection takes too: it passes the light that it does not mirror, so that their sum has no
    // grain.
    let first = visible_facet(s, direction, 1.0, 0u);
    if (sampling.samples > FEW_SAMPLES) {
        return ChosenFacet(first, through_share(s, passed_direction(s, first, direction)), 0.0);
    }
    var chosen = choice_of_facets();
    for (var i = 0u; i < FACET_TRIES; i++) {
        let facet = visible_facet(s, direction, 1.0, i);
        offer_facet(&chosen, facet, through_share(s, passed_direction(s, facet, direction)));
    }
    chosen.share /= f32(FACET_TRIES);
    return chosen;
}

// The ray transmitted through a surface: straight through thin ones, refracted into and out of solids; by one
// microfacet where the surface is rough (Walter et al. 2007, with visible normals).
fn transmitted(direction: vec3f, s: Surface) -> Reflected {
    let straight = Reflected(direction, vec3f(1.0 - s.alpha), 0.0, 1.0, 1.0, s.normal);
    if (s.transmission <= 0.0) { return straight; }
    let is_rough = HAS_ROUGH_REFLECTIONS && s.roughness * s.roughness > SMOOTH_ALPHA;
    var facet = ChosenFacet(s.normal, 1.0, 0.0);
    if (is_rough) { facet = passing_facet(s, direction); }
    var out = passed_direction(s, facet.normal, direction);
    var weight = vec3f(0.0);
    if (through_share(s, out) > 0.0) {
        weight = facet.share * passed_share(s, facet.normal, direction) * s.base_color
            * (s.transmission * (1.0 - s.metallic) * s.alpha * coat_transmittance(s, dot(coat_normal(s), -direction))
                * base_share(s, -direction));
        out = normalize(out);
    } else {
        out = direction;
    }
    let through = Reflected(out, weight, 0.0, 1.0, 1.0, s.normal);
    if (s.alpha >= 1.0) { return through; }
    return chosen(through, straight, ALPHA_PAIR);
}
