// Layers of a surface beside its own reflection: light that is transmitted, refracted or not, partial coverage
// (blended alpha), and a clear coat on top. After KHR_materials_transmission, _volume, _ior and _clearcoat.
//
// A path that meets such a surface continues along one of its layers, chosen by the light that each returns, so that
// many sub-frames cover all of them; only at the surface of a pixel both reflection and transmission are followed.

#import bvh
#import dispersion
#import frame
#import sampling
#import transmitted

override HAS_TRANSMISSION: bool = true;
override HAS_COATS: bool = true;
override AIMS_THROUGH: bool = true; // whether light samples look for light beyond rough solids

// How much oftener paths stay in a solid than the light says, where light samples find most of the light beyond: bright
// light past further reflections is rare, and left most of the grain.
const FAVOR_INSIDE: f32 = 2.0;

// Number of surfaces that a path has crossed or been mirrored by inside of solids, from which on only every second path that
// is to stay in a solid goes on, with twice the weight: pixels that are traced together wait for the longest path.
const FAR_CROSSINGS: u32 = 4u;

// Most passages through surfaces and reflections inside solids along one path; many, as walls of glass guide light.
const MAX_CROSSINGS: u32 = 60u;
// Maximum number of transmissive and cut-out surfaces between a light and a point; MAX_VISITS limits their work.
const MAX_PANES: u32 = 4096u;
const DARKEST_PANE: f32 = 1.0 / 255.0; // minimum share of light that a shadow ray follows further

var<private> path_crossings: u32 = 0u; // number of surfaces crossed
var<private> walk_scatterings: u32 = 0u; // number of scatterings of the path within solids
var<private> far_weight: f32 = 1.0; // weight of the path from FAR_CROSSINGS on
var<private> vertex: vec3f = vec3f(0.0); // position of the surface that the path left last
// Whether the ray that arrives at a surface is the only one that finds the light beyond, so that light samples may share it.
var<private> finds_alone: bool = false;
// Whether rays aimed from within a solid share the light that the path's ray sees: no solid lets them through.
var<private> path_is_aimed: bool = false;
var<private> shadow_is_aimed: bool = false; // whether shadow rays are such rays
// Inside of a solid.
struct Medium {
    extinction: vec3f, // per meter
    albedo: vec3f, // of its isotropic scattering; black: clear
    lit_share: f32, // share of light samples of a point within that counts; 0: none passes its surface
    material: u32,
}

// Solids that a ray is in, and the insides of the three that it entered last.
struct Media {
    solids: u32,
    here: Medium,
    around: Medium,
    farther: Medium,
}

var<private> media: Media = Media(); // of the path

// Begins a path where the eye is, or on the inner side of a transmissive solid.
fn start_path(position: vec3f, is_inside: bool) {
    vertex = position;
    path_crossings = 0u;
    walk_scatterings = 0u;
    finds_alone = false;
    path_is_aimed = false;
    path_channel = 0u;
    media = Media();
    media.solids = max(frame.eye_solids, u32(is_inside));
    media.here = Medium(frame.eye_extinction, frame.eye_scattering, select(frame.eye_lit_share, 0.0, UNBIASED), NONE);
}

fn medium_of(material: u32) -> Medium {
    let extinction = material_extinction(material);
    if (!HAS_SCATTERING) { return Medium(extinction, vec3f(0.0), 0.0, material); }
    // Light samples go straight, while refraction lets in 1 / n² of the directions alone.
    let index = material_ior(material);
    let is_lit = !UNBIASED && material_transmission(material) > 0.0;
    return Medium(extinction, material_scattering(material), select(0.0, 1.0 / (index * index), is_lit), material);
}

// Media beyond a surface that a ray crosses; sheets within a solid leave it as it is.
fn media_beyond(before: Media, s: Surface) -> Media {
    if (!s.is_solid || (s.transmission <= 0.0 && !bounds_scattering(s))) { return before; }
    if (s.is_inside) {
        // A solid that overlaps another may be left before it.
        let is_around = before.around.material == s.material && before.here.material != s.material && before.solids > 1u;
        var here = before.around;
        if (is_around) { here = before.here; }
        return Media(max(before.solids, 1u) - 1u, here, before.farther, Medium());
    }
    return Media(before.solids + 1u, medium_of(s.material), before.here, before.around);
}

// Share of light that is left after a distance where the path is (Beer-Lambert law).
fn medium_transmittance(distance_m: f32) -> vec3f {
    if (!HAS_LAYERS) { return vec3f(1.0); }
    return exp(-media.here.extinction * distance_m);
}

// Whether the surface is the inner side of glass, which mirrors part of the light back into it, or all.
fn mirrors_inside(s: Surface) -> bool {
    return HAS_TRANSMISSION && s.is_inside && s.transmission > 0.0;
}

// Whether light is aimed at from the inner side of a rough solid, beside the rays that it refracts.
fn is_aimed_through(s: Surface) -> bool {
    return AIMS_THROUGH && finds_alone && mirrors_inside(s)
        && s.roughness * s.roughness > SMOOTH_ALPHA && (path_channel > 0u || !is_dispersive(s)) && !has_sheen(s);
}

// Whether a surface that is lit is the outer side of one that is seen from within: of these no other light is asked for.
fn is_outer_side(s: Surface) -> bool {
    return AIMS_THROUGH && mirrors_inside(s);
}

fn is_transmissive(s: Surface) -> bool {
    return HAS_TRANSMISSION && (s.transmission > 0.0 || s.alpha < 1.0);
}

// Whether the reflectance follows Fresnel's equations rather than Schlick's approximation.
fn is_exact(s: Surface) -> bool {
    return is_transmissive(s) || (HAS_INDICES && s.has_index);
}

// Whether the coat's reflection is traced, rather than lights and environment alone.
fn has_traced_coat(s: Surface) -> bool {
    return HAS_COATS && s.clearcoat > 0.0
        && (s.reflection == REFLECTION_MIRROR || (s.reflection == REFLECTION_AUTO && round(s.clearcoat_roughness * COAT_STEPS) < frame.roughness_cutoff * COAT_STEPS));
}

// Roughness of the layer whose reflection is traced.
fn reflected_roughness(s: Surface) -> f32 {
    return select(s.roughness, s.clearcoat_roughness, has_traced_coat(s));
}

// Normal of the layer whose reflection is traced.
fn reflected_normal(s: Surface) -> vec3f {
    return select(s.normal, coat_normal(s), has_traced_coat(s));
}

// Share of the light entering the surface that it scatters rather than transmits.
fn reflected_share(s: Surface) -> f32 {
    if (!HAS_TRANSMISSION) { return 1.0; }
    return select(1.0 - s.transmission, 0.0, mirrors_inside(s));
}

// Unpolarized Fresnel reflectance of a smooth dielectric interface; `index` is the relative index of refraction.
fn dielectric_fresnel(cosine: f32, index: f32) -> f32 {
    let c = saturate(cosine);
    let sine2 = (1.0 - c * c) / (index * index);
    if (sine2 >= 1.0) { return select(1.0, 0.0, index == 1.0); }
    let t = sqrt(1.0 - sine2);
    let s_wave = (c - index * t) / (c + index * t);
    let p_wave = (index * c - t) / (index * c + t);
    return 0.5 * (s_wave * s_wave + p_wave * p_wave);
}

// Reflectance with the strength and the color of KHR_materials_specular, interpolated between normal and grazing
// incidence. Inside a solid it stays untinted, so that reflection and transmission add up to 1.
fn tinted(s: Surface, reflectance: f32) -> vec3f {
    if (!HAS_TINTS || s.is_inside) { return vec3f(reflectance); }
    let least = min(s.reflectivity, 0.999);
    let rise = saturate((reflectance - least) / (1.0 - least));
    return mix(dielectric_f0(s), dielectric_f90(s), rise);
}

// Exact Fresnel equations, with the index of the reflectivity; Schlick's approximation for metals.
fn exact_fresnel(s: Surface, cosine: f32) -> vec3f {
    let root = sqrt(min(s.reflectivity, 0.999));
    let index = (1.0 + root) / (1.0 - root);
    let dielectric = dielectric_fresnel(cosine, select(index, 1.0 / index, s.is_inside));
    let metal = mix(s.base_color, vec3f(f90(s.base_color)), schlick_weight(cosine));
    return mix(tinted(s, dielectric), metal, s.metallic) - edge_dip(s, cosine);
}

fn coat_normal(s: Surface) -> vec3f {
    if (HAS_COAT_NORMALS) { return s.coat_normal; }
    return s.normal;
}

// The clear coat alone, as a surface.
fn coat_of(s: Surface) -> Surface {
    var coat = s;
    coat.base_color = vec3f(0.0);
    coat.emission = vec3f(0.0);
    coat.metallic = 0.0;
    coat.roughness = s.clearcoat_roughness;
    coat.normal = coat_normal(s);
    coat.reflectivity = s.coat_reflectivity;
    coat.has_index = false;
    coat.has_edge_tint = false;
    coat.transmission = 0.0;
    coat.alpha = 1.0;
    coat.clearcoat = 0.0;
    coat.specular = 1.0;
    coat.specular_color = vec3f(1.0);
    coat.has_film = false;
    coat.sheen_color = vec3f(0.0);
    coat.diffuse_roughness = 0.0;
    coat.diffuse_transmission = 0.0;
    coat.anisotropy = 0.0;
    return coat;
}

// The other side of a surface, alone, with the diffuse light that it passes to the side of the view.
fn other_side(s: Surface, view: vec3f) -> Surface {
    var other = outer_side(without_specular(coat_of(s)));
    other.normal = -s.normal;
    other.base_color = passed_albedo(s, view);
    return other;
}

fn below_coat(s: Surface) -> Surface {
    var below = s;
    below.clearcoat = 0.0;
    return below;
}

// Share of the light below the coat that passes it towards the view.
fn coat_transmittance(s: Surface, cosine: f32) -> f32 {
    if (!HAS_COATS) { return 1.0; }
    return 1.0 - s.clearcoat * coat_albedo(s, select(s.clearcoat_roughness, 0.0, s.reflection == REFLECTION_MIRROR), cosine);
}

fn shade(s: Surface, view: vec3f, reused: vec2u) -> Shade {
    if (!HAS_LAYERS && !HAS_DIFFUSE_TRANSMISSION) { return shade_layer(s, view, reused); }
    var out: Shade;
    // From within a solid, light is seen by the ray that continues, refracted or mirrored, and by light samples beyond.
    let is_aimed = is_aimed_through(s);
    if (mirrors_inside(s) && (!is_aimed || first_way == BACK)) { return out; }
    let has_coat = HAS_COATS && s.clearcoat > 0.0 && !is_aimed;
    let passes = passes_diffusely(s) && !is_aimed && (s.is_inside || !bounds_scattering(s));
    let within = media;
    if (is_aimed) { media = media_beyond(media, s); }
    shadow_is_aimed = is_aimed;
    // One call in a loop keeps the inlined code small: light shading is long.
    for (var layer = 0u; layer <= select(u32(has_coat), 2u, passes); layer++) {
        var part = below_coat(s);
        if (is_aimed) { part = outer_side(dispersed(s)); }
        var share = 1.0;
        if (layer == 1u) {
            if (!has_coat) { continue; }
            part = coat_of(s);
            share = s.clearcoat;
        } else if (has_coat) {
            share = coat_transmittance(s, dot(coat_normal(s), view));
        }
        let is_other = HAS_DIFFUSE_TRANSMISSION && layer == 2u;
        if (is_other) {
            part = other_side(s, view);
            media = media_beyond(media, s);
        }
        let lit = shade_layer(part, select(view, -view, is_other), select(reused | out.visible, vec2u(0u), is_other));
        out.diffuse += lit.diffuse * share;
        out.specular += lit.specular * share;
        out.visible |= select(lit.visible, vec2u(0u), is_other);
    }
    media = within;
    shadow_is_aimed = false;
    if (HAS_TRANSMISSION) {
        out.diffuse *= s.alpha;
        out.specular *= s.alpha;
    }
    return out;
}

// Share of the emission at a point of a triangle that leaves the surface at this cosine, past its coat and its
// alpha.
fn emitted_share(material: u32, instance: u32, c: Corner, bary: vec2f, cosine: f32) -> f32 {
    if (!HAS_LAYERS) { return 1.0; }
    var s = material_at(material, instance, c, bary, Footprint());
    s.clearcoat *= layer_texel(CLEARCOAT_SLOT, c, bary, Footprint()).x;
    s.alpha = 1.0;
    if (material_is_blended(material) != 0u) { s.alpha = material_alpha(material, instance, c, bary, Footprint()); }
    return s.alpha * coat_transmittance(s, cosine);
}

// One of two rays, chosen by the light that each returns. A ray so unlikely that the sub-frames could not resolve it is
// never chosen; its light is added to the ray that is kept. `favor`: factor on the odds of the second.
fn chosen(a: Reflected, b: Reflected, pair: u32, favor: f32) -> Reflected {
    let weights = vec2f(luminance(a.weight), luminance(b.weight));
    var odds = weights * vec2f(1.0, favor);
    let both = odds.x + odds.y;
    if (both <= 0.0) { return a; }
    let least = select(0.5 / f32(sampling.samples * paths_each), 0.0, UNBIASED);
    var share = odds.y / both;
    if (share < least) { share = 0.0; }
    if (share > 1.0 - least) { share = 1.0; }
    let is_chance = share > 0.0 && share < 1.0;
    path_is_chance = path_is_chance || is_chance;
    if (!is_chance) { odds = weights; }
    let takes_b = share == 1.0 || sample_square(sample_index(), pair).x < share;
    var ray = a;
    if (takes_b) { ray = b; }
    ray.weight *= (odds.x + odds.y) / select(odds.x, odds.y, takes_b);
    return ray;
}

// Reflection ray of a surface.
fn reflected(direction: vec3f, s: Surface) -> Reflected {
    if (!HAS_LAYERS) { return lobe_ray(direction, s); }
    var ray: Reflected;
    // One call in a loop keeps the inlined code small.
    for (var layer = 0u; layer <= u32(has_traced_coat(s)); layer++) {
        var part = below_coat(s);
        if (layer == 1u) { part = coat_of(s); }
        var found = lobe_ray(direction, part);
        if (layer == 1u) {
            found.weight *= s.clearcoat;
            found = chosen(found, ray, COAT_PAIR, 1.0);
        } else if (HAS_COATS && s.clearcoat > 0.0) {
            found.weight *= coat_transmittance(s, dot(coat_normal(s), -direction));
            if (!is_reflector(part)) { found.weight = vec3f(0.0); }
        }
        ray = found;
    }
    if (HAS_TRANSMISSION) { ray.weight *= s.alpha; }
    // From within a solid no light samples are taken of the side that the ray stays on, so it has full weight.
    if (mirrors_inside(s)) { ray = Reflected(ray.direction, ray.weight, 0.0, 1.0, 1.0, s.normal); }
    return ray;
}

fn only_lobe(s: Surface, view: vec3f) -> OnlyLobe {
    if (!HAS_LAYERS) { return OnlyLobe(s, 1.0); }
    if (!HAS_COATS || s.clearcoat == 0.0) { return OnlyLobe(s, s.alpha); }
    let base = below_coat(s);
    if (!is_reflector(base) || all(grazing_reflectance(base) == vec3f(0.0))) { return OnlyLobe(coat_of(s), s.clearcoat * s.alpha); }
    let passed = coat_transmittance(s, dot(coat_normal(s), view));
    return OnlyLobe(base, select(passed * s.alpha, 0.0, has_traced_coat(s)));
}

// Share of the light scattered below the surface's layers that leaves them towards the view.
fn scattered_share(s: Surface, view: vec3f) -> f32 {
    if (!HAS_LAYERS) { return 1.0; }
    if (mirrors_inside(s)) { return 0.0; }
    return s.alpha * coat_transmittance(s, dot(coat_normal(s), view));
}

// Approximate albedo of the directions in which paths continue: mirrored and transmitted light.
fn onward_albedo(s: Surface, view: vec3f) -> f32 {
    let mirrored = luminance(fresnel(s, dot(s.normal, view)));
    if (!HAS_LAYERS) { return mirrored; }
    let passed = s.transmission * (1.0 - s.metallic) * luminance(s.base_color);
    return min(mirrored + 0.1 * s.clearcoat + passed, 1.0) * s.alpha + 1.0 - s.alpha;
}

// Starts the path anew in a scattered direction.
fn leave_vertex(position: vec3f) {
    vertex = position;
    passed_m = 0.0;
    path_is_aimed = false;
}

// Share of a pixel that its surface covers, by its alpha.
fn coverage(s: Surface) -> f32 {
    if (!HAS_LAYERS) { return 1.0; }
    return s.alpha;
}

// Records that the path crosses the surface.
fn cross_surface(s: Surface) {
    path_crossings++;
    media = media_beyond(media, s);
}

// Whether light behind the surface is found only by refracted or rough transmission rays, not by straight shadow
// rays, which `is_aimed` says of paths and shadow rays that share light beyond a rough solid.
fn bends(s: Surface, is_aimed: bool) -> bool {
    return (UNBIASED || is_aimed) && s.transmission > 0.0 && (s.is_solid || s.roughness * s.roughness > SMOOTH_ALPHA);
}

// Next ray of a path, mirrored or transmitted, from a surface that it has hit. Rays of pixels bring one kind of light.
fn onward(before: Reflected, met: Surface, light: u32) -> Reflected {
    let s = dispersed(met);
    let direction = before.direction;
    var back: Reflected;
    if (light != LIGHT_BEHIND) { back = reflected(direction, s); }
    back.weight *= before.kept;
    if (!is_transmissive(s) || light == MIRRORED_LIGHT) { return back; }
    if (!is_reflector(s)) { back.weight = vec3f(0.0); }
    var through = transmitted(direction, s);
    if (light == LIGHT_BEHIND) { return in_one_channel(met, through); }
    // Light samples go straight through panes, so a light seen through one keeps the weight of the ray before it:
    // otherwise a rough surface would count a lamp behind glass twice, once as rare, bright specks.
    let is_aimed = is_aimed_through(s);
    var is_shared = is_aimed;
    if (is_aimed || (bends(s, path_is_aimed) && (s.alpha >= 1.0 || any(direction != through.direction)))) {
        through.weight *= before.kept;
    } else {
        through.pdf = before.pdf;
        through.sky_weight = before.sky_weight;
        through.kept = before.kept;
        through.normal = before.normal;
        is_shared = path_is_aimed;
    }
    if (AIMS_THROUGH && first_way != ANY_WAY) {
        if (first_way == OUT) { back.weight = vec3f(0.0); } else { through.weight = vec3f(0.0); }
        first_way = ANY_WAY;
    }
    var ray = chosen(through, back, ONWARD_PAIR, select(1.0, FAVOR_INSIDE, is_aimed));
    if (met.is_inside || dot(ray.direction, s.geometric_normal) < 0.0) { ray = in_one_channel(met, ray); }
    path_is_aimed = is_shared && ray.pdf > 0.0 && dot(ray.direction, s.geometric_normal) < 0.0;
    if (is_aimed && path_is_aimed) {
        ray.sky_weight = balance(ray.pdf, environment_rays_pdf(outer_side(s), -direction, ray.direction));
        ray.normal = -s.normal;
    }
    let way_m = passed_m + distance(vertex, s.position);
    vertex = s.position;
    passed_m = 0.0;
    if (dot(ray.direction, s.geometric_normal) < 0.0) {
        passed_m = select(way_m, 0.0, is_aimed && path_is_aimed);
        cross_surface(s);
    } else if (s.is_inside) {
        path_crossings++;
    }
    if (AIMS_THROUGH && path_crossings >= FAR_CROSSINGS) {
        ray.weight *= far_weight;
        far_weight = 1.0;
    }
    if (path_crossings > MAX_CROSSINGS && !UNBIASED) { return Reflected(ray.direction, vec3f(0.0), 0.0, 0.0, 1.0, s.normal); }
    return ray;
}

fn onward_origin(s: Surface, direction: vec3f) -> vec3f {
    if (!HAS_LAYERS && !HAS_DIFFUSE_TRANSMISSION) { return ray_origin(s.position, s.geometric_normal); }
    return ray_origin(s.position, s.geometric_normal * select(1.0, -1.0, dot(direction, s.geometric_normal) < 0.0));
}

// Share of light that arrives along a ray, straight through transmissive surfaces: shadow rays are not refracted.
fn transmittance(origin: vec3f, direction: vec3f, distance_m: f32) -> vec3f {
    if (!HAS_TRANSMISSION) { return vec3f(f32(trace_solid(origin, direction, 0.0, distance_m, true).instance == NO_INSTANCE)); }
    var share = vec3f(1.0);
    var start_m = 0.0;
    var ahead_m = 1e30;
    var within = media;
    visits_left = MAX_VISITS;
    passed_cutout = vec2u(NONE);
    for (var pane = 0u; pane < MAX_PANES; pane++) {
        let end_m = min(start_m + ahead_m, distance_m);
        // The nearest hit marked ALPHA_TESTED, or any opaque hit.
        let h = traverse(origin, direction, start_m, end_m, true);
        if (visits_left == 0u) { break; }
        // Beyond many panes the next one is sought nearby first, past fewer nodes.
        ahead_m = select(1e30, 4.0 * (h.t - start_m), pane >= 16u && h.instance != NONE);
        if (h.instance == NONE && end_m < distance_m) { continue; }
        share *= exp(-within.here.extinction * (h.t - start_m));
        if (h.instance == NONE) { return share; }
        start_m = max(start_m, h.t);
        passed_cutout = vec2u(NONE);
        if (HAS_CUTOUT && is_cut_out(h)) {
            passed_cutout = vec2u(h.instance, h.triangle);
            continue;
        }
        var s = surface_at(h.instance, h.triangle, h.bary, direction, 0.0);
        if (!is_transmissive(s)) { return vec3f(0.0); }
        within = media_beyond(within, s);
        let cosine = dot(s.normal, -direction);
        // Both sides filter alike: the ray leaves at the angle at which it entered.
        s.is_inside = false;
        let through = passing_share(s, cosine) * s.base_color
            * (s.transmission * (1.0 - s.metallic) * coat_transmittance(s, cosine) * base_share(s, -direction));
        share *= mix(vec3f(1.0), select(through, vec3f(0.0), bends(s, shadow_is_aimed)), s.alpha);
        if (max(share.x, max(share.y, share.z)) < select(DARKEST_PANE, 1e-12, UNBIASED)) { return vec3f(0.0); }
    }
    // More surfaces than a ray or the loops of a driver may pass: the way behind them counts as clear.
    exhausted_rays++;
    return share;
}
