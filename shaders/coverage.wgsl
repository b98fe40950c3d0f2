// Coverage: share of each pixel that shows a surface rather than the background; added to the sum of the sub-frames
// before it.

#import coverage_params
#import gbuffer

@group(2) @binding(5) var coverage_sum: texture_storage_2d<r32float, read_write>;
@group(2) @binding(6) var<uniform> params: Params;
@group(2) @binding(8) var transmitted_light: texture_2d<f32>; // w: share of the light behind that surfaces cover
@group(2) @binding(9) var fog_light: texture_2d<f32>; // w: transmittance

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = moment_pixel(id.xy);
    if (any(pixel >= vec2u(frame.size))) { return; }
    var uncovered = 1.0;
    if (textureLoad(view_depth, pixel, 0).x < FAR_M) {
        uncovered = 0.0;
        if (HAS_TRANSMISSION) {
            let own = coverage(load_surface(pixel));
            uncovered = 1.0 - (own + (1.0 - own) * textureLoad(transmitted_light, pixel, 0).w);
        }
    }
    if (HAS_FOG) { uncovered *= textureLoad(fog_light, pixel, 0).w; }
    var covered = 1.0 - uncovered;
    if (params.sample > 0u) { covered += textureLoad(coverage_sum, pixel).x; }
    textureStore(coverage_sum, pixel, vec4f(covered, 0.0, 0.0, 0.0));
}
