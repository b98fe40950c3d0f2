// Mirror rays of pixels through the BVHs, bounce by bounce.

#import cause
#import gbuffer
#import mirror_hit
#import mirrored
#import lists
#import radiance

@group(2) @binding(5) var cause: texture_2d<u32>;
@group(2) @binding(6) var reflection: RadianceTexture;
@group(2) @binding(9) var counts: texture_storage_2d<rgba32uint, write>; // with COUNT

const PATHS: u32 = MIRROR_PATHS;

// Traces the mirror ray of a pixel, or shades its known first hit, and writes its reflection and its first hit.
fn trace_pixel(pixel: vec2u) {
    let first = load_surface(pixel);
    let ray = reflected_ray(pixel, first);
    if (MARCH && is_known) {
        let found = stored_hit(pixel);
        // In fog, rays past all surfaces are listed too, for the light on their way.
        known_hit = Hit(select(bitcast<f32>(found.x), FAR_M, HAS_FOG && found.y == NONE), found.y, found.z, unpack2x16unorm(found.w), 0u);
    }
    var light = vec4f(0.0);
    if (carries_light(ray)) {
        if (!MAPPED) { free_start_m = free_m(textureLoad(cause, pixel, 0).x); }
        light = mirrored_light(pixel, first, ray, ray_origin(first.position, first.geometric_normal));
    }
    if (SHADE) { textureStore(reflection, pixel, stored(light)); }
    if (!is_known) { store_hit(pixel, first_hit); }
    if (exhausted_rays > 0u) { atomicAdd(&counters[EXHAUSTED_COUNTER], exhausted_rays); }
    if (COUNT) { textureStore(counts, pixel, vec4u(map_steps, traversals, visited_nodes, tested_triangles)); }
}
