// Transmit: follows rays through the transmissive surfaces of the listed pixels, to the surfaces behind.

#import in_scattering
#import cone
#import gbuffer
#import indirect
#import lists
#import radiance

@group(2) @binding(0) var ids: texture_2d<u32>;
@group(2) @binding(6) var transmitted_light: RadianceTexture;
@group(2) @binding(11) var counts: texture_storage_2d<rgba32uint, write>; // with COUNT

const FIRST_VERTEX: u32 = 64u; // offset of sample numbers: others than for reflections

// Whether the background is transparent, where the camera sees it through surfaces of partial coverage.
override HIDES_BACKGROUND: bool = false;

// Whether straight rays of the camera show the environment; refracted and mirrored rays always do.
override SHOW_ENVIRONMENT: bool = true;

// Surface of a pixel, with the material's values that the G-buffer does not hold.
fn completed(pixel: vec2u) -> Surface {
    var s = load_surface(pixel);
    let m = instance_material(textureLoad(ids, pixel, 0).x);
    s.ior = material_ior(m);
    s.dispersion = material_dispersion(m);
    s.absorption = material_absorption(m);
    s.is_solid = material_is_solid(m) != 0u;
    return s;
}

// Light from behind the surface of a pixel along one path; w: share that is covered by surfaces rather than the
// background.
fn behind_once(pixel: vec2u, first: Surface) -> vec4f {
    var s = first;
    forget_path();
    forget_scatterings();
    start_path(s.position, false);
    start_samples(pixel, FIRST_VERTEX);
    var cone = pixel_cone(distance(s.position, frame.eye));
    var ray = through(view_direction(s.position), s);
    var throughput = ray.weight;
    var color = vec3f(0.0);
    let seen = view_direction(s.position);
    var is_straight = s.transmission <= 0.0;
    var uncovered = 1.0; // share that the surfaces behind the first leave uncovered
    var origin = onward_origin(s, ray.direction);
    for (var step = 0u; step < frame.bounces + crossings() + scatterings(); step++) {
        if (max(throughput.x, max(throughput.y, throughput.z)) < frame.dimmest) { break; }
        start_samples(pixel, FIRST_VERTEX + step + 1u);
        let h = trace_nearest(origin, ray.direction, 0.0, FAR_M);
        let end = seen_at_end(origin, ray, h.instance, h.t);
        throughput *= medium_transmittance(end.distance_m);
        if (HAS_FOG) {
            let air = through_air(origin, ray, end.distance_m);
            color += found_light(throughput * air.light, step);
            throughput *= air.share;
            uncovered *= air.share.x;
            if (air.scatters) {
                uncovered = 0.0;
                cone = continued(cone, distance(origin, air.position));
                ray = air.ray;
                origin = air.position;
                is_straight = false;
                continue;
            }
        }
        if (h.instance == NONE) {
            if (HIDES_BACKGROUND && is_straight) { return vec4f(color, 1.0 - uncovered); }
            if (!SHOW_ENVIRONMENT && is_straight) { return vec4f(color + throughput * frame.background, 1.0); }
        }
        if (end.is_seen) {
            color += found_light(throughput * end.radiance, step);
            break;
        }
        cone = continued(cone, h.t);
        let direction = ray.direction;
        s = surface_at(h.instance, h.triangle, h.bary, direction, cone.width_m);
        s.emission *= met_emission(ray, h.instance, h.triangle, h.t, s);
        let lit = shade(s, -direction, vec2u(0u));
        color += found_light(throughput * met_light(ray, lit), step);
        if (!continues(s)) { break; }
        uncovered *= 1.0 - coverage(s);
        ray = next_ray(ray, s);
        throughput *= ray.weight;
        is_straight = is_straight && s.transmission <= 0.0 && dot(ray.direction, seen) > 0.99999;
        origin = onward_origin(s, ray.direction);
    }
    return vec4f(color, 1.0);
}

// Number of paths: more in the first pictures, where glass turns or scatters light, so that one path that ends in the
// dark leaves no black speck.
fn number_of_paths(s: Surface) -> u32 {
    let is_rough = HAS_ROUGH_REFLECTIONS && s.roughness * s.roughness > SMOOTH_ALPHA;
    if (s.transmission <= 0.0 || !(s.is_solid || is_rough)) { return 1u; }
    return paths_behind();
}

fn behind(pixel: vec2u) -> vec4f {
    let s = completed(pixel);
    if (!is_transmissive(s)) { return vec4f(0.0, 0.0, 0.0, 1.0); }
    let paths = number_of_paths(s);
    var sum = vec4f(0.0);
    for (var k = 0u; k < paths; k++) {
        take_path(k, paths);
        sum += behind_once(pixel, s);
    }
    return sum / f32(paths);
}

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = (group.y * groups.x + group.x) * RAYS_PER_GROUP + lane;
    if (index >= atomicLoad(&counters[TRANSMISSIVE_COUNTER])) { return; }
    let pixel = unpack_pixel(lists[transmissive_slot(index)]);
    textureStore(transmitted_light, pixel, stored(behind(pixel)));
    if (COUNT) { textureStore(counts, pixel, vec4u(0u, traversals, visited_nodes, tested_triangles)); }
    if (exhausted_rays > 0u) { atomicAdd(&counters[EXHAUSTED_COUNTER], exhausted_rays); }
}
