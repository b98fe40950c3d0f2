// Fog: light that the fog between the camera and a pixel's surface scatters, and its transmittance.

#import in_scattering
#import gbuffer
#import indirect
#import lists
#import radiance

@group(2) @binding(5) var fog_light: RadianceTexture; // w: transmittance

const LEAVES_PIXELS: bool = false;
const FIRST_VERTEX: u32 = 192u; // offset of sample numbers: others than for surfaces

fn fog_before(pixel: vec2u) -> vec4f {
    let center = vec2f(pixel) + 0.5;
    let along = pixel_ray(center);
    let depth_m = textureLoad(view_depth, pixel, 0).x;
    var distance_m = FAR_M;
    if (depth_m < FAR_M) {
        // No fog is within glass around the eye.
        if (load_surface(pixel).is_inside || frame.eye_solids > 0u) { return vec4f(0.0, 0.0, 0.0, 1.0); }
        distance_m = depth_m * length(along);
    }
    let origin = pixel_origin(center);
    start_path(origin, false);
    start_samples(pixel, FIRST_VERTEX);
    let way = way_in_fog(origin, normalize(along), distance_m);
    var light = vec3f(0.0);
    for (var k = 0u; k < sampling.rays; k++) {
        light += scattered_on_way(way, first_light_sample() + k, 1.0);
        if (!SEVERAL_LIGHT_RAYS) { break; }
    }
    light /= f32(sampling.rays);
    if (FOLLOWS_FOG) { light += gathered_by_path(pixel, FIRST_VERTEX + 1u, 1u, scattered_start(way), pixel_cone(0.0), false).xyz; }
    return stored(vec4f(light, 1.0 - way.scattered));
}

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = invoked_pixel(group, groups, local);
    if (any(pixel >= vec2u(frame.size)) || is_left_out(pixel)) { return; }
    textureStore(fog_light, pixel, fog_before(pixel));
    if (exhausted_rays > 0u) { atomicAdd(&counters[EXHAUSTED_COUNTER], exhausted_rays); }
}
