// Hits: shades the screen hits of the march, at the point where the ray meets the surface and with the ray's
// footprint, as the trace pass would.

#import in_scattering
#import lists
#import radiance
#import shaded_hit

@group(2) @binding(5) var hit: texture_2d<u32>;
@group(2) @binding(6) var reflection: RadianceTexture;
@group(2) @binding(8) var counts: texture_storage_2d<rgba32uint, write>; // with COUNT

fn shade_pixel(pixel: vec2u) {
    let first = load_surface(pixel);
    let ray = reflected_ray(pixel, first);
    let direction = ray.direction;
    let found = textureLoad(hit, pixel, 0);
    // In fog, rays past all surfaces are listed too, for the light on their way.
    if (HAS_FOG && found.y == NONE && !carries_light(ray)) { return; }
    let distance_m = select(bitcast<f32>(found.x), FAR_M, HAS_FOG && found.y == NONE);
    start_samples(pixel, 1u);
    start_path(first.position, first.is_inside);
    let end = seen_at_end(first.position, ray, found.y, distance_m);
    let air = through_air(first.position, ray, end.distance_m);
    var color = end.radiance;
    var start = Start(Reflected(direction, vec3f(0.0), 0.0, 0.0, 1.0, first.normal), first.position);
    var cone = reflected_cone(first, distance_m);
    if (!end.is_seen && !air.scatters) {
        var s = surface_at(found.y, found.z, unpack2x16unorm(found.w), direction, cone.width_m);
        s.emission *= met_emission(ray, found.y, found.z, distance_m, s);
        var reused = vec2u(0u);
        if (REUSES_LIGHT) { reused = reused_visibility(s); }
        color = met_light(ray, s, reused);
        start = scattered_by_surface(ray, s);
    }
    if (HAS_FOG && air.scatters) {
        color = vec3f(0.0);
        start = Start(air.ray, air.position);
        start.ray.weight = vec3f(1.0);
        cone = reflected_cone(first, distance(first.position, air.position));
    }
    color *= medium_transmittance(end.distance_m);
    start.ray.weight *= medium_transmittance(end.distance_m);
    color += followed(pixel, 2u, 1u, start, cone);
    if (HAS_FOG) { color = air.light + color * air.share; }
    textureStore(reflection, pixel, stored(smoothable(first, ray, color)));
    if (exhausted_rays > 0u) { atomicAdd(&counters[EXHAUSTED_COUNTER], exhausted_rays); }
}

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = (group.y * groups.x + group.x) * RAYS_PER_GROUP + lane;
    if (index >= atomicLoad(&counters[HIT_COUNTER])) { return; }
    let pixel = unpack_pixel(lists[hit_slot(index)]);
    shade_pixel(pixel);
    if (COUNT) { textureStore(counts, pixel, vec4u(0u, traversals, visited_nodes, tested_triangles)); }
}
