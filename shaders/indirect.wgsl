// Indirect: path traces the diffuse light that the surfaces of pixels receive from other surfaces.

#import cone
#import gbuffer
#import indirect
#import lists
#import radiance

@group(2) @binding(3) var indirect_light: RadianceTexture;

const FIRST_VERTEX: u32 = 128u; // offset of sample numbers, so that they differ from those of reflections

fn gathered(pixel: vec2u) -> vec3f {
    if (textureLoad(view_depth, pixel, 0).x >= FAR_M) { return vec3f(0.0); }
    let s = load_surface(pixel);
    let distance_m = distance(s.position, frame.eye);
    start_path(s.position, false);
    start_samples(pixel, FIRST_VERTEX);
    let view = Reflected(view_direction(s.position), vec3f(1.0), 0.0, 1.0, 1.0, s.normal);
    return followed(pixel, FIRST_VERTEX + 1u, 0u, scattered_by_surface(view, s), pixel_cone(distance_m));
}

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = invoked_pixel(group, groups, local);
    if (any(pixel >= vec2u(frame.size)) || is_left_out(pixel)) { return; }
    textureStore(indirect_light, pixel, stored(vec4f(gathered(pixel), 1.0)));
    if (exhausted_rays > 0u) { atomicAdd(&counters[EXHAUSTED_COUNTER], exhausted_rays); }
}
