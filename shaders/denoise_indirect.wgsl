// Denoise indirect: smooths indirect light on matte surfaces, in pictures of few sub-frames, over neighboring pixels of the same
// surface. The radius is a share of the harmonic mean distance that the light comes from, within which it changes
// little (Ward et al. 1988). Textures stay sharp, as the light is smoothed before it is multiplied by their colors.

#import gbuffer
#import radiance
#import denoise_indirect_params
#import taps

@group(2) @binding(5) var source: texture_2d<f32>; // see paths.wgsl
@group(2) @binding(6) var denoised: RadianceTexture;
@group(2) @binding(7) var<uniform> params: Params;

const SAME_SIDES: f32 = 0.02; // maximum difference of diffuse transmission, whose light has two sides
const MOST_BETWEEN: i32 = 8; // pixels looked at between a pixel and a tap

// Mean of w over the pixels around: harmonic mean of distances; 0 without any. The pixel's own ray is left out: where
// it met something bright, that would make the share of its light depend on it.
fn mean_nearness(pixel: vec2i) -> f32 {
    var sum = 0.0;
    var count = 0.0;
    for (var k = 0; k < 25; k++) {
        if (k == 12) { continue; }
        let at = pixel_of_moment(pixel + vec2i(k % 5 - 2, k / 5 - 2) * 3);
        if (!inside(at)) { continue; }
        let nearness = textureLoad(source, at, 0).w;
        sum += nearness;
        count += select(0.0, 1.0, nearness > 0.0);
    }
    return sum / max(count, 1.0);
}

// Whether something stands on the plane of the surface between a pixel and another, such as a wall between two floors.
fn is_apart(pixel: vec2i, near: vec2i, s: Surface, normal: vec3f, tolerance_m: f32) -> bool {
    let way = near - pixel;
    let steps = min(max(abs(way.x), abs(way.y)), MOST_BETWEEN);
    for (var j = 1; j < steps; j++) {
        let between = pixel_of_moment(pixel + way * j / steps);
        if (!inside(between)) { continue; }
        let position = position_at(vec2u(between), textureLoad(view_depth, between, 0).x);
        if (dot(position - s.position, normal) > tolerance_m) { return true; }
    }
    return false;
}

// Light of a pixel and its weight, in each color and in w.
struct Weighted {
    light: vec4f,
    weight: vec4f,
}

fn weighted(light: vec4f, weight: f32) -> Weighted {
    let known = select(vec4f(0.0), vec4f(weight), light >= vec4f(0.0));
    return Weighted(light * known, known);
}

fn denoised_light(pixel: vec2u, s: Surface, own: vec4f) -> vec4f {
    let footprint_m = pixel_width(distance(s.position, frame.eye));
    let nearness = mean_nearness(vec2i(pixel));
    if (nearness <= 0.0) { return own; }
    let reach_px = min(params.reach / nearness, params.widest * frame.size.y);
    if (reach_px < 0.5) { return own; }
    let reach_m = max(reach_px, 1.0) * footprint_m;
    let tolerance_m = (0.1 * reach_px + 0.5) * footprint_m;
    let normal = unpack_geometric_normal(textureLoad(surface, pixel, 0));
    let turn = turn_of(pixel);
    var sum = weighted(own, 1.0);
    for (var k = 0u; k < params.taps; k++) {
        let r = tap_radius(k, params.taps);
        let at = tap_at(pixel, turn, reach_px * r, k);
        if (!inside(at)) { continue; }
        let found = textureLoad(source, at, 0);
        if (found.w <= 0.0 || abs(diffuse_transmission_at(vec2u(at)) - s.diffuse_transmission) > SAME_SIDES) { continue; }
        let other = unpack_geometric_normal(textureLoad(surface, at, 0));
        let offset_m = position_at(vec2u(at), textureLoad(view_depth, at, 0).x) - s.position;
        let tilt = 1.0 - dot(normal, other);
        // A disk on the screen reaches far over a surface that is seen at a grazing angle.
        let away = max(r * r, dot(offset_m, offset_m) / (reach_m * reach_m));
        let weight = exp(-2.0 * away - 20.0 * tilt);
        if (weight < 1e-3 || abs(dot(offset_m, normal)) > tolerance_m) { continue; }
        if (is_apart(vec2i(pixel), at, s, normal, tolerance_m)) { continue; }
        let part = weighted(found, weight);
        sum.light += part.light;
        sum.weight += part.weight;
    }
    return select(sum.light / max(sum.weight, vec4f(1e-6)), own, sum.weight <= vec4f(0.0));
}

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = moment_pixel(id.xy);
    if (any(pixel >= vec2u(frame.size))) { return; }
    var light = textureLoad(source, pixel, 0);
    if (light.w > 0.0) {
        let s = load_surface(pixel);
        light = denoised_light(pixel, s, light);
        if (params.is_last != 0u) { light = vec4f(max(light.xyz, vec3f(0.0)) * scattering_albedo(s, -view_direction(s.position)), 1.0); }
    }
    textureStore(denoised, pixel, stored(light));
}
