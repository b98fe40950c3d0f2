// Hits: shades the screen hits of the march, at the point where the ray meets the surface and with the ray's
// footprint, as the trace pass would.

#import gbuffer
#import lists
#import mirrored
#import radiance

@group(2) @binding(5) var hit: texture_2d<u32>;
@group(2) @binding(6) var reflection: RadianceTexture;
@group(2) @binding(8) var counts: texture_storage_2d<rgba32uint, write>; // with COUNT

const PATHS: u32 = HIT_PATHS;

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = (group.y * groups.x + group.x) * RAYS_PER_GROUP + lane;
    if (index >= atomicLoad(&counters[HIT_COUNTER])) { return; }
    let pixel = unpack_pixel(lists[hit_slot(index)]);
    let first = load_surface(pixel);
    let ray = reflected_ray(pixel, first);
    let found = textureLoad(hit, pixel, 0);
    // In fog, rays past all surfaces are listed too, for the light on their way.
    let is_past_all = HAS_FOG && found.y == NONE;
    if (is_past_all && !carries_light(ray)) { return; }
    known_hit = Hit(select(bitcast<f32>(found.x), FAR_M, is_past_all), found.y, found.z, unpack2x16unorm(found.w), 0u);
    textureStore(reflection, pixel, stored(mirrored_light(pixel, first, ray, first.position)));
    if (exhausted_rays > 0u) { atomicAdd(&counters[EXHAUSTED_COUNTER], exhausted_rays); }
    if (COUNT) { textureStore(counts, pixel, vec4u(0u, traversals, visited_nodes, tested_triangles)); }
}
