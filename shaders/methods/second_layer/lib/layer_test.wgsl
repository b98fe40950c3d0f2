// Test whether a surface lies behind the first depth layer.

#import depth_pyramid
#import frame
#import peel_params

@group(2) @binding(0) var<uniform> params: Params;
@group(2) @binding(1) var ids: texture_2d<u32>;
@group(2) @binding(20) var<storage, read> lists: array<u32>;

// Minimum relative difference of depths of two surfaces: the first is computed, the second rasterized.
const SAME_DEPTH: f32 = 1e-4;

// Minimum view depth of the second layer at a pixel.
fn least_depth_m(pixel: vec2u) -> f32 {
    let first_m = depth_of(abs(bitcast<f32>(lists[pyramid_slot(pyramid(), pixel, 0u)])));
    return first_m * (1.0 + SAME_DEPTH) + params.separation_m;
}

// Whether a triangle belongs to the second layer, at a place of the screen with clip-space z. A plane is met but once.
fn is_behind(place: vec4f, id: vec2u) -> bool {
    let pixel = vec2u(place.xy);
    return depth_of(place.z) >= least_depth_m(pixel) && any(textureLoad(ids, pixel, 0).xy != id);
}
