// Group 0: data that all passes of a frame share: the camera, the lights, the shadow maps.

#import constants
#import hash

struct Frame {
    clip_from_world: mat4x4f,
    eye: vec3f,
    near_m: f32,
    forward: vec3f,
    pixel_spread: f32, // angle of one pixel, radians; initial spread of ray cones
    right: vec3f, // half the picture's width at distance 1; orthographic: at any distance
    ray_length_m: f32,
    up: vec3f, // half the picture's height, likewise
    roughness_cutoff: f32,
    size: vec2f, // pixels
    jitter: vec2f, // sub-frame offset, pixels, -0.5 to 0.5, plus the lens shift
    zenith: vec3f,
    light_count: u32,
    horizon: vec3f,
    bounces: u32,
    ground: vec3f,
    fade: u32,
    reuse_light: u32, // 1: hits reuse the light visibility of the pixels that show them
    dimmest: f32, // minimum throughput of a path; below it ends
    pixel_m: f32, // width of an orthographic pixel, m; 0: perspective
    far_m: f32, // far plane of an orthographic camera, beyond all geometry; 0: perspective
    has_edge_on: u32, // 1: the march may miss surfaces that are seen edge-on
    diffuse_bounces: u32, // maximum number of diffuse scatterings along a path
    glint_limit: f32, // maximum radiance that a path adds after a random choice; 0: no limit
    hard_lights: u32, // number of lights without a size, which come first
    moments: u32, // number of moments of the sub-frame; 1: all pixels show it
    moment: u32, // index of the moment that is rendered
    whole_surfaces: u32, // 1: surfaces are resolved for the pixels of other moments too
    pad0: u32,
    crop: vec4f, // left, top, right and bottom edge of the crop, pixels
}

struct Light {
    position: vec3f,
    kind: u32, // LIGHT_*
    direction: vec3f, // direction in which the light shines
    shadow: u32, // SHADOW_*
    color: vec3f, // candela or lux per channel
    range_m: f32, // 0: unlimited
    spot_scale: f32,
    spot_offset: f32,
    layer: u32, // layer of its shadow map
    texel: f32, // world size of a shadow texel: at distance 1, or anywhere for directional
    clip_from_world: mat4x4f,
    half_u: vec3f, // half axes of a flat light, m
    extent: f32, // radius, m; of directional lights half their angle, radians
    half_v: vec3f,
    shown: f32, // 1; 0 where the picture shows another light group
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> lights: array<Light, MAX_LIGHTS>;
@group(0) @binding(2) var shadow_cubes: texture_depth_cube_array;
@group(0) @binding(3) var shadow_maps: texture_depth_2d_array;
@group(0) @binding(4) var shadow_sampler: sampler_comparison;

const PI: f32 = 3.14159265358979;

// Whether something names a light group, so that pictures may show one group alone. Random choices are those of all lights,
// so that the groups add up to the whole picture.
override HAS_LIGHT_GROUPS: bool = true;

// Share of a light that the picture shows.
fn shown_share(i: u32) -> f32 {
    if (!HAS_LIGHT_GROUPS) { return 1.0; }
    return lights[i].shown;
}

// Whether light outside of the crop is left out.
override CROPS: bool = false;

fn is_left_out(pixel: vec2u) -> bool {
    return CROPS && (any(vec2f(pixel) < frame.crop.xy) || any(vec2f(pixel) >= frame.crop.zw));
}

// Number of times that the rows of workgroups are shuffled: software drivers give each thread a block of adjacent
// rows, and rows take unequal times.
override ROW_SHUFFLES: u32 = 0u;

// Whether pixels of one sub-frame show different moments of an open shutter.
override HAS_MOMENTS: bool = true;

// Whether this share of a sub-frame has one pixel in each square of 2 × 2; else it has all.
fn is_share() -> bool {
    return HAS_MOMENTS && frame.moments > 1u;
}

// Pixel of a square that shows the moment; the squares are shuffled differently.
fn moment_pixel(square: vec2u) -> vec2u {
    if (!is_share()) { return square; }
    let random = hash(square.x + hash(square.y));
    let place = (frame.moment ^ random) * ((random >> 8u) | 1u) + (random >> 16u);
    return 2u * square + vec2u(place & 1u, (place >> 1u) & 1u);
}

// Pixel that shows the moment, near another one.
fn pixel_of_moment(near: vec2i) -> vec2i {
    if (!is_share()) { return near; }
    return vec2i(moment_pixel(vec2u(near) / 2u));
}

// Whether a pixel shows the moment.
fn shows_moment(pixel: vec2u) -> bool {
    return all(pixel_of_moment(vec2i(pixel)) == vec2i(pixel));
}

// Pixel of an invocation in passes that resolve surfaces.
fn surface_pixel(invoked: vec2u) -> vec2u {
    if (!is_share() || frame.whole_surfaces != 0u) { return invoked; }
    return moment_pixel(invoked);
}

// Place of an invocation among those of passes over all pixels, or over the squares of which each has one that shows the
// moment.
fn invoked_place(group: vec3u, groups: vec3u, local: vec3u) -> vec2u {
    var row = group.y;
    let half = (groups.y + 1u) / 2u;
    for (var k = 0u; k < ROW_SHUFFLES; k++) { row = select(2u * (row - half) + 1u, 2u * row, row < half); }
    return vec2u(group.x, row) * GROUP_PX + local.xy;
}

// Pixel of an invocation, in passes over all pixels that show the moment.
fn invoked_pixel(group: vec3u, groups: vec3u, local: vec3u) -> vec2u {
    return moment_pixel(invoked_place(group, groups, local));
}

fn is_orthographic() -> bool {
    return frame.far_m > 0.0;
}

// Offset from the center of the picture to a pixel, at distance 1; orthographic: at any distance.
fn pixel_offset(pixel: vec2f) -> vec3f {
    let ndc = (pixel + frame.jitter) / frame.size * 2.0 - 1.0;
    return frame.right * ndc.x - frame.up * ndc.y;
}

fn pixel_origin(pixel: vec2f) -> vec3f {
    if (is_orthographic()) { return frame.eye + pixel_offset(pixel); }
    return frame.eye;
}

// Direction of a pixel's ray, not normalized: its component along `forward` is 1, so that t is linear view depth.
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

// Clip-space z of a view depth, and the inverse below. It is linear along a ray on the screen, and 1 at the near
// plane.
fn screen_z(depth_m: f32) -> f32 {
    if (is_orthographic()) { return max((frame.far_m - depth_m) / (frame.far_m - frame.near_m), 0.0); }
    return frame.near_m / depth_m;
}

fn depth_of(z: f32) -> f32 {
    if (is_orthographic()) { return frame.far_m - z * (frame.far_m - frame.near_m); }
    return frame.near_m / max(z, 1e-30);
}

// Luminance of linear Rec. 709 colors, the weight of random choices between colors.
fn luminance(color: vec3f) -> f32 {
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}
