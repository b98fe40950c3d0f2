// Sampling of directions by the lobes of a surface, and their densities.

#import basis
#import frame

fn on_circle(radius: f32, turn: f32) -> vec2f {
    return radius * vec2f(cos(2.0 * PI * turn), sin(2.0 * PI * turn));
}

fn cosine_direction(normal: vec3f, u: vec2f) -> vec3f {
    let flat = on_circle(sqrt(u.x), u.y);
    return basis(normal) * vec3f(flat, sqrt(max(1.0 - u.x, 0.0)));
}

// Samples a facet normal among those visible from the view, z up: Dupuy & Benyoub 2023, "Sampling Visible GGX
// Normals with Spherical Caps". `bound` is 1 for all of them; see `reflection_bound`.
fn visible_normal(view: vec3f, alpha: vec2f, bound: f32, u: vec2f) -> vec3f {
    let stretched = normalize(vec3f(view.xy * alpha, view.z));
    let lowest = bound * stretched.z;
    let z = (1.0 - u.x) * (1.0 + lowest) - lowest;
    let flat = on_circle(sqrt(saturate(1.0 - z * z)), u.y);
    let h = vec3f(flat, z) + stretched;
    return normalize(vec3f(h.xy * alpha, max(h.z, 1e-6)));
}

// GGX alpha of the lobe along the tangent and across it (KHR_materials_anisotropy).
fn ggx_alphas(s: Surface) -> vec2f {
    let across = ggx_alpha(s);
    if (!HAS_ANISOTROPY) { return vec2f(across); }
    return vec2f(mix(across, 1.0, s.anisotropy * s.anisotropy), across);
}

// Axes of the lobe as columns: along, across, normal.
fn lobe_axes(s: Surface) -> mat3x3f {
    if (HAS_ANISOTROPY && s.anisotropy > 0.0) {
        let along = s.tangent - s.normal * dot(s.normal, s.tangent);
        let along2 = dot(along, along);
        if (along2 > 1e-6) {
            let tangent = along * inverseSqrt(along2);
            return mat3x3f(tangent, cross(s.normal, tangent), s.normal);
        }
    }
    return basis(s.normal);
}

// Density of facet normals (GGX; Burley 2012, B.2).
fn facet_density(s: Surface, facet: vec3f) -> f32 {
    if (HAS_ANISOTROPY) {
        let alphas = ggx_alphas(s);
        let stretched = (facet * lobe_axes(s)) / vec3f(alphas, 1.0);
        let length2 = dot(stretched, stretched);
        return 1.0 / (PI * alphas.x * alphas.y * length2 * length2);
    }
    let alpha = ggx_alpha(s);
    let a2 = alpha * alpha;
    let nh = saturate(dot(s.normal, facet));
    let d = nh * nh * (a2 - 1.0) + 1.0;
    return a2 / (PI * d * d);
}

// The cosine of a direction times 1 + 2 Λ of Smith's masking: the visible share of facets is G1 = 2 / (1 + this /
// cosine) (Heitz 2014).
fn masked(s: Surface, direction: vec3f, cosine: f32) -> f32 {
    let alphas = ggx_alphas(s);
    if (HAS_ANISOTROPY) {
        let local = direction * lobe_axes(s);
        return length(vec3f(alphas * local.xy, cosine));
    }
    let a2 = alphas.x * alphas.x;
    return sqrt(cosine * cosine * (1.0 - a2) + a2);
}

// Bound of the spherical cap of visible normals that leaves out most normals that mirror the view below the surface and
// so find no light (Eto & Tokuyoshi 2023, "Bounded VNDF Sampling for Smith-GGX Reflections", eq. 5).
fn reflection_bound(s: Surface, nv: f32) -> f32 {
    if (mirrors_inside(s)) { return 1.0; }
    let alphas = ggx_alphas(s);
    let alpha = min(alphas.x, alphas.y);
    let a2 = alpha * alpha;
    let size = 1.0 + sqrt(max(1.0 - nv * nv, 0.0));
    let size2 = size * size;
    return (1.0 - a2) * size2 / (size2 + a2 * nv * nv);
}

// Density per solid angle of mirroring `view` at a sampled visible normal within the bound.
fn facet_pdf(s: Surface, view: vec3f, direction: vec3f) -> f32 {
    let nv = max(dot(s.normal, view), 1e-3);
    let facets = reflection_bound(s, nv) * nv + masked(s, view, nv);
    return facet_density(s, normalize(view + direction)) / (2.0 * facets);
}

// Density of reflection rays for the power heuristic: the geometric mean of the density of the direction and the
// highest of the lobe. The first alone makes extended lights grainy, as GGX has long tails; with the second alone,
// rays in the tails meet lamps at full weight.
fn lobe_density(s: Surface, view: vec3f, direction: vec3f) -> f32 {
    if (is_outer_side(s)) { return refracting_facet(outer_side(s), view, direction).w; }
    let alphas = ggx_alphas(s);
    return sqrt(facet_pdf(s, view, direction) / (4.0 * PI * alphas.x * alphas.y));
}
