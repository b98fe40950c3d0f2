// Paths, ray by ray; with diffuse interreflection they also continue in directions that diffuse surfaces scatter.
// A pass says by LEAVES_PIXELS whether its paths start at surfaces of pixels; other paths have a given first ray.

#import in_scattering
#import cause
#import closest_hit
#import cone
#import area_sampling
#import diffuse
#import layers
#import light_reuse
#import lobe
#import sampling
#import subsurface

override MIRRORS: bool = true; // with LEAVES_PIXELS: whether mirror rays are followed, where pixels reflect

// Whether hits are shaded. false: the same rays are followed and their hits written, to measure how
// much of the time traversal takes.
override SHADE: bool = true;

const FIRST_ENDING: u32 = 4u; // number of vertices before Russian roulette starts
const MOST_LIKELY: f32 = 0.95; // maximum survival probability

// With LEAVES_PIXELS: the light that first rays bring, and these rays.
var<private> start_light: u32 = ANY_LIGHT;
var<private> first_ray: Reflected;
var<private> path_weight: vec3f = vec3f(1.0);
var<private> path_vertices: u32 = 0u;
var<private> first_m: f32 = FAR_M; // length of the first ray that was followed, unless it was scattered in a solid
var<private> free_start_m: f32 = 0.0; // length of the first ray that the march has found free
var<private> first_hit: vec4u = vec4u(0u, NONE, NONE, NONE); // of a mirror ray, see mirror_hit.wgsl
var<private> is_known: bool = false; // whether the first hit is known; light is scattered alone there
var<private> known_hit: Hit;
// How a mirror ray of a pixel ended in a map; CAUSE_UNMARCHED where trees ended it.
var<private> first_cause: u32 = CAUSE_UNMARCHED;

fn is_mirrored() -> bool {
    return LEAVES_PIXELS && MIRRORS && HAS_REFLECTIONS && start_light == MIRRORED_LIGHT;
}

// Number of hits after which the path ends: crossings, scatterings and known hits do not count as bounces.
fn most_hits() -> u32 {
    let uncounted = select(0u, path_crossings + walk_scatterings, HAS_LAYERS) + select(0u, path_scatterings, HAS_INDIRECT);
    return frame.bounces + uncounted + u32(is_known);
}

// Prepares for a path after another one of the same invocation.
fn forget_path() {
    path_scatterings = 0u;
    path_is_chance = false;
    passed_m = 0.0;
    path_weight = vec3f(1.0);
    path_vertices = 0u;
}

// Maximum length of the path's next ray: only reflections are limited to the scene's ray length.
fn reach_m() -> f32 {
    return select(frame.ray_length_m, FAR_M, HAS_INDIRECT && path_scatterings > 0u);
}

// Diffuse albedo of a surface towards the view, while the path may still scatter.
fn scattered_albedo(s: Surface, view: vec3f) -> vec3f {
    if (path_scatterings >= frame.diffuse_bounces) { return vec3f(0.0); }
    return diffuse_albedo(s, view) * scattered_share(s, view);
}

fn continues(s: Surface) -> bool {
    let is_matte = has_sheen(s) || passes_diffusely(s) || (s.metallic < 1.0 && any(s.base_color > vec3f(0.0)));
    return goes_on(s) || (HAS_INDIRECT && path_scatterings < frame.diffuse_bounces && is_matte);
}

// Albedo of the light that a surface scatters from its other side to the side of the view, while the path may still scatter.
fn scattered_through(s: Surface, view: vec3f) -> vec3f {
    if (!passes_diffusely(s) || path_scatterings >= frame.diffuse_bounces) { return vec3f(0.0); }
    return passed_albedo(s, view) * scattered_share(s, view);
}

// A cosine-distributed scattered ray, on either side of the surface by the light that comes from there. The
// environment's light is left to light samples.
fn scattered_ray(s: Surface, view: vec3f, albedo: vec3f) -> Reflected {
    var u = sample_square(sample_index(), SCATTER_PAIR);
    var part = s;
    var color = albedo;
    var share = 1.0; // probability of the side
    var enters = false; // whether the ray goes on in a solid that scatters light
    if (HAS_DIFFUSE_TRANSMISSION) {
        let through = scattered_through(s, view);
        let here = luminance(albedo) + luminance(sheen_albedo(s, view)) * scattered_share(s, view);
        share = here / max(here + luminance(through), 1e-6);
        if (u.x >= share) {
            part = other_side(s, view);
            color = through;
            enters = !s.is_inside && bounds_scattering(s);
            media = media_beyond(media, s);
            u.x -= share;
            share = 1.0 - share;
        }
        u.x = min(u.x / max(share, 1e-6), BELOW_ONE);
    }
    // A walk within a solid counts as one scattering, where it leaves.
    if (enters) { path_crossings++; } else { path_scatterings++; }
    path_is_chance = true;
    leave_vertex(s.position);
    let out = cosine_direction(part.normal, u);
    if (dot(out, part.geometric_normal) <= 0.0) { return Reflected(part.normal, vec3f(0.0), TAKEN, 0.0, 1.0, part.normal); }
    let weight = (diffuse_towards(part, color, view, out) + sheen(part, view, out) * scattered_share(s, view)) / share;
    // Light samples stop at the surface of the solid.
    if (enters) { return Reflected(out, weight, 0.0, 1.0, 1.0, part.normal); }
    return Reflected(out, weight, scattered_density(dot(part.normal, out)), 0.0, 1.0, part.normal);
}

// Next ray of a path: scattered, mirrored or transmitted, by the light that each returns, or for one kind of light.
fn next_ray(before: Reflected, s: Surface, light: u32) -> Reflected {
    if (!HAS_INDIRECT) { return onward(before, s, light); }
    let view = -before.direction;
    let albedo = scattered_albedo(s, view);
    var diffuse = luminance(albedo + scattered_through(s, view));
    if (path_scatterings < frame.diffuse_bounces) { diffuse += luminance(sheen_albedo(s, view)) * scattered_share(s, view); }
    var rest = select(0.0, max(onward_albedo(s, view), 0.01), goes_on(s) && light != RECEIVED_LIGHT);
    if (light == MIRRORED_LIGHT || light == LIGHT_BEHIND) {
        diffuse = 0.0;
        rest = 1.0;
    }
    if (diffuse + rest <= 0.0) { return Reflected(s.normal, vec3f(0.0), TAKEN, 0.0, 1.0, s.normal); }
    let share = diffuse / (diffuse + rest);
    let u = sample_square(sample_index(), CHOICE_PAIR);
    var ray: Reflected;
    if (u.x < share) {
        ray = scattered_ray(s, view, albedo);
        ray.weight *= before.kept / share;
    } else {
        ray = onward(before, s, light);
        ray.weight /= 1.0 - share;
    }
    if (UNBIASED && light == ANY_LIGHT) { ray.weight *= survival(ray.weight, u.y); }
    return ray;
}

// Russian roulette: factor on a surviving path; 0 ends it.
fn survival(weight: vec3f, u: f32) -> f32 {
    path_weight *= weight;
    path_vertices++;
    if (path_vertices < FIRST_ENDING) { return 1.0; }
    let chance = clamp(max(path_weight.x, max(path_weight.y, path_weight.z)), 0.05, MOST_LIKELY);
    if (u >= chance) { return 0.0; }
    path_weight /= chance;
    return 1.0 / chance;
}

// First ray of a path, and the point where it starts. With LEAVES_PIXELS: the surface that it starts at, where the ray arrives.
struct Start {
    ray: Reflected,
    origin: vec3f,
    at: Surface,
}

// The nearest hit of a ray of a path, up to a distance.
fn hit_of_path(origin: vec3f, direction: vec3f, most_m: f32, is_first: bool) -> Hit {
    if (is_known && is_first) { return known_hit; }
    if (!LEAVES_PIXELS || (MAPPED && !is_mirrored())) { return trace_nearest(origin, direction, 0.0, most_m); }
    let end_m = select(most_m, min(reach_m(), most_m), is_mirrored());
    let h = closest_hit(origin, direction, select(0.0, free_start_m, is_first), end_m);
    if (is_first) { first_cause = map_cause; }
    return h;
}

// Light that a path gathers. `vertex` is the number of its first samples, `hits` the number of its earlier hits;
// `is_seen`: whether the camera looks straight along its first ray. w: share that is covered by surfaces rather than the
// background, for such a path.
fn gathered_by_path(pixel: vec2u, vertex: u32, hits: u32, start: Start, first: Cone, is_seen: bool) -> vec4f {
    var color = vec3f(0.0);
    var ray = start.ray;
    var origin = start.origin;
    var throughput = ray.weight;
    var cone = first;
    var is_straight = is_seen;
    var uncovered = 1.0; // share that the surfaces met so far leave uncovered
    var s = start.at;
    var is_scattered = false;
    var leaves = LEAVES_PIXELS; // whether the path leaves the surface or the point of a scattering
    for (var k = 0u; ; k++) {
        // All rays leave here, as drivers inline each call.
        if (leaves) {
            let is_start = LEAVES_PIXELS && k == 0u;
            if (HAS_SCATTERING && is_scattered) {
                ray = scattered_within(s, throughput);
            } else {
                ray = next_ray(ray, s, select(select(ANY_LIGHT, RECEIVED_LIGHT, is_known && k == 1u), start_light, is_start));
            }
            if (is_start) {
                first_ray = ray;
                // The pixel's surface weighs its reflection.
                ray.weight = select(ray.weight / path_share, vec3f(1.0), is_mirrored() && carries_light(ray));
            }
            throughput *= ray.weight;
            is_straight = is_straight && s.transmission <= 0.0 && dot(ray.direction, start.ray.direction) > 0.99999;
            // A transmitted ray keeps its cone; a mirrored one has its cone widened by the curvature.
            if (is_mirrored() && dot(ray.direction, s.geometric_normal) > 0.0) { cone = mirrored_cone(cone, s.curvature); }
            origin = select(onward_origin(s, ray.direction), s.position, HAS_SCATTERING && is_scattered);
        }
        leaves = true;
        let most = max(throughput.x, max(throughput.y, throughput.z));
        if (k >= most_hits() || most < frame.dimmest || (LEAVES_PIXELS && most <= 0.0)) { break; }
        start_samples(pixel, vertex + k);
        let flight = free_flight(select(throughput, vec3f(0.0), is_mirrored() && k == 0u));
        let h = hit_of_path(origin, ray.direction, flight.length_m, k == 0u);
        let end = seen_at_end(origin, ray, h.instance, h.t);
        is_scattered = HAS_SCATTERING && flight.length_m < end.distance_m;
        let way_m = min(flight.length_m, end.distance_m);
        throughput *= medium_transmittance(way_m) * flight_weight(flight, way_m, is_scattered);
        if (k == 0u && !is_scattered) { first_m = way_m; }
        if (is_mirrored() && k == 0u && !end.is_seen) { first_hit = vec4u(bitcast<u32>(h.t), h.instance, h.triangle, NONE); }
        if (HAS_FOG && SHADE) {
            let air = through_air(origin, ray, end.distance_m);
            color += found_light(throughput * air.light, hits + k);
            throughput *= air.share;
            uncovered *= air.share.x;
            if (air.scatters) {
                uncovered = 0.0;
                cone = continued(cone, distance(origin, air.position));
                ray = air.ray;
                origin = air.position;
                is_straight = false;
                leaves = false;
                continue;
            }
        }
        if (h.instance == NONE && is_straight && !is_scattered) {
            if (HIDES_BACKGROUND) { return vec4f(color, 1.0 - uncovered); }
            if (!SHOW_ENVIRONMENT) { return vec4f(color + throughput * frame.background, 1.0); }
        }
        if (end.is_seen && !is_scattered) {
            color += found_light(throughput * end.radiance, hits + k);
            break;
        }
        // Without shading, a surface only matters where the path may continue from it.
        if (!SHADE && k + 1u == most_hits()) { break; }
        cone = continued(cone, way_m);
        if (HAS_SCATTERING && is_scattered) {
            s = scatterer(origin + ray.direction * way_m);
        } else {
            s = surface_at(h.instance, h.triangle, h.bary, ray.direction, cone.width_m);
            s.emission *= met_emission(ray, h.instance, h.triangle, h.t, s);
        }
        let lit_share = select(1.0, media.here.lit_share, is_scattered);
        if (SHADE && lit_share > 0.0) {
            var reused = vec2u(0u);
            if (REUSES_LIGHT && is_mirrored()) { reused = reused_visibility(s); }
            color += found_light(throughput * met_light(ray, s, reused) * lit_share, hits + k);
        }
        if (is_known && !HAS_INDIRECT) { break; }
        if (AIMS_THROUGH && first_way != ANY_WAY && !is_aimed_through(s)) {
            if (first_way == BACK) { break; }
            first_way = ANY_WAY;
        }
        if (!is_scattered && !continues(s)) { break; }
        uncovered *= 1.0 - coverage(s);
    }
    return vec4f(color, 1.0);
}
