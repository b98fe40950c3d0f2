// Paths of mirror rays through the BVHs, bounce by bounce.

#import gbuffer
#import indirect
#import lists
#import radiance

@group(2) @binding(6) var reflection: RadianceTexture;
@group(2) @binding(7) var hit: texture_storage_2d<rgba32uint, write>;
@group(2) @binding(9) var counts: texture_storage_2d<rgba32uint, write>; // with COUNT

const MIRRORED: bool = true;

// Traces the mirror ray of a pixel and writes its reflection; the result is its first hit.
fn trace_pixel(pixel: vec2u) -> vec4u {
    let first = load_surface(pixel);
    let ray = reflected_ray(pixel, first);
    var light = vec4f(0.0);
    if (carries_light(ray)) {
        start_path(first.position, first.is_inside);
        free_start_m = march_free_m(pixel);
        var start = Start(ray, ray_origin(first.position, first.geometric_normal));
        start.ray.weight = vec3f(1.0); // the pixel's surface weighs its reflection
        let cone = mirrored_cone(pixel_cone(distance(first.position, frame.eye)), first.curvature);
        light = smoothable(first, ray, gathered_by_path(pixel, 1u, 0u, start, cone, false).xyz);
    }
    if (SHADE) { textureStore(reflection, pixel, stored(light)); }
    textureStore(hit, pixel, first_hit);
    if (exhausted_rays > 0u) { atomicAdd(&counters[EXHAUSTED_COUNTER], exhausted_rays); }
    return first_hit;
}
