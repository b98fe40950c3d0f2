// Group 0: what one frame has in common: the camera, the lights, the shadow maps.

#import constants

struct Frame {
    clip_from_world: mat4x4f,
    eye: vec3f,
    near_m: f32,
    forward: vec3f,
    pixel_spread: f32, // radians that one pixel spans; ray cones start with it
    right: vec3f, // half the width of the picture, at distance 1 or, if orthographic, at any
    ray_length_m: f32,
    up: vec3f, // half its height
    roughness_cutoff: f32,
    size: vec2f, // pixels
    jitter: vec2f, // pixels, -0.5 to 0.5, and beyond by what a lens shifts the picture
    zenith: vec3f,
    light_count: u32,
    horizon: vec3f,
    bounces: u32,
    ground: vec3f,
    fade: u32,
    reuse_light: u32, // 1: hits take from the picture which lights reach them
    dimmest: f32, // share of light that a bounce must carry to be seen
    pixel_m: f32, // width of an orthographic pixel; 0: perspective
    far_m: f32, // depth where an orthographic clip space ends: nothing lies beyond; 0: perspective
    has_edge_on: u32, // 1: rays on the screen may pass surfaces that are seen edge-on
    diffuse_bounces: u32, // times that matte surfaces scatter along a path
    glint_limit: f32, // radiance that paths add past a chance; 0: no limit
    hard_lights: u32, // lights without a size, the first ones
}

struct Light {
    position: vec3f,
    kind: u32, // LIGHT_*
    direction: vec3f, // in which it shines
    shadow: u32, // SHADOW_*
    color: vec3f, // candela or lux per channel
    range_m: f32, // 0: endless
    spot_scale: f32,
    spot_offset: f32,
    layer: u32, // of its shadow map
    texel: f32, // world size of a shadow texel: at distance 1, or anywhere for directional
    clip_from_world: mat4x4f,
    half_u: vec3f, // from the middle of a flat light to its edges
    extent: f32, // radius; of directional lights half their angle
    half_v: vec3f,
    pad0: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> lights: array<Light, MAX_LIGHTS>;
@group(0) @binding(2) var shadow_cubes: texture_depth_cube_array;
@group(0) @binding(3) var shadow_maps: texture_depth_2d_array;
@group(0) @binding(4) var shadow_sampler: sampler_comparison;

const PI: f32 = 3.14159265358979;

// Times that the rows of groups are shuffled: drivers without a GPU give each of their threads one stretch of rows,
// and rows take unlike times.
override ROW_SHUFFLES: u32 = 0u;
const GROUP_PX: u32 = 8u;

// The pixel of an invocation of a pass over all pixels.
fn invoked_pixel(group: vec3u, groups: vec3u, local: vec3u) -> vec2u {
    var row = group.y;
    let half = (groups.y + 1u) / 2u;
    for (var k = 0u; k < ROW_SHUFFLES; k++) { row = select(2u * (row - half) + 1u, 2u * row, row < half); }
    return vec2u(group.x, row) * GROUP_PX + local.xy;
}

fn is_orthographic() -> bool {
    return frame.far_m > 0.0;
}

// From the middle of the picture to a pixel: at distance 1 or, if orthographic, at any.
fn pixel_offset(pixel: vec2f) -> vec3f {
    let ndc = (pixel + frame.jitter) / frame.size * 2.0 - 1.0;
    return frame.right * ndc.x - frame.up * ndc.y;
}

fn pixel_origin(pixel: vec2f) -> vec3f {
    if (is_orthographic()) { return frame.eye + pixel_offset(pixel); }
    return frame.eye;
}

// Not normalized: its length along `forward` is 1, so that t along it is linear view depth.
fn pixel_ray(pixel: vec2f) -> vec3f {
    if (is_orthographic()) { return frame.forward; }
    return frame.forward + pixel_offset(pixel);
}

// Unit direction along which the camera sees a point.
fn view_direction(position: vec3f) -> vec3f {
    if (is_orthographic()) { return frame.forward; }
    return normalize(position - frame.eye);
}

// Width of a pixel's cone at a distance from the eye.
fn pixel_width(distance_m: f32) -> f32 {
    return frame.pixel_m + frame.pixel_spread * distance_m;
}

// Clip-space z of a view depth, and back. It is linear along a ray on the screen, and 1 at the near plane.
fn screen_z(depth_m: f32) -> f32 {
    if (is_orthographic()) { return max((frame.far_m - depth_m) / (frame.far_m - frame.near_m), 0.0); }
    return frame.near_m / depth_m;
}

fn depth_of(z: f32) -> f32 {
    if (is_orthographic()) { return frame.far_m - z * (frame.far_m - frame.near_m); }
    return frame.near_m / max(z, 1e-30);
}

// Of linear Rec. 709 colors: what choices between colors weigh by.
fn luminance(color: vec3f) -> f32 {
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}
