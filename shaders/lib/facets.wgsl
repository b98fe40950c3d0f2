// Microfacets that reflect or transmit a ray: sampled ones, and the choice of one among several.

#import frame
#import lobe
#import sampling

// Facets that are sampled in pictures of few sub-frames where many facets turn light to the wrong side of the surface,
// so that a single one would often leave a pixel black: one is chosen by the share of its light that leaves the
// surface, and takes the mean of these shares (resampled importance sampling, Talbot et al. 2005; unbiased). In more
// sub-frames single facets are spread evenly, which leaves less grain. At the first inner side, paths that are to
// stay in a solid choose by the light that a facet mirrors.
const FACET_TRIES: u32 = 8u;
const FEW_SAMPLES: u32 = 32u; // most sub-frames of such a picture
const FACET_PAIR: u32 = 0x40000u; // first of their pairs of dimensions, after pair 0 of the first one

// Ways of a path at the first inner side of a rough solid: a pixel follows both (`AIMS_THROUGH`).
const ANY_WAY: u32 = 0u; // by odds
const OUT: u32 = 1u; // refracted
const BACK: u32 = 2u; // mirrored

var<private> first_way: u32 = ANY_WAY; // until the path has taken it

// A sampled microfacet normal that is visible from the direction of this ray, within a bound (see `visible_normal`):
// one for each vertex of a path and each try.
fn visible_facet(s: Surface, direction: vec3f, bound: f32, attempt: u32) -> vec3f {
    let axes = lobe_axes(s);
    var view = -direction * axes;
    view.z = max(view.z, 1e-3);
    let pair = select(FACET_PAIR + attempt, 0u, attempt == 0u);
    return axes * visible_normal(normalize(view), ggx_alphas(s), bound, sample_square(sample_index(), pair));
}

// Share of the visible facets whose mirrored view no other facet blocks: height-correlated masking of both directions
// over the view's (Heitz 2014; 2018, eq. 19). On the inner side of glass that conserves energy blocked light is
// mirrored again.
fn seen_facets(s: Surface, view: vec3f, out: vec3f) -> f32 {
    if (CONSERVES_ENERGY && mirrors_inside(s)) { return 1.0; }
    let nl = dot(s.normal, out);
    if (nl <= 0.0) { return 0.0; }
    let nv = max(dot(s.normal, view), 1e-3);
    let masked_v = masked(s, view, nv);
    let masked_l = masked(s, out, nl);
    return nl * (nv + masked_v) / (nv * masked_l + nl * masked_v);
}

// A facet, chosen among some by a share of each.
struct ChosenFacet {
    normal: vec3f,
    share: f32, // sum of the shares so far, and in the end their mean
    u: f32, // random number in [0, 1) for the choice
}

fn choice_of_facets() -> ChosenFacet {
    return ChosenFacet(vec3f(0.0), 0.0, sample_square(sample_index(), FACET_PAIR).x);
}

// Offers a facet to the choice.
fn offer_facet(chosen: ptr<function, ChosenFacet>, facet: vec3f, share: f32) {
    let before = (*chosen).share;
    if (before <= 0.0) { (*chosen).normal = facet; }
    if (share <= 0.0) { return; }
    (*chosen).share += share;
    // The rest of the random number is uniform again.
    let at = (*chosen).u * (*chosen).share;
    if (at < share) {
        (*chosen).normal = facet;
        (*chosen).u = at / share;
    } else {
        (*chosen).u = (at - share) / max(before, 1e-20);
    }
}

// The facet of a reflection, and the share of its light that leaves the surface; see FACET_TRIES.
fn mirroring_facet(s: Surface, direction: vec3f, bound: f32) -> ChosenFacet {
    let first = visible_facet(s, direction, bound, 0u);
    // The few facets that mirror all light back into a solid hold much of it.
    let is_by_light = AIMS_THROUGH && first_way == BACK;
    // Round lobes have a tight bound.
    if (!is_by_light && (!HAS_ANISOTROPY || s.anisotropy <= 0.0 || sampling.samples > FEW_SAMPLES)) {
        return ChosenFacet(first, seen_facets(s, -direction, mirrored(s, direction, first)), 0.0);
    }
    var chosen = choice_of_facets();
    for (var i = 0u; i < FACET_TRIES; i++) {
        let facet = visible_facet(s, direction, bound, i);
        var share = seen_facets(s, -direction, mirrored(s, direction, facet));
        if (is_by_light) { share *= luminance(fresnel(s, dot(facet, -direction))); }
        offer_facet(&chosen, facet, share);
    }
    chosen.share /= f32(FACET_TRIES);
    if (is_by_light) { chosen.share /= max(luminance(fresnel(s, dot(chosen.normal, -direction))), 1e-6); }
    return chosen;
}

// Direction in which a facet mirrors a ray. On the inner side of glass that conserves energy none leaves the surface.
fn mirrored(s: Surface, direction: vec3f, facet: vec3f) -> vec3f {
    let out = reflect(direction, facet);
    if (!CONSERVES_ENERGY || !mirrors_inside(s)) { return out; }
    return out + s.normal * max(-2.0 * dot(s.normal, out), 0.0);
}
