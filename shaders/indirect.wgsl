// Indirect: path traces the diffuse light that the surfaces of pixels receive from other surfaces.

#import cone
#import gbuffer
#import indirect
#import lists
#import radiance

@group(2) @binding(5) var indirect_light: RadianceTexture;
@group(2) @binding(11) var counts: texture_storage_2d<rgba32uint, write>; // with COUNT

// Whether the light is smoothed over neighbors: it is stored without the albedo of the surface then, -1 in colors that
// the surface does not scatter, and w is the width of a pixel over the distance that the light came from; 0 where the
// surface scatters none.
override SMOOTHED: bool = false;

const PATHS: u32 = FREE_PATHS;
const FIRST_VERTEX: u32 = 128u; // offset of sample numbers: others than for reflections

fn gathered(pixel: vec2u) -> vec4f {
    if (textureLoad(view_depth, pixel, 0).x >= FAR_M) { return vec4f(0.0); }
    let s = load_surface(pixel);
    let distance_m = distance(s.position, frame.eye);
    start_path(s.position, false);
    start_samples(pixel, FIRST_VERTEX);
    let view = -view_direction(s.position);
    let albedo = scattering_albedo(s, view);
    if (all(albedo <= vec3f(0.0))) { return vec4f(0.0, 0.0, 0.0, select(1.0, 0.0, SMOOTHED)); }
    let ray = scattered_ray(s, view, scattered_albedo(s, view));
    var start = Start(ray, onward_origin(s, ray.direction));
    if (SMOOTHED) {
        let brightest = max(albedo.x, max(albedo.y, albedo.z));
        if (brightest < 1e-4) { return vec4f(0.0); }
        // The path ends no sooner where the surface is dark.
        path_share = brightest;
        start.ray.weight /= brightest;
    }
    let light = gathered_by_path(pixel, FIRST_VERTEX + 1u, 0u, start, pixel_cone(distance_m), false).xyz;
    if (!SMOOTHED) { return vec4f(light, 1.0); }
    let arrived = select(vec3f(-1.0), light * path_share / max(albedo, vec3f(1e-4)), albedo >= vec3f(1e-4));
    return vec4f(arrived, clamp(pixel_width(distance_m) / first_m, 1e-3, 1.0));
}

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = invoked_pixel(group, groups, local);
    if (any(pixel >= vec2u(frame.size)) || is_left_out(pixel)) { return; }
    textureStore(indirect_light, pixel, stored(gathered(pixel)));
    if (COUNT) { textureStore(counts, pixel, vec4u(0u, traversals, visited_nodes, tested_triangles)); }
    if (exhausted_rays > 0u) { atomicAdd(&counters[EXHAUSTED_COUNTER], exhausted_rays); }
}
