// Paths of mirror rays through the BVHs, bounce by bounce.

#import in_scattering
#import cause
#import cone
#import gbuffer
#import indirect
#import light_reuse
#import lists
#import closest_hit
#import radiance

@group(2) @binding(6) var reflection: RadianceTexture;
@group(2) @binding(7) var hit: texture_storage_2d<rgba32uint, write>;

@group(2) @binding(8) var visible_lights: texture_2d<u32>; // shadow ray results of the light pass, reused here
@group(2) @binding(9) var counts: texture_storage_2d<rgba32uint, write>; // with COUNT

// Whether hits are shaded. false: the same rays are followed and their hits written, to measure how
// much of the time traversal takes.
override SHADE: bool = true;

// How the first ray of the path ended in a map; CAUSE_UNMARCHED where trees ended it.
var<private> first_cause: u32 = CAUSE_UNMARCHED;

// Traces the mirror ray of a pixel and writes its reflection; the result is its first hit.
fn trace_pixel(pixel: vec2u) -> vec4u {
    let first = load_surface(pixel);
    var cone = mirrored_cone(pixel_cone(distance(first.position, frame.eye)), first.curvature);
    var origin = ray_origin(first.position, first.geometric_normal);
    let leaving = reflected_ray(pixel, first);
    var ray = leaving;
    if (!carries_light(ray)) {
        textureStore(hit, pixel, vec4u(0u, NONE, NONE, 0u));
        if (SHADE) { textureStore(reflection, pixel, vec4f(0.0)); }
        return vec4u(0u, NONE, NONE, 0u);
    }
    start_path(first.position, first.is_inside);
    var color = vec3f(0.0);
    var throughput = vec3f(1.0);
    var found = vec4u(0u, NONE, NONE, 0u);
    var start_m = free_start_m(pixel); // length that the march has found free
    for (var bounce = 0u; bounce < frame.bounces + crossings() + scatterings(); bounce++) {
        start_samples(pixel, bounce + 1u);
        let direction = ray.direction;
        let h = closest_hit(origin, direction, start_m, reach_m());
        if (bounce == 0u) { first_cause = map_cause; }
        start_m = 0.0;
        let end = seen_at_end(origin, ray, h.instance, h.t);
        throughput *= medium_transmittance(end.distance_m);
        if (bounce == 0u && !end.is_seen) { found = vec4u(bitcast<u32>(h.t), h.instance, h.triangle, 0u); }
        if (HAS_FOG && SHADE) {
            let air = through_air(origin, ray, end.distance_m);
            color += found_light(throughput * air.light, bounce);
            throughput *= air.share;
            if (air.scatters) {
                cone = continued(cone, distance(origin, air.position));
                ray = air.ray;
                origin = air.position;
                continue;
            }
        }
        if (end.is_seen) {
            color += found_light(throughput * end.radiance, bounce);
            break;
        }
        // Without shading, a surface only matters where the path may continue from it.
        if (!SHADE && bounce + 1u == frame.bounces + crossings() + scatterings()) { break; }
        cone = continued(cone, h.t);
        var s = surface_at(h.instance, h.triangle, h.bary, direction, cone.width_m);
        s.emission *= met_emission(ray, h.instance, h.triangle, h.t, s);
        if (SHADE) {
            var reused = vec2u(0u);
            if (REUSES_LIGHT) { reused = reused_visibility(visible_lights, s); }
            color += found_light(throughput * met_light(ray, s, reused), bounce);
        }
        if (!continues(s)) { break; }
        ray = next_ray(ray, s);
        throughput *= ray.weight;
        if (max(throughput.x, max(throughput.y, throughput.z)) < frame.dimmest) { break; }
        // A transmitted ray keeps its cone; a mirrored one has its cone widened by the curvature.
        if (dot(ray.direction, s.geometric_normal) > 0.0) { cone = mirrored_cone(cone, s.curvature); }
        origin = onward_origin(s, ray.direction);
    }
    if (SHADE) { textureStore(reflection, pixel, stored(smoothable(first, leaving, color))); }
    textureStore(hit, pixel, found);
    if (exhausted_rays > 0u) { atomicAdd(&counters[EXHAUSTED_COUNTER], exhausted_rays); }
    return found;
}
