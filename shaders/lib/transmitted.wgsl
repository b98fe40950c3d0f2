// Light that passes through a surface.

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
    let back = fresnel(base, dot(facet, view)) * compensation(base, shown_lobe(base, view));
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

// The outer side of a surface that is met from within a solid, as light samples beyond it see it.
fn outer_side(s: Surface) -> Surface {
    var outer = s;
    outer.normal = -s.normal;
    outer.geometric_normal = -s.geometric_normal;
    outer.lift_m = 0.0;
    outer.occlusion = 1.0;
    outer.emission = vec3f(0.0);
    return outer;
}

// The facet of a solid's inner side that refracts a ray towards the view into `out` or back; w: density per solid angle
// with which visible facets do so (Walter et al. 2007, eq. 16 and 17).
fn refracting_facet(s: Surface, view: vec3f, out: vec3f) -> vec4f {
    let across = s.ior * view + out;
    let across2 = max(dot(across, across), 1e-12);
    let facet = across * (sign(s.ior - 1.0) * inverseSqrt(across2));
    let nv = max(dot(s.normal, view), 1e-3);
    let cosines = vec3f(dot(facet, view), -dot(facet, out), dot(facet, s.normal));
    if (any(cosines <= vec3f(0.0))) { return vec4f(s.normal, 0.0); }
    let visible = facet_density(s, facet) * 2.0 * cosines.x / (nv + masked(s, view, nv));
    return vec4f(facet, visible * cosines.y / across2);
}

// Share of the light of a ray that a facet passes on where the surface covers all.
fn passed_weight(s: Surface, facet: vec3f, direction: vec3f) -> vec3f {
    return passed_share(s, facet, direction) * s.base_color
        * (s.transmission * (1.0 - s.metallic) * coat_transmittance(s, dot(coat_normal(s), -direction)) * base_share(s, -direction));
}

// Lobe of the light that the inner side of a rough solid lets out of it towards the view, times the cosine.
fn refracted_lobe(outer: Surface, view: vec3f, to_light: vec3f) -> vec3f {
    let s = outer_side(outer);
    let facet = refracting_facet(s, view, to_light);
    return passed_weight(s, facet.xyz, -view) * (facet.w * through_share(s, to_light));
}

// The ray transmitted through a surface: straight through thin ones, refracted into and out of solids; by one
// microfacet where the surface is rough (Walter et al. 2007, with visible normals).
fn transmitted(direction: vec3f, s: Surface) -> Reflected {
    let straight = Reflected(direction, vec3f(1.0 - s.alpha), 0.0, 1.0, 1.0, s.normal);
    if (s.transmission <= 0.0) { return straight; }
    var facet = ChosenFacet(s.normal, 1.0, 0.0);
    if (HAS_ROUGH_REFLECTIONS && s.roughness * s.roughness > SMOOTH_ALPHA) { facet = passing_facet(s, direction); }
    var out = passed_direction(s, facet.normal, direction);
    var through = Reflected(direction, vec3f(0.0), 0.0, 1.0, 1.0, s.normal);
    if (through_share(s, out) > 0.0) {
        through.weight = facet.share * s.alpha * passed_weight(s, facet.normal, direction);
        through.direction = normalize(out);
        if (is_aimed_through(s)) {
            // Rays that the surface has turned to its other side have no density.
            let refracting = refracting_facet(s, -direction, through.direction);
            if (distance(refracting.xyz, facet.normal) < 1e-3) { through.pdf = refracting.w; }
        }
    }
    if (s.alpha >= 1.0) { return through; }
    return chosen(through, straight, ALPHA_PAIR, 1.0);
}
