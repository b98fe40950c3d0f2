// Filter: smooths the reflections of rough surfaces in pictures of few sub-frames, over neighboring pixels that see
// nearly the same: along one surface, as far as the lobe spreads on its way to the hit. Sharp reflections stay
// as they are.

#import cause
#import filter_params
#import gbuffer
#import radiance
#import taps

@group(2) @binding(5) var cause: texture_2d<u32>;
@group(2) @binding(6) var hit: texture_2d_array<u32>;
@group(2) @binding(7) var source: texture_2d<f32>; // w in the first step: 0 where the facet mirrors the view into the surface
@group(2) @binding(8) var blurred: RadianceTexture;
@group(2) @binding(9) var<uniform> params: Params;

const WIDEST: f32 = 0.03; // maximum radius, as a share of the picture's height
const FARTHEST_M: f32 = 6e4; // within floats of 16 bits

// Mean hit distance of the rays of the pixels around, m; each is clamped to `farthest_m`.
fn mean_hit_m(pixel: vec2i, farthest_m: f32) -> f32 {
    var sum = 0.0;
    var count = 0.0;
    let step = select(1, 2, params.taps < 9u);
    for (var k = 0; k < 9; k += step) {
        let at = pixel_of_moment(pixel + vec2i(k % 3 - 1, k / 3 - 1) * 2);
        if (!inside(at) || !reflects(textureLoad(cause, at, 0).x) || textureLoad(source, at, 0).w == 0.0) { continue; }
        let found = vec2u(textureLoad(hit, at, 0, 0).x, textureLoad(hit, at, 1, 0).x);
        sum += select(min(bitcast<f32>(found.x), farthest_m), farthest_m, found.y == NONE);
        count += 1.0;
    }
    return sum / max(count, 1.0);
}

// Smoothed light. w: mean hit distance, which the first step finds.
fn filtered(pixel: vec2u, center: vec4f) -> vec4f {
    let s = load_surface(pixel);
    if (!is_spread(s)) { return center; }
    let roughness = reflected_roughness(s);
    let alpha = roughness * roughness;
    let footprint_m = pixel_width(distance(s.position, frame.eye));
    let widest_px = WIDEST * frame.size.y;
    let farthest_m = widest_px * footprint_m / alpha;
    var hit_m = center.w;
    if (params.is_first != 0u) { hit_m = min(mean_hit_m(vec2i(pixel), farthest_m), FARTHEST_M); }
    let reach_m = params.reach * alpha * hit_m;
    let reach_px = reach_m / footprint_m;
    if (reach_px < 0.5) { return vec4f(center.xyz, hit_m); }
    var sum = center.xyz;
    var weights = 1.0;
    let turn = turn_of(pixel);
    for (var k = 0u; k < params.taps; k++) {
        let r = tap_radius(k, params.taps);
        let at = tap_at(pixel, turn, reach_px * r, k);
        if (!inside(at) || !reflects(textureLoad(cause, at, 0).x)) { continue; }
        let other = load_surface(vec2u(at));
        if (!is_spread(other)) { continue; }
        // Mirrored directions turn twice as far as normals, and lobes are about twice as wide as alpha.
        let tilt2 = 2.0 * (1.0 - dot(reflected_normal(s), reflected_normal(other)));
        let away_m = dot(other.position - s.position, s.geometric_normal);
        let rougher = (reflected_roughness(other) - roughness) / (0.2 * roughness);
        var weight = exp(-2.0 * r * r - tilt2 / (alpha * alpha) - rougher * rougher);
        weight *= select(1.0, 0.0, abs(away_m) > 0.1 * reach_m + 0.5 * footprint_m);
        sum += textureLoad(source, at, 0).xyz * weight;
        weights += weight;
    }
    return vec4f(sum / weights, hit_m);
}

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = moment_pixel(id.xy);
    if (any(pixel >= vec2u(frame.size))) { return; }
    var color = textureLoad(source, pixel, 0);
    if (reflects(textureLoad(cause, pixel, 0).x)) { color = filtered(pixel, color); }
    textureStore(blurred, pixel, stored(color));
}
